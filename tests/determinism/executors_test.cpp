// The whole fur frame gives the same bits in every way to run it: execution orders, local store, oneTBB,
// fusion, instruction sets, the sort in pieces. `pelt verify` goes through the full product on any
// scene; this holds `tiny`, some of its ribbons as lines, past its teleport, and says which broke.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>

#include "core/kernels/frame_table.hpp"
#include "jobs/tbb_executor.hpp"
#include "platform_sim/local_store.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

constexpr uint32_t kFrames = 24;

class WholeFrame : public ::testing::Test {
 protected:
  // The serial executor with the reference kernels.
  static const std::vector<uint64_t>& Truth() {
    static const std::vector<uint64_t> kTruth = [] {
      Scenario scenario = EveryOutputScenario();
      return RunDigests(scenario, OptionsFor(Isa::kReference), kFrames);
    }();
    return kTruth;
  }
  static void ExpectTruth(const SceneOptions& options, Executor& executor,
                          const std::string& what) {
    Scenario scenario = EveryOutputScenario();
    ExpectSameFrames(Truth(), RunDigests(scenario, options, executor, kFrames), what);
  }
};

TEST_F(WholeFrame, MovesFromFrameToFrame) {
  for (uint32_t f = 1; f < kFrames; ++f) EXPECT_NE(Truth()[f], Truth()[f - 1]) << f;
}

TEST_F(WholeFrame, IsTheSameTwice) {
  SerialExecutor serial;
  ExpectTruth(OptionsFor(Isa::kReference), serial, "again");
}

TEST_F(WholeFrame, IsTheSameOnEveryInstructionSet) {
  SerialExecutor serial;
  for (const Isa isa : kAllIsas) {
    if (!FindKernels(isa)) {
      std::printf("not run: %s, this processor or build lacks it\n", IsaName(isa).data());
      continue;
    }
    ExpectTruth(OptionsFor(isa), serial, std::string(IsaName(isa)));
  }
}

TEST_F(WholeFrame, IsTheSameInEveryExecutionOrder) {
  for (uint64_t seed = 0; seed < 4; ++seed) {
    PermutedExecutor executor(seed);
    ExpectTruth(OptionsFor(BestIsa()), executor, "order " + std::to_string(seed));
  }
}

TEST_F(WholeFrame, IsTheSameFusedAndUnfused) {
  SceneOptions options = OptionsFor(BestIsa());
  options.plan.fuse = false;
  SerialExecutor serial;
  ExpectTruth(options, serial, "unfused");
  options.plan.fuse = true;
  options.plan.local_store_data_bytes = 96 * 1024;
  ExpectTruth(options, serial, "fused for a smaller local store");
}

TEST_F(WholeFrame, IsTheSameInLocalStoreWithoutFaults) {
  for (const Isa isa : {Isa::kReference, BestIsa()})
    for (const bool fuse : {true, false}) {
      SceneOptions options = OptionsFor(isa);
      options.plan.fuse = fuse;
      LocalStoreExecutor local(options.plan.local_store_data_bytes);
      ExpectTruth(options, local, fuse ? "fused" : "unfused");
      ExpectNoFaults(local);
      EXPECT_GT(local.counts().get_bytes, 0u);
      EXPECT_LE(local.counts().peak_bytes, options.plan.local_store_data_bytes);
    }
}

TEST_F(WholeFrame, IsTheSameSortedInPieces) {
  SceneOptions options = OptionsFor(BestIsa());
  options.piecewise_sort_chunks = 1;
  SerialExecutor serial;
  ExpectTruth(options, serial, "pieces");
  PermutedExecutor permuted(3);
  ExpectTruth(options, permuted, "pieces, permuted");
  LocalStoreExecutor local(options.plan.local_store_data_bytes);
  ExpectTruth(options, local, "pieces in local store");
  EXPECT_TRUE(local.faults().empty());
}

TEST_F(WholeFrame, IsTheSameOnOneTbb) {
  for (const uint32_t workers : {1u, 2u, 3u, 7u}) {
    TbbExecutor executor(workers);
    ExpectTruth(OptionsFor(BestIsa()), executor, std::to_string(workers) + " workers");
  }
}

// For any share of a layer's strands that lives, the vertices that kernels gather for them live too:
// for the strands of whole lane groups.
TEST_F(WholeFrame, EveryVertexInUseLives) {
  Scenario scenario = EveryOutputScenario();
  RunningScenario running(scenario, OptionsFor(BestIsa()));
  const FrameMemory& memory = running.scene().memory();
  const SceneShape& shape = running.scene().shape();
  uint32_t used = 0, idle = 0;
  for (uint32_t f = 0; f < kFrames; ++f) {
    LodSettings lod;
    lod.hysteresis = 0.0f;
    lod.strand_budget = uint32_t(scenario.StrandCount()) * (f % 8 + 1) / 9;
    RunFrame(running, f, {.lod = true}, lod);
    for (uint32_t c = 0; c < shape.chunk_count; ++c) {
      const StrandBlock& strands = *memory.Of<&Streams::strands>(c);
      const uint32_t live = memory.Of<&Streams::chunk_state>(c)->live_strands;
      const uint32_t touched = std::min(RoundUpToLaneGroups(live), strands.strand_count);
      for (uint32_t s = 0; s < touched; ++s)
        for (const auto& corner : strands.vertex) {
          const VertexPlace place = FindVertex(memory, c, corner[s]);
          ASSERT_EQ(shape.patch_layer[place.patch], shape.chunk_layer[c]);
          ASSERT_LT(place.lane, memory.Of<&Streams::patch_state>(place.patch)->live_vertices)
              << "frame " << f << ", chunk " << c << ", strand " << s;
          ++used;
        }
    }
    for (uint32_t p = 0; p < shape.patch_count; ++p) {
      const ChunkStateBlock& state = *memory.Of<&Streams::patch_state>(p);
      if (state.flags & kChunkVisible)
        idle += memory.Of<&Streams::patches>(p)->vertex_count - state.live_vertices;
    }
  }
  EXPECT_GT(used, 1000u);
  EXPECT_GT(idle, 0u) << "and not all do";
}

// Vertices in strand order are those in draw order, each where the order says.
TEST_F(WholeFrame, VertexOrdersHoldTheSameVertices) {
  Scenario scenario = EveryOutputScenario();
  RunningScenario sorted_run(scenario, {}),
      unsorted_run(scenario, {.vertex_order = VertexOrder::kIndexBuffer});
  const FurScene &sorted = sorted_run.scene(), &unsorted = unsorted_run.scene();
  for (uint32_t f = 0; f < 4; ++f) RunFrame(sorted_run, f), RunFrame(unsorted_run, f);
  uint32_t compared = 0;
  for (uint32_t l = 0; l < sorted.shape().layer_count; ++l) {
    const uint32_t first = sorted.shape().layer_first_chunk[l];
    const auto& count = *sorted.memory().Of<&Streams::layer_sort>(l);
    const OutputEntry& output = kOutputs[OutputOf(sorted.shape().layer_kind[l])];
    if (!output.OfStrands()) {
      const uint32_t first_patch = sorted.shape().layer_first_patch[l];
      ASSERT_GT(sorted.shape().LayerPatches(l), 0u);
      for (uint32_t p = first_patch; p < sorted.shape().layer_first_patch[l + 1]; ++p)
        ASSERT_EQ(std::memcmp(sorted.memory().Block(output.in_draw_order, p),
                              unsorted.memory().Block(output.in_strand_order, p),
                              sizeof(ShellVertexBlock)),
                  0)
            << "patch " << p;
      compared += count.visible_count;
      continue;
    }
    const uint32_t bytes = output.StrandBytes();
    for (uint32_t place = 0; place < count.visible_count; ++place) {
      const uint32_t chunk = first + place / kStrandsPerChunk, lane = place % kStrandsPerChunk;
      const uint32_t strand = sorted.memory().Of<&Streams::order>(chunk)->strand[lane];
      ASSERT_EQ(unsorted.memory().Of<&Streams::order>(chunk)->strand[lane], strand);
      const uint32_t from = first + strand / kStrandsPerChunk, at = strand % kStrandsPerChunk;
      const auto* a = sorted.memory().Block(output.in_draw_order, chunk) + lane * bytes;
      const auto* b = unsorted.memory().Block(output.in_strand_order, from) + at * bytes;
      ASSERT_EQ(std::memcmp(a, b, bytes), 0) << "layer " << l << ", place " << place;
      ++compared;
    }
  }
  EXPECT_EQ(compared, sorted.DrawnStrands());
  EXPECT_GT(compared, 100u);
}

}  // namespace
}  // namespace pelt::testing
