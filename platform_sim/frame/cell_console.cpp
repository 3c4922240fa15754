// The Cell as frames see it: short streams on the line-level model give its memory's numbers.

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "platform_sim/frame/console_machine.hpp"
#include "platform_sim/memory/spu_program.hpp"

namespace pelt {
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

}  // namespace pelt
