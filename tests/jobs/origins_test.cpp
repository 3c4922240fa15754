// Characters with origins of their own: nothing changes where they are not used, nothing moves with
// them, and far away fur is as exact as at home.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

#include "bench/accuracy/double3.hpp"
#include "core/groom/groom_file.hpp"
#include "platform_sim/local_store.hpp"
#include "tests/jobs/c_scene.hpp"
#include "tests/jobs/non_finite.hpp"
#include "tests/jobs/pair_scene.hpp"

namespace pelt::testing {
namespace {

using accuracy::Double3, accuracy::Length;

// Noise is sampled where things are in the world, so that elsewhere there is another wind; and where a
// strand hits something, a rounding may decide which way it goes.
Scenario Calm(Scenario scenario) {
  scenario.base.wind.turbulence = 0.0f;
  scenario.base.use_ground = false;
  scenario.spheres.clear();
  return scenario;
}

const SceneOptions kWithOrigins{.origins = true};

// Points of all living strands of a scene, relative to where the scenario is, by layer.
std::vector<std::vector<Double3>> PointsOf(const Scenario& scenario, FurScene& scene) {
  std::vector<std::vector<Double3>> all(scene.shape().layer_count);
  std::vector<StrandCurve> curves(1000);
  for (const LayerDraw& draw : scene.Draws()) {
    const uint32_t count = scene.CopyCurves(draw.layer, curves);
    const Double3 from = {draw.origin[0] - scenario.place[0], draw.origin[1] - scenario.place[1],
                          draw.origin[2] - scenario.place[2]};
    for (uint32_t s = 0; s < count; ++s)
      for (const auto& p : curves[s].point)
        all[draw.layer].push_back(Double3{p[0], p[1], p[2]} + from);
  }
  return all;
}

// Distances between the same points of two scenes.
void AddApart(const std::vector<std::vector<Double3>>& a,
              const std::vector<std::vector<Double3>>& b, std::vector<double>& apart) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t l = 0; l < a.size(); ++l) {
    ASSERT_EQ(a[l].size(), b[l].size()) << "layer " << l;
    for (size_t i = 0; i < a[l].size(); ++i) apart.push_back(Length(a[l][i] - b[l][i]));
  }
}

double Quantile(std::vector<double>& values, double share) {
  EXPECT_GT(values.size(), 1000u);
  const auto at = values.begin() + ptrdiff_t(share * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Of all points of all frames of two scenarios that are the same but for where they are and how that
// is given: what `share` of them are within. (Some strands stand on edges, and fall either way.)
double Apart(Scenario a, Scenario b, uint32_t frames, double share) {
  RunningScenario first(a, {}), second(b, {});
  std::vector<double> apart;
  for (uint32_t f = 0; f < frames; ++f) {
    for (RunningScenario* run : {&first, &second}) RunFrame(*run, f);
    AddApart(PointsOf(a, first.scene()), PointsOf(b, second.scene()), apart);
  }
  return Quantile(apart, share);
}

TEST(Origins, OfZeroAreTheSameBits) {
  for (const bool clips : {false, true}) {
    Scenario scenario = clips ? PairScenario() : EveryOutputScenario();
    const auto expected = RunDigests(scenario, {}, 12);
    ExpectSameFrames(expected, RunDigests(scenario, kWithOrigins, 12), "origins of 0");
  }
}

// The frame's origin and the characters' is the same: there is nothing to convert.
TEST(Origins, ThatAllShareAreTheSameBits) {
  Scenario scenario = Calm(EveryOutputScenario());
  const auto expected = RunDigests(scenario, {}, 8);
  RunningScenario run(scenario, kWithOrigins);
  const double origin[3] = {1.0e6 / 3.0, -17.1, 9.9e6};
  std::copy_n(origin, 3, run.scene().Origin(0));
  for (uint32_t f = 0; f < 8; ++f) {
    FrameInput input = run.Prepare(f, scenario.base.skip, scenario.base.lod);
    std::copy_n(origin, 3, input.origin);
    RunInput(run, input);
    EXPECT_EQ(run.scene().DigestFrame(), expected[f]) << f;
    for (const LayerDraw& draw : run.scene().Draws()) EXPECT_EQ(draw.origin[2], 9.9e6);
  }
}

// Origins that wander about move nothing.
TEST(Origins, ThatMoveAreNotSeen) {
  for (const Solver solver : {Solver::kPbd, Solver::kVerlet, Solver::kModal}) {
    Scenario still = Calm(PairScenario());
    for (LayerParams* layer : LayersOf(still))
      if (solver != Solver::kVerlet || layer->chain == ChainKind::kStrand) layer->solver = solver;
    // As thick as the fur, where hips are: it does not go the origin's way.
    CapsuleCollider bar;
    bar.radius = 0.2f;
    bar.joint = 1;
    still.capsules = {bar};
    // One of the world that holds all, and one that the hips carry.
    still.base.force_count = 2;
    still.base.force[0] = {.half = {4, 4, 4}, .kind = uint32_t(ForceKind::kPull), .strength = 3.0f};
    still.base.force[1] = {.shape = uint32_t(ForceShape::kBox), .strength = 3.0f, .joint = 1};
    Scenario moving = still;
    moving.origins = true;
    EXPECT_LT(Apart(still, moving, 40, 0.99), 1.0e-5) << int(solver);
  }
}

// Of every living strand of a painted layer, by chunk and lane.
std::vector<uint32_t> PaintOf(const FurScene& scene) {
  std::vector<uint32_t> all;
  for (uint32_t c = 0; c < scene.shape().chunk_count; ++c)
    if (const PaintBlock* paint = scene.memory().Of<&Streams::paint>(c))
      for (uint32_t s = 0; s < scene.memory().Of<&Streams::chunk_state>(c)->live_strands; ++s)
        all.push_back(paint->amounts[s]);
  return all;
}

// Of one strand, the channel that differs most.
int PaintApart(uint32_t a, uint32_t b) {
  int most = 0;
  for (uint32_t channel = 0; channel < kPaintChannels; ++channel)
    most = std::max(most, std::abs(int(a >> 8 * channel & 255) - int(b >> 8 * channel & 255)));
  return most;
}

// Brushes are given relative to the frame's origin, and hold the strands that are there.
TEST(Origins, ThatMovePaintTheSameStrands) {
  Scenario still = Calm(LitScenario()), moving = still;
  moving.origins = true;
  RunningScenario first(still, {}), second(moving, {});
  for (uint32_t f = 0; f < 6; ++f)
    for (RunningScenario* run : {&first, &second}) RunFrame(*run, f);
  const std::vector<uint32_t> a = PaintOf(first.scene()), b = PaintOf(second.scene());
  ASSERT_EQ(a.size(), b.size());
  size_t painted = 0, apart = 0;
  for (size_t s = 0; s < a.size(); ++s) {
    painted += a[s] != 0;
    apart += PaintApart(a[s], b[s]) > 6;  // each frame rounds
  }
  EXPECT_GT(painted, a.size() / 8);
  EXPECT_EQ(apart, 0u) << "of " << a.size();
}

// A character of one metre is drawn within a few roundings of one metre, wherever it is.
TEST(Origins, FarAwayIsAsExactAsAtHome) {
  const Scenario home = Calm(PairScenario());
  for (const double far_m : {1.0e3, 1.0e4, 1.0e6}) {
    Scenario away = home;
    away.place = {far_m, 0.3 * far_m, -0.7 * far_m};
    away.origins = true;
    EXPECT_LT(Apart(home, away, 40, 0.99), 1.0e-5) << far_m;
    if (far_m > 1.0e4) continue;
    away.origins = false;
    EXPECT_GT(Apart(home, away, 40, 0.5), far_m * 2.0e-8) << far_m;
  }
}

TEST(Origins, AreRefusedWithTheReason) {
  Scenario scenario = TinyScenario();
  RunningScenario without(scenario, {});
  EXPECT_EQ(without.scene().Origin(0), nullptr);
  FrameInput input = without.Prepare(0, {}, {});
  input.origin[1] = 1.0;
  EXPECT_EQ(BeginError(without.scene(), input),
            "origin: the scene was made without SceneOptions::origins");
  RunningScenario with(scenario, kWithOrigins);
  FurScene& scene = with.scene();
  input = with.Prepare(0, {}, {});
  input.origin[1] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(BeginError(scene, input), "origin: it is not finite, or beyond 1e7 m");
  // A character's own is part of its pose: with one that cannot be used it stays where it was.
  for (uint32_t f = 0; f < 3; ++f) {
    input = with.Prepare(f, {}, {});
    scene.Origin(0)[2] = f == 1 ? std::numeric_limits<double>::infinity() : 0.05;
    RunInput(scene, input);
    ASSERT_EQ(scene.RefusedPoses().size(), f == 1 ? 1u : 0u);
    if (f == 1) {
      EXPECT_EQ(DescribeRefusedPose(scene.RefusedPoses()[0]),
                "pose of character 0: its origin is not finite, or beyond 1e7 m");
    }
    ASSERT_FALSE(scene.Draws().empty());
    for (const LayerDraw& draw : scene.Draws()) EXPECT_EQ(draw.origin[2], 0.05) << f;
  }
}

// A scene at rest whose origins move wakes, is drawn where it was, and goes to sleep again.
TEST(Origins, ARestingSceneSleepsAgain) {
  Scenario scenario = RestingScenario(20);
  RunningScenario run(scenario, kWithOrigins);
  FurScene& scene = run.scene();
  std::vector<std::vector<Double3>> before;
  uint32_t asleep = 0;
  for (uint32_t f = 0; f < 1200; ++f) {
    FrameInput input = run.Prepare(f, scenario.base.skip, scenario.base.lod);
    const float moved = f < 600 ? 0.0f : 0.25f;
    scene.Origin(0)[0] = double(moved);
    scene.Pose(0).root[3] -= moved;
    RunInput(run, input);
    if (f == 599) before = PointsOf(scenario, scene), asleep = CountAsleep(scene);
  }
  EXPECT_GT(asleep, 10u);
  EXPECT_GE(CountAsleep(scene), asleep);
  std::vector<double> apart;
  AddApart(before, PointsOf(scenario, scene), apart);
  EXPECT_LT(Quantile(apart, 0.99), 1e-4);
}

// The pose is given as before, so the character goes along with its origin: its fur is dragged after it.
TEST(Origins, ThatMoveUnderAStillPoseWakeEverybody) {
  Scenario scenario = RestingScenario(20);
  RunningScenario run(scenario, kWithOrigins);
  FurScene& scene = run.scene();
  const auto run_frame = [&](uint32_t f, double at) {
    const FrameInput input = run.Prepare(f, scenario.base.skip, scenario.base.lod);
    scene.Origin(0)[0] = at;
    RunInput(run, input);
  };
  for (uint32_t f = 0; f < 600; ++f) run_frame(f, 0.0);
  EXPECT_GT(CountAsleep(scene), 10u);
  // In the frame after, the skin stands still again.
  for (uint32_t f = 600; f < 602; ++f) {
    run_frame(f, 0.25);
    EXPECT_EQ(CountChunks(scene, kChunkSkin | kChunkSimulate), scene.shape().chunk_count) << f;
  }
}

// Local stores have the parameters of the right character.
TEST(Origins, GiveTheSameBitsInALocalStore) {
  Scenario scenario = PairScenario();
  scenario.origins = true;
  scenario.place = {1.0e4, 2.0, 3.0};
  LocalStoreExecutor local(PlanOptions{}.local_store_data_bytes);
  ExpectSameFrames(RunDigests(scenario, {}, 5), RunDigests(scenario, {}, local, 5), "local");
  EXPECT_TRUE(local.faults().empty());
}

// Jumps of the origin of any size leave everything finite.
TEST(Origins, AnyLeapIsFinite) {
  Scenario scenario = EveryOutputScenario();
  RunningScenario run(scenario, kWithOrigins);
  const double leaps[] = {0.0, 1.0e7, -1.0e7, 1.0e-9, 3.0, 3.0};
  for (uint32_t f = 0; f < 6; ++f) {
    const FrameInput input = run.Prepare(f, scenario.base.skip, scenario.base.lod);
    for (int k = 0; k < 3; ++k) run.scene().Origin(0)[k] = leaps[f];
    RunInput(run, input);
    EXPECT_EQ(FindNonFinite(run.scene()), "") << f;
  }
}

TEST(Origins, ComeInByTheCInterface) {
  PeltSceneOptions options{};
  options.origins = 1;
  const OwnScene own = MakeCScene(&options), own_plain = MakeCScene(nullptr);
  PeltScene *const scene = own.get(), *const plain = own_plain.get();
  const double origin[3] = {5.0e6, 0.25, -3.0};
  EXPECT_STREQ(pelt_set_origin(plain, 0, origin), "the scene was made without origins");
  EXPECT_NE(pelt_set_origin(scene, 1, origin), nullptr);
  EXPECT_NE(pelt_set_origin(scene, 0, nullptr), nullptr);
  EXPECT_NE(pelt_set_origin(nullptr, 0, origin), nullptr);
  EXPECT_EQ(pelt_set_origin(scene, 0, origin), nullptr);
  PeltFrame frame;
  pelt_default_frame(&frame);
  frame.skip &= ~uint32_t(PELT_CULL);
  std::copy_n(origin, 3, frame.origin);
  EXPECT_NE(pelt_begin(plain, &frame), nullptr);
  ASSERT_EQ(pelt_begin(scene, &frame), nullptr);
  ASSERT_EQ(pelt_run(scene, nullptr), nullptr);
  PeltDraw draws[64];
  const uint32_t count = pelt_draws(scene, draws, 64);
  ASSERT_GT(count, 0u);
  for (uint32_t d = 0; d < count; ++d)
    for (int k = 0; k < 3; ++k) EXPECT_EQ(draws[d].origin[k], origin[k]);
}

// Going back in time takes the origins along.
TEST(Origins, AreCopiedWithTheState) {
  Scenario scenario = Calm(PairScenario());
  scenario.origins = true;
  RunningScenario a(scenario, {}), b(scenario, {});
  for (uint32_t f = 0; f < 6; ++f) RunFrame(a, f);
  ASSERT_TRUE(b.scene().CopyStateFrom(a.scene()));
  RunFrame(a, 6), RunFrame(b, 6);
  EXPECT_EQ(a.scene().DigestFrame(), b.scene().DigestFrame());
}

}  // namespace
}  // namespace pelt::testing
