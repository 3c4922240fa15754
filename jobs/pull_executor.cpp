#include "jobs/pull_executor.hpp"

#include <algorithm>

#include "jobs/spin_wait.hpp"

namespace pelt {
namespace {

// Room for about a million strands.
constexpr uint32_t kWords = 1024, kNodes = 16384;

uint32_t CoreCount() {
#if defined(__wasi__)
  return 1;
#else
  return std::max(1u, std::thread::hardware_concurrency());
#endif
}

}  // namespace

PullExecutor::PullExecutor(uint32_t workers)
    : scheduler_(workers ? workers : CoreCount(), kWords, kNodes) {}

bool PullExecutor::Begin(const Frame& frame, const char** why) {
  const char* fault = frame.phase ? frame.phase->StartRun() : nullptr;
  if (!fault && !scheduler_.TakeForFrame()) {
    fault = "another frame is open on this executor";
    if (frame.phase) frame.phase->UndoStart();
  }
  if (why) *why = fault;
  if (fault) return false;
  frame_ = frame;
  scheduler_.Start(frame_.plan->graph, [this] { EndRun(); });
  return true;
}

PullResult PullExecutor::TryRun(uint32_t worker) {
  FrameScheduler<std::atomic>::Claim claim;
  const PullResult result = scheduler_.TryClaim(worker, claim);
  if (result != PullResult::kRan) return result;
  const FrameGraph& graph = frame_.plan->graph;
  const FrameGraph::Word& word = graph.words[claim.word];
  RunItem(frame_, word.pass, graph.items[word.first + claim.bit], worker);
  scheduler_.Finish(graph, graph.item_node[graph.AtItem(claim.word, claim.bit)],
                    [this] { EndRun(); });
  return result;
}

void PullExecutor::EndRun() const {
  if (frame_.phase) frame_.phase->EndRun();
}

void PullExecutor::RunPasses(const Frame& frame) {
  SpinWait wait;
  while (!Begin(frame)) wait.After(TryRun() == PullResult::kRan);
  while (!IsIdle()) wait.After(TryRun() == PullResult::kRan);
}

}  // namespace pelt
