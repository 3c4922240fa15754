#include "platform_sim/frame/moved_data.hpp"

#include <algorithm>

namespace pelt {
namespace {

constexpr uint32_t kMostElements = 2048;  // of a DMA list
constexpr uint32_t kQuadBytes = 16;

constexpr uint32_t BytesOf(ElementType type) {
  return type == ElementType::kU8 ? 1 : type == ElementType::kU16 ? 2 : 4;
}

}  // namespace

MovedData::MovedData(const ConsoleMachine& machine)
    : line_bytes_(machine.line_bytes),
      largest_bytes_(machine.largest_transfer_bytes),
      has_stores_(machine.local_store_bytes > 0),
      held_(machine.units) {}

void MovedData::BeginFrame() { std::ranges::fill(held_, Held{}); }

void MovedData::Apply(const Frame& frame, uint32_t unit, uint32_t pass, uint32_t item,
                      ItemWork& work) {
  const Domain domain = frame.plan->passes[pass].domain;
  if (held_[unit].pass != pass)
    held_[unit] = {pass, std::vector<uint32_t>(frame.plan->table->streams.size(), kNoBlock)};
  // Caches hold it already; a character's own pass makes it.
  if (has_stores_ && domain > Domain::kCharacter) DropResident(frame, unit, domain, item, work);
  if (IsInLayer(domain)) MoveLivePrefix(frame, domain, item, work);
}

void MovedData::DropResident(const Frame& frame, uint32_t unit, Domain domain, uint32_t item,
                             ItemWork& work) {
  const StreamTable& table = *frame.plan->table;
  const uint32_t character =
      PlaceOf(*frame.memory->shape, domain, item).first[size_t(Domain::kCharacter)];
  for (ItemWork::StreamBytes& moved : work.streams) {
    if (table[moved.stream].domain != Domain::kCharacter || moved.get_bytes == 0) continue;
    uint32_t& held = held_[unit].character[size_t(moved.stream)];
    if (held == character) {
      Replace(Whole(moved.get_bytes), {0, 0, 0}, work.get);
      moved.get_bytes = 0;
    }
    held = character;
  }
}

void MovedData::MoveLivePrefix(const Frame& frame, Domain domain, uint32_t item,
                               ItemWork& work) const {
  for (ItemWork::StreamBytes& moved : work.streams) {
    const StreamDesc& stream = (*frame.plan->table)[moved.stream];
    // What is drawn is put as it lies, places of dead strands and all.
    const bool is_drawn = stream.lanes.group == 1;
    if (stream.domain != domain || stream.lanes.AllHoldValues() || is_drawn) continue;
    const uint32_t live = frame.memory->LiveLanes(moved.stream, item);
    MovedPieces prefix{0, 0, 0};
    for (const RowDesc& row : stream.rows) {
      const uint32_t lanes = std::min(live, row.lane_count),
                     each = row.element_count / row.lane_count;
      // A row of lanes after the other; or all that a lane has, lane after lane.
      const uint32_t pieces = row.lane_major ? 1 : each;
      const uint32_t bytes = lanes * BytesOf(row.type) * (row.lane_major ? each : 1);
      const uint32_t quads = (bytes + kQuadBytes - 1) / kQuadBytes * kQuadBytes;
      if (bytes == 0) continue;
      prefix.bytes += uint64_t(pieces) * quads;
      prefix.elements += pieces;
      prefix.lines += pieces * ((quads + line_bytes_ - 1) / line_bytes_);
    }
    // Whole blocks only: what was gathered by records is no more than it needs already.
    const auto shrink = [&](uint64_t& bytes, TransferShape& shape) {
      if (bytes != stream.block_bytes || prefix.lines >= Whole(bytes).lines) return;
      Replace(Whole(bytes), prefix, shape);
      bytes = prefix.bytes;
    };
    shrink(moved.get_bytes, work.get);
    shrink(moved.put_bytes, work.put);
  }
}

MovedPieces MovedData::Whole(uint64_t bytes) const {
  return {bytes, uint32_t((bytes + largest_bytes_ - 1) / largest_bytes_),
          uint32_t((bytes + line_bytes_ - 1) / line_bytes_)};
}

void MovedData::Replace(const MovedPieces& was, const MovedPieces& is, TransferShape& shape) const {
  shape.lines += is.lines - was.lines;
  shape.bytes += uint64_t(is.lines) * line_bytes_ - uint64_t(was.lines) * line_bytes_;
  if (!has_stores_) return;
  shape.elements += is.elements - was.elements;
  shape.commands = (shape.elements + kMostElements - 1) / kMostElements;
}

}  // namespace pelt
