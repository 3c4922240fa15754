// The words of a listing: comments taken out, statements and operands cut apart, numbers read.
// What they mean is listing.cpp's.
//
// Invariant: nothing here fails; what is no number is no value, what is no statement is left out,
// and views point into the caller's text.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace pelt {

bool IsDigit(char c);
// Of a label or an opcode.
bool IsWordChar(char c);
std::string_view Trim(std::string_view s);

// What a message shows of the input: printable, and not all of a long line.
std::string Shown(std::string_view s);

// Decimal or 0x..., with '-' or without.
std::optional<int64_t> ParseInteger(std::string_view s);

// Comments become blanks, so that lines keep their numbers. `unclosed_line`: where a comment begins
// that does not end; 0: nowhere.
std::string WithoutComments(std::string_view text, uint32_t& unclosed_line);

struct Statement {
  std::string_view text;
  uint32_t line;
};

std::vector<Statement> SplitStatements(std::string_view text);

// At commas outside of brackets.
std::vector<std::string_view> SplitOperands(std::string_view text);

// At blanks.
std::vector<std::string_view> SplitWords(std::string_view text);

}  // namespace pelt
