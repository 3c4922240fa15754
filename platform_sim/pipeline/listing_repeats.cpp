#include "platform_sim/pipeline/listing_repeats.hpp"

#include "core/format.hpp"

namespace pelt {
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
