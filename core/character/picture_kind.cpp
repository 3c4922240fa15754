#include "core/character/picture_kind.hpp"

#include <algorithm>

#include "core/file_bytes.hpp"

namespace pelt {
namespace {

using namespace std::string_view_literals;

struct Kind {
  std::string_view start;
  size_t at;  // of `start`, bytes from the first
  std::string_view name;
};

constexpr Kind kRead[] = {{"\x89PNG\r\n\x1a\n"sv, 0, "a PNG"}, {"\xff\xd8\xff"sv, 0, "a JPEG"}};
constexpr Kind kOthers[] = {{"WEBP"sv, 8, "a WebP picture"},
                            {"ftypavi"sv, 4, "an AVIF picture"},
                            {"ftypmif1"sv, 4, "an AVIF or HEIC picture"},
                            {"ftyphei"sv, 4, "a HEIC picture"},
                            {"\xabKTX 20"sv, 0, "a KTX2 picture (Basis Universal)"},
                            {"\xabKTX"sv, 0, "a KTX picture"},
                            {"DDS "sv, 0, "a DDS picture"},
                            {"GIF8"sv, 0, "a GIF picture"},
                            {"BM"sv, 0, "a BMP picture"},
                            {"II*\0"sv, 0, "a TIFF picture"},
                            {"MM\0*"sv, 0, "a TIFF picture"},
                            {"8BPS"sv, 0, "a Photoshop picture"},
                            {"\x76\x2f\x31\x01"sv, 0, "an OpenEXR picture"},
                            {"#?RADIANCE"sv, 0, "a Radiance picture"},
                            {"\0\0\0\x0cJXL "sv, 0, "a JPEG XL picture"},
                            {"\0\0\0\x0cjP  "sv, 0, "a JPEG 2000 picture"},
                            {"<svg"sv, 0, "an SVG drawing"},
                            {"<?xml"sv, 0, "XML"},
                            {"<!DOCTYPE"sv, 0, "an HTML page"},
                            {"<html"sv, 0, "an HTML page"},
                            {"version https://git-lfs"sv, 0,
                             "a pointer of Git LFS, whose file was not fetched (git lfs pull)"}};

bool Is(std::span<const std::byte> bytes, const Kind& kind) {
  const std::string_view text = AsText(bytes);
  return text.size() >= kind.at && text.substr(kind.at).starts_with(kind.start);
}

}  // namespace

bool IsReadPicture(std::span<const std::byte> bytes) {
  return std::ranges::any_of(kRead, [&](const Kind& kind) { return Is(bytes, kind); });
}

// PNG, third edition, 11.2.1 and 11.3.1: a colour type with alpha, or a chunk of transparency in front of the pixels.
bool MayHaveAlpha(std::span<const std::byte> bytes) {
  constexpr size_t kColourType = 25;
  if (!Is(bytes, kRead[0]) || bytes.size() <= kColourType) return false;
  const std::string_view text = AsText(bytes);
  return (uint8_t(text[kColourType]) & 4) ||
         text.substr(0, text.find("IDAT")).find("tRNS") != text.npos;
}

std::string_view NamePicture(std::span<const std::byte> bytes) {
  for (const std::span<const Kind> kinds :
       {std::span<const Kind>(kRead), std::span<const Kind>(kOthers)})
    for (const Kind& kind : kinds)
      if (Is(bytes, kind)) return kind.name;
  return {};
}

}  // namespace pelt
