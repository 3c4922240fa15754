// Lets instructions of straight code go before their turn as long as the rest can still run in
// program order without a spill.
//
// Idea: how many registers each gap of the program would take if, from now on, all that is left ran
// in program order, is known:
//
//   gap (before instruction)   h .. . . . . . j .. . .        h: the first that has not issued
//   j issued now               +1 for what it writes: live in h .. j already
//                              -1 for what it was the last to read: its life ends at the reader
//                                 before j that has not issued, or now
//
// An instruction may issue when no gap then overflows. So the order that was fitted to the
// registers always remains as a way out, and no choice can end without a register.
//
// Invariant: Fits() is true for the first instruction that has not issued, whatever went before.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "platform_sim/schedule/scheduling_core.hpp"
#include "platform_sim/schedule/straight_code.hpp"
#include "platform_sim/schedule/value_uses.hpp"

namespace pelt {

// Numbers in a row, changed by ranges; both ends of a range belong to it. Small numbers: the
// registers of a file (kMostSchedulingRegisters), so that a block's maximum is a few operations.
class PressureProfile {
 public:
  void Resize(size_t gaps);
  void Add(uint32_t first, uint32_t last, int32_t change);
  int32_t At(uint32_t gap) const { return whole_[gap / kBlock] + gap_[gap]; }
  // The first gap of the range with more than `limit`; `last` + 1: none.
  uint32_t FirstAbove(int32_t limit, uint32_t first, uint32_t last) const;

 private:
  static constexpr uint32_t kBlock = 32;

  std::vector<int16_t> gap_;          // without what its whole block has
  std::vector<int16_t> whole_, max_;  // of each block; max_ with whole_ in it
};

class RegisterGuard {
 public:
  // The code fits (fit_registers.hpp).
  RegisterGuard(const StraightCode& code, const ValueUses& uses, const SchedulingCore& core);

  // The first instruction that has not issued; the program's size when all have.
  uint32_t head() const { return head_; }
  bool HasIssued(uint32_t instruction) const { return has_issued_[instruction]; }
  bool Fits(uint32_t instruction) const;
  void Issue(uint32_t instruction);

 private:
  // The last reader of `value` before `instruction`, its last one, that has not issued.
  uint32_t ReaderBefore(uint32_t value, uint32_t instruction) const;
  bool IsLastReader(uint32_t value, uint32_t instruction) const;

  const StraightCode& code_;
  const ValueUses& uses_;
  const SchedulingCore& core_;
  std::array<PressureProfile, kValueFileCount> pressure_;
  // Where an instruction last did not fit: mostly the next one fails there too.
  mutable std::array<uint32_t, kValueFileCount> tight_gap_{};
  std::vector<uint32_t> readers_left_;  // of each value: those up to the last that has not issued
  std::vector<bool> has_issued_;
  uint32_t head_ = 0;
};

}  // namespace pelt
