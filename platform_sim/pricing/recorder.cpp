#include "platform_sim/pricing/recorder.hpp"

#include <algorithm>

namespace pelt {
namespace {

constexpr int64_t kSpaceEnd = int64_t{0x7FFFFF00};

struct KindFacts {
  std::string_view name;
  uint32_t lane_arithmetic;
};
constexpr KindFacts kFacts[] = {
    {"splat", 0},
    {"iota", 0},
    {"load", 0},
    {"load record", 0},
    {"load bytes", 0},
    {"load splat", 0},
    {"store", 0},
    {"add", 1},
    {"subtract", 1},
    {"multiply", 1},
    {"divide", 1},
    {"negate", 1},
    {"reciprocal root", 16},
    {"reciprocal estimate", 1},
    {"reciprocal root estimate", 1},
    {"min", 1},
    {"max", 1},
    {"less", 1},
    {"less or equal", 1},
    {"equal", 1},
    {"mask and", 1},
    {"mask or", 1},
    {"mask not", 1},
    {"any", 1},
    {"all set", 1},
    {"select", 1},
    {"integer add", 1},
    {"integer subtract", 1},
    {"integer multiply", 1},
    {"and", 1},
    {"or", 1},
    {"xor", 1},
    {"shift left", 1},
    {"shift right", 1},
    {"integer equal", 1},
    {"integer less", 1},
    {"truncate", 1},
    {"to float", 1},
    {"transpose", 0},
    {"splat in fours", 0},
    {"extract", 0},
    {"word load", 0},
    {"word store", 0},
    {"word add", 0},
    {"word subtract", 0},
    {"word and", 0},
    {"word or", 0},
    {"word shift left", 0},
    {"word shift right", 0},
    {"word differs", 0},
    {"multiply-add", 2},
    {"multiply-subtract", 2},
    {"subtract-multiply", 2},
};
static_assert(std::size(kFacts) == kRecordedKindCount);

}  // namespace

std::string_view RecordedKindName(RecordedKind kind) { return kFacts[uint32_t(kind)].name; }
uint32_t LaneArithmetic(RecordedKind kind) { return kFacts[uint32_t(kind)].lane_arithmetic; }

bool Recorder::AddBlock(const void* begin, uint64_t bytes) {
  const auto first = reinterpret_cast<uintptr_t>(begin);
  for (const Block& block : blocks_)
    if (block.begin <= first && first + bytes <= block.end) return true;
  if (blocks_end_ + int64_t(bytes) > kSpaceEnd) return false;
  blocks_.push_back({first, first + uintptr_t(bytes), int32_t(blocks_end_)});
  blocks_end_ = (blocks_end_ + int64_t(bytes) + 127) / 128 * 128;
  return true;
}

int32_t Recorder::PlaceOf(const void* host) {
  const auto at = reinterpret_cast<uintptr_t>(host);
  for (const Block& block : blocks_)
    if (at >= block.begin && at < block.end) return block.place + int32_t(at - block.begin);
  const int32_t next = kTemporaries + int32_t(lines_.size()) * kLineBytes;
  return lines_.try_emplace(at / kLineBytes, next).first->second + int32_t(at % kLineBytes);
}

uint32_t Recorder::Append(RecordedOperation operation, std::initializer_list<uint32_t> operands,
                          uint32_t results) {
  for (const uint32_t value : operands) operation.operand[operation.operand_count++] = value;
  operation.result_count = uint8_t(results);
  if (results) operation.result = trace_.value_count;
  trace_.value_count += results;
  trace_.operations.push_back(operation);
  return operation.result;
}

uint32_t Recorder::Splat(uint32_t bits) {
  if (keep_ == Keep::kCounts) return kNoValue;
  const auto [at, is_new] = splats_.try_emplace(bits, 0);
  if (is_new)
    at->second = Append({.kind = RecordedKind::kSplat,
                         .size_bytes = 16,
                         .address = int32_t(16 * (splats_.size() - 1)),
                         .bits = bits},
                        {}, 1);
  return at->second;
}

uint32_t Recorder::Load(RecordedKind kind, const void* from, uint32_t bytes, uint32_t index) {
  Count(kind);
  if (keep_ == Keep::kCounts) return kNoValue;
  const RecordedOperation load{
      .kind = kind, .size_bytes = uint8_t(bytes), .address = PlaceOf(from)};
  if (index == kNoValue) return Append(load, {}, 1);
  return Append(load, {index}, 1);
}

void Recorder::Store(RecordedKind kind, const void* to, uint32_t bytes, uint32_t value,
                     uint32_t index) {
  Count(kind);
  if (keep_ == Keep::kCounts) return;
  const RecordedOperation store{.kind = kind, .size_bytes = uint8_t(bytes), .address = PlaceOf(to)};
  if (index == kNoValue)
    Append(store, {value}, 0);
  else
    Append(store, {value, index}, 0);
}

void Recorder::SideBySide(uint32_t a, uint32_t b) {
  if (keep_ == Keep::kCounts) return;
  constexpr size_t kMostSides = 4;
  const auto end = trace_.operations.end();
  const auto made = end - std::min(kMostSides, trace_.operations.size());
  for (auto o = made; o != end; ++o)
    if (o != made && o->result == b) o->is_side |= (o - 1)->result == a;
}

uint32_t Recorder::Word(RecordedKind kind, uint32_t bytes, uint32_t a, uint32_t b) {
  Count(kind);
  if (keep_ == Keep::kCounts) return kNoValue;
  return Append({.kind = kind, .size_bytes = uint8_t(bytes)}, {a, b}, 1);
}

}  // namespace pelt
