// Which mutation is on: forced into every file of the mutated copy (run.py), not part of any build.
//
// PELT_MUTATION holds its number, read once before main. PELT_MUTATION_REACHED names a file to
// which a process that came past a site of it adds a byte at its end: a mutant that never ran is
// another finding than one that ran and was not caught.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <thread>

namespace pelt_mutation {

struct State {
  unsigned active;
  std::atomic<bool> reached{false};

  State() {
    const char* text = std::getenv("PELT_MUTATION");
    active = text ? unsigned(std::atoi(text)) : 0u;
  }
  ~State() {
    const char* path = std::getenv("PELT_MUTATION_REACHED");
    if (!path || !reached.load(std::memory_order_relaxed)) return;
    if (std::FILE* file = std::fopen(path, "a")) {
      std::fputc('1', file);
      std::fclose(file);
    }
  }
};
inline State state;

inline const std::thread::id first_thread = std::this_thread::get_id();

// Not inline: a kernel's operations are to stay as they are where no mutant is on.
__attribute__((noinline, cold)) inline bool Reach() {
  state.reached.store(true, std::memory_order_relaxed);
  return true;
}

}  // namespace pelt_mutation

__attribute__((always_inline)) inline constexpr bool PeltMutated(unsigned number) {
  if (__builtin_is_constant_evaluated()) return false;
  return __builtin_expect(pelt_mutation::state.active == number, 0) && pelt_mutation::Reach();
}
