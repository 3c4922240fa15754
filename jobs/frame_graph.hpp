// The waits of a plan item by item: what becomes ready when, and where it lies until a worker takes
// it. Made with the plan, once; what a frame has done of it so far is in jobs/frame_scheduler.hpp.
//
// A node fires when all that it waits for is done: items that were run, other nodes that fired. It
// then opens items, and counts for the nodes that wait for it. The first node is the frame's
// beginning, the last its end:
//
//   beginning ─> [opens items of layer 3] ... each counts for ─> (end of layer 3) ─> [opens its sort]
//
// An open item is a bit. Items of patches and chunks have homes: each worker has a share of the
// places, finds its items of every pass and frame there, and takes from another's when its own are
// gone (what lies in a core's cache is used again). The others are few and wanted by many: they lie
// in front, where every worker looks first.
#pragma once

#include <bit>
#include <cstdint>
#include <vector>

#include "core/frame_memory.hpp"

namespace pelt {

struct Plan;

// Where words lie: `common` ones, then `in_place` of each place, on cache lines of their own.
struct WordLayout {
  static constexpr uint32_t kPerLine = 8;
  uint32_t common = 0, in_place = 0, places = 0;

  static constexpr uint32_t Pad(uint32_t words) { return (words + kPerLine - 1) & ~(kPerLine - 1); }
  uint32_t Word(uint32_t place, uint32_t word) const {
    return Pad(common) + place * Pad(in_place) + word;
  }
  uint64_t Packed() const {
    return uint64_t(common) | uint64_t(in_place) << 24 | uint64_t(places) << 48;
  }
  static WordLayout Unpack(uint64_t packed) {
    return {uint32_t(packed & 0xffffff), uint32_t(packed >> 24 & 0xffffff), uint32_t(packed >> 48)};
  }
};

struct FrameGraph {
  // Parts into which patches and chunks are divided, at most. Many workers' numbers divide it.
  static constexpr uint32_t kMostPlaces = 48;

  // Of a node: how much it waits for, and where in `opens` and `next` begins what it opens and
  // counts for; they end where the next node's begin. There is one node more than fire.
  struct Node {
    uint32_t waits_for, first_open, first_next;
  };
  struct Open {
    uint32_t word;
    uint64_t bits;
  };
  // 64 items of a pass at most: in `items`, from `first` on.
  struct Word {
    uint32_t pass, first;
  };

  std::vector<Node> nodes;
  std::vector<Open> opens;
  std::vector<uint32_t> next;  // nodes
  WordLayout layout;
  // A word's bits are in the order in which they had best be run, its words in that of their passes.
  std::vector<Word> words;
  std::vector<uint32_t> items;
  // Of each pass the place of its item 0 in `item_node`: the node that a run item counts for.
  std::vector<uint32_t> pass_first, item_node;

  uint64_t HeapBytes() const;
  // The place in `item_node` of what a bit stands for.
  uint32_t AtItem(uint32_t word, uint32_t bit) const {
    return pass_first[words[word].pass] + items[words[word].first + bit];
  }
  // Calls f(pass, item, its place in `item_node`) for each item that the node opens.
  template <class F>
  void ForEachOpened(uint32_t node, const F& f) const {
    for (uint32_t o = nodes[node].first_open; o < nodes[node + 1].first_open; ++o)
      for (uint64_t bits = opens[o].bits; bits; bits &= bits - 1) {
        const auto bit = uint32_t(std::countr_zero(bits));
        const Word& word = words[opens[o].word];
        f(word.pass, items[word.first + bit], AtItem(opens[o].word, bit));
      }
  }
  uint32_t LastNode() const { return uint32_t(nodes.size()) - 2; }
};

// Of a plan whose waits are set. Where a wait goes by a list, the lists are read from `memory`; without it the
// wait is for all in the layer.
FrameGraph BuildGraph(const Plan& plan, const SceneShape& shape,
                      const FrameMemory* memory = nullptr);

}  // namespace pelt
