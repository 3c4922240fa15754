// What a modal chain may touch, as its substeps see it: the plane through its root, the scene's
// colliders (collider.hpp), and the ball around its groomed place that a point may not leave
// (max_distance).
//
// The idea: near a point each is a plane, or a ball that the point stays out of or within. In
// either case a point that is beyond it has a normal that leads back, and a depth. Of several, the
// deepest counts. The point is one of the strand's places (modal_material.hpp); of round colliders, the nearest
// point of the line from the place before it.
//
// All in parts of the strand, from the root's place at the substep's end. The plane turns with the skin and the
// balls with the groom while the frame lasts; colliders go evenly to where they are at its end.
//
// What overlaps from before (a collider was put there, or a strand was laid into one) leaves at a
// bounded speed, or the push of a single substep would throw it: the more, the shorter the frame.
// What enters in this substep is stopped in it. A collider that is somewhere else than in the last
// frame, without a velocity, pushes at once: where it overlaps may be its way here.
#pragma once

#include "core/kernels/chain.hpp"
#include "core/kernels/collider.hpp"
#include "core/kernels/modal_curl.hpp"
#include "core/kernels/modal_curve.hpp"
#include "core/kernels/modal_step.hpp"

namespace pelt::modal {

// Where a round shape meets a link, not only its end: the link's nearest point, and whether the
// shape crossed a point between two moments.
//
// Invariant: a shape of radius 0 (one that does not count for a lane) meets nothing.

// Nearer to its upper end a link is not met: the link above has its end there, and hardly anything
// could turn this one out.
inline constexpr float kLeastShare = 0.25f;

// Where on the link `from` + share * `link` is nearest to the shape. `per_square`: 1 / |link|^2,
// near enough. Exact for spheres; for capsules it goes back and forth between link and axis.
template <class Shape, class W>
PELT_INLINE W NearestShare(const Shape& shape, Vec3<W> from, Vec3<W> link, W per_square) {
  W share = W(1.0f);
  for (int look = 0; look < Shape::kLooks; ++look) {
    const Vec3<W> point = from + link * share, way = shape.Core(point) - from;
    share = Clamp(Dot(way, link) * per_square, W(kLeastShare), W(1.0f));
  }
  return share;
}

// Whether anything of the link is inside.
template <class Shape, class W>
PELT_INLINE typename W::Mask IsLinkInside(const Shape& shape, Vec3<W> from, Vec3<W> to,
                                          W per_square) {
  if constexpr (Shape::kIsRound) {
    const Vec3<W> link = to - from;
    return shape.IsInside(from + link * NearestShare(shape, from, link, per_square));
  } else {
    return shape.IsInside(to);
  }
}

// A ball's crossing of a point: it goes from `first` to `last`, both as seen from the centre.
template <class W>
struct Crossing {
  typename W::Mask any;  // came from outside and got in
  W when;                // the share of its way at which it did
  Vec3<W> normal;        // and where

  PELT_INLINE Crossing(Vec3<W> first, Vec3<W> last, W radius) {
    const Vec3<W> way = last - first;
    const W a = Dot(way, way), b = Dot(first, way), c = Dot(first, first) - radius * radius;
    const W inner = b * b - a * c, none = W(0.0f);
    // What it touched already when it began to move may be a little inside.
    const W outside = radius * radius * W(-0.36f);
    const W enters = none - b - Sqrt(Max(inner, none));
    any = (radius > none) & (c > outside) & (b < none) & (inner > none) & (enters < a);
    when = enters / Max(a, W(1.0e-12f));
    const Vec3<W> hit = first + way * when;
    normal = hit * (W(1.0f) / Max(radius, W(1.0e-6f)));
  }
};

// Share of a chain's length that it is straightened to at most: where a root lies inside something,
// a point may not be able to get out, and a force that tries grows without bounds.
inline constexpr float kReach = 0.98f;

// m/s at which what overlaps a collider leaves it.
inline constexpr float kLeaving = 0.2f;

// How far a moving collider takes a point along in a substep, at most, over its distance from the
// root: what is faster is gone by the substep's end, and tangents turned further could not be solved.
inline constexpr float kFarthestHit = 0.15f;

PELT_INLINE bool HasLimit(const LayerBlock& layer) { return layer.max_distance > 0.0f; }

// One of them, as it stands to one point.
template <class W>
struct Obstacle {
  typename W::Mask any, round, goes;  // goes: it moves
  Vec3<W> centre, normal;             // the sphere's; the plane's
  W reach;                            // radius; offset of the plane along its normal
  W side;                             // -1: a sphere to stay within; else 1
  W carried, spins;                   // 1: moves with the root; turns with the skin
  Vec3<W> drift;                      // speed besides, parts/s
  W bounce;                           // share of the speed that comes back
  W eases;                            // 1: overlaps from before leave it slowly
  W left;                             // how deep a point may stay for now
  W share;                            // where on the line to its place the point is: 1: there

  PELT_INLINE void Clear() {
    const W none = W(0.0f);
    any = round = goes = W(1.0f) < none;
    centre = normal = drift = {none, none, none};
    reach = carried = spins = bounce = eases = left = none;
    side = share = W(1.0f);
  }
  // A collider, as it stands to a point near `at`. Only planes return speed (as in the other
  // solvers). `per_step`: parts/s for each metre of its way.
  template <class Shape>
  static PELT_INLINE Obstacle Of(const Shape& shape, const ColliderStep& step, Vec3<W> at,
                                 W plane_bounce, W per_step) {
    Obstacle o;
    o.Clear();
    if constexpr (Shape::kIsRound) {
      o.round = !o.any;
      o.centre = shape.Core(at);
      o.reach = shape.radius;
    } else {
      o.normal = shape.normal;
      o.reach = W(0.0f) - shape.height;
    }
    if constexpr (Shape::kBounces) o.bounce = plane_bounce;
    if (step.moves != 0) {
      const Vec3<W> way = shape.Velocity(step, at, 1.0f);
      o.drift = way * per_step;
      o.goes = !o.any;
    }
    if (step.at_once == 0) o.eases = W(1.0f);
    return o;
  }
  PELT_INLINE void Take(typename W::Mask lanes, const Obstacle& from) {
    round = (from.round & lanes) | (round & !lanes);
    goes = (from.goes & lanes) | (goes & !lanes);
    centre = Select<W>(lanes, from.centre, centre);
    normal = Select<W>(lanes, from.normal, normal);
    reach = Select(lanes, from.reach, reach);
    side = Select(lanes, from.side, side);
    carried = Select(lanes, from.carried, carried);
    spins = Select(lanes, from.spins, spins);
    drift = Select<W>(lanes, from.drift, drift);
    bounce = Select(lanes, from.bounce, bounce);
    eases = Select(lanes, from.eases, eases);
    left = Select(lanes, from.left, left);
    share = Select(lanes, from.share, share);
    any = any | lanes;
  }
  // Its point of a line.
  PELT_INLINE Vec3<W> PointOf(Vec3<W> from, Vec3<W> to) const {
    const Vec3<W> line = to - from, inner = from + line * share;
    return Select<W>(share < W(1.0f), inner, to);
  }
  // Puts it back to where a point at most `length` from the root can still get out of it. What
  // moved beyond that has let go of the strand.
  PELT_INLINE void KeepWithinReach(W length) {
    const W none = W(0.0f), far = Select(round, Sqrt(Dot(centre, centre)), none);
    const W most = far + length;
    drift = Select<W>((reach > most) & goes, {none, none, none}, drift);
    reach = Min(reach, most);
  }
  // What is faster than the strand can turn takes it along no faster.
  PELT_INLINE void SlowDown(Vec3<W> at, W time, W farthest) {
    const W none = W(0.0f), speed2 = Dot(drift, drift), flat = Dot(normal, at);
    const W slower = Min(farthest * Rsqrt(Max(speed2 * time * time, W(1.0e-12f))), W(1.0f));
    drift = Select<W>(goes, drift * slower, drift);
    const Vec3<W> out = at - centre;
    const W distance = Select(round, Sqrt(Dot(out, out)), flat);
    reach = Select(goes, reach - Max(reach - distance - farthest, none), reach);
  }
  // Gives way to a point that was inside already when the substep began, `before`, by all but what
  // may leave in a substep; `time` is its length, s.
  PELT_INLINE void Ease(Vec3<W> before, W time, W most) {
    const Vec3<W> was = before + drift * time, out = was - centre;
    const W flat = Dot(normal, was);
    const W distance = Select(round, Sqrt(Dot(out, out)), flat);
    left = Max(reach - distance - most, W(0.0f)) * eases;
    reach = reach - left;
  }
  // Normal and depth of a point; 0 where there is nothing.
  PELT_INLINE void Look(Vec3<W> at, Vec3<W>& n, W& depth) const {
    const W none = W(0.0f);
    const Vec3<W> out = at - centre;
    const W distance = Sqrt(Dot(out, out));
    const Vec3<W> away = out * (side / Max(distance, W(1.0e-6f)));
    n = Select<W>(any, Select<W>(round, away, normal), {none, none, none});
    depth = (reach - Select(round, distance, Dot(normal, at))) * side;
    depth = Select(any, depth, none);
  }
};

// Of strands of N nodes with Q places.
template <class W, uint32_t N, uint32_t Q>
struct Surroundings {
  using Mask = typename W::Mask;

  float hardness, plane_bounce, max_distance, friction;
  bool varies;                // lanes bounce otherwise than the layer:
  W bounce_factor;            // by this
  Vec3<W> end_surface, turn;  // normal of the plane through the root, and its change in this frame
  W per_length;
  float spacing;    // parts from place to place
  Vec3<W> base[Q];  // where places stand when all tangents are nothing
  W per_step;       // parts/s for each metre in this frame
  float before;     // the present substep's end, as a share of the frame from its end
  Colliders<W> colliders;
  // At the end of the present substep.
  Vec3<W> root;                      // from where it is at the frame's end
  Vec3<W> surface;                   // normal of the plane through it
  Vec3<W> groom[Q], groom_speed[Q];  // the groom's places from the root; parts/s from it
  Vec3<W> start[Q], start_root;      // places at its start, where PlaceStart was asked for them
  float time;                        // its length, s

  template <uint32_t kParts>
  PELT_INLINE void Load(const ModalTableBlock& t, const LayerBlock& layer,
                        const SimulateParams& params, Vec3<W> last_surface,
                        const Vec3<W> (&rest)[N], const chain::Group<W, kParts>& g) {
    hardness = layer.surface_hardness;
    plane_bounce = layer.bounce;
    varies = false;
    max_distance = layer.max_distance;
    friction = layer.modal.friction;
    surface = end_surface = g.normal;
    turn = g.normal - last_surface;
    per_length = W(1.0f) / g.length;
    spacing = float(kParts) / float(Q);
    BasePlaces(t, g, per_length, rest, base);
    per_step = per_length * W(t.euler_speed);
    chain::LoadColliders(params, g, colliders);
    colliders.KeepRootsOut();
  }

  // Share of the speed that a plane gives back.
  PELT_INLINE W Bounce() const {
    const W bounce = W(plane_bounce);
    return varies ? Min(bounce * bounce_factor, W(1.0f)) : bounce;
  }

  PELT_INLINE void Advance(const ModalTableBlock& t, uint32_t substep, const Motion<W, N>& motion) {
    const ModalSubstep& s = t.substep[substep];
    root = {WeighRoot(s.root_place, motion.axis[0].root),
            WeighRoot(s.root_place, motion.axis[1].root),
            WeighRoot(s.root_place, motion.axis[2].root)};
    before = 1.0f - float(substep + 1) / float(t.substeps);
    if (hardness > 0.0f)
      surface =
          before > 0.0f ? NormalizeOr(end_surface - turn * W(before), end_surface) : end_surface;
    time = t.frame_s / float(t.substeps);
    if (max_distance > 0.0f) PlaceGroom(t, s, motion);
  }

  PELT_INLINE bool HasColliders() const {
    return colliders.sphere_count > 0 || colliders.capsule_count > 0 || colliders.use_ground;
  }

  // Lanes of which some point is beyond something.
  PELT_INLINE Mask IsInside(const Vec3<W> (&at)[Q]) const {
    Mask inside = W(1.0f) < W(0.0f);
    if (hardness > 0.0f)
      for (uint32_t i = 0; i < Q; ++i) inside = inside | (Dot(at[i], surface) < W(0.0f));
    if (max_distance > 0.0f)
      for (uint32_t i = 0; i < Q; ++i) {
        const Vec3<W> off = at[i] - groom[i];
        inside = inside | (Dot(off, off) > W(Limit(i) * Limit(i)));
      }
    const Vec3<W> zero = {W(0.0f), W(0.0f), W(0.0f)};
    ForEachNow([&](const auto& shape, const ColliderStep&) __attribute__((always_inline)) {
      for (uint32_t i = 0; i < Q; ++i) {
        const Vec3<W> from = i == 0 ? zero : at[i - 1];
        inside = inside | IsLinkInside(shape, from, at[i], PerSquare(at[i] - from));
      }
    });
    return inside;
  }

  // Points at the substep's start, seen from where the root is at its end.
  PELT_INLINE void PlaceStart(const ModalTableBlock& t, uint32_t substep,
                              const Motion<W, N>& motion) {
    Vec3<W> was;
    if (substep == 0) {
      was = {motion.axis[0].root[0], motion.axis[1].root[0], motion.axis[2].root[0]};
      was = was * W(-1.0f);
    } else {
      const auto& place = t.substep[substep - 1].root_place;
      was = {WeighRoot(place, motion.axis[0].root), WeighRoot(place, motion.axis[1].root),
             WeighRoot(place, motion.axis[2].root)};
    }
    start_root = was - root;
    PlaceRows<W, N, Q>(t, motion, &Axis<W, N>::d, base, start);
    for (Vec3<W>& at : start) at = at + start_root;
  }

  // Where that point before place i was at the substep's start.
  PELT_INLINE Vec3<W> StartOf(uint32_t i, const Obstacle<W>& o) const {
    return o.PointOf(i == 0 ? start_root : start[i - 1], start[i]);
  }

  // What the line to place i, from `from` to `at`, is deepest beyond.
  PELT_INLINE void Find(uint32_t i, Vec3<W> from, Vec3<W> at, Obstacle<W>& found) const {
    const W none = W(0.0f), one = W(1.0f);
    const Mask never = one < none, always = !never;
    const Vec3<W> zero = {none, none, none};
    W deepest = none;  // signed distance, so below 0
    found.Clear();
    const auto take = [&](W distance, const Obstacle<W>& o) __attribute__((always_inline)) {
      found.Take(distance < deepest, o);
      deepest = Min(distance, deepest);
    };
    if (hardness > 0.0f) {
      const W height = Dot(at, surface);
      // A share of the depth stays where the surface is soft.
      const W reach = height * W(1.0f - hardness);
      take(height, {never, never, never, zero, surface, reach, one, one, one, zero, Bounce(), none,
                    none, one});
    }
    ForEachNow([&](const auto& shape, const ColliderStep& step) __attribute__((always_inline)) {
      W share = one;
      if constexpr (std::decay_t<decltype(shape)>::kIsRound)
        share = NearestShare(shape, from, at - from, PerSquare(at - from));
      Obstacle<W> o;
      o.share = share;
      const Vec3<W> point = o.PointOf(from, at);
      const W distance = shape.Distance(point);
      if (Any(distance < deepest)) {
        o = Obstacle<W>::Of(shape, step, point, Bounce(), per_step);
        o.share = share;
        take(distance, o);
      }
    });
    if (max_distance > 0.0f) {
      const W limit = W(Limit(i));
      const Vec3<W> off = at - groom[i];
      take(limit - Sqrt(Dot(off, off)), {never, always, never, groom[i], zero, limit, W(-1.0f), one,
                                         none, groom_speed[i], none, none, none, one});
    }
  }

 private:
  // Colliders as they are at the substep's end.
  template <class Visit>
  PELT_INLINE void ForEachNow(const Visit& visit) const {
    colliders.ForEachStep([&](const auto& collider, const ColliderStep& step)
                              __attribute__((always_inline)) {
                                auto now = collider;
                                if (step.moves != 0 && before > 0.0f)
                                  now = collider.Before(step, before);
                                visit(now.In(per_length, root), step);
                              });
  }
  PELT_INLINE float Limit(uint32_t i) const { return max_distance * spacing * float(i + 1); }
  static PELT_INLINE W PerSquare(Vec3<W> line) {
    return W(1.0f) / Max(Dot(line, line), W(1.0e-6f));
  }

  __attribute__((noinline)) void PlaceGroom(const ModalTableBlock& t, const ModalSubstep& s,
                                            const Motion<W, N>& motion) {
    W rest[3][N], moving[3][N];
    RestAt<W, N>(t, s.root_place, motion, rest);
    RestAt<W, N>(t, s.root_speed, motion, moving);
    const Vec3<W> none = {W(0.0f), W(0.0f), W(0.0f)};
    Vec3<W> r[N], speed[N], still[Q];
    for (Vec3<W>& at : still) at = none;
    for (uint32_t i = 0; i < N; ++i) {
      r[i] = {rest[0][i], rest[1][i], rest[2][i]};
      const Vec3<W> v = {moving[0][i], moving[1][i], moving[2][i]};
      speed[i] = v - Row(motion, &Axis<W, N>::rest, i);
    }
    PlaceVectors(t, r, base, groom);
    PlaceVectors(t, speed, still, groom_speed);
  }
};

// What a group's chains may meet in a frame.
template <class W, uint32_t N, uint32_t Q>
struct Meeting {
  bool use = false;  // false: there is nothing to meet, nothing below is set but `around.time`
  Surroundings<W, N, Q> around;
  W slow;  // parts/s, below which nothing bounces, or a resting strand would never rest

  template <uint32_t kParts>
  PELT_INLINE void Load(const ModalTableBlock& t, const LayerBlock& layer,
                        const SimulateParams& params, Vec3<W> last_surface,
                        const Vec3<W> (&rest)[N], const chain::Group<W, kParts>& g) {
    use = true;
    around.Load(t, layer, params, last_surface, rest, g);
    slow = W(chain::SlowContact(layer, params.dt) * t.euler_speed) * around.per_length;
  }
  // Of lanes with traits.
  template <class At>
  PELT_INLINE void Vary(const TraitBlock& own, const At& at) {
    slow = traits::Weigh(&own, at, slow);
    around.varies = true;
    around.bounce_factor = LoadLanes<W>(own.bounce, at);
  }
};

}  // namespace pelt::modal
