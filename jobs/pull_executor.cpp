#include "jobs/pull_executor.hpp"

#include "jobs/spin_wait.hpp"
#include "jobs/tick_clock.hpp"

namespace pelt {
namespace {

// A frame as the scheduler sees it.
struct FramePasses {
  const Frame& frame;

  uint32_t Count() const { return uint32_t(frame.plan->passes.size()); }
  uint32_t Items(uint32_t pass) const {
    return frame.memory->shape->ItemCount(frame.plan->passes[pass].domain);
  }
  void OnBegin(uint32_t pass) const {
    if (frame.profile) frame.profile->passes[pass].begin_ticks = ReadTicks();
  }
  void OnEnd(uint32_t pass) const {
    if (frame.profile) frame.profile->passes[pass].end_ticks = ReadTicks();
    if (frame.phase && pass + 1 == Count()) frame.phase->EndRun();
  }
};

}  // namespace

bool PullExecutor::Begin(const Frame& frame, const char** why) {
  const char* fault = frame.phase ? frame.phase->StartRun() : nullptr;
  if (!fault && !scheduler_.TakeForFrame()) {
    fault = "another frame is open on this executor";
    if (frame.phase) frame.phase->UndoStart();
  }
  if (why) *why = fault;
  if (fault) return false;
  frame_ = frame;
  scheduler_.Open(FramePasses{frame_});
  return true;
}

PullResult PullExecutor::TryRun(uint32_t worker) {
  PullScheduler<std::atomic>::Item item;
  const PullResult result = scheduler_.TryClaim(item);
  if (result != PullResult::kRan) return result;
  const FramePasses passes{frame_};
  RunItem(frame_, item.pass, passes.Items(item.pass) - item.unclaimed, worker);
  scheduler_.Finish(item.pass, passes);
  return result;
}

void PullExecutor::RunPasses(const Frame& frame) {
  SpinWait wait;
  const auto help = [&] {
    const PullResult result = TryRun();
    if (result == PullResult::kRan) {
      wait.Reset();
    } else {
      wait.Once();
    }
  };
  while (!Begin(frame)) help();
  while (!IsIdle()) help();
}

}  // namespace pelt
