// Strands with traits of their own in whole frames: the same bits everywhere, and factors that are those of a layer.
// Limits, drag and what is a lane's own: tests/kernels/traits_test.cpp.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstring>

#include "core/kernels/frame_table.hpp"
#include "platform_sim/local_store.hpp"
#include "tests/jobs/tiny_scene.hpp"

namespace pelt::testing {
namespace {

TEST(Traits, HaveTheSameBitsOnEveryInstructionSetAndInLocalStores) {
  constexpr uint32_t kFrames = 8;
  Scenario scenario = TraitsTiny();
  for (const bool velocities : {false, true}) {
    SceneOptions options = OptionsFor(Isa::kReference);
    options.velocities = velocities;
    const std::vector<uint64_t> expected = RunDigests(scenario, options, kFrames);
    for (const Isa isa : kAllIsas)
      if (FindKernels(isa)) {
        options.isa = isa;
        EXPECT_EQ(RunDigests(scenario, options, kFrames), expected) << IsaName(isa);
      }
    LocalStoreExecutor local(options.plan.local_store_data_bytes);
    EXPECT_EQ(RunDigests(scenario, options, local, kFrames), expected);
    ExpectNoFaults(local);
  }
}

// What is drawn in the last of a few frames, without weather.
std::vector<std::byte> DrawnBy(Scenario scenario) {
  scenario.weather_course = {};
  RunningScenario run(scenario, {});
  for (uint32_t f = 0; f < 12; ++f) RunFrame(run, f);
  std::vector<std::byte> drawn;
  for (const LayerDraw& draw : run.scene().Draws())
    drawn.insert(drawn.end(), draw.vertices.begin(), draw.vertices.end());
  return drawn;
}

// Room for traits alone, and traits that are all the same as the layer's.
TEST(Traits, OfOneLeaveWhatIsDrawn) {
  Scenario roomy = TinyScenario();
  FurSetup setup = LoadSetup("tiny");
  for (LayerSetup& layer : setup.layers) layer.params.traits = true;
  roomy.grooms[roomy.actors[0].groom] = BakeForActor(roomy, setup);
  const std::vector<std::byte> plain = DrawnBy(TinyScenario());
  ASSERT_GT(plain.size(), 10'000u);
  EXPECT_TRUE(DrawnBy(roomy) == plain);
  EXPECT_FALSE(DrawnBy(TraitsTiny()) == plain);
}

TEST(Traits, AreThoseOfTheGroomThatReplacesAnother) {
  Scenario scenario = TraitsTiny(), changed = TraitsTiny();
  Groom& groom = changed.grooms[0];
  for (auto* blocks : {&groom.vertex_traits, &groom.strand_traits})
    for (TraitBlock& own : *blocks)
      for (float& weight : own.weight) weight *= 0.5f;
  RunningScenario run(scenario, {});
  RunFrame(run, 0);
  ASSERT_TRUE(run.scene().ReplaceGrooms(changed.ActorGrooms()));
  const FrameMemory& memory = run.scene().memory();
  const auto expect = [](const TraitBlock* found, const TraitBlock& wanted) {
    EXPECT_EQ(std::memcmp(found, &wanted, sizeof wanted), 0);
  };
  ASSERT_EQ(groom.strand_traits.size(), run.scene().shape().chunk_count);
  for (uint32_t c = 0; c < groom.strand_traits.size(); ++c)
    expect(memory.Of<&Streams::strand_traits>(c), groom.strand_traits[c]);
  size_t next = 0;
  for (uint32_t p = 0; p < run.scene().shape().patch_count; ++p)
    if (const TraitBlock* found = memory.Of<&Streams::vertex_traits>(p))
      expect(found, groom.vertex_traits.at(next++));
  EXPECT_EQ(next, groom.vertex_traits.size());
}

// A layer of every solver and chain with these keys.
Scenario EverySolver(const std::string& keys, const std::string& keys_of_links) {
  std::string text;
  const auto add = [&](const char* solver, const char* chain, int points) {
    text += fmt::format(
        "[[layer]]\nname = '{0} {1} {2}'\nsolver = '{0}'\nchain = '{1}'\npoints = {2}\n"
        "density = 60_000\nmax_strands = 100\nmask = {{ materials = ['body', 'head'] }}\n"
        "length = {{ value = 0.1, randomise = 0.2 }}\nwidth = 0.001\nfrequency = 1\n"
        "clump_controls = 16\n{3}{4}",
        solver, chain, points, keys, std::string_view(solver) == "modal" ? "" : keys_of_links);
  };
  for (const char* solver : {"pbd", "modal"}) {
    add(solver, "vertex", 4);
    add(solver, "strand", 4);
    add(solver, "strand", 5);
  }
  add("modal", "strand", 9);
  add("verlet", "strand", 4);
  add("verlet", "strand", 5);
  return LoadScenario(ScenarioRequest{.scene = "tiny", .setup_texts = {text}});
}

// Of powers of two, to the bit: from keys by grooms to what is drawn. The profile is of every link.
TEST(Traits, FactorsAreThoseOfALayer) {
  const std::string
      halves = "weight = 1\nbounce = 0.25\nclump = 0.25\n",
      half_links = "stiffness = 0.1\nangular_hardness_middle = 0.1\nangular_hardness_end = 0.2\n",
      wholes = "weight = 2\nbounce = 0.5\nclump = 0.5\n",
      whole_links = "stiffness = 0.2\nangular_hardness_middle = 0.2\nangular_hardness_end = 0.4\n",
      scales = "weight_scale = 2\nbounce_scale = 2\nclump_scale = 2\n";
  const std::vector<std::byte> whole = DrawnBy(EverySolver(wholes, whole_links));
  ASSERT_GT(whole.size(), 10'000u);
  EXPECT_TRUE(DrawnBy(EverySolver(halves + scales, half_links + "stiffness_scale = 2\n")) == whole);
  EXPECT_FALSE(DrawnBy(EverySolver(halves, half_links)) == whole);
  EXPECT_FALSE(DrawnBy(EverySolver(halves, half_links + "stiffness_scale = 2\n")) == whole);
  EXPECT_FALSE(DrawnBy(EverySolver(halves + scales, half_links)) == whole);
}

}  // namespace
}  // namespace pelt::testing
