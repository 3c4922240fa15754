// Straight code: one basic block, but that branches may leave it (an extended basic block), on
// values instead of registers. What a recorded kernel becomes, and what a scheduler takes.
//
// Invariant: registers of `program` are value numbers below value_count; each is written by one
// instruction at most, before any that reads it (a value that none writes was there before). All
// targets are kNoTarget, but for branches that go on: Flow::kConditional to the program's size,
// foretold not taken. Addresses of loads and stores are absolute in a space of the recorder's own:
// base and index are kNoRegister, displacement_bytes is the address. Two accesses that overlap keep
// their order when one of them is a store; a store stays behind the branches before it; all else
// may move, as on a machine where loads and arithmetic raise nothing.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "platform_sim/pipeline/instruction.hpp"

namespace pelt {

// Where a value lives: an SPU has one file, a PPE more.
enum class ValueFile : uint8_t { kVector, kGeneral, kCondition };
inline constexpr uint32_t kValueFileCount = 3;

// Of a place in the program that is not there.
inline constexpr uint32_t kNoInstruction = ~0u;

struct StraightCode {
  std::vector<Instruction> program;
  std::vector<ValueFile> file;  // of each value
  uint32_t value_count() const { return uint32_t(file.size()); }
  // Of a program that is whole.
  void EndBranches() {
    for (Instruction& instruction : program)
      if (instruction.flow == Flow::kConditional) instruction.target = uint32_t(program.size());
  }
};

// Whether the invariant above holds, for a core of so many classes. All that takes StraightCode
// checks it; the reason is in `error` ("instruction 4: ...").
bool CheckStraightCode(const StraightCode& code, uint32_t class_count, std::string& error);

// Where an instruction of finished code comes from, if not from an instruction of the straight
// code.
inline constexpr uint32_t kSpillStore = 0xFFFFFFFF, kSpillLoad = 0xFFFFFFFE, kPadding = 0xFFFFFFFD;

// A value that is there when the code begins: in a register, or, when there are more such values
// than registers, in its spill slot.
struct EntryValue {
  uint32_t value = 0;
  uint32_t reg = kNoRegister;
  int32_t slot_address = 0;  // if reg is kNoRegister
};

// The same on registers that the core has, and what that took.
struct FinishedCode {
  std::vector<Instruction> program;  // numbered as the core's instruction set says
  std::vector<uint32_t> origin;      // of each: instruction of the straight code, or as above
  std::vector<EntryValue> entry;
  uint32_t spill_stores = 0, spill_loads = 0;
  uint32_t made_again = 0;         // instructions that run once more, instead of a spill
  uint32_t padding = 0;            // nop and lnop that put pairs into fetch groups
  uint32_t most_live_vectors = 0;  // after spilling: at most what the core has
};

// Who writes and who reads each value of straight code: readers in program order, each once.
class ValueUses {
 public:
  explicit ValueUses(const StraightCode& code);

  // kNoTarget: none, it is there when the code begins.
  uint32_t WriterOf(uint32_t value) const { return writer_[value]; }
  std::span<const uint32_t> ReadersOf(uint32_t value) const {
    return std::span(readers_).subspan(first_[value], count_[value]);
  }

 private:
  std::vector<uint32_t> writer_;
  std::vector<uint32_t> first_, count_;  // of each value, into readers_
  std::vector<uint32_t> readers_;
};

}  // namespace pelt
