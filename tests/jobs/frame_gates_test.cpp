// When the stages of a frame of fur run, by what chunks and layers say.
#include "core/kernels/frame_gates.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/jobs/synthetic_scene.hpp"

namespace pelt {
namespace {

using namespace testing;
using Holds = std::vector<bool>;

class FrameGates : public ::testing::Test {
 protected:
  FrameGates() : scene_({{0, 0, 2}, {0, 0, 3}, {1, 0, 1}}) {}

  ChunkStateBlock& State(uint32_t chunk) {
    return *scene_.memory().Of<&Streams::chunk_state>(chunk);
  }
  LayerBlock& Layer(uint32_t layer) { return *scene_.memory().Of<&Streams::layers>(layer); }
  LayerSortBlock& Sort(uint32_t layer) { return *scene_.memory().Of<&Streams::layer_sort>(layer); }
  // Of every chunk.
  Holds Of(const Gate& gate) {
    Holds holds;
    for (uint32_t c = 0; c < scene_.shape().chunk_count; ++c)
      holds.push_back(gate.when.holds(scene_.memory(), PlaceOf(scene_.shape(), Domain::kChunk, c)));
    return holds;
  }

  SyntheticSceneOf<Streams> scene_;
};

TEST_F(FrameGates, ChunksSayWhatIsToBeDone) {
  const uint32_t flags[] = {kChunkSkin, kChunkSimulate,          kChunkFit,
                            kChunkKeys, kChunkSkin | kChunkKeys, 0};
  for (uint32_t c = 0; c < 6; ++c) State(c).flags = flags[c];
  EXPECT_EQ(Of(frame_gates::kSkinned), Holds({1, 0, 0, 0, 1, 0}));
  EXPECT_EQ(Of(frame_gates::kSimulated), Holds({0, 1, 0, 0, 0, 0}));
  EXPECT_EQ(Of(frame_gates::kFitted), Holds({0, 0, 1, 0, 0, 0}));
  EXPECT_EQ(Of(frame_gates::kKeyed), Holds({0, 0, 0, 1, 1, 0}));
}

TEST_F(FrameGates, WindIsForChunksThatMoveInLayersThatItBlowsOn) {
  for (uint32_t c = 0; c < 6; ++c) State(c).flags = c == 3 ? ~kChunkSimulate : kChunkSimulate;
  for (uint32_t l = 0; l < 3; ++l) Layer(l).flags = l == 1 ? kLayerWind : ~kLayerWind;
  EXPECT_EQ(Of(frame_gates::kBlown), Holds({0, 0, 1, 0, 1, 0}));
}

TEST_F(FrameGates, ALayerIsSortedWhenKeysChanged) {
  for (uint32_t l = 0; l < 3; ++l) Sort(l) = {kStrandsPerChunk, l == 2, 0, {}};
  EXPECT_EQ(Of(frame_gates::kResorted), Holds({0, 0, 0, 0, 0, 1}));
}

TEST_F(FrameGates, PiecesThatHoldDrawnStrandsAreRedrawn) {
  Sort(0) = {kStrandsPerChunk, 0, 1, {}};      // the first only: the second begins behind the last
  Sort(1) = {kStrandsPerChunk + 1, 1, 0, {}};  // two of three
  Sort(2) = {5, 0, 0, {}};                     // nothing changed
  EXPECT_EQ(Of(frame_gates::kRedrawn), Holds({1, 0, 1, 1, 0, 0}));
}

}  // namespace
}  // namespace pelt
