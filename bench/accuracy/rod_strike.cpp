// Strands and a rod that a ball strikes.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "bench/accuracy/rod_contact.hpp"
#include "bench/accuracy/solver_run.hpp"
#include "core/error.hpp"
#include "core/modal/modal_material.hpp"

namespace pelt::accuracy {
namespace {

constexpr int kStrikeRate = 60, kStrikeSettles = 240;  // of a path; its points while it settles
constexpr double kStrikeGravity = 9.81, kStrikeUnder = 0.5;  // of the radius
// How far before the place that it hits the ball begins, radii.
constexpr double kStrikeBefore = 1.2;

struct Strike {
  StrikeCase from;
  RodAmongWalls rod;
  Double3 hit;         // where the ball's middle passes below the place, lengths
  double length_rate;  // the ball's speed, lengths/s

  explicit Strike(const StrikeCase& c) : from(c) {
    const Preset& preset = c.preset;
    const double gamma = GammaOf(preset.frequency, preset.length, kStrikeGravity);
    rod = {{kZero3, {1.0, 0.0, 0.0}, {0.0, 1.0, 0.0}, 0.0}, {0.0, -gamma, 0.0}};
    constexpr int kLinks = 32;
    hit = FindRest(rod, kLinks).At(c.at) - Double3{0.0, kStrikeUnder * kStrikeRadius, 0.0};
    length_rate = c.speed / preset.length;
  }
  Double3 BallAt(double seconds) const {
    return hit + Double3{0.0, 0.0, length_rate * seconds - kStrikeBefore * kStrikeRadius};
  }
};

// The tip 60 times a second; the first where it hangs. Lengths.
using TipPath = std::vector<Double3>;

TipPath RodPath(const Strike& strike, int links, int steps_per_second, double seconds) {
  const Preset& preset = strike.from.preset;
  // Seconds of the rod's unit of time.
  const double unit = kRodFrequency1 / (2.0 * std::numbers::pi * preset.frequency);
  const auto ball = [&](double t) {
    return std::vector<RodWall>{OutsideBall(strike.BallAt(t), kStrikeRadius)};
  };
  RodAmongWalls rod = strike.rod;
  rod.walls = ball(0.0);
  RodMotion motion(rod, {preset.drag * unit, 2.0 * preset.damping_ratio / kRodFrequency1}, links,
                   1.0 / (steps_per_second * unit));
  TipPath path = {motion.Shape().point.back()};
  const int steps = int(std::lround(seconds * kStrikeRate)) * steps_per_second / kStrikeRate;
  for (int step = 1; step <= steps; ++step) {
    motion.Step(ball(double(step) / steps_per_second));
    if (step % (steps_per_second / kStrikeRate) == 0) path.push_back(motion.Shape().point.back());
  }
  return path;
}

double OffTip(const TipPath& path, const TipPath& rod) {
  double off = 0.0, gone = 0.0;
  for (size_t i = 1; i < rod.size(); ++i) {
    const Double3 away = path[i] - rod[i], way = rod[i] - rod[0];
    off += Dot(away, away);
    gone += Dot(way, way);
  }
  return std::sqrt(off / gone);
}

// It comes to its own rest first; the ball is far off.
TipPath StrandPath(const Strike& strike, const RestModel& model, const ModalKernels& kernels,
                   ModalQuality quality, int rate, double seconds) {
  const double length = strike.from.preset.length;
  const double settled = double(kStrikeSettles) / kStrikeRate;
  ModalFeatures features;
  features.sphere_radius = kStrikeRadius * length;
  features.going = {0.0, 0.0, strike.from.speed};
  features.sphere_centre = strike.BallAt(-settled) * length;
  Strand strand{kZero3, {}};
  LinkDirections start{};
  for (int i = 0; i < model.parts; ++i) strand.rest[size_t(i)] = start[size_t(i)] = {1.0, 0.0, 0.0};
  const SolverFactory factory = model.nodes ? LayerFactory(kernels, quality, features)
                                            : ModalFactory(kernels, quality, features);
  const BodyPose pose = StillPose();
  SolverRun run(factory, MakeMaterial(strike.from.preset, model.parts, Coefficients::kCalibrated),
                1.0 / rate, {strand}, std::span(&start, 1), pose);
  if (!run.valid()) throw Error("no kernel for " + model.name);
  TipPath path;
  const int points = kStrikeSettles + int(std::lround(seconds * kStrikeRate));
  for (int point = 1; point <= points; ++point) {
    for (int frame = 0; frame < rate / kStrikeRate; ++frame) run.Step(pose);
    if (point >= kStrikeSettles) path.push_back(run.Point(0, model.parts - 1) * (1.0 / length));
  }
  return path;
}

}  // namespace

std::vector<StrikeCase> StrikeCases() {
  std::vector<StrikeCase> cases;
  for (size_t preset = 0; preset < 3; ++preset)
    for (const double at : {0.5, 0.8})
      for (const double speed : {0.5, 1.5}) cases.push_back({kPresets[preset], at, speed});
  return cases;
}

StrikeErrorTable MeasureStrikes(const std::vector<StrikeCase>& cases, Isa isa,
                                const StrikeOptions& options) {
  const ModalKernels kernels = ModalKernelsOf(isa);
  const int links = options.links, steps = options.steps_per_second;
  StrikeErrorTable table;
  for (const RestModel& model : options.models)
    for (const ModalQuality quality :
         {ModalQuality::kFast, ModalQuality::kFine, ModalQuality::kBest})
      for (const int rate : options.rates) table.rows.push_back({model.name, quality, rate, {}});
  for (const StrikeCase& c : cases) {
    const Strike strike(c);
    const TipPath rod = RodPath(strike, links, steps, options.seconds);
    if (options.self_errors) {
      table.step_errors.push_back(OffTip(RodPath(strike, links, steps / 2, options.seconds), rod));
      table.link_errors.push_back(
          OffTip(RodPath(strike, links * 3 / 4, steps, options.seconds), rod));
    }
    auto row = table.rows.begin();
    for (const RestModel& model : options.models)
      for (size_t i = 0; i < 3 * options.rates.size(); ++i, ++row)
        row->errors.push_back(OffTip(
            StrandPath(strike, model, kernels, row->quality, row->rate, options.seconds), rod));
  }
  return table;
}

}  // namespace pelt::accuracy
