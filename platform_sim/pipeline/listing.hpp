// Reads an instruction listing in the GNU assembler's syntax into a program for a core model.
//
//   loop:                       # a label; '1:' with '1b' and '1f' too
//     lqd   $4, 16($3)          # registers: $4, r4 or 4
//     fma   $5, $4, $6, $5 ; lnop
//     brnz  $7, loop
//
// '#', '//' and /* */ begin comments; so does ';' at the start of a line, or ';;'. Another ';'
// separates statements. Directives are skipped, but .align, .balign and .p2align pad with
// instructions (nop and lnop), as the assembler does, because addresses decide what pairs; and
// .rept ... .endr is written out (listing_text.hpp).
//
// Invariant: what it cannot read it refuses, with file, line, what it found and what it expected;
// a listing that is read has only targets inside itself. Not looked into: the values of immediates
// and symbols, macros, .if, .irp, and data (which is taken to lie in another section).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "platform_sim/pipeline/instruction_set.hpp"

namespace pelt {

// The most a listing may have; one SPU's local store holds 65536 instructions.
inline constexpr uint32_t kMaxListingInstructions = 262'144;

struct ListingLabel {
  std::string name;
  uint32_t index;  // of the instruction behind it; the program's size if there is none
};

struct Listing {
  std::string name;  // of the file, for messages
  const InstructionSet* set = nullptr;
  std::vector<Instruction> program;
  std::vector<std::string> text;  // of each instruction, blanks made even
  std::vector<uint32_t> line;     // of each instruction, from 1
  std::vector<ListingLabel> labels;

  const ListingLabel* FindLabel(std::string_view label) const;
};

Result<Listing> ReadListing(std::string_view text, std::string_view name,
                            const InstructionSet& set);

}  // namespace pelt
