// What an artist does with the pointer, natively: comb vectors on the skin, and maps that bake.
#include "bench/viewer/groom_tools.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/groom/groom_file.hpp"
#include "tests/test_folder.hpp"

namespace pelt {
namespace {

using Json = nlohmann::json;
using Part = GroomTools::CombPart;

constexpr std::string_view kCoat =
    "[[layer]]\nname = \"coat\"\nmask = { materials = [\"body\"] }\ndensity = 4000\n";

ScenarioRequest CoatRequest() { return {.setup = "monster", .setup_texts = {std::string(kCoat)}}; }

struct Studio {
  Viewer viewer{CoatRequest()};
  GroomTools tools{viewer};

  Studio() {
    EXPECT_EQ(viewer.Step(), nullptr);
    EXPECT_GT(Json::parse(viewer.LastFrame())["layer_ns"][0]["coat"].get<double>(), 0.0);
  }
  uint64_t DigestOfRun() {
    viewer.Restart();
    for (int f = 0; f < 3; ++f) EXPECT_EQ(viewer.Step(), nullptr);
    return viewer.run_digest();
  }
  Json Move(const Json& comb, Part part, double x, double y, double lift) {
    return Json::parse(tools.MoveComb(0, comb.dump(), part, x, y, lift));
  }
};

TEST(GroomTools, ACombVectorFollowsThePointerAndCombs) {
  Studio studio;
  const Json fresh = {{"position", {0, 0, 0}}, {"direction", {0, -1, 0}}, {"reach", 0.1}};
  EXPECT_TRUE(studio.Move(fresh, Part::kRoot, 0.01, 0.01, 20.0).is_null());
  const Json root = studio.Move(fresh, Part::kRoot, 0.5, 0.5, 20.0);
  ASSERT_FALSE(root.is_null());
  for (size_t c = 0; c < 2; ++c) EXPECT_NEAR(root["root"][c].get<double>(), 0.5, 0.02);
  EXPECT_NEAR(root["lift"].get<double>(), 20.0, 0.1);
  EXPECT_TRUE(root["faces"].get<bool>());
  const Json tip = studio.Move(root, Part::kTip, 0.5, 0.62, 30.0);
  EXPECT_EQ(tip["position"], root["position"]);
  EXPECT_GT(tip["tip"][1].get<double>(), tip["root"][1].get<double>() + 0.05);
  EXPECT_NEAR(tip["lift"].get<double>(), 30.0, 0.1);
  EXPECT_GT(tip["reach"].get<double>(), 0.1);
  EXPECT_GT(tip["ring"].get<double>(), 0.05);

  EXPECT_EQ(studio.tools.DescribeCombs(0, "coat"), "[]");
  EXPECT_EQ(studio.tools.DescribeCombs(0, "no such layer"), "[]");
  const uint64_t bare = studio.DigestOfRun();
  studio.viewer.ChangeKey(
      0, "coat", "comb",
      fmt::format("[{{ position = {}, direction = {}, reach = {} }}]", tip["position"].dump(),
                  tip["direction"].dump(), tip["reach"].dump()));
  EXPECT_NE(studio.DigestOfRun(), bare);
  const Json shown = Json::parse(studio.tools.DescribeCombs(0, "coat"));
  ASSERT_EQ(shown.size(), 1u);
  EXPECT_EQ(shown[0]["position"], tip["position"]);
}

TEST(GroomTools, AMapIsPaintedAndBakes) {
  Studio studio;
  const auto strands = [&] {
    return Json::parse(studio.viewer.Describe())["strands"].get<uint64_t>();
  };
  const uint64_t before = strands();
  EXPECT_EQ(studio.tools.PaintMap({0.5, 0.5}, {0.5, 0.5}, 0.1, 0.5, 1.0), 0.0);  // none was begun
  ASSERT_EQ(studio.tools.BeginMap(0, "coat", "mask.bald", 128, 0.0), "");
  EXPECT_GT(studio.tools.PaintMap({0.47, 0.5}, {0.53, 0.55}, 0.1, 0.5, 1.0), 0.02);
  EXPECT_EQ(studio.tools.PaintMap({0.01, 0.01}, {0.01, 0.02}, 0.1, 0.5, 1.0), 0.0);
  const std::string png = studio.tools.MapPng();
  const test::TestFolder folder;
  const std::string path = folder.Save("bald.png", std::string_view(png));
  studio.tools.TakeMap(0, "coat", "mask.bald", path);
  EXPECT_LT(strands(), before);
  EXPECT_GT(strands(), before / 4);
  EXPECT_NE(studio.viewer.setup_text(0).find(path), std::string::npos);
  // What was painted is what is painted on.
  ASSERT_EQ(studio.tools.BeginMap(0, "coat", "mask.bald", 128, 0.0), "");
  EXPECT_EQ(studio.tools.MapPng(), png);

  const Json files = Json::parse(studio.tools.DescribeFiles(0));
  EXPECT_EQ(files["file"], "monster.toml");
  ASSERT_EQ(files["maps"].size(), 1u);
  EXPECT_EQ(files["maps"][0]["path"], path);
  ScenarioRequest saved = CoatRequest();
  saved.setup_texts = {studio.viewer.setup_text(0)};
  const auto bytes = WriteGroom(LoadScenario(saved).grooms[0]).OrThrow();
  EXPECT_EQ(files["digest"], fmt::format("{:016x}", HashGroomBytes(bytes)));
}

TEST(GroomTools, WhatCannotBePaintedIsReported) {
  Studio studio;
  const auto reason = [&](std::string_view layer, std::string_view key, uint32_t side) {
    return studio.tools.BeginMap(0, layer, key, side, 1.0);
  };
  EXPECT_EQ(reason("coat", "length", 64), "");
  EXPECT_EQ(reason("tail", "length", 64), "there is no layer 'tail' to paint on");
  EXPECT_EQ(reason("coat", "stiffness", 64), "layer 'coat': key 'stiffness' takes no map");
  EXPECT_EQ(reason("coat", "length", 32), "a map of 32 texels a side; 64 to 1024 are painted");
}

}  // namespace
}  // namespace pelt
