// What a shader is given of a strand besides its curve: which way the skin under it faces,
// where on the skin it stands, what is on it, and a number of its own. Shading fur needs the skin's
// normal, and a record of curves has none.
//
// Records lie in strand order, independent of the order of the vertices: a shader finds one by the strand's number,
// which every vertex format carries. So they are written when the strands' curves are, or when
// brushes changed what is on one of them, and not when only their order changes.
#pragma once

#include <string_view>

#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/kernels/write_lines.hpp"
#include "core/layer.hpp"
#include "core/streams.hpp"

namespace pelt {

namespace write_looks_detail {

using write_lines_detail::PackSigned;

// A unit vector as a point of the octahedron, unfolded to a square (Cigolle et al., A Survey of
// Efficient Representations for Independent Unit Vectors, JCGT 2014): x in the low 16 bits, y above.
template <class V>
PELT_INLINE typename V::Int PackOctahedral(const Vec3<V>& n) {
  const V zero(0.0f), one(1.0f), least(-1.0f);
  const V across = Abs(n.x) + Abs(n.y), sum = across + Abs(n.z);
  const V x = n.x / sum, y = n.y / sum;
  const V sign_x = Select(x < zero, least, one), sign_y = Select(y < zero, least, one);
  const V folded_x = (one - Abs(y)) * sign_x, folded_y = (one - Abs(x)) * sign_y;
  const auto below = n.z < zero;
  const V u = Clamp(Select(below, folded_x, x), least, one);
  const V v = Clamp(Select(below, folded_y, y), least, one);
  return PackSigned(u) | (PackSigned(v) << 16);
}

// Every bit depends on every bit (lowbias32, Wellons, Hash Function Prospector, 2018).
template <class I>
PELT_INLINE I MixWord(I a) {
  const I first(0x7feb352d), second(int32_t(0x846ca68bu));
  const I b = (a ^ (a >> 16)) * first, c = (b ^ (b >> 15)) * second;
  return c ^ (c >> 16);
}

}  // namespace write_looks_detail

namespace write_looks_detail {

template <bool kPainted>
struct Ports {
  Shared<&Streams::layers> layer;
  In<&Streams::chunk_state> state;
  In<&Streams::strand_uv> uv;
  In<&Streams::roots> roots;
  Out<&Streams::looks> looks;
};
template <>
struct Ports<true> {
  Shared<&Streams::layers> layer;
  In<&Streams::chunk_state> state;
  In<&Streams::strand_uv> uv;
  In<&Streams::roots> roots;
  In<&Streams::paint> paint;
  Out<&Streams::looks> looks;
};

// What weather puts on every strand of the layer. The colours of a layer that is not painted show
// its dirt already.
template <class V, bool kPainted>
PELT_INLINE typename V::Int WeatherAmounts(const LayerBlock& layer) {
  const V wet(layer.wetness * 255.0f + 0.5f);
  const typename V::Int wet_byte = Truncate(wet) << 16;
  if constexpr (!kPainted) return wet_byte;
  const V mud(layer.dirt * 255.0f + 0.5f);
  return wet_byte | Truncate(mud);
}

// The larger of what is there and what weather brings: it rains on who is wet already. For channels
// without the sign's bit, which compare where they are.
template <class I>
PELT_INLINE I LargerByte(I paint, I weather, PaintChannel channel) {
  const I byte(int32_t(255u << 8 * uint32_t(channel)));
  const I old = paint & byte, fresh = weather & byte;
  return (paint ^ old) | Select(old > fresh, old, fresh);
}

}  // namespace write_looks_detail

template <class V, bool kPainted>
struct WriteLooks {
  static constexpr std::string_view kName = kPainted ? "write_painted_looks" : "write_looks";
  using Ports = write_looks_detail::Ports<kPainted>;

  static void Run(const Ports& ports) {
    using namespace write_looks_detail;
    using I = typename V::Int;
    const uint32_t lanes = RoundUpToLaneGroups(ports.state->live_strands);
    const I weather = WeatherAmounts<V, kPainted>(*ports.layer);
    [[maybe_unused]] const bool is_fair = ports.layer->wetness == 0.0f && ports.layer->dirt == 0.0f;
    LookRecord* const record = ports.looks->record;
    for (uint32_t lane = 0; lane < lanes; lane += V::kLanes) {
      const I normal = PackOctahedral(Load3<V>(ports.roots->normal, lane));
      I amounts = weather;
      if constexpr (kPainted) {
        amounts = I::Load(ports.paint->amounts + lane);
        if (!is_fair) {
          amounts = LargerByte(amounts, weather, PaintChannel::kMud);
          amounts = LargerByte(amounts, weather, PaintChannel::kWet);
        }
      }
      const I random = MixWord(I::Iota(int32_t(ports.state->first_place + lane + 1)));
      const I uv = I::Load(ports.uv->uv + lane);
      ScatterRecords<V>(
          [&](int l) __attribute__((always_inline)) {
            return reinterpret_cast<float*>(record + lane + uint32_t(l));
          },
          FromBits(normal), FromBits(uv), FromBits(amounts), FromBits(random));
    }
  }
};

}  // namespace pelt
