// What a modal chain touches: the surface, soft ones too, colliders, the ball about its groom.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/groom/layer_params.hpp"
#include "core/layer_block.hpp"
#include "tests/kernels/modal_scene.hpp"

namespace pelt::test {
namespace {

TEST(SimulateModalContact, KeepsOutOfSurfaceSphereAndGround) {
  auto s = std::make_unique<ModalScene<5>>(StrandMaterial(5, 0.5, 0.1, 6.0));
  std::mt19937 random(3);
  s->SetRest(0.01, {0.8, 0.36, 0.48});
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
    s->MoveRoot(lane, {Uniform(random, -0.02f, 0.02f), 0.02, Uniform(random, 0.021f, 0.03f)});
  s->layer.surface_hardness = 1.0f;
  s->AddGround();
  s->AddSphere(0.02f);
  double worst = 0.0;
  for (int frame = 0; frame < 240; ++frame) {
    s->Step(kDt);
    s->HoldRoots();
    s->ForEachPoint([&](uint32_t lane, Double3 at) {
      worst = std::max({worst, -at.y, 0.02 - Length(at), s->roots.position[2][lane] - at.z});
    });
    ASSERT_LT(s->Stretch(), 1e-5);
  }
  RecordProperty("worst_penetration_um", int(worst * 1e6));
  EXPECT_LT(worst, 0.01 * 0.04);
}

void ExpectSameMirrored(const ModalScene<4>& forth, const ModalScene<4>& back) {
  constexpr uint32_t kLast = kStrandsPerChunk - 1;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
    for (uint32_t i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k) {
        EXPECT_EQ(forth.chain.direction[i][k][lane], back.chain.direction[i][k][kLast - lane]);
        EXPECT_EQ(forth.chain.velocity[i][k][lane], back.chain.velocity[i][k][kLast - lane]);
        EXPECT_EQ(forth.position.position[i][k][lane], back.position.position[i][k][kLast - lane]);
      }
}

// Who touches something is picked from the chunk and stepped beside others than it stands beside.
TEST(SimulateModalContact, ALaneDoesNotDependOnItsNeighbours) {
  const auto run = [](bool turned_round) {
    auto s = std::make_unique<ModalScene<4>>(StrandMaterial(4, 1.0, 0.05, 4.0));
    for (uint32_t i = 0; i < kStrandsPerChunk; ++i) {
      std::mt19937 random(i);
      const uint32_t lane = turned_round ? kStrandsPerChunk - 1 - i : i;
      s->SetRest(lane, 0.01, RandomUnit(random));
      s->MoveRoot(lane, {Uniform(random, -0.1f, 0.1f), Uniform(random, 0.0f, 0.1f), 0.0});
    }
    s->layer.surface_hardness = 0.5f;
    s->AddGround();
    s->AddSphere(0.02f);
    s->params.capsule_count = 1;
    s->params.capsule[0] = {{0.03f, 0.0f, 0.05f}, 0.01f, {1.0f, 0.0f, 0.0f}, 0.05f};
    for (ColliderStep* step : {&s->params.sphere_step[0], &s->params.capsule_step[0]})
      *step = {{0.03f, 0.0f, 0.0f}, {0.01f, 0.02f, 0.0f}, 1, 0};
    for (int frame = 0; frame < 20; ++frame) {
      s->params.sphere[0][0] = 0.03f * float(frame) - 0.3f;
      s->Step(kDt);
      s->HoldRoots();
    }
    return s;
  };
  ExpectSameMirrored(*run(false), *run(true));
}

// Strands too short for their weight take no substep (FollowsWeight), and stand between others that do, all of them
// in the way of a sphere from the frame on in which it appears.
TEST(SimulateModalContact, WhoTakesNoStepDoesNotDependOnItsNeighbours) {
  constexpr float kShort_m = 0.0006f, kLong_m = 0.01f, kGravity = 160.0f;
  const auto run = [&](bool turned_round) {
    auto s = std::make_unique<ModalScene<4>>(StrandMaterial(4, 1.0, 0.1, 6.0));
    for (uint32_t i = 0; i < kStrandsPerChunk; ++i) {
      std::mt19937 random(i);
      const uint32_t lane = turned_round ? kStrandsPerChunk - 1 - i : i;
      s->SetRest(lane, i % 3 == 0 ? kShort_m : kLong_m, RandomUnit(random));
      s->MoveRoot(lane, {Uniform(random, -0.002f, 0.002f), Uniform(random, -0.002f, 0.002f), 0.0});
    }
    s->layer.gravity[1] = -kGravity;
    s->layer.surface_hardness = 1.0f;
    s->params.sphere[0][3] = 0.001f;
    for (int frame = 0; frame < 20; ++frame) {
      s->params.sphere_count = frame > 0 ? 1 : 0;
      s->Step(kDt);
      s->HoldRoots();
    }
    return s;
  };
  const auto forth = run(false);
  using V = ArrayVec<4>;
  const auto follows = [&](float link_m) {
    return AllSet(
        modal::FollowsWeight<V, 3>(forth->table, forth->layer.gravity, V(1.0f / (3.0f * link_m))));
  };
  EXPECT_FALSE(follows(kShort_m));
  EXPECT_TRUE(follows(kLong_m));
  ExpectSameMirrored(*forth, *run(true));
}

// Only the substeps meet a soft surface: nothing is pushed out of it at the frame's end.
TEST(SimulateModalContact, ASoftSurfaceHoldsPartOfTheWeight) {
  const auto depth_at = [](float hardness) {
    auto s = std::make_unique<ModalScene<4>>(StrandMaterial(4, 0.5, 0.1, 6.0));
    s->PullDown();
    s->layer.surface_hardness = hardness;
    for (int frame = 0; frame < 240; ++frame) s->Step(kDt);
    return -s->Tip(0).z;
  };
  const double none = depth_at(0.0f), soft = depth_at(0.25f), hard = depth_at(1.0f);
  EXPECT_GT(none, 0.01);
  EXPECT_LT(soft, 0.5 * none);
  EXPECT_GT(soft, 0.0);
  EXPECT_LT(hard, 1e-5);
}

// What a layer's soft surface is in a frame of dt seconds.
float HardnessIn(const ModalLayer& layer, double dt, float hardness, ModalQuality quality) {
  LayerParams params;
  params.surface_hardness = hardness;
  const float none[3] = {};
  return FillLayerBlock(params, {}, float(dt), none, Air::kLeftOut, 1, 1.0f, true, nullptr, 1.0f,
                        PushRatio(layer, quality, {{dt, dt, dt}}))
      .surface_hardness;
}

// Strands that lean on a soft surface, their weight pressing them into it.
std::unique_ptr<ModalScene<4>> OnSoftSurface() {
  auto s = std::make_unique<ModalScene<4>>(StrandMaterial(4, 3.0, 0.1, 6.0));
  std::mt19937 random(9);
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
    Double3 d = RandomUnit(random);
    d.z = 0.2 + 0.3 * std::fabs(d.z);
    s->SetRest(lane, 0.01, Unit(d));
  }
  s->PullDown();
  return s;
}

void StepSoft(ModalScene<4>& s, double dt, float hardness) {
  s.layer.surface_hardness = HardnessIn(s.material, dt, hardness, s.quality);
  s.Step(dt);
}

double FarthestTips(const ModalScene<4>& a, const ModalScene<4>& b) {
  double worst = 0.0;
  for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
    worst = std::max(worst, Length(a.Tip(lane) - b.Tip(lane)));
  return worst;
}

TEST(SimulateModalContact, ASoftSurfaceIsAsDeepAtEveryFrameRate) {
  const ModalLayer layer = MakeModalLayer(StrandMaterial(4, 1.0, 0.1, 3.0));
  EXPECT_EQ(HardnessIn(layer, kDt / 2, 0.7f, ModalQuality::kFast), 0.7f);  // a substep of 1/120 s
  EXPECT_EQ(HardnessIn(layer, kDt / 4, 1.0f, ModalQuality::kFine), 1.0f);
  EXPECT_EQ(HardnessIn(layer, kDt / 4, 0.0f, ModalQuality::kFine), 0.0f);
  for (const float hardness : {0.4f, 0.7f, 0.95f}) {
    const auto at_rest = [&](double dt) {
      auto s = OnSoftSurface();
      for (int frame = 0; frame < int(8.0 / dt); ++frame) StepSoft(*s, dt, hardness);
      return s;
    };
    const auto at60 = at_rest(kDt);
    double deepest = 0.0;
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
      deepest = std::max(deepest, -at60->Tip(lane).z);
    for (const double rate : {30.0, 120.0, 240.0}) {
      const double apart = FarthestTips(*at60, *at_rest(1.0 / rate));
      std::printf("hardness %.1f: %.3f mm deep, at %g Hz %.4f mm elsewhere\n", hardness,
                  1e3 * deepest, rate, 1e3 * apart);
      EXPECT_LT(apart, 1e-4) << hardness << " at " << rate;
    }
  }
}

TEST(SimulateModalContact, ALongFrameLeavesStrandsOnASoftSurfaceWhereTheyWere) {
  for (const float hardness : {0.4f, 0.7f, 0.95f}) {
    auto s = OnSoftSurface();
    for (int frame = 0; frame < 480; ++frame) StepSoft(*s, kDt, hardness);
    const ModalScene<4> before = *s;
    StepSoft(*s, 0.07, hardness);
    const double moved = FarthestTips(before, *s);
    for (int frame = 0; frame < 240; ++frame) StepSoft(*s, kDt, hardness);
    std::printf("hardness %.1f: %.4f mm in the long frame, %.4f mm for good\n", hardness,
                1e3 * moved, 1e3 * FarthestTips(before, *s));
    EXPECT_LT(moved, 2.5e-4);
    EXPECT_LT(FarthestTips(before, *s), 1e-4);
  }
}

// Strands droop onto it from above: along it, across it, and a short one, beyond its caps too.
TEST(SimulateModalContact, KeepsOutOfACapsule) {
  for (const Double3 half :
       {Double3{0.03, 0.0, 0.0}, Double3{0.0, 0.02, 0.0}, Double3{0.004, -0.004, 0.0}}) {
    auto s = std::make_unique<ModalScene<5>>(StrandMaterial(5, 0.5, 0.1, 6.0));
    std::mt19937 random(5);
    s->SetRest(0.01, {0.8, 0.36, 0.48});
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
      s->MoveRoot(lane, {Uniform(random, -0.02f, 0.02f), Uniform(random, -0.02f, 0.02f),
                         Uniform(random, 0.021f, 0.03f)});
    s->PullDown();
    const double length = Length(half);
    s->params.capsule_count = 1;
    CapsuleParams& capsule = s->params.capsule[0];
    const double ends[3] = {half.x, half.y, half.z};
    for (int k = 0; k < 3; ++k) {
      capsule.from[k] = float(-ends[k]);
      capsule.axis[k] = float(ends[k] / length);
    }
    capsule.length = float(2.0 * length);
    capsule.radius = 0.02f;
    double worst = 0.0, nearest = 1.0;
    for (int frame = 0; frame < 240; ++frame) {
      s->Step(kDt);
      s->HoldRoots();
      s->ForEachPoint([&](uint32_t, Double3 at) {
        const double along = Dot(at, half) / (length * length);
        const double distance = Length(at - half * std::clamp(along, -1.0, 1.0)) - 0.02;
        worst = std::max(worst, -distance);
        if (frame == 239) nearest = std::min(nearest, std::abs(distance));
      });
      ASSERT_LT(s->Stretch(), 1e-5);
    }
    RecordProperty("worst_penetration_um", int(worst * 1e6));
    EXPECT_LT(worst, 0.01 * 0.04) << half.x << " " << half.y;
    EXPECT_LT(nearest, 1e-4) << "nothing lies on it";  // links do, their ends hardly above
  }
}

// Largest distance of a point from the groom over its distance along the strand.
template <uint32_t kPoints>
double FarthestFromGroom(const ModalScene<kPoints>& s) {
  double worst = 0.0;
  for (uint32_t lane = 0; lane < s.state.live_strands; ++lane)
    for (uint32_t i = 0; i + 1 < kPoints; ++i) {
      const Double3 off = At(s.position.position[i], lane) - At(s.roots.position, lane) -
                          At(s.rest.offset[i], lane);
      worst = std::max(worst, Length(off) / (double(s.rest.segment_length[lane]) * (i + 1)));
    }
  return worst;
}

// Strands so soft that they lie on their limits, shaken and then left alone.
TEST(SimulateModalContact, KeepsWithinMaxDistanceAndComesToRestThere) {
  for (const ModalQuality quality : kQualities)
    for (const float limit : {kLeastMaxDistance, 0.3f, 1.0f}) {
      SCOPED_TRACE(testing::Message() << "limit " << limit << ", quality " << int(quality));
      auto s = std::make_unique<ModalScene<5>>(StrandMaterial(5, 0.5, 0.2, 6.0));
      s->quality = quality;
      s->layer.max_distance = limit;
      s->params.rest_threshold = kRestThreshold;
      std::mt19937 random(5);
      for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane) {
        // Upright ones would slide round a limit that is nearly level for minutes.
        Double3 d = RandomUnit(random);
        while (std::fabs(d.y) > 0.9) d = RandomUnit(random);
        s->SetRest(lane, 0.01, d);
      }
      double worst = 0.0;
      for (int frame = 0; frame < 120; ++frame) {
        for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane)
          s->MoveRoot(lane, {0.02 * std::sin(0.7 * frame), 0.0, 0.03 * std::cos(0.3 * frame)});
        s->Step(kDt);
        worst = std::max(worst, FarthestFromGroom(*s));
        ASSERT_LT(s->Stretch(), 1e-5);
      }
      EXPECT_LT(worst, limit + 1e-3f);
      s->HoldRoots();
      int frames = 0;
      do {
        s->Step(kDt);
      } while (s->state.state_changed && ++frames < 1800);
      EXPECT_LT(frames, 1800);
      EXPECT_LT(FarthestFromGroom(*s), limit + 1e-3f);
      // Strands that point sideways hang at the limit.
      EXPECT_GT(FarthestFromGroom(*s), std::min(limit, 0.9f) - 0.01f);
    }
}

}  // namespace
}  // namespace pelt::test
