// What hair stays out of: a struct for each shape, and the list of those that a group of chains may
// touch. Every solver, the modal contact and the finish of a frame know a shape by what is below
// and by nothing else.
//
//   Distance(p)    signed distance of a point; below 0 inside
//   Normal(p)      unit direction that leads out
//   IsInside(p)    Distance(p) < 0, as cheap as the shape has it
//   PushOut(p)     p, or the nearest point that is not inside
//   In(scale, o)   the shape in other units, from another origin: scale * x - o
//   Before(s, f)   the shape at the share f of a frame before its end, s its way in that frame
//   Velocity(...)  what moves at the point of its core nearest to p, for such a way
//   Less(depth)    smaller by that much on every side, but never less than nothing
//   Lean(...)      how far a link must lean for its end to be outside; of a sphere: all of it
//   kLooks         how often to look for a link's nearest point (modal_obstacle.hpp); round ones alone
//   kIsRound       stood for, near a point, by the ball of `radius` about Core(p); else by a plane
//   kBounces       gives speed back
//
// A round shape is what lies within `radius` of its core. It says Core(p), the core's point that is
// nearest to p, and gets the rest from Round, Lean apart.
//
// Coordinates are relative to the chain's root. Invariant: a shape treats lanes independently, and
// from finite input gives finite output. Operands that are vectors are named
// (platform_sim/pricing/trace.hpp).
#pragma once

#include <cstdint>

#include "core/kernels/simulate_params.hpp"
#include "core/simd.hpp"

namespace pelt {

// A link of length 1 ends outside where u . d >= least, d its direction; below -1: wherever it
// points.
template <class W>
struct LeanLimit {
  Vec3<W> u;
  W least;
};

template <class W>
PELT_INLINE Vec3<W> Way(const float (&step)[3], float scale) {
  return {W(step[0] * scale), W(step[1] * scale), W(step[2] * scale)};
}

// A half-space: free where normal . p + height >= 0.
template <class W>
struct Plane {
  static constexpr bool kIsRound = false, kBounces = true;
  Vec3<W> normal;
  W height;

  PELT_INLINE W Distance(Vec3<W> p) const { return Dot(normal, p) + height; }
  PELT_INLINE Vec3<W> Normal(Vec3<W>) const { return normal; }
  PELT_INLINE typename W::Mask IsInside(Vec3<W> p) const { return Distance(p) < W(0.0f); }
  PELT_INLINE Vec3<W> PushOut(Vec3<W> p) const { return p - normal * Min(Distance(p), W(0.0f)); }
  PELT_INLINE Plane In(W scale, Vec3<W> origin) const {
    return {normal, height * scale + Dot(normal, origin)};
  }
  PELT_INLINE Plane Before(const ColliderStep& step, float share) const {
    const Vec3<W> way = Way<W>(step.from, share);
    return {normal, height + Dot(normal, way)};
  }
  PELT_INLINE Vec3<W> Velocity(const ColliderStep& step, Vec3<W>, float scale) const {
    return Way<W>(step.from, scale);
  }
  PELT_INLINE Plane Less(W depth) const { return {normal, height + depth}; }
  PELT_INLINE LeanLimit<W> Lean(Vec3<W> from, Vec3<W>, W per_length) const {
    return {normal, W(0.0f) - Distance(from) * per_length};
  }
};

template <class W, class Shape>
struct Round {
  static constexpr bool kIsRound = true, kBounces = false;
  W radius;  // 0: nothing is inside

  PELT_INLINE W Distance(Vec3<W> p) const {
    const Vec3<W> out = Out(p);
    return Sqrt(Dot(out, out)) - radius;
  }
  PELT_INLINE Vec3<W> Normal(Vec3<W> p) const {
    const Vec3<W> out = Out(p);
    return out * Rsqrt(Max(Dot(out, out), W(1.0e-12f)));
  }
  PELT_INLINE typename W::Mask IsInside(Vec3<W> p) const {
    const Vec3<W> out = Out(p);
    return Dot(out, out) < radius * radius;
  }
  PELT_INLINE Vec3<W> PushOut(Vec3<W> p) const {
    const Vec3<W> core = Self().Core(p), out = p - core;
    const W square = Dot(out, out);
    const auto inside = square < radius * radius;
    const Vec3<W> moved = core + out * (radius * Rsqrt(square));
    return Select<W>(inside, moved, p);
  }

 private:
  PELT_INLINE const Shape& Self() const { return static_cast<const Shape&>(*this); }
  PELT_INLINE Vec3<W> Out(Vec3<W> p) const { return p - Self().Core(p); }
};

template <class W>
struct Sphere : Round<W, Sphere<W>> {
  static constexpr int kLooks = 1;
  using Round<W, Sphere>::radius;
  Vec3<W> centre;

  PELT_INLINE Vec3<W> Core(Vec3<W>) const { return centre; }
  PELT_INLINE Sphere In(W scale, Vec3<W> origin) const {
    return {{radius * scale}, centre * scale - origin};
  }
  PELT_INLINE Sphere Before(const ColliderStep& step, float share) const {
    const Vec3<W> way = Way<W>(step.from, share);
    return {{radius}, centre - way};
  }
  PELT_INLINE Vec3<W> Velocity(const ColliderStep& step, Vec3<W>, float scale) const {
    return Way<W>(step.from, scale);
  }
  PELT_INLINE Sphere Less(W depth) const { return {{Max(radius - depth, W(0.0f))}, centre}; }
  // With the link's upper end at distance q: (radius^2 - q^2 - 1) / (2 q); where the link is long
  // enough to reach the sphere's tangent, -t / q, t its length.
  PELT_INLINE LeanLimit<W> Lean(Vec3<W> from, Vec3<W>, W per_length) const {
    const Vec3<W> out = (from - centre) * per_length;
    const W square = Dot(out, out), reach = radius * per_length;
    const W inverse = Rsqrt(Max(square, W(1.0e-12f)));
    const W beyond = square - reach * reach;
    const W near = (W(-1.0f) - beyond) * (W(0.5f) * inverse);
    const W tangent = W(0.0f) - Sqrt(Max(beyond, W(0.0f))) * inverse;
    // Also for a link that starts on the sphere, with room for rounding.
    const auto touches = (beyond > W(-1.0e-3f)) & (beyond < W(1.0f));
    const W least = Select(touches, tangent, near);
    return {out * inverse, Select(reach > W(0.0f), least, W(-2.0f))};
  }
};

// What a sphere covers on its way from one point along an axis.
template <class W>
struct Capsule : Round<W, Capsule<W>> {
  static constexpr int kLooks = 3;
  using Round<W, Capsule>::radius;
  Vec3<W> from, axis;  // axis: unit; 0: a sphere
  W length;

  PELT_INLINE Vec3<W> Core(Vec3<W> p) const {
    const W along = Clamp(Dot(p - from, axis), W(0.0f), length);
    return from + axis * along;
  }
  PELT_INLINE Capsule In(W scale, Vec3<W> origin) const {
    return {{radius * scale}, from * scale - origin, axis, length * scale};
  }
  PELT_INLINE Capsule Before(const ColliderStep& step, float share) const {
    const Vec3<W> way = Way<W>(step.from, share), other = Way<W>(step.to, share);
    const Vec3<W> start = from - way, parting = way - other;
    const Vec3<W> span = axis * length + parting;
    const W long2 = Dot(span, span);
    return {{radius}, start, span * Rsqrt(Max(long2, W(1.0e-12f))), Sqrt(long2)};
  }
  PELT_INLINE Vec3<W> Velocity(const ColliderStep& step, Vec3<W> p, float scale) const {
    const W along = Clamp(Dot(p - from, axis), W(0.0f), length);
    const W share = along / Max(length, W(1.0e-6f));
    const Vec3<W> first = Way<W>(step.from, scale), second = Way<W>(step.to, scale);
    return first + (second - first) * share;
  }
  PELT_INLINE Capsule Less(W depth) const {
    return {{Max(radius - depth, W(0.0f))}, from, axis, length};
  }
  // Of an end that is nearest to a cap, as a sphere's. Nearest to what lies between the caps, it
  // must keep its distance from the axis: with the upper end at distance q from that, `bent` the
  // square of how much of the link's turn is along it, and c = u . d,
  //
  //   (q + c)^2 + (1 - bent) (1 - c^2) = radius^2,   the larger root.
  //
  // A link whose end has come out on the other side is left there, as a sphere leaves it.
  PELT_INLINE LeanLimit<W> Lean(Vec3<W> upper, Vec3<W> d, W per_length) const {
    const W none = W(0.0f), one = W(1.0f), reach = radius * per_length;
    const Vec3<W> start = (upper - from) * per_length, end = start + d;
    const W top = length * per_length, ended = Dot(end, axis);
    const W nearest = Clamp(ended, none, top);
    const Vec3<W> past = end - axis * nearest;
    const auto inside = Dot(past, past) < reach * reach;
    const auto between = (ended > none) & (ended < top);
    const Vec3<W> out = start - axis * Select(between, Dot(start, axis), nearest);
    const W square = Dot(out, out), inverse = Rsqrt(Max(square, W(1.0e-12f)));
    const Vec3<W> u = out * inverse;
    const W q = square * inverse, leaning = Dot(u, d), along = Dot(d, axis);
    const W across = Max(one - leaning * leaning, W(1.0e-6f));
    const W bent = Select(between, Min(along * along / across, one), none);
    const W rest = square + one - bent - reach * reach;
    const W root = Sqrt(Max(square - bent * rest, none));
    const W least = (none - rest) / Max(q + root, W(1.0e-6f));
    // From on the axis every direction leads out, and none is nearest.
    const auto leads = square > W(1.0e-12f);
    return {u, Select(inside & leads, least, W(-2.0f))};
  }
};

// What one group of chains may touch. A round shape counts for a lane only when it can touch the
// box the lane's points start in; groups none of whose lanes count leave it out. The choice is made
// by lane, so it cannot depend on the lane count. What the group has (the counts, `moves`) does:
// it may skip work and decide nothing.
template <class W>
struct Colliders {
  Plane<W> ground;
  Sphere<W> sphere[kSpheresPerScene];  // radius 0 for lanes it does not count for
  Capsule<W> capsule[kCapsulesPerScene];
  uint32_t sphere_count, capsule_count;
  bool use_ground;
  const ColliderStep* ground_step;
  const ColliderStep* sphere_step[kSpheresPerScene];
  const ColliderStep* capsule_step[kCapsulesPerScene];
  bool moves;            // one of them
  typename W::Mask any;  // lanes for which something counts

  static PELT_INLINE bool HasAny(const SimulateParams& params) {
    return params.sphere_count > 0 || params.capsule_count > 0 || params.use_ground;
  }

  static PELT_INLINE bool HasMoving(const SimulateParams& params) {
    bool moves = params.use_ground != 0 && params.ground_step.moves != 0;
    for (uint32_t s = 0; s < Spheres(params); ++s) moves |= params.sphere_step[s].moves != 0;
    for (uint32_t c = 0; c < Capsules(params); ++c) moves |= params.capsule_step[c].moves != 0;
    return moves;
  }

  // `reach`: how far from its root a point may be.
  PELT_INLINE void Load(const SimulateParams& params, Vec3<W> root, W reach) {
    use_ground = params.use_ground != 0;
    any = W(0.0f) < W(use_ground ? 1.0f : 0.0f);
    ground_step = &params.ground_step;
    moves = use_ground && ground_step->moves != 0;
    ground = {{W(0.0f), W(0.0f), W(0.0f)}, W(0.0f)};
    if (use_ground) {
      ground.normal = {W(params.ground[0]), W(params.ground[1]), W(params.ground[2])};
      ground.height = Dot(ground.normal, root) + W(params.ground[3]);
    }
    sphere_count = 0;
    for (uint32_t s = 0; s < Spheres(params); ++s) {
      const float* from = params.sphere[s];
      Sphere<W>& to = sphere[sphere_count];
      to.centre = Vec3<W>{W(from[0]), W(from[1]), W(from[2])} - root;
      sphere_step[sphere_count] = &params.sphere_step[s];
      sphere_count += KeepNear(W(from[3]), reach, params.sphere_step[s], to);
    }
    capsule_count = 0;
    for (uint32_t c = 0; c < Capsules(params); ++c) {
      const CapsuleParams& from = params.capsule[c];
      Capsule<W>& to = capsule[capsule_count];
      to.from = Vec3<W>{W(from.from[0]), W(from.from[1]), W(from.from[2])} - root;
      to.axis = {W(from.axis[0]), W(from.axis[1]), W(from.axis[2])};
      to.length = W(from.length);
      capsule_step[capsule_count] = &params.capsule_step[c];
      capsule_count += KeepNear(W(from.radius), reach, params.capsule_step[c], to);
    }
  }

  // Shrinks each round shape that a root lies in, the more the deeper, to nothing, and lowers the
  // ground to a root beneath it. A strand that starts inside
  // may not be able to get out, and one that is pushed and falls back swings over the shape for
  // ever; so does one whose first link leans on what is next to its root.
  PELT_INLINE void KeepRootsOut() {
    for (uint32_t s = 0; s < sphere_count; ++s) LeaveRoot(sphere[s]);
    for (uint32_t c = 0; c < capsule_count; ++c) LeaveRoot(capsule[c]);
    if (use_ground) LeaveRoot(ground);
  }

  // In the order in which points are pushed out: the last one wins.
  template <class Visit>
  PELT_INLINE void ForEach(const Visit& visit) const {
    for (uint32_t s = 0; s < sphere_count; ++s) visit(sphere[s]);
    for (uint32_t c = 0; c < capsule_count; ++c) visit(capsule[c]);
    if (use_ground) visit(ground);
  }

  // The same with their ways.
  template <class Visit>
  PELT_INLINE void ForEachStep(const Visit& visit) const {
    for (uint32_t s = 0; s < sphere_count; ++s) visit(sphere[s], *sphere_step[s]);
    for (uint32_t c = 0; c < capsule_count; ++c) visit(capsule[c], *capsule_step[c]);
    if (use_ground) visit(ground, *ground_step);
  }

  template <uint32_t kPoints>
  PELT_INLINE void PushOut(Vec3<W> (&point)[kPoints]) const {
    ForEach([&](const auto& shape) __attribute__((always_inline)) {
      for (Vec3<W>& p : point) p = shape.PushOut(p);
    });
  }

  // As KeepRootsOut, one shape in any units as seen from the root.
  static PELT_INLINE void LeaveRoot(Plane<W>& plane) {
    plane.height = plane.height + Max(W(0.0f) - plane.height, W(0.0f));
  }
  template <class Shape>
  static PELT_INLINE void LeaveRoot(Shape& shape) {
    constexpr float kShrink = 6.0f;  // of the radius, for the root's depth
    const Vec3<W> core = shape.Core({W(0.0f), W(0.0f), W(0.0f)});
    const W depth = Max(shape.radius - Sqrt(Dot(core, core)), W(0.0f));
    shape.radius = Max(shape.radius - depth * W(kShrink), W(0.0f));
  }
  // At least as far as any point of it moved.
  static PELT_INLINE float FarthestWay(const ColliderStep& step) {
    const auto sum = [](const float(&v)[3]) {
      return (v[0] < 0 ? -v[0] : v[0]) + (v[1] < 0 ? -v[1] : v[1]) + (v[2] < 0 ? -v[2] : v[2]);
    };
    const float from = sum(step.from), to = sum(step.to);
    return from > to ? from : to;
  }

 private:
  static PELT_INLINE uint32_t Spheres(const SimulateParams& params) {
    return params.sphere_count < kSpheresPerScene ? params.sphere_count : kSpheresPerScene;
  }
  static PELT_INLINE uint32_t Capsules(const SimulateParams& params) {
    return params.capsule_count < kCapsulesPerScene ? params.capsule_count : kCapsulesPerScene;
  }
  // Sets the shape's radius; false where it counts for no lane.
  template <class Shape>
  PELT_INLINE bool KeepNear(W radius, W reach, const ColliderStep& step, Shape& shape) {
    const W none = W(0.0f);
    W range = reach + radius;
    if (step.moves != 0) range = range + W(FarthestWay(step));
    const Vec3<W> core = shape.Core({none, none, none});
    const auto near = Dot(core, core) < range * range;
    if (!Any(near)) return false;
    shape.radius = Select(near, radius, none);
    any = any | near;
    moves |= step.moves != 0;
    return true;
  }
};

}  // namespace pelt
