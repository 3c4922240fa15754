// Changes to what a modal chain is given of the last frames: where it does not feel all of what its
// root does, and where it grew.
//
// The idea: a strand that feels a share of its root's turns is simulated in axes that make the rest
// of each turn with it. Turned into the axes of this frame's end, its directions, its velocities
// relative to the root and the past of its rest directions are those of a body that did not turn so
// far; what is left of the turn goes through the frame as ever. So the motion is that of a root that
// turns less, at every frame rate. Gravity, wind and the root's path stay as they are in the world.
//
//   turn  last normal -> normal by the least turn, then about the normal as far as the first node's
//         rest tangent went round; the share of it by a quaternion that is mixed with none
//
// How the root turned is known from what the state has of the last frame: the skin's normal and, in
// the pull, the rest direction. Turns about the normal of a strand that stands
// straight on the skin are not known, and not made.
//
// Lengths are in parts of the strand, so when those grow the root's past is so many fewer of them.
//
// Invariant: a lane whose root did not turn and that did not grow keeps all its bits.
#pragma once

#include "core/kernels/modal_motion.hpp"
#include "core/kernels/modal_ports.hpp"

namespace pelt::modal {

PELT_INLINE bool HasRootHistory(const ModalTerms& terms) {
  return terms.turn_follow > 0.0f || (terms.shrink != 1.0f && terms.shrink != 0.0f);
}

template <class W>
struct Quaternion {
  W w;
  Vec3<W> v;

  PELT_INLINE Vec3<W> Turn(Vec3<W> a) const {
    const Vec3<W> t = Cross(v, a) * W(2.0f);
    const Vec3<W> round = Cross(v, t);
    return a + t * w + round;
  }
};

template <class W>
PELT_INLINE Quaternion<W> UnitQuaternion(W w, Vec3<W> v) {
  const W inverse = Rsqrt(Max(w * w + Dot(v, v), W(1.0e-20f)));
  return {w * inverse, v * inverse};
}

// The turn that takes unit vectors `from` to `to` and, about `to`, `rest_from` towards `rest_to`.
template <class W>
PELT_INLINE Quaternion<W> TurnOfRoot(Vec3<W> from, Vec3<W> to, Vec3<W> rest_from, Vec3<W> rest_to) {
  constexpr float kLeastCosine = 1.0e-6f;  // and one
  // Of the square of a sine: nearer to the normal a rest direction does not say how it went round.
  constexpr float kLeastTilt = 1.0e-5f;
  const Quaternion<W> lean =
      UnitQuaternion(Max(W(1.0f) + Dot(from, to), W(kLeastCosine)), Cross(from, to));
  const Vec3<W> leant = lean.Turn(rest_from);
  const Vec3<W> a = leant - to * Dot(leant, to);
  const Vec3<W> b = rest_to - to * Dot(rest_to, to);
  const W aa = Dot(a, a), bb = Dot(b, b);
  const typename W::Mask tilted = (aa > W(kLeastTilt)) & (bb > W(kLeastTilt));
  const W size = Sqrt(aa * bb);
  const W cosine = Dot(a, b), sine = Dot(to, Cross(a, b));
  const W half = Select(tilted, Max(size + cosine, size * W(kLeastCosine)), W(1.0f));
  const W round = Select(tilted, sine, W(0.0f));
  const Quaternion<W> twist = UnitQuaternion(half, to * round);
  const W w = twist.w * lean.w - Dot(twist.v, lean.v);
  const Vec3<W> v = lean.v * twist.w + twist.v * lean.w + Cross(twist.v, lean.v);
  const typename W::Mask back = w < W(0.0f);
  return {Abs(w), Select<W>(back, v * W(-1.0f), v)};
}

// Of lanes `at`.
template <class W, uint32_t kPoints, class Ports, class At>
struct RootHistory {
  static constexpr uint32_t N = NodesOf(kPoints);
  using Motion = modal::Motion<W, N>;
  using Mask = typename W::Mask;

  // After motion was loaded: its directions, velocities and differences again.
  static __attribute__((noinline)) void Take(const Ports& ports, const At& at, Vec3<W> rest,
                                             Motion& motion) {
    Past past;
    FindPast(ports, at, rest, motion, past);
    TakeStart(ports, at, past, motion);
    TakeDifferences(ports, at, past, motion);
  }

  // Its directions and velocities alone.
  static __attribute__((noinline)) void TakeStart(const Ports& ports, const At& at, Vec3<W> rest,
                                                  Motion& motion) {
    Past past;
    FindPast(ports, at, rest, motion, past);
    TakeStart(ports, at, past, motion);
  }

 private:
  struct Past {
    Mask other;          // lanes with another past than the state has
    Quaternion<W> turn;  // what the strand makes with its root
    W shrink;
    Vec3<W> step, curve, speed;  // of the root, in last frame's parts
  };

  static PELT_INLINE void FindPast(const Ports& ports, const At& at, Vec3<W> rest,
                                   const Motion& motion, Past& past) {
    const ModalTableBlock& t = *ports.table;
    const ModalStateBlock<NodesOf(kPoints)>& old = *ports.chain;
    const LayerBlock& layer = *ports.layer;
    const Vec3<W> normal = Load3<W>(ports.roots->normal, at);
    const Vec3<W> last_normal = Load3<W>(old.normal, at);
    const Vec3<W> off = normal - last_normal;
    W moved = Abs(off.x) + Abs(off.y) + Abs(off.z);
    W last_rest[3];
    for (uint32_t k = 0; k < 3; ++k) {
      W pull[N];
      for (uint32_t m = 0; m < N; ++m) {
        pull[m] = LoadLanes<W>(old.bend[m][k], at);
        moved = moved + Abs(motion.axis[k].bend[0][m] - pull[m]);
      }
      last_rest[k] = Weigh<W, N>(t.rest_of_bend[0], pull);
    }
    const Mask turned = moved > W(0.0f);
    const Quaternion<W> whole =
        TurnOfRoot(last_normal, normal, {last_rest[0], last_rest[1], last_rest[2]}, rest);
    const W share = Select(turned, W(layer.modal.turn_follow), W(0.0f));
    const W w = W(1.0f) + (whole.w - W(1.0f)) * share;
    past.turn = UnitQuaternion(w, whole.v * share);
    past.shrink = W(layer.modal.shrink == 0.0f ? 1.0f : layer.modal.shrink);
    past.other = turned | (past.shrink < W(1.0f)) | (past.shrink > W(1.0f));
    past.step = Load3<W>(old.root_step, at);
    past.curve = Load3<W>(old.root_turn, at);
    const Vec3<W> way = past.step + past.curve * W(0.5f);
    past.speed = way * W(layer.frame_ratio * t.euler_speed);
  }

  // A row that the root's motion is part of, by `share` of `root`.
  static PELT_INLINE Vec3<W> TurnRow(const Past& past, Vec3<W> row, Vec3<W> root, W share) {
    const Vec3<W> part = root * share;
    const Vec3<W> turned = past.turn.Turn(row - part);
    return turned + part * past.shrink;
  }

  static PELT_INLINE void TakeStart(const Ports& ports, const At& at, const Past& past,
                                    Motion& motion) {
    const ModalTableBlock& t = *ports.table;
    const ModalStateBlock<NodesOf(kPoints)>& old = *ports.chain;
    for (uint32_t m = 0; m < N; ++m) {
      const Vec3<W> z = TurnRow(past, Load3<W>(old.velocity[m], at), past.speed, W(t.pull_mode[m]));
      const Vec3<W> d = past.turn.Turn(Load3<W>(old.direction[m], at));
      for (uint32_t k = 0; k < 3; ++k) {
        Axis<W, N>& a = motion.axis[k];
        a.z[m] = Select(past.other, Component(z, k), a.z[m]);
        a.d[m] = Select(past.other, Component(d, k), a.d[m]);
      }
    }
  }

  static PELT_INLINE void TakeDifferences(const Ports& ports, const At& at, const Past& past,
                                          Motion& motion) {
    const ModalTableBlock& t = *ports.table;
    const ModalStateBlock<NodesOf(kPoints)>& old = *ports.chain;
    for (uint32_t m = 0; m < N; ++m) {
      const W place = W(t.bend_root[m]);
      const Vec3<W> bend = past.turn.Turn(Load3<W>(old.bend[m], at));
      const Vec3<W> step = TurnRow(past, Load3<W>(old.bend_step[m], at), past.step, place);
      const Vec3<W> curve = TurnRow(past, Load3<W>(old.bend_turn[m], at), past.curve, place);
      for (uint32_t k = 0; k < 3; ++k) {
        Axis<W, N>& a = motion.axis[k];
        const W first = a.bend[0][m] - Component(bend, k) + a.root[0] * place;
        const W second = first - Component(step, k);
        const W third = second - Component(curve, k);
        a.bend[1][m] = Select(past.other, first, a.bend[1][m]);
        a.bend[2][m] = Select(past.other, second, a.bend[2][m]);
        a.bend[3][m] = Select(past.other, third, a.bend[3][m]);
      }
    }
    for (uint32_t k = 0; k < 3; ++k) {
      Axis<W, N>& a = motion.axis[k];
      const W second = a.root[0] - Component(past.step, k) * past.shrink;
      const W third = second - Component(past.curve, k) * past.shrink;
      a.root[1] = Select(past.other, second, a.root[1]);
      a.root[2] = Select(past.other, third, a.root[2]);
    }
  }
};

}  // namespace pelt::modal
