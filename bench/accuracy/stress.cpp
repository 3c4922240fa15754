#include "bench/accuracy/stress.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/accuracy/reference_integrator.hpp"
#include "bench/accuracy/solver_run.hpp"
#include "core/exact_math.hpp"
#include "core/random.hpp"

namespace pelt::accuracy {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kCalmSeconds = 8.0;
constexpr double kViolentSeconds = 3.6;  // the violent motion has ended by then

Double3 RandomUnit(Random& random) {
  const double z = random.Uniform(-1.0, 1.0), a = random.Uniform(0.0, 2.0 * kPi);
  const double across = std::sqrt(1.0 - z * z);
  return {across * exact::Cos(a), z, across * exact::Sin(a)};
}

// A still pose, moved and turned.
BodyPose PlacedPose(Double3 position, Double3 axis, double angle) {
  BodyPose pose = StillPose();
  pose.position = position;
  for (Double3& a : pose.axis) a = TurnAbout(a, axis, angle);
  return pose;
}

StressProblem Basic(std::string name, const ChainMaterial& material, uint64_t seed, int strands) {
  StressProblem p{std::move(name),
                  material,
                  SeededStrands(material.links, strands, seed),
                  {},
                  {},
                  true,
                  0.0,
                  0.0,
                  60};
  for (const Strand& strand : p.strands) p.start.push_back(FindEquilibrium(material, strand));
  p.pose = [](double, size_t) { return StillPose(); };
  return p;
}

void SetCalm(double calm_from, StressProblem& p) {
  p.calm_from = calm_from;
  p.seconds = calm_from + kCalmSeconds;
}

// Links point anywhere; the root jumps by up to ten lengths and turns anyhow, four times per second.
StressProblem RandomStarts(std::string_view what, const ChainMaterial& material,
                           const StressOptions& options, int strands) {
  StressProblem p =
      Basic(fmt::format("{} random starts, {}", strands, what), material, options.seed, strands);
  for (int s = 0; s < strands; ++s) {
    Random random(MixSeed(options.seed + 1, uint64_t(s)));
    for (int i = 0; i < options.links; ++i) p.start[size_t(s)][size_t(i)] = RandomUnit(random);
  }
  p.same_pose = false;
  const double reach = 10.0 * material.TotalLength();
  SetCalm(2.0, p);
  p.pose = [=, calm = p.calm_from, seed = options.seed + 2](double t, size_t strand) {
    const uint64_t jump = uint64_t(std::min(t, calm) * 4.0 + 1e-9);
    if (jump == 0) return StillPose();
    Random random(MixSeed(MixSeed(seed, strand), jump));
    const Double3 to = RandomUnit(random) * (reach * random.Uniform());
    const Double3 axis = RandomUnit(random);
    return PlacedPose(to, axis, random.Uniform(0.0, kPi));
  };
  return p;
}

// So short and limp that links swing on their weight faster than a solver's steps follow.
ChainMaterial Limp(int links, double length) {
  ChainMaterial material = MakeMaterial(kPresets[0], links);
  ScaleToFrequency(1.0, material);
  const double scale = length / material.TotalLength();
  for (double& l : material.length) l *= scale;
  for (double& k : material.stiffness) k *= scale * scale;
  return material;
}

StressProblem Teleport(const StressOptions& options) {
  StressProblem p = Basic("teleport, 5 m and half a turn", MakeMaterial(kPresets[2], options.links),
                          options.seed, 64);
  p.pose = [](double t, size_t) {
    if (t < 0.5) return StillPose();
    return PlacedPose({3.0, 0.0, 4.0}, {0.0, 1.0, 0.0}, kPi);
  };
  SetCalm(0.5, p);
  return p;
}

StressProblem Jitter(const StressOptions& options) {
  StressProblem p = Basic("root jitter, 2 cm of white noise",
                          MakeMaterial(kPresets[2], options.links), options.seed, 64);
  SetCalm(2.0, p);
  p.pose = [calm = p.calm_from, seed = options.seed](double t, size_t) {
    if (t >= calm) return StillPose();
    Random random(MixSeed(seed, uint64_t(std::lround(t * 1e4))));
    const auto noise = [&] { return random.Uniform(-0.02, 0.02); };
    const double x = noise(), y = noise(), z = noise();
    return PlacedPose({x, y, z}, {0.0, 1.0, 0.0}, 0.0);
  };
  return p;
}

// Masses and stiffnesses from the root to the tip in a geometric series.
ChainMaterial Graded(ChainMaterial material, double mass_ratio, double stiffness_ratio) {
  double total = 0.0;
  for (int i = 0; i < material.links; ++i) {
    const double share = double(i) / (material.links - 1);
    material.mass[i] = exact::Pow(mass_ratio, share);
    material.stiffness[i] *= exact::Pow(stiffness_ratio, share);
    total += material.mass[i];
  }
  for (int i = 0; i < material.links; ++i) material.mass[i] /= total;
  return material;
}

StressProblem Violent(std::string name, const ChainMaterial& material,
                      const StressOptions& options) {
  StressProblem p = Basic(std::move(name), material, options.seed, 64);
  p.pose = [](double t, size_t) { return PoseOf(Motion::kViolent, t); };
  SetCalm(kViolentSeconds, p);
  return p;
}

StressProblem Folded(const StressOptions& options) {
  StressProblem p =
      Basic("folded start", MakeMaterial(kPresets[2], options.links), options.seed, 64);
  for (auto& start : p.start)
    for (int i = 1; i < options.links; ++i) start[size_t(i)] = -start[size_t(i) - 1];
  SetCalm(0.0, p);
  return p;
}

// Strands as layers have them, let go in their rest shape on a body that stands still; the first
// ones straight and sideways, the rest curled.
StressProblem LetGo(std::string name, const ChainMaterial& material, const StressOptions& options) {
  StressProblem p = Basic(std::move(name), material, options.seed, 64);
  for (size_t s = 0; s < p.strands.size(); ++s) {
    if (s < 8) {
      const double turn = 0.25 * kPi * double(s);
      p.strands[s].rest.fill({exact::Cos(turn), 0.0, exact::Sin(turn)});
    }
    p.start[s] = p.strands[s].rest;
  }
  SetCalm(0.0, p);
  return p;
}

void AddCalibrated(const StressOptions& options, std::vector<StressProblem>& problems) {
  for (const Preset& preset : kPresets) {
    ChainMaterial material = MakeMaterial(preset, options.links, Coefficients::kCalibrated);
    problems.push_back(
        LetGo(fmt::format("calibrated, let go, {}", preset.name), material, options));
    material.bending_damping = 0.0;
    problems.push_back(
        LetGo(fmt::format("calibrated, let go, {}, drag only", preset.name), material, options));
  }
}

// ---- Running ---------------------------------------------------------------------------------

// Tangential force on a link over its weight and stiffness: about the angle it is off by, rad.
double OffBalance(const ChainDynamics& dynamics, const BodyPose& pose,
                  const LinkDirections& direction) {
  LinkDirections rest{}, bend{};
  const int n = dynamics.material().links;
  for (int i = 0; i < n; ++i) rest[i] = pose.Turn(dynamics.strand().rest[i]);
  dynamics.Bend(direction, rest, bend);
  double off = 0.0;
  for (int i = 0; i < n; ++i) {
    const Double3 weight = dynamics.material().gravity * dynamics.matrices().pull[i];
    const Double3 force = bend[i] + weight;
    const auto& stiffness = dynamics.material().stiffness;
    const double scale = Length(weight) + stiffness[i] + (i + 1 < n ? stiffness[i + 1] : 0.0);
    off = std::max(off, Length(force - direction[i] * Dot(direction[i], force)) / scale);
  }
  return off;
}

class StressRun {
 public:
  StressRun(const StressProblem& problem, const SolverFactory& factory, bool links)
      : problem_(problem),
        links_(links),
        poses_(problem.strands.size()),
        bad_(problem.strands.size(), false),
        run_(factory, problem.material, 1.0 / problem.frames_per_second, problem.strands,
             problem.start, problem.pose(0.0, 0)) {}

  StressResult Run() {
    StressResult result;
    result.ran = run_.valid();
    if (!result.ran) return result;
    const int frames = int(std::lround(problem_.seconds * problem_.frames_per_second));
    for (int f = 1; f <= frames; ++f) {
      StepTo(double(f) / problem_.frames_per_second);
      Inspect(result);
      history_.push_back(Positions());
    }
    Judge(result);
    return result;
  }

 private:
  void StepTo(double t) {
    if (problem_.same_pose) return run_.Step(poses_[0] = problem_.pose(t, 0));
    for (size_t s = 0; s < poses_.size(); ++s) poses_[s] = problem_.pose(t, s);
    run_.Step(poses_);
  }
  const BodyPose& PoseOf(size_t strand) const { return poses_[problem_.same_pose ? 0 : strand]; }

  void Inspect(StressResult& result) {
    for (size_t s = 0; s < bad_.size(); ++s) {
      Double3 upper = kZero3;
      for (int i = 0; i < problem_.material.links; ++i) {
        const Double3 point = run_.Point(s, i);
        if (!IsFinite(point)) {
          bad_[s] = true;
          break;
        }
        const double stretch = Length(point - upper) / problem_.material.length[i] - 1.0;
        result.worst_stretch = std::max(result.worst_stretch, stretch);
        upper = point;
      }
    }
  }
  std::vector<Double3> Positions() const {
    std::vector<Double3> points;
    for (size_t s = 0; s < bad_.size(); ++s)
      for (int i = 0; i < problem_.material.links; ++i) points.push_back(run_.Point(s, i));
    return points;
  }

  void Judge(StressResult& result) {
    const int n = problem_.material.links;
    const double length = problem_.material.TotalLength();
    const std::vector<Double3>& last = history_.back();
    const std::vector<Double3>& before = history_[history_.size() - 2];
    for (size_t s = 0; s < bad_.size(); ++s) {
      if (bad_[s]) {
        ++result.non_finite;
        continue;
      }
      double moved = 0.0;
      LinkDirections direction{};
      for (int i = 0; i < n; ++i) {
        const size_t at = s * size_t(n) + size_t(i);
        moved = std::max(moved, Length(last[at] - before[at]));
        direction[i] = Unit(last[at] - (i > 0 ? last[at - 1] : kZero3));
      }
      const ChainDynamics dynamics(problem_.material, problem_.strands[s]);
      const double off = links_ ? OffBalance(dynamics, PoseOf(s), direction) : 0.0;
      result.worst_off_balance = std::max(result.worst_off_balance, off);
      if (moved > 1e-4 * length) {
        ++result.unsettled;
      } else if (off > 0.1) {
        ++result.stuck;
      }
    }
    result.recovery_seconds = Recovery();
  }

  double Recovery() const {
    const std::vector<Double3>& last = history_.back();
    const double near = 0.01 * problem_.material.TotalLength();
    const size_t links = size_t(problem_.material.links);
    size_t frame = history_.size();
    while (frame > 0) {
      bool away = false;
      for (size_t i = 0; i < last.size(); ++i)
        away = away || (!bad_[i / links] && !(Length(history_[frame - 1][i] - last[i]) <= near));
      if (away) break;
      --frame;
    }
    return std::max(double(frame) / problem_.frames_per_second - problem_.calm_from, 0.0);
  }

  const StressProblem& problem_;
  const bool links_;
  std::vector<BodyPose> poses_;
  std::vector<bool> bad_;
  SolverRun run_;
  std::vector<std::vector<Double3>> history_;
};

}  // namespace

std::vector<StressProblem> StressProblems(const StressOptions& options) {
  std::vector<StressProblem> problems;
  const int share = (options.random_starts + 3) / 4;
  for (const Preset& preset : kPresets)
    problems.push_back(
        RandomStarts(preset.name, MakeMaterial(preset, options.links), options, share));
  for (const int millimetres : {1, 4, 12})
    problems.push_back(RandomStarts(fmt::format("limp, {} mm long", millimetres),
                                    Limp(options.links, 1e-3 * millimetres), options, 64));
  problems.push_back(Teleport(options));
  const ChainMaterial medium = MakeMaterial(kPresets[2], options.links);
  for (const int rate : options.frame_rates) {
    problems.push_back(Violent(fmt::format("violent motion, {} fps", rate), medium, options));
    problems.back().frames_per_second = rate;
  }
  problems.push_back(Jitter(options));
  ChainMaterial hard = medium;
  ScaleToFrequency(1000.0, hard);
  problems.push_back(Violent("first mode at 1,000 Hz", hard, options));
  problems.push_back(
      Violent("stiffness ratio 1e6, softer to the tip", Graded(medium, 1.0, 1e-6), options));
  problems.push_back(
      Violent("stiffness ratio 1e6, harder to the tip", Graded(medium, 1.0, 1e6), options));
  problems.push_back(
      Violent("mass ratio 1e4, lighter to the tip", Graded(medium, 1e-4, 1.0), options));
  problems.push_back(
      Violent("mass ratio 1e4, heavier to the tip", Graded(medium, 1e4, 1.0), options));
  problems.push_back(Folded(options));
  if (options.calibrated) AddCalibrated(options, problems);
  return problems;
}

std::vector<std::string> BrokenPromises(const StressResult& result) {
  std::vector<std::string> broken;
  if (!result.ran) broken.push_back("not run");
  if (result.non_finite > 0) broken.push_back("not finite");
  if (result.unsettled > 0) broken.push_back("unsettled");
  if (!(result.worst_stretch <= kMostPromisedStretch)) broken.push_back("stretched");
  return broken;
}

StressResult RunStress(const StressProblem& problem, const SolverFactory& factory, bool links) {
  return StressRun(problem, factory, links).Run();
}

}  // namespace pelt::accuracy
