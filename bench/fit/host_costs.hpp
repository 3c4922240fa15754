// What the stages of a frame cost on this machine, measured once and kept in a file: `pelt calibrate` writes it, and
// `pelt fit --platform host --costs` takes it in place of a clock.
//
// A stage costs so much for each item and for each iteration (CountIterations), of the modal solver by tier: the line
// through frames with all strands and with an eighth of them. A frame takes a part of its core time, as workers share it.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "bench/fit/fit_scene.hpp"
#include "core/isa.hpp"

namespace pelt {

struct HostCosts {
  struct Stage {
    std::string name;
    std::string tier = {};          // of Tiers(); empty: the same in all of them
    uint32_t picoseconds = 0;       // per iteration
    uint32_t item_picoseconds = 0;  // per item
  };
  std::string processor, commit, isa;
  uint32_t workers = 0;
  uint32_t frame_permille = 0;  // a frame over its core time, both the 95th percentile
  std::vector<Stage> stages;
};

struct CalibrationOptions {
  uint32_t workers = 0;  // 0: one for each core
  uint32_t warm_up = 10, frames = 30;
  std::vector<std::string> scenes;  // at least one; the last gives frame_permille
  std::function<void(const std::string& now)> progress = {};
};
// `disturbances`: what makes the times doubtful, a sentence each.
HostCosts MeasureHost(const CalibrationOptions& options, std::vector<std::string>& disturbances);

std::string HostCostsText(const HostCosts& costs);
// Throws Error with path and line.
HostCosts ReadHostCosts(const std::string& path);

// LodSettings::costs: what the scene's layers take on this machine in the solver and quality that they have, and in
// `fast`. 0 for others. `path`: of the costs, for messages.
FurCosts FurCostsOnHost(const HostCosts& costs, const std::string& path, const Scenario& scene);

// `path`: of the costs, for messages.
FitPlatform OnHost(const HostCosts& costs, const std::string& path, uint32_t warm_up,
                   uint32_t frames);

}  // namespace pelt
