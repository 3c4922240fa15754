// The scene that is verified, threads that flush denormals, and what a finding says.
#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "bench/verify/verified_scene.hpp"
#include "core/groom/groom_file.hpp"
#include "tests/verify/planting.hpp"

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace pelt::testing {
namespace {

TEST(VerifiedScene, HasTwoCharactersThatDiffer) {
  const Scenario verified = MakeVerifiedScene(Tiny());
  ASSERT_EQ(verified.actors.size(), 2u);
  const Groom& first = verified.grooms[verified.actors[0].groom];
  const Groom& second = verified.grooms[verified.actors[1].groom];
  EXPECT_NE(first.layers.size(), second.layers.size());
  EXPECT_NE(first.layers[0].params.solver, second.layers[0].params.solver);
  EXPECT_NE(std::memcmp(&first.skeleton, &second.skeleton, sizeof first.skeleton), 0);
  EXPECT_NE(verified.actors[0].weather_share, verified.actors[1].weather_share);
  EXPECT_EQ(Tiny().actors.size(), 1u) << "the scene itself stays what it is";
}

// What a setup may say at most stays within what a groom may have.
TEST(VerifiedScene, IsOneThatCanBeMade) {
  Scenario heavy = Tiny();
  for (GroomLayer& layer : heavy.grooms[0].layers)
    layer.params.weight = float(LayerParamEntryOf(&LayerParams::weight).high);
  const Scenario verified = MakeVerifiedScene(heavy);
  for (const Groom& groom : verified.grooms) EXPECT_EQ(FindGroomFault(groom, "verified"), "");
  EXPECT_NE(verified.grooms[0].layers.back().params.weight,
            verified.grooms[1].layers[0].params.weight);
}

// A worker that flushes denormals while this stage runs, as an engine's thread might.
#if defined(__SSE__)
void RunFlushing(const void* params, const Binding* bindings) {
  const uint32_t saved = _mm_getcsr();
  _mm_setcsr(saved | 0x8040u);
  healthy.run(params, bindings);
  _mm_setcsr(saved);
}

TEST(VerifyFloats, AWorkerThatFlushesDenormalsIsFound) {
  for (const char* stage : {"sample_pose", "fit_cubic_5", "fit_ribbon_4"}) {
    VerifyOptions options = OneExecutor("pull", 3);
    const auto one = options.filter;
    options.filter = [one](const VerifyCase& c) { return one(c) && c.workers == 2; };
    options.tamper = Planting(stage, RunFlushing);
    const CaseResult result = RunOne(options);
    EXPECT_FALSE(result.passed) << stage;
    EXPECT_EQ(result.stage, stage) << result.reason;
  }
}
#endif

TEST(VerifyFindings, TextAndJsonSayWhatKindItIs) {
  VerifyOptions options = OneExecutor("serial", 2);
  options.tamper = Planting("roots", [](const void* params, const Binding* bindings) {
    healthy.run(params, bindings);
    healthy.As<RootBlock>(bindings, StreamOf<&Streams::roots>)->normal[0][0] += 0.5f;
  });
  const VerifyReport report = Verify(Tiny(), options);
  EXPECT_NE(DescribeReport(report).find("  value: frame 0, stage roots"), std::string::npos)
      << DescribeReport(report);
  const auto json = nlohmann::json::parse(ReportAsJson(report));
  EXPECT_EQ(json["cases"].back()["kind"], "value");
  EXPECT_EQ(json["cases"].back()["stage"], "roots");
  EXPECT_EQ(json["cases"].back()["stream"], "roots");
  EXPECT_EQ(json["cases"][0].count("kind"), 0u);
}

}  // namespace
}  // namespace pelt::testing
