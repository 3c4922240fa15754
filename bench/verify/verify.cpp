#include "bench/verify/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

#include "bench/verify/checks.hpp"
#include "bench/verify/frame_digests.hpp"
#include "bench/verify/lockstep.hpp"
#include "bench/verify/verified_scene.hpp"
#include "core/kernels/frame_table.hpp"
#include "traces/digest.hpp"

namespace pelt {
namespace {

constexpr uint32_t kWorkerCounts[] = {1, 2, 3, 7, 16};
constexpr Settings kAllSettings[] = {Settings::kSkips, Settings::kNoSkips, Settings::kLod};
constexpr uint64_t kOrderSeeds[] = {0, 1, 2};
// Locating a difference runs two courses again: of a broken build a few places say enough.
constexpr uint32_t kMostLocated = 12;

Course RecordCourse(Scenario& scenario, const VerifyCase& what, uint32_t frames) {
  CaseRun run(scenario, what, FrameSettingsOf(what.settings, scenario), {});
  Course course;
  for (uint32_t f = 0; f < frames; ++f) {
    run.RunFrame(f);
    course.push_back(DigestsOf(run.scene()));
  }
  return course;
}

VerifyCase ReferenceFor(const VerifyCase& what) {
  VerifyCase reference;
  reference.vertex_order = what.vertex_order;
  reference.settings = what.settings;
  return reference;
}

// The two vertex orders must agree on all but the vertices themselves.
CaseResult CompareVertexOrders(Settings settings, const auto& reference_for) {
  const VerifyCase sorted{.settings = settings};
  CaseResult result;
  result.what = {.vertex_order = VertexOrder::kIndexBuffer, .settings = settings};
  const Course &expected = reference_for(sorted), &found = reference_for(result.what);
  for (uint32_t f = 0; f < expected.size() && result.passed; ++f)
    if (!SameDigests(expected[f], found[f], {.vertices = false}))
      result.Fail({FindingKind::kValue, "", "",
                   fmt::format("frame {}: the vertex orders differ before the vertices", f)});
  return result;
}

void CheckWorkers(CaseRun& run, CaseResult& result) {
  if (!result.what.executor->HasWorkers()) return;
  result.workers_observed = run.executor().ObservedWorkers();
  if (result.workers_observed == result.what.workers) return;
  result.Fail({FindingKind::kWorkers, "", "",
               fmt::format("{} workers ran together, not {}", result.workers_observed,
                           result.what.workers)});
}

void CheckFindings(CaseRun& run, CaseResult& result) {
  const std::vector<Finding> findings = run.executor().Findings();
  if (findings.empty()) return;
  Finding first = findings.front();
  if (findings.size() > 1) first.text += fmt::format(" (and {} more)", findings.size() - 1);
  result.Fail(first);
}

// What the case alone may be the reason for.
FindingKind FindingKindOf(const VerifyCase& what, const Mismatch& mismatch) {
  if (!mismatch.reproduced) return FindingKind::kRace;
  if (what.odd_floats) return FindingKind::kFloats;
  return what.executor->order == ItemOrder::kAscending ? FindingKind::kValue : FindingKind::kOrder;
}

CaseResult RunCase(Scenario& scenario, const VerifyCase& what, const Course& reference,
                   const VerifyOptions& options, uint32_t& located) {
  CaseResult result;
  result.what = what;
  const FrameSettings settings = FrameSettingsOf(what.settings, scenario);
  uint32_t frame = 0;
  {
    CaseRun run(scenario, what, settings, options.tamper);
    CheckWorkers(run, result);
    for (; frame < options.frames; ++frame) {
      run.RunFrame(frame);
      if (!SameDigests(reference[frame], DigestsOf(run.scene()), {})) break;
    }
    CheckFindings(run, result);
  }
  if (frame == options.frames) return result;
  if (located++ >= kMostLocated) {
    result.Fail({FindingKind::kValue, "", "",
                 fmt::format("frame {} differs; earlier cases say where", frame)});
    return result;
  }
  const Mismatch mismatch = Locate(CaseRun(scenario, ReferenceFor(what), settings, {}),
                                   CaseRun(scenario, what, settings, options.tamper), frame, true);
  // What a stage takes from where it may not shows as a wrong value somewhere: ask the guard.
  if (const auto cause = FindUndeclared(scenario, what, options, frame)) result.Fail(*cause);
  result.Fail(FindingKindOf(what, mismatch), mismatch);
  return result;
}

// Each stage alone, so fusion is nothing to it: every setting, order and sort once.
void AddStagesAlone(const ExecutorEntry& entry, Isa isa, std::vector<VerifyCase>& cases) {
  VerifyCase c{.executor = entry, .isa = isa};
  cases.push_back(c);
  c.settings = Settings::kLod;
  c.vertex_order = VertexOrder::kIndexBuffer;
  c.piecewise_sort = true;
  cases.push_back(c);
  c.settings = Settings::kNoSkips;
  c.vertex_order = VertexOrder::kSorted;
  cases.push_back(c);
}

// An executor with all its numbers of workers, or all its orders.
void AddVariants(const ExecutorEntry& entry, std::vector<VerifyCase>& cases) {
  switch (entry.order) {
    case ItemOrder::kAscending:
      cases.push_back({.executor = entry});
      break;
    case ItemOrder::kSeeded:
      for (const uint64_t seed : kOrderSeeds)
        cases.push_back({.executor = entry, .order_seed = seed});
      break;
    case ItemOrder::kThreads:
      for (const uint32_t n : kWorkerCounts) cases.push_back({.executor = entry, .workers = n});
  }
}

}  // namespace

bool TakesNext(const VerifyOptions& options, VerifyReport& report) {
  report.stopped = options.stop_at_failure && !report.Passed();
  return report.shard.Takes(report.places++) && !report.stopped;
}

void Outcome::Fail(Finding finding) {
  passed = false;
  if (kind == FindingKind::kNone) {
    kind = finding.kind;
    stage = finding.stage;
    stream = finding.stream;
  }
  reason += (reason.empty() ? "" : "; ") + finding.text;
}

void Outcome::Fail(FindingKind why, const Mismatch& where) {
  if (!mismatch) mismatch = where;
  Fail({why, where.stage, where.stream, DescribeMismatch(where)});
}

void Outcome::LeaveOut(std::string why) {
  compared = false;
  reason = std::move(why);
}

void Outcome::Miss(std::string why) {
  LeaveOut(std::move(why));
  missing = true;
}

std::vector<VerifyCase> AllCases() {
  std::vector<VerifyCase> executors;
  for (const ExecutorEntry& entry : ExecutorEntries())
    if (!entry.stages_alone && entry.IsAvailable()) AddVariants(entry, executors);

  std::vector<VerifyCase> cases;
  for (const Isa isa : kAllIsas) {
    if (!FindKernels(isa)) continue;
    for (const Settings settings : kAllSettings)
      for (const VertexOrder order : {VertexOrder::kSorted, VertexOrder::kIndexBuffer})
        for (const bool pieces : {false, true})
          for (const bool fuse : {true, false})
            for (VerifyCase c : executors) {
              c.isa = isa;
              c.settings = settings;
              c.vertex_order = order;
              c.piecewise_sort = pieces;
              c.fuse = fuse;
              cases.push_back(c);
            }
    for (const ExecutorEntry& entry : ExecutorEntries())
      if (entry.stages_alone && entry.IsAvailable()) AddStagesAlone(entry, isa, cases);
    for (const ExecutorEntry& entry : ExecutorEntries())
      if (!entry.stages_alone && entry.IsAvailable())
        cases.push_back({.executor = entry,
                         .workers = entry.HasWorkers() ? 2u : 1u,
                         .isa = isa,
                         .odd_floats = true});
  }
  return cases;
}

VerifyReport Verify(const Scenario& scenario, const VerifyOptions& options) {
  Scenario verified = MakeVerifiedScene(scenario);
  VerifyReport report;
  report.scene = verified.name;
  report.frames = options.frames;
  report.shard = options.shard;
  report.strands = verified.StrandCount();
  report.characters = uint32_t(verified.actors.size());
  for (const Isa isa : kAllIsas)
    if (!FindKernels(isa))
      report.not_run.push_back(fmt::format("instruction set {}", IsaName(isa)));
  for (const ExecutorEntry& entry : ExecutorEntries())
    if (!entry.IsAvailable()) report.not_run.push_back(fmt::format("executor {}", entry.name));

  if (!HasRoomForEverything(scenario))
    report.not_run.push_back("the character of `everything`: the scene is of another size");

  std::vector<VerifyCase> cases = AllCases();
  if (options.filter) std::erase_if(cases, [&](const VerifyCase& c) { return !options.filter(c); });

  // References, made when a case first asks.
  std::map<std::pair<Settings, VertexOrder>, Course> references;
  const auto reference_for = [&](const VerifyCase& what) -> const Course& {
    auto [at, fresh] = references.try_emplace({what.settings, what.vertex_order});
    if (fresh) at->second = RecordCourse(verified, ReferenceFor(what), options.frames);
    return at->second;
  };
  Digest fold;
  for (const StreamDigests& frame : reference_for({}))
    for (uint32_t s = 0; s < kStreamCount; ++s)
      if (DescribeStream(Stream(s)).role == Role::kValue) fold.Add64(frame[s]);
  report.digest = fold.Value();
  const auto add = [&report](CaseResult result) {
    result.place = report.places - 1;
    report.cases.push_back(std::move(result));
  };
  for (const Settings settings : kAllSettings)
    if (TakesNext(options, report)) add(CompareVertexOrders(settings, reference_for));

  uint32_t done = 0, located = 0;
  for (const VerifyCase& what : cases) {
    if (options.progress) options.progress(done++, uint32_t(cases.size()), NameCase(what));
    if (TakesNext(options, report))
      add(RunCase(verified, what, reference_for(what), options, located));
  }
  if (options.skips) VerifySkips(verified, options, report);
  if (options.checks) RunChecks(verified, options, report);
  return report;
}

std::vector<std::string> VerifyReport::Missing() const {
  std::vector<std::string> all;
  for (const CheckResult& c : checks)
    if (c.missing) all.push_back(fmt::format("{}, {}: {}", c.section, c.name, c.reason));
  return all;
}

bool VerifyReport::Passed() const {
  const auto passed = [](const Outcome& o) { return o.passed; };
  return std::all_of(cases.begin(), cases.end(), passed) &&
         std::all_of(skips.begin(), skips.end(), passed) &&
         std::all_of(checks.begin(), checks.end(), passed);
}

}  // namespace pelt
