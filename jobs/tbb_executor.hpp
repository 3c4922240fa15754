// Runs a frame on oneTBB. The only header whose source sees oneTBB.
#pragma once

#include <memory>

#include "jobs/frame.hpp"

namespace pelt {

class TbbExecutor final : public Executor {
 public:
  // Runs on `workers` threads, the caller's included; 0: one for each core. oneTBB silently gives
  // an arena fewer threads than it asked for, so the limit is raised for the executor's lifetime
  // and the number that really ran together is observed: see ObservedWorkers. Of several executors
  // alive at a time the smallest limit holds for all (oneTBB's rule): keep one at a time.
  explicit TbbExecutor(uint32_t workers);
  ~TbbExecutor() override;

  uint32_t workers() const;
  // Threads that were inside the arena at one time, found by a rendezvous. Below workers() when
  // oneTBB gave fewer within ten seconds.
  uint32_t ObservedWorkers();

 private:
  void RunPasses(const Frame& frame) override;

  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace pelt
