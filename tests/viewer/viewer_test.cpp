// What the page's module does, natively: the frames are those of `pelt run`, and what is changed can be taken back.
#include "bench/viewer/viewer.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "bench/viewer/data_views.hpp"
#include "bench/viewer/page_text.hpp"
#include "core/error.hpp"
#include "core/kernels/frame_table.hpp"

namespace pelt {
namespace {

using Json = nlohmann::json;

constexpr uint32_t kFrames = 12;

uint64_t RunFor(Viewer& viewer, uint32_t frames) {
  for (uint32_t f = 0; f < frames; ++f) EXPECT_EQ(viewer.Step(), nullptr);
  return viewer.run_digest();
}

uint64_t NativeDigest(uint32_t frames) { return RunDigests({.scene = "tiny"}, frames).back(); }

TEST(Viewer, RunsTheScenesOwnFrames) {
  Viewer viewer({.scene = "tiny"});
  EXPECT_EQ(RunFor(viewer, kFrames), NativeDigest(kFrames));
  viewer.Restart();
  EXPECT_EQ(RunFor(viewer, kFrames), NativeDigest(kFrames));
}

TEST(Viewer, SettingsOfThePictureChangeNoBit) {
  Viewer viewer({.scene = "tiny"});
  for (const PageEntry& entry : PageEntries())
    if (entry.group == "light") viewer.Set(entry.key, entry.low);
  EXPECT_EQ(RunFor(viewer, kFrames), NativeDigest(kFrames));
}

TEST(Viewer, EverySettingCanBeSetToWhatItIs) {
  Viewer viewer({.scene = "tiny"});
  const Json described = Json::parse(viewer.Describe());
  ASSERT_EQ(described["settings"].size(), PageEntries().size());
  for (const Json& row : described["settings"]) {
    // The wind's direction is two numbers, which go through an angle.
    if (row["group"] == "wind") continue;
    viewer.Set(row["key"].get<std::string>(), row["value"]);
  }
  EXPECT_EQ(RunFor(viewer, kFrames), NativeDigest(kFrames));
}

TEST(Viewer, ReliefTakesThePlaceOfHair) {
  Viewer viewer({.scene = "tiny"});
  for (const double relief : {0.0, 1.0, 2.0, 3.0, 0.0}) {
    viewer.Set("relief", relief);
    EXPECT_EQ(viewer.Step(), nullptr);
    viewer.Look();
    const PictureScene& shown = viewer.Picture(1.0f);
    EXPECT_EQ(shown.bodies[0].relief != nullptr, relief > 0.0);
    EXPECT_EQ(shown.relief.frame >= 0, relief == 2.0);
    EXPECT_EQ(shown.relief.shows_steps, relief == 3.0);
    EXPECT_EQ(std::ranges::all_of(shown.layers, [](const auto& hairs) { return hairs.empty(); }),
              relief > 0.0);
  }
  EXPECT_EQ(viewer.run_digest(), NativeDigest(5));
}

TEST(Viewer, WindTurnsAndKeepsItsSpeed) {
  Viewer viewer({.scene = "tiny"});
  viewer.Set("wind_speed", 3.0);
  viewer.Set("wind_direction", 90.0);
  const Json described = Json::parse(viewer.Describe());
  for (const Json& row : described["settings"]) {
    const bool is_speed = row["key"] == "wind_speed", is_direction = row["key"] == "wind_direction";
    if (is_speed || is_direction) {
      EXPECT_NEAR(row["value"], is_speed ? 3.0 : 90.0, 1e-4);
    }
  }
  EXPECT_NE(RunFor(viewer, kFrames), NativeDigest(kFrames));
}

TEST(Viewer, AKeyChangesBitsAndCanBeTakenBack) {
  Viewer viewer({.scene = "tiny"});
  RunFor(viewer, kFrames);
  const std::string before = viewer.setup_text(0);
  const Json described = Json::parse(viewer.Describe());
  const std::string layer = described["setups"][0]["layers"][0]["name"];
  viewer.ChangeKey(0, layer, "weight", "3.5");
  EXPECT_EQ(viewer.next_frame(), kFrames);
  viewer.Restart();
  EXPECT_NE(RunFor(viewer, kFrames), NativeDigest(kFrames));
  EXPECT_NE(viewer.setup_text(0), before);
  viewer.ReplaceSetup(0, before);
  viewer.Restart();
  EXPECT_EQ(RunFor(viewer, kFrames), NativeDigest(kFrames));
}

TEST(Viewer, ADensityMakesAnotherScene) {
  Viewer viewer({.scene = "tiny"});
  RunFor(viewer, kFrames);
  const uint64_t strands = Json::parse(viewer.Describe())["strands"];
  const std::string layer = Json::parse(viewer.Describe())["setups"][0]["layers"][0]["name"];
  viewer.ChangeKey(0, layer, "max_strands", "7");
  EXPECT_LT(Json::parse(viewer.Describe())["strands"].get<uint64_t>(), strands);
  EXPECT_EQ(viewer.Step(), nullptr);
}

TEST(Viewer, RefusesWhatIsNotThereAndStaysAsItWas) {
  Viewer viewer({.scene = "tiny"});
  const std::string before = viewer.setup_text(0);
  EXPECT_THROW(viewer.Set("nonsense", 1.0), Error);
  EXPECT_THROW(viewer.Set("gravity", 1e9), Error);
  EXPECT_THROW(viewer.Set("gravity", std::nan("")), Error);
  EXPECT_THROW(viewer.ChangeKey(0, "no such layer", "weight", "1.0"), Error);
  const std::string layer = Json::parse(viewer.Describe())["setups"][0]["layers"][0]["name"];
  EXPECT_THROW(viewer.ChangeKey(0, layer, "weight", "99999"), Error);
  EXPECT_THROW(viewer.ReplaceSetup(0, "[[layer]"), Error);
  EXPECT_EQ(viewer.setup_text(0), before);
  EXPECT_EQ(RunFor(viewer, kFrames), NativeDigest(kFrames));
}

TEST(Viewer, PicksWhereTheRayMeetsTheCharacter) {
  Viewer viewer({.scene = "tiny"});
  RunFor(viewer, 1);
  const auto hit = viewer.Pick(viewer.RayAt(0.5, 0.5));
  ASSERT_TRUE(hit);
  EXPECT_LT(glm::length(*hit - glm::vec3(0.0f, 0.6f, 0.0f)), 1.0f);
  EXPECT_FALSE(viewer.Pick(viewer.RayAt(0.001, 0.001)));
}

TEST(Viewer, PaintStaysOnTheStrands) {
  Viewer viewer({.scene = "tiny"});
  RunFor(viewer, 1);
  const auto hit = viewer.Pick(viewer.RayAt(0.5, 0.5));
  ASSERT_TRUE(hit);
  viewer.Set("brush_radius", 0.3);
  viewer.Set("brush_amount", 1.0);
  viewer.Paint(uint32_t(PaintChannel::kMud), *hit);
  RunFor(viewer, 3);
  float most = 0.0f;
  for (const std::vector<Hair>& hairs : viewer.Gather().layers)
    for (const Hair& hair : hairs) most = std::max(most, hair.paint[int(PaintChannel::kMud)]);
  EXPECT_GT(most, 0.5f);
}

TEST(Viewer, ABallThatIsDraggedMovesStrands) {
  Viewer dragged({.scene = "tiny"}), still({.scene = "tiny"});
  for (Viewer* viewer : {&dragged, &still}) RunFor(*viewer, 2);
  const auto hit = dragged.Pick(dragged.RayAt(0.5, 0.5));
  ASSERT_TRUE(hit);
  dragged.Set("sphere_radius", 0.1);
  dragged.MoveSphere(*hit);
  EXPECT_NE(RunFor(dragged, 4), RunFor(still, 4));
}

TEST(Viewer, FurCanBeLeftOutOfThePicture) {
  Viewer viewer({.scene = "tiny"});
  RunFor(viewer, 1);
  viewer.Set("render_fur", 0.0);
  for (const std::vector<Hair>& hairs : viewer.Gather().layers) EXPECT_TRUE(hairs.empty());
}

// Of every strand that is drawn, by number.
std::map<uint32_t, Hair> HairsOf(const PictureScene& shown) {
  std::map<uint32_t, Hair> hairs;
  for (const std::vector<Hair>& layer : shown.layers)
    for (const Hair& hair : layer) hairs[hair.number] = hair;
  return hairs;
}

TEST(Viewer, AKeyGoesOnFromTheStateThatThereIs) {
  Viewer changed({.scene = "tiny"}), left({.scene = "tiny"});
  for (Viewer* viewer : {&changed, &left}) RunFor(*viewer, kFrames);
  const auto before = HairsOf(changed.Gather());
  const Json described = Json::parse(changed.Describe());
  for (const Json& layer : described["setups"][0]["layers"])
    changed.ChangeKey(0, layer["name"].get<std::string>(), "weight", "3.0");
  for (Viewer* viewer : {&changed, &left}) RunFor(*viewer, 1);
  const auto after = HairsOf(changed.Gather()), without = HairsOf(left.Gather());
  float moved = 0.0f, apart = 0.0f;
  for (const auto& [number, hair] : after) {
    const glm::vec3 tip = hair.knot[hair.knots - 1].at;
    if (const auto at = before.find(number); at != before.end())
      moved = std::max(moved, glm::length(tip - at->second.knot[hair.knots - 1].at));
    if (const auto at = without.find(number); at != without.end())
      apart = std::max(apart, glm::length(tip - at->second.knot[hair.knots - 1].at));
  }
  EXPECT_GT(apart, 1e-4f);  // it is felt
  EXPECT_LT(moved, 0.05f);  // and nothing jumps
}

TEST(Viewer, InBetweenIsOnTheWayFromOneFrameToTheNext) {
  Viewer viewer({.scene = "tiny"});
  viewer.Set("frame_rate", 15);
  RunFor(viewer, 4);
  ASSERT_TRUE(viewer.HasInBetween());
  const PictureScene from = viewer.Gather(0.0f), half = viewer.Gather(0.5f), to = viewer.Gather();
  const auto first = HairsOf(from), middle = HairsOf(half), last = HairsOf(to);
  ASSERT_EQ(middle.size(), last.size());
  float moved = 0.0f;
  for (const auto& [number, hair] : middle)
    for (uint32_t k = 0; k < hair.knots; ++k) {
      const glm::vec3 a = first.at(number).knot[k].at, b = last.at(number).knot[k].at;
      EXPECT_LT(glm::length(hair.knot[k].at - (a + b) * 0.5f), 1e-5f);
      moved = std::max(moved, glm::length(b - a));
    }
  EXPECT_GT(moved, 0.005f);
  for (size_t v = 0; v < half.bodies[0].position.size(); ++v)
    EXPECT_LT(glm::length(half.bodies[0].position[v] -
                          (from.bodies[0].position[v] + to.bodies[0].position[v]) * 0.5f),
              1e-5f);
  // What is uploaded is what hairs say.
  for (size_t i = 0; i < half.draws.size(); ++i) {
    const auto curves = half.draws[i].As<CurveRecord>();
    if (half.layers[i].empty() || curves.empty()) continue;
    const float* root = curves[0].curve[0];
    EXPECT_LT(glm::length(half.layers[i][0].knot[0].at - glm::vec3(root[0], root[1], root[2])),
              1e-5f);
  }
  viewer.Set("in_between", 0);
  RunFor(viewer, 1);
  EXPECT_FALSE(viewer.HasInBetween());
}

TEST(Viewer, TheFrameBeforeIsWhereItWas) {
  Viewer viewer({.scene = "tiny"});
  viewer.Set("frame_rate", 15);
  RunFor(viewer, 4);
  const auto before = HairsOf(viewer.Gather());
  RunFor(viewer, 1);
  size_t held = 0;
  for (const auto& [number, hair] : HairsOf(viewer.Gather(0.0f)))
    if (const auto at = before.find(number); at != before.end()) {
      EXPECT_LT(glm::length(hair.knot[hair.knots - 1].at - at->second.knot[hair.knots - 1].at),
                1e-5f);
      ++held;
    }
  EXPECT_GT(held, before.size() / 2);
}

// A line ends where its joint is: the tip of the next joint's line begins there.
TEST(Viewer, JointsAreWhereThePoseHasThem) {
  Viewer viewer({.scene = "tiny"});
  const auto& names = DataViewNames();
  viewer.Set("show", double(std::ranges::find(names, "joints") - names.begin()));
  RunFor(viewer, kFrames);
  const PictureScene shown = viewer.Gather();
  uint32_t met = 0;
  for (const std::vector<Hair>& lines : shown.layers)
    for (const Hair& line : lines)
      met += std::ranges::any_of(
          lines, [&](const Hair& other) { return other.root == line.knot[line.knots - 1].at; });
  EXPECT_GT(met, 10u);
  const Json described = Json::parse(viewer.Describe());
  ASSERT_GT(described["joints"].size(), 10u);
  EXPECT_EQ(described["joints"][0]["colour"].get<std::string>().size(), 7u);
}

TEST(Viewer, EveryViewShowsSomethingElseAndChangesNoBit) {
  Viewer viewer({.scene = "tiny"});
  std::set<std::string> seen;
  for (size_t view = 0; view < DataViews().size(); ++view) {
    viewer.Set("show", double(view));
    if (view == 0) RunFor(viewer, kFrames);
    std::string bytes;
    size_t hairs = 0;
    const PictureScene shown = viewer.Gather();
    for (size_t i = 0; i < shown.draws.size(); ++i) {
      hairs += shown.layers[i].size();
      if (!shown.draws[i].format().OfStrands()) continue;
      EXPECT_EQ(shown.layers[i].size(), shown.draws[i].strand_count);
      const auto vertices = shown.draws[i].vertices.first(
          shown.draws[i].strand_count * size_t(shown.draws[i].format().StrandBytes()));
      bytes.append(reinterpret_cast<const char*>(vertices.data()), vertices.size());
    }
    EXPECT_GT(hairs, 100u) << DataViews()[view].name;
    EXPECT_TRUE(seen.insert(bytes).second) << DataViews()[view].name;
  }
  viewer.Restart();
  EXPECT_EQ(RunFor(viewer, kFrames), NativeDigest(kFrames));
}

TEST(Viewer, OtherKernelsInTheMiddleOfARunChangeNoBit) {
  Viewer viewer({.scene = "tiny"});
  RunFor(viewer, kFrames / 2);
  viewer.Set("kernels", 0);
  const KernelDesc& kernel = viewer.scene().plan().stages.back().kernel;
  EXPECT_EQ(kernel.run, FindKernels(Isa::kReference)->Find(kernel.name)->run);
  EXPECT_EQ(RunFor(viewer, kFrames / 2), NativeDigest(kFrames));
}

TEST(Viewer, AHeldViewKeepsWhatIsDrawn) {
  Viewer viewer({.scene = "tiny"});
  RunFor(viewer, 2);
  viewer.Set("hold_view", 1);
  const uint32_t drawn = viewer.scene().DrawnStrands();
  // From behind, where without it others are drawn.
  viewer.SetCamera(PageCamera{{0.0f, 0.5f, 0.0f}, 3.14, 0.0, 2.0});
  RunFor(viewer, 1);
  const uint32_t held = viewer.scene().DrawnStrands();
  viewer.Set("hold_view", 0);
  RunFor(viewer, 1);
  EXPECT_NEAR(double(held), double(drawn), 0.1 * double(drawn));
  EXPECT_GT(std::abs(double(viewer.scene().DrawnStrands()) - double(held)), 0.02 * double(drawn));
}

// The frame that ran is drawn from elsewhere by one of no time, where the scene is moved, too (frame 20).
TEST(Viewer, TurningBetweenFramesChangesNoBit) {
  constexpr uint32_t kTurned = 26;
  Viewer viewer({.scene = "tiny"});
  for (uint32_t f = 0; f < kTurned; ++f) {
    RunFor(viewer, 1);
    const glm::vec3 root = viewer.Gather().layers.front().front().root;
    viewer.SetCamera(PageCamera{{0.0f, 0.5f, 0.0f}, 3.14, 0.01 * f, 2.0});
    viewer.Look();
    // From behind, other hairs are the farthest.
    EXPECT_NE(viewer.Gather().layers.front().front().root, root) << f;
    viewer.SetCamera(std::nullopt);
    viewer.Look();
  }
  EXPECT_EQ(viewer.next_frame(), kTurned);
  EXPECT_EQ(viewer.run_digest(), NativeDigest(kTurned));
}

TEST(Viewer, APictureIsGatheredAgainWhereMoreThanCameraAndLightChanged) {
  Viewer viewer({.scene = "tiny"});
  RunFor(viewer, 2);
  const auto content = [&] {
    viewer.Look();
    return viewer.Picture(1.0f).content;
  };
  const uint64_t first = content();
  const std::vector<glm::vec3> skin = viewer.Picture(1.0f).bodies[0].position;
  EXPECT_EQ(content(), first);
  // Light.
  const glm::vec3 sun = viewer.Picture(1.0f).look.light.sun;
  viewer.Set("sun", 0.5);
  EXPECT_EQ(content(), first);
  EXPECT_EQ(viewer.Picture(1.0f).look.light.sun, 0.5f * sun);
  // A camera without a frame of its own.
  viewer.Set("hold_view", 1);
  const uint64_t held = content();
  EXPECT_NE(held, first);
  viewer.SetCamera(PageCamera{{0.0f, 0.5f, 0.0f}, 3.14, 0.3, 2.0});
  EXPECT_EQ(content(), held);
  EXPECT_LT(viewer.Picture(1.0f).camera.eye[2], 0.0f);
  // With one: other hairs on the same skin.
  viewer.Set("hold_view", 0);
  const uint64_t turned = content();
  EXPECT_NE(turned, held);
  EXPECT_EQ(viewer.Picture(1.0f).bodies[0].position, skin);
  for (const char* key : {"show", "render_fur"}) {
    const uint64_t before = content();
    viewer.Set(key, key == std::string_view("show") ? 1.0 : 0.0);
    EXPECT_NE(content(), before) << key;
  }
  RunFor(viewer, 1);
  EXPECT_NE(content(), turned);
  EXPECT_NE(viewer.Picture(1.0f).bodies[0].position, skin);
  const uint64_t layer_change = content();
  viewer.ChangeKey(0, "vertex", "length", "0.08");
  EXPECT_NE(content(), layer_change);
}

TEST(Viewer, CastHasASetupForEachCharacter) {
  ScenarioRequest request{.scene = "cast"};
  Viewer viewer(request);
  ASSERT_EQ(viewer.setup_count(), 17u);
  const uint64_t native = RunFor(viewer, 2);
  for (size_t s = 0; s < viewer.setup_count(); ++s)
    request.setup_texts.push_back(viewer.setup_text(s));
  EXPECT_EQ(RunDigests(request, 2).back(), native);
  const Json described = Json::parse(viewer.Describe());
  ASSERT_EQ(described["setups"].size(), 17u);
  EXPECT_EQ(described["setups"][16]["layers"].size(), 9u);
  const std::string before = viewer.setup_text(3), other = viewer.setup_text(4);
  viewer.ChangeKey(3, described["setups"][3]["layers"][2]["name"].get<std::string>(), "weight",
                   "3.5");
  EXPECT_NE(viewer.setup_text(3), before);
  EXPECT_EQ(viewer.setup_text(4), other);
  viewer.Restart();
  EXPECT_NE(RunFor(viewer, 2), native);
  // What is copied is a setup for the character that it was read for.
  const Scenario alone = LoadScenario({.setup = "monster", .setup_texts = {before}});
  EXPECT_EQ(alone.grooms[0].layers.size(), 10u);
}

TEST(PageText, HasNoModuleOrIsWhole) {
  const PageContent content{{.scene = "tiny"}, {}, "pelt run", {1, 2}};
  if (EmbeddedModule().empty()) {
    EXPECT_THROW((void)MakePage(content), Error);
    return;
  }
  const std::string page = MakePage(content);
  for (const char* mark : {"@style@", "@module@", "@given@", "@worker@", "@script@"})
    EXPECT_EQ(page.find(mark), page.npos) << mark;
  EXPECT_NE(page.find("0000000000000002"), page.npos);
}

}  // namespace
}  // namespace pelt
