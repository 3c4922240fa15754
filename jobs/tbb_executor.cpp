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

// Items are handed out by a counter: a chunk costs microseconds, so one atomic step each balances
// the load, and oneTBB sees one task a worker instead of one an item.
void TbbExecutor::Run(const Frame& frame) {
  state_->arena.execute([&] {
    ForEachPass(frame, [&](uint32_t pass, uint32_t count) {
      if (count == 1 || state_->workers == 1) {
        for (uint32_t i = 0; i < count; ++i) RunItem(frame, pass, i);
        return;
      }
      std::atomic<uint32_t> next{0};
      state_->ForEachWorker([&](uint32_t worker) {
        for (uint32_t i; (i = next.fetch_add(1, std::memory_order_relaxed)) < count;)
          RunItem(frame, pass, i, worker);
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
