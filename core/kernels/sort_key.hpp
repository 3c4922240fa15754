// The depth a strand is sorted by, and whether it is drawn at all.
//
// Depth is that of the point at the layer's `sort_place` on the strand, along the view direction: unless a setup says
// another, three quarters down, nearer to where a strand's pixels are than its root, steadier than its tip. The key is
// the depth's float bits, remapped so that unsigned order is far to near:
//
//   bits of +x: 0 ......... 0x7f7fffff   ->  bits ^ 0x7fffffff   (larger depth, smaller key)
//   bits of -x: 0x80000000 .. 0xff7fffff ->  bits                (behind the eye, after everything)
//
// -0 becomes +0 first, so equal depths have equal keys; depths are clamped to finite values, so no
// key can be kCulledKey (that would be a NaN's). Strands whose root normal faces away by more than
// the layer's tolerance, that are cut off, and lanes that do not live, are kCulledKey.
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

namespace sort_key_detail {

alignas(64) inline constexpr uint32_t kBitOfLane[kLaneGroup] = {
    1u << 0, 1u << 1, 1u << 2,  1u << 3,  1u << 4,  1u << 5,  1u << 6,  1u << 7,
    1u << 8, 1u << 9, 1u << 10, 1u << 11, 1u << 12, 1u << 13, 1u << 14, 1u << 15};

template <class V>
PELT_INLINE typename V::Mask AreCut(const ChunkStateBlock& state, uint32_t lane) {
  using I = typename V::Int;
  const I word = I(int32_t(state.cut[lane / 32] >> lane % 32));
  return !((word & I::Load(kBitOfLane)) == I(0));
}

PELT_INLINE bool HasCut(const ChunkStateBlock& state) {
  uint32_t any = 0;
  for (const uint32_t word : state.cut) any |= word;
  return any != 0;
}

}  // namespace sort_key_detail

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

  // A share of the polyline: of the segment from point `from` on a share of its own.
  struct Place {
    uint32_t from;
    float share;
  };
  static PELT_INLINE Place FindPlace(float along) {
    const float segments = along * float(kPoints - 1);
    uint32_t from = uint32_t(segments);
    if (from > kPoints - 2) from = kPoints - 2;
    return {from, segments - float(from)};
  }
  static PELT_INLINE Vec3<V> LoadPoint(const Ports& ports, uint32_t i, uint32_t lane) {
    return i == 0 ? Load3<V>(ports.roots->position, lane)
                  : Load3<V>(ports.points->position[i - 1], lane);
  }

  static void Run(const Params& p, const Ports& ports) {
    using I = typename V::Int;
    using Mask = typename V::Mask;
    const Vec3<V> eye{V(p.eye[0]), V(p.eye[1]), V(p.eye[2])};
    const Vec3<V> forward{V(p.forward[0]), V(p.forward[1]), V(p.forward[2])};
    const bool cull = (ports.layer->flags & kLayerBackFaceCull) != 0;
    const V least_facing = V(-ports.layer->backface_tolerance);
    const uint32_t live = ports.state->live_strands;
    const Place place = FindPlace(ports.layer->sort_place);
    const bool has_cut = sort_key_detail::HasCut(*ports.state);
    uint32_t* keys = ports.keys->key;

    I seen = I(0);
    Mask differs = I(0) < I(0);
    uint32_t lane = 0;
    for (; lane < live; lane += V::kLanes) {
      Vec3<V> point = LoadPoint(ports, place.from, lane);
      if (place.share != 0.0f) {
        const Vec3<V> next = LoadPoint(ports, place.from + 1, lane);
        const Vec3<V> before = point * V(1.0f - place.share), behind = next * V(place.share);
        point = before + behind;
      }
      const V depth = Clamp(Dot(point - eye, forward), V(-3.0e38f), V(3.0e38f));
      Mask culled = !(I::Iota(int32_t(lane)) < I(int32_t(live)));
      if (cull) {
        const Vec3<V> to_eye = Normalize(eye - Load3<V>(ports.roots->position, lane));
        culled = culled | (Dot(Load3<V>(ports.roots->normal, lane), to_eye) < least_facing);
      }
      if (has_cut) culled = culled | sort_key_detail::AreCut<V>(*ports.state, lane);
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
