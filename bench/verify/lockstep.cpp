#include "bench/verify/lockstep.hpp"

#include <algorithm>
#include <cfenv>
#include <cstdint>
#include <thread>

#include "core/error.hpp"

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace pelt {
namespace {

// The worst that a thread may bring along: it rounds upwards, flushes denormal results to zero and
// takes denormal operands for zero. Threads started meanwhile inherit it. Put back on the way out.
class OddFloats {
 public:
  explicit OddFloats(bool on) : on_(on) {
    if (!on_) return;
    std::fegetenv(&saved_);
    std::fesetround(FE_UPWARD);
#if defined(__SSE__)
    _mm_setcsr(_mm_getcsr() | 0x8040u);
#elif defined(__aarch64__)
    uint64_t control;
    asm volatile("mrs %0, fpcr" : "=r"(control));
    asm volatile("msr fpcr, %0" : : "r"(control | (uint64_t{1} << 24)));
#endif
  }
  ~OddFloats() {
    if (on_) std::fesetenv(&saved_);
  }
  OddFloats(const OddFloats&) = delete;
  OddFloats& operator=(const OddFloats&) = delete;

 private:
  bool on_;
  std::fenv_t saved_;
};

}  // namespace

SceneOptions SceneOptionsOf(const VerifyCase& what) {
  SceneOptions options;
  options.plan.must_fit = what.executor->local_store;
  options.isa = what.isa;
  options.plan.fuse = what.fuse;
  options.vertex_order = what.vertex_order;
  options.piecewise_sort_chunks = what.piecewise_sort ? 1 : 0;
  return options;
}

uint32_t WorkersOf(const VerifyCase& what) {
  if (!what.executor->HasWorkers()) return 1;
  return what.workers ? what.workers : std::max(1u, std::thread::hardware_concurrency());
}

std::unique_ptr<WatchedExecutor> MakeExecutor(const VerifyCase& what) {
  return what.executor->make({.workers = WorkersOf(what), .order_seed = what.order_seed});
}

SkipSettings NoSkips(bool lod) {
  return {.sleep = false,
          .unmoved = false,
          .sort = false,
          .cull = false,
          .wind = false,
          .light = false,
          .lod = lod};
}

FrameSettings FrameSettingsOf(Settings settings, const Scenario& scenario) {
  FrameSettings all;
  if (settings == Settings::kNoSkips) all.skip = NoSkips();
  if (settings == Settings::kLod) {
    all.skip.lod = true;
    all.lod.strand_budget = uint32_t(scenario.StrandCount() / 2);
    all.lod.costs = {0.0f, 0.0f, 1000.0f, {}};
    all.lod.budget_us = std::max(1u, all.lod.strand_budget * 4 / 5);
  }
  return all;
}

CaseRun::CaseRun(Scenario& scenario, const VerifyCase& what, const FrameSettings& settings,
                 const std::function<void(const VerifyCase&, Plan&)>& tamper)
    : odd_floats_(what.odd_floats),
      running_(scenario, SceneOptionsOf(what)),
      plan_(running_.scene().plan()),
      settings_(settings) {
  const OddFloats odd(odd_floats_);  // its threads inherit them
  executor_ = MakeExecutor(what);
  if (tamper) tamper(what, plan_);
}

void CaseRun::RunFrame(uint32_t frame, const Change& change) {
  if (!TryRunFrame(frame, change)) throw Error(running_.RefusalText(frame));
}

bool CaseRun::TryRunFrame(uint32_t frame, const Change& change) {
  FrameInput input = running_.Prepare(frame, settings_.skip, settings_.lod);
  if (change) change(input, running_.scene());
  const OddFloats odd(odd_floats_);
  if (!running_.TryBegin(input)) return false;
  Frame work = running_.scene().CurrentFrame();
  work.plan = &plan_;
  executor_->Run(work);
  return true;
}

std::optional<Mismatch> FindMismatch(CaseRun& expected, CaseRun& found, uint32_t frame,
                                     bool bookkeeping) {
  const FurScene& scene = expected.scene();
  std::optional<Mismatch> out = FindMismatch({&expected.plan(), &scene.memory()},
                                             {&found.plan(), &found.scene().memory()}, bookkeeping);
  if (!out) return out;
  out->frame = frame;
  if (out->layer_index != Mismatch::kNoLayer) out->layer = scene.LayerName(out->layer_index);
  return out;
}

}  // namespace pelt
