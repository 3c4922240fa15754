// There is no library for exceptions on wasm32: one that is thrown is said, and ends the program. The page starts
// another, and goes on with what it had.
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <typeinfo>

extern "C" {

void* __cxa_allocate_exception(size_t size) { return std::malloc(size); }

// All that Pelt and its libraries throw derive from std::exception first, so that it lies in front.
[[noreturn]] void __cxa_throw(void* thrown, std::type_info*, void (*)(void*)) {
  std::fprintf(stderr, "%s\n", static_cast<std::exception*>(thrown)->what());
  std::abort();
}
}
