#include "jobs/tbb_executor.hpp"

#include <oneapi/tbb/global_control.h>
#include <oneapi/tbb/parallel_for.h>
#include <oneapi/tbb/task_arena.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "jobs/pass_loop.hpp"

namespace pelt {

struct TbbExecutor::State {
  explicit State(uint32_t n)
      : workers(n), limit(tbb::global_control::max_allowed_parallelism, n), arena(int(n)) {}

  // Runs body(worker) once for each worker, on as many threads as oneTBB gives.
  template <class Body>
  void ForEachWorker(const Body& body) {
    tbb::parallel_for(
        0u, workers, 1u, [&](uint32_t worker) { body(worker); }, tbb::simple_partitioner{});
  }

  uint32_t workers;
  tbb::global_control limit;
  tbb::task_arena arena;
};

TbbExecutor::TbbExecutor(uint32_t workers)
    : state_(std::make_unique<State>(workers ? workers
                                             : std::max(1u, std::thread::hardware_concurrency()))) {
}

TbbExecutor::~TbbExecutor() = default;

uint32_t TbbExecutor::workers() const { return state_->workers; }

// Ranges of items, which oneTBB halves as workers come: neighbours stay on one core, and so does
// most of what they had in its cache a pass or a frame ago. (Partitioners that remember who had an
// item are faster while workers spin from frame to frame, and 28 % slower once they sleep between
// two: what is theirs waits for them.)
void TbbExecutor::RunPasses(const Frame& frame) {
  state_->arena.execute([&] {
    ForEachPass(frame, [&](uint32_t pass, uint32_t count) {
      tbb::parallel_for(0u, count, [&](uint32_t i) {
        // For the profile only: the caller has the arena's first place.
        const int worker = frame.profile ? tbb::this_task_arena::current_thread_index() : 0;
        RunItem(frame, pass, i, uint32_t(worker));
      });
    });
  });
}

uint32_t TbbExecutor::ObservedWorkers() {
  std::atomic<uint32_t> arrived{0}, together{0};
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(10);
  state_->arena.execute([&] {
    state_->ForEachWorker([&](uint32_t) {
      arrived.fetch_add(1);
      while (arrived.load() < state_->workers && std::chrono::steady_clock::now() < deadline)
        std::this_thread::yield();
      uint32_t none =
          0;  // the first to leave knows how many were inside; later arrivals came alone
      together.compare_exchange_strong(none, arrived.load());
    });
  });
  return together.load();
}

}  // namespace pelt
