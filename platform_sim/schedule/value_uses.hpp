// Who writes and who reads each value of straight code: readers in program order, each once.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "platform_sim/schedule/straight_code.hpp"

namespace pelt {

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

inline ValueUses::ValueUses(const StraightCode& code)
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
