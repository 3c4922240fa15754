// The words of a listing: comments taken out, statements and operands cut apart, numbers read, what is repeated written
// out. What they mean is listing.cpp's.
//
// Invariant: but for repeats nothing here fails; what is no number is no value, what is no statement is left out, and
// views point into the caller's text.
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

// .rept N ... .endr of a listing, written out as the assembler would: a loop that is unrolled by
// hand is written so.
//
// Invariant: every statement keeps the line that it stands on, and there are never more than
// kMaxListingStatements, regardless of what the counts multiply to.

inline constexpr uint32_t kMaxListingStatements = 1u << 20;

// Nothing, and the reason in `error` with its place in `line`, for a count that is none, too many
// statements, or a .rept and a .endr that do not belong to each other.
std::optional<std::vector<Statement>> WriteOutRepeats(std::vector<Statement> statements,
                                                      std::string& error, uint32_t& line);

}  // namespace pelt
