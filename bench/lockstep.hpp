// Two runs of a scene side by side, to find where they part.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/verify.hpp"
#include "jobs/frame.hpp"

namespace pelt {

SceneOptions SceneOptionsOf(const VerifyCase& what);
// Threads it is to run on: `what.workers`, for 0 one for each core; 1 for executors without
// workers.
uint32_t WorkersOf(const VerifyCase& what);
std::unique_ptr<Executor> MakeExecutor(const VerifyCase& what);
// Threads of an executor with workers that ran together, found by a rendezvous; 1 for others.
uint32_t ObservedWorkers(Executor& executor);
// What an executor found wrong while it ran, a line each: local-store faults, a door misused.
std::vector<std::string> FaultsOf(const Executor& executor);

struct FrameSettings {
  SkipSettings skip;
  LodSettings lod;
};
// With LOD, a budget of half the scenario's strands.
FrameSettings FrameSettingsOf(Settings settings, const Scenario& scenario);

// A scenario under one case: its scene, plan and executor.
class CaseRun {
 public:
  CaseRun(Scenario& scenario, const VerifyCase& what, const FrameSettings& settings,
          const std::function<void(const VerifyCase&, Plan&)>& tamper);

  void RunFrame(uint32_t frame);
  FurScene& scene() { return running_.scene(); }
  const Plan& plan() const { return plan_; }
  Executor& executor() { return *executor_; }

 private:
  RunningScenario running_;
  Plan plan_;
  std::unique_ptr<Executor> executor_;
  FrameSettings settings_;
};

// The first difference after a frame, going through the table's stages in order. Streams that only
// one of the vertex orders fills are left out when the orders differ.
std::optional<Mismatch> FindMismatch(CaseRun& expected, CaseRun& found, uint32_t frame);

}  // namespace pelt
