#include "platform_sim/frame/modelled_frame.hpp"

namespace pelt {

std::string_view UnitWorkName(UnitWork work) {
  constexpr std::string_view kNames[kUnitWorkCount] = {
      "dispatch", "commands", "code", "get stall", "compute", "put stall", "imbalance", "barrier"};
  return kNames[size_t(work)];
}

void ModelledFrame::BeginWith(const FrameWork& work) {
  cycles = 0;
  passes.assign(work.passes.size(), {});
  stage_cycles.assign(work.stage_count, 0);
  stage_items.assign(work.stage_count, 0);
  stream_get_bytes.assign(work.stream_count, 0);
  stream_put_bytes.assign(work.stream_count, 0);
}

void ModelledFrame::Count(const ItemWork& work, uint32_t pass) {
  ModelledPass& of = passes[pass];
  of.items += !work.stages.empty();
  for (const ItemWork::StageTime& stage : work.stages) ++stage_items[stage.stage];
  uint64_t bytes = 0;
  for (const ItemWork::StreamBytes& s : work.streams) {
    stream_get_bytes[size_t(s.stream)] += s.get_bytes;
    stream_put_bytes[size_t(s.stream)] += s.put_bytes;
    of.get_bytes += s.get_bytes;
    of.put_bytes += s.put_bytes;
    bytes += s.get_bytes + s.put_bytes;
  }
  of.wasted_bytes += work.get.bytes + work.put.bytes - bytes;
}

}  // namespace pelt
