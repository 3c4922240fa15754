// Scenes on consoles, with stage costs that a test makes up.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "bench/scenarios/scenarios.hpp"
#include "platform_sim/frame/console_frame.hpp"
#include "platform_sim/frame/console_machine.hpp"

namespace pelt::testing {

// A local store's plan, unless the console has caches.
inline SceneOptions OptionsOn(const ConsoleMachine& machine) {
  return {.plan = {.must_fit = machine.local_store_bytes > 0}};
}

// Every stage takes as many cycles per iteration, a third more on a core that is shared.
inline StageCosts FlatCosts(const Plan& plan, const SceneShape& shape, uint64_t clock_hz,
                            float cycles_per_iteration, uint32_t code_bytes = 2048) {
  StageCosts costs;
  costs.clock_hz = clock_hz;
  for (const Stage& stage : plan.stages) {
    StageCosts::Stage& cost = costs.stages.emplace_back();
    cost.name = stage.kernel.name;
    cost.code_bytes = code_bytes;
    cost.scheduled.cycles_per_iteration.assign(shape.ItemCount(stage.domain), cycles_per_iteration);
    cost.scheduled.shared_cycles_per_iteration.assign(shape.ItemCount(stage.domain),
                                                      cycles_per_iteration * 4 / 3);
    cost.as_written = cost.scheduled;
  }
  return costs;
}

// Made once a program for each number of SPUs.
inline ConsoleMachine Ps3(uint32_t spus = 6) {
  static std::map<uint32_t, ConsoleMachine> made;
  const auto at = made.find(spus);
  if (at != made.end()) return at->second;
  CellMemoryParameters p;
  p.spu_count = spus;
  return made[spus] = MakeCell(p, AtomicDispatch(150)).OrThrow();
}
inline ConsoleMachine Xbox() {
  static const ConsoleMachine made = MakeXenon(XenonParameters{}).OrThrow();
  return made;
}

// Of passes over as many items as the first has, each of which waits for all of the one before.
inline FrameGraph PassAfterPass(const FrameWork& work) {
  SceneShape shape;
  shape.AddLayer(0, 0, uint32_t(work.passes[0].items.size()));
  Plan plan;
  for (uint32_t p = 0; p < work.passes.size(); ++p) {
    plan.passes.push_back({0, 1, Domain::kChunk, {}, 0, 0, 0, false, {}});
    if (p > 0) plan.passes.back().waits = {{p - 1, Domain::kScene}};
  }
  plan.waits_of_end = {{uint32_t(work.passes.size()) - 1, Domain::kScene}};
  return BuildGraph(plan, shape);
}

struct ModelledRun {
  std::vector<ModelledFrame> frames;
  std::vector<uint64_t> digests;
  std::vector<LocalStoreFault> faults;
  FrameWork last_work;
  Plan plan;
  SceneShape shape;
};

inline ModelledRun RunOn(Scenario& scenario, const ConsoleMachine& machine, uint32_t frames,
                         float cycles_per_iteration, bool timelines = false) {
  RunningScenario running(scenario, OptionsOn(machine));
  const FurScene& scene = running.scene();
  const StageCosts costs =
      FlatCosts(scene.plan(), scene.shape(), machine.clock_hz, cycles_per_iteration);
  const auto executor = ConsoleExecutor::Make(machine, costs, scene.CurrentFrame()).OrThrow();
  executor->KeepTimelines(timelines);
  ModelledRun run;
  for (uint32_t f = 0; f < frames; ++f) {
    running.Begin(f);
    executor->Run(scene.CurrentFrame());
    run.frames.push_back(executor->modelled());
    run.digests.push_back(scene.DigestFrame());
  }
  run.faults = executor->faults();
  run.last_work = executor->work();
  run.plan = scene.plan();
  run.shape = scene.shape();
  return run;
}

}  // namespace pelt::testing
