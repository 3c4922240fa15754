#include "bench/fit/console_price.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "bench/fit/layer_work.hpp"
#include "bench/fit/tiers.hpp"

namespace pelt {
namespace {

constexpr uint32_t kEstimateFrames = 12;

double CyclesOf(const StageCosts::Stage::Price& price, const StageWork& work) {
  return double(price.fixed_cycles) +
         double(price.cycles_per_iteration[work.item]) * work.iterations;
}

// Core time by layer, without moving any data.
PlatformCost PriceLayers(Scenario& scenario, const ConsoleRequest& request,
                         const PricedScene& priced) {
  const ConsoleMachine machine = MakeConsole(request);
  RunningScenario running(scenario, priced.options);
  std::vector<double> cycles(running.scene().shape().layer_count);
  double rest = 0.0;
  WalkWork(
      running, {.warm_up = request.warm_up, .count = request.frames},
      [&](const StageWork& work) {
        const StageCosts::Stage& stage = priced.costs.stages[work.stage];
        const double scheduled = CyclesOf(stage.scheduled, work),
                     as_written = CyclesOf(stage.as_written, work);
        (work.layer == kNoLayer ? rest : cycles[work.layer]) +=
            scheduled + machine.code_order * (as_written - scheduled);
      },
      [] {});
  const auto ns = [&](double all) {
    return uint64_t(all * 1e9 / (double(machine.clock_hz) * request.frames) + 0.5);
  };
  PlatformCost cost;
  for (const double of_layer : cycles) cost.layer_ns.push_back(ns(of_layer));
  cost.rest_ns = ns(rest);
  cost.live_strands = CountLiveStrands(running.scene());
  return cost;
}

}  // namespace

FurCosts FurCostsOnConsole(const Scenario& scenario, ConsoleRequest request) {
  request.lod.budget_us = 0;  // whose costs they are to be
  const ConsoleMachine machine = MakeConsole(request);
  const double ns = 1e9 / double(machine.clock_hz);
  FurCostSums sums;
  std::vector<bool> has;
  const auto fast = std::ranges::find(Tiers(), "fast", &Tier::name);
  for (Scenario way : {scenario, AtTier(scenario, *fast, has)}) {
    const PricedScene priced = PriceScene(way, request);
    sums.Add(
        way,
        [&](const FurScene&, const StageWork& work) {
          const StageCosts::Stage& stage = priced.costs.stages[work.stage];
          const auto between = [&](double scheduled, double as_written) {
            return ns * (scheduled + machine.code_order * (as_written - scheduled));
          };
          // Of a core with two threads, beside another.
          const auto each = [&](const StageCosts::Stage::Price& price) {
            return (machine.threads_per_core > 1 ? price.shared_cycles_per_iteration
                                                 : price.cycles_per_iteration)[work.item];
          };
          return StagePrice{
              between(stage.scheduled.fixed_cycles, stage.as_written.fixed_cycles),
              work.iterations * between(each(stage.scheduled), each(stage.as_written))};
        },
        priced.options);
  }
  return sums.Take();
}

FitPlatform OnConsole(const ConsoleRequest& request) {
  return {.name = std::string(ConsoleName(request.console)),
          .price =
              [request](Scenario& scenario) {
                ConsoleRun run(scenario, request);
                SceneOptions options = request.scene;
                options.plan = run.plan_options();
                PlatformCost cost = PriceLayers(scenario, request, {options, run.costs()});
                cost.frame_ns = uint64_t(std::ceil(run.TimeVerdictMs() * 1e6));
                return cost;
              },
          .price_layers =
              [request](std::span<Scenario> scenes) {
                const PricedScene priced = PriceScene(scenes[0], request);
                ConsoleRequest few = request;
                few.warm_up = std::min(few.warm_up, kEstimateFrames);
                few.frames = std::min(few.frames, kEstimateFrames);
                std::vector<PlatformCost> costs;
                for (Scenario& scene : scenes) costs.push_back(PriceLayers(scene, few, priced));
                return costs;
              }};
}

}  // namespace pelt
