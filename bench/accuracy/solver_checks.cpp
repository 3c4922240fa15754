#include "bench/accuracy/solver_checks.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "bench/accuracy/dop853.hpp"
#include "bench/accuracy/solver_timing.hpp"
#include "core/exact_math.hpp"

namespace pelt::accuracy {

// ---- Cantilever ------------------------------------------------------------------------------

namespace {

// From the free end: with tau = 1 - s and phi = pi/2 - theta, phi'' = Gamma tau sin phi from
// phi'(0) = 0. Shooting from the clamp would magnify rounding by exp(2/3 sqrt Gamma); from the tip
// only the small angle phi(0) shrinks that way, and its logarithm is found without loss.
struct Rod {
  double gamma, target;  // phi at the clamp
  int steps;

  // phi, phi', integral of cos phi, of sin phi at the clamp; phi stays above `target` once there.
  std::array<double, 4> Shoot(double tip_angle) const {
    std::array<double, 4> y = {tip_angle, 0.0, 0.0, 0.0};
    const double h = 1.0 / steps;
    for (int i = 0; i < steps && y[0] <= target; ++i)
      dop853::Step<4>(
          [this](double tau, const std::array<double, 4>& at, std::array<double, 4>& slope) {
            slope = {at[1], gamma * tau * exact::Sin(at[0]), exact::Cos(at[0]), exact::Sin(at[0])};
          },
          i * h, h, y);
    return y;
  }
};

}  // namespace

Sag SolveElastica(double gamma, double clamp_angle) {
  Rod rod{gamma, 0.5 * std::numbers::pi - clamp_angle, 0};
  rod.steps = 200 + int(30.0 * std::sqrt(gamma));
  double high = exact::Log(rod.target), low = high - std::sqrt(gamma) - 5.0;
  for (int i = 0; i < 100 && high - low > 4e-16 * std::abs(high + low); ++i) {
    const double middle = 0.5 * (low + high);
    (rod.Shoot(exact::Exp(middle))[0] > rod.target ? high : low) = middle;
  }
  const std::array<double, 4> end = rod.Shoot(exact::Exp(low));
  return {end[2], end[3]};
}

Sag SolveChainSag(ChainMaterial material, double gamma, double bending_stiffness, double density,
                  double clamp_angle) {
  const double length = material.TotalLength();
  const double weight = gamma * bending_stiffness / (density * length * length * length);
  material.gravity = {0.0, -weight, 0.0};
  Strand strand;
  for (Double3& rest : strand.rest) rest = {exact::Cos(clamp_angle), -exact::Sin(clamp_angle), 0.0};
  const auto direction = FindEquilibrium(material, strand);
  Double3 tip = kZero3;
  for (int i = 0; i < material.links; ++i) tip = tip + direction[i] * material.length[i];
  return {-tip.y / length, tip.x / length};
}

namespace {

constexpr std::string_view kQualityNames[3] = {"modal", "modal-fine", "modal-best"};

double SagRatioError(const ChainMaterial& material, double gamma) {
  const Sag rod = SolveElastica(gamma), chain = SolveChainSag(material, gamma, 1.0, 1.0);
  return std::abs(chain.drop / chain.reach / (rod.drop / rod.reach) - 1.0);
}

// A layer's strand, clamped horizontally, comes to rest under its own weight, at 60 frames per second; damped, so
// that it is at rest in time.
double RestMiss(int links, double gamma, std::string_view solver, Isa isa) {
  constexpr double kLength = 0.05, kGravity = 9.81, kDensity = 1.0 / kLength;
  ChainMaterial material = CalibratedRod(
      links, kLength, kDensity * kGravity * kLength * kLength * kLength / gamma, kDensity);
  material.gravity = {0.0, -kGravity, 0.0};
  material.drag = 3.0;
  Strand strand;
  for (Double3& rest : strand.rest) rest = {1.0, 0.0, 0.0};
  SolverRun run(LayerFactoryOf(*FindSolver(solver), isa), material, 1.0 / 60, {strand},
                std::span(&strand.rest, 1), StillPose());
  for (int f = 0; f < 20 * 60; ++f) run.Step(StillPose());
  const Sag rod = SolveElastica(gamma);
  return Length(run.Point(0, links - 1) * (1.0 / kLength) - Double3{rod.reach, -rod.drop, 0.0});
}

}  // namespace

std::vector<CantileverRow> MeasureCantilever(Isa isa) {
  std::vector<CantileverRow> rows;
  for (const int links : {3, 4, 8}) {
    const ChainMaterial rod = CalibratedRod(links, 1.0, 1.0, 1.0);
    const ChainMaterial naive = NaiveRod(links, 1.0, 1.0, 1.0);
    CantileverRow row{links, 0.0, 0.0, 0.0, {}, {}};
    for (const double gamma :
         {0.01, 0.1, 0.3, 1.0, 2.0, 3.0, 5.0, 7.0, 10.0, 15.0, 20.0, 25.0, kMostGamma}) {
      const double error = SagRatioError(rod, gamma);
      if (error > row.sag_error) row.worst_gamma = gamma;
      row.sag_error = std::max(row.sag_error, error);
      row.naive_sag_error = std::max(row.naive_sag_error, SagRatioError(naive, gamma));
    }
    const ChainMatrices modes = MatricesOf(rod);
    for (size_t f = 0; f < 2; ++f) row.frequency[f] = modes.omega[f] / kRodFrequency[f];
    for (size_t q = 0; q < 3; ++q)
      for (const double gamma : {1.0, 10.0, kMostGamma})
        row.strand_miss[q] =
            std::max(row.strand_miss[q], RestMiss(links, gamma, kQualityNames[q], isa));
    rows.push_back(row);
  }
  return rows;
}

// ---- Fixed problems --------------------------------------------------------------------------

namespace {

constexpr const Preset& kMedium = kPresets[2];

FixedProblem Release(int links, std::vector<FixedValue> tip) {
  FixedProblem fixed{links == 3 ? "release, 3 links" : "release, 4 links", {}, 1e-10, tip};
  fixed.problem.material = MakeMaterial(kMedium, links);
  fixed.problem.strand.root = kZero3;
  for (Double3& rest : fixed.problem.strand.rest) rest = {1.0, 0.0, 0.0};
  fixed.problem.start = fixed.problem.strand.rest;
  return fixed;
}

FixedProblem HangingChain() {
  FixedProblem fixed{"hanging chain, moving root",
                     {},
                     1e-10,
                     {{0.5, {0.0995866346, -0.0576332707, 0.0120291245}},
                      {1.0, {0.0794080094, 0.0116080578, -0.0193215638}},
                      {1.5, {0.1115231396, 0.0096630783, -0.0362345470}}}};
  ChainMaterial& material = fixed.problem.material;
  material.links = 3;
  for (int i = 0; i < 3; ++i) {
    material.length[i] = 0.02;
    material.mass[i] = 1.0 / 3.0;
  }
  material.drag = 2.0;
  fixed.problem.motion = MotionOf(Motion::kHeadshake);
  fixed.problem.strand.root = {0.1, 0.0, 0.0};
  for (Double3& rest : fixed.problem.strand.rest) rest = {0.0, -1.0, 0.0};
  fixed.problem.start = fixed.problem.strand.rest;
  return fixed;
}

FixedProblem CurledHeadshake(CurlModel curl, std::string_view name, std::vector<FixedValue> tip) {
  FixedProblem fixed{name, {}, 1e-10, tip};
  fixed.problem.material = MakeMaterial(kMedium, 3);
  fixed.problem.material.curl = curl;
  fixed.problem.motion = MotionOf(Motion::kHeadshake);
  fixed.problem.strand.root = {0.06, 0.08, 0.0};
  for (int i = 0; i < 3; ++i) {
    const double turn = 0.35 * i;
    fixed.problem.strand.rest[i] = {0.6 * exact::Cos(turn), 0.8 * exact::Cos(turn),
                                    exact::Sin(turn)};
  }
  fixed.problem.start = fixed.problem.strand.rest;
  return fixed;
}

}  // namespace

FixedProblem PendulumChallenge() {
  FixedProblem fixed{"pendulum challenge",
                     {},
                     1e-9,
                     {{0.25, {0.299996964, 0.295930466, 0.0}},
                      {0.5, {0.164739173, -0.763572898, 0.0}},
                      {0.75, {-0.171119732, -0.013671231, 0.0}},
                      {1.0, {-0.617362810, -0.086025600, 0.0}}}};
  ChainMaterial& material = fixed.problem.material;
  material.links = 3;
  material.gravity = {0.0, -10.0, 0.0};
  for (int i = 0; i < 3; ++i) {
    material.length[i] = 0.3;
    material.mass[i] = 1.0;
  }
  fixed.problem.strand.root = kZero3;
  for (Double3& rest : fixed.problem.strand.rest) rest = {0.0, -1.0, 0.0};
  fixed.problem.start = {Double3{1.0, 0.0, 0.0}, Double3{0.0, 1.0, 0.0}, Double3{0.0, 1.0, 0.0}};
  return fixed;
}

std::vector<FixedProblem> FixedProblems() {
  return {PendulumChallenge(),
          Release(3, {{0.05, {0.0384172067, -0.0109294530, 0.0}},
                      {0.1, {0.0348790825, -0.0191269922, 0.0}},
                      {0.2, {0.0393052139, -0.0073033411, 0.0}},
                      {0.5, {0.0376600073, -0.0132016435, 0.0}},
                      {1.0, {0.0380801792, -0.0119979949, 0.0}},
                      {4.0, {0.0380514679, -0.0120845556, 0.0}}}),
          Release(4, {{0.05, {0.0382675956, -0.0113379254, 0.0}},
                      {0.1, {0.0344707858, -0.0196480577, 0.0}},
                      {0.2, {0.0392428490, -0.0075681544, 0.0}},
                      {1.0, {0.0379126747, -0.0124005781, 0.0}},
                      {4.0, {0.0378892854, -0.0124674222, 0.0}}}),
          HangingChain(),
          CurledHeadshake(CurlModel::kRoot, "headshake with curl, model L",
                          {{0.5, {0.0829467752, 0.1004301265, 0.0170030881}},
                           {1.0, {0.0877730275, 0.0911681354, 0.0343395718}},
                           {2.0, {0.0919583606, 0.0929390339, 0.0086427242}},
                           {4.0, {0.0879352326, 0.1014664776, 0.0145745875}}}),
          CurledHeadshake(CurlModel::kParent, "headshake with curl, model F",
                          {{0.5, {0.0809266135, 0.0980362825, 0.0200725937}},
                           {1.0, {0.0859713107, 0.0873688441, 0.0371550432}},
                           {2.0, {0.0905486194, 0.0927096552, 0.0110041051}}})};
}

Double3 SolveFixed(const FixedProblem& fixed, const SolverFactory& factory, int frames_per_second,
                   double seconds) {
  const ChainProblem& problem = fixed.problem;
  const int last = problem.material.links - 1;
  SolverRun run(factory, problem.material, 1.0 / frames_per_second, {problem.strand},
                std::span(&problem.start, 1), problem.motion(0.0));
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (!run.valid()) return {kNone, kNone, kNone};
  const int frames = int(std::lround(seconds * frames_per_second));
  for (int f = 1; f <= frames; ++f) run.Step(problem.motion(double(f) / frames_per_second));
  return problem.motion(seconds).Place(problem.strand.root) + run.Point(0, last);
}

std::vector<PendulumRow> MeasurePendulum(Isa isa, bool quick) {
  static constexpr std::string_view kNames[] = {"xpbd-50", "xpbd-8",     "trapezoid-2",
                                                "modal",   "modal-fine", "modal-best"};
  const FixedProblem pendulum = PendulumChallenge();
  const ChainProblem& problem = pendulum.problem;
  std::vector<PendulumRow> rows;
  std::vector<SolverFactory> factories;
  for (const std::string_view name : kNames) {
    const NamedSolver solver = *FindSolver(name);
    factories.push_back(FactoryOf(solver, isa));
    const Double3 tip = SolveFixed(pendulum, factories.back(), 60, 1.0);
    rows.push_back({solver, Length(tip - pendulum.tip.back().position), 0.0, 0.0});
  }
  const TimedProblem timed = {problem.material, {problem.strand}, {problem.start}, problem.motion};
  const std::vector<SolverTime> times =
      TimeInTurn(factories, timed, {quick ? 1024u : 4096u, 60, quick ? 3 : 5, 60});
  for (size_t s = 0; s < rows.size(); ++s) {
    rows[s].ns = times[s].ns;
    rows[s].ratio = TimeRatio(times[s], times[0]);
  }
  return rows;
}

}  // namespace pelt::accuracy
