#include "jobs/frame.hpp"

#include <algorithm>
#include <span>
#include <utility>

#include "core/float_environment.hpp"
#include "core/random.hpp"
#include "jobs/pass_loop.hpp"
#include "jobs/tick_clock.hpp"

namespace pelt {
namespace {

bool IsFrameGateOpen(const Stage& stage, const FrameMemory& memory, const ItemPlace& place) {
  if (memory.paused)
    return stage.gate.frame == FrameGate::kAlsoPaused ||
           (stage.gate.frame == FrameGate::kFollows && memory.restored);
  if (stage.gate.frame != FrameGate::kNotHeld) return true;
  const uint8_t* held = memory.held[size_t(stage.domain)];
  return !held || !held[place.first[size_t(stage.domain)]];
}

}  // namespace

bool IsWanted(const Stage& stage, const FrameMemory& memory, const ItemPlace& place) {
  if (!IsFrameGateOpen(stage, memory, place)) return false;
  if (stage.domain >= Domain::kLayer &&
      !stage.kinds.Admits(memory.shape->layer_kind[place.first[size_t(Domain::kLayer)]]))
    return false;
  return !stage.gate.when.holds || stage.gate.when.holds(memory, place);
}

ItemPlace PlaceOf(const SceneShape& shape, Domain domain, uint32_t item) {
  // CompilePlan lets only the scene and layers ask for all of a finer domain.
  ItemPlace place{{}, {1, 1, 1, 1, 1}, {}};
  if (domain == Domain::kScene) {
    for (uint32_t d = 1; d < kDomainCount; ++d) place.count[d] = shape.ItemCount(Domain(d));
    return place;
  }
  place.first[size_t(domain)] = item;
  if (domain == Domain::kCharacter) return place;
  const uint32_t layer = shape.LayerOf(domain, item);
  place.first[size_t(Domain::kCharacter)] = shape.layer_character[layer];
  place.first[size_t(Domain::kLayer)] = layer;
  for (const Domain fine : {Domain::kPatch, Domain::kChunk}) {
    place.layer_first[size_t(fine)] = shape.LayerFirst(fine, layer);
    if (domain != Domain::kLayer) continue;
    place.first[size_t(fine)] = shape.LayerFirst(fine, layer);
    place.count[size_t(fine)] = shape.LayerItems(fine, layer);
  }
  return place;
}

namespace {

void RunStage(const Frame& frame, const Stage& stage, const ItemPlace& place) {
  Binding bindings[kMaxPorts];
  Binding* next = bindings;
  for (const PortDesc& port : stage.kernel.ports) BindPort(port, *frame.memory, place, *next++);
  stage.kernel.run(ParamsOf(stage, *frame.memory, place), bindings);
}

// One reading of the clock a stage, where one ends the next begins; or one an item.
void RunItemProfiled(const Frame& frame, uint32_t pass_index, uint32_t item, uint32_t worker) {
  const Plan& plan = *frame.plan;
  const FrameProfile& profile = *frame.profile;
  const Pass& pass = plan.passes[pass_index];
  uint64_t* ends = profile.stage_ends + profile.stage_first[pass_index] + item * pass.stage_count;
  ItemSlice& slice = profile.items[profile.item_first[pass_index] + item];
  // Last written a frame ago, so not in the cache: fetched while the first stage runs, or kernels
  // wait for room in the store buffer.
  __builtin_prefetch(&slice, 1);
  __builtin_prefetch(ends, 1);
  __builtin_prefetch(ends + pass.stage_count - 1, 1);
  const ItemPlace place = PlaceOf(*frame.memory->shape, pass.domain, item);
  const uint64_t begin = ReadTicks();
  uint64_t now = begin;
  for (uint32_t s = 0; s < pass.stage_count; ++s) {
    const Stage& stage = plan.stages[pass.first_stage + s];
    if (!IsWanted(stage, *frame.memory, place)) {
      ends[s] = 0;
      continue;
    }
    RunStage(frame, stage, place);
    if (profile.stage_times) now = ReadTicks();
    ends[s] = now;
  }
  if (!profile.stage_times) now = ReadTicks();
  slice = {{begin, now}, worker};
}

}  // namespace

Slice FrameProfile::Stage(const Plan& plan, uint32_t pass, uint32_t item, uint32_t stage) const {
  const uint64_t* ends = stage_ends + stage_first[pass] + item * plan.passes[pass].stage_count;
  if (ends[stage] == 0) return {};
  uint32_t before = stage;
  while (before > 0 && ends[before - 1] == 0) --before;
  const uint64_t begin = before > 0 ? ends[before - 1] : items[item_first[pass] + item].begin_ticks;
  return {begin, ends[stage]};
}

Slice FrameProfile::Pass(uint32_t pass, uint32_t item_count) const {
  Slice all;
  for (const ItemSlice& item : std::span(items + item_first[pass], item_count)) {
    all.begin_ticks = all.Ran() ? std::min(all.begin_ticks, item.begin_ticks) : item.begin_ticks;
    all.end_ticks = std::max(all.end_ticks, item.end_ticks);
  }
  return all;
}

void RunItem(const Frame& frame, uint32_t pass_index, uint32_t item, uint32_t worker) {
  const FloatEnvironment float_environment;
  if (frame.profile) return RunItemProfiled(frame, pass_index, item, worker);
  const Plan& plan = *frame.plan;
  const Pass& pass = plan.passes[pass_index];
  const ItemPlace place = PlaceOf(*frame.memory->shape, pass.domain, item);
  for (uint32_t s = pass.first_stage; s < pass.first_stage + pass.stage_count; ++s)
    if (IsWanted(plan.stages[s], *frame.memory, place)) RunStage(frame, plan.stages[s], place);
}

const char* Executor::Run(const Frame& frame) {
  if (!frame.phase) return RunPasses(frame), nullptr;
  if (const char* fault = frame.phase->StartRun()) return fault;
  struct EndRun {  // also when a user's own executor throws
    FramePhase* phase;
    ~EndRun() { phase->EndRun(); }
  };
  const EndRun end_run{frame.phase};
  Frame work = frame;
  work.phase = nullptr;
  RunPasses(work);
  return nullptr;
}

void SerialExecutor::RunPasses(const Frame& frame) {
  ForEachPass(frame, [&](uint32_t pass, uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) RunItem(frame, pass, i);
  });
}

void PermutedExecutor::RunPasses(const Frame& frame) {
  const FrameGraph& graph = frame.plan->graph;
  waits_for_.clear();
  for (const FrameGraph::Node& node : graph.nodes) waits_for_.push_back(node.waits_for);
  Random random(state_++);
  for (Fire(graph, 0); !ready_.empty();) {
    if (seed_ != 0) std::swap(ready_.back(), ready_[random.Below(uint32_t(ready_.size()))]);
    const Item run = ready_.back();
    ready_.pop_back();
    RunItem(frame, run.pass, run.item);
    if (--waits_for_[run.node] == 0) Fire(graph, run.node);
  }
}

void PermutedExecutor::Fire(const FrameGraph& graph, uint32_t node) {
  graph.ForEachOpened(node, [&](uint32_t pass, uint32_t item, uint32_t at) {
    ready_.push_back({pass, item, graph.item_node[at]});
  });
  for (uint32_t n = graph.nodes[node].first_next; n < graph.nodes[node + 1].first_next; ++n)
    if (--waits_for_[graph.next[n]] == 0) Fire(graph, graph.next[n]);
}

}  // namespace pelt
