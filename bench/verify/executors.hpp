// The executors of a frame, one entry each: what `--executor` offers, what `pelt verify` compares
// with the reference, what every report names.
//
// Invariant: what a caller wants to know of an executor is a property of its entry, and what an
// executor has to say of its runs it says through WatchedExecutor; no caller asks which one it is.
// Only a check that is about one executor (closed pages) names it.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "jobs/frame.hpp"
#include "jobs/verify/mismatch.hpp"

namespace pelt {

// An executor, and what it can say of its runs.
class WatchedExecutor : public Executor {
 public:
  // Threads that ran together, found by a rendezvous; 1 for executors without workers.
  virtual uint32_t ObservedWorkers() = 0;
  // What it found wrong while it ran: undeclared accesses, a door misused.
  virtual std::vector<Finding> Findings() const = 0;
  std::vector<std::string> Faults() const;  // their texts
  // Stages, each counted for every item it ran on; 0: it does not count them.
  virtual uint64_t StagesRun() const = 0;
};

// How the items of a pass follow each other, and so which settings the executor needs.
enum class ItemOrder : uint8_t { kAscending, kSeeded, kThreads };

struct ExecutorSettings {
  uint32_t workers = 1;     // kThreads
  uint64_t order_seed = 0;  // kSeeded
  uint32_t local_store_data_bytes = PlanOptions{}.local_store_data_bytes;
};

struct ExecutorEntry {
  std::string_view name, text;  // "on threads of oneTBB"
  ItemOrder order;
  std::unique_ptr<WatchedExecutor> (*make)(const ExecutorSettings&);
  // Runs on copies: every item of its plan has to fit, and its times are not a frame's.
  bool local_store = false;
  // Runs every stage by itself, for verification alone: fusion is nothing to it, and no command
  // offers it.
  bool stages_alone = false;
  bool (*available)() = nullptr;  // on this system; null: everywhere

  bool HasWorkers() const { return order == ItemOrder::kThreads; }
  bool HasSeed() const { return order == ItemOrder::kSeeded; }
  bool IsAvailable() const { return !available || available(); }
};

// All entries: the first is the reference's, then as tables of a report have them.
std::span<const ExecutorEntry> ExecutorEntries();

// An entry, by its name. Throws Error for a name that no entry has.
class ExecutorKind {
 public:
  ExecutorKind() : entry_(&ExecutorEntries().front()) {}
  explicit ExecutorKind(std::string_view name);
  ExecutorKind(const char* name) : ExecutorKind(std::string_view(name)) {}
  ExecutorKind(const ExecutorEntry& entry) : entry_(&entry) {}

  const ExecutorEntry* operator->() const { return entry_; }
  bool operator==(const ExecutorKind&) const = default;

 private:
  const ExecutorEntry* entry_;
};

// The names of those that commands offer: all of them, or those with workers, or with a seed.
std::vector<std::string> OfferedExecutors(bool (ExecutorEntry::*which)() const = nullptr);

}  // namespace pelt
