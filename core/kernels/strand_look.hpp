// What a strand's record says about its looks: width, colours, tag. Shared by both fits.
//
// Colours are sRGB bytes and are mixed as such: darkened by the layer (wet), then mixed with the
// dirt's colour. Alpha carries the LOD fade of the last living strands. Work that would change
// nothing (dry and clean; no fade) is left out for the chunk, and would have given the same bytes.
#pragma once

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/kernels/prefetch.hpp"
#include "core/layer.hpp"
#include "core/simd.hpp"
#include "core/streams.hpp"

namespace pelt::look {

// Of a kernel that makes records of strands.
template <uint32_t kPoints, auto kWritten>
struct FitPorts {
  Shared<&Streams::layers> layer;
  In<&Streams::chunk_state> state;
  In<&Streams::strands> strands;
  In<&Streams::roots> roots;
  In<ChainStreams<kPoints, false>::kPosition> points;
  Out<kWritten> written;
};

template <class V>
struct StrandLook {
  typename V::Int base_colour, tip_colour, tag;
  V width;
};

// Rounds each of the three colour channels of byte * scale + add; keeps alpha.
template <class V>
PELT_INLINE typename V::Int Tint(typename V::Int colour, float scale, const V (&add)[3]) {
  using I = typename V::Int;
  I out = colour & I(int32_t(0xff000000u));
  for (int k = 0; k < 3; ++k) {
    const V byte = ToFloat((colour >> (8 * k)) & I(255));
    const V tinted = Clamp(byte * V(scale) + add[k] + V(0.5f), V(0.5f), V(255.5f));
    out = out | (Truncate(tinted) << (8 * k));
  }
  return out;
}

template <class V>
PELT_INLINE typename V::Int ScaleAlpha(typename V::Int colour, V share) {
  using I = typename V::Int;
  const V alpha = ToFloat((colour >> 24) & I(255)) * share + V(0.5f);
  return (colour & I(0x00ffffff)) | (Truncate(alpha) << 24);
}

// What weather makes of the layer's colours.
template <class V>
struct LayerTint {
  bool changes;
  float scale;
  V add[3];
};

template <class V>
PELT_INLINE LayerTint<V> MakeTint(const LayerBlock& layer) {
  LayerTint<V> tint{};
  tint.changes = !(layer.flags & kLayerPainted) && (layer.darken != 1.0f || layer.dirt > 0.0f);
  if (!tint.changes) return tint;
  tint.scale = layer.darken * (1.0f - layer.dirt);
  for (int k = 0; k < 3; ++k) tint.add[k] = V(layer.dirt * layer.dirt_colour[k] * 255.0f);
  return tint;
}

template <class V>
PELT_INLINE typename V::Int Tinted(const LayerTint<V>& tint, typename V::Int colour) {
  return tint.changes ? Tint<V>(colour, tint.scale, tint.add) : colour;
}

// The rows that Look reads.
PELT_INLINE auto RowsOfLook(const StrandBlock& strands) {
  static_assert(offsetof(StrandBlock, tip_colour) ==
                offsetof(StrandBlock, width) + 2 * sizeof strands.width);
  return RowsFrom<3, 2>(strands, strands.width);
}

// Lanes [lane, lane + kLanes) of the chunk.
template <class V>
PELT_INLINE StrandLook<V> Look(const LayerBlock& layer, const ChunkStateBlock& state,
                               const StrandBlock& strands, uint32_t lane) {
  using I = typename V::Int;
  const I lanes = I::Iota(int32_t(lane));
  StrandLook<V> look;
  const I base = I::Load(strands.base_colour + lane), tip = I::Load(strands.tip_colour + lane);
  const LayerTint<V> tint = MakeTint<V>(layer);
  look.base_colour = Tinted(tint, base);
  look.tip_colour = Tinted(tint, tip);
  if (state.fade_count > 0.0f) {
    const V left = (V(state.live_exact) - ToFloat(lanes)) / V(state.fade_count);
    const V share = Clamp(left, V(0.0f), V(1.0f));
    look.base_colour = ScaleAlpha<V>(look.base_colour, share);
    look.tip_colour = ScaleAlpha<V>(look.tip_colour, share);
  }
  look.width = V::Load(strands.width + lane) * V(layer.scale);
  look.tag = ((I(int32_t(strands.first_strand)) + lanes) & I(0x00ffffff)) |
             (I::LoadBytes(strands.film_strip + lane) << 24);
  return look;
}

}  // namespace pelt::look
