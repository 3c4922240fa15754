// Frames of chains that something fast strikes.
//
// A ball that goes further in a substep than it is large is at a strand for a fraction of that, and
// what it strikes turns several times faster than substeps can follow. So such a chain takes the
// whole frame in short steps instead (modal_short_steps.hpp). What goes further in 1/60 s than a
// quarter of its radius counts as fast, at any frame rate and in any quality: by a substep's way,
// more frames would take the less accurate course with balls up to four times as fast. It is the
// same step (modal_step.hpp) but for contact:
//
// Before a short step every collider is looked at on its way through it, in a few parts, as the
// chain's points would go on: when it first meets the line to a place, where on that, and with which normal. There
// the point gets what it lacks of the collider's own speed along the normal, as an impulse that keeps
// the lengths, and friction its share of that; then it flies on. That is a hard collider's blow,
// regardless of where the collider is at the frame's end. What slides along a strand gives one in each
// part, as it is in the middle of it.
//
// What was struck is taken so until it turns slowly enough for substeps. The memory of that is
// quiet_s, which counts up from below 0 meanwhile.
//
// Invariants: lanes that nothing fast strikes, nor has struck, keep their bits. From finite input
// comes finite output.
#pragma once

#include <algorithm>

#include "core/kernels/modal_friction.hpp"
#include "core/kernels/modal_impulse.hpp"
#include "core/kernels/modal_short_steps.hpp"

namespace pelt::modal {

// Parts of one in which colliders are looked for.
inline constexpr int kLooksForBlows = 4;
// What a tangent turns in a short step, at most, rad: what is faster is slowed down to that.
inline constexpr float kMostShortTurn = 0.5f;
// Substeps follow strands that turn no further in one than this, rad, for this long, s.
inline constexpr float kFollowedTurn = 0.3f, kFollowedFor = 0.1f;

// What goes further than this share of its radius in this time, s, is too fast for substeps.
inline constexpr float kFastShare = 0.25f, kFastTime = 1.0f / 60.0f;

// Lanes for which a round shape is that fast; `radius`: 0 where it does not count.
template <class W>
PELT_INLINE typename W::Mask IsFast(W radius, const ColliderStep& step, float frame_s) {
  if (step.moves == 0) return W(1.0f) < W(0.0f);
  const W way = W(Colliders<W>::FarthestWay(step) * (kFastTime / frame_s));
  return (radius > W(0.0f)) & (radius * W(kFastShare) < way);
}

// Lanes that such a one may strike in the frame: looked for at so many places of its way.
inline constexpr int kLooksForWay = 9;
template <class W, uint32_t N, uint32_t kParts>
__attribute__((noinline)) typename W::Mask IsInFastWay(const SimulateParams& params,
                                                       const chain::Group<W, kParts>& g,
                                                       W per_length, float frame_s,
                                                       const Motion<W, N>& motion) {
  const W none = W(0.0f);
  const Vec3<W> zero = {none, none, none};
  const Vec3<W> start =
      zero - Vec3<W>{motion.axis[0].root[0], motion.axis[1].root[0], motion.axis[2].root[0]};
  const W root_way = Abs(start.x) + Abs(start.y) + Abs(start.z);
  typename W::Mask near = W(1.0f) < none;
  Colliders<W> colliders;
  chain::LoadColliders(params, g, colliders);
  colliders.ForEachStep([&]<class Shape>(const Shape& shape, const ColliderStep& step) {
    if constexpr (Shape::kIsRound) {
      const auto fast = IsFast(shape.radius, step, frame_s);
      if (!Any(fast)) return;
      const W way = W(Colliders<W>::FarthestWay(step)) * per_length + root_way;
      const W range =
          W(float(kParts)) + shape.radius * per_length + way * W(0.5f / float(kLooksForWay - 1));
      for (int look = 0; look < kLooksForWay; ++look) {
        const float share = float(look) / float(kLooksForWay - 1);
        const auto then = shape.Before(step, share).In(per_length, start * W(share));
        const Vec3<W> core = then.Core(zero);
        near = near | (fast & (Dot(core, core) < range * range));
      }
    }
  });
  return near;
}

// quiet_s of lanes that took short steps, after `before`; `now`: that something fast struck in this
// frame, `fastest`: how fast a tangent turns at its end, rad/s.
template <class W, class Table>
PELT_INLINE W ClockOfStruck(const Table& t, W before, typename W::Mask now, W fastest) {
  const auto whips = fastest * W(t.frame_s / float(t.substeps)) > W(kFollowedTurn);
  const W later = Min(before + W(t.frame_s), W(0.0f));
  return Select(now | whips, W(-kFollowedFor), later);
}

// Touches of steps whose contacts are blows.
struct NoTouches {
  template <bool kBest, class Table, class Motion>
  PELT_INLINE bool Resolve(const Table&, uint32_t, Motion&) {
    return false;
  }
};

template <class W, uint32_t N, uint32_t Q>
struct Strikes : Meeting<W, N, Q> {
  using Meeting<W, N, Q>::use, Meeting<W, N, Q>::around, Meeting<W, N, Q>::slow;
  using Mask = typename W::Mask;

  template <uint32_t kParts>
  PELT_INLINE void Load(const ModalTableBlock& t, const LayerBlock& layer,
                        const SimulateParams& params, Vec3<W> last_surface,
                        const Vec3<W> (&rest)[N], const chain::Group<W, kParts>& g) {
    Meeting<W, N, Q>::Load(t, layer, params, last_surface, rest, g);
    // Not less what roots lie in at the frame's end: a ball may have gone over them.
    chain::LoadColliders(params, g, around.colliders);
  }

  // Steps the frame. Returns the lanes that something fast strikes; `fastest`: how fast a link
  // turns at its end, rad/s.
  __attribute__((noinline)) Mask Step(const ModalTableBlock& frame, bool wind, Motion<W, N>& motion,
                                      W& fastest) {
    const Mask all = W(0.0f) < W(1.0f);
    Mask struck = !all;
    ShortSteps<W, N> steps(frame);
    around.time = steps.step_s();
    NoTouches none;
    for (uint32_t step = 0; step < steps.count(); ++step) {
      const ModalTableBlock& t = steps.At(step);
      if (use && (around.HasColliders() || around.hardness > 0.0f))
        struck = struck | Meet(t, frame.frame_s, steps.Time(step), motion);
      Vec3<W> before[N];
      for (uint32_t i = 0; i < N; ++i) before[i] = Row(motion, &Axis<W, N>::d, i);
      const Mask good = RunSubstep<false>(t, 1, wind, none, motion);
      if (!AllSet(good)) Hold(t, good, before, motion);
      MakeTangent(t, t.substep[1].root_speed, motion);
      fastest = SlowDown(t, WeighRoots(t.substep[1].root_speed, motion), all, motion);
      steps.GoOn();
    }
    return struck;
  }

 private:
  // What meets the strand first, place by place.
  struct Blow {
    Obstacle<W> what;
    W when;  // share of the part
    Vec3<W> normal;
    Mask fast;
  };
  // The strand as it goes on evenly in a step, from the root: parts, parts/s.
  struct Way {
    Vec3<W> start[N], v[N], root_start, root_v;  // tangents at the step's start
    // In a part of the step: its ends, s from the step's start and shares of the frame before its
    // end; the root and the places then; tangents at the first.
    float from_s, to_s, begin, end;
    Vec3<W> root_first, root_last, d[N], first[Q], last[Q];

    PELT_INLINE void TakePart(const ModalTableBlock& t, const Vec3<W> (&base)[Q], float from,
                              float to, float frame_begin, float per_frame) {
      from_s = from, to_s = to;
      begin = frame_begin - from * per_frame;
      end = std::max(frame_begin - to * per_frame, 0.0f);
      root_first = root_start + root_v * W(from);
      root_last = root_start + root_v * W(to);
      Vec3<W> at[N], then[N];
      for (uint32_t i = 0; i < N; ++i) {
        at[i] = start[i] + v[i] * W(from);
        then[i] = start[i] + v[i] * W(to);
        d[i] = at[i] * Rsqrt(Max(Dot(at[i], at[i]), W(1.0e-12f)));
      }
      PlaceVectors(t, at, base, first);
      PlaceVectors(t, then, base, last);
    }
  };

  static PELT_INLINE Vec3<W> Speed(const ModalTableBlock& t, uint32_t i, Vec3<W> root,
                                   const Motion<W, N>& motion) {
    return {NodeRate<W, N>(t, i, motion.axis[0].z, root.x),
            NodeRate<W, N>(t, i, motion.axis[1].z, root.y),
            NodeRate<W, N>(t, i, motion.axis[2].z, root.z)};
  }
  static PELT_INLINE Vec3<W> WeighRoots(const float (&weights)[kModalSamples - 1],
                                        const Motion<W, N>& motion) {
    return {WeighRoot(weights, motion.axis[0].root), WeighRoot(weights, motion.axis[1].root),
            WeighRoot(weights, motion.axis[2].root)};
  }

  PELT_INLINE void FindWay(const ModalTableBlock& t, const Motion<W, N>& motion, Way& way) const {
    way.root_start = WeighRoots(t.substep[0].root_place, motion);
    const Vec3<W> root_end = WeighRoots(t.substep[1].root_place, motion);
    way.root_v = (root_end - way.root_start) * W(1.0f / around.time);
    for (uint32_t i = 0; i < N; ++i) {
      way.start[i] = Row(motion, &Axis<W, N>::d, i);
      way.v[i] = Speed(t, i, way.root_v, motion);
    }
  }

  template <class Shape>
  PELT_INLINE void MeetShape(const Shape& shape, const ColliderStep& step, float frame_s,
                             const Way& way, Blow (&blow)[Q]) const {
    const W none = W(0.0f);
    auto first = step.moves ? shape.Before(step, way.begin) : shape;
    auto last = step.moves ? shape.Before(step, way.end) : shape;
    first = first.In(around.per_length, way.root_first);
    last = last.In(around.per_length, way.root_last);
    Mask fast = W(1.0f) < none, near = !fast;
    if constexpr (Shape::kIsRound) {
      Colliders<W>::LeaveRoot(first);
      last.radius = first.radius;
      const Vec3<W> zero = {none, none, none};
      const Vec3<W> near_first = first.Core(zero), near_last = last.Core(zero);
      const Vec3<W> moved = near_last - near_first;
      const W range = W(float(Q) * around.spacing) + first.radius + Sqrt(Dot(moved, moved));
      near = (Dot(near_first, near_first) < range * range) & (first.radius > none);
      if (!Any(near)) return;
      fast = IsFast(shape.radius, step, frame_s);
    } else {
      const W height = first.height;
      Colliders<W>::LeaveRoot(first);
      last.height = last.height + (first.height - height);
    }
    for (uint32_t q = 0; q < Q; ++q) {
      const Vec3<W> from = q == 0 ? Vec3<W>{none, none, none} : way.first[q - 1];
      const Vec3<W> to = q == 0 ? Vec3<W>{none, none, none} : way.last[q - 1];
      Mask met;
      W when, share = W(1.0f);
      Vec3<W> normal;
      if constexpr (Shape::kIsRound) {
        const Vec3<W> link = way.first[q] - from, link_last = way.last[q] - to;
        const W long2 = W(1.0f) / Max(Dot(link, link), W(1.0e-6f));
        const W share_first = NearestShare(first, from, link, long2);
        const W share_last = NearestShare(last, to, link_last, long2);
        const Vec3<W> point = from + link * share_first, point_last = to + link_last * share_last;
        const Vec3<W> seen = point - first.Core(point),
                      seen_last = point_last - last.Core(point_last);
        const Crossing<W> crossing(seen, seen_last, first.radius);
        met = crossing.any;
        const Mask slides = crossing.when <= none;
        when = Max(crossing.when, none);
        share = share_first + (share_last - share_first) * Select(slides, W(0.5f), when);
        const Vec3<W> middle = seen + seen_last;
        normal = Select<W>(slides, middle * Rsqrt(Max(Dot(middle, middle), W(1.0e-12f))),
                           crossing.normal);
      } else {
        const W height = first.Distance(way.first[q]), end = last.Distance(way.last[q]);
        met = (end < none) & (end < height);
        when = Max(height, none) / Max(height - end, W(1.0e-12f));
        normal = shape.normal;
      }
      const Vec3<W> at = from + (way.first[q] - from) * share;
      Obstacle<W> o = Obstacle<W>::Of(first, step, at, around.Bounce(), around.per_step);
      o.drift = o.drift - way.root_v;
      o.share = share;
      Take(met & near, o, when, normal, fast, blow[q]);
    }
  }
  // Of several the first.
  static PELT_INLINE void Take(Mask met, const Obstacle<W>& o, W when, Vec3<W> normal, Mask fast,
                               Blow& blow) {
    const Mask taken = met & (when < blow.when);
    blow.what.Take(taken, o);
    blow.when = Select(taken, when, blow.when);
    blow.normal = Select<W>(taken, normal, blow.normal);
    blow.fast = (fast & taken) | (blow.fast & !taken);
  }

  // Blows of a step. Returns the lanes that something fast struck.
  __attribute__((noinline)) Mask Meet(const ModalTableBlock& t, float frame_s, float time,
                                      Motion<W, N>& motion) const {
    Mask struck = W(1.0f) < W(0.0f);
    Way way;
    FindWay(t, motion, way);
    const float part = around.time * (1.0f / float(kLooksForBlows));
    for (int look = 0; look < kLooksForBlows; ++look) {
      way.TakePart(t, around.base, float(look) * part, float(look + 1) * part, 0.0f - time,
                   t.euler_speed);
      struck = struck | MeetInPart(t, frame_s, way, motion);
    }
    return struck;
  }

  PELT_INLINE Mask MeetInPart(const ModalTableBlock& t, float frame_s, Way& way,
                              Motion<W, N>& motion) const {
    const W none = W(0.0f), one = W(1.0f);
    const Mask never = one < none;
    Blow blow[Q];
    for (Blow& b : blow) {
      b.what.Clear();
      b.when = one;
      b.normal = {none, none, none};
      b.fast = never;
    }
    around.colliders.ForEachStep([&](const auto& shape, const ColliderStep& step) {
      MeetShape(shape, step, frame_s, way, blow);
    });
    if (around.hardness > 0.0f)
      for (uint32_t q = 0; q < Q; ++q) {
        const Vec3<W> up = around.end_surface;
        const W height = Dot(up, way.first[q]), end = Dot(up, way.last[q]);
        const W when = Max(height, none) / Max(height - end, W(1.0e-12f));
        Obstacle<W> skin;
        skin.Clear();
        skin.carried = one;
        skin.bounce = around.Bounce();
        Take((end < none) & (end < height), skin, when, up, never, blow[q]);
      }
    Mask met = never;
    for (const Blow& b : blow) met = met | b.what.any;
    return Any(met) ? Answer(t, way, blow, motion) : never;
  }

  PELT_INLINE Mask Answer(const ModalTableBlock& t, Way& way, const Blow (&blow)[Q],
                          Motion<W, N>& motion) const {
    const W none = W(0.0f), one = W(1.0f);
    W wanted[Q], least[Q], push[Q], lever[Q][N], when = one;
    Pushed<W, N> all;
    Vec3<W> normal[Q], slip[Q], impulse[Q];
    Obstacle<W> what[Q];
    Mask any = one < none, struck = any;
    PushedPlaces<Q> places;
    for (uint32_t q = 0; q < Q; ++q) {
      what[q] = blow[q].what;
      LeverOf<W, N>(t, q, what[q].share, lever[q]);
      Vec3<W> speed = way.v[0] * lever[q][0];
      for (uint32_t i = 1; i < N; ++i) speed = speed + way.v[i] * lever[q][i];
      slip[q] = speed - what[q].drift;
      const W into = none - Dot(blow[q].normal, slip[q]);
      const Mask meets = what[q].any & (into > none);
      normal[q] = Select<W>(meets, blow[q].normal, {none, none, none});
      wanted[q] = Select(meets, into + Select(into > slow, into * what[q].bounce, none), none);
      when = Select(meets, Min(when, blow[q].when), when);
      least[q] = none;
      any = any | meets;
      struck = struck | (meets & blow[q].fast);
      if (Any(meets)) places.Add(q);
    }
    if (places.count == 0) return struck;
    const ImpulseMetric<W, N> metric(t, way.d);
    if (around.friction > 0.0f) {
      Friction<W, N, Q> friction;
      friction.Clear();
      friction.Settle(metric, lever, around, places, what, normal, wanted, slip, all, impulse);
    } else {
      SolvePushes(metric, places, normal, lever, wanted, least, push, all);
      for (const uint32_t q : places) impulse[q] = normal[q] * push[q];
    }
    AddImpulses(t, places, impulse, lever, way.d, all.held, any, motion);
    SlowDown(t, way.root_v, any, motion);
    // Until then it went on as it was.
    const W late = W(way.from_s) + when * W(way.to_s - way.from_s);
    for (uint32_t i = 0; i < N; ++i) {
      const Vec3<W> now = Speed(t, i, way.root_v, motion);
      const Vec3<W> back = (now - way.v[i]) * late;
      way.v[i] = Select<W>(any, now, way.v[i]);
      way.start[i] = Select<W>(any, way.start[i] - back, way.start[i]);
      for (uint32_t k = 0; k < 3; ++k) motion.axis[k].d[i] = Component(way.start[i], k);
    }
    return struck;
  }

  // Lanes whose step failed stand still for it.
  static PELT_INLINE void Hold(const ModalTableBlock& t, Mask good, const Vec3<W> (&before)[N],
                               Motion<W, N>& motion) {
    const Vec3<W> root = WeighRoots(t.substep[1].root_speed, motion);
    for (uint32_t i = 0; i < N; ++i) {
      const Vec3<W> old = before[i];
      const Vec3<W> d = old * Rsqrt(Max(Dot(old, old), W(1.0e-12f)));
      motion.lambda[i] = Select(good, motion.lambda[i], W(0.0f));
      for (uint32_t k = 0; k < 3; ++k) {
        Axis<W, N>& a = motion.axis[k];
        a.d[i] = Select(good, a.d[i], Component(d, k));
        a.z[i] = Select(good, a.z[i], Component(root, k) * W(t.pull_mode[i]));
      }
    }
  }

  // Keeps lanes' tangents to what a step can turn them; returns how fast the fastest goes.
  PELT_INLINE W SlowDown(const ModalTableBlock& t, Vec3<W> root, Mask lanes,
                         Motion<W, N>& motion) const {
    W fastest2 = W(0.0f);
    for (uint32_t i = 0; i < N; ++i) {
      const Vec3<W> v = Speed(t, i, root, motion);
      fastest2 = Max(fastest2, Dot(v, v));
    }
    const float most = kMostShortTurn / around.time;
    const Mask over = lanes & (fastest2 > W(most * most));
    if (Any(over)) {
      const W less = W(most) * Rsqrt(Max(fastest2, W(1.0e-12f)));
      for (uint32_t k = 0; k < 3; ++k)
        for (uint32_t m = 0; m < N; ++m) {
          W& z = motion.axis[k].z[m];
          const W carried = Component(root, k) * W(t.pull_mode[m]);
          z = Select(over, carried + (z - carried) * less, z);
        }
    }
    return Min(Sqrt(fastest2), W(most));
  }
};

}  // namespace pelt::modal
