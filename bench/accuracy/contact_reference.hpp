// The motion of chains that touch things, in double: what errors of contact are measured from.
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
#pragma once

#include <functional>
#include <vector>

#include "bench/accuracy/reference_integrator.hpp"

namespace pelt::accuracy {

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
