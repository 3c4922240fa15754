// The cheapest clock that runs evenly on all cores: what profiles are taken with. Reading the
// system's clock round every stage of every chunk would cost several per cent of a frame.
#pragma once

#include <chrono>
#include <cstdint>

#if defined(__x86_64__)
#include <x86intrin.h>
#endif

namespace pelt {

// Ticks of an unknown, even length; never 0. On x86-64 this takes the time-stamp counter to be
// invariant, as on every processor of the last fifteen years.
inline uint64_t ReadTicks() {
#if defined(__x86_64__)
  return __rdtsc();
#elif defined(__aarch64__)
  uint64_t ticks;
  asm volatile("mrs %0, cntvct_el0" : "=r"(ticks));
  return ticks;
#else
  return uint64_t(std::chrono::steady_clock::now().time_since_epoch().count());
#endif
}

// Nanoseconds in a tick, from two readings of both clocks as far apart as the caller lets them be.
class TickScale {
 public:
  double NsPerTick() const {
    const uint64_t ticks = ReadTicks() - ticks_;
    const std::chrono::duration<double, std::nano> ns = std::chrono::steady_clock::now() - time_;
    return ticks ? ns.count() / double(ticks) : 1.0;
  }

 private:
  std::chrono::steady_clock::time_point time_ = std::chrono::steady_clock::now();
  uint64_t ticks_ = ReadTicks();
};

}  // namespace pelt
