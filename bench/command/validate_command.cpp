// `pelt budget --validate`: the measured rows beside what the models say of them.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "bench/command/commands.hpp"
#include "bench/consoles/kernel_rows_report.hpp"
#include "bench/report/json_text.hpp"
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
std::string Prediction(const RowResult& row, double value, RowKind counts) {
  return fmt::format("{:>9} {:>+7.2f}{}", Number(value), row.ErrorPercent(value),
                     row.kind == counts ? '*' : ' ');
}

void PrintTable(const std::vector<RowResult>& rows) {
  fmt::print("{:<5} {:<55} {:<16} {:>12}  {:>18} {:>18}  {:>7}  {:<12}  {}\n", "row", "work",
             "unit", "measured", "raw, off %", "available, off %", "allowed", "class", "verdict");
  for (const RowResult& row : rows) {
    if (!row.failure.empty()) {
      fmt::print("{:<5} {:<55} cannot be run: {}\n", row.id, row.work, row.failure);
      continue;
    }
    fmt::print("{:<5} {:<55} {:<16} {:>12}  {} {}  {:>7}  {:<12}  {}\n", row.id, row.work, row.unit,
               Measured(row), Prediction(row, row.predicted_raw, RowKind::kWay),
               Prediction(row, row.predicted_with_availability, RowKind::kRate), AllowedOff(row),
               RowClassName(row.row_class), row.passes ? "ok" : "MISSED");
  }
}

// What is no evidence of its own is named beside the count, never in it.
void PrintCounts(const std::vector<RowResult>& rows, const RowCount& independent) {
  fmt::print("{} independent rows: {} predicted within what they allow, {} missed. Not counted:",
             independent.rows, independent.rows - independent.missed, independent.missed);
  for (const RowClass c : {RowClass::kDerived, RowClass::kPlausibility, RowClass::kParameter}) {
    const RowCount count = CountRows(rows, c);
    fmt::print("{} {} {}", c == RowClass::kDerived ? "" : ",", count.rows, RowClassName(c));
    if (count.missed > 0) fmt::print(" ({} missed)", count.missed);
  }
  fmt::print(".\n");
  for (const RowResult& row : rows)
    if (!row.missed_because.empty()) fmt::print("{}: {}.\n", row.id, row.missed_because);
  fmt::print(
      "* is held against the measurement: rates with the console's availability, single ways "
      "without.\n");
}

std::string RowsAsJson(const std::vector<RowResult>& rows, const std::vector<KernelRow>& kernels,
                       bool pass) {
  JsonText json;
  json.BeginObject();
  json.Add("pass", pass);
  json.BeginObject("count");
  for (uint32_t c = 0; c < kRowClassCount; ++c) {
    const RowCount count = CountRows(rows, RowClass(c));
    json.BeginObject(RowClassName(RowClass(c)));
    json.Add("rows", count.rows);
    json.Add("missed", count.missed);
    json.EndObject();
  }
  json.EndObject();
  json.BeginArray("rows");
  for (const RowResult& row : rows) {
    json.BeginObject();
    json.Add("row", row.id);
    json.Add("work", row.work);
    json.Add("unit", row.unit);
    json.Add("measured_least", row.measured_least);
    json.Add("measured_most", row.measured_most);
    json.Add("predicted_raw", row.predicted_raw);
    json.Add("predicted_with_availability", row.predicted_with_availability);
    json.Add("availability_counts", row.kind == RowKind::kRate);
    json.Add("error_raw_percent", row.ErrorPercent(row.predicted_raw));
    json.Add("error_with_availability_percent", row.ErrorPercent(row.predicted_with_availability));
    json.Add("allowed", row.allowed);
    json.Add("allowed_in", row.allowed_in == Allowed::kPercent ? "percent" : "units");
    json.Add("allowed_from", row.allowed_from);
    json.Add("class", RowClassName(row.row_class));
    if (!row.class_because.empty()) json.Add("class_because", row.class_because);
    if (!row.missed_because.empty()) json.Add("missed_because", row.missed_because);
    json.Add("pass", row.passes);
    if (!row.failure.empty()) json.Add("failure", row.failure);
    json.EndObject();
  }
  json.EndArray();
  AddKernelRows(json, kernels);
  json.EndObject();
  return json.text();
}

}  // namespace

int PrintValidation(const ValidateArgs& args) {
  const std::vector<RowResult> rows = PredictRows();
  const std::vector<KernelRow> kernels = PriceKernelRows();
  const RowCount independent = CountRows(rows, RowClass::kIndependent);
  const bool pass = std::ranges::none_of(rows, &RowResult::Surprises) && AllPass(kernels);
  if (args.json) {
    fmt::print("{}\n", RowsAsJson(rows, kernels, pass));
  } else {
    PrintTable(rows);
    PrintCounts(rows, independent);
    fmt::print("\n{}", DescribeKernelRows(kernels));
  }
  return pass ? 0 : 1;
}

}  // namespace pelt
