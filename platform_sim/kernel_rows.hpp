// Kernels that were measured on a console, through all of the back end: written on the vector type
// (rows/measured_kernels.hpp), recorded, simplified, lowered, put on registers, scheduled, timed.
// What every kernel figure rests on, compared with what hardware did.
//
// A price is a range: the order of the source at one end, the best schedule that is found at the
// other. A row says where in it the measurement lies,
//
//   place = (measured cycles - scheduled) / (as written - scheduled)     0 best schedule, 1 as
//   written
//
// and a frame's verdict uses the mean place of the rows that a compiler made (MeasuredPlace), as an engine's code is
// a compiler's; its ends are the two ends of the price.
//
// Invariant: no row has a number of its own in the models.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"
#include "platform_sim/measured_rows.hpp"
#include "platform_sim/platforms/platform.hpp"
#include "platform_sim/pricing/kernel_cost.hpp"

namespace pelt {

// A stretch of a kernel's work that is priced by itself.
struct KernelPart {
  Trace trace;
  uint32_t iterations;
  double times = 1.0;  // that the row's work has it
};

struct KernelRowDefinition {
  std::string_view id, work, unit, built_by;
  bool is_compiled;  // by a compiler, from source in no order of its own
  double measured;   // units of all SPUs together
  uint32_t spus;
  double units_per_pass;  // of one SPU, in giga, or what `unit` says
  bool has_availability;  // measured on a retail PS3, as a rate (platforms/cell.hpp)
  RowClass row_class;     // plausibility: the kernel is ours, its source is not published
  Result<> (*record)(std::vector<KernelPart>& parts);
};

struct KernelRow {
  const KernelRowDefinition* row = nullptr;
  // Cycles of one pass over the row's work on one SPU; measured: with the availability taken out.
  double measured_cycles = 0.0, scheduled_cycles = 0.0, as_written_cycles = 0.0;
  double iterations = 0.0;                   // of the pass
  double scheduled = 0.0, as_written = 0.0;  // in the row's unit, with the availability
  double place = 0.0;
  bool passes = false;  // the measurement lies in the range, or kKernelAllowedPercent beyond
  std::string failure;  // why there is no price; empty
};
inline constexpr double kKernelAllowedPercent = 5.0;

std::span<const KernelRowDefinition> KernelRows();
KernelRow PriceKernelRow(const KernelRowDefinition& row, const PlatformParameters& platform);
std::vector<KernelRow> PriceKernelRows(const PlatformParameters& platform = {});

// Where compiled kernels that were measured lay in their prices.
struct MeasuredPlace {
  double mean = 0.0, least = 0.0, most = 0.0;
  uint32_t rows = 0;
};
MeasuredPlace PlaceOf(std::span<const KernelRow> rows);
// Of the rows on the standard platforms; made once.
const MeasuredPlace& MeasuredCodePlace();

}  // namespace pelt
