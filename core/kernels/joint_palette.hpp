// Local poses to the palette: one mesh-to-world matrix for every joint.
//
//   local  = T * R * S                  lanes are joints
//   world  = parent's world * local     parents first; a root's parent is the character's placement
//   matrix = world * inverse_bind
//
// Matrices are row-major 3x4 (the last row 0 0 0 1 is implied). A row of a product is a blend of
// the right matrix's rows, so rows are handled as 16-byte records.
//
// Invariant: `moved` says exactly which matrices differ in some bit from last frame's; everything
// that sleeps relies on it. What breaks if a joint's parent does not come before it: the world
// matrix read is last joint's local one. Joints not in use hold the identity.
#pragma once

#include <string_view>

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/streams.hpp"

namespace pelt {

template <class V>
struct JointPalette {
  static constexpr std::string_view kName = "joint_palette";
  struct Ports {
    In<&Streams::pose> pose;
    In<&Streams::skeleton> skeleton;
    In<&Streams::local_pose> local;
    InOut<&Streams::palette> palette;
  };

  static void Run(const Ports& ports) {
    const uint32_t joint_count = ports.pose->joint_count;
    const SkeletonBlock& skeleton = *ports.skeleton;
    PaletteBlock& palette = *ports.palette;
    alignas(64) float world[kJointsPerCharacter][12];
    const uint32_t lanes = RoundUpToLaneGroups(joint_count);
    for (uint32_t j = 0; j < lanes; j += V::kLanes) BuildLocalMatrices(*ports.local, j, world);

    for (uint32_t& word : palette.moved) word = 0;
    for (uint32_t j = 0; j < joint_count; ++j) {
      const int32_t parent = skeleton.parent[j];
      alignas(64) float matrix[12];
      Concatenate(parent < 0 ? ports.pose->root : world[parent], world[j], world[j]);
      Concatenate(world[j], skeleton.inverse_bind[j], matrix);
      StoreIfMoved(palette, j, matrix);
    }
    alignas(16) const float identity[12] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
    for (uint32_t j = joint_count; j < kJointsPerCharacter; ++j)
      std::memcpy(palette.matrix[j], identity, sizeof identity);
    palette.teleported = ports.pose->teleported;
  }

  // What joint_rates.hpp needs too.

  static PELT_INLINE void BuildLocalMatrices(const LocalPoseBlock& local, uint32_t joint,
                                             float (*matrix)[12]) {
    const V one(1.0f), two(2.0f);
    const V x = V::Load(local.rotation[0] + joint), y = V::Load(local.rotation[1] + joint);
    const V z = V::Load(local.rotation[2] + joint), w = V::Load(local.rotation[3] + joint);
    const Vec3<V> t = Load3<V>(local.translation, joint);
    const Vec3<V> s = Load3<V>(local.scale, joint);
    const V xx = x * x, yy = y * y, zz = z * z, xy = x * y, xz = x * z, yz = y * z;
    const V wx = w * x, wy = w * y, wz = w * z;
    const auto row = [&](int r) {
      return [matrix, joint, r](int lane) { return matrix[joint + uint32_t(lane)] + 4 * r; };
    };
    ScatterRecords(row(0), (one - two * (yy + zz)) * s.x, two * (xy - wz) * s.y,
                   two * (xz + wy) * s.z, t.x);
    ScatterRecords(row(1), two * (xy + wz) * s.x, (one - two * (xx + zz)) * s.y,
                   two * (yz - wx) * s.z, t.y);
    ScatterRecords(row(2), two * (xz - wy) * s.x, two * (yz + wx) * s.y,
                   (one - two * (xx + yy)) * s.z, t.z);
  }

  // out = a * b; out may be b.
  static PELT_INLINE void Concatenate(const float* a, const float* b, float* out) {
    alignas(64) static constexpr float kOrigin[4] = {0, 0, 0, 1};
    using Record = RecordOf<V>;
    const Record b0 = LoadRecordAs<V>(b), b1 = LoadRecordAs<V>(b + 4), b2 = LoadRecordAs<V>(b + 8);
    const Record origin = LoadRecordAs<V>(kOrigin);
    for (int r = 0; r < 3; ++r, a += 4)
      StoreRecordAs<V>(out + 4 * r, b0 * a[0] + b1 * a[1] + b2 * a[2] + origin * a[3]);
  }

 private:
  static PELT_INLINE void StoreIfMoved(PaletteBlock& palette, uint32_t joint,
                                       const float (&matrix)[12]) {
    uint32_t before[12], now[12], differs = 0;
    std::memcpy(before, palette.matrix[joint], sizeof before);
    std::memcpy(now, matrix, sizeof now);
    for (int i = 0; i < 12; ++i) differs |= before[i] ^ now[i];
    if (differs == 0) return;
    palette.moved[joint / 32] |= 1u << (joint % 32);
    std::memcpy(palette.matrix[joint], matrix, sizeof matrix);
  }
};

}  // namespace pelt
