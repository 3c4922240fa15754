// The scenarios are what they say, the same every time, and refuse what does not fit together.
#include "bench/scenarios/scenarios.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "bench/scenarios/embedded_files.hpp"
#include "bench/scenarios/made_scenes.hpp"
#include "core/character/builtin_character.hpp"
#include "core/kernels/frame_table.hpp"
#include "jobs/frame.hpp"
#include "tests/error_from.hpp"
#include "tests/jobs/tiny_scene.hpp"
#include "tests/test_folder.hpp"

namespace pelt {
namespace {

std::string LoadError(const ScenarioRequest& request) {
  return test::ErrorFrom([&] { LoadScenario(request); });
}

uint64_t DigestAfter(Scenario& scenario, uint32_t frames, const SceneOptions& options = {}) {
  RunningScenario running(scenario, options);
  for (uint32_t f = 0; f < frames; ++f) testing::RunFrame(running, f);
  return running.scene().DigestFrame();
}

TEST(Scenarios, MonsterHasItsRegionsAndStrands) {
  const Scenario monster = LoadScenario("monster");
  std::set<std::string> names;
  for (const GroomLayer& layer : monster.grooms[0].layers) names.insert(layer.name);
  EXPECT_EQ(names, (std::set<std::string>{"head", "brows", "body", "arms", "tail"}));
  EXPECT_GE(monster.StrandCount(), 38'000u);
  EXPECT_LE(monster.StrandCount(), 42'000u);
}

TEST(Scenarios, CastIsWhatTheOriginalShipped) {
  const Scenario cast = LoadScenario("cast");
  EXPECT_EQ(cast.actors.size(), kCastCharacters);
  EXPECT_GT(cast.StrandCount(), 100'000u);
  size_t layers = 0;
  std::set<float> heights;  // 17 different characters, not one repeated
  for (const Actor& actor : cast.actors) {
    layers += cast.grooms[actor.groom].layers.size();
    float height = 0.0f;
    for (const glm::vec3& p : cast.characters[actor.character].mesh.position)
      height = std::max(height, p.y);
    heights.insert(height);
  }
  EXPECT_EQ(layers, kCastLayers);
  EXPECT_EQ(heights.size(), kCastCharacters);
}

// Before a camera, with level of detail even if not asked for; no character's clip jumps.
TEST(Scenarios, StageIsWhatTheOriginalDrew) {
  Scenario stage = LoadScenario("stage");
  ASSERT_EQ(stage.actors.size(), kStageCharacters);
  EXPECT_GT(stage.StrandCount(), 33'000u);
  EXPECT_LT(stage.StrandCount(), 40'000u);
  std::set<std::string> clips;
  for (const Actor& actor : stage.actors) {
    EXPECT_EQ(stage.grooms[actor.groom].layers.size(), 10u);
    EXPECT_FALSE(actor.jumps);
    clips.insert(stage.characters[actor.character].clips.at(size_t(actor.clip)).name);
  }
  EXPECT_EQ(clips, (std::set<std::string>{"greet", "walk"}));
  RunningScenario running(stage, {});
  SerialExecutor serial;
  for (uint32_t f = 0; f < stage.default_frames; f += stage.default_frames / 4) {
    const FrameInput input = running.Prepare(f, SkipSettings{}, LodSettings{});
    ASSERT_EQ(running.scene().BeginFrame(input), nullptr);
    serial.Run(running.scene().CurrentFrame());
    EXPECT_LT(running.scene().LiveStrands(), stage.StrandCount()) << f;
    for (const Actor& actor : stage.actors) {
      float square = 0.0f;
      for (int axis = 0; axis < 3; ++axis) {
        const float middle = actor.placement[3][axis] + (axis == 1 ? 0.5f : 0.0f);
        const float apart = middle - input.camera.eye[axis];
        square += apart * apart;
      }
      EXPECT_GT(square, 3.8f * 3.8f) << f;
      EXPECT_LT(square, 5.4f * 5.4f) << f;
    }
  }
}

TEST(Scenarios, ThePublishedLookOfShellsIsASetup) {
  const ScenarioRequest request{.character = "scorpion", .setup = "furry_scorpion"};
  const LayerParams params = LoadScenario(request).grooms.at(0).layers.at(0).params;
  EXPECT_EQ(params.output, Output::kShells);
  EXPECT_EQ(params.cone_kind, ConeKind::kPublished);
  EXPECT_EQ(LoadSetup("furry_scorpion").layers.at(0).length.value, 0.2f);
  const std::vector<uint8_t> texture = MakeFurTexture(params);
  ASSERT_EQ(texture.size(), 128u * 128u);
  const auto bare = double(std::ranges::count(texture, uint8_t{0}));
  EXPECT_NEAR(bare / double(texture.size()), std::exp(-0.2), 0.01);
}

TEST(Scenarios, EyePetHasFivePointChainsInRibbonsOverShells) {
  const Scenario eyepet = LoadScenario("eyepet");
  EXPECT_TRUE(eyepet.base.use_ground);
  const std::vector<GroomLayer>& layers = eyepet.grooms[0].layers;
  ASSERT_EQ(layers.size(), 2u);
  EXPECT_EQ(layers[0].strand_count, 8'000u);
  EXPECT_EQ(layers[0].params.points, 5u);
  EXPECT_EQ(layers[0].params.output, Output::kRibbons);
  EXPECT_GT(layers[0].params.clump, 0.0f);
  EXPECT_EQ(layers[1].params.output, Output::kShells);
}

// Frames of ten seconds in which the pose is torn from where it was. Idle takes a minute and ends in
// another stand than it begins in.
std::set<uint32_t> TeleportsOf(const ScenarioRequest& request) {
  Scenario scenario = LoadScenario(request);
  scenario.dt_s = 10.0;
  scenario.actors[0].teleport_frame = -1;
  RunningScenario running(scenario, {});
  std::set<uint32_t> frames;
  for (uint32_t f = 0; f < 14; ++f) {
    scenario.PrepareFrame(f, running.scene());
    if (running.scene().Pose(0).teleported) frames.insert(f);
  }
  return frames;
}

TEST(Scenarios, FurStartsAnewWhereAClipJumps) {
  EXPECT_EQ(TeleportsOf({.scene = "tiny", .clip = "idle"}), (std::set<uint32_t>{6, 12}));
  EXPECT_EQ(TeleportsOf({.scene = "tiny", .clip = "idle", .once = true}), std::set<uint32_t>{});
  EXPECT_EQ(TeleportsOf({.scene = "tiny", .clip = "walk"}), std::set<uint32_t>{});
  EXPECT_EQ(TeleportsOf({.scene = "tiny"}), std::set<uint32_t>{});
}

TEST(Scenarios, PlayTheClipThatIsAskedFor) {
  const Scenario tiny = LoadScenario(ScenarioRequest{.scene = "tiny", .clip = "shake"});
  EXPECT_EQ(tiny.characters[0].clips[size_t(tiny.actors[0].clip)].name, "shake");
  const std::string error = LoadError({.scene = "tiny", .clip = "fly"});
  EXPECT_NE(error.find("no clip 'fly'"), std::string::npos) << error;
  EXPECT_NE(error.find("walk, idle, shake"), std::string::npos) << error;
}

// What a user gets, and what the originals did. Shells have chains at vertices, for which no Verlet is.
TEST(Scenarios, AreModalUnlessToldOtherwise) {
  const auto solvers = [](const ScenarioRequest& request) {
    std::set<Solver> found;
    for (const Groom& groom : LoadScenario(request).grooms)
      for (const GroomLayer& layer : groom.layers)
        if (layer.params.output != Output::kShells) found.insert(layer.params.solver);
    return found;
  };
  const std::pair<const char*, Solver> originals[] = {
      {"monster", Solver::kPbd}, {"cast", Solver::kPbd}, {"eyepet", Solver::kVerlet}};
  for (const auto& [scene, original] : originals) {
    EXPECT_EQ(solvers({.scene = scene}), std::set{Solver::kModal}) << scene;
    EXPECT_EQ(solvers({.scene = scene, .solver = original}), std::set{original}) << scene;
  }
  for (const std::string_view setup : NamesOf(EmbeddedSetups())) {
    if (setup == "tiny" || setup == "everything") continue;  // they have every solver
    for (const LayerSetup& layer : LoadSetup(std::string(setup)).layers)
      EXPECT_EQ(layer.params.solver, Solver::kModal) << setup << ' ' << layer.name;
  }
}

TEST(Scenarios, TinyHasEverySolverChainAndOutput) {
  Scenario tiny = LoadScenario("tiny");
  EXPECT_LT(tiny.StrandCount(), 2'000u);
  std::set<Solver> solvers;
  std::set<ChainKind> chains;
  std::set<Output> outputs;
  std::set<uint32_t> points;
  for (const GroomLayer& layer : tiny.grooms[0].layers) {
    solvers.insert(layer.params.solver);
    chains.insert(layer.params.chain);
    outputs.insert(layer.params.output);
    points.insert(layer.params.points);
  }
  EXPECT_EQ(solvers.size(), 3u);
  EXPECT_EQ(chains.size(), 2u);
  EXPECT_EQ(outputs.size(), 2u);
  EXPECT_EQ(points.size(), 2u);
  EXPECT_GE(tiny.actors[0].teleport_frame, 0);
  EXPECT_FALSE(tiny.spheres.empty());
}

std::set<std::string_view> KernelsThatRun(Scenario tiny) {
  std::set<std::string_view> ran;
  for (const VertexOrder order : {VertexOrder::kSorted, VertexOrder::kIndexBuffer})
    for (const uint32_t other : {0u, 1u}) {
      tiny.origins = other != 0;
      RunningScenario running(
          tiny, {.vertex_order = order, .piecewise_sort_chunks = other, .velocities = other != 0});
      for (const uint32_t frame : {0u, 1u}) {  // an origin moves from the second frame on
        testing::RunFrame(running, frame);
        for (const Stage& stage : running.scene().plan().stages)
          for (uint32_t i = 0; i < running.scene().shape().ItemCount(stage.domain); ++i)
            if (IsWanted(stage, running.scene().memory(), i)) ran.insert(stage.kernel.name);
      }
    }
  return ran;
}

TEST(Scenarios, TinyRunsEveryKernelThereIs) {
  std::set<std::string_view> ran = KernelsThatRun(LoadScenario("tiny"));
  ran.merge(KernelsThatRun(testing::SagFreeTiny()));
  ran.merge(KernelsThatRun(testing::EveryOutputScenario()));
  ran.merge(KernelsThatRun(testing::TraitsTiny()));
  for (const FrameEntry& entry : FindKernels(Isa::kReference)->entries)
    EXPECT_TRUE(ran.count(entry.kernel.name)) << entry.kernel.name;
}

// A setup of the test's own, for the built-in character.
Scenario LoadText(const std::string& text) {
  return LoadScenario(ScenarioRequest{.setup = test::TestFile(text)});
}

TEST(Scenarios, ASetupsLightsAreThoseOfItsScene) {
  const std::string layer = "[[layer]]\nname = 'x'\nmax_strands = 32\n";
  const std::string lights = "[lights.sun]\ncolour = [3, 2, 1]\n";
  const Scenario lit = LoadText(layer + "lit = true\n" + lights);
  EXPECT_EQ(lit.base.lighting.sun_rgb[0], 3.0f);
  EXPECT_EQ(lit.base.lighting.light_count, 0u);
  const auto has_lights = [](const Scenario& scenario) {
    for (const std::string& note : scenario.notes)
      if (note.find("light no layer") != std::string::npos) return true;
    return false;
  };
  EXPECT_FALSE(has_lights(lit));
  EXPECT_TRUE(has_lights(LoadText(layer + lights)));
  // A studio's, if it says nothing; none where nothing is lit.
  EXPECT_GT(LoadText(layer + "lit = true\n").base.lighting.light_count, 0u);
  EXPECT_EQ(LoadText(layer).base.lighting.light_count, 0u);
}

// Its layers are as bare as they are meant to be; the same in a setup of the user is reported.
TEST(Scenarios, OwnScenesSayNothingOfThemselves) {
  for (const std::string_view name : ScenarioNames())
    EXPECT_TRUE(LoadScenario(std::string(name)).notes.empty()) << name;
  EXPECT_TRUE(LoadScenario(ScenarioRequest{.setup = "tiny"}).notes.empty());
  const auto bald = [](const Scenario& scenario) {
    size_t count = 0;
    for (const std::string& note : scenario.notes) count += note.find("is bald") != note.npos;
    return count;
  };
  const std::string text = SetupText("tiny");
  EXPECT_EQ(bald(LoadText(text)), 9u);
  EXPECT_EQ(bald(LoadScenario(ScenarioRequest{.scene = "tiny", .setup_texts = {text}})), 9u);
}

Scenario CastLitBy(const std::string& lights) {
  return LoadScenario({.scene = "cast", .lights = lights});
}

// Of characters whose setups say nothing of light, and in front of those whose do.
TEST(Scenarios, LightsOfOnesOwnReachEveryLayer) {
  Scenario cast = CastLitBy(test::TestFile("[[lights.light]]\nposition = [0, 2, 3]\n"));
  RunningScenario running(cast, {});
  testing::RunFrame(running, 0);
  const FrameMemory& memory = running.scene().memory();
  ASSERT_EQ(running.scene().shape().layer_count, kCastLayers);
  for (uint32_t l = 0; l < kCastLayers; ++l) {
    ASSERT_TRUE(running.scene().shape().layer_kind[l] & kLayerLit) << l;
    EXPECT_GT(memory.Of<&Streams::layer_light>(l)->harmonics[0][0], 0.0f) << l;
  }
  const std::string setup =
      test::TestFile("[lights.sun]\ncolour = [3, 2, 1]\n[[layer]]\nname = 'x'\nmax_strands = 32\n");
  const Scenario other = LoadScenario({.setup = setup, .lights = "lamps"});
  EXPECT_EQ(other.base.lighting.sun_rgb[0], 1.0f);
  EXPECT_TRUE(other.grooms[0].layers[0].params.lit);
  const Scenario shells = LoadScenario({.scene = "scorpion", .lights = setup});
  EXPECT_EQ(shells.base.lighting.sun_rgb[0], 3.0f);
  for (const GroomLayer& layer : shells.grooms[0].layers) EXPECT_TRUE(layer.params.lit);
}

TEST(Scenarios, EveryBuiltInLightLights) {
  for (const EmbeddedFile& file : EmbeddedLights()) {
    const Scenario lit = LoadScenario({.scene = "tiny", .lights = std::string(file.name)});
    EXPECT_GT(lit.base.lighting.light_count, 0u) << file.name;
  }
}

TEST(Scenarios, MistakesInLightsAreTold) {
  const auto error_of = [](const std::string& lights) {
    return LoadError({.scene = "tiny", .lights = lights});
  };
  EXPECT_NE(error_of("lamp").find("no built-in lights 'lamp' (there are: lamps, night)"),
            std::string::npos);
  EXPECT_NE(error_of("no/such.toml").find("no/such.toml"), std::string::npos);
  EXPECT_NE(
      error_of(test::TestFile("[[layer]]\nname = 'x'\n")).find(":1: there is no [lights] in it"),
      std::string::npos);
  EXPECT_NE(
      error_of(test::TestFile("\n[lights.sun]\ncolour = 3\n")).find(":3: key 'lights.sun.colour'"),
      std::string::npos);
  for (const char* black : {"[lights]\n", "[lights.sun]\ncolour = [0, 0, 0]\n",
                            "[[lights.light]]\nposition = [0, 1, 0]\ncolour = [0, 0, 0]\n",
                            "[[lights.sample]]\nposition = [0, 1, 0]\n"})
    EXPECT_NE(error_of(test::TestFile(black)).find("all of its [lights] are black"),
              std::string::npos)
        << black;
}

// In its first frame, and it stays.
TEST(Scenarios, PaintAllPaintsEveryStrandOnce) {
  Scenario scenario = LoadScenario("tiny");
  PaintAmounts amounts{};
  amounts[size_t(PaintChannel::kMud)] = 0.4f;
  amounts[size_t(PaintChannel::kDust)] = 1.0f;
  PaintAll(scenario, amounts);
  RunningScenario running(scenario, {});
  for (uint32_t f = 0; f < 3; ++f) {
    testing::RunFrame(running, f);
    const FrameMemory& memory = running.scene().memory();
    for (uint32_t c = 0; c < running.scene().shape().chunk_count; ++c)
      for (uint32_t s = 0; s < memory.Of<&Streams::chunk_state>(c)->live_strands; ++s)
        ASSERT_EQ(memory.Of<&Streams::paint>(c)->amounts[s], 255u << 24 | 102u) << f;
  }
}

TEST(Scenarios, SameScenarioTwiceGivesTheSameBits) {
  Scenario first = LoadScenario("tiny"), second = LoadScenario("tiny");
  EXPECT_EQ(DigestAfter(first, 12), DigestAfter(second, 12));
}

TEST(Scenarios, InputOfAFrameDoesNotDependOnFramesBefore) {
  Scenario scenario = LoadScenario("tiny");
  RunningScenario a(scenario, {}), b(scenario, {});
  for (uint32_t f = 0; f < 25; ++f) testing::RunFrame(a, f);
  a.Begin(25);
  b.Begin(25);
  EXPECT_EQ(std::memcmp(&a.scene().Pose(0), &b.scene().Pose(0), sizeof(PoseBlock)), 0);
}

TEST(Scenarios, SeedsGiveOtherGrooms) {
  Scenario standard = LoadScenario("tiny");
  Scenario other = LoadScenario(ScenarioRequest{.scene = "tiny", .seed = 5});
  EXPECT_NE(DigestAfter(standard, 1), DigestAfter(other, 1));
}

TEST(Scenarios, WetFurDiffersFromDryWithoutAReset) {
  Scenario dry = LoadScenario("tiny"), wet = LoadScenario("tiny");
  dry.weather_course = {};
  wet.weather_course = {1.0f, 1.0f, 5};
  EXPECT_EQ(DigestAfter(dry, 5), DigestAfter(wet, 5));
  EXPECT_NE(DigestAfter(dry, 9), DigestAfter(wet, 9));
}

TEST(Scenarios, UnknownNamesSayWhatThereIs) {
  EXPECT_NE(LoadError({.scene = "monstre"}).find("monster"), std::string::npos);
  EXPECT_NE(LoadError({.setup = "monstre"}).find("eyepet"), std::string::npos);
  EXPECT_NE(LoadError({.character = "no/such.glb", .setup = "tiny"}).find("no/such.glb"),
            std::string::npos);
  EXPECT_NE(LoadError({.groom = "no/such.groom"}).find("no/such.groom"), std::string::npos);
}

TEST(Scenarios, AGroomOfOtherJointsIsRefusedByName) {
  const Scenario tiny = LoadScenario("tiny");
  Groom groom = tiny.grooms[0];
  ASSERT_NO_THROW(CheckGroomFits(groom, "x.groom", tiny.characters[0]));
  groom.joint_names[3] = "rump";
  const std::string text =
      test::ErrorFrom([&] { CheckGroomFits(groom, "x.groom", tiny.characters[0]); });
  EXPECT_NE(text.find("x.groom"), std::string::npos);
  EXPECT_NE(text.find("joint 3"), std::string::npos);
  EXPECT_NE(text.find("'rump'"), std::string::npos);
}

}  // namespace
}  // namespace pelt
