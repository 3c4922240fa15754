// One set-associative cache: which lines are in it, which go. Least recently used goes first.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

namespace pelt {

class Cache {
 public:
  struct Evicted {
    bool any = false, dirty = false;
    uint64_t line = 0;
  };

  Cache(uint32_t bytes, uint32_t ways, uint32_t line_bytes)
      : ways_(ways), sets_(bytes / (ways * line_bytes)), entries_(size_t(ways_) * sets_) {}

  // Is line number `line` here? Marks it used, and dirty if asked to.
  bool Touch(uint64_t line, bool dirty);
  // Puts it here; what had to go is returned.
  Evicted Fill(uint64_t line, bool dirty);
  // Drops it, without a word about what it held.
  void Drop(uint64_t line);

 private:
  struct Entry {
    uint64_t line = ~uint64_t{0};
    uint64_t used = 0;
    bool dirty = false;
  };
  Entry* Find(uint64_t line);

  uint32_t ways_, sets_;
  uint64_t clock_ = 0;
  std::vector<Entry> entries_;
};

}  // namespace pelt
