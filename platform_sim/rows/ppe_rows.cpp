// The PPE's rows: one thread alone on its core, and two with a mix each.
//
// cellmark's chases are through 4-byte pointers and indices (its compiler loads them with lwz): its
// 32768 pointers are 128 KiB, in which a quarter of the loads still hits L1. Its counters say the
// same: 390,000 misses of 524,288 loads. Its first chases, by index, were through 14 and 256 KiB.
#include <algorithm>
#include <array>

#include "platform_sim/rows/predictions.hpp"
#include "platform_sim/rows/row_work.hpp"

namespace pelt::rows {
namespace {

constexpr uint32_t kElementBytes = 4, kVectorBytes = 16;

bool Chase(const CellParameters& cell, const std::string& listing, uint32_t chases_per_iteration,
           uint32_t bytes, double availability, double& predicted, std::string& error) {
  const PpeWalk walk = WalkAtRandom(bytes / kElementBytes, cell.line_bytes / kElementBytes);
  const auto iteration = PpeCyclesPerIteration(cell, listing, walk, error);
  if (iteration) predicted = *iteration / chases_per_iteration / availability;
  return iteration.has_value();
}

bool Stream(const CellParameters& cell, const std::string& listing, uint32_t bytes,
            uint32_t lines_ahead, double availability, double& predicted, std::string& error) {
  const PpeWalk walk =
      WalkInOrder(bytes / cell.line_bytes, cell.line_bytes / kVectorBytes, lines_ahead);
  const auto iteration = PpeCyclesPerIteration(cell, listing, walk, error);
  if (iteration) predicted = cell.line_bytes / *iteration * cell.GigaHertz() * availability;
  return iteration.has_value();
}

// Of a loop alone on its core that hits L1 throughout.
std::optional<double> CyclesAlone(const PlatformParameters& p, const std::string& listing,
                                  std::string& error) {
  const auto chart = TimePpeListing(listing, {}, p.cell.ppe, error);
  return chart ? CyclesPerIteration(*chart, error) : std::nullopt;
}

bool Rate(const PlatformParameters& p, const std::string& listing, double operations_per_iteration,
          double availability, double& predicted, std::string& error) {
  const auto iteration = CyclesAlone(p, listing, error);
  if (iteration)
    predicted = operations_per_iteration / *iteration * p.cell.GigaHertz() * availability;
  return iteration.has_value();
}

// cellmark's pair: the first thread has 2 Mi iterations, the second 1.25 Mi; who is done first
// leaves the core to the other. A thread's rate is its work over its own time.
constexpr std::array<double, 2> kPairIterations = {2.0 * 1024 * 1024, 1.25 * 1024 * 1024};

bool BesideEachOther(const PlatformParameters& p, uint32_t thread, double operations_per_iteration,
                     double availability, double& predicted, std::string& error) {
  const std::array<std::string, 2> listings = {ScalarFmaChains(), IntegerAddChains()};
  const auto both = TimePpePair(listings[0], listings[1], p.cell.ppe, error);
  if (!both) return false;
  const uint32_t other = 1 - thread;
  const double own_cycles = both->CyclesPerIteration(thread);
  const double shared_cycles = kPairIterations[other] * both->CyclesPerIteration(other);
  double cycles = kPairIterations[thread] * own_cycles;
  if (shared_cycles < cycles) {
    const auto alone = CyclesAlone(p, listings[thread], error);
    if (!alone) return false;
    cycles = shared_cycles + (kPairIterations[thread] - shared_cycles / own_cycles) * *alone;
  }
  predicted = kPairIterations[thread] * operations_per_iteration / cycles * p.cell.GigaHertz() *
              availability;
  return true;
}

}  // namespace

bool PpeChase(const PlatformParameters& p, double availability, uint32_t bytes, double& predicted,
              std::string& error) {
  return Chase(p.cell, PointerChase(), kChasesPerIteration, bytes, availability, predicted, error);
}

bool PpeIndexChase(const PlatformParameters& p, double availability, uint32_t bytes,
                   double& predicted, std::string& error) {
  return Chase(p.cell, IndexChase(), 1, bytes, availability, predicted, error);
}

bool PpeStream(const PlatformParameters& p, double availability, uint32_t bytes, double& predicted,
               std::string& error) {
  return Stream(p.cell, VectorStream(), bytes, 0, availability, predicted, error);
}

bool PpePrefetchedStream(const PlatformParameters& p, double availability, uint32_t bytes,
                         double& predicted, std::string& error) {
  return Stream(p.cell, PrefetchedVectorStream(), bytes, kLinesAhead, availability, predicted,
                error);
}

bool PpeVectorFma(const PlatformParameters& p, double availability, uint32_t, double& predicted,
                  std::string& error) {
  return Rate(p, VectorFmaChains(), 8 * 6 * 8, availability, predicted, error);
}

bool PpeScalarFma(const PlatformParameters& p, double availability, uint32_t, double& predicted,
                  std::string& error) {
  return Rate(p, ScalarFmaChains(), 2 * kEightChains, availability, predicted, error);
}

bool PpeIntegerAdd(const PlatformParameters& p, double availability, uint32_t, double& predicted,
                   std::string& error) {
  return Rate(p, IntegerAddChains(), kEightChains, availability, predicted, error);
}

bool PpeScalarFmaTwice(const PlatformParameters& p, double availability, uint32_t,
                       double& predicted, std::string& error) {
  const auto both = TimePpePair(ScalarFmaChains(), ScalarFmaChains(), p.cell.ppe, error);
  if (!both) return false;
  const double iterations = 1.0 / both->CyclesPerIteration(0) + 1.0 / both->CyclesPerIteration(1);
  predicted = 2 * kEightChains * iterations * p.cell.GigaHertz() * availability;
  return true;
}

bool PpeScalarFmaBesideAdds(const PlatformParameters& p, double availability, uint32_t,
                            double& predicted, std::string& error) {
  return BesideEachOther(p, 0, 2 * kEightChains, availability, predicted, error);
}

bool PpeAddsBesideScalarFma(const PlatformParameters& p, double availability, uint32_t,
                            double& predicted, std::string& error) {
  return BesideEachOther(p, 1, kEightChains, availability, predicted, error);
}

bool XenonLoadHitStore(const PlatformParameters& p, double availability, uint32_t,
                       double& predicted, std::string& error) {
  const auto chart = TimePpeListing(LoadHitStore(), {}, p.xenon.core, error);
  if (chart) predicted = double(chart->first_pass.back().cycle) / availability;
  return chart.has_value();
}

bool XenonSynchronisation(const PlatformParameters&, double availability, uint32_t which,
                          double& predicted, std::string&) {
  predicted = kXenonSynchronisation[which].Middle() / availability;
  return true;
}

// Two threads that do the same: twice the iterations in the time of one that shares its core.
bool XenonSecondThreadGain(const PlatformParameters& p, double, uint32_t, double& predicted,
                           std::string& error) {
  const std::string listing = MixedVectorKernel();
  const auto chart = TimePpeListing(listing, {}, p.xenon.core, error);
  const auto alone = chart ? CyclesPerIteration(*chart, error) : std::nullopt;
  const auto both = alone ? TimePpePair(listing, listing, p.xenon.core, error) : std::nullopt;
  if (!both) return false;
  const double gain = *alone / both->CyclesPerIteration(0) + *alone / both->CyclesPerIteration(1);
  predicted = 100.0 * (gain - 1.0);
  return true;
}

}  // namespace pelt::rows
