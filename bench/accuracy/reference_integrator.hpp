// The exact motion of chains, in double: what every solver's error is measured from, of a chain problem and of chains
// that touch things.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "bench/accuracy/chain_problem.hpp"

namespace pelt::accuracy {

// ---- Free ------------------------------------------------------------------------------------

// d and d' are integrated by the eighth-order Runge-Kutta method of Dormand and Prince with twelve
// stages (the weights of DOP853: Hairer, Norsett, Wanner, "Solving Ordinary Differential Equations
// I", 1993) at a fixed step. The multipliers come from |d_i| = 1 differentiated twice: a
// tridiagonal system (M^-1 o Gram) lambda = -|d'|^2 - d . a. After each step d is normalised and d'
// made tangent, so |d_i| = 1 to rounding for ever; that projection moves d by the step's own error
// only and keeps the order.
//
// Several strands that share a motion are integrated together, so that the body's pose, the most
// expensive part, is found once for all.
//
// Invariant: halving the step must not change a point by more than 1e-10 of the length on a
// well-conditioned problem (ReferenceConverges in the tests); if it does, the error figures of good
// solvers are those of the reference.

// The state of one chain.
struct ChainState {
  std::array<Double3, kMaxLinks> direction, rate;  // d, d' (1/s)
};

// The right-hand side d'' of the chain's equation at time t, with the multipliers that keep the
// links' lengths.
class ChainDynamics {
 public:
  ChainDynamics(const ChainMaterial& material, const Strand& strand);
  void Accelerate(const BodyPose& pose, const ChainState& state,
                  std::array<Double3, kMaxLinks>& acceleration) const;
  // Force on each direction, K (r - d) or -grad E_F, damping left out.
  void Bend(const std::array<Double3, kMaxLinks>& direction,
            const std::array<Double3, kMaxLinks>& rest,
            std::array<Double3, kMaxLinks>& force) const;
  // Kinetic, bending and gravity energy about a root that stands still in `pose`, J.
  double Energy(const BodyPose& pose, const ChainState& state) const;
  const ChainMaterial& material() const { return material_; }
  const ChainMatrices& matrices() const { return matrices_; }
  const Strand& strand() const { return strand_; }

 private:
  ChainMaterial material_;
  ChainMatrices matrices_;
  Strand strand_;
};

// Steps chains that share a motion. Times are kept as counts of steps: t = steps / rate.
class ReferenceIntegrator {
 public:
  // All problems have the motion of the first. `steps_per_second`: a multiple of every frame rate
  // the motion is to be compared at.
  ReferenceIntegrator(std::span<const ChainProblem> problems, int steps_per_second);
  void Step();
  // The motion from the present time on.
  void SetMotion(BodyMotion motion) { motion_ = std::move(motion); }
  // The root's velocity jumps: an impulse on the first link, lengths kept.
  void Kick(size_t problem, Double3 velocity_jump);
  double seconds() const { return double(steps_) / rate_; }
  const ChainState& state(size_t problem) const { return states_[problem]; }
  void SetState(size_t problem, const ChainState& state) { states_[problem] = state; }
  // Points 1 .. links of a chain at the present time, m, world.
  void Points(size_t problem, Double3* points) const;

 private:
  BodyMotion motion_;
  std::vector<ChainDynamics> chains_;
  std::vector<ChainState> states_;
  int64_t rate_, steps_ = 0;
};

// Steps a second that keep the reference below 1e-10 L: from the fastest mode's frequency.
int ReferenceRate(const ChainMaterial& material);

// Points 1 .. links of each problem at frames 0 .. frame_count, frame after frame.
// [problem][frame * links + i]; rate a multiple of frames_per_second.
std::vector<std::vector<Double3>> SolveReference(std::span<const ChainProblem> problems,
                                                 int frames_per_second, int frame_count,
                                                 int steps_per_second);
// A point (0: the first free one) of one problem at time t, a multiple of 1 / steps_per_second.
Double3 ReferencePoint(const ChainProblem& problem, int point, double t, int steps_per_second);

// ---- In contact ------------------------------------------------------------------------------

// The motion of chains that touch things: what errors of contact are measured from.
//
// Shapes are hard: a point of a link never gets in, loses its speed along the normal where it meets
// one (no bounce), and is held back across it by Coulomb's law. Time goes in steps of some 20
// microseconds (Moreau's scheme: J. J. Moreau, "Unilateral contact and dry friction in finite
// freedom dynamics", 1988): speeds live between the steps (leapfrog), the chain's own forces come
// from ChainDynamics, and each step the impulses are found that keep every link's nearest point from
// entering by the step's end, each within its cone of friction. There is no stiffness to choose: the
// step is all that can be wrong, and halving it shows by how much (feature_errors_test.cpp). What
// overlaps from the start has no motion that is right, and leaves as the solver says it does.
//
// Nothing of this is shared with core: neither shapes, nor nearest points, nor the solve.

// A ball swept from `from` to `to`, or, with a normal, the half-space normal . x + offset < 0. It
// moves as a whole: by `way(t)` at t seconds, with way(0) as it is given, at `speed(t)`.
struct ContactShape {
  Double3 from = kZero3, to = kZero3;
  double radius = 0.0;
  Double3 normal = kZero3;  // not 0: a half-space
  double offset = 0.0;
  std::function<Double3(double)> way, speed;  // none: it stands
};

// Chains that share a motion and what they touch.
class ContactReference {
 public:
  ContactReference(const ChainMaterial& material, const std::vector<Strand>& strands,
                   const std::vector<std::array<Double3, kMaxLinks>>& start, BodyMotion motion,
                   std::vector<ContactShape> shapes, double friction, int steps_per_second);
  void Step();
  double seconds() const { return double(steps_) / rate_; }
  const ChainState& state(size_t strand) const { return states_[strand]; }
  // Point i (0: the first free one), from the root.
  Double3 Point(size_t strand, int i) const;

 private:
  struct Touch;
  void Move(size_t strand, const BodyPose& pose, const BodyPose& between);
  int FindTouches(const ChainDynamics& chain, const ChainState& s, const BodyPose& pose,
                  const BodyPose& between, Touch* touches) const;
  Double3 SpeedOf(const Touch& touch, const std::array<Double3, kMaxLinks>& rate) const;
  void FindAnswers(const ChainDynamics& chain, const std::array<Double3, kMaxLinks>& d,
                   Touch* touches, int count) const;
  void Resolve(Touch* touches, int count, double friction,
               std::array<Double3, kMaxLinks>& rate) const;

  ChainMaterial material_;
  BodyMotion motion_;
  std::vector<ContactShape> shapes_;
  double friction_;
  std::vector<ChainDynamics> chains_;
  std::vector<ChainState> states_;
  // Where shapes are at the step's start and how fast they go within it.
  std::vector<Double3> way_, speed_;
  int64_t rate_, steps_ = 0;
};

}  // namespace pelt::accuracy
