// What a figure was measured on and made with: printed beside every figure.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "bench/report/report_tree.hpp"

namespace pelt {

struct Machine {
  std::string processor;  // the model's name as the system gives it
  uint32_t cores;         // hardware threads this process may use
  std::string compiler;
  std::string build_type;
  std::string commit;  // of the source tree when it was configured; "-dirty" with changes in it
};

Machine DescribeMachine();

std::string_view PeltVersion();  // "0.1.0"

// "processor", "cores", "compiler", "build_type", "commit".
void AddMachine(const Machine& machine, ReportTree& tree);

// Whether standard error is a terminal: where progress is shown.
bool IsTerminal();

}  // namespace pelt
