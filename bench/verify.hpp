// Whether a scene gives the same bits whatever runs it.
//
// The reference is the serial executor with the reference kernels. Every case differs from it in
// executor, workers, order, fusion, instruction set, sort or settings (LOD, skips); after each
// frame the digests of all value streams are held against those of the reference with the same
// settings. On a mismatch both are run again in lock-step and the first differing stage, block, row
// and lane is named. A second section switches each skip off and wants the same digests again.
//
// Invariant: a report that says "same" compared every value stream of every frame of every case it
// lists; what was not compared is listed as skipped, with the reason.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/scenarios.hpp"
#include "bench/shard.hpp"

namespace pelt {

enum class ExecutorKind : uint8_t {
  kSerial,
  kTbb,
  kDoor,  // the engine's door, on a pool of std::threads
  kPull,  // polling std::threads
  kPermuted,
  kLocalStore
};
std::string_view ExecutorName(ExecutorKind kind);  // "serial", "tbb", "door", "pull", ...
// Whether it runs on as many threads as it is told.
inline bool HasWorkers(ExecutorKind kind) {
  return kind == ExecutorKind::kTbb || kind == ExecutorKind::kDoor || kind == ExecutorKind::kPull;
}
std::optional<ExecutorKind> ParseExecutor(std::string_view name);

// What a frame is told to leave out. LOD is its own picture, so each has a reference of its own.
enum class Settings : uint8_t { kSkips, kNoSkips, kLod };
std::string_view SettingsName(Settings settings);  // "skips", "no-skips", "lod"

struct VerifyCase {
  ExecutorKind executor = ExecutorKind::kSerial;
  uint32_t workers = 1;     // tbb, door, pull
  uint64_t order_seed = 0;  // permuted
  bool fuse = true;
  Isa isa = Isa::kReference;
  VertexOrder vertex_order = VertexOrder::kSorted;
  bool piecewise_sort = false;
  Settings settings = Settings::kSkips;
};
std::string NameCase(const VerifyCase& what);

// The first value that differs between reference and case, in the order of the frame's stages.
struct Mismatch {
  uint32_t frame = 0;
  std::string stage, stream, row;
  std::string layer;            // empty for streams of scene or character
  uint32_t item = 0;            // character, layer or chunk of the scene
  uint32_t chunk_in_layer = 0;  // for chunk streams
  uint32_t component = 0, lane = 0;
  uint32_t expected = 0, found = 0;
  bool is_float = false;
  bool reproduced = true;  // false: seen once, and not again in lock-step: a race
};
std::string DescribeMismatch(const Mismatch& mismatch);

struct CaseResult {
  VerifyCase what;
  uint32_t place = 0;  // in the list that shards split: cases and skips, as they are reported
  bool passed = true;
  std::string reason;  // of a failure, one line
  std::optional<Mismatch> mismatch;
  uint32_t workers_observed = 0;
};

struct SkipResult {
  std::string name;    // the switch
  std::string course;  // "as it runs" or "coming to rest"
  uint32_t place = 0;
  bool passed = true;
  bool compared = true;
  std::string reason;
  std::optional<Mismatch> mismatch;
  uint64_t items_skipped = 0;  // more stage items than with the switch off, over all frames
};

struct VerifyReport {
  std::string scene;
  uint32_t frames = 0;
  uint64_t strands = 0;
  uint64_t digest = 0;  // of the reference, vertices sorted, all frames
  std::vector<CaseResult> cases;
  std::vector<SkipResult> skips;
  uint32_t places = 0;  // length of the whole list, of which this has the shard's
  Shard shard;
  bool stopped = false;              // at a failure
  std::vector<std::string> not_run;  // instruction sets that this processor or build lacks
  bool Passed() const;
};

struct VerifyOptions {
  uint32_t frames = 20;
  // A case may be changed before it runs: how tests plant faults. Never applied to the reference.
  std::function<void(const VerifyCase&, Plan&)> tamper;
  std::function<void(uint32_t done, uint32_t total, const std::string& now)> progress;
  // Runs only cases this accepts; empty: all.
  std::function<bool(const VerifyCase&)> filter;
  bool skips = true;
  Shard shard;                   // of the list: everything that has a place in it
  bool stop_at_failure = false;  // what comes after the first one is not run, nor reported
};

VerifyReport Verify(Scenario& scenario, const VerifyOptions& options);

// Every case of the full matrix for instruction sets this processor has.
std::vector<VerifyCase> AllCases();

// A table, what failed, and one verdict line.
std::string DescribeReport(const VerifyReport& report);
// Shards of equal fingerprints can be merged: bench/merge_shards.hpp.
std::string ReportAsJson(const VerifyReport& report, const Fingerprint& fingerprint = {});

}  // namespace pelt
