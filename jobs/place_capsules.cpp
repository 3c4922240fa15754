#include "jobs/place_capsules.hpp"

#include <algorithm>
#include <cmath>

#include "core/bind_pose.hpp"
#include "core/float_rules.hpp"

namespace pelt {
namespace {

// The placed end of a capsule; false where it is not finite or too far away to touch anything.
bool PlaceEnd(const float (&end)[3], const SkeletonBlock& skeleton, const float (&matrix)[12],
              uint32_t joint, const Offset& offset, float (&placed)[3]) {
  double in_mesh[3];
  PlaceInMesh(skeleton, joint, end, in_mesh);
  for (int r = 0; r < 3; ++r) {
    const float* row = matrix + 4 * r;
    double sum = row[0] * in_mesh[0] + row[1] * in_mesh[1] + row[2] * in_mesh[2] + row[3];
    if (offset.step[r] != 0.0) sum -= offset.step[r];
    if (!(std::abs(sum) <= kFarthest_m)) return false;
    placed[r] = float(sum);
  }
  return true;
}

CapsuleParams Span(const float (&from)[3], const float (&to)[3], float radius) {
  CapsuleParams capsule{};
  double length2 = 0.0;
  for (int k = 0; k < 3; ++k) {
    const double step = double(to[k]) - from[k];
    length2 += step * step;
  }
  const double length = std::sqrt(length2);
  std::copy_n(from, 3, capsule.from);
  capsule.radius = radius;
  // Shorter, the direction is lost in the ends' own rounding.
  if (length < 1.0e-6) return capsule;
  capsule.length = float(length);
  for (int k = 0; k < 3; ++k) capsule.axis[k] = float((double(to[k]) - from[k]) / length);
  return capsule;
}

}  // namespace

CapsuleSources PlaceCapsules(const FrameInput& in, const FrameMemory& memory, const PoseGate& gate,
                             SimulateParams& params, std::span<const CharacterOrigin> origins,
                             uint32_t character) {
  CapsuleSources sources{};
  params.capsule_count = 0;
  const PaletteBlock* palette = nullptr;
  uint32_t palette_of = 0;
  for (uint32_t c = 0; c < in.capsule_count; ++c) {
    const CapsuleCollider& capsule = in.capsule[c];
    float from[3], to[3];
    if (capsule.joint == CapsuleCollider::kFree) {
      std::copy_n(capsule.from, 3, from);
      std::copy_n(capsule.to, 3, to);
    } else {
      if (!palette || palette_of != capsule.character)
        palette = &gate.PaletteOf(memory, palette_of = capsule.character);
      const auto& skeleton = *memory.Of<&Streams::skeleton>(capsule.character);
      const auto& matrix = palette->matrix[capsule.joint];
      const Offset offset =
          origins.empty() ? Offset{}
                          : OffsetBetween(origins[capsule.character].used, origins[character].used);
      if (!PlaceEnd(capsule.from, skeleton, matrix, capsule.joint, offset, from) ||
          !PlaceEnd(capsule.to, skeleton, matrix, capsule.joint, offset, to))
        continue;
    }
    sources[params.capsule_count] = c;
    params.capsule[params.capsule_count++] = Span(from, to, capsule.radius);
  }
  return sources;
}

}  // namespace pelt
