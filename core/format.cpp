#include "core/format.hpp"

#include <fmt/format.h>

#include <iterator>

namespace pelt {
namespace {

bool IsControl(uint32_t code) { return code < 0x20 || (code >= 0x7f && code < 0xa0); }

// Line and paragraph separators, and marks, embeddings, overrides and isolates of direction.
bool ChangesLayout(uint32_t code) {
  return code == 0x061c || code == 0x200e || code == 0x200f || (code >= 0x2028 && code <= 0x202e) ||
         (code >= 0x2066 && code <= 0x2069);
}

bool IsPrintableCharacter(const Utf8Character& c) {
  return c.bytes != 0 && !IsControl(c.code) && !ChangesLayout(c.code);
}

}  // namespace

void AppendText(fmt::string_view format, fmt::format_args args, std::string& out) {
  fmt::vformat_to(std::back_inserter(out), format, args);
}

Utf8Character FirstCharacter(std::string_view text) {
  if (text.empty()) return {0, 0};
  const auto byte = [&](size_t i) { return uint8_t(text[i]); };
  const uint8_t lead = byte(0);
  if (lead < 0x80) return {lead, 1};
  const size_t count = lead >= 0xf0 && lead < 0xf5   ? 4
                       : lead >= 0xe0 && lead < 0xf0 ? 3
                       : lead >= 0xc2 && lead < 0xe0 ? 2
                                                     : 0;
  if (count == 0 || text.size() < count) return {0, 0};
  uint32_t code = lead & (0x7fu >> count);
  for (size_t i = 1; i < count; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return {0, 0};
    code = (code << 6) | (byte(i) & 0x3f);
  }
  constexpr uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  return {code, code < kLeast[count] || code > 0x10ffff || surrogate ? 0 : count};
}

bool IsPrintable(std::string_view text) {
  while (!text.empty()) {
    const Utf8Character c = FirstCharacter(text);
    if (!IsPrintableCharacter(c)) return false;
    text.remove_prefix(c.bytes);
  }
  return true;
}

std::string Printable(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const Utf8Character c = FirstCharacter(text);
    const size_t bytes = c.bytes ? c.bytes : 1;
    if (IsPrintableCharacter(c))
      out += text.substr(0, bytes);
    else if (c.bytes == 0 || c.code < 0x80)
      FormatTo(out, "\\x{:02x}", uint8_t(text.front()));
    else
      FormatTo(out, "\\u{:04x}", c.code);
    text.remove_prefix(bytes);
  }
  return out;
}

}  // namespace pelt
