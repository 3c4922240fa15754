// The suite of exact motions, solved once for all tests of the program.
#pragma once

#include "bench/accuracy/error_metric.hpp"

namespace pelt::accuracy {

inline const Suite& SharedSuite() {
  static const Suite suite = SolveSuite({});
  return suite;
}

}  // namespace pelt::accuracy
