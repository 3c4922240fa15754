// Any kernel that is written on the vector type, recorded as the stages of a frame are: what
// PriceTrace prices (kernel_cost.hpp).
//
//   template <class V> void Scale(const float* in, float* out, uint32_t n) {
//     for (uint32_t i = 0; i < n; i += V::kLanes) (V::Load(in + i) * V(2.0f)).Store(out + i);
//   }
//   auto trace = RecordKernel({{in, 4 * n}, {out, 4 * n}},
//                             [&] { Scale<RecordingVec>(in, out, n); });
//   auto cost = PriceTrace(*trace, n / 4, core, {});
//
// Blocks are 128-byte aligned, as in a local store. Scalars that are not WordOf<V> are not seen,
// nor are addresses and loop counters: an iteration is charged a counter, a hint and a branch.
#pragma once

#include <initializer_list>

#include "core/error.hpp"
#include "platform_sim/pricing/recording_vec.hpp"

namespace pelt {

struct KernelBlock {
  const void* begin;
  uint64_t bytes;
};

// Refused when the blocks are too many for the recorder's space.
template <class Run>
Result<Trace> RecordKernel(std::initializer_list<KernelBlock> blocks, Run run) {
  Recorder recorder(Recorder::Keep::kOperations);
  for (const KernelBlock& block : blocks)
    if (!recorder.AddBlock(block.begin, block.bytes))
      return Failure{"the kernel's blocks do not fit the recorder's 2 GiB"};
  const RecorderScope recording(recorder);
  run();
  return recorder.trace();
}

}  // namespace pelt
