#include "platform_sim/pricing/record_stage.hpp"

#include <algorithm>

#include "core/float_environment.hpp"
#include "core/format.hpp"
#include "core/kernels/frame_table.hpp"

namespace pelt {
namespace {

// Bytes that the kernel may touch from where the port points.
uint64_t BytesOf(const PortDesc& port, const Binding& binding, const FrameMemory& memory,
                 uint32_t item) {
  if (port.access != Access::kGather && port.access != Access::kScatter)
    return uint64_t(port.block_bytes) * binding.count;
  const SceneShape& shape = *memory.shape;
  return uint64_t(shape.LayerItems(port.domain, shape.chunk_layer[item])) * port.stride;
}

}  // namespace

const FrameTable& KernelsRecording();  // frame_table.cpp on the recording vector

std::span<const KernelDesc> RecordingKernels() {
  static const std::vector<KernelDesc> kernels = [] {
    std::vector<KernelDesc> all;
    for (const FrameEntry& entry : KernelsRecording().entries) all.push_back(entry.kernel);
    return all;
  }();
  return kernels;
}

Result<> RecordStage(const Frame& frame, uint32_t stage_index, uint32_t item,
                     std::span<const KernelDesc> kernels, Recorder& recorder) {
  const Stage& stage = frame.plan->stages[stage_index];
  const auto kernel = std::ranges::find(kernels, stage.kernel.name, &KernelDesc::name);
  if (kernel == kernels.end())
    return Failure{
        Format("stage {}: there is no recording kernel of this name", stage.kernel.name)};
  const FrameMemory& memory = *frame.memory;
  const void* const params = ParamsOf(stage, memory, item);
  bool fits = recorder.AddBlock(params, stage.kernel.params_bytes);
  Binding bindings[kMaxPorts];
  for (size_t p = 0; p < stage.kernel.ports.size(); ++p) {
    const PortDesc& port = stage.kernel.ports[p];
    bindings[p] = BindPort(port, memory, stage.domain, item);
    fits = fits && recorder.AddBlock(bindings[p].block, BytesOf(port, bindings[p], memory, item));
  }
  if (!fits)
    return Failure{Format("stage {}: the blocks of item {} do not fit the recorder's 2 GiB",
                          stage.kernel.name, item)};
  const FloatEnvironment float_environment;
  const RecorderScope recording(recorder);
  kernel->run(params, bindings);
  return Done{};
}

}  // namespace pelt
