// A plan gives the layers that it names their solver and quality, and nothing else; what is wrong with one is reported
// with its line.
#include "bench/scenarios/layer_plan.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "bench/scenarios/scenarios.hpp"
#include "core/groom/groom_file.hpp"
#include "tests/error_from.hpp"
#include "tests/run_frame.hpp"
#include "tests/test_folder.hpp"

namespace pelt {
namespace {

Scenario Planned(const std::string& text) {
  return LoadScenario(ScenarioRequest{.scene = "tiny", .plan = test::TestFile(text)});
}

const LayerParams& ParamsOf(const Scenario& scenario, std::string_view name) {
  return std::ranges::find(scenario.grooms[0].layers, name, &GroomLayer::name)->params;
}

uint64_t DigestOf(Scenario scenario) {
  RunningScenario running(scenario, {});
  for (uint32_t f = 0; f < 4; ++f) testing::RunFrame(running, f);
  return running.scene().DigestFrame();
}

std::string PlanError(const std::string& text) {
  return test::ErrorFrom([&] { Planned(text); });
}

constexpr const char* kTwo = R"([[layer]]
character = 0
name = "strand4"
solver = "modal"
quality = "best"
curl_follows = "root"

[[layer]]
character = 0
name = "modal5"
solver = "verlet"
)";

TEST(LayerPlan, ChangesTheLayersItNames) {
  const Scenario own = LoadScenario("tiny"), planned = Planned(kTwo);
  for (const GroomLayer& layer : own.grooms[0].layers) {
    const LayerParams& params = ParamsOf(planned, layer.name);
    if (layer.name == "strand4") {
      EXPECT_EQ(params.solver, Solver::kModal);
      EXPECT_EQ(params.quality, ModalQuality::kBest);
      EXPECT_EQ(params.curl_follows, CurlFollows::kRoot);
    } else if (layer.name == "modal5") {
      EXPECT_EQ(params.solver, Solver::kVerlet);
      EXPECT_EQ(params.quality, layer.params.quality);
    } else {
      EXPECT_EQ(params.solver, layer.params.solver) << layer.name;
      EXPECT_EQ(params.quality, layer.params.quality) << layer.name;
      EXPECT_EQ(params.curl_follows, layer.params.curl_follows) << layer.name;
    }
  }
}

TEST(LayerPlan, IsReadAsItWasWritten) {
  const std::vector<LayerChoice> plan = {
      {0, "strand4", {Solver::kModal, ModalQuality::kFine, CurlFollows::kParent}},
      {3, "with \"quotes\" and \\", {Solver::kPbd, {}, {}, 0.125f, 0.3f}}};
  const std::vector<LayerChoice> read = ReadLayerPlan(test::TestFile(LayerPlanText(plan)));
  ASSERT_EQ(read.size(), plan.size());
  for (size_t l = 0; l < plan.size(); ++l) {
    EXPECT_EQ(read[l].character, plan[l].character);
    EXPECT_EQ(read[l].name, plan[l].name);
    EXPECT_EQ(read[l].choice, plan[l].choice);
  }
}

// The first strands of each chunk, and nothing else: the groom is one that a file may hold, and runs.
TEST(LayerPlan, KeepsAShareOfTheStrands) {
  const Scenario own = LoadScenario("tiny");
  for (const GroomLayer& layer : own.grooms[0].layers) {
    const Scenario planned =
        Planned("[[layer]]\ncharacter = 0\nname = \"" + layer.name + "\"\nstrand_share = 0.4\n");
    for (const GroomLayer& is : planned.grooms[0].layers) {
      if (is.name != layer.name) {
        const auto was = std::ranges::find(own.grooms[0].layers, is.name, &GroomLayer::name);
        EXPECT_EQ(is.strand_count, was->strand_count) << is.name;
        continue;
      }
      EXPECT_GE(is.strand_count, uint32_t(0.4 * layer.strand_count)) << is.name;
      EXPECT_LT(is.strand_count, layer.strand_count) << is.name;
    }
    EXPECT_EQ(FindGroomFault(planned.grooms[0], "planned"), "") << layer.name;
    EXPECT_NE(DigestOf(planned), DigestOf(own)) << layer.name;
  }
}

TEST(LayerPlan, KeepsAShareOfTheChains) {
  const char* half = "[[layer]]\ncharacter = 0\nname = \"vertex\"\nchain_share = 0.5\n";
  const Scenario planned = Planned(half);
  EXPECT_EQ(ParamsOf(planned, "vertex").chain_share, 0.5f);
  EXPECT_NE(DigestOf(planned), DigestOf(LoadScenario("tiny")));
}

// The frames of a plan are those of --solver that says the same.
TEST(LayerPlan, OfOneSolverIsThatSolver) {
  std::vector<LayerChoice> plan;
  const Scenario tiny = LoadScenario("tiny");
  for (const GroomLayer& layer : tiny.grooms[0].layers)
    plan.push_back({0, layer.name, {.solver = Solver::kPbd, .quality = {}, .curl_follows = {}}});
  const uint64_t digest = DigestOf(Planned(LayerPlanText(plan)));
  EXPECT_EQ(digest,
            DigestOf(LoadScenario(ScenarioRequest{.scene = "tiny", .solver = Solver::kPbd})));
  EXPECT_NE(digest, DigestOf(LoadScenario("tiny")));
}

TEST(LayerPlan, TellsWhatIsWrongAndWhere) {
  const auto expect = [](const char* text, const char* place, const char* reason) {
    const std::string error = PlanError(text);
    EXPECT_NE(error.find(place), std::string::npos) << error;
    EXPECT_NE(error.find(reason), std::string::npos) << error;
  };
  expect("[[layer]]\ncharacter = 0\nname = \"stand4\"\n", ".toml:1", "did you mean 'strand4'");
  expect("\n[[layer]]\ncharacter = 2\nname = \"strand4\"\n", ".toml:2", "no character 2");
  expect("[[layer]]\ncharacter = 0\nname = \"strand4\"\nsolvr = \"pbd\"\n", ".toml:4",
         "did you mean 'solver'");
  expect("[[layer]]\ncharacter = 0\nname = \"strand4\"\nsolver = \"pdb\"\n", ".toml:4", "'pbd'");
  expect("[[layer]]\ncharacter = 0\nname = \"vertex\"\nsolver = \"verlet\"\n", ".toml:1",
         "chain for each strand");
  expect("[[layer]]\ncharacter = 0\nname = \"a\"\nsolver = \"pbd\"\nquality = \"fast\"\n",
         ".toml:1", "solver = \"modal\"");
  expect("[[layer]]\ncharacter = 0\nname = \"a\"\n[[layer]]\ncharacter = 0\nname = \"a\"\n",
         ".toml:4", "twice");
  expect("[[layer]]\ncharacter = 0\nname = \"strand4\"\nchain_share = 0.5\n", ".toml:1",
         "chains at mesh vertices");
  expect("[[layer]]\ncharacter = 0\nname = \"strand4\"\nstrand_share = 0\n", ".toml:4",
         "strand_share");
  expect("[[layer]]\nname = \"strand4\"\n", ".toml:1", "'character'");
  expect("[[layers]]\n", ".toml:1", "[[layer]]");
  expect("", ".toml", "[[layer]]");
  expect("layer = 3\n", ".toml", "[[layer]]");
  expect("[[layer]\n", ".toml:1", "");
  EXPECT_THROW(ReadLayerPlan("nowhere.toml"), Error);
}

}  // namespace
}  // namespace pelt
