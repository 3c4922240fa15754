#include "core/modal/quality_on_screen.hpp"

#include "core/box_distance.hpp"
#include "core/float_rules.hpp"

namespace pelt {

ModalQuality QualityOnScreen(ModalQuality asked, ModalQuality last, const View& view,
                             const BoundsBlock& box, float length_max, float allowed_px) {
  if (asked != ModalQuality::kFine || !(allowed_px > 0.0f)) return asked;
  const float near2 = view.near_m * view.near_m, box2 = SquaredDistance(view.eye, box);
  const float distance2 = box2 < near2 ? near2 : box2;
  const float error = kFastError * length_max * view.pixels_per_unit_at_1m;
  const float allowed = last == ModalQuality::kFast ? kFastHysteresis * allowed_px : allowed_px;
  return error * error <= allowed * allowed * distance2 ? ModalQuality::kFast : asked;
}

}  // namespace pelt
