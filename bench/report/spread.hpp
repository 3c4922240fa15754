// What is reported of many values of one kind.
#pragma once

#include <span>

namespace pelt {

struct Spread {
  double median = 0.0, p95 = 0.0, worst = 0.0;
};
// Of values in any unit; 0 of none. Reorders them.
Spread SpreadOf(std::span<double> values);

}  // namespace pelt
