// Runs a frame as an SPU would see it: every block a kernel declared is copied into a real,
// poisoned 256 KiB buffer, the kernel runs there, and what it declared as written is copied back.
//
// What it proves: a kernel that reads what it did not declare, or what it declared Out, sees NaN
// (0xFF bytes), so its digest differs; a write through a read-only port, to a block of another
// stage, past a block, or scattered outside the layer is found at once and named. Nothing here is
// timed: the platform models do that from the same plan and the counts kept here.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "jobs/frame.hpp"

namespace pelt {

inline constexpr uint32_t kLocalStoreBytes = 256 * 1024;

struct LocalStoreFault {
  enum class Kind : uint8_t {
    kWrote,       // where no port lets it
    kDoesNotFit,  // the plan is for another local store
  };
  std::string_view stage;
  uint32_t item;
  std::string what;
  Kind kind = Kind::kWrote;
  std::string_view stream = {};  // of the block; empty for a write past all of them
};

struct LocalStoreCounts {
  uint64_t get_bytes = 0, put_bytes = 0;
  uint64_t transient_bytes = 0;  // put only so that digests can be compared; a console would not
  uint64_t dma_commands =
      0;  // at most 16 KiB each; gathered and scattered records are one list element each
  uint64_t list_elements = 0;
  uint32_t peak_bytes = 0;  // of data at one time, for one item
};

// What one item moved, and which stages ran on it: what a model of its time starts from.
struct LocalStoreItem {
  struct Block {
    Stream stream;
    uint32_t get_bytes, put_bytes;        // what a console would move
    uint32_t get_elements, put_elements;  // records of a list; 0: the block moves whole
    uint32_t get_lines, put_lines;        // of memory, that the records touch
  };
  std::vector<Block> blocks;  // in the order in which they came
  std::vector<uint32_t> stages;

  void Clear() {
    blocks.clear();
    stages.clear();
  }
};

// Called for each stage that is about to run, while main memory stands as its gate saw it.
class StageObserver {
 public:
  virtual ~StageObserver() = default;
  virtual void OnStage(uint32_t stage, uint32_t item) = 0;
};

class LocalStoreExecutor final : public Executor {
 public:
  // `data_bytes`: what kernels may fill, the plan's limit. A port beyond it is a fault, and its
  // stage does not run.
  explicit LocalStoreExecutor(uint32_t data_bytes);
  ~LocalStoreExecutor() override;

  // One item of one pass, as Run does it; what it moved is added to `moved`.
  void RunItem(const Frame& frame, uint32_t pass, uint32_t item, StageObserver& observer,
               LocalStoreItem& moved);

  const LocalStoreCounts& counts() const { return counts_; }
  const std::vector<LocalStoreFault>& faults() const { return faults_; }

 private:
  // A block (or list of records) that lies in the local store.
  struct Resident {
    Stream stream;
    Access access;  // as first bound
    uint32_t offset, bytes, record_bytes, count;
    bool writable;  // by the stage that is running
    bool written;   // and not yet put
    LocalStoreItem::Block moved;
  };
  struct Buffer;

  void RunPasses(const Frame& frame) override;
  void RunStages(const Frame& frame, const Pass& pass, uint32_t item, StageObserver* observer);
  void RunStage(const Frame& frame, const Stage& stage, uint32_t item);
  // Null when it does not fit.
  Resident* FindOrLoad(const Frame& frame, const Stage& stage, const PortDesc& port, uint32_t item);
  void Load(const Frame& frame, const Binding& main, uint32_t item, Resident& block);
  void Store(const Frame& frame, const Stage& stage, uint32_t item, Resident& block,
             bool transient);
  void Scatter(const Frame& frame, const Stage& stage, uint32_t item, Resident& block);
  void CheckUntouched(const Frame& frame, const Stage& stage, uint32_t item, const Resident& block);
  void CheckGuards(const Frame& frame, const Stage& stage, uint32_t item);
  void Fault(const Stage& stage, uint32_t item, std::string what, std::string_view stream,
             LocalStoreFault::Kind kind = LocalStoreFault::Kind::kWrote);
  void CountTransfer(uint64_t bytes, bool get);

  uint32_t data_bytes_;
  std::unique_ptr<Buffer> buffer_;
  std::vector<std::byte> snapshot_;
  std::vector<Resident> resident_;
  std::vector<uint32_t> stages_ran_;  // on the item, when there is an observer
  uint32_t top_ = 0;                  // first byte behind the last guard
  uint32_t data_used_ = 0;            // of it, without guards
  LocalStoreCounts counts_;
  std::vector<LocalStoreFault> faults_;
};

}  // namespace pelt
