#include "bench/report/memory_table.hpp"

namespace pelt {

void AddMemory(const SceneLayout& layout, ReportTree& report) {
  ReportTable& memory =
      report.AddTable("memory", {{.key = "memory"}, {"bytes"}, {"blocks"}, {"role"}});
  memory.is_map = true;
  for (const MemoryRange& range : layout.ranges)
    if (range.bytes) memory.Add({range.name, range.bytes, range.blocks, RoleName(range.role)});
  report.Add({"memory_bytes", "B", -1, "all"}, layout.total_bytes);
  report.Add(InText("bytes per strand", "", 0),
             double(layout.total_bytes) / double(layout.strand_count));
  report.Add({"state_bytes_per_strand", "", 1, "of them simulation state"},
             layout.StateBytesPerStrand());
}

}  // namespace pelt
