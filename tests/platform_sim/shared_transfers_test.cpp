// The fluid of transfers against the line-level model on the same items, and its rules one by one.
#include "platform_sim/frame/shared_transfers.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <utility>
#include <vector>

#include "platform_sim/frame/console_machine.hpp"
#include "platform_sim/frame/frame_clock.hpp"
#include "platform_sim/memory/spu_program.hpp"
#include "platform_sim/memory/xenon_memory.hpp"
#include "tests/platform_sim/modelled_scene.hpp"
#include "tests/platform_sim/platform_rows.hpp"

namespace pelt::testing {
namespace {

// Equal items on every SPU: blocks in as one list, compute, blocks out as one list.
struct Items {
  uint32_t spus = 6;
  uint32_t get_elements = 1, put_elements = 1;
  uint32_t element_bytes = 16 * 1024;
  Cycles compute = 0;
  uint32_t each = 24;  // items of each SPU
};

CellMemoryParameters Cell(uint32_t spus = 6) {
  CellMemoryParameters p;
  p.spu_count = spus;
  return p;
}

// Units that draw one after another do not move in step: in step, all would read, then all write.
constexpr Cycles kDraw = 480;

class LineProgram {
 public:
  LineProgram(const Items& items, uint32_t spu)
      : items_(items), spu_(spu), base_(uint64_t(spu) << 26) {}

  bool operator()(SpuStep& step) {
    while (steps_.empty())
      if (!Refill()) return false;
    step = std::move(steps_.front());
    steps_.erase(steps_.begin());
    return true;
  }

 private:
  DmaCommand List(DmaKind kind, uint32_t item) const {
    const uint32_t count = kind == DmaKind::kGet ? items_.get_elements : items_.put_elements;
    // Elements that are smaller than a line lie in lines of their own.
    const uint64_t stride = (items_.element_bytes + 127) & ~127u;
    const uint64_t from = base_ + (kind == DmaKind::kPut ? 1 << 25 : 0) + item * stride * count;
    DmaCommand list = MakeDma(kind, item % 2 * 100 * 1024, from, items_.element_bytes, item % 2);
    list.list = true;
    for (uint32_t e = 1; e < count; ++e)
      list.elements.push_back({from + e * stride, items_.element_bytes});
    return list;
  }
  // Draws an item and gets it, into a buffer that its last put has left.
  void Draw(uint32_t item) {
    if (item > items_.each) return;
    // The line goes round once before any SPU has an item; one draw more finds that there is none.
    steps_.push_back(Compute(kDraw * (item == 0 ? spu_ + 1 : 1)));
    if (item == items_.each || items_.get_elements == 0) return;
    steps_.push_back(Dma(List(DmaKind::kGet, item)));
    if (item > 1) steps_.back().dma.order = DmaOrder::kFence;
  }
  bool Refill() {
    if (iteration_ > items_.each) return false;
    if (iteration_ == 0) Draw(0);
    if (iteration_ < items_.each) {
      const uint32_t item = iteration_;
      Draw(item + 1);
      if (items_.get_elements > 0) steps_.push_back(WaitTags(1u << item % 2));
      steps_.push_back(Compute(items_.compute));
      if (items_.put_elements > 0) steps_.push_back(Dma(List(DmaKind::kPut, item)));
    } else {
      steps_.push_back(WaitTags(3));
    }
    ++iteration_;
    return true;
  }

  const Items items_;
  const uint32_t spu_;
  const uint64_t base_;
  uint32_t iteration_ = 0;
  std::vector<SpuStep> steps_;
};

Cycles LineLevel(const Items& items) {
  std::vector<SpuProgram::NextStep> programs;
  for (uint32_t s = 0; s < items.spus; ++s) programs.push_back(LineProgram(items, s));
  SpuRun run;
  std::string error;
  EXPECT_TRUE(RunSpus(Cell(), std::move(programs), run, error)) << error;
  return run.cycles;
}

TransferShape Shape(uint32_t elements, uint32_t element_bytes) {
  const uint32_t lines = elements * ((element_bytes + 127) / 128);
  return {uint64_t(lines) * 128, elements > 0 ? 1u : 0u, elements, lines};
}

// The Cell without a barrier.
ConsoleMachine SixSpus() {
  ConsoleMachine machine = MakeCell(Cell(), AtomicDispatch(0)).OrThrow();
  machine.draw_cycles = kDraw;
  machine.barrier_cycles = 0;
  return machine;
}

Cycles Fluid(const Items& items, const ConsoleMachine& machine) {
  ItemWork item;
  const auto cycles = double(items.compute);
  item.stages = {{0, {cycles, cycles}, {cycles, cycles}}};
  item.get = Shape(items.get_elements, items.element_bytes);
  item.put = Shape(items.put_elements, items.element_bytes);
  FrameWork work;
  work.stage_count = 1;
  work.passes.push_back({0, true, 0, 0, {}, {}});
  work.passes[0].items.assign(size_t(items.spus) * items.each, item);
  work.graph = PassAfterPass(work);
  return TimeFrame(work, machine).cycles;
}

std::vector<Items> Streams() {
  std::vector<Items> all;
  for (const uint32_t spus : {1u, 3u, 6u}) {
    // Bound by memory: big blocks, chunk-sized items of mixed blocks, small blocks, records.
    all.push_back({spus, 1, 0, 16 * 1024, 0});
    all.push_back({spus, 0, 1, 16 * 1024, 0});
    all.push_back({spus, 1, 1, 16 * 1024, 0});
    all.push_back({spus, 20, 21, 2048, 0});
    all.push_back({spus, 1, 1, 2048, 0, 96});
    all.push_back({spus, 128, 64, 64, 0});
    // Bound by latency; more SPUs would wait for the counter, which these programs do not share.
    if (spus == 1) all.push_back({spus, 1, 1, 256, 0, 200});
    // In between, and bound by compute.
    all.push_back({spus, 20, 21, 2048, 12000});
    all.push_back({spus, 20, 21, 2048, 40000});
    all.push_back({spus, 1, 1, 2048, 3000, 96});
    all.push_back({spus, 128, 64, 64, 60000});
  }
  return all;
}

double WorstPercentOff(const ConsoleMachine& six, bool print) {
  double worst = 0.0;
  static const std::vector<Items> kStreams = Streams();
  static const std::vector<Cycles> kLines = [] {
    std::vector<Cycles> lines;
    for (const Items& items : kStreams) lines.push_back(LineLevel(items));
    return lines;
  }();
  for (size_t i = 0; i < kStreams.size(); ++i) {
    const Items& items = kStreams[i];
    ConsoleMachine machine = six;
    machine.units = items.spus;
    const auto line = double(kLines[i]), fluid = double(Fluid(items, machine));
    const double off = PercentOff(fluid, line);
    if (print)
      std::printf(
          "%u SPU, get %3u put %3u x %5u B, compute %5ld: lines %8.0f fluid %8.0f  %+5.1f %%\n",
          items.spus, items.get_elements, items.put_elements, items.element_bytes,
          long(items.compute), line, fluid, off);
    worst = std::max(worst, std::abs(off));
  }
  return worst;
}

constexpr double kAllowedPercent = 5.0;

TEST(SharedTransfers, TakesAsLongAsTheLineLevelModel) {
  EXPECT_LE(WorstPercentOff(SixSpus(), true), kAllowedPercent);
}

// Each rule of the fluid is needed: without it some stream is off.
TEST(SharedTransfers, PlantedErrorsAreCaught) {
  const ConsoleMachine machine = SixSpus();
  const auto worst_with = [&](auto plant) {
    ConsoleMachine planted = machine;
    plant(planted.memory);
    return WorstPercentOff(planted, false);
  };
  EXPECT_GT(worst_with([](SharedMemory& m) { m.read_latency_cycles = m.write_latency_cycles = 0; }),
            kAllowedPercent)
      << "no latency";
  EXPECT_GT(worst_with([](SharedMemory& m) { m.read_rate = m.write_rate = m.mixed_rate = 1e6; }),
            kAllowedPercent)
      << "no sharing";
  EXPECT_GT(worst_with([](SharedMemory& m) {
              m.write_rate = m.port_write_rate = 1e6;
              m.write_latency_cycles = 0;
            }),
            kAllowedPercent)
      << "puts free";
  EXPECT_GT(worst_with([](SharedMemory& m) { m.mixed_rate = m.read_rate; }), kAllowedPercent)
      << "turning the memory free";
  EXPECT_GT(worst_with([](SharedMemory& m) { m.port_read_rate = m.port_write_rate = 1e6; }),
            kAllowedPercent)
      << "any number of lines in flight";
  EXPECT_GT(worst_with([](SharedMemory& m) { m.element_cycles = 100; }), kAllowedPercent)
      << "list elements dear";
}

// ---- The rules, one by one ----------------------------------------------------------------------

SharedMemory Simple() {
  SharedMemory m;
  m.read_rate = m.write_rate = 8.0;
  m.mixed_rate = 6.0;
  m.port_read_rate = m.port_write_rate = 4.0;
  m.read_latency_cycles = 100;
  m.write_latency_cycles = 200;
  m.command_cycles = 10;
  m.element_cycles = 1;
  return m;
}
constexpr TransferShape kOne{8000, 1, 1, 63};

// When each is through, all given at cycle 0 in this order.
struct Given {
  uint32_t unit;
  bool put;
  TransferShape shape = kOne;
  int after = -1;
};
std::vector<Cycles> DoneTimes(const SharedMemory& memory, const std::vector<Given>& given) {
  SharedTransfers transfers(memory, 6);
  for (const Given& g : given)
    transfers.Start(0, g.unit, g.put, g.shape,
                    g.after < 0 ? SharedTransfers::kNone : uint32_t(g.after));
  for (Cycles next = transfers.NextEvent(); next != SharedTransfers::kNever;
       next = transfers.NextEvent())
    transfers.AdvanceTo(next);
  std::vector<Cycles> done;
  for (uint32_t t = 0; t < given.size(); ++t) done.push_back(transfers.DoneAt(t));
  return done;
}

using Times = std::vector<Cycles>;

TEST(SharedTransfers, AUnitAloneHasItsOwnRateAndTakesOneAfterAnother) {
  EXPECT_EQ(DoneTimes(Simple(), {{0, false}}), Times({10 + 2000 + 100}));
  EXPECT_EQ(DoneTimes(Simple(), {{0, false}, {0, false}}), Times({2110, 4110}))
      << "the second's command is taken up while the first flows, its latency is the first's";
}

TEST(SharedTransfers, UnitsShareAlike) {
  EXPECT_EQ(DoneTimes(Simple(), {{0, false}, {1, false}}), Times({2110, 2110}));
  EXPECT_EQ(DoneTimes(Simple(), {{0, false}, {1, false}, {2, false}, {3, false}}),
            Times({4110, 4110, 4110, 4110}));
  // A short one is through at the shared rate; the others have its share from then on.
  const Times three =
      DoneTimes(Simple(), {{0, false, {800, 1, 1, 7}}, {1, false}, {2, false}, {3, false}});
  EXPECT_EQ(three[0], 10 + 400 + 100);
  EXPECT_EQ(three[1], 10 + 400 + 2700 + 100);
}

TEST(SharedTransfers, ReadsAndWritesShareWhatTurningLeaves) {
  // One writer against three readers: half of 6.0 each way.
  const Times times = DoneTimes(Simple(), {{0, true}, {1, false}, {2, false}, {3, false}});
  EXPECT_EQ(times[0], 10 + 2667 + 200);
  EXPECT_EQ(times[1], times[3]);
  EXPECT_EQ(times[1], 10 + 2667 + 2000 + 100) << "then the readers have 8.0";
}

TEST(SharedTransfers, WhatIsHeldLetsOthersPass) {
  // The get waits for the put, its latency included; the unit's next put goes first.
  const Times times = DoneTimes(Simple(), {{0, true}, {0, false, kOne, 0}, {0, true}});
  EXPECT_EQ(times[0], 10 + 2000 + 200);
  EXPECT_EQ(times[2], 10 + 4000 + 200);
  EXPECT_EQ(times[1], 10 + 4000 + 2000 + 100);
}

TEST(SharedTransfers, ListElementsTakeTheirTime) {
  EXPECT_EQ(DoneTimes(Simple(), {{0, false, {8000, 1, 4000, 63}}}), Times({10 + 4010 + 100}));
}

TEST(SharedTransfers, AnIdlePortIsAheadOfItsRate) {
  SharedMemory memory = Simple();
  memory.burst_bytes = 400.0;
  // 8 bytes per cycle until 400 bytes ahead of 4.
  EXPECT_EQ(DoneTimes(memory, {{0, false, {800, 1, 1, 7}}}), Times({10 + 100 + 100}));
  EXPECT_EQ(DoneTimes(memory, {{0, false}}), Times({10 + 1900 + 100}));
}

// ---- The Xenon ----------------------------------------------------------------------------------

// Threads that prefetch a stream and do nothing else, on the cache model and as items.
TEST(SharedTransfers, XenonStreamsTakeAsLongAsTheCacheModel) {
  constexpr uint32_t kLines = 4096;
  const XenonParameters p;
  ConsoleMachine machine = MakeXenon(p).OrThrow();
  machine.draw_cycles = machine.barrier_cycles = 0;
  for (const uint32_t cores : {1u, 2u, 3u}) {
    for (const uint32_t per_core : {1u, 2u}) {
      std::vector<std::vector<MemoryAccess>> traces(cores * 2);
      for (uint32_t t = 0; t < cores * 2; ++t)
        for (uint32_t line = 0; t % 2 < per_core && line < kLines; ++line)
          traces[t].push_back(
              {AccessKind::kPrefetch, 128, (uint64_t(t) << 24) + uint64_t(line) * 128, 0, 0});
      CacheMemoryRun run;
      std::string error;
      ASSERT_TRUE(RunCacheMemory(p, traces, run, error)) << error;
      SharedTransfers transfers(machine.memory, machine.units);
      uint32_t last = 0;
      for (uint32_t t = 0; t < cores * 2; ++t)
        if (t % 2 < per_core) last = transfers.Start(0, t, false, {kLines * 128, 0, 0, kLines});
      while (transfers.NextEvent() != SharedTransfers::kNever)
        transfers.AdvanceTo(transfers.NextEvent());
      const double off = PercentOff(double(transfers.DoneAt(last)), double(run.finish));
      std::printf("%u cores x %u threads: cache model %8ld fluid %8ld  %+5.1f %%\n", cores,
                  per_core, long(run.finish), long(transfers.DoneAt(last)), off);
      EXPECT_LE(std::abs(off), kAllowedPercent);
    }
  }
}

}  // namespace
}  // namespace pelt::testing
