#include "platform_sim/schedule/assign_registers.hpp"

#include <algorithm>
#include <deque>

#include "platform_sim/schedule/value_uses.hpp"

namespace pelt {
namespace {

class Assignment {
 public:
  Assignment(const FittedCode& fitted, const SchedulingCore& core, FinishedCode& out)
      : code_(fitted.code),
        fitted_(fitted),
        out_(out),
        uses_(code_),
        readers_left_(code_.value_count()),
        reg_(code_.value_count(), kNoRegister) {
    for (uint32_t v = 0; v < code_.value_count(); ++v)
      readers_left_[v] = uint32_t(uses_.ReadersOf(v).size());
    for (uint32_t f = 0; f < kValueFileCount; ++f)
      for (uint32_t r = 0; r < core.files[f].count; ++r)
        free_[f].push_back(core.files[f].first + r);
  }

  bool Run(std::span<const uint32_t> order, uint32_t instruction_bytes) {
    out_.entry = fitted_.in_memory;
    std::vector<bool> in_memory(code_.value_count());
    for (const EntryValue& value : fitted_.in_memory) in_memory[value.value] = true;
    bool fits = true;
    for (uint32_t v = 0; v < code_.value_count() && fits; ++v) {
      if (uses_.WriterOf(v) != kNoTarget || readers_left_[v] == 0 || in_memory[v]) continue;
      fits = Take(v);
      out_.entry.push_back({.value = v, .reg = reg_[v]});
    }
    for (size_t n = 0; n < order.size() && fits; ++n) fits = Place(order[n]);
    if (!fits) return false;
    for (size_t i = 0; i < out_.program.size(); ++i) {
      out_.program[i].location_bytes = i * instruction_bytes;
      if (out_.program[i].target != kNoTarget)
        out_.program[i].target = uint32_t(out_.program.size());
    }
    out_.spill_stores = fitted_.spill_stores;
    out_.spill_loads = fitted_.spill_loads;
    out_.made_again = fitted_.made_again;
    return true;
  }

 private:
  uint32_t File(uint32_t value) const { return uint32_t(code_.file[value]); }

  bool Take(uint32_t value) {
    std::deque<uint32_t>& free = free_[File(value)];
    if (free.empty()) return false;
    reg_[value] = free.front();
    free.pop_front();
    if (code_.file[value] == ValueFile::kVector)
      out_.most_live_vectors = std::max(out_.most_live_vectors, ++live_vectors_);
    return true;
  }

  void GiveBack(uint32_t value) {
    free_[File(value)].push_back(reg_[value]);
    live_vectors_ -= code_.file[value] == ValueFile::kVector;
  }

  bool Place(uint32_t index) {
    const Instruction& before = code_.program[index];
    Instruction now = before;
    for (uint32_t r = 0; r < before.reads.count; ++r)
      now.reads.number[r] = reg_[before.reads.number[r]];
    for (uint32_t r = 0; r < before.reads.count; ++r) {
      const uint32_t value = before.reads.number[r];
      const auto earlier = std::span(before.reads.number).first(r);
      if (std::ranges::find(earlier, value) != earlier.end()) continue;
      if (--readers_left_[value] == 0) GiveBack(value);
    }
    for (uint32_t w = 0; w < before.writes.count; ++w) {
      if (!Take(before.writes.number[w])) return false;
      now.writes.number[w] = reg_[before.writes.number[w]];
    }
    for (const uint32_t value : before.writes)
      if (readers_left_[value] == 0) GiveBack(value);
    out_.program.push_back(now);
    out_.origin.push_back(fitted_.origin[index]);
    return true;
  }

  const StraightCode& code_;
  const FittedCode& fitted_;
  FinishedCode& out_;
  const ValueUses uses_;
  std::vector<uint32_t> readers_left_;
  std::vector<uint32_t> reg_;  // of each value
  std::array<std::deque<uint32_t>, kValueFileCount> free_;
  uint32_t live_vectors_ = 0;
};

}  // namespace

Result<FinishedCode> AssignRegisters(const FittedCode& fitted, std::span<const uint32_t> order,
                                     const SchedulingCore& core) {
  FinishedCode out;
  out.program.reserve(order.size());
  out.origin.reserve(order.size());
  if (!Assignment(fitted, core, out).Run(order, core.instruction_bytes))
    return Failure{"an order that needs more registers than the core has"};
  return out;
}

}  // namespace pelt
