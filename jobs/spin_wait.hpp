// Waiting for something that another thread is about to do: a few polls at full speed, then giving
// the core away between polls. Never blocks for good by itself; the caller asks again.
#pragma once

#include <cstdint>
#if !defined(__wasi__)  // WebAssembly without threads: nothing else could do it
#include <thread>
#endif

namespace pelt {

// Tells the core that this is a loop that waits.
inline void PauseCore() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#elif defined(__aarch64__)
  asm volatile("yield");
#endif
}

class SpinWait {
 public:
  void Once() {
    if (spins_ < kSpins) {
      ++spins_;
      PauseCore();
    } else {
#if !defined(__wasi__)
      std::this_thread::yield();
#endif
    }
  }
  void Reset() { spins_ = 0; }
  // After a poll that found something, or nothing.
  void After(bool found) {
    if (found) {
      Reset();
    } else {
      Once();
    }
  }

 private:
  static constexpr uint32_t kSpins = 64;
  uint32_t spins_ = 0;
};

}  // namespace pelt
