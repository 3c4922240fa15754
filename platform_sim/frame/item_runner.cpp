#include "platform_sim/frame/item_runner.hpp"

#include <algorithm>

#include "core/float_environment.hpp"

namespace pelt {

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

// ---- Local stores -------------------------------------------------------------------------------

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

std::unique_ptr<ItemRunner> MakeLocalStoreRunner(const ConsoleMachine& machine,
                                                 const StageCosts& costs) {
  return std::make_unique<LocalStoreRunner>(machine, costs);
}

// ---- Caches -------------------------------------------------------------------------------------

namespace {

// Which blocks of a frame lie in a shared L2: whole blocks, least recently used goes first.
//
// Between the passes of a frame, and between items that share a block (the pose of a character, the
// records of a layer), a cache saves what a local store brings anew. At the size of blocks that is
// a matter of capacity; sets, ways and single lines belong to memory/xenon_memory.hpp.
//
// Invariant: every dirty block that leaves, or is still here, was written once; what came is what
// was not here.

class BlockCache {
 public:
  // Of the blocks of this frame's memory.
  BlockCache(uint64_t bytes, const FrameMemory& memory);

  struct Evicted {
    Stream stream;
    uint32_t bytes;
  };
  // Block `block` (a number, not an item) of `stream` is used; `whole`: it is written without being
  // read. Returns the bytes that memory must bring; what must be written back is added to
  // `evicted`.
  uint32_t Touch(Stream stream, uint32_t block, bool written, bool whole,
                 std::vector<Evicted>& evicted);

 private:
  static constexpr uint32_t kNone = ~0u;
  struct Entry {
    uint32_t newer = kNone, older = kNone;
    Stream stream = Stream::kNone;
    bool here = false, dirty = false;
  };
  void Unlink(uint32_t e);
  void LinkNewest(uint32_t e);

  const uint64_t capacity_;
  uint64_t used_ = 0;
  const StreamTable& table_;
  std::vector<uint32_t> first_;  // entry of a stream's block 0
  std::vector<Entry> entries_;
  uint32_t newest_ = kNone, oldest_ = kNone;
};

BlockCache::BlockCache(uint64_t bytes, const FrameMemory& memory)
    : capacity_(bytes), table_(*memory.table) {
  for (uint32_t s = 0; s < memory.streams.size(); ++s) {
    first_.push_back(uint32_t(entries_.size()));
    Entry entry;
    entry.stream = Stream(s);
    entries_.insert(entries_.end(), memory.streams[s].block_count, entry);
  }
}

void BlockCache::Unlink(uint32_t e) {
  Entry& entry = entries_[e];
  (entry.newer == kNone ? newest_ : entries_[entry.newer].older) = entry.older;
  (entry.older == kNone ? oldest_ : entries_[entry.older].newer) = entry.newer;
  entry.newer = entry.older = kNone;
}

void BlockCache::LinkNewest(uint32_t e) {
  entries_[e].older = newest_;
  (newest_ == kNone ? oldest_ : entries_[newest_].newer) = e;
  newest_ = e;
}

uint32_t BlockCache::Touch(Stream stream, uint32_t block, bool written, bool whole,
                           std::vector<Evicted>& evicted) {
  const uint32_t e = first_[size_t(stream)] + block;
  const uint32_t bytes = table_[stream].block_bytes;
  Entry& entry = entries_[e];
  entry.dirty |= written;
  if (entry.here) {
    Unlink(e);
    LinkNewest(e);
    return 0;
  }
  entry.here = true;
  LinkNewest(e);
  used_ += bytes;
  while (used_ > capacity_ && oldest_ != e) {
    Entry& old = entries_[oldest_];
    const uint32_t old_bytes = table_[old.stream].block_bytes;
    if (old.dirty) evicted.push_back({old.stream, old_bytes});
    used_ -= old_bytes;
    old.here = old.dirty = false;
    Unlink(oldest_);
  }
  return whole ? 0 : bytes;
}

class CacheRunner final : public ItemRunner {
 public:
  CacheRunner(const ConsoleMachine& machine, const StageCosts& costs, const FrameMemory& memory)
      : machine_(machine), costs_(costs), cache_(machine.l2_bytes, memory) {}

  void Run(const Frame& frame, uint32_t, uint32_t pass_index, uint32_t item,
           ItemWork& work) override {
    const FloatEnvironment float_environment;
    const Pass& pass = frame.plan->passes[pass_index];
    work.Clear();
    for (uint32_t s = pass.first_stage; s < pass.first_stage + pass.stage_count; ++s) {
      const Stage& stage = frame.plan->stages[s];
      if (!IsWanted(stage, *frame.memory, item)) continue;
      work.stages.push_back(TimeStage(costs_, frame, s, item));
      Binding bindings[kMaxPorts];
      for (size_t p = 0; p < stage.kernel.ports.size(); ++p) {
        bindings[p] = BindPort(stage.kernel.ports[p], *frame.memory, stage.domain, item);
        TouchPort(*frame.memory, stage.kernel.ports[p], bindings[p], work);
      }
      stage.kernel.run(ParamsOf(stage, *frame.memory, item), bindings);
    }
    Shape(work);
  }

 private:
  // The blocks behind a port, in memory order. Records that are gathered or scattered lie in blocks
  // that neighbours use too: the cache takes those whole.
  void TouchPort(const FrameMemory& memory, const PortDesc& port, const Binding& binding,
                 ItemWork& work) {
    if (!binding.block) return;
    const StreamPlace& place = memory.streams[size_t(port.stream)];
    const uint32_t block_bytes = port.stride;
    const auto offset = size_t(static_cast<std::byte*>(binding.block) - place.base);
    const auto first = uint32_t(offset / block_bytes);
    const bool written = IsWritten(port.access);
    const bool whole = port.access == Access::kOut || port.access == Access::kAllOut;
    const auto touch = [&](uint32_t block) {
      const uint32_t bytes = cache_.Touch(port.stream, block, written, whole, evicted_);
      if (bytes > 0) work.streams.push_back({port.stream, bytes, 0});
    };
    if (port.access == Access::kScatter) {
      touch(first);
    } else if (port.access == Access::kGather) {
      const uint32_t per_block = block_bytes / port.block_bytes;
      const uint32_t blocks = place.block_count - first;
      for (uint32_t i = 0; i < binding.count; ++i)
        if (binding.index[i] / per_block < blocks) touch(first + binding.index[i] / per_block);
    } else {
      for (uint32_t b = 0; b < binding.count; ++b) touch(first + b);
    }
  }

  void Shape(ItemWork& work) {
    for (const BlockCache::Evicted& e : evicted_) work.streams.push_back({e.stream, 0, e.bytes});
    evicted_.clear();
    for (const ItemWork::StreamBytes& s : work.streams) {
      Add(work.get, s.get_bytes);
      Add(work.put, s.put_bytes);
    }
  }
  void Add(TransferShape& shape, uint64_t bytes) const {
    const uint64_t lines = (bytes + machine_.line_bytes - 1) / machine_.line_bytes;
    shape.lines += uint32_t(lines);
    shape.bytes += lines * machine_.line_bytes;
  }

  const ConsoleMachine machine_;
  const StageCosts& costs_;
  BlockCache cache_;
  std::vector<BlockCache::Evicted> evicted_;
};

}  // namespace

std::unique_ptr<ItemRunner> MakeCacheRunner(const ConsoleMachine& machine, const StageCosts& costs,
                                            const FrameMemory& memory) {
  return std::make_unique<CacheRunner>(machine, costs, memory);
}

}  // namespace pelt
