// Memory for the profile of one frame after another: when every stage, item and pass ran, and on
// which worker. Recording a frame overwrites the last one; nothing allocates after construction.
#pragma once

#include <vector>

#include "jobs/frame.hpp"
#include "jobs/tick_clock.hpp"

namespace pelt {

class FrameRecording {
 public:
  // The plan must outlive it.
  FrameRecording(const Plan& plan, const SceneShape& shape);
  FrameRecording(const FrameRecording&) = delete;
  FrameRecording& operator=(const FrameRecording&) = delete;

  // Whether frames from now on time stages (they do at first), or only items.
  void TimeStages(bool on) { profile_.stage_times = on; }
  // For Frame::profile.
  const FrameProfile* profile() const { return &profile_; }

  // Of a stage by its number in the plan.
  Slice Stage(uint32_t stage, uint32_t item) const {
    const uint32_t pass = stage_pass_[stage];
    return profile_.Stage(plan_, pass, item, stage - plan_.passes[pass].first_stage);
  }
  const ItemSlice& Item(uint32_t pass, uint32_t item) const {
    return items_[item_first_[pass] + item];
  }
  Slice Pass(uint32_t pass) const { return profile_.Pass(pass, item_count_[pass]); }
  // Better the longer the recording lives.
  double NsPerTick() const { return scale_.NsPerTick(); }

 private:
  const Plan& plan_;
  std::vector<uint32_t> stage_pass_, item_first_, item_count_, stage_first_;
  std::vector<uint64_t> stage_ends_;
  std::vector<ItemSlice> items_;
  FrameProfile profile_;
  TickScale scale_;
};

}  // namespace pelt
