#include "bench/accuracy/recorded_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/accuracy/reference_integrator.hpp"
#include "bench/accuracy/solver_run.hpp"
#include "core/random.hpp"

namespace pelt::accuracy {
namespace {

// The directions as they lie in the body's frame.
LinkDirections Unturned(const LinkDirections& directions, const BodyPose& pose) {
  LinkDirections own{};
  for (size_t i = 0; i < own.size(); ++i)
    own[i] = {Dot(pose.axis[0], directions[i]), Dot(pose.axis[1], directions[i]),
              Dot(pose.axis[2], directions[i])};
  return own;
}

void AddStart(const StrandFile& strand, const RootSample& sample, PointTrack& track) {
  const BodyPose pose = PoseOf(sample);
  const LinkDirections start = strand.StartIn(pose);
  track.links = strand.material.links;
  track.seconds.push_back(sample.seconds);
  track.root.push_back(pose.Place(strand.strand.root));
  Double3 at = kZero3;
  for (int i = 0; i < track.links; ++i)
    track.offset.push_back(at = at + start[size_t(i)] * strand.material.length[size_t(i)]);
}

}  // namespace

PointTrack RunSolver(const StrandFile& strand, const std::vector<RootSample>& samples,
                     const SolverFactory& factory) {
  const LinkDirections start = strand.StartIn(PoseOf(samples[0]));
  SolverRun run(factory, strand.material, samples[1].seconds - samples[0].seconds, {strand.strand},
                std::span(&start, 1), PoseOf(samples[0]));
  PointTrack track;
  if (!run.valid()) return track;
  AddStart(strand, samples[0], track);
  for (size_t f = 1; f < samples.size(); ++f) {
    const BodyPose pose = PoseOf(samples[f]);
    if (f > 1) run.SetFrameTime(samples[f].seconds - samples[f - 1].seconds);
    run.Step(pose);
    track.seconds.push_back(samples[f].seconds);
    track.root.push_back(pose.Place(strand.strand.root));
    for (int i = 0; i < track.links; ++i) track.offset.push_back(run.Point(0, i));
  }
  return track;
}

PointTrack RunExact(const StrandFile& strand, const std::vector<RootSample>& samples) {
  const RootSpline spline(samples);
  ChainProblem problem;
  problem.material = strand.material;
  problem.strand = strand.strand;
  problem.start = strand.StartIn(PoseOf(samples[0]));
  const int rate = ReferenceRate(strand.material);
  ReferenceIntegrator integrator(std::span(&problem, 1), rate);
  PointTrack track;
  AddStart(strand, samples[0], track);
  for (size_t f = 1; f < samples.size(); ++f) {
    const double begin = samples[f - 1].seconds, end = samples[f].seconds;
    integrator.SetMotion([&spline, f](double t) { return spline.At(t, f); });
    integrator.StepAcross(begin, end, std::max(1, int(std::ceil((end - begin) * rate))));
    track.seconds.push_back(end);
    track.root.push_back(PoseOf(samples[f]).Place(strand.strand.root));
    Double3 at = kZero3;
    for (int i = 0; i < track.links; ++i) {
      const auto& direction = integrator.state(0).direction;
      track.offset.push_back(at = at + direction[size_t(i)] * strand.material.length[size_t(i)]);
    }
  }
  return track;
}

std::string PointsText(const PointTrack& track) {
  std::string text = "time";
  for (int i = 0; i <= track.links; ++i) text += fmt::format(",x{0},y{0},z{0}", i);
  text += '\n';
  for (size_t f = 0; f < track.seconds.size(); ++f) {
    text += fmt::format("{:.9g}", track.seconds[f]);
    for (int i = 0; i <= track.links; ++i) {
      Double3 p = track.root[f];
      if (i > 0) p = p + track.offset[f * size_t(track.links) + size_t(i) - 1];
      text += fmt::format(",{:.9g},{:.9g},{:.9g}", p.x, p.y, p.z);
    }
    text += '\n';
  }
  return text;
}

TrackError CompareTracks(const StrandFile& strand, const std::vector<RootSample>& samples,
                         const PointTrack& track, const PointTrack& exact) {
  const LinkDirections own = Unturned(strand.StartIn(PoseOf(samples[0])), PoseOf(samples[0]));
  double off_squares = 0.0, moved_squares = 0.0, worst = 0.0;
  for (size_t f = 1; f < samples.size(); ++f) {
    const BodyPose pose = PoseOf(samples[f]);
    Double3 rigid = kZero3;
    for (int i = 0; i < exact.links; ++i) {
      const size_t at = f * size_t(exact.links) + size_t(i);
      rigid = rigid + pose.Turn(own[size_t(i)]) * strand.material.length[size_t(i)];
      const Double3 off = track.offset[at] - exact.offset[at], moved = exact.offset[at] - rigid;
      off_squares += Dot(off, off);
      moved_squares += Dot(moved, moved);
      worst = std::max(worst, Length(off));
    }
  }
  return {std::sqrt(off_squares / moved_squares), worst};
}

std::string ExampleStrand() {
  return "# A strand of fur for pelt accuracy --strand.\n"
         "length = 0.05         # m\n"
         "links = 3             # or 4; 8 for --exact\n"
         "frequency_hz = 3.0    # of the first bending mode\n"
         "damping_ratio = 0.05  # of that mode, by bending alone\n"
         "drag = 5.0            # 1/s, towards the wind\n"
         "root = [0.1, 0, 0]    # m, in the body's frame\n"
         "rest = [[0.8, 0.6, 0], [0.65, 0.75, 0.1], [0.45, 0.85, 0.25]]\n"
         "start = \"equilibrium\"\n";
}

std::vector<RootSample> ExampleRoots() {
  std::vector<RootSample> samples;
  Random random(1);
  for (double t = 0.0; t < 4.0; t += 1.0 / random.Uniform(50.0, 75.0)) {
    BodyPose pose = PoseOf(Motion::kHeadshake, t);
    pose.position = PoseOf(Motion::kDash, t).position;
    pose.wind = PoseOf(Motion::kWind, t).wind;
    samples.push_back(SampleOf(pose, t));
  }
  return samples;
}

}  // namespace pelt::accuracy
