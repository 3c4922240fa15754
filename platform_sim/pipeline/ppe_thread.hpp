// One hardware thread of the PPE under way: when its next instruction can dispatch, and what that
// changes. The core with one thread and with two (ppe_core.cpp) are both made of it.
//
// Invariant: Propose changes nothing, so a core may ask both of its threads and take one; Commit is
// given what Propose said, or a later cycle of the same. What the threads share is in PpeUnits.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "platform_sim/pipeline/issue_chart.hpp"
#include "platform_sim/platforms/ppe.hpp"

namespace pelt {

// What both threads of a core use.
struct PpeUnits {
  std::array<int64_t, kPpeUnitCount> free_at{};  // of instructions that are not pipelined
};

class PpeThread {
 public:
  PpeThread(uint32_t register_end, const PpeParameters& ppe) : ppe_(ppe), ready_(register_end) {}

  // In the cycle that `allowed(cycle)` says, a cycle that this thread may dispatch in and not
  // before the given one.
  template <typename Allowed>
  IssueSlot Propose(const Instruction& instruction, uint32_t index, const PpeUnits& units,
                    Allowed allowed) const {
    IssueSlot slot = ProposeAlone(instruction, index, units);
    const int64_t in_turn = FirstCycle(slot.unpaired);
    slot.WaitUntil(allowed(slot.cycle), StallCause::kOtherThread);
    if (slot.unpaired == Unpaired::kPaired && slot.cycle > in_turn) slot.GiveUpPair();
    return slot;
  }
  void Commit(const Instruction& instruction, const IssueSlot& slot, bool taken, PpeUnits& units);

  bool started() const { return started_; }
  int64_t last_cycle() const { return last_cycle_; }

  // All that its future depends on, relative to `now`; and moving it in time.
  void AppendState(int64_t now, std::vector<int64_t>& state) const;
  void Leap(int64_t cycles);

 private:
  enum class Reader : uint8_t { kArithmetic, kAddress, kBranch, kRegisterBranch };
  static constexpr uint32_t kReaderCount = 4;

  // A store that a load may hit; its registers are unchanged since.
  struct PendingStore {
    uint32_t base, index;
    int64_t begin, end;  // bytes, from what the registers say
    int64_t cycle;
  };

  IssueSlot ProposeAlone(const Instruction& instruction, uint32_t index,
                         const PpeUnits& units) const;
  int64_t FirstCycle(Unpaired pairing) const {
    return !started_ ? 0 : last_cycle_ + (pairing != Unpaired::kPaired);
  }
  Unpaired Pairing(const PpeClassParameters& op) const;
  static bool IsAddress(const Instruction& instruction, uint32_t reg);
  static Reader ReaderOf(const Instruction& instruction, uint32_t reg);
  static bool IsUpdate(const Instruction& instruction);
  void WaitForRegisters(IssueSlot& slot, const Instruction& instruction) const;
  void WaitForStores(IssueSlot& slot, const AddressOperand& address) const;
  void Write(const Instruction& instruction, const PpeClassParameters& op, int64_t cycle,
             uint32_t reg);
  uint32_t LatencyInto(PpeClass producer, uint32_t latency, Reader reader) const;
  void RememberStore(const Instruction& instruction, int64_t cycle);

  const PpeParameters& ppe_;
  std::vector<std::array<int64_t, kReaderCount>> ready_;  // of a register, by who reads it
  std::vector<PendingStore> stores_;
  bool started_ = false;
  int64_t last_cycle_ = 0, restart_ = 0;
  uint8_t used_units_ = 0;      // in the last cycle
  uint32_t in_last_cycle_ = 0;  // instructions
  bool group_ended_ = false;    // nothing goes with the last one
};

}  // namespace pelt
