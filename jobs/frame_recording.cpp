#include "jobs/frame_recording.hpp"

namespace pelt {

FrameRecording::FrameRecording(const Plan& plan, const SceneShape& shape) : plan_(plan) {
  uint32_t items = 0, stage_ends = 0;
  for (uint32_t p = 0; p < plan.passes.size(); ++p) {
    const pelt::Pass& pass = plan.passes[p];
    stage_pass_.insert(stage_pass_.end(), pass.stage_count, p);
    item_first_.push_back(items);
    stage_first_.push_back(stage_ends);
    item_count_.push_back(shape.ItemCount(pass.domain));
    items += item_count_[p];
    stage_ends += item_count_[p] * pass.stage_count;
  }
  items_.resize(items);
  stage_ends_.resize(stage_ends);
  profile_ = {item_first_.data(), items_.data(), stage_first_.data(), stage_ends_.data()};
}

}  // namespace pelt
