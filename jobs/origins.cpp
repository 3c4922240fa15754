#include "jobs/origins.hpp"

#include <algorithm>
#include <cmath>

#include "core/float_rules.hpp"

namespace pelt {
namespace {

void MovePlace(const Offset& offset, float (&place)[3]) {
  for (int k = 0; k < 3; ++k) place[k] = offset.Place(place[k], k);
}

// The plane n . x + d = 0 of the same points.
float MovePlane(const Offset& offset, const float* plane) {
  double d = plane[3];
  for (int k = 0; k < 3; ++k) d += double(plane[k]) * offset.step[k];
  return float(d);
}

}  // namespace

void CharacterOrigin::Advance(const double* given) {
  was_shifted = shifted;
  shifted = false;
  for (int k = 0; k < 3; ++k) {
    shift[k] = given ? float(given[k] - used[k]) : 0.0f;
    if (given) used[k] = given[k];
    shifted |= shift[k] != 0.0f;
  }
}

bool IsOriginUsable(const double* origin) {
  return std::all_of(origin, origin + 3,
                     [](double value) { return std::abs(value) <= kFarthestOrigin_m; });
}

void MovePlaces(const Offset& offset, FrameInput& input) {
  if (offset.IsNone()) return;
  input.ground[3] = MovePlane(offset, input.ground);
  for (uint32_t s = 0; s < input.sphere_count; ++s)
    for (int k = 0; k < 3; ++k) input.sphere[s][k] = offset.Place(input.sphere[s][k], k);
  for (uint32_t c = 0; c < input.capsule_count; ++c) {
    CapsuleCollider& capsule = input.capsule[c];
    if (capsule.joint != CapsuleCollider::kFree) continue;
    MovePlace(offset, capsule.from);
    MovePlace(offset, capsule.to);
  }
  for (uint32_t f = 0; f < input.force_count; ++f)
    if (input.force[f].joint == ForceVolume::kFree) MovePlace(offset, input.force[f].centre);
  Lighting& lighting = input.lighting;
  for (uint32_t l = 0; l < lighting.light_count; ++l) MovePlace(offset, lighting.light[l].position);
  for (uint32_t s = 0; s < lighting.sample_count; ++s)
    MovePlace(offset, lighting.sample[s].position);
  for (uint32_t b = 0; b < input.brush_count; ++b) MovePlace(offset, input.brush[b].centre);
}

void MoveView(const Offset& offset, View& view) {
  if (offset.IsNone()) return;
  MovePlace(offset, view.eye);
  for (auto& plane : view.planes) plane[3] = MovePlane(offset, plane);
}

}  // namespace pelt
