// Runs every stage alone between pages that no code may touch.
//
// Each block that the stage's ports declare is copied to a place of its own, with closed pages
// around it; read-only ports lie on pages that cannot be written. Any other access of a kernel
// stops it at that instruction, regardless of the value there, and the address says which block of
// which stream it would have been. Every stage runs twice: with its blocks against the page behind
// them, then against the page in front, and with two different contents of what it declares Out.
// Both runs must give the same bytes, so nothing a kernel writes may come from what it promised not
// to read, from where its blocks lie, or from what it remembers.
//
// Invariant: no two runs in a row use the same addresses, and those of earlier runs are closed, so
// a pointer that a kernel keeps is stale the next time it is followed. What breaks if ignored: the
// bytes that happened to lie around a block would decide what is found.
//
// Needs a system with pages to protect and signals (POSIX); elsewhere IsAvailable() is false.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "jobs/frame.hpp"
#include "jobs/verify/mismatch.hpp"

namespace pelt {

class GuardedExecutor final : public Executor {
 public:
  static bool IsAvailable();

  GuardedExecutor();
  ~GuardedExecutor() override;

  // One for each kind of fault, stage and stream, in the order in which they were found.
  const std::vector<Finding>& findings() const { return findings_; }
  uint64_t stages_run() const { return stages_run_; }

 private:
  void RunPasses(const Frame& frame) override;

  class Arena;
  struct Place;
  struct StageRun;

  void RunUnguarded(const Frame& frame);
  void RunStage(const Frame& frame, const Stage& stage, uint32_t item);
  // False, with a finding, when the kernel was stopped or wrote where it may not.
  bool RunOnce(const Frame& frame, const Stage& stage, uint32_t item, StageRun& run);
  bool CheckSlack(const Frame& frame, const Stage& stage, uint32_t item, const StageRun& run);
  void Compare(const Frame& frame, const Stage& stage, uint32_t item, StageRun& first,
               StageRun& second);
  // The stream of the port declared Out whose contents decide; empty when none does.
  std::string FindOutThatMatters(const Frame& frame, const Stage& stage, uint32_t item,
                                 const StageRun& first);
  void Store(const Frame& frame, const Stage& stage, uint32_t item, const StageRun& run);
  void Find(FindingKind kind, const Stage& stage, std::string stream, std::string text);

  std::unique_ptr<Arena> arena_;
  std::vector<Finding> findings_;
  uint64_t frames_run_ = 0, stages_run_ = 0;
};

}  // namespace pelt
