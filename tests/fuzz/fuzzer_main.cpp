// The door libFuzzer calls.
#include "tests/fuzz/fuzz_target.hpp"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  pelt::fuzz::ReadHostile(std::as_bytes(std::span(data, size)));
  return 0;
}
