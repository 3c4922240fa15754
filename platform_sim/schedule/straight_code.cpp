#include "platform_sim/schedule/straight_code.hpp"

#include <algorithm>

#include "core/format.hpp"
#include "platform_sim/pipeline/issue_walk.hpp"

namespace pelt {
namespace {

// Why an instruction's place in a straight program is wrong; nullptr: it is right.
const char* WrongShape(const Instruction& instruction, size_t program_size) {
  const AddressOperand& address = instruction.address;
  if (address.base != kNoRegister || address.index != kNoRegister)
    return "an address in registers; expected an absolute one";
  if (address.size_bytes && int64_t{address.displacement_bytes} + address.size_bytes > INT32_MAX)
    return "an address beyond 2 GiB";
  if (instruction.flow == Flow::kNext) {
    if (instruction.target != kNoTarget || instruction.hinted != kNoTarget)
      return "a target, but it is no branch";
    return nullptr;
  }
  if (instruction.flow == Flow::kConditional && instruction.target == program_size) return nullptr;
  return "a jump; expected only conditional branches to behind the program";
}

bool Refuse(size_t index, const char* what, std::string& error) {
  error = Format("instruction {}: {}", index, what);
  return false;
}

}  // namespace

bool CheckStraightCode(const StraightCode& code, uint32_t class_count, std::string& error) {
  if (!CheckProgram(code.program, class_count, error)) return false;
  std::vector<bool> is_written(code.value_count()), is_read(code.value_count());
  for (size_t i = 0; i < code.program.size(); ++i) {
    const Instruction& instruction = code.program[i];
    if (const char* wrong = WrongShape(instruction, code.program.size()))
      return Refuse(i, wrong, error);
    for (const uint32_t value : instruction.reads) {
      if (value >= code.value_count()) return Refuse(i, "reads a value that has no file", error);
      is_read[value] = true;
    }
    for (const uint32_t value : instruction.writes) {
      if (value >= code.value_count()) return Refuse(i, "writes a value that has no file", error);
      if (is_written[value]) return Refuse(i, "writes a value that is already written", error);
      if (is_read[value]) return Refuse(i, "writes a value that was read before", error);
      is_written[value] = true;
    }
  }
  return true;
}

ValueUses::ValueUses(const StraightCode& code)
    : writer_(code.value_count(), kNoTarget),
      first_(code.value_count() + 1, 0),
      count_(code.value_count(), 0) {
  for (const Instruction& instruction : code.program)
    for (const uint32_t value : instruction.reads) ++first_[value + 1];
  for (uint32_t v = 0; v < code.value_count(); ++v) first_[v + 1] += first_[v];
  readers_.resize(first_.back());
  for (uint32_t i = 0; i < code.program.size(); ++i) {
    for (const uint32_t value : code.program[i].writes) writer_[value] = i;
    for (const uint32_t value : code.program[i].reads) {
      uint32_t& count = count_[value];
      if (count && readers_[first_[value] + count - 1] == i) continue;  // reads it twice
      readers_[first_[value] + count++] = i;
    }
  }
}

}  // namespace pelt
