// What no solver can see: how far a chain of a few links is off the rod that it stands for, both
// moved exactly. And what a layer then gets: the same with the chain moved by the modal solver, 60
// frames a second, which is links and time steps in one figure.
//
// The rod is a chain of kRodLinks with the coefficients of its midpoint rule. Every chain has the rod's
// first frequency, hangs still at first, and rests on the same helix. Compared is what each point
// does beyond the chain's own shape carried rigidly, at the chain's joints:
//
//     error = RMS((x - rigid) - (rod - rod's rigid)) / RMS(rod - rod's rigid)
//
// 3, 4 and 8 links have the calibrated coefficients of layers, others those of the midpoint rule.
#pragma once

#include <optional>
#include <vector>

#include "bench/accuracy/drawn_problem.hpp"
#include "core/isa.hpp"
#include "core/modal/modal_quality.hpp"

namespace pelt::accuracy {

inline constexpr int kRodLinks = 12;

struct ModelErrorOptions {
  std::vector<int> links{3, 4, 6, 8};
  std::vector<Preset> presets{std::begin(kPresets), std::end(kPresets)};
  DrawnOptions drawn{.motions = 6};
  int strands = 2;  // a motion
  double seconds = 3.0;
  // Also by the modal solver with these kernels; none: only exactly.
  std::optional<Isa> isa = {};
};

struct ModelErrorRow {
  int links;
  size_t preset;                        // of the options'
  std::optional<ModalQuality> quality;  // of the solver that moved the chain; none: exactly
  std::vector<double> errors;           // of each case, 1 = 100 %
};

// Links after links, preset after preset, the exact motion first.
std::vector<ModelErrorRow> MeasureModelError(const ModelErrorOptions& options);

}  // namespace pelt::accuracy
