// The depth a strand is sorted by, and whether it is drawn at all.
//
// Depth is that of the point three quarters down the strand, along the view direction: nearer to
// where a strand's pixels are than its root, steadier than its tip. The key is the depth's float
// bits, remapped so that unsigned order is far to near:
//
//   bits of +x: 0 ......... 0x7f7fffff   ->  bits ^ 0x7fffffff   (larger depth, smaller key)
//   bits of -x: 0x80000000 .. 0xff7fffff ->  bits                (behind the eye, after everything)
//
// -0 becomes +0 first, so equal depths have equal keys; depths are clamped to finite values, so no
// key can be kCulledKey (that would be a NaN's). Strands whose root normal faces away by more than
// the layer's tolerance, and lanes that do not live, are kCulledKey.
//
// Invariant: all lanes of the block are written, and keys_changed tells whether any differs from
// last frame's; on a restart it is set in any case, since the keys may be left from a time when
// this chunk was last in view. What breaks if ignored: the sort would be skipped on a stale order.
#pragma once

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/layer.hpp"
#include "core/streams.hpp"

namespace pelt {

struct SortKeyParams {
  float eye[3];      // m
  float forward[3];  // unit
};

// Unsigned ascending order of the result is descending order of `depth`; depth is not NaN.
template <class V>
PELT_INLINE typename V::Int FarToNearKey(V depth) {
  using I = typename V::Int;
  const I bits = Bits(depth + V(0.0f));
  return Select(bits < I(0), bits, bits ^ I(0x7fffffff));
}

template <class V, uint32_t kPoints>
struct SortKey {
  static constexpr std::string_view kName =
      ByPoints<kPoints>("sort_key4", "sort_key5", "sort_key9");
  using Params = SortKeyParams;
  struct Ports {
    Shared<&Streams::layers> layer;
    InOut<&Streams::chunk_state> state;
    In<&Streams::roots> roots;
    In<ChainStreams<kPoints, false>::kPosition> points;
    InOut<&Streams::sort_keys> keys;
  };

  // Point at t = 0.75 on the polyline: 2.25 segments of 3, 3 of 4, 6 of 8.
  static PELT_INLINE Vec3<V> ThreeQuarterPoint(const PointBlock<kPoints>& points, uint32_t lane) {
    if constexpr (kPoints % 4 == 1) {
      return Load3<V>(points.position[(kPoints - 1) / 4 * 3 - 1], lane);
    } else {
      return Load3<V>(points.position[1], lane) * V(0.75f) +
             Load3<V>(points.position[2], lane) * V(0.25f);
    }
  }

  static void Run(const Params& p, const Ports& ports) {
    using I = typename V::Int;
    using Mask = typename V::Mask;
    const Vec3<V> eye{V(p.eye[0]), V(p.eye[1]), V(p.eye[2])};
    const Vec3<V> forward{V(p.forward[0]), V(p.forward[1]), V(p.forward[2])};
    const bool cull = (ports.layer->flags & kLayerBackFaceCull) != 0;
    const V least_facing = V(-ports.layer->backface_tolerance);
    const uint32_t live = ports.state->live_strands;
    uint32_t* keys = ports.keys->key;

    I seen = I(0);
    Mask differs = I(0) < I(0);
    uint32_t lane = 0;
    for (; lane < live; lane += V::kLanes) {
      const Vec3<V> point = ThreeQuarterPoint(*ports.points, lane);
      const V depth = Clamp(Dot(point - eye, forward), V(-3.0e38f), V(3.0e38f));
      Mask culled = !(I::Iota(int32_t(lane)) < I(int32_t(live)));
      if (cull) {
        const Vec3<V> to_eye = Normalize(eye - Load3<V>(ports.roots->position, lane));
        culled = culled | (Dot(Load3<V>(ports.roots->normal, lane), to_eye) < least_facing);
      }
      const I key = Select(culled, I(int32_t(kCulledKey)), FarToNearKey(depth));
      differs = differs | !(key == I::Load(keys + lane));
      seen = seen + Select(culled, I(0), I(1));
      key.Store(keys + lane);
    }
    for (; lane < kStrandsPerChunk; lane += V::kLanes) {
      differs = differs | !(I::Load(keys + lane) == I(int32_t(kCulledKey)));
      I(int32_t(kCulledKey)).Store(keys + lane);
    }

    uint32_t visible = 0;
    for (int l = 0; l < V::kLanes; ++l) visible += uint32_t(seen[l]);
    ports.state->visible_strands = visible;
    ports.state->keys_changed = Any(differs) || (ports.state->flags & kChunkRestart) != 0 ? 1u : 0u;
  }
};

}  // namespace pelt
