// How far a frame spreads: what its graph (jobs/frame_graph.hpp) lets so many workers do at once,
// by a simulation that is the same on every machine.
//
// An item costs what its stages cost on it. Without times a stage costs the bytes that it moves; with
// those of a run it costs what it took there, by the bytes of each item. Nothing else costs: not the
// taking of an item, not a cache that other cores write to. What is left is what no number of cores
// helps: that items are few, uneven, and wait for each other.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "bench/report/run_comparison.hpp"
#include "jobs/frame.hpp"

namespace pelt {

// By stage name: ms on one core, over all items of a frame.
using StageTimes = std::map<std::string, double, std::less<>>;

struct WorkerForecast {
  uint32_t workers;
  double best, ours;  // times one worker's speed: the bound of any executor, and Pelt's
};

class FrameForecast {
 public:
  // Of the stages that `profile` says ran; of those without a time in `times` by bytes, unless it
  // is empty: then of all.
  FrameForecast(const Frame& frame, const StageTimes& times);

  double TotalCost() const { return total_; }  // ms, or bytes
  // What the longest chain of items that wait for each other costs.
  double CriticalPath() const;
  // The passes' share of the sum, 0 to 1.
  std::vector<double> PassShares() const;
  WorkerForecast On(uint32_t workers) const;

 private:
  const Plan& plan_;
  std::vector<double> costs_;  // of items, as FrameGraph::item_node
  double total_ = 0.0;
};

// What the stages of the plan took in a run. Throws Error where it is of another plan; `from` names it.
StageTimes StageTimesOf(const MeasuredRun& run, std::string_view from, const Plan& plan);

}  // namespace pelt
