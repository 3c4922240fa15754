// Whether a point is in view of a camera, worked out for the check of culling alone.
//
// Projects the point and looks where it lands, in double; the frame tests boxes against planes. The
// two share no code and no formula, so that one mistake cannot be made in both.
#pragma once

#include "core/view.hpp"

namespace pelt {

class ViewTest {
 public:
  explicit ViewTest(const Camera& camera);
  // In view, and by more than any rounding from its border.
  bool IsClearlyInside(const float (&point)[3]) const;

 private:
  double eye_[3], right_[3], up_[3], forward_[3];
  double half_width_, half_height_;  // of the picture, one metre ahead
  double near_m_, far_m_;
};

}  // namespace pelt
