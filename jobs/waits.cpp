#include "jobs/waits.hpp"

#include <algorithm>
#include <iterator>
#include <vector>

namespace pelt {
namespace {

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

}  // namespace

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

}  // namespace pelt
