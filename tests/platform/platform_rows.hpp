// How a measured row is held against the model: printed, and no further off than allowed.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

namespace pelt::testing {

inline double PercentOff(double predicted, double measured) {
  return (predicted / measured - 1.0) * 100.0;
}

inline void ExpectRow(const char* row, double predicted, double measured, const char* unit,
                      double allowed_percent) {
  const double off = PercentOff(predicted, measured);
  std::printf("row %-4s predicted %9.3f  measured %9.3f %-5s  %+6.2f %%\n", row, predicted,
              measured, unit, off);
  EXPECT_LE(std::abs(off), allowed_percent) << row;
}

}  // namespace pelt::testing
