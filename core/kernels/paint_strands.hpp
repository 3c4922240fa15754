// Brushes on a chunk: what a strand has of mud, snow, water or dust grows, or shrinks, by how deep
// its root lies in each ball.
//
// Idea: amounts are bytes, and a brush adds a whole number of them: its amount times a falloff of
// the squared distance, rounded to nearest. A full brush paints all within `hardness` of its radius,
// and (1 - d^2) / (1 - h^2) of it beyond (d and h as shares of the radius), 0 at the radius. What
// one brush adds, the same brush below 0 takes away again; an amount stays within 0 and 255.
//
// Brushes act one after the other, each on what the one before has left, so their order matters where
// an amount meets 0 or 255: of a full brush and one that takes all away, the last has its way.
//
// A strand that does not live has no root, and is not painted: it keeps what it has. A brush too
// weak to add half a byte in a frame adds nothing, however long it stays.
//
// Invariant: without a brush that meets the layer's box not a byte is written, and kChunkPainted is
// set only if an amount has changed. What breaks if ignored: looks are written in every frame.
#pragma once

#include <algorithm>
#include <span>
#include <string_view>

#include "core/kernel.hpp"
#include "core/streams.hpp"
#include "core/surroundings.hpp"

namespace pelt {

// A brush as the kernel needs it.
struct PaintBall {
  float centre[3];  // m, world
  float radius2;    // m^2
  float slope;      // of the falloff, 1/m^2: it is 1 where this times (radius2 - distance^2) is
  float bytes;      // most that it adds, or takes away
  int32_t sign;
  uint32_t shift;  // of its channel in a strand's word
};

struct PaintStrandsParams {
  uint32_t count;
  PaintBall ball[kBrushesPerScene];
};

// Of the brushes that paint something at all.
PELT_INLINE PaintStrandsParams MakePaintStrandsParams(std::span<const PaintBrush> brushes) {
  constexpr float kSteepest = 3.0e38f, kLeast_m2 = 1.0e-30f;
  PaintStrandsParams p{};
  for (const PaintBrush& brush : brushes) {
    if (brush.amount == 0.0f || brush.radius == 0.0f) continue;
    PaintBall& ball = p.ball[p.count++];
    std::copy_n(brush.centre, 3, ball.centre);
    ball.radius2 = brush.radius * brush.radius;
    const float hard2 = brush.hardness * brush.hardness, soft_m2 = ball.radius2 * (1.0f - hard2);
    ball.slope = soft_m2 > kLeast_m2 ? 1.0f / soft_m2 : kSteepest;
    ball.bytes = 255.0f * (brush.amount < 0.0f ? -brush.amount : brush.amount);
    ball.sign = brush.amount < 0.0f ? -1 : 1;
    ball.shift = 8 * brush.channel;
  }
  return p;
}

namespace paint_strands_detail {

PELT_INLINE bool MeetsBox(const PaintBall& ball, const BoundsBlock& box) {
  float distance2 = 0.0f;
  for (int k = 0; k < 3; ++k) {
    const float c = ball.centre[k], low = box.low[k], high = box.high[k];
    const float apart = c < low ? low - c : (c > high ? c - high : 0.0f);
    distance2 += apart * apart;
  }
  return distance2 < ball.radius2;
}

// The balls that meet the box, as bits.
PELT_INLINE uint32_t FindMet(const PaintStrandsParams& p, const BoundsBlock& box) {
  uint32_t met = 0;
  for (uint32_t b = 0; b < p.count; ++b) met |= MeetsBox(p.ball[b], box) ? 1u << b : 0u;
  return met;
}

// The words of strands with roots at `at`, of which those below `live` are painted.
template <class V>
PELT_INLINE typename V::Int Paint(const PaintBall& ball, const Vec3<V>& at, typename V::Int strand,
                                  uint32_t live, typename V::Int word) {
  using I = typename V::Int;
  const I none(0), most(255), shifted = word >> int(ball.shift), old = shifted & most;
  const V x = at.x - V(ball.centre[0]), y = at.y - V(ball.centre[1]), z = at.z - V(ball.centre[2]);
  const V xx = x * x, yy = y * y, zz = z * z, distance2 = xx + yy + zz;
  const V left = V(ball.radius2) - distance2;
  const V share = Min(left * V(ball.slope), V(1.0f));
  const V bytes = share * V(ball.bytes) + V(0.5f);
  const auto inside = left > V(0.0f);
  const auto lives = strand < I(int32_t(live));
  const I step = Truncate(Select(inside & lives, bytes, V(0.0f))) * I(ball.sign);
  const I sum = old + step, above = Select(sum < none, none, sum);
  const I now = Select(above > most, most, above);
  return word ^ ((old ^ now) << int(ball.shift));
}

}  // namespace paint_strands_detail

template <class V>
struct PaintStrands {
  static constexpr std::string_view kName = "paint_strands";
  using Params = PaintStrandsParams;
  struct Ports {
    Shared<&Streams::bounds> bounds;
    In<&Streams::roots> roots;
    InOut<&Streams::chunk_state> state;
    InOut<&Streams::paint> paint;
  };

  static void Run(const Params& p, const Ports& ports) {
    using namespace paint_strands_detail;
    using I = typename V::Int;
    const uint32_t met = FindMet(p, *ports.bounds);
    if (met == 0) return;
    const uint32_t live = ports.state->live_strands, lanes = RoundUpToLaneGroups(live);
    uint32_t* const amounts = ports.paint->amounts;
    I changed(0);
    for (uint32_t lane = 0; lane < lanes; lane += V::kLanes) {
      const Vec3<V> at = Load3<V>(ports.roots->position, lane);
      const I strand = I::Iota(int32_t(lane)), old = I::Load(amounts + lane);
      I word = old;
      for (uint32_t b = 0; b < p.count; ++b)
        if (met >> b & 1) word = Paint<V>(p.ball[b], at, strand, live, word);
      word.Store(amounts + lane);
      changed = changed | (word ^ old);
    }
    if (!AllSet(changed == I(0))) ports.state->flags |= kChunkPainted;
  }
};

}  // namespace pelt
