#include "platform_sim/measured_rows.hpp"

#include <algorithm>
#include <cmath>

#include "platform_sim/rows/predictions.hpp"

namespace pelt {
namespace {

using enum RowKind;
constexpr Allowed kPercent = Allowed::kPercent, kUnits = Allowed::kUnits;

constexpr std::string_view kSpuRates = "SPU rates: 2 %";
constexpr std::string_view kExact = "published by the vendor's tool: exact";
constexpr std::string_view kWholeCycles = "measured in whole cycles";
constexpr std::string_view kTransfers = "DMA and bus: 5 %";
constexpr std::string_view kJobs = "jobs: 20 %";
constexpr std::string_view kPpe = "PPE: 10 %";
constexpr std::string_view kRange = "the published range";

constexpr std::string_view kPieces = "main memory to local store, 8 pieces in flight";
constexpr std::string_view kJobQueue = "gcell's job queue, 1 SPE, nominal job length";

// clang-format off
constexpr RowDefinition kRows[] = {
    {"C1", "single-precision multiply-adds, 6 chains, 6 SPEs", "GFLOPS", 134.4, 134.4,
     kRate, false, 2.0, kPercent, kSpuRates, rows::SinglePrecisionRate},
    {"C2", "integer multiply-adds, 7 chains, 6 SPEs", "Gop/s", 130.1, 130.1,
     kRate, false, 2.0, kPercent, kSpuRates, rows::IntegerRate},
    {"C5", "Newton reciprocal and root, 6 wide, 6 SPEs", "Gop/s", 56.43, 56.43,
     kRate, false, 2.0, kPercent, kSpuRates, rows::NewtonRate},
    {"C7", "double-precision multiply-adds, 13 chains, 6 SPEs", "GFLOPS", 8.65, 8.65,
     kRate, false, 2.0, kPercent, kSpuRates, rows::DoublePrecisionRate},
    {"C9", "loop of 12 with an unhinted taken branch", "cycles a turn", 30, 30,
     kWay, false, 0.5, kUnits, kWholeCycles, rows::BranchTurn},
    {"C13", "SGEMM of 64 x 64 in one local store, our own schedule", "% of peak", 99.8, 99.8,
     kWay, false, 2.0, kPercent, kSpuRates, rows::MatrixPeakShare},
    {"C23", "IBM's published listing, 18 instructions", "cycles a turn", 42, 42,
     kWay, false, 0.0, kUnits, kExact, rows::PublishedTurn},
    {"C23t", "the same: issue times that are as printed", "of 18", 18, 18,
     kWay, false, 0.0, kUnits, kExact, rows::PublishedIssueTimes},

    {"D1", "main memory to local store, 16 KiB, double-buffered", "GB/s", 22.83, 22.83,
     kRate, false, 5.0, kPercent, kTransfers, rows::DoubleBufferedReads, 16384},
    {"D3", kPieces, "GB/s, 256 B", 22, 22, kRate, false, 5.0, kPercent, kTransfers,
     rows::EightInFlight, 256},
    {"D4", kPieces, "GB/s, 512 B", 22, 22, kRate, false, 5.0, kPercent, kTransfers,
     rows::EightInFlight, 512},
    {"D5", kPieces, "GB/s, 1 KiB", 22, 22, kRate, false, 5.0, kPercent, kTransfers,
     rows::EightInFlight, 1024},
    {"D6", kPieces, "GB/s, 2 KiB", 22, 22, kRate, false, 5.0, kPercent, kTransfers,
     rows::EightInFlight, 2048},
    {"D7", kPieces, "GB/s, 4 KiB", 22, 22, kRate, false, 5.0, kPercent, kTransfers,
     rows::EightInFlight, 4096},
    {"D8", kPieces, "GB/s, 8 KiB", 22, 22, kRate, false, 5.0, kPercent, kTransfers,
     rows::EightInFlight, 8192},
    {"D9", kPieces, "GB/s, 16 KiB", 22, 22, kRate, false, 5.0, kPercent, kTransfers,
     rows::EightInFlight, 16384},
    {"E1", "3 pairs of SPEs, both ways; mean of the 28 consoles", "GB/s", 114.73, 114.73,
     kRate, false, 5.0, kPercent, kTransfers, rows::PairsBothWays},
    {"E8", "one SPE reads another, all 30 ordered pairs in turn", "GB/s", 23.42, 23.42,
     kRate, false, 5.0, kPercent, kTransfers, rows::OnePairAfterAnother},
    {"S1", "atomic line bounced between 2 SPEs", "ns a bounce", 150, 150,
     kWay, false, 5.0, kPercent, kTransfers, rows::AtomicBounce},
    {"S2", "mailbox PPE to SPE and back, through the system", "us a round trip", 11.6, 11.6,
     kWay, true, 5.0, kPercent, kTransfers, rows::Mailbox},

    {"J1a", kJobQueue, "us a job of 100", 107.53, 107.53, kRate, false, 20.0, kPercent, kJobs,
     rows::JobsOnOneSpe, 100},
    {"J1b", kJobQueue, "us a job of 300", 320.62, 320.62, kRate, false, 20.0, kPercent, kJobs,
     rows::JobsOnOneSpe, 300},
    {"J1c", kJobQueue, "us a job of 500", 533.64, 533.64, kRate, false, 20.0, kPercent, kJobs,
     rows::JobsOnOneSpe, 500},
    {"J4", "the same, short jobs, mean over 2 to 6 SPEs", "us a job of 5", 19, 25,
     kRate, true, 0.0, kPercent, kRange, rows::FloorOfShortJobs, 5},

    {"P1", "PPE, pointer chase in L1", "cycles", 6.4, 6.4,
     kWay, false, 10.0, kPercent, kPpe, rows::PpeChase, 16 * 1024},
    {"P3", "PPE, pointer chase in L2, 256 KiB", "cycles", 36, 36,
     kWay, true, 10.0, kPercent, kPpe, rows::PpeChase, 256 * 1024},
    {"P5", "PPE, vector reads in L1, 28 KiB", "GB/s", 10.3, 10.3,
     kRate, false, 10.0, kPercent, kPpe, rows::PpeStream, 28 * 1024},
    {"P7", "PPE, VMX multiply-adds, 6 chains", "GFLOPS", 12.2, 12.2,
     kRate, false, 10.0, kPercent, kPpe, rows::PpeVectorFma},

    {"X1", "Xenon, lwsync", "cycles", 33, 48,
     kWay, true, 0.0, kPercent, kRange, rows::XenonSynchronisation, 0},
    {"X2", "Xenon, InterlockedIncrement", "cycles", 225, 260,
     kWay, true, 0.0, kPercent, kRange, rows::XenonSynchronisation, 1},
    {"X3", "Xenon, critical section", "cycles", 345, 345,
     kWay, true, 0.0, kPercent, kRange, rows::XenonSynchronisation, 2},
    {"X4", "Xenon, mutex", "cycles", 2350, 2350,
     kWay, true, 0.0, kPercent, kRange, rows::XenonSynchronisation, 3},
    {"X5", "Xenon, load-hit-store, up to", "cycles", 0, 40,
     kWay, true, 0.0, kPercent, kRange, rows::XenonLoadHitStore},
    {"X6", "Xenon, second hardware thread: points by a matrix", "% gained", 10, 20,
     kWay, false, 0.0, kPercent, kRange, rows::XenonSecondThreadGain},
};
// clang-format on

// Availability of the console that the row was measured on.
double AvailabilityOf(const RowDefinition& row, const PlatformParameters& p) {
  return row.id.starts_with('X') ? p.xenon.Availability() : p.cell.Availability();
}

bool IsWithin(const RowResult& row) {
  constexpr double kRounding = 1e-9;
  const double predicted = row.Predicted();
  if (row.allowed_in == Allowed::kPercent)
    return std::abs(row.ErrorPercent(predicted)) <= row.allowed + kRounding;
  return predicted >= row.measured_least - row.allowed - kRounding &&
         predicted <= row.measured_most + row.allowed + kRounding;
}

}  // namespace

double RowResult::ErrorPercent(double predicted) const {
  if (predicted >= measured_least && predicted <= measured_most) return 0.0;
  const double nearer = predicted < measured_least ? measured_least : measured_most;
  return 100.0 * (predicted / nearer - 1.0);
}

std::span<const RowDefinition> MeasuredRows() { return kRows; }

const RowDefinition* FindRow(std::string_view id) {
  const auto row = std::ranges::find(kRows, id, &RowDefinition::id);
  return row == std::end(kRows) ? nullptr : row;
}

RowResult PredictRow(const RowDefinition& row, const PlatformParameters& p) {
  RowResult result{.id = row.id,
                   .work = row.work,
                   .unit = row.unit,
                   .measured_least = row.measured_least,
                   .measured_most = row.measured_most,
                   .kind = row.kind,
                   .is_parameter = row.is_parameter,
                   .allowed = row.allowed,
                   .allowed_in = row.allowed_in,
                   .allowed_from = row.allowed_from,
                   .failure = {}};
  if (row.predict(p, 1.0, row.argument, result.predicted_raw, result.failure) &&
      row.predict(p, AvailabilityOf(row, p), row.argument, result.predicted_with_availability,
                  result.failure))
    result.passes = IsWithin(result);
  return result;
}

std::vector<RowResult> PredictRows(const PlatformParameters& p) {
  std::vector<RowResult> results;
  for (const RowDefinition& row : kRows) results.push_back(PredictRow(row, p));
  return results;
}

}  // namespace pelt
