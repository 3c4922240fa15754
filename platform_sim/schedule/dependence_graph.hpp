// What must come before what in straight code, and by how many cycles.
//
// Edges, all forward in program order: from a value's writer to its readers, by latency; between
// accesses to the same bytes when one is a store, a load behind a store as late as the core says;
// from each branch to the next and to the stores behind it. Loads among themselves are free, and so
// is all that raises nothing.
//
// Bytes are looked at in words of four: accesses that share a word and no byte are kept in order
// too, which the rules would not need.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "platform_sim/schedule/scheduling_core.hpp"
#include "platform_sim/schedule/straight_code.hpp"
#include "platform_sim/schedule/value_uses.hpp"

namespace pelt {

class DependenceGraph {
 public:
  struct Edge {
    uint32_t to;
    uint32_t cycles;  // at least, from issue to issue
  };

  DependenceGraph(const StraightCode& code, const ValueUses& uses, const SchedulingCore& core);

  uint32_t size() const { return uint32_t(height_.size()); }
  std::span<const Edge> After(uint32_t instruction) const {
    return std::span(edges_).subspan(first_[instruction],
                                     first_[instruction + 1] - first_[instruction]);
  }
  uint32_t EdgesInto(uint32_t instruction) const { return edges_into_[instruction]; }
  // Cycles from its issue to the issue of the last instruction that waits for it.
  uint32_t Height(uint32_t instruction) const { return height_[instruction]; }

 private:
  std::vector<uint32_t> first_;
  std::vector<Edge> edges_;
  std::vector<uint32_t> edges_into_, height_;
};

}  // namespace pelt
