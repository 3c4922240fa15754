#include "traces/json_string.hpp"

#include "core/format.hpp"
#include "core/printable.hpp"

namespace pelt {

void AppendJsonString(std::string& out, std::string_view text) {
  out += '"';
  while (!text.empty()) {
    const auto [code, count] = FirstCharacter(text);
    const char c = text.front();
    if (count == 0) {
      out += "\\ufffd";
    } else if (count == 1 && (c == '"' || c == '\\')) {
      out += {'\\', c};
    } else if (code < 0x10000 && !IsPrintable(text.substr(0, count))) {
      FormatTo(out, "\\u{:04x}", code);
    } else {
      out += text.substr(0, count);
    }
    text.remove_prefix(count ? count : 1);
  }
  out += '"';
}

}  // namespace pelt
