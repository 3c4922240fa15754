#include <algorithm>
#include <compare>
#include <map>
#include <span>

#include "platform_sim/pricing/trace.hpp"

namespace pelt {
namespace {

using Kind = RecordedKind;

// What is computed: equal keys, equal results.
struct OperationKey {
  Kind kind;
  uint8_t size_bytes;
  std::array<uint32_t, 4> operand;
  uint32_t bits;
  auto operator<=>(const OperationKey&) const = default;
};

std::span<uint32_t> OperandsOf(RecordedOperation& operation) {
  return {operation.operand.data(), operation.operand_count};
}
std::span<const uint32_t> OperandsOf(const RecordedOperation& operation) {
  return {operation.operand.data(), operation.operand_count};
}

class Simplifier {
 public:
  Simplifier(const Trace& trace, uint32_t begin, uint32_t end)
      : same_as_(trace.value_count),
        operations_(trace.operations.begin() + begin, trace.operations.begin() + end) {
    for (uint32_t v = 0; v < trace.value_count; ++v) same_as_[v] = v;
    readers_.resize(trace.value_count);
    for (size_t o = end; o < trace.operations.size(); ++o)
      for (const uint32_t value : OperandsOf(trace.operations[o]))
        if (value != kNoValue) readers_[value] = kReadLater;
  }

  void MergeEqual() {
    for (RecordedOperation& operation : operations_) {
      for (uint32_t& value : OperandsOf(operation))
        if (value != kNoValue) value = same_as_[value];
      if (IsStore(operation.kind)) ForgetLoads(operation);
      if (!MayMerge(operation)) continue;
      const OperationKey key{operation.kind, operation.size_bytes, operation.operand,
                             operation.bits};
      const uint32_t first = IsLoad(operation.kind)
                                 ? FindLoad(key, operation)
                                 : made_.try_emplace(key, operation.result).first->second;
      for (uint32_t r = 0; r < operation.result_count; ++r) {
        same_as_[operation.result + r] = first + r;
        if (first != operation.result && readers_[operation.result + r] == kReadLater)
          readers_[first + r] = kReadLater;
      }
      if (first != operation.result) operation.result_count = 0;  // is there already
    }
    std::erase_if(operations_, [](const RecordedOperation& operation) {
      return operation.result_count == 0 && !HasEffect(operation.kind);
    });
  }

  void FuseProducts() {
    CountReaders();
    std::map<uint32_t, size_t> products;
    for (size_t o = 0; o < operations_.size(); ++o) {
      RecordedOperation& operation = operations_[o];
      if (operation.kind == Kind::kMultiply) products[operation.result] = o;
      if (operation.kind != Kind::kAdd && operation.kind != Kind::kSubtract) continue;
      for (const uint32_t side : {1u, 0u}) {
        const auto at = products.find(operation.operand[side]);
        if (at == products.end() || readers_[at->first] != 1) continue;
        const RecordedOperation& product = operations_[at->second];
        const Kind fused = operation.kind == Kind::kAdd ? Kind::kMultiplyAdd
                           : side == 1                  ? Kind::kSubtractMultiply
                                                        : Kind::kMultiplySubtract;
        operation.operand = {product.operand[0], product.operand[1], operation.operand[1 - side],
                             kNoValue};
        operation.operand_count = 3;
        operation.kind = fused;
        break;
      }
    }
  }

  std::vector<RecordedOperation> TakeLiving() {
    std::vector<bool> living(readers_.size());
    for (size_t v = 0; v < readers_.size(); ++v) living[v] = readers_[v] >= kReadLater;
    std::vector<RecordedOperation> out;
    for (size_t o = operations_.size(); o-- > 0;) {
      const RecordedOperation& operation = operations_[o];
      bool keep = HasEffect(operation.kind);
      for (uint32_t r = 0; r < operation.result_count; ++r)
        keep = keep || living[operation.result + r];
      if (!keep) continue;
      for (const uint32_t value : OperandsOf(operation))
        if (value != kNoValue) living[value] = true;
      out.push_back(operation);
    }
    std::reverse(out.begin(), out.end());
    return out;
  }

 private:
  static constexpr uint32_t kReadLater = 1u << 30;

  static bool MayMerge(const RecordedOperation& operation) {
    const Kind kind = operation.kind;
    if (HasEffect(kind) || kind == Kind::kLoadRecord) return false;
    return !IsLoad(kind) || operation.operand_count == 0;
  }

  uint32_t FindLoad(const OperationKey& key, const RecordedOperation& operation) {
    auto [at, end] = loads_.equal_range(operation.address);
    for (; at != end; ++at)
      if (at->second.first == key) return at->second.second;
    loads_.emplace(operation.address, std::pair(key, operation.result));
    return operation.result;
  }

  void ForgetLoads(const RecordedOperation& store) {
    constexpr int32_t kMostBytes = 16;
    auto at = loads_.upper_bound(store.address - kMostBytes);
    while (at != loads_.end() && at->first < store.address + store.size_bytes)
      at = at->first + at->second.first.size_bytes > store.address ? loads_.erase(at) : next(at);
  }

  void CountReaders() {
    for (const RecordedOperation& operation : operations_)
      for (const uint32_t value : OperandsOf(operation))
        if (value != kNoValue) ++readers_[value];
  }

  std::vector<uint32_t> same_as_;  // the first value with what this one has
  std::vector<uint32_t> readers_;  // in here, plus kReadLater
  std::vector<RecordedOperation> operations_;
  std::map<OperationKey, uint32_t> made_;
  // By address, not written since.
  std::multimap<int32_t, std::pair<OperationKey, uint32_t>> loads_;
};

}  // namespace

std::vector<RecordedOperation> SimplifyTrace(const Trace& trace, uint32_t begin, uint32_t end,
                                             const SimplifyRules& rules) {
  Simplifier simplifier(trace, begin, end);
  simplifier.MergeEqual();
  if (rules.fuse_multiply_add) simplifier.FuseProducts();
  return simplifier.TakeLiving();
}

}  // namespace pelt
