// The SPU's numbers: what its core model starts from, and nothing else. A plain struct, so that a
// test can plant a wrong number and see a measured row notice. How many there are and how fast they
// run is the system's matter: cell.hpp.
//
// Sources: "SDK": IBM SDK for Multicore Acceleration 3.0, Programming Tutorial (pipelines, dual
// issue, DMA); "GCC": GCC's SPU machine description, which agrees with it where both speak;
// "cellmark": measurements on a retail PS3 (sagemono/cellmark, 2026). How sure: P published or
// measured and read at its source, S second-hand, L a lead only.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "platform_sim/platforms/number.hpp"

namespace pelt {

enum class SpuPipe : uint8_t { kEven, kOdd };

enum class SpuClass : uint8_t {
  kFx2,       // simple integer, logical, compare, select, immediates
  kFx3,       // word rotate and shift
  kFxb,       // bytes
  kFp6,       // single precision
  kFp7,       // integer multiply, convert, interpolate
  kFpd,       // double precision
  kShuffle,   // shuffle, quadword shift and rotate, form mask, gather
  kEstimate,  // frest, frsqest: of the shuffle unit
  kLoad,
  kStore,
  kBranch,
  kHint,
  kChannel,
  kNop,
  kLnop,
  kSync,
};
inline constexpr uint32_t kSpuClassCount = uint32_t(SpuClass::kSync) + 1;

struct SpuClassParameters {
  std::string_view name;
  std::string_view operations;  // for the printed table
  SpuPipe pipe;
  uint32_t latency_cycles;    // from issue to the issue of a reader
  uint32_t stall_cycles = 0;  // after issue, in which neither pipe issues
  Sureness sure = Sureness::kPublished;
  std::string_view source;
};

struct SpuNumbers {
  Number<uint32_t> fetch_group_bytes = {8, "fetch group", "bytes", "SDK"};
  Number<uint32_t> instruction_bytes = {4, "instruction", "bytes", "SDK"};
  Number<uint32_t> mispredict_cycles = {18, "mispredicted branch", "cycles", "SDK"};
  // A younger hint's branch waits for its target.
  Number<uint32_t> hint_lead_cycles = {15, "lead of a branch hint", "cycles", "SDK"};
  // Fewer between hint and branch: no hint at all.
  Number<uint32_t> hint_reach_instructions = {8, "reach of a branch hint", "instructions", "GCC"};
  Number<uint32_t> fp6_after_fp7_cycles = {1, "FP6 right after an FP7", "cycles", "SDK"};
  Number<uint32_t> register_count = {128, "registers", "registers", "SDK"};
};

struct SpuParameters : SpuNumbers {
  std::array<SpuClassParameters, kSpuClassCount> classes = {{
      {"FX2", "a ai and or xor selb il ila ceq cgt fcgt", SpuPipe::kEven, 2, 0,
       Sureness::kPublished, "SDK, GCC"},
      {"FX3", "shl rot rotm rotma and halfword forms", SpuPipe::kEven, 4, 0, Sureness::kPublished,
       "SDK, GCC"},
      {"FXB", "absdb sumb cntb avgb", SpuPipe::kEven, 4, 0, Sureness::kPublished, "SDK, GCC"},
      {"FP6", "fa fs fm fma fnms fms", SpuPipe::kEven, 6, 0, Sureness::kPublished, "SDK, GCC"},
      {"FP7", "mpy mpya csflt cflts fi", SpuPipe::kEven, 7, 0, Sureness::kPublished, "SDK, GCC"},
      {"FPD", "dfa dfm dfma", SpuPipe::kEven, 13, 6, Sureness::kPublished, "SDK"},
      {"SHUF", "shufb rotqby shlqbi orx fsmbi gb cwd", SpuPipe::kOdd, 4, 0, Sureness::kPublished,
       "SDK, GCC"},
      {"EST", "frest frsqest", SpuPipe::kOdd, 4, 0, Sureness::kPublished, "SDK, GCC"},
      {"LOAD", "lqd lqx lqa lqr", SpuPipe::kOdd, 6, 0, Sureness::kPublished, "SDK, GCC"},
      {"STORE", "stqd stqx stqa stqr", SpuPipe::kOdd, 6, 0, Sureness::kPublished, "SDK, GCC"},
      {"BR", "br brz brnz bi brsl", SpuPipe::kOdd, 4, 0, Sureness::kPublished, "SDK, GCC"},
      {"HB", "hbr hbra hbrr", SpuPipe::kOdd, 0, 0, Sureness::kPublished, "SDK"},
      {"CH", "rdch rchcnt wrch mfspr mtspr", SpuPipe::kOdd, 6, 0, Sureness::kPublished, "SDK"},
      {"NOP", "nop", SpuPipe::kEven, 0, 0, Sureness::kPublished, "SDK, GCC"},
      {"LNOP", "lnop", SpuPipe::kOdd, 0, 0, Sureness::kPublished, "SDK, GCC"},
      {"SYNC", "sync dsync stop stopd", SpuPipe::kOdd, 0, 0, Sureness::kLead,
       "pipe by the instruction table; what they wait for is not modelled"},
  }};

  const SpuClassParameters& Of(SpuClass c) const { return classes[uint32_t(c)]; }
  SpuClassParameters& Of(SpuClass c) { return classes[uint32_t(c)]; }
};

// Every number above by name, for a report.
std::vector<PlatformNumber> DescribeNumbers(const SpuParameters& spu);

}  // namespace pelt
