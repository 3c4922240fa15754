#include "bench/accuracy/report/accuracy_report.hpp"

#include <fmt/format.h>

#include <cmath>

#include "bench/report/json_text.hpp"

namespace pelt {

using namespace accuracy;

std::string PercentText(double share) {
  const double percent = 100.0 * share;
  if (!std::isfinite(percent)) return "-";
  return fmt::format("{:.{}f}", percent, percent < 10.0 ? 2 : percent < 100.0 ? 1 : 0);
}

namespace {

std::string PercentOf(const WorkPrecisionRow& row, size_t rate) {
  return row.Finite(rate) ? PercentText(row.scores[rate].error) : "not finite";
}

void AddPanelText(const WorkPrecision& table, const WorkPrecisionPanel& panel, std::string& text) {
  const std::vector<int>& rates = table.options.rates;
  const size_t middle = MiddleRate(rates);
  text += fmt::format("\n{}, {} links\n  {:<42} {:>8} {:>7}",
                      table.options.presets[panel.preset].name, panel.links, "", "ns", "of PBD");
  for (const int rate : rates) text += fmt::format(" {:>10}", fmt::format("{} Hz, %", rate));
  text += fmt::format(" {:>9}\n", "stretch");
  for (const WorkPrecisionRow& row : panel.rows) {
    text += fmt::format("{} {:<42} {:>8} {:>7}", panel.OnFront(row, middle) ? '*' : ' ',
                        row.solver.label, row.ns > 0.0 ? fmt::format("{:.1f}", row.ns) : "-",
                        row.ratio > 0.0 ? fmt::format("{:.2f}", row.ratio) : "-");
    for (size_t r = 0; r < rates.size(); ++r) text += fmt::format(" {:>10}", PercentOf(row, r));
    text += fmt::format(" {:>9.0e}\n", row.scores[middle].stretch);
  }
  text += fmt::format("  {:<42} {:>8} {:>7}", "exact, root as samples", "", "");
  for (const double error : panel.input_errors) text += fmt::format(" {:>10}", PercentText(error));
  text += '\n';
}

void AddCantileverText(const std::vector<CantileverRow>& rows, std::string& text) {
  text +=
      "\nClamped rod under its own weight: calibrated links against the continuous rod\n"
      "  links  H/W off, %  at Gamma  (naive, %)  f1 over rod  f2 over rod  modal at rest "
      "off, L: fast, default, best\n";
  for (const CantileverRow& row : rows)
    text += fmt::format(
        "  {:>5}  {:>10.2f}  {:>8.4g}  {:>10.0f}  {:>11.5f}  {:>11.5f}  {:>21.0e} {:.0e} {:.0e}\n",
        row.links, 100.0 * row.sag_error, row.worst_gamma, 100.0 * row.naive_sag_error,
        row.frequency[0], row.frequency[1], row.solver_miss[0], row.solver_miss[1],
        row.solver_miss[2]);
}

void AddPendulumText(const std::vector<PendulumRow>& rows, std::string& text) {
  text += fmt::format("\nPendulum challenge, third point at 1 s\n  {:<42} {:>8} {:>8} {:>8}\n", "",
                      "off, mm", "ns", "of XPBD");
  for (const PendulumRow& row : rows)
    text += fmt::format("  {:<42} {:>8.2f} {:>8.1f} {:>8.2f}\n", row.solver.label, 1e3 * row.miss,
                        row.ns, row.ratio);
}

std::string Signed(double share, int digits) {
  return std::isfinite(share) ? fmt::format("{:+.{}f}", 100.0 * share, digits) : "-";
}

void AddStabilityText(const std::vector<StabilityRow>& rows, std::string& text) {
  text += fmt::format(
      "\nEnergy kept after 5 s, undamped, 60 Hz (1: all), and small motion of the medium preset\n"
      "  {:<42} {:>7} {:>7} {:>7} {:>10} {:>9} {:>10}\n",
      "", "free", "2 Hz", "5 Hz", "f1 off, %", "decay, %", "any mode");
  for (const StabilityRow& row : rows)
    text += fmt::format("  {:<42} {:>7.3f} {:>7.3f} {:>7.3f} {:>10} {:>9} {:>10.0e}\n",
                        row.solver.label, row.energy[0], row.energy[1], row.energy[2],
                        Signed(row.frequency_error, 3), Signed(row.decay_error, 3), row.worst_mode);
  text += fmt::format("\nStatic shape: sag off, %, medium preset\n  {:<42}", "");
  for (const int rate : kStaticRates) text += fmt::format(" {:>9}", fmt::format("{} Hz", rate));
  text += fmt::format(" {:>9}\n", "mixed");
  for (const StabilityRow& row : rows) {
    text += fmt::format("  {:<42}", row.solver.label);
    for (const double error : row.shape) text += fmt::format(" {:>9}", Signed(error, 4));
    text += fmt::format(" {:>9}\n", Signed(row.mixed_shape, 4));
  }
}

// ---- JSON ------------------------------------------------------------------------------------

void AddSolver(JsonText& json, const NamedSolver& solver) {
  json.Add("solver", solver.name);
  json.Add("family", FamilyName(solver.family));
  json.Add("label", solver.label);
}

void AddPanel(JsonText& json, const WorkPrecision& table, const WorkPrecisionPanel& panel) {
  json.BeginObject();
  json.Add("links", panel.links);
  json.Add("preset", table.options.presets[panel.preset].name);
  json.BeginArray("input_errors");
  for (const double error : panel.input_errors) json.Add("", error);
  json.EndArray();
  json.BeginArray("rows");
  for (const WorkPrecisionRow& row : panel.rows) {
    json.BeginObject();
    AddSolver(json, row.solver);
    json.Add("ns", row.ns);
    json.Add("of_pbd", row.ratio);
    json.BeginArray("scores");
    for (size_t r = 0; r < row.scores.size(); ++r) {
      const Score& score = row.scores[r];
      json.BeginObject();
      json.Add("rate", table.options.rates[r]);
      json.Add("finite", row.Finite(r));
      json.Add("on_front", panel.OnFront(row, r));
      json.Add("error", score.error);
      json.Add("worst", score.worst);
      json.Add("stretch", score.stretch);
      json.Add("cases", score.cases);
      if (row.solver.Tuned()) json.Add("stiffness_scale", row.scales[r]);
      json.EndObject();
    }
    json.EndArray();
    json.EndObject();
  }
  json.EndArray();
  json.EndObject();
}

void AddChecks(JsonText& json, const AccuracyReport& report) {
  json.BeginArray("cantilever");
  for (const CantileverRow& row : report.cantilever) {
    json.BeginObject();
    json.Add("links", row.links);
    json.Add("sag_error", row.sag_error);
    json.Add("worst_gamma", row.worst_gamma);
    json.Add("naive_sag_error", row.naive_sag_error);
    json.Add("f1_over_rod", row.frequency[0]);
    json.Add("f2_over_rod", row.frequency[1]);
    json.BeginArray("modal_miss");
    for (const double miss : row.solver_miss) json.Add("", miss);
    json.EndArray();
    json.EndObject();
  }
  json.EndArray();
  json.BeginArray("pendulum");
  for (const PendulumRow& row : report.pendulum) {
    json.BeginObject();
    AddSolver(json, row.solver);
    json.Add("miss_m", row.miss);
    json.Add("ns", row.ns);
    json.Add("of_xpbd_50", row.ratio);
    json.EndObject();
  }
  json.EndArray();
  json.BeginArray("stability");
  for (const StabilityRow& row : report.stability) {
    json.BeginObject();
    AddSolver(json, row.solver);
    json.BeginArray("energy_kept");
    for (const double share : row.energy) json.Add("", share);
    json.EndArray();
    json.BeginArray("static_shape_error");
    for (const double error : row.shape) json.Add("", error);
    json.EndArray();
    json.Add("mixed_shape_error", row.mixed_shape);
    json.Add("frequency_error", row.frequency_error);
    json.Add("decay_error", row.decay_error);
    json.Add("worst_mode", row.worst_mode);
    json.EndObject();
  }
  json.EndArray();
}

}  // namespace

std::string AccuracyText(const AccuracyReport& report) {
  const WorkPrecision& table = report.table;
  const bool calibrated = table.options.coefficients == Coefficients::kCalibrated;
  std::string text =
      "Part of the secondary motion that is wrong (100 %: no better than a rigid strand), and ns a "
      "strand a frame.\n"
      "*: nothing as cheap is more exact at the rate nearest 60 Hz; stretch is of that rate. "
      "Position-based\nsolvers and follow-the-leader are tuned on these very cases.\n";
  text +=
      fmt::format("Strands with {}.\n", calibrated ? "calibrated coefficients, as layers have them"
                                                   : "equal masses and joints");
  for (const WorkPrecisionPanel& panel : table.panels) AddPanelText(table, panel, text);
  AddCantileverText(report.cantilever, text);
  AddPendulumText(report.pendulum, text);
  AddStabilityText(report.stability, text);
  text += fmt::format(
      "\nmachine   {} ({} cores), {}, {}\ncommit    {}\ntimes     {} kernels, one core, {} "
      "strands; "
      "fastest of {} rounds taken in turn, {} frames each\ndigest    {:016x} of the errors\n"
      "took      {:.1f} s\n",
      report.machine.processor, report.machine.cores, report.machine.compiler,
      report.machine.build_type, report.machine.commit, IsaName(table.options.isa),
      table.timed_strands, table.rounds, table.timed_frames, table.error_digest, report.seconds);
  return text;
}

std::string AccuracyJson(const AccuracyReport& report) {
  const WorkPrecision& table = report.table;
  JsonText json;
  json.BeginObject();
  json.Add("format", kAccuracyFormat);
  AddMachine(report.machine, json);
  json.Add("isa", IsaName(table.options.isa));
  json.Add("quick", table.options.quick);
  json.Add("calibrated", table.options.coefficients == Coefficients::kCalibrated);
  json.Add("rounds", table.rounds);
  json.Add("timed_strands", table.timed_strands);
  json.Add("timed_frames", table.timed_frames);
  json.AddDigest("error_digest", table.error_digest);
  json.Add("seconds", report.seconds);
  json.BeginArray("rates");
  for (const int rate : table.options.rates) json.Add("", rate);
  json.EndArray();
  json.BeginArray("panels");
  for (const WorkPrecisionPanel& panel : table.panels) AddPanel(json, table, panel);
  json.EndArray();
  AddChecks(json, report);
  json.EndObject();
  return json.text();
}

}  // namespace pelt
