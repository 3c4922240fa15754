// The Xenon as frames see it: short streams on the cache model give its memory's numbers.
//
// A port is a core: its two threads share the misses it may have outstanding. A thread prefetches
// (dcbt) the blocks of its next item under the work on this one; what it writes whole it makes with
// dcbz, so that the line is not read first.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "platform_sim/frame/console_machine.hpp"
#include "platform_sim/memory/xenon_memory.hpp"

namespace pelt {
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
