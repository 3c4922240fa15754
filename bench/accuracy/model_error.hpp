// How far a strand is off the rod that it stands for: what no solver of its equations can see.
//
// Every model has the rod's mass, weight and first frequency, hangs still at first, and rests on the same
// helix. It is moved exactly (curve_motion.hpp) or, links as layers have them, by the modal kernels at 60
// frames a second, which is model and time steps in one figure. Compared is what a third, two thirds and the
// tip do beyond the strand's own shape carried rigidly:
//
//     error = RMS((x - rigid) - (rod - rod's rigid)) / RMS(rod - rod's rigid)
//
// The rod has polynomials of degree 10. Cases are well posed where a rod of kPosedLinks agrees with it
// to kPosedError: under wild motions soft strands are chaotic, and nothing follows them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "bench/accuracy/drawn_problem.hpp"
#include "bench/accuracy/rod_problem.hpp"
#include "core/isa.hpp"
#include "core/modal/modal_quality.hpp"

namespace pelt::accuracy {

inline constexpr int kPosedLinks = 16;
inline constexpr double kPosedError = 0.05;

struct ModelErrorOptions {
  std::vector<MotionFamily> families = AllMotionFamilies();
  std::vector<Preset> presets{std::begin(kPresets), std::end(kPresets)};
  uint64_t seed = kDrawnSeed;
  int problems = 4;  // of a family
  double seconds = kRodSeconds;
  // Also links by the modal solver with these kernels; none: only exactly.
  std::optional<Isa> isa = {};
};

struct ModelErrorRow {
  MotionFamily family;
  std::string model;
  std::optional<ModalQuality> quality;      // of the solver that moved it; none: exactly
  std::vector<std::vector<double>> errors;  // of each preset's cases, 1 = 100 %
};

struct ModelErrorTable {
  std::vector<ModelErrorRow> rows;                    // family after family, model after model
  std::vector<std::vector<std::vector<bool>>> posed;  // [family][preset][case]
};

ModelErrorTable MeasureModelError(const ModelErrorOptions& options);

// RMS over the presets of the RMS over each one's cases; stiff strands, which every model does well, are
// left out. `posed`: the cases that count; empty: all.
double PooledError(const ModelErrorRow& row, const ModelErrorOptions& options,
                   const std::vector<std::vector<bool>>& posed = {});

}  // namespace pelt::accuracy
