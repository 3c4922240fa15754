// The built-in monster: where its joints and primitives lie, and how it moves. Numbers are metres of
// the standard monster; a seed scales limbs, belly, head, ears and tail.
#include <algorithm>
#include <cmath>

#include "core/character/builtin_shape.hpp"
#include "core/exact_math.hpp"
#include "core/float_rules.hpp"
#include "core/random.hpp"

namespace pelt::builtin {
namespace monster {
namespace {
using glm::dvec3;

enum Material : uint8_t { kHead, kBrow, kBody, kArm, kLeg, kTail, kEye };
constexpr const char* kMaterialNames[] = {"head", "brow", "body", "arm", "leg", "tail", "eye"};

enum Joint : uint8_t {
  kRoot,
  kHips,
  kSpine,
  kChest,
  kNeck,
  kHeadJoint,
  kBrowL,
  kBrowR,
  kShoulderL,
  kElbowL,
  kHandL,
  kShoulderR,
  kElbowR,
  kHandR,
  kThighL,
  kShinL,
  kFootL,
  kThighR,
  kShinR,
  kFootR,
  kTail1,
  kTail2,
  kTail3,
  kTail4,
  kJointCount
};

struct Proportions {
  double size = 1.0, leg = 1.0, belly = 1.0, head = 1.0, arm = 1.0, tail = 1.0, ear = 1.0;
};

Proportions DrawProportions(uint64_t seed) {
  Proportions p;
  if (seed == 0) return p;
  Random random(MixSeed(seed, 0x6d6f6e73));
  p.size = random.Uniform(0.75, 1.15);
  p.leg = random.Uniform(0.75, 1.30);
  p.belly = random.Uniform(0.85, 1.20);
  p.head = random.Uniform(0.85, 1.20);
  p.arm = random.Uniform(0.80, 1.25);
  p.tail = random.Uniform(0.60, 1.30);
  p.ear = random.Uniform(0.50, 1.80);
  return p;
}

enum ChartIndex : uint8_t {
  kBodyChart,
  kHeadChart,
  kArmLChart,
  kArmRChart,
  kLegLChart,
  kLegRChart,
  kTailChart,
  kEyeLChart,
  kEyeRChart,
};

class Designer {
 public:
  explicit Designer(const BuiltinCharacterOptions& options)
      : p_(DrawProportions(options.seed)), inflate_(options.tiny ? 0.03 : 0.0) {}

  Shape Design() {
    shape_.name = "monster";
    shape_.cell_m = 0.027;
    shape_.joints.resize(kJointCount);
    shape_.carrier = kHips;
    shape_.materials.assign(std::begin(kMaterialNames), std::end(kMaterialNames));
    hip_ = 0.06 + 0.31 * p_.leg;
    PlaceTrunk();
    PlaceArms();
    PlaceLegs();
    PlaceTail();
    PlaceCharts();
    Scale();
    return shape_;
  }

 private:
  void Joint(monster::Joint joint, const char* name, int parent, const dvec3& at) {
    shape_.joints[joint] = {name, parent, at};
  }

  void Ellipsoid(const dvec3& centre, const dvec3& radii, monster::Joint joint, Material material,
                 ChartIndex chart, double blend) {
    shape_.primitives.push_back(
        MakeEllipsoid(centre, radii + dvec3(inflate_), joint, material, chart, blend));
  }

  void Cone(const dvec3& a, const dvec3& b, double radius_a, double radius_b, monster::Joint joint,
            Material material, ChartIndex chart, double blend) {
    shape_.primitives.push_back(
        MakeCone(a, b, radius_a + inflate_, radius_b + inflate_, joint, material, chart, blend));
  }

  void PlaceTrunk() {
    const double b = p_.belly, h = p_.head;
    head_ = dvec3(0.0, hip_ + 0.44 + 0.14 * h, 0.03);
    Joint(kRoot, "root", -1, dvec3(0.0));
    Joint(kHips, "hips", kRoot, {0.0, hip_, 0.0});
    Joint(kSpine, "spine", kHips, {0.0, hip_ + 0.12, 0.0});
    Joint(kChest, "chest", kSpine, {0.0, hip_ + 0.27, 0.0});
    Joint(kNeck, "neck", kChest, {0.0, hip_ + 0.40, 0.01});
    Joint(kHeadJoint, "head", kNeck, {0.0, hip_ + 0.45, 0.02});
    Ellipsoid({0.0, hip_, -0.01}, {0.205 * b, 0.15, 0.185 * b}, kHips, kBody, kBodyChart, 0.08);
    Ellipsoid({0.0, hip_ + 0.13, 0.02}, {0.235 * b, 0.21, 0.215 * b}, kSpine, kBody, kBodyChart,
              0.08);
    Ellipsoid({0.0, hip_ + 0.29, 0.0}, {0.175, 0.15, 0.155}, kChest, kBody, kBodyChart, 0.08);
    Cone({0.0, hip_ + 0.38, 0.005}, {0.0, hip_ + 0.45, 0.02}, 0.11, 0.11, kNeck, kBody, kBodyChart,
         0.05);
    Ellipsoid(head_, dvec3(0.185, 0.165, 0.165) * h, kHeadJoint, kHead, kHeadChart, 0.05);
    Ellipsoid(head_ + dvec3(0.0, -0.05, 0.135) * h, dvec3(0.105, 0.07, 0.075) * h, kHeadJoint,
              kHead, kHeadChart, 0.05);
    for (int side = 0; side < 2; ++side) {
      auto on = [&](const dvec3& at) { return head_ + (side ? Mirror(at) : at) * h; };
      const monster::Joint brow = side ? kBrowR : kBrowL;
      Joint(brow, side ? "brow_r" : "brow_l", kHeadJoint, on({0.075, 0.085, 0.12}));
      const dvec3 tip = dvec3(0.135, 0.125, -0.01) + dvec3(0.045, 0.075, 0.0) * p_.ear;
      Cone(on({0.115, 0.105, -0.01}), on(tip), 0.052 * h, 0.03 * h, kHeadJoint, kHead, kHeadChart,
           0.04);
      Cone(on({0.030, 0.082, 0.150}), on({0.125, 0.092, 0.092}), 0.027 * h, 0.024 * h, brow, kBrow,
           kHeadChart, 0.02);
      Ellipsoid(on({0.07, 0.022, 0.142}), dvec3(0.042) * h, kHeadJoint, kEye,
                side ? kEyeRChart : kEyeLChart, 0.008);
    }
  }

  void PlaceArms() {
    const dvec3 shoulder(0.155, hip_ + 0.33, 0.0);
    const dvec3 elbow = shoulder + dvec3(0.155, -0.155, 0.02) * p_.arm;
    const dvec3 wrist = elbow + dvec3(0.11, -0.155, 0.045) * p_.arm;
    const dvec3 hand = wrist + dvec3(0.025, -0.05, 0.015);
    for (int side = 0; side < 2; ++side) {
      auto on = [&](const dvec3& at) { return side ? Mirror(at) : at; };
      const monster::Joint s = side ? kShoulderR : kShoulderL, e = side ? kElbowR : kElbowL;
      const monster::Joint w = side ? kHandR : kHandL;
      const ChartIndex chart = side ? kArmRChart : kArmLChart;
      Joint(s, side ? "shoulder_r" : "shoulder_l", kChest, on(shoulder));
      Joint(e, side ? "elbow_r" : "elbow_l", s, on(elbow));
      Joint(w, side ? "hand_r" : "hand_l", e, on(wrist));
      Cone(on(shoulder), on(elbow), 0.078, 0.062, s, kArm, chart, 0.05);
      Cone(on(elbow), on(wrist), 0.062, 0.056, e, kArm, chart, 0.04);
      Ellipsoid(on(hand), dvec3(0.07, 0.072, 0.066), w, kArm, chart, 0.03);
    }
    arm_ = {shoulder, hand};
  }

  void PlaceLegs() {
    const dvec3 thigh(0.105, hip_ - 0.03, 0.0);
    const dvec3 knee(0.122, 0.06 + (thigh.y - 0.06) * 0.48, 0.02);
    const dvec3 ankle(0.128, 0.075, -0.005);
    for (int side = 0; side < 2; ++side) {
      auto on = [&](const dvec3& at) { return side ? Mirror(at) : at; };
      const monster::Joint t = side ? kThighR : kThighL, s = side ? kShinR : kShinL;
      const monster::Joint f = side ? kFootR : kFootL;
      const ChartIndex chart = side ? kLegRChart : kLegLChart;
      Joint(t, side ? "thigh_r" : "thigh_l", kHips, on(thigh));
      Joint(s, side ? "shin_r" : "shin_l", t, on(knee));
      Joint(f, side ? "foot_r" : "foot_l", s, on(ankle));
      Cone(on(thigh), on(knee), 0.098, 0.084, t, kLeg, chart, 0.05);
      Cone(on(knee), on(ankle), 0.084, 0.068, s, kLeg, chart, 0.04);
      Cone(on({0.13, 0.064, -0.02}), on({0.138, 0.055, 0.115}), 0.064, 0.055, f, kLeg, chart, 0.03);
    }
    leg_ = {thigh, dvec3(0.128, 0.0, 0.0)};
  }

  void PlaceTail() {
    const dvec3 step[4] = {
        {0.0, -0.02, -0.12}, {0.0, 0.05, -0.11}, {0.0, 0.10, -0.06}, {0.0, 0.12, 0.0}};
    const double radius[5] = {0.075, 0.066, 0.060, 0.052, 0.038};
    const char* names[4] = {"tail_1", "tail_2", "tail_3", "tail_4"};
    dvec3 at(0.0, hip_ - 0.02, -0.15 * p_.belly);
    tail_[0] = at;
    for (int i = 0; i < 4; ++i) {
      const monster::Joint joint = monster::Joint(kTail1 + i);
      const dvec3 next = at + step[i] * p_.tail;
      Joint(joint, names[i], i ? joint - 1 : int(kHips), at);
      Cone(at, next, radius[i], radius[i + 1], joint, kTail, kTailChart, 0.04);
      at = next;
    }
    tail_[1] = at;
  }

  void AddChart(const dvec3& from, const dvec3& to, const dvec3& front) {
    shape_.charts.push_back(MakeChart(from, to, front));
  }

  // In the order of ChartIndex.
  void PlaceCharts() {
    const dvec3 forward(0.0, 0.0, 1.0), up(0.0, 1.0, 0.0);
    AddChart({0.0, hip_ - 0.2, 0.0}, {0.0, hip_ + 0.5, 0.0}, forward);
    AddChart(head_ - up * 0.3, head_ + up * 0.3, forward);
    AddChart(arm_[0], arm_[1], forward);
    AddChart(Mirror(arm_[0]), Mirror(arm_[1]), forward);
    AddChart(leg_[0], leg_[1], forward);
    AddChart(Mirror(leg_[0]), Mirror(leg_[1]), forward);
    AddChart(tail_[0], tail_[1], up);
    const dvec3 eye = dvec3(0.07, 0.022, 0.142) * p_.head;
    AddChart(head_ + eye - forward * 0.05, head_ + eye + forward * 0.05, up);
    AddChart(head_ + Mirror(eye) - forward * 0.05, head_ + Mirror(eye) + forward * 0.05, up);
  }

  void Scale() {
    const double s = p_.size;
    for (JointPlace& joint : shape_.joints) joint.position *= s;
    for (Primitive& p : shape_.primitives)
      p = p.radius_b < 0.0
              ? MakeEllipsoid(p.a * s, p.b * s, p.joint, p.material, p.chart, p.blend * s)
              : MakeCone(p.a * s, p.b * s, p.radius_a * s, p.radius_b * s, p.joint, p.material,
                         p.chart, p.blend * s);
    for (Chart& chart : shape_.charts) {
      chart.origin *= s;
      chart.length *= s;
    }
  }

  Proportions p_;
  double inflate_;
  double hip_ = 0.0;
  dvec3 head_{0.0};
  std::array<dvec3, 2> arm_{}, leg_{}, tail_{};
  Shape shape_{};
};

// ---- How it walks, stands, shakes itself and greets ----------------------------------------------

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

Shape DesignMonster(const BuiltinCharacterOptions& options) {
  return monster::Designer(options).Design();
}
std::span<const ClipPlan> MonsterClips() { return monster::kClips; }

}  // namespace pelt::builtin
