// What a modal chain may touch, as its substeps see it: the plane through its root, spheres, the
// ground, and the ball around its groomed place that a point may not leave (max_distance).
//
// The idea: each is a plane, or a sphere that a point stays out of or within. Whatever it is, a
// point that is beyond it has a normal that leads back, and a depth. Of several, the deepest
// counts.
//
// All in links, from the root's place at the substep's end. The plane turns with the skin and the
// balls with the groom while the frame lasts; spheres and ground stand still.
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
  chain::Obstacles<W, N> obstacles;
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
    obstacles.Load(params, g);
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
    for (uint32_t s = 0; s < obstacles.sphere_count; ++s) {
      const Vec3<W> centre = Centre(s);
      const W radius = Radius(s);
      for (uint32_t i = 0; i < N; ++i) {
        const Vec3<W> out = at[i] - centre;
        inside = inside | (Dot(out, out) < radius * radius);
      }
    }
    if (obstacles.use_ground) {
      const W offset = GroundOffset();
      for (uint32_t i = 0; i < N; ++i)
        inside = inside | (Dot(at[i], obstacles.ground_normal) < offset);
    }
    return inside;
  }

  // What point i at `at` is deepest beyond.
  PELT_INLINE void Find(uint32_t i, Vec3<W> at, Obstacle<W>& found) const {
    const W none = W(0.0f), one = W(1.0f);
    const Mask never = one < none, always = !never;
    const Vec3<W> zero = {none, none, none};
    W deepest = none;
    found.Clear();
    const auto take = [&](W depth, const Obstacle<W>& o) __attribute__((always_inline)) {
      found.Take(depth > deepest, o);
      deepest = Max(depth, deepest);
    };
    if (hardness > 0.0f) {
      const W height = Dot(at, surface);
      // A share of the depth stays where the surface is soft.
      const W reach = height * W(1.0f - hardness);
      take(none - height,
           {never, never, zero, surface, reach, one, one, one, zero, W(plane_bounce)});
    }
    if (obstacles.use_ground) {
      const Vec3<W> up = obstacles.ground_normal;
      const W offset = GroundOffset();
      take(offset - Dot(at, up),
           {never, never, zero, up, offset, one, none, none, zero, W(plane_bounce)});
    }
    for (uint32_t s = 0; s < obstacles.sphere_count; ++s) {
      const Vec3<W> centre = Centre(s);
      const W radius = Radius(s);
      take(radius - Distance(at, centre),
           {never, always, centre, zero, radius, one, none, none, zero, none});
    }
    if (max_distance > 0.0f) {
      const W limit = W(Limit(i));
      take(Distance(at, groom[i]) - limit,
           {never, always, groom[i], zero, limit, W(-1.0f), one, none, groom_speed[i], none});
    }
  }

 private:
  PELT_INLINE float Limit(uint32_t i) const { return max_distance * float(i + 1); }
  PELT_INLINE W Radius(uint32_t s) const { return obstacles.radius[s] * per_length; }
  PELT_INLINE Vec3<W> Centre(uint32_t s) const { return obstacles.centre[s] * per_length - root; }
  PELT_INLINE W GroundOffset() const {
    return W(0.0f) - obstacles.ground_height * per_length - Dot(obstacles.ground_normal, root);
  }
  static PELT_INLINE W Distance(Vec3<W> a, Vec3<W> b) {
    const Vec3<W> off = a - b;
    return Sqrt(Dot(off, off));
  }

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
