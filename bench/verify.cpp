#include "bench/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>
#include <utility>

#include "bench/lockstep.hpp"
#include "core/error.hpp"
#include "traces/digest.hpp"

namespace pelt {
namespace {

// Whether the next place of the list is this shard's, and still to be run.
bool TakesNext(const VerifyOptions& options, VerifyReport& report) {
  report.stopped = options.stop_at_failure && !report.Passed();
  return report.shard.Takes(report.places++) && !report.stopped;
}

constexpr uint32_t kWorkerCounts[] = {1, 2, 3, 7, 16};
constexpr Settings kAllSettings[] = {Settings::kSkips, Settings::kNoSkips, Settings::kLod};
constexpr uint64_t kOrderSeeds[] = {0, 1, 2};

using StreamDigests = std::array<uint64_t, kStreamCount>;

StreamDigests DigestsOf(const FurScene& scene) {
  StreamDigests digests{};
  for (uint32_t s = 0; s < kStreamCount; ++s) digests[s] = scene.DigestStream(Stream(s));
  return digests;
}

// Streams whose layout depends on the vertex order.
bool IsVertexStream(uint32_t s) {
  return Stream(s) == Stream::kInstances || Stream(s) == Stream::kRibbonVertices;
}

bool SameDigests(const StreamDigests& a, const StreamDigests& b, bool with_vertices) {
  for (uint32_t s = 0; s < kStreamCount; ++s)
    if (a[s] != b[s] && (with_vertices || !IsVertexStream(s))) return false;
  return true;
}

using Course = std::vector<StreamDigests>;  // by frame

Course RecordCourse(Scenario& scenario, const VerifyCase& what, uint32_t frames) {
  CaseRun run(scenario, what, FrameSettingsOf(what.settings, scenario), {});
  Course course;
  for (uint32_t f = 0; f < frames; ++f) {
    run.RunFrame(f);
    course.push_back(DigestsOf(run.scene()));
  }
  return course;
}

// Runs both again, frame by frame together, until they part.
Mismatch Locate(CaseRun expected, CaseRun found, uint32_t frame) {
  for (uint32_t f = 0; f <= frame; ++f) {
    expected.RunFrame(f);
    found.RunFrame(f);
    if (auto mismatch = FindMismatch(expected, found, f)) return *mismatch;
  }
  Mismatch unknown;
  unknown.frame = frame;
  unknown.reproduced = false;
  return unknown;
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
    if (!SameDigests(expected[f], found[f], false)) {
      result.passed = false;
      result.reason = fmt::format("frame {}: the vertex orders differ before the vertices", f);
    }
  return result;
}

void CheckWorkers(CaseRun& run, CaseResult& result) {
  if (!HasWorkers(result.what.executor)) return;
  result.workers_observed = ObservedWorkers(run.executor());
  if (result.workers_observed == result.what.workers) return;
  result.passed = false;
  result.reason =
      fmt::format("{} workers ran together, not {}", result.workers_observed, result.what.workers);
}

void CheckFaults(CaseRun& run, CaseResult& result) {
  const std::vector<std::string> faults = FaultsOf(run.executor());
  if (faults.empty()) return;
  result.passed = false;
  result.reason = fmt::format("{} ({} faults)", faults.front(), faults.size());
}

CaseResult RunCase(Scenario& scenario, const VerifyCase& what, const Course& reference,
                   const VerifyOptions& options) {
  CaseResult result;
  result.what = what;
  const FrameSettings settings = FrameSettingsOf(what.settings, scenario);
  uint32_t frame = 0;
  {
    CaseRun run(scenario, what, settings, options.tamper);
    CheckWorkers(run, result);
    for (; frame < options.frames; ++frame) {
      run.RunFrame(frame);
      if (!SameDigests(reference[frame], DigestsOf(run.scene()), true)) break;
    }
    CheckFaults(run, result);
  }
  if (frame == options.frames) return result;
  result.passed = false;
  result.mismatch = Locate(CaseRun(scenario, ReferenceFor(what), settings, {}),
                           CaseRun(scenario, what, settings, options.tamper), frame);
  const std::string difference = DescribeMismatch(*result.mismatch);
  result.reason = result.reason.empty() ? difference : result.reason + "; " + difference;
  return result;
}

// ---- Skips
// --------------------------------------------------------------------------------------

struct SwitchDesc {
  std::string_view name;
  bool SkipSettings::*member;
};
constexpr SwitchDesc kSwitches[] = {{"sleep", &SkipSettings::sleep},
                                    {"unmoved", &SkipSettings::unmoved},
                                    {"sort", &SkipSettings::sort},
                                    {"wind", &SkipSettings::wind},
                                    {"cull", &SkipSettings::cull}};

// Stage items that run in the frame just run: what skipping saves.
uint64_t CountWork(CaseRun& run) {
  const FurScene& scene = run.scene();
  uint64_t work = 0;
  for (const Stage& stage : run.plan().stages)
    for (uint32_t i = 0; i < scene.shape().ItemCount(stage.domain); ++i)
      work += IsWanted(stage, scene.memory(), i);
  return work;
}

// Most chains lie still, bit for bit, this many frames after everything around them does.
constexpr uint32_t kSettleFrames = 240;

struct SkipCourse {
  Course digests;
  uint64_t work = 0;
  std::string hidden;  // the first layer that left the view, and when; empty: none did
};

SkipCourse RecordSkips(Scenario& scenario, const VerifyCase& what, const SkipSettings& skip,
                       uint32_t frames) {
  CaseRun run(scenario, what, FrameSettings{skip, {}}, {});
  SkipCourse course;
  for (uint32_t f = 0; f < frames; ++f) {
    run.RunFrame(f);
    const FurScene& scene = run.scene();
    course.digests.push_back(DigestsOf(scene));
    course.work += CountWork(run);
    for (uint32_t l = 0; l < scene.shape().layer_count && course.hidden.empty(); ++l)
      if (!scene.memory().As<LodBlock>(Stream::kLod, l)->visible)
        course.hidden = fmt::format("layer '{}' is out of view in frame {}", scene.LayerName(l), f);
  }
  return course;
}

SkipResult CompareSkip(Scenario& scenario, const VerifyCase& what, const SkipCourse& base,
                       const SwitchDesc* off, const std::string& course, uint32_t frames) {
  SkipResult result;
  result.name = off ? off->name : "all of them";
  result.course = course;
  if ((!off || off->name == "cull") && !base.hidden.empty()) {
    result.compared = false;
    result.reason = "not compared: " + base.hidden + ", and culling stops its simulation";
    return result;
  }
  SkipSettings skip;
  for (const SwitchDesc& s : kSwitches)
    if (!off || off == &s) skip.*s.member = false;
  const SkipCourse without = RecordSkips(scenario, what, skip, frames);
  result.items_skipped = without.work > base.work ? without.work - base.work : 0;
  for (uint32_t f = 0; f < frames; ++f) {
    if (SameDigests(base.digests[f], without.digests[f], true)) continue;
    result.passed = false;
    result.mismatch = Locate(CaseRun(scenario, what, FrameSettings{skip, {}}, {}),
                             CaseRun(scenario, what, {}, {}), f);
    result.reason = DescribeMismatch(*result.mismatch);
    break;
  }
  return result;
}

void VerifySkips(Scenario& scenario, const VerifyOptions& options, VerifyReport& report) {
  VerifyCase what;
  what.isa = BestIsa();
  const uint32_t rest_before = scenario.rest_from_frame;
  const auto compare = [&](const SwitchDesc* off, std::optional<SkipCourse>& base,
                           const std::string& course, uint32_t frames) {
    if (!TakesNext(options, report)) return;
    if (!base) base = RecordSkips(scenario, what, SkipSettings{}, frames);
    report.skips.push_back(CompareSkip(scenario, what, *base, off, course, frames));
    report.skips.back().place = report.places - 1;
  };
  for (const bool at_rest : {false, true}) {
    const std::string course = at_rest ? "coming to rest" : "as it runs";
    // A scene that stands still from a third of the way on is where skips have something to do.
    if (at_rest) scenario.rest_from_frame = options.frames / 3;
    const uint32_t frames = options.frames + (at_rest ? kSettleFrames : 0);
    std::optional<SkipCourse> base;  // made when the shard first needs it
    for (const SwitchDesc& s : kSwitches) compare(&s, base, course, frames);
    compare(nullptr, base, course, frames);
  }
  scenario.rest_from_frame = rest_before;
}

}  // namespace

std::vector<VerifyCase> AllCases() {
  std::vector<VerifyCase> executors;
  executors.push_back({});
  for (const ExecutorKind kind : {ExecutorKind::kTbb, ExecutorKind::kDoor, ExecutorKind::kPull})
    for (const uint32_t n : kWorkerCounts) executors.push_back({.executor = kind, .workers = n});
  for (const uint64_t seed : kOrderSeeds)
    executors.push_back({.executor = ExecutorKind::kPermuted, .order_seed = seed});
  executors.push_back({.executor = ExecutorKind::kLocalStore});

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
  }
  return cases;
}

VerifyReport Verify(Scenario& scenario, const VerifyOptions& options) {
  VerifyReport report;
  report.scene = scenario.name;
  report.frames = options.frames;
  report.shard = options.shard;
  report.strands = scenario.StrandCount();
  for (const Isa isa : kAllIsas)
    if (!FindKernels(isa)) report.not_run.emplace_back(IsaName(isa));

  std::vector<VerifyCase> cases = AllCases();
  if (options.filter) std::erase_if(cases, [&](const VerifyCase& c) { return !options.filter(c); });

  // References, made when a case first asks.
  std::map<std::pair<Settings, VertexOrder>, Course> references;
  const auto reference_for = [&](const VerifyCase& what) -> const Course& {
    auto [at, fresh] = references.try_emplace({what.settings, what.vertex_order});
    if (fresh) at->second = RecordCourse(scenario, ReferenceFor(what), options.frames);
    return at->second;
  };
  Digest fold;
  for (const StreamDigests& frame : reference_for({}))
    for (const uint64_t digest : frame) fold.Add64(digest);
  report.digest = fold.Value();
  const auto add = [&report](CaseResult result) {
    result.place = report.places - 1;
    report.cases.push_back(std::move(result));
  };
  for (const Settings settings : kAllSettings)
    if (TakesNext(options, report)) add(CompareVertexOrders(settings, reference_for));

  uint32_t done = 0;
  for (const VerifyCase& what : cases) {
    if (options.progress) options.progress(done++, uint32_t(cases.size()), NameCase(what));
    if (TakesNext(options, report)) add(RunCase(scenario, what, reference_for(what), options));
  }
  if (options.skips) VerifySkips(scenario, options, report);
  return report;
}

bool VerifyReport::Passed() const {
  return std::all_of(cases.begin(), cases.end(), [](const CaseResult& c) { return c.passed; }) &&
         std::all_of(skips.begin(), skips.end(), [](const SkipResult& s) { return s.passed; });
}

}  // namespace pelt
