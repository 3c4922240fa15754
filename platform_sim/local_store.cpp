#include "platform_sim/local_store.hpp"

#include <algorithm>
#include <cstring>

#include "core/float_environment.hpp"
#include "core/format.hpp"
#include "jobs/pass_loop.hpp"

namespace pelt {
namespace {

constexpr std::byte kPoison{0xff};
constexpr uint32_t kGuardBytes =
    kBlockAlignment;                       // poison between blocks: finds writes past an end
constexpr uint32_t kDmaBytes = 16 * 1024;  // largest command
constexpr uint32_t kWatchedBytes = 4096;   // behind the last block: must stay poisoned too
constexpr size_t kMostFaults = 64;
constexpr uint32_t kNotPut = ~0u;  // poisoned index of a scatter entry the kernel did not use

bool IsAll(Access a) { return a == Access::kAll || a == Access::kAllOut || a == Access::kAllInOut; }
bool IsList(Access a) { return a == Access::kGather || a == Access::kScatter; }

// Blocks bound in the same manner share one copy; a gathered list and an own block of one stream do
// not.
bool SameBinding(Access a, Access b) {
  return IsList(a) || IsList(b) ? a == b : IsAll(a) == IsAll(b);
}

uint64_t RoundUp(uint64_t bytes) {
  return (bytes + kBlockAlignment - 1) & ~uint64_t(kBlockAlignment - 1);
}

// Memory lines that record number `record` of a layer lies in.
uint32_t LinesOf(uint32_t record, uint32_t record_bytes) {
  const uint64_t first = uint64_t(record) * record_bytes, last = first + record_bytes - 1;
  return uint32_t(last / kBlockAlignment - first / kBlockAlignment + 1);
}

const StreamDesc& Describe(const Frame& frame, Stream stream) {
  return (*frame.memory->table)[stream];
}

// Of the stream, in the layer of a chunk.
uint32_t LayerRecords(const Frame& frame, uint32_t chunk, Stream stream, uint32_t record_bytes) {
  const SceneShape& shape = *frame.memory->shape;
  const StreamDesc& desc = Describe(frame, stream);
  return shape.LayerItems(desc.domain, shape.chunk_layer[chunk]) *
         (desc.block_bytes / record_bytes);
}

}  // namespace

struct alignas(kBlockAlignment) LocalStoreExecutor::Buffer {
  std::byte bytes[kLocalStoreBytes];
};

LocalStoreExecutor::LocalStoreExecutor(uint32_t data_bytes)
    : data_bytes_(data_bytes), buffer_(std::make_unique<Buffer>()), snapshot_(kLocalStoreBytes) {
  std::fill_n(buffer_->bytes, kLocalStoreBytes, kPoison);
}

LocalStoreExecutor::~LocalStoreExecutor() = default;

void LocalStoreExecutor::RunPasses(const Frame& frame) {
  ForEachPass(frame, [&](uint32_t pass, uint32_t count) {
    for (uint32_t i = 0; i < count; ++i) RunStages(frame, frame.plan->passes[pass], i, nullptr);
  });
}

void LocalStoreExecutor::RunItem(const Frame& frame, uint32_t pass, uint32_t item,
                                 StageObserver& observer, LocalStoreItem& moved) {
  stages_ran_.clear();
  RunStages(frame, frame.plan->passes[pass], item, &observer);
  for (const Resident& block : resident_)
    if (block.moved.get_bytes + block.moved.put_bytes > 0) moved.blocks.push_back(block.moved);
  moved.stages.insert(moved.stages.end(), stages_ran_.begin(), stages_ran_.end());
}

void LocalStoreExecutor::RunStages(const Frame& frame, const Pass& pass, uint32_t item,
                                   StageObserver* observer) {
  const FloatEnvironment float_environment;
  std::fill_n(buffer_->bytes, std::min(top_ + kWatchedBytes, kLocalStoreBytes), kPoison);
  resident_.clear();
  top_ = data_used_ = 0;
  for (uint32_t s = pass.first_stage; s < pass.first_stage + pass.stage_count; ++s) {
    if (!IsWanted(frame.plan->stages[s], *frame.memory, item)) continue;
    if (observer) {
      observer->OnStage(s, item);
      stages_ran_.push_back(s);
    }
    RunStage(frame, frame.plan->stages[s], item);
  }
  for (Resident& block : resident_) {
    if (!block.written) continue;
    const auto use = std::find_if(pass.streams.begin(), pass.streams.end(),
                                  [&](const PassStream& u) { return u.stream == block.stream; });
    Store(frame, frame.plan->stages[pass.first_stage], item, block,
          use != pass.streams.end() && use->transient);
  }
}

void LocalStoreExecutor::RunStage(const Frame& frame, const Stage& stage, uint32_t item) {
  Binding bindings[kMaxPorts];
  const auto& ports = stage.kernel.ports;
  for (size_t p = 0; p < ports.size(); ++p) {
    Resident* block = FindOrLoad(frame, stage, ports[p], item);
    if (!block) return;
    auto* index = ports[p].access == Access::kScatter
                      ? reinterpret_cast<uint32_t*>(buffer_->bytes + block->offset +
                                                    size_t(block->record_bytes) * block->count)
                      : nullptr;
    bindings[p] = {buffer_->bytes + block->offset, index, block->count};
    block->writable |= IsWritten(ports[p].access);
    // Whoever declares Out promises not to look at what an earlier stage of the pass left.
    if (!IsRead(ports[p].access))
      std::fill_n(buffer_->bytes + block->offset, block->bytes, kPoison);
  }
  std::memcpy(snapshot_.data(), buffer_->bytes, top_);
  stage.kernel.run(ParamsOf(stage, *frame.memory, item), bindings);

  for (Resident& block : resident_) {
    if (!block.writable) {
      CheckUntouched(frame, stage, item, block);
      continue;
    }
    block.writable = false;
    block.written = true;
    // Gates look at what ran in main memory; a console's PPU would get the same by mailbox.
    if (Describe(frame, block.stream).role == Role::kBookkeeping) {
      Store(frame, stage, item, block, false);
      block.written = false;
    }
  }
  CheckGuards(frame, stage, item);
}

void LocalStoreExecutor::CheckUntouched(const Frame& frame, const Stage& stage, uint32_t item,
                                        const Resident& block) {
  if (std::memcmp(snapshot_.data() + block.offset, buffer_->bytes + block.offset, block.bytes) == 0)
    return;
  for (const PortDesc& port : stage.kernel.ports)
    if (port.stream == block.stream && SameBinding(port.access, block.access))
      return Fault(
          stage, item,
          Format("wrote through its read-only port '{}'", Describe(frame, port.stream).name),
          Describe(frame, block.stream).name);
  Fault(
      stage, item,
      Format("wrote to stream '{}', which it has no port for", Describe(frame, block.stream).name),
      Describe(frame, block.stream).name);
}

LocalStoreExecutor::Resident* LocalStoreExecutor::FindOrLoad(const Frame& frame, const Stage& stage,
                                                             const PortDesc& port, uint32_t item) {
  for (Resident& r : resident_)
    if (r.stream == port.stream && SameBinding(r.access, port.access)) return &r;
  const Binding main = BindPort(port, *frame.memory, stage.domain, item);
  const uint64_t per_record = port.block_bytes + (port.access == Access::kScatter ? 4u : 0u);
  const uint64_t bytes = per_record * main.count;
  const uint64_t over_data = data_used_ + RoundUp(bytes);
  const uint64_t end = top_ + RoundUp(bytes) + kGuardBytes;
  // CompilePlan refuses plans that need more than they were given; this finds a plan made for
  // another local store, or one that counted wrongly. The stage does not run.
  if (over_data > data_bytes_ || end > kLocalStoreBytes) {
    Fault(stage, item,
          Format("port '{}' needs {} bytes; of {} in local store {} are taken",
                 Describe(frame, port.stream).name, bytes, data_bytes_, data_used_),
          Describe(frame, port.stream).name, LocalStoreFault::Kind::kDoesNotFit);
    return nullptr;
  }
  resident_.push_back({port.stream,
                       port.access,
                       top_,
                       uint32_t(bytes),
                       port.block_bytes,
                       main.count,
                       false,
                       false,
                       {port.stream, 0, 0, 0, 0, 0, 0}});
  top_ = uint32_t(end);
  data_used_ = uint32_t(over_data);
  counts_.peak_bytes = std::max(counts_.peak_bytes, data_used_);
  if (IsRead(port.access)) Load(frame, main, item, resident_.back());
  return &resident_.back();
}

void LocalStoreExecutor::Load(const Frame& frame, const Binding& main, uint32_t item,
                              Resident& block) {
  std::byte* to = buffer_->bytes + block.offset;
  if (block.access != Access::kGather) {
    std::memcpy(to, main.block, block.bytes);
    block.moved.get_bytes = block.bytes;
    CountTransfer(block.bytes, true);
    return;
  }
  // Lists may end in entries that mean nothing; they are not fetched, and a kernel that uses one
  // all the same sees poison.
  const uint32_t records = LayerRecords(frame, item, block.stream, block.record_bytes);
  for (uint32_t i = 0; i < block.count; ++i) {
    const uint32_t from = main.index[i];
    if (from >= records) continue;
    std::memcpy(to + size_t(i) * block.record_bytes,
                static_cast<std::byte*>(main.block) + size_t(from) * block.record_bytes,
                block.record_bytes);
    ++counts_.list_elements;
    counts_.get_bytes += block.record_bytes;
    block.moved.get_bytes += block.record_bytes;
    ++block.moved.get_elements;
    block.moved.get_lines += LinesOf(from, block.record_bytes);
  }
  ++counts_.dma_commands;
}

void LocalStoreExecutor::Store(const Frame& frame, const Stage& stage, uint32_t item,
                               Resident& block, bool transient) {
  if (block.access == Access::kScatter) return Scatter(frame, stage, item, block);
  const ItemPlace place = PlaceOf(*frame.memory->shape, stage.domain, item);
  const auto domain = size_t(Describe(frame, block.stream).domain);
  std::memcpy(frame.memory->Block(block.stream, place.first[domain]), buffer_->bytes + block.offset,
              block.bytes);
  if (transient) {
    counts_.transient_bytes += block.bytes;
    return;
  }
  CountTransfer(block.bytes, false);
  block.moved.put_bytes = block.bytes;  // once, however often it was stored for gates
}

void LocalStoreExecutor::Scatter(const Frame& frame, const Stage& stage, uint32_t item,
                                 Resident& block) {
  const SceneShape& shape = *frame.memory->shape;
  std::byte* to =
      frame.memory->Block(block.stream, shape.layer_first_chunk[shape.chunk_layer[item]]);
  const std::byte* records = buffer_->bytes + block.offset;
  const auto* index =
      reinterpret_cast<const uint32_t*>(records + size_t(block.record_bytes) * block.count);
  const uint32_t places = LayerRecords(frame, item, block.stream, block.record_bytes);
  for (uint32_t i = 0; i < block.count; ++i) {
    if (index[i] == kNotPut) continue;
    if (index[i] >= places) {
      Fault(stage, item, Format("scattered to place {} of {} in its layer", index[i], places),
            Describe(frame, block.stream).name);
      continue;
    }
    std::memcpy(to + size_t(index[i]) * block.record_bytes,
                records + size_t(i) * block.record_bytes, block.record_bytes);
    ++counts_.list_elements;
    counts_.put_bytes += block.record_bytes;
    block.moved.put_bytes += block.record_bytes;
    ++block.moved.put_elements;
    block.moved.put_lines += LinesOf(index[i], block.record_bytes);
  }
  ++counts_.dma_commands;
}

void LocalStoreExecutor::CheckGuards(const Frame& frame, const Stage& stage, uint32_t item) {
  const auto poisoned = [&](uint32_t from, uint32_t to) {
    return std::all_of(buffer_->bytes + from, buffer_->bytes + to,
                       [](std::byte b) { return b == kPoison; });
  };
  for (const Resident& r : resident_)
    if (!poisoned(r.offset + r.bytes, r.offset + uint32_t(RoundUp(r.bytes)) + kGuardBytes))
      Fault(
          stage, item,
          Format("wrote past the end of its block of stream '{}'", Describe(frame, r.stream).name),
          Describe(frame, r.stream).name);
  const uint32_t after = std::min(top_ + kWatchedBytes, kLocalStoreBytes);
  if (!poisoned(top_, after)) Fault(stage, item, "wrote past its last block", {});
}

void LocalStoreExecutor::Fault(const Stage& stage, uint32_t item, std::string what,
                               std::string_view stream, LocalStoreFault::Kind kind) {
  if (faults_.size() < kMostFaults)
    faults_.push_back({stage.kernel.name, item, std::move(what), kind, stream});
}

void LocalStoreExecutor::CountTransfer(uint64_t bytes, bool get) {
  (get ? counts_.get_bytes : counts_.put_bytes) += bytes;
  counts_.dma_commands += (bytes + kDmaBytes - 1) / kDmaBytes;
}

}  // namespace pelt
