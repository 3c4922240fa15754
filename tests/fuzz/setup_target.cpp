// Fur setups. Maps are looked for in a folder that is not there: only the text is fuzzed.
#include "core/error.hpp"
#include "core/groom/fur_setup.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace pelt::fuzz {

void ReadHostile(std::span<const std::byte> input) {
  try {
    ReadFurSetup({reinterpret_cast<const char*>(input.data()), input.size()}, "fuzz.toml",
                 "/nonexistent/pelt-fuzz");
  } catch (const Error&) {
  }
}

}  // namespace pelt::fuzz
