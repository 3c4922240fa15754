#include "platform_sim/rows/predictions.hpp"
#include "platform_sim/rows/row_work.hpp"

namespace pelt::rows {

// ---- DMA and bus --------------------------------------------------------------------------------

namespace {

// What was measured ran for seconds: a rate is what the second half of a short stream adds to the
// first, so that filling and draining count for nothing.
constexpr uint32_t kLocalStoreBlocks = 4;

double SteadyGbPerSecond(const SpuRun& half, const SpuRun& whole, const CellSystem& cell) {
  return double(whole.Bytes() - half.Bytes()) / double(whole.cycles - half.cycles) *
         cell.GigaHertz();
}

bool StreamRate(const CellParameters& cell, StreamOfBlocks stream, double availability,
                double& predicted, std::string& error) {
  const auto half = RunStream(cell, stream, error);
  stream.bytes_each *= 2;
  const auto whole = half ? RunStream(cell, stream, error) : std::nullopt;
  if (whole) predicted = SteadyGbPerSecond(*half, *whole, cell) * availability;
  return whole.has_value();
}

bool LocalStoreRate(const CellMemoryParameters& cell, const std::vector<int>& reads, double& sum,
                    std::string& error) {
  const auto half = RunLocalStoreReads(cell, reads, kLocalStoreBlocks, error);
  const auto whole =
      half ? RunLocalStoreReads(cell, reads, 2 * kLocalStoreBlocks, error) : std::nullopt;
  if (whole) sum += SteadyGbPerSecond(*half, *whole, cell);
  return whole.has_value();
}

}  // namespace

bool DoubleBufferedReads(const PlatformParameters& p, double availability, uint32_t block_bytes,
                         double& predicted, std::string& error) {
  return StreamRate(p.cell, {.block_bytes = block_bytes, .in_flight = 2}, availability, predicted,
                    error);
}

bool EightInFlight(const PlatformParameters& p, double availability, uint32_t block_bytes,
                   double& predicted, std::string& error) {
  return StreamRate(p.cell, {.block_bytes = block_bytes, .in_flight = 8}, availability, predicted,
                    error);
}

bool DoubleBufferedWrites(const PlatformParameters& p, double availability, uint32_t block_bytes,
                          double& predicted, std::string& error) {
  return StreamRate(p.cell, {.block_bytes = block_bytes, .in_flight = 2, .get = false, .put = true},
                    availability, predicted, error);
}

// The pairs are neighbours in the ring's order: 0 and 1, 2 and 3, 4 and 5 (cellmark).
bool PairsBothWays(const PlatformParameters& p, double availability, uint32_t, double& predicted,
                   std::string& error) {
  double rate = 0.0;
  if (!LocalStoreRate(p.cell, {1, 0, 3, 2, 5, 4}, rate, error)) return false;
  predicted = rate * availability;
  return true;
}

bool OneStoreReadByAll(const PlatformParameters& p, double availability, uint32_t,
                       double& predicted, std::string& error) {
  double rate = 0.0;
  if (!LocalStoreRate(p.cell, {-1, 0, 0, 0, 0, 0}, rate, error)) return false;
  predicted = rate * availability;
  return true;
}

bool OnePairAfterAnother(const PlatformParameters& p, double availability, uint32_t,
                         double& predicted, std::string& error) {
  constexpr int kSpus = 6;
  double sum = 0.0;
  for (int reader = 0; reader < kSpus; ++reader)
    for (int far = 0; far < kSpus; ++far) {
      if (reader == far) continue;
      std::vector<int> reads(kSpus, -1);
      reads[size_t(reader)] = far;
      if (!LocalStoreRate(p.cell, reads, sum, error)) return false;
    }
  predicted = sum / (kSpus * (kSpus - 1)) * availability;
  return true;
}

bool AtomicBounce(const PlatformParameters& p, double availability, uint32_t, double& predicted,
                  std::string&) {
  predicted = p.cell.Nanoseconds(double(AtomicBounceCycles(p.cell))) / availability;
  return true;
}

bool Mailbox(const PlatformParameters& p, double availability, uint32_t, double& predicted,
             std::string&) {
  predicted = p.cell.Nanoseconds(double(MailboxRoundTripCycles(p.cell))) / 1000.0 / availability;
  return true;
}

// ---- Jobs ---------------------------------------------------------------------------------------
//
// A job's nominal time is work at the model's rate: availability stretches it. What dispatching
// costs was measured as it is.

namespace {

bool MicrosecondsPerJob(const DispatchParameters& jobs, uint32_t spes, double job_us,
                        double& predicted, std::string& error) {
  constexpr uint64_t kJobs = 5000;
  JobRun run;
  if (!RunJobs(jobs, spes, kJobs, job_us * 1000.0, run, error)) return false;
  predicted = run.MicrosecondsPerJob(kJobs);
  return true;
}

}  // namespace

bool JobsOnOneSpe(const PlatformParameters& p, double availability, uint32_t job_us,
                  double& predicted, std::string& error) {
  return MicrosecondsPerJob(p.cell.jobs, 1, job_us / availability, predicted, error);
}

// The mean over 2 to 6 SPEs, for a job of any length.
bool FloorOfShortJobs(const PlatformParameters& p, double availability, uint32_t job_us,
                      double& predicted, std::string& error) {
  double sum = 0.0;
  for (uint32_t spes = 2; spes <= 6; ++spes) {
    if (!MicrosecondsPerJob(p.cell.jobs, spes, job_us / availability, predicted, error))
      return false;
    sum += predicted;
  }
  predicted = sum / 5;
  return true;
}

}  // namespace pelt::rows
