// What the page's module does, natively: the frames are those of `pelt run`, and what is changed can be taken back.
#include "bench/page/viewer.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "bench/page/page_text.hpp"
#include "core/error.hpp"

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
  for (const PageRow& row : PageRows())
    if (row.group == "light") viewer.Set(row.key, row.low);
  EXPECT_EQ(RunFor(viewer, kFrames), NativeDigest(kFrames));
}

TEST(Viewer, EverySettingCanBeSetToWhatItIs) {
  Viewer viewer({.scene = "tiny"});
  const Json described = Json::parse(viewer.Describe());
  ASSERT_EQ(described["settings"].size(), PageRows().size());
  for (const Json& row : described["settings"]) {
    // The wind's direction is two numbers, which go through an angle.
    if (row["group"] == "wind") continue;
    viewer.Set(row["key"].get<std::string>(), row["value"]);
  }
  EXPECT_EQ(RunFor(viewer, kFrames), NativeDigest(kFrames));
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
  const std::string before = viewer.setup_text();
  const Json described = Json::parse(viewer.Describe());
  const std::string layer = described["layers"][0]["name"];
  viewer.ChangeKey(layer, "weight", "3.5");
  EXPECT_EQ(viewer.next_frame(), kFrames);
  viewer.Restart();
  EXPECT_NE(RunFor(viewer, kFrames), NativeDigest(kFrames));
  EXPECT_NE(viewer.setup_text(), before);
  viewer.ReplaceSetup(before);
  viewer.Restart();
  EXPECT_EQ(RunFor(viewer, kFrames), NativeDigest(kFrames));
}

TEST(Viewer, ADensityMakesAnotherScene) {
  Viewer viewer({.scene = "tiny"});
  RunFor(viewer, kFrames);
  const uint64_t strands = Json::parse(viewer.Describe())["strands"];
  const std::string layer = Json::parse(viewer.Describe())["layers"][0]["name"];
  viewer.ChangeKey(layer, "max_strands", "7");
  EXPECT_LT(Json::parse(viewer.Describe())["strands"].get<uint64_t>(), strands);
  EXPECT_EQ(viewer.Step(), nullptr);
}

TEST(Viewer, RefusesWhatIsNotThereAndStaysAsItWas) {
  Viewer viewer({.scene = "tiny"});
  const std::string before = viewer.setup_text();
  EXPECT_THROW(viewer.Set("nonsense", 1.0), Error);
  EXPECT_THROW(viewer.Set("gravity", 1e9), Error);
  EXPECT_THROW(viewer.Set("gravity", std::nan("")), Error);
  EXPECT_THROW(viewer.ChangeKey("no such layer", "weight", "1.0"), Error);
  const std::string layer = Json::parse(viewer.Describe())["layers"][0]["name"];
  EXPECT_THROW(viewer.ChangeKey(layer, "weight", "99999"), Error);
  EXPECT_THROW(viewer.ReplaceSetup("[[layer]"), Error);
  EXPECT_EQ(viewer.setup_text(), before);
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
