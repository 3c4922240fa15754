// The numbers of the PPE and of its family (the Xenon core is its sister): what the PPE core model
// starts from, and nothing else. A plain struct, so that a test can plant a wrong number.
//
// Sources: "GCC": GCC's machine description of the Cell PPU, contributed by Sony; "MS": Microsoft's
// Xbox 360 performance talks. How sure: P published or measured and read at its source, S
// second-hand, L a lead only.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include "platform_sim/platforms/number.hpp"

namespace pelt {

// One of each. Two instructions that need the same one never dispatch together.
enum class PpeUnit : uint8_t {
  kFixedPoint = 1,
  kLoadStore = 2,
  kBranch = 4,
  kVsu1 = 8,   // VMX arithmetic and floating point
  kVsu2 = 16,  // VMX permute, vector and floating-point load and store
};
constexpr uint8_t operator|(PpeUnit a, PpeUnit b) { return uint8_t(a) | uint8_t(b); }
inline constexpr uint32_t kPpeUnitCount = 5;

enum class PpeClass : uint8_t {
  kInteger,
  kCompare,
  kMultiplyImmediate,
  kMultiplyWord,
  kMultiplyDouble,
  kDivideWord,
  kDivideDouble,
  kLoad,
  kLoadExtend,
  kLoadUpdate,
  kFloatLoad,
  kVectorLoad,
  kStore,
  kStoreUpdate,
  kFloatStore,
  kVectorStore,
  kFloat,
  kFloatCompare,
  kFloatDivide,
  kFloatRoot,
  kVectorSimple,
  kVectorPermute,
  kVectorComplex,
  kVectorFloat,
  kVectorEstimate,
  kBranch,
  kMoveToBranch,    // mtctr, mtlr
  kMoveFromBranch,  // mfctr, mflr
  kMoveFromCr,
  kCrLogical,
  kSync,
};
inline constexpr uint32_t kPpeClassCount = uint32_t(PpeClass::kSync) + 1;

// What a multiply or divide of the fixed-point unit holds up: all but branches.
inline constexpr uint8_t kPpeAllButBranch = uint8_t(PpeUnit::kFixedPoint) |
                                            uint8_t(PpeUnit::kLoadStore) | uint8_t(PpeUnit::kVsu1) |
                                            uint8_t(PpeUnit::kVsu2);

struct PpeClassParameters {
  std::string_view name;
  uint8_t units;             // PpeUnit bits
  uint32_t latency_cycles;   // from dispatch to the dispatch of a reader
  uint8_t blocks_units = 0;  // not pipelined: these take nothing else until it is done
  Sureness sure = Sureness::kPublished;
  std::string_view source = "GCC";
};

struct PpeNumbers {
  // Into an address the way is longer: a load or an integer result is ready for it only this late.
  // The PPE's manual: 4 to 6, by the way the result takes; GCC schedules with 5. Chained loads take
  // the long way (row P1).
  Number<uint32_t> load_to_address_cycles = {
      6, "load to a dependent address", "cycles",
      "PPE User's Manual as quoted by cellmark: 4 to 6, chained loads at the upper end",
      Sureness::kSecondHand};
  Number<uint32_t> integer_to_address_cycles = {5, "integer to a dependent address", "cycles",
                                                "GCC"};
  Number<uint32_t> float_compare_to_branch_cycles = {6, "FP compare to branch", "cycles", "GCC"};
  Number<uint32_t> count_to_register_branch_cycles = {10, "mtctr to bctr", "cycles", "GCC"};
  Number<uint32_t> load_hit_store_cycles = {40, "load-hit-store, at most", "cycles", "MS"};
  Number<uint32_t> dispatch_width = {2, "dispatch", "instructions per cycle", "GCC"};
  Number<uint32_t> mispredict_cycles = {23, "mispredicted branch", "cycles", "widely repeated",
                                        Sureness::kLead};  // where a loop ends
  Number<uint32_t> smt_threads = {2, "hardware threads", "threads", "GCC"};
  Number<uint32_t> general_register_count = {32, "general registers", "registers", "architecture"};
  Number<uint32_t> float_register_count = {32, "FP registers", "registers", "architecture"};
  // 128 on the Xenon core.
  Number<uint32_t> vector_register_count = {32, "vector registers", "registers", "architecture"};
};

struct PpeParameters : PpeNumbers {
  std::array<PpeClassParameters, kPpeClassCount> classes = {{
      {"integer", uint8_t(PpeUnit::kFixedPoint), 2},
      {"compare", uint8_t(PpeUnit::kFixedPoint), 1},
      {"mulli", uint8_t(PpeUnit::kFixedPoint), 6, kPpeAllButBranch},
      {"mullw", uint8_t(PpeUnit::kFixedPoint), 9, kPpeAllButBranch},
      {"mulld", uint8_t(PpeUnit::kFixedPoint), 15, kPpeAllButBranch},
      {"divw", uint8_t(PpeUnit::kFixedPoint), 32, kPpeAllButBranch},
      {"divd", uint8_t(PpeUnit::kFixedPoint), 64, kPpeAllButBranch},
      {"load", uint8_t(PpeUnit::kLoadStore), 2},
      {"load with sign", PpeUnit::kFixedPoint | PpeUnit::kLoadStore, 2},
      {"load with update", PpeUnit::kFixedPoint | PpeUnit::kLoadStore, 2},
      {"FP load", PpeUnit::kLoadStore | PpeUnit::kVsu2, 1},
      {"vector load", PpeUnit::kLoadStore | PpeUnit::kVsu2, 2},
      {"store", uint8_t(PpeUnit::kLoadStore), 1},
      {"store with update", PpeUnit::kFixedPoint | PpeUnit::kLoadStore, 1},
      {"FP store", PpeUnit::kLoadStore | PpeUnit::kVsu2, 1},
      {"vector store", PpeUnit::kLoadStore | PpeUnit::kVsu2, 1},
      {"scalar FP", uint8_t(PpeUnit::kVsu1), 10},
      {"FP compare", uint8_t(PpeUnit::kVsu1), 1},
      {"fdiv", uint8_t(PpeUnit::kVsu1), 74, uint8_t(PpeUnit::kVsu1)},
      {"fsqrt", uint8_t(PpeUnit::kVsu1), 84, uint8_t(PpeUnit::kVsu1)},
      {"VMX simple", uint8_t(PpeUnit::kVsu1), 4},
      {"VMX permute", uint8_t(PpeUnit::kVsu2), 4},
      {"VMX complex", uint8_t(PpeUnit::kVsu1), 10},
      {"VMX float", uint8_t(PpeUnit::kVsu1), 12},
      {"VMX estimate", uint8_t(PpeUnit::kVsu1), 14},
      {"branch", uint8_t(PpeUnit::kBranch), 1},
      {"mtctr, mtlr", uint8_t(PpeUnit::kBranch), 1},
      {"mfctr, mflr", uint8_t(PpeUnit::kBranch), 1},
      {"mfcr", uint8_t(PpeUnit::kFixedPoint), 34, kPpeAllButBranch},
      {"cr logical", uint8_t(PpeUnit::kBranch), 1},
      {"sync", uint8_t(PpeUnit::kLoadStore), 11},
  }};

  const PpeClassParameters& Of(PpeClass c) const { return classes[uint32_t(c)]; }
  PpeClassParameters& Of(PpeClass c) { return classes[uint32_t(c)]; }
};

// Every number above by name, for a report.
std::vector<PlatformNumber> DescribeNumbers(const PpeParameters& ppe);

}  // namespace pelt
