// One instruction as the core models see it: a class, the registers it reads and writes, where it
// may jump and what it addresses. No text: a listing reader makes it, and so can a recorder that
// sees only operations and operands.
//
// Invariant: `op_class` is an index of the class table of the core that runs it (SpuClass or
// PpeClass); mixing the two is refused by nothing, so a program is made for one core.
//
// Registers are plain numbers and may exceed what the machine has (a recorder numbers values, not
// registers): the chart says how many are live at once against the machine's limit.
#pragma once

#include <array>
#include <cstdint>
#include <span>

namespace pelt {

inline constexpr uint32_t kNoRegister = 0xFFFFFFFF;
inline constexpr uint32_t kNoTarget = 0xFFFFFFFF;

// Registers of one instruction, in operand order.
template <uint32_t kCapacity>
struct RegisterList {
  std::array<uint32_t, kCapacity> number{};
  uint32_t count = 0;

  bool Add(uint32_t reg) {
    if (count == kCapacity) return false;
    number[count++] = reg;
    return true;
  }
  const uint32_t* begin() const { return number.data(); }
  const uint32_t* end() const { return number.data() + count; }
};

enum class Flow : uint8_t {
  kNext,         // goes on with the next instruction
  kConditional,  // to `target`, or on
  kAlways,       // to `target`
  kHint,         // goes on; announces that branch `hinted` goes to `target`
  kCall,         // leaves the program and comes back: not followed
  kEnd,          // leaves the program
};

// What a load or store addresses, as far as its text says it.
struct AddressOperand {
  uint32_t base = kNoRegister, index = kNoRegister;
  int32_t displacement_bytes = 0;
  uint32_t size_bytes = 0;  // 0: not a load or store
  bool is_store = false;
};

struct Instruction {
  uint8_t op_class = 0;
  Flow flow = Flow::kNext;
  RegisterList<5> reads;   // all of them, the address's too
  RegisterList<3> writes;  // three: a compare-and-branch that counts, a load that updates
  AddressOperand address;
  uint32_t target = kNoTarget;  // index of an instruction; the program's size: just behind it
  uint32_t hinted = kNoTarget;  // for a hint: index of the branch
  uint64_t location_bytes = 0;  // of the instruction itself, for what looks at its alignment
};

using Program = std::span<const Instruction>;

// How often a loop runs: `head` is the instruction its backward branch goes to.
struct TripCount {
  uint32_t head = 0;
  uint64_t iterations = 0;
};

}  // namespace pelt
