// The loop of executors that run pass after pass, and a clock.
#pragma once

#include <chrono>
#include <cstdint>

#include "jobs/frame.hpp"

namespace pelt {

using TimePoint = std::chrono::steady_clock::time_point;
inline TimePoint Now() { return std::chrono::steady_clock::now(); }
inline uint64_t ElapsedNs(TimePoint from) {
  return uint64_t(std::chrono::duration_cast<std::chrono::nanoseconds>(Now() - from).count());
}

// Calls run(pass, item count) for each pass; it returns when every item of the pass is done.
template <class RunPass>
void ForEachPass(const Frame& frame, RunPass run) {
  const Plan& plan = *frame.plan;
  for (uint32_t p = 0; p < plan.passes.size(); ++p)
    run(p, frame.memory->shape->ItemCount(plan.passes[p].domain));
}

}  // namespace pelt
