// The problems that models of a hair are measured on against the rod: motions by family, helices to grow.
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
#pragma once

#include <string_view>

#include "bench/accuracy/curve_motion.hpp"

namespace pelt::accuracy {

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

}  // namespace pelt::accuracy
