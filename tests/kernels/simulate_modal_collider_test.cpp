// Colliders in the way of modal chains: overlaps, velocities, links, what is too fast to be seen.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/kernels/modal_scene.hpp"

namespace pelt::test {
namespace {

// Upright strands, and a ball that stands in the upper ends of some from the side.
TEST(SimulateModalContact, OverlapsAreLeftAtABoundedSpeedAtEveryFrameRate) {
  const auto fastest_at = [](double rate, bool at_once) {
    auto s = std::make_unique<ModalScene<4>>(StrandMaterial(4, 3.0, 0.1, 6.0));
    s->SetRest(0.01, {0, 0, 1});
    s->layer.gravity[1] = 0.0f;
    for (int frame = 0; frame < 5; ++frame) s->Step(1.0 / rate);
    s->params.sphere_count = 1;
    const float sphere[4] = {0.016f, 0.0f, 0.03f, 0.02f};  // 4 mm over each tip
    for (int k = 0; k < 4; ++k) s->params.sphere[0][k] = sphere[k];
    double fastest = 0.0;
    for (int frame = 0; frame < int(0.5 * rate); ++frame) {
      s->params.sphere_step[0].at_once = at_once && frame == 0 ? 1 : 0;
      const Double3 before = s->Tip(0);
      s->Step(1.0 / rate);
      fastest = std::max(fastest, Length(s->Tip(0) - before) * rate);
    }
    EXPECT_LT(0.02 - Length(s->Tip(0) - Double3{0.016, 0.0, 0.03}), 1e-5) << "it got out";
    return fastest;
  };
  for (const double rate : {30.0, 60.0, 120.0, 240.0}) {
    const double eased = fastest_at(rate, false), at_once = fastest_at(rate, true);
    std::printf("%g Hz: %.3f m/s, at once %.3f m/s\n", rate, eased, at_once);
    EXPECT_LT(eased, 0.3) << rate;
    EXPECT_GT(eased, rate > 40 ? 0.15 : 0.1) << rate;
    EXPECT_GT(at_once, 0.1) << rate;
  }
  EXPECT_GT(fastest_at(240.0, true), 0.5);
}

// Tips ahead of a ball go as fast as it does, between frames too: with its velocity.
TEST(SimulateModalContact, ASpherePushesStrandsAlong) {
  const auto tip_at = [](double rate, bool velocity, double* lag) {
    auto s = std::make_unique<ModalScene<4>>(StrandMaterial(4, 3.0, 0.1, 6.0));
    s->SetRest(0.01, {0, 0, 1});
    s->layer.gravity[1] = 0.0f;
    s->AddSphere(0.02f);
    s->params.sphere[0][2] = 0.032f;
    const double speed = 0.4;
    *lag = 0.0;
    for (int frame = 0; frame < int(rate * 2.0 / 15.0 + 0.5); ++frame) {
      s->params.sphere[0][0] = float(-0.045 + speed * (frame + 1) / rate);
      s->params.sphere_step[0] = {};
      if (velocity) {
        s->params.sphere_step[0].from[0] = s->params.sphere_step[0].to[0] = float(speed / rate);
        s->params.sphere_step[0].moves = 1;
      } else {
        s->params.sphere_step[0].at_once = 1;
      }
      s->Step(1.0 / rate);
      const Double3 centre = {s->params.sphere[0][0], 0.0, 0.032};
      *lag = std::max(*lag, 0.02 - Length(s->Tip(0) - centre));
    }
    return s->Tip(0);
  };
  double lag[4];
  const Double3 fine = tip_at(960.0, true, &lag[0]), coarse = tip_at(60.0, true, &lag[1]),
                at30 = tip_at(30.0, true, &lag[2]), told_nothing = tip_at(60.0, false, &lag[3]);
  std::printf("60 Hz %.3f mm off, 30 Hz %.3f, without velocity %.3f; lag %.4f %.4f %.4f %.4f mm\n",
              1e3 * Length(coarse - fine), 1e3 * Length(at30 - fine),
              1e3 * Length(told_nothing - fine), 1e3 * lag[0], 1e3 * lag[1], 1e3 * lag[2],
              1e3 * lag[3]);
  for (const double depth : lag) EXPECT_LT(depth, 1e-4);
  EXPECT_LT(Length(coarse - fine), 5e-4);
  EXPECT_LT(Length(at30 - fine), 1e-3);
}

// Depth of the deepest point of any link in a ball, m.
template <uint32_t kPoints>
double DeepestLink(const ModalScene<kPoints>& s, Double3 centre, double radius) {
  double deepest = 0.0;
  for (uint32_t lane = 0; lane < s.state.live_strands; ++lane) {
    Double3 from = At(s.roots.position, lane);
    for (uint32_t i = 0; i + 1 < kPoints; ++i) {
      const Double3 to = At(s.position.position[i], lane);
      for (int part = 0; part <= 20; ++part)
        deepest = std::max(deepest, radius - Length(from + (to - from) * (part / 20.0) - centre));
      from = to;
    }
  }
  return deepest;
}

// A ball as small as a third of a link, on which strands fall across.
TEST(SimulateModalContact, LinksKeepOutOfASphereBetweenTheirEnds) {
  for (const double radius : {0.004, 0.01}) {
    auto s = std::make_unique<ModalScene<4>>(StrandMaterial(4, 0.7, 0.1, 6.0));
    std::mt19937 random(5);
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
      s->SetRest(lane, 0.012, {1, 0, 0});
      s->MoveRoot(lane, {Uniform(random, -0.028f, -0.012f), Uniform(random, -0.002f, 0.002f),
                         radius + 0.003});
    }
    s->PullDown();
    s->AddSphere(float(radius));
    double deepest = 0.0, lowest = 1.0, moved = 0.0;
    for (int frame = 0; frame < 600; ++frame) {
      const Double3 before = s->Tip(0);
      s->Step(kDt);
      s->HoldRoots();
      ASSERT_LT(s->Stretch(), 1e-5);
      deepest = std::max(deepest, DeepestLink(*s, {0, 0, 0}, radius));
      moved = Length(s->Tip(0) - before);
    }
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
      lowest = std::min(lowest, s->Tip(lane).z);
    std::printf("radius %.0f mm: %.4f mm deep, lowest tip %.1f mm, still moving %.6f mm\n",
                1e3 * radius, 1e3 * deepest, 1e3 * lowest, 1e3 * moved);
    EXPECT_LT(deepest, 0.01 * 0.036);
    EXPECT_LT(lowest, radius) << "nothing bends over it";
  }
}

// Upright strands about a line, and what of a round collider's way along it at `speed` they stand in.
struct Passage {
  double speed, rate, height, phase;
  ModalQuality quality = ModalQuality::kFine;
  bool bar = false;  // as long as 4 cm, across its way
  float friction = 0.0f;
};
constexpr double kBall = 0.015, kStrand = 0.03;

struct Passed {
  std::vector<double> depth,
      moved;  // of each strand in the ball at most, were it not moved; farthest tip
};

Passed Pass(const Passage& p) {
  auto s = std::make_unique<ModalScene<4>>(StrandMaterial(4, 3.0, 0.1, 6.0));
  s->quality = p.quality;
  s->layer.modal.friction = p.friction;
  std::mt19937 random(5);
  Passed passed;
  const double half = p.bar ? 0.02 : 0.0;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    s->SetRest(lane, kStrand / 3, {0, 0, 1});
    const double x = Uniform(random, -0.2f, 0.2f), y = Uniform(random, -0.016f, 0.016f);
    s->MoveRoot(lane, {x, y, 0.0});
    const double beside = std::max(std::fabs(y) - half, 0.0);
    const double above = std::max(p.height - kStrand, 0.0);
    passed.depth.push_back(kBall - std::hypot(beside, above));
  }
  s->layer.gravity[1] = 0.0f;
  s->Step(1.0 / p.rate);
  s->HoldRoots();
  const float way = float(p.speed / p.rate);
  ColliderStep& step = p.bar ? s->params.capsule_step[0] : s->params.sphere_step[0];
  step = {{way, 0, 0}, {way, 0, 0}, 1, 0};
  (p.bar ? s->params.capsule_count : s->params.sphere_count) = 1;
  CapsuleParams& bar = s->params.capsule[0];
  bar = {{0, float(-half), float(p.height)}, float(kBall), {0, 1, 0}, float(2.0 * half)};
  s->params.sphere[0][2] = float(p.height);
  s->params.sphere[0][3] = float(kBall);
  passed.moved.assign(kStrandsPerChunk, 0.0);
  const int frames = int(0.7 / p.speed * p.rate) + 2;
  for (int frame = 0; frame < frames + int(0.4 * p.rate); ++frame) {
    bar.from[0] = s->params.sphere[0][0] = float(-0.3 + p.speed * (frame + p.phase) / p.rate);
    s->Step(1.0 / p.rate);
    EXPECT_LT(s->Stretch(), 1e-5);
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
      const Double3 rest = {s->roots.position[0][lane], s->roots.position[1][lane], kStrand};
      passed.moved[lane] = std::max(passed.moved[lane], Length(s->Tip(lane) - rest));
    }
  }
  s->params.sphere_count = s->params.capsule_count = 0;
  for (int frame = 0; frame < int(4.0 * p.rate); ++frame) s->Step(1.0 / p.rate);
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    EXPECT_LT(std::fabs(s->Tip(lane).x - s->roots.position[0][lane]), 2e-3);
    EXPECT_GE(s->chain.quiet_s[lane], 0.0f) << "still taken as struck";
  }
  return passed;
}

// A ball of 3 cm at 10 m/s goes 17 to 4 cm in a frame, through strands of 3 cm: it moves every strand
// that it grazes by a tenth of a millimetre. Beside its way nothing moves at all.
TEST(SimulateModalContact, AFastSphereMissesNothingInItsWay) {
  std::mt19937 random(11);
  for (const double rate : {15.0, 30.0, 60.0, 120.0, 240.0})
    for (const double speed : {1.0, 3.0, 10.0, 20.0})
      for (const double height : {0.01, 0.02, 0.03, 0.04})
        for (const bool bar : {false, true}) {
          Passage p{speed, rate, height, Uniform(random, 0.0f, 1.0f)};
          p.bar = bar;
          p.friction = height == 0.03 ? 0.3f : 0.0f;
          p.quality = ModalQuality(uint32_t(random()) % 3);
          SCOPED_TRACE(testing::Message()
                       << rate << " Hz, " << speed << " m/s, " << height << (bar ? ", bar" : "")
                       << ", quality " << int(p.quality));
          const Passed passed = Pass(p);
          int missed = 0, hit = 0;
          double least = 1.0;
          for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
            const double depth = passed.depth[lane], moved = passed.moved[lane];
            if (depth < -1e-4) {
              EXPECT_LT(moved, 1e-8);
            }
            if (depth < 1e-4) continue;
            ++hit;
            missed += moved < (speed < 5.0 ? 0.5 * depth : 1e-3);
            least = std::min(least, moved);
          }
          std::printf("%3g Hz %2g m/s %g%s: %d of %d missed, least %.2f mm\n", rate, speed, height,
                      bar ? " bar" : "", missed, hit, 1e3 * least);
          EXPECT_EQ(missed, 0) << "of " << hit;
        }
}

// Strands within reach of its way that it does not touch keep the bits that they have without it.
TEST(SimulateModalContact, WhatAFastSphereMissesKeepsItsBits) {
  const auto run = [](bool with_ball) {
    auto s = std::make_unique<ModalScene<4>>(StrandMaterial(4, 3.0, 0.1, 6.0));
    std::mt19937 random(5);
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
      s->SetRest(lane, kStrand / 3, {0, 0, 1});
      s->MoveRoot(lane, {Uniform(random, -0.2f, 0.2f), Uniform(random, -0.06f, 0.06f), 0.0});
    }
    s->layer.gravity[1] = -1.0f;  // they swing, by up to 6 mm
    s->layer.surface_hardness = 1.0f;
    s->params.sphere_count = with_ball ? 1 : 0;
    s->params.sphere[0][2] = 0.025f;
    s->params.sphere[0][3] = float(kBall);
    const float way = float(10.0 / 60.0);
    s->params.sphere_step[0] = {{way, 0, 0}, {way, 0, 0}, 1, 0};
    for (int frame = 0; frame < 20; ++frame) {
      s->params.sphere[0][0] = way * float(frame - 10);
      s->Step(kDt);
      s->HoldRoots();
    }
    return s;
  };
  const auto with = run(true), without = run(false);
  int missed = 0, struck = 0;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    const bool beside = std::fabs(with->roots.position[1][lane]) > kBall + 0.006;
    const bool same = SameLinks(with->chain, without->chain, lane);
    if (beside) {
      EXPECT_TRUE(same) << lane;
    }
    missed += beside && std::fabs(with->roots.position[1][lane]) < kBall + kStrand;
    struck += !same;
  }
  EXPECT_GT(missed, int(kStrandsPerChunk) / 8);
  EXPECT_GT(struck, int(kStrandsPerChunk) / 8);
}

}  // namespace
}  // namespace pelt::test
