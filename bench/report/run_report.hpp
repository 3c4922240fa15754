// Frames run and measured: what `pelt run` and the frame benchmarks report.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/report/budget.hpp"
#include "bench/report/machine.hpp"
#include "bench/report/machine_use.hpp"
#include "bench/report/report_tree.hpp"
#include "bench/report/timeline.hpp"
#include "bench/verify/verify.hpp"
#include "jobs/scene.hpp"

namespace pelt {

// The quality that each layer's strands were simulated in, frame by frame, and how wrong that may look: the scene
// chooses it for what is seen (core/modal/modal_quality.hpp), and what a frame costs is the price of that choice.

struct LayerQuality {
  std::string name;
  uint32_t character = 0;
  std::string_view solver,
      asked;  // as in a setup; asked: quality, empty of other solvers than modal
  std::array<uint32_t, 3> frames{};  // by quality
  uint32_t chain_level = 0;          // coarsest of a frame
  float error_px = 0.0f;             // largest bound of a frame
};

// Of each layer of the scene; no frame counted.
std::vector<LayerQuality> QualitiesOf(const FurScene& scene, std::span<const Groom* const> grooms);
// After a frame.
void AddFrame(const FurScene& scene, std::vector<LayerQuality>& layers);

// "layer_quality"; in text layers that are alike are one row.
void AddLayerQuality(const std::vector<LayerQuality>& layers, ReportTree& tree);

// "memory": what every range of a scene's block takes, an object from a range's name to its bytes; and the sums.
void AddMemory(const SceneLayout& layout, ReportTree& report);

// A frame that has run, for RunOptions::observe.
struct FinishedFrame {
  uint32_t frame;
  FrameTicks ticks;
  const FrameProfile& profile;
  const FurScene& scene;
  CoreWait wait;  // of its threads, while it ran
};

struct RunOptions {
  SceneOptions scene;
  ExecutorKind executor = "tbb";
  uint32_t workers = 0;     // tbb; 0: one for each core
  uint64_t order_seed = 1;  // permuted
  uint32_t frames = 0;      // 0: the scenario's own
  uint32_t warm_up = 0;     // frames before them, which nothing sees
  SkipSettings skip;
  LodSettings lod;
  bool digest = true;  // of every frame; taken outside the timed part
  std::function<void(uint32_t done, uint32_t total)> progress;
  // Called after every frame from `observe_from_frame` on, outside the timed part. Each of these is
  // recorded, so the budget's wall times hold what recording costs.
  std::function<void(const FinishedFrame&)> observe;
  uint32_t observe_from_frame = 0;
  Recording observed_as = Recording::kTrace;
  // Called after every frame, outside the timed part; changes nothing about how frames are run.
  std::function<void(uint32_t frame, const FurScene&)> after_frame;
};

struct RunReport {
  std::string scene;
  Machine machine;
  MachineUse use;  // while frames ran
  RunOptions options;
  uint32_t workers = 1, workers_observed = 1;
  uint32_t frames = 0;
  uint64_t strands = 0;
  uint32_t characters = 0, layers = 0, chunks = 0;
  std::vector<uint32_t> layer_strands;           // of the whole scene
  uint32_t live_strands = 0, drawn_strands = 0;  // of the last frame
  Budget budget;
  CostSplit costs;
  std::vector<LayerQuality> qualities;  // of each layer
  LodBudget fur_budget;                 // of the last frame, where there is one
  SceneLayout layout;
  uint64_t digest = 0;              // of all frames, folded; 0 when not taken
  std::vector<std::string> faults;  // of the local store
};

// Throws Error when an executor records no times, for those who want to see them.
void CheckRecords(ExecutorKind executor);

// Runs the scenario from frame 0. `running` must have been made with options.scene, and has run
// nothing yet. Throws Error when a frame refuses its input.
RunReport RunFrames(Scenario& scenario, RunningScenario& running, const RunOptions& options);

ReportTree MakeRunTree(const RunReport& report);

}  // namespace pelt
