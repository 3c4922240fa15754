// How far a strand is off the rod that it stands for, solver and all: the first thing that `pelt accuracy` says.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "bench/accuracy/curve_motion.hpp"
#include "bench/accuracy/drawn_problem.hpp"
#include "bench/accuracy/named_solver.hpp"
#include "bench/accuracy/solver_timing.hpp"

namespace pelt::accuracy {

// ---- The problems ----------------------------------------------------------------------------

// Motions by family, helices to grow.
//
// Everyday motions are what a character does: a gait, jumps, turns on the spot and dashes, sums of slow
// waves. The wild ones are the same at more than twice the size. Wind blows on a body that sways; a shake is a
// dog's; violence is a dash and a stop within a frame or two. `drawn` are those of drawn_problem.hpp.
//
// A strand stands anywhere 5 to 15 cm from the middle of the body, leaning up to 50 degrees from
// straight out, with 21 to 66 degrees of curl from root to tip, and 0.8 to 1.25 of its preset's length.
//
// Invariant: what is drawn depends on the family, the seed and the place in the list alone. The nodes of
// core/modal/node_model.hpp were chosen on seeds of another generator: none of these tuned anything.

enum class MotionFamily : uint8_t { kEveryday, kWild, kDrawn, kWind, kShake, kViolent };
inline constexpr std::string_view kMotionFamilies[] = {"everyday", "wild",  "drawn",
                                                       "wind",     "shake", "violent"};
std::vector<MotionFamily> AllMotionFamilies();

struct RodProblem {
  BodyMotion motion;  // kRodSeconds long, from standing still
  RestCurve rest;
  double length_scale;
};
inline constexpr double kRodSeconds = 3.0;

RodProblem DrawRodProblem(MotionFamily family, uint64_t seed, int index);

// ---- The error -------------------------------------------------------------------------------

// Every model has the rod's mass, weight and first frequency, hangs still at first, and rests on the same
// helix. It is moved exactly (curve_motion.hpp), which is the model's own error, or by a solver at 60 frames a
// second, which is model and time steps in one figure: nodes as layers have them, and links, by the modal solver;
// links by the solvers that it is compared with. Compared is what a third, two thirds and the tip do beyond the
// strand's own shape carried rigidly:
//
//     error = RMS((x - rigid) - (rod - rod's rigid)) / RMS(rod - rod's rigid)
//
// The rod has polynomials of degree 10; two rows show how far it has converged, one of degree 8 and one in half steps.
// Cases are well posed where a rod of kPosedLinks agrees with it to kPosedError: under wild motions soft strands are
// chaotic, and nothing follows them.
//
// Solvers without a stiffness of their own are tuned for each family and preset on the cases that they are
// scored on: the best they could do.

inline constexpr int kPosedLinks = 16;
inline constexpr double kPosedError = 0.05;

struct ModelErrorOptions {
  std::vector<MotionFamily> families = AllMotionFamilies();
  std::vector<Preset> presets{std::begin(kPresets), std::end(kPresets)};
  uint64_t seed = kDrawnSeed;
  int problems = 4;  // of a family
  double seconds = kRodSeconds;
  BodyMotion motion = {};  // of every problem, from standing still; none: as drawn
  CurlModel curl = CurlModel::kRoot;
  std::optional<double> rest_turn = {};  // rad from root to tip, of every strand; none: as drawn
  // Also by solvers, with these kernels; none: only exactly.
  std::optional<Isa> isa = {};
  // And what these take, in turn; none: not timed.
  std::optional<TimingOptions> timing = {};
};

struct ModelErrorRow {
  std::string model;
  std::optional<NamedSolver> solver;        // that moved it, as tuned on TimedPreset; none: exactly
  std::vector<std::vector<double>> errors;  // [preset][case], 1 = 100 %; not finite: infinity
  double ns = 0.0;                          // per strand and frame, median of slices; 0: not timed
};

struct ModelErrorPanel {
  MotionFamily family;
  std::vector<std::vector<bool>> posed;  // [preset][case]
  std::vector<ModelErrorRow> rows;       // the same of every family
};

struct ModelErrorTable {
  std::vector<ModelErrorPanel> panels;  // [family]
};

ModelErrorTable MeasureModelError(const ModelErrorOptions& options);

// On whose material solvers are timed, in the headshake: the preset in the middle.
size_t TimedPreset(const ModelErrorOptions& options);

// RMS over the presets of the RMS over each one's cases; stiff strands, which every model does well, are
// left out where there are others. `posed`: the cases that count; empty: all.
double PooledError(const ModelErrorRow& row, const ModelErrorOptions& options,
                   const std::vector<std::vector<bool>>& posed = {});

// Timed, and nothing as cheap is nearer to the rod.
bool IsParetoOptimal(const ModelErrorPanel& panel, const ModelErrorRow& row,
                     const ModelErrorOptions& options);

double RootMeanSquare(const std::vector<double>& values);  // 0 of none

}  // namespace pelt::accuracy
