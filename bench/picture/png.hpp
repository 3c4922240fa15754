// Pictures as PNG files: what such a file is made of, one picture, and several that play.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace pelt {

// Chunks of a type, bytes and their checksum (PNG specification, third edition, 5.3).

inline constexpr uint8_t kPngSignature[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

inline uint32_t CountCrc(std::span<const uint8_t> bytes) {
  uint32_t crc = 0xffffffffu;
  for (const uint8_t byte : bytes) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0);
  }
  return ~crc;
}

inline void PutBig(std::vector<uint8_t>& out, uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) out.push_back(uint8_t(value >> shift));
}

inline void PutChunk(std::vector<uint8_t>& out, std::string_view type,
                     std::span<const uint8_t> body) {
  PutBig(out, uint32_t(body.size()));
  const size_t begin = out.size();
  out.insert(out.end(), type.begin(), type.end());
  out.insert(out.end(), body.begin(), body.end());
  PutBig(out, CountCrc(std::span(out).subspan(begin)));
}

// 8 bits a channel, 1 to 4 channels, rows from the top.
std::vector<std::byte> EncodePng(std::span<const uint8_t> pixels, uint32_t width, uint32_t height,
                                 uint32_t channels);

// Pictures one after the other as one animated PNG (11.3.6 of the specification), which browsers play and other viewers
// show the first picture of.
struct AnimationFrame {
  std::vector<std::byte> png;  // of 8 bits per channel, all of one size
  double seconds;              // that it is shown
};

// Plays without end. Throws Error where there is no frame, where one is no PNG, and where sizes differ.
std::vector<std::byte> AnimatePng(std::span<const AnimationFrame> frames);

}  // namespace pelt
