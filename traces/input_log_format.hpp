// What writer and reader of the input log share: places in the header, numbers as bytes, the hash,
// the rows of a pose.
//
// Numbers are put together byte by byte, on every host, so there is one path to test.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <type_traits>
#include <vector>

#include "core/chunk.hpp"
#include "core/layer.hpp"
#include "core/streams.hpp"
#include "traces/digest.hpp"

namespace pelt::input_log {

inline constexpr std::string_view kMagic = "PELTINP\n";
inline constexpr size_t kOptionsAt = 16;
inline constexpr size_t kGroomCountAt = 20;
inline constexpr size_t kFrameCountAt = 28;
inline constexpr size_t kFileBytesAt = 32;
inline constexpr size_t kHashAt = 40;
inline constexpr size_t kHeaderBytes = 48;
inline constexpr uint32_t kTextBytesLimit = 4096;
// Every character has at least one layer.
inline constexpr uint32_t kCharactersLimit = kLayersPerScene;
inline constexpr uint8_t kPoseUnchanged = 0, kPoseFollows = 1;
inline constexpr uint8_t kRatesUnchanged = 0, kRatesFollow = 1, kNoRatesGiven = 2;
inline constexpr uint32_t kWithIndexBuffer = 1u << 0, kWithVelocities = 1u << 1,
                          kWithOrigins = 1u << 2, kWithSnapshot = 1u << 3, kWithLists = 1u << 4;

template <class T>
void PutNumber(std::vector<std::byte>& to, T value) {
  for (size_t b = 0; b < sizeof(T); ++b) to.push_back(std::byte(uint64_t(value) >> 8 * b & 255));
}

template <class T>
void PutNumberAt(std::vector<std::byte>& to, size_t at, T value) {
  for (size_t b = 0; b < sizeof(T); ++b) to[at + b] = std::byte(uint64_t(value) >> 8 * b & 255);
}

template <class T>
T GetNumber(const std::byte* from) {
  uint64_t value = 0;
  for (size_t b = 0; b < sizeof(T); ++b) value |= uint64_t(from[b]) << 8 * b;
  return T(value);
}

// Of all bytes but the hash itself. Each step is a bijection of the state, so one damaged word is
// always noticed.
inline uint64_t HashOf(std::span<const std::byte> file) {
  Digest digest;
  const auto add = [&digest](std::span<const std::byte> bytes) {
    size_t at = 0;
    for (; at + 4 <= bytes.size(); at += 4) digest.Add(GetNumber<uint32_t>(bytes.data() + at));
    for (; at < bytes.size(); ++at) digest.Add(uint32_t(bytes[at]));
  };
  add(file.first(kHashAt));
  add(file.subspan(kHeaderBytes));
  return digest.Value();
}

// Calls visit(byte offset in PoseBlock, number of words) for every row, of lanes in use only; or in
// another block of a character's joints.
template <auto kRow = &Streams::pose, class Visit>
void ForEachPoseRow(uint32_t joint_count, Visit visit) {
  for (const RowDesc& row : DescribeStream(StreamOf<kRow>).rows) {
    // joint_count and teleported stand before the rows; whether velocities are given, too.
    if (row.lane_count == 1) continue;
    const bool by_joint = row.lane_count == kJointsPerCharacter;
    const uint32_t lanes = by_joint ? joint_count : row.lane_count;
    for (uint32_t first = 0; first < row.element_count; first += row.lane_count)
      visit(row.offset_bytes + 4 * first, lanes);
  }
}

template <auto kRow = &Streams::pose>
size_t CountPoseWords(uint32_t joint_count) {
  size_t words = 0;
  ForEachPoseRow<kRow>(joint_count, [&words](size_t, uint32_t lanes) { words += lanes; });
  return words;
}

// An archive of ListInputFields that appends.
struct Writer {
  std::vector<std::byte>& bytes;

  template <class T>
  void operator()(const char*, const T& value) {
    if constexpr (std::is_same_v<T, double>) {
      PutNumber(bytes, std::bit_cast<uint64_t>(value));
    } else if constexpr (std::is_same_v<T, float>) {
      PutNumber(bytes, std::bit_cast<uint32_t>(value));
    } else if constexpr (std::is_same_v<T, bool>) {
      PutNumber(bytes, uint8_t(value));
    } else if constexpr (std::is_array_v<T>) {
      for (const auto& element : value) (*this)("", element);
    } else {
      static_assert(std::is_same_v<T, uint32_t> || std::is_same_v<T, uint8_t>);
      PutNumber(bytes, value);
    }
  }
};

}  // namespace pelt::input_log
