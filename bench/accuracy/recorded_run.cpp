#include "bench/accuracy/recorded_run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/accuracy/curve_motion.hpp"
#include "bench/accuracy/reference_integrator.hpp"
#include "bench/accuracy/solver_run.hpp"
#include "core/random.hpp"

namespace pelt::accuracy {
namespace {

// In the body's frame.
Double3 Unturned(const BodyPose& pose, Double3 v) {
  return {Dot(pose.axis[0], v), Dot(pose.axis[1], v), Dot(pose.axis[2], v)};
}

// Points that link directions lead to, the root first.
std::vector<Double3> PointsAlong(const StrandFile& strand, const LinkDirections& direction) {
  std::vector<Double3> points = {kZero3};
  for (int i = 0; i < strand.material.links; ++i)
    points.push_back(points.back() + direction[size_t(i)] * strand.material.length[size_t(i)]);
  return points;
}

void AddFrame(const StrandFile& strand, const RootSample& sample, PointTrack& track) {
  track.links = strand.material.links;
  track.seconds.push_back(sample.seconds);
  track.root.push_back(PoseOf(sample).Place(strand.strand.root));
}
void AddPoints(const StrandFile& strand, const RootSample& sample,
               const std::vector<Double3>& points, PointTrack& track) {
  AddFrame(strand, sample, track);
  track.offset.insert(track.offset.end(), points.begin() + 1, points.end());
}

// The rod, or nodes that stand for it.
class Curve {
 public:
  Curve(const StrandFile& strand, const CurveStrand& model)
      : strand_(strand),
        at_(model.at),
        groom_(PointsAlong(strand, strand.strand.rest)),
        dynamics_(model, MaterialOf(strand), RestOf(strand), CurlModel::kRoot,
                  {.gravity = strand.material.gravity}) {}

  const CurveDynamics& dynamics() const { return dynamics_; }
  UnknownVectors StartIn(const BodyPose& pose) const {
    if (strand_.start == StrandFile::Start::kEquilibrium) return dynamics_.Equilibrium(pose);
    const RestShape shape = ThroughPoints(PointsAlong(strand_, strand_.StartIn(pose)));
    UnknownVectors start{};
    for (size_t i = 0; i < dynamics_.count(); ++i) start[i] = shape.tangent_at(at_[i]);
    return start;
  }
  // Of the rod alone.
  std::vector<Double3> Points(const BodyPose& pose, const UnknownVectors& direction) const {
    std::vector<Double3> points = groom_;
    for (size_t k = 1; k < points.size(); ++k) {
      const UnknownRow place = RodPlaceAt(double(k) / double(points.size() - 1));
      points[k] = pose.Turn(points[k]);
      for (size_t i = 0; i < dynamics_.count(); ++i)
        points[k] = points[k] + (direction[i] - pose.Turn(dynamics_.rest()[i])) *
                                    (place[i] * dynamics_.length());
    }
    return points;
  }

 private:
  static Preset MaterialOf(const StrandFile& strand) {
    const ChainMaterial& m = strand.material;
    const double omega = MatricesOf(m).omega[0];
    return {"", m.TotalLength(), omega / (2.0 * exact::kPi), m.drag,
            0.5 * m.bending_damping * omega};
  }
  static RestShape RestOf(const StrandFile& strand) {
    RestShape shape = ThroughPoints(PointsAlong(strand, strand.strand.rest));
    shape.root = strand.strand.root;
    return shape;
  }

  const StrandFile& strand_;
  UnknownRow at_;
  std::vector<Double3> groom_;
  CurveDynamics dynamics_;
};

// As LayerFactory chooses them.
CurveStrand NodesOf(const StrandFile& strand) {
  const ChainMaterial& m = strand.material;
  if (m.links > 3) return NodesOfStrand("", kFourNodes);
  const double hz = MatricesOf(m).omega[0] / (2.0 * exact::kPi);
  const bool stiff = GammaOf(hz, m.TotalLength(), Length(m.gravity)) < kStiffGamma;
  return NodesOfStrand("", stiff ? kThreeStiffNodes : kThreeNodes);
}

// What a solver's strand starts along: links, or nodes.
LinkDirections StartOf(const StrandFile& strand, const NamedSolver& solver, const BodyPose& pose) {
  if (!strand.rod || solver.family != Family::kModal) return strand.StartIn(pose);
  const UnknownVectors nodes = Curve(strand, NodesOf(strand)).StartIn(pose);
  LinkDirections start{};
  std::copy_n(nodes.begin(), kMaxNodes, start.begin());
  return start;
}

PointTrack RunRod(const StrandFile& strand, const std::vector<RootSample>& samples) {
  constexpr double kStepsPerSecond = 1920.0;
  const RootSpline spline(samples);
  const Curve rod(strand, RodOfStrand());
  const double begin = samples.front().seconds, seconds = samples.back().seconds - begin;
  const double step = seconds / std::ceil(seconds * kStepsPerSecond);
  const BodyPose first = PoseOf(samples[0]);
  CurveMotion motion(rod.dynamics(), first, step, rod.StartIn(first));
  PointTrack track;
  std::vector<Double3> before, after = rod.Points(first, motion.directions());
  AddPoints(strand, samples[0], after, track);
  double now = begin;
  int64_t steps = 0;
  for (size_t f = 1; f < samples.size(); ++f) {
    const double end = samples[f].seconds;
    while (now < end - 1e-9 * step) {
      before = std::move(after);
      now = begin + double(++steps) * step;
      const BodyPose pose = spline.At(now);
      motion.Step(pose);
      after = rod.Points(pose, motion.directions());
    }
    // Steps do not end where frames do. In one, a point leaves the line by some 1e-8 m.
    const double left = (now - end) / step;
    AddFrame(strand, samples[f], track);
    for (size_t k = 1; k < after.size(); ++k)
      track.offset.push_back(after[k] + (before[k] - after[k]) * left);
  }
  return track;
}

PointTrack RunChain(const StrandFile& strand, const std::vector<RootSample>& samples) {
  const RootSpline spline(samples);
  ChainProblem problem;
  problem.material = strand.material;
  problem.strand = strand.strand;
  problem.start = strand.StartIn(PoseOf(samples[0]));
  const int rate = ReferenceRate(strand.material);
  ReferenceIntegrator integrator(std::span(&problem, 1), rate);
  PointTrack track;
  AddPoints(strand, samples[0], PointsAlong(strand, problem.start), track);
  for (size_t f = 1; f < samples.size(); ++f) {
    const double begin = samples[f - 1].seconds, end = samples[f].seconds;
    integrator.SetMotion([&spline, f](double t) { return spline.At(t, f); });
    integrator.StepAcross(begin, end, std::max(1, int(std::ceil((end - begin) * rate))));
    AddPoints(strand, samples[f], PointsAlong(strand, integrator.state(0).direction), track);
  }
  return track;
}

}  // namespace

PointTrack RunSolver(const StrandFile& strand, const std::vector<RootSample>& samples,
                     const NamedSolver& solver, Isa isa) {
  const BodyPose first = PoseOf(samples[0]);
  const LinkDirections start = StartOf(strand, solver, first);
  SolverRun run(strand.rod ? LayerFactoryOf(solver, isa) : FactoryOf(solver, isa), strand.material,
                samples[1].seconds - samples[0].seconds, {strand.strand}, std::span(&start, 1),
                first);
  PointTrack track;
  if (!run.valid()) return track;
  AddPoints(strand, samples[0], PointsAlong(strand, strand.StartIn(first)), track);
  for (size_t f = 1; f < samples.size(); ++f) {
    if (f > 1) run.SetFrameTime(samples[f].seconds - samples[f - 1].seconds);
    run.Step(PoseOf(samples[f]));
    AddFrame(strand, samples[f], track);
    for (int i = 0; i < track.links; ++i) track.offset.push_back(run.Point(0, i));
  }
  return track;
}

PointTrack RunExact(const StrandFile& strand, const std::vector<RootSample>& samples) {
  return strand.rod ? RunRod(strand, samples) : RunChain(strand, samples);
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

TrackError CompareTracks(const std::vector<RootSample>& samples, const PointTrack& track,
                         const PointTrack& exact) {
  const BodyPose first = PoseOf(samples[0]);
  double off_squares = 0.0, moved_squares = 0.0, worst = 0.0;
  for (size_t f = 1; f < samples.size(); ++f) {
    const BodyPose pose = PoseOf(samples[f]);
    for (int i = 0; i < exact.links; ++i) {
      const size_t at = f * size_t(exact.links) + size_t(i);
      const Double3 rigid = pose.Turn(Unturned(first, exact.offset[size_t(i)]));
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
         "links = 3             # parts that are seen; or 4, 8\n"
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
