// A fault that hides a change of the input from what sleeps is found, for any input.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "core/kernels/activate.hpp"
#include "core/kernels/collect_changes.hpp"
#include "tests/jobs/tiny_scene.hpp"
#include "tests/verify/planting.hpp"

namespace pelt::testing {
namespace {

VerifyReport RunWaking(Tamper tamper) { return RunSection("waking", 12, std::move(tamper)); }

::testing::AssertionResult FindsWaking(const char* stage, Planted planted, const char* name) {
  return Finds("waking", 12, FindingKind::kSleep, name, stage, planted);
}

// The plan's `activate` with one of its parameters switched off.
uint32_t ActivateParams::*hidden_param;
void ActivateWithout(const void* params, const Binding* bindings) {
  auto hiding = *static_cast<const ActivateParams*>(params);
  hiding.*hidden_param = 0;
  healthy.run(&hiding, bindings);
}

TEST(VerifyWaking, HealthyScenePassesAndSomethingWakes) {
  const VerifyReport report = RunWaking({});
  EXPECT_TRUE(report.Passed()) << DescribeReport(report);
  const auto checks = ChecksOf(report, "waking");
  // Some chunk sleeps, or nothing was proven; and every kind of input wakes one.
  EXPECT_GT(checks.front().seen, 10u) << "asleep";
  const auto woke = [&](std::string_view name) {
    return std::any_of(checks.begin(), checks.end(), [&](const CheckResult& c) {
      return c.name == name && c.compared && c.seen > 0 && c.felt;
    });
  };
  for (const char* name :
       {"dt_s, less than a float's ulp", "dt_s, a lot", "gravity[1], one ulp", "sphere 1[0], a lot",
        "sphere 1[3], a lot", "wetness of character 0, one ulp", "wetness of character 1, a lot",
        "wind.velocity[0], a lot", "ground[3], a lot", "use_ground",
        "pose of character 0, root[0], one ulp", "character 0 teleported",
        "a sphere more, around sphere 1", "a sphere less", "capsule 0 radius, a lot",
        "capsule 0 to[0], a lot", "capsule 0 joint, one ulp", "a capsule less"})
    EXPECT_TRUE(woke(name)) << name;
  // What blows already keeps awake, and what moves the eye wakes no chain.
  for (const char* name : {"wind that blew already", "eye and target[0]", "eye and target[1]"})
    EXPECT_TRUE(std::any_of(checks.begin(), checks.end(), [&](const CheckResult& c) {
      return c.name == name && c.compared && c.felt;
    })) << name;
  EXPECT_TRUE(std::any_of(checks.begin(), checks.end(), [](const CheckResult& c) {
    return c.name.starts_with("sphere ") && c.name.ends_with("one ulp") && c.felt;
  }));
  // Every number of the input is there, and what is not compared says why.
  EXPECT_GT(checks.size(), 200u);
  for (const CheckResult& c : checks) EXPECT_TRUE(c.compared) << c.name << ": " << c.reason;
}

// Only modal layers, and what swings in them has no end; or no layer at all.
Scenario LooseTiny(bool any_layer) {
  Scenario loose = Tiny();
  for (LayerParams* layer : LayersOf(loose)) {
    layer->enabled &= any_layer && layer->solver == Solver::kModal;
    layer->damping_ratio = layer->velocity_damping = 0.0f;
  }
  return loose;
}

TEST(VerifyWaking, ASceneThatDoesNotRestIsDampedAndOneWithoutSleepersIsMissed) {
  VerifyOptions options = NoCases(1);
  options.checks = true;
  options.sections = {"waking"};
  VerifyReport report = Verify(LooseTiny(true), options);
  EXPECT_TRUE(report.Passed()) << DescribeReport(report);
  EXPECT_TRUE(report.Missing().empty()) << DescribeReport(report);
  EXPECT_GT(ChecksOf(report, "waking").front().seen, 3u) << "asleep";
  report = Verify(LooseTiny(false), options);
  EXPECT_TRUE(report.Passed());
  ASSERT_EQ(report.Missing().size(), 2u) << DescribeReport(report);
  EXPECT_EQ(report.Missing()[0].find("waking, coming to rest: no chunk sleeps"), 0u);
}

// What the chains at vertices do not see, their strands do not get, whichever input it is.
TEST(VerifyWaking, FrameInputsHiddenFromSleepingPatchesAreFound) {
  hidden_param = &ActivateParams::frame_inputs_changed;
  EXPECT_TRUE(FindsWaking("activate_patch", ActivateWithout, ""));
}

// Chains that still swing when nothing changes any more, and chunks that do not see it.
void ActivateWithoutPatches(const void* params, const Binding* bindings) {
  PatchListBlock none;
  std::fill(std::begin(none.patch), std::end(none.patch), ~0u);
  healthy.RunWith(params, bindings, StreamOf<&Streams::patch_list>, &none);
}

TEST(VerifyWaking, PatchesThatWakeHiddenFromTheirChunksAreFound) {
  EXPECT_TRUE(
      FindsWaking("activate_followers", ActivateWithoutPatches, "wetness of character 0, a lot"));
}

TEST(VerifyWaking, FrameInputsHiddenFromSleepersAreFound) {
  hidden_param = &ActivateParams::frame_inputs_changed;
  const VerifyReport report = RunWaking(Planting("activate", ActivateWithout));
  const auto checks = ChecksOf(report, "waking");
  // dt reaches a chunk through its layer too: what hides it alone is below.
  for (const char* name : {"sphere 1[0], a lot", "sphere 1[3], a lot", "ground[3], a lot",
                           "use_ground", "a sphere more", "a sphere less",
                           "capsule 0 radius, a lot", "capsule 0 to[0], a lot", "a capsule less"})
    EXPECT_TRUE(AnyFailed(checks, FindingKind::kSleep, name)) << name;
}

TEST(VerifyWaking, ATurnedCameraHiddenFromSleepersIsFound) {
  hidden_param = &ActivateParams::view_changed;
  for (const char* stage : {"activate", "activate_followers"})
    EXPECT_TRUE(FindsWaking(stage, ActivateWithout, "camera.eye[0]"));
}

// Weather and the modal solver's course tables reach a chunk through its layer's `changed`.
void ActivateUnchangedLayers(const void* params, const Binding* bindings) {
  LayerBlock layer = *healthy.As<const LayerBlock>(bindings, StreamOf<&Streams::layers>);
  layer.changed = 0;
  healthy.RunWith(params, bindings, StreamOf<&Streams::layers>, &layer);
}

TEST(VerifyWaking, ChangedLayersHiddenFromSleepersAreFound) {
  const VerifyReport report = RunWaking(Planting("activate", ActivateUnchangedLayers));
  const auto checks = ChecksOf(report, "waking");
  EXPECT_TRUE(AnyFailed(checks, FindingKind::kSleep, "wetness of character 0, a lot"));
  EXPECT_TRUE(AnyFailed(checks, FindingKind::kSleep, "dt_s, less than a float's ulp"))
      << "of the modal tables alone";
  EXPECT_TRUE(
      FindsWaking("activate_patch", ActivateUnchangedLayers, "wetness of character 0, a lot"));
}

// Wind keeps no chunk awake: only its beginning and its end wake, which change the layer's flags.
void ActivateWithoutWind(const void* params, const Binding* bindings) {
  LayerBlock layer = *healthy.As<const LayerBlock>(bindings, StreamOf<&Streams::layers>);
  layer.flags &= ~uint32_t(kLayerWind | kLayerBlows);
  healthy.RunWith(params, bindings, StreamOf<&Streams::layers>, &layer);
}

TEST(VerifyWaking, WindThatBlewAlreadyAndChangesHiddenFromSleepersIsFound) {
  EXPECT_TRUE(FindsWaking("activate", ActivateWithoutWind, "wind that blew already"));
}

// Vertices are written again only when a key or a record changed.
void CollectWithoutTheEye(const void* params, const Binding* bindings) {
  auto hiding = *static_cast<const CollectChangesParams*>(params);
  hiding.view_changed = 0;
  healthy.run(&hiding, bindings);
}

TEST(VerifyWaking, RibbonsThatDoNotTurnToAnEyeThatMovesAcrossAreFound) {
  EXPECT_TRUE(FindsWaking("collect_changes", CollectWithoutTheEye, "eye and target["));
}

// A joint that moves and does not say so.
uint32_t still_joint;
void PaletteWithAStillJoint(const void* params, const Binding* bindings) {
  healthy.run(params, bindings);
  auto& palette = *healthy.As<PaletteBlock>(bindings, StreamOf<&Streams::palette>);
  palette.moved[still_joint / 32] &= ~(1u << still_joint % 32);
}

TEST(VerifyWaking, AJointThatNeverMovesIsFound) {
  still_joint = 7;
  EXPECT_TRUE(FindsWaking("joint_palette", PaletteWithAStillJoint, "joint 7"));
}

// Joints that moved by less than a millionth did not move.
void PaletteWithThreshold(const void* params, const Binding* bindings) {
  auto& palette = *healthy.As<PaletteBlock>(bindings, StreamOf<&Streams::palette>);
  const PaletteBlock before = palette;
  healthy.run(params, bindings);
  for (uint32_t j = 0; j < kJointsPerCharacter; ++j) {
    float most = 0.0f;
    for (int i = 0; i < 12; ++i)
      most = std::max(most, std::abs(palette.matrix[j][i] - before.matrix[j][i]));
    if (most < 1e-6f) palette.moved[j / 32] &= ~(1u << j % 32);
  }
}

TEST(VerifyWaking, PosesThatChangeByLessThanAMillionthAreFound) {
  EXPECT_TRUE(FindsWaking("joint_palette", PaletteWithThreshold, "one ulp"));
}

}  // namespace
}  // namespace pelt::testing
