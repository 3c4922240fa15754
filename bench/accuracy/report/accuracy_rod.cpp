#include "bench/accuracy/report/accuracy_rod.hpp"

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

}  // namespace

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

}  // namespace pelt
