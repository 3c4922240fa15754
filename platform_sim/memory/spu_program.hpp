// What an SPU does with time: computes, gives commands to its MFC, waits for tags.
//
// The SPU spends its channel operations itself, stands when the MFC's queue is full and when it
// waits; the rest runs beside it. Steps come one by one from a function, so that what an SPU does
// next may depend on what has happened: a frame model hands out chunks that way.
//
//   SpuProgram driver(memory, spu, next, finished);   driver.Start();   queue.Run();
//
// DoubleBuffer makes the steps of the usual pattern: get the next block, compute on this one, put
// the last.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "platform_sim/memory/cell_memory.hpp"

namespace pelt {

struct SpuStep {
  enum class Kind : uint8_t { kCompute, kDma, kWaitTags } kind = Kind::kCompute;
  Cycles cycles = 0;      // of kCompute
  DmaCommand dma;         // of kDma
  uint32_t tag_mask = 0;  // of kWaitTags
};

SpuStep Compute(Cycles cycles);
SpuStep Dma(DmaCommand command);
SpuStep WaitTags(uint32_t tag_mask);

struct SpuTimes {
  Cycles finish = 0;  // of the last step
  Cycles compute = 0;
  Cycles channel = 0;      // spent on giving commands and asking for tags
  Cycles queue_stall = 0;  // standing before a full queue
  Cycles tag_stall = 0;    // waiting for data
};

class SpuProgram {
 public:
  // Fills in the next step; false: there is none, ever.
  using NextStep = std::function<bool(SpuStep&)>;

  SpuProgram(CellMemory& memory, uint32_t spu, NextStep next, Action finished = {});

  // Begins now; once it has finished, goes on now with what `next` has by then. It must outlive the
  // run.
  void Start();

  const SpuTimes& times() const { return times_; }
  // Why it stopped early: an illegal command. Empty if it did not.
  const std::string& error() const { return error_; }

 private:
  void Next();
  void Stand(Cycles SpuTimes::*reason, Cycles since);

  CellMemory& memory_;
  uint32_t spu_;
  NextStep next_;
  Action finished_;
  SpuStep step_;
  SpuTimes times_;
  std::string error_;
};

// Blocks of one size that stream through `buffers` places in local store.
struct StreamWork {
  DmaFar far = DmaFar::kMemory;
  uint32_t far_spu = 0;
  uint64_t get_address = 0, put_address = 0;
  uint32_t block_bytes = 16 * 1024;
  uint32_t block_count = 0;
  uint32_t buffers = 2;             // in flight at one time
  uint64_t window_bytes = 1 << 20;  // addresses wrap after so many
  bool get = true, put = false;
  Cycles compute_cycles = 0;  // on each block
};

// Buffer b uses tag b and, from local store 0 on, its own 128-byte aligned place. A get into a
// buffer whose put is not through yet is fenced behind it.
SpuProgram::NextStep DoubleBuffer(const StreamWork& work);

struct SpuRun {
  Cycles cycles = 0;  // until the last SPU finished
  std::vector<SpuTimes> spus;
  std::vector<DmaCounts> counts;
  uint64_t bus_lines = 0, memory_read_lines = 0, memory_write_lines = 0;

  uint64_t Bytes() const;
  // GB/s (10^9) over the whole run; the platform's availability is not in it.
  double GigabytesPerSecond(const CellMemoryParameters& p) const;
};

// Runs program i on SPU i, all from time 0. False, and why in `error`, for a platform or a command
// that cannot be, or more programs than SPUs.
bool RunSpus(const CellMemoryParameters& p, std::vector<SpuProgram::NextStep> programs, SpuRun& run,
             std::string& error);

// An atomic line's way from one SPE to the other: getllar that misses, putllc that must own it.
// Follows from the numbers of a command, a snoop and a line between local stores.
Cycles AtomicBounceCycles(const CellMemoryParameters& p);
// PPE writes a mailbox, SPE answers, each through an operating-system call.
Cycles MailboxRoundTripCycles(const CellMemoryParameters& p);

}  // namespace pelt
