// A layer's bounding box in the world, before anything of it is skinned.
//
// A skinned vertex is a convex combination of its joints' images, so the union of the joints'
// transformed boxes holds the skin. A box is moved as centre and extent: the extent goes through
// the absolute values of the matrix (Arvo, Graphics Gems, 1990). The fur adds length_max all round.
//
// Invariant: lanes are joints and the union is taken over single lanes at the end; minimum and
// maximum do not depend on order, once the sign of zero is dropped. A layer without joints is a
// point at the origin.
#pragma once

#include <string_view>

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/layer.hpp"
#include "core/streams.hpp"

namespace pelt {

template <class V>
struct BoundLayer {
  static constexpr std::string_view kName = "bound_layer";
  struct Ports {
    Shared<&Streams::palette> palette;
    In<&Streams::layers> layer;
    In<&Streams::layer_joints> joints;
    Out<&Streams::bounds> bounds;
  };

  static void Run(const Ports& ports) {
    const LayerJointBlock& joints = *ports.joints;
    const PaletteBlock& palette = *ports.palette;
    const V never(3e38f);
    Vec3<V> low = {never, never, never}, high = {-never, -never, -never};
    for (uint32_t j = 0; j < joints.count; j += V::kLanes) {
      // Lanes past the last joint repeat it; the union does not mind.
      const auto matrix = [&](int lane) {
        const uint32_t i = j + uint32_t(lane);
        return palette.matrix[joints.joint[i < joints.count ? i : joints.count - 1]];
      };
      const auto used = typename V::Int(int32_t(joints.count)) > V::Int::Iota(int32_t(j));
      const Vec3<V> box_low = Load3<V>(joints.low, j), box_high = Load3<V>(joints.high, j);
      const Vec3<V> centre = (box_low + box_high) * V(0.5f);
      const Vec3<V> extent = (box_high - box_low) * V(0.5f);
      AddAxis(matrix, 0, used, centre, extent, low.x, high.x);
      AddAxis(matrix, 1, used, centre, extent, low.y, high.y);
      AddAxis(matrix, 2, used, centre, extent, low.z, high.z);
    }
    BoundsBlock& bounds = *ports.bounds;
    const float margin = ports.layer->length_max;
    const V lows[3] = {low.x, low.y, low.z}, highs[3] = {high.x, high.y, high.z};
    for (int axis = 0; axis < 3; ++axis) {
      float least = lows[axis][0], most = highs[axis][0];
      for (int lane = 1; lane < V::kLanes; ++lane) {
        least = lows[axis][lane] < least ? lows[axis][lane] : least;
        most = highs[axis][lane] > most ? highs[axis][lane] : most;
      }
      // + 0 drops the sign of a zero, which does depend on the order.
      bounds.low[axis] = joints.count == 0 ? 0.0f : (least - margin) + 0.0f;
      bounds.high[axis] = joints.count == 0 ? 0.0f : (most + margin) + 0.0f;
    }
    for (uint32_t& word : bounds.pad) word = 0;
  }

 private:
  template <class MatrixOfLane>
  static PELT_INLINE void AddAxis(MatrixOfLane matrix, int axis, typename V::Mask used,
                                  Vec3<V> centre, Vec3<V> extent, V& low, V& high) {
    V mx, my, mz, origin;
    GatherColumns<V>([&](int lane) { return matrix(lane) + 4 * axis; }, mx, my, mz, origin);
    const V middle = mx * centre.x + my * centre.y + mz * centre.z + origin;
    const V reach = Abs(mx) * extent.x + Abs(my) * extent.y + Abs(mz) * extent.z;
    low = Select(used, Min(low, middle - reach), low);
    high = Select(used, Max(high, middle + reach), high);
  }
};

}  // namespace pelt
