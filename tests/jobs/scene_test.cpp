// FurScene: memory as measured, bad input refused without a trace.
#include "jobs/scene.hpp"

#include <gtest/gtest.h>

#include <cstring>

#include "core/error.hpp"
#include "tests/jobs/non_finite.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

// ---- Memory -------------------------------------------------------------------------------------

std::string CreateError(const SceneMemory& memory) {
  return FurScene::Create(TinyScenario().ActorGrooms(), {}, memory).error();
}

TEST(FurSceneMemory, TakesExactlyWhatWasMeasured) {
  const Scenario scenario = TinyScenario();
  const SceneLayout layout = MeasureScene(scenario.ActorGrooms(), {}).OrThrow();
  uint64_t sum = 0;
  for (const MemoryRange& range : layout.ranges) {
    EXPECT_FALSE(range.name.empty());
    EXPECT_EQ(range.bytes % kBlockAlignment, 0u) << range.name;
    sum += range.bytes;
  }
  EXPECT_EQ(sum, layout.total_bytes);
  EXPECT_EQ(layout.strand_count, scenario.StrandCount());

  // Canaries on both sides of the block survive frames.
  SceneBlock block(layout.total_bytes + 2 * kBlockAlignment);
  std::memset(block.bytes().data(), 0x5a, block.bytes().size());
  const auto made = FurScene::Create(scenario.ActorGrooms(), {},
                                     {block.bytes().subspan(kBlockAlignment, layout.total_bytes)})
                        .OrThrow();
  FurScene& scene = *made;
  Scenario course = TinyScenario();
  for (uint32_t f = 0; f < 3; ++f) RunInput(scene, course.PrepareFrame(f, scene));
  for (uint32_t i = 0; i < kBlockAlignment; ++i) {
    ASSERT_EQ(block.bytes()[i], std::byte(0x5a));
    ASSERT_EQ(block.bytes()[block.bytes().size() - 1 - i], std::byte(0x5a));
  }
}

TEST(FurSceneMemory, RefusesTooLittleAndUnalignedMemory) {
  const SceneLayout layout = MeasureScene(TinyScenario().ActorGrooms(), {}).OrThrow();
  SceneBlock block(layout.total_bytes + kBlockAlignment);
  const std::string little = CreateError({block.bytes().first(layout.total_bytes - 1)});
  EXPECT_EQ(little, "the scene needs " + std::to_string(layout.total_bytes) +
                        " bytes and was given " + std::to_string(layout.total_bytes - 1));
  const std::string unaligned = CreateError({block.bytes().subspan(16)});
  EXPECT_NE(unaligned.find("aligned to 128 bytes"), std::string::npos) << unaligned;
}

// What an engine's allocator is asked, and what it gives.
struct Allocator {
  std::optional<SceneBlock> block;
  uint32_t calls = 0;
  uint64_t bytes = 0;
  static std::byte* Give(uint64_t bytes, void* user) {
    auto& self = *static_cast<Allocator*>(user);
    ++self.calls;
    self.bytes = bytes;
    return self.block.emplace(bytes).bytes().data();
  }
};

TEST(FurSceneMemory, IsAskedForOnceAndExactly) {
  const Scenario scenario = TinyScenario();
  Allocator allocator;
  const auto scene = FurScene::Create(scenario.ActorGrooms(), {},
                                      {.allocate = &Allocator::Give, .user = &allocator})
                         .OrThrow();
  EXPECT_EQ(allocator.calls, 1u);
  EXPECT_EQ(allocator.bytes, scene->layout().total_bytes);
  EXPECT_EQ(scene->memory().streams[0].base, allocator.block->bytes().data());
  const std::string refused =
      CreateError({.allocate = [](uint64_t, void*) -> std::byte* { return nullptr; }});
  EXPECT_NE(refused.find("gave none"), std::string::npos) << refused;
}

TEST(FurSceneMemory, NeedsAGroom) {
  EXPECT_THROW(MeasureScene({}, {}).OrThrow(), Error);
  const std::vector<const Groom*> none(1, nullptr);
  EXPECT_THROW(MeasureScene(none, {}).OrThrow(), Error);
}

// ---- Bad input ----------------------------------------------------------------------------------

struct BadInput {
  const char* says;
  std::function<void(FrameInput&)> spoil;
};

const std::vector<BadInput> kBadInputs = {
    {"dt_s is 1e-38", [](FrameInput& in) { in.dt_s = 1e-38; }},
    {"dt_s is 5e-324", [](FrameInput& in) { in.dt_s = 5e-324; }},
    {"neither 0 nor in [1e-06, 1] s", [](FrameInput& in) { in.dt_s = 9e-7; }},
    {"dt_s", [](FrameInput& in) { in.dt_s = -0.01; }},
    {"dt_s", [](FrameInput& in) { in.dt_s = double(kNaN); }},
    {"dt_s", [](FrameInput& in) { in.dt_s = double(kInf); }},
    {"dt_s", [](FrameInput& in) { in.dt_s = 1.5; }},
    {"time_s", [](FrameInput& in) { in.time_s = double(kNaN); }},
    {"time_s", [](FrameInput& in) { in.time_s = -1.0; }},
    {"time_s", [](FrameInput& in) { in.time_s = 1e300; }},
    {"camera", [](FrameInput& in) { in.camera.eye[1] = kNaN; }},
    {"camera's eye is beyond", [](FrameInput& in) { in.camera.eye[1] = 3e38f; }},
    {"camera's target is beyond", [](FrameInput& in) { in.camera.target[1] = -3e38f; }},
    {"camera's up vector is beyond", [](FrameInput& in) { in.camera.up[1] = 3e38f; }},
    {"camera", [](FrameInput& in) { in.camera.vertical_fov_rad = 0.0f; }},
    {"camera",
     [](FrameInput& in) { std::memcpy(in.camera.target, in.camera.eye, sizeof in.camera.target); }},
    {"gravity", [](FrameInput& in) { in.gravity[2] = kInf; }},
    {"gravity", [](FrameInput& in) { in.gravity[0] = 1e30f; }},
    {"wind", [](FrameInput& in) { in.wind.velocity[0] = kNaN; }},
    {"wind", [](FrameInput& in) { in.wind.gust_strength = kInf; }},
    {"wind", [](FrameInput& in) { in.wind.gust_period_s = 0.0f; }},
    {"wind", [](FrameInput& in) { in.wind.turbulence_scale_m = -1.0f; }},
    {"wind", [](FrameInput& in) { in.wind.turbulence_scale_m = kNaN; }},
    {"ground", [](FrameInput& in) { in.use_ground = true, in.ground[3] = kNaN; }},
    {"normal is not unit", [](FrameInput& in) { in.use_ground = true, in.ground[1] = 2.0f; }},
    {"a sphere's velocity",
     [](FrameInput& in) { in.sphere_count = 1, in.sphere_velocity[0][2] = kInf; }},
    {"the ground's velocity",
     [](FrameInput& in) { in.use_ground = true, in.ground_velocity[0] = 2e6f; }},
    {"more spheres", [](FrameInput& in) { in.sphere_count = kSpheresPerScene + 1; }},
    {"sphere", [](FrameInput& in) { in.sphere_count = 1, in.sphere[0][0] = kNaN; }},
    {"sphere", [](FrameInput& in) { in.sphere_count = 1, in.sphere[0][3] = -0.1f; }},
    {"9 capsules, a scene holds 8",
     [](FrameInput& in) { in.capsule_count = kCapsulesPerScene + 1; }},
    {"capsule 1: an end is not finite, or beyond 1e6",
     [](FrameInput& in) { in.capsule_count = 2, in.capsule[1].to[2] = kNaN; }},
    {"capsule 0: its radius is -0.1, not in [0, 1e6] m",
     [](FrameInput& in) { in.capsule_count = 1, in.capsule[0].radius = -0.1f; }},
    {"capsule 0: its radius is inf",
     [](FrameInput& in) { in.capsule_count = 1, in.capsule[0].radius = kInf; }},
    {"capsule 0: bound to character 1, the scene has 1",
     [](FrameInput& in) {
       in.capsule_count = 1, in.capsule[0].joint = 0, in.capsule[0].character = 1;
     }},
    {"capsule 0: bound to joint 99 of character 0, which has ",
     [](FrameInput& in) { in.capsule_count = 1, in.capsule[0].joint = 99; }},
    {"9 lights, a scene holds 8",
     [](FrameInput& in) { in.lighting.light_count = kLightsPerScene + 1; }},
    {"light 1: its position is not finite, or beyond 1e6",
     [](FrameInput& in) { in.lighting.light_count = 2, in.lighting.light[1].position[2] = kNaN; }},
    {"light 0: its colour",
     [](FrameInput& in) { in.lighting.light_count = 1, in.lighting.light[0].rgb[0] = kInf; }},
    {"light 0: its radius is not in [0, 1e6] m",
     [](FrameInput& in) { in.lighting.light_count = 1, in.lighting.light[0].radius = -1.0f; }},
    {"light 0: its range is not in [0, 1e6] m",
     [](FrameInput& in) { in.lighting.light_count = 1, in.lighting.light[0].range = kNaN; }},
    {"13 irradiance samples, a scene holds 12",
     [](FrameInput& in) { in.lighting.sample_count = kIrradianceSamplesPerScene + 1; }},
    {"irradiance sample 0: its falloff is not in [1e-3, 1e6] m",
     [](FrameInput& in) { in.lighting.sample_count = 1, in.lighting.sample[0].falloff = 0.0f; }},
    {"irradiance sample 0: its up is not unit",
     [](FrameInput& in) { in.lighting.sample_count = 1, in.lighting.sample[0].up[1] = 0.9f; }},
    {"irradiance sample 0: a colour is not finite",
     [](FrameInput& in) { in.lighting.sample_count = 1, in.lighting.sample[0].ground[1] = kNaN; }},
    {"the sun's direction is not unit",
     [](FrameInput& in) { in.lighting.sun_direction[0] = kNaN; }},
    {"the sun's colour", [](FrameInput& in) { in.lighting.sun_rgb[0] = kInf; }},
    {"the rim light's direction is not unit",
     [](FrameInput& in) { in.lighting.rim_direction[1] = 0.0f; }},
    {"the rim light's colour", [](FrameInput& in) { in.lighting.rim_rgb[2] = kNaN; }},
    {"the rim light's exponent is -1, not in [0, 1000]",
     [](FrameInput& in) { in.lighting.rim_exponent = -1.0f; }},
    {"17 brushes, a scene holds 16", [](FrameInput& in) { in.brush_count = kBrushesPerScene + 1; }},
    {"brush 1: its centre is not finite, or beyond 1e6",
     [](FrameInput& in) { in.brush_count = 2, in.brush[1].centre[2] = kInf; }},
    {"brush 0: its radius is -1, not in [0, 1e6] m",
     [](FrameInput& in) { in.brush_count = 1, in.brush[0].radius = -1.0f; }},
    {"brush 0: its hardness is 1.5, not in [0, 1]",
     [](FrameInput& in) { in.brush_count = 1, in.brush[0].hardness = 1.5f; }},
    {"brush 0: its amount is nan, not in [-1, 1]",
     [](FrameInput& in) { in.brush_count = 1, in.brush[0].amount = kNaN; }},
    {"brush 0: its channel is 4, there are 4",
     [](FrameInput& in) { in.brush_count = 1, in.brush[0].channel = kPaintChannels; }},
    {"wind: its kind is 2, there are 2", [](FrameInput& in) { in.wind.kind = kWindKinds; }},
    {"9 force volumes, a scene holds 8",
     [](FrameInput& in) { in.force_count = kForceVolumesPerScene + 1; }},
    {"force volume 1: its centre is not finite, or beyond 1e6",
     [](FrameInput& in) { in.force_count = 2, in.force[1].centre[2] = kInf; }},
    {"force volume 0: half of a side is 0, not in [1e-3, 1e6] m",
     [](FrameInput& in) { in.force_count = 1, in.force[0].half[1] = 0.0f; }},
    {"its shape is 2, there are 2",
     [](FrameInput& in) { in.force_count = 1, in.force[0].shape = 2; }},
    {"its kind is 7, there are 2",
     [](FrameInput& in) { in.force_count = 1, in.force[0].kind = 7; }},
    {"force volume 0: its direction is not unit",
     [](FrameInput& in) { in.force_count = 1, in.force[0].direction[1] = 0.5f; }},
    {"force volume 0: its strength is inf, beyond 1e6 m/s^2",
     [](FrameInput& in) { in.force_count = 1, in.force[0].strength = kInf; }},
    {"force volume 0: its hardness is nan, not in [0, 1]",
     [](FrameInput& in) { in.force_count = 1, in.force[0].hardness = kNaN; }},
    {"force volume 0: bound to joint 99 of character 0, which has ",
     [](FrameInput& in) { in.force_count = 1, in.force[0].joint = 99; }},
    {"weather for 2 characters, the scene has 1",
     [](FrameInput& in) {
       static const Weather kTwo[2];
       in.weather = kTwo;
     }},
    {"weather of character 0",
     [](FrameInput& in) {
       static const Weather kBad[1] = {{kNaN, 0.0f}};
       in.weather = kBad;
     }},
    {"lod", [](FrameInput& in) { in.lod.full_detail_px = kNaN; }},
    {"lod", [](FrameInput& in) { in.lod.min_fraction = kNaN; }},
    {"lod", [](FrameInput& in) { in.lod.hysteresis = -1.0f; }},
    {"lod", [](FrameInput& in) { in.lod.fade_share = 2.0f; }},
    {"lod: worst_px", [](FrameInput& in) { in.lod.worst_px = kNaN; }},
    {"lod: budget_us is given without costs", [](FrameInput& in) { in.lod.budget_us = 1; }},
    {"lod: a cost", [](FrameInput& in) { in.lod.costs.node_ns[4] = -1.0f; }},
};

TEST(FurSceneInput, BadInputIsRefusedAndLeavesNoTrace) {
  Scenario scenario = TinyScenario();
  RunningScenario clean(scenario, {}), tried(scenario, {});
  uint32_t frame = 0;
  const auto run_both = [&] {
    RunFrame(clean, frame);
    RunFrame(tried, frame++);
    return clean.scene().DigestFrame() == tried.scene().DigestFrame();
  };
  ASSERT_TRUE(run_both());
  for (const BadInput& bad : kBadInputs) {
    FrameInput input = scenario.PrepareFrame(frame, tried.scene());
    bad.spoil(input);
    const std::string error = BeginError(tried.scene(), input);
    EXPECT_NE(error.find(bad.says), std::string::npos)
        << "wanted '" << bad.says << "', got '" << error << "'";
    ASSERT_TRUE(run_both()) << bad.says;
  }
}

// Finite, and as absurd as the door lets through: what comes out stays finite, and a scene that is
// put back in order recovers.
TEST(FurSceneInput, AbsurdButFiniteInputDoesNoLastingHarm) {
  Scenario scenario = TinyScenario();
  RunningScenario running(scenario, {});
  FurScene& scene = running.scene();
  for (uint32_t f = 0; f < 3; ++f) RunFrame(running, f);
  FrameInput input = scenario.PrepareFrame(3, scene);
  for (int i : {3, 7, 11}) scene.Pose(0).root[i] = 9e5f;
  input.gravity[1] = -9e5f;
  input.wind.velocity[0] = 9e5f;
  input.dt_s = 1.0;
  RunInput(scene, input);
  for (uint32_t f = 4; f < 30; ++f) RunFrame(running, f);
  ExpectPointsNear(scene);
}

}  // namespace
}  // namespace pelt::testing
