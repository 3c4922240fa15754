// Layers that are culled though they are seen, and returns that are no start, are found.
#include <gtest/gtest.h>

#include <cstring>

#include "bench/verify/checks.hpp"
#include "core/kernels/select_lod.hpp"
#include "tests/verify/planting.hpp"

namespace pelt::testing {
namespace {

::testing::AssertionResult FindsCulling(const char* stage, Planted planted, const char* name) {
  return Finds("culling", 6, FindingKind::kCull, name, stage, planted);
}

TEST(VerifyCulling, HealthyScenePassesWithLayersThatLeaveAndReturn) {
  const VerifyReport report = RunSection("culling", 6, {});
  EXPECT_TRUE(report.Passed()) << DescribeReport(report);
  for (const CheckResult& c : ChecksOf(report, "culling")) {
    EXPECT_TRUE(c.compared) << c.name << ": " << c.reason;
    EXPECT_GT(c.seen, 0u) << c.name;
  }
}

void CullEverything(const void* params, const Binding* bindings) {
  auto wrong = *static_cast<const SelectLodParams*>(params);
  for (auto& plane : wrong.view.planes)
    for (float& x : plane) x = -x;
  healthy.run(&wrong, bindings);
}
void CullAtTheMiddle(const void* params, const Binding* bindings) {
  auto wrong = *static_cast<const SelectLodParams*>(params);
  // The left plane through the middle of the picture: half of what is seen is lost.
  for (int i = 0; i < 3; ++i)
    wrong.view.planes[0][i] = wrong.view.planes[0][i] - wrong.view.planes[1][i];
  wrong.view.planes[0][3] = wrong.view.planes[0][3] - wrong.view.planes[1][3];
  healthy.run(&wrong, bindings);
}

TEST(VerifyCulling, APlaneTestThatCullsTooMuchIsFound) {
  for (const Planted planted : {CullEverything, CullAtTheMiddle})
    EXPECT_TRUE(FindsCulling("select_lod", planted, "no layer in view"));
}

// A layer that returns goes on from where it left instead of starting from its groom.
template <auto kState>
void ActivateWithoutRestart(const void* params, const Binding* bindings) {
  healthy.run(params, bindings);
  auto& state = *healthy.As<ChunkStateBlock>(bindings, StreamOf<kState>);
  state.flags &= ~uint32_t(kChunkRestart);
  state.first_new_strand = state.live_strands;
  state.first_new_vertex = state.live_vertices;
  state.first_new_chain = state.live_chains;
}

TEST(VerifyCulling, ALayerThatReturnsWithoutARestartIsFound) {
  const std::pair<const char*, Planted> kPlanted[] = {
      {"activate", &ActivateWithoutRestart<&Streams::chunk_state>},
      {"activate_followers", &ActivateWithoutRestart<&Streams::chunk_state>},
      {"activate_patch", &ActivateWithoutRestart<&Streams::patch_state>}};
  for (const auto& [stage, planted] : kPlanted) EXPECT_TRUE(FindsCulling(stage, planted, "return"));
}

// Only the flag that says so: all lanes are new in any case.
void ActivateWithoutTheRestartFlag(const void* params, const Binding* bindings) {
  healthy.run(params, bindings);
  healthy.As<ChunkStateBlock>(bindings, StreamOf<&Streams::chunk_state>)->flags &=
      ~uint32_t(kChunkRestart);
}

TEST(VerifyCulling, ALayerThatReturnsAndDoesNotSayThatItRestartsIsFound) {
  for (const char* stage : {"activate", "activate_followers"})
    EXPECT_TRUE(FindsCulling(stage, ActivateWithoutTheRestartFlag, "return"));
}

// Keys that are those of the last time in view are reported as unchanged.
void KeysWithoutTheRestart(const void* params, const Binding* bindings) {
  const SortKeyBlock before =
      *healthy.As<const SortKeyBlock>(bindings, StreamOf<&Streams::sort_keys>);
  healthy.run(params, bindings);
  const auto& keys = *healthy.As<const SortKeyBlock>(bindings, StreamOf<&Streams::sort_keys>);
  if (std::memcmp(&before, &keys, sizeof keys) == 0)
    healthy.As<ChunkStateBlock>(bindings, StreamOf<&Streams::chunk_state>)->keys_changed = 0;
}

TEST(VerifyCulling, AnUnchangedKeyThatIsNotReportedAfterAReturnIsFound) {
  EXPECT_TRUE(FindsCulling("sort_key4", KeysWithoutTheRestart, "the same picture"));
}

// The box of the skin, on its low or its high side.
bool skin_low;
void BoundOfTheSkin(const void* params, const Binding* bindings) {
  healthy.run(params, bindings);
  const float margin =
      healthy.As<const LayerBlock>(bindings, StreamOf<&Streams::layers>)->length_max;
  auto& bounds = *healthy.As<BoundsBlock>(bindings, StreamOf<&Streams::bounds>);
  for (int axis = 0; axis < 3; ++axis)
    (skin_low ? bounds.low : bounds.high)[axis] += skin_low ? margin : -margin;
}

TEST(VerifyCulling, ABoxWithoutTheFursLengthIsFound) {
  for (const bool low : {true, false}) {
    skin_low = low;
    EXPECT_TRUE(FindsCulling("bound_layer", BoundOfTheSkin, "tips"));
  }
}

TEST(ViewTest, SeesWhatStandsBeforeTheCamera) {
  Camera camera;  // at (0, 1, 3), towards (0, 1, 0)
  camera.near_m = 0.5f;
  camera.far_m = 10.0f;
  const ViewTest view(camera);
  EXPECT_TRUE(view.IsClearlyInside({0.0f, 1.0f, 0.0f}));
  EXPECT_FALSE(view.IsClearlyInside({0.0f, 1.0f, 2.9f})) << "nearer than near";
  EXPECT_FALSE(view.IsClearlyInside({0.0f, 1.0f, -8.0f})) << "beyond far";
  EXPECT_FALSE(view.IsClearlyInside({0.0f, 1.0f, 4.0f})) << "behind";
  EXPECT_FALSE(view.IsClearlyInside({3.5f, 1.0f, 0.0f}));
  EXPECT_FALSE(view.IsClearlyInside({-3.5f, 1.0f, 0.0f}));
  EXPECT_FALSE(view.IsClearlyInside({0.0f, 3.0f, 0.0f}));
  EXPECT_FALSE(view.IsClearlyInside({0.0f, -1.0f, 0.0f}));
  EXPECT_TRUE(view.IsClearlyInside({2.0f, 1.0f, 0.0f})) << "wider than high";
}

}  // namespace
}  // namespace pelt::testing
