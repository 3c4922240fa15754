// What is left of contact when the substeps are done, and how strength and clump shape what is
// seen.
//
// The idea: the substeps push points out (modal_touch.hpp) to within what their few rounds leave,
// and the links' lengths come first. So at the frame's end links are walked from the root to the
// tip: with its upper end where it is, a link's lower end stays out of a plane or a sphere, or
// within a ball, exactly if the link leans far enough along one direction u (the normal; from the
// centre to the upper end, or back). A link that leans less is turned to u . d = least within its
// plane, and keeps its length; what its end's velocity has against u is taken from the link. Lanes
// that touch nothing keep their bits; groups that touch nothing skip all of it.
//
//          u                    upper end P, height h:       least = -h / l
//          |  / d               centre C, distance q = |P - C|, radius R:
//          | /                    outside                    least = (R^2 - q^2 - l^2) / (2 l q)
//   -------+------- plane         within, u towards C        least = (q^2 + l^2 - R^2) / (2 l q)
//
// The idea of strength and clump: they are shares of what the chain does (of its motion; of the way
// to the control strand) and act on the points alone, never on the state. So they mean the same at
// every frame rate, cost no accuracy, and never fight the springs.
//
// Invariant: unit directions in, unit directions out.
#pragma once

#include "core/kernels/chain.hpp"
#include "core/kernels/modal_touch.hpp"

namespace pelt::modal {

// What the substeps' contacts may leave of a link inside an obstacle, in links: turning it out of
// every rounding would keep a resting strand awake.
inline constexpr float kLeftInside = 2.0e-4f;

// Walks over a link's obstacles: leaning out of one may lean into another.
inline constexpr int kContactPasses = 2;

// The end of link i from its upper end's place, root-relative, m. The first adds nothing: a lane
// that is placed once more, because its neighbours are, must keep the sign of a zero.
template <class W, uint32_t N>
PELT_INLINE void PlacePoint(uint32_t i, const Vec3<W> (&d)[N], chain::Group<W, N>& g) {
  const Vec3<W> link = d[i] * g.length;
  g.point[i] = i == 0 ? link : g.point[i - 1] + link;
}

// Points from directions.
template <class W, uint32_t N>
PELT_INLINE void PlacePoints(const Vec3<W> (&d)[N], chain::Group<W, N>& g) {
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i) PlacePoint(i, d, g);
}

// Directions from points, the points put back at the links' length: each link towards its point. By
// how much links are longer than the way through the points adds up towards the tip; of 8 links the
// last one would fold, so of more than 4 each goes as its two points lie.
template <class W, uint32_t N>
PELT_INLINE void LayLinks(chain::Group<W, N>& g, Vec3<W> (&d)[N]) {
  Vec3<W> at = {W(0.0f), W(0.0f), W(0.0f)};
  for (uint32_t i = 0; i < N; ++i) {
    const Vec3<W> point = g.point[i];
    d[i] = NormalizeOr(point - at, d[i]);
    PlacePoint(i, d, g);
    at = N > 4 ? point : g.point[i];
  }
}

// What the end of a link touches: the last of them, where there are several.
template <class W>
struct Contact {
  typename W::Mask any = W(1.0f) < W(0.0f);
  Vec3<W> normal = {W(0.0f), W(0.0f), W(0.0f)};
  W carried = W(0.0f);                          // 1: moves with the root
  W bounce = W(0.0f);                           // share of the speed that comes back
  Vec3<W> drift = {W(0.0f), W(0.0f), W(0.0f)};  // its own speed, links/s
};

// What links are turned out of.
template <class W, uint32_t N>
struct Walls {
  float hardness;      // of the surface
  float bounce;        // of planes; round shapes give nothing back (as in the other solvers)
  float max_distance;  // from the groom; 0: no limit
  float allowed;       // what may be left inside, in links
  float per_s;         // frames
  W left[N];           // how deep a point may stay inside a collider, m: it leaves that slowly
  Colliders<W> colliders;

  PELT_INLINE Walls(const LayerBlock& layer, const SimulateParams& params,
                    const chain::Group<W, N>& g)
      : hardness(layer.surface_hardness),
        bounce(layer.bounce),
        max_distance(layer.max_distance),
        allowed(0.0f),
        per_s(1.0f / params.dt) {
    for (W& depth : left) depth = W(0.0f);
    chain::LoadColliders(params, g, colliders);
    colliders.KeepRootsOut();
  }
};

// d turned towards the unit vector u until u . d is `least`, `most` at most, where it is less.
template <class W>
PELT_INLINE void LeanAlong(Vec3<W> u, W least, float most, float allowed, float carried,
                           float bounce, Vec3<W> drift, Vec3<W>& d, Contact<W>& contact) {
  const W wanted = Clamp(least, W(-1.0f), W(most));
  const typename W::Mask inside = Dot(u, d) < Min(least, W(most)) - W(allowed);
  if (!Any(inside)) return;
  const Vec3<W> across = UnitAcross(u, d);
  const Vec3<W> along = u * wanted;
  const Vec3<W> turned = along + across * Sqrt(Max(W(1.0f) - wanted * wanted, W(0.0f)));
  d = Select<W>(inside, turned, d);
  contact.any = contact.any | inside;
  contact.normal = Select<W>(inside, u, contact.normal);
  contact.carried = Select(inside, W(carried), contact.carried);
  contact.bounce = Select(inside, W(bounce), contact.bounce);
  contact.drift = Select<W>(inside, drift, contact.drift);
}

// Turns link `i`, which starts at `from`, so that its end is beyond none of the walls. The limit
// comes first: what is solid wins.
template <class W, uint32_t N>
PELT_INLINE void LeanOut(const Walls<W, N>& walls, const chain::Group<W, N>& g, uint32_t i,
                         Vec3<W> from, W per_length, Vec3<W>& d, Contact<W>& contact) {
  const W none = W(0.0f);
  const Vec3<W> still = {none, none, none};
  if (walls.max_distance > 0.0f) {
    const Vec3<W> in = (g.rest[i] - from) * per_length;
    const float radius = walls.max_distance * float(i + 1);
    const W square = Dot(in, in), inverse = Rsqrt(Max(square, W(1.0e-12f)));
    const W least = (square + W(1.0f - radius * radius)) * (W(0.5f) * inverse);
    // The substeps have taken the speed it had out of there, and know how the groom turns.
    Contact<W> place_only;
    // d(distance) = d(u . d) / radius, near enough.
    LeanAlong(in * inverse, least, 1.0f, walls.allowed * radius, 1.0f, 0.0f, still, d, place_only);
  }
  if (walls.hardness > 0.0f) {
    // A share of the depth stays where the surface is soft.
    const W height = Dot(from, g.normal) * per_length, end = height + Dot(d, g.normal);
    LeanAlong(g.normal, Min(end, none) * W(1.0f - walls.hardness) - height, kReach, walls.allowed,
              1.0f, walls.bounce, still, d, contact);
  }
  walls.colliders.ForEachStep([&]<class Shape>(
      const Shape& whole, const ColliderStep& step) __attribute__((always_inline)) {
    const auto shape = whole.Less(walls.left[i]);
    const LeanLimit<W> out = shape.Lean(from, d, per_length);
    Vec3<W> drift = {none, none, none};
    if (step.moves != 0) {
      drift = shape.Velocity(step, from, walls.per_s);
      drift = drift * per_length;
    }
    LeanAlong(out.u, out.least, kReach, walls.allowed, 0.0f, Shape::kBounces ? walls.bounce : 0.0f,
              drift, d, contact);
  });
}

// Lanes of which some point is beyond a wall.
template <class W, uint32_t N>
PELT_INLINE typename W::Mask IsInside(const Walls<W, N>& walls, const chain::Group<W, N>& g) {
  typename W::Mask inside = W(1.0f) < W(0.0f);
  const W per_square = W(1.0f) / (g.length * g.length);
  for (uint32_t i = 0; i < N; ++i) {
    if (walls.hardness > 0.0f) inside = inside | (Dot(g.point[i], g.normal) < W(0.0f));
    if (walls.max_distance > 0.0f) {
      const Vec3<W> off = g.point[i] - g.rest[i];
      const W limit = g.length * W(walls.max_distance * float(i + 1));
      inside = inside | (Dot(off, off) > limit * limit);
    }
    walls.colliders.ForEach([&](const auto& shape) __attribute__((always_inline)) {
      const Vec3<W> from = i == 0 ? Vec3<W>{W(0.0f), W(0.0f), W(0.0f)} : g.point[i - 1];
      inside = inside | IsLinkInside(shape, from, g.point[i], per_square);
    });
  }
  return inside;
}

// Turns the lanes' links out of what they may not enter, root to tip, and places their points.
template <class W, uint32_t N>
PELT_INLINE void LeanChainOut(const Walls<W, N>& walls, typename W::Mask lanes,
                              chain::Group<W, N>& g, Vec3<W> (&d)[N], Contact<W> (&contact)[N]) {
  const W per_length = W(1.0f) / g.length;
  Vec3<W> at = {W(0.0f), W(0.0f), W(0.0f)};
  for (uint32_t i = 0; i < N; ++i) {
    Vec3<W> to = d[i];
    contact[i] = {};
    for (int pass = 0; pass < kContactPasses; ++pass)
      LeanOut(walls, g, i, at, per_length, to, contact[i]);
    d[i] = Select<W>(lanes, to, d[i]);
    PlacePoint(i, d, g);
    at = g.point[i];
  }
}

template <class W, uint32_t N>
PELT_INLINE void Directions(const Motion<W, N>& motion, Vec3<W> (&d)[N]) {
  PELT_UNROLL
  for (uint32_t i = 0; i < N; ++i)
    d[i] = {motion.axis[0].d[i], motion.axis[1].d[i], motion.axis[2].d[i]};
}

// Below this share of a link's motion across itself can its end move along the normal.
inline constexpr float kLeastLever = 0.05f;

// Takes directions d for the lanes given, and from each link that touches something the speed its
// end has into it. `slow`: links/s, below which nothing bounces, or a resting strand would never
// rest.
template <class W, uint32_t N>
PELT_INLINE void TakeContact(const ModalTable<N>& t, const Vec3<W> (&d)[N],
                             const Contact<W> (&contact)[N], W slow, typename W::Mask lanes,
                             Motion<W, N>& motion) {
  Vec3<W> v[N];
  for (uint32_t i = 0; i < N; ++i)
    v[i] = {Weigh<W, N>(t.shape[i], motion.axis[0].z), Weigh<W, N>(t.shape[i], motion.axis[1].z),
            Weigh<W, N>(t.shape[i], motion.axis[2].z)};
  const Vec3<W> root = {WeighRoot(t.root_end_speed, motion.axis[0].root),
                        WeighRoot(t.root_end_speed, motion.axis[1].root),
                        WeighRoot(t.root_end_speed, motion.axis[2].root)};
  v[0] = v[0] - root;
  Vec3<W> end = {W(0.0f), W(0.0f), W(0.0f)};
  for (uint32_t i = 0; i < N; ++i) {
    const Vec3<W> n = contact[i].normal;
    const Vec3<W> tangent = v[i] - d[i] * Dot(v[i], d[i]);
    const Vec3<W> point = end + tangent + root * (W(1.0f) - contact[i].carried) - contact[i].drift;
    const W into = Max(W(0.0f) - Dot(point, n), W(0.0f));
    const Vec3<W> lever = n - d[i] * Dot(n, d[i]);
    const W back = W(1.0f) + Select(into > slow, contact[i].bounce, W(0.0f));
    const W push = into * back / Max(Dot(lever, lever), W(kLeastLever));
    v[i] = Select<W>(contact[i].any, tangent + lever * push, v[i]);
    end = end + v[i];
  }
  v[0] = v[0] + root;
  for (uint32_t k = 0; k < 3; ++k) {
    Axis<W, N>& a = motion.axis[k];
    W part[N];
    for (uint32_t i = 0; i < N; ++i) {
      part[i] = k == 0 ? v[i].x : k == 1 ? v[i].y : v[i].z;
      a.d[i] = Select(lanes, k == 0 ? d[i].x : k == 1 ? d[i].y : d[i].z, a.d[i]);
    }
    for (uint32_t m = 0; m < N; ++m) a.z[m] = Select(lanes, Weigh<W, N>(t.image[m], part), a.z[m]);
  }
}

// What links are turned out of at the frame's end.
template <class W, uint32_t N>
PELT_INLINE Walls<W, N> EndWalls(const LayerBlock& layer, const SimulateParams& params,
                                 const chain::Group<W, N>& g) {
  Walls<W, N> walls(layer, params, g);
  walls.allowed = kLeftInside;
  // A soft surface is left to the substeps: taking a share of what they left is another motion.
  if (walls.hardness < 1.0f) walls.hardness = 0.0f;
  return walls;
}

// Needs g.point placed; leaves them placed. `left`: Walls'.
template <class W, uint32_t N>
PELT_INLINE void PushOut(const ModalTable<N>& t, const LayerBlock& layer,
                         const SimulateParams& params, const W (&left)[N], chain::Group<W, N>& g,
                         Motion<W, N>& motion) {
  Walls<W, N> walls = EndWalls(layer, params, g);
  for (uint32_t i = 0; i < N; ++i) walls.left[i] = left[i];
  const auto touching = IsInside(walls, g);
  if (!Any(touching)) return;
  Vec3<W> d[N];
  Contact<W> contact[N];
  Directions(motion, d);
  LeanChainOut(walls, touching, g, d, contact);
  const W slow = W(chain::SlowContact(layer, params.dt) * t.euler_speed) / g.length;
  TakeContact(t, d, contact, slow, touching, motion);
}

// A link goes the share `strength` of the way from its rest direction, all of it in lanes `full`.
template <class W, uint32_t N>
PELT_INLINE void Weaken(typename W::Mask full, W strength, const Vec3<W> (&rest)[N],
                        Vec3<W> (&d)[N]) {
  for (uint32_t i = 0; i < N; ++i) {
    const Vec3<W> to = NormalizeOr(rest[i] + (d[i] - rest[i]) * strength, rest[i]);
    d[i] = Select<W>(full, d[i], to);
  }
}

// Every point goes its share of the way to the control strand's, `control` root-relative; links
// keep their length.
template <class W, uint32_t N>
PELT_INLINE void Gather(float clump, const Vec3<W> (&control)[N], chain::Group<W, N>& g,
                        Vec3<W> (&d)[N]) {
  for (uint32_t i = 0; i < N; ++i)
    g.point[i] = g.point[i] + (control[i] - g.point[i]) * W(chain::ClumpShare(clump, i, N));
  LayLinks(g, d);
}

// Points of shaped lanes keep out of what is solid; where clumping may take them is not limited.
template <class W, uint32_t N>
PELT_INLINE void KeepOut(const LayerBlock& layer, const SimulateParams& params,
                         typename W::Mask shaped, const W (&left)[N], chain::Group<W, N>& g,
                         Vec3<W> (&d)[N]) {
  Walls<W, N> walls(layer, params, g);
  for (uint32_t i = 0; i < N; ++i) walls.left[i] = left[i];
  walls.max_distance = 0.0f;
  const typename W::Mask inside = IsInside(walls, g) & shaped;
  if (!Any(inside)) return;
  Contact<W> contact[N];
  LeanChainOut(walls, inside, g, d, contact);
}

}  // namespace pelt::modal
