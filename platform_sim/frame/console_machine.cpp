#include "platform_sim/frame/console_machine.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "platform_sim/memory/spu_program.hpp"
#include "platform_sim/memory/xenon_memory.hpp"

namespace pelt {

// ---- Cell ---------------------------------------------------------------------------------------
//
// The Cell as frames see it: short streams on the line-level model give its memory's numbers.

namespace {

// Of each SPU: at the begin, all read before any writes.
constexpr uint32_t kStreamBytes = 1 << 20;

// Runs streams and notes the first error; a platform was checked before, so there is none.
class CellBench {
 public:
  CellBench(const CellMemoryParameters& p, std::string& error) : p_(p), error_(error) {}

  bool Failed() const { return !error_.empty(); }

  // Bytes a cycle of `spus` that stream blocks of the largest command.
  double Rate(uint32_t spus, bool get, bool put) {
    std::vector<SpuProgram::NextStep> programs;
    for (uint32_t s = 0; s < spus; ++s) {
      StreamWork work;
      work.get_address = uint64_t(s) << 24;
      work.put_address = work.get_address + (1 << 23);
      work.block_bytes = p_.largest_command_bytes;
      work.block_count = kStreamBytes / p_.largest_command_bytes;
      work.buffers = Buffers(get && put);
      work.get = get;
      work.put = put;
      programs.push_back(DoubleBuffer(work));
    }
    const SpuRun run = Run(std::move(programs));
    return run.cycles > 0 ? double(run.Bytes()) / double(run.cycles) : 0.0;
  }

  // Of one command of one SPU alone, without what the SPU spends on giving it and asking for it.
  double Alone(DmaKind kind, uint32_t bytes) {
    std::vector<SpuStep> steps = {WaitTags(1), Dma(MakeDma(kind, 0, 0, bytes, 0))};
    const SpuRun run = Run({[steps](SpuStep& step) mutable {
      if (steps.empty()) return false;
      step = std::move(steps.back());
      steps.pop_back();
      return true;
    }});
    return double(run.cycles) -
           double(p_.ChannelCycles()) * (p_.channels_per_command + p_.channels_per_wait);
  }

 private:
  // Both ways, puts must not hold gets back: more buffers, as many as fit half the store.
  uint32_t Buffers(bool both) const {
    const uint32_t most = p_.local_store_bytes / p_.largest_command_bytes;
    return std::clamp(most, 1u, both ? 4u : 2u);
  }

  SpuRun Run(std::vector<SpuProgram::NextStep> programs) {
    SpuRun run;
    std::string error;
    if (!RunSpus(p_, std::move(programs), run, error) && error_.empty()) error_ = error;
    return run;
  }

  const CellMemoryParameters& p_;
  std::string& error_;
};

SharedMemory MeasureMemory(const CellMemoryParameters& p, CellBench& bench) {
  SharedMemory m;
  m.read_rate = bench.Rate(p.spu_count, true, false);
  m.write_rate = bench.Rate(p.spu_count, false, true);
  m.mixed_rate = bench.Rate(p.spu_count, true, true);
  m.port_read_rate = bench.Rate(1, true, false);
  m.port_write_rate = bench.Rate(1, false, true);
  m.command_cycles = p.command_cycles;
  m.element_cycles = p.list_element_cycles;
  m.line_cycles = p.bus_cycle_cycles;

  // A line alone: taken up, its own time at memory, and the latency.
  const double fixed = double(p.command_cycles);
  const double read = bench.Alone(DmaKind::kGet, p.line_bytes);
  const double write = bench.Alone(DmaKind::kPut, p.line_bytes);
  m.read_latency_cycles = Cycles(std::lround(read - fixed - p.line_bytes / m.read_rate));
  m.write_latency_cycles = Cycles(std::lround(write - fixed - p.line_bytes / m.write_rate));
  // All lines that an MFC has in flight, alone: how far that is ahead of its rate.
  const uint32_t window =
      std::min(p.lines_in_flight * p.line_bytes, p.largest_command_bytes / 16 * 16);
  const double flow = bench.Alone(DmaKind::kGet, window) - fixed - double(m.read_latency_cycles);
  m.burst_bytes = std::max(0.0, double(window) - m.port_read_rate * flow);
  return m;
}

Cycles FromNanoseconds(const ConsoleMachine& m, uint32_t ns) {
  return Cycles(uint64_t(ns) * m.clock_hz / 1'000'000'000);
}

}  // namespace

Result<ConsoleMachine> MakeCell(const CellMemoryParameters& p, const DispatchParameters& dispatch) {
  std::string error;
  if (!CheckCellMemory(p, error)) return Failure{error};
  ConsoleMachine m;
  m.name = "PS3";
  m.clock_hz = p.clock_hz;
  m.units = p.spu_count;
  m.availability = p.Availability();
  m.availability_from = "measured on a retail PS3";

  CellBench bench(p, error);
  m.memory = MeasureMemory(p, bench);
  if (bench.Failed()) return Failure{error};
  m.command_cycles = Cycles(p.ChannelCycles()) * p.channels_per_command;
  m.wait_cycles = Cycles(p.ChannelCycles()) * p.channels_per_wait;
  m.largest_transfer_bytes = p.largest_command_bytes;
  m.line_bytes = p.line_bytes;
  m.local_store_bytes = p.local_store_bytes;
  m.runtime = p.runtime;

  m.draw_cycles = FromNanoseconds(m, dispatch.spe_job_ns);
  m.dispatcher_cycles = FromNanoseconds(m, dispatch.ppe_job_ns);
  // The item is counted on an atomic line, and the line goes to those that watch it.
  m.barrier_cycles = 2 * AtomicBounceCycles(p);
  return m;
}

// ---- Xenon --------------------------------------------------------------------------------------
//
// The Xenon as frames see it: short streams on the cache model give its memory's numbers.
//
// A port is a core: its two threads share the misses it may have outstanding. A thread prefetches
// (dcbt) the blocks of its next item under the work on this one; what it writes whole it makes with
// dcbz, so that the line is not read first.

namespace {

// Of each core: several times what the L2 holds, so that lines that were written leave it.
constexpr uint32_t kStreamLines = 16384;

using Trace = std::vector<MemoryAccess>;

class XenonBench {
 public:
  XenonBench(const CacheMemoryParameters& p, std::string& error) : p_(p), error_(error) {}

  bool Failed() const { return !error_.empty(); }

  // Bytes a cycle, both ways, of the first thread of `cores` cores that prefetch a stream as fast
  // as misses may be outstanding and, when `write`, make a line for each that they fetch.
  double Rate(uint32_t cores, bool write) {
    std::vector<Trace> traces(size_t(cores) * p_.core.smt_threads);
    for (uint32_t c = 0; c < cores; ++c) traces[c * p_.core.smt_threads] = Stream(c, write);
    const CacheMemoryRun run = Run(traces);
    const double bytes = double(run.bus_read_bytes + run.bus_write_bytes);
    return run.finish > 0 ? bytes / double(run.finish) : 0.0;
  }

  // One load that misses everything.
  double Latency() { return double(Run({{Access(AccessKind::kLoad, 0)}}).finish); }

 private:
  MemoryAccess Access(AccessKind kind, uint64_t line) const {
    MemoryAccess access;
    access.kind = kind;
    access.address = line * p_.line_bytes;
    access.bytes = kind == AccessKind::kLoad ? 4 : p_.line_bytes;
    return access;
  }

  Trace Stream(uint32_t core, bool write) const {
    Trace trace;
    const uint64_t first = uint64_t(core) << 24;
    for (uint64_t line = 0; line < kStreamLines; ++line) {
      trace.push_back(Access(AccessKind::kPrefetch, first + line));
      if (write) trace.push_back(Access(AccessKind::kLineZero, first + (1 << 22) + line));
    }
    return trace;
  }

  CacheMemoryRun Run(const std::vector<Trace>& traces) {
    CacheMemoryRun run;
    std::string error;
    if (!RunCacheMemory(p_, traces, run, error) && error_.empty()) error_ = error;
    return run;
  }

  const CacheMemoryParameters& p_;
  std::string& error_;
};

SharedMemory MeasureMemory(const CacheMemoryParameters& p, XenonBench& bench) {
  SharedMemory m;
  m.units_per_port = p.core.smt_threads;
  m.read_rate = bench.Rate(p.cores, false);
  m.port_read_rate = bench.Rate(1, false);
  m.mixed_rate = bench.Rate(p.cores, true);
  // Lines leave the L2 by themselves: only the lines that come next wait for them.
  m.write_rate = std::min(p.bus_milli_bytes_per_cycle / 1000.0,
                          p.memory_milli_bytes_per_cycle / 1000.0 * (1000 - p.gpu_permille) / 1000);
  m.port_write_rate = m.write_rate;
  m.read_latency_cycles = Cycles(std::lround(bench.Latency() - double(p.line_bytes) / m.read_rate));
  const double window = double(p.outstanding_misses) * p.line_bytes;
  m.burst_bytes = std::max(0.0, window - m.port_read_rate * window / m.read_rate);
  m.line_cycles = p.core.smt_threads;  // a dcbt for each
  return m;
}

}  // namespace

Result<ConsoleMachine> MakeXenon(const XenonParameters& p) {
  std::string error;
  if (!CheckXenon(p, error)) return Failure{error};
  ConsoleMachine m;
  m.name = "Xbox 360";
  m.clock_hz = p.clock_hz;
  m.units = p.cores * p.core.smt_threads;
  m.threads_per_core = p.core.smt_threads;
  m.availability = p.Availability();
  m.availability_from = "the PS3's: none was measured on an Xbox 360";

  XenonBench bench(p, error);
  m.memory = MeasureMemory(p, bench);
  if (bench.Failed()) return Failure{error};
  m.largest_transfer_bytes = p.line_bytes;
  m.line_bytes = p.line_bytes;
  m.l2_bytes = p.l2_bytes;

  // Rows X1, X2: an InterlockedIncrement draws an item; what was written is made visible (lwsync),
  // counted, and seen by those that wait.
  const Cycles increment = kXenonSynchronisation[1].Middle();
  m.draw_cycles = increment;
  m.barrier_cycles = kXenonSynchronisation[0].Middle() + increment + p.l2_hit_cycles;
  return m;
}

}  // namespace pelt
