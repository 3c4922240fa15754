#include "jobs/plan.hpp"

#include <algorithm>
#include <iterator>
#include <set>
#include <vector>

#include "core/format.hpp"

namespace pelt {
namespace {

// Whose end an item of a pass waits for: derived from the ports of both sides.
//
// Two items must not run at once, and keep the order of their passes, where one of them writes a
// block that the other touches. Which blocks an item may touch follows from its ports: its own, one
// of a coarser unit that it is in, all in its layer or in the scene, or those that a list names. So
// two items can meet in a block only if they are in one unit, and the coarser of the two reaches is
// the unit; the wait is for all of the earlier pass in it.

// The coarser one.
Domain Coarser(Domain a, Domain b) { return std::min(a, b); }

// What an item of a pass may touch: blocks of a stream in the unit of domain `reach` that it is in;
// where there is a list, those of them that it names.
struct Use {
  Stream stream;
  bool written;
  Domain reach;
  Stream list = Stream::kNone;
};

Use UseOf(const PortDesc& port, Domain item, const StreamTable& table) {
  switch (port.access) {
    case Access::kShared:
      return {port.stream, false, port.domain};
    case Access::kGather: {
      // A list that a stage writes is not known before the frame.
      const bool baked = table[port.record_list].role == Role::kInput;
      return {port.stream, false, Domain::kLayer, baked ? port.record_list : Stream::kNone};
    }
    case Access::kScatter:
      return {port.stream, true, Domain::kLayer};
    default:  // its own block, or all in it
      return {port.stream, IsWritten(port.access), item};
  }
}

std::vector<Use> UsesOf(const Plan& plan, const Pass& pass) {
  std::vector<Use> uses;
  for (uint32_t s = pass.first_stage; s < pass.first_stage + pass.stage_count; ++s) {
    const Stage& stage = plan.stages[s];
    for (const PortDesc& port : stage.kernel.ports) {
      uses.push_back(UseOf(port, pass.domain, *plan.table));
      if (port.access == Access::kGather) uses.push_back({port.record_list, false, pass.domain});
    }
    for (const Stream read : stage.gate.when.reads)
      if (read != Stream::kNone)
        uses.push_back({read, false, Coarser(stage.gate.when.domain, (*plan.table)[read].domain)});
  }
  return uses;
}

// Whether one of the waits is for all that `wait` is for.
bool IsCovered(const Wait& wait, const std::vector<Wait>& waits) {
  return std::any_of(waits.begin(), waits.end(), [&](const Wait& w) {
    return w.pass == wait.pass &&
           (w.within < wait.within ||
            (w.within == wait.within && (w.list == wait.list || w.list == Stream::kNone)));
  });
}

// Of one earlier pass there is the coarsest unit, or lists if nothing else waits for more.
void Add(std::vector<Wait>& waits, const Wait& wait) {
  if (IsCovered(wait, waits)) return;
  std::erase_if(waits, [&](const Wait& w) { return IsCovered(w, {wait}); });
  waits.push_back(wait);
}

// What a pass of uses `later` waits for in the pass `pass` of uses `earlier`.
void AddWaits(uint32_t pass, const std::vector<Use>& earlier, const std::vector<Use>& later,
              std::vector<Wait>& waits) {
  for (const Use& a : earlier)
    for (const Use& b : later) {
      if (a.stream != b.stream || !(a.written || b.written)) continue;
      // The list of the earlier one names what it reads; who in the layer writes that is not said.
      const bool listed = b.list != Stream::kNone && IsInLayer(a.reach);
      Add(waits, {pass, Coarser(a.reach, b.reach), listed ? b.list : Stream::kNone});
    }
}

// What an item has waited for that waits as `outer` says for a pass which itself waits as `inner`
// says; given that every unit has items of the pass between.
Wait Composed(const Wait& outer, const Wait& inner) {
  return {inner.pass, Coarser(outer.within, inner.within)};
}

// The scene has characters, each of them has layers, and each layer has items of the domain.
bool IsEverywhere(const SceneShape& shape, Domain domain) {
  if (domain == Domain::kScene) return true;
  if (shape.layer_count == 0) return false;
  std::vector<bool> has_layer(shape.character_count, false);
  for (uint32_t l = 0; l < shape.layer_count; ++l) {
    has_layer[shape.layer_character[l]] = true;
    if (IsInLayer(domain) && shape.LayerItems(domain, l) == 0) return false;
  }
  return std::find(has_layer.begin(), has_layer.end(), false) == has_layer.end();
}

// Waits, and what follows from them. A list may be empty: nothing follows from a wait by one.
class WaitsOfPasses {
 public:
  explicit WaitsOfPasses(const SceneShape& shape) : shape_(shape) {}

  // Of the next pass. Returns those that do not follow from the others.
  std::vector<Wait> Add(const std::vector<Wait>& waits, Domain domain) {
    std::vector<Wait> implied;
    for (const Wait& outer : waits) {
      const Known& between = known_[outer.pass];
      if (outer.list != Stream::kNone || !between.is_everywhere) continue;
      for (const Wait& inner : between.waits)
        if (inner.list == Stream::kNone) pelt::Add(implied, Composed(outer, inner));
    }
    std::vector<Wait> left;
    std::copy_if(waits.begin(), waits.end(), std::back_inserter(left),
                 [&](const Wait& wait) { return !IsCovered(wait, implied); });
    for (const Wait& wait : waits) pelt::Add(implied, wait);
    known_.push_back({implied, IsEverywhere(shape_, domain)});
    return left;
  }

 private:
  struct Known {
    std::vector<Wait> waits;
    bool is_everywhere;
  };
  const SceneShape& shape_;
  std::vector<Known> known_;
};

// Sets the waits of the plan's passes, from its stages alone. A wait that follows from others
// (another pass that is waited for has waited itself) is left out.
void DeriveWaits(Plan& plan, const SceneShape& shape) {
  std::vector<std::vector<Use>> uses;
  WaitsOfPasses all(shape);
  std::vector<Wait> of_end;
  for (uint32_t later = 0; later < plan.passes.size(); ++later) {
    Pass& pass = plan.passes[later];
    uses.push_back(UsesOf(plan, pass));
    std::vector<Wait> waits;
    for (uint32_t earlier = 0; earlier < later; ++earlier)
      AddWaits(earlier, uses[earlier], uses[later], waits);
    pass.waits = all.Add(waits, pass.domain);
    of_end.push_back({later, Domain::kScene});
  }
  plan.waits_of_end = all.Add(of_end, Domain::kScene);
}

// Reaches records of any item in the layer.
bool Crosses(Access a) { return a == Access::kGather || a == Access::kScatter; }
bool IsAll(Access a) { return a == Access::kAll || a == Access::kAllOut || a == Access::kAllInOut; }
bool IsStreamed(Access a) { return a != Access::kShared; }

// Ports of one stream that see it in the same manner share one copy in local store.
bool ShareCopy(Access a, Access b) {
  return Crosses(a) || Crosses(b) ? a == b : IsAll(a) == IsAll(b);
}

// What keeps `b` out of the pass of the earlier stage `a`.
bool Conflict(const Stage& a, const Stage& b) {
  for (const PortDesc& p : a.kernel.ports)
    for (const PortDesc& q : b.kernel.ports) {
      if (p.stream == q.stream && (IsWritten(p.access) || IsWritten(q.access)) &&
          (Crosses(p.access) || Crosses(q.access)))
        return true;
      // A record list is followed in main memory, so it must be there before the pass.
      if (q.access == Access::kGather && q.record_list == p.stream && IsWritten(p.access))
        return true;
    }
  return false;
}

// Some of the layers are of such a kind, and some are not. (Of none, there is no such stage.)
bool HasSomeOnly(const KindMask& kinds, const SceneShape& shape) {
  const auto admits = [&](uint32_t kind) { return kinds.Admits(kind); };
  return std::any_of(shape.layer_kind.begin(), shape.layer_kind.end(), admits) &&
         !std::all_of(shape.layer_kind.begin(), shape.layer_kind.end(), admits);
}

// Null, or why a port cannot be bound: it would reach another item's block, or none at all.
const char* FindPortFault(const StreamTable& table, const SceneShape& shape, const PortDesc& p,
                          Domain domain) {
  const StreamDesc& stream = table[p.stream];
  if (Crosses(p.access)) {
    if (domain != Domain::kChunk || !IsInLayer(stream.domain))
      return "records are gathered and scattered by chunks, among their layer's chunks and patches";
    const bool has_list =
        p.record_list != Stream::kNone && table[p.record_list].domain == Domain::kChunk;
    return p.access == Access::kGather && !has_list ? "it has no record list" : nullptr;
  }
  if (p.access == Access::kShared)
    return IsPartOf(domain, stream.domain) ? nullptr : "a shared block is one of a coarser domain";
  if (!IsAll(p.access)) return stream.domain == domain ? nullptr : "own blocks are of one domain";
  if (!IsPartOf(stream.domain, domain) || domain == Domain::kCharacter)
    return "All is for the scene, and for the chunks and patches of a layer";
  if (domain == Domain::kScene && HasSomeOnly(stream.kinds, shape))
    return "not every layer has the stream";
  return nullptr;
}

// Why a stage cannot run as it is declared, or its items would race; or empty.
std::string FindStageFault(const StreamTable& table, const SceneShape& shape, const Stage& stage) {
  const auto ports = stage.kernel.ports;
  if (&stage.kernel.table() != &table)
    return Format("stage {}: its ports are of another table of streams than the first stage's",
                  stage.kernel.name);
  if (stage.gate.when.domain != stage.domain && !IsPartOf(stage.domain, stage.gate.when.domain))
    return Format("stage {}: its gate is for a {}, and its items are in none", stage.kernel.name,
                  DomainName(stage.gate.when.domain));
  for (size_t i = 0; i < ports.size(); ++i) {
    if (const char* fault = FindPortFault(table, shape, ports[i], stage.domain))
      return Format("stage {}: port '{}': {}", stage.kernel.name, table[ports[i].stream].name,
                    fault);
    for (size_t j = 0; j < i; ++j)
      if (ports[i].stream == ports[j].stream &&
          (IsWritten(ports[i].access) || IsWritten(ports[j].access)))
        return Format("stage {}: two ports are of stream {}, and one of them is written",
                      stage.kernel.name, table[ports[i].stream].name);
  }
  return {};
}

uint32_t RoundUp(uint32_t bytes) { return (bytes + kBlockAlignment - 1) & ~(kBlockAlignment - 1); }

// Bytes one item of layer `layer` needs in local store for a port.
uint32_t PortBytes(const PortDesc& port, const SceneShape& shape, Domain domain, uint32_t layer) {
  switch (port.access) {
    case Access::kAll:
    case Access::kAllOut:
    case Access::kAllInOut: {
      const uint32_t blocks = domain == Domain::kLayer ? shape.LayerItems(port.domain, layer)
                                                       : shape.ItemCount(port.domain);
      return RoundUp(port.block_bytes * blocks);
    }
    case Access::kGather:
      return RoundUp(port.block_bytes * port.records);
    case Access::kScatter:
      return RoundUp((port.block_bytes + 4) * port.records);
    default:
      return RoundUp(port.block_bytes);
  }
}

struct StreamUse {
  uint32_t first_stage, last_stage;
};

// First and last stage of the table that uses each stream.
std::vector<StreamUse> FindUses(const std::vector<Stage>& stages, size_t stream_count) {
  std::vector<StreamUse> uses(stream_count, {~0u, 0});
  for (uint32_t s = 0; s < stages.size(); ++s)
    for (const PortDesc& p : stages[s].kernel.ports) {
      StreamUse& use = uses[size_t(p.stream)];
      use.first_stage = std::min(use.first_stage, s);
      use.last_stage = std::max(use.last_stage, s);
    }
  return uses;
}

// Whether no stage of [first, first + count) that uses the stream runs in a frame that leaves out
// the one which writes it: then no stage reads in such a frame what was not written in it.
bool ShareFrameGate(const std::vector<Stage>& stages, uint32_t first, uint32_t count, Stream stream,
                    FrameGate gate) {
  for (uint32_t s = first; s < first + count; ++s)
    for (const PortDesc& p : stages[s].kernel.ports)
      if (p.stream == stream && stages[s].gate.frame != gate &&
          !(gate == FrameGate::kFollows && stages[s].gate.frame == FrameGate::kNotPaused))
        return false;
  return true;
}

// The streams stages [first, first + count) keep resident for an item of `layer`.
std::vector<PassStream> CollectStreams(const Plan& plan, uint32_t first, uint32_t count,
                                       const SceneShape& shape, uint32_t layer,
                                       const std::vector<StreamUse>& uses) {
  const std::vector<Stage>& stages = plan.stages;
  std::vector<PassStream> out;
  for (uint32_t s = first; s < first + count; ++s) {
    const Stage& stage = stages[s];
    if (stage.domain >= Domain::kLayer && !stage.kinds.Admits(shape.layer_kind[layer])) continue;
    for (const PortDesc& p : stage.kernel.ports) {
      auto it = std::find_if(out.begin(), out.end(), [&](const PassStream& u) {
        return u.stream == p.stream && ShareCopy(u.access, p.access);
      });
      const uint32_t bytes = PortBytes(p, shape, stage.domain, layer);
      if (it == out.end()) {
        const StreamUse& use = uses[size_t(p.stream)];
        const bool inside = use.first_stage >= first && use.last_stage < first + count;
        const StreamDesc& stream = (*plan.table)[p.stream];
        // A stage that may be skipped while its readers run leaves last frame's block to them: it
        // must be kept.
        const bool transient = inside && !IsRead(p.access) && stream.kept != Kept::kOutput &&
                               (!stage.gate.when.holds || stream.role == Role::kScratch) &&
                               ShareFrameGate(stages, first, count, p.stream, stage.gate.frame);
        out.push_back({p.stream, p.access, bytes, IsRead(p.access), false, transient});
        it = out.end() - 1;
      }
      it->bytes = std::max(it->bytes, bytes);
      it->put |= IsWritten(p.access);
    }
  }
  return out;
}

uint32_t ResidentBytes(const std::vector<PassStream>& streams, bool double_buffered) {
  uint32_t bytes = 0;
  for (const PassStream& s : streams)
    bytes += s.bytes * (double_buffered && IsStreamed(s.access) && !s.transient ? 2 : 1);
  return bytes;
}

// Of each kind the layers with most patches and most chunks stand for all layers in a measurement.
std::vector<uint32_t> RepresentativeLayers(const SceneShape& shape) {
  std::vector<uint32_t> layers;
  std::set<uint32_t> kinds(shape.layer_kind.begin(), shape.layer_kind.end());
  for (uint32_t kind : kinds) {
    for (const Domain domain : {Domain::kPatch, Domain::kChunk}) {
      uint32_t largest = ~0u;
      for (uint32_t l = 0; l < shape.layer_count; ++l)
        if (shape.layer_kind[l] == kind &&
            (largest == ~0u || shape.LayerItems(domain, l) > shape.LayerItems(domain, largest)))
          largest = l;
      layers.push_back(largest);
    }
  }
  return layers;
}

Pass MeasurePass(const Plan& plan, uint32_t first, uint32_t count, const SceneShape& shape,
                 bool double_buffered, const std::vector<StreamUse>& uses) {
  Pass pass{first, count, plan.stages[first].domain, {}, 0, 0, 0, double_buffered, {}};
  for (uint32_t layer : RepresentativeLayers(shape)) {
    auto streams = CollectStreams(plan, first, count, shape, layer, uses);
    const uint32_t resident = ResidentBytes(streams, double_buffered);
    if (pass.streams.empty() || resident > pass.resident_bytes) {
      pass.resident_bytes = resident;
      pass.streams = std::move(streams);
    }
  }
  for (const PassStream& s : pass.streams) {
    if (s.get && s.access != Access::kShared) pass.get_bytes += s.bytes;
    if (s.put && !s.transient) pass.put_bytes += s.bytes;
  }
  return pass;
}

// A stage runs on the layers that have all its streams.
void AddStreamKinds(const StreamTable& table, Stage& stage) {
  for (const PortDesc& p : stage.kernel.ports) {
    stage.kinds.required |= table[p.stream].kinds.required;
    stage.kinds.forbidden |= table[p.stream].kinds.forbidden;
  }
}

bool IsAdmitted(const Stage& stage, const SceneShape& shape) {
  return (stage.kinds.required | stage.kinds.forbidden) == 0 ||
         std::any_of(shape.layer_kind.begin(), shape.layer_kind.end(),
                     [&](uint32_t kind) { return stage.kinds.Admits(kind); });
}

uint32_t CodeBytes(const PlanOptions& options, const std::vector<Stage>& stages, uint32_t first,
                   uint32_t count) {
  uint32_t bytes = 0;
  for (uint32_t s = first; options.code_bytes && s < first + count; ++s)
    bytes += options.code_bytes(stages[s].kernel.name);
  return bytes;
}

// What a pass's data may take of a local store.
uint32_t DataLimit(const PlanOptions& options, uint32_t code) {
  if (!options.code_bytes) return options.local_store_data_bytes;
  return options.code_and_data_bytes - std::min(code, options.code_and_data_bytes);
}

bool CanJoin(const std::vector<Stage>& stages, uint32_t first, uint32_t next) {
  if (stages[next].domain != stages[first].domain) return false;
  for (uint32_t s = first; s < next; ++s)
    if (Conflict(stages[s], stages[next])) return false;
  return true;
}

}  // namespace

const char* DomainName(Domain domain) {
  constexpr const char* kNames[] = {"scene", "character", "layer", "patch", "chunk"};
  return kNames[size_t(domain)];
}

Result<Plan> CompilePlan(std::vector<Stage> stages, const SceneShape& shape,
                         const PlanOptions& options) {
  Plan plan{nullptr, std::move(stages), {}, {}, {}};
  if (!plan.stages.empty()) plan.table = &plan.stages.front().kernel.table();
  for (Stage& stage : plan.stages) {
    if (std::string fault = FindStageFault(*plan.table, shape, stage); !fault.empty())
      return Failure{std::move(fault)};
    AddStreamKinds(*plan.table, stage);
  }
  // A stage for kinds of layer that the scene has none of would only cost waits.
  std::erase_if(plan.stages, [&](const Stage& s) { return !IsAdmitted(s, shape); });
  const auto uses = FindUses(plan.stages, plan.table ? plan.table->streams.size() : 0);
  uint32_t first = 0;
  while (first < plan.stages.size()) {
    uint32_t count = 1;
    const uint32_t code = CodeBytes(options, plan.stages, first, 1);
    const uint32_t limit = DataLimit(options, code);
    Pass pass = MeasurePass(plan, first, 1, shape, true, uses);
    if (pass.resident_bytes > limit) pass = MeasurePass(plan, first, 1, shape, false, uses);
    if (pass.resident_bytes > limit && options.must_fit)
      return Failure{
          Format("stage {}: one {} needs {} bytes of local store, {} more than the {} there are{}",
                 plan.stages[first].kernel.name, DomainName(pass.domain), pass.resident_bytes,
                 pass.resident_bytes - limit, limit,
                 code > 0 ? Format(" beside {} of code", code)
                          : "; use smaller chunks or smaller layers")};
    while (options.fuse && first + count < plan.stages.size() &&
           CanJoin(plan.stages, first, first + count)) {
      Pass longer = MeasurePass(plan, first, count + 1, shape, true, uses);
      const uint32_t left = DataLimit(options, CodeBytes(options, plan.stages, first, count + 1));
      const uint32_t room = options.must_fit ? left : std::max(left, options.cache_bytes);
      if (longer.resident_bytes > room) break;
      pass = std::move(longer);
      ++count;
    }
    plan.passes.push_back(std::move(pass));
    first += count;
  }
  DeriveWaits(plan, shape);
  plan.graph = BuildGraph(plan, shape);
  return plan;
}

}  // namespace pelt
