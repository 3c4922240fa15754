// Recorded roots: what a table may hold, that the motion between samples is the one that was recorded, and that errors
// under it are those under the motion itself.
#include "tests/accuracy/recorded_root.hpp"

#include <gtest/gtest.h>

#include "bench/accuracy/model_error.hpp"

namespace pelt::accuracy {
namespace {

// A sway with a turn about the vertical, from rest.
RootParts PartsAt(double t) {
  const double grown = t * t / (0.3 + t * t), angle = 0.4 * grown * std::sin(7.0 * t);
  return {0.1 * grown * std::sin(5.0 * t),
          0.02 * grown * std::sin(10.0 * t),
          0.0,
          0.0,
          std::sin(0.5 * angle),
          0.0,
          std::cos(0.5 * angle)};
}
RecordedRoot Record(double frames_per_second, double seconds) {
  RecordedRoot root;
  for (int f = 0; f <= int(std::lround(seconds * frames_per_second)); ++f) {
    root.seconds.push_back(f / frames_per_second);
    root.parts.push_back(PartsAt(root.seconds.back()));
  }
  return root;
}

std::string MessageOf(const std::string& text) {
  std::istringstream in(text);
  try {
    ReadRecordedRoot(in);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(RecordedRoot, EveryMistakeHasItsLineAndReason) {
  const std::string good = "time,x,y,z,qx,qy,qz,qw\n0,0,0,0,0,0,0,1\n";
  const std::pair<std::string, std::string> cases[] = {
      {"", "line 1: expected time,x"},
      {"time,x\n", "line 1: expected time,x"},
      {good, "line 2: expected two poses"},
      {good + "0.1,0,0,0,0,0,0\n", "line 3: expected 8 numbers"},
      {good + "0.1,0,0,0,0,0,0,1,2\n", "line 3: expected 8 numbers"},
      {good + "0.1,nan,0,0,0,0,0,1\n", "line 3: expected 8 numbers"},
      {good + "0,0,0,0,0,0,0,1\n", "line 3: times begin at 0 and rise"},
      {good + "0.1,0,0,0,0,0,0,0.9\n", "line 3: the quaternion's length"},
      {good + "0.1,0,0,0,0,0,0,-1\n", "no error"},
  };
  for (const auto& [text, expected] : cases)
    EXPECT_EQ(MessageOf(text).substr(0, expected.size()), expected) << text;
}

TEST(RecordedRoot, SplineGoesThroughTheSamplesSmoothly) {
  const RecordedRoot root = Record(50.0, 2.0);
  const BodyMotion motion = MotionOf(root);
  for (size_t s = 1; s + 1 < root.seconds.size(); ++s) {
    const double t = root.seconds[s];
    EXPECT_LT(std::abs(motion(t).position.x - root.parts[s][0]), 1e-12);
    EXPECT_LT(Length(motion(t - 1e-9).acceleration - motion(t).acceleration), 1e-5);
    EXPECT_LT(Length(motion(t - 1e-9).axis_bend[0] - motion(t).axis_bend[0]), 1e-5);
  }
  EXPECT_LT(Length(motion(0.0).velocity) + Length(motion(0.0).axis_rate[0]), 1e-12);
  // Its derivatives are those of its values.
  const double t = 1.2345, h = 1e-5;
  const BodyPose low = motion(t - h), middle = motion(t), high = motion(t + h);
  EXPECT_LT(Length((high.axis[0] - low.axis[0]) * (0.5 / h) - middle.axis_rate[0]), 1e-6);
  EXPECT_LT(Length((high.axis_rate[0] - low.axis_rate[0]) * (0.5 / h) - middle.axis_bend[0]), 1e-4);
}

// The motion itself is what a recording of 1,000 frames per second comes to.
TEST(RecordedRoot, ErrorsUnderARecordingAreThoseUnderTheMotion) {
  ModelErrorOptions options;
  options.families = {MotionFamily::kEveryday};
  options.presets = {kPresets[1]};
  options.problems = 1;
  options.seconds = 1.5;
  const auto error_of = [&](double frames_per_second) {
    options.motion = MotionOf(Record(frames_per_second, 2.0));
    const ModelErrorTable table = MeasureModelError(options);
    EXPECT_EQ(table.panels[0].rows[0].model, "3 nodes");
    return table.panels[0].rows[0].errors[0][0];
  };
  const double exact = error_of(1000.0), at_60 = error_of(60.0);
  std::printf("3 nodes, exactly: %.3f %% off, recorded at 60 Hz %.3f\n", 100 * exact, 100 * at_60);
  EXPECT_LT(exact, 0.1);
  EXPECT_LT(std::abs(at_60 - exact), 0.05 * exact);
}

}  // namespace
}  // namespace pelt::accuracy
