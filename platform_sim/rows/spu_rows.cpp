#include <algorithm>
#include <iterator>

#include "platform_sim/rows/predictions.hpp"
#include "platform_sim/rows/row_work.hpp"

namespace pelt::rows {
namespace {

bool Iteration(const std::string& text, const CellParameters& cell, double& cycles,
               std::string& error) {
  const auto chart = TimeSpuListing(text, {}, cell.spu, error);
  const auto iteration = chart ? CyclesPerIteration(*chart, error) : std::nullopt;
  if (iteration) cycles = *iteration;
  return iteration.has_value();
}

bool Rate(const std::string& text, double operations_per_iteration, const CellParameters& cell,
          double availability, double& giga, std::string& error) {
  double cycles = 1.0;
  if (!CheckCellSystem(cell, error) || !Iteration(text, cell, cycles, error)) return false;
  giga = operations_per_iteration / cycles * cell.GigaHertz() * cell.spu_count * availability;
  return true;
}

std::optional<IssueChart> TimePublished(const CellParameters& cell, std::string& error) {
  // The tool that printed it pairs by order.
  return TimeSpuListing(PublishedListing(), {.pair_by_order = true}, cell.spu, error);
}

// As printed, from the first.
constexpr int64_t kPrintedCycles[] = {47, 47, 48, 48, 49, 54, 60, 61, 62,
                                      62, 63, 67, 71, 75, 81, 87, 88, 88};

}  // namespace

bool SinglePrecisionRate(const PlatformParameters& p, double availability, uint32_t,
                         double& predicted, std::string& error) {
  return Rate(SinglePrecisionFma(), 3072, p.cell, availability, predicted, error);
}
// A multiply and an add of a lane are two.
bool IntegerRate(const PlatformParameters& p, double availability, uint32_t, double& predicted,
                 std::string& error) {
  return Rate(IntegerMultiplyAdd(), 32 * 7 * 4 * 2, p.cell, availability, predicted, error);
}
// Nine a round, of four words each; six multiply-adds of two operations and six others.
bool ShuffleRate(const PlatformParameters& p, double availability, uint32_t, double& predicted,
                 std::string& error) {
  return Rate(Shuffles(), 64 * 9 * 4, p.cell, availability, predicted, error);
}
bool DualIssueRate(const PlatformParameters& p, double availability, uint32_t, double& predicted,
                   std::string& error) {
  return Rate(FmaBesideShuffles(), 64 * 6 * (4 * 2 + 4), p.cell, availability, predicted, error);
}
bool EvenNopNewtonRate(const PlatformParameters& p, double availability, uint32_t,
                       double& predicted, std::string& error) {
  return Rate(NewtonStepsWithEvenNops(), 2112, p.cell, availability, predicted, error);
}
bool NewtonRate(const PlatformParameters& p, double availability, uint32_t, double& predicted,
                std::string& error) {
  return Rate(NewtonSteps(), 2112, p.cell, availability, predicted, error);
}
bool DoublePrecisionRate(const PlatformParameters& p, double availability, uint32_t,
                         double& predicted, std::string& error) {
  return Rate(DoublePrecisionFma(), 832, p.cell, availability, predicted, error);
}

bool BranchIteration(const PlatformParameters& p, double availability, uint32_t, double& predicted,
                     std::string& error) {
  if (!Iteration(UnhintedBranch(), p.cell, predicted, error)) return false;
  predicted /= availability;
  return true;
}

bool HintedBranchIteration(const PlatformParameters& p, double availability, uint32_t,
                           double& predicted, std::string& error) {
  if (!Iteration(HintedBranch(), p.cell, predicted, error)) return false;
  predicted /= availability;
  return true;
}

// Of one SPE's peak, a multiply-add of four lanes a cycle: measured on a blade, so a share.
bool MatrixPeakShare(const PlatformParameters& p, double availability, uint32_t, double& predicted,
                     std::string& error) {
  double cycles = 1.0;
  if (!Iteration(MatrixMultiply(), p.cell, cycles, error)) return false;
  predicted = 100.0 * kMatrixMultiplyFmas / cycles * availability;
  return true;
}

bool PublishedIteration(const PlatformParameters& p, double availability, uint32_t,
                        double& predicted, std::string& error) {
  const auto chart = TimePublished(p.cell, error);
  if (!chart) return false;
  predicted = double(chart->first_pass_totals.cycles) / availability;
  return true;
}

bool PublishedIssueTimes(const PlatformParameters& p, double, uint32_t, double& predicted,
                         std::string& error) {
  const auto chart = TimePublished(p.cell, error);
  if (!chart) return false;
  predicted = 0.0;
  const size_t count = std::min(chart->first_pass.size(), std::size(kPrintedCycles));
  for (size_t i = 0; i < count; ++i)
    predicted += chart->first_pass[i].cycle == kPrintedCycles[i] - kPrintedCycles[0];
  return true;
}

}  // namespace pelt::rows
