#include <fmt/format.h>

#include <algorithm>

#include "bench/consoles/console_report.hpp"

namespace pelt {

void AddKernelRows(std::span<const KernelRow> rows, ReportTree& tree) {
  tree.Say(
      "measured kernels through the back end: cycles per iteration of four lanes, and the rate of "
      "all SPUs");
  ReportTable& works =
      tree.AddTable({}, {InText("kernel"), InText("class"), InText("built by"), InText("work")});
  ReportTable& table = tree.AddTable("kernel_rows", {{"row", "", -1, "kernel"},
                                                     InJson("work"),
                                                     InJson("built_by"),
                                                     InJson("class"),
                                                     InText("scheduled", "cycles", 1),
                                                     InText("measured", "cycles", 1),
                                                     InText("written", "cycles", 1),
                                                     {"measured", "rate", -4},
                                                     {"as_written", "rate", -4, "written"},
                                                     {"scheduled", "rate", -4},
                                                     {"unit"},
                                                     InJson("iterations"),
                                                     InJson("measured_cycles"),
                                                     InJson("scheduled_cycles"),
                                                     InJson("as_written_cycles"),
                                                     {"place", "", 2},
                                                     InJson("pass"),
                                                     InJson("failure"),
                                                     InText("verdict")});
  std::vector<std::string> failures;
  for (const KernelRow& r : rows) {
    const KernelRowDefinition& row = *r.row;
    const std::string_view row_class = RowClassName(row.row_class);
    const bool failed = !r.failure.empty();
    works.Add({row.id, row_class, row.built_by, row.work});
    table.Add({row.id, row.work, row.built_by, row_class, r.scheduled_cycles / r.iterations,
               r.measured_cycles / r.iterations, r.as_written_cycles / r.iterations, row.measured,
               r.as_written, r.scheduled, row.unit, r.iterations, r.measured_cycles,
               r.scheduled_cycles, r.as_written_cycles, r.place, r.passes,
               failed ? Value(r.failure) : Value{}, r.passes ? "in the range" : "OUT OF IT"},
              failed ? Show::kJson : Show::kBoth);
    if (failed) failures.push_back(fmt::format("{} cannot be priced: {}", row.id, r.failure));
  }
  tree.AddTexts({}, failures);
  const MeasuredPlace place = PlaceOf(rows);
  ReportTree& measured = tree.AddSection("measured_place", "place");
  measured.Add({"mean", "", 2}, place.mean).Add({"least", "", 2, "from"}, place.least);
  measured.Add({"most", "", 2, "to"}, place.most).Add(InText("kernels"), place.rows);
  tree.Say(
      fmt::format("0 is the best schedule, 1 the order as written. A measurement may lie "
                  "{:.0f} % beyond. Measured cycles are without the console's availability.",
                  kKernelAllowedPercent));
}

bool AllPass(std::span<const KernelRow> rows) {
  return std::ranges::all_of(rows, [](const KernelRow& row) { return row.passes; });
}

std::string DescribePlace(double code_order) {
  const MeasuredPlace& measured = MeasuredCodePlace();
  return fmt::format(
      "{:.2f} of the way from the best schedule to the order as written (a compiler's kernels: "
      "{:.2f} "
      "to {:.2f})",
      code_order, measured.least, measured.most);
}

}  // namespace pelt
