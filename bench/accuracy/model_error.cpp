#include "bench/accuracy/model_error.hpp"

#include <algorithm>
#include <cmath>

#include "bench/accuracy/modal_solver.hpp"
#include "bench/accuracy/solver_run.hpp"

namespace pelt::accuracy {
namespace {

constexpr int kFramesPerSecond = 60;
// Of exact motions: halved, they change an error by less than 0.1 % of itself.
constexpr int kStepsPerFrame = 32;

struct Problem {
  RodProblem drawn;
  Preset preset;
  int frames;
};

// Displacements of the compared points from the shape at the start carried rigidly, m, frame after frame.
using Track = std::vector<Double3>;

void AddFrame(const CurveStrand& strand, double length, const BodyPose& pose,
              const UnknownVectors& start, const UnknownVectors& d, Track& track) {
  for (const UnknownRow& place : strand.place) {
    Double3 moved = kZero3;
    for (size_t i = 0; i < size_t(strand.count); ++i)
      moved = moved + (d[i] - pose.Turn(start[i])) * (place[i] * length);
    track.push_back(moved);
  }
}

Track MoveExactly(const CurveStrand& strand, const Problem& problem) {
  const CurveDynamics dynamics(strand, problem.preset, problem.drawn.rest);
  const double step = 1.0 / (kFramesPerSecond * kStepsPerFrame);
  const BodyMotion& motion = problem.drawn.motion;
  CurveMotion moving(dynamics, motion(0.0), step);
  const UnknownVectors start = moving.directions();
  Track track;
  int64_t steps = 0;
  for (int frame = 0; frame < problem.frames; ++frame) {
    for (int k = 0; k < kStepsPerFrame; ++k) moving.Step(motion(double(++steps) * step));
    AddFrame(strand, problem.preset.length, motion(double(steps) * step), start,
             moving.directions(), track);
  }
  return track;
}

// By the modal solver, a layer's links.
Track MoveBySolver(const CurveStrand& links, const Problem& problem, const SolverFactory& solver) {
  const CurveDynamics dynamics(links, problem.preset, problem.drawn.rest);
  const BodyMotion& motion = problem.drawn.motion;
  const UnknownVectors start = dynamics.Equilibrium(motion(0.0));
  const size_t n = size_t(links.count);
  Strand strand{problem.drawn.rest.root, {}};
  LinkDirections hung{};
  std::copy_n(dynamics.rest().begin(), n, strand.rest.begin());
  std::copy_n(start.begin(), n, hung.begin());
  SolverRun run(solver, MakeMaterial(problem.preset, links.count, Coefficients::kCalibrated),
                1.0 / kFramesPerSecond, {strand}, std::span(&hung, 1), motion(0.0));
  Track track;
  for (int frame = 1; frame <= problem.frames; ++frame) {
    const BodyPose pose = motion(double(frame) / kFramesPerSecond);
    run.Step(pose);
    UnknownVectors d{};
    Double3 above = kZero3;
    for (size_t i = 0; i < n; ++i) {
      const Double3 point = run.Point(0, int(i));
      d[i] = (point - above) * (double(n) / problem.preset.length);
      above = point;
    }
    AddFrame(links, problem.preset.length, pose, start, d, track);
  }
  return track;
}

double Distance(const Track& track, const Track& rod) {
  double off = 0.0, moved = 0.0;
  for (size_t i = 0; i < rod.size(); ++i) {
    const Double3 away = track[i] - rod[i];
    off += Dot(away, away);
    moved += Dot(rod[i], rod[i]);
  }
  return std::sqrt(off / moved);
}

struct Model {
  CurveStrand strand;
  bool is_of_layers;  // the kernels have it
};
std::vector<Model> Models() {
  return {{LinksOfStrand(3), true},
          {LinksOfStrand(4), true},
          {LinksOfStrand(8), true},
          {NodesOfStrand("3 nodes", kThreeNodes), false},
          {NodesOfStrand("3 stiff nodes", kThreeStiffNodes), false},
          {NodesOfStrand("4 nodes", kFourNodes), false}};
}

constexpr ModalQuality kMeasuredQualities[] = {ModalQuality::kFast, ModalQuality::kDefault,
                                               ModalQuality::kBest};

}  // namespace

ModelErrorTable MeasureModelError(const ModelErrorOptions& options) {
  const std::vector<Model> models = Models();
  const CurveStrand rod = RodOfStrand(), fine = LinksOfStrand(kPosedLinks);
  const size_t presets = options.presets.size();
  ModelErrorTable table;
  for (const MotionFamily family : options.families) {
    std::vector<std::vector<bool>> posed(presets);
    const size_t first = table.rows.size();
    for (const Model& model : models) {
      table.rows.push_back({family, model.strand.name, {}, {}});
      if (options.isa && model.is_of_layers)
        for (const ModalQuality quality : kMeasuredQualities)
          table.rows.push_back({family, model.strand.name, quality, {}});
    }
    for (size_t row = first; row < table.rows.size(); ++row) table.rows[row].errors.resize(presets);
    for (int index = 0; index < options.problems; ++index)
      for (size_t p = 0; p < presets; ++p) {
        Problem problem{DrawRodProblem(family, options.seed, index), options.presets[p],
                        int(options.seconds * kFramesPerSecond)};
        problem.preset.length *= problem.drawn.length_scale;
        const Track wanted = MoveExactly(rod, problem);
        posed[p].push_back(Distance(MoveExactly(fine, problem), wanted) < kPosedError);
        size_t row = first;
        for (const Model& model : models) {
          const CurveStrand& strand = model.strand;
          table.rows[row++].errors[p].push_back(Distance(MoveExactly(strand, problem), wanted));
          if (!options.isa || !model.is_of_layers) continue;
          for (const ModalQuality quality : kMeasuredQualities) {
            const SolverFactory solver = ModalFactory(ModalKernelsOf(*options.isa), quality);
            table.rows[row++].errors[p].push_back(
                Distance(MoveBySolver(strand, problem, solver), wanted));
          }
        }
      }
    table.posed.push_back(std::move(posed));
  }
  return table;
}

double PooledError(const ModelErrorRow& row, const ModelErrorOptions& options,
                   const std::vector<std::vector<bool>>& posed) {
  double sum = 0.0;
  int presets = 0;
  for (size_t p = 0; p < row.errors.size(); ++p) {
    if (options.presets[p].name == "stiff") continue;
    double squares = 0.0;
    int cases = 0;
    for (size_t i = 0; i < row.errors[p].size(); ++i) {
      if (!posed.empty() && !posed[p][i]) continue;
      squares += row.errors[p][i] * row.errors[p][i];
      ++cases;
    }
    if (cases == 0) continue;
    sum += squares / cases;
    ++presets;
  }
  return presets > 0 ? std::sqrt(sum / presets) : 0.0;
}

}  // namespace pelt::accuracy
