// Strands under recorded roots: what files may hold, how each mistake is told, and that what comes
// out is the motion of that strand under that root.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "bench/accuracy/named_solver.hpp"
#include "bench/accuracy/recorded_run.hpp"
#include "bench/accuracy/reference_integrator.hpp"
#include "bench/accuracy/solver_run.hpp"
#include "core/error.hpp"

namespace pelt::accuracy {
namespace {

constexpr const char* kHeader = "time,x,y,z,qx,qy,qz,qw\n";
constexpr const char* kGoodStrand = "length = 0.05\nfrequency_hz = 3\n";

StrandFile ExampleChain() { return ParseStrand(ExampleStrand() + "rod = \"uniform\"\n", "s.toml"); }

template <class Parse>
std::string MessageOf(Parse parse) {
  try {
    parse();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}
std::string RootsMessage(const std::string& text) {
  return MessageOf([&] { ParseRoots(text, "r.csv"); });
}
std::string StrandMessage(const std::string& text) {
  return MessageOf([&] { ParseStrand(text, "s.toml"); });
}

std::vector<RootSample> Record(Motion motion, double frames_per_second, double seconds = 4.0,
                               bool rated = false) {
  std::vector<RootSample> samples;
  for (int f = 0; f <= int(std::lround(seconds * frames_per_second)); ++f)
    samples.push_back(
        SampleOf(PoseOf(motion, f / frames_per_second), f / frames_per_second, rated));
  return samples;
}

TEST(RecordedRoot, ReadsBackWhatItWrote) {
  const std::vector<RootSample> samples = ExampleRoots();
  const std::vector<RootSample> again = ParseRoots(RootsText(samples), "r.csv");
  ASSERT_EQ(again.size(), samples.size());
  ASSERT_GT(samples.size(), 200u);
  for (size_t s = 0; s < samples.size(); ++s) {
    EXPECT_NEAR(again[s].seconds, samples[s].seconds, 1e-8);
    EXPECT_LT(Length(again[s].position - samples[s].position), 1e-8);
    EXPECT_LT(Length(again[s].wind - samples[s].wind), 1e-7);
    for (size_t k = 0; k < 4; ++k)
      EXPECT_NEAR(again[s].quaternion[k], samples[s].quaternion[k], 2e-8);
  }
}

TEST(RecordedRoot, ColumnsStandInAnyOrder) {
  const auto samples = ParseRoots(
      "\r\n qw, qx,qy,qz , z,y,x,time\r\n1,0,0,0,3,2,1,0\r\n\r\n1,0,0,0,6,5,4,0.02\n", "r.csv");
  ASSERT_EQ(samples.size(), 2u);
  EXPECT_EQ(samples[1].seconds, 0.02);
  EXPECT_EQ(Length(samples[1].position - Double3{4, 5, 6}), 0.0);
  EXPECT_EQ(samples[1].quaternion[3], 1.0);
}

TEST(RecordedRoot, EveryMistakeHasItsLineAndReason) {
  const std::string row = "0,0,0,0,0,0,0,1\n", next = "0.01,0,0,0,0,0,0,1\n";
  const auto with = [&](const std::string& last) { return kHeader + row + last; };
  const std::pair<std::string, std::string> cases[] = {
      {"", "r.csv:1: is empty"},
      {"time,x,y,z,qx,qy,qz\n" + row, "r.csv:1: column 'qw' is missing"},
      {"time,x,y,z,qx,qy,qz,qv\n" + row, "r.csv:1: unknown column 'qv'; did you mean 'q"},
      {"time,x,y,z,qx,qy,qz,qw,temperature\n" + row, "the columns are time,x,y,z"},
      {"time,x,x,y,z,qx,qy,qz,qw\n" + row, "r.csv:1: column 'x' stands there twice"},
      {"time,x,y,z,qx,qy,qz,qw,wind_x\n" + row, "r.csv:1: column 'wind_y' is missing"},
      {kHeader, "0 poses; at least two"},
      {kHeader + row, "1 pose; at least two"},
      {with("0.01,0,0,0,0,0,0\n"), "r.csv:3: 7 cells, but the header has 8 columns; is the file"},
      {with("0.01,0,0,0,0\n" + next), "r.csv:3: 5 cells, but the header has 8 columns"},
      {with("0.01,nan,0,0,0,0,0,1\n"), "r.csv:3: column 'x': nan is not finite"},
      {with("0.01,0,inf,0,0,0,0,1\n"), "r.csv:3: column 'y': inf is not finite"},
      {with("0.01,0,0,1e400,0,0,0,1\n"), "r.csv:3: column 'z': '1e400' is not a number"},
      {with("0.01,0,0,1e9,0,0,0,1\n"), "r.csv:3: column 'z': 1000000000 is beyond"},
      {with("0.01,,0,0,0,0,0,1\n"), "r.csv:3: column 'x': '' is not a number"},
      {with("0.01,1.5m,0,0,0,0,0,1\n"), "r.csv:3: column 'x': '1.5m' is not a number"},
      {with("0.01,0,0,0,0,0,0,0.9\n"), "r.csv:3: the quaternion's length is 0.9"},
      {with("0.01,0,0,0,0,0,0,0\n"), "r.csv:3: the quaternion's length is 0;"},
      {with("0,0,0,0,0,0,0,1\n"), "r.csv:3: time 0 does not come after 0"},
      {with("-1,0,0,0,0,0,0,1\n"), "r.csv:3: time -1 does not come after 0"},
      {with("3,0,0,0,0,0,0,1\n"), "r.csv:3: a frame of 3 s"},
      {with("1e-7,0,0,0,0,0,0,1\n"), "r.csv:3: a frame of 1e-07 s"},
      {with(std::string("0.01,\x01") + '\0' + ",0,0,0,0,0,1\n"), "r.csv:3: column 'x': '?\?'"},
  };
  for (const auto& [text, expected] : cases)
    EXPECT_NE(RootsMessage(text).find(expected), std::string::npos)
        << "expected " << expected << "\ngot      " << RootsMessage(text);
  EXPECT_EQ(RootsMessage(with(next)), "no error");
}

TEST(RecordedRoot, VelocitiesAreReadBackAndKept) {
  const std::vector<RootSample> samples = Record(Motion::kHeadshake, 30.0, 2.0, true);
  const std::vector<RootSample> again = ParseRoots(RootsText(samples), "r.csv");
  ASSERT_EQ(again.size(), samples.size());
  const RootSpline spline(again);
  double fastest = 0.0;
  for (size_t s = 0; s < samples.size(); ++s) {
    ASSERT_TRUE(again[s].rated);
    EXPECT_LT(Length(again[s].velocity - samples[s].velocity), 1e-7);
    EXPECT_LT(Length(again[s].spin - samples[s].spin), 1e-7);
    for (const size_t frame : {std::max<size_t>(s, 1), std::min(s + 1, samples.size() - 1)}) {
      const BodyPose pose = spline.At(again[s].seconds, frame);
      EXPECT_LT(Length(SpinOf(pose) - samples[s].spin), 1e-6) << s;
      EXPECT_LT(Length(pose.velocity - samples[s].velocity), 1e-6) << s;
    }
    fastest = std::max(fastest, Length(samples[s].spin));
  }
  EXPECT_GT(fastest, 3.0);
  const std::string row = "0,0,0,0,0,0,0,1";
  EXPECT_EQ(RootsMessage("time,x,y,z,qx,qy,qz,qw,velocity_x\n" + row + ",0\n"),
            "r.csv:1: column 'velocity_y' is missing");
  EXPECT_EQ(RootsMessage("time,x,y,z,qx,qy,qz,qw,velocity_x,velocity_y,velocity_z,spin_x,spin_y,"
                         "spin_z\n" +
                         row + ",0,0,nan,0,0,0\n"),
            "r.csv:2: column 'velocity_z': nan is not finite");
}

// Every cut of a good file is either refused with file and line or a shorter good file.
TEST(RecordedRoot, CutFilesAreRefusedOrShorter) {
  const std::string text = RootsText(Record(Motion::kHeadshake, 30.0, 0.5));
  for (size_t length = 0; length < text.size(); length += 7) {
    const std::string message = RootsMessage(text.substr(0, length));
    EXPECT_TRUE(message == "no error" || message.starts_with("r.csv:")) << message;
  }
}

TEST(RecordedRoot, SplineGoesThroughTheSamplesSmoothly) {
  const std::vector<RootSample> samples = ExampleRoots();
  const RootSpline spline(samples);
  for (size_t s = 1; s + 1 < samples.size(); ++s) {
    const BodyPose own = PoseOf(samples[s]);
    const BodyPose before = spline.At(samples[s].seconds, s),
                   after = spline.At(samples[s].seconds, s + 1);
    EXPECT_LT(Length(before.position - own.position), 1e-12);
    for (int k = 0; k < 3; ++k) {
      EXPECT_LT(Length(before.axis[k] - own.axis[k]), 1e-12);
      EXPECT_LT(Length(before.axis_rate[k] - after.axis_rate[k]), 1e-9);
      EXPECT_LT(Length(before.axis_bend[k] - after.axis_bend[k]), 1e-6);
    }
    EXPECT_LT(Length(before.velocity - after.velocity), 1e-10);
    EXPECT_LT(Length(before.acceleration - after.acceleration), 1e-8);
  }
  const BodyPose first = spline.At(samples[0].seconds);
  EXPECT_LT(Length(first.velocity) + Length(first.axis_rate[0]), 1e-12);
  // Its derivatives are those of its values.
  const double t = 1.2345, h = 1e-5;
  const BodyPose low = spline.At(t - h), middle = spline.At(t), high = spline.At(t + h);
  EXPECT_LT(Length((high.axis[1] - low.axis[1]) * (0.5 / h) - middle.axis_rate[1]), 1e-6);
  EXPECT_LT(Length((high.axis_rate[1] - low.axis_rate[1]) * (0.5 / h) - middle.axis_bend[1]), 1e-4);
}

TEST(RecordedRoot, SignsOfQuaternionsDoNotMatter) {
  std::vector<RootSample> samples = Record(Motion::kHeadshake, 60.0), flipped = samples;
  for (size_t s = 0; s < flipped.size(); s += 3)
    for (double& part : flipped[s].quaternion) part = -part;
  const RootSpline spline(samples), other(flipped);
  for (double t = 0.0; t < 4.0; t += 0.017)
    EXPECT_LT(Length(spline.At(t).axis[0] - other.At(t).axis[0]), 1e-12);
}

TEST(StrandFile, DefaultsAndValues) {
  const StrandFile plain = ParseStrand(kGoodStrand, "s.toml");
  EXPECT_EQ(plain.material.links, 3);
  EXPECT_NEAR(plain.material.TotalLength(), 0.05, 1e-15);
  EXPECT_NEAR(MatricesOf(plain.material).omega[0], 2.0 * exact::kPi * 3.0, 1e-9);
  EXPECT_EQ(plain.material.drag, 0.0);
  EXPECT_EQ(plain.material.gravity.y, -9.81);
  EXPECT_EQ(plain.strand.rest[2].y, 1.0);
  const StrandFile full = ParseStrand(
      "length = 0.08\nlinks = 4\nstiffness = [4, 3, 2, 1]\nmass = [1, 2, 3, 4]\n"
      "damping_ratio = 0.1\ndrag = 2\ngravity = [0, 0, -9]\nroot = [1, 2, 3]\n"
      "rest = [[2, 0, 0], [0, 3, 0], [0, 0, 4], [1, 1, 0]]\n"
      "start = [[0, 1, 0], [0, 1, 0], [0, 1, 0], [0, 2, 0]]\n",
      "s.toml");
  EXPECT_EQ(full.material.mass[3], 4.0);
  EXPECT_EQ(full.material.stiffness[1], 3.0);
  EXPECT_NEAR(full.material.bending_damping * MatricesOf(full.material).omega[0], 0.2, 1e-12);
  EXPECT_EQ(full.strand.root.z, 3.0);
  EXPECT_NEAR(Length(full.strand.rest[3]), 1.0, 1e-15);
  EXPECT_EQ(full.StartIn(StillPose())[3].y, 1.0);
  const StrandFile free = ParseStrand("length = 0.05\nfrequency_hz = 0\n", "s.toml");
  EXPECT_EQ(free.material.stiffness[0], 0.0);
  const auto stiffness = [](const char* rod) {
    return ParseStrand(std::string(kGoodStrand) + "rod = \"" + rod + "\"\n", "s.toml")
        .material.stiffness;
  };
  EXPECT_EQ(stiffness("uniform")[0], stiffness("uniform")[1]);
  EXPECT_GT(stiffness("calibrated")[0], 2.0 * stiffness("calibrated")[1]);
}

TEST(StrandFile, EveryMistakeHasItsLineAndReason) {
  const std::string good = kGoodStrand;
  const std::pair<std::string, std::string> cases[] = {
      {"", "key 'length': is needed"},
      {"frequency_hz = 3\n", "key 'length': is needed"},
      {"length = 0.05\n", "'frequency_hz': is needed and missing; or give stiffness"},
      {good + "lenght = 3\n", "s.toml:3: unknown key 'lenght'; did you mean 'length'?"},
      {good + "colour = 3\n", "s.toml:3: unknown key 'colour'; the keys are length, links"},
      {good + "links = 9\n", "s.toml:3: key 'links': 9 is out of bounds"},
      {good + "links = 5\n", "s.toml:3: key 'links': expected 3, 4 or 8"},
      {good + "links = 3.5\n", "s.toml:3: key 'links': expected 3, 4 or 8"},
      {good + "links = \"3\"\n", "s.toml:3: key 'links': expected a number"},
      {good + "drag = -1\n",
       "s.toml:3: key 'drag': -1 is out of bounds; allowed are 0 to 1000 1/s"},
      {good + "drag = nan\n", "s.toml:3: key 'drag': is not a finite number"},
      {good + "gravity = [0, 1]\n", "s.toml:3: key 'gravity': has 2 entries; 3 are needed"},
      {good + "root = 3\n", "s.toml:3: key 'root': expected a list of 3"},
      {good + "rest = [[0, 1, 0]]\n", "s.toml:3: key 'rest': has 1 entries; 3 are needed"},
      {good + "rest = [[0,1,0],[0,0,0],[0,1,0]]\n", "s.toml:3: key 'rest': a direction is zero"},
      {good + "start = \"resting\"\n", "s.toml:3: key 'start': expected one of \"rest\""},
      {good + "start = 3\n", "s.toml:3: key 'start': expected \"rest\""},
      {good + "stiffness = [1, 1, 1]\n", "s.toml:3: key 'stiffness': stands beside frequency_hz"},
      {good + "mass = [1, 1, 1]\n", "s.toml:3: key 'mass': goes with stiffness"},
      {good + "rod = \"wood\"\n", "s.toml:3: key 'rod': expected one of \"calibrated\""},
      {"length = 0.05\nstiffness = [1, 1, 1]\nrod = \"uniform\"\n", "s.toml:3: key 'rod': goes"},
      {"length = 0.05\nstiffness = [1e6, 1e6, 1e6]\nmass = [1, 1, 1e-3]\n",
       "s.toml:2: key 'stiffness': its fastest"},
      {"length = 0.05\nfrequency_hz = 0\ndamping_ratio = 0.1\n", "s.toml:3: key 'damping_ratio'"},
      {"length = 0.05\nfrequency_hz = [\n", "s.toml:"},
      {"length = 0.05\nlength = 0.06\n", "s.toml:2: not valid TOML"},
      {"[=\n", "s.toml:1: not valid TOML"},
  };
  for (const auto& [text, expected] : cases)
    EXPECT_NE(StrandMessage(text).find(expected), std::string::npos)
        << "expected " << expected << "\ngot      " << StrandMessage(text);
  EXPECT_EQ(StrandMessage(good), "no error");
}

// A recording is the motion it was made of: the error of the spline falls with the frame rate.
TEST(RecordedRun, ExactIsTheMotionThatWasRecorded) {
  const StrandFile strand = ExampleChain();
  ChainProblem problem;
  problem.material = strand.material;
  problem.strand = strand.strand;
  problem.motion = MotionOf(Motion::kHeadshake);
  problem.start = strand.StartIn(StillPose());
  const Double3 tip = ReferencePoint(problem, 2, 2.0, 1920);
  const auto miss = [&](int rate) {
    const PointTrack track = RunExact(strand, Record(Motion::kHeadshake, rate, 2.5));
    const size_t frame = size_t(2 * rate);
    return Length(track.root[frame] + track.offset[3 * frame + 2] - tip) / 0.05;
  };
  const double at_60 = miss(60), at_240 = miss(240);
  std::printf("recorded at 60 and 240 Hz, the tip is %.1e and %.1e L off\n", at_60, at_240);
  EXPECT_LT(at_60, 2e-3);
  EXPECT_LT(at_240, 2e-5);
}

// The same of a rod, of frames that end between its steps.
TEST(RecordedRun, ARodMovesTheSameByFewerFrames) {
  const StrandFile strand = ParseStrand(ExampleStrand(), "s.toml");
  ASSERT_TRUE(strand.rod);
  const PointTrack dense = RunExact(strand, Record(Motion::kHeadshake, 1000.0, 2.5));
  const auto miss = [&](int rate) {
    const PointTrack track = RunExact(strand, Record(Motion::kHeadshake, rate, 2.5));
    return Length(track.offset[size_t(2 * rate) * 3 + 2] - dense.offset[2000 * 3 + 2]) / 0.05;
  };
  const double at_50 = miss(50), at_250 = miss(250);
  std::printf("recorded at 50 and 250 Hz, the rod's tip is %.1e and %.1e L off\n", at_50, at_250);
  EXPECT_LT(at_50, 5e-3);
  EXPECT_LT(at_250, 5e-5);
}

// As core/modal/README.md has it of everyday motion.
TEST(RecordedRun, LayersAreNearTheirRod) {
  const std::vector<RootSample> samples = Record(Motion::kWalk, 60.0);
  const auto error_of = [&](const char* name, const char* links) {
    const StrandFile strand =
        ParseStrand(std::string(kGoodStrand) +
                        "drag = 5\ndamping_ratio = 0.05\n"
                        "start = \"equilibrium\"\nrest = [[1,0,0],[1,0,0],[1,0.2,0]" +
                        links,
                    "s.toml");
    return CompareTracks(samples, RunSolver(strand, samples, *FindSolver(name), BestIsa()),
                         RunExact(strand, samples))
        .share;
  };
  const double three = error_of("modal", "]\n");
  const double four = error_of("modal-fine", ",[1,0.3,0]]\nlinks = 4\n");
  const double pbd = error_of("pbd", "]\n");
  std::printf("walk: 3 nodes %.1f %%, 4 nodes, fine, %.1f, PBD %.0f\n", 100 * three, 100 * four,
              100 * pbd);
  EXPECT_LT(three, 0.1);
  EXPECT_LT(four, 0.05);
  EXPECT_GT(pbd, 0.3);
}

TEST(RecordedRun, SolversRunAsTheyDoOnTheYardstick) {
  const StrandFile strand = ExampleChain();
  const std::vector<RootSample> samples = Record(Motion::kWalk, 60.0, 2.0);
  const LinkDirections start = strand.StartIn(StillPose());
  for (const char* name : {"modal-fine", "pbd", "xpbd-8"}) {
    const NamedSolver solver = *FindSolver(name);
    const PointTrack track = RunSolver(strand, samples, solver, Isa::kReference);
    SolverRun run(FactoryOf(solver, Isa::kReference), strand.material, 1.0 / 60, {strand.strand},
                  std::span(&start, 1), PoseOf(Motion::kWalk, 0.0));
    ASSERT_EQ(track.seconds.size(), samples.size());
    double worst = 0.0;
    for (size_t f = 1; f < samples.size(); ++f) {
      run.Step(PoseOf(Motion::kWalk, double(f) / 60));
      for (int i = 0; i < 3; ++i)
        worst = std::max(worst, Length(run.Point(0, i) - track.offset[3 * f + size_t(i)]));
    }
    EXPECT_LT(worst, 2e-5) << name;  // times were rounded differently
  }
}

// Frames of many lengths: the solver follows; told that they are all alike, it does not.
TEST(RecordedRun, FrameTimesAreHonoured) {
  const StrandFile strand = ExampleChain();
  std::vector<RootSample> samples;
  const double lengths[] = {1.0 / 120, 1.0 / 30, 1.0 / 60, 1.0 / 90};
  double t = 0.0;
  for (size_t f = 0; t < 4.0; t += lengths[f++ % 4])
    samples.push_back(SampleOf(PoseOf(Motion::kHeadshake, t), t));
  const PointTrack exact = RunExact(strand, samples);
  const auto error_of = [&](const std::vector<RootSample>& seen) {
    return CompareTracks(samples, RunSolver(strand, seen, *FindSolver("modal-best"), BestIsa()),
                         exact);
  };
  const TrackError good = error_of(samples);
  std::vector<RootSample> alike = samples;
  for (size_t f = 0; f < alike.size(); ++f) alike[f].seconds = double(f) * t / double(alike.size());
  const TrackError bad = error_of(alike);
  std::printf("frames of 8 to 33 ms: modal, best, %.2f %% wrong; as if all alike: %.0f %%\n",
              100.0 * good.share, 100.0 * bad.share);
  EXPECT_LT(good.share, 0.05);
  EXPECT_GT(bad.share, 5.0 * good.share);
}

TEST(RecordedRun, PointsAreATableOfTheWorld) {
  const StrandFile strand = ParseStrand("length = 0.08\nlinks = 4\nfrequency_hz = 3\n", "s.toml");
  const std::vector<RootSample> samples = Record(Motion::kStill, 60.0, 1.0);
  const PointTrack track = RunSolver(strand, samples, *FindSolver("modal-fine"), BestIsa());
  const std::string text = PointsText(track);
  EXPECT_TRUE(
      text.starts_with("time,x0,y0,z0,x1,y1,z1,x2,y2,z2,x3,y3,z3,x4,y4,z4\n0,0,0,0,0,0.02,0"))
      << text.substr(0, 120);
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 62);
  EXPECT_EQ(std::count(text.begin(), text.end(), ','), 62 * 15);
  EXPECT_EQ(text.find("nan"), std::string::npos);
  EXPECT_EQ(CompareTracks(samples, track, track).worst, 0.0);
}

TEST(RecordedRun, UnknownChainsAreNotRun) {
  const StrandFile strand = ParseStrand(std::string(kGoodStrand) + "links = 8\n", "s.toml");
  const PointTrack track =
      RunSolver(strand, Record(Motion::kWalk, 60.0, 0.1), *FindSolver("xpbd-8"), BestIsa());
  EXPECT_EQ(track.links, 0);
}

TEST(RecordedRun, VelocitiesMakeAFewSamplesEnough) {
  StrandFile strand =
      ParseStrand("length = 0.03\nfrequency_hz = 12\ndrag = 10\nrod = \"uniform\"\n", "s.toml");
  const auto samples = Record(Motion::kHeadshake, 30.0, 3.0, true);
  auto unknown = samples;
  for (RootSample& sample : unknown) sample.rated = false, sample.velocity = sample.spin = kZero3;
  // Exact under the motion itself: samples so near each other that it matters no more.
  const auto dense = Record(Motion::kHeadshake, 960.0, 3.0, true);
  const PointTrack fine = RunExact(strand, dense);
  PointTrack exact{fine.links, {}, {}, {}};
  for (size_t f = 0; f < samples.size(); ++f)
    for (size_t i = 0; i < size_t(fine.links); ++i)
      exact.offset.push_back(fine.offset[32 * f * size_t(fine.links) + i]);
  NamedSolver solver = *FindSolver("modal-fine");
  const auto error_of = [&](const std::vector<RootSample>& seen) {
    solver.velocities = seen[0].rated;
    return CompareTracks(seen, RunSolver(strand, seen, solver, BestIsa()), exact).share;
  };
  const double with = error_of(samples), without = error_of(unknown);
  std::printf("30 Hz: %.2f %% wrong without velocities, %.2f with\n", 100 * without, 100 * with);
  EXPECT_LT(with, 0.02);
  EXPECT_GT(without, 0.03);
  EXPECT_LT(CompareTracks(samples, RunExact(strand, samples), exact).share, 0.02);
}

}  // namespace
}  // namespace pelt::accuracy
