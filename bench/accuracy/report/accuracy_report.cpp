#include "bench/accuracy/report/accuracy_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "bench/accuracy/quantile.hpp"

namespace pelt {

using namespace accuracy;

namespace {

// Two digits of per cent, or one.
std::string PercentText(double share) {
  const double percent = 100.0 * share;
  if (!std::isfinite(percent)) return "-";
  if (percent < 0.095) return "<0.1";
  return percent < 9.95 ? fmt::format("{:.1f}", percent) : fmt::format("{:.0f}", percent);
}

std::string_view Mover(const ModelErrorRow& row) {
  return row.solver ? std::string_view(row.solver->name) : "exactly";
}

ReportTable PresetErrors(const ModelErrorPanel& panel, const ModelErrorRow& row,
                         const ModelErrorOptions& options) {
  ReportTable table{{},
                    {{"preset"}, {"rms"}, {"median"}, {"ninth_tenth"}, {"cases"}, {"well_posed"}}};
  for (size_t p = 0; p < row.errors.size(); ++p) {
    const std::vector<double>& errors = row.errors[p];
    table.Add({options.presets[p].name, RootMeanSquare(errors), Quantile(errors, 0.5),
               Quantile(errors, 0.9), errors.size(),
               std::count(panel.posed[p].begin(), panel.posed[p].end(), true)});
  }
  return table;
}

void AddFamily(const ModelErrorPanel& panel, const ModelErrorOptions& options, ReportTree& tree) {
  const std::string_view motion = kMotionFamilies[size_t(panel.family)];
  tree.BlankLine();
  tree.Say(fmt::format("Off the rod, {} motions", motion));
  tree.Add(InJson("motion"), motion).Add(InJson("cases"), options.problems);
  std::vector<Quantity> columns = {InText(" "),
                                   InJson("pareto_optimal"),
                                   {"model"},
                                   {"moved"},
                                   InJson("family"),
                                   InJson("ns"),
                                   InText("ns", "", 0),
                                   {"pooled", "%", -2, "all", 100},
                                   {"pooled_well_posed", "%", -2, "posed", 100},
                                   InJson("presets")};
  for (const Preset& preset : options.presets) columns.push_back(InText(std::string(preset.name)));
  ReportTable& table = tree.AddTable("rows", columns);
  for (const ModelErrorRow& row : panel.rows) {
    const bool best = IsParetoOptimal(panel, row, options);
    std::vector<Value> values = {best ? Value("*") : Value{},
                                 best,
                                 row.model,
                                 Mover(row),
                                 row.solver ? FamilyName(row.solver->family) : "exactly",
                                 row.ns,
                                 row.ns > 0.0 ? Value(row.ns) : Value{},
                                 PooledError(row, options),
                                 PooledError(row, options, panel.posed),
                                 PresetErrors(panel, row, options)};
    for (const std::vector<double>& errors : row.errors)
      values.push_back(fmt::format("{} ({})", PercentText(Quantile(errors, 0.5)),
                                   PercentText(Quantile(errors, 0.9))));
    table.Add(std::move(values));
  }
}

// How far strands are off the rod that they stand for, the first tables: the array `model_error`, an entry a family of
// motions.
void AddRodTables(const ModelErrorTable& table, const ModelErrorOptions& options,
                  ReportTree& tree) {
  tree.Say(fmt::format(
      "Against a rod (polynomials of degree 10): what a strand gets wrong of its secondary motion, "
      "solver and all, at 60 Hz; 100 %: no better than a rigid strand. Each family of motions has "
      "{}, "
      "motions and strands drawn from seed {}. 'exactly': what the model gets wrong by itself. "
      "Nodes "
      "moved by a solver are what layers have, of 3 the stiff ones where strands are stiff for "
      "their "
      "weight; links are what the other solvers have. Last: the rod itself with degree 8, and in "
      "half steps.",
      options.problems, options.seed));
  if (table.panels.empty()) return tree.BeginList("model_error");
  tree.Say(fmt::format(
      "all: RMS over materials but the stiff; posed: of the cases where a rod of {} links agrees "
      "to {:.0f} %; each material: median (90 % are below). ns per strand and frame: {}, the "
      "motion "
      "of a shaken head. *: nothing as cheap is nearer. Position-based solvers and the lengths of "
      "rods are tuned for each family and material on these very cases.",
      kPosedLinks, 100.0 * kPosedError, options.presets[TimedPreset(options)].name));
  for (const ModelErrorPanel& panel : table.panels)
    AddFamily(panel, options, tree.AddEntry("model_error"));
  tree.BlankLine();
}

void AddSolverColumns(std::vector<Quantity>& columns) {
  for (const Quantity& column :
       {InJson("solver"), InJson("family"), Quantity{"label", "", -1, "solver"}})
    columns.push_back(column);
}

void AddSolver(const NamedSolver& solver, std::vector<Value>& row) {
  for (Value value : {Value(solver.name), Value(FamilyName(solver.family)), Value(solver.label)})
    row.push_back(std::move(value));
}

ReportTable ScoreTable(const WorkPrecision& table, const WorkPrecisionPanel& panel,
                       const WorkPrecisionRow& row) {
  ReportTable scores{{},
                     {{"rate"},
                      {"finite"},
                      {"pareto_optimal"},
                      {"error"},
                      {"worst"},
                      {"stretch"},
                      {"cases"},
                      {"stiffness_scale"}}};
  for (size_t r = 0; r < row.scores.size(); ++r) {
    const Score& score = row.scores[r];
    scores.Add({table.options.rates[r], row.Finite(r), panel.IsParetoOptimal(row, r), score.error,
                score.worst, score.stretch, score.cases,
                row.solver.Tuned() ? Value(row.scales[r]) : Value{}});
  }
  return scores;
}

void AddPanel(const WorkPrecision& table, const WorkPrecisionPanel& panel, ReportTree& tree) {
  const std::vector<int>& rates = table.options.rates;
  const size_t middle = MiddleRate(rates);
  const std::string preset(table.options.presets[panel.preset].name);
  tree.BlankLine();
  tree.Say(fmt::format("{}, {} links", preset, panel.links));
  tree.Add(InJson("links"), panel.links).Add(InJson("preset"), preset);
  tree.Add(InJson("input_errors"), panel.input_errors);
  std::vector<Quantity> columns = {InText(" ")};
  AddSolverColumns(columns);
  columns.insert(columns.end(), {{"ns", "", 1},
                                 InJson("ns_quartiles"),
                                 InText("+-", "%", 0),
                                 {"of_pbd", "", 2, "of PBD"},
                                 InJson("scores")});
  for (const int rate : rates) columns.push_back(InText(fmt::format("{} Hz", rate), "%", -3));
  columns.push_back(InText("stretch", "", -2));
  ReportTable& rows = tree.AddTable("rows", columns);
  for (const WorkPrecisionRow& row : panel.rows) {
    std::vector<Value> values = {panel.IsParetoOptimal(row, middle) ? Value("*") : Value{}};
    AddSolver(row.solver, values);
    const double half = 0.5 * (row.high_ns - row.low_ns);
    for (Value value : {Value(row.ns), Value(std::vector<double>{row.low_ns, row.high_ns}),
                        Value(row.ns > 0.0 ? 100.0 * half / row.ns : 0.0), Value(row.ratio),
                        Value(ScoreTable(table, panel, row))})
      values.push_back(std::move(value));
    for (size_t r = 0; r < rates.size(); ++r)
      values.push_back(row.Finite(r) ? 100.0 * row.scores[r].error : std::nan(""));
    values.push_back(row.scores[middle].stretch);
    rows.Add(std::move(values));
  }
  std::vector<Value> exact = {{}, {}, {}, "exact, root as samples", {}, {}, {}, {}, {}};
  for (const double error : panel.input_errors) exact.push_back(100.0 * error);
  rows.Add(std::move(exact), Show::kText);
}

std::string Percent(double share) {
  return std::isfinite(share) ? fmt::format("{:.3g}", 100.0 * share) : "-";
}

ReportTable ShippedScores(const std::vector<int>& rates, const ShippedRow& row) {
  ReportTable scores{
      {}, {{"rate"}, {"finite"}, {"rms"}, {"median"}, {"worst_case"}, {"stretch"}, {"cases"}}};
  for (size_t r = 0; r < rates.size(); ++r) {
    const Score& s = row.scores[r];
    scores.Add({rates[r], s.finite, s.error, s.Median(), s.WorstCase(), s.stretch, s.cases});
  }
  return scores;
}

void AddShippedPanel(const WorkPrecision& table, const ShippedPanel& panel, ReportTree& tree) {
  const std::vector<int>& rates = table.options.shipped_rates;
  tree.BlankLine();
  tree.Say(fmt::format("Chains of {} links, {} motions of {} strands for each material",
                       panel.links, panel.motions, panel.strands));
  tree.Add(InJson("links"), panel.links).Add(InJson("motions"), panel.motions);
  tree.Add(InJson("strands"), panel.strands);
  std::vector<Quantity> columns = {InJson("solver"),   InJson("velocities"), InJson("preset"),
                                   InText("material"), InText("quality"),    InJson("scores")};
  for (const int rate : rates) columns.push_back(InText(fmt::format("{} Hz", rate)));
  columns.push_back(InText("cases"));
  ReportTable& rows = tree.AddTable("rows", columns);
  for (const ShippedRow& row : panel.rows) {
    const std::string name(panel.presets[row.preset].name);
    std::vector<Value> values = {row.solver.name, row.solver.velocities, name, name};
    values.push_back(row.solver.label + (row.solver.velocities ? ", velocities" : ""));
    values.push_back(ShippedScores(rates, row));
    for (const Score& s : row.scores)
      values.push_back(s.finite ? fmt::format("{} ({}, {})", Percent(s.error), Percent(s.Median()),
                                              Percent(s.WorstCase()))
                                : std::string("not finite"));
    values.push_back(row.scores[0].cases);
    rows.Add(std::move(values));
  }
}

void AddShipped(const WorkPrecision& table, ReportTree& tree) {
  if (table.shipped.empty()) return tree.BeginList("shipped");
  tree.Say(fmt::format(
      "Against the model's own exact motion, which leaves the time steps: the modal solver on "
      "chains of links, per cent of the secondary motion that is wrong (100 %: no "
      "better than a rigid strand), RMS over the cases (their median, the worst). Motions, strands "
      "and lengths are drawn from seed {} and tuned nothing; calibrated coefficients; cases "
      "that a perturbation of 1e-7 at the start moves by twice as much or more do not count.",
      table.options.seed));
  for (const ShippedPanel& panel : table.shipped)
    AddShippedPanel(table, panel, tree.AddEntry("shipped"));
  tree.Add({"shipped_digest", "", -1, "digest of these errors"}, DigestText(table.shipped_digest));
  tree.BlankLine();
}

std::string ProblemsText(const WorkPrecision& table) {
  if (table.options.problems == Problems::kDrawn)
    return "Solvers on the same drawn problems, strands with calibrated coefficients, as layers "
           "have them.";
  return fmt::format("The suite that chose the modal solver's constants, strands with {}.",
                     table.options.coefficients == Coefficients::kCalibrated
                         ? "calibrated coefficients, as layers have them"
                         : "equal masses and joints");
}

void AddCantilever(const std::vector<CantileverRow>& rows, ReportTree& tree) {
  tree.BlankLine();
  tree.Say("Clamped rod under its own weight: calibrated links against the continuous rod");
  ReportTable& table = tree.AddTable(
      "cantilever", {{"links"},
                     {"sag_error", "%", 2, "H/W off", 100},
                     {"worst_gamma", "", -4, "at Gamma"},
                     {"naive_sag_error", "%", 0, "naive", 100},
                     {"f1_over_rod", "", 5},
                     {"f2_over_rod", "", 5},
                     {"strand_miss", "%", 2, "a strand's tip off: fast, fine, best", 100}});
  for (const CantileverRow& row : rows)
    table.Add({row.links, row.sag_error, row.worst_gamma, row.naive_sag_error, row.frequency[0],
               row.frequency[1],
               std::vector<double>(std::begin(row.strand_miss), std::end(row.strand_miss))});
}

void AddPendulum(const std::vector<PendulumRow>& rows, ReportTree& tree) {
  tree.BlankLine();
  tree.Say("Pendulum challenge, third point at 1 s");
  std::vector<Quantity> columns;
  AddSolverColumns(columns);
  columns.insert(
      columns.end(),
      {{"miss_m", "mm", 2, "off", 1000}, {"ns", "", 1}, {"of_xpbd_50", "", 2, "of XPBD"}});
  ReportTable& table = tree.AddTable("pendulum", columns);
  for (const PendulumRow& row : rows) {
    std::vector<Value> values;
    AddSolver(row.solver, values);
    for (const double value : {row.miss, row.ns, row.ratio}) values.push_back(value);
    table.Add(std::move(values));
  }
}

void AddStability(const std::vector<StabilityRow>& rows, ReportTree& tree) {
  tree.BlankLine();
  tree.Say(
      "Energy kept after 5 s, undamped, 60 Hz (1: all), and small motion of the medium preset");
  std::vector<Quantity> columns, shape_columns = {{"solver"}};
  AddSolverColumns(columns);
  columns.insert(columns.end(), {InText("free", "", 3),
                                 InText("2 Hz", "", 3),
                                 InText("5 Hz", "", 3),
                                 InJson("energy_kept"),
                                 InJson("static_shape_error"),
                                 InJson("mixed_shape_error"),
                                 {"frequency_error", "%", 3, "f1 off", 100},
                                 {"decay_error", "%", 3, "decay", 100},
                                 {"worst_mode", "", -2, "any mode"}});
  for (const int rate : kStaticRates)
    shape_columns.push_back(InText(fmt::format("{} Hz", rate), "%", 4));
  shape_columns.push_back(InText("mixed", "%", 4));
  ReportTable& table = tree.AddTable("stability", columns);
  tree.BlankLine();
  tree.Say("Static shape: sag off, medium preset");
  ReportTable& shapes = tree.AddTable({}, shape_columns);
  for (const StabilityRow& row : rows) {
    const std::vector<double> energy(std::begin(row.energy), std::end(row.energy)),
        shape(std::begin(row.shape), std::end(row.shape));
    std::vector<Value> values, shape_values = {row.solver.label};
    AddSolver(row.solver, values);
    for (Value value : {Value(energy[0]), Value(energy[1]), Value(energy[2]), Value(energy),
                        Value(shape), Value(row.mixed_shape), Value(row.frequency_error),
                        Value(row.decay_error), Value(row.worst_mode)})
      values.push_back(std::move(value));
    table.Add(std::move(values));
    for (const double error : shape) shape_values.push_back(100.0 * error);
    shape_values.push_back(100.0 * row.mixed_shape);
    shapes.Add(std::move(shape_values));
  }
}

}  // namespace

ReportTree MakeAccuracyTree(const AccuracyReport& report) {
  const WorkPrecision& table = report.table;
  const bool drawn = table.options.problems == Problems::kDrawn;
  const bool calibrated = drawn || table.options.coefficients == Coefficients::kCalibrated;
  ReportTree tree;
  tree.Add(InJson("format"), kAccuracyFormat);
  tree.Add(InJson("problems"), drawn ? "drawn" : "tuned").Add(InJson("seed"), table.options.seed);
  AddRodTables(report.model_error, report.model_options, tree);
  AddShipped(table, tree);
  tree.Say(ProblemsText(table));
  tree.Say(
      "Part of the secondary motion that is wrong (100 %: no better than a rigid strand), and "
      "ns per strand and frame (+-: half of what their quartiles lie apart). *: nothing as cheap "
      "is more exact at the rate nearest 60 Hz; "
      "stretch is of that rate. Position-based solvers and follow-the-leader are tuned on these "
      "very cases.");
  tree.Add(InJson("quick"), table.options.quick).Add(InJson("calibrated"), calibrated);
  tree.Add(InJson("rates"), table.options.rates);
  for (const WorkPrecisionPanel& panel : table.panels)
    AddPanel(table, panel, tree.AddEntry("panels"));
  AddCantilever(report.cantilever, tree);
  AddPendulum(report.pendulum, tree);
  AddStability(report.stability, tree);
  tree.BlankLine();
  AddMachine(report.machine, tree);
  tree.EndLine();
  tree.Add({"isa", "", -1, "one core, kernels"}, IsaName(table.options.isa));
  tree.Add({"timed_strands"}, table.timed_strands);
  tree.Add({"rounds", "", -1, "median frame of rounds taken in turn"}, table.rounds);
  tree.Add({"timed_frames", "", -1, "of frames"}, table.timed_frames).EndLine();
  tree.Add({"error_digest", "", -1, "digest of the errors"}, DigestText(table.error_digest));
  tree.Add({"seconds", "s", 1, "took"}, report.seconds);
  return tree;
}

}  // namespace pelt
