// Which frames of a run are drawn, where the camera is placed for it, and what an animation is made of.
#include "bench/command/picture_shots.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "bench/command/commands.hpp"
#include "bench/picture/png.hpp"
#include "core/exact_math.hpp"
#include "core/file_bytes.hpp"
#include "core/groom/fur_setup.hpp"
#include "tests/error_from.hpp"
#include "tests/groom/png.hpp"
#include "tests/jobs/tiny_scene.hpp"
#include "tests/test_folder.hpp"

namespace pelt::testing {
namespace {

namespace fs = std::filesystem;

class PictureShotsTest : public ::testing::Test {
 protected:
  void SetUp() override {
    args_.width_px = 24;
    args_.height_px = 16;
  }
  OutputPath Path(const char* name) const { return OutputPath::Of(folder_ / name); }
  std::vector<std::string> Files() const {
    std::vector<std::string> names;
    for (const auto& entry : fs::directory_iterator(folder_.path()))
      names.push_back(entry.path().filename().string());
    std::ranges::sort(names);
    return names;
  }
  std::vector<std::byte> Bytes(const char* name) const {
    return ReadFileBytes("picture", folder_ / name, 1u << 24).OrThrow();
  }
  // Runs `frames` frames and takes the pictures of it.
  PictureShots Take(uint32_t frames) {
    running_.emplace(scenario_, SceneOptions{});
    PictureShots shots(args_, scenario_, running_->scene(), frames, VertexOrder::kSorted);
    for (uint32_t f = 0; f < frames; ++f) {
      RunFrame(*running_, f);
      shots.Take(f);
    }
    shots.Finish();
    EXPECT_TRUE(shots.faults().empty());
    return shots;
  }

  const test::TestFolder folder_;
  PictureArgs args_;
  Scenario scenario_ = TinyScenario();
  std::optional<RunningScenario> running_;
};

TEST_F(PictureShotsTest, NothingIsDrawnThatNobodyAsksFor) {
  const PictureShots shots = Take(3);
  EXPECT_EQ(shots.Taken(), 0u);
  ReportTree tree;
  shots.AddTo(tree);
  EXPECT_EQ(tree.Json().find("pictures"), std::string::npos);
}

TEST_F(PictureShotsTest, TheLastFrameIsTheOneInAFolderToo) {
  args_.last = Path("last.png");
  args_.folder = OutputPath::Of(folder_.path().string());
  args_.every = 2;
  EXPECT_EQ(Take(6).Taken(), 3u);
  EXPECT_EQ(Files(), (std::vector<std::string>{"frame-00001.png", "frame-00003.png",
                                               "frame-00005.png", "last.png"}));
  EXPECT_EQ(Bytes("last.png"), Bytes("frame-00005.png"));
  EXPECT_NE(Bytes("frame-00001.png"), Bytes("frame-00005.png"));
}

TEST_F(PictureShotsTest, TimesNameFrames) {
  args_.folder = OutputPath::Of(folder_.path().string());
  args_.times_s = {0.05, 0.0, 0.051};  // at 60 Hz frames 3, 0 and 3
  EXPECT_EQ(Take(5).Taken(), 2u);
  EXPECT_EQ(Files(), (std::vector<std::string>{"frame-00000.png", "frame-00003.png"}));
}

TEST_F(PictureShotsTest, ATimeThatNoFrameHasSaysHowManyWouldDo) {
  args_.last = Path("late.png");
  args_.times_s = {1.0};
  RunningScenario running(scenario_, {});
  const std::string error = test::ErrorFrom(
      [&] { PictureShots(args_, scenario_, running.scene(), 60, VertexOrder::kSorted); });
  EXPECT_NE(error.find("--frames 61"), std::string::npos) << error;
  EXPECT_NO_THROW(PictureShots(args_, scenario_, running.scene(), 61, VertexOrder::kSorted));
}

TEST_F(PictureShotsTest, LightChangesThePicture) {
  args_.last = Path("picture.png");
  std::vector<std::vector<std::byte>> pictures;
  for (const char* light : {"", "studio", "dark-rim", "backlit", "overcast", "evening"}) {
    args_.light = light;
    Take(1);
    pictures.push_back(Bytes("picture.png"));
  }
  EXPECT_EQ(pictures[0], pictures[1]);
  for (size_t a = 1; a < pictures.size(); ++a)
    for (size_t b = a + 1; b < pictures.size(); ++b)
      EXPECT_NE(pictures[a], pictures[b]) << a << ' ' << b;
}

// Each step has what the one before it has not.
TEST_F(PictureShotsTest, StepsAreASheetOfPicturesThatDiffer) {
  args_.steps = Path("steps.png");
  args_.last = Path("last.png");
  Take(1);
  const auto read = [&](const char* name) {
    const std::vector<std::byte> png = Bytes(name);
    return ReadControlMap({reinterpret_cast<const uint8_t*>(png.data()), png.size()}, name);
  };
  const ControlMap sheet = read("steps.png"), last = read("last.png");
  ASSERT_EQ(sheet.width, 3 * args_.width_px);
  ASSERT_EQ(sheet.height, 2 * args_.height_px);
  std::set<std::vector<uint8_t>> seen;
  std::vector<uint8_t> panel;
  for (uint32_t s = 0; s < 6; ++s) {
    panel.clear();
    for (uint32_t y = 0; y < args_.height_px; ++y) {
      const size_t row = (s / 3 * args_.height_px + y) * sheet.width + s % 3 * args_.width_px;
      panel.insert(panel.end(), sheet.rgba.begin() + long(4 * row),
                   sheet.rgba.begin() + long(4 * (row + args_.width_px)));
    }
    EXPECT_TRUE(seen.insert(panel).second) << s;
  }
  EXPECT_EQ(panel, last.rgba);
}

TEST(CameraChoice, StandsWhereItWasToldAndTurnsOnce) {
  RunArgs args;
  args.request.scene = "tiny";
  args.options.frames = 30;
  args.camera = {.orbit = {90.0, 30.0, 0.5}, .target_m = {1.0f, 2.0f, 3.0f}};
  Scenario scenario = LoadForRun(args, nullptr);
  const CameraOrbit own = TinyScenario().camera;
  const double distance_m = 0.5 * std::hypot(own.radius_m, own.height_m);
  EXPECT_NEAR(scenario.camera.radius_m, distance_m * std::cos(exact::kPi / 6), 1e-9);
  EXPECT_NEAR(scenario.camera.height_m, distance_m * 0.5, 1e-9);
  RunningScenario running(scenario, {});
  const Camera camera = scenario.PrepareFrame(7, running.scene()).camera;
  EXPECT_NEAR(camera.eye[0], 1.0 + scenario.camera.radius_m, 1e-5);
  EXPECT_NEAR(camera.eye[1], 2.0 + scenario.camera.height_m, 1e-5);
  EXPECT_NEAR(camera.eye[2], 3.0, 1e-5);

  args.camera.turntable = true;
  EXPECT_NEAR(LoadForRun(args, nullptr).camera.rate_rad_per_s * 30 * scenario.dt_s,
              2.0 * exact::kPi, 1e-9);
  EXPECT_EQ(DescribeSettings(args), "camera 90,30,0.5, camera target 1,2,3, turntable");
}

std::vector<std::byte> GreyPng(uint32_t size, uint8_t grey) {
  const std::vector<uint8_t> png =
      test::MakePng(size, size, 1, std::vector<uint8_t>(size * size, grey));
  const auto bytes = std::as_bytes(std::span(png));
  return {bytes.begin(), bytes.end()};
}

// The chunks of a PNG in order, with their checksums looked at.
std::vector<std::pair<std::string, std::vector<uint8_t>>> Chunks(std::span<const std::byte> png) {
  const std::span<const uint8_t> bytes(reinterpret_cast<const uint8_t*>(png.data()), png.size());
  const auto big = [&](size_t at) {
    return uint32_t(bytes[at] << 24 | bytes[at + 1] << 16 | bytes[at + 2] << 8 | bytes[at + 3]);
  };
  std::vector<std::pair<std::string, std::vector<uint8_t>>> chunks;
  for (size_t at = 8; at < bytes.size();) {
    const size_t length = big(at);
    const auto body = bytes.subspan(at + 8, length);
    chunks.push_back({std::string(bytes.begin() + long(at) + 4, bytes.begin() + long(at) + 8),
                      {body.begin(), body.end()}});
    EXPECT_EQ(CountCrc(bytes.subspan(at + 4, length + 4)), big(at + 8 + length));
    at += length + 12;
  }
  return chunks;
}

TEST(Animation, HasAllPicturesInOrderWithTheirTimes) {
  const std::vector<AnimationFrame> frames = {
      {GreyPng(3, 10), 0.5}, {GreyPng(3, 20), 0.05}, {GreyPng(3, 30), 1.0 / 60}};
  const auto chunks = Chunks(AnimatePng(frames));
  std::string types;
  std::vector<uint32_t> sequence, delay_ms;
  for (const auto& [type, body] : chunks) {
    types += type + ' ';
    const auto big = [&body = body](size_t at) {
      return uint32_t(body[at] << 24 | body[at + 1] << 16 | body[at + 2] << 8 | body[at + 3]);
    };
    if (type == "acTL") {
      EXPECT_EQ(big(0), 3u);
    }
    if (type == "fcTL" || type == "fdAT") sequence.push_back(big(0));
    if (type == "fcTL") delay_ms.push_back(big(20) >> 16);
  }
  EXPECT_EQ(types, "IHDR acTL fcTL IDAT fcTL fdAT fcTL fdAT IEND ");
  EXPECT_EQ(sequence, (std::vector<uint32_t>{0, 1, 2, 3, 4}));
  EXPECT_EQ(delay_ms, (std::vector<uint32_t>{500, 50, 17}));
  // What a viewer without animation shows.
  EXPECT_EQ(chunks[3].second, Chunks(frames[0].png)[1].second);
  const std::vector<uint8_t>& last = chunks[7].second;
  EXPECT_EQ(std::vector<uint8_t>(last.begin() + 4, last.end()), Chunks(frames[2].png)[1].second);
}

TEST(Animation, RefusesWhatIsNoPicture) {
  EXPECT_THROW(AnimatePng({}), Error);
  std::vector<AnimationFrame> frames = {{GreyPng(3, 10), 0.1}, {GreyPng(4, 10), 0.1}};
  EXPECT_THROW(AnimatePng(frames), Error);
  for (size_t bytes = 0; bytes < frames[0].png.size(); ++bytes) {
    frames[1].png.assign(frames[0].png.begin(), frames[0].png.begin() + long(bytes));
    EXPECT_THROW(AnimatePng(frames), Error) << bytes;
  }
}

}  // namespace
}  // namespace pelt::testing
