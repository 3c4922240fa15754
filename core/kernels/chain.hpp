// What the two solvers share: how a chain is loaded, predicted, kept out of things and put back.
//
// The idea: a chain is solved in coordinates relative to its root of this frame. The root is then
// the origin, the surface plane passes through it, the floats are small (a point 100 m from the
// world's origin is solved as finely as one at it), and what is safe can be said in lengths of the
// strand.
//
//   world  position, previous --+                                     +--> position, previous
//                               v                                     |
//   root-relative          [predict] -> solver's iterations -> [finish]
//                           box                                 strength, restart, rest
//
// Invariants:
//  - A lane's result depends on that lane only (and, clumping, on its control strand's).
//  - From finite input comes finite output, and no predicted point is further from its root than
//    kBoxReach times its distance along the strand, however the root moved.
//  - A lane without strength, a lane that is new, and every lane of a chunk that restarts lie
//    exactly on the groom, at rest.
//  - A chain that hardly moved keeps its bits, so a still scene reaches a state that a step leaves
//    bit for bit unchanged; sleeping stands on that.
//
// Source: position-based dynamics (Mueller, Heidelberger, Hennix, Ratcliff 2007); the length
// constraint without a square root follows Jakobsen (Advanced Character Physics, GDC 2001), one
// order better (LengthRule). Hardness is a share removed per iteration, as in the originals: it is
// not physical, and the static shape depends on frame rate and iterations. Velocity is the last
// frame's displacement, not corrected when dt changes between frames.
#pragma once

#include <cstdint>

#include "core/chunk.hpp"
#include "core/kernels/collider.hpp"
#include "core/kernels/traits.hpp"
#include "core/kernels/unrolled.hpp"
#include "core/layer.hpp"
#include "core/simd.hpp"

namespace pelt {

namespace chain {

// Share of a length correction that moves the upper point of a segment; the lower takes the rest.
// A strand tapers, so each point is lighter than the one above it; this is a mass ratio of 3, and
// it is also what lets four sweeps from the root hold the length.
inline constexpr float kParentShare = 0.25f;
// Points never come nearer each other than this in the length constraint's arithmetic, m.
inline constexpr float kSegmentMin = 1.0e-6f;
// A predicted point lies inside this many times its distance along the strand from its root, by
// component. This is what caps speed: after a jump of the root without the restart flag a point
// cannot be thrown further than its chain could follow, while the speed of the body as a whole is
// not limited. A chain that is held together never gets to the box: its points are within once
// their distance.
inline constexpr float kBoxReach = 2.0f;
// Four steps of a float: below this share of a coordinate, motion is rounding.
inline constexpr float kRoundingShare = 4.8e-7f;

// One group of chains, relative to their roots.
template <class W, uint32_t kFree>
struct Group {
  Vec3<W> root, normal, free_motion, carried_motion;
  Vec3<W> rest[kFree];   // offsets of the groom's points, turned into the world's axes
  Vec3<W> point[kFree];  // offsets of the present points
  W length;              // of one segment, m
};

template <class W>
PELT_INLINE Vec3<W> Splat3(const float (&v)[3]) {
  return {W(v[0]), W(v[1]), W(v[2])};
}

template <class W>
PELT_INLINE Vec3<W> ClampBox(Vec3<W> v, W reach) {
  const W low = -reach;
  return {Clamp(v.x, low, reach), Clamp(v.y, low, reach), Clamp(v.z, low, reach)};
}

// Offset in the root frame (tangent, normal x tangent, normal) to world axes.
template <class W>
PELT_INLINE Vec3<W> Turn(Vec3<W> tangent, Vec3<W> bitangent, Vec3<W> normal, Vec3<W> offset) {
  return Combine(tangent, offset.x, bitangent, offset.y, normal, offset.z);
}

// Of a link, m.
template <class W, uint32_t kPoints, class At>
PELT_INLINE W LinkLength(const RestBlock<kPoints>& rest, float scale, const At& at) {
  const W length = Max(LoadLanes<W>(rest.segment_length, at), W(kSegmentMin));
  return scale == 1.0f ? length : length * W(scale);
}

template <class W, uint32_t kPoints, class At>
PELT_INLINE void LoadGroom(const RestBlock<kPoints>& rest, const RootBlock& roots, float follow,
                           float scale, const At& at, Group<W, kPoints - 1>& g) {
  g.root = Load3<W>(roots.position, at);
  g.normal = Load3<W>(roots.normal, at);
  const Vec3<W> tangent = Load3<W>(roots.tangent, at);
  const Vec3<W> bitangent = Cross(g.normal, tangent);
  const Vec3<W> motion = Load3<W>(roots.motion, at);
  g.carried_motion = motion * W(follow);
  g.free_motion = motion - g.carried_motion;
  g.length = LinkLength<W>(rest, scale, at);
  for (uint32_t i = 0; i < kPoints - 1; ++i)
    g.rest[i] = Turn(tangent, bitangent, g.normal, Load3<W>(rest.offset[i], at));
  if (scale == 1.0f) return;
  for (uint32_t i = 0; i < kPoints - 1; ++i) g.rest[i] = g.rest[i] * W(scale);
}

// Where the points go if nothing holds them: the old place, carried along with the root by the
// layer's share, plus what is kept of the last frame's step, plus acceleration * dt^2 (`fall`). `keep`: of
// the layer, or of each lane, as what is written `auto` below.
template <class W, uint32_t kPoints>
PELT_INLINE void Predict(const PointBlock<kPoints>& position, const PointBlock<kPoints>& previous,
                         auto keep, Vec3<W> fall, uint32_t lane, Group<W, kPoints - 1>& g) {
  const Vec3<W> shift = g.carried_motion + fall;
  for (uint32_t i = 0; i < kPoints - 1; ++i) {
    const Vec3<W> old = Load3<W>(position.position[i], lane);
    const Vec3<W> step = old - Load3<W>(previous.position[i], lane);
    const Vec3<W> onward = step * W(keep), reached = old - g.root + shift + onward;
    g.point[i] = ClampBox(reached, g.length * W(kBoxReach * float(i + 1)));
  }
}

// The length constraint's numbers, once a group: segment vector d is to become d * Scale(d). For
// hardness 1 that is Halley's step for L / |d|,
//
//     Scale = (3 L^2 + d^2) / (L^2 + 3 d^2) = 1/3 + 8/9 L^2 / (d^2 + L^2 / 3),
//
// no square root; with s = |d| / L it leaves an error of (s - 1)^3 / (1 + 3 s^2): cubic, and never
// past the length from either side.
template <class W>
struct LengthRule {
  W third, top, rest_share;
  PELT_INLINE LengthRule(W length, float hardness) {
    const W length2 = length * length;
    third = length2 * W(1.0f / 3.0f);
    top = length2 * W(8.0f / 9.0f * hardness);
    rest_share = W(1.0f - hardness * (2.0f / 3.0f));
  }
  PELT_INLINE W Scale(Vec3<W> d) const { return top / (Dot(d, d) + third) + rest_share; }
};

// Sets the lengths from root to tip. What a segment gains or loses is shared by its ends by mass;
// the root does not move.
template <class W, uint32_t kFree>
PELT_INLINE void SetLengths(const LengthRule<W>& rule, Vec3<W> (&point)[kFree]) {
  point[0] = point[0] * rule.Scale(point[0]);
  for (uint32_t i = 1; i < kFree; ++i) {
    const Vec3<W> d = point[i] - point[i - 1];
    const W scale = rule.Scale(d);
    point[i - 1] = point[i - 1] - d * ((scale - W(1.0f)) * W(kParentShare));
    point[i] = point[i - 1] + d * scale;
  }
}

// How far a point may be from its root when a frame starts, and what it may touch from there.
template <class W, uint32_t kFree>
PELT_INLINE void LoadColliders(const SimulateParams& params, const Group<W, kFree>& g,
                               Colliders<W>& colliders) {
  colliders.Load(params, g.root, g.length * W(2.0f * kBoxReach * float(kFree)));
}

// The plane through the root, across its normal, is a contact.
PELT_INLINE bool HasSurface(const LayerBlock& layer) { return layer.surface_hardness > 0.0f; }

// Takes away a share of each point's depth below that plane.
template <class W, uint32_t kFree>
PELT_INLINE void PushAboveSurface(Group<W, kFree>& g, float hardness) {
  const Vec3<W> lift = g.normal * W(hardness);
  for (uint32_t i = 0; i < kFree; ++i)
    g.point[i] = g.point[i] - lift * Min(Dot(g.point[i], g.normal), W(0.0f));
}

// Speed into a plane, m per frame, below which a contact returns nothing: two frames of free fall.
PELT_INLINE float SlowContact(const LayerBlock& layer, float dt) {
  const float x = layer.gravity[0], y = layer.gravity[1], z = layer.gravity[2];
  return 2.0f * dt * dt * ((x < 0 ? -x : x) + (y < 0 ? -y : y) + (z < 0 ? -z : z));
}

// What a contact gives back. A point that was predicted to dive into a plane (the surface at its
// root, the ground) leaves it with `bounce` times the speed it came with. Contacts slower than two
// frames of free fall return nothing, or a resting chain would never rest. Round shapes return
// nothing.
template <class W, uint32_t kFree>
struct Bounces {
  W surface_speed[kFree];  // into the plane, m per frame; 0: no contact
  W ground_speed[kFree];

  template <uint32_t kPoints>
  PELT_INLINE void Record(const PointBlock<kPoints>& position, auto slow, bool has_surface,
                          uint32_t lane, const Group<W, kFree>& g, const Colliders<W>& colliders) {
    for (uint32_t i = 0; i < kFree; ++i) {
      const Vec3<W> start = Load3<W>(position.position[i], lane) + g.carried_motion - g.root;
      const Vec3<W> step = g.point[i] - start;
      const W surface = Dot(g.free_motion - step, g.normal);
      surface_speed[i] = W(0.0f);
      if (has_surface)
        surface_speed[i] =
            Select((Dot(g.point[i], g.normal) < W(0.0f)) & (surface > W(slow)), surface, W(0.0f));
      ground_speed[i] = W(0.0f);
      if (!colliders.use_ground) continue;
      const W ground = -Dot(step, colliders.ground.normal);
      const auto below = colliders.ground.IsInside(g.point[i]);
      ground_speed[i] = Select(below & (ground > W(slow)), ground, W(0.0f));
    }
  }

  // What to add to `previous` of point i so that the next frame's velocity leaves the plane.
  PELT_INLINE Vec3<W> Kick(uint32_t i, Vec3<W> step, auto bounce, const Group<W, kFree>& g,
                           const Colliders<W>& colliders) const {
    const W none = W(0.0f);
    const W leave = surface_speed[i] - Dot(step - g.free_motion, g.normal);
    Vec3<W> kick = g.normal * (Select(surface_speed[i] > none, leave, none) * W(-bounce));
    if (colliders.use_ground) {
      const W up = ground_speed[i] - Dot(step, colliders.ground.normal);
      kick =
          kick + colliders.ground.normal * (Select(ground_speed[i] > none, up, none) * W(-bounce));
    }
    return kick;
  }
};

template <class W>
PELT_INLINE typename W::Int Differences(Vec3<W> a, Vec3<W> b) {
  return (Bits(a.x) ^ Bits(b.x)) | (Bits(a.y) ^ Bits(b.y)) | (Bits(a.z) ^ Bits(b.z));
}

// Puts a group back: strength (of a point's distance from the groom, s (2 - s) is kept each frame),
// lanes that start afresh, and lanes at rest, which keep their bits. Returns the lanes whose
// position or previous changed. A group without special lanes takes the short way, which gives them
// the same bits. `bounce`: of the layer; `returned`: the same, or of each lane.
template <class W, uint32_t kPoints>
PELT_INLINE typename W::Mask Finish(const RestBlock<kPoints>& rest, const SimulateParams& params,
                                    float bounce, auto returned,
                                    const Bounces<W, kPoints - 1>& bounces,
                                    const Colliders<W>& colliders, typename W::Mask fresh,
                                    uint32_t lane, Group<W, kPoints - 1>& g,
                                    PointBlock<kPoints>& position, PointBlock<kPoints>& previous) {
  constexpr uint32_t kFree = kPoints - 1;
  const W strength = W::Load(rest.strength + lane);
  fresh = fresh | (strength <= W(0.0f));
  const auto loose = strength >= W(1.0f);
  if (!AllSet(loose)) {
    const W pull = (W(1.0f) - strength) * (W(1.0f) - strength);
    for (uint32_t i = 0; i < kFree; ++i)
      g.point[i] = Select<W>(loose, g.point[i], g.point[i] + (g.rest[i] - g.point[i]) * pull);
  }
  Vec3<W> next[kFree], last[kFree];
  W far2 = W(0.0f);
  for (uint32_t i = 0; i < kFree; ++i) {
    const Vec3<W> old = Load3<W>(position.position[i], lane);
    next[i] = g.root + g.point[i];
    last[i] = old + g.carried_motion;
    const Vec3<W> step = next[i] - old;
    far2 = Max(far2, Dot(step, step));
  }
  if (bounce > 0.0f)
    for (uint32_t i = 0; i < kFree; ++i)
      last[i] = last[i] + bounces.Kick(i, next[i] - last[i], returned, g, colliders);

  typename W::Mask changed = W(0.0f) < W(1.0f);
  typename W::Mask still = !changed;
  if (params.rest_threshold > 0.0f) {
    const W size = Max(Max(Abs(g.root.x), Abs(g.root.y)), Abs(g.root.z));
    const W limit = Max(g.length * W(params.rest_threshold), size * W(kRoundingShare));
    still = (far2 < limit * limit) & !fresh;
  }
  // A lane that is neither has moved by more than its limit. Without a limit, look.
  if (params.rest_threshold <= 0.0f || Any(still | fresh)) {
    typename W::Int change = 0;
    for (uint32_t i = 0; i < kFree; ++i) {
      const Vec3<W> old = Load3<W>(position.position[i], lane);
      const Vec3<W> groom = g.root + g.rest[i];
      next[i] = Select<W>(still, old, Select<W>(fresh, groom, next[i]));
      last[i] = Select<W>(still, old, Select<W>(fresh, groom, last[i]));
      change = change | Differences(next[i], old) |
               Differences(last[i], Load3<W>(previous.position[i], lane));
    }
    changed = !(change == typename W::Int(0));
  }
  for (uint32_t i = 0; i < kFree; ++i) {
    Store3(position.position[i], lane, next[i]);
    Store3(previous.position[i], lane, last[i]);
  }
  return changed;
}

// Every lane on the groom, at rest.
template <class W, uint32_t kPoints>
PELT_INLINE typename W::Mask PlaceOnGroom(uint32_t lane, const Group<W, kPoints - 1>& g,
                                          PointBlock<kPoints>& position,
                                          PointBlock<kPoints>& previous) {
  typename W::Int change = 0;
  for (uint32_t i = 0; i < kPoints - 1; ++i) {
    const Vec3<W> groom = g.root + g.rest[i];
    change = change | Differences(groom, Load3<W>(position.position[i], lane)) |
             Differences(groom, Load3<W>(previous.position[i], lane));
    Store3(position.position[i], lane, groom);
    Store3(previous.position[i], lane, groom);
  }
  return !(change == typename W::Int(0));
}

// Of the control strands of a group's lanes, at `at`: where their points of this frame stand in the rows that the
// kernel writes, once the controls are solved. `control`: a lane's control strand; what is not among the first
// `count` follows the last of those.
template <class W>
PELT_INLINE PickedLanes<W> ControlsOf(const uint8_t (&control)[kStrandsPerChunk], uint32_t count,
                                      const PickedLanes<W>& at) {
  PickedLanes<W> controls;
  for (int l = 0; l < W::kLanes; ++l) {
    const uint32_t c = control[at.lane[l]];
    controls.lane[l] = int32_t(c < count ? c : count - 1);
  }
  return controls;
}
template <class W>
PELT_INLINE PickedLanes<W> ControlsOf(const uint8_t (&control)[kStrandsPerChunk], uint32_t count,
                                      uint32_t first) {
  PickedLanes<W> lanes;
  for (int l = 0; l < W::kLanes; ++l) lanes.lane[l] = int32_t(first) + l;
  return ControlsOf<W>(control, count, lanes);
}

// Share of the way to the control strand at free point i of kFree: 0 at the root, `clump` at the
// tip.
template <class Clump>
PELT_INLINE constexpr Clump ClumpShare(Clump clump, uint32_t i, uint32_t free_points) {
  return clump * Clump(float(i + 1) / float(free_points));
}

}  // namespace chain
}  // namespace pelt
