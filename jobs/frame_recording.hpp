// Memory for the profile of one frame after another: when every stage, item and pass ran, and on
// which worker. Recording a frame overwrites the last one; nothing allocates after construction.
#pragma once

#include <vector>

#include "jobs/frame.hpp"
#include "jobs/tick_clock.hpp"

namespace pelt {

class FrameRecording {
 public:
  FrameRecording(const Plan& plan, const SceneShape& shape, bool stage_times = true);
  FrameRecording(const FrameRecording&) = delete;
  FrameRecording& operator=(const FrameRecording&) = delete;

  // For Frame::profile.
  const FrameProfile* profile() const { return &profile_; }

  const Slice& Stage(uint32_t stage, uint32_t item) const {
    return stages_[stage_first_[stage] + item];
  }
  const ItemSlice& Item(uint32_t pass, uint32_t item) const {
    return items_[pass_first_[pass] + item];
  }
  const Slice& Pass(uint32_t pass) const { return passes_[pass]; }
  // Better the longer the recording lives.
  double NsPerTick() const { return scale_.NsPerTick(); }

 private:
  std::vector<uint32_t> stage_first_, pass_first_;
  std::vector<Slice> stages_, passes_;
  std::vector<ItemSlice> items_;
  FrameProfile profile_;
  TickScale scale_;
};

}  // namespace pelt
