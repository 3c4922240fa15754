#include "jobs/frame_graph.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <set>
#include <utility>

#include "jobs/plan.hpp"

namespace pelt {
namespace {

// Layers of at least so many chunks have some in every place: their sort, which waits for all of
// them, then begins while other layers are at work. The others lie one after the other.
constexpr uint32_t kLargeLayerChunks = 32;
// So many of them at most, the largest: each has words of its own in every place.
constexpr uint32_t kMostLargeLayers = 8;
constexpr uint32_t kNone = ~0u;

// Which place each patch and chunk has, and in which order they are best run: those of large layers
// first, because most waits for them; the others in the scene's order, as neighbours have data in common.
class Places {
 public:
  explicit Places(const SceneShape& shape) : shape_(shape), is_large_(shape.layer_count, false) {
    count_ =
        std::clamp(std::max(shape.chunk_count, shape.patch_count), 1u, FrameGraph::kMostPlaces);
    std::vector<uint32_t> by_size(shape.layer_count), small;
    std::iota(by_size.begin(), by_size.end(), 0u);
    std::stable_sort(by_size.begin(), by_size.end(), [&](uint32_t a, uint32_t b) {
      return shape.LayerChunks(a) > shape.LayerChunks(b);
    });
    for (const uint32_t l : by_size) {
      if (shape.LayerChunks(l) < kLargeLayerChunks || groups_.size() == kMostLargeLayers) break;
      is_large_[l] = true;
      groups_.push_back({l});
    }
    for (uint32_t l = 0; l < shape.layer_count; ++l) {
      small_before_.push_back(small_weight_);
      if (is_large_[l]) continue;
      small_weight_ += Weight(l);
      small.push_back(l);
    }
    groups_.push_back(std::move(small));
  }
  uint32_t Count() const { return count_; }
  // Layers, in the order in which their items are best begun.
  const std::vector<std::vector<uint32_t>>& Groups() const { return groups_; }

  // Of item `i` of the layer's `items` patches or chunks; equal shares of them have equal places.
  uint32_t Of(uint32_t layer, uint32_t i, uint32_t items) const {
    uint64_t at = 2 * i + 1, of = 2 * items;  // the item's middle
    if (!is_large_[layer]) {
      at = 2 * uint64_t(items) * small_before_[layer] + at * Weight(layer);
      of *= small_weight_;
    }
    return uint32_t(at * count_ / of);
  }

 private:
  uint32_t Weight(uint32_t layer) const { return std::max(1u, shape_.LayerChunks(layer)); }

  const SceneShape& shape_;
  uint32_t count_, small_weight_ = 0;
  std::vector<bool> is_large_;
  std::vector<uint32_t> small_before_;
  std::vector<std::vector<uint32_t>> groups_;
};

// Of a unit the coarser unit it is in.
uint32_t UnitOf(const SceneShape& shape, Domain domain, uint32_t unit, Domain coarser) {
  if (coarser == domain) return unit;
  if (coarser == Domain::kScene) return 0;
  const uint32_t layer = shape.LayerOf(domain, unit);
  return coarser == Domain::kLayer ? layer : shape.layer_character[layer];
}

class Builder {
 public:
  Builder(const Plan& plan, const SceneShape& shape, const FrameMemory* memory)
      : plan_(plan), shape_(shape), memory_(memory) {}

  FrameGraph Build() {
    beginning_ = AddNodes(1);
    for (uint32_t p = 0; p < plan_.passes.size(); ++p) {
      graph_.pass_first.push_back(uint32_t(graph_.item_node.size()));
      graph_.item_node.resize(graph_.item_node.size() + Items(p));
    }
    bits_.resize(graph_.item_node.size());
    PlaceItems();
    for (uint32_t p = 0; p < plan_.passes.size(); ++p) AddEnds(p);
    for (uint32_t p = 0; p < plan_.passes.size(); ++p) AddStarts(p);
    AddEndOfFrame();
    Pack();
    return std::move(graph_);
  }

 private:
  struct Bit {
    uint32_t word, bit;
  };
  using Ends = std::array<uint32_t, kDomainCount>;  // of a unit's domain: its first node, or kNone

  uint32_t Items(uint32_t pass) const { return shape_.ItemCount(plan_.passes[pass].domain); }
  uint32_t AddNodes(uint32_t count) {
    waits_.resize(waits_.size() + count);
    return uint32_t(waits_.size()) - count;
  }
  void AddEdge(uint32_t from, uint32_t to) {
    edges_.emplace_back(from, to);
    ++waits_[to];
  }

  // ---- Where items lie --------------------------------------------------------------------------

  // Items of a pass that each place has in words next to each other.
  struct Track {
    uint32_t pass;
    std::vector<std::vector<uint32_t>> placed;  // of places
    uint32_t words = 0;                         // in every place
  };

  void PlaceItems() {
    const Places places(shape_);
    std::vector<Track> tracks;
    for (uint32_t p = 0; p < plan_.passes.size(); ++p) {
      const Domain domain = plan_.passes[p].domain;
      std::vector<uint32_t> common;
      for (uint32_t i = 0; domain < Domain::kLayer && i < Items(p); ++i) common.push_back(i);
      for (const std::vector<uint32_t>& group : places.Groups()) {
        if (domain == Domain::kLayer) common.insert(common.end(), group.begin(), group.end());
        if (IsInLayer(domain)) tracks.push_back(PlaceGroup(p, group, places));
      }
      AddWords(p, common, WordsFor(common));
    }
    graph_.layout = {uint32_t(graph_.words.size()), 0, places.Count()};
    for (const Track& track : tracks) graph_.layout.in_place += track.words;
    for (uint32_t place = 0; place < places.Count(); ++place) {
      graph_.words.resize(graph_.layout.Word(place, 0));
      for (const Track& track : tracks) AddWords(track.pass, track.placed[place], track.words);
    }
  }
  Track PlaceGroup(uint32_t pass, const std::vector<uint32_t>& layers, const Places& places) const {
    const Domain domain = plan_.passes[pass].domain;
    Track track{pass, std::vector<std::vector<uint32_t>>(places.Count())};
    for (const uint32_t layer : layers) {
      const uint32_t items = shape_.LayerItems(domain, layer);
      for (uint32_t i = 0; i < items; ++i)
        track.placed[places.Of(layer, i, items)].push_back(shape_.LayerFirst(domain, layer) + i);
    }
    for (const auto& items : track.placed) track.words = std::max(track.words, WordsFor(items));
    return track;
  }
  static uint32_t WordsFor(const std::vector<uint32_t>& items) {
    return uint32_t(items.size() + 63) / 64;
  }
  void AddWords(uint32_t pass, const std::vector<uint32_t>& items, uint32_t words) {
    for (uint32_t w = 0; w < words; ++w) {
      const auto word = uint32_t(graph_.words.size());
      graph_.words.push_back({pass, uint32_t(graph_.items.size())});
      for (size_t i = 64 * size_t(w); i < std::min(items.size(), 64 * (size_t(w) + 1)); ++i) {
        bits_[graph_.pass_first[pass] + items[i]] = {word, uint32_t(i % 64)};
        graph_.items.push_back(items[i]);
      }
    }
  }

  // ---- What waits for what ----------------------------------------------------------------------

  // A wait by a list that can be read is for single items.
  Domain UnitWaitedFor(const Wait& wait) const {
    return wait.list != Stream::kNone && memory_ ? plan_.passes[wait.pass].domain : wait.within;
  }
  Domain UnitThatWaits(const Wait& wait, Domain waiting) const {
    return wait.list != Stream::kNone && memory_ ? waiting : wait.within;
  }

  // A node for the end of each unit that is waited for: of the finest ones each counts its items, of coarser ones
  // the finest ones.
  void AddEnds(uint32_t pass) {
    const Domain domain = plan_.passes[pass].domain;
    std::set<Domain> units;
    for (const Wait& wait : plan_.waits_of_end)
      if (wait.pass == pass) units.insert(Domain::kScene);
    for (const Pass& later : plan_.passes)
      for (const Wait& wait : later.waits)
        if (wait.pass == pass) units.insert(UnitWaitedFor(wait));
    if (units.empty()) units.insert(Domain::kScene);
    // Not all of a scene's chunks count in one place: many cores would wait for it.
    if (IsInLayer(domain) && *units.begin() < Domain::kLayer) units.insert(Domain::kLayer);
    const Domain finest = *units.rbegin();
    Ends& ends = ends_.emplace_back();
    ends.fill(kNone);
    for (const Domain unit : units) ends[size_t(unit)] = AddNodes(shape_.ItemCount(unit));
    for (uint32_t i = 0; i < Items(pass); ++i) {
      const uint32_t node = ends[size_t(finest)] + UnitOf(shape_, domain, i, finest);
      graph_.item_node[graph_.pass_first[pass] + i] = node;
      ++waits_[node];
    }
    for (const Domain unit : units)
      for (uint32_t f = 0; unit != finest && f < shape_.ItemCount(finest); ++f)
        if (waits_[ends[size_t(finest)] + f] > 0)
          AddEdge(ends[size_t(finest)] + f, ends[size_t(unit)] + UnitOf(shape_, finest, f, unit));
  }
  void AddEndEdge(uint32_t pass, Domain unit, uint32_t which, uint32_t to) {
    const uint32_t end = ends_[pass][size_t(unit)] + which;
    if (waits_[end] > 0) AddEdge(end, to);
  }

  // A node for each group of items that become ready together.
  void AddStarts(uint32_t pass) {
    const Domain domain = plan_.passes[pass].domain;
    const std::vector<Wait>& waits = plan_.passes[pass].waits;
    Domain unit = Domain::kScene;
    for (const Wait& wait : waits) unit = std::max(unit, UnitThatWaits(wait, domain));
    const uint32_t starts = AddNodes(shape_.ItemCount(unit));
    for (uint32_t i = 0; i < Items(pass); ++i)
      opens_.emplace_back(starts + UnitOf(shape_, domain, i, unit),
                          bits_[graph_.pass_first[pass] + i]);
    for (uint32_t u = 0; u < shape_.ItemCount(unit); ++u) {
      for (const Wait& wait : waits)
        if (wait.list != Stream::kNone && memory_)
          for (const uint32_t named : NamedItems(pass, wait, u))
            AddEndEdge(wait.pass, plan_.passes[wait.pass].domain, named, starts + u);
        else
          AddEndEdge(wait.pass, wait.within, UnitOf(shape_, unit, u, wait.within), starts + u);
      if (waits_[starts + u] == 0) AddEdge(beginning_, starts + u);
    }
  }
  // The items of `wait.pass` whose records the list of chunk `chunk` names.
  std::set<uint32_t> NamedItems(uint32_t pass, const Wait& wait, uint32_t chunk) const {
    std::set<uint32_t> named;
    const Domain domain = plan_.passes[wait.pass].domain;
    const uint32_t layer = shape_.chunk_layer[chunk];
    const auto* list = memory_->As<const uint32_t>(wait.list, chunk);
    const Pass& waiting = plan_.passes[pass];
    for (uint32_t s = waiting.first_stage; list && s < waiting.first_stage + waiting.stage_count;
         ++s)
      for (const PortDesc& port : plan_.stages[s].kernel.ports) {
        if (port.access != Access::kGather || port.record_list != wait.list ||
            port.domain != domain)
          continue;
        for (uint32_t r = 0; r < port.records; ++r) {
          const uint64_t item = uint64_t(list[r]) * port.block_bytes / port.stride;
          if (item < shape_.LayerItems(domain, layer))
            named.insert(shape_.LayerFirst(domain, layer) + uint32_t(item));
        }
      }
    return named;
  }

  void AddEndOfFrame() {
    const uint32_t end = AddNodes(1);
    for (const Wait& wait : plan_.waits_of_end) AddEndEdge(wait.pass, Domain::kScene, 0, end);
    if (waits_[end] == 0) AddEdge(beginning_, end);
  }

  // What was gathered, node by node, one after the other.
  void Pack() {
    std::stable_sort(edges_.begin(), edges_.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::stable_sort(opens_.begin(), opens_.end(), [](const auto& a, const auto& b) {
      return std::pair(a.first, a.second.word) < std::pair(b.first, b.second.word);
    });
    auto edge = edges_.begin();
    auto open = opens_.begin();
    for (uint32_t n = 0; n <= waits_.size(); ++n) {
      const auto first_open = uint32_t(graph_.opens.size());
      graph_.nodes.push_back(
          {n < waits_.size() ? waits_[n] : 0, first_open, uint32_t(graph_.next.size())});
      for (; open != opens_.end() && open->first == n; ++open) {
        const auto [word, bit] = open->second;
        if (graph_.opens.size() == first_open || graph_.opens.back().word != word)
          graph_.opens.push_back({word, 0});
        graph_.opens.back().bits |= uint64_t{1} << bit;
      }
      for (; edge != edges_.end() && edge->first == n; ++edge) graph_.next.push_back(edge->second);
    }
  }

  const Plan& plan_;
  const SceneShape& shape_;
  const FrameMemory* memory_;
  FrameGraph graph_;
  uint32_t beginning_ = 0;
  std::vector<Bit> bits_;                             // of items, as graph_.item_node
  std::vector<uint32_t> waits_;                       // of nodes
  std::vector<std::pair<uint32_t, uint32_t>> edges_;  // of nodes
  std::vector<std::pair<uint32_t, Bit>> opens_;       // by nodes
  std::vector<Ends> ends_;                            // of passes
};

}  // namespace

uint64_t FrameGraph::HeapBytes() const {
  const auto bytes = [](const auto& v) { return uint64_t(v.capacity()) * sizeof(v[0]); };
  return bytes(nodes) + bytes(opens) + bytes(next) + bytes(words) + bytes(items) +
         bytes(pass_first) + bytes(item_node);
}

FrameGraph BuildGraph(const Plan& plan, const SceneShape& shape, const FrameMemory* memory) {
  return Builder(plan, shape, memory).Build();
}

}  // namespace pelt
