#include <algorithm>
#include <map>

#include "platform_sim/pricing/recorder.hpp"
#include "platform_sim/pricing/trace.hpp"

namespace pelt {
namespace {

constexpr uint32_t kNeverRead = 0xFFFFFFFF;

bool IsConstant(const RecordedOperation& operation) {
  return operation.kind == RecordedKind::kSplat || operation.kind == RecordedKind::kIota;
}

// Operations that one operation on several vectors side by side has made (core/kernels/unrolled.hpp), which is one
// node in the source.
class Nodes {
 public:
  explicit Nodes(const Trace& trace)
      : maker_(trace.value_count), first_(trace.operations.size()), end_(trace.operations.size()) {
    for (uint32_t o = 0; o < first_.size(); ++o) {
      const RecordedOperation& operation = trace.operations[o];
      for (uint32_t r = 0; r < operation.result_count; ++r) maker_[operation.result + r] = o;
      first_[o] = operation.is_side ? first_[o - 1] : o;
      end_[first_[o]] = o + 1;
    }
  }

  // The operation that a node begins with, which stands for it; and where the next one begins.
  uint32_t Of(uint32_t operation) const { return first_[operation]; }
  uint32_t End(uint32_t node) const { return end_[node]; }
  uint32_t MakerOf(uint32_t value) const { return maker_[value]; }

 private:
  std::vector<uint32_t> maker_;  // of each value
  std::vector<uint32_t> first_;  // of each operation's node
  std::vector<uint32_t> end_;    // of a node's first operation
};

class WrittenOrder {
 public:
  explicit WrittenOrder(const Trace& trace)
      : old_(trace.operations),
        nodes_(trace),
        renamed_(trace.value_count, kNoValue),
        last_reader_(trace.operations.size(), kNeverRead),
        is_placed_(trace.operations.size()) {}

  Trace Take() {
    FindReaders();
    std::vector<uint32_t> kept;
    for (uint32_t n = 0; n < old_.size(); n = nodes_.End(n))
      if (IsNeeded(n) && !IsConstant(old_[n])) kept.push_back(n);
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
    uint32_t node, next_operand;
  };

  bool IsNeeded(uint32_t n) const {
    return HasEffect(old_[n].kind) || last_reader_[n] != kNeverRead;
  }

  // Of one operation: the nodes that its operands come from.
  template <class Function>
  void ForMakers(uint32_t o, Function visit) const {
    for (uint32_t i = 0; i < old_[o].operand_count; ++i)
      if (const uint32_t value = old_[o].operand[i]; value != kNoValue)
        visit(nodes_.Of(nodes_.MakerOf(value)));
  }

  void FindReaders() {
    for (auto o = uint32_t(old_.size()); o-- > 0;)
      if (const uint32_t node = nodes_.Of(o); IsNeeded(node))
        ForMakers(o, [&](uint32_t maker) {
          if (last_reader_[maker] == kNeverRead) last_reader_[maker] = node;
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

  // `root` and what it needs from `first` on, operands first: of a node the first ones of all its operations, then the
  // second ones.
  void Walk(uint32_t root, uint32_t first) {
    visits_.push_back({root, 0});
    while (!visits_.empty()) {
      const uint32_t n = visits_.back().node;
      const uint32_t next = visits_.back().next_operand++, sides = nodes_.End(n) - n;
      if (next == old_[n].operand_count * sides) {
        visits_.pop_back();
        Append(n);
        continue;
      }
      const uint32_t value = old_[n + next % sides].operand[next / sides];
      if (value == kNoValue) continue;
      const uint32_t maker = nodes_.Of(nodes_.MakerOf(value));
      if (maker >= first && !is_placed_[maker] && !IsConstant(old_[maker]))
        visits_.push_back({maker, 0});
    }
  }

  // With the constants that it is the first to read.
  void Append(uint32_t n) {
    if (is_placed_[n]) return;
    is_placed_[n] = true;
    const uint32_t end = nodes_.End(n);
    for (uint32_t o = n; o < end; ++o)
      ForMakers(o, [&](uint32_t maker) {
        if (IsConstant(old_[maker])) Append(maker);
      });
    for (uint32_t o = n; o < end; ++o) AppendOne(old_[o]);
  }

  void AppendOne(RecordedOperation operation) {
    const uint32_t result = operation.result;
    for (uint32_t i = 0; i < operation.operand_count; ++i)
      if (operation.operand[i] != kNoValue) operation.operand[i] = renamed_[operation.operand[i]];
    for (uint32_t r = 0; r < operation.result_count; ++r)
      renamed_[result + r] = new_.value_count + r;
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
  const Nodes nodes_;
  std::vector<uint32_t> renamed_;      // old values to new ones
  std::vector<uint32_t> last_reader_;  // of each node
  std::vector<bool> is_placed_;
  std::vector<Visit> visits_;
  std::map<int32_t, int32_t> lines_;  // of temporaries, old to new
  int32_t splat_count_ = 0;
  Trace new_;
};

}  // namespace

Trace InWrittenOrder(const Trace& trace) { return WrittenOrder(trace).Take(); }

}  // namespace pelt
