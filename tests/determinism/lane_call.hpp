// One call of a patch's or chunk's kernel as it comes up in a running scene, to be repeated with
// its lanes in other places and on every instruction set.
//
// The tables say which rows are by lane (core/block_rows.hpp) and whose lanes they are, so a new
// kernel or stream needs nothing here.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "core/float_environment.hpp"
#include "core/kernels/frame_table.hpp"
#include "core/random.hpp"
#include "core/streams.hpp"
#include "jobs/frame.hpp"

namespace pelt::testing {

inline constexpr uint32_t kLanes = kStrandsPerChunk;

using Places = std::vector<uint32_t>;  // [lane]: the one whose values it gets

// ---- Lanes of a block --------------------------------------------------------------------------

struct alignas(kBlockAlignment) Line {
  std::byte bytes[kBlockAlignment];
};
using Bytes = std::vector<Line>;
inline std::byte* At(Bytes& bytes) { return bytes.front().bytes; }

// Values of lanes: `count` times `lanes` of `bytes` each, `pitch` lanes from one to the next.
struct LaneRow {
  std::string_view name;
  uint32_t offset, bytes, lanes, count, pitch;

  void Move(std::byte* from, std::byte* to, const Places& places) const {
    for (uint32_t c = 0; c < count; ++c) {
      const uint32_t first = offset + c * pitch * bytes;
      if (bytes == 4) {
        const auto* old = reinterpret_cast<const uint32_t*>(from + first);
        auto* now = reinterpret_cast<uint32_t*>(to + first);
        for (uint32_t l = 0; l < lanes; ++l) now[l] = old[places[l]];
      } else {
        for (uint32_t l = 0; l < lanes; ++l)
          std::memcpy(to + first + l * bytes, from + first + places[l] * bytes, bytes);
      }
    }
  }
  // The first of the lanes `sure` that differs; `lanes` if none does.
  uint32_t FirstDifference(const std::byte* a, const std::byte* b,
                           const std::vector<bool>& sure) const {
    for (uint32_t c = 0; c < count; ++c) {
      const uint32_t first = offset + c * pitch * bytes;
      if (std::memcmp(a + first, b + first, lanes * bytes) == 0) continue;
      for (uint32_t l = 0; l < lanes; ++l)
        if (sure[l] && std::memcmp(a + first + l * bytes, b + first + l * bytes, bytes) != 0)
          return l;
    }
    return lanes;
  }
};

enum class LanesOf : uint8_t { kNothing, kVertices, kStrands };

// What a stream's lanes are. A halo's are places that strands refer to.
inline LanesOf OwnerOf(const StreamDesc& stream) {
  if (!IsInLayer(stream.domain)) return LanesOf::kNothing;
  for (const std::string_view other :
       {"patches", "patch_state", "chunk_state", "halo", "patch_list"})
    if (stream.name == other) return LanesOf::kNothing;
  return stream.domain == Domain::kPatch ? LanesOf::kVertices : LanesOf::kStrands;
}

constexpr uint32_t SizeOf(ElementType type) {
  return type == ElementType::kU8 ? 1 : type == ElementType::kU16 ? 2 : 4;
}

inline std::vector<LaneRow> LaneRowsOf(const StreamDesc& stream) {
  std::vector<LaneRow> rows;
  for (const RowDesc& row : stream.rows) {
    // Weights of vertices are by groups of 16; rows of modal state are a little longer.
    const bool weights = stream.name == "mesh" && row.name == "weight";
    const uint32_t lanes = weights ? kLaneGroup : kLanes;
    if (row.lane_count < lanes) continue;
    const uint32_t parts = row.element_count / row.lane_count, size = SizeOf(row.type);
    rows.push_back({row.name, row.offset_bytes, row.lane_major ? size * parts : size, lanes,
                    row.lane_major ? 1 : parts, row.lane_count});
  }
  return rows;
}

// What these write depends on a lane's number (its tag, what is random of it, how it fades), so
// some of its lanes stay where they are while the others change places.
inline bool IsNumbered(std::string_view kernel) {
  return kernel.starts_with("fit_") || kernel.ends_with("looks");
}

// ---- One call of a kernel ----------------------------------------------------------------------

struct Port {
  Binding main;
  bool written = false, moves = false;
  std::vector<LaneRow> rows;
  Bytes given, moved, found, base, expected;
  std::string_view stream;
  uint32_t live = 0;
};

class Call {
 public:
  Call(const Frame& frame, const Stage& stage, uint32_t item)
      : memory_(*frame.memory), stage_(stage), item_(item), ports_(stage.kernel.ports.size()) {
    for (const PortDesc& port : stage.kernel.ports)
      if (IsWritten(port.access)) {
        const LanesOf owner = OwnerOf(DescribeStream(port.stream));
        if (owner != LanesOf::kNothing) lanes_of_ = owner;
      }
    for (size_t p = 0; p < ports_.size(); ++p) Load(stage.kernel.ports[p], ports_[p]);
    FindClasses();
  }

  bool HasLanes() const { return lanes_of_ != LanesOf::kNothing; }

  // A random order of the lanes of each class.
  Places Shuffled(Random& random) const {
    Places places(kLanes);
    std::iota(places.begin(), places.end(), 0u);
    const auto shuffle = [&](uint32_t begin, uint32_t end) {
      Places moved;
      for (uint32_t l = begin; l < end; ++l)
        if (!numbered_ || random.Below(2) == 0) moved.push_back(l);
      for (uint32_t i = uint32_t(moved.size()); i > 1; --i)
        std::swap(places[moved[i - 1]], places[moved[random.Below(i)]]);
    };
    if (by_group_) {
      shuffle(0, kLaneGroup);
      for (uint32_t l = kLaneGroup; l < kLanes; ++l)
        places[l] = l / kLaneGroup * kLaneGroup + places[l % kLaneGroup];
    } else {
      for (size_t c = 0; c + 1 < ends_.size(); ++c) shuffle(ends_[c], ends_[c + 1]);
    }
    return places;
  }
  // Each group is lane k of it, many times; those that others follow are as they are.
  Places Alone(uint32_t k) const {
    Places places(kLanes);
    for (uint32_t l = 0; l < kLanes; ++l)
      places[l] = l < controls_ ? l : l / kLaneGroup * kLaneGroup + k;
    return places;
  }

  // Puts the lanes so, runs the kernel of every set, and compares with what each got in its own
  // place, which the first call, of all lanes in their places, has found.
  void Try(const Places& places, bool whole, const std::string& what) {
    if (::testing::Test::HasFailure()) return;
    Places back(kLanes, kLanes);
    for (uint32_t l = 0; l < kLanes; ++l)
      if (back[places[l]] == kLanes || places[l] == l) back[places[l]] = l;
    for (Port& port : ports_) {
      if (port.moves) Move(port, port.given, port.moved, places, &back);
      if (port.moves && port.written && has_base_)
        Move(port, port.base, port.expected, places, nullptr);
    }
    for (const Isa isa : kAllIsas) {
      const FrameTable* table = FindKernels(isa);
      if (!table) continue;
      RunOn(*table->Find(stage_.kernel.name));
      if (!has_base_)
        for (Port& port : ports_) port.base = port.expected = port.found;
      has_base_ = true;
      Compare(places, whole, what + ", " + std::string(IsaName(isa)));
      if (::testing::Test::HasFailure()) return;
    }
  }

 private:
  uint32_t Layer() const { return memory_.shape->LayerOf(stage_.domain, item_); }

  void Load(const PortDesc& desc, Port& port) {
    const StreamDesc& stream = DescribeStream(desc.stream);
    port.stream = stream.name;
    port.main = BindPort(desc, memory_, stage_.domain, item_);
    port.written = IsWritten(desc.access);
    const bool gathers = desc.access == Access::kGather;
    // What is gathered lies as its list does.
    const LanesOf owner = OwnerOf(gathers ? DescribeStream(desc.record_list) : stream);
    port.moves = owner == lanes_of_ && HasLanes();
    if (!port.moves && !port.written) return;
    port.given.resize((size_t(desc.block_bytes) * port.main.count + sizeof(Line) - 1) /
                      sizeof(Line));
    if (gathers) {
      // As a local store has them: in the order of the list.
      port.rows = {{stream.name, 0, desc.block_bytes, kLanes, 1, kLanes}};
      const uint32_t records = memory_.shape->LayerItems(desc.domain, Layer()) * kLanes;
      for (uint32_t i = 0; i < kLanes; ++i)
        if (port.main.index[i] < records)
          std::memcpy(At(port.given) + size_t(i) * desc.block_bytes,
                      static_cast<std::byte*>(port.main.block) +
                          size_t(port.main.index[i]) * desc.block_bytes,
                      desc.block_bytes);
    } else {
      std::memcpy(At(port.given), port.main.block, desc.block_bytes);
      if (port.moves) port.rows = LaneRowsOf(stream);
      if (port.written && port.moves) port.live = memory_.LiveLanes(desc.stream, item_);
    }
    by_group_ |= stream.name == "mesh" && port.moves;
    port.moved = port.given;
  }

  // Lanes that a kernel treats alike: controls, old ones, new ones, and those that do not live.
  void FindClasses() {
    const bool vertices = stage_.domain == Domain::kPatch;
    const auto& state = vertices ? *memory_.Of<&Streams::patch_state>(item_)
                                 : *memory_.Of<&Streams::chunk_state>(item_);
    const auto& layer = *memory_.Of<&Streams::layers>(Layer());
    std::set<uint32_t> ends = {0, kLanes};
    ends.insert(std::min(kLanes, vertices ? state.first_new_vertex : state.first_new_strand));
    ends.insert(std::min(kLanes, vertices ? state.live_vertices : state.live_strands));
    if (vertices) {
      const uint32_t count = memory_.Of<&Streams::patches>(item_)->vertex_count;
      for (const uint32_t end : {state.first_new_chain, state.whole_chains, state.live_chains})
        ends.insert(std::min(kLanes, end));
      // Chains that are left out follow those before their level.
      for (uint32_t level = 1; level < kChainLevels; ++level)
        ends.insert(CountChains(count, level));
      if (state.whole_chains < state.live_vertices && FindPort("chain_parents"))
        controls_ = CountChains(count, 1);
    }
    for (const Port& port : ports_)
      if (port.written && port.moves) ends.insert(port.live);
    if (!vertices && (layer.flags & kLayerClump))
      controls_ = std::min(kLanes, memory_.Of<&Streams::strands>(item_)->control_count);
    ends.insert(controls_);
    ends_.assign(ends.begin(), ends.end());
  }
  size_t ClassOf(uint32_t lane) const {
    return size_t(std::upper_bound(ends_.begin(), ends_.end(), lane) - ends_.begin());
  }

  const Port* FindPort(std::string_view stream) const {
    const auto found = std::ranges::find(ports_, stream, &Port::stream);
    return found == ports_.end() ? nullptr : &*found;
  }

  // `back`: where a control strand, and a chain that others follow, is now.
  static void Move(const Port& port, Bytes& from, Bytes& to, const Places& places,
                   const Places* back) {
    to = from;
    for (const LaneRow& row : port.rows) {
      row.Move(At(from), At(to), places);
      if (back && port.stream == "chain_parents" && row.name == "lanes") {
        auto* lanes = reinterpret_cast<uint8_t*>(At(to) + row.offset);
        for (uint32_t l = 0; l < 4 * kLanes; ++l)
          if (const uint32_t c = (*back)[lanes[l]]; c < kLanes) lanes[l] = uint8_t(c);
      }
      if (!back || row.name != "control") continue;
      auto* control = reinterpret_cast<uint8_t*>(At(to) + row.offset);
      for (uint32_t l = 0; l < kLanes; ++l)
        if (const uint32_t c = control[l]; c < kLanes) control[l] = uint8_t((*back)[c]);
    }
  }

  void RunOn(const KernelDesc& kernel) {
    Binding bindings[kMaxPorts];
    for (size_t p = 0; p < ports_.size(); ++p) {
      Port& port = ports_[p];
      bindings[p] = port.main;
      if (!port.moves && !port.written) continue;
      if (port.written) port.found = port.moved;
      bindings[p] = {At(port.written ? port.found : port.moved), nullptr, port.main.count};
    }
    const FloatEnvironment float_environment;
    kernel.run(ParamsOf(stage_, memory_, item_), bindings);
  }

  void Compare(const Places& places, bool whole, const std::string& what) {
    for (Port& port : ports_) {
      if (!port.written) continue;
      if (!port.moves) {
        if (whole &&
            std::memcmp(At(port.found), At(port.base), port.found.size() * sizeof(Line)) != 0)
          ADD_FAILURE() << what << ": what it says of the whole, " << port.stream;
        continue;
      }
      std::vector<bool> sure(kLanes);
      for (uint32_t l = 0; l < port.live; ++l)
        sure[l] = numbered_ ? places[l] == l : ClassOf(l) == ClassOf(places[l]);
      for (const LaneRow& row : port.rows) {
        const uint32_t lane = row.FirstDifference(At(port.found), At(port.expected), sure);
        if (lane == row.lanes) continue;
        ADD_FAILURE() << what << ": " << port.stream << ", " << row.name << ", lane " << lane
                      << " with the values of lane " << places[lane];
        return;
      }
    }
  }

  const FrameMemory& memory_;
  const Stage& stage_;
  uint32_t item_;
  std::vector<Port> ports_;
  LanesOf lanes_of_ = LanesOf::kNothing;
  bool by_group_ = false, has_base_ = false, numbered_ = IsNumbered(stage_.kernel.name);
  uint32_t controls_ = 0;
  std::vector<uint32_t> ends_;  // of classes
};

inline bool IsByLane(const KernelDesc& kernel) {
  return std::ranges::none_of(kernel.ports, [](const PortDesc& port) {
    return port.access == Access::kScatter || port.access == Access::kAll ||
           port.access == Access::kAllOut || port.access == Access::kAllInOut ||
           DescribeStream(port.stream).name == "digits";  // a count over the chunk
  });
}

}  // namespace pelt::testing
