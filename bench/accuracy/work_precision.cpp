#include "bench/accuracy/work_precision.hpp"

#include <algorithm>
#include <cstdlib>
#include <cstring>

#include "bench/accuracy/solver_timing.hpp"
#include "core/groom/layer_params.hpp"
#include "core/modal/modal_material.hpp"
#include "core/random.hpp"

namespace pelt::accuracy {
namespace {

constexpr int kTimedRate = 60;
constexpr std::string_view kYardstick = "pbd-4";
constexpr double kDefaultLength_m = 0.03;  // LayerSetup's, as a test holds it

SuiteOptions SuiteFor(const WorkPrecisionOptions& options, int links) {
  SuiteOptions suite;
  suite.links = links;
  suite.presets = options.presets;
  suite.coefficients = options.coefficients;
  if (options.quick) {
    suite.strands = 3;
    suite.seconds = 2.5;
    suite.motions = {Motion::kWalk, Motion::kHeadshake};
  }
  if (options.problems == Problems::kDrawn) {
    suite.coefficients = Coefficients::kCalibrated;
    suite.drawn = {.seed = options.seed, .motions = options.quick ? 3 : 12};
    suite.strands = options.quick ? 3 : 4;
    suite.presets = ShippedPresets(options.presets, links);
  }
  return suite;
}

uint64_t MixDouble(uint64_t digest, double value) {
  uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return MixSeed(digest, bits);
}

// Fills the scores of a panel's rows; returns what runs at `kTimedRate`, for the clock.
class PanelScores {
 public:
  PanelScores(const WorkPrecisionOptions& options, const Suite& suite, size_t preset)
      : options_(options), suite_(suite), preset_(preset) {}

  NamedSolver Fill(WorkPrecisionRow& row) const {
    NamedSolver timed = row.solver;
    const size_t middle = MiddleRate(options_.rates);
    for (size_t r = 0; r < options_.rates.size(); ++r) {
      const TunedSolver tuned =
          ScoreNamed(row.solver, options_.isa, suite_, preset_, options_.rates[r]);
      row.scores.push_back(tuned.score);
      row.scales.push_back(tuned.scale);
      if (r == middle) timed = tuned.solver;
    }
    return timed;
  }

 private:
  const WorkPrecisionOptions& options_;
  const Suite& suite_;
  size_t preset_;
};

void TimePanel(const std::vector<NamedSolver>& solvers, const ChainMaterial& material,
               const WorkPrecisionOptions& options, WorkPrecisionPanel& panel) {
  std::vector<SolverFactory> factories;
  for (const NamedSolver& solver : solvers) factories.push_back(FactoryOf(solver, options.isa));
  const std::vector<SolverTime> times =
      TimeInTurn(factories, HeadshakeProblem(material), TableTiming(options.quick));
  SolverTime yardstick;
  for (size_t s = 0; s < solvers.size(); ++s)
    if (solvers[s].name == kYardstick) yardstick = times[s];
  for (size_t s = 0; s < solvers.size(); ++s) {
    WorkPrecisionRow& row = panel.rows[s];
    row.ns = times[s].ns;
    row.low_ns = times[s].low_ns;
    row.high_ns = times[s].high_ns;
    row.ratio = TimeRatio(times[s], yardstick);
  }
}

uint64_t MixScore(uint64_t digest, const Score& score) {
  for (const double value : {score.error, score.worst, score.stretch})
    digest = MixDouble(digest, value);
  return digest;
}

uint64_t DigestOf(const std::vector<WorkPrecisionPanel>& panels) {
  uint64_t digest = 0;
  for (const WorkPrecisionPanel& panel : panels)
    for (const WorkPrecisionRow& row : panel.rows)
      for (size_t r = 0; r < row.scores.size(); ++r)
        digest = MixDouble(MixScore(digest, row.scores[r]), row.scales[r]);
  return digest;
}

uint64_t DigestOf(const std::vector<ShippedPanel>& panels) {
  uint64_t digest = 0;
  for (const ShippedPanel& panel : panels)
    for (const ShippedRow& row : panel.rows)
      for (const Score& score : row.scores) digest = MixScore(digest, score);
  return digest;
}

}  // namespace

bool WorkPrecisionPanel::IsParetoOptimal(const WorkPrecisionRow& row, size_t rate) const {
  return row.ns > 0.0 && row.Finite(rate) &&
         std::none_of(rows.begin(), rows.end(), [&](const WorkPrecisionRow& other) {
           return other.ns > 0.0 && other.ns <= row.ns && other.Finite(rate) &&
                  other.scores[rate].error < row.scores[rate].error;
         });
}

size_t MiddleRate(const std::vector<int>& rates) {
  size_t middle = 0;
  for (size_t r = 1; r < rates.size(); ++r)
    if (std::abs(rates[r] - kTimedRate) < std::abs(rates[middle] - kTimedRate)) middle = r;
  return middle;
}

Preset DefaultLayer(int links) {
  const LayerParams params;
  const double frequency =
      FrequencyOfHardness(uint32_t(links), double(params.angular_hardness_middle),
                          double(params.angular_hardness_end), params.iterations);
  return {kDefaultLayer, kDefaultLength_m, frequency, double(params.velocity_damping),
          double(params.damping_ratio)};
}

std::vector<Preset> ShippedPresets(std::vector<Preset> presets, int links) {
  presets.push_back(DefaultLayer(links));
  return presets;
}

std::vector<ShippedRow> MeasureShipped(const Suite& suite, const std::vector<int>& rates, Isa isa) {
  std::vector<ShippedRow> rows;
  for (const char* name : {"modal-fine", "modal", "modal-best"})
    for (size_t preset = 0; preset < suite.options.presets.size(); ++preset)
      for (const bool velocities : {false, true}) {
        ShippedRow row{preset, *FindSolver(name), {}};
        row.solver.velocities = velocities;
        const SolverFactory factory = FactoryOf(row.solver, isa);
        for (const int rate : rates)
          row.scores.push_back(ScoreSolver(suite, preset, factory, rate));
        rows.push_back(std::move(row));
      }
  return rows;
}

WorkPrecision MeasureWorkPrecision(const WorkPrecisionOptions& options) {
  WorkPrecision result;
  result.options = options;
  const TimingOptions timing = TableTiming(options.quick);
  result.rounds = timing.repeats;
  result.timed_strands = int(timing.strands);
  result.timed_frames = timing.frames;
  const std::vector<NamedSolver> solvers = AllSolvers(options.quick);
  // A panel counts as two more: its suite and its times.
  const size_t total = options.links.size() * options.presets.size() * (solvers.size() + 2);
  size_t done = 0;
  const auto show = [&](size_t more) {
    done += more;
    if (options.progress) options.progress(done, total);
  };
  for (const int links : options.links) {
    show(0);
    const Suite suite = SolveSuite(SuiteFor(options, links));
    if (suite.options.drawn)
      result.shipped.push_back({links, suite.options.presets, suite.options.strands,
                                suite.options.drawn->motions,
                                MeasureShipped(suite, options.shipped_rates, options.isa)});
    for (size_t preset = 0; preset < options.presets.size(); ++preset) {
      show(1);
      WorkPrecisionPanel panel{links, preset, {}, {}};
      for (const int rate : options.rates)
        panel.input_errors.push_back(InputError(suite, preset, rate, RootCourse::kCubic));
      const PanelScores scores(options, suite, preset);
      std::vector<NamedSolver> timed;
      for (const NamedSolver& solver : solvers) {
        panel.rows.emplace_back().solver = solver;
        timed.push_back(scores.Fill(panel.rows.back()));
        show(1);
      }
      if (options.timed)
        TimePanel(timed, MakeMaterial(options.presets[preset], links, suite.options.coefficients),
                  options, panel);
      show(1);
      result.panels.push_back(std::move(panel));
    }
  }
  result.error_digest = DigestOf(result.panels);
  result.shipped_digest = DigestOf(result.shipped);
  return result;
}

}  // namespace pelt::accuracy
