// When the stages of a frame of fur run, by what patches, chunks and layers say.
#include "core/kernels/frame_gates.hpp"

#include <gtest/gtest.h>

#include <vector>

#include "tests/jobs/synthetic_scene.hpp"

namespace pelt::testing {
namespace {

using Holds = std::vector<bool>;

class FrameGates : public ::testing::Test {
 protected:
  FrameGates() : scene_({{0, 0, 2, 1}, {0, 0, 3, 3}, {1, 0, 1, 2}}) {}

  ChunkStateBlock& State(uint32_t chunk) {
    return *scene_.memory().Of<&Streams::chunk_state>(chunk);
  }
  ChunkStateBlock& Patch(uint32_t patch) {
    return *scene_.memory().Of<&Streams::patch_state>(patch);
  }
  LayerBlock& Layer(uint32_t layer) { return *scene_.memory().Of<&Streams::layers>(layer); }
  LayerSortBlock& Sort(uint32_t layer) { return *scene_.memory().Of<&Streams::layer_sort>(layer); }
  // Of every chunk.
  Holds Of(const Gate& gate) { return OfAll(gate, Domain::kChunk); }
  Holds OfPatches(const Gate& gate) { return OfAll(gate, Domain::kPatch); }

  SyntheticSceneOf<Streams> scene_;

 private:
  Holds OfAll(const Gate& gate, Domain domain) {
    Holds holds;
    for (uint32_t i = 0; i < scene_.shape().ItemCount(domain); ++i)
      holds.push_back(gate.when.holds(scene_.memory(), PlaceOf(scene_.shape(), domain, i)));
    return holds;
  }
};

TEST_F(FrameGates, ChunksSayWhatIsToBeDone) {
  const uint32_t flags[] = {kChunkSkin, kChunkSimulate,          kChunkFit,
                            kChunkKeys, kChunkSkin | kChunkKeys, 0};
  for (uint32_t c = 0; c < 6; ++c) State(c).flags = flags[c];
  for (uint32_t p = 0; p < 6; ++p) Patch(p).flags = ~flags[p];
  EXPECT_EQ(Of(frame_gates::kRooted<Domain::kChunk>), Holds({1, 0, 0, 0, 1, 0}));
  EXPECT_EQ(Of(frame_gates::kSimulated<Domain::kChunk>), Holds({0, 1, 0, 0, 0, 0}));
  EXPECT_EQ(Of(frame_gates::kFitted), Holds({0, 0, 1, 0, 0, 0}));
  EXPECT_EQ(Of(frame_gates::kKeyed), Holds({0, 0, 0, 1, 1, 0}));
}

TEST_F(FrameGates, PatchesSayWhatIsToBeDoneOfThem) {
  const uint32_t flags[] = {kChunkSkin, kChunkSimulate, kChunkFit, 0, kChunkSkin | kChunkSimulate,
                            0};
  for (uint32_t p = 0; p < 6; ++p) Patch(p).flags = flags[p];
  for (uint32_t c = 0; c < 6; ++c) State(c).flags = ~flags[c];
  EXPECT_EQ(OfPatches(frame_gates::kSkinned), Holds({1, 0, 0, 0, 1, 0}));
  EXPECT_EQ(OfPatches(frame_gates::kRooted<Domain::kPatch>), Holds({1, 0, 0, 0, 1, 0}));
  EXPECT_EQ(OfPatches(frame_gates::kSimulated<Domain::kPatch>), Holds({0, 1, 0, 0, 1, 0}));
  EXPECT_EQ(OfPatches(frame_gates::kLoaded), Holds({0, 1, 0, 0, 1, 0}));
  EXPECT_EQ(OfPatches(frame_gates::kBent), Holds({0, 0, 1, 0, 0, 0}));
}

TEST_F(FrameGates, WindIsForChunksThatMoveInLayersThatItBlowsOn) {
  for (uint32_t c = 0; c < 6; ++c) State(c).flags = c == 3 ? ~kChunkSimulate : kChunkSimulate;
  for (uint32_t l = 0; l < 3; ++l) Layer(l).flags = l == 1 ? kLayerWind : ~kLayerWind;
  EXPECT_EQ(Of(frame_gates::kBlown<Domain::kChunk>), Holds({0, 0, 1, 0, 1, 0}));
}

TEST_F(FrameGates, WindIsForPatchesLikewise) {
  for (uint32_t p = 0; p < 6; ++p) Patch(p).flags = p == 2 ? ~kChunkSimulate : kChunkSimulate;
  for (uint32_t l = 0; l < 3; ++l) Layer(l).flags = l == 1 ? kLayerWind : ~kLayerWind;
  EXPECT_EQ(OfPatches(frame_gates::kBlown<Domain::kPatch>), Holds({0, 1, 0, 1, 0, 0}));
}

// Chains ask for rates where they are simulated; strands with chains of their own ask for those of
// vertices that rest, too.
TEST_F(FrameGates, RatesAreForWhatAsksForThemWhereTheyWereGiven) {
  const uint32_t flags[] = {kChunkVisible,
                            kChunkVisible | kChunkSimulate,
                            kChunkVisible,
                            0,
                            0,
                            kChunkVisible | kChunkSimulate};
  for (uint32_t i = 0; i < 6; ++i) State(i).flags = Patch(i).flags = flags[i];
  for (uint32_t l = 0; l < 3; ++l) Layer(l).flags = l == 1 ? kLayerRatesGiven : ~kLayerRatesGiven;
  EXPECT_EQ(Of(frame_gates::kRated<Domain::kChunk>), Holds({0, 0, 0, 0, 0, 0}));
  EXPECT_EQ(OfPatches(frame_gates::kRated<Domain::kPatch>), Holds({0, 1, 0, 0, 0, 0}));
  EXPECT_EQ(OfPatches(frame_gates::kMeshRated), Holds({0, 1, 1, 0, 0, 0}));
  Layer(2).flags = kLayerRatesGiven;
  EXPECT_EQ(Of(frame_gates::kRated<Domain::kChunk>), Holds({0, 0, 0, 0, 0, 1}));
  EXPECT_EQ(OfPatches(frame_gates::kMeshRated), Holds({0, 1, 1, 0, 0, 1}));
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
}  // namespace pelt::testing
