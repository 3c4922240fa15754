// Friction of modal chains on colliders: held within the cone, slowed down by mu times the weight
// beyond it.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/kernels/modal_scene.hpp"

namespace pelt::test {
namespace {

constexpr double kGravity = 9.81;

// Strands that lie along x on the plane y = 0, pulled aside, along z, by `aside`: a slope, seen from
// its own plane.
template <uint32_t kPoints>
std::unique_ptr<ModalScene<kPoints>> LyingStrands(double hz, double friction, double aside,
                                                  ModalQuality quality = ModalQuality::kFine) {
  auto s = std::make_unique<ModalScene<kPoints>>(StrandMaterial(kPoints, hz, 0.1, 0.5));
  s->quality = quality;
  s->SetRest(0.01, {1, 0, 0});
  s->AddGround();
  s->layer.modal.friction = float(friction);
  s->layer.gravity[1] = float(-kGravity);
  s->layer.gravity[2] = float(aside);
  return s;
}

// Below atan(mu) a strand on a slope stays, above it slides.
TEST(SimulateModalFriction, HoldsUpToItsAngle) {
  for (const double rate : {30.0, 120.0})
    for (const ModalQuality quality : kQualities)
      for (const double friction : {0.1, 1.0})
        for (const double share : {0.9, 1.1}) {
          auto s = LyingStrands<4>(0.3, friction, share * friction * kGravity, quality);
          double lowest = 1.0, highest = -1.0;
          for (int frame = 0; frame < int(2.0 * rate); ++frame) {
            s->Step(1.0 / rate);
            lowest = std::min(lowest, s->Tip(0).y), highest = std::max(highest, s->Tip(0).y);
          }
          const double slid = s->Tip(0).z;
          EXPECT_LT(highest - lowest, 2e-6) << "it lies on the ground";
          if (share < 1.0)
            EXPECT_LT(std::fabs(slid), 2e-5) << rate << " Hz, mu " << friction;
          else
            EXPECT_GT(slid, 1e-3) << rate << " Hz, mu " << friction;
          EXPECT_LT(s->Stretch(), 1e-5);
        }
}

// Each link's end carries its own mass, so a strand that slides feels mu g less than what pulls it.
TEST(SimulateModalFriction, SlidesAsIfItWerePulledThatMuchLess) {
  for (const double friction : {0.1, 0.4}) {
    auto rubbed = LyingStrands<4>(1.0, friction, 2.0 + friction * kGravity);
    auto free = LyingStrands<4>(1.0, 0.0, 2.0);
    double off = 0.0, way = 0.0;
    for (int frame = 0; frame < 6; ++frame) {
      rubbed->Step(kDt), free->Step(kDt);
      off = std::max(off, Length(rubbed->Tip(0) - free->Tip(0)));
      way = std::max(way, free->Tip(0).z);
    }
    std::printf("mu %.1f: %.4f mm off of %.3f mm\n", friction, 1e3 * off, 1e3 * way);
    EXPECT_GT(way, 2e-3);
    EXPECT_LT(off, 0.02 * way) << friction;
  }
}

// Ground that moves under a strand bends it as far as mu times its weight does.
TEST(SimulateModalFriction, MovingGroundBendsAStrandAsMuTimesItsWeight) {
  for (const double rate : {30.0, 60.0, 240.0})
    for (const double friction : {0.0, 0.2, 0.5}) {
      auto dragged = LyingStrands<4>(3.0, friction, 0.0);
      auto pulled = LyingStrands<4>(3.0, 0.0, friction * kGravity);
      ColliderStep& step = dragged->params.ground_step;
      step.from[2] = step.to[2] = float(0.3 / rate);
      step.moves = 1;
      for (int frame = 0; frame < int(5.0 * rate); ++frame)
        dragged->Step(1.0 / rate), pulled->Step(1.0 / rate);
      const double off = Length(dragged->Tip(0) - pulled->Tip(0));
      std::printf("%g Hz, mu %.1f: %.4f mm off, %.3f mm aside\n", rate, friction, 1e3 * off,
                  1e3 * pulled->Tip(0).z);
      EXPECT_LT(off, 5e-5) << rate << " Hz, mu " << friction;
    }
}

// A capsule that goes along its own axis takes what lies on it along, until the springs pull more
// than it holds.
TEST(SimulateModalFriction, AMovingCapsuleDragsWhatLiesOnIt) {
  const auto aside_at = [](double friction, double speed, double seconds) {
    auto s = LyingStrands<4>(1.0, friction, 0.0);
    s->params.use_ground = 0;
    s->params.capsule_count = 1;
    CapsuleParams& c = s->params.capsule[0];
    c.from[0] = 0.022f, c.from[1] = -0.01f, c.axis[2] = 1.0f;
    c.length = 0.4f, c.radius = 0.01f;
    for (int frame = 0; frame < 60; ++frame) {
      c.from[2] = -0.2f;
      s->Step(kDt);
    }
    ColliderStep& step = s->params.capsule_step[0];
    step.from[2] = step.to[2] = float(speed * kDt);
    step.moves = 1;
    const double before = s->Tip(0).z;
    for (int frame = 0; frame < int(seconds / kDt + 0.5); ++frame) {
      c.from[2] += float(speed * kDt);
      s->Step(kDt);
    }
    return s->Tip(0).z - before;
  };
  const double speed = 0.02, seconds = 0.1;
  const double none = aside_at(0.0, speed, seconds), some = aside_at(0.005, speed, seconds),
               full = aside_at(1.0, speed, seconds), later = aside_at(1.0, speed, 0.2);
  std::printf("%.4f, %.4f, %.4f, %.4f mm aside\n", 1e3 * none, 1e3 * some, 1e3 * full, 1e3 * later);
  EXPECT_LT(std::fabs(none), 2e-6);
  EXPECT_GT(some, 1e-5);
  EXPECT_LT(some, 0.6 * full);
  // It lies on the capsule at 22 of 30 mm: its tip goes 30 / 22 as far.
  EXPECT_NEAR(full, speed * seconds * 30.0 / 22.0, 0.35 * speed * seconds);
  EXPECT_GT(later, 1.7 * full);
}

// What is held by friction comes to rest, all bits.
TEST(SimulateModalFriction, WhatIsHeldComesToRest) {
  auto s = LyingStrands<5>(2.0, 0.6, 0.2 * kGravity);
  s->params.rest_threshold = kRestThreshold;
  s->flags = kChunkSteady;
  std::mt19937 random(3);
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
    s->MoveRoot(lane, {Uniform(random, -0.1f, 0.1f), Uniform(random, -0.001f, 0.02f), 0.0});
  ModalStateBlock<4> last;
  for (int frame = 0; frame < 1200; ++frame) {
    last = s->chain;
    s->Step(kDt);
    s->HoldRoots();
    ASSERT_LT(s->Stretch(), 1e-5);
  }
  uint32_t awake = 0;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
    awake += std::memcmp(&last.direction[3][2][lane], &s->chain.direction[3][2][lane], 4) != 0;
  EXPECT_EQ(awake, 0u) << "of " << kStrandsPerChunk;
}

}  // namespace
}  // namespace pelt::test
