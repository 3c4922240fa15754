// Control maps: PNG pictures a setup refers to.
#include "core/error.hpp"
#include "core/groom/fur_setup.hpp"
#include "tests/fuzz/fuzz_target.hpp"

namespace pelt::fuzz {

void ReadHostile(std::span<const std::byte> input) {
  try {
    ReadControlMap({reinterpret_cast<const uint8_t*>(input.data()), input.size()}, "fuzz.png");
  } catch (const Error&) {
  }
}

}  // namespace pelt::fuzz
