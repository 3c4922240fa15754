#include "platform_sim/schedule/register_guard.hpp"

#include <algorithm>
#include <utility>

namespace pelt {

void PressureProfile::Resize(size_t gaps) {
  const size_t blocks = (gaps + kBlock - 1) / kBlock;
  gap_.assign(blocks * kBlock, 0);
  whole_.assign(blocks, 0);
  max_.assign(blocks, 0);
}

void PressureProfile::Add(uint32_t first, uint32_t last, int32_t change) {
  for (uint32_t block = first / kBlock; block <= last / kBlock; ++block) {
    const uint32_t begin = std::max(first, block * kBlock);
    const uint32_t end = std::min(last + 1, (block + 1) * kBlock);
    if (end - begin == kBlock) {
      whole_[block] = int16_t(whole_[block] + change);
      max_[block] = int16_t(max_[block] + change);
      continue;
    }
    for (uint32_t gap = begin; gap < end; ++gap) gap_[gap] = int16_t(gap_[gap] + change);
    const int16_t* of_block = &gap_[size_t{block} * kBlock];
    int16_t most = of_block[0];
    for (uint32_t i = 0; i < kBlock; ++i) most = std::max(most, of_block[i]);
    max_[block] = int16_t(whole_[block] + most);
  }
}

uint32_t PressureProfile::FirstAbove(int32_t limit, uint32_t first, uint32_t last) const {
  for (uint32_t block = first / kBlock; block <= last / kBlock; ++block) {
    if (max_[block] <= limit) continue;
    const uint32_t end = std::min(last + 1, (block + 1) * kBlock);
    for (uint32_t gap = std::max(first, block * kBlock); gap < end; ++gap)
      if (At(gap) > limit) return gap;
  }
  return last + 1;
}

RegisterGuard::RegisterGuard(const StraightCode& code, const ValueUses& uses,
                             const SchedulingCore& core)
    : code_(code),
      uses_(uses),
      core_(core),
      readers_left_(code.value_count()),
      has_issued_(code.program.size()) {
  for (uint32_t f = 0; f < kValueFileCount; ++f)
    pressure_[f].Resize(core.files[f].count ? code.program.size() + 1 : 0);
  for (uint32_t v = 0; v < code.value_count(); ++v) {
    const auto readers = uses.ReadersOf(v);
    const uint32_t writer = uses.WriterOf(v);
    readers_left_[v] = uint32_t(readers.size());
    if (writer == kNoTarget && readers.empty()) continue;
    const uint32_t first = writer == kNoTarget ? 0 : writer + 1;
    pressure_[uint32_t(code.file[v])].Add(first, readers.empty() ? first : readers.back(), 1);
  }
}

uint32_t RegisterGuard::ReaderBefore(uint32_t value, uint32_t instruction) const {
  const std::span<const uint32_t> readers = uses_.ReadersOf(value);
  for (uint32_t r = readers_left_[value]; r-- > 0;)
    if (readers[r] != instruction && !has_issued_[readers[r]]) return readers[r];
  return kNoInstruction;
}

bool RegisterGuard::IsLastReader(uint32_t value, uint32_t instruction) const {
  return uses_.ReadersOf(value)[readers_left_[value] - 1] == instruction;
}

// What it writes is live from the head on; what it frees makes up for that behind each freed
// value's new last reader, one for one.
bool RegisterGuard::Fits(uint32_t instruction) const {
  if (instruction == head_) return true;
  const Instruction& it = code_.program[instruction];
  for (uint32_t f = 0; f < kValueFileCount; ++f) {
    int32_t written = 0;
    for (const uint32_t value : it.writes) written += uint32_t(code_.file[value]) == f;
    if (written == 0) continue;
    // Of freed values: the first gap that each is no longer live in, ascending.
    std::array<uint32_t, 5> life_end;
    life_end.fill(instruction + 1);
    for (uint32_t r = 0; r < it.reads.count; ++r) {
      const uint32_t value = it.reads.number[r];
      if (uint32_t(code_.file[value]) != f || !IsLastReader(value, instruction)) continue;
      const auto earlier = std::span(it.reads.number).first(r);
      if (std::ranges::find(earlier, value) != earlier.end()) continue;
      const uint32_t reader = ReaderBefore(value, instruction);
      uint32_t end = reader == kNoInstruction ? head_ : reader + 1;
      for (uint32_t& later : life_end)
        if (end < later) std::swap(end, later);
    }
    const int32_t limit = int32_t(core_.files[f].count);
    const uint32_t tight = tight_gap_[f];
    uint32_t first = head_;
    for (int32_t more = written; more > 0; --more) {
      const uint32_t end = life_end[uint32_t(written - more)];  // of three at most
      if (end <= first) continue;
      if (first <= tight && tight < end && pressure_[f].At(tight) + more > limit) return false;
      const uint32_t above = pressure_[f].FirstAbove(limit - more, first, end - 1);
      if (above < end) {
        tight_gap_[f] = above;
        return false;
      }
      first = end;
    }
  }
  return true;
}

void RegisterGuard::Issue(uint32_t instruction) {
  const Instruction& it = code_.program[instruction];
  has_issued_[instruction] = true;
  for (const uint32_t value : it.reads) {
    uint32_t& left = readers_left_[value];
    // A second mention finds it done.
    if (left == 0 || !IsLastReader(value, instruction)) continue;
    const auto readers = uses_.ReadersOf(value);
    while (left > 0 && has_issued_[readers[left - 1]]) --left;
    const uint32_t life_end = left == 0 ? head_ : readers[left - 1] + 1;
    if (instruction != head_ && life_end <= instruction)
      pressure_[uint32_t(code_.file[value])].Add(life_end, instruction, -1);
  }
  for (const uint32_t value : it.writes) {
    if (instruction == head_) continue;
    PressureProfile& pressure = pressure_[uint32_t(code_.file[value])];
    if (readers_left_[value] == 0)
      pressure.Add(instruction + 1, instruction + 1, -1);  // nobody reads it: gone at once
    else
      pressure.Add(head_, instruction, 1);
  }
  while (head_ < code_.program.size() && has_issued_[head_]) ++head_;
}

}  // namespace pelt
