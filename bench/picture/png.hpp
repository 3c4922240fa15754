// Pictures as PNG files.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace pelt {

// 8 bits a channel, 1 to 4 channels, rows from the top.
std::vector<std::byte> EncodePng(std::span<const uint8_t> pixels, uint32_t width, uint32_t height,
                                 uint32_t channels);

}  // namespace pelt
