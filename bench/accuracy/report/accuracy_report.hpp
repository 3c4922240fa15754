// What `pelt accuracy` found, as a report tree.
//
// The JSON is what `pelt report --accuracy` reads (accuracy_section.hpp): a member that goes there
// is part of a format, named by kAccuracyFormat.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/model_error.hpp"
#include "bench/accuracy/solver_checks.hpp"
#include "bench/accuracy/work_precision.hpp"
#include "bench/report/machine.hpp"

namespace pelt {

inline constexpr std::string_view kAccuracyFormat = "pelt accuracy 3";

struct AccuracyReport {
  accuracy::WorkPrecision table;
  accuracy::ModelErrorOptions model_options;
  accuracy::ModelErrorTable model_error;
  std::vector<accuracy::CantileverRow> cantilever;
  std::vector<accuracy::PendulumRow> pendulum;
  std::vector<accuracy::StabilityRow> stability;
  Machine machine;
  double seconds = 0.0;  // that all of it took
};

ReportTree MakeAccuracyTree(const AccuracyReport& report);

}  // namespace pelt
