#include "jobs/frame.hpp"

#include <numeric>
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
  struct EndRun {  // also when an executor of somebody else's throws
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
  ForEachPass(frame, [&](uint32_t pass, uint32_t count) {
    order_.resize(count);
    std::iota(order_.begin(), order_.end(), 0u);
    if (seed_ == 0) {
      for (uint32_t i = 0; i < count; ++i) order_[i] = count - 1 - i;
    } else {
      Random random(state_++);
      for (uint32_t i = count; i > 1; --i) std::swap(order_[i - 1], order_[random.Below(i)]);
    }
    for (uint32_t i : order_) RunItem(frame, pass, i);
  });
}

}  // namespace pelt
