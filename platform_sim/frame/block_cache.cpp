#include "platform_sim/frame/block_cache.hpp"

namespace pelt {

BlockCache::BlockCache(uint64_t bytes, const FrameMemory& memory)
    : capacity_(bytes), table_(*memory.table) {
  for (uint32_t s = 0; s < memory.streams.size(); ++s) {
    first_.push_back(uint32_t(entries_.size()));
    Entry entry;
    entry.stream = Stream(s);
    entries_.insert(entries_.end(), memory.streams[s].block_count, entry);
  }
}

void BlockCache::Unlink(uint32_t e) {
  Entry& entry = entries_[e];
  (entry.newer == kNone ? newest_ : entries_[entry.newer].older) = entry.older;
  (entry.older == kNone ? oldest_ : entries_[entry.older].newer) = entry.newer;
  entry.newer = entry.older = kNone;
}

void BlockCache::LinkNewest(uint32_t e) {
  entries_[e].older = newest_;
  (newest_ == kNone ? oldest_ : entries_[newest_].newer) = e;
  newest_ = e;
}

uint32_t BlockCache::Touch(Stream stream, uint32_t block, bool written, bool whole,
                           std::vector<Evicted>& evicted) {
  const uint32_t e = first_[size_t(stream)] + block;
  const uint32_t bytes = table_[stream].block_bytes;
  Entry& entry = entries_[e];
  entry.dirty |= written;
  if (entry.here) {
    Unlink(e);
    LinkNewest(e);
    return 0;
  }
  entry.here = true;
  LinkNewest(e);
  used_ += bytes;
  while (used_ > capacity_ && oldest_ != e) {
    Entry& old = entries_[oldest_];
    const uint32_t old_bytes = table_[old.stream].block_bytes;
    if (old.dirty) evicted.push_back({old.stream, old_bytes});
    used_ -= old_bytes;
    old.here = old.dirty = false;
    Unlink(oldest_);
  }
  return whole ? 0 : bytes;
}

}  // namespace pelt
