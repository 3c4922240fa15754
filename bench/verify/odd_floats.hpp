// The worst that a thread may bring along: it rounds upwards, flushes denormal results to zero and
// takes denormal operands for zero. Threads started meanwhile inherit it. Put back on the way out.
#pragma once

#include <cfenv>
#include <cstdint>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace pelt {

class OddFloats {
 public:
  explicit OddFloats(bool on = true) : on_(on) {
    if (!on_) return;
    std::fegetenv(&saved_);
    std::fesetround(FE_UPWARD);
#if defined(__SSE__)
    _mm_setcsr(_mm_getcsr() | 0x8040u);
#elif defined(__aarch64__)
    uint64_t control;
    asm volatile("mrs %0, fpcr" : "=r"(control));
    asm volatile("msr fpcr, %0" : : "r"(control | (uint64_t{1} << 24)));
#endif
  }
  ~OddFloats() {
    if (on_) std::fesetenv(&saved_);
  }
  OddFloats(const OddFloats&) = delete;
  OddFloats& operator=(const OddFloats&) = delete;

 private:
  bool on_;
  std::fenv_t saved_;
};

}  // namespace pelt
