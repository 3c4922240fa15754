#include "platform_sim/memory/spu_program.hpp"

#include <algorithm>

#include "core/format.hpp"

namespace pelt {

SpuStep Compute(Cycles cycles) { return {SpuStep::Kind::kCompute, cycles, {}, 0}; }
SpuStep Dma(DmaCommand command) { return {SpuStep::Kind::kDma, 0, std::move(command), 0}; }
SpuStep WaitTags(uint32_t tag_mask) { return {SpuStep::Kind::kWaitTags, 0, {}, tag_mask}; }

SpuProgram::SpuProgram(CellMemory& memory, uint32_t spu, NextStep next, Action finished)
    : memory_(memory), spu_(spu), next_(std::move(next)), finished_(std::move(finished)) {}

void SpuProgram::Start() {
  memory_.queue().After(0, [this] { Next(); });
}

void SpuProgram::Stand(Cycles SpuTimes::*reason, Cycles since) {
  times_.*reason += memory_.queue().now() - since;
  Next();
}

void SpuProgram::Next() {
  EventQueue& queue = memory_.queue();
  const CellMemoryParameters& p = memory_.parameters();
  step_ = {};
  const bool more = error_.empty() && next_(step_);
  if (more && step_.cycles < 0) error_ = "a step of negative length";
  if (!more || !error_.empty()) {
    times_.finish = queue.now();
    if (finished_) finished_();
    return;
  }
  switch (step_.kind) {
    case SpuStep::Kind::kCompute:
      times_.compute += step_.cycles;
      return queue.After(step_.cycles, [this] { Next(); });
    case SpuStep::Kind::kDma: {
      const Cycles channels = Cycles(p.channels_per_command) * p.ChannelCycles();
      times_.channel += channels;
      return queue.After(channels, [this, since = queue.now() + channels] {
        if (!memory_.Submit(
                spu_, step_.dma, [this, since] { Stand(&SpuTimes::queue_stall, since); }, [] {},
                error_))
          Next();
      });
    }
    case SpuStep::Kind::kWaitTags: {
      const Cycles channels = Cycles(p.channels_per_wait) * p.ChannelCycles();
      times_.channel += channels;
      return queue.After(channels, [this, since = queue.now() + channels] {
        memory_.WaitTags(spu_, step_.tag_mask,
                         [this, since] { Stand(&SpuTimes::tag_stall, since); });
      });
    }
  }
}

namespace {

// The pattern as a machine that is asked for one step at a time. Per block: wait for its buffer,
// compute, put, and get the block that comes into the same buffer next.
class Streaming {
 public:
  explicit Streaming(const StreamWork& work) : work_(work) {
    place_bytes_ = (work.block_bytes + 127) & ~127u;
  }

  bool operator()(SpuStep& step) {
    while (ready_.empty() && !Refill()) return false;
    step = std::move(ready_.back());
    ready_.pop_back();
    return true;
  }

 private:
  DmaCommand Command(DmaKind kind, uint32_t block) const {
    const uint32_t buffer = block % work_.buffers;
    const uint64_t offset = uint64_t(block) * work_.block_bytes % work_.window_bytes;
    const uint64_t base = kind == DmaKind::kGet ? work_.get_address : work_.put_address;
    DmaCommand command =
        MakeDma(kind, buffer * place_bytes_, base + offset, work_.block_bytes, buffer);
    command.far = work_.far;
    command.far_spu = work_.far_spu;
    return command;
  }

  // The steps of the next iteration, last first. False: there are none.
  bool Refill() {
    if (iteration_ >= work_.block_count + (drained_ ? 0u : 1u)) return false;
    std::vector<SpuStep> steps;
    if (iteration_ == 0 && work_.get && !primed_) {
      primed_ = true;
      for (uint32_t b = 0; b < std::min(work_.buffers, work_.block_count); ++b)
        steps.push_back(Dma(Command(DmaKind::kGet, b)));
      if (steps.empty()) return false;
    } else if (iteration_ == work_.block_count) {
      drained_ = true;
      steps.push_back(WaitTags(~0u));
    } else {
      steps = Iteration(iteration_++);
    }
    ready_.assign(std::make_move_iterator(steps.rbegin()), std::make_move_iterator(steps.rend()));
    return true;
  }

  std::vector<SpuStep> Iteration(uint32_t block) const {
    std::vector<SpuStep> steps = {WaitTags(1u << block % work_.buffers)};
    if (work_.compute_cycles > 0) steps.push_back(Compute(work_.compute_cycles));
    if (work_.put) steps.push_back(Dma(Command(DmaKind::kPut, block)));
    if (work_.get && block + work_.buffers < work_.block_count) {
      steps.push_back(Dma(Command(DmaKind::kGet, block + work_.buffers)));
      if (work_.put) steps.back().dma.order = DmaOrder::kFence;
    }
    return steps;
  }

  StreamWork work_;
  uint32_t place_bytes_;
  uint32_t iteration_ = 0;
  bool primed_ = false, drained_ = false;
  std::vector<SpuStep> ready_;
};

}  // namespace

SpuProgram::NextStep DoubleBuffer(const StreamWork& work) { return Streaming(work); }

uint64_t SpuRun::Bytes() const {
  uint64_t bytes = 0;
  for (const DmaCounts& c : counts) bytes += c.get_bytes + c.put_bytes;
  return bytes;
}

double SpuRun::GigabytesPerSecond(const CellMemoryParameters& p) const {
  return cycles == 0 ? 0.0 : double(Bytes()) * p.GigaHertz() / double(cycles);
}

bool RunSpus(const CellMemoryParameters& p, std::vector<SpuProgram::NextStep> programs, SpuRun& run,
             std::string& error) {
  EventQueue queue;
  const auto made = CellMemory::Make(p, queue);
  if (!made) {
    error = made.error();
    return false;
  }
  CellMemory& memory = **made;
  if (programs.size() > p.spu_count) {
    error = Format("{} SPU programs; there are {} SPUs", programs.size(), p.spu_count);
    return false;
  }
  std::vector<std::unique_ptr<SpuProgram>> spus;
  for (uint32_t i = 0; i < programs.size(); ++i)
    spus.push_back(std::make_unique<SpuProgram>(memory, i, std::move(programs[i])));
  for (auto& spu : spus) spu->Start();
  queue.Run();

  run = {};
  for (uint32_t i = 0; i < spus.size(); ++i) {
    if (!spus[i]->error().empty()) {
      error = Format("SPU {}: {}", i, spus[i]->error());
      return false;
    }
    run.spus.push_back(spus[i]->times());
    run.counts.push_back(memory.counts(i));
    run.cycles = std::max(run.cycles, spus[i]->times().finish);
  }
  run.bus_lines = memory.bus_lines();
  run.memory_read_lines = memory.memory_lines(false);
  run.memory_write_lines = memory.memory_lines(true);
  return true;
}

Cycles AtomicBounceCycles(const CellMemoryParameters& p) {
  const Cycles give = Cycles(p.channels_per_command) * p.ChannelCycles() + p.command_cycles;
  const Cycles line =
      p.local_store_cycles + Cycles(p.line_bytes / p.ring_bytes) * p.bus_cycle_cycles;
  const Cycles status = p.ChannelCycles();  // of each of the two commands
  return 2 * (give + p.snoop_cycles + status) + line;
}

Cycles MailboxRoundTripCycles(const CellMemoryParameters& p) {
  return Cycles(2.0 * p.os_call_ns * p.GigaHertz() + 0.5);
}

}  // namespace pelt
