// The built-in scorpion: eight legs, two claws, a tail with a sting.
#include <algorithm>

#include "core/character/builtin_shape.hpp"
#include "core/exact_math.hpp"
#include "core/float_rules.hpp"

namespace pelt::builtin {
namespace scorpion {
namespace {

using glm::dvec3;

constexpr const char* kMaterialNames[] = {"head", "body", "tail", "sting", "claw", "leg", "eye"};
enum Material : uint8_t { kHead, kBody, kTail, kSting, kClaw, kLeg, kEye };

constexpr int kLegs = 4, kTailJoints = 6;  // legs of a side

// Sides follow each other: left, then right.
enum Joint : uint8_t {
  kRoot,
  kBodyJoint,
  kHeadJoint,
  kAbdomen,
  kTail1,
  kArmL = kTail1 + kTailJoints,
  kElbowL,
  kClawL,
  kFingerL,
  kArmR,
  kThighL1 = kArmR + 4,
  kThighR1 = kThighL1 + 2 * kLegs,
  kJointCount = kThighR1 + 2 * kLegs
};
static_assert(kJointCount <= kMostJoints);

constexpr const char* kTailNames[kTailJoints] = {"tail_1", "tail_2", "tail_3",
                                                 "tail_4", "tail_5", "sting"};
constexpr const char* kArmNames[2][4] = {{"arm_l", "elbow_l", "claw_l", "finger_l"},
                                         {"arm_r", "elbow_r", "claw_r", "finger_r"}};
constexpr const char* kLegNames[2][kLegs][2] = {{{"thigh_l1", "shin_l1"},
                                                 {"thigh_l2", "shin_l2"},
                                                 {"thigh_l3", "shin_l3"},
                                                 {"thigh_l4", "shin_l4"}},
                                                {{"thigh_r1", "shin_r1"},
                                                 {"thigh_r2", "shin_r2"},
                                                 {"thigh_r3", "shin_r3"},
                                                 {"thigh_r4", "shin_r4"}}};

uint8_t ArmJoint(int side, int part) { return uint8_t((side ? kArmR : kArmL) + part); }
uint8_t LegJoint(int side, int leg, int part) {
  return uint8_t((side ? kThighR1 : kThighL1) + 2 * leg + part);
}

class Designer {
 public:
  Shape Design() {
    shape_.name = "scorpion";
    shape_.cell_m = 0.016;
    shape_.joints.resize(kJointCount);
    shape_.carrier = kBodyJoint;
    shape_.materials.assign(std::begin(kMaterialNames), std::end(kMaterialNames));
    PlaceTrunk();
    PlaceTail();
    for (int side = 0; side < 2; ++side) {
      PlaceArm(side);
      for (int leg = 0; leg < kLegs; ++leg) PlaceLeg(side, leg);
    }
    return shape_;
  }

 private:
  uint8_t AddChart(const dvec3& from, const dvec3& to, const dvec3& front) {
    shape_.charts.push_back(MakeChart(from, to, front));
    return uint8_t(shape_.charts.size() - 1);
  }
  void Ellipsoid(const dvec3& centre, const dvec3& radii, uint8_t joint, Material material,
                 uint8_t chart, double blend) {
    shape_.primitives.push_back(MakeEllipsoid(centre, radii, joint, material, chart, blend));
  }
  void Cone(const dvec3& a, const dvec3& b, double radius_a, double radius_b, uint8_t joint,
            Material material, uint8_t chart, double blend) {
    shape_.primitives.push_back(MakeCone(a, b, radius_a, radius_b, joint, material, chart, blend));
  }

  void PlaceTrunk() {
    const dvec3 up(0.0, 1.0, 0.0), forward(0.0, 0.0, 1.0);
    const uint8_t chart = AddChart({0.0, 0.24, -0.4}, {0.0, 0.24, 0.4}, up);
    shape_.joints[kRoot] = {"root", -1, dvec3(0.0)};
    shape_.joints[kBodyJoint] = {"body", kRoot, {0.0, 0.23, 0.0}};
    shape_.joints[kHeadJoint] = {"head", kBodyJoint, {0.0, 0.24, 0.16}};
    shape_.joints[kAbdomen] = {"abdomen", kBodyJoint, {0.0, 0.24, -0.14}};
    Ellipsoid({0.0, 0.235, 0.03}, {0.185, 0.105, 0.175}, kBodyJoint, kBody, chart, 0.06);
    Ellipsoid({0.0, 0.255, 0.19}, {0.155, 0.115, 0.115}, kHeadJoint, kHead, chart, 0.05);
    Ellipsoid({0.0, 0.245, -0.17}, {0.150, 0.095, 0.165}, kAbdomen, kBody, chart, 0.06);
    for (int side = 0; side < 2; ++side) {
      const dvec3 at(0.068, 0.325, 0.262), seen = side ? Mirror(at) : at;
      Ellipsoid(seen, dvec3(0.046), kHeadJoint, kEye,
                AddChart(seen - forward * 0.05, seen + forward * 0.05, up), 0.008);
    }
  }

  // Over the back to a sting that points forward.
  void PlaceTail() {
    const dvec3 at[kTailJoints + 1] = {{0.0, 0.26, -0.30}, {0.0, 0.33, -0.41}, {0.0, 0.45, -0.48},
                                       {0.0, 0.58, -0.48}, {0.0, 0.69, -0.41}, {0.0, 0.73, -0.29},
                                       {0.0, 0.66, -0.16}};
    const double radius[kTailJoints + 1] = {0.082, 0.074, 0.068, 0.062, 0.058, 0.060, 0.014};
    const dvec3 side(1.0, 0.0, 0.0);
    uint8_t chart = 0;
    for (int i = 0; i < kTailJoints; ++i) {
      // The tail bends too far for one cylinder: two links share one.
      if (i % 2 == 0) chart = AddChart(at[i], at[i + 2], side);
      const uint8_t joint = uint8_t(kTail1 + i);
      shape_.joints[joint] = {kTailNames[i], i ? joint - 1 : int(kAbdomen), at[i]};
      const bool sting = i + 1 == kTailJoints;
      Cone(at[i], at[i + 1], radius[i], radius[i + 1], joint, sting ? kSting : kTail, chart,
           sting ? 0.015 : 0.03);
    }
  }

  void PlaceArm(int side) {
    const auto on = [side](const dvec3& at) { return side ? Mirror(at) : at; };
    const dvec3 arm(0.12, 0.21, 0.22), elbow(0.29, 0.23, 0.30), claw(0.29, 0.22, 0.47);
    const dvec3 finger(0.26, 0.22, 0.58);
    const uint8_t chart = AddChart(on(arm), on(finger), {0.0, 1.0, 0.0});
    const dvec3 places[4] = {arm, elbow, claw, finger};
    for (int part = 0; part < 4; ++part)
      shape_.joints[ArmJoint(side, part)] = {kArmNames[side][part],
                                             part ? ArmJoint(side, part - 1) : int(kBodyJoint),
                                             on(places[part])};
    Cone(on(arm), on(elbow), 0.050, 0.046, ArmJoint(side, 0), kClaw, chart, 0.03);
    Cone(on(elbow), on(claw), 0.048, 0.058, ArmJoint(side, 1), kClaw, chart, 0.03);
    Ellipsoid(on({0.285, 0.22, 0.53}), {0.082, 0.068, 0.105}, ArmJoint(side, 2), kClaw, chart,
              0.03);
    Cone(on({0.325, 0.22, 0.58}), on({0.292, 0.22, 0.72}), 0.046, 0.016, ArmJoint(side, 2), kClaw,
         chart, 0.02);
    Cone(on(finger), on({0.232, 0.22, 0.70}), 0.036, 0.015, ArmJoint(side, 3), kClaw, chart, 0.012);
  }

  void PlaceLeg(int side, int leg) {
    const auto on = [side](const dvec3& at) { return side ? Mirror(at) : at; };
    const double fan = (leg - 1.5) / 1.5;  // 1 at the last pair: backwards
    const dvec3 hip(0.13, 0.20, 0.12 - 0.085 * leg);
    const dvec3 knee = hip + dvec3(0.17, 0.12, -0.09 * fan);
    const dvec3 foot(knee.x + 0.13, 0.022, knee.z - 0.09 * fan);
    const uint8_t chart = AddChart(on(hip), on(foot), {0.0, 1.0, 0.0});
    shape_.joints[LegJoint(side, leg, 0)] = {kLegNames[side][leg][0], kBodyJoint, on(hip)};
    shape_.joints[LegJoint(side, leg, 1)] = {kLegNames[side][leg][1], LegJoint(side, leg, 0),
                                             on(knee)};
    Cone(on(hip), on(knee), 0.040, 0.034, LegJoint(side, leg, 0), kLeg, chart, 0.025);
    Cone(on(knee), on(foot), 0.034, 0.022, LegJoint(side, leg, 1), kLeg, chart, 0.015);
  }

  Shape shape_{};
};

// Two groups of four legs step in turn, in a second; a foot is lifted while it swings forward.
void Step(double t, Motion& m) {
  for (int side = 0; side < 2; ++side) {
    const double mirror = side ? -1.0 : 1.0;
    for (int leg = 0; leg < kLegs; ++leg) {
      const double phase = t + 0.5 * ((leg + side) % 2) - 0.04 * leg;
      const double forward = Wave(phase), rising = std::max(Wave(phase + 0.25), 0.0);
      const double lift = rising * rising;
      m.turn[LegJoint(side, leg, 0)] = {0.0, -0.30 * forward * mirror, 0.30 * lift * mirror};
      m.turn[LegJoint(side, leg, 1)] = {0.0, 0.0, -0.12 * lift * mirror};
    }
  }
}

Motion Walk(double t) {
  Motion m;
  Step(t, m);
  m.shift = {0.008 * Wave(t), 0.010 * Wave(2 * t + 0.1), 0.0};
  m.turn[kBodyJoint] = {0.02 * Wave(2 * t), 0.06 * Wave(t), 0.03 * Wave(t + 0.25)};
  m.turn[kHeadJoint] = {0.05 * Wave(2 * t + 0.3), 0.05 * Wave(t + 0.1), 0.0};
  m.turn[kAbdomen] = {0.03 * Wave(2 * t + 0.5), -0.08 * Wave(t), 0.0};
  for (int i = 0; i < kTailJoints; ++i)
    m.turn[size_t(kTail1 + i)] = {0.05 * Wave(2 * t - 0.09 * i), 0.10 * Wave(t - 0.11 * i),
                                  0.05 * Wave(t - 0.11 * i)};
  for (int side = 0; side < 2; ++side) {
    const double mirror = side ? -1.0 : 1.0, p = t + 0.5 * side;
    m.turn[ArmJoint(side, 0)] = {0.06 * Wave(p), 0.10 * Wave(p + 0.2) * mirror,
                                 0.10 * Wave(p) * mirror};
    m.turn[ArmJoint(side, 1)] = {0.05 * Wave(p + 0.3), 0.10 * Wave(p + 0.4) * mirror, 0.0};
    m.turn[ArmJoint(side, 3)] = {0.0, 0.16 * (1.0 + Wave(2 * p)) * mirror, 0.0};
  }
  return m;
}

// Down on its legs in half a second, claws half open.
Motion Idle(double t) {
  const double e = Ease(t / 0.5);
  Motion m;
  m.shift = {0.0, -0.02 * e, 0.0};
  m.turn[kHeadJoint] = {-0.06 * e, 0.05 * e, 0.0};
  for (int i = 0; i < kTailJoints; ++i) m.turn[size_t(kTail1 + i)] = {-0.05 * e, 0.03 * e, 0.0};
  for (int side = 0; side < 2; ++side) {
    const double mirror = side ? -1.0 : 1.0;
    for (int leg = 0; leg < kLegs; ++leg) {
      m.turn[LegJoint(side, leg, 0)] = {0.0, 0.0, 0.07 * e * mirror};
      m.turn[LegJoint(side, leg, 1)] = {0.0, 0.0, -0.10 * e * mirror};
    }
    m.turn[ArmJoint(side, 3)] = {0.0, 0.25 * e * mirror, 0.0};
  }
  return m;
}

// Draws the tail back, strikes over its head, and comes to rest.
Motion Strike(double t) {
  const double back = Ease(t / 0.5) * (1.0 - Ease((t - 0.5) / 0.15));
  const double struck = Ease((t - 0.5) / 0.15) * (1.0 - Ease((t - 0.75) / 0.6));
  Motion m;
  m.shift = {0.0, -0.03 * back + 0.01 * struck, -0.03 * back + 0.05 * struck};
  m.turn[kBodyJoint] = {-0.06 * back + 0.10 * struck, 0.0, 0.0};
  for (int i = 0; i < kTailJoints; ++i)
    m.turn[size_t(kTail1 + i)] = {-0.14 * back + 0.20 * struck, 0.0, 0.0};
  for (int side = 0; side < 2; ++side) {
    const double mirror = side ? -1.0 : 1.0;
    m.turn[ArmJoint(side, 0)] = {-0.25 * back, 0.25 * back * mirror, 0.0};
    m.turn[ArmJoint(side, 3)] = {0.0, 0.45 * back * mirror, 0.0};
  }
  return m;
}

constexpr ClipPlan kClips[] = {{"walk", Walk, true, 1.0, 16},
                               {"idle", Idle, false, 0.5, 15, 60.0},
                               {"strike", Strike, true, 1.5, 60}};

}  // namespace
}  // namespace scorpion

Shape DesignScorpion() { return scorpion::Designer().Design(); }
std::span<const ClipPlan> ScorpionClips() { return scorpion::kClips; }

}  // namespace pelt::builtin
