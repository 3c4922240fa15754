#include <algorithm>

#include "platform_sim/schedule/schedule.hpp"

namespace pelt {
namespace {

constexpr int64_t kWordBytes = 4;

struct FullEdge {
  uint32_t from, to, cycles;
};

// The order of accesses, word by word.
class MemoryOrder {
 public:
  explicit MemoryOrder(const StraightCode& code) {
    for (const Instruction& instruction : code.program)
      ForWords(instruction.address, [&](int64_t word) { words_.push_back(word); });
    std::ranges::sort(words_);
    words_.erase(std::unique(words_.begin(), words_.end()), words_.end());
    last_store_.assign(words_.size(), kNoInstruction);
    last_load_.assign(words_.size(), kNoInstruction);
  }

  // `add`(earlier access, it is a store) for each that `index` stays behind.
  template <class Add>
  void Visit(uint32_t index, const AddressOperand& address, const Add& add) {
    uint32_t at = kNoInstruction;
    ForWords(address, [&](int64_t word) {
      // Words of one access lie side by side.
      at = at == kNoInstruction ? uint32_t(std::ranges::lower_bound(words_, word) - words_.begin())
                                : at + 1;
      if (last_store_[at] != kNoInstruction) add(last_store_[at], true);
      if (!address.is_store) {
        loads_.push_back({index, last_load_[at]});
        last_load_[at] = uint32_t(loads_.size() - 1);
        return;
      }
      for (uint32_t l = last_load_[at]; l != kNoInstruction; l = loads_[l].before)
        add(loads_[l].index, false);
      last_load_[at] = kNoInstruction;
      last_store_[at] = index;
    });
  }

 private:
  struct Load {
    uint32_t index, before;  // before: of the same word, since its last store
  };

  template <class Do>
  static void ForWords(const AddressOperand& address, const Do& run) {
    if (address.size_bytes == 0) return;
    const auto word_of = [](int64_t byte) {
      return byte >= 0 ? byte / kWordBytes : -((-byte + kWordBytes - 1) / kWordBytes);
    };
    const int64_t begin = address.displacement_bytes;
    const int64_t last = word_of(begin + address.size_bytes - 1);
    for (int64_t word = word_of(begin); word <= last; ++word) run(word);
  }

  std::vector<int64_t> words_;
  std::vector<uint32_t> last_store_, last_load_;  // of each word; last_load_ into loads_
  std::vector<Load> loads_;
};

std::vector<FullEdge> CollectEdges(const StraightCode& code, const ValueUses& uses,
                                   const SchedulingCore& core) {
  std::vector<FullEdge> edges;
  MemoryOrder memory(code);
  uint32_t last_branch = kNoInstruction;
  std::vector<uint32_t> last_into(code.program.size(),
                                  kNoInstruction);  // last edge by memory from each
  for (uint32_t i = 0; i < code.program.size(); ++i) {
    const Instruction& instruction = code.program[i];
    const bool is_branch = core.classes[instruction.op_class].is_branch;
    for (const uint32_t value : instruction.reads) {
      const uint32_t writer = uses.WriterOf(value);
      if (writer == kNoTarget) continue;
      const SchedulingCore::Class& op = core.classes[code.program[writer].op_class];
      edges.push_back({writer, i, is_branch ? op.latency_into_branch_cycles : op.latency_cycles});
    }
    memory.Visit(i, instruction.address, [&](uint32_t before, bool is_store) {
      // The words of one access mostly name the same one.
      if (last_into[before] == i) return;
      last_into[before] = i;
      const bool is_load_of_it = is_store && !instruction.address.is_store;
      edges.push_back({before, i, is_load_of_it ? core.store_to_load_cycles : 1});
    });
    const bool jumps = instruction.flow == Flow::kConditional;
    if ((jumps || instruction.address.is_store) && last_branch != kNoInstruction)
      edges.push_back({last_branch, i, 1});
    if (jumps) last_branch = i;
  }
  return edges;
}

}  // namespace

DependenceGraph::DependenceGraph(const StraightCode& code, const ValueUses& uses,
                                 const SchedulingCore& core)
    : first_(code.program.size() + 1, 0),
      edges_into_(code.program.size(), 0),
      height_(code.program.size(), 0) {
  const std::vector<FullEdge> all = CollectEdges(code, uses, core);
  for (const FullEdge& edge : all) {
    ++first_[edge.from + 1];
    ++edges_into_[edge.to];
  }
  for (uint32_t i = 0; i < size(); ++i) first_[i + 1] += first_[i];
  edges_.resize(all.size());
  std::vector<uint32_t> next(first_.begin(), first_.end() - 1);
  for (const FullEdge& edge : all) edges_[next[edge.from]++] = {edge.to, edge.cycles};
  for (uint32_t i = size(); i-- > 0;)
    for (const Edge& edge : After(i))
      height_[i] = std::max(height_[i], edge.cycles + height_[edge.to]);
}

}  // namespace pelt
