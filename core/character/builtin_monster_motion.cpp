// How the monster walks, stands, shakes itself and greets.
#include "core/character/builtin_monster.hpp"
#include "core/exact_math.hpp"
#include "core/float_rules.hpp"

namespace pelt::builtin {
namespace monster {
namespace {

// One step with each leg a second.
Motion Walk(double t) {
  Motion m;
  m.shift = {0.018 * Wave(t), -0.012 - 0.022 * Wave(2 * t + 0.1), 0.0};
  m.turn[kHips] = {0.04 * Wave(2 * t), 0.14 * Wave(t + 0.25), 0.07 * Wave(t)};
  m.turn[kSpine] = {0.05, -0.12 * Wave(t + 0.25), -0.08 * Wave(t)};
  m.turn[kChest] = {0.03 * Wave(2 * t + 0.2), -0.14 * Wave(t + 0.25), -0.05 * Wave(t)};
  m.turn[kNeck] = {0.05 * Wave(2 * t + 0.4), 0.08 * Wave(t + 0.25), 0.0};
  m.turn[kHeadJoint] = {0.09 * Wave(2 * t + 0.55), 0.06 * Wave(t + 0.3), 0.08 * Wave(t + 0.1)};
  for (int side = 0; side < 2; ++side) {
    const double p = side ? t + 0.5 : t;
    const double mirror = side ? -1.0 : 1.0;
    m.turn[side ? kBrowR : kBrowL] = {0.10 * Wave(2 * t + 0.6), 0.0, 0.12 * Wave(2 * p) * mirror};
    m.turn[side ? kThighR : kThighL] = {-0.52 * Wave(p), 0.0, 0.04 * mirror};
    m.turn[side ? kShinR : kShinL] = {0.42 * (1.0 - Wave(p - 0.08)) * 0.9, 0.0, 0.0};
    m.turn[side ? kFootR : kFootL] = {-0.12 + 0.30 * Wave(p - 0.2), 0.0, 0.0};
    m.turn[side ? kShoulderR : kShoulderL] = {0.62 * Wave(p), 0.0,
                                              (-0.22 + 0.06 * Wave(2 * t)) * mirror};
    m.turn[side ? kElbowR : kElbowL] = {-0.45 - 0.30 * Wave(p + 0.6), 0.0, 0.0};
    m.turn[side ? kHandR : kHandL] = {0.25 * Wave(p + 0.75), 0.0, 0.10 * Wave(p) * mirror};
  }
  for (int i = 0; i < 4; ++i)
    m.turn[size_t(kTail1 + i)] = {0.10 * Wave(2 * t - 0.12 * i), 0.26 * Wave(t - 0.13 * i), 0.0};
  return m;
}

// From the rest pose into a relaxed stand in half a second.
Motion Idle(double t) {
  const double e = Ease(t / 0.5);
  Motion m;
  m.shift = {0.015 * e, -0.01 * e, 0.0};
  m.turn[kSpine] = {0.04 * e, 0.0, 0.05 * e};
  m.turn[kHeadJoint] = {0.06 * e, 0.15 * e, -0.08 * e};
  for (int side = 0; side < 2; ++side) {
    const double mirror = side ? -1.0 : 1.0;
    m.turn[side ? kShoulderR : kShoulderL] = {0.0, 0.0, -0.25 * e * mirror};
    m.turn[side ? kElbowR : kElbowL] = {-0.25 * e, 0.0, 0.0};
    m.turn[side ? kThighR : kThighL] = {-0.06 * e, 0.0, 0.05 * e * mirror};
    m.turn[side ? kShinR : kShinL] = {0.10 * e, 0.0, 0.0};
  }
  for (int i = 0; i < 4; ++i) m.turn[size_t(kTail1 + i)] = {0.05 * e, 0.10 * e, 0.0};
  return m;
}

// Three swings a second for one second, swelling and fading, then still. Of more, or wider ones, fur is chaotic: no
// frame rate then shows where a strand belongs.
Motion Shake(double t) {
  const double s = t < 1.0 ? exact::Sin(exact::kPi * t) : 0.0;
  const double swell = 0.5 * s * s;
  Motion m;
  m.turn[kHeadJoint] = {0.15 * swell, 0.50 * swell * Wave(3 * t), 0.30 * swell * Wave(3 * t + 0.1)};
  m.turn[kNeck] = {0.10 * swell, 0.25 * swell * Wave(3 * t - 0.05), 0.0};
  m.turn[kChest] = {0.0, 0.18 * swell * Wave(3 * t - 0.12), 0.0};
  m.turn[kSpine] = {0.08 * swell, 0.14 * swell * Wave(3 * t - 0.2), 0.0};
  m.turn[kHips] = {0.0, 0.10 * swell * Wave(3 * t - 0.3), 0.0};
  m.turn[kBrowL] = {0.0, 0.0, 0.35 * swell * Wave(3 * t + 0.2)};
  m.turn[kBrowR] = {0.0, 0.0, 0.35 * swell * Wave(3 * t + 0.2)};
  m.turn[kShoulderL] = {0.0, 0.0, swell * (0.15 + 0.20 * Wave(3 * t))};
  m.turn[kShoulderR] = {0.0, 0.0, swell * (-0.15 + 0.20 * Wave(3 * t))};
  for (int i = 0; i < 4; ++i)
    m.turn[size_t(kTail1 + i)] = {0.0, 0.22 * swell * Wave(3 * t - 0.35 - 0.1 * i), 0.0};
  return m;
}

// Waves with an arm above its head, and nods at each second wave.
Motion Greet(double t) {
  Motion m;
  m.shift = {0.012 * Wave(t / 2), -0.012 - 0.008 * Wave(t), 0.0};
  m.turn[kHips] = {0.0, 0.05 * Wave(t / 2), 0.04 * Wave(t / 2)};
  m.turn[kSpine] = {0.03 + 0.02 * Wave(t), 0.06 * Wave(t / 2 + 0.1), -0.05 * Wave(t / 2)};
  m.turn[kChest] = {0.02 * Wave(t + 0.2), 0.06 * Wave(t / 2 + 0.15), 0.05};
  m.turn[kNeck] = {0.05 * Wave(t / 2 + 0.3), 0.0, 0.05 * Wave(t / 2)};
  m.turn[kHeadJoint] = {0.12 * Wave(t / 2 + 0.4), 0.10 * Wave(t / 2), 0.08 * Wave(t / 2 + 0.2)};
  m.turn[kShoulderR] = {0.10 * Wave(t), 0.0, -1.75 + 0.15 * Wave(t + 0.1)};
  m.turn[kElbowR] = {0.0, 0.0, -0.45 + 0.35 * Wave(t)};
  m.turn[kHandR] = {0.0, 0.0, 0.30 * Wave(t - 0.12)};
  m.turn[kShoulderL] = {0.06 * Wave(t / 2), 0.0, -0.25};
  m.turn[kElbowL] = {-0.30 - 0.06 * Wave(t / 2 + 0.2), 0.0, 0.0};
  for (int side = 0; side < 2; ++side)
    m.turn[side ? kBrowR : kBrowL] = {0.08 * Wave(t / 2 + 0.5), 0.0, 0.0};
  for (int i = 0; i < 4; ++i)
    m.turn[size_t(kTail1 + i)] = {0.05 * Wave(t - 0.12 * i), 0.20 * Wave(t / 2 - 0.1 * i), 0.0};
  return m;
}

constexpr ClipPlan kClips[] = {{"walk", Walk, true, 1.0, 16},
                               {"idle", Idle, false, 0.5, 15, 60.0},
                               {"shake", Shake, true, 1.6, 64},
                               {"greet", Greet, true, 2.0, 32}};

}  // namespace
}  // namespace monster

std::span<const ClipPlan> MonsterClips() { return monster::kClips; }

}  // namespace pelt::builtin
