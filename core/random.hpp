// Seeded random numbers that are the same on every machine (the standard library's distributions
// are not).
//
// SplitMix64 (Steele, Lea, Flood 2014): a counter passed through a mixing function. Any seed is
// good, 0 included. For numbers that must not depend on the order of drawing, hash what they belong
// to: Random(MixSeed(layer_seed, strand)).
#pragma once

#include <cstdint>

namespace pelt {

// A bijection of 64 bits in which every input bit reaches every output bit.
inline constexpr uint64_t MixBits(uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ull;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebull;
  return z ^ (z >> 31);
}

// A new seed from a seed and what it is for; order matters.
inline constexpr uint64_t MixSeed(uint64_t seed, uint64_t purpose) {
  return MixBits(MixBits(seed + 0x9e3779b97f4a7c15ull) + 0x9e3779b97f4a7c15ull * (purpose + 1));
}

struct Random {
  uint64_t state;

  explicit constexpr Random(uint64_t seed) : state(seed) {}

  constexpr uint64_t U64() {
    state += 0x9e3779b97f4a7c15ull;
    return MixBits(state);
  }
  constexpr uint32_t U32() { return uint32_t(U64() >> 32); }

  // [0, 1), multiples of 2^-53.
  constexpr double Uniform() { return double(U64() >> 11) * 0x1p-53; }
  constexpr double Uniform(double low, double high) { return low + (high - low) * Uniform(); }

  // [0, count), count > 0. The bias of the multiply is below count / 2^32.
  constexpr uint32_t Below(uint32_t count) {
    return uint32_t((uint64_t(U32()) * uint64_t(count)) >> 32);
  }
};

}  // namespace pelt
