#include "platform_sim/pipeline/listing_text.hpp"

#include <algorithm>
#include <charconv>

namespace pelt {
namespace {

bool IsBlank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v'; }

}  // namespace

bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool IsWordChar(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || IsDigit(c) || c == '_' || c == '.' ||
         c == '$';
}

std::string_view Trim(std::string_view s) {
  while (!s.empty() && IsBlank(s.front())) s.remove_prefix(1);
  while (!s.empty() && IsBlank(s.back())) s.remove_suffix(1);
  return s;
}

std::string Shown(std::string_view s) {
  constexpr size_t kMost = 40;
  std::string out;
  for (const char c : s.substr(0, kMost)) out += c >= ' ' && c < 127 ? c : '?';
  return s.size() > kMost ? out + "..." : out;
}

std::optional<int64_t> ParseInteger(std::string_view s) {
  const bool negative = s.starts_with('-');
  if (negative) s.remove_prefix(1);
  const bool hex = s.starts_with("0x") || s.starts_with("0X");
  if (hex) s.remove_prefix(2);
  int64_t value = 0;
  const auto [end, code] = std::from_chars(s.data(), s.data() + s.size(), value, hex ? 16 : 10);
  if (s.empty() || code != std::errc() || end != s.data() + s.size() || value < 0)
    return std::nullopt;
  return negative ? -value : value;
}

std::string WithoutComments(std::string_view text, uint32_t& unclosed_line) {
  std::string out(text);
  unclosed_line = 0;
  uint32_t line = 1, block_line = 0;
  bool in_block = false, in_line = false, line_is_blank = true;
  for (size_t i = 0; i < out.size(); ++i) {
    const char c = out[i], next = i + 1 < out.size() ? out[i + 1] : '\n';
    if (c == '\n') {
      ++line;
      in_line = false;
      line_is_blank = true;
      continue;
    }
    if (in_block) {
      line_is_blank = false;  // a ';' behind it separates
      out[i] = ' ';
      if (c == '*' && next == '/') {
        out[++i] = ' ';
        in_block = false;
      }
      continue;
    }
    if (!in_line && c == '/' && next == '*') {
      in_block = true;
      block_line = line;
      out[i] = out[i + 1] = ' ';
      ++i;
      continue;
    }
    in_line |=
        c == '#' || (c == '/' && next == '/') || (c == ';' && (line_is_blank || next == ';'));
    line_is_blank &= IsBlank(c);
    if (in_line) out[i] = ' ';
  }
  if (in_block) unclosed_line = block_line;
  return out;
}

std::vector<Statement> SplitStatements(std::string_view text) {
  std::vector<Statement> out;
  uint32_t line = 1;
  size_t begin = 0;
  for (size_t i = 0; i <= text.size(); ++i) {
    if (i < text.size() && text[i] != '\n' && text[i] != ';') continue;
    if (const auto statement = Trim(text.substr(begin, i - begin)); !statement.empty())
      out.push_back({statement, line});
    if (i < text.size() && text[i] == '\n') ++line;
    begin = i + 1;
  }
  return out;
}

std::vector<std::string_view> SplitOperands(std::string_view text) {
  std::vector<std::string_view> out;
  if (Trim(text).empty()) return out;
  size_t begin = 0;
  int depth = 0;
  for (size_t i = 0; i <= text.size(); ++i) {
    const char c = i < text.size() ? text[i] : ',';
    if (c == '(') ++depth;
    if (c == ')') --depth;
    if (i < text.size() && (c != ',' || depth > 0)) continue;
    out.push_back(Trim(text.substr(begin, i - begin)));
    begin = i + 1;
  }
  return out;
}

std::vector<std::string_view> SplitWords(std::string_view text) {
  std::vector<std::string_view> out;
  while (!(text = Trim(text)).empty()) {
    const size_t end = std::min(text.find(' '), text.size());
    out.push_back(text.substr(0, end));
    text.remove_prefix(end);
  }
  return out;
}

}  // namespace pelt
