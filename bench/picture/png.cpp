#include "bench/picture/png.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

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

namespace {

struct Chunk {
  std::string_view type;
  std::span<const uint8_t> body;
};

uint32_t ReadBig(std::span<const uint8_t> bytes) {
  return uint32_t(bytes[0]) << 24 | uint32_t(bytes[1]) << 16 | uint32_t(bytes[2]) << 8 | bytes[3];
}

std::vector<Chunk> SplitPng(std::span<const std::byte> file, size_t frame) {
  const std::span<const uint8_t> bytes(reinterpret_cast<const uint8_t*>(file.data()), file.size());
  constexpr size_t kAround = 12;  // length, type and checksum
  std::vector<Chunk> chunks;
  size_t at = std::size(kPngSignature);
  if (bytes.size() < at ||
      !std::equal(std::begin(kPngSignature), std::end(kPngSignature), bytes.begin()))
    throw Error(fmt::format("animation: picture {} is no PNG", frame));
  while (at < bytes.size()) {
    const size_t left = bytes.size() - at;
    if (left < kAround || ReadBig(bytes.subspan(at)) > left - kAround)
      throw Error(fmt::format("animation: picture {} ends within a chunk", frame));
    const size_t length = ReadBig(bytes.subspan(at));
    chunks.push_back(
        {{reinterpret_cast<const char*>(bytes.data() + at + 4), 4}, bytes.subspan(at + 8, length)});
    at += kAround + length;
  }
  constexpr size_t kHeaderBytes = 13;
  if (chunks.empty() || chunks[0].type != "IHDR" || chunks[0].body.size() != kHeaderBytes)
    throw Error(fmt::format("animation: picture {} has no header", frame));
  if (chunks.back().type != "IEND")
    throw Error(fmt::format("animation: picture {} has no end", frame));
  return chunks;
}

// fcTL: the whole of the canvas, put in the place of what was there.
void PutFrameControl(std::vector<uint8_t>& out, uint32_t sequence, const Chunk& header,
                     double seconds) {
  constexpr uint32_t kTicksPerSecond = 1000;
  const double ticks = std::clamp(std::round(seconds * kTicksPerSecond), 1.0, 65535.0);
  std::vector<uint8_t> body;
  PutBig(body, sequence);
  body.insert(body.end(), header.body.begin(), header.body.begin() + 8);  // width and height
  PutBig(body, 0);                                                        // from the left
  PutBig(body, 0);                                                        // from the top
  PutBig(body, uint32_t(ticks) << 16 | kTicksPerSecond);
  body.insert(body.end(), {0, 0});
  PutChunk(out, "fcTL", body);
}

}  // namespace

std::vector<std::byte> AnimatePng(std::span<const AnimationFrame> frames) {
  if (frames.empty()) throw Error("animation: there is no picture");
  std::vector<uint8_t> out(std::begin(kPngSignature), std::end(kPngSignature));
  const std::vector<Chunk> first = SplitPng(frames[0].png, 0);
  PutChunk(out, first[0].type, first[0].body);
  std::vector<uint8_t> control;
  PutBig(control, uint32_t(frames.size()));
  PutBig(control, 0);  // without end
  PutChunk(out, "acTL", control);
  uint32_t sequence = 0;
  for (size_t f = 0; f < frames.size(); ++f) {
    const std::vector<Chunk> chunks = SplitPng(frames[f].png, f);
    if (!std::ranges::equal(chunks[0].body, first[0].body))
      throw Error(fmt::format(
          "animation: picture {} has another size or kind of pixels than the first", f));
    PutFrameControl(out, sequence++, chunks[0], frames[f].seconds);
    for (const Chunk& chunk : chunks) {
      if (chunk.type != "IDAT") continue;
      if (f == 0) {
        PutChunk(out, "IDAT", chunk.body);
        continue;
      }
      std::vector<uint8_t> body;
      PutBig(body, sequence++);
      body.insert(body.end(), chunk.body.begin(), chunk.body.end());
      PutChunk(out, "fdAT", body);
    }
  }
  PutChunk(out, "IEND", {});
  const std::span<const std::byte> bytes = std::as_bytes(std::span(out));
  return {bytes.begin(), bytes.end()};
}

}  // namespace pelt
