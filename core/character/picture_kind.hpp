// What a picture's bytes are, by how they begin: names and media types are often wrong.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

namespace pelt {

// Whether it is of a kind that control maps and a character's images are read from.
bool IsReadPicture(std::span<const std::byte> bytes);

// Whether a picture that is read may have alpha.
bool MayHaveAlpha(std::span<const std::byte> bytes);

// "a WebP picture"; empty for what is not known.
std::string_view NamePicture(std::span<const std::byte> bytes);

}  // namespace pelt
