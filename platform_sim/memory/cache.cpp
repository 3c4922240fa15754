#include "platform_sim/memory/cache.hpp"

#include <algorithm>

namespace pelt {

Cache::Entry* Cache::Find(uint64_t line) {
  Entry* set = &entries_[size_t(line % sets_) * ways_];
  const auto at = std::find_if(set, set + ways_, [&](const Entry& e) { return e.line == line; });
  return at == set + ways_ ? nullptr : at;
}

bool Cache::Touch(uint64_t line, bool dirty) {
  Entry* entry = Find(line);
  if (!entry) return false;
  entry->used = ++clock_;
  entry->dirty |= dirty;
  return true;
}

Cache::Evicted Cache::Fill(uint64_t line, bool dirty) {
  Entry* set = &entries_[size_t(line % sets_) * ways_];
  Entry* oldest = std::min_element(set, set + ways_,
                                   [](const Entry& a, const Entry& b) { return a.used < b.used; });
  const Evicted evicted = {oldest->used > 0, oldest->dirty, oldest->line};
  *oldest = {line, ++clock_, dirty};
  return evicted;
}

void Cache::Drop(uint64_t line) {
  if (Entry* entry = Find(line)) *entry = {};
}

}  // namespace pelt
