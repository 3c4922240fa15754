// Whether the machine was a run's own: times taken while others used its cores are not what the
// work costs, and no count of threads shows it.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "bench/report/report_tree.hpp"

namespace pelt {

// Whether a time is within a target, and what the answers for several platforms come to.

// A later value outweighs an earlier one: kDoesNotFit stays so, even if other answers are unsure.
enum class Fit : uint8_t { kFits, kUnsure, kDoesNotFit };

constexpr std::string_view FitName(Fit fit) {
  constexpr std::string_view kNames[] = {"FITS", "UNSURE", "DOES NOT FIT"};
  return kNames[size_t(fit)];
}

// `disturbed`: others used the machine, so the time is not that of the work alone.
constexpr Fit JudgeTime(double ms, double target_ms, bool disturbed) {
  if (disturbed) return Fit::kUnsure;
  return ms <= target_ms ? Fit::kFits : Fit::kDoesNotFit;
}

// Of one at least.
constexpr Fit JudgeAll(std::span<const Fit> fits) {
  return *std::max_element(fits.begin(), fits.end());
}

// What others took from the process, all of its threads together.
struct CoreWait {
  uint64_t preemptions = 0;
  std::optional<double> waited_ms;  // ready, and no core to run on; not every system counts it

  CoreWait Since(const CoreWait& before) const;
};
// From the process's begin on.
CoreWait ReadCoreWait();
// Whether what so many threads did in that time was slower by it.
bool IsDisturbed(const CoreWait& wait, double wall_ms, uint32_t threads);

struct MachineUse {
  CoreWait wait;                       // in the run
  uint32_t cores_allowed = 1;          // by the process's affinity mask
  std::optional<double> load_average;  // of the minute before the run
  double wall_ms = 0.0;
};

// From its making on.
class MachineUseWatch {
 public:
  MachineUseWatch();
  MachineUse Finish() const;

 private:
  MachineUse begin_;
  uint64_t begin_ns_;
};

// Of so many workers those that can run at once.
uint32_t Threads(const MachineUse& use, uint32_t workers);
// What makes the times of a run of so many threads doubtful, a sentence each; empty: nothing.
std::vector<std::string> FindDisturbances(const MachineUse& use, uint32_t workers);

// "machine_use".
void AddMachineUse(const MachineUse& use, uint32_t workers, ReportTree& tree);

}  // namespace pelt
