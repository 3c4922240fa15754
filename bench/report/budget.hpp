// The frame budget: what each stage of a frame costs, over many frames.
//
// Stage times are taken in every second frame and wall times in the others: reading the clock round
// every stage of every chunk costs a few per cent, which must not be in the frame's own figure.
//
// Invariant: nothing allocates between Begin and Finish.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "bench/report/report_tree.hpp"
#include "jobs/frame_recording.hpp"
#include "jobs/scene.hpp"

namespace pelt {

// What is reported of many values of one kind.
struct Spread {
  double median = 0.0, p95 = 0.0, worst = 0.0;
};
// Of values in any unit; 0 of none. Reorders them.
Spread SpreadOf(std::span<double> values);

// What each layer and each character costs, over many frames: of a scene of 166 layers the stages'
// times do not say which.
//
// A layer's cost is that of all its chunks, and of stages that run on the layer itself; a
// character's, that of its layers and of its pose and joints. What is left is the scene's: the order
// of its layers. The sums of a frame are those of its stages.

struct LayerCost {
  std::string name;
  uint32_t character = 0, chunks = 0;
  uint64_t strands = 0;
  Spread core_ms;
  std::vector<double> samples_ms;  // of each frame
  uint32_t dearest_stage = 0;
  double dearest_share = 0.0;
};
struct CharacterCost {
  uint32_t layers = 0;
  uint64_t strands = 0;
  Spread core_ms;
  std::vector<double> samples_ms;
  double own_ms = 0.0;  // median of pose and joints
};
struct CostSplit {
  std::vector<LayerCost> layers;
  std::vector<CharacterCost> characters;
  Spread scene_ms, all_ms;
};

class LayerCosts {
 public:
  LayerCosts(const FurScene& scene, uint32_t frames);

  // A frame in which all stages were timed: first this, then every run of a stage.
  void BeginFrame();
  void Add(uint32_t stage, uint32_t item, uint64_t ticks);
  // `layer_strands`: of each layer.
  CostSplit Summarise(double ms_per_tick, std::span<const uint32_t> layer_strands) const;

 private:
  std::vector<double> FrameSums(double ms_per_tick, const std::vector<uint32_t>& rows) const;

  const FurScene& scene_;
  // [row][frame] in ticks: layers, then characters by themselves, then the scene.
  std::vector<std::vector<uint64_t>> ticks_;
  std::vector<std::vector<uint64_t>> stage_ticks_;  // [layer][stage], of all frames
};

// Bytes the ports of `stage` move for one item, if it runs: whole blocks in and out, as a DMA
// would. Blocks shared by many items are not counted: they stay where they are.
struct PortTraffic {
  uint64_t in_bytes, out_bytes;
};
PortTraffic StageTraffic(const Stage& stage, const SceneShape& shape, uint32_t item);

struct StageBudget {
  std::string_view name;
  Domain domain;
  Spread core_ms;  // summed over all threads, per frame
  double ns_per_strand = 0.0;
  double bytes = 0.0;               // moved, per frame
  double ran = 0.0, skipped = 0.0;  // items per frame; those of other kinds are in neither
  std::vector<double> samples_ms;   // core_ms of each frame that stages were timed in
};
struct PassBudget {
  std::string stages;
  Spread wall_ms;
};
struct Budget {
  uint32_t frames = 0;
  std::vector<StageBudget> stages;
  std::vector<PassBudget> passes;
  Spread caller_ms;                // poses and parameters, on the caller's thread
  Spread wall_ms;                  // the whole frame: caller's part and all passes
  double ns_per_strand = 0.0;      // of the whole frame's median
  std::vector<double> samples_ms;  // wall_ms of each frame that stages were not timed in
};

// What a frame is recorded for. Reading the clock round every stage of every chunk costs about 3 %
// of a frame, round every chunk about 1 %.
enum class Recording : uint8_t {
  kBudget,  // stage times in every second frame, nothing in the others
  kTrace,   // items in every frame, stage times in every fourth: under 2 % over all
  kAll,     // stage times in every frame
};

// Records frames of one scene.
class BudgetRecorder {
 public:
  BudgetRecorder(const FurScene& scene, uint32_t frames);

  // The profile for the frame about to run, null if this one is to run without.
  const FrameProfile* Begin(Recording recording = Recording::kBudget);
  // After the frame: what the caller's part and the whole took.
  void Finish(uint64_t caller_ns, uint64_t wall_ns);

  Budget Summarise() const;
  // Of the frames that stages were timed in; `layer_strands`: of each layer.
  CostSplit SplitCosts(std::span<const uint32_t> layer_strands) const {
    return costs_.Summarise(times_.NsPerTick() * 1e-6, layer_strands);
  }
  // Of the last profiled frame.
  double LastStageMs(uint32_t stage) const { return stage_ms_[stage].back(); }

 private:
  const FurScene& scene_;
  uint32_t frame_ = 0;
  FrameRecording times_;
  bool has_stages_ = false, has_wall_ = false;  // what the present frame counts for
  // [stage][frame], [pass][frame]
  std::vector<std::vector<double>> stage_ms_, pass_ms_;
  std::vector<double> caller_ms_, wall_ms_;
  std::vector<uint64_t> ran_, admitted_, bytes_;
  std::vector<std::vector<uint64_t>> item_bytes_;  // [stage][layer, or 0]
  LayerCosts costs_;
};

// "stages", "passes", "caller_ms", "frame_ms" and "ns_per_strand".
void AddBudget(const Budget& budget, uint32_t workers, ReportTree& tree);
// "layer_costs" and "character_costs", in JSON only: a table of 166 layers is of no use in a terminal.
void AddCostSplit(const CostSplit& costs, const Budget& budget, ReportTree& tree);
// "samples": what the medians are of, for `pelt compare`; in JSON only.
void AddSamples(const Budget& budget, const CostSplit& costs, ReportTree& tree);

}  // namespace pelt
