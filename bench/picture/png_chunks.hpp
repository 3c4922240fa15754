// What a PNG file is made of: chunks of a type, bytes and their checksum (PNG specification, third edition, 5.3).
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

namespace pelt {

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

}  // namespace pelt
