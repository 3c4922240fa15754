// The scale from the cheapest way to run a scene to the most exact: its ends, its order, and that
// nothing but the way itself is in an error.
#include "bench/accuracy/scene_precision.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "bench/accuracy/scene_points.hpp"
#include "core/character/pose.hpp"
#include "core/groom/bake.hpp"
#include "core/groom/groom_file.hpp"
#include "core/modal/modal_quality.hpp"

namespace pelt::accuracy {
namespace {

ScenePrecisionOptions Quick(uint32_t frames) {
  ScenePrecisionOptions options;
  options.frames = frames;
  options.quick = true;
  return options;
}

const ScenePrecision& Tiny() {
  static const ScenePrecision result = MeasureScenePrecision(LoadScenario("tiny"), Quick(120));
  return result;
}
const ScenePrecisionRow& Row(const ScenePrecision& result, std::string_view way) {
  const ScenePrecisionRow* row = result.Find(way);
  if (!row) ADD_FAILURE() << "no row " << way;
  return *row;
}
double ErrorOf(std::string_view way) { return Row(Tiny(), way).error; }

TEST(ErrorSum, IsTheShareOfTheSecondaryMotion) {
  const ScenePoints rigid = {1.0f, 2.0f, 3.0f, 4.0f, 5.0f, 6.0f};
  const ScenePoints reference = {1.5f, 2.0f, 2.0f, 4.0f, 5.25f, 6.0f};
  ScenePoints points = reference;
  for (size_t i = 0; i < points.size(); ++i) points[i] += 0.25f * (reference[i] - rigid[i]);
  ErrorSum sum;
  sum.Add(points, reference, rigid);
  EXPECT_DOUBLE_EQ(sum.Share(), 0.25);
  sum.Add(rigid, reference, rigid);
  EXPECT_DOUBLE_EQ(sum.Share(), std::sqrt((1.0 + 0.0625) / 2));
  // Two points, twice.
  EXPECT_DOUBLE_EQ(sum.MovedRms(), std::sqrt((0.25 + 1.0 + 0.0625) / 2));
}

TEST(ScenePrecision, RunsFromNoSimulationToTheReference) {
  EXPECT_DOUBLE_EQ(ErrorOf("rigid"), 1.0);
  EXPECT_GT(Tiny().self_error, 0.0);
  for (const ScenePrecisionRow& row : Tiny().rows) {
    EXPECT_GT(row.error, Tiny().self_error) << row.way.label;
    EXPECT_GT(row.simulate_ns, 0.0) << row.way.label;
    EXPECT_GT(row.frame_ns, row.simulate_ns) << row.way.label;
    if (row.way.simulate && row.way.OnReferenceMaterial()) {
      EXPECT_LT(row.error, 0.8) << row.way.label;
    }
  }
  EXPECT_EQ(Tiny().rows.size(), AllSceneWays().size());
  EXPECT_GT(Tiny().secondary_m, 1e-3);
}

TEST(ScenePrecision, TipsAreWithinTheirBound) {
  uint64_t of_fast = 0;
  for (const TipRow& layer : Tiny().layer_tips) {
    EXPECT_TRUE(layer.name.starts_with("modal")) << layer.name << " is of another solver";
    if (layer.way == "fast") of_fast += layer.tips;
  }
  std::map<std::string, TipRow> ways;
  for (const TipRow& row : Tiny().tips) {
    ways[row.way] = row;
    EXPECT_GT(double(row.within), 0.99 * double(row.tips)) << row.way;
    EXPECT_LT(row.p99, ErrorShare(row.way.starts_with("fast") || row.way == "fine-on-screen"
                                      ? ModalQuality::kFast
                                      : ModalQuality::kFine,
                                  row.way == "fine-lod-4"         ? 3
                                  : row.way == "fine-lod-2"       ? 2
                                  : row.way == "fine-half-chains" ? 1
                                                                  : 0))
        << row.way;
  }
  ASSERT_EQ(ways.size(), 7u);
  EXPECT_LT(ways["fine-lod-2"].tips, ways["fine"].tips) << "of what lives";
  EXPECT_EQ(ways["fast"].tips, of_fast);
  EXPECT_GT(ways["fast"].p99, 1.2 * ways["fine"].p99);
  // A tip is off its own strand's motion.
  EXPECT_GT(ways["fine"].p99, 1e-4);
}

// Shares of 0.5 % to 99.5 % of the length, one as often as the other.
TEST(TipErrors, CountTipsByTheirShareOfTheLongestStrand) {
  Scenario scene = LoadScenario("tiny");
  for (GroomLayer& layer : scene.grooms[0].layers) layer.params.solver = Solver::kModal;
  const SceneWay ways[] = {{.name = "fine", .label = ""}};
  ASSERT_TRUE(SetWay(ways[0], scene, scene));
  SceneRun run(ways[0], scene, BestIsa());
  run.RunFrame(0);
  const ScenePointsLayout layout(run.scene());
  ScenePoints reference;
  layout.Read(run.scene(), reference);
  ScenePoints points = reference;
  TipErrors errors(scene, ways);
  uint64_t tips = 0, within = 0;
  for (const auto& piece : layout.pieces()) {
    const uint32_t layer = run.scene().shape().chunk_layer[piece.chunk];
    const float length = run.scene().memory().Of<&Streams::layers>(layer)->length_max;
    for (uint32_t lane = 0; lane < piece.strands; ++lane, ++tips) {
      const float share = 0.01f * float(tips % 100) + 0.005f;
      points[piece.PlaceOfTip(1, lane)] += share * length;
      within += share < ErrorShare(ModalQuality::kFine);
    }
  }
  errors.Add(0, run.scene(), layout, points, reference);
  const std::vector<TipRow> rows = errors.Ways();
  ASSERT_EQ(rows.size(), 1u);
  EXPECT_EQ(rows[0].tips, tips);
  EXPECT_EQ(rows[0].within, within);
  EXPECT_GE(rows[0].p99, 0.985);
  EXPECT_LE(rows[0].p99, 1.03);
}

// Without contacts, which are resolved once per frame in every quality.
TEST(ScenePrecision, QualitiesAreInOrder) {
  ScenePrecisionOptions options = Quick(90);
  options.contact = false;
  const ScenePrecision result = MeasureScenePrecision(LoadScenario("tiny"), options);
  EXPECT_LT(Row(result, "fine").error, Row(result, "fast").error);
  // What these two get wrong is the roots' path between frames, which neither knows.
  EXPECT_LT(Row(result, "best").error, 1.15 * Row(result, "fine").error);
  EXPECT_LT(result.self_error, Row(result, "best").error);
  EXPECT_LT(Row(result, "best").error, 0.3 * ErrorOf("best"));
  EXPECT_LT(Row(result, "fast").error, Row(result, "fast-halved").error);
}

TEST(ScenePrecision, EverySecondFrameLiesBetween) {
  for (const std::string way : {"fast", "fine", "best"}) {
    EXPECT_GT(ErrorOf(way + "-halved"), 1.1 * ErrorOf(way)) << way;
    EXPECT_LT(ErrorOf(way + "-halved"), 0.5) << way;
  }
}

TEST(ScenePrecision, SleepingIsTheSameForLess) {
  const ScenePrecisionRow &sleep = Row(Tiny(), "fine-sleep"), &awake = Row(Tiny(), "fine");
  EXPECT_EQ(sleep.points_digest, awake.points_digest);
  EXPECT_NE(sleep.points_digest, Row(Tiny(), "best").points_digest);
  EXPECT_EQ(sleep.error, awake.error);
  EXPECT_LT(sleep.simulate_runs, 0.5 * awake.simulate_runs);
  EXPECT_GT(sleep.simulate_runs, 0.0);
}

// Dropped strands move with their neighbours: worse than their own motion, better than none.
TEST(ScenePrecision, LodCarriesWhatItDrops) {
  const ScenePrecisionRow &half = Row(Tiny(), "fine-lod-2"), &quarter = Row(Tiny(), "fine-lod-4");
  EXPECT_NEAR(half.live_share, 0.5, 0.05);
  EXPECT_NEAR(quarter.live_share, 0.25, 0.05);
  EXPECT_EQ(Row(Tiny(), "fine").live_share, 1.0);
  EXPECT_GT(half.error, ErrorOf("fine"));
  EXPECT_GT(quarter.error, half.error);
  // Alone with what lives, the rest rigid, at least sqrt(share dropped) would be wrong.
  EXPECT_LT(half.error, 0.9 * std::sqrt(0.5));
  EXPECT_LT(quarter.error, 0.9 * std::sqrt(0.75));
}

TEST(ScenePrecision, ErrorsAreTheSameOnEveryInstructionSet) {
  ScenePrecisionOptions options = Quick(16);
  options.still_frames = 4;
  const ScenePrecision wide = MeasureScenePrecision(LoadScenario("tiny"), options);
  options.isa = Isa::kReference;
  const ScenePrecision reference = MeasureScenePrecision(LoadScenario("tiny"), options);
  EXPECT_EQ(wide.error_digest, reference.error_digest);
  EXPECT_NE(wide.error_digest, Tiny().error_digest);
}

// Strands that follow chains at vertices are off by that, however exact their chains are.
TEST(ScenePrecision, ChainsAtVerticesAreHeldAgainstOnesOfTheirOwn) {
  EXPECT_TRUE(Tiny().has_vertex_chains);
  EXPECT_GT(Tiny().chain_error, 0.01);
  EXPECT_LT(Tiny().chain_error, 0.1);
  const ScenePrecisionRow &best = Row(Tiny(), "best"), &own = Row(Tiny(), "fine-own-chains");
  EXPECT_GT(best.own_error, best.error);
  EXPECT_NEAR(best.own_error, Tiny().chain_error, best.error);
  EXPECT_EQ(own.own_error, own.error);
  EXPECT_LT(own.own_error, best.own_error);
}

// scene_rod_test.cpp has what rods say; this, that they are asked.
TEST(ScenePrecision, WaysAreHeldAgainstRods) {
  EXPECT_FALSE(Row(Tiny(), "rigid").rod_error || Row(Tiny(), "fine-halved").rod_error);
  const double best = *Row(Tiny(), "best").rod_error;
  EXPECT_GT(*Row(Tiny(), "pbd").rod_error, 5.0 * best);
  // The layers of `tiny` that have chains at vertices follow those.
  EXPECT_LT(*Row(Tiny(), "fine-own-chains").rod_error, 0.5 * best);
  EXPECT_EQ(Tiny().rods.layers.size(), 8u);
  EXPECT_LT(Tiny().rods.self_error, 0.1 * best);
}

TEST(ScenePrecision, OwnChainsMakeAGroomWithoutVertices) {
  Scenario scenario = LoadScenario("tiny");
  Groom& groom = scenario.grooms[0];
  ASSERT_FALSE(groom.vertex_rest.empty());
  EXPECT_TRUE(GiveOwnChains(groom));
  EXPECT_TRUE(groom.vertex_rest.empty());
  EXPECT_FALSE(GiveOwnChains(groom));
  EXPECT_EQ(FindGroomFault(groom, "tiny"), "");
}

// Of sag-free layers, which way is down at each strand comes from the vertices: about what a bake
// of chains of their own gives, layer by layer.
TEST(ScenePrecision, OwnChainsKnowWhichWayIsDown) {
  const Scenario scenario = LoadScenario("tiny");
  const Character& character = scenario.characters[scenario.actors[0].character];
  const auto layer = [](std::string_view name, std::string_view keys) {
    return "[[layer]]\nname = '" + std::string(name) + "'\ndensity = 20_000\n" + std::string(keys);
  };
  const std::string held = "solver = 'modal'\nsag_free = true\n";
  FurSetup setup = ReadFurSetup(
      layer("own", "chain = 'strand'\nmax_strands = 150\n" + held) +
          layer("coat", "max_strands = 300\n" + held) + layer("shells", "output = 'shells'\n") +
          layer("loose", "max_strands = 200\n") + layer("ruff", "max_strands = 250\n" + held),
      "held", ".");
  const float unit = scenario.grooms[scenario.actors[0].groom].unit_scale;
  const RestGeometry rest = ComputeRestGeometry(character, unit);
  Groom groom = BakeGroom(character, rest, setup, unit);
  ASSERT_FALSE(groom.vertex_down.empty());
  EXPECT_TRUE(GiveOwnChains(groom));
  EXPECT_EQ(FindGroomFault(groom, "held"), "");
  EXPECT_TRUE(groom.vertex_down.empty());
  for (LayerSetup& own : setup.layers)
    if (own.params.output != Output::kShells) own.params.chain = ChainKind::kStrand;
  const Groom baked = BakeGroom(character, rest, setup, unit);
  ASSERT_EQ(groom.strand_down.size(), baked.strand_down.size());
  size_t near = 0, all = 0;
  for (size_t c = 0; c < baked.strand_down.size(); ++c)
    for (uint32_t lane = 0; lane < kStrandsPerChunk; ++lane, ++all) {
      double cosine = 0.0;
      for (int axis = 0; axis < 3; ++axis)
        cosine += double(groom.strand_down[c].down[axis][lane]) *
                  double(baked.strand_down[c].down[axis][lane]);
      near += cosine > 0.95;
    }
  EXPECT_GT(double(near), 0.9 * double(all));
}

ScenePrecisionRow Made(double simulate_ns, double frame_ns, double error, SceneWay way = {}) {
  return {.way = std::move(way), .simulate_ns = simulate_ns, .frame_ns = frame_ns, .error = error};
}

TEST(ScenePrecision, FrontIsWhatNothingCheaperBeats) {
  constexpr SceneTime kSimulate = &ScenePrecisionRow::simulate_ns;
  constexpr SceneTime kFrame = &ScenePrecisionRow::frame_ns;
  ScenePrecision made;
  made.rows = {Made(1.0, 10.0, 1.0),
               Made(2.0, 9.0, 0.5),
               Made(3.0, 11.0, 0.6),
               Made(4.0, 11.0, 0.5),
               Made(5.0, 12.0, 0.1),
               Made(0.5, 1.0, 0.01, {.name = "", .label = "", .solver = Solver::kPbd}),
               Made(0.5, 1.0, 0.01, {.name = "", .label = "", .sleep = true})};
  const std::vector<bool> simulate = {true, true, false, false, true, false, false};
  const std::vector<bool> frame = {false, true, false, false, true, false, false};
  for (size_t i = 0; i < made.rows.size(); ++i) {
    EXPECT_EQ(made.IsParetoOptimal(made.rows[i], kSimulate), simulate[i]) << i;
    EXPECT_EQ(made.IsParetoOptimal(made.rows[i], kFrame), frame[i]) << i;
  }
}

}  // namespace
}  // namespace pelt::accuracy
