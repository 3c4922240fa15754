// A scene that takes over another's state goes on as the other does.
#include <gtest/gtest.h>

#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

uint64_t RunOne(RunningScenario& running, uint32_t frame, double dt_s = 1.0 / 60.0) {
  FrameInput input = running.Prepare(frame, {}, {});
  input.dt_s = dt_s;
  RunInput(running, input);
  return running.scene().DigestFrame();
}

TEST(FurSceneState, CopiedMidwayBothGoOnAlike) {
  Scenario scenario = TinyScenario();
  RunningScenario straight(scenario, {}), other(scenario, {});
  for (uint32_t f = 0; f < 12; ++f) RunOne(straight, f);
  RunOne(other, 0);  // elsewhere on its course, and no first frame any more
  ASSERT_TRUE(other.scene().CopyStateFrom(straight.scene()));
  EXPECT_EQ(other.scene().DigestFrame(), straight.scene().DigestFrame());
  for (uint32_t f = 12; f < 24; ++f)  // the teleport of frame 20 is in it
    ASSERT_EQ(RunOne(straight, f), RunOne(other, f)) << "frame " << f;
}

// How long the last frames were is part of it: what a modal layer's frame is stepped by depends on that.
TEST(FurSceneState, CopiedBehindALongFrameBothGoOnAlike) {
  Scenario scenario = TinyScenario();
  RunningScenario straight(scenario, {}), other(scenario, {});
  for (uint32_t f = 0; f < 6; ++f) RunOne(straight, f, f < 5 ? 1.0 / 60.0 : 1.0 / 30.0);
  for (uint32_t f = 0; f < 3; ++f) RunOne(other, f);
  ASSERT_TRUE(other.scene().CopyStateFrom(straight.scene()));
  for (uint32_t f = 6; f < 12; ++f)
    ASSERT_EQ(RunOne(straight, f), RunOne(other, f)) << "frame " << f;
}

TEST(FurSceneState, GoesBackToAnEarlierFrame) {
  Scenario scenario = TinyScenario();
  RunningScenario running(scenario, {}), kept(scenario, {});
  for (uint32_t f = 0; f < 6; ++f) RunOne(running, f);
  ASSERT_TRUE(kept.scene().CopyStateFrom(running.scene()));
  std::vector<uint64_t> first;
  for (uint32_t f = 6; f < 10; ++f) first.push_back(RunOne(running, f));
  ASSERT_TRUE(running.scene().CopyStateFrom(kept.scene()));
  for (uint32_t f = 6; f < 10; ++f) ASSERT_EQ(RunOne(running, f), first[f - 6]) << "frame " << f;
}

TEST(FurSceneState, OfAnotherShapeIsRefusedAndNothingIsDone) {
  Scenario scenario = TinyScenario(), longer = TinyScenario();
  longer.actors.push_back(longer.actors[0]);
  RunningScenario one(scenario, {}), two(longer, {});
  RunOne(one, 0);
  const uint64_t before = one.scene().DigestFrame();
  EXPECT_FALSE(one.scene().CopyStateFrom(two.scene()));
  EXPECT_FALSE(two.scene().CopyStateFrom(one.scene()));
  EXPECT_EQ(one.scene().DigestFrame(), before);
  // Of the same memory, but sorted in pieces: other stages run.
  RunningScenario sorted_in_pieces(scenario, {.piecewise_sort_chunks = 1});
  EXPECT_FALSE(one.scene().CopyStateFrom(sorted_in_pieces.scene()));
}

TEST(FurSceneState, GoesOnWithTheSameGroomsAsIfNothingHadBeen) {
  Scenario scenario = TinyScenario();
  RunningScenario straight(scenario, {}), replaced(scenario, {});
  for (uint32_t f = 0; f < 12; ++f) ASSERT_EQ(RunOne(straight, f), RunOne(replaced, f));
  for (uint32_t f = 12; f < 24; ++f) {
    ASSERT_TRUE(replaced.GoOnWith(scenario));
    ASSERT_EQ(RunOne(straight, f), RunOne(replaced, f)) << "frame " << f;
  }
}

// `change` of every layer in the middle of a run: how far tips are then from where they were a frame before, and from
// where they are without it.
void GoOnChanged(auto change, float& moved, float& apart) {
  Scenario scenario = TinyScenario(), changed = TinyScenario();
  for (LayerParams* layer : LayersOf(changed)) change(*layer);
  RunningScenario straight(scenario, {}), replaced(scenario, {});
  const auto curves = [](RunningScenario& running, uint32_t layer) {
    std::vector<StrandCurve> out(size_t(running.scene().shape().LayerChunks(layer)) *
                                 kStrandsPerChunk);
    out.resize(running.scene().CopyCurves(layer, out));
    return out;
  };
  const auto far = [&](RunningScenario& a, const auto& b, uint32_t layer) {
    float most = 0.0f;
    const std::vector<StrandCurve> curve = curves(a, layer);
    for (size_t s = 0; s < std::min(curve.size(), b.size()); ++s)
      for (int c = 0; c < 3; ++c)
        most = std::max(most, std::abs(curve[s].point[4][c] - b[s].point[4][c]));
    return most;
  };
  for (uint32_t f = 0; f < 12; ++f) {
    RunOne(straight, f);
    RunOne(replaced, f);
  }
  ASSERT_TRUE(replaced.GoOnWith(changed));
  std::vector<std::vector<StrandCurve>> before;
  for (uint32_t l = 0; l < straight.scene().shape().layer_count; ++l)
    before.push_back(curves(replaced, l));
  RunOne(straight, 12);
  RunOne(replaced, 12);
  moved = apart = 0.0f;
  for (uint32_t l = 0; l < before.size(); ++l) {
    moved = std::max(moved, far(replaced, before[l], l));
    apart = std::max(apart, far(replaced, curves(straight, l), l));
  }
}

TEST(FurSceneState, AChangedWeightIsFeltWithoutAJump) {
  float moved = 0.0f, apart = 0.0f;
  GoOnChanged([](LayerParams& p) { p.weight *= 3.0f; }, moved, apart);
  EXPECT_GT(apart, 1e-4f);
  EXPECT_LT(moved, 0.045f) << moved;
}

TEST(FurSceneState, OtherStrandsAreRefusedAndNothingIsDone) {
  Scenario scenario = TinyScenario(), fewer = TinyScenario(), other_kind = TinyScenario();
  Scenario other_mesh = TinyScenario(), other_root = TinyScenario(), other_halo = TinyScenario();
  reinterpret_cast<unsigned char&>(other_mesh.grooms[0].mesh[1]) ^= 1;
  std::swap(other_root.grooms[0].strands[0].vertex[0][0],
            other_root.grooms[0].strands[0].vertex[1][0]);
  HaloBlock& halo = other_halo.grooms[0].halo[0];
  std::swap(halo.vertex[0], halo.vertex[1]);
  fewer.grooms[0].strands[0].strand_count -= 1;
  Solver& solver = other_kind.grooms[0].layers[0].params.solver;
  solver = solver == Solver::kModal ? Solver::kPbd : Solver::kModal;
  RunningScenario straight(scenario, {}), running(scenario, {});
  for (uint32_t f = 0; f < 3; ++f) ASSERT_EQ(RunOne(straight, f), RunOne(running, f));
  EXPECT_FALSE(running.GoOnWith(fewer));
  EXPECT_FALSE(running.GoOnWith(other_kind));
  EXPECT_FALSE(running.GoOnWith(other_mesh));
  EXPECT_FALSE(running.GoOnWith(other_root));
  EXPECT_FALSE(running.GoOnWith(other_halo));
  EXPECT_EQ(RunOne(straight, 3), RunOne(running, 3));
}

}  // namespace
}  // namespace pelt::testing
