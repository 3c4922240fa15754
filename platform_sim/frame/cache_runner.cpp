#include <algorithm>

#include "core/float_environment.hpp"
#include "platform_sim/frame/block_cache.hpp"
#include "platform_sim/frame/item_runner.hpp"

namespace pelt {
namespace {

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
