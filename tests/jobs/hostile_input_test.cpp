// Input at the limits of what the frame's door lets through, drawn at random: for all of it, every
// value that a frame computes is finite, and a scene that is put back in order has its fur near its
// skin again.
#include <gtest/gtest.h>

#include <cmath>

#include "core/random.hpp"
#include "tests/jobs/non_finite.hpp"
#include "tests/jobs/pair_scene.hpp"

namespace pelt::testing {
namespace {

constexpr float kLargest = 1e6f;

// One of the limits, nothing, next to nothing, something small, or anything between.
float Extreme(Random& random, float largest = kLargest) {
  const float sign = random.Below(2) ? 1.0f : -1.0f;
  switch (random.Below(6)) {
    case 0:
      return sign * largest;
    case 1:
      return sign * 0.0f;
    case 2:
      return sign * 1e-40f;  // denormal
    case 3:
      return sign * float(random.Uniform(0.0, 1.0));
    case 4:
      return sign * 1e-20f;
    default:
      return sign * float(random.Uniform(0.0, 1.0)) * largest;
  }
}

template <class T>
void FillExtreme(Random& random, T& rows, uint32_t one_in) {
  auto* value = reinterpret_cast<float*>(&rows);
  for (size_t i = 0; i < sizeof rows / sizeof(float); ++i)
    if (random.Below(one_in) == 0) value[i] = Extreme(random);
}

void SpoilPose(Random& random, PoseBlock& pose) {
  // Mostly a few values, sometimes all.
  const uint32_t one_in = 1u << random.Below(10);
  switch (random.Below(6)) {
    case 0:
      return FillExtreme(random, pose.root, 1 + random.Below(4));
    case 1:
      return FillExtreme(random, pose.translation_key, one_in);
    case 2:
      return FillExtreme(random, pose.rotation_key, one_in);
    case 3:
      return FillExtreme(random, pose.scale_key, one_in);
    case 4:
      return FillExtreme(random, pose.rotation_weight, one_in);
    default:
      pose.teleported = random.Below(2);
  }
}

void SpoilInput(Random& random, FrameInput& in) {
  const double lengths[] = {1e-6, 1e-5, 1e-3, 1.0 / 60.0, 0.3, 1.0};
  in.dt_s = lengths[random.Below(6)];
  if (random.Below(2)) in.time_s = random.Below(2) ? 1e9 : random.Uniform(0.0, 1e9);
  if (random.Below(2)) FillExtreme(random, in.gravity, 2);
  if (random.Below(2)) {
    FillExtreme(random, in.wind.velocity, 2);
    in.wind.turbulence = Extreme(random);
    in.wind.gust_strength = Extreme(random);
    in.wind.gust_period_s = random.Below(2) ? 1e-3f : 1e6f;
    in.wind.turbulence_scale_m = random.Below(2) ? 1e-3f : 1e6f;
    in.wind.kind = random.Below(kWindKinds);
  }
  if (random.Below(2)) {
    in.force_count = kForceVolumesPerScene;
    for (ForceVolume& force : in.force) {
      FillExtreme(random, force.centre, 2);
      for (float& half : force.half) half = random.Below(2) ? 1e-3f : 1e6f;
      force.shape = random.Below(kForceShapes), force.kind = random.Below(kForceKinds);
      force.strength = Extreme(random);
      force.hardness = random.Below(2) ? 1.0f : 0.0f;
      if (random.Below(2)) force.joint = 0;
    }
  }
  if (random.Below(2)) {
    in.sphere_count = kSpheresPerScene;
    FillExtreme(random, in.sphere, 2);
    for (auto& sphere : in.sphere) sphere[3] = std::abs(sphere[3]);
    in.capsule_count = kCapsulesPerScene;
    for (CapsuleCollider& capsule : in.capsule) {
      FillExtreme(random, capsule.from, 1);
      FillExtreme(random, capsule.to, 1);
      FillExtreme(random, capsule.radius, 1);
      capsule.radius = std::abs(capsule.radius);
      if (random.Below(2)) capsule.joint = 0;
    }
  }
  if (random.Below(2)) {
    in.lighting.light_count = kLightsPerScene;
    for (SphereLight& light : in.lighting.light) {
      FillExtreme(random, light.position, 1);
      FillExtreme(random, light.rgb, 1);
      light.radius = std::abs(Extreme(random));
      light.range = random.Below(2) ? std::abs(Extreme(random)) : 0.0f;
    }
    in.lighting.sample_count = kIrradianceSamplesPerScene;
    for (IrradianceSample& sample : in.lighting.sample) {
      FillExtreme(random, sample.position, 1);
      FillExtreme(random, sample.sky, 1);
      FillExtreme(random, sample.ground, 1);
      sample.falloff = random.Below(2) ? 1e-3f : 1e6f;
    }
  }
  if (random.Below(2)) {
    in.brush_count = kBrushesPerScene;
    for (PaintBrush& brush : in.brush) {
      FillExtreme(random, brush.centre, 1);
      brush.radius = std::abs(Extreme(random));
      brush.hardness = random.Below(2) ? 1.0f : 0.0f;
      brush.channel = uint32_t(random.Below(kPaintChannels));
      brush.amount = random.Below(2) ? 1.0f : -1.0f;
    }
  }
  if (random.Below(3) == 0) {
    in.use_ground = true;
    in.ground[3] = Extreme(random);
  }
  if (random.Below(4) == 0)
    for (float& c : in.camera.eye) c = Extreme(random);
  in.skip.lod = random.Below(2) != 0;
}

void RunHostileCourse(uint64_t seed, std::optional<Solver> solver) {
  Scenario scenario = PairScenario();
  if (solver)
    for (LayerParams* layer : LayersOf(scenario))
      if (layer->solver != Solver::kVerlet || *solver != Solver::kModal)
        if (layer->chain == ChainKind::kStrand || *solver != Solver::kVerlet)
          layer->solver = *solver;
  RunningScenario running(scenario, OptionsFor(BestIsa()));
  FurScene& scene = running.scene();
  Random random(seed);
  for (uint32_t f = 0; f < 16; ++f) {
    FrameInput input = scenario.PrepareFrame(f, scene);
    SpoilInput(random, input);
    for (uint32_t c = 0; c < 2; ++c)
      if (random.Below(2)) SpoilPose(random, scene.Pose(c));
    SCOPED_TRACE(::testing::Message() << "seed " << seed << ", frame " << f);
    RunInput(scene, input);
    ASSERT_EQ(FindNonFinite(scene), "");
  }
  for (uint32_t f = 0; f < 60; ++f) RunFrame(running, f);
  SCOPED_TRACE(seed);
  ExpectPointsNear(scene);
}

TEST(HostileInput, NothingMakesTheStateNonFinite) {
  for (uint64_t seed = 0; seed < 12; ++seed) RunHostileCourse(seed, std::nullopt);
}
TEST(HostileInput, NothingMakesModalNonFinite) {
  for (uint64_t seed = 100; seed < 108; ++seed) RunHostileCourse(seed, Solver::kModal);
}
TEST(HostileInput, NothingMakesPbdNonFinite) {
  for (uint64_t seed = 200; seed < 204; ++seed) RunHostileCourse(seed, Solver::kPbd);
}

}  // namespace
}  // namespace pelt::testing
