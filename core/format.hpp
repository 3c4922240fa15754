// Texts, by fmt's rules. The only code of fmt's that comes out of a file that includes this is what
// lists the arguments: fmt as headers costs each file that calls it two seconds to compile and 180
// KB of copies.
#pragma once

#include <fmt/core.h>

#include <string>

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

}  // namespace pelt
