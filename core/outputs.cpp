#include "core/outputs.hpp"

#include "core/float_rules.hpp"

namespace pelt::outputs_detail {
namespace {

template <class Record, class PointAt>
StrandCurve ReadRecord(const Record& record, float tip_width, PointAt point_at) {
  StrandCurve curve{.point = {},
                    .base_colour = record.base_colour,
                    .tip_colour = record.tip_colour,
                    .strand = record.tag & 0xffffffu,
                    .film_strip = record.tag >> 24};
  for (uint32_t i = 0; i < kRibbonPoints; ++i) {
    const float t = float(i) / float(kRibbonPoints - 1);
    for (uint32_t axis = 0; axis < 3; ++axis) curve.point[i][axis] = point_at(i, t, axis);
    curve.point[i][3] = record.width * (1.0f + (tip_width - 1.0f) * t);
  }
  return curve;
}

}  // namespace

StrandCurve ReadCurve(const CurveRecord& record, float tip_width) {
  const auto& c = record.curve;
  return ReadRecord(record, tip_width, [&](uint32_t, float t, uint32_t axis) {
    return c[0][axis] + t * (c[1][axis] + t * (c[2][axis] + t * c[3][axis]));
  });
}

StrandCurve ReadCurve(const RibbonRecord& record, float tip_width) {
  return ReadRecord(record, tip_width,
                    [&](uint32_t i, float, uint32_t axis) { return record.point[i][axis]; });
}

}  // namespace pelt::outputs_detail
