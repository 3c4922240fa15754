#include "traces/json_string.hpp"

#include <cstdint>

#include "core/format.hpp"

namespace pelt {
namespace {

// Bytes of the UTF-8 sequence that `text` begins with; 0 if it begins with none.
size_t SequenceBytes(std::string_view text) {
  const auto byte = [&](size_t i) { return uint8_t(text[i]); };
  const uint8_t lead = byte(0);
  if (lead < 0x80) return 1;
  const size_t count = lead >= 0xf0 && lead < 0xf5   ? 4
                       : lead >= 0xe0 && lead < 0xf0 ? 3
                       : lead >= 0xc2 && lead < 0xe0 ? 2
                                                     : 0;
  if (count == 0 || text.size() < count) return 0;
  uint32_t code = lead & (0x7fu >> count);
  for (size_t i = 1; i < count; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
    code = (code << 6) | (byte(i) & 0x3f);
  }
  constexpr uint32_t kLeast[] = {0, 0, 0x80, 0x800, 0x10000};
  const bool surrogate = code >= 0xd800 && code < 0xe000;
  return code < kLeast[count] || code > 0x10ffff || surrogate ? 0 : count;
}

}  // namespace

void AppendJsonString(std::string& out, std::string_view text) {
  out += '"';
  while (!text.empty()) {
    const size_t count = SequenceBytes(text);
    const char c = text.front();
    if (count == 0) {
      out += "\\ufffd";
    } else if (count == 1 && (c == '"' || c == '\\')) {
      out += {'\\', c};
    } else if (count == 1 && uint8_t(c) < 0x20) {
      out += Format("\\u{:04x}", int(c));
    } else {
      out += text.substr(0, count);
    }
    text.remove_prefix(count ? count : 1);
  }
  out += '"';
}

}  // namespace pelt
