// What no plan is made from: ports that cannot be bound, streams that race within a stage, gates of
// another domain. The text names stage, port and stream.
#include <gtest/gtest.h>

#include <string>

#include "core/error.hpp"
#include "jobs/plan.hpp"
#include "tests/jobs/synthetic_scene.hpp"

namespace pelt {
namespace {

using testing::MakeShape;
using testing::MakeStage;

struct NoParams {};
constexpr NoParams kNone{};
const SceneShape kShape = MakeShape({{0, 0, 3}, {0, 0, 2}});

template <class K>
Stage Chunk() {
  return MakeStage<K>(Domain::kChunk, kNone);
}

std::string ErrorOf(std::vector<Stage> stages) {
  try {
    CompilePlan(std::move(stages), kShape, {});
  } catch (const Error& e) {
    return e.what();
  }
  return "";
}

struct SumLayer {
  static constexpr std::string_view kName = "sum_layer";
  using Params = NoParams;
  struct Ports {
    All<SortKeyBlock> keys;
    Out<LayerSortBlock> sum;
  };
  static constexpr auto kPorts = PortList(Port<&Ports::keys>(Stream::kSortKeys, "keys"),
                                          Port<&Ports::sum>(Stream::kLayerSort, "sum"));
  static void Run(const Params&, const Ports&) {}
};
struct OutToCoarser {
  static constexpr std::string_view kName = "out_to_coarser";
  using Params = NoParams;
  struct Ports {
    Out<BoundsBlock> bounds;
  };
  static constexpr auto kPorts = PortList(Port<&Ports::bounds>(Stream::kBounds, "bounds"));
  static void Run(const Params&, const Ports&) {}
};
struct SharedOfOwnDomain {
  static constexpr std::string_view kName = "shared_of_own";
  using Params = NoParams;
  struct Ports {
    Shared<SortKeyBlock> keys;
  };
  static constexpr auto kPorts = PortList(Port<&Ports::keys>(Stream::kSortKeys, "keys"));
  static void Run(const Params&, const Ports&) {}
};
struct WrongBlock {
  static constexpr std::string_view kName = "wrong_block";
  using Params = NoParams;
  struct Ports {
    In<SortPairBlock> keys;
  };
  static constexpr auto kPorts = PortList(Port<&Ports::keys>(Stream::kSortKeys, "keys"));
  static void Run(const Params&, const Ports&) {}
};
struct GatherWithoutList {
  static constexpr std::string_view kName = "gather_without_list";
  using Params = NoParams;
  struct Ports {
    Gather<CurveRecord> curves;
  };
  static constexpr auto kPorts = PortList(Port<&Ports::curves>(Stream::kCurves, "curves"));
  static void Run(const Params&, const Ports&) {}
};
struct ReadsAndScatters {
  static constexpr std::string_view kName = "reads_and_scatters";
  using Params = NoParams;
  struct Ports {
    In<SortPairBlock> pairs;
    Scatter<SortPair> sorted;
  };
  static constexpr auto kPorts = PortList(Port<&Ports::pairs>(Stream::kSortPairsA, "pairs"),
                                          Port<&Ports::sorted>(Stream::kSortPairsA, "sorted"));
  static void Run(const Params&, const Ports&) {}
};

TEST(PlanErrors, RefusesPortsThatCannotBeBound) {
  const auto has = [](const std::string& text, std::string_view part) {
    return text.find(part) != std::string::npos;
  };
  const std::string coarser = ErrorOf({Chunk<OutToCoarser>()});
  EXPECT_TRUE(has(coarser, "stage out_to_coarser: port 'bounds' (stream bounds)")) << coarser;
  const std::string shared = ErrorOf({Chunk<SharedOfOwnDomain>()});
  EXPECT_TRUE(has(shared, "coarser domain")) << shared;
  const std::string block = ErrorOf({Chunk<WrongBlock>()});
  EXPECT_TRUE(has(block, "block is not the stream's")) << block;
  const std::string list = ErrorOf({Chunk<GatherWithoutList>()});
  EXPECT_TRUE(has(list, "no record list")) << list;
  const std::string all = ErrorOf({Chunk<SumLayer>()});
  EXPECT_TRUE(has(all, "stage sum_layer: port 'keys'")) << all;
  const std::string race = ErrorOf({Chunk<ReadsAndScatters>()});
  EXPECT_TRUE(has(race, "'pairs' and 'sorted' are one stream (sort_pairs_a)")) << race;
}

TEST(PlanErrors, RefusesGatesOfAnotherDomain) {
  const std::string error =
      ErrorOf({MakeStage<SumLayer>(Domain::kLayer, kNone, {.chunk_flags = kChunkSkin})});
  EXPECT_NE(error.find("stage sum_layer: its gate is for chunks"), std::string::npos) << error;
}

}  // namespace
}  // namespace pelt
