#include "platform_sim/pipeline/listing_text.hpp"

#include <algorithm>
#include <charconv>
#include <utility>

#include "core/format.hpp"

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

namespace {

struct Repeat {
  size_t begin;  // of its body, in what is written out
  uint32_t count;
  uint32_t line;
};

// What stands behind the labels of a statement.
std::string_view BehindLabels(std::string_view text) {
  for (;;) {
    size_t end = 0;
    while (end < text.size() && IsWordChar(text[end])) ++end;
    const std::string_view rest = Trim(text.substr(end));
    if (end == 0 || !rest.starts_with(':')) return text;
    text = Trim(rest.substr(1));
  }
}

}  // namespace

std::optional<std::vector<Statement>> WriteOutRepeats(std::vector<Statement> statements,
                                                      std::string& error, uint32_t& line) {
  std::vector<Statement> out;
  std::vector<Repeat> open;
  const auto fail = [&](uint32_t at, std::string what) {
    line = at;
    error = std::move(what);
    return std::nullopt;
  };
  for (const Statement& statement : statements) {
    const std::string_view text = BehindLabels(statement.text);
    const std::string_view word = text.substr(0, text.find_first_of(" \t"));
    const bool begins = word == ".rept", ends = word == ".endr";
    // Is refused where statements are read; its .endr is its own.
    if (word.starts_with(".irp")) {
      out.push_back(statement);
      open.push_back({out.size(), 1, statement.line});
      continue;
    }
    if (!begins && !ends) {
      if (out.size() == kMaxListingStatements)
        return fail(statement.line, Format("more than {} statements with .rept written out; give "
                                           "the loop that matters",
                                           kMaxListingStatements));
      out.push_back(statement);
      continue;
    }
    // Its labels stand before what is repeated, or at its end.
    const size_t label_length = statement.text.size() - text.size();
    if (label_length) out.push_back({Trim(statement.text.substr(0, label_length)), statement.line});
    const std::string_view operands = Trim(text.substr(word.size()));
    if (begins) {
      const auto count = ParseInteger(operands);
      if (!count || *count < 0 || *count > kMaxListingStatements)
        return fail(statement.line, Format(".rept {}; expected how often, 0 to {}", Shown(operands),
                                           kMaxListingStatements));
      open.push_back({out.size(), uint32_t(*count), statement.line});
      continue;
    }
    if (open.empty()) return fail(statement.line, ".endr without a .rept before it");
    const Repeat repeat = open.back();
    open.pop_back();
    const size_t body = out.size() - repeat.begin;
    if (repeat.begin + uint64_t(body) * repeat.count > kMaxListingStatements)
      return fail(repeat.line, Format(".rept {} of {} statements; expected at most {} statements "
                                      "with all of them written out",
                                      repeat.count, body, kMaxListingStatements));
    out.resize(repeat.begin + (repeat.count ? body : 0));
    for (uint32_t n = 1; n < repeat.count; ++n)
      for (size_t i = 0; i < body; ++i) out.push_back(out[repeat.begin + i]);
  }
  if (!open.empty()) return fail(open.back().line, ".rept without an .endr behind it");
  return out;
}

}  // namespace pelt
