// The work-precision table: the same errors on every instruction set, names that lead back to their
// solvers, fair times, a Pareto front that is one, promises that can be broken.
#include "bench/accuracy/work_precision.hpp"

#include <gtest/gtest.h>

#include <set>

#include "bench/accuracy/solver_checks.hpp"
#include "bench/accuracy/solver_timing.hpp"
#include "bench/accuracy/stress.hpp"

namespace pelt::accuracy {
namespace {

WorkPrecisionOptions Small(Isa isa) {
  WorkPrecisionOptions options;
  options.links = {3};
  options.rates = {60};
  options.presets = {kPresets[2]};
  options.isa = isa;
  options.quick = true;
  options.timed = false;
  return options;
}

TEST(WorkPrecision, ErrorsAreTheSameOnEveryInstructionSet) {
  const WorkPrecision reference = MeasureWorkPrecision(Small(Isa::kReference));
  const uint64_t expected = reference.error_digest;
  for (const Isa isa : kAllIsas) {
    if (!FindKernels(isa)) continue;
    const WorkPrecision same = MeasureWorkPrecision(Small(isa));
    EXPECT_EQ(same.error_digest, expected) << IsaName(isa);
    EXPECT_EQ(same.shipped_digest, reference.shipped_digest) << IsaName(isa);
  }
  WorkPrecisionOptions other = Small(BestIsa());
  other.presets = {kPresets[3]};
  EXPECT_NE(MeasureWorkPrecision(other).error_digest, expected);
  other = Small(BestIsa());
  other.seed += 1;
  EXPECT_NE(MeasureWorkPrecision(other).error_digest, expected);
  other = Small(BestIsa());
  other.problems = Problems::kTuned;
  const WorkPrecision even = MeasureWorkPrecision(other);
  EXPECT_NE(even.error_digest, expected);
  EXPECT_TRUE(even.shipped.empty());
  other.coefficients = Coefficients::kCalibrated;
  EXPECT_NE(MeasureWorkPrecision(other).error_digest, even.error_digest);
}

TEST(WorkPrecision, PanelsHoldEverySolverAndRate) {
  WorkPrecisionOptions options = Small(BestIsa());
  options.rates = {30, 60};
  options.timed = true;
  const WorkPrecision table = MeasureWorkPrecision(options);
  ASSERT_EQ(table.panels.size(), 1u);
  const WorkPrecisionPanel& panel = table.panels[0];
  ASSERT_EQ(panel.rows.size(), AllSolvers(true).size());
  ASSERT_EQ(panel.input_errors.size(), 2u);
  EXPECT_GT(panel.input_errors[0], 3.0 * panel.input_errors[1]);
  bool pareto_optimal = false;
  for (const WorkPrecisionRow& row : panel.rows) {
    ASSERT_EQ(row.scores.size(), 2u);
    EXPECT_GT(row.ns, 0.0) << row.solver.name;
    EXPECT_GT(row.scores[1].cases, 0) << row.solver.name;
    if (row.solver.name == "pbd-4") {
      EXPECT_EQ(row.ratio, 1.0);
    }
    pareto_optimal = pareto_optimal || panel.IsParetoOptimal(row, 1);
    // No solver is much more exact than the root is known.
    EXPECT_GT(row.scores[1].error, 0.5 * panel.input_errors[1]) << row.solver.name;
  }
  EXPECT_TRUE(pareto_optimal);
}

TEST(WorkPrecision, TheFrontIsWhatNothingAsCheapBeats) {
  WorkPrecisionPanel panel{3, 0, {0.0}, {}};
  const auto add = [&](double ns, double error) {
    WorkPrecisionRow row{};
    row.ns = ns;
    row.scores.emplace_back().error = error;
    row.scales = {1.0};
    panel.rows.push_back(row);
  };
  add(10, 0.5);
  add(20, 0.6);
  add(20, 0.1);
  add(40, 0.1);
  add(50, 0.05);
  panel.rows.push_back(panel.rows[4]);
  panel.rows.back().ns = 5;
  panel.rows.back().scores[0].finite = false;
  const bool expected[] = {true, false, true, true, true, false};
  for (size_t r = 0; r < panel.rows.size(); ++r)
    EXPECT_EQ(panel.IsParetoOptimal(panel.rows[r], 0), expected[r]) << r;
}

TEST(WorkPrecision, MiddleRate) {
  EXPECT_EQ(MiddleRate({15, 30, 60, 120}), 2u);
  EXPECT_EQ(MiddleRate({15, 240}), 0u);
  EXPECT_EQ(MiddleRate({120}), 0u);
}

TEST(NamedSolver, NamesLeadBack) {
  std::set<std::string> names;
  for (const NamedSolver& solver : AllSolvers()) {
    EXPECT_TRUE(names.insert(solver.name).second) << solver.name;
    const auto found = FindSolver(solver.name);
    ASSERT_TRUE(found) << solver.name;
    EXPECT_EQ(found->label, solver.label);
    EXPECT_EQ(found->family, solver.family);
  }
  for (const NamedSolver& solver : AllSolvers(true))
    EXPECT_TRUE(names.contains(solver.name)) << solver.name;
  EXPECT_EQ(FindSolver("xpbd-50")->method.substeps, 50);
  EXPECT_EQ(FindSolver("xpbd16-2")->method.iterations, 16);
  EXPECT_EQ(FindSolver("xpbd-cubic-8")->method.method, Method::kXpbdCubic);
  EXPECT_EQ(FindSolver("pbd")->core.iterations, 4u);
  EXPECT_EQ(FindSolver("verlet")->core.method, CoreMethod::kVerlet);
  for (const char* wrong : {"", "xpbd", "xpbd-", "xpbd-0", "xpbd-65", "xpbd-8x", "xpbd--8", "pbdx",
                            "pbd4", "modal-7", "Modal", "dftl"})
    EXPECT_FALSE(FindSolver(wrong)) << wrong;
}

// A clock that only the solvers move: Step takes the time it was given, half as long in the first
// round and nine times in the last, everything else an hour.
double clock_s = 0.0;

class Slow final : public StrandSolver {
 public:
  explicit Slow(double seconds) : seconds_(seconds) {}
  void Start(const FrameRows&, const float* const (*)[3]) override { clock_s += 3600.0; }
  void Prepare(const FrameRows&) override { clock_s += 3600.0; }
  void Step(const FrameRows&) override { clock_s += seconds_; }
  void SetFrameTime(double) override {}
  void Points(int, float* const (&)[3]) const override { clock_s += 3600.0; }
  void Velocities(int, float* const (&)[3]) const override {}

 private:
  double seconds_;
};

TEST(SolverTiming, TimesAreOfStepAloneAndOfTheMiddleRound) {
  int made = 0;
  const auto slow = [&](double seconds) {
    return [&made, seconds](const SolverSetup&) {
      const int round = made++ / 2;
      return std::make_unique<Slow>(seconds * (round == 0 ? 0.5 : round == 2 ? 9.0 : 1.0));
    };
  };
  const SolverFactory factories[] = {
      slow(1e-3), slow(2e-3), [](const SolverSetup&) { return std::unique_ptr<StrandSolver>(); }};
  clock_s = 0.0;
  const auto times =
      TimeInTurn(factories, HeadshakeProblem(MakeMaterial(kPresets[2], 3)),
                 {.strands = 64, .frames = 10, .repeats = 3, .now = [] { return clock_s; }});
  EXPECT_EQ(made, 6);
  EXPECT_NEAR(times[0].ns, 1e6 / 64, 1.0);
  EXPECT_NEAR(times[1].ns, 2e6 / 64, 1.0);
  EXPECT_NEAR(times[0].low_ns, 0.5e6 / 64, 1.0);
  EXPECT_NEAR(times[0].high_ns, 9e6 / 64, 1.0);
  EXPECT_NEAR(TimeRatio(times[1], times[0]), 2.0, 1e-6);
  EXPECT_EQ(times[2].ns, 0.0);
  EXPECT_EQ(TimeRatio(times[0], times[2]), 0.0);
}

// Solvers of unlike strands run in one turn, each on its own.
TEST(SolverTiming, EachHasItsOwnProblem) {
  const TimedProblem problems[] = {HeadshakeProblem(MakeMaterial(kPresets[2], 3)),
                                   HeadshakeProblem(MakeMaterial(kPresets[2], 4))};
  std::vector<int> links;
  const SolverFactory slow = [&](const SolverSetup& setup) {
    links.push_back(setup.material.links);
    return std::make_unique<Slow>(1e-3 * setup.material.links);
  };
  const TimedSolver solvers[] = {{slow, &problems[0]}, {slow, &problems[1]}, {slow, &problems[0]}};
  clock_s = 0.0;
  const auto times = TimeInTurn(
      solvers, {.strands = 64, .frames = 4, .repeats = 2, .now = [] { return clock_s; }});
  EXPECT_EQ(links, (std::vector<int>{3, 4, 3, 3, 4, 3}));
  for (size_t s = 0; s < 3; ++s) EXPECT_NEAR(times[s].ns, 1e6 * (s == 1 ? 4 : 3) / 64, 1.0);
}

TEST(SolverChecks, FiguresAreWithinTheirTargets) {
  for (const CantileverRow& row : MeasureCantilever(BestIsa())) {
    EXPECT_LT(row.sag_error, row.links == 3 ? 0.02 : 0.01);
    EXPECT_GT(row.naive_sag_error, row.links == 8 ? 0.5 : 1.0);  // falls with the links
    EXPECT_NEAR(row.frequency[0], 1.0, 1e-3);
    EXPECT_NEAR(row.frequency[1], 1.0, 1e-2);
    std::printf("%d parts: a strand's tip rests %.2f %.2f %.2f %% of the length off the rod's\n",
                row.links, 100.0 * row.strand_miss[0], 100.0 * row.strand_miss[1],
                100.0 * row.strand_miss[2]);
    for (const double miss : row.strand_miss) EXPECT_LT(miss, 4e-3);
  }
  for (const PendulumRow& row : MeasurePendulum(BestIsa(), true)) {
    if (row.solver.name == "xpbd-50") {
      EXPECT_NEAR(row.miss, 0.116, 5e-3);
    }
    if (row.solver.name == "modal-best") {
      EXPECT_LT(row.miss, 1e-3);
    }
  }
  for (const StabilityRow& row : MeasureStability(BestIsa(), true)) {
    if (row.solver.family != Family::kModal) continue;
    EXPECT_LT(std::abs(row.frequency_error), 1e-4) << row.solver.name;
    EXPECT_LT(row.worst_mode, 5e-5) << row.solver.name;
    EXPECT_LT(std::abs(row.mixed_shape), 2e-4) << row.solver.name;
  }
}

TEST(Stress, PromisesCanBeBroken) {
  const auto broken = [](const StressResult& result) { return BrokenPromises(result); };
  EXPECT_TRUE(broken({}).empty());
  EXPECT_TRUE(broken({.worst_stretch = 1e-4}).empty());
  EXPECT_EQ(broken({.worst_stretch = 2e-4}), std::vector<std::string>{"stretched"});
  EXPECT_EQ(broken({.worst_stretch = std::nan("")}), std::vector<std::string>{"stretched"});
  EXPECT_EQ(broken({.non_finite = 1}), std::vector<std::string>{"not finite"});
  EXPECT_EQ(broken({.unsettled = 1}), std::vector<std::string>{"unsettled"});
  EXPECT_EQ(broken({.ran = false}), std::vector<std::string>{"not run"});
}

}  // namespace
}  // namespace pelt::accuracy
