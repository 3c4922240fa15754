// Which layers are seen this frame, and what share of their strands.
//
// A layer is seen unless its box lies wholly outside one plane of the view (Gribb and Hartmann's
// planes against the box corner farthest along each: may keep a box that is outside, never drops
// one that is inside). The share follows the size of the box on the screen:
//
//   size_px = importance * box diagonal * pixels_per_unit_at_1m / distance from the eye to the box
//   wanted  = clamp(size_px / full_detail_pixels, min_fraction, 1)      stored for the budget
//   target  = wanted * min(budget_scale * importance, 1)
//
// so a layer never loses strands by coming nearer or growing. `fraction` follows `target` only when
// they differ by more than hysteresis * fraction, when the layer comes into view, or when target
// reaches 1 (a layer close up has all its strands). Near 1 that is no flicker: once at 1 it leaves
// only through the band. The last strands of the prefix fade out; the fade narrows to nothing as
// the share reaches 1, so it does not jump there either.
//
// Chains at mesh vertices thin with the strands and twice as fast, by halves (CountChains): a layer that
// lacks a strand simulates half of each patch's, with half of its strands a quarter, then an eighth.
// The others follow three that are kept. The loads of those that go or come are blended over 16 frames,
// so that nothing jumps: a chain that comes starts from the groom when nothing is seen of it yet. On
// `cast` with LOD 99 % of tips are 0.56 px off then where all chains leave 0.27, for two thirds of the
// frame on consoles; thinning like the strands leaves 0.41 and takes four fifths. A layer's own share of
// its chains (`chain_share`) is a level that it never falls below, with LOD or without.
//
// Shells are of whole layers: of one that is seen every strand (triangle) lives, at any distance
// that it has a shell at (select_shells.hpp), and the budget does not count them.
//
// Invariant: visible == 0 means fraction 0, and fraction > 0 means visible != 0. What breaks if
// ignored: chunks with no live strands in a visible layer would keep last frame's sort keys.
#pragma once

#include <span>

#include "core/box_distance.hpp"
#include "core/chunk.hpp"
#include "core/kernel.hpp"
#include "core/kernels/select_shells.hpp"
#include "core/layer.hpp"
#include "core/streams.hpp"
#include "core/view.hpp"

namespace pelt {

enum SelectLodFlag : uint32_t {
  kLodOn = 1u << 0,   // else every strand of a visible layer lives
  kCullOn = 1u << 1,  // else every enabled layer is visible
};

struct SelectLodParams {
  View view;
  float full_detail_pixels;  // on-screen box diagonal from which all strands live, px
  float min_fraction;        // least share a visible layer asks for, before the budget, 0..1
  float hysteresis;          // share of the present fraction a change must exceed, 0..1
  float budget_scale;        // from BudgetScale
  float fade_share;          // share of the living strands that fade, 0..1
  float least_chains;        // least share of a layer's chains that are simulated, 0..1
  uint32_t flags;            // SelectLodFlag
};

namespace select_lod_detail {

PELT_INLINE bool IsOutsidePlane(const float (&plane)[4], const BoundsBlock& box) {
  float distance = plane[3], magnitude = plane[3] < 0.0f ? -plane[3] : plane[3];
  for (int axis = 0; axis < 3; ++axis) {
    const float n = plane[axis];
    const float term = n * (n > 0.0f ? box.high[axis] : box.low[axis]);
    distance = distance + term;
    magnitude = magnitude + (term < 0.0f ? -term : term);
  }
  // Rounding of the four terms stays below this, so a box that touches the plane is kept.
  return distance < -1e-6f * magnitude;
}

PELT_INLINE bool IsVisible(const SelectLodParams& p, const LayerBlock& layer,
                           const BoundsBlock& box) {
  if (!(layer.flags & kLayerEnabled) || layer.strand_count == 0) return false;
  if (!(p.flags & kCullOn)) return true;
  bool outside = false;
  for (int i = 0; i < 6; ++i) outside = outside || IsOutsidePlane(p.view.planes[i], box);
  return !outside;
}

// Share of strands the box's size on the screen asks for.
template <class V>
PELT_INLINE float WantedFraction(const SelectLodParams& p, float importance,
                                 const BoundsBlock& box) {
  float diagonal2 = 0.0f, distance2 = SquaredDistance(p.view.eye, box);
  for (int axis = 0; axis < 3; ++axis) {
    const float edge = box.high[axis] - box.low[axis];
    diagonal2 = diagonal2 + edge * edge;
  }
  const float near2 = p.view.near_m * p.view.near_m;
  if (distance2 < near2) distance2 = near2;
  const float diagonal = Sqrt(V(diagonal2))[0], distance = Sqrt(V(distance2))[0];
  const float size_px = diagonal * p.view.pixels_per_unit_at_1m * importance;
  const float full_px = p.full_detail_pixels * distance;
  if (size_px >= full_px) return 1.0f;  // also when full_detail_pixels is 0
  const float wanted = size_px / full_px;
  return wanted < p.min_fraction ? p.min_fraction : wanted;
}

// The coarsest level at which at least half as large a share of the chains is simulated as of the
// strands live.
PELT_INLINE uint32_t LevelOf(float fraction, float least_chains) {
  if (fraction >= 1.0f) return 0;
  uint32_t level = 0;
  float share = 0.5f;
  while (level + 1 < kChainLevels && share >= 0.5f * fraction && share >= least_chains) {
    ++level;
    share = share * 0.5f;
  }
  return level;
}

// One step from level to level.
PELT_INLINE void FollowLevel(uint32_t target, LodBlock& lod) {
  constexpr float kStep = 1.0f / 16.0f;
  if (target > lod.chain_level) {  // fewer
    lod.parent_share = lod.parent_share + kStep;
    if (lod.parent_share < 1.0f) return;
    ++lod.chain_level;
    lod.parent_share = 0.0f;
  } else if (lod.parent_share > 0.0f) {
    lod.parent_share = lod.parent_share - kStep;
  } else if (target < lod.chain_level) {
    --lod.chain_level;
    lod.parent_share = 1.0f;
  }
}

// `present` is last frame's fraction, 0 when the layer was not visible.
PELT_INLINE float FollowTarget(float present, float target, float hysteresis) {
  if (present <= 0.0f || target >= 1.0f) return target;
  const float band = hysteresis * present;
  const float difference = target > present ? target - present : present - target;
  return difference > band ? target : present;
}

}  // namespace select_lod_detail

// A scale by which no layer loses a strand, where the least important one's importance is `least`.
PELT_INLINE float WholeScale(float least) { return least < 1.0f ? 2.0f / least : 1.0f; }

// What times a layer's importance is the share that it keeps of the strands that it wants, all of them from 1 on,
// such that the strands of all visible layers stay within the budget, from last frame's LOD blocks; WholeScale
// when they fit or when the budget is 0 (none). Reads `wanted`, which the budget does not act on, so
// that it settles at once and cannot swing. Living strands may exceed the budget by the hysteresis
// band and by one strand per chunk. Called on the caller's thread; both spans have one entry a layer.
PELT_INLINE float BudgetScale(std::span<const LodBlock> lod, std::span<const LayerBlock> layers,
                              uint32_t strand_budget) {
  // Strands with `scale`: of layers that keep all of theirs, and of the others for each 1 of it.
  double whole = 0.0, shared = 0.0, scale = 0.0;
  float least = 1.0f;
  const auto sum = [&] {
    whole = shared = 0.0;
    for (size_t i = 0; i < lod.size() && i < layers.size(); ++i) {
      const float importance = layers[i].importance;
      if (importance > 0.0f && importance < least) least = importance;
      if ((layers[i].flags & kLayerShells) || !lod[i].visible) continue;
      const double strands = double(lod[i].wanted) * double(layers[i].strand_count);
      if (scale * double(importance) >= 1.0)
        whole += strands;
      else
        shared += strands * double(importance);
    }
  };
  sum();
  // Of those that keep all there are more at each turn, until there are no more.
  while (strand_budget != 0 && shared > 0.0) {
    const double larger = (double(strand_budget) - whole) / shared;
    if (larger <= scale) return float(scale);
    scale = larger;
    sum();
  }
  return WholeScale(least);
}

template <class V>
struct SelectLod {
  static constexpr std::string_view kName = "select_lod";
  using Params = SelectLodParams;
  struct Ports {
    In<&Streams::layers> layer;
    In<&Streams::bounds> bounds;
    InOut<&Streams::lod> lod;
  };

  static PELT_INLINE void SetChains(const Params& p, const Ports& ports) {
    using namespace select_lod_detail;
    LodBlock& lod = *ports.lod;
    const bool thins = (p.flags & kLodOn) && !(ports.layer->flags & kLayerShells);
    const uint32_t least = (ports.layer->flags & kLayerChainLevel) >> kLayerChainLevelShift;
    uint32_t target = thins ? LevelOf(lod.fraction, p.least_chains) : 0;
    if (target < least) target = least;
    if (thins && lod.was_visible) {
      FollowLevel(target, lod);
    } else {
      lod.chain_level = target;
      lod.parent_share = 0.0f;
    }
  }

  static PELT_INLINE void SetFraction(const Params& p, const Ports& ports) {
    using namespace select_lod_detail;
    LodBlock& lod = *ports.lod;
    const bool shells = (ports.layer->flags & kLayerShells) != 0;
    if (!(p.flags & kLodOn) || shells) {
      const bool reached =
          !(p.flags & kLodOn) || !shells ||
          CountShells(ShellDistance2(p.view.eye, *ports.layer, *ports.bounds), 1) != 0;
      lod.wanted = lod.fraction = reached ? 1.0f : 0.0f;
      lod.fade = 0.0f;
      return;
    }
    const float importance = ports.layer->importance;
    lod.wanted = WantedFraction<V>(p, importance, *ports.bounds);
    const float left = p.budget_scale * importance;
    const float scaled = left < 1.0f ? lod.wanted * left : lod.wanted;
    const float present = lod.was_visible ? lod.fraction : 0.0f;
    lod.fraction = FollowTarget(present, scaled < 1.0f ? scaled : 1.0f, p.hysteresis);
    const float fade = p.fade_share * lod.fraction, room = 1.0f - lod.fraction;
    lod.fade = fade < room ? fade : room;
  }

  static void Run(const Params& p, const Ports& ports) {
    LodBlock& lod = *ports.lod;
    lod.was_visible = lod.visible;
    lod.visible = select_lod_detail::IsVisible(p, *ports.layer, *ports.bounds) ? 1u : 0u;
    if (lod.visible) SetFraction(p, ports);
    if (lod.visible && lod.fraction > 0.0f) {
      SetChains(p, ports);
      return;
    }
    lod.chain_level = 0;
    lod.parent_share = 0.0f;
    lod.visible = 0;
    lod.fraction = 0.0f;
    lod.fade = 0.0f;
    lod.wanted = 0.0f;
  }
};

}  // namespace pelt
