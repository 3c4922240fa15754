#include "traces/digest.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>

#include "core/simd/vec.hpp"

namespace pelt {
namespace {

uint32_t LanesOf(const StreamDesc& stream, const RowDesc& row, uint32_t live_lanes) {
  return stream.lanes.AllHoldValues() ? row.lane_count : std::min(row.lane_count, live_lanes);
}

// Calls visit(element index) for every element in a live lane; stops when it returns false.
template <class Visit>
bool ForEachLive(const StreamDesc& stream, const RowDesc& row, uint32_t live_lanes, Visit visit) {
  const uint32_t lanes = LanesOf(stream, row, live_lanes);
  const uint32_t components = row.element_count / row.lane_count;
  if (row.lane_major) {
    for (uint32_t e = 0; e < lanes * components; ++e)
      if (!visit(e)) return false;
    return true;
  }
  for (uint32_t c = 0; c < components; ++c)
    for (uint32_t l = 0; l < lanes; ++l)
      if (!visit(c * row.lane_count + l)) return false;
  return true;
}

}  // namespace

uint32_t RowElement(const void* block, const RowDesc& row, uint32_t index) {
  const auto* bytes = static_cast<const uint8_t*>(block) + row.offset_bytes;
  switch (row.type) {
    case ElementType::kU8:
      return bytes[index];
    case ElementType::kU16: {
      uint16_t v;
      std::memcpy(&v, bytes + 2 * size_t(index), 2);
      return v;
    }
    default: {
      uint32_t v;
      std::memcpy(&v, bytes + 4 * size_t(index), 4);
      return v;
    }
  }
}

void AddBlock(Digest& digest, const StreamDesc& stream, const void* block, uint32_t live_lanes) {
  for (const RowDesc& row : stream.rows)
    ForEachLive(stream, row, live_lanes, [&](uint32_t e) {
      digest.Add(RowElement(block, row, e));
      return true;
    });
}

BlockDifference FindDifference(const StreamDesc& stream, const void* left, const void* right,
                               uint32_t live_lanes) {
  BlockDifference found;
  for (const RowDesc& row : stream.rows) {
    ForEachLive(stream, row, live_lanes, [&](uint32_t e) {
      const uint32_t a = RowElement(left, row, e), b = RowElement(right, row, e);
      if (a == b) return true;
      const uint32_t components = row.element_count / row.lane_count;
      const uint32_t lane = row.lane_major ? e / components : e % row.lane_count;
      const uint32_t component = row.lane_major ? e % components : e / row.lane_count;
      found = {true, &row, component, lane, a, b};
      return false;
    });
    if (found.differs) break;
  }
  return found;
}

namespace {

// The digest of a stream in the making: of each block the number of its live lanes, then its rows,
// as runs of words that lie together.
class StreamDigest {
 public:
  // Of the items [first, end), behind what `digest` has.
  StreamDigest(const FrameMemory& memory, Stream stream, uint32_t first, uint32_t end,
               Digest digest)
      : memory_(&memory),
        stream_(stream),
        desc_(&(*memory.table)[stream]),
        digest_(digest),
        item_(first),
        end_(end) {}
  StreamDigest(const FrameMemory& memory, Stream stream)
      : StreamDigest(memory, stream, 0, memory.shape->ItemCount((*memory.table)[stream].domain),
                     {}) {}

  // Sees to a run that is not empty; false at the end.
  bool FindRun() {
    while (left_ == 0)
      if (!NextRun()) return false;
    return true;
  }
  // All of it, where nothing else is digested.
  Digest Finish() {
    while (FindRun()) AddTogether<1>({this});
    return digest_;
  }
  uint64_t Value() const { return digest_.Value(); }
  Stream stream() const { return stream_; }

  // Each word waits for the one before it, of the same stream: several streams' do not.
  template <size_t kCount>
  static void AddTogether(std::array<StreamDigest*, kCount> streams) {
    size_t words = SIZE_MAX;
    std::array<Digest, kCount> digests;
    std::array<const std::byte*, kCount> from;
    for (size_t k = 0; k < kCount; ++k) {
      words = std::min(words, streams[k]->left_);
      digests[k] = streams[k]->digest_;
      from[k] = streams[k]->words_;
    }
    for (size_t w = 0; w < words; ++w) {
      PELT_UNROLL
      for (size_t k = 0; k < kCount; ++k) {
        uint32_t word;
        std::memcpy(&word, from[k] + 4 * w, 4);
        digests[k].Add(word);
      }
    }
    for (size_t k = 0; k < kCount; ++k) {
      streams[k]->digest_ = digests[k];
      streams[k]->words_ += 4 * words;
      streams[k]->left_ -= words;
    }
  }

 private:
  bool NextRun() {
    if (!block_ || row_ == desc_->rows.size()) return NextBlock();
    const RowDesc& row = desc_->rows[row_];
    const uint32_t lanes = LanesOf(*desc_, row, lanes_), parts = row.element_count / row.lane_count;
    const uint32_t first = part_ * row.lane_count, count = row.lane_major ? lanes * parts : lanes;
    if (row.type == ElementType::kU8 || row.type == ElementType::kU16) {  // few are
      for (uint32_t i = 0; i < count; ++i) digest_.Add(RowElement(block_, row, first + i));
    } else {
      words_ = block_ + row.offset_bytes + 4 * size_t(first);
      left_ = count;
    }
    if (row.lane_major || ++part_ == parts) {
      ++row_;
      part_ = 0;
    }
    return true;
  }
  bool NextBlock() {
    for (block_ = nullptr; !block_ && item_ < end_; ++item_)
      if ((block_ = memory_->Block(stream_, item_))) lanes_ = memory_->LiveLanes(stream_, item_);
    row_ = part_ = 0;
    if (block_) digest_.Add(lanes_);
    return block_;
  }

  const FrameMemory* memory_;
  Stream stream_;
  const StreamDesc* desc_;
  Digest digest_;
  uint32_t item_, end_;
  const std::byte *block_ = nullptr, *words_ = nullptr;
  uint32_t row_ = 0, part_ = 0, lanes_ = 0;
  size_t left_ = 0;  // words of the run
};

}  // namespace

void AddItem(Digest& digest, const FrameMemory& memory, Stream stream, uint32_t item) {
  digest = StreamDigest(memory, stream, item, item + 1, digest).Finish();
}

uint64_t DigestStream(const FrameMemory& memory, Stream stream) {
  if ((*memory.table)[stream].role != Role::kValue) return 0;
  return StreamDigest(memory, stream).Finish().Value();
}

// Four streams side by side; one that ends gives its place to the next. Frames are digested where
// nothing may allocate.
uint64_t DigestFrame(const FrameMemory& memory) {
  constexpr size_t kTogether = 4, kMostStreams = size_t(Stream::kNone);
  uint64_t values[kMostStreams];
  std::array<std::optional<StreamDigest>, kTogether> open;
  uint32_t next = 0;
  // A stream that the scene does not have counts for nothing, so that a new kind of stream leaves
  // the digests of other scenes alone.
  const auto is_counted = [&](uint32_t s) {
    return memory.table->streams[s].role == Role::kValue && memory.streams[s].block_count != 0;
  };
  const auto find_run = [&](std::optional<StreamDigest>& place) {
    for (;;) {
      if (place && place->FindRun()) return true;
      if (place) values[size_t(place->stream())] = place->Value();
      place.reset();
      while (next < memory.streams.size() && !is_counted(next)) ++next;
      if (next == memory.streams.size()) return false;
      place.emplace(memory, Stream(next++));
    }
  };
  for (;;) {
    size_t running = 0;
    for (auto& place : open) running += find_run(place);
    if (running == 0) break;
    if (running == kTogether)
      StreamDigest::AddTogether<kTogether>({&*open[0], &*open[1], &*open[2], &*open[3]});
    else
      for (auto& place : open)
        if (place) StreamDigest::AddTogether<1>({&*place});
  }
  Digest digest;
  for (uint32_t s = 0; s < memory.streams.size(); ++s)
    if (is_counted(s)) digest.Add64(values[s]);
  return digest.Value();
}

}  // namespace pelt
