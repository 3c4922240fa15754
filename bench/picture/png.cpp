#include "bench/picture/png.hpp"

#include "core/error.hpp"

#define STB_IMAGE_WRITE_STATIC
#define STBI_WRITE_NO_STDIO
#define STB_IMAGE_WRITE_IMPLEMENTATION
#include <stb/stb_image_write.h>

namespace pelt {

std::vector<std::byte> EncodePng(std::span<const uint8_t> pixels, uint32_t width, uint32_t height,
                                 uint32_t channels) {
  std::vector<std::byte> png;
  const auto append = [](void* to, void* data, int bytes) {
    const std::byte* first = static_cast<const std::byte*>(data);
    static_cast<std::vector<std::byte>*>(to)->insert(
        static_cast<std::vector<std::byte>*>(to)->end(), first, first + bytes);
  };
  if (!stbi_write_png_to_func(append, &png, int(width), int(height), int(channels), pixels.data(),
                              int(width * channels)))
    throw Error("picture: no memory to write it as PNG");
  return png;
}

}  // namespace pelt
