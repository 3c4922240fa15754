#include "platform_sim/frame/console_frame.hpp"

#include <algorithm>
#include <functional>
#include <numeric>
#include <tuple>
#include <utility>

#include "core/format.hpp"
#include "platform_sim/frame/frame_clock.hpp"
#include "platform_sim/frame/item_runner.hpp"

namespace pelt {

namespace {

constexpr uint32_t kMostElements = 2048;  // of a DMA list
constexpr uint32_t kMovedBytes = 16;

constexpr uint32_t ElementBytes(ElementType type) {
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
      const uint32_t bytes = lanes * ElementBytes(row.type) * (row.lane_major ? each : 1);
      const uint32_t quads = (bytes + kMovedBytes - 1) / kMovedBytes * kMovedBytes;
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

bool FitsLocalStore(const CellMemoryParameters& p, const LocalStoreUse& use, uint64_t& free_bytes,
                    std::string& error) {
  const uint64_t bytes = use.Bytes();
  if (bytes <= p.local_store_bytes) {
    free_bytes = p.local_store_bytes - bytes;
    return true;
  }
  free_bytes = 0;
  error = Format(
      "local store: {} bytes are needed, {} too many for {}: code {}, stack {}, data {}, {} x {} "
      "of "
      "buffers; use smaller chunks, fewer fused stages or one buffer set",
      bytes, bytes - p.local_store_bytes, p.local_store_bytes, use.code_bytes, use.stack_bytes,
      use.data_bytes, use.buffer_sets, use.buffer_bytes);
  return false;
}

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
