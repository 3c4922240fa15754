#include "platform_sim/pricing/record_stage.hpp"

#include "core/format.hpp"
#include "jobs/float_environment.hpp"

namespace pelt {
namespace {

// Bytes that the kernel may touch from where the port points.
uint64_t BytesOf(const PortDesc& port, const Binding& binding, const FrameMemory& memory,
                 uint32_t item) {
  if (port.access != Access::kGather && port.access != Access::kScatter)
    return uint64_t(port.block_bytes) * binding.count;
  const SceneShape& shape = *memory.shape;
  return uint64_t(shape.LayerChunks(shape.chunk_layer[item])) *
         DescribeStream(port.stream).block_bytes;
}

// The recording twin of a kernel; null for one that is not in the table.
const KernelDesc* FindRecordingKernel(std::string_view name) {
  return KernelsRecording().Find(name);
}

}  // namespace

bool TryRecordStage(const Frame& frame, uint32_t stage_index, uint32_t item, Recorder& recorder,
                    std::string& error) {
  const Stage& stage = frame.plan->stages[stage_index];
  const KernelDesc* const kernel = FindRecordingKernel(stage.kernel.name);
  if (!kernel) {
    error = Format("stage {}: there is no recording kernel of this name", stage.kernel.name);
    return false;
  }
  const FrameMemory& memory = *frame.memory;
  bool fits = recorder.AddBlock(stage.params, stage.kernel.params_bytes);
  Binding bindings[kMaxPorts];
  for (size_t p = 0; p < stage.kernel.ports.size(); ++p) {
    const PortDesc& port = stage.kernel.ports[p];
    bindings[p] = BindPort(port, memory, stage.domain, item);
    fits = fits && recorder.AddBlock(bindings[p].block, BytesOf(port, bindings[p], memory, item));
  }
  if (!fits) {
    error = Format("stage {}: the blocks of item {} do not fit the recorder's 2 GiB",
                   stage.kernel.name, item);
    return false;
  }
  const FloatEnvironment float_environment;
  const RecorderScope recording(recorder);
  kernel->run(stage.params, bindings);
  return true;
}

}  // namespace pelt
