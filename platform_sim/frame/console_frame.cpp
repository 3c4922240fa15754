#include "platform_sim/frame/console_frame.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/format.hpp"
#include "platform_sim/frame/frame_clock.hpp"
#include "platform_sim/frame/item_runner.hpp"
#include "platform_sim/frame/moved_data.hpp"
#include "platform_sim/memory/local_store_budget.hpp"

namespace pelt {
namespace {

// Fills in what is left; false, and why in `error`, when it is less than nothing.
bool FitPass(const ConsoleMachine& machine, const Plan& plan, const StageCosts& costs,
             uint32_t index, PassStore& store, std::string& error) {
  const Pass& pass = plan.passes[index];
  store.code_bytes = machine.runtime.code_bytes;
  store.stack_bytes = machine.runtime.stack_bytes;
  for (uint32_t s = pass.first_stage; s < pass.first_stage + pass.stage_count; ++s) {
    store.code_bytes += costs.stages[s].code_bytes;
    store.parameter_bytes += plan.stages[s].kernel.params_bytes;
  }
  store.buffer_sets = pass.double_buffered ? 2 : 1;
  store.buffer_bytes = pass.resident_bytes / store.buffer_sets;

  CellMemoryParameters cell;
  cell.local_store_bytes = machine.local_store_bytes;
  std::string why;
  if (FitsLocalStore(cell,
                     {store.code_bytes, store.stack_bytes, store.parameter_bytes,
                      store.buffer_bytes, store.buffer_sets},
                     store.free_bytes, why))
    return true;
  error = Format("pass {} ('{}' and {} more) does not fit: {}", index,
                 plan.stages[pass.first_stage].kernel.name, pass.stage_count - 1, why);
  return false;
}

bool CheckCosts(const ConsoleMachine& machine, const StageCosts& costs, const Frame& frame,
                std::string& error) {
  const Plan& plan = *frame.plan;
  if (costs.clock_hz != machine.clock_hz) {
    error = Format("stage costs are for a clock of {} Hz; the {} has {}", costs.clock_hz,
                   machine.name, machine.clock_hz);
    return false;
  }
  bool same = costs.stages.size() == plan.stages.size();
  for (size_t s = 0; same && s < plan.stages.size(); ++s) {
    const size_t items = frame.memory->shape->ItemCount(plan.stages[s].domain);
    const StageCosts::Stage& cost = costs.stages[s];
    same = cost.name == plan.stages[s].kernel.name;
    for (const StageCosts::Stage::Price* price : {&cost.as_written, &cost.scheduled})
      same = same && price->cycles_per_iteration.size() == items &&
             price->shared_cycles_per_iteration.size() == items;
  }
  if (!same) error = "stage costs are of another plan or scene: price the stages of this one";
  return same;
}

bool CheckMachine(const ConsoleMachine& m, std::string& error) {
  if (m.units > 0 && m.clock_hz > 0 && m.threads_per_core > 0 && m.line_bytes > 0 &&
      m.largest_transfer_bytes > 0 && m.availability > 0.0 && m.memory.units_per_port > 0 &&
      m.code_order >= 0.0)
    return true;
  error = Format(
      "{}: no unit, clock, line or availability may be zero, no code better than its best schedule",
      m.name);
  return false;
}

// Of each item how many come before it: a character's come together, as units keep its palette; of them those of
// layers of more chunks come first, as they have most to wait for.
std::vector<uint32_t> LargestLayersFirst(const SceneShape& shape, Domain domain) {
  if (domain < Domain::kLayer) return {};
  std::vector<uint32_t> of_character(shape.character_count, 0);
  for (const uint32_t layer : shape.chunk_layer) ++of_character[shape.layer_character[layer]];
  std::vector<uint32_t> items(shape.ItemCount(domain)), rank(items.size());
  std::iota(items.begin(), items.end(), 0u);
  std::ranges::stable_sort(items, std::greater{}, [&](uint32_t item) {
    const uint32_t layer = shape.LayerOf(domain, item), character = shape.layer_character[layer];
    return std::tuple(of_character[character], character, shape.LayerChunks(layer));
  });
  for (uint32_t i = 0; i < items.size(); ++i) rank[items[i]] = i;
  return rank;
}

}  // namespace

struct ConsoleExecutor::State final : WorkSource {
  State(const ConsoleMachine& machine, const StageCosts& stage_costs)
      : costs(stage_costs), clock(machine), data(machine) {}

  const ItemWork& Take(uint32_t unit, uint32_t pass, uint32_t item) override {
    ItemWork& item_work = work.passes[pass].items[item];
    runner->Run(*frame, unit, pass, item, item_work);
    data.Apply(*frame, unit, pass, item, item_work);
    return item_work;
  }

  const StageCosts costs;
  FrameClock clock;
  MovedData data;
  std::unique_ptr<ItemRunner> runner;
  std::vector<PassStore> stores;
  FrameWork work;
  ModelledFrame modelled;
  bool timelines = false;

  const Frame* frame = nullptr;  // that runs
};

Result<std::unique_ptr<ConsoleExecutor>> ConsoleExecutor::Make(const ConsoleMachine& machine,
                                                               const StageCosts& costs,
                                                               const Frame& frame) {
  std::string error;
  if (!CheckMachine(machine, error) || !CheckCosts(machine, costs, frame, error))
    return Failure{error};
  const Plan& plan = *frame.plan;
  auto state = std::make_unique<State>(machine, costs);
  const bool has_stores = machine.local_store_bytes > 0;
  state->work.stage_count = uint32_t(plan.stages.size());
  state->work.stream_count = uint32_t(plan.table->streams.size());
  for (uint32_t p = 0; p < plan.passes.size(); ++p) {
    const Pass& pass = plan.passes[p];
    PassWork& work = state->work.passes.emplace_back();
    work.pass = p;
    // The blocks of the next items must not drive those of these out of the cache.
    work.double_buffered = has_stores
                               ? pass.double_buffered
                               : uint64_t(pass.resident_bytes) * machine.units <= machine.l2_bytes;
    work.items.resize(frame.memory->shape->ItemCount(pass.domain));
    work.rank = LargestLayersFirst(*frame.memory->shape, pass.domain);
    if (!has_stores) continue;
    PassStore& store = state->stores.emplace_back();
    if (!FitPass(machine, plan, costs, p, store, error)) return Failure{error};
    work.code_bytes = store.code_bytes - machine.runtime.code_bytes;
    work.parameter_bytes = store.parameter_bytes;
  }
  state->runner = has_stores ? MakeLocalStoreRunner(machine, state->costs)
                             : MakeCacheRunner(machine, state->costs, *frame.memory);
  return std::unique_ptr<ConsoleExecutor>(new ConsoleExecutor(std::move(state)));
}

ConsoleExecutor::ConsoleExecutor(std::unique_ptr<State> state) : state_(std::move(state)) {}
ConsoleExecutor::~ConsoleExecutor() = default;

void ConsoleExecutor::RunPasses(const Frame& frame) {
  State& s = *state_;
  s.frame = &frame;
  s.work.graph = frame.plan->graph;
  s.data.BeginFrame();
  s.clock.Run(s.work, s, s.timelines, s.modelled);
}

void ConsoleExecutor::KeepTimelines(bool keep) { state_->timelines = keep; }
const ConsoleMachine& ConsoleExecutor::machine() const { return state_->clock.machine(); }
const ModelledFrame& ConsoleExecutor::modelled() const { return state_->modelled; }
const FrameWork& ConsoleExecutor::work() const { return state_->work; }
const std::vector<PassStore>& ConsoleExecutor::stores() const { return state_->stores; }
std::vector<LocalStoreFault> ConsoleExecutor::faults() const { return state_->runner->Faults(); }

}  // namespace pelt
