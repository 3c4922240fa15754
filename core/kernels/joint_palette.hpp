// Local poses to the palette: one mesh-to-world matrix for every joint; and how fast it changes.
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

  // What JointRates needs too.

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

// Velocities of a pose to those of the palette: the derivative by time of one mesh-to-world matrix
// for every joint.
//
//   local'  = [w]x R S + R S', t'            w: the joint's spin in its parent's axes
//   world'  = parent's world' * local + parent's world * local'
//   matrix' = world' * inverse_bind
//
// The last row of a derivative is 0 0 0 0. A joint that has a velocity counts as moved, also where
// its matrix kept its bits: what sleeps on `moved` would miss it.
//
// Runs after JointPalette, in frames whose pose has velocities.
template <class V>
struct JointRates {
  static constexpr std::string_view kName = "joint_rates";
  struct Ports {
    In<&Streams::pose> pose;
    In<&Streams::pose_rates> pose_rates;
    In<&Streams::skeleton> skeleton;
    In<&Streams::local_pose> local;
    InOut<&Streams::palette> palette;
    Out<&Streams::palette_rates> palette_rates;
  };

  static void Run(const Ports& ports) {
    const uint32_t joint_count = ports.pose->joint_count;
    const SkeletonBlock& skeleton = *ports.skeleton;
    const PoseRateBlock& rates = *ports.pose_rates;
    auto& out = ports.palette_rates->matrix;
    alignas(64) float world[kJointsPerCharacter][12], rate[kJointsPerCharacter][12];
    const uint32_t lanes = RoundUpToLaneGroups(joint_count);
    for (uint32_t j = 0; j < lanes; j += V::kLanes) {
      JointPalette<V>::BuildLocalMatrices(*ports.local, j, world);
      BuildLocalRates(*ports.local, rates, j, rate);
    }
    for (uint32_t j = 0; j < joint_count; ++j) {
      const int32_t parent = skeleton.parent[j];
      const float* const above = parent < 0 ? ports.pose->root : world[parent];
      const float* const above_rate = parent < 0 ? rates.root : rate[parent];
      ConcatenateRates(above, above_rate, world[j], rate[j]);
      JointPalette<V>::Concatenate(above, world[j], world[j]);
      JointPalette<V>::Concatenate(rate[j], skeleton.inverse_bind[j], out[j]);
      if (HasRate(out[j])) ports.palette->moved[j / 32] |= 1u << (j % 32);
    }
    for (uint32_t j = joint_count; j < kJointsPerCharacter; ++j)
      for (float& value : out[j]) value = 0.0f;
  }

 private:
  static PELT_INLINE Vec3<V> RateOfAxis(Vec3<V> spin, Vec3<V> axis, V scale, V scale_rate) {
    const Vec3<V> turned = Cross(spin, axis) * scale;
    const Vec3<V> grown = axis * scale_rate;
    return turned + grown;
  }

  static PELT_INLINE void BuildLocalRates(const LocalPoseBlock& local, const PoseRateBlock& rates,
                                          uint32_t joint, float (*matrix)[12]) {
    const V one(1.0f), two(2.0f);
    const V x = V::Load(local.rotation[0] + joint), y = V::Load(local.rotation[1] + joint);
    const V z = V::Load(local.rotation[2] + joint), w = V::Load(local.rotation[3] + joint);
    const Vec3<V> s = Load3<V>(local.scale, joint);
    const Vec3<V> velocity = Load3<V>(rates.translation, joint);
    const Vec3<V> spin = Load3<V>(rates.spin, joint);
    const Vec3<V> growth = Load3<V>(rates.scale, joint);
    const V xx = x * x, yy = y * y, zz = z * z, xy = x * y, xz = x * z, yz = y * z;
    const V wx = w * x, wy = w * y, wz = w * z;
    const Vec3<V> right = {one - two * (yy + zz), two * (xy + wz), two * (xz - wy)};
    const Vec3<V> up = {two * (xy - wz), one - two * (xx + zz), two * (yz + wx)};
    const Vec3<V> forward = {two * (xz + wy), two * (yz - wx), one - two * (xx + yy)};
    const Vec3<V> a = RateOfAxis(spin, right, s.x, growth.x);
    const Vec3<V> b = RateOfAxis(spin, up, s.y, growth.y);
    const Vec3<V> c = RateOfAxis(spin, forward, s.z, growth.z);
    const auto row = [&](int r) {
      return [matrix, joint, r](int lane) { return matrix[joint + uint32_t(lane)] + 4 * r; };
    };
    ScatterRecords(row(0), a.x, b.x, c.x, velocity.x);
    ScatterRecords(row(1), a.y, b.y, c.y, velocity.y);
    ScatterRecords(row(2), a.z, b.z, c.z, velocity.z);
  }

  // rate = above_rate * local + above * rate, of 3x4 matrices, `local` with a last row 0 0 0 1.
  static PELT_INLINE void ConcatenateRates(const float* above, const float* above_rate,
                                           const float* local, float* rate) {
    alignas(64) static constexpr float kOrigin[4] = {0, 0, 0, 1};
    using Record = RecordOf<V>;
    const Record b0 = LoadRecordAs<V>(local), b1 = LoadRecordAs<V>(local + 4);
    const Record b2 = LoadRecordAs<V>(local + 8), origin = LoadRecordAs<V>(kOrigin);
    const Record d0 = LoadRecordAs<V>(rate), d1 = LoadRecordAs<V>(rate + 4);
    const Record d2 = LoadRecordAs<V>(rate + 8);
    for (int r = 0; r < 3; ++r, above += 4, above_rate += 4) {
      const Record carried =
          b0 * above_rate[0] + b1 * above_rate[1] + b2 * above_rate[2] + origin * above_rate[3];
      const Record own = d0 * above[0] + d1 * above[1] + d2 * above[2];
      StoreRecordAs<V>(rate + 4 * r, carried + own);
    }
  }

  static PELT_INLINE bool HasRate(const float (&matrix)[12]) {
    uint32_t bits[12], any = 0;
    std::memcpy(bits, matrix, sizeof bits);
    for (int i = 0; i < 12; ++i) any |= bits[i] << 1;  // without the sign
    return any != 0;
  }
};

}  // namespace pelt
