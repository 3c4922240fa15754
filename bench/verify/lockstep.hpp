// Two runs of a scene side by side, to find where they part.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/verify/verify.hpp"
#include "jobs/frame.hpp"

namespace pelt {

SceneOptions SceneOptionsOf(const VerifyCase& what);
// Threads it is to run on: `what.workers`, for 0 one for each core; 1 for executors without
// workers.
uint32_t WorkersOf(const VerifyCase& what);
std::unique_ptr<WatchedExecutor> MakeExecutor(const VerifyCase& what);

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

  // `change` is given the frame's input, with the poses in the scene, before the frame begins.
  // Throws Error when the frame refuses its input.
  using Change = std::function<void(FrameInput&, FurScene&)>;
  void RunFrame(uint32_t frame, const Change& change = {});
  // False when the frame refuses its input; nothing was run.
  bool TryRunFrame(uint32_t frame, const Change& change);
  // As FurScene::ReplaceGrooms does.
  bool GoOnWith(Scenario& scenario) { return running_.GoOnWith(scenario); }
  void set_skip(const SkipSettings& skip) { settings_.skip = skip; }
  FurScene& scene() { return running_.scene(); }
  const Plan& plan() const { return plan_; }
  Plan& tampered_plan() { return plan_; }  // to plant faults in
  WatchedExecutor& executor() { return *executor_; }

 private:
  bool odd_floats_;
  RunningScenario running_;
  Plan plan_;
  std::unique_ptr<WatchedExecutor> executor_;
  FrameSettings settings_;
};

// All skips off but LOD's, which changes the picture, as `lod` says.
SkipSettings NoSkips(bool lod = false);

// The first difference after a frame, going through the table's stages in order: of values, then,
// when `bookkeeping` is set, of the bookkeeping of what ran.
std::optional<Mismatch> FindMismatch(CaseRun& expected, CaseRun& found, uint32_t frame,
                                     bool bookkeeping = false);

}  // namespace pelt
