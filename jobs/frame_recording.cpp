#include "jobs/frame_recording.hpp"

namespace pelt {

FrameRecording::FrameRecording(const Plan& plan, const SceneShape& shape) : plan_(plan) {
  uint32_t items = 0, stage_ends = 0;
  for (uint32_t p = 0; p < plan.passes.size(); ++p) {
    const pelt::Pass& pass = plan.passes[p];
    stage_pass_.insert(stage_pass_.end(), pass.stage_count, p);
    item_first_.push_back(items);
    stage_first_.push_back(stage_ends);
    items += shape.ItemCount(pass.domain);
    stage_ends += shape.ItemCount(pass.domain) * pass.stage_count;
  }
  items_.resize(items);
  stage_ends_.resize(stage_ends);
  passes_.resize(plan.passes.size());
  profile_ = {item_first_.data(), items_.data(), stage_first_.data(), stage_ends_.data(),
              passes_.data()};
}

}  // namespace pelt
