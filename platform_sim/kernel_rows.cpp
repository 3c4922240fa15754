#include "platform_sim/kernel_rows.hpp"

#include <algorithm>
#include <memory>

#include "platform_sim/pricing/record_kernel.hpp"
#include "platform_sim/rows/measured_kernels.hpp"

namespace pelt {
namespace {

using V = RecordingVec;

// As many as make a trace that windows find their places in.
constexpr uint32_t kRecordedBodies = 2, kRecordedNewtonIterations = 8;

Result<> AddPart(Result<Trace> trace, uint32_t iterations, double times,
                 std::vector<KernelPart>& parts) {
  if (!trace) return Failure{trace.error()};
  parts.push_back({*std::move(trace), iterations, times});
  return Done{};
}

// One body, all others.
Result<> RecordBodies(std::vector<KernelPart>& parts) {
  const auto bodies = std::make_unique<Bodies>();
  Pulls pulls[kRecordedBodies];
  return AddPart(RecordKernel({{bodies.get(), sizeof(Bodies)}, {pulls, sizeof pulls}},
                              [&] {
                                for (uint32_t b = 0; b < kRecordedBodies; ++b)
                                  PullOnBody<V>(*bodies, b, pulls[b]);
                              }),
                 kRecordedBodies * kBodies / V::kLanes, 1.0 / kRecordedBodies, parts);
}

Result<> RecordFft(std::vector<KernelPart>& parts) {
  const auto tables = std::make_unique<FftTables>();
  const auto data = std::make_unique<FftData>();
  for (uint32_t i = 0; i < kFftPoints; ++i)
    for (uint32_t bit = 1; bit < kFftPoints; bit *= 2)
      if (i & bit) tables->reversed[i] |= kFftPoints / 2 / bit;
  const std::initializer_list<KernelBlock> blocks = {{tables.get(), sizeof(FftTables)},
                                                     {data.get(), sizeof(FftData)}};
  uint32_t swaps = 0, log2 = 0;
  while (1u << log2 < kFftPoints) ++log2;
  auto reversal = RecordKernel(blocks, [&] { swaps = FftReversal<V>(*tables, *data); });
  if (auto added = AddPart(std::move(reversal), swaps, 1.0, parts); !added) return added;
  return AddPart(RecordKernel(blocks, [&] { FftButterflies<V>(*tables, *data); }),
                 kFftPoints / 2 * log2, 1.0, parts);
}

Result<> RecordNewton(std::vector<KernelPart>& parts) {
  struct alignas(128) {
    float lanes[kNewtonChains][32] = {};
  } rows;
  return AddPart(RecordKernel({{&rows, sizeof rows}},
                              [&] {
                                V x[kNewtonChains];
                                for (uint32_t c = 0; c < kNewtonChains; ++c)
                                  x[c] = V::Load(rows.lanes[c]);
                                NewtonIterations(x, kRecordedNewtonIterations);
                                for (uint32_t c = 0; c < kNewtonChains; ++c)
                                  x[c].Store(rows.lanes[c]);
                              }),
                 kRecordedNewtonIterations, 1.0 / kRecordedNewtonIterations, parts);
}

Result<> RecordMatrices(std::vector<KernelPart>& parts) {
  const auto m = std::make_unique<Matrix[]>(3);
  return AddPart(
      RecordKernel({{m.get(), 3 * sizeof(Matrix)}}, [&] { SubtractProduct<V>(m[0], m[1], m[2]); }),
      kMatrixIterations, 1.0, parts);
}

constexpr double kNewtonOperations = 2112e-9;  // per iteration, as the row counts
constexpr double kMatrixFlops = 2e-9 * kMatrixSide * kMatrixSide * kMatrixSide;

constexpr KernelRowDefinition kKernelRows[] = {
    {"K1", "N-body, 4,080 bodies: the pull on one", "Mpairs/s", "spu-gcc 4.1 -O2 -funroll-loops",
     true, 2195.0, 6, 1e-6 * kBodies, true, RowClass::kIndependent, RecordBodies},
    {"K2", "FFT of 1,024 points, radix 2, 4 in lanes", "Mpoints/s",
     "spu-gcc 4.1 -O2 -funroll-loops", true, 184.82, 6, 4e-6 * kFftPoints, true,
     RowClass::kIndependent, RecordFft},
    {"C5", "Newton reciprocal and root, 6 wide", "Gop/s", "assembly in the order as written", false,
     56.43, 6, kNewtonOperations, true, RowClass::kDerived, RecordNewton},
    {"C13", "SGEMM of 64 x 64 in one local store, our own source", "GFLOP/s",
     "assembly, scheduled by a tool", false, 25.55, 1, kMatrixFlops, false, RowClass::kPlausibility,
     RecordMatrices},
};

}  // namespace

std::span<const KernelRowDefinition> KernelRows() { return kKernelRows; }

KernelRow PriceKernelRow(const KernelRowDefinition& row, const PlatformParameters& platform) {
  KernelRow out;
  out.row = &row;
  const PricedCore core = MakePricedCore(CoreKind::kSpu, platform);
  std::vector<KernelPart> parts;
  if (const auto recorded = row.record(parts); !recorded) {
    out.failure = recorded.error();
    return out;
  }
  for (const KernelPart& part : parts) {
    const auto cost = PriceTrace(part.trace, part.iterations, core, {});
    if (!cost) {
      out.failure = cost.error();
      return out;
    }
    const double iterations = part.times * part.iterations;
    out.iterations += iterations;
    out.scheduled_cycles += cost->scheduled.cycles_per_iteration * iterations;
    out.as_written_cycles += cost->as_written.cycles_per_iteration * iterations;
  }
  const double availability = row.has_availability ? platform.cell.Availability() : 1.0;
  const double units = row.units_per_pass * row.spus * double(core.clock_hz) * availability;
  out.measured_cycles = units / row.measured;
  out.scheduled = units / out.scheduled_cycles;
  out.as_written = units / out.as_written_cycles;
  out.place = (out.measured_cycles - out.scheduled_cycles) /
              std::max(out.as_written_cycles - out.scheduled_cycles, 1e-9);
  const double beyond = 1.0 + kKernelAllowedPercent / 100.0;
  out.passes = out.measured_cycles * beyond >= out.scheduled_cycles &&
               out.measured_cycles <= out.as_written_cycles * beyond;
  return out;
}

std::vector<KernelRow> PriceKernelRows(const PlatformParameters& platform) {
  std::vector<KernelRow> out;
  for (const KernelRowDefinition& row : kKernelRows) out.push_back(PriceKernelRow(row, platform));
  return out;
}

MeasuredPlace PlaceOf(std::span<const KernelRow> rows) {
  MeasuredPlace place;
  for (const KernelRow& row : rows) {
    if (!row.failure.empty() || !row.row->is_compiled) continue;
    place.least = place.rows ? std::min(place.least, row.place) : row.place;
    place.most = place.rows ? std::max(place.most, row.place) : row.place;
    place.mean += row.place;
    ++place.rows;
  }
  if (place.rows) place.mean /= place.rows;
  return place;
}

const MeasuredPlace& MeasuredCodePlace() {
  static const MeasuredPlace place = PlaceOf(PriceKernelRows());
  return place;
}

}  // namespace pelt
