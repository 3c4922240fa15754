#include "platform_sim/pipeline/spu_core.hpp"

#include <algorithm>

#include "platform_sim/pipeline/issue_walk.hpp"

namespace pelt {
namespace {

constexpr int64_t kLongAgo = -1'000'000;

class SpuIssue final : public IssueModel {
 public:
  SpuIssue(Program program, const SpuRules& rules, const SpuParameters& spu)
      : rules_(rules), spu_(spu), ready_(RegisterEnd(program), 0) {}

  IssueSlot Issue(const Instruction& instruction, uint32_t index, bool taken) override {
    const SpuClassParameters& op = spu_.classes[instruction.op_class];
    const Unpaired pairing = Pairing(instruction, op);
    IssueSlot slot{index, EarliestCycle(pairing), uint8_t(op.pipe), pairing};
    const int64_t in_turn = slot.cycle;
    slot.WaitUntil(restart_, StallCause::kBranch);
    slot.WaitUntil(pipes_free_, StallCause::kBlocked);
    WaitForRegisters(slot, instruction);
    WaitAfterFp7(slot, instruction);
    if (Branches(instruction) && hinted_ == index) WaitForHintTarget(slot);
    if (pairing == Unpaired::kPaired && slot.cycle > in_turn) slot.GiveUpPair();
    Remember(instruction, op, slot, index, taken);
    return slot;
  }

  uint32_t BusyCycles(const Instruction& instruction, uint32_t pipe) const override {
    const SpuClassParameters& op = spu_.classes[instruction.op_class];
    return (uint32_t(op.pipe) == pipe ? 1 : 0) + op.stall_cycles;
  }

  void AppendState(std::vector<int64_t>& state) const override {
    const auto until = [&](int64_t cycle) { return std::max<int64_t>(cycle - last_cycle_, 0); };
    for (const int64_t cycle : ready_) state.push_back(until(cycle));
    state.push_back(until(restart_));
    state.push_back(until(pipes_free_));
    state.push_back(std::min<int64_t>(last_cycle_ - last_fp7_, 2 + spu_.fp6_after_fp7_cycles));
    state.push_back(std::min<int64_t>(last_cycle_ - hint_cycle_, spu_.hint_lead_cycles));
    state.push_back(since_hint_);
    state.push_back(int64_t(hinted_));
    state.push_back(int64_t(hint_target_));
    // Equal at the same branch, but a state is a state.
    for (const bool flag : {last_paired_, last_never_pairs_, branched_}) state.push_back(flag);
    state.push_back(int64_t(last_pipe_));
    state.push_back(int64_t(last_location_));
  }

  void Leap(int64_t cycles) override {
    for (int64_t& cycle : ready_) cycle += cycles;
    for (int64_t* cycle : {&restart_, &pipes_free_, &last_fp7_, &hint_cycle_, &last_cycle_})
      *cycle += cycles;
  }

  uint32_t PipeCount() const override { return 2; }

 private:
  bool SameFetchGroup(uint64_t a, uint64_t b) const {
    return a / spu_.fetch_group_bytes == b / spu_.fetch_group_bytes;
  }

  // kPaired: it may go with the one before it, if it is ready.
  Unpaired Pairing(const Instruction& instruction, const SpuClassParameters& op) const {
    if (!started_ || branched_ || last_paired_) return Unpaired::kFirst;
    const bool pipes_fit = last_pipe_ == SpuPipe::kEven && op.pipe == SpuPipe::kOdd;
    if (!rules_.pair_by_order && !SameFetchGroup(last_location_, instruction.location_bytes))
      return pipes_fit ? Unpaired::kAddress : Unpaired::kFirst;
    if (last_never_pairs_ || op.stall_cycles) return Unpaired::kNever;
    return pipes_fit ? Unpaired::kPaired : Unpaired::kPipe;
  }

  int64_t EarliestCycle(Unpaired pairing) const {
    if (!started_) return 0;
    return pairing == Unpaired::kPaired ? last_cycle_ : last_cycle_ + 1;
  }

  // Both would end in the same cycle, so only the very next one is held.
  void WaitAfterFp7(IssueSlot& slot, const Instruction& instruction) const {
    if (SpuClass(instruction.op_class) == SpuClass::kFp6 && slot.cycle == last_fp7_ + 1)
      slot.WaitUntil(slot.cycle + spu_.fp6_after_fp7_cycles, StallCause::kAfterFp7);
  }

  // The front end has seen the hint and fetches its target: the branch waits for that.
  void WaitForHintTarget(IssueSlot& slot) const {
    if (rules_.branches_hinted || since_hint_ < spu_.hint_reach_instructions) return;
    slot.WaitUntil(hint_cycle_ + spu_.hint_lead_cycles, StallCause::kHintTarget);
  }

  void WaitForRegisters(IssueSlot& slot, const Instruction& instruction) const {
    uint32_t latest = kNoRegister;
    for (const uint32_t reg : instruction.reads)
      if (latest == kNoRegister || ready_[reg] > ready_[latest]) latest = reg;
    if (latest != kNoRegister) slot.WaitUntil(ready_[latest], StallCause::kRegister, latest);
  }

  void Remember(const Instruction& instruction, const SpuClassParameters& op, const IssueSlot& slot,
                uint32_t index, bool taken) {
    started_ = true;
    last_cycle_ = slot.cycle;
    last_location_ = instruction.location_bytes;
    for (const uint32_t reg : instruction.writes) ready_[reg] = slot.cycle + op.latency_cycles;
    if (op.stall_cycles) pipes_free_ = slot.cycle + 1 + op.stall_cycles;
    if (SpuClass(instruction.op_class) == SpuClass::kFp7) last_fp7_ = slot.cycle;
    last_pipe_ = op.pipe;
    last_paired_ = slot.unpaired == Unpaired::kPaired;
    last_never_pairs_ = op.stall_cycles > 0;
    branched_ = taken;
    if (IsMispredicted(instruction, index, taken))
      restart_ = slot.cycle + 1 + spu_.mispredict_cycles;
    since_hint_ = std::min<uint32_t>(since_hint_ + 1, spu_.hint_reach_instructions);
    if (instruction.flow == Flow::kHint) {
      since_hint_ = 0;
      hint_cycle_ = slot.cycle;
      hinted_ = instruction.hinted;
      hint_target_ = instruction.target;
    }
  }

  static bool Branches(const Instruction& instruction) {
    return instruction.flow == Flow::kConditional || instruction.flow == Flow::kAlways;
  }

  bool IsMispredicted(const Instruction& instruction, uint32_t index, bool taken) const {
    if (!Branches(instruction) || rules_.branches_hinted) return false;
    const bool hint_holds = hinted_ == index && since_hint_ >= spu_.hint_reach_instructions;
    const bool right_target = hint_target_ == kNoTarget || hint_target_ == instruction.target;
    return taken ? !(hint_holds && right_target) : hint_holds;
  }

  const SpuRules rules_;
  const SpuParameters& spu_;
  std::vector<int64_t> ready_;  // cycle from which a register can be read
  bool started_ = false;
  int64_t last_cycle_ = 0;
  uint64_t last_location_ = 0;
  SpuPipe last_pipe_ = SpuPipe::kEven;
  bool last_paired_ = false, last_never_pairs_ = false, branched_ = false;
  int64_t restart_ = 0;     // of the front end, behind a mispredicted branch
  int64_t pipes_free_ = 0;  // behind double precision
  int64_t last_fp7_ = kLongAgo, hint_cycle_ = kLongAgo;
  uint32_t hinted_ = kNoTarget, hint_target_ = kNoTarget;
  uint32_t since_hint_ = 0;  // instructions; no more are counted than a hint needs to reach
};

}  // namespace

Result<IssueChart> TimeOnSpu(Program program, std::span<const TripCount> trips,
                             const SpuRules& rules, const SpuParameters& spu) {
  std::string error;
  if (!CheckProgram(program, kSpuClassCount, error)) return Failure{error};
  IssueChart chart;
  chart.pipes = {"even pipe", "odd pipe"};
  SpuIssue model(program, rules, spu);
  if (!RunWalk(program, trips, model, chart, error)) return Failure{error};
  // A recorder's values may be more than there are registers; all count.
  chart.live = {{"SPU", MostLiveRegisters(program, 0, RegisterEnd(program)), spu.register_count}};
  return chart;
}

}  // namespace pelt
