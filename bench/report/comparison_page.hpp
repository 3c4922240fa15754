// Two runs side by side as one HTML page: their frames to one scale, and what `pelt compare` finds.
#pragma once

#include <string>

#include "bench/report/run_comparison.hpp"

namespace pelt {

// `found`: CompareRuns() of the two.
std::string ComparisonPage(const ComparedSide& a, const ComparedSide& b, const ReportTree& found);

}  // namespace pelt
