#include "platform_sim/schedule/interleave_iterations.hpp"

#include <algorithm>
#include <queue>
#include <tuple>

#include "platform_sim/schedule/dependence_graph.hpp"
#include "platform_sim/schedule/value_uses.hpp"

namespace pelt {
namespace {

// Ahead of its first reader, of both iterations' instructions: enough for a load.
constexpr int64_t kLeadInstructions = 8;

// Values alive before each instruction.
std::vector<int32_t> CountAlive(const StraightCode& code, const ValueUses& uses) {
  std::vector<int32_t> alive(code.program.size() + 1);
  for (uint32_t v = 0; v < code.value_count(); ++v) {
    const auto readers = uses.ReadersOf(v);
    const uint32_t writer = uses.WriterOf(v);
    if (writer == kNoTarget || readers.empty()) continue;
    ++alive[writer + 1];
    if (readers.back() + 1 < alive.size()) --alive[readers.back() + 1];
  }
  for (size_t p = 1; p < alive.size(); ++p) alive[p] += alive[p - 1];
  return alive;
}

// Where each iteration begins, and the end.
std::vector<uint32_t> IterationBegins(const StraightCode& code, const ValueUses& uses,
                                      uint32_t iterations) {
  const std::vector<int32_t> alive = CountAlive(code, uses);
  const auto size = uint32_t(code.program.size());
  std::vector<uint32_t> begins = {0};
  for (uint32_t t = 1; t < iterations; ++t) {
    const auto due = uint32_t(uint64_t{size} * t / iterations), reach = size / iterations / 3;
    const uint32_t first = std::max(due - std::min(due, reach), begins.back());
    const uint32_t last = std::min(due + reach, size);
    begins.push_back(uint32_t(std::min_element(alive.begin() + first, alive.begin() + last + 1) -
                              alive.begin()));
  }
  begins.push_back(size);
  return begins;
}

struct Key {
  uint32_t group = 0;
  int64_t progress = 0;  // into its iteration, in parts of kWhole
  uint32_t iteration = 0;
  auto operator<=>(const Key&) const = default;
};
constexpr int64_t kWhole = int64_t{1} << 32;

// Of each value: whether it is made of more than constants and memory.
std::vector<bool> FindWaiting(const StraightCode& code) {
  std::vector<bool> waits(code.value_count());
  std::vector<bool> is_plain(code.value_count(), true);
  for (const Instruction& instruction : code.program) {
    const bool any =
        std::ranges::any_of(instruction.reads, [&](uint32_t value) { return waits[value]; });
    // One step behind a load at most: a splat of a word.
    const bool deep =
        std::ranges::any_of(instruction.reads, [&](uint32_t value) { return !is_plain[value]; });
    for (const uint32_t value : instruction.writes) {
      waits[value] = any || deep;
      is_plain[value] = instruction.reads.count == 0;
    }
  }
  return waits;
}

std::vector<Key> KeysOf(const StraightCode& code, const ValueUses& uses, uint32_t iterations,
                        uint32_t together) {
  const std::vector<uint32_t> begins = IterationBegins(code, uses, iterations);
  std::vector<Key> keys(code.program.size());
  for (uint32_t t = 0; t < iterations; ++t)
    for (uint32_t i = begins[t]; i < begins[t + 1]; ++i)
      keys[i] = {t / together, (i - begins[t]) * kWhole / (begins[t + 1] - begins[t]), t};
  const int64_t lead =
      kLeadInstructions * kWhole * iterations / int64_t(std::max<size_t>(code.program.size(), 1));
  const std::vector<bool> waits = FindWaiting(code);
  // Branches keep their order, so one of a younger iteration comes behind those of older ones; and
  // what decides it comes just before it: conditions are few, and nothing spills them.
  Key last_branch;
  for (size_t i = 0; i < keys.size(); ++i)
    if (code.program[i].flow == Flow::kConditional)
      last_branch = keys[i] = std::max(last_branch, keys[i]);
  // Readers first: what makes their operands moves with them.
  for (size_t i = keys.size(); i-- > 0;) {
    const Instruction& instruction = code.program[i];
    if (instruction.writes.count != 1) continue;
    const uint32_t value = instruction.writes.number[0];
    const bool decides = code.file[value] == ValueFile::kCondition;
    const auto readers = uses.ReadersOf(value);
    if ((waits[value] && !decides) || readers.empty()) continue;
    Key first = keys[readers[0]];
    for (const uint32_t reader : readers) first = std::min(first, keys[reader]);
    if (!decides) first.progress -= lead;
    keys[i] = std::max(keys[i], first);
  }
  return keys;
}

}  // namespace

InterleavedCode InterleaveIterations(const StraightCode& code, uint32_t iterations,
                                     uint32_t together, const SchedulingCore& core) {
  const ValueUses uses(code);
  const DependenceGraph graph(code, uses, core);
  const std::vector<Key> keys = KeysOf(code, uses, std::max(iterations, 1u), together);
  using Waiting = std::pair<Key, uint32_t>;
  std::priority_queue<Waiting, std::vector<Waiting>, std::greater<>> ready;
  std::vector<uint32_t> edges_left(graph.size());
  for (uint32_t i = 0; i < graph.size(); ++i) {
    edges_left[i] = graph.EdgesInto(i);
    if (edges_left[i] == 0) ready.push({keys[i], i});
  }
  InterleavedCode out{.code = {.program = {}, .file = code.file}, .origin = {}};
  while (!ready.empty()) {
    const uint32_t i = ready.top().second;
    ready.pop();
    out.code.program.push_back(code.program[i]);
    out.origin.push_back(i);
    for (const DependenceGraph::Edge& edge : graph.After(i))
      if (--edges_left[edge.to] == 0) ready.push({keys[edge.to], edge.to});
  }
  return out;
}

}  // namespace pelt
