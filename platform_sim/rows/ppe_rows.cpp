// The PPE's rows are run with its other hardware thread present, whose dispatch cycles are its own
// (consoles.md, section 3): what a console under an operating system measures.
#include "platform_sim/rows/predictions.hpp"
#include "platform_sim/rows/row_work.hpp"

namespace pelt::rows {

bool PpeChase(const PlatformParameters& p, double availability, uint32_t bytes, double& predicted,
              std::string& error) {
  const auto lines = LinesInRandomCycle(bytes / p.cell.line_bytes);
  const auto turn = PpeCyclesPerTurn(p.cell, PointerChase(), lines, error);
  if (turn) predicted = *turn / availability;
  return turn.has_value();
}

bool PpeStream(const PlatformParameters& p, double availability, uint32_t bytes, double& predicted,
               std::string& error) {
  constexpr uint32_t kBytesATurn = 128;
  const auto lines = LinesInOrder(bytes / p.cell.line_bytes);
  const auto turn = PpeCyclesPerTurn(p.cell, VectorStream(), lines, error);
  if (turn) predicted = kBytesATurn / *turn * p.cell.GigaHertz() * availability;
  return turn.has_value();
}

bool PpeVectorFma(const PlatformParameters& p, double availability, uint32_t, double& predicted,
                  std::string& error) {
  const auto chart = TimePpeListing(VectorFmaChains(), {.smt = true}, p.cell.ppe, error);
  const auto turn = chart ? CyclesPerTurn(*chart, error) : std::nullopt;
  if (turn) predicted = 16 * 6 * 8 / *turn * p.cell.GigaHertz() * availability;
  return turn.has_value();
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

// Two threads that do the same: twice the turns in the time of one that shares its core.
bool XenonSecondThreadGain(const PlatformParameters& p, double, uint32_t, double& predicted,
                           std::string& error) {
  double turn[2] = {1.0, 1.0};
  for (const bool smt : {false, true}) {
    const auto chart = TimePpeListing(MixedVectorKernel(), {.smt = smt}, p.xenon.core, error);
    const auto cycles = chart ? CyclesPerTurn(*chart, error) : std::nullopt;
    if (!cycles) return false;
    turn[smt] = *cycles;
  }
  predicted = 100.0 * (2.0 * turn[false] / turn[true] - 1.0);
  return true;
}

}  // namespace pelt::rows
