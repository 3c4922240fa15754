// What no solver can see: how far a chain of a few links is off the rod that it stands for, both
// moved exactly.
//
// The rod is a chain of kRodLinks with the coefficients of its midpoint rule. Every chain has the rod's
// first frequency, hangs still at first, and rests on the same helix. Compared is what each point
// does beyond the chain's own shape carried rigidly, at the chain's joints:
//
//     error = RMS((x - rigid) - (rod - rod's rigid)) / RMS(rod - rod's rigid)
//
// 3 and 4 links have the calibrated coefficients of layers, others those of the midpoint rule.
#pragma once

#include <vector>

#include "bench/accuracy/drawn_problem.hpp"

namespace pelt::accuracy {

inline constexpr int kRodLinks = 12;

struct ModelErrorOptions {
  std::vector<int> links{3, 4, 6, 8};
  std::vector<Preset> presets{std::begin(kPresets), std::end(kPresets)};
  DrawnOptions drawn{.motions = 6};
  int strands = 2;  // a motion
  double seconds = 3.0;
};

struct ModelErrorRow {
  int links;
  size_t preset;               // of the options'
  std::vector<double> errors;  // of each case, 1 = 100 %
};

// Links after links, preset after preset.
std::vector<ModelErrorRow> MeasureModelError(const ModelErrorOptions& options);

}  // namespace pelt::accuracy
