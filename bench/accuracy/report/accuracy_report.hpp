// What `pelt accuracy` found, as text, as JSON, and as the work-precision diagram.
//
// The JSON is what `pelt report --accuracy` reads (accuracy_section.hpp): a member that goes there
// is part of a format, named by kAccuracyFormat.
#pragma once

#include <string>
#include <vector>

#include "bench/accuracy/solver_checks.hpp"
#include "bench/accuracy/work_precision.hpp"
#include "bench/report/machine.hpp"

namespace pelt {

inline constexpr std::string_view kAccuracyFormat = "pelt accuracy 1";

struct AccuracyReport {
  accuracy::WorkPrecision table;
  std::vector<accuracy::CantileverRow> cantilever;
  std::vector<accuracy::PendulumRow> pendulum;
  std::vector<accuracy::StabilityRow> stability;
  Machine machine;
  double seconds = 0.0;  // that all of it took
};

// A share as per cent, three digits or so; "-" for what is not finite.
std::string PercentText(double share);
std::string AccuracyText(const AccuracyReport& report);
std::string AccuracyJson(const AccuracyReport& report);
// An SVG file: error against ns a strand, both logarithmic; a column for each preset, a row for
// each kind of chain and frame rate, a curve for each method.
std::string WorkPrecisionSvg(const accuracy::WorkPrecision& table);

}  // namespace pelt
