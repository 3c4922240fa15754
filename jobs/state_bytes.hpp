// State as bytes: what a snapshot's small values and rows are put into and taken from.
//
// Everything is a 32-bit word, little-endian; a double is two, the low one first. So the bytes are
// the same on every machine. What has state lists it once (ListState(io, self)), for an archive
// that counts, writes, looks or reads.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

namespace pelt {

// Four words of a snapshot, as they lie there or as the machine has them.
typedef uint32_t StateWords __attribute__((vector_size(16)));

inline StateWords LoadStateWords(const std::byte* from) {
  StateWords words;
  std::memcpy(&words, from, sizeof words);
  return words;
}
inline StateWords InOtherOrder(StateWords words) {
  if constexpr (std::endian::native == std::endian::big)
    for (int i = 0; i < 4; ++i) words[i] = __builtin_bswap32(words[i]);
  return words;
}

inline void StoreStateWords(std::byte* to, StateWords words) {
  std::memcpy(to, &words, sizeof words);
}
inline uint32_t SumOf(StateWords words) { return words[0] + words[1] + words[2] + words[3]; }

// Copies whole vectors into a snapshot, the last one of `vectors` (at least 1) with `mask`. Returns
// `sum` and all that was copied.
inline StateWords SaveStateWords(std::byte* to, const std::byte* from, size_t vectors,
                                 StateWords mask, StateWords sum) {
  const size_t last = sizeof(StateWords) * (vectors - 1);
  for (size_t b = 0; b < last; b += sizeof(StateWords)) {
    const StateWords words = LoadStateWords(from + b);
    StoreStateWords(to + b, InOtherOrder(words));
    sum += words;
  }
  const StateWords words = LoadStateWords(from + last) & mask;
  StoreStateWords(to + last, InOtherOrder(words));
  return sum + words;
}
// And out of it.
inline void LoadStateVectors(std::byte* to, const std::byte* from, size_t vectors) {
  for (size_t b = 0; b < sizeof(StateWords) * vectors; b += sizeof(StateWords))
    StoreStateWords(to + b, InOtherOrder(LoadStateWords(from + b)));
}
// One word, either way.
inline uint32_t CopyStateWord(std::byte* to, const std::byte* from) {
  uint32_t word;
  std::memcpy(&word, from, 4);
  const uint32_t other = std::endian::native == std::endian::big ? __builtin_bswap32(word) : word;
  std::memcpy(to, &other, 4);
  return word;
}

// The sum of vectors in a snapshot.
inline uint32_t SumStateWords(const std::byte* from, size_t vectors) {
  StateWords sum = {}, other = {};
  size_t v = 0;
  for (; v + 2 <= vectors; v += 2) {
    sum += InOtherOrder(LoadStateWords(from + sizeof(StateWords) * v));
    other += InOtherOrder(LoadStateWords(from + sizeof(StateWords) * (v + 1)));
  }
  if (v < vectors) sum += InOtherOrder(LoadStateWords(from + sizeof(StateWords) * v));
  return SumOf(sum + other);
}

// Hands every value of a thing to Archive::Word and Archive::Double, as its type has it.
template <class Archive>
struct StateArchive {
  template <class T>
  void operator()(T& value) {
    auto& archive = static_cast<Archive&>(*this);
    if constexpr (std::is_array_v<T>) {
      for (auto& element : value) (*this)(element);
    } else if constexpr (std::is_same_v<std::remove_const_t<T>, double>) {
      archive.Double(value);
    } else {
      static_assert(std::is_arithmetic_v<T> || std::is_enum_v<T>);
      static_assert(sizeof(T) <= 4);
      archive.Word(value);
    }
  }
};

struct StateCounter : StateArchive<StateCounter> {
  uint64_t words = 0;
  template <class T>
  void Word(T&) {
    ++words;
  }
  template <class T>
  void Double(T&) {
    words += 2;
  }
};

struct StateWriter : StateArchive<StateWriter> {
  explicit StateWriter(std::byte* first) : to(first) {}
  std::byte* to;

  void Put(uint32_t word) {
    CopyStateWord(to, reinterpret_cast<const std::byte*>(&word));
    to += 4;
  }
  template <class T>
  void Word(const T& value) {
    if constexpr (std::is_same_v<T, float>)
      Put(std::bit_cast<uint32_t>(value));
    else
      Put(uint32_t(value));
  }
  void Double(double value) {
    const auto bits = std::bit_cast<uint64_t>(value);
    Put(uint32_t(bits));
    Put(uint32_t(bits >> 32));
  }
};

struct StateReader : StateArchive<StateReader> {
  explicit StateReader(const std::byte* first) : from(first) {}
  const std::byte* from;

  uint32_t Get() {
    uint32_t word;
    CopyStateWord(reinterpret_cast<std::byte*>(&word), from);
    from += 4;
    return word;
  }
  template <class T>
  void Word(T& value) {
    if constexpr (std::is_same_v<T, float>)
      value = std::bit_cast<float>(Get());
    else if constexpr (std::is_same_v<T, bool>)
      value = Get() != 0;
    else
      value = T(Get());
  }
  void Double(double& value) {
    const uint64_t low = Get();
    value = std::bit_cast<double>(low | uint64_t(Get()) << 32);
  }
};

// Goes over what a reader would read and changes nothing: doubles must be finite.
struct StateLooker : StateArchive<StateLooker> {
  explicit StateLooker(const std::byte* first) : reader(first) {}
  StateReader reader;
  bool finite = true;

  template <class T>
  void Word(const T&) {
    reader.Get();
  }
  void Double(const double&) {
    double value;
    reader.Double(value);
    finite = finite && std::isfinite(value);
  }
};

}  // namespace pelt
