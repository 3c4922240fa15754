// What a modal chain may touch, as its substeps see it: the plane through its root, the scene's
// colliders (collider.hpp), and the ball around its groomed place that a point may not leave
// (max_distance).
//
// The idea: near a point each is a plane, or a ball that the point stays out of or within. Whatever
// it is, a point that is beyond it has a normal that leads back, and a depth. Of several, the
// deepest counts.
//
// All in links, from the root's place at the substep's end. The plane turns with the skin and the
// balls with the groom while the frame lasts; colliders stand still.
#pragma once

#include "core/kernels/chain.hpp"
#include "core/kernels/modal_curl.hpp"
#include "core/kernels/modal_step.hpp"

namespace pelt::modal {

// Share of a chain's length that it is straightened to at most: where a root lies inside something,
// a point may not be able to get out, and a force that tries grows without bounds.
inline constexpr float kReach = 0.98f;

PELT_INLINE bool HasLimit(const LayerBlock& layer) { return layer.max_distance > 0.0f; }

// One of them, as it stands to one point.
template <class W>
struct Obstacle {
  typename W::Mask any, round;
  Vec3<W> centre, normal;  // the sphere's; the plane's
  W reach;                 // radius; offset of the plane along its normal
  W side;                  // -1: a sphere to stay within; else 1
  W carried, spins;        // 1: moves with the root; turns with the skin
  Vec3<W> drift;           // speed besides, links/s
  W bounce;                // share of the speed that comes back

  PELT_INLINE void Clear() {
    const W none = W(0.0f);
    any = round = W(1.0f) < none;
    centre = normal = drift = {none, none, none};
    reach = carried = spins = bounce = none;
    side = W(1.0f);
  }
  // A collider, as it stands to a point near `at`. Only planes return speed (as in the other
  // solvers).
  template <class Shape>
  static PELT_INLINE Obstacle Of(const Shape& shape, Vec3<W> at, W plane_bounce) {
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
    return o;
  }
  PELT_INLINE void Take(typename W::Mask lanes, const Obstacle& from) {
    round = (from.round & lanes) | (round & !lanes);
    centre = Select<W>(lanes, from.centre, centre);
    normal = Select<W>(lanes, from.normal, normal);
    reach = Select(lanes, from.reach, reach);
    side = Select(lanes, from.side, side);
    carried = Select(lanes, from.carried, carried);
    spins = Select(lanes, from.spins, spins);
    drift = Select<W>(lanes, from.drift, drift);
    bounce = Select(lanes, from.bounce, bounce);
    any = any | lanes;
  }
  // Puts it back to where a point at most `length` from the root can still get out of it.
  PELT_INLINE void KeepWithinReach(W length) {
    const W far = Select(round, Sqrt(Dot(centre, centre)), W(0.0f));
    reach = Min(reach, far + length);
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

template <class W, uint32_t N>
struct Surroundings {
  using Mask = typename W::Mask;

  float hardness, plane_bounce, max_distance;
  Vec3<W> end_surface, turn;  // normal of the plane through the root, and its change in this frame
  W per_length;
  Colliders<W> colliders;
  // At the end of the present substep.
  Vec3<W> root;                      // from where it is at the frame's end
  Vec3<W> surface;                   // normal of the plane through it
  Vec3<W> groom[N], groom_speed[N];  // the groom's points from the root; links/s from it

  PELT_INLINE void Load(const LayerBlock& layer, const SimulateParams& params, Vec3<W> last_surface,
                        const chain::Group<W, N>& g) {
    hardness = layer.surface_hardness;
    plane_bounce = layer.bounce;
    max_distance = layer.max_distance;
    surface = end_surface = g.normal;
    turn = g.normal - last_surface;
    per_length = W(1.0f) / g.length;
    chain::LoadColliders(params, g, colliders);
  }

  PELT_INLINE void Advance(const ModalTableBlock& t, uint32_t substep, const Motion<W, N>& motion) {
    const ModalSubstep& s = t.substep[substep];
    root = {WeighRoot(s.root_place, motion.axis[0].root),
            WeighRoot(s.root_place, motion.axis[1].root),
            WeighRoot(s.root_place, motion.axis[2].root)};
    if (hardness > 0.0f) {
      const float left = 1.0f - float(substep + 1) / float(t.substeps);
      surface = left > 0.0f ? NormalizeOr(end_surface - turn * W(left), end_surface) : end_surface;
    }
    if (max_distance > 0.0f) PlaceGroom(t, s, motion);
  }

  // Lanes of which some point is beyond something.
  PELT_INLINE Mask IsInside(const Vec3<W> (&at)[N]) const {
    Mask inside = W(1.0f) < W(0.0f);
    if (hardness > 0.0f)
      for (uint32_t i = 0; i < N; ++i) inside = inside | (Dot(at[i], surface) < W(0.0f));
    if (max_distance > 0.0f)
      for (uint32_t i = 0; i < N; ++i) {
        const Vec3<W> off = at[i] - groom[i];
        inside = inside | (Dot(off, off) > W(Limit(i) * Limit(i)));
      }
    colliders.ForEach([&](const auto& collider) __attribute__((always_inline)) {
      const auto shape = collider.In(per_length, root);
      for (uint32_t i = 0; i < N; ++i) inside = inside | shape.IsInside(at[i]);
    });
    return inside;
  }

  // What point i at `at` is deepest beyond.
  PELT_INLINE void Find(uint32_t i, Vec3<W> at, Obstacle<W>& found) const {
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
      take(height, {never, never, zero, surface, reach, one, one, one, zero, W(plane_bounce)});
    }
    colliders.ForEach([&](const auto& collider) __attribute__((always_inline)) {
      const auto shape = collider.In(per_length, root);
      const W distance = shape.Distance(at);
      take(distance, Obstacle<W>::Of(shape, at, W(plane_bounce)));
    });
    if (max_distance > 0.0f) {
      const W limit = W(Limit(i));
      const Vec3<W> off = at - groom[i];
      take(limit - Sqrt(Dot(off, off)),
           {never, always, groom[i], zero, limit, W(-1.0f), one, none, groom_speed[i], none});
    }
  }

 private:
  PELT_INLINE float Limit(uint32_t i) const { return max_distance * float(i + 1); }

  __attribute__((noinline)) void PlaceGroom(const ModalTableBlock& t, const ModalSubstep& s,
                                            const Motion<W, N>& motion) {
    W rest[3][N], moving[3][N];
    RestAt<W, N>(t, s.root_place, motion, rest);
    RestAt<W, N>(t, s.root_speed, motion, moving);
    Vec3<W> at = {W(0.0f), W(0.0f), W(0.0f)}, speed = at;
    for (uint32_t i = 0; i < N; ++i) {
      groom[i] = at = at + Vec3<W>{rest[0][i], rest[1][i], rest[2][i]};
      speed = speed + Vec3<W>{moving[0][i], moving[1][i], moving[2][i]};
      groom_speed[i] = speed = speed - Row(motion, &Axis<W, N>::rest, i);
    }
  }
};

}  // namespace pelt::modal
