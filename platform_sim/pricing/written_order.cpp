#include "platform_sim/pricing/written_order.hpp"

#include <algorithm>
#include <map>

#include "platform_sim/pricing/recorder.hpp"

namespace pelt {
namespace {

constexpr uint32_t kNever = 0xFFFFFFFF;

bool IsConstant(const RecordedOperation& operation) {
  return operation.kind == RecordedKind::kSplat || operation.kind == RecordedKind::kIota;
}

class WrittenOrder {
 public:
  explicit WrittenOrder(const Trace& trace)
      : old_(trace.operations),
        maker_(trace.value_count),
        renamed_(trace.value_count, kNoValue),
        last_reader_(trace.operations.size(), kNever),
        is_placed_(trace.operations.size()) {}

  Trace Take() {
    FindReaders();
    std::vector<uint32_t> kept;
    for (uint32_t o = 0; o < old_.size(); ++o)
      if (IsNeeded(o) && !IsConstant(old_[o])) kept.push_back(o);
    // Each stretch, from the last: where it begins.
    std::vector<size_t> begins;
    for (size_t end = kept.size(); end > 0; end = begins.back()) begins.push_back(Begin(kept, end));
    size_t end = 0;
    for (size_t s = begins.size(); s-- > 0;) {
      end = s > 0 ? begins[s - 1] : kept.size();
      Walk(kept[end - 1], kept[begins[s]]);
    }
    return std::move(new_);
  }

 private:
  struct Visit {
    uint32_t operation, next_operand;
  };

  bool IsNeeded(uint32_t o) const { return HasEffect(old_[o].kind) || last_reader_[o] != kNever; }

  template <class Function>
  void ForMakers(uint32_t o, Function visit) const {
    for (uint32_t i = 0; i < old_[o].operand_count; ++i)
      if (old_[o].operand[i] != kNoValue) visit(maker_[old_[o].operand[i]]);
  }

  void FindReaders() {
    for (uint32_t o = 0; o < old_.size(); ++o)
      for (uint32_t r = 0; r < old_[o].result_count; ++r) maker_[old_[o].result + r] = o;
    for (auto o = uint32_t(old_.size()); o-- > 0;)
      if (IsNeeded(o))
        ForMakers(o, [&](uint32_t maker) {
          if (last_reader_[maker] == kNever) last_reader_[maker] = o;
        });
  }

  // Of the stretch that ends before kept[end].
  size_t Begin(const std::vector<uint32_t>& kept, size_t end) const {
    const uint32_t root = kept[end - 1];
    size_t begin = end - 1;
    while (begin > 0 && !HasEffect(old_[kept[begin - 1]].kind) &&
           last_reader_[kept[begin - 1]] <= root)
      --begin;
    return begin;
  }

  // `root` and what it needs from `first` on, operands first.
  void Walk(uint32_t root, uint32_t first) {
    visits_.push_back({root, 0});
    while (!visits_.empty()) {
      const uint32_t o = visits_.back().operation;
      const uint32_t next = visits_.back().next_operand++;
      if (next == old_[o].operand_count) {
        visits_.pop_back();
        Append(o);
        continue;
      }
      const uint32_t value = old_[o].operand[next];
      if (value == kNoValue) continue;
      const uint32_t maker = maker_[value];
      if (maker >= first && !is_placed_[maker] && !IsConstant(old_[maker]))
        visits_.push_back({maker, 0});
    }
  }

  // With the constants that it is the first to read.
  void Append(uint32_t o) {
    if (is_placed_[o]) return;
    ForMakers(o, [&](uint32_t maker) {
      if (IsConstant(old_[maker])) Append(maker);
    });
    is_placed_[o] = true;
    RecordedOperation operation = old_[o];
    for (uint32_t i = 0; i < operation.operand_count; ++i)
      if (operation.operand[i] != kNoValue) operation.operand[i] = renamed_[operation.operand[i]];
    for (uint32_t r = 0; r < operation.result_count; ++r)
      renamed_[operation.result + r] = new_.value_count + r;
    if (operation.result_count) operation.result = new_.value_count;
    new_.value_count += operation.result_count;
    operation.address = PlaceOf(operation);
    new_.operations.push_back(operation);
  }

  // Constants and temporaries lie in the order in which they are first touched; blocks stay.
  int32_t PlaceOf(const RecordedOperation& operation) {
    if (operation.kind == RecordedKind::kSplat) return int32_t{16} * splat_count_++;
    if (!IsLoad(operation.kind) && !IsStore(operation.kind)) return operation.address;
    const int32_t past = operation.address - Recorder::kTemporaries;
    if (operation.address >= Recorder::kBlocks || past < 0) return operation.address;
    const auto next = int32_t(lines_.size());
    const int32_t line = lines_.try_emplace(past / Recorder::kLineBytes, next).first->second;
    return Recorder::kTemporaries + line * Recorder::kLineBytes + past % Recorder::kLineBytes;
  }

  const std::vector<RecordedOperation>& old_;
  std::vector<uint32_t> maker_;        // of each old value
  std::vector<uint32_t> renamed_;      // old values to new ones
  std::vector<uint32_t> last_reader_;  // of each old operation
  std::vector<bool> is_placed_;
  std::vector<Visit> visits_;
  std::map<int32_t, int32_t> lines_;  // of temporaries, old to new
  int32_t splat_count_ = 0;
  Trace new_;
};

}  // namespace

Trace InWrittenOrder(const Trace& trace) { return WrittenOrder(trace).Take(); }

}  // namespace pelt
