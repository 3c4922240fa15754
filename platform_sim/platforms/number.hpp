// How a platform's number is told: name, value, unit, source and how sure it is.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace pelt {

enum class Sureness : uint8_t {
  kPublished,   // P: by the vendor, or measured on hardware, and read at its source
  kSecondHand,  // S: a page that quotes a manual or a talk
  kLead,        // L: widely repeated, no source read
};

constexpr char SurenessLetter(Sureness sure) { return "PSL"[uint8_t(sure)]; }

struct PlatformNumber {
  std::string name;
  double value = 0.0;
  std::string_view unit;
  std::string_view source;
  Sureness sure = Sureness::kPublished;
};

}  // namespace pelt
