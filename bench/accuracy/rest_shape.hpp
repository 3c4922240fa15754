// How a strand lies on its body, as a curve.
#pragma once

#include <functional>
#include <vector>

#include "bench/accuracy/body_motion.hpp"

namespace pelt::accuracy {

// How a strand grows from its body; s from 0, its root, to 1, its tip.
struct RestShape {
  Double3 root;                                          // m
  std::function<Double3(double s)> tangent_at, bend_at;  // unit; its change per length
};

// A helix, whose tangent turns about an axis that it leans towards.
struct RestCurve {
  Double3 root, tangent, axis;  // m; unit
  double turn;                  // from root to tip, rad

  Double3 TangentAt(double s) const { return Unit(TurnAbout(tangent, axis, turn * s)); }
  Double3 BendAt(double s) const { return Cross(axis, TangentAt(s)) * turn; }  // per length
  operator RestShape() const {
    return {root, [rest = *this](double s) { return rest.TangentAt(s); },
            [rest = *this](double s) { return rest.BendAt(s); }};
  }
};

// A cubic spline through points at equal steps along the strand, the root first; its root is 0.
RestShape ThroughPoints(const std::vector<Double3>& points);

}  // namespace pelt::accuracy
