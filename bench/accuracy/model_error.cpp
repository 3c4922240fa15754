#include "bench/accuracy/model_error.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <span>

#include "bench/accuracy/solver_run.hpp"

namespace pelt::accuracy {
namespace {

constexpr int kFramesPerSecond = 60, kSettledFrames = 240;
// Of exact motions: halved, they change an error by less than 0.1 % of itself.
constexpr int kStepsPerFrame = 32;

struct Problem {
  RodProblem drawn;
  Preset preset;
  int frames;
  CurlModel curl;
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

Track MoveExactly(const CurveStrand& strand, const Problem& problem,
                  int steps_per_frame = kStepsPerFrame) {
  const CurveDynamics dynamics(strand, problem.preset, problem.drawn.rest, problem.curl);
  const double step = 1.0 / (kFramesPerSecond * steps_per_frame);
  const BodyMotion& motion = problem.drawn.motion;
  CurveMotion moving(dynamics, motion(0.0), step);
  const UnknownVectors start = moving.directions();
  Track track;
  int64_t steps = 0;
  for (int frame = 0; frame < problem.frames; ++frame) {
    for (int k = 0; k < steps_per_frame; ++k) moving.Step(motion(double(++steps) * step));
    AddFrame(strand, problem.preset.length, motion(double(steps) * step), start,
             moving.directions(), track);
  }
  return track;
}

struct Model {
  CurveStrand strand;
  int parts = 0;  // links, or those that a layer's strand is drawn as; 0: solvers have none
  bool nodes =
      false;  // by solvers as layers have them, which choose between two sets of three; else links
};

SolverFactory FactoryOf(const Model& model, const NamedSolver& solver, Isa isa) {
  return model.nodes ? LayerFactoryOf(solver, isa) : FactoryOf(solver, isa);
}

ChainMaterial MaterialOf(const Model& model, const Preset& preset, CurlModel curl) {
  ChainMaterial material = MakeMaterial(preset, model.parts, Coefficients::kCalibrated);
  material.curl = curl;
  return material;
}

// The groom of a layer: parts of equal length along the rest curve.
Double3 PartOf(const RestCurve& rest, int part, int parts) {
  constexpr int kSteps = 64;
  Double3 sum = kZero3;
  for (int k = 0; k < kSteps; ++k) sum = sum + rest.TangentAt((part + (k + 0.5) / kSteps) / parts);
  return Unit(sum);
}

Track MoveBySolver(const Model& model, const Problem& problem, const SolverFactory& solver) {
  const CurveDynamics dynamics(model.strand, problem.preset, problem.drawn.rest, problem.curl);
  const BodyMotion& motion = problem.drawn.motion;
  const UnknownVectors start = dynamics.Equilibrium(motion(0.0));
  const int parts = model.parts;
  Strand strand{problem.drawn.rest.root, {}};
  for (int i = 0; i < parts; ++i) strand.rest[size_t(i)] = PartOf(problem.drawn.rest, i, parts);
  LinkDirections hung{};
  std::copy_n(start.begin(), dynamics.count(), hung.begin());
  SolverRun run(solver, MaterialOf(model, problem.preset, problem.curl), 1.0 / kFramesPerSecond,
                {strand}, std::span(&hung, 1), motion(0.0));
  // The shape at the start, as the solver has it: a first frame in which nothing moves.
  std::array<Double3, kMaxLinks> hangs{};
  Track track;
  // It comes to its own rest first.
  for (int frame = -kSettledFrames; frame <= problem.frames; ++frame) {
    const BodyPose pose = motion(std::max(frame, 0) / double(kFramesPerSecond));
    run.Step(pose);
    std::array<Double3, kMaxLinks> at{};
    for (int i = 0; i < parts; ++i) at[size_t(i)] = run.Point(0, i);
    if (frame <= 0) {
      hangs = at;
      continue;
    }
    for (size_t p = 0; p < kComparedPoints; ++p) {
      const double place = double(p + 1) / kComparedPoints * parts;
      const int above = std::min(int(place - 1e-9), parts - 1);
      const auto between = [&](const std::array<Double3, kMaxLinks>& points) {
        const Double3 from = above == 0 ? kZero3 : points[size_t(above) - 1];
        return from + (points[size_t(above)] - from) * (place - above);
      };
      track.push_back(between(at) - pose.Turn(between(hangs)));
    }
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
  const double share = std::sqrt(off / moved);
  return std::isfinite(share) ? share : std::numeric_limits<double>::infinity();
}

// A row of the table: a model, and what moves it.
struct Entrant {
  Model model;
  std::optional<NamedSolver> solver = {};  // none: exactly
  int steps_per_frame = kStepsPerFrame;    // of exact motion
};

constexpr std::string_view kModal[] = {"modal", "modal-fine", "modal-best"};
constexpr std::string_view kRivals[] = {"pbd-4", "verlet-4", "textbook-pbd-4", "xpbd-8",
                                        "trapezoid-2"};

// What layers have first, the rod's own convergence last.
std::vector<Entrant> Entrants(bool by_solvers) {
  std::vector<Entrant> entrants;
  const auto add = [&](const Model& model, std::span<const std::string_view> solvers) {
    if (!by_solvers) return;
    for (const std::string_view name : solvers) entrants.push_back({model, FindSolver(name)});
  };
  const auto add_with_exact = [&](const Model& model) {
    add(model, kModal);
    entrants.push_back({model});
  };
  const Model three_links{LinksOfStrand(3), 3};
  add_with_exact({NodesOfStrand("3 nodes", kThreeNodes), 3, true});
  add_with_exact({NodesOfStrand("4 nodes", kFourNodes), 4, true});
  add({NodesOfStrand("4 nodes, 9 points", kFourNodes), 8, true}, kModal);
  add_with_exact(three_links);
  add_with_exact({LinksOfStrand(4), 4});
  add(three_links, kRivals);
  entrants.push_back({{NodesOfStrand("3 stiff nodes", kThreeStiffNodes)}});
  entrants.push_back({{LinksOfStrand(8)}});
  entrants.push_back({{CoarseRodOfStrand()}});
  entrants.push_back({{RodOfStrand()}, {}, 2 * kStepsPerFrame});
  entrants.back().model.strand.name = "rod, half steps";
  return entrants;
}

struct Case {
  Problem problem;
  Track rod;
  bool posed;
};

std::vector<Case> SolveCases(const ModelErrorOptions& options, MotionFamily family,
                             const Preset& preset) {
  const CurveStrand rod = RodOfStrand(), links = LinksOfStrand(kPosedLinks);
  std::vector<Case> cases;
  for (int index = 0; index < options.problems; ++index) {
    Problem problem{DrawRodProblem(family, options.seed, index), preset,
                    int(options.seconds * kFramesPerSecond), options.curl};
    if (options.rest_turn) problem.drawn.rest.turn = *options.rest_turn;
    if (options.motion) problem.drawn.motion = options.motion;
    problem.preset.length *= problem.drawn.length_scale;
    Track track = MoveExactly(rod, problem);
    const bool posed = Distance(MoveExactly(links, problem), track) < kPosedError;
    cases.push_back({std::move(problem), std::move(track), posed});
  }
  return cases;
}

struct Moved {
  std::optional<NamedSolver> solver;
  std::vector<double> errors;  // of each case
};

Moved MoveExactly(const Entrant& entrant, const std::vector<Case>& cases) {
  Moved moved;
  for (const Case& c : cases)
    moved.errors.push_back(
        Distance(MoveExactly(entrant.model.strand, c.problem, entrant.steps_per_frame), c.rod));
  return moved;
}

Moved MoveBySolver(const Entrant& entrant, const std::vector<Case>& cases, Isa isa) {
  Moved best;
  for (const NamedSolver& solver : TuningCandidates(*entrant.solver)) {
    std::vector<double> errors;
    const SolverFactory factory = FactoryOf(entrant.model, solver, isa);
    for (const Case& c : cases)
      errors.push_back(Distance(MoveBySolver(entrant.model, c.problem, factory), c.rod));
    if (best.solver && RootMeanSquare(errors) >= RootMeanSquare(best.errors)) continue;
    best = {solver, std::move(errors)};
  }
  return best;
}

ModelErrorPanel MeasureFamily(const ModelErrorOptions& options, MotionFamily family,
                              const std::vector<Entrant>& entrants) {
  ModelErrorPanel panel{family, {}, {}};
  for (const Entrant& entrant : entrants)
    panel.rows.push_back({entrant.model.strand.name, entrant.solver, {}});
  for (size_t p = 0; p < options.presets.size(); ++p) {
    const std::vector<Case> cases = SolveCases(options, family, options.presets[p]);
    std::vector<bool>& posed = panel.posed.emplace_back();
    for (const Case& c : cases) posed.push_back(c.posed);
    for (size_t e = 0; e < entrants.size(); ++e) {
      ModelErrorRow& row = panel.rows[e];
      Moved moved = entrants[e].solver ? MoveBySolver(entrants[e], cases, *options.isa)
                                       : MoveExactly(entrants[e], cases);
      if (p == TimedPreset(options)) row.solver = moved.solver;
      row.errors.push_back(std::move(moved.errors));
    }
  }
  return panel;
}

// All in turn, as tuned for the first family.
void AddTimes(const ModelErrorOptions& options, const std::vector<Entrant>& entrants,
              std::vector<ModelErrorPanel>& panels) {
  const Preset& preset = options.presets[TimedPreset(options)];
  std::map<int, TimedProblem> problems;  // by parts
  std::vector<TimedSolver> solvers;
  std::vector<size_t> rows;
  for (size_t row = 0; row < entrants.size(); ++row) {
    const Model& model = entrants[row].model;
    const std::optional<NamedSolver>& solver = panels[0].rows[row].solver;
    if (!solver) continue;
    TimedProblem& problem = problems[model.parts];
    if (problem.strands.empty())
      problem = HeadshakeProblem(MaterialOf(model, preset, options.curl));
    solvers.push_back({FactoryOf(model, *solver, *options.isa), &problem});
    rows.push_back(row);
  }
  const std::vector<SolverTime> times = TimeInTurn(solvers, *options.timing);
  for (ModelErrorPanel& panel : panels)
    for (size_t s = 0; s < rows.size(); ++s) panel.rows[rows[s]].ns = times[s].ns;
}

}  // namespace

ModelErrorTable MeasureModelError(const ModelErrorOptions& options) {
  const std::vector<Entrant> entrants = Entrants(options.isa.has_value());
  ModelErrorTable table;
  for (const MotionFamily family : options.families)
    table.panels.push_back(MeasureFamily(options, family, entrants));
  if (options.isa && options.timing) AddTimes(options, entrants, table.panels);
  return table;
}

size_t TimedPreset(const ModelErrorOptions& options) { return options.presets.size() / 2; }

bool IsParetoOptimal(const ModelErrorPanel& panel, const ModelErrorRow& row,
                     const ModelErrorOptions& options) {
  const double error = PooledError(row, options);
  return row.ns > 0.0 && std::isfinite(error) &&
         std::none_of(panel.rows.begin(), panel.rows.end(), [&](const ModelErrorRow& other) {
           return other.ns > 0.0 && other.ns <= row.ns && PooledError(other, options) < error;
         });
}

double RootMeanSquare(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += value * value;
  return values.empty() ? 0.0 : std::sqrt(sum / double(values.size()));
}

double PooledError(const ModelErrorRow& row, const ModelErrorOptions& options,
                   const std::vector<std::vector<bool>>& posed) {
  double sum = 0.0;
  int presets = 0;
  for (size_t p = 0; p < row.errors.size(); ++p) {
    if (options.presets.size() > 1 && options.presets[p].name == "stiff") continue;
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
