#include "bench/consoles/kernel_rows_report.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace pelt {

std::string DescribeKernelRows(std::span<const KernelRow> rows) {
  std::string out = fmt::format(
      "measured kernels through the back end: cycles an iteration of four lanes, and the rate of all "
      "SPUs\n{:<6} {:<52} {:<30} {:>10} {:>9} {:>9} {:>9}  {:<24} {:>6}  {:<12}  {}\n",
      "kernel", "work", "built by", "scheduled", "measured", "written", "measured", "of", "place",
      "class", "verdict");
  for (const KernelRow& r : rows) {
    const KernelRowDefinition& row = *r.row;
    if (!r.failure.empty()) {
      out += fmt::format("{:<6} {:<52} cannot be priced: {}\n", row.id, row.work, r.failure);
      continue;
    }
    out += fmt::format(
        "{:<6} {:<52} {:<30} {:>10.1f} {:>9.1f} {:>9.1f} {:>9.4g}  {:<24} {:>6.2f}  {:<12}  {}\n",
        row.id, row.work, row.built_by, r.scheduled_cycles / r.iterations, r.measured_cycles / r.iterations,
        r.as_written_cycles / r.iterations, row.measured,
        fmt::format("{:.4g} to {:.4g} {}", r.as_written, r.scheduled, row.unit), r.place,
        RowClassName(row.row_class), r.passes ? "in the range" : "OUT OF THE RANGE");
  }
  const MeasuredPlace place = PlaceOf(rows);
  return out + fmt::format(
                   "place: 0 is the best schedule, 1 the order as written; mean {:.2f}, from "
                   "{:.2f} to {:.2f}, of {} kernels.\nA measurement may lie {:.0f} % beyond. "
                   "Measured cycles are without the console's availability.\n",
                   place.mean, place.least, place.most, place.rows, kKernelAllowedPercent);
}

void AddKernelRows(JsonText& json, std::span<const KernelRow> rows) {
  json.BeginArray("kernel_rows");
  for (const KernelRow& r : rows) {
    const KernelRowDefinition& row = *r.row;
    json.BeginObject();
    json.Add("row", row.id);
    json.Add("work", row.work);
    json.Add("unit", row.unit);
    json.Add("built_by", row.built_by);
    json.Add("class", RowClassName(row.row_class));
    json.Add("measured", row.measured);
    json.Add("scheduled", r.scheduled);
    json.Add("as_written", r.as_written);
    json.Add("iterations", r.iterations);
    json.Add("measured_cycles", r.measured_cycles);
    json.Add("scheduled_cycles", r.scheduled_cycles);
    json.Add("as_written_cycles", r.as_written_cycles);
    json.Add("place", r.place);
    json.Add("pass", r.passes);
    if (!r.failure.empty()) json.Add("failure", r.failure);
    json.EndObject();
  }
  json.EndArray();
  const MeasuredPlace place = PlaceOf(rows);
  json.BeginObject("measured_place");
  json.Add("mean", place.mean);
  json.Add("least", place.least);
  json.Add("most", place.most);
  json.EndObject();
}

bool AllPass(std::span<const KernelRow> rows) {
  return std::ranges::all_of(rows, [](const KernelRow& row) { return row.passes; });
}

std::string DescribePlace(double code_order) {
  const MeasuredPlace& measured = MeasuredCodePlace();
  return fmt::format(
      "{:.2f} of the way from the best schedule to the order as written (measured kernels: {:.2f} "
      "to {:.2f})",
      code_order, measured.least, measured.most);
}

}  // namespace pelt
