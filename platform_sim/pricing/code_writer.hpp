// Writes StraightCode for recorded operations: gives every recorded value a value of the code, and
// a value to every constant the moment it is first needed.
//
// Invariant: a value read before it is written was there before the code.
#pragma once

#include <initializer_list>
#include <map>

#include "platform_sim/pricing/lowering.hpp"

namespace pelt {

// Both machines move aligned quadwords.
inline constexpr uint32_t kQuadBytes = 16;
constexpr int32_t QuadOf(int32_t address) { return address & ~int32_t(kQuadBytes - 1); }
constexpr bool IsAligned(int32_t address) { return QuadOf(address) == address; }

struct MachineOperation {
  std::string_view mnemonic;
  uint8_t op_class;
};

class CodeWriter {
 public:
  struct Access {
    int32_t address;
    uint32_t bytes;
    bool is_store;
  };

  // The value of the code that holds a recorded one.
  uint32_t Of(uint32_t recorded, ValueFile file = ValueFile::kVector) {
    const auto [at, is_new] = values_.try_emplace(recorded, 0);
    if (is_new) at->second = New(file);
    return at->second;
  }
  void Bind(uint32_t recorded, uint32_t value) { values_[recorded] = value; }

  // A constant in a register, by a name of the caller's.
  uint32_t Constant(uint32_t name, ValueFile file = ValueFile::kVector) {
    const auto [at, is_new] = constants_.try_emplace({name, file}, 0);
    if (is_new) at->second = New(file);
    return at->second;
  }

  uint32_t New(ValueFile file = ValueFile::kVector) {
    out_.code.file.push_back(file);
    return out_.code.value_count() - 1;
  }

  // An instruction with one result, which is returned.
  uint32_t Emit(MachineOperation operation, std::initializer_list<uint32_t> reads,
                ValueFile file = ValueFile::kVector) {
    const uint32_t result = New(file);
    Add(operation, reads).writes.Add(result);
    return result;
  }
  uint32_t EmitLoad(MachineOperation operation, int32_t address, uint32_t bytes,
                    std::initializer_list<uint32_t> reads = {},
                    ValueFile file = ValueFile::kVector) {
    const uint32_t result = New(file);
    Instruction& instruction = Add(operation, reads);
    instruction.writes.Add(result);
    instruction.address.displacement_bytes = address;
    instruction.address.size_bytes = bytes;
    return result;
  }
  void EmitStore(MachineOperation operation, int32_t address, uint32_t bytes,
                 std::initializer_list<uint32_t> reads) {
    Instruction& instruction = Add(operation, reads);
    instruction.address.displacement_bytes = address;
    instruction.address.size_bytes = bytes;
    instruction.address.is_store = true;
  }
  // A branch that is foretold not taken, and is not.
  void EmitBranch(MachineOperation operation, std::initializer_list<uint32_t> reads) {
    Add(operation, reads).flow = Flow::kConditional;
  }
  void EmitPlain(MachineOperation operation) { Add(operation, {}); }

  LoweredCode Take() {
    out_.code.EndBranches();
    return std::move(out_);
  }

 private:
  Instruction& Add(MachineOperation operation, std::initializer_list<uint32_t> reads) {
    Instruction instruction;
    instruction.op_class = operation.op_class;
    for (const uint32_t value : reads) instruction.reads.Add(value);
    out_.code.program.push_back(instruction);
    out_.name.push_back(operation.mnemonic);
    return out_.code.program.back();
  }

  LoweredCode out_;
  std::map<uint32_t, uint32_t> values_;
  std::map<std::pair<uint32_t, ValueFile>, uint32_t> constants_;
};

// Records that lie in one struct are reached by one look-up: remembers the last look-ups.
class RecordLookups {
 public:
  // The value that the look-up of a struct around `address` gave; null if there was none lately.
  const uint32_t* Find(int32_t address) const {
    for (const auto& [base, value] : recent_)
      if (address >= base && address < base + kStructBytes) return &value;
    return nullptr;
  }
  void Remember(int32_t address, uint32_t value) {
    if (recent_.size() == kRemembered) recent_.erase(recent_.begin());
    recent_.push_back({address, value});
  }

 private:
  static constexpr size_t kRemembered = 16;    // four lanes, a few structs each
  static constexpr int32_t kStructBytes = 80;  // the largest record (RibbonRecord)
  std::vector<std::pair<int32_t, uint32_t>> recent_;
};

}  // namespace pelt
