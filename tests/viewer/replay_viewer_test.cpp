// A recording on the page: its digests are those that were recorded, wherever the user stands, and what is wrong with
// it is reported.
#include "bench/viewer/replay_viewer.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <nlohmann/json.hpp>

#include "bench/viewer/page_text.hpp"
#include "tests/traces/recordings.hpp"

namespace pelt {
namespace {

using Json = nlohmann::json;

constexpr uint32_t kRecorded = 12;

const std::vector<std::byte>& Tiny() {
  static const std::vector<std::byte> tiny = RecordScene("tiny", kRecorded);
  return tiny;
}

std::unique_ptr<ReplayViewer> OpenViewer(std::span<const std::byte> file) {
  return ReplayViewer::Open(file, "x.peltinput").OrThrow();
}

void RunToEnd(ReplayViewer& viewer) {
  while (!viewer.AtEnd()) ASSERT_EQ(viewer.Step(), nullptr);
}

size_t CountHairs(const ReplayViewer& viewer) {
  size_t count = 0;
  for (const std::vector<Hair>& hairs : viewer.Gather().layers) count += hairs.size();
  return count;
}

glm::vec3 FirstRoot(const PictureScene& shown) { return shown.layers.front().front().root; }

TEST(ReplayViewer, EveryFrameIsAsRecorded) {
  const auto viewer = OpenViewer(Tiny());
  for (uint32_t f = 0; f < kRecorded; ++f) {
    ASSERT_FALSE(viewer->AtEnd());
    ASSERT_EQ(viewer->Step(), nullptr);
    const Json frame = Json::parse(viewer->LastFrame());
    EXPECT_EQ(frame["frame"], f);
    EXPECT_EQ(frame["digest"], frame["recorded"]);
    EXPECT_EQ(frame["others"], 0);
  }
  EXPECT_TRUE(viewer->AtEnd());
  EXPECT_TRUE(viewer->result().Same());
  EXPECT_EQ(viewer->result().digest, RunDigests({.scene = "tiny"}, kRecorded).back());
}

TEST(ReplayViewer, BehindTheLastFrameItBeginsAgain) {
  const auto viewer = OpenViewer(Tiny());
  RunToEnd(*viewer);
  const uint64_t digest = viewer->result().digest;
  ASSERT_EQ(viewer->Step(), nullptr);
  EXPECT_EQ(Json::parse(viewer->LastFrame())["frame"], 0);
  RunToEnd(*viewer);
  EXPECT_EQ(viewer->result().digest, digest);
  viewer->Restart();
  RunToEnd(*viewer);
  EXPECT_TRUE(viewer->result().Same());
  EXPECT_EQ(viewer->result().digest, digest);
}

TEST(ReplayViewer, TheUserMayStandAnywhereAndNoBitChanges) {
  const auto viewer = OpenViewer(Tiny());
  ASSERT_EQ(viewer->Step(), nullptr);
  viewer->Look();
  const Camera own = viewer->camera();
  const size_t hairs = CountHairs(*viewer);
  ASSERT_GT(hairs, 500u);
  const glm::vec3 root = FirstRoot(viewer->Gather());
  viewer->SetCamera(PageCamera{{0.0f, 0.6f, 0.0f}, 3.6, 0.4, 2.0});
  viewer->Look();
  EXPECT_GT(CountHairs(*viewer), hairs / 2);
  EXPECT_NE(viewer->camera().eye[2], own.eye[2]);
  // From behind, other hairs are the farthest.
  EXPECT_NE(FirstRoot(viewer->Gather()), root);
  for (double yaw = 0.0; !viewer->AtEnd(); yaw += 0.7) {
    viewer->SetCamera(PageCamera{{0.0f, 0.6f, 0.0f}, yaw, 0.4, 1.5 + yaw});
    viewer->Look();
    ASSERT_EQ(viewer->Step(), nullptr);
    viewer->Look();
  }
  EXPECT_TRUE(viewer->result().Same()) << DescribeReplay(viewer->result());
  viewer->SetCamera(std::nullopt);
  viewer->Look();
  const InputLog log = ReadInputLog(Tiny(), "x").OrThrow();
  EXPECT_EQ(viewer->camera().eye[2], log.frames.back().input.camera.eye[2]);
}

// What the page begins to turn from, it shows.
TEST(ReplayViewer, TurningBeginsWhereTheRecordedCameraIs) {
  const auto viewer = OpenViewer(Tiny());
  ASSERT_EQ(viewer->Step(), nullptr);
  const Json orbit = Json::parse(viewer->LastFrame())["camera"];
  const Camera own = viewer->camera();
  viewer->SetCamera(PageCamera{{orbit["target"][0], orbit["target"][1], orbit["target"][2]},
                               orbit["yaw"],
                               orbit["elevation"],
                               orbit["distance"]});
  viewer->Look();
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(viewer->camera().eye[c], own.eye[c], 1e-4f) << c;
}

TEST(ReplayViewer, WithoutACameraAllOfTheFurIsInSight) {
  const auto viewer = OpenViewer(RecordScene("tiny", 3, [](uint32_t, FrameInput& input) {
    input.camera = Camera{};
    input.skip.cull = false;
  }));
  ASSERT_EQ(viewer->Step(), nullptr);
  viewer->Look();
  const View view = MakeView(viewer->camera());
  for (const std::vector<Hair>& hairs : viewer->Gather().layers)
    for (const Hair& hair : hairs)
      for (const auto& plane : view.planes) {
        const float inside =
            plane[0] * hair.root.x + plane[1] * hair.root.y + plane[2] * hair.root.z + plane[3];
        ASSERT_GE(inside, 0.0f);
      }
  RunToEnd(*viewer);
  EXPECT_TRUE(viewer->result().Same());
}

// Of a recording of 15 frames a second.
TEST(ReplayViewer, InBetweenIsOnTheWayFromOneFrameToTheNext) {
  const auto viewer = OpenViewer(
      RecordScene("tiny", 6, [](uint32_t, FrameInput& input) { input.dt_s = 1.0 / 15.0; }));
  ASSERT_EQ(viewer->Step(), nullptr);
  EXPECT_FALSE(viewer->HasInBetween());
  for (int f = 0; f < 3; ++f) ASSERT_EQ(viewer->Step(), nullptr);
  ASSERT_TRUE(viewer->HasInBetween());
  const PictureScene from = viewer->Gather(0.0f), half = viewer->Gather(0.5f),
                     to = viewer->Gather();
  float moved = 0.0f;
  ASSERT_EQ(half.layers[0].size(), to.layers[0].size());
  for (size_t i = 0; i < to.layers[0].size(); ++i) {
    const glm::vec3 a = from.layers[0][i].knot[2].at, b = to.layers[0][i].knot[2].at;
    EXPECT_LT(glm::length(half.layers[0][i].knot[2].at - 0.5f * (a + b)), 1e-5f);
    moved = std::max(moved, glm::length(b - a));
  }
  EXPECT_GT(moved, 0.005f);
  RunToEnd(*viewer);
  EXPECT_TRUE(viewer->result().Same());
  viewer->Set("in_between", 0);
  ASSERT_EQ(viewer->Step(), nullptr);
  ASSERT_EQ(viewer->Step(), nullptr);
  EXPECT_FALSE(viewer->HasInBetween());
}

TEST(ReplayViewer, WhatIsPlantedInAFrameIsFoundThere) {
  const auto planted = RewriteLog(ReadInputLog(Tiny(), "x").OrThrow(), 5,
                                  [](FrameInput& input, auto&) { input.gravity[1] = -3.0f; });
  const auto viewer = OpenViewer(planted);
  for (uint32_t f = 0; f < 5; ++f) ASSERT_EQ(viewer->Step(), nullptr);
  EXPECT_TRUE(viewer->result().Same());
  ASSERT_EQ(viewer->Step(), nullptr);
  const Json frame = Json::parse(viewer->LastFrame());
  EXPECT_NE(frame["digest"], frame["recorded"]);
  EXPECT_EQ(frame["first_other"], 5);
  RunToEnd(*viewer);
  EXPECT_EQ(Json::parse(viewer->LastFrame())["first_other"], 5);
}

TEST(ReplayViewer, AFrameThatCannotRunIsTheEnd) {
  const auto planted = RewriteLog(ReadInputLog(Tiny(), "x").OrThrow(), 2,
                                  [](FrameInput& input, auto&) { input.dt_s = -1.0; });
  const auto viewer = OpenViewer(planted);
  ASSERT_EQ(viewer->Step(), nullptr);
  ASSERT_EQ(viewer->Step(), nullptr);
  const char* const refused = viewer->Step();
  ASSERT_NE(refused, nullptr);
  EXPECT_NE(std::string(refused).find("frame 2 cannot run: dt_s"), std::string::npos) << refused;
  EXPECT_TRUE(viewer->AtEnd());
  viewer->Look();
  EXPECT_GT(CountHairs(*viewer), 0u);
  ASSERT_EQ(viewer->Step(), nullptr);
  EXPECT_EQ(Json::parse(viewer->LastFrame())["frame"], 0);
}

TEST(ReplayViewer, WhatIsDamagedIsToldWithItsPlace) {
  std::vector<std::byte> cut = Tiny();
  cut.resize(cut.size() / 2);
  const auto refused = [](std::span<const std::byte> file) {
    const auto viewer = ReplayViewer::Open(file, "x.peltinput");
    return viewer ? std::string("was opened") : viewer.error();
  };
  EXPECT_EQ(refused(cut).find("input log 'x.peltinput': header, byte "), 0u) << refused(cut);
  EXPECT_NE(refused(cut).find("it was cut or extended"), std::string::npos) << refused(cut);
  std::vector<std::byte> damaged = Tiny();
  damaged[damaged.size() / 2] ^= std::byte{4};
  EXPECT_NE(refused(damaged).find("the file is damaged"), std::string::npos) << refused(damaged);
  EXPECT_NE(refused({}).find("not an input log"), std::string::npos) << refused({});
  const auto bad_first = RewriteLog(ReadInputLog(Tiny(), "x").OrThrow(), 0,
                                    [](FrameInput& input, auto&) { input.dt_s = -1.0; });
  EXPECT_NE(refused(bad_first).find("frame 0 cannot run"), std::string::npos);
  const auto none = RecordScene("tiny", 0);
  EXPECT_NE(refused(none).find("no frame in it"), std::string::npos) << refused(none);
}

TEST(ReplayViewer, HasTheSettingsOfPicturesAlone) {
  const auto viewer = OpenViewer(Tiny());
  const Json described = Json::parse(viewer->Describe());
  EXPECT_EQ(described["frames"], kRecorded);
  EXPECT_EQ(described["recording"]["file"], "x.peltinput");
  EXPECT_TRUE(described["setups"].empty());
  EXPECT_EQ(described["strands"], LoadScenario("tiny").StrandCount());
  ASSERT_GT(described["settings"].size(), 5u);
  for (const Json& row : described["settings"])
    viewer->Set(row["key"].get<std::string>(), row["low"]);
  EXPECT_THROW(viewer->Set("gravity", 1.0), Error);
  EXPECT_THROW(viewer->Set("nonsense", 1.0), Error);
  RunToEnd(*viewer);
  EXPECT_TRUE(viewer->result().Same());
  EXPECT_EQ(CountHairs(*viewer), 0u);  // render_fur
  for (size_t view = 0; view < described["views"].size(); ++view) {
    viewer->Set("show", double(view));
    EXPECT_EQ(viewer->Gather().draws.size(), viewer->Gather().layers.size());
  }
}

}  // namespace
}  // namespace pelt
