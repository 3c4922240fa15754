#include <algorithm>
#include <map>

#include "core/format.hpp"
#include "platform_sim/schedule/schedule.hpp"

namespace pelt {
namespace {

constexpr uint32_t kNoReader = 0xFFFFFFFF;  // no further reader
constexpr uint32_t kNowhere = 0xFFFFFFFF;
constexpr int32_t kSlotStrideBytes = 16;

// One pass over the program; `values` are those of the code that comes in.
class Fitting {
 public:
  Fitting(const StraightCode& code, const SchedulingCore& core)
      : in_(code), core_(core), uses_(code), state_(code.value_count()) {
    FindRemakeable();
  }

  Result<FittedCode> Run() {
    out_.code.file = in_.file;
    out_.code.program.reserve(in_.program.size());
    next_slot_ = FirstFreeAddress();
    PlaceEntryValues();
    for (uint32_t i = 0; i < in_.program.size(); ++i)
      if (!Fit(i)) return Failure{Format("instruction {}: {}", i, why_)};
    out_.code.EndBranches();
    return std::move(out_);
  }

 private:
  struct ValueState {
    uint32_t name = kNowhere;   // the value in out_ that now holds it in a register
    uint32_t place = 0;         // in resident_ of its file, if it has a name
    uint32_t readers_done = 0;  // of ReadersOf
    int64_t slot = -1;          // address; -1: not stored yet
    bool is_remakeable = false;
    bool is_kept = false;  // what is made again reads it: it stays behind its last reader
  };

  // What can be made again at any of its readers: a constant of the instruction, a load whose bytes
  // are not written before the last of them, and one step on such a load and constants.
  void FindRemakeable() {
    std::vector<uint32_t> written_at = FirstStoresOver();
    for (const Instruction& instruction : in_.program) {
      if (instruction.writes.count != 1 || instruction.flow != Flow::kNext ||
          instruction.address.is_store)
        continue;
      const uint32_t value = instruction.writes.number[0];
      if (uses_.ReadersOf(value).empty() || !FileOf(value).spills) continue;
      const uint32_t last = uses_.ReadersOf(value).back();
      uint32_t until = written_at[uses_.WriterOf(value)];
      bool good = instruction.reads.count == 0;
      if (instruction.reads.count > 0 && instruction.address.size_bytes == 0) {
        const uint32_t* const source = SourceOf(instruction);
        good = source != nullptr;
        if (good) until = written_at[uses_.WriterOf(*source)];
      }
      state_[value].is_remakeable = good && last < until;
      if (!state_[value].is_remakeable) continue;
      for (const uint32_t operand : instruction.reads)
        state_[operand].is_kept |= uses_.WriterOf(operand) == kNoTarget;
    }
  }

  // The one operand that is loaded, if all others are there when the code begins.
  const uint32_t* SourceOf(const Instruction& instruction) const {
    const uint32_t* source = nullptr;
    for (const uint32_t& value : instruction.reads) {
      const uint32_t writer = uses_.WriterOf(value);
      if (writer == kNoTarget) continue;
      const Instruction& by = in_.program[writer];
      const bool is_load = by.reads.count == 0 && by.writes.count == 1 && by.address.size_bytes;
      if (!is_load || (source && *source != value)) return nullptr;
      source = &value;
    }
    return source;
  }

  // Of each load: the first store behind it to one of its bytes.
  std::vector<uint32_t> FirstStoresOver() const {
    std::vector<uint32_t> out(in_.program.size(), kNoReader);
    std::multimap<int64_t, uint32_t> loads;  // by address, not written yet
    uint32_t most_bytes = 0;
    for (uint32_t i = 0; i < in_.program.size(); ++i) {
      const AddressOperand& address = in_.program[i].address;
      if (address.size_bytes == 0) continue;
      const int64_t begin = address.displacement_bytes, end = begin + address.size_bytes;
      if (!address.is_store) {
        loads.emplace(begin, i);
        most_bytes = std::max(most_bytes, address.size_bytes);
        continue;
      }
      auto at = loads.upper_bound(begin - int64_t{most_bytes});
      while (at != loads.end() && at->first < end) {
        const bool overlaps = at->first + in_.program[at->second].address.size_bytes > begin;
        if (overlaps) out[at->second] = i;
        at = overlaps ? loads.erase(at) : next(at);
      }
    }
    return out;
  }

  // Slots lie behind all that the program addresses.
  int64_t FirstFreeAddress() const {
    int64_t end = 0;
    for (const Instruction& instruction : in_.program)
      end = std::max(
          end, int64_t{instruction.address.displacement_bytes} + instruction.address.size_bytes);
    return (end + kSlotStrideBytes - 1) / kSlotStrideBytes * kSlotStrideBytes;
  }

  std::vector<uint32_t>& ResidentsOf(uint32_t value) {
    return resident_[uint32_t(in_.file[value])];
  }
  const SchedulingCore::File& FileOf(uint32_t value) const { return core_.Of(in_.file[value]); }

  uint32_t NextReader(uint32_t value) const {
    const auto readers = uses_.ReadersOf(value);
    const uint32_t done = state_[value].readers_done;
    return done < readers.size() ? readers[done] : kNoReader;
  }

  void Settle(uint32_t value, uint32_t name) {
    std::vector<uint32_t>& residents = ResidentsOf(value);
    state_[value].name = name;
    state_[value].place = uint32_t(residents.size());
    residents.push_back(value);
  }

  void Leave(uint32_t value) {
    std::vector<uint32_t>& residents = ResidentsOf(value);
    const uint32_t place = state_[value].place;
    residents[place] = residents.back();
    state_[residents[place]].place = place;
    residents.pop_back();
    state_[value].name = kNowhere;
  }

  // Those that are read first come in registers, as far as there are any.
  void PlaceEntryValues() {
    std::vector<uint32_t> values;
    for (uint32_t v = 0; v < in_.value_count(); ++v)
      if (uses_.WriterOf(v) == kNoTarget && NextReader(v) != kNoReader) values.push_back(v);
    std::ranges::stable_sort(
        values, {}, [&](uint32_t v) { return std::pair(!state_[v].is_kept, NextReader(v)); });
    for (const uint32_t v : values) {
      if (ResidentsOf(v).size() < FileOf(v).count) {
        Settle(v, v);
        continue;
      }
      TakeSlot(v);
      out_.in_memory.push_back({.value = v, .slot_address = int32_t(state_[v].slot)});
    }
  }

  void TakeSlot(uint32_t value) {
    state_[value].slot = next_slot_;
    next_slot_ += kSlotStrideBytes;
  }

  bool Fit(uint32_t i) {
    Instruction instruction = in_.program[i];
    for (const uint32_t value : instruction.reads)
      if (state_[value].name == kNowhere && (!MakeRoom(value, i, {}) || !BringBack(value)))
        return false;
    for (uint32_t& value : std::span(instruction.reads.number).first(instruction.reads.count))
      value = state_[value].name;
    const Instruction& original = in_.program[i];
    for (const uint32_t value : original.reads) {
      if (NextReader(value) != i) continue;  // reads it twice
      ++state_[value].readers_done;
      if (NextReader(value) == kNoReader && !state_[value].is_kept) Leave(value);
    }
    for (uint32_t w = 0; w < original.writes.count; ++w) {
      const uint32_t value = original.writes.number[w];
      if (!MakeRoom(value, i, std::span(original.writes.number).first(w))) return false;
      Settle(value, value);
    }
    for (const uint32_t value : original.writes)
      if (NextReader(value) == kNoReader) Leave(value);
    Emit(instruction, i);
    return true;
  }

  // A register for `value`, not one of `kept` nor of what instruction `i` still has to read.
  bool MakeRoom(uint32_t value, uint32_t i, std::span<const uint32_t> kept) {
    const std::vector<uint32_t>& residents = ResidentsOf(value);
    if (residents.size() < FileOf(value).count) return true;
    uint32_t victim = kNowhere, farthest = 0;
    for (const uint32_t v : residents) {
      const uint32_t reader = NextReader(v);
      if (reader == i || state_[v].is_kept || std::ranges::find(kept, v) != kept.end()) continue;
      if (victim != kNowhere && (reader < farthest || (reader == farthest && v > victim))) continue;
      victim = v;
      farthest = reader;
    }
    if (victim == kNowhere) return Refuse("needs more registers than the core has");
    if (!FileOf(value).spills)
      return Refuse("more values are live than registers, of a kind that the core cannot store");
    if (!state_[victim].is_remakeable) return Store(victim);
    Leave(victim);
    return true;
  }

  bool BringBack(uint32_t value) {
    return state_[value].is_remakeable ? MakeAgain(value) : Load(value);
  }

  // What it loads takes the register that is then its own.
  bool MakeAgain(uint32_t value) {
    Instruction made = in_.program[uses_.WriterOf(value)];
    uint32_t loaded = kNowhere, source = kNowhere;
    if (const uint32_t* const from = SourceOf(made)) {
      source = *from;
      Instruction load = in_.program[uses_.WriterOf(source)];
      loaded = NewName(source);
      load.writes.number[0] = loaded;
      Emit(load, uses_.WriterOf(source));
      ++out_.made_again;
    }
    for (uint32_t& operand : std::span(made.reads.number).first(made.reads.count))
      operand = operand == source ? loaded : state_[operand].name;
    const uint32_t name = NewName(value);
    made.writes.number[0] = name;
    Settle(value, name);
    Emit(made, uses_.WriterOf(value));
    ++out_.made_again;
    return true;
  }

  uint32_t NewName(uint32_t value) {
    out_.code.file.push_back(in_.file[value]);
    return out_.code.value_count() - 1;
  }

  bool Store(uint32_t value) {
    if (state_[value].slot < 0) {
      TakeSlot(value);
      if (next_slot_ > INT32_MAX) return Refuse("no addresses left for spill slots");
      Instruction store = Access(value, FileOf(value).store_class, true);
      store.reads.Add(state_[value].name);
      Emit(store, kSpillStore);
      ++out_.spill_stores;
    }
    Leave(value);
    return true;
  }

  bool Load(uint32_t value) {
    if (next_slot_ > INT32_MAX) return Refuse("no addresses left for spill slots");
    const uint32_t name = NewName(value);
    Settle(value, name);
    Instruction load = Access(value, FileOf(value).load_class, false);
    load.writes.Add(name);
    Emit(load, kSpillLoad);
    ++out_.spill_loads;
    return true;
  }

  Instruction Access(uint32_t value, uint8_t op_class, bool is_store) const {
    Instruction out;
    out.op_class = op_class;
    out.address = {.displacement_bytes = int32_t(state_[value].slot),
                   .size_bytes = FileOf(value).slot_bytes,
                   .is_store = is_store};
    return out;
  }

  void Emit(const Instruction& instruction, uint32_t origin) {
    out_.code.program.push_back(instruction);
    out_.origin.push_back(origin);
  }

  bool Refuse(const char* why) {
    why_ = why;
    return false;
  }

  const StraightCode& in_;
  const SchedulingCore& core_;
  const ValueUses uses_;
  std::vector<ValueState> state_;
  std::array<std::vector<uint32_t>, kValueFileCount> resident_;  // values in registers, by file
  int64_t next_slot_ = 0;
  const char* why_ = "";
  FittedCode out_;
};

}  // namespace

Result<FittedCode> FitRegisters(const StraightCode& code, const SchedulingCore& core) {
  std::string error;
  if (!CheckStraightCode(code, uint32_t(core.classes.size()), error)) return Failure{error};
  return Fitting(code, core).Run();
}

}  // namespace pelt
