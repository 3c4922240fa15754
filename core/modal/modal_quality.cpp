#include "core/modal/modal_quality.hpp"

#include <cmath>

#include "core/box_distance.hpp"
#include "core/float_rules.hpp"

namespace pelt {
namespace {

// From the eye, m^2; nothing is nearer than the near plane.
float SquaredDistanceFrom(const View& view, const BoundsBlock& box) {
  const float near2 = view.near_m * view.near_m, box2 = SquaredDistance(view.eye, box);
  return box2 < near2 ? near2 : box2;
}

}  // namespace

ModalQuality QualityOnScreen(ModalQuality asked, ModalQuality last, const View& view,
                             const BoundsBlock& box, float length_max, float allowed_px) {
  if (asked != ModalQuality::kFine || !(allowed_px > 0.0f)) return asked;
  const float distance2 = SquaredDistanceFrom(view, box);
  const float error = kFastTypicalError * length_max * view.pixels_per_unit_at_1m;
  const float allowed = last == ModalQuality::kFast ? kFastHysteresis * allowed_px : allowed_px;
  return error * error <= allowed * allowed * distance2 ? ModalQuality::kFast : asked;
}

double FastErrorPx2(const View& view, const BoundsBlock& box, float length_max) {
  const double error = double(kFastTypicalError) * length_max * view.pixels_per_unit_at_1m;
  return error * error / double(SquaredDistanceFrom(view, box));
}

float LengthOnScreenPx(const View& view, const BoundsBlock& box, float length) {
  return length * view.pixels_per_unit_at_1m / std::sqrt(SquaredDistanceFrom(view, box));
}

}  // namespace pelt
