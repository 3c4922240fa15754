#include "platform_sim/measured_rows.hpp"

#include <algorithm>
#include <cmath>

#include "platform_sim/rows/predictions.hpp"

namespace pelt {
namespace {

using enum RowKind;
using enum RowClass;
constexpr Allowed kPercent = Allowed::kPercent, kUnits = Allowed::kUnits;

constexpr std::string_view kSpuRates = "SPU rates: 2 %";
constexpr std::string_view kExact = "published by the vendor's tool: exact";
constexpr std::string_view kWholeCycles = "measured in whole cycles";
constexpr std::string_view kTransfers = "DMA and bus: 5 %";
constexpr std::string_view kJobs = "jobs: 20 %";
constexpr std::string_view kPpe = "PPE: 10 %";
constexpr std::string_view kRange = "the published range";

constexpr std::string_view kOwnLoop = "what was run is not published: the loop is our own";
constexpr std::string_view kGuesses = "a sum of numbers of class L";
constexpr std::string_view kOwnNumber = "the models' own number";
constexpr std::string_view kManualsUpperEnd =
    "picks 6 of the 4 to 6 cycles that the PPE's manual gives a load";
constexpr std::string_view kRepeatsC23 = "repeats C23: the same listing, cycle by cycle";
constexpr std::string_view kRepeatsD3 = "repeats D3: the memory's rate, for pieces of any size";
constexpr std::string_view kIntercept =
    "what a job costs beyond its length was read off these rows";

constexpr std::string_view kOneCycleMore =
    "the SDK's 15 cycles from a hint to its branch and the iteration's last make 16";
constexpr std::string_view kNothingShared =
    "in the ring's order its three pairs share no part of it, so the model has every port at its "
    "full rate; what holds them back on the console is not known";
constexpr std::string_view kLeavesL1 =
    "what it reads does not stay in L1: the console counts up to 0.4 misses a line, and the model "
    "knows "
    "no reason for them";

constexpr std::string_view kPieces = "main memory to local store, 8 pieces in flight";
constexpr std::string_view kJobQueue = "gcell's job queue, 1 SPE, nominal job length";

// clang-format off
constexpr RowDefinition kMeasuredRows[] = {
    {"C1", "single-precision multiply-adds, 6 chains, 6 SPEs", "GFLOPS", 134.4, 134.4,
     kRate, kIndependent, 2.0, kPercent, kSpuRates, rows::SinglePrecisionRate},
    {"C2", "integer multiply-adds, 7 chains, 6 SPEs", "Gop/s", 130.1, 130.1,
     kRate, kIndependent, 2.0, kPercent, kSpuRates, rows::IntegerRate},
    {"C3", "shuffles, 5 chains, and rotates, 6 SPEs", "Gop/s", 68.43, 68.43,
     kRate, kIndependent, 2.0, kPercent, kSpuRates, rows::ShuffleRate},
    {"C4", "multiply-adds beside shuffles, both pipes, 6 SPEs", "Gop/s", 202.13, 202.13,
     kRate, kIndependent, 2.0, kPercent, kSpuRates, rows::DualIssueRate},
    {"C5", "Newton reciprocal and root, 6 wide, 6 SPEs", "Gop/s", 56.43, 56.43,
     kRate, kIndependent, 2.0, kPercent, kSpuRates, rows::NewtonRate},
    {"C6", "the same with a nop of the wrong pipe behind each and", "Gop/s", 52.77, 52.77,
     kRate, kIndependent, 2.0, kPercent, kSpuRates, rows::EvenNopNewtonRate},
    {"C7", "double-precision multiply-adds, 13 chains, 6 SPEs", "GFLOPS", 8.65, 8.65,
     kRate, kIndependent, 2.0, kPercent, kSpuRates, rows::DoublePrecisionRate},
    {"C9", "loop of 12 with an unhinted taken branch", "cycles per iteration", 30, 30,
     kWay, kIndependent, 0.5, kUnits, kWholeCycles, rows::BranchIteration},
    {"C10", "the same with a hint at its head", "cycles per iteration", 17, 17,
     kWay, kIndependent, 0.5, kUnits, kWholeCycles, rows::HintedBranchIteration, 0, {}, kOneCycleMore},
    {"C13", "SGEMM of 64 x 64 in one local store, our own schedule", "% of peak", 99.8, 99.8,
     kWay, kPlausibility, 2.0, kPercent, kSpuRates, rows::MatrixPeakShare, 0, kOwnLoop},
    {"C23", "IBM's published listing, 18 instructions", "cycles per iteration", 42, 42,
     kWay, kIndependent, 0.0, kUnits, kExact, rows::PublishedIteration},
    {"C23t", "the same: issue times that are as printed", "of 18", 18, 18,
     kWay, kDerived, 0.0, kUnits, kExact, rows::PublishedIssueTimes, 0, kRepeatsC23},

    {"D1", "main memory to local store, 16 KiB, double-buffered", "GB/s", 22.83, 22.83,
     kRate, kIndependent, 5.0, kPercent, kTransfers, rows::DoubleBufferedReads, 16384},
    {"D2", "local store to main memory, 16 KiB, double-buffered", "GB/s", 22.13, 22.13,
     kRate, kIndependent, 5.0, kPercent, kTransfers, rows::DoubleBufferedWrites, 16384},
    {"D3", kPieces, "GB/s, 256 B", 22, 22, kRate, kIndependent, 5.0, kPercent, kTransfers,
     rows::EightInFlight, 256},
    {"D4", kPieces, "GB/s, 512 B", 22, 22, kRate, kDerived, 5.0, kPercent, kTransfers,
     rows::EightInFlight, 512, kRepeatsD3},
    {"D5", kPieces, "GB/s, 1 KiB", 22, 22, kRate, kDerived, 5.0, kPercent, kTransfers,
     rows::EightInFlight, 1024, kRepeatsD3},
    {"D6", kPieces, "GB/s, 2 KiB", 22, 22, kRate, kDerived, 5.0, kPercent, kTransfers,
     rows::EightInFlight, 2048, kRepeatsD3},
    {"D7", kPieces, "GB/s, 4 KiB", 22, 22, kRate, kDerived, 5.0, kPercent, kTransfers,
     rows::EightInFlight, 4096, kRepeatsD3},
    {"D8", kPieces, "GB/s, 8 KiB", 22, 22, kRate, kDerived, 5.0, kPercent, kTransfers,
     rows::EightInFlight, 8192, kRepeatsD3},
    {"D9", kPieces, "GB/s, 16 KiB", 22, 22, kRate, kDerived, 5.0, kPercent, kTransfers,
     rows::EightInFlight, 16384, kRepeatsD3},
    {"E1", "3 pairs of SPEs, neighbours on the ring, both ways", "GB/s", 114.73, 114.73,
     kRate, kIndependent, 5.0, kPercent, kTransfers, rows::PairsBothWays, 0, {}, kNothingShared},
    {"E2", "5 SPEs read the local store of the sixth", "GB/s", 23.72, 23.72,
     kRate, kIndependent, 5.0, kPercent, kTransfers, rows::OneStoreReadByAll},
    {"E8", "one SPE reads another, all 30 ordered pairs in turn", "GB/s", 23.42, 23.42,
     kRate, kIndependent, 5.0, kPercent, kTransfers, rows::OnePairAfterAnother},
    {"S1", "atomic line bounced between 2 SPEs", "ns a bounce", 150, 150,
     kWay, kPlausibility, 5.0, kPercent, kTransfers, rows::AtomicBounce, 0, kGuesses},
    {"S2", "mailbox PPE to SPE and back, through the system", "us a round trip", 11.6, 11.6,
     kWay, kParameter, 5.0, kPercent, kTransfers, rows::Mailbox, 0, kOwnNumber},

    {"J1a", kJobQueue, "us a job of 100", 107.53, 107.53, kRate, kDerived, 20.0, kPercent, kJobs,
     rows::JobsOnOneSpe, 100, kIntercept},
    {"J1b", kJobQueue, "us a job of 300", 320.62, 320.62, kRate, kDerived, 20.0, kPercent, kJobs,
     rows::JobsOnOneSpe, 300, kIntercept},
    {"J1c", kJobQueue, "us a job of 500", 533.64, 533.64, kRate, kDerived, 20.0, kPercent, kJobs,
     rows::JobsOnOneSpe, 500, kIntercept},
    {"J4", "the same, short jobs, mean over 2 to 6 SPEs", "us a job of 5", 19, 25,
     kRate, kParameter, 0.0, kPercent, kRange, rows::FloorOfShortJobs, 5, kOwnNumber},

    {"P1", "PPE, pointer chase in L1", "cycles", 6.4, 6.4,
     kRate, kParameter, 10.0, kPercent, kPpe, rows::PpeChase, 14 * 1024, kManualsUpperEnd},
    {"P2", "PPE, index chase in L1", "cycles", 12.5, 12.5,
     kRate, kIndependent, 10.0, kPercent, kPpe, rows::PpeIndexChase, 14 * 1024},
    {"P3", "PPE, pointer chase in L2, a quarter of it L1 hits", "cycles", 36, 36,
     kRate, kParameter, 10.0, kPercent, kPpe, rows::PpeChase, 128 * 1024, kOwnNumber},
    {"P4", "PPE, index chase in L2, 256 KiB", "cycles", 51, 51,
     kRate, kIndependent, 10.0, kPercent, kPpe, rows::PpeIndexChase, 256 * 1024},
    {"P5", "PPE, vector reads in L1, 28 KiB", "GB/s", 10.3, 10.3,
     kRate, kIndependent, 10.0, kPercent, kPpe, rows::PpeStream, 28 * 1024, {}, kLeavesL1},
    {"P6", "PPE, vector reads in L2, 400 KiB, dcbt 4 lines ahead", "GB/s", 8.4, 8.4,
     kRate, kIndependent, 10.0, kPercent, kPpe, rows::PpePrefetchedStream, 400 * 1024},
    {"P7", "PPE, VMX multiply-adds, 6 chains", "GFLOPS", 12.2, 12.2,
     kRate, kIndependent, 10.0, kPercent, kPpe, rows::PpeVectorFma},
    {"P8", "PPE, scalar multiply-adds, 8 chains", "GFLOPS", 4.93, 4.93,
     kRate, kIndependent, 10.0, kPercent, kPpe, rows::PpeScalarFma},
    {"P9", "PPE, integer adds, 8 chains", "Gop/s", 3.00, 3.00,
     kRate, kIndependent, 10.0, kPercent, kPpe, rows::PpeIntegerAdd},
    {"P10", "PPE, both threads: P8 and P8", "GFLOPS", 6.10, 6.10,
     kRate, kIndependent, 10.0, kPercent, kPpe, rows::PpeScalarFmaTwice},
    {"P11", "PPE, both threads: P8 beside P9", "GFLOPS of P8", 3.55, 3.55,
     kRate, kIndependent, 10.0, kPercent, kPpe, rows::PpeScalarFmaBesideAdds},
    {"P12", "PPE, both threads: P9 beside P8", "Gop/s of P9", 1.54, 1.54,
     kRate, kIndependent, 10.0, kPercent, kPpe, rows::PpeAddsBesideScalarFma},

    {"X1", "Xenon, lwsync", "cycles", 33, 48,
     kWay, kParameter, 0.0, kPercent, kRange, rows::XenonSynchronisation, 0, kOwnNumber},
    {"X2", "Xenon, InterlockedIncrement", "cycles", 225, 260,
     kWay, kParameter, 0.0, kPercent, kRange, rows::XenonSynchronisation, 1, kOwnNumber},
    {"X3", "Xenon, critical section", "cycles", 345, 345,
     kWay, kParameter, 0.0, kPercent, kRange, rows::XenonSynchronisation, 2, kOwnNumber},
    {"X4", "Xenon, mutex", "cycles", 2350, 2350,
     kWay, kParameter, 0.0, kPercent, kRange, rows::XenonSynchronisation, 3, kOwnNumber},
    {"X5", "Xenon, load-hit-store, up to", "cycles", 0, 40,
     kWay, kParameter, 0.0, kPercent, kRange, rows::XenonLoadHitStore, 0, kOwnNumber},
    {"X6", "Xenon, second hardware thread: points by a matrix", "% gained", 10, 20,
     kWay, kPlausibility, 0.0, kPercent, kRange, rows::XenonSecondThreadGain, 0, kOwnLoop},
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

std::string_view RowClassName(RowClass row_class) {
  constexpr std::string_view kNames[kRowClassCount] = {"independent", "derived", "plausibility",
                                                       "parameter"};
  return kNames[uint32_t(row_class)];
}

std::span<const RowDefinition> MeasuredRows() { return kMeasuredRows; }

const RowDefinition* FindRow(std::string_view id) {
  const auto row = std::ranges::find(kMeasuredRows, id, &RowDefinition::id);
  return row == std::end(kMeasuredRows) ? nullptr : row;
}

RowResult PredictRow(const RowDefinition& row, const PlatformParameters& platform) {
  RowResult result{.id = row.id,
                   .work = row.work,
                   .unit = row.unit,
                   .measured_least = row.measured_least,
                   .measured_most = row.measured_most,
                   .kind = row.kind,
                   .row_class = row.row_class,
                   .allowed = row.allowed,
                   .allowed_in = row.allowed_in,
                   .allowed_from = row.allowed_from,
                   .class_because = row.class_because,
                   .missed_because = row.missed_because,
                   .failure = {}};
  if (row.predict(platform, 1.0, row.argument, result.predicted_raw, result.failure) &&
      row.predict(platform, AvailabilityOf(row, platform), row.argument,
                  result.predicted_with_availability, result.failure))
    result.passes = IsWithin(result);
  return result;
}

std::vector<RowResult> PredictRows(const PlatformParameters& platform) {
  std::vector<RowResult> results;
  for (const RowDefinition& row : kMeasuredRows) results.push_back(PredictRow(row, platform));
  return results;
}

RowCount CountRows(std::span<const RowResult> rows, RowClass row_class) {
  RowCount count;
  for (const RowResult& row : rows)
    if (row.row_class == row_class) {
      ++count.rows;
      count.missed += !row.passes;
    }
  return count;
}

}  // namespace pelt
