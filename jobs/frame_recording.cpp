#include "jobs/frame_recording.hpp"

namespace pelt {

FrameRecording::FrameRecording(const Plan& plan, const SceneShape& shape, bool stage_times) {
  uint32_t stage_entries = 0, item_entries = 0;
  for (const pelt::Stage& stage : plan.stages) {
    stage_first_.push_back(stage_entries);
    stage_entries += shape.ItemCount(stage.domain);
  }
  for (const pelt::Pass& pass : plan.passes) {
    pass_first_.push_back(item_entries);
    item_entries += shape.ItemCount(pass.domain);
  }
  stages_.resize(stage_entries);
  items_.resize(item_entries);
  passes_.resize(plan.passes.size());
  profile_ = {stage_first_.data(), stages_.data(), pass_first_.data(), items_.data(),
              passes_.data(),       stage_times};
}

}  // namespace pelt
