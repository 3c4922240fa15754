// `pelt budget --validate`: the measured rows beside what the models say of them.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "bench/command/commands.hpp"
#include "bench/consoles/console_report.hpp"
#include "bench/report/report_tree.hpp"
#include "platform_sim/measured_rows.hpp"

namespace pelt {
namespace {

std::string Number(double value) {
  return value >= 1000.0 ? fmt::format("{:.0f}", value) : fmt::format("{:.4g}", value);
}

std::string Measured(const RowResult& row) {
  if (row.measured_least == row.measured_most) return Number(row.measured_least);
  return fmt::format("{} to {}", Number(row.measured_least), Number(row.measured_most));
}

std::string AllowedOff(const RowResult& row) {
  if (row.allowed == 0.0) return row.measured_least == row.measured_most ? "none" : "range";
  return fmt::format("{}{}", row.allowed, row.allowed_in == Allowed::kPercent ? " %" : "");
}

// The prediction that counts has a star.
Value Star(const RowResult& row, RowKind counts) { return row.kind == counts ? "*" : ""; }

Value IfAny(std::string_view text) { return text.empty() ? Value{} : Value(text); }

// What a row is of stands in a table of its own, or it would not fit the width.
void AddRows(const std::vector<RowResult>& rows, ReportTree& tree) {
  ReportTable& works =
      tree.AddTable({}, {InText("row"), InText("class"), InText("unit"), InText("work")});
  ReportTable& table = tree.AddTable("rows", {{"row"},
                                              InJson("work"),
                                              InJson("unit"),
                                              InText("measured"),
                                              InJson("measured_least"),
                                              InJson("measured_most"),
                                              {"predicted_raw", "", -4, "raw"},
                                              {"error_raw_percent", "%", 2, "off"},
                                              InText(" "),
                                              {"predicted_with_availability", "", -4, "available"},
                                              {"error_with_availability_percent", "%", 2, "off"},
                                              InText(" "),
                                              InJson("availability_counts"),
                                              InJson("allowed"),
                                              InText("allowed"),
                                              InJson("allowed_in"),
                                              InJson("allowed_from"),
                                              InJson("class"),
                                              InJson("class_because"),
                                              InJson("missed_because"),
                                              InJson("pass"),
                                              InJson("failure"),
                                              InText("verdict")});
  std::vector<std::string> remarks;
  for (const RowResult& row : rows) {
    const std::string_view row_class = RowClassName(row.row_class);
    works.Add({row.id, row_class, row.unit, row.work});
    table.Add({row.id,
               row.work,
               row.unit,
               Measured(row),
               row.measured_least,
               row.measured_most,
               row.predicted_raw,
               row.ErrorPercent(row.predicted_raw),
               Star(row, RowKind::kWay),
               row.predicted_with_availability,
               row.ErrorPercent(row.predicted_with_availability),
               Star(row, RowKind::kRate),
               row.kind == RowKind::kRate,
               row.allowed,
               AllowedOff(row),
               row.allowed_in == Allowed::kPercent ? "percent" : "units",
               row.allowed_from,
               row_class,
               IfAny(row.class_because),
               IfAny(row.missed_because),
               row.passes,
               IfAny(row.failure),
               row.passes ? "ok" : "MISSED"},
              row.failure.empty() ? Show::kBoth : Show::kJson);
    if (!row.failure.empty())
      remarks.push_back(fmt::format("{}: cannot be run: {}", row.id, row.failure));
    if (!row.missed_because.empty())
      remarks.push_back(fmt::format("{}: {}.", row.id, row.missed_because));
  }
  tree.AddTexts({}, remarks);
}

ReportTree MakeTree(const std::vector<RowResult>& rows, const std::vector<KernelRow>& kernels,
                    bool pass) {
  ReportTree tree;
  tree.Add(InJson("pass"), pass);
  AddRows(rows, tree);
  // What is no evidence of its own is named beside the count, never in it.
  tree.Say("Only independent rows count:");
  ReportTree& count = tree.AddSection("count");
  for (uint32_t c = 0; c < kRowClassCount; ++c) {
    const std::string name(RowClassName(RowClass(c)));
    const RowCount of = CountRows(rows, RowClass(c));
    count.AddSection(name, name).Add({"rows"}, of.rows).Add({"missed"}, of.missed);
  }
  tree.Say(
      "* is compared with the measurement: rates with the console's availability, single ways "
      "without.");
  tree.BlankLine();
  AddKernelRows(kernels, tree);
  return tree;
}

}  // namespace

ExitCode PrintValidation(const ValidateArgs& args) {
  const std::vector<RowResult> rows = PredictRows();
  const std::vector<KernelRow> kernels = PriceKernelRows();
  const bool pass = std::ranges::none_of(rows, &RowResult::Surprises) && AllPass(kernels);
  MakeTree(rows, kernels, pass).Print(args.json);
  return AnswerOf(pass);
}

}  // namespace pelt
