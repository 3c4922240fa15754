// What a stage may touch, where it is hardest to see: at rest.
//
// While everything moves, a stage that reads what it declares Out often cannot tell: it would have
// found a difference in any case. At rest, with nothing skipped, what it finds there is this
// frame's own result, so that poison there and the last frame's bytes lead to different answers.
#include <fmt/format.h>

#include "bench/verify/checks.hpp"
#include "bench/verify/frame_digests.hpp"
#include "bench/verify/guarded_executor.hpp"

namespace pelt {
namespace {

constexpr uint32_t kFrames = 7;  // each of the guard's patterns once

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
    what.executor = ExecutorKind::kSerial;
    CaseRun reference(scenario, what, settings, {});
    reference.scene().CopyStateFrom(settled.scene());
    what.executor = ExecutorKind::kGuarded;
    CaseRun guarded(scenario, what, settings, options.tamper);
    guarded.scene().CopyStateFrom(settled.scene());
    std::optional<Mismatch> mismatch;
    for (uint32_t k = 0; k < kFrames && !mismatch; ++k) {
      reference.RunFrame(first + k);
      guarded.RunFrame(first + k);
      if (!SameDigests(DigestsOf(reference.scene()), DigestsOf(guarded.scene()), {}))
        mismatch = FindMismatch(reference, guarded, first + k, true);
    }
    result.seen = dynamic_cast<GuardedExecutor&>(guarded.executor()).stages_run();
    // What was touched first: a wrong value may be no more than what comes of it.
    for (const Finding& finding : FindingsOf(guarded.executor())) result.Fail(finding);
    if (mismatch) result.Fail(FindingKind::kValue, *mismatch);
    report.checks.push_back(result);
  }
  scenario.rest_from_frame = rest_before;
}

}  // namespace pelt
