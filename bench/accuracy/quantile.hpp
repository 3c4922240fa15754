// The value below which a share of a sample lies, between two of them on the line through them.
#pragma once

#include <algorithm>
#include <vector>

namespace pelt::accuracy {

// share 0.5: the median. 0 of nothing.
inline double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  std::sort(values.begin(), values.end());
  const double at = share * double(values.size() - 1);
  const size_t below = size_t(at), above = std::min(below + 1, values.size() - 1);
  return values[below] + (at - double(below)) * (values[above] - values[below]);
}

}  // namespace pelt::accuracy
