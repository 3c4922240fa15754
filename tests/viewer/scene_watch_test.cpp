// What `pelt view --watch` sees of files that change, and what it reports of them.
#include "bench/viewer/scene_watch.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "tests/groom/png.hpp"
#include "tests/source_folder.hpp"
#include "tests/test_folder.hpp"

namespace pelt {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr uint32_t kWatched = 2;

// A model, a setup for it and the setup's one map.
class SceneWatchTest : public testing::Test {
 protected:
  void SetUp() override {
    fs::copy_file(test::SourceFolder() + "/tests/fuzz/corpus/gltf/builtin.glb", Path("my.glb"));
    Save("map.png", Map(200));
    Save("fur.toml", Setup("density = { value = 4000, map = 'map.png' }"));
  }

  std::string Path(const std::string& name) const { return folder_ / name; }
  void Save(const std::string& name, const std::string& text) { folder_.Save(name, text); }
  // As editors do that never leave half a file.
  void SaveByRename(const std::string& name, const std::string& text) {
    Save(name + ".new", text);
    fs::rename(Path(name + ".new"), Path(name));
  }
  std::string Load(const std::string& name) const { return test::ReadText(Path(name)); }
  static std::string Map(uint8_t grey) {
    const auto png = test::MakePng(2, 1, 1, {grey, grey});
    return {png.begin(), png.end()};
  }
  static std::string Setup(const std::string& line) {
    return "[[layer]]\nname = 'coat'\nmax_strands = 60\n" + line + "\n";
  }
  SceneWatch Watch() {
    ScenarioRequest request;
    request.character = Path("my.glb");
    request.setup = Path("fur.toml");
    SceneWatch scene(request, kWatched);
    while (scene.StepDigest()) {
    }
    EXPECT_EQ(Looks(scene), 0u) << "nothing changed yet";
    return scene;
  }
  // How many of a few looks saw something.
  static uint32_t Looks(SceneWatch& scene, uint32_t looks = 4) {
    uint32_t seen = 0;
    for (uint32_t l = 0; l < looks; ++l) seen += scene.Look();
    return seen;
  }
  static Json Changes(const SceneWatch& scene, uint32_t since) {
    return Json::parse(scene.ChangesSince(since));
  }

  const test::TestFolder folder_;
};

TEST_F(SceneWatchTest, KnowsEveryFileThatTheSetupAndTheModelLeadTo) {
  const SceneWatch scene = Watch();
  EXPECT_EQ(scene.files().size(), 3u);
  for (const char* name : {"my.glb", "fur.toml", "map.png"})
    EXPECT_TRUE(scene.files().contains(Path(name))) << name;
  EXPECT_EQ(scene.digests().size(), kWatched);
  EXPECT_EQ(scene.Content("").files, scene.files());
}

TEST_F(SceneWatchTest, WhatIsWrittenAgainAsItWasIsNoChange) {
  SceneWatch scene = Watch();
  SaveByRename("fur.toml", Load("fur.toml"));
  Save("map.png", Load("map.png"));
  fs::last_write_time(Path("my.glb"), fs::file_time_type::clock::now());
  EXPECT_EQ(Looks(scene), 0u);
  EXPECT_EQ(scene.version(), 0u);
  EXPECT_FALSE(Changes(scene, 0).contains("files"));
}

TEST_F(SceneWatchTest, ASetupThatIsSavedIsToldOnceWithItsTextAndThenItsDigests) {
  SceneWatch scene = Watch();
  const std::vector<uint64_t> before = scene.digests();
  const std::string text = Setup("density = 3000\nlength = 0.2");
  SaveByRename("fur.toml", text);
  EXPECT_FALSE(scene.Look()) << "it may still be written";
  EXPECT_TRUE(scene.Look());
  EXPECT_EQ(Looks(scene), 0u);
  EXPECT_EQ(scene.changed(), std::vector<std::string>{Path("fur.toml")});
  EXPECT_EQ(scene.files().size(), 2u) << "the map is not its any more";

  const uint32_t version = scene.version();
  const Json changes = Changes(scene, 0);
  EXPECT_EQ(changes["version"], version);
  EXPECT_EQ(changes["setup"], text);
  EXPECT_EQ(changes["files"].size(), 1u);
  EXPECT_EQ(changes["digests"], Json::array());
  while (scene.StepDigest()) {
  }
  ASSERT_EQ(scene.digests().size(), kWatched);
  EXPECT_NE(scene.digests(), before);
  EXPECT_EQ(Changes(scene, version)["digests"].size(), kWatched);
  EXPECT_FALSE(Changes(scene, version).contains("files"));
  EXPECT_FALSE(Changes(scene, scene.version()).contains("digests"));
}

TEST_F(SceneWatchTest, AMapOrAModelThatIsSavedIsToldWithoutTheSetup) {
  SceneWatch scene = Watch();
  const std::vector<uint64_t> before = scene.digests();
  Save("map.png", Map(20));
  EXPECT_EQ(Looks(scene), 1u);
  Json changes = Changes(scene, 0);
  EXPECT_TRUE(changes["files"].contains(Path("map.png")));
  EXPECT_EQ(changes["files"].size(), 1u);
  EXPECT_FALSE(changes.contains("setup"));
  while (scene.StepDigest()) {
  }
  EXPECT_NE(scene.digests(), before) << "there is less fur";

  const uint32_t version = scene.version();
  std::string model = Load("my.glb");
  const size_t name = model.find("\"name\":\"");
  ASSERT_NE(name, model.npos);
  model[name + 8] = 'Q';
  SaveByRename("my.glb", model);
  EXPECT_EQ(Looks(scene), 1u);
  changes = Changes(scene, version);
  EXPECT_EQ(changes["files"].size(), 1u);
  EXPECT_EQ(changes["files"][Path("my.glb")], Base64(AsBytes(model)));
  EXPECT_EQ(Changes(scene, 0)["files"].size(), 2u) << "for a page that missed one";
}

TEST_F(SceneWatchTest, AMistypedKeyIsToldWithItsLineAndTheLastSceneStays) {
  SceneWatch scene = Watch();
  const FileBytes before = scene.files();
  const std::string good = Load("fur.toml");
  Save("fur.toml", Setup("lenght = 0.1"));
  EXPECT_EQ(Looks(scene), 1u);
  EXPECT_NE(scene.error().find("fur.toml:4: "), std::string::npos) << scene.error();
  EXPECT_NE(scene.error().find("length"), std::string::npos) << scene.error();
  EXPECT_EQ(Changes(scene, 0)["error"], scene.error());
  EXPECT_FALSE(Changes(scene, 0).contains("files"));
  EXPECT_EQ(scene.files(), before);
  EXPECT_EQ(Looks(scene, 12), 0u) << "it is reported once";

  SaveByRename("fur.toml", good);
  EXPECT_EQ(Looks(scene), 1u);
  EXPECT_EQ(Changes(scene, 0)["error"], "");
  EXPECT_TRUE(scene.changed().empty());
}

TEST_F(SceneWatchTest, HalfAFileHealsWhenTheRestIsThere) {
  SceneWatch scene = Watch();
  for (const char* name : {"my.glb", "map.png"}) {
    const std::string whole = Load(name);
    Save(name, whole.substr(0, whole.size() / 2));
    EXPECT_EQ(Looks(scene), 1u) << name;
    EXPECT_NE(scene.error().find(name), std::string::npos) << scene.error();
    Save(name, whole);
    EXPECT_EQ(Looks(scene), 1u) << name;
    EXPECT_EQ(scene.error(), "");
    fs::remove(Path(name));
    EXPECT_EQ(Looks(scene), 1u) << name;
    EXPECT_NE(scene.error().find("no such file"), std::string::npos) << scene.error();
    Save(name, whole);
    EXPECT_EQ(Looks(scene), 1u) << name;
    EXPECT_EQ(scene.error(), "");
  }
}

TEST_F(SceneWatchTest, AFileThatIsStillWrittenToIsLeftAlone) {
  SceneWatch scene = Watch();
  std::string text = Setup("density = 3000");
  for (int l = 0; l < 6; ++l) {
    Save("fur.toml", text += "# more\n");
    EXPECT_FALSE(scene.Look());
  }
  EXPECT_EQ(Looks(scene), 1u);
  EXPECT_EQ(Changes(scene, 0)["setup"], text);
}

TEST_F(SceneWatchTest, AMapThatComesAfterTheSetupThatNamesItIsFound) {
  SceneWatch scene = Watch();
  Save("fur.toml", Setup("density = { value = 4000, map = 'later.png' }"));
  EXPECT_EQ(Looks(scene), 1u);
  EXPECT_NE(scene.error().find("later.png"), std::string::npos) << scene.error();
  Save("later.png", Map(100));
  EXPECT_EQ(Looks(scene, 12), 1u);
  EXPECT_EQ(scene.error(), "");
  EXPECT_TRUE(Changes(scene, 0)["files"].contains(Path("later.png")));
}

TEST(SceneWatch, ASceneThatIsAllBuiltInHasNoFile) {
  const SceneWatch scene({.scene = "tiny"}, 1);
  EXPECT_TRUE(scene.files().empty());
  EXPECT_THROW(SceneWatch({.setup = "no/such.toml"}, 1), Error);
}

}  // namespace
}  // namespace pelt
