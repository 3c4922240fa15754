#include "jobs/colliders.hpp"

#include <algorithm>
#include <cmath>

#include "core/bind_pose.hpp"
#include "core/float_rules.hpp"
#include "core/kernels/wind.hpp"

namespace pelt {
namespace {

// Where places of joints' spaces are in this frame, relative to the origin of a character.
struct JointPlaces {
  const FrameMemory& memory;
  const PoseGate& gate;
  std::span<const CharacterOrigin> origins;
  uint32_t character;
  const PaletteBlock* palette = nullptr;
  uint32_t palette_of = 0;

  // False where it is not finite or too far away to touch anything.
  template <class T>
  bool Find(uint32_t of, uint32_t joint, const float (&point)[3], T (&placed)[3]) {
    if (!palette || palette_of != of) palette = &gate.PaletteOf(memory, palette_of = of);
    const Offset offset =
        origins.empty() ? Offset{} : OffsetBetween(origins[of].used, origins[character].used);
    double in_mesh[3];
    PlaceInMesh(*memory.Of<&Streams::skeleton>(of), joint, point, in_mesh);
    for (int r = 0; r < 3; ++r) {
      const float* row = palette->matrix[joint] + 4 * r;
      double sum = row[0] * in_mesh[0] + row[1] * in_mesh[1] + row[2] * in_mesh[2] + row[3];
      if (offset.step[r] != 0.0) sum -= offset.step[r];
      if (!(std::abs(sum) <= kFarthest_m)) return false;
      placed[r] = T(sum);
    }
    return true;
  }
};

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

// By what `find` makes of a place; false where there is none, or the joint has lost an axis.
bool Place(const ForceVolume& force, auto&& find, PlacedForce& placed) {
  const bool pulls = force.kind == uint32_t(ForceKind::kPull);
  double centre[3], push[3] = {};
  if (!find(force.centre, centre)) return false;
  for (int a = 0; a < 3; ++a) {
    float end[3] = {force.centre[0], force.centre[1], force.centre[2]};
    end[a] += 1.0f;
    double axis[3], square = 0.0, middle = 0.0;
    if (!find(end, axis)) return false;
    for (int k = 0; k < 3; ++k) {
      axis[k] -= centre[k];
      square += axis[k] * axis[k];
    }
    if (!(square > 1.0e-24)) return false;
    for (int k = 0; k < 3; ++k) {
      const double unit = axis[k] / std::sqrt(square);
      placed.own[a][k] = float(unit / double(force.half[a]));
      middle += unit * centre[k];
      push[k] += unit * double(force.direction[a]);
    }
    placed.own[a][3] = float(-middle / double(force.half[a]));
  }
  for (int k = 0; k < 3; ++k)
    placed.push[k] = float(pulls ? centre[k] : push[k] * double(force.strength));
  placed.pull = pulls ? force.strength : 0.0f;
  placed.steepness = 1.0f / std::max(1.0f - force.hardness, 1.0e-6f);
  placed.flags =
      (force.shape == uint32_t(ForceShape::kBox) ? kForceBox : 0u) | (pulls ? kForcePulls : 0u);
  return true;
}

}  // namespace

CapsuleSources PlaceCapsules(const FrameInput& in, const FrameMemory& memory, const PoseGate& gate,
                             SimulateParams& params, std::span<const CharacterOrigin> origins,
                             uint32_t character) {
  CapsuleSources sources{};
  params.capsule_count = 0;
  JointPlaces joints{memory, gate, origins, character};
  for (uint32_t c = 0; c < in.capsule_count; ++c) {
    const CapsuleCollider& capsule = in.capsule[c];
    float from[3], to[3];
    if (capsule.joint == CapsuleCollider::kFree) {
      std::copy_n(capsule.from, 3, from);
      std::copy_n(capsule.to, 3, to);
    } else if (!joints.Find(capsule.character, capsule.joint, capsule.from, from) ||
               !joints.Find(capsule.character, capsule.joint, capsule.to, to)) {
      continue;
    }
    sources[params.capsule_count] = c;
    params.capsule[params.capsule_count++] = Span(from, to, capsule.radius);
  }
  return sources;
}

ForceParams PlaceForces(const FrameInput& in, const FrameMemory& memory, const PoseGate& gate,
                        std::span<const CharacterOrigin> origins, uint32_t character) {
  ForceParams params;
  JointPlaces joints{memory, gate, origins, character};
  for (uint32_t f = 0; f < in.force_count; ++f) {
    const ForceVolume& force = in.force[f];
    const auto find = [&](const float(&point)[3], double(&placed)[3]) {
      if (force.joint != ForceVolume::kFree)
        return joints.Find(force.character, force.joint, point, placed);
      std::copy_n(point, 3, placed);
      return true;
    };
    if (Place(force, find, params.force[params.count]))
      ++params.count;
    else
      params.force[params.count] = {};
  }
  return params;
}

bool Touches(const PlacedForce& force, const BoundsBlock& box) {
  for (const auto& row : force.own) {
    double middle = row[3], reach = 1.0;
    for (int k = 0; k < 3; ++k) {
      middle += double(row[k]) * 0.5 * (double(box.low[k]) + double(box.high[k]));
      reach += std::abs(double(row[k])) * 0.5 * (double(box.high[k]) - double(box.low[k]));
    }
    if (!(std::abs(middle) <= reach)) return false;
  }
  return true;
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
