#include "platform_sim/frame/what_if.hpp"

#include <algorithm>
#include <array>

#include "core/kernels/sort_pieces.hpp"

namespace pelt {
namespace {

constexpr uint32_t kListElements = 2048;  // of a DMA list
constexpr uint32_t kQuadBytes = 16;

// 32 bits in three digits of 11 instead of four of 8: eight times the places, a round less.
constexpr uint32_t kDroppedDigit = 1;
constexpr uint64_t kMorePlaces = (1u << 11) / (1u << 8);

struct Names {
  WhatIf what_if;
  std::string_view name, text;
};
constexpr Names kNames[] = {
    {WhatIf::kNothing, "nothing", "as it is"},
    {WhatIf::kResidentPalette, "resident-palette",
     "the joint palette kept in local store from item to item of a character"},
    {WhatIf::kLivePrefix, "live-prefix", "of every row only the lanes that live moved"},
    {WhatIf::kWiderDigits, "wider-digits",
     "layers that are sorted in pieces sorted on three digits of 11 bits"},
    {WhatIf::kFewerPoints, "fewer-points",
     "strands of 5 points resampled to 4, as a bake with points = 4 would"},
};

template <size_t kCount>
bool IsOneOf(std::string_view name, const std::string_view (&names)[kCount]) {
  return std::ranges::find(names, name) != std::end(names);
}

using sort_pieces_detail::kCountNames, sort_pieces_detail::kOffsetNames,
    sort_pieces_detail::kScatterNames;

constexpr uint32_t BytesOf(ElementType type) {
  return type == ElementType::kU8 ? 1 : type == ElementType::kU16 ? 2 : 4;
}

}  // namespace

std::string_view WhatIfName(WhatIf what_if) { return kNames[size_t(what_if)].name; }
std::string_view DescribeWhatIf(WhatIf what_if) { return kNames[size_t(what_if)].text; }
std::optional<WhatIf> ParseWhatIf(std::string_view name) {
  const auto at = std::ranges::find(kNames, name, &Names::name);
  return at == std::end(kNames) ? std::nullopt : std::optional(at->what_if);
}

WorkChange::WorkChange(WhatIf what_if, const ConsoleMachine& machine)
    : what_if_(what_if),
      line_bytes_(machine.line_bytes),
      largest_bytes_(machine.largest_transfer_bytes),
      has_stores_(machine.local_store_bytes > 0),
      palette_of_(machine.units, kNoBlock) {}

void WorkChange::BeginPass() { std::ranges::fill(palette_of_, kNoBlock); }

bool WorkChange::KeepsPass(const Plan& plan, uint32_t pass) const {
  if (what_if_ != WhatIf::kWiderDigits) return true;
  const std::string_view dropped[] = {kCountNames[kDroppedDigit], kOffsetNames[kDroppedDigit],
                                      kScatterNames[kDroppedDigit]};
  const Pass& p = plan.passes[pass];
  for (uint32_t s = p.first_stage; s < p.first_stage + p.stage_count; ++s)
    if (!IsOneOf(plan.stages[s].kernel.name, dropped)) return true;
  return false;
}

void WorkChange::Apply(const Frame& frame, uint32_t unit, uint32_t pass, uint32_t item,
                       ItemWork& work) {
  switch (what_if_) {
    case WhatIf::kNothing:
    case WhatIf::kFewerPoints:
      return;
    case WhatIf::kResidentPalette:
      return DropPalette(frame, unit, pass, item, work);
    case WhatIf::kLivePrefix:
      return MoveLivePrefix(frame, pass, item, work);
    case WhatIf::kWiderDigits:
      return WidenDigits(frame, work);
  }
}

void WorkChange::DropPalette(const Frame& frame, uint32_t unit, uint32_t pass, uint32_t item,
                             ItemWork& work) {
  const Domain domain = frame.plan->passes[pass].domain;
  // Caches hold it already; a character's own pass makes it.
  if (!has_stores_ || domain <= Domain::kCharacter) return;
  const uint32_t character =
      PlaceOf(*frame.memory->shape, domain, item).first[size_t(Domain::kCharacter)];
  for (ItemWork::StreamBytes& moved : work.streams) {
    if (moved.stream != StreamOf<&Streams::palette> || moved.get_bytes == 0) continue;
    if (palette_of_[unit] == character) {
      Replace(Whole(moved.get_bytes), {0, 0, 0}, work.get);
      moved.get_bytes = 0;
    }
    palette_of_[unit] = character;
  }
}

void WorkChange::MoveLivePrefix(const Frame& frame, uint32_t pass, uint32_t item,
                                ItemWork& work) const {
  const Domain domain = frame.plan->passes[pass].domain;
  if (!IsInLayer(domain)) return;
  for (ItemWork::StreamBytes& moved : work.streams) {
    const StreamDesc& stream = DescribeStream(moved.stream);
    // What is drawn is put as it lies, places of dead strands and all.
    const bool is_drawn = stream.lanes.group == 1;
    if (stream.domain != domain || stream.lanes.AllHoldValues() || is_drawn) continue;
    const uint32_t live = frame.memory->LiveLanes(moved.stream, item);
    Pieces prefix{0, 0, 0};
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

void WorkChange::WidenDigits(const Frame& frame, ItemWork& work) const {
  for (ItemWork::StageTime& stage : work.stages)
    if (IsOneOf(frame.plan->stages[stage.stage].kernel.name, kOffsetNames))
      for (ItemWork::CodeTime* time : {&stage.as_written, &stage.scheduled}) {
        time->cycles *= double(kMorePlaces);
        time->shared_cycles *= double(kMorePlaces);
      }
  for (ItemWork::StreamBytes& moved : work.streams) {
    if (moved.stream != StreamOf<&Streams::digits>) continue;
    const auto widen = [&](uint64_t& bytes, TransferShape& shape) {
      if (bytes == 0) return;
      Replace(Whole(bytes), Whole(bytes * kMorePlaces), shape);
      bytes *= kMorePlaces;
    };
    widen(moved.get_bytes, work.get);
    widen(moved.put_bytes, work.put);
  }
}

WorkChange::Pieces WorkChange::Whole(uint64_t bytes) const {
  return {bytes, uint32_t((bytes + largest_bytes_ - 1) / largest_bytes_),
          uint32_t((bytes + line_bytes_ - 1) / line_bytes_)};
}

void WorkChange::Replace(const Pieces& was, const Pieces& is, TransferShape& shape) const {
  shape.lines += is.lines - was.lines;
  shape.bytes += uint64_t(is.lines) * line_bytes_ - uint64_t(was.lines) * line_bytes_;
  if (!has_stores_) return;
  shape.elements += is.elements - was.elements;
  shape.commands = (shape.elements + kListElements - 1) / kListElements;
}

}  // namespace pelt
