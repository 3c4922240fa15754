#include "bench/accuracy/solver_checks.hpp"

#include <algorithm>
#include <cmath>

#include "bench/accuracy/elastica.hpp"
#include "bench/accuracy/fixed_problems.hpp"
#include "bench/accuracy/solver_timing.hpp"
#include "bench/accuracy/stability.hpp"

namespace pelt::accuracy {
namespace {

constexpr std::string_view kQualityNames[3] = {"modal", "modal-fine", "modal-best"};

std::vector<NamedSolver> SolversOf(std::span<const std::string_view> names) {
  std::vector<NamedSolver> solvers;
  for (const std::string_view name : names) solvers.push_back(*FindSolver(name));
  return solvers;
}

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

double WorstMode(const SolverFactory& factory, const ChainMaterial& material) {
  double worst = 0.0;
  for (const int rate : {15, 60, 240})
    for (const ModeResponse& mode : MeasureModes(factory, material, 1.0 / rate)) {
      worst = std::max(worst, std::abs(mode.first - mode.exact_first));
      if (mode.gone) continue;
      worst = std::max(worst, std::abs(mode.sum - mode.exact_sum));
      worst = std::max(worst, std::abs(mode.product - mode.exact_product));
    }
  return worst;
}

StabilityRow MeasureSolver(const NamedSolver& solver, Isa isa) {
  const SolverFactory factory = FactoryOf(solver, isa);
  const ChainMaterial medium = MakeMaterial(kPresets[2], 3);
  const Strand strand = SeededStrands(3, 6, 1)[3];
  StabilityRow row{};
  row.solver = solver;
  for (size_t f = 0; f < 3; ++f) row.energy[f] = EnergyKept(factory, 3, kEnergyFrequencies[f], 60);
  for (size_t r = 0; r < kStaticRates.size(); ++r)
    row.shape[r] = StaticShapeError(factory, medium, strand, kStaticRates[r]);
  row.mixed_shape = StaticShapeError(factory, medium, strand, 60, 8.0, 3.0);
  const ModeResponse first = MeasureModes(factory, medium, 1.0 / 60)[0];
  const ModeRate exact = RateOf(first.exact_sum, first.exact_product, 1.0 / 60);
  const ModeRate rate = RateOf(first.sum, first.product, 1.0 / 60);
  row.frequency_error = rate.frequency / exact.frequency - 1.0;
  row.decay_error = rate.decay / exact.decay - 1.0;
  row.worst_mode = WorstMode(factory, medium);
  return row;
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

std::vector<PendulumRow> MeasurePendulum(Isa isa, bool quick) {
  static constexpr std::string_view kNames[] = {"xpbd-50", "xpbd-8",     "trapezoid-2",
                                                "modal",   "modal-fine", "modal-best"};
  const FixedProblem pendulum = PendulumChallenge();
  const ChainProblem& problem = pendulum.problem;
  std::vector<PendulumRow> rows;
  std::vector<SolverFactory> factories;
  for (const NamedSolver& solver : SolversOf(kNames)) {
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

std::vector<StabilityRow> MeasureStability(Isa isa, bool quick) {
  static constexpr std::string_view kQuick[] = {"pbd-4", "xpbd-8", "modal", "modal-fine",
                                                "modal-best"};
  static constexpr std::string_view kAll[] = {
      "dftl-1",  "textbook-pbd-4", "pbd-4", "verlet-4",   "xpbd-8",    "xpbd-64",
      "euler-1", "trapezoid-2",    "modal", "modal-fine", "modal-best"};
  std::vector<StabilityRow> rows;
  for (const NamedSolver& solver : quick ? SolversOf(kQuick) : SolversOf(kAll))
    rows.push_back(MeasureSolver(solver, isa));
  return rows;
}

}  // namespace pelt::accuracy
