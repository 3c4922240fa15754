// Whether the digests see everything.
//
// All else that a verification says rests on digests, so they are checked against the frame itself:
// what the plan's stages leave behind must be of a stream that is digested; what a stream's rows do
// not cover must hold nothing; and one flipped bit in any stream, item, row or live lane must
// change the stream's digest, the frame's, and a column of the digest log. So must two values that
// change places: lanes, rows, items.
//
// What counts as live is counted here from the chunks' bookkeeping, not asked of the scene.
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "bench/verify/checks.hpp"
#include "bench/verify/frame_digests.hpp"
#include "bench/verify/stage_digests.hpp"
#include "core/random.hpp"

namespace pelt {
namespace {

constexpr uint32_t kMostItems = 64;  // of a stream in a large scene: evenly taken

std::string_view NameOf(Stream stream) { return DescribeStream(stream).name; }

class DigestCheck {
 public:
  DigestCheck(Scenario& scenario, const VerifyOptions& options, VertexOrder order)
      : options_(options),
        order_(order),
        // In pieces too, where a sort's working storage passes from stage to stage.
        run_(scenario, {.isa = BestIsa(), .vertex_order = order, .piecewise_sort = true}, {}, {}),
        stages_(run_.scene()) {
    for (uint32_t f = 0; f < options.frames; ++f) run_.RunFrame(f);
  }

  void Run(VerifyReport& report) {
    CheckRoles(report);
    for (uint32_t s = 0; s < kStreamCount; ++s) {
      const StreamDesc& desc = DescribeStream(Stream(s));
      if (desc.role != Role::kValue || !IsWrittenHere(Stream(s))) continue;
      CheckResult result = NewResult(fmt::format("stream {}", desc.name));
      CheckCover(Stream(s), result);
      CheckFlips(Stream(s), result);
      report.checks.push_back(std::move(result));
    }
  }

 private:
  CheckResult NewResult(std::string name) const {
    CheckResult result;
    result.section = "digest";
    result.name = fmt::format("{}, vertices {}", name, VertexOrderName(order_));
    return result;
  }
  static void Fail(CheckResult& result, Stream stream, std::string text) {
    if (result.passed)
      result.Fail({FindingKind::kDigest, "", std::string(NameOf(stream)), std::move(text)});
  }
  uint64_t DigestOf(Stream stream) const {
    return options_.digest_stream ? options_.digest_stream(run_.scene(), stream)
                                  : run_.scene().DigestStream(stream);
  }
  bool IsWrittenHere(Stream stream) const {
    for (const Stage& stage : run_.plan().stages)
      for (const PortDesc& port : stage.kernel.ports)
        if (port.stream == stream && IsWritten(port.access)) return true;
    return false;
  }

  // What outlives a frame: results that no stage reads, and state that one reads before any writes
  // it. Those are values, or bookkeeping.
  void CheckRoles(VerifyReport& report) {
    CheckResult result = NewResult("streams that outlive the frame");
    for (uint32_t s = 0; s < kStreamCount; ++s) {
      // Working storage of one stage.
      if (Stream(s) == StreamOf<&Streams::sort_words>) continue;
      bool written = false, read = false, carried = false;
      for (const Stage& stage : run_.plan().stages)
        for (const PortDesc& port : stage.kernel.ports) {
          if (port.stream != Stream(s)) continue;
          if (IsRead(port.access)) {
            read = true;
            carried |= !written;
          }
          written |= IsWritten(port.access);
        }
      if (!written || (read && !carried)) continue;
      ++result.seen;
      const Role role = DescribeStream(Stream(s)).role;
      if (role == Role::kValue || (carried && role == Role::kBookkeeping)) continue;
      Fail(
          result, Stream(s),
          fmt::format("stream {} is {}, and the stream table has it as '{}', which no digest holds",
                      NameOf(Stream(s)), carried ? "kept from frame to frame" : "a result",
                      RoleName(role)));
    }
    report.checks.push_back(std::move(result));
  }

  // Bytes of a block that no row covers are padding: they stay what they were made, zero.
  void CheckCover(Stream stream, CheckResult& result) {
    const StreamDesc& desc = DescribeStream(stream);
    std::vector<bool> covered(desc.block_bytes, false);
    for (const RowDesc& row : desc.rows) {
      const size_t end = row.offset_bytes + size_t(row.element_count) * BytesOf(row);
      std::fill(covered.begin() + row.offset_bytes,
                covered.begin() + ptrdiff_t(std::min(end, covered.size())), true);
    }
    for (uint32_t i = 0; i < run_.scene().shape().ItemCount(desc.domain); ++i) {
      const std::byte* block = run_.scene().memory().Block(stream, i);
      for (size_t b = 0; block && b < desc.block_bytes; ++b)
        if (!covered[b] && block[b] != std::byte{0})
          return Fail(
              result, stream,
              fmt::format("byte {} of its blocks holds something, and no row covers it", b));
    }
  }

  uint32_t CountLive(Stream stream, uint32_t item) const {
    const FurScene& scene = run_.scene();
    const StreamDesc& desc = DescribeStream(stream);
    if (desc.lanes.AllHoldValues()) return kStrandsPerChunk;
    const SceneShape& shape = scene.shape();
    const auto state = [&](uint32_t c) -> const ChunkStateBlock& {
      return *scene.memory().Of<&Streams::chunk_state>(c);
    };
    const bool unsorted = order_ == VertexOrder::kIndexBuffer;
    const OutputEntry* output = unsorted ? FindOutputIn(stream) : nullptr;
    if (output && output->in_strand_order != stream) return 0;  // nothing writes it
    const auto counts = desc.lanes.count;
    if (counts == &streams_detail::CountVertices)
      return scene.memory().Of<&Streams::patch_state>(item)->live_vertices;
    if (counts == &streams_detail::CountLiveChains)
      return scene.memory().Of<&Streams::patch_state>(item)->live_chains;
    if (counts == &streams_detail::CountStrands || output) return state(item).live_strands;
    const uint32_t layer = shape.chunk_layer[item];
    uint32_t drawn = 0;
    for (uint32_t c = shape.layer_first_chunk[layer]; c < shape.layer_first_chunk[layer + 1]; ++c)
      drawn += state(c).visible_strands;
    const uint32_t before = (item - shape.layer_first_chunk[layer]) * kStrandsPerChunk;
    return drawn > before ? std::min(drawn - before, kStrandsPerChunk) : 0;
  }

  void CheckFlips(Stream stream, CheckResult& result) {
    const FurScene& scene = run_.scene();
    const StreamDesc& desc = DescribeStream(stream);
    before_ = DigestOf(stream);
    std::vector<uint32_t> items;
    for (uint32_t i = 0; i < scene.shape().ItemCount(desc.domain); ++i)
      if (scene.memory().Block(stream, i)) items.push_back(i);
    const uint32_t step = std::max(1u, uint32_t(items.size()) / kMostItems);
    for (size_t n = 0; n < items.size() && result.passed; n += step) {
      const uint32_t live = CountLive(stream, items[n]);
      // Every row of the first, the last and one between; one row of all others.
      const bool all_rows = n == 0 || n + step >= items.size() || n == items.size() / 2;
      const uint32_t one = random_.Below(uint32_t(desc.rows.size()));
      for (uint32_t r = 0; r < desc.rows.size() && result.passed; ++r)
        if (all_rows || r == one) FlipRow(stream, items[n], desc.rows[r], live, result);
      if (live != 0 && all_rows && result.passed)
        SwapElements(stream, items[n], items[(n + step) % items.size()], live, result);
    }
    if (result.passed && result.seen == 0)
      result.LeaveOut("no live lane in the last frame of this course");
    if (result.passed && result.seen != 0) FlipForLogs(stream, items, result);
  }

  struct Element {
    uint32_t lane, component;
  };

  void FlipRow(Stream stream, uint32_t item, const RowDesc& row, uint32_t live,
               CheckResult& result) {
    const bool all = DescribeStream(stream).lanes.AllHoldValues();
    const uint32_t lanes = all ? row.lane_count : std::min(row.lane_count, live);
    if (lanes == 0) return;
    const uint32_t components = row.element_count / row.lane_count;
    const Element elements[] = {
        {0, components - 1}, {lanes - 1, 0}, {random_.Below(lanes), random_.Below(components)}};
    for (const Element& e : elements) {
      std::byte* at = AddressOf(stream, item, row, e) + random_.Below(BytesOf(row));
      const auto bit = std::byte(1u << random_.Below(8));
      *at ^= bit;
      ++result.seen;
      if (DigestOf(stream) == before_)
        Fail(result, stream,
             fmt::format("a bit flipped in item {}, row {}[{}], lane {} of {} leaves its digest as "
                         "it was",
                         item, row.name, e.component, e.lane, lanes));
      *at ^= bit;
    }
  }

  // The first value of each row with the last one, with the next row's and with another item's.
  void SwapElements(Stream stream, uint32_t item, uint32_t other, uint32_t live,
                    CheckResult& result) {
    const StreamDesc& desc = DescribeStream(stream);
    const bool all = desc.lanes.AllHoldValues();
    for (size_t r = 0; r < desc.rows.size(); ++r) {
      const RowDesc& row = desc.rows[r];
      const uint32_t lanes = all ? row.lane_count : std::min(row.lane_count, live);
      const uint32_t components = row.element_count / row.lane_count;
      std::byte* first = AddressOf(stream, item, row, {0, 0});
      const auto swap = [&](std::byte* with, std::string_view what) {
        if (std::equal(first, first + BytesOf(row), with)) return;
        std::swap_ranges(first, first + BytesOf(row), with);
        ++result.seen;
        if (DigestOf(stream) == before_)
          Fail(result, stream,
               fmt::format("the first value of item {}, row {}, and that of {} change places, and "
                           "its digest stays as it was",
                           item, row.name, what));
        std::swap_ranges(first, first + BytesOf(row), with);
      };
      swap(AddressOf(stream, item, row, {lanes - 1, components - 1}), "the last lane");
      if (r + 1 < desc.rows.size() && BytesOf(desc.rows[r + 1]) == BytesOf(row))
        swap(AddressOf(stream, item, desc.rows[r + 1], {0, 0}), "the next row");
      if (all || CountLive(stream, other) != 0)
        swap(AddressOf(stream, other, row, {0, 0}), "another item");
    }
  }

  static uint32_t BytesOf(const RowDesc& row) {
    return row.type == ElementType::kU8 ? 1 : row.type == ElementType::kU16 ? 2 : 4;
  }
  std::byte* AddressOf(Stream stream, uint32_t item, const RowDesc& row, const Element& e) const {
    const uint32_t components = row.element_count / row.lane_count;
    const uint32_t index =
        row.lane_major ? e.lane * components + e.component : e.component * row.lane_count + e.lane;
    return run_.scene().memory().Block(stream, item) + row.offset_bytes +
           size_t(index) * BytesOf(row);
  }

  // The frame's digest and the log's columns, once a stream: each is as long as all of it.
  void FlipForLogs(Stream stream, const std::vector<uint32_t>& items, CheckResult& result) {
    const StreamDesc& desc = DescribeStream(stream);
    const RowDesc& row = desc.rows.front();
    for (const uint32_t item : items) {
      if (CountLive(stream, item) == 0) continue;
      // Logs have what stages ran on; blocks of layers are there for those of any kind.
      if (desc.domain == Domain::kLayer &&
          !desc.kinds.Admits(run_.scene().shape().layer_kind[item]))
        continue;
      const uint64_t frame = run_.scene().DigestFrame();
      const DigestLog log = LogFrame();
      std::byte* at = AddressOf(stream, item, row, {0, 0});
      *at ^= std::byte{1};
      if (run_.scene().DigestFrame() == frame)
        Fail(result, stream, "a bit flipped in it leaves the frame's digest as it was");
      const DigestLog flipped = LogFrame();
      bool seen = false;
      for (size_t c = 0; c + 1 < log.columns.size(); ++c)  // the last is the frame's
        seen |= log.columns[c].stream == NameOf(stream) && log.digests[c] != flipped.digests[c];
      if (!seen)
        Fail(result, stream,
             "a bit flipped in it leaves its columns of the digest log as they were");
      *at ^= std::byte{1};
      return;
    }
  }

  DigestLog LogFrame() const {
    DigestLog log = stages_.Begin("", "", order_);
    stages_.AddFrame(run_.scene(), log);
    return log;
  }

  const VerifyOptions& options_;
  VertexOrder order_;
  mutable CaseRun run_;
  StageDigests stages_;
  uint64_t before_ = 0;
  Random random_{1};
};

}  // namespace

void CheckDigests(Scenario& scenario, const VerifyOptions& options, VerifyReport& report) {
  for (const VertexOrder order : {VertexOrder::kSorted, VertexOrder::kIndexBuffer})
    DigestCheck(scenario, options, order).Run(report);
}

}  // namespace pelt
