// `pelt budget --validate`: the measured rows beside what the models say of them.
#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <vector>

#include "bench/commands.hpp"
#include "bench/json_text.hpp"
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

std::string_view Verdict(const RowResult& row) {
  if (!row.passes) return "MISSED";
  return row.is_parameter ? "parameter" : "ok";
}

// The prediction that counts has a star.
std::string Prediction(const RowResult& row, double value, RowKind counts) {
  return fmt::format("{:>9} {:>+7.2f}{}", Number(value), row.ErrorPercent(value),
                     row.kind == counts ? '*' : ' ');
}

void PrintTable(const std::vector<RowResult>& rows) {
  fmt::print("{:<5} {:<55} {:<16} {:>12}  {:>18} {:>18}  {:>7}  {}\n", "row", "work", "unit",
             "measured", "raw, off %", "available, off %", "allowed", "verdict");
  for (const RowResult& row : rows) {
    if (!row.failure.empty()) {
      fmt::print("{:<5} {:<55} cannot be run: {}\n", row.id, row.work, row.failure);
      continue;
    }
    fmt::print("{:<5} {:<55} {:<16} {:>12}  {} {}  {:>7}  {}\n", row.id, row.work, row.unit,
               Measured(row), Prediction(row, row.predicted_raw, RowKind::kWay),
               Prediction(row, row.predicted_with_availability, RowKind::kRate), AllowedOff(row),
               Verdict(row));
  }
}

std::string RowsAsJson(const std::vector<RowResult>& rows, bool pass) {
  JsonText json;
  json.BeginObject();
  json.Add("pass", pass);
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
    json.Add("is_parameter", row.is_parameter);
    json.Add("pass", row.passes);
    if (!row.failure.empty()) json.Add("failure", row.failure);
    json.EndObject();
  }
  json.EndArray();
  json.EndObject();
  return json.text();
}

}  // namespace

int PrintValidation(const ValidateArgs& args) {
  const std::vector<RowResult> rows = PredictRows();
  const auto missed = std::ranges::count(rows, false, &RowResult::passes);
  const auto parameters = std::ranges::count(rows, true, &RowResult::is_parameter);
  if (args.json) {
    fmt::print("{}\n", RowsAsJson(rows, missed == 0));
  } else {
    PrintTable(rows);
    fmt::print(
        "{} rows: {} predictions and {} that are the models' own parameters; {} missed.\n"
        "* is held against the measurement: rates with the console's availability, single ways "
        "without.\n",
        rows.size(), std::ptrdiff_t(rows.size()) - parameters, parameters, missed);
  }
  return missed == 0 ? 0 : 1;
}

}  // namespace pelt
