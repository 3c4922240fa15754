// Fixes how floats round while a kernel runs, or anything else that ends up in the bits of a frame
// or a groom: every function of a public header that computes has one at its head. Engines set
// flush-to-zero on their workers; a worker with it and one without would give different bits.
// Restores the caller's settings on the way out.
//
// A compiler knows nothing of what arithmetic takes from here. What is read from memory after it and
// written to memory before its end stays between; a result that goes from register to register is to
// be computed out of line (core/modal/modal_material.cpp).
#pragma once

#include <cfenv>
#include <cstdint>

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace pelt {

class FloatEnvironment {
 public:
#if defined(__SSE__)
  FloatEnvironment() : saved_(_mm_getcsr()) {
    if ((saved_ & kControl) != kDefault) _mm_setcsr(kDefault);
    asm volatile("" : : : "memory");
  }
  ~FloatEnvironment() {
    asm volatile("" : : : "memory");
    _mm_setcsr(saved_);
  }

 private:
  static constexpr uint32_t kControl = 0xffc0u;  // everything but the sticky exception flags
  static constexpr uint32_t kDefault =
      0x1f80u;  // round to nearest, all exceptions masked, no FTZ, no DAZ
  uint32_t saved_;
#elif defined(__aarch64__)
  FloatEnvironment() {
    asm volatile("mrs %0, fpcr" : "=r"(saved_));
    asm volatile("msr fpcr, %0" : : "r"(uint64_t{0}) : "memory");
  }
  ~FloatEnvironment() { asm volatile("msr fpcr, %0" : : "r"(saved_) : "memory"); }

 private:
  uint64_t saved_;
#elif defined(__powerpc__)
  // All bits 0: round to nearest, no traps, denormals kept ("Java mode" in AltiVec's words; Linux
  // starts every thread with its vectors in the other one).
  FloatEnvironment() {
    asm volatile("mffs %0" : "=f"(saved_));
    asm volatile("mtfsf 255, %0" : : "f"(0.0) : "memory");
#if defined(__ALTIVEC__)
    asm volatile("mfvscr %0" : "=v"(saved_vectors_));
    asm volatile("mtvscr %0" : : "v"(Words{0, 0, 0, 0}));
#endif
  }
  ~FloatEnvironment() {
    asm volatile("mtfsf 255, %0" : : "f"(saved_) : "memory");
#if defined(__ALTIVEC__)
    asm volatile("mtvscr %0" : : "v"(saved_vectors_));
#endif
  }

 private:
  double saved_;
#if defined(__ALTIVEC__)
  typedef uint32_t Words __attribute__((vector_size(16)));
  Words saved_vectors_;
#endif
#else
  FloatEnvironment() {
    std::fegetenv(&saved_);
    std::fesetenv(FE_DFL_ENV);  // rounding, and on 32-bit ARM denormals
  }
  ~FloatEnvironment() { std::fesetenv(&saved_); }

 private:
  std::fenv_t saved_;
#endif

 public:
  FloatEnvironment(const FloatEnvironment&) = delete;
  FloatEnvironment& operator=(const FloatEnvironment&) = delete;
};

}  // namespace pelt
