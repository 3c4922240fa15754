// In builds without bench/accuracy.
#include "bench/fit/layer_errors.hpp"
#include "core/error.hpp"

namespace pelt {

void RequireAccuracy() {
  throw Error("this pelt was built without bench/accuracy: -DPELT_ACCURACY=ON");
}

std::vector<std::vector<TipError>> MeasureTipErrors(const Scenario&, std::span<Scenario>,
                                                    const ErrorFrames&) {
  RequireAccuracy();
  return {};
}

}  // namespace pelt
