#include <algorithm>

#include "platform_sim/frame/item_runner.hpp"

namespace pelt {
namespace {

// What local stores have for data is checked when the executor is made.
constexpr uint32_t kListElements = 2048;  // of a DMA list

class LocalStoreRunner final : public ItemRunner, private StageObserver {
 public:
  LocalStoreRunner(const ConsoleMachine& machine, const StageCosts& costs)
      : machine_(machine), costs_(costs) {
    for (uint32_t u = 0; u < machine.units; ++u)
      stores_.push_back(std::make_unique<LocalStoreExecutor>(kLocalStoreBytes));
  }

  void Run(const Frame& frame, uint32_t unit, uint32_t pass, uint32_t item,
           ItemWork& work) override {
    frame_ = &frame;
    work_ = &work;
    work.Clear();
    moved_.Clear();
    stores_[unit]->RunItem(frame, pass, item, *this, moved_);
    for (const LocalStoreItem::Block& block : moved_.blocks) {
      work.streams.push_back({block.stream, block.get_bytes, block.put_bytes});
      Add(work.get, block.get_bytes, block.get_elements, block.get_lines);
      Add(work.put, block.put_bytes, block.put_elements, block.put_lines);
    }
    GetState(frame, frame.plan->passes[pass], item, work);
    for (TransferShape* shape : {&work.get, &work.put})
      shape->commands = (shape->elements + kListElements - 1) / kListElements;
  }

  std::vector<LocalStoreFault> Faults() const override {
    std::vector<LocalStoreFault> faults;
    for (const auto& store : stores_)
      faults.insert(faults.end(), store->faults().begin(), store->faults().end());
    return faults;
  }

 private:
  void OnStage(uint32_t stage, uint32_t item) override {
    work_->stages.push_back(TimeStage(costs_, *frame_, stage, item));
  }

  // A block in pieces of the largest command, or a list of records; whole lines.
  void Add(TransferShape& shape, uint32_t bytes, uint32_t records, uint32_t record_lines) const {
    if (bytes == 0) return;
    const uint32_t line = machine_.line_bytes, largest = machine_.largest_transfer_bytes;
    const uint32_t lines = records > 0 ? record_lines : (bytes + line - 1) / line;
    shape.elements += records > 0 ? records : (bytes + largest - 1) / largest;
    shape.lines += lines;
    shape.bytes += uint64_t(lines) * line;
  }

  // What says whether stages want to run is a line each, where no stage brought it anyway.
  void GetState(const Frame& frame, const Pass& pass, uint32_t item, ItemWork& work) const {
    std::vector<bool> needed(frame.memory->table->streams.size());
    for (uint32_t s = pass.first_stage; s < pass.first_stage + pass.stage_count; ++s) {
      const Stage& stage = frame.plan->stages[s];
      if (stage.domain < Domain::kLayer) continue;
      const SceneShape& shape = *frame.memory->shape;
      const uint32_t layer = PlaceOf(shape, stage.domain, item).first[size_t(Domain::kLayer)];
      if (!stage.kinds.Admits(shape.layer_kind[layer])) continue;  // known when the scene is made
      for (const Stream stream : stage.gate.when.reads)
        if (stream != Stream::kNone) needed[size_t(stream)] = true;
    }
    for (const LocalStoreItem::Block& block : moved_.blocks) needed[size_t(block.stream)] = false;
    for (uint32_t s = 0; s < needed.size(); ++s) {
      if (!needed[s]) continue;
      work.streams.push_back({Stream(s), machine_.line_bytes, 0});
      Add(work.get, machine_.line_bytes, 0, 0);
    }
  }

  const ConsoleMachine machine_;
  const StageCosts& costs_;
  std::vector<std::unique_ptr<LocalStoreExecutor>> stores_;
  LocalStoreItem moved_;
  const Frame* frame_ = nullptr;
  ItemWork* work_ = nullptr;
};

}  // namespace

ItemWork::StageTime TimeStage(const StageCosts& costs, const Frame& frame, uint32_t stage,
                              uint32_t item) {
  const StageCosts::Stage& cost = costs.stages[stage];
  const double iterations = CountIterations(frame, stage, item);
  const auto time = [&](const StageCosts::Stage::Price& price) -> ItemWork::CodeTime {
    const double fixed = price.fixed_cycles;
    return {iterations * double(price.cycles_per_iteration[item]) + fixed,
            iterations * double(price.shared_cycles_per_iteration[item]) + fixed};
  };
  return {stage, time(cost.as_written), time(cost.scheduled)};
}

std::unique_ptr<ItemRunner> MakeLocalStoreRunner(const ConsoleMachine& machine,
                                                 const StageCosts& costs) {
  return std::make_unique<LocalStoreRunner>(machine, costs);
}

}  // namespace pelt
