// A scene's frame budget on a console: the scenario run on the console's model, compared with a
// target.
//
//   host, some frames in   one frame with every skip off, recorded    -> what each stage costs
//   the console's model    every frame executed while it is timed     -> milliseconds and bytes
//   host, beside it        the same frames, serial, on its best kernels -> the digests that must be
//                                                                        the console's
//
// Invariant: digests are compared in every kDigestEvery-th frame and in the last: state carries
// over from frame to frame, so a difference in between would show there.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/report/budget.hpp"
#include "bench/scenarios/scenarios.hpp"
#include "platform_sim/frame/console_frame.hpp"
#include "platform_sim/frame/console_machine.hpp"
#include "platform_sim/frame/modelled_frame.hpp"
#include "platform_sim/gpu/draw_bound.hpp"
#include "platform_sim/platforms/platform.hpp"
#include "platform_sim/pricing/kernel_cost.hpp"

namespace pelt {

enum class Console : uint8_t { kPs3, kXbox360 };
inline constexpr Console kAllConsoles[] = {Console::kPs3, Console::kXbox360};
std::string_view ConsoleName(Console console);  // "ps3", "xbox360"

inline constexpr uint32_t kDigestEvery = 10;

struct ConsoleRequest {
  Console console = Console::kPs3;
  PlatformParameters numbers = {};
  uint32_t frames = 0;   // 0: the scenario's own
  uint32_t warm_up = 0;  // frames before them, which no figure counts
  SceneOptions scene = {};
  SkipSettings skip = {};
  LodSettings lod = {};
  std::function<void(uint32_t done, uint32_t total)> progress = {};
  // Of the console with these numbers; shared by requests that price much the same.
  std::shared_ptr<KnownPrices> known = std::make_shared<KnownPrices>();
};

struct ConsoleBudget {
  std::string scene;
  uint32_t layers = 0, characters = 0;
  uint64_t strands = 0;
  uint32_t live_strands = 0, drawn_strands = 0;  // of the last frame
  ConsoleMachine machine;
  GpuParameters gpu;
  std::vector<DrawPass> draws;  // of the last frame
  StageCosts costs;
  FrameSummary summary;
  // The same frames, were all code as well scheduled as can be, or left in the order it is written
  // in: the ends of the range that summary lies in (ConsoleMachine::code_order).
  Spread scheduled_ms, as_written_ms;
  uint32_t warm_up = 0;
  std::vector<PassStore> stores;  // [pass]; empty on caches
  ModelledFrame slowest;          // summary.worst_frame, with timelines
  uint32_t digests_compared = 0;
  std::optional<uint32_t> differs_at;  // the first frame whose digest is not the host's
  uint64_t digest = 0;                 // of the last frame
  std::vector<std::string> faults;     // of the local stores

  // What the verdict is about: the 95th percentile, with the console's availability.
  double VerdictMs() const { return machine.Available(summary.p95_ms); }
  bool Fits(double target_ms) const { return VerdictMs() <= target_ms; }
  // Whether the verdict hangs on how well code is scheduled.
  bool FitsOnlyAtOneEnd(double target_ms) const {
    return (machine.Available(scheduled_ms.p95) <= target_ms) !=
           (machine.Available(as_written_ms.p95) <= target_ms);
  }
};

// The machine of a request, checked, its code as well scheduled as a compiler's were in the
// mean (kernel_rows.hpp). Throws Error for one that cannot be.
ConsoleMachine MakeConsole(const ConsoleRequest& request);

// What every stage of a scenario costs on a console, and how its scene is made there. Whether the console
// has room for it is not asked.
struct PricedScene {
  SceneOptions options;
  StageCosts costs;
};
PricedScene PriceScene(Scenario& scenario, const ConsoleRequest& request);

// A scenario on a console, its stages priced.
class ConsoleRun {
 public:
  // The scenario must outlive this. Throws Error when the console cannot be, or the scene does not fit
  // its local stores beside its code.
  ConsoleRun(Scenario& scenario, const ConsoleRequest& request);
  ConsoleRun(const ConsoleRun&) = delete;
  ConsoleRun& operator=(const ConsoleRun&) = delete;

  // Runs the request's frames from the first. Throws Error when a frame refuses its input.
  ConsoleBudget Run();
  // With LOD, timed only: the worst of a few frames, which is quick, or what Run's verdict would
  // be about.
  enum class Trial : uint8_t { kFewFrames, kAllFrames };
  struct LodTrial {
    double ms = 0.0;  // as a verdict takes it
    uint32_t live_strands = 0;
  };
  LodTrial TryLod(const LodSettings& lod, Trial trial);

  // What Run's verdict would be about; timed only.
  double TimeVerdictMs() const;

  const ConsoleRequest& request() const { return request_; }
  // Planned for the console; as the last Run left it.
  const FurScene& scene() const { return running_->scene(); }
  const PlanOptions& plan_options() const { return options_.plan; }
  const StageCosts& costs() const { return costs_; }

 private:
  void ChargeCode(const Plan& priced);
  std::unique_ptr<ConsoleExecutor> MakeExecutor(const FurScene& scene) const;
  // All frames of the request, timed only.
  FrameSummary Time(const SkipSettings& skip, const LodSettings& lod, uint32_t warm_up,
                    uint32_t frames, uint32_t* live_strands) const;

  Scenario& scenario_;
  ConsoleRequest request_;
  SceneOptions options_;
  ConsoleMachine machine_;
  StageCosts costs_;
  std::unique_ptr<RunningScenario> running_;
};

// What would make a scene fit a console's milliseconds: fewer strands, other chunks, or what binds
// where none of it helps.
//
// Invariant: a figure of strands is the 95th percentile of a run of the model with them, over the
// frames of the budget: asking for the same run gives the same figure.

// A line each; none when it fits.
std::vector<std::string> Advise(ConsoleRun& run, const ConsoleBudget& budget, double target_ms);

}  // namespace pelt
