// What a stage may touch, where it is hardest to see: at rest.
//
// While everything moves, a stage that reads what it declares Out often cannot tell: it would have
// found a difference in any case. At rest, with nothing skipped, what it finds there is this
// frame's own result, so that poison there and the last frame's bytes lead to different answers.
//
// And with LOD, where the last lanes that are worked on do not live: that what they read is
// written.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <utility>

#include "bench/verify/checks.hpp"
#include "bench/verify/frame_digests.hpp"
#include "jobs/verify/guarded_executor.hpp"

namespace pelt {
namespace {

constexpr uint32_t kFrames = 7;  // each of the guard's patterns once

// A vertex of a lane that a vector kernel works on and that was not skinned; empty: there is none.
std::string FindUnskinnedVertex(const FurScene& scene) {
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c) {
    const auto& state = *scene.memory().Of<&Streams::chunk_state>(c);
    const auto& strands = *scene.memory().Of<&Streams::strands>(c);
    const uint32_t groups = RoundUpToLaneGroups(state.live_strands) / kLaneGroup;
    for (uint32_t lane = 0; lane < std::min(groups * kLaneGroup, strands.strand_count); ++lane)
      for (const auto& corner : strands.vertex) {
        const VertexPlace vertex = FindVertex(scene.memory(), c, corner[lane]);
        const uint32_t skinned =
            scene.memory().Of<&Streams::patch_state>(vertex.patch)->live_vertices;
        if (vertex.lane >= skinned)
          return fmt::format(
              "{} strands of chunk {} live, and vertex {} of patch {}, which lane {} in their last "
              "lane group uses, is not among the {} skinned ones",
              state.live_strands, c, vertex.lane, vertex.patch, lane, skinned);
      }
  }
  return {};
}

// Lanes are worked on in groups, so what the last group's lanes read has to be written although
// not all of them live. No page is between a skinned vertex and one that was not: counted here.
void CheckLaneGroups(Scenario& scenario, const VerifyOptions& options, VerifyReport& report) {
  CheckResult result;
  result.section = "access";
  result.name = "vertices of whole lane groups";
  FrameSettings settings = FrameSettingsOf(Settings::kLod, scenario);
  const uint32_t budget = settings.lod.strand_budget;
  CaseRun run(scenario, {.isa = BestIsa()}, settings, options.tamper);
  for (uint32_t f = 0; f < kFrames && result.passed; ++f) {
    run.RunFrame(f, [&](FrameInput& in, FurScene&) {
      in.lod.hysteresis = 0.0f;
      in.lod.strand_budget = std::max(1u, budget / (f + 1));
    });
    ++result.seen;
    if (const std::string text = FindUnskinnedVertex(run.scene()); !text.empty())
      result.Fail(
          {FindingKind::kReadsOut, "roots", "skinned", fmt::format("frame {}: {}", f, text)});
  }
  report.checks.push_back(std::move(result));
}

}  // namespace

void CheckAccessAtRest(Scenario& scenario, const VerifyOptions& options, VerifyReport& report) {
  const uint32_t rest_before = scenario.rest_from_frame;
  scenario.rest_from_frame = options.frames / 3;
  const uint32_t first = options.frames / 3 + kSettleFrames;
  VerifyCase what{.isa = BestIsa()};
  const FrameSettings never{NoSkips(), {}};
  CaseRun settled(scenario, what, never, {});
  for (uint32_t f = 0; f < first; ++f) settled.RunFrame(f);
  for (const bool sleeps : {false, true}) {
    CheckResult result;
    result.section = "access";
    result.name = sleeps ? "at rest, all skips" : "at rest, no skips";
    if (!GuardedExecutor::IsAvailable()) {
      result.LeaveOut("this system has no pages to close");
      report.checks.push_back(result);
      continue;
    }
    const FrameSettings settings = sleeps ? FrameSettings{} : never;
    what.executor = "serial";
    CaseRun reference(scenario, what, settings, {});
    reference.scene().CopyStateFrom(settled.scene());
    what.executor = "guarded";
    CaseRun guarded(scenario, what, settings, options.tamper);
    guarded.scene().CopyStateFrom(settled.scene());
    std::optional<Mismatch> mismatch;
    for (uint32_t k = 0; k < kFrames && !mismatch; ++k) {
      reference.RunFrame(first + k);
      guarded.RunFrame(first + k);
      if (!SameDigests(DigestsOf(reference.scene()), DigestsOf(guarded.scene()), {}))
        mismatch = FindMismatch(reference, guarded, first + k, true);
    }
    result.seen = guarded.executor().StagesRun();
    // What was touched first: a wrong value may be no more than what comes of it.
    for (const Finding& finding : guarded.executor().Findings()) result.Fail(finding);
    if (mismatch) result.Fail(FindingKind::kValue, *mismatch);
    report.checks.push_back(result);
  }
  scenario.rest_from_frame = rest_before;
  CheckLaneGroups(scenario, options, report);
}

}  // namespace pelt
