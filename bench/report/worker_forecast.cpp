#include "bench/report/worker_forecast.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <queue>
#include <tuple>

#include "bench/report/budget.hpp"
#include "core/error.hpp"
#include "jobs/frame_scheduler.hpp"

namespace pelt {
namespace {

using Scheduler = FrameScheduler<std::atomic>;

// Workers take items as they do in a frame (it is the same scheduler), but time is counted.
class SimulatedFrame {
 public:
  SimulatedFrame(const FrameGraph& graph, std::span<const double> costs, uint32_t workers)
      : graph_(graph),
        costs_(costs),
        scheduler_(workers, uint32_t(graph.words.size()), uint32_t(graph.nodes.size())) {
    for (uint32_t w = 0; w < workers; ++w) idle_.push_back(w);
  }

  // Returns when it ends.
  double Run() {
    double now = 0.0;
    if (!scheduler_.TakeForFrame()) return now;
    scheduler_.Start(graph_, [] {});
    for (StartItems(now); !running_.empty(); StartItems(now)) {
      const auto [end, worker, node] = running_.top();
      running_.pop();
      now = end;
      scheduler_.Finish(graph_, node, [] {});
      idle_.insert(std::ranges::lower_bound(idle_, worker), worker);
    }
    return now;
  }

 private:
  void StartItems(double now) {
    std::erase_if(idle_, [&](uint32_t worker) {
      Scheduler::Claim claim;
      if (scheduler_.TryClaim(worker, claim) != PullResult::kRan) return false;
      const uint32_t at = graph_.AtItem(claim.word, claim.bit);
      running_.emplace(now + costs_[at], worker, graph_.item_node[at]);
      return true;
    });
  }

  const FrameGraph& graph_;
  std::span<const double> costs_;
  Scheduler scheduler_;
  std::vector<uint32_t> idle_;  // by number
  // When an item ends, who runs it, what it counts for: the earliest first.
  using Running = std::tuple<double, uint32_t, uint32_t>;
  std::priority_queue<Running, std::vector<Running>, std::greater<>> running_;
};

// The cost of each stage on each of its items, as the profile says it ran.
std::vector<double> StageBytes(const Frame& frame, uint32_t pass, uint32_t stage) {
  const Plan& plan = *frame.plan;
  const SceneShape& shape = *frame.memory->shape;
  std::vector<double> bytes(shape.ItemCount(plan.passes[pass].domain), 0.0);
  for (uint32_t i = 0; i < bytes.size(); ++i) {
    if (!frame.profile->Stage(plan, pass, i, stage - plan.passes[pass].first_stage).Ran()) continue;
    const PortTraffic traffic = StageTraffic(plan.stages[stage], shape, i);
    bytes[i] = double(traffic.in_bytes + traffic.out_bytes);
  }
  return bytes;
}

}  // namespace

FrameForecast::FrameForecast(const Frame& frame, const StageTimes& times) : plan_(*frame.plan) {
  costs_.resize(plan_.graph.item_node.size(), 0.0);
  for (uint32_t p = 0; p < plan_.passes.size(); ++p)
    for (uint32_t s = 0; s < plan_.passes[p].stage_count; ++s) {
      const uint32_t stage = plan_.passes[p].first_stage + s;
      const std::vector<double> bytes = StageBytes(frame, p, stage);
      double sum = 0.0;
      for (const double b : bytes) sum += b;
      const auto time = times.find(plan_.stages[stage].kernel.name);
      const double scale = times.empty()         ? 1.0
                           : time == times.end() ? 0.0
                                                 : time->second / std::max(sum, 1.0);
      for (size_t i = 0; i < bytes.size(); ++i)
        costs_[plan_.graph.pass_first[p] + i] += scale * bytes[i];
    }
  for (const double cost : costs_) total_ += cost;
}

double FrameForecast::CriticalPath() const {
  const FrameGraph& graph = plan_.graph;
  std::vector<double> fires(graph.nodes.size(), 0.0);  // when: with workers without end
  std::vector<uint32_t> left, ready = {0};
  for (const FrameGraph::Node& node : graph.nodes) left.push_back(node.waits_for);
  const auto count = [&](uint32_t node, double when) {
    fires[node] = std::max(fires[node], when);
    if (--left[node] == 0) ready.push_back(node);
  };
  while (!ready.empty()) {
    const uint32_t node = ready.back();
    ready.pop_back();
    graph.ForEachOpened(node, [&](uint32_t, uint32_t, uint32_t at) {
      count(graph.item_node[at], fires[node] + costs_[at]);
    });
    for (uint32_t n = graph.nodes[node].first_next; n < graph.nodes[node + 1].first_next; ++n)
      count(graph.next[n], fires[node]);
  }
  return fires[graph.LastNode()];
}

std::vector<double> FrameForecast::PassShares() const {
  std::vector<double> shares(plan_.passes.size(), 0.0);
  for (size_t p = 0; p < shares.size(); ++p) {
    const size_t end =
        p + 1 < shares.size() ? plan_.graph.pass_first[p + 1] : plan_.graph.item_node.size();
    for (size_t i = plan_.graph.pass_first[p]; i < end; ++i) shares[p] += costs_[i] / total_;
  }
  return shares;
}

WorkerForecast FrameForecast::On(uint32_t workers) const {
  const double best = std::max(total_ / workers, CriticalPath());
  const double ours = SimulatedFrame(plan_.graph, costs_, workers).Run();
  return {workers, total_ / best, total_ / ours};
}

StageTimes StageTimesOf(const MeasuredRun& run, std::string_view from, const Plan& plan) {
  StageTimes times;
  for (auto [stage, ms] : run.stages_ms) times[stage] = SpreadOf(ms).median;
  for (const Stage& stage : plan.stages)
    if (!times.contains(stage.kernel.name))
      throw Error(fmt::format("{}: has no stage '{}': it is of another scene or plan", from,
                              stage.kernel.name));
  return times;
}

}  // namespace pelt
