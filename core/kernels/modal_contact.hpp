// What is left of contact when the substeps are done, and how strength and clump shape what is
// seen: points alone, never the state.
//
// The idea: the substeps push places out (modal_touch.hpp) to within what their few rounds leave, and
// the curve's points are cut back to their parts (modal_curve.hpp). So what is seen is walked from the root
// to the tip: with its upper end where it is, a part's lower end stays out of a plane or a sphere, or
// within a ball, exactly if the part leans far enough along one direction u (the normal; from the
// centre to the upper end, or back). A part that leans less is turned to u . d = least within its
// plane, and keeps its length l. Lanes that touch nothing keep their bits; groups that touch nothing skip
// all of it.
//
//          u                    upper end P, height h:       least = -h / l
//          |  / d               centre C, distance q = |P - C|, radius R:
//          | /                    outside                    least = (R^2 - q^2 - l^2) / (2 l q)
//   -------+------- plane         within, u towards C        least = (q^2 + l^2 - R^2) / (2 l q)
//
// The idea of strength and clump: they are shares of what the strand does (of its motion; of the way
// to the control strand). So they mean the same at every frame rate, cost no accuracy, and never fight
// the springs.
//
// Invariant: no part gets longer.
#pragma once

#include "core/kernels/chain.hpp"
#include "core/kernels/modal_touch.hpp"

namespace pelt::modal {

// What the substeps' contacts may leave of a part inside an obstacle, in parts.
inline constexpr float kLeftInside = 2.0e-4f;

// Walks over a part's obstacles: leaning out of one may lean into another.
inline constexpr int kContactPasses = 2;

// What parts are turned out of, of strands of so many.
template <class W, uint32_t kParts>
struct Walls {
  float hardness;      // of the surface
  float max_distance;  // from the groom; 0: no limit
  float allowed;       // what may be left inside, in parts
  W left[kParts];      // how deep a point may stay inside a collider, m: it leaves that slowly
  Colliders<W> colliders;

  PELT_INLINE Walls(const LayerBlock& layer, const SimulateParams& params,
                    const chain::Group<W, kParts>& g)
      : hardness(layer.surface_hardness), max_distance(layer.max_distance), allowed(0.0f) {
    for (W& depth : left) depth = W(0.0f);
    chain::LoadColliders(params, g, colliders);
    colliders.KeepRootsOut();
  }
};

// Turns part `i`, which starts at `from` and is 1 / `per_length` long, so that its end is beyond none of the
// walls. The limit comes first: what is solid wins. `lanes`: those that may lean out of the surface, which then
// are those that a collider has turned since.
template <class W, uint32_t kParts>
PELT_INLINE void LeanOut(const Walls<W, kParts>& walls, const chain::Group<W, kParts>& g,
                         uint32_t i, Vec3<W> from, W per_length, typename W::Mask& lanes,
                         Vec3<W>& d) {
  const W none = W(0.0f), never = W(-2.0f);
  if (walls.max_distance > 0.0f) {
    const Vec3<W> in = (g.rest[i] - from) * per_length;
    const W radius = g.length * per_length * W(walls.max_distance * float(i + 1));
    const W square = Dot(in, in), inverse = Rsqrt(Max(square, W(1.0e-12f)));
    const W least = (square + W(1.0f) - radius * radius) * (W(0.5f) * inverse);
    // d(distance) = d(u . d) / radius, near enough.
    LeanAlong(in * inverse, least, 1.0f, radius * W(walls.allowed), d);
  }
  if (walls.hardness > 0.0f && Any(lanes)) {
    // A share of the depth stays where the surface is soft.
    const W height = Dot(from, g.normal) * per_length, end = height + Dot(d, g.normal);
    const W least = Min(end, none) * W(1.0f - walls.hardness) - height;
    LeanAlong(g.normal, Select(lanes, least, never), kReach, W(walls.allowed), d);
  }
  if (walls.max_distance == 0.0f) lanes = none < never;
  const Vec3<W> part = d * (W(1.0f) / per_length);
  walls.colliders.ForEach([&](const auto& whole) __attribute__((always_inline)) {
    const auto shape = whole.Less(walls.left[i]);
    const LeanLimit<W> out = shape.Lean(from, d, per_length);
    // By the same rule as IsInside: a part that leads away from what its upper end lies on is not turned.
    const auto inside = IsLinkInside(shape, from, from + part, per_length * per_length);
    LeanAlong(out.u, Select(inside, out.least, never), kReach, W(walls.allowed), d);
    lanes = lanes | inside;
  });
}

// Lanes of which some point is beyond a wall.
template <class W, uint32_t kParts>
PELT_INLINE typename W::Mask IsInside(const Walls<W, kParts>& walls,
                                      const chain::Group<W, kParts>& g) {
  typename W::Mask inside = W(1.0f) < W(0.0f);
  for (uint32_t i = 0; i < kParts; ++i) {
    if (walls.hardness > 0.0f) inside = inside | (Dot(g.point[i], g.normal) < W(0.0f));
    if (walls.max_distance > 0.0f) {
      const Vec3<W> off = g.point[i] - g.rest[i];
      const W limit = g.length * W(walls.max_distance * float(i + 1));
      inside = inside | (Dot(off, off) > limit * limit);
    }
    walls.colliders.ForEach([&](const auto& shape) __attribute__((always_inline)) {
      const Vec3<W> from = i == 0 ? Vec3<W>{W(0.0f), W(0.0f), W(0.0f)} : g.point[i - 1];
      const Vec3<W> part = g.point[i] - from;
      const W per_square = W(1.0f) / Max(Dot(part, part), W(1.0e-12f));
      inside = inside | IsLinkInside(shape, from, g.point[i], per_square);
    });
  }
  return inside;
}

// Turns parts of `lanes` that have a point beyond a wall out of what they may not enter, root to tip. Out of line:
// points that are shaped are kept out once more.
template <class W, uint32_t kParts>
__attribute__((noinline)) void LeanPartsOut(const Walls<W, kParts>& walls, typename W::Mask lanes,
                                            chain::Group<W, kParts>& g) {
  lanes = IsInside(walls, g) & lanes;
  if (!Any(lanes)) return;
  Vec3<W> before = {W(0.0f), W(0.0f), W(0.0f)}, at = before;
  for (uint32_t i = 0; i < kParts; ++i) {
    const Vec3<W> part = g.point[i] - before;
    before = g.point[i];
    const W square = Max(Dot(part, part), W(1.0e-12f)), inverse = Rsqrt(square);
    W length = square * inverse;
    // A part that the curve has shortened must not keep its end from its groomed place.
    if (walls.max_distance > 0.0f) {
      const Vec3<W> in = g.rest[i] - at;
      const W far = Sqrt(Dot(in, in)) - g.length * W(walls.max_distance * float(i + 1));
      length = Max(length, Min(far, g.length));
    }
    Vec3<W> to = part * inverse;
    const W per_length = W(1.0f) / length;
    typename W::Mask leaning = lanes;
    for (int pass = 0; pass < kContactPasses; ++pass)
      LeanOut(walls, g, i, at, per_length, leaning, to);
    const Vec3<W> end = at + to * length;
    g.point[i] = Select<W>(lanes, end, g.point[i]);
    at = g.point[i];
  }
}

template <class W, uint32_t N>
PELT_INLINE void Directions(const Motion<W, N>& motion, Vec3<W> (&d)[N]) {
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i)
    d[i] = {motion.axis[0].d[i], motion.axis[1].d[i], motion.axis[2].d[i]};
}

// What parts are turned out of at the frame's end.
template <class W, uint32_t kParts>
PELT_INLINE Walls<W, kParts> EndWalls(const LayerBlock& layer, const SimulateParams& params,
                                      const chain::Group<W, kParts>& g) {
  Walls<W, kParts> walls(layer, params, g);
  walls.allowed = kLeftInside;
  // A soft surface is left to the substeps: taking a share of what they left is another motion.
  if (walls.hardness < 1.0f) walls.hardness = 0.0f;
  return walls;
}

// `left`: Walls'.
template <class W, uint32_t kParts>
PELT_INLINE void PushOut(const LayerBlock& layer, const SimulateParams& params,
                         const W (&left)[kParts], chain::Group<W, kParts>& g) {
  Walls<W, kParts> walls = EndWalls(layer, params, g);
  for (uint32_t i = 0; i < kParts; ++i) walls.left[i] = left[i];
  LeanPartsOut(walls, W(0.0f) < W(1.0f), g);
}

// A point goes the share `strength` of the way from its groomed place, all of it in lanes `full`.
template <class W, uint32_t kParts>
PELT_INLINE void Weaken(typename W::Mask full, W strength, chain::Group<W, kParts>& g) {
  for (uint32_t i = 0; i < kParts; ++i) {
    const Vec3<W> to = g.rest[i] + (g.point[i] - g.rest[i]) * strength;
    g.point[i] = Select<W>(full, g.point[i], to);
  }
}

// Every point goes its share of the way to the control strand's, `control` root-relative; parts keep their
// length. By how much they are longer than the way through the points adds up towards the tip; of 8 the
// last one would fold, so of more than 4 each goes as its two points lie. `clump`: of the layer, or each lane's.
template <class Clump, class W, uint32_t kParts>
PELT_INLINE void Gather(Clump clump, const Vec3<W> (&control)[kParts], chain::Group<W, kParts>& g) {
  Vec3<W> before = {W(0.0f), W(0.0f), W(0.0f)}, gathered = before, at = before;
  for (uint32_t i = 0; i < kParts; ++i) {
    const Vec3<W> part = g.point[i] - before;
    before = g.point[i];
    const Vec3<W> to =
        g.point[i] + (control[i] - g.point[i]) * W(chain::ClumpShare(clump, i, kParts));
    const Vec3<W> way = to - (kParts > 4 ? gathered : at);
    gathered = to;
    // |part| / |way| by one root.
    const W square = Dot(part, part), way2 = Max(Dot(way, way), W(1.0e-12f));
    g.point[i] = at + way * (square * Rsqrt(Max(square * way2, W(1.0e-30f))));
    at = g.point[i];
  }
}

// What is solid to drawn points that were shaped; where clumping may take them is not limited.
template <class W, uint32_t kParts>
PELT_INLINE Walls<W, kParts> DrawnWalls(const LayerBlock& layer, const SimulateParams& params,
                                        const chain::Group<W, kParts>& g) {
  Walls<W, kParts> walls(layer, params, g);
  walls.max_distance = 0.0f;
  walls.hardness = layer.modal.drawn_hardness;
  return walls;
}

// Points of shaped lanes keep out of that. `left`: Walls'.
template <class W, uint32_t kParts>
PELT_INLINE void KeepOut(const LayerBlock& layer, const SimulateParams& params,
                         typename W::Mask shaped, const W (&left)[kParts],
                         chain::Group<W, kParts>& g) {
  Walls<W, kParts> walls = DrawnWalls(layer, params, g);
  for (uint32_t i = 0; i < kParts; ++i) walls.left[i] = left[i];
  LeanPartsOut(walls, shaped, g);
}

}  // namespace pelt::modal
