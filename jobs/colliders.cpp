#include "jobs/colliders.hpp"

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

namespace {

// m/s. A joint that goes further was put where it is, and met nothing on its way.
constexpr float kFastestJoint = 100.0f;

bool IsZero(const float (&v)[3]) { return v[0] == 0.0f && v[1] == 0.0f && v[2] == 0.0f; }

ColliderStep StepOf(const float (&from)[3], const float (&to)[3], float dt) {
  ColliderStep step{};
  for (int k = 0; k < 3; ++k) {
    step.from[k] = from[k] * dt;
    step.to[k] = to[k] * dt;
  }
  step.moves = IsZero(step.from) && IsZero(step.to) ? 0 : 1;
  return step;
}

template <size_t kCount>
bool Differ(const float (&a)[kCount], const float (&b)[kCount]) {
  return !std::equal(a, a + kCount, b);
}

// By velocity, or as something that is where it was not.
ColliderStep StepBy(const float (&from)[3], const float (&to)[3], float dt, bool elsewhere) {
  ColliderStep step = StepOf(from, to, dt);
  step.at_once = step.moves == 0 && elsewhere ? 1 : 0;
  return step;
}

void FindEnd(const CapsuleParams& capsule, float (&end)[3]) {
  for (int k = 0; k < 3; ++k) end[k] = capsule.from[k] + capsule.axis[k] * capsule.length;
}

// Of a capsule bound to a joint.
ColliderStep Carried(const CapsuleParams& now, const CapsuleParams& last, float dt) {
  float end[3], last_end[3], from[3], to[3];
  FindEnd(now, end);
  FindEnd(last, last_end);
  float fastest = 0.0f;
  for (int k = 0; k < 3; ++k) {
    from[k] = (now.from[k] - last.from[k]) / dt;
    to[k] = (end[k] - last_end[k]) / dt;
    fastest = std::max({fastest, std::abs(from[k]), std::abs(to[k])});
  }
  return fastest <= kFastestJoint ? StepOf(from, to, dt) : ColliderStep{};
}

// Relative to where an origin moved to.
CapsuleParams Shifted(CapsuleParams capsule, const float* shift) {
  for (int k = 0; k < 3; ++k) capsule.from[k] -= shift[k];
  return capsule;
}

bool IsSame(const CapsuleCollider& a, const CapsuleCollider& b) {
  return a.joint == b.joint && a.radius == b.radius && !Differ(a.from, b.from) &&
         !Differ(a.to, b.to) && (a.joint == CapsuleCollider::kFree || a.character == b.character);
}

}  // namespace

const CapsuleParams* ColliderCourse::LastOf(uint32_t source, const SimulateParams& last) const {
  for (uint32_t c = 0; c < last.capsule_count; ++c)
    if (sources_[c] == source) return &last.capsule[c];
  return nullptr;
}

void ColliderCourse::Advance(const FrameInput& in, const FrameMemory& memory,
                             const CapsuleSources& sources, const SimulateParams* last,
                             const float* shift, SimulateParams& params) {
  const float dt = params.dt;
  const bool compares = last && std::equal(in.origin, in.origin + 3, origin_);
  if (params.use_ground)
    params.ground_step = StepBy(in.ground_velocity, in.ground_velocity, dt,
                                compares && use_ground_ && Differ(ground_, in.ground));
  for (uint32_t s = 0; s < params.sphere_count; ++s)
    params.sphere_step[s] =
        StepBy(in.sphere_velocity[s], in.sphere_velocity[s], dt,
               compares && s < sphere_count_ && Differ(sphere_[s], in.sphere[s]));
  for (uint32_t c = 0; c < params.capsule_count; ++c) {
    const CapsuleCollider &now = in.capsule[sources[c]], &was = capsule_[sources[c]];
    const CapsuleParams* before = last ? LastOf(sources[c], *last) : nullptr;
    if (now.joint == CapsuleCollider::kFree)
      params.capsule_step[c] =
          StepBy(now.from_velocity, now.to_velocity, dt, compares && before && !IsSame(now, was));
    else if (before && IsSame(now, was) &&
             memory.Of<&Streams::pose>(now.character)->teleported == 0)
      params.capsule_step[c] =
          Carried(params.capsule[c], shift ? Shifted(*before, shift) : *before, dt);
  }
  std::copy_n(in.origin, 3, origin_);
  use_ground_ = in.use_ground;
  std::copy_n(in.ground, 4, ground_);
  sphere_count_ = in.sphere_count;
  std::copy_n(in.sphere[0], 4 * kSpheresPerScene, sphere_[0]);
  std::copy_n(in.capsule, kCapsulesPerScene, capsule_);
  sources_ = sources;
}

}  // namespace pelt
