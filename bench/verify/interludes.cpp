#include "bench/verify/interludes.hpp"

#include "bench/verify/checks.hpp"

namespace pelt {
namespace {

// What the scene is told in it is that of another frame, so that what is taken from it shows.
constexpr uint32_t kElsewhere = 7;
constexpr std::string_view kNames[] = {"a refused frame", "a pause", "the same grooms again",
                                       "another scene goes on"};
static_assert(std::size(kNames) == kInterludes);

std::optional<Finding> MoveOn(CaseTurn& turn, Scenario& scenario, const FrameSettings& settings,
                              const VerifyOptions& options) {
  auto next = std::make_unique<CaseRun>(scenario, turn.what, settings, options.tamper);
  if (!next->scene().CopyStateFrom(turn.run->scene()))
    return Finding{FindingKind::kExecutor, "", "", "a scene of the same case refuses its state"};
  turn.run = std::move(next);
  return {};
}

}  // namespace

std::string_view InterludeName(Interlude what) { return kNames[size_t(what)]; }

std::optional<Finding> Interrupt(CaseTurn& turn, Interlude interlude, Scenario& scenario,
                                 const FrameSettings& settings, uint32_t frame,
                                 const VerifyOptions& options) {
  CaseRun& run = *turn.run;
  const auto with_step = [&](double dt_s) {
    return run.TryRunFrame(frame + kElsewhere,
                           [dt_s](FrameInput& input, FurScene&) { input.dt_s = dt_s; });
  };
  switch (interlude) {
    case Interlude::kRefused:
      if (!with_step(-1.0)) return {};
      return Finding{FindingKind::kExecutor, "", "", "a frame of negative time is run"};
    case Interlude::kPause:
      // A first frame of no time is a frame; and what is culled keeps the keys of the last eye that saw it.
      if (frame > 0 && !settings.skip.cull) with_step(0.0);
      return {};
    case Interlude::kReplaced:
      if (run.scene().ReplaceGrooms(scenario.ActorGrooms())) return {};
      return Finding{FindingKind::kExecutor, "", "", "the same grooms are refused"};
    case Interlude::kMoved:
      return MoveOn(turn, scenario, settings, options);
  }
  return {};
}

}  // namespace pelt
