// The exact motion of a CurveStrand on a moving body, in double.
//
// The idea: explicit methods would need a million steps a second for the fastest modes of a rod. So the
// linear part is moved exactly, mode by mode, under the cubic that has the body's poses and velocities at
// both ends of a step; the lengths are brought back by Newton's method to the end, along the middle of each
// vector's turn; velocities are made tangent after every step. It is the modal step (core/kernels/
// modal_step.hpp) without its short cuts.
//
// Invariant: of second order in the step. Halving steps of 1/1920 s must not change an error by more than
// 0.1 % of itself, and a Runge-Kutta method that shares nothing with it must agree (tests/accuracy).
#pragma once

#include <vector>

#include "bench/accuracy/chain_problem.hpp"
#include "bench/accuracy/curve_strand.hpp"
#include "core/modal/modal_response.hpp"

namespace pelt::accuracy {

// How a strand grows from its body: a helix, whose tangent turns about an axis that it leans towards.
struct RestCurve {
  Double3 root, tangent, axis;  // m; unit
  double turn;                  // from root to tip, rad

  Double3 TangentAt(double s) const { return Unit(TurnAbout(tangent, axis, turn * s)); }
};

using UnknownVectors = std::array<Double3, kMostUnknowns>;

// The strand's equation, in lengths of the strand and seconds.
class CurveDynamics {
 public:
  CurveDynamics(const CurveStrand& strand, const Preset& preset, const RestCurve& rest);

  size_t count() const { return n_; }
  double length() const { return length_; }
  const UnknownVectors& rest() const { return rest_; }
  // Directions in which it hangs still on the body in that pose.
  UnknownVectors Equilibrium(const BodyPose& pose) const;
  // d'' with the multipliers that keep |d_i| = 1.
  void Accelerate(const BodyPose& pose, const UnknownVectors& d, const UnknownVectors& rate,
                  UnknownVectors& acceleration) const;

 private:
  friend class CurveMotion;
  static constexpr Double3 kGravity = {0.0, -9.81, 0.0};

  // What the body's place adds to direction i, of the body's pose or its derivatives: e_i x0 + (M^-1 m)_i r0.
  Double3 OnBody(size_t i) const { return root_ * root_share_[i] + clamp_ * clamp_share_[i]; }

  size_t n_;
  double length_, drag_, damping_;
  UnknownMatrix mass_, inverse_, stiffness_, modes_{};
  UnknownRow pull_, squares_{}, root_share_{}, clamp_share_{};
  UnknownVectors rest_{};
  Double3 root_, clamp_;  // in the body's frame; lengths
};

class CurveMotion {
 public:
  // Begins hanging still in `pose`.
  CurveMotion(const CurveDynamics& dynamics, const BodyPose& pose, double step_s);
  // The body goes from the last pose to this one in a step.
  void Step(const BodyPose& to);
  const UnknownVectors& directions() const { return d_; }

 private:
  struct Path;  // of the body through a step, as powers of time
  UnknownVectors RunFree(const Path& path);
  void KeepLengths(const UnknownVectors& free);
  void MakeTangent(const Path& path);

  const CurveDynamics& dynamics_;
  double step_;
  std::vector<OscillatorStep> oscillator_;
  UnknownMatrix response_{};  // of y to half a force that is constant over the step
  BodyPose pose_;
  UnknownVectors d_, z_{};  // directions; rates by mode
  UnknownRow lambda_{};
};

}  // namespace pelt::accuracy
