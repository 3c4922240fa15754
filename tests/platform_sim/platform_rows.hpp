// How far a prediction is off what was measured.
#pragma once

namespace pelt::testing {

inline double PercentOff(double predicted, double measured) {
  return (predicted / measured - 1.0) * 100.0;
}

}  // namespace pelt::testing
