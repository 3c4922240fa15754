#include "platform_sim/pipeline/ppe_thread.hpp"

#include <algorithm>
#include <bit>

namespace pelt {

IssueSlot PpeThread::ProposeAlone(const Instruction& instruction, uint32_t index,
                                  const PpeUnits& units) const {
  const PpeClassParameters& op = ppe_.classes[instruction.op_class];
  const Unpaired pairing = Pairing(op);
  IssueSlot slot{index, 0, uint8_t(std::countr_zero(op.units)), pairing};
  slot.cycle = FirstCycle(pairing);
  slot.WaitUntil(restart_, StallCause::kBranch);
  for (uint32_t u = 0; u < kPpeUnitCount; ++u)
    if (op.units >> u & 1) slot.WaitUntil(units.free_at[u], StallCause::kBlocked);
  WaitForRegisters(slot, instruction);
  WaitForStores(slot, instruction.address);
  return slot;
}

void PpeThread::Commit(const Instruction& instruction, const IssueSlot& slot, bool taken,
                       PpeUnits& units) {
  const PpeClassParameters& op = ppe_.classes[instruction.op_class];
  const bool same_cycle = started_ && slot.cycle == last_cycle_;
  used_units_ = uint8_t(op.units | (same_cycle ? used_units_ : 0));
  in_last_cycle_ = 1 + (same_cycle ? in_last_cycle_ : 0);
  group_ended_ = op.blocks_units != 0 || PpeClass(instruction.op_class) == PpeClass::kBranch;
  started_ = true;
  last_cycle_ = slot.cycle;
  for (uint32_t u = 0; u < kPpeUnitCount; ++u)
    if (op.blocks_units >> u & 1) units.free_at[u] = slot.cycle + op.latency_cycles;
  for (const uint32_t reg : instruction.writes) Write(instruction, op, slot.cycle, reg);
  if (instruction.address.is_store) RememberStore(instruction, slot.cycle);
  if (instruction.flow == Flow::kConditional && instruction.target <= slot.instruction && !taken)
    restart_ = slot.cycle + 1 + ppe_.mispredict_cycles;
}

void PpeThread::AppendState(int64_t now, std::vector<int64_t>& state) const {
  const auto until = [&](int64_t cycle) { return std::max<int64_t>(cycle - now, 0); };
  for (const auto& ready : ready_)
    for (const int64_t cycle : ready) state.push_back(until(cycle));
  state.push_back(until(restart_));
  state.push_back(last_cycle_ - now);
  state.push_back(used_units_);
  state.push_back(in_last_cycle_);
  state.push_back(group_ended_);
  for (const PendingStore& store : stores_) {
    const int64_t age = now - store.cycle;
    if (age >= ppe_.load_hit_store_cycles) continue;
    for (const int64_t field :
         {age, int64_t{store.base}, int64_t{store.index}, store.begin, store.end})
      state.push_back(field);
  }
}

void PpeThread::Leap(int64_t cycles) {
  for (auto& ready : ready_)
    for (int64_t& cycle : ready) cycle += cycles;
  for (PendingStore& store : stores_) store.cycle += cycles;
  restart_ += cycles;
  last_cycle_ += cycles;
}

Unpaired PpeThread::Pairing(const PpeClassParameters& op) const {
  if (!started_ || in_last_cycle_ >= ppe_.dispatch_width) return Unpaired::kFirst;
  if (group_ended_) return Unpaired::kNever;
  return used_units_ & op.units ? Unpaired::kPipe : Unpaired::kPaired;
}

bool PpeThread::IsAddress(const Instruction& instruction, uint32_t reg) {
  return reg == instruction.address.base || reg == instruction.address.index;
}

PpeThread::Reader PpeThread::ReaderOf(const Instruction& instruction, uint32_t reg) {
  if (PpeClass(instruction.op_class) == PpeClass::kBranch)
    return instruction.flow == Flow::kEnd ? Reader::kRegisterBranch : Reader::kBranch;
  return IsAddress(instruction, reg) ? Reader::kAddress : Reader::kArithmetic;
}

void PpeThread::WaitForRegisters(IssueSlot& slot, const Instruction& instruction) const {
  uint32_t latest = kNoRegister;
  int64_t cycle = 0;
  for (const uint32_t reg : instruction.reads) {
    const int64_t ready = ready_[reg][uint32_t(ReaderOf(instruction, reg))];
    if (latest != kNoRegister && ready <= cycle) continue;
    latest = reg;
    cycle = ready;
  }
  if (latest != kNoRegister) slot.WaitUntil(cycle, StallCause::kRegister, latest);
}

void PpeThread::WaitForStores(IssueSlot& slot, const AddressOperand& address) const {
  if (address.size_bytes == 0 || address.is_store) return;
  const int64_t begin = address.displacement_bytes, end = begin + address.size_bytes;
  for (const PendingStore& store : stores_)
    if (store.base == address.base && store.index == address.index && store.begin < end &&
        begin < store.end)
      slot.WaitUntil(store.cycle + ppe_.load_hit_store_cycles, StallCause::kLoadHitStore);
}

void PpeThread::Write(const Instruction& instruction, const PpeClassParameters& op, int64_t cycle,
                      uint32_t reg) {
  PpeClass producer = PpeClass(instruction.op_class);
  uint32_t latency = op.latency_cycles;
  if (IsAddress(instruction, reg) && instruction.address.base == reg && IsUpdate(instruction)) {
    producer = PpeClass::kInteger;  // the new address, which the fixed-point unit adds up
    latency = ppe_.Of(producer).latency_cycles;
  }
  for (uint32_t r = 0; r < kReaderCount; ++r)
    ready_[reg][r] = cycle + LatencyInto(producer, latency, Reader(r));
  std::erase_if(stores_,
                [&](const PendingStore& store) { return store.base == reg || store.index == reg; });
}

uint32_t PpeThread::LatencyInto(PpeClass producer, uint32_t latency, Reader reader) const {
  const bool is_load = producer == PpeClass::kLoad || producer == PpeClass::kLoadExtend ||
                       producer == PpeClass::kLoadUpdate;
  if (reader == Reader::kAddress && is_load) return ppe_.load_to_address_cycles;
  if (reader == Reader::kAddress && producer == PpeClass::kInteger)
    return ppe_.integer_to_address_cycles;
  if (reader == Reader::kBranch && producer == PpeClass::kFloatCompare)
    return ppe_.float_compare_to_branch_cycles;
  if (reader == Reader::kRegisterBranch && producer == PpeClass::kMoveToBranch)
    return ppe_.count_to_register_branch_cycles;
  return latency;
}

// A load or store that also writes its base.
bool PpeThread::IsUpdate(const Instruction& instruction) {
  const auto has = [&](const auto& list) {
    return std::ranges::find(list, instruction.address.base) != list.end();
  };
  return instruction.address.base != kNoRegister && has(instruction.reads) &&
         has(instruction.writes) &&
         (PpeClass(instruction.op_class) == PpeClass::kLoadUpdate ||
          PpeClass(instruction.op_class) == PpeClass::kStoreUpdate ||
          instruction.writes.count > (instruction.address.is_store ? 0u : 1u));
}

void PpeThread::RememberStore(const Instruction& instruction, int64_t cycle) {
  const AddressOperand& address = instruction.address;
  std::erase_if(stores_, [&](const PendingStore& store) {
    return cycle - store.cycle >= ppe_.load_hit_store_cycles;
  });
  if (address.size_bytes == 0) return;
  // Behind an update the base is the address itself.
  const bool update = IsUpdate(instruction);
  const int64_t begin = update ? 0 : address.displacement_bytes;
  stores_.push_back({address.base, update ? kNoRegister : address.index, begin,
                     begin + address.size_bytes, cycle});
}

}  // namespace pelt
