// Texts, by fmt's rules. The only code of fmt's that comes out of a file that includes this is what
// lists the arguments: fmt as headers costs each file that calls it two seconds to compile and 180
// KB of copies.
#pragma once

#include <fmt/core.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace pelt {

// Appends; allocates only where `out` has no room.
void AppendText(fmt::string_view format, fmt::format_args args, std::string& out);

template <class... Args>
void FormatTo(std::string& out, fmt::format_string<Args...> format, Args&&... args) {
  AppendText(format, fmt::make_format_args(args...), out);
}

template <class... Args>
std::string Format(fmt::format_string<Args...> format, Args&&... args) {
  std::string out;
  AppendText(format, fmt::make_format_args(args...), out);
  return out;
}

// ---- Printable ----------------------------------------------------------------------------------
//
// What was read from a file, for a person to read: messages and tables quote names and lines of
// files from unknown sources. Raw, a control character in one could move a terminal's cursor,
// rewrite what was printed before or answer in the user's place.

// Control characters, what changes the direction of text, and bytes that are no UTF-8 as "\x1b",
// "\u202e", "\xff"; the rest as it is. The result is one line and is left as it is by another call.
std::string Printable(std::string_view text);

// Whether Printable() would leave it as it is.
bool IsPrintable(std::string_view text);

// The character that `text` begins with.
struct Utf8Character {
  uint32_t code;
  size_t bytes;  // 0: `text` does not begin with UTF-8
};
Utf8Character FirstCharacter(std::string_view text);

}  // namespace pelt
