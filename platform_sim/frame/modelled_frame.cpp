#include "platform_sim/frame/modelled_frame.hpp"

#include <algorithm>
#include <numeric>

#include "platform_sim/frame/frame_clock.hpp"

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

namespace {

void AddCycles(WorkMs& sum, const WorkCycles& cycles, double share) {
  for (uint32_t w = 0; w < kUnitWorkCount; ++w) sum[w] += double(cycles[w]) * share;
}

Cycles At(const std::vector<Cycles>& sorted, double part) {
  if (sorted.empty()) return 0;
  return sorted[std::min(sorted.size() - 1, size_t(double(sorted.size()) * part))];
}

}  // namespace

std::string_view PassLimitName(PassLimit limit) {
  constexpr std::string_view kNames[kPassLimitCount] = {"compute", "memory", "dispatch",
                                                        "imbalance"};
  return kNames[size_t(limit)];
}

ConsoleMachine WithoutLimit(const ConsoleMachine& machine, PassLimit limit) {
  ConsoleMachine free = machine;
  switch (limit) {
    case PassLimit::kCompute:
      free.compute_is_free = true;
      break;
    case PassLimit::kMemory:
      free.memory = FreeMemory(machine.memory.units_per_port);
      free.command_cycles = free.wait_cycles = 0;
      break;
    case PassLimit::kDispatch:
      free.draw_cycles = free.dispatcher_cycles = free.barrier_cycles = 0;
      break;
    case PassLimit::kImbalance:
      break;
  }
  return free;
}

FrameStatistics::FrameStatistics(const ConsoleMachine& machine, const Plan& plan)
    : machine_(machine) {
  sum_.stages.resize(plan.stages.size());
  sum_.passes.resize(plan.passes.size());
  sum_.stream_get_bytes.resize(plan.table->streams.size());
  sum_.stream_put_bytes.resize(plan.table->streams.size());
  for (uint32_t p = 0; p < plan.passes.size(); ++p)
    stage_pass_.insert(stage_pass_.end(), plan.passes[p].stage_count, p);
}

double FrameStatistics::CyclesOf(const ModelledPass& pass) const {
  return double(std::accumulate(pass.unit_cycles.begin(), pass.unit_cycles.end(), Cycles{0})) /
         machine_.units;
}

void FrameStatistics::Add(const ModelledFrame& frame) {
  if (lengths_.empty() || frame.cycles > *std::max_element(lengths_.begin(), lengths_.end()))
    sum_.worst_frame = uint32_t(lengths_.size());
  lengths_.push_back(frame.cycles);
  cycles_ += double(frame.cycles);
  for (size_t p = 0; p < frame.passes.size(); ++p) {
    const ModelledPass& pass = frame.passes[p];
    FrameSummary::Pass& sum = sum_.passes[p];
    sum.ms += CyclesOf(pass);
    sum.items += pass.items;
    for (WorkMs* total : {&sum.unit_ms, &sum_.unit_ms})
      AddCycles(*total, pass.unit_cycles, 1.0 / machine_.units);
    for (WorkMs* total : {&sum.critical_ms, &sum_.critical_ms})
      AddCycles(*total, pass.critical_cycles, 1.0);
    sum_.code_bytes += double(pass.code_bytes);
    sum_.wasted_bytes += double(pass.wasted_bytes);
    bytes_ += double(pass.get_bytes + pass.put_bytes + pass.code_bytes + pass.wasted_bytes);
  }
  for (size_t s = 0; s < frame.stage_cycles.size(); ++s) {
    const ModelledPass& pass = frame.passes[stage_pass_[s]];
    const auto compute = double(pass.unit_cycles[size_t(UnitWork::kCompute)]);
    const auto cycles = double(frame.stage_cycles[s]);
    sum_.stages[s].core_ms += cycles;
    if (compute > 0.0) sum_.stages[s].wall_ms += CyclesOf(pass) * cycles / compute;
    sum_.stages[s].items += frame.stage_items[s];
  }
  for (size_t s = 0; s < frame.stream_get_bytes.size(); ++s) {
    sum_.stream_get_bytes[s] += double(frame.stream_get_bytes[s]);
    sum_.stream_put_bytes[s] += double(frame.stream_put_bytes[s]);
  }
}

void FrameStatistics::AddLimits(const ModelledFrame& frame, const FrameWork& work) {
  ++limited_frames_;
  for (const PassLimit limit : {PassLimit::kCompute, PassLimit::kMemory, PassLimit::kDispatch}) {
    const ModelledFrame without = TimeFrame(work, WithoutLimit(machine_, limit));
    for (size_t p = 0; p < without.passes.size(); ++p)
      sum_.passes[p].without_ms[size_t(limit)] += CyclesOf(without.passes[p]);
  }
  for (size_t p = 0; p < frame.passes.size(); ++p) {
    const ModelledPass& pass = frame.passes[p];
    const auto idle = double(pass.unit_cycles[size_t(UnitWork::kImbalance)]);
    sum_.passes[p].limited_ms += CyclesOf(pass);
    sum_.passes[p].without_ms[size_t(PassLimit::kImbalance)] +=
        CyclesOf(pass) - idle / machine_.units;
  }
}

FrameSummary FrameStatistics::Summarise() const {
  FrameSummary s = sum_;
  s.frames = uint32_t(lengths_.size());
  if (s.frames == 0) return s;
  std::vector<Cycles> sorted = lengths_;
  std::sort(sorted.begin(), sorted.end());
  s.median_ms = machine_.Milliseconds(double(At(sorted, 0.5)));
  s.p95_ms = machine_.Milliseconds(double(At(sorted, 0.95)));
  s.worst_ms = machine_.Milliseconds(double(sorted.back()));

  const double mean = 1.0 / s.frames, mean_ms = machine_.Milliseconds(mean);
  const auto scale = [](auto& values, double by) {
    for (double& value : values) value *= by;
  };
  for (FrameSummary::Stage& stage : s.stages) {
    stage.core_ms *= mean_ms;
    stage.wall_ms *= mean_ms;
    stage.items *= mean;
  }
  const double limited_ms =
      limited_frames_ > 0 ? machine_.Milliseconds(1.0 / limited_frames_) : 0.0;
  for (FrameSummary::Pass& pass : s.passes) {
    pass.ms *= mean_ms;
    pass.items *= mean;
    scale(pass.unit_ms, mean_ms);
    scale(pass.critical_ms, mean_ms);
    scale(pass.without_ms, limited_ms);
    pass.limited_ms *= limited_ms;
    const auto least = std::min_element(pass.without_ms.begin(), pass.without_ms.end());
    pass.binds = PassLimit(least - pass.without_ms.begin());
  }
  scale(s.unit_ms, mean_ms);
  scale(s.critical_ms, mean_ms);
  scale(s.stream_get_bytes, mean);
  scale(s.stream_put_bytes, mean);
  s.code_bytes *= mean;
  s.wasted_bytes *= mean;
  const double rate = std::max(machine_.memory.read_rate, machine_.memory.mixed_rate);
  s.bus_use = cycles_ > 0.0 ? bytes_ / (cycles_ * rate) : 0.0;
  return s;
}

}  // namespace pelt
