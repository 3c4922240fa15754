// Drawn scenes: they are what their seed says, within the bounds of the schema, and what is planted is found in them.
#include <set>
#include <string>

#include "bench/verify/random_course.hpp"
#include "tests/verify/planting.hpp"

namespace pelt::testing {
namespace {

// What a scene is, and what input it gets in its first frames.
std::string BytesOf(RandomScene& drawn) {
  std::string bytes;
  const auto add = [&](const auto& value) {
    bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  for (const Groom& groom : drawn.scenario.grooms)
    for (const StrandBlock& strands : groom.strands) add(strands.width);
  RunningScenario running(drawn.scenario, {.isa = Isa::kReference});
  for (uint32_t f = 0; f < 5; ++f) {
    const FrameInput input = running.Prepare(f, drawn.skip, drawn.lod);
    add(input.sphere);
    add(input.wind);
    add(input.dt_s);
  }
  return bytes;
}

TEST(RandomScene, IsWhatItsSeedSays) {
  std::set<std::string> all;
  for (const uint64_t seed : {0, 1, 2}) {
    RandomScene drawn = DrawScene(seed), again = DrawScene(seed);
    EXPECT_EQ(drawn.text, again.text);
    EXPECT_TRUE(BytesOf(drawn) == BytesOf(again)) << seed;
    all.insert(BytesOf(drawn));
  }
  EXPECT_EQ(all.size(), 3u);
}

TEST(RandomScene, IsWithinTheBoundsOfTheSchemaAndHasEveryKind) {
  std::set<Solver> solvers;
  std::set<Output> outputs;
  std::set<uint32_t> points;
  std::set<bool> painted, sag_free, friction, distance, chains;
  for (uint64_t seed = 0; seed < 40; ++seed)
    for (const Groom& groom : DrawScene(seed).scenario.grooms)
      for (const GroomLayer& layer : groom.layers) {
        const LayerParams& p = layer.params;
        EXPECT_EQ(FindBadParam(p), "") << seed;
        solvers.insert(p.solver);
        outputs.insert(p.output);
        points.insert(p.points);
        painted.insert(p.painted);
        sag_free.insert(p.sag_free);
        friction.insert(p.friction > 0.0f);
        distance.insert(p.max_distance > 0.0f);
        chains.insert(p.chain == ChainKind::kVertex);
      }
  EXPECT_EQ(solvers.size(), 3u);
  EXPECT_EQ(outputs.size(), 4u);
  EXPECT_EQ(points.size(), 3u);
  for (const auto& both : {painted, sag_free, friction, distance, chains})
    EXPECT_EQ(both.size(), 2u);
}

// Of the roots' normals, in every case but the reference's.
void TurnARoot(const void* params, const Binding* bindings) {
  healthy.run(params, bindings);
  if (auto* roots = healthy.As<RootBlock>(bindings, StreamOf<&Streams::roots>))
    roots->normal[1][0] += 0.25f;
}

TEST(VerifyRandom, NamesSeedStageAndKeysOfWhatIsPlanted) {
  VerifyOptions options;
  options.filter = [](const VerifyCase& c) { return c.isa == BestIsa(); };
  options.tamper = Planting("roots", TurnARoot);
  options.stop_at_failure = true;
  // In scenes with origins of characters a stage before the roots moves what they change.
  uint64_t first = 7;
  while (DrawScene(first).scenario.origins) ++first;
  const VerifyReport report = VerifyRandom(3, first, options);
  ASSERT_FALSE(report.Passed());
  const CheckResult& found = report.checks.back();
  EXPECT_FALSE(found.passed);
  EXPECT_EQ(found.stage, "roots");
  EXPECT_NE(found.reason.find("row normal[1], lane 0"), std::string::npos) << found.reason;
  EXPECT_NE(found.reason.find("; its keys: "), std::string::npos) << found.reason;
  // The same alone, from its own seed.
  const uint64_t seed = first - 1 + report.checks.size();
  EXPECT_EQ(found.section, "seed " + std::to_string(seed));
  const VerifyReport alone = VerifyRandom(1, seed, options);
  ASSERT_EQ(alone.checks.size(), 1u);
  EXPECT_EQ(alone.checks[0].reason, found.reason);
}

}  // namespace
}  // namespace pelt::testing
