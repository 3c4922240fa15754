// A number of a platform: its value, and how it is reported. The member of a platform's struct is the
// whole of it, so that a number cannot be used without being listed, or listed with another's
// source:
//
//   struct CellSystemNumbers {
//     Number<uint32_t> spu_count = {6, "SPEs a game can use", "SPEs", "cellmark"};
//     ...
//
// A number reads as its value and is assigned one, so that a test or a "what if" plants another.
//
// Invariant: a struct of numbers holds nothing else, or TellNumbers does not compile. To add a
// number is to add the member.
#pragma once

#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace pelt {

enum class Sureness : uint8_t {
  kPublished,   // P: by the vendor, or measured on hardware, and read at its source
  kSecondHand,  // S: a page that quotes a manual or a talk
  kLead,        // L: widely repeated, no source read
};

constexpr char SurenessLetter(Sureness sure) { return "PSL"[uint8_t(sure)]; }

template <class T>
struct Number {
  T value;
  std::string_view name, unit, source;
  Sureness sure = Sureness::kPublished;
  double scale = 1.0;  // from the value to what is reported: 0.001 for thousandths

  constexpr operator T() const { return value; }
  constexpr Number& operator=(T other) {
    value = other;
    return *this;
  }
  constexpr Number& operator*=(T factor) { return *this = value * factor; }
  constexpr Number& operator/=(T divisor) { return *this = value / divisor; }
};

// What one may call a number that a report prints.
struct PlatformNumber {
  std::string name;
  double value = 0.0;
  std::string_view unit;
  std::string_view source;
  Sureness sure = Sureness::kPublished;
};

template <class T>
PlatformNumber TellNumber(const Number<T>& number, std::string_view of = {}) {
  return {std::string(of) + std::string(number.name), double(number.value) * number.scale,
          number.unit, number.source, number.sure};
}

// Every member of a struct that holds numbers of 32 bits and nothing else, in order.
template <class Numbers>
void TellNumbers(const Numbers& numbers, std::vector<PlatformNumber>& out,
                 std::string_view of = {}) {
  static_assert(sizeof(Numbers) % sizeof(Number<uint32_t>) == 0);
  using Members = std::array<Number<uint32_t>, sizeof(Numbers) / sizeof(Number<uint32_t>)>;
  for (const Number<uint32_t>& number : std::bit_cast<Members>(numbers))
    out.push_back(TellNumber(number, of));
}

}  // namespace pelt
