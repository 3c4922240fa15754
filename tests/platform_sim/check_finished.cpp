#include "tests/platform_sim/check_finished.hpp"

#include <algorithm>
#include <map>

#include "core/format.hpp"

namespace pelt {
namespace {

constexpr uint32_t kNone = 0xFFFFFFFF;

// Of one access: for each byte the store that it finds there.
using FoundStores = std::vector<uint32_t>;

// The last store of each byte.
class SymbolicMemory {
 public:
  FoundStores Access(uint32_t instruction, const AddressOperand& address) {
    FoundStores found;
    for (uint32_t b = 0; b < address.size_bytes; ++b) {
      uint32_t& last =
          last_.try_emplace(address.displacement_bytes + int64_t{b}, kNone).first->second;
      found.push_back(last);
      if (address.is_store) last = instruction;
    }
    return found;
  }
  bool Holds(const AddressOperand& address) const {
    const auto at = last_.lower_bound(address.displacement_bytes);
    return at != last_.end() &&
           at->first < address.displacement_bytes + int64_t{address.size_bytes};
  }

 private:
  std::map<int64_t, uint32_t> last_;
};

class Check {
 public:
  Check(const StraightCode& code, const FinishedCode& finished, const SchedulingCore& core)
      : code_(code), finished_(finished), core_(core), times_run_(code.program.size(), 0) {}

  bool Run(std::string& error) {
    for (uint32_t i = 0; i < code_.program.size(); ++i) {
      const Instruction& instruction = code_.program[i];
      expected_.push_back(memory_as_written_.Access(i, instruction.address));
      branches_before_.push_back(i == 0 ? 0 : branches_before_[i - 1]);
      if (i > 0) branches_before_[i] += code_.program[i - 1].flow == Flow::kConditional;
    }
    bool good = finished_.origin.size() == finished_.program.size() || Fail("no origin");
    good = good && Enter();
    for (at_ = 0; good && at_ < finished_.program.size(); ++at_) good = Step();
    good = good && CheckTotals();
    if (!good) error = Format("instruction {}: {}", at_, why_);
    return good;
  }

 private:
  bool Fail(std::string why) {
    why_ = std::move(why);
    return false;
  }

  bool Enter() {
    for (const EntryValue& value : finished_.entry) {
      if (value.value >= code_.value_count()) return Fail("a value that is none comes in");
      if (value.reg == kNoRegister)
        slots_[value.slot_address] = value.value;
      else if (!Write(value.reg, value.value))
        return false;
    }
    return true;
  }

  bool Write(uint32_t reg, uint32_t value) {
    const SchedulingCore::File& file = core_.Of(code_.file[value]);
    if (reg < file.first || reg - file.first >= file.count)
      return Fail(Format("register {} is none of those of value {}", reg, value));
    registers_[reg] = value;
    return true;
  }

  // kNone: nothing.
  uint32_t ValueIn(uint32_t reg) const {
    const auto at = registers_.find(reg);
    return at == registers_.end() ? kNone : at->second;
  }

  bool Step() {
    const Instruction& now = finished_.program[at_];
    if (now.location_bytes != uint64_t{at_} * core_.instruction_bytes)
      return Fail("it does not lie behind the one before it");
    switch (finished_.origin[at_]) {
      case kPadding:
        return StepPadding(now);
      case kSpillStore:
        return StepSpillStore(now);
      case kSpillLoad:
        return StepSpillLoad(now);
      default:
        return StepOriginal(now, finished_.origin[at_]);
    }
  }

  bool StepPadding(const Instruction& now) {
    ++padding_;
    const bool is_one =
        core_.fetch_groups && (now.op_class == core_.fetch_groups->first_padding_class ||
                               now.op_class == core_.fetch_groups->second_padding_class);
    return (is_one && now.reads.count == 0 && now.writes.count == 0) || Fail("not a padding");
  }

  bool StepSpillStore(const Instruction& now) {
    ++spill_stores_;
    if (now.reads.count != 1 || now.writes.count != 0 || !now.address.is_store)
      return Fail("not a spill store");
    const uint32_t value = ValueIn(now.reads.number[0]);
    if (value == kNone) return Fail("stores a register that holds nothing");
    if (now.op_class != core_.Of(code_.file[value]).store_class) return Fail("not its store");
    if (memory_as_written_.Holds(now.address)) return Fail("a slot in the program's own memory");
    const auto [slot, is_new] = slots_.try_emplace(now.address.displacement_bytes, value);
    return is_new || Fail("a slot is stored to twice");
  }

  bool StepSpillLoad(const Instruction& now) {
    ++spill_loads_;
    if (now.reads.count != 0 || now.writes.count != 1 || now.address.is_store)
      return Fail("not a spill load");
    const auto slot = slots_.find(now.address.displacement_bytes);
    if (slot == slots_.end()) return Fail("loads a slot that holds nothing");
    if (now.op_class != core_.Of(code_.file[slot->second]).load_class) return Fail("not its load");
    return Write(now.writes.number[0], slot->second);
  }

  bool StepOriginal(const Instruction& now, uint32_t origin) {
    if (origin >= code_.program.size()) return Fail("comes from nowhere");
    const Instruction& before = code_.program[origin];
    if (times_run_[origin]++) {
      ++made_again_;
      if (before.address.is_store || before.flow != Flow::kNext)
        return Fail(Format("instruction {} a second time", origin));
    }
    if (now.op_class != before.op_class || now.flow != before.flow ||
        now.reads.count != before.reads.count || now.writes.count != before.writes.count)
      return Fail(Format("is not instruction {}", origin));
    for (uint32_t r = 0; r < now.reads.count; ++r)
      if (ValueIn(now.reads.number[r]) != before.reads.number[r])
        return Fail(Format("operand {} is not value {}", r, before.reads.number[r]));
    for (uint32_t w = 0; w < now.writes.count; ++w)
      if (!Write(now.writes.number[w], before.writes.number[w])) return false;
    for (uint32_t w = 0; w < now.writes.count; ++w)
      if (ValueIn(now.writes.number[w]) != before.writes.number[w])
        return Fail("writes one register twice");
    const AddressOperand &a = now.address, &b = before.address;
    if (a.displacement_bytes != b.displacement_bytes || a.size_bytes != b.size_bytes ||
        a.is_store != b.is_store)
      return Fail("another address");
    if (memory_as_run_.Access(origin, a) != expected_[origin])
      return Fail(Format("instruction {} finds another store's bytes", origin));
    if (now.flow == Flow::kConditional) {
      ++branches_run_;
      if (now.target != finished_.program.size()) return Fail("another target");
    }
    if (a.is_store && branches_run_ < branches_before_[origin])
      return Fail("a store ahead of a branch");
    return true;
  }

  bool CheckTotals() {
    for (size_t i = 0; i < times_run_.size(); ++i)
      if (times_run_[i] == 0) return Fail(Format("instruction {} is missing", i));
    if (spill_stores_ != finished_.spill_stores || spill_loads_ != finished_.spill_loads ||
        made_again_ != finished_.made_again || padding_ != finished_.padding)
      return Fail("counts that are not right");
    return finished_.most_live_vectors <= core_.Of(ValueFile::kVector).count ||
           Fail("more live vectors than registers");
  }

  const StraightCode& code_;
  const FinishedCode& finished_;
  const SchedulingCore& core_;
  SymbolicMemory memory_as_written_, memory_as_run_;
  std::vector<FoundStores> expected_;  // of each instruction of the straight code
  std::vector<uint32_t> branches_before_, times_run_;
  std::map<uint32_t, uint32_t> registers_;  // the value in each
  std::map<int64_t, uint32_t> slots_;
  uint32_t branches_run_ = 0, spill_stores_ = 0, spill_loads_ = 0, padding_ = 0;
  uint32_t made_again_ = 0, at_ = 0;
  std::string why_;
};

}  // namespace

bool CheckFinishedCode(const StraightCode& code, const FinishedCode& finished,
                       const SchedulingCore& core, std::string& error) {
  return Check(code, finished, core).Run(error);
}

}  // namespace pelt
