// Control maps: pictures that scale attributes over the surface, and those that colour it, decoded from PNG or JPEG.
//
// The decoder's code lives in this file alone and is private to it (STB_IMAGE_STATIC), because the
// glTF library brings its own. It sees hostile files: the picture's side, and every allocation, is
// bounded; a bound exceeded is an ordinary decoding error. Sampling is plain arithmetic, so a groom
// has the same bits everywhere.

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "core/character/picture_kind.hpp"
#include "core/error.hpp"
#include "core/file_bytes.hpp"
#include "core/float_rules.hpp"
#include "core/format.hpp"
#include "core/groom/fur_setup.hpp"

namespace pelt {
namespace {

constexpr int kSideLimit = 8192;
constexpr size_t kPngBytesLimit = 256u << 20;
// A picture of the largest side, four 16-bit channels, and a filter byte a row.
constexpr size_t kAllocationLimit = size_t(kSideLimit) * kSideLimit * 8 + kSideLimit;

// A small PNG can claim to unpack to gigabytes; the decoder takes null as "out of memory".
void* AllocateBounded(size_t bytes) {
  return bytes <= 2 * kAllocationLimit ? std::malloc(bytes) : nullptr;
}
void* ResizeBounded(void* block, size_t bytes) {
  return bytes <= 2 * kAllocationLimit ? std::realloc(block, bytes) : nullptr;
}

}  // namespace
}  // namespace pelt

#define STB_IMAGE_IMPLEMENTATION
#define STB_IMAGE_STATIC
#define STBI_ONLY_PNG
#define STBI_ONLY_JPEG
#define STBI_NO_SIMD  // one way to decode on every machine
#define STBI_NO_STDIO
#define STBI_NO_THREAD_LOCALS
#define STBI_MAX_DIMENSIONS 8192
#define STBI_MALLOC(bytes) pelt::AllocateBounded(bytes)
#define STBI_REALLOC(block, bytes) pelt::ResizeBounded(block, bytes)
#define STBI_FREE(block) std::free(block)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wunused-function"
#pragma GCC diagnostic ignored "-Wmissing-field-initializers"
#pragma GCC diagnostic ignored "-Wsign-compare"
#include <stb/stb_image.h>
#pragma GCC diagnostic pop

namespace pelt {

ControlMap ReadControlMap(std::span<const uint8_t> png, const std::string& name) {
  if (png.size() > kPngBytesLimit) {
    throw Error(Format("control map '{}': larger than {} bytes", name, kPngBytesLimit));
  }
  int width = 0, height = 0, channels = 0;
  if (!stbi_info_from_memory(png.data(), int(png.size()), &width, &height, &channels)) {
    const std::string_view kind = NamePicture(std::as_bytes(png));
    throw Error(Format(
        "control map '{}': {}not a PNG or JPEG this tool reads ({}); pictures have at "
        "most {} pixels a side",
        name, kind.empty() || kind == "a PNG" || kind == "a JPEG" ? "" : Format("{}, ", kind),
        stbi_failure_reason(), kSideLimit));
  }
  if (width < 1 || height < 1 || width > kSideLimit || height > kSideLimit) {
    throw Error(Format("control map '{}': {} x {} pixels; at most {} a side are allowed", name,
                       width, height, kSideLimit));
  }
  stbi_uc* pixels =
      stbi_load_from_memory(png.data(), int(png.size()), &width, &height, &channels, 4);
  if (!pixels) {
    throw Error(Format("control map '{}': damaged picture ({})", name, stbi_failure_reason()));
  }
  ControlMap map;
  map.width = uint32_t(width);
  map.height = uint32_t(height);
  map.rgba.assign(pixels, pixels + size_t(width) * size_t(height) * 4);
  std::free(pixels);
  return map;
}

ControlMap ReadControlMapFile(const std::string& path) {
  const auto png = ReadWhole(path, kPngBytesLimit);
  if (!png) throw Error(Format("control map '{}': {}", path, png.error()));
  return ReadControlMap({reinterpret_cast<const uint8_t*>(png->data()), png->size()}, path);
}

namespace {

struct Blend {
  uint32_t first, second;
  float share;  // of the second
};

// The two texels around a coordinate, and their blend. Texel centres lie at (i + 0.5) / size.
Blend FindTexels(float coordinate, uint32_t size, Wrap wrap) {
  if (wrap != Wrap::kRepeat) {
    if (wrap == Wrap::kMirror) {
      const float turn = coordinate - 2.0f * std::floor(0.5f * coordinate);
      coordinate = turn > 1.0f ? 2.0f - turn : turn;
    }
    const float end = float(size - 1);
    float place = std::min(std::max(coordinate * float(size) - 0.5f, 0.0f), end);
    if (!(place >= 0.0f && place <= end)) place = 0.0f;  // not finite
    const uint32_t first = uint32_t(place);
    return {first, std::min(first + 1, size - 1), place - float(first)};
  }
  float turn = coordinate - std::floor(coordinate);
  if (!(turn >= 0.0f && turn <= 1.0f)) turn = 0.0f;               // not finite
  const float place = turn * float(size) + (float(size) - 0.5f);  // one turn up: never negative
  const float whole = std::floor(place);
  const uint32_t first = uint32_t(whole) % size;
  return {first, (first + 1) % size, place - whole};
}

}  // namespace

float ControlMap::Sample(glm::vec2 uv, int channel, const std::array<Wrap, 2>& wrap) const {
  if (width == 0 || height == 0) return 1.0f;
  const Blend x = FindTexels(uv.x, width, wrap[0]), y = FindTexels(uv.y, height, wrap[1]);
  const auto texel = [&](uint32_t column, uint32_t row) {
    return float(rgba[(size_t(row) * width + column) * 4 + size_t(channel)]);
  };
  const auto mix = [](float a, float b, float share) { return a + (b - a) * share; };
  const float top = mix(texel(x.first, y.first), texel(x.second, y.first), x.share);
  const float bottom = mix(texel(x.first, y.second), texel(x.second, y.second), x.share);
  return std::min(std::max(mix(top, bottom, y.share) / 255.0f, 0.0f), 1.0f);
}

float ControlMap::Nearest(glm::vec2 uv, int channel, const std::array<Wrap, 2>& wrap) const {
  if (width == 0 || height == 0) return 1.0f;
  const auto nearest = [](const Blend& b) { return b.share < 0.5f ? b.first : b.second; };
  const size_t row = nearest(FindTexels(uv.y, height, wrap[1])),
               column = nearest(FindTexels(uv.x, width, wrap[0]));
  return float(rgba[(row * width + column) * 4 + size_t(channel)]) / 255.0f;
}

}  // namespace pelt
