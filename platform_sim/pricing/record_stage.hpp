// Runs a stage of a frame on recording kernels: the frame's kernels once more, with
// recording_vec.hpp for their vector.
//
// Invariant: memory is afterwards as any other instruction set would leave it, so a frame may be
// recorded instead of run.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "jobs/frame.hpp"
#include "platform_sim/pricing/recorder.hpp"

namespace pelt {

// Those of fur (core/kernels/frame_table.cpp).
std::span<const KernelDesc> RecordingKernels();

// Runs `stage` (of the plan) on `item`, recorded into `recorder`, which is fresh. Refused if
// none of `kernels` has its name or its blocks are too many for the recorder's space.
Result<> RecordStage(const Frame& frame, uint32_t stage, uint32_t item,
                     std::span<const KernelDesc> kernels, Recorder& recorder);

// Runs the whole frame so: `record(pass, stage, item)` is called, in the order of a serial run, for
// every stage that wants to run on an item, and must run it (RecordStage). False stops. A frame
// that was begun is run by this; one that was run before may be recorded again, for other prices:
// it then steps once more, and its scene is good for nothing else.
template <class RecordItem>
bool RecordFrame(const Frame& frame, RecordItem record) {
  struct EndRun {
    FramePhase* phase;
    ~EndRun() {
      if (phase) phase->EndRun();
    }
  };
  const EndRun end_run{frame.phase && !frame.phase->StartRun() ? frame.phase : nullptr};
  for (uint32_t p = 0; p < frame.plan->passes.size(); ++p) {
    const Pass& pass = frame.plan->passes[p];
    const uint32_t items = frame.memory->shape->ItemCount(pass.domain);
    for (uint32_t i = 0; i < items; ++i)
      for (uint32_t s = pass.first_stage; s < pass.first_stage + pass.stage_count; ++s)
        if (IsWanted(frame.plan->stages[s], *frame.memory, i) && !record(p, s, i)) return false;
  }
  return true;
}

}  // namespace pelt
