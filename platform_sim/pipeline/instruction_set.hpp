// The opcodes of a machine: mnemonic, class and a pattern that says what the operands are. The
// listing reader knows patterns, not opcodes.
//
// A pattern is a list of operands, separated by blanks:
//
//   wX rX uX   register of file X: written, read, both
//   mX MX      memory operand "16(reg)", base in file X; M: the base is written too
//   bX BX xX   base and index register of an address; B: the base is written too
//   i          immediate: a number, a symbol or an expression; not looked into
//   l          branch target      h  place of the branch that a hint is for
//   n          channel number     k  condition bit (its CR field is read)
//   +wS +rS +uS  a special register that is not written down
//
// Files: s SPU, g general, 0 general where 0 means no register, f floating point, v vector,
// c condition field (cr0 if left out). Specials: T count register, L link register, 0 CR0.
// A '?' behind an operand: it may be left out.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "platform_sim/pipeline/instruction.hpp"

namespace pelt {

struct Opcode {
  std::string_view mnemonic;
  uint8_t op_class = 0;
  std::string_view operands;
  Flow flow = Flow::kNext;
  uint8_t access_bytes = 0;  // of a load or store whose address its text says
  bool is_store = false;
  uint32_t sets_cr = kNoRegister;  // by its spelling: "add."
};

// Opcodes that differ by name only.
struct OpcodeGroup {
  uint8_t op_class;
  std::string_view operands;
  std::string_view mnemonics;
  Flow flow = Flow::kNext;
  uint8_t access_bytes = 0;
  bool is_store = false;
};
// One opcode for each mnemonic, sorted by it.
std::vector<Opcode> ExpandGroups(std::span<const OpcodeGroup> groups);
std::optional<Opcode> FindOpcode(std::span<const Opcode> sorted, std::string_view mnemonic);

// Registers of one kind, numbered from `first` in Instruction.
struct RegisterFile {
  char letter;
  uint32_t first, count;
  std::string_view prefixes;  // blank-separated, longer ones first; a bare number is always taken
  std::string_view name;      // "SPU register"
};

struct InstructionSet {
  std::string_view name;
  std::span<const RegisterFile> files;
  // What .align pads with, at addresses 0 and 4 beyond a multiple of 8.
  std::string_view even_padding, odd_padding;
  // Opcode of a mnemonic as written.
  std::optional<Opcode> (*find)(std::string_view mnemonic);
};

const InstructionSet& SpuInstructionSet();
const InstructionSet& PpeInstructionSet();

// "r12", "f3", "cr7", "ctr".
std::string RegisterName(const InstructionSet& set, uint32_t reg);

// How the PPE's registers are numbered.
inline constexpr uint32_t kPpeGeneral = 0, kPpeFloat = 32, kPpeVector = 64, kPpeCr = 192,
                          kPpeCount = 200, kPpeLink = 201;

}  // namespace pelt
