// Colliders in the way of modal chains: overlaps, velocities, links, what is too fast to be seen.
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/kernels/modal_scene.hpp"

namespace pelt::test {
namespace {

// Upright strands, and a ball that stands in the upper ends of some from the side.
TEST(SimulateModalContact, OverlapsAreLeftAtABoundedSpeedAtEveryFrameRate) {
  const auto fastest_at = [](double rate, bool at_once) {
    auto s = std::make_unique<ModalScene<4>>(CalibratedMaterial(3, 3.0, 0.1, 6.0));
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
      s->SetRest(lane, 0.01, std::vector<Point3>(3, {0, 0, 1}));
    s->layer.gravity[1] = 0.0f;
    for (int frame = 0; frame < 5; ++frame) s->Step(1.0 / rate);
    s->params.sphere_count = 1;
    const float sphere[4] = {0.016f, 0.0f, 0.03f, 0.02f};  // 4 mm over each tip
    for (int k = 0; k < 4; ++k) s->params.sphere[0][k] = sphere[k];
    double fastest = 0.0;
    for (int frame = 0; frame < int(0.5 * rate); ++frame) {
      s->params.sphere_step[0].at_once = at_once && frame == 0 ? 1 : 0;
      const Point3 before = s->Tip(0);
      s->Step(1.0 / rate);
      fastest = std::max(fastest, Norm(s->Tip(0) - before) * rate);
    }
    EXPECT_LT(0.02 - Norm(s->Tip(0) - Point3{0.016, 0.0, 0.03}), 1e-5) << "it got out";
    return fastest;
  };
  for (const double rate : {30.0, 60.0, 120.0, 240.0}) {
    const double eased = fastest_at(rate, false), at_once = fastest_at(rate, true);
    std::printf("%g Hz: %.3f m/s, at once %.3f m/s\n", rate, eased, at_once);
    EXPECT_LT(eased, 0.25) << rate;
    EXPECT_GT(eased, rate > 40 ? 0.15 : 0.1) << rate;
    EXPECT_GT(at_once, 0.1) << rate;
  }
  EXPECT_GT(fastest_at(240.0, true), 0.5);
}

// Tips ahead of a ball go as fast as it does, between frames too: with its velocity.
TEST(SimulateModalContact, ASpherePushesStrandsAlong) {
  const auto tip_at = [](double rate, bool velocity, double* lag) {
    auto s = std::make_unique<ModalScene<4>>(CalibratedMaterial(3, 3.0, 0.1, 6.0));
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
      s->SetRest(lane, 0.01, std::vector<Point3>(3, {0, 0, 1}));
    s->layer.gravity[1] = 0.0f;
    s->params.sphere_count = 1;
    s->params.sphere[0][2] = 0.032f;
    s->params.sphere[0][3] = 0.02f;
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
      const Point3 centre = {s->params.sphere[0][0], 0.0, 0.032};
      *lag = std::max(*lag, 0.02 - Norm(s->Tip(0) - centre));
    }
    return s->Tip(0);
  };
  double lag[4];
  const Point3 fine = tip_at(960.0, true, &lag[0]), coarse = tip_at(60.0, true, &lag[1]),
               at30 = tip_at(30.0, true, &lag[2]), told_nothing = tip_at(60.0, false, &lag[3]);
  std::printf("60 Hz %.3f mm off, 30 Hz %.3f, without velocity %.3f; lag %.4f %.4f %.4f %.4f mm\n",
              1e3 * Norm(coarse - fine), 1e3 * Norm(at30 - fine), 1e3 * Norm(told_nothing - fine),
              1e3 * lag[0], 1e3 * lag[1], 1e3 * lag[2], 1e3 * lag[3]);
  for (const double depth : lag) EXPECT_LT(depth, 1e-4);
  EXPECT_LT(Norm(coarse - fine), 5e-4);
  EXPECT_LT(Norm(at30 - fine), 1e-3);
}

// Depth of the deepest point of any link in a ball, m.
template <uint32_t kPoints>
double DeepestLink(const ModalScene<kPoints>& s, Point3 centre, double radius) {
  double deepest = 0.0;
  for (uint32_t lane = 0; lane < s.state.live_strands; ++lane) {
    Point3 from = {s.roots.position[0][lane], s.roots.position[1][lane], s.roots.position[2][lane]};
    for (uint32_t i = 0; i + 1 < kPoints; ++i) {
      const auto& p = s.position.position[i];
      const Point3 to = {p[0][lane], p[1][lane], p[2][lane]};
      for (int part = 0; part <= 20; ++part)
        deepest = std::max(deepest, radius - Norm(from + (to - from) * (part / 20.0) - centre));
      from = to;
    }
  }
  return deepest;
}

// A ball as small as a third of a link, on which strands fall across.
TEST(SimulateModalContact, LinksKeepOutOfASphereBetweenTheirEnds) {
  for (const double radius : {0.004, 0.01}) {
    auto s = std::make_unique<ModalScene<4>>(CalibratedMaterial(3, 0.7, 0.1, 6.0));
    std::mt19937 random(5);
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
      s->SetRest(lane, 0.012, std::vector<Point3>(3, {1, 0, 0}));
      s->MoveRoot(lane, {Uniform(random, -0.028f, -0.012f), Uniform(random, -0.002f, 0.002f),
                         radius + 0.003});
    }
    s->layer.gravity[1] = 0.0f;
    s->layer.gravity[2] = -9.81f;
    s->params.sphere_count = 1;
    s->params.sphere[0][3] = float(radius);
    double deepest = 0.0, lowest = 1.0, moved = 0.0;
    for (int frame = 0; frame < 600; ++frame) {
      const Point3 before = s->Tip(0);
      s->Step(kDt);
      s->HoldRoots();
      ASSERT_LT(s->Stretch(), 1e-5);
      deepest = std::max(deepest, DeepestLink(*s, {0, 0, 0}, radius));
      moved = Norm(s->Tip(0) - before);
    }
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
      lowest = std::min(lowest, s->Tip(lane).z);
    std::printf("radius %.0f mm: %.4f mm deep, lowest tip %.1f mm, still moving %.6f mm\n",
                1e3 * radius, 1e3 * deepest, 1e3 * lowest, 1e3 * moved);
    EXPECT_LT(deepest, 0.01 * 0.036);
    EXPECT_LT(lowest, radius) << "nothing bends over it";
  }
}

// A ball of 3 cm at 10 m/s goes 17 to 6 cm in a substep, through strands of 3 cm. Those it misses are in lanes that
// fall back to steps that know no contact.
TEST(SimulateModalContact, AFastSphereDoesNotTunnel) {
  for (const double rate : {30.0, 60.0, 120.0})
    for (const ModalQuality quality :
         {ModalQuality::kFast, ModalQuality::kDefault, ModalQuality::kBest})
      for (const double aim : {0.02, 0.03}) {
        SCOPED_TRACE(testing::Message() << rate << " Hz, quality " << int(quality) << ", " << aim);
        auto s = std::make_unique<ModalScene<4>>(CalibratedMaterial(3, 3.0, 0.1, 6.0));
        s->quality = quality;
        std::mt19937 random(5);
        for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
          s->SetRest(lane, 0.01, std::vector<Point3>(3, {0, 0, 1}));
          s->MoveRoot(lane, {Uniform(random, -0.2f, 0.2f), Uniform(random, -0.01f, 0.01f), 0.0});
        }
        s->layer.gravity[1] = 0.0f;
        s->Step(1.0 / rate);
        s->HoldRoots();
        s->params.sphere_count = 1;
        s->params.sphere[0][2] = float(aim);
        s->params.sphere[0][3] = 0.015f;
        s->params.sphere_step[0].from[0] = s->params.sphere_step[0].to[0] = float(10.0 / rate);
        s->params.sphere_step[0].moves = 1;
        double most[kStrandsPerChunk] = {};
        const int frames = int(0.8 / 10.0 * rate) + 2;
        for (int frame = 0; frame < frames; ++frame) {
          s->params.sphere[0][0] = float(-0.4 + 10.0 * (frame + 1) / rate);
          s->Step(1.0 / rate);
          ASSERT_LT(s->Stretch(), 1e-5);
          for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
            const Point3 rest = {s->roots.position[0][lane], s->roots.position[1][lane], 0.03};
            most[lane] = std::max(most[lane], Norm(s->Tip(lane) - rest));
          }
        }
        int missed = 0;
        for (const double way : most) missed += way < 0.002;
        EXPECT_LE(missed, 5) << "of " << kStrandsPerChunk;
        s->params.sphere_count = 0;
        for (int frame = 0; frame < int(4.0 * rate); ++frame) s->Step(1.0 / rate);
        for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
          EXPECT_LT(std::fabs(s->Tip(lane).x - s->roots.position[0][lane]), 2e-3);
      }
}

}  // namespace
}  // namespace pelt::test
