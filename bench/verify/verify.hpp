// Whether a scene gives the same bits regardless of what runs it.
//
// The reference is the serial executor with the reference kernels. Every case differs from it in
// executor, workers, order, fusion, instruction set, sort, settings (LOD, skips) or the calling
// threads' rounding; after each frame the digests of all value streams, and of the bookkeeping,
// are compared with those of the reference with the same settings. On a mismatch both are run
// again in lock-step and the first differing stage, block, row and lane is named. A second section
// switches each skip off and wants the same digests again. The checks of a third section judge by
// other means than a second run of the same code: see bench/verify/.
//
// What is verified is the scene with a second character that differs, where it has only one
// (bench/verify/verified_scene.hpp).
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

#include "bench/scenarios/scenarios.hpp"
#include "bench/verify/executors.hpp"
#include "bench/verify/shard.hpp"
#include "jobs/verify/mismatch.hpp"

namespace pelt {

// What a frame is set to leave out. LOD is its own picture, so each has a reference of its own.
enum class Settings : uint8_t { kSkips, kNoSkips, kLod };
std::string_view SettingsName(Settings settings);  // "skips", "no-skips", "lod"

struct VerifyCase {
  ExecutorKind executor = {};  // the reference's
  uint32_t workers = 1;        // of executors with workers; 0: one for each core
  uint64_t order_seed = 0;     // of those with a seeded order
  bool fuse = true;
  Isa isa = Isa::kReference;
  VertexOrder vertex_order = VertexOrder::kSorted;
  bool piecewise_sort = false;
  Settings settings = Settings::kSkips;
  bool odd_floats = false;  // the threads that call round upwards and flush denormals
};
std::string NameCase(const VerifyCase& what);

// What every part of a report says of one thing that it looked at.
struct Outcome {
  bool passed = true;
  bool compared = true;
  FindingKind kind = FindingKind::kNone;
  std::string stage, stream;  // of the finding, where it has them
  std::string reason;         // of a failure, or why it was not compared; one line
  std::optional<Mismatch> mismatch;
  uint32_t place = 0;  // in the list that shards split: cases, skips, sections of checks

  void Fail(Finding finding);
  void Fail(FindingKind why, const Mismatch& where);
  void LeaveOut(std::string why);
  // As LeaveOut, of what every scene should be looked at with: the whole verdict lacks it.
  void Miss(std::string why);
  bool missing = false;
};

struct CaseResult : Outcome {
  VerifyCase what;
  uint32_t workers_observed = 0;
};

struct SkipResult : Outcome {
  std::string name;            // the switch
  std::string course;          // "as it runs" or "coming to rest"
  uint64_t items_skipped = 0;  // more stage items than with the switch off, over all frames
};

// One check of bench/verify/.
struct CheckResult : Outcome {
  std::string section;  // "waking"
  std::string name;     // "sphere 0[3], one ulp"
  uint64_t seen = 0;    // how many things it looked at; what, the section says
  bool felt = false;    // waking: whether the changed input reached any bit
};

struct VerifyReport {
  std::string scene;
  uint32_t frames = 0;
  uint64_t strands = 0;
  uint32_t characters = 0;
  uint64_t digest = 0;  // of the reference, vertices sorted, all frames
  std::vector<CaseResult> cases;
  std::vector<SkipResult> skips;
  uint32_t places = 0;  // length of the whole list, of which this has the shard's
  Shard shard;
  bool stopped = false;  // at a failure
  std::vector<CheckResult> checks;
  std::vector<std::string> not_run;  // that this processor, system or build lacks
  bool Passed() const;
  // What it should have looked at and could not, and why: "waking, coming to rest: no chunk ...".
  std::vector<std::string> Missing() const;
};

struct VerifyOptions;
// Whether the next place of the list is this shard's, and still to be run.
bool TakesNext(const VerifyOptions& options, VerifyReport& report);

struct VerifyOptions {
  uint32_t frames = 20;
  // A case may be changed before it runs: how tests plant faults. Never applied to the reference.
  std::function<void(const VerifyCase&, Plan&)> tamper;
  // Of cases; behind them total is 0, and `now` names what is checked.
  std::function<void(uint32_t done, uint32_t total, const std::string& now)> progress;
  // Runs only cases this accepts; empty: all.
  std::function<bool(const VerifyCase&)> filter;
  bool skips = true;
  Shard shard;                   // of the list: everything that has a place in it
  bool stop_at_failure = false;  // what comes after the first one is not run, nor reported
  bool checks = true;
  uint32_t rollback = 5;  // frames that the check of rollback goes back; 0: it is left out
  std::vector<std::string> sections;  // of the checks, by name; empty: all
  bool every_executor = false;  // in the checks; otherwise the first one and, in rotation, another
  // Instead of FurScene's: how tests plant a digest that leaves something out.
  std::function<uint64_t(const FurScene&, Stream)> digest_stream;
};

VerifyReport Verify(const Scenario& scenario, const VerifyOptions& options);

// Scenes drawn from `seed` and the seeds after it, a check each: the same bits on every instruction set, executors and
// orders in rotation, with all skips and with what may stand between two frames (course_check.cpp).
VerifyReport VerifyRandom(uint32_t count, uint64_t seed, const VerifyOptions& options);

// Every case of the full matrix for instruction sets this processor has.
std::vector<VerifyCase> AllCases();

// Tables, what failed, and one verdict line.
ReportTree MakeVerifyTree(const VerifyReport& report, const Fingerprint& fingerprint = {});
std::string DescribeReport(const VerifyReport& report);
// Shards of equal fingerprints can be merged: MergeShards.
std::string ReportAsJson(const VerifyReport& report, const Fingerprint& fingerprint = {});

}  // namespace pelt
