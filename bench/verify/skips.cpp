// Each skip against the same course without it.
#include <fmt/format.h>

#include "bench/verify/checks.hpp"
#include "bench/verify/frame_digests.hpp"

namespace pelt {
namespace {

struct SwitchDesc {
  std::string_view name;
  bool SkipSettings::*member;
};
constexpr SwitchDesc kSwitches[] = {
    {"sleep", &SkipSettings::sleep}, {"unmoved", &SkipSettings::unmoved},
    {"sort", &SkipSettings::sort},   {"wind", &SkipSettings::wind},
    {"cull", &SkipSettings::cull},   {"light", &SkipSettings::light}};

// Stage items that run in the frame just run: what skipping saves.
uint64_t CountWork(CaseRun& run) {
  const FurScene& scene = run.scene();
  uint64_t work = 0;
  for (const Stage& stage : run.plan().stages)
    for (uint32_t i = 0; i < scene.shape().ItemCount(stage.domain); ++i)
      work += IsWanted(stage, scene.memory(), i);
  return work;
}

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
      if (!scene.memory().Of<&Streams::lod>(l)->visible)
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
    result.LeaveOut("not compared: " + base.hidden + ", and culling stops its simulation");
    return result;
  }
  SkipSettings skip;
  for (const SwitchDesc& s : kSwitches)
    if (!off || off == &s) skip.*s.member = false;
  const SkipCourse without = RecordSkips(scenario, what, skip, frames);
  result.items_skipped = without.work > base.work ? without.work - base.work : 0;
  for (uint32_t f = 0; f < frames; ++f) {
    if (SameDigests(base.digests[f], without.digests[f], {.bookkeeping = false})) continue;
    result.Fail(FindingKind::kSkip, Locate(CaseRun(scenario, what, FrameSettings{skip, {}}, {}),
                                           CaseRun(scenario, what, {}, {}), f));
    break;
  }
  return result;
}

}  // namespace

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

}  // namespace pelt
