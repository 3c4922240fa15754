#include "platform_sim/pricing/order_of_need.hpp"

#include <algorithm>
#include <map>
#include <tuple>

#include "platform_sim/pricing/recorder.hpp"

namespace pelt {
namespace {

constexpr uint32_t kNever = 0xFFFFFFFF;

class NeedOrder {
 public:
  explicit NeedOrder(const Trace& trace)
      : old_(trace.operations),
        maker_(trace.value_count),
        renamed_(trace.value_count, kNoValue),
        place_(trace.operations.size()) {}

  Trace Take() {
    FindNeeds();
    FindDepths();
    std::vector<uint32_t> order;
    for (uint32_t o = 0; o < old_.size(); ++o)
      if (place_[o].need != kNever) order.push_back(o);
    std::ranges::sort(order, {}, [&](uint32_t o) {
      return std::tuple(place_[o].stretch, place_[o].depth, place_[o].need);
    });
    for (const uint32_t o : order) Append(old_[o]);
    return std::move(new_);
  }

 private:
  struct Place {
    uint32_t stretch = 0;    // effects before it
    uint32_t depth = 0;      // in its stretch
    uint32_t need = kNever;  // its turn when operands are walked from left to right
  };
  struct Visit {
    uint32_t operation, next_operand;
  };

  void FindNeeds() {
    uint32_t effects = 0;
    for (uint32_t o = 0; o < old_.size(); ++o) {
      for (uint32_t r = 0; r < old_[o].result_count; ++r) maker_[old_[o].result + r] = o;
      place_[o].stretch = effects;
      if (!HasEffect(old_[o].kind)) continue;
      Walk(o);
      ++effects;
    }
  }

  // Numbers an operation and all it needs.
  void Walk(uint32_t wanted) {
    visits_.push_back({wanted, 0});
    while (!visits_.empty()) {
      auto& [o, next] = visits_.back();
      if (next < old_[o].operand_count) {
        const uint32_t value = old_[o].operand[next++];
        if (value != kNoValue && place_[maker_[value]].need == kNever)
          visits_.push_back({maker_[value], 0});
        continue;
      }
      if (place_[o].need == kNever) place_[o].need = needs_++;
      visits_.pop_back();
    }
  }

  template <class Function>
  void ForOperandsInStretch(uint32_t o, Function visit) const {
    for (uint32_t i = 0; i < old_[o].operand_count; ++i) {
      if (old_[o].operand[i] == kNoValue) continue;
      const uint32_t maker = maker_[old_[o].operand[i]];
      if (place_[maker].stretch == place_[o].stretch) visit(maker);
    }
  }

  // As deep as the longest chain that leads to it; what has no operands waits for its first reader.
  void FindDepths() {
    for (uint32_t o = 0; o < old_.size(); ++o) {
      uint32_t& depth = place_[o].depth;
      if (HasEffect(old_[o].kind)) {
        depth = kNever;
        continue;
      }
      ForOperandsInStretch(
          o, [&](uint32_t maker) { depth = std::max(depth, place_[maker].depth + 1); });
      depth = std::max(depth, 1u);
    }
    for (uint32_t o = 0; o < old_.size(); ++o)
      if (old_[o].operand_count == 0 && !HasEffect(old_[o].kind)) place_[o].depth = kNever - 1;
    for (uint32_t o = 0; o < old_.size(); ++o) {
      if (place_[o].need == kNever || old_[o].operand_count == 0) continue;
      ForOperandsInStretch(o, [&](uint32_t maker) {
        if (old_[maker].operand_count == 0)
          place_[maker].depth = std::min(place_[maker].depth, place_[o].depth - 1);
      });
    }
  }

  void Append(RecordedOperation operation) {
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
  std::vector<uint32_t> maker_;    // of each old value
  std::vector<uint32_t> renamed_;  // old values to new ones
  std::vector<Place> place_;       // of each old operation
  std::vector<Visit> visits_;
  uint32_t needs_ = 0;
  std::map<int32_t, int32_t> lines_;  // of temporaries, old to new
  int32_t splat_count_ = 0;
  Trace new_;
};

}  // namespace

Trace OrderByNeed(const Trace& trace) { return NeedOrder(trace).Take(); }

}  // namespace pelt
