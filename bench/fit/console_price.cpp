#include "bench/fit/console_price.hpp"

#include <cmath>

#include "bench/fit/layer_work.hpp"

namespace pelt {
namespace {

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

FitPlatform OnConsole(const ConsoleRequest& request) {
  return {.name = std::string(ConsoleName(request.console)),
          .price =
              [request](Scenario& scenario) {
                ConsoleRun run(scenario, request);
                SceneOptions options = request.scene;
                options.plan = run.plan_options();
                PlatformCost cost = PriceLayers(scenario, request, {options, run.costs()});
                cost.frame_ns = uint64_t(std::ceil(run.TryWhatIf(request.what_if) * 1e6));
                return cost;
              },
          .price_layers =
              [request](Scenario& scenario) {
                return PriceLayers(scenario, request, PriceScene(scenario, request));
              }};
}

}  // namespace pelt
