// Writes a small PNG without compression, for tests: 8-bit, 1 (grey), 3 or 4 channels.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/picture/png.hpp"

namespace pelt::test {

// `pixels` are rows from the top.
inline std::vector<uint8_t> MakePng(uint32_t width, uint32_t height, int channels,
                                    const std::vector<uint8_t>& pixels) {
  std::vector<uint8_t> raw;
  for (uint32_t y = 0; y < height; ++y) {
    raw.push_back(0);  // no filter
    const auto row = pixels.begin() + ptrdiff_t(size_t(y) * width * size_t(channels));
    raw.insert(raw.end(), row, row + ptrdiff_t(width) * channels);
  }
  std::vector<uint8_t> packed{0x78, 0x01};
  uint32_t a = 1, b = 0;
  for (uint8_t byte : raw) {
    a = (a + byte) % 65521;
    b = (b + a) % 65521;
  }
  for (size_t at = 0; at < raw.size(); at += 65535) {
    const size_t count = raw.size() - at < 65535 ? raw.size() - at : 65535;
    packed.push_back(at + count == raw.size());
    for (size_t value : {count, count ^ 0xffff}) {
      packed.push_back(uint8_t(value));
      packed.push_back(uint8_t(value >> 8));
    }
    packed.insert(packed.end(), raw.begin() + ptrdiff_t(at), raw.begin() + ptrdiff_t(at + count));
  }
  PutBig(packed, b << 16 | a);
  std::vector<uint8_t> out(std::begin(kPngSignature), std::end(kPngSignature));
  std::vector<uint8_t> header;
  PutBig(header, width);
  PutBig(header, height);
  const uint8_t colour_type = channels == 1 ? 0 : channels == 3 ? 2 : 6;
  header.insert(header.end(), {8, colour_type, 0, 0, 0});
  PutChunk(out, "IHDR", header);
  PutChunk(out, "IDAT", packed);
  PutChunk(out, "IEND", {});
  return out;
}

}  // namespace pelt::test
