// Whether the machine was a run's own: times taken while others used its cores are not what the
// work costs, and no count of threads shows it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "bench/report/report_tree.hpp"

namespace pelt {

struct MachineUse {
  uint32_t cores_allowed = 1;          // by the process's affinity mask
  std::optional<double> load_average;  // of the minute before the run
  uint64_t preemptions = 0;            // of all threads, in the run
  // Ready, and no core to run on: all threads together. Not every system counts it.
  std::optional<double> waited_ms;
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

// What makes the times of a run of so many threads doubtful, a sentence each; empty: nothing.
std::vector<std::string> FindDisturbances(const MachineUse& use, uint32_t workers);

// "machine_use".
void AddMachineUse(const MachineUse& use, uint32_t workers, ReportTree& tree);

}  // namespace pelt
