// The Cell's memory: what must hold of any stream, and the rules of DMA commands. Its rows are in
// measured_rows_test.cpp.
#include <algorithm>

#include "tests/platform_sim/cell_work.hpp"

namespace pelt::testing {
namespace {

TEST(DmaProperties, LinesFromThePpesL2ComeAtItsRate) {
  const CellMemoryParameters p;
  const SpuRun run = MoveBlocks(
      p, {.block_bytes = 4096, .in_flight = 8, .bytes_each = 1 << 16, .far = DmaFar::kL2});
  // 7 GB/s, Perrone, as spoken.
  EXPECT_NEAR(run.GigabytesPerSecond(p), 7.0, 0.35);
}

TEST(DmaProperties, NoStageGoesBeyondItsPeak) {
  const CellMemoryParameters p;
  for (uint32_t spus = 1; spus <= 6; ++spus)
    for (uint32_t bytes : {16u, 128u, 1024u, 16384u})
      for (bool put : {false, true}) {
        const SpuRun run = MoveBlocks(p, {.spus = spus,
                                          .block_bytes = bytes,
                                          .in_flight = 8,
                                          .put = put,
                                          .bytes_each = 1 << 16});
        const double rate = run.GigabytesPerSecond(p);
        EXPECT_LE(rate, 24.7) << spus << " x " << bytes;
        EXPECT_LE(rate, 25.6 * spus * (put ? 2 : 1));
      }
  EXPECT_LE(ReadLocalStores(p, {1}).GigabytesPerSecond(p), 25.6);
}

TEST(DmaProperties, MoreSpusAreNeverSlower) {
  const CellMemoryParameters p;
  for (uint32_t bytes : {64u, 128u, 256u, 2048u, 16384u}) {
    double before = 0.0;
    for (uint32_t spus = 1; spus <= 6; ++spus) {
      const double rate =
          MoveBlocks(p, {.spus = spus, .block_bytes = bytes, .in_flight = 8, .bytes_each = 1 << 16})
              .GigabytesPerSecond(p);
      EXPECT_GE(rate, before * 0.995) << spus << " x " << bytes;
      before = rate;
    }
  }
}

// One SPU is limited by what it may have in flight over the round trip, not by the memory.
TEST(DmaProperties, OneSpuFollowsLittlesLaw) {
  const CellMemoryParameters p;
  for (uint32_t in_flight : {1u, 2u, 4u, 8u}) {
    const SpuRun run = MoveBlocks(
        p, {.spus = 1, .block_bytes = 128, .in_flight = in_flight, .bytes_each = 1 << 16});
    const double round_trip =
        p.snoop_cycles + p.memory_access_cycles + p.memory_line_cycles + 16 + 10;
    const double most = in_flight * 128 / round_trip * 3.2;
    EXPECT_LE(run.GigabytesPerSecond(p), most * 1.01) << in_flight;
    EXPECT_GE(run.GigabytesPerSecond(p), most * 0.75) << in_flight;
  }
}

TEST(DmaProperties, SmallCommandsWasteTheirLine) {
  const CellMemoryParameters p;
  const SpuRun lines = MoveBlocks(p, {.block_bytes = 128, .in_flight = 8, .bytes_each = 1 << 16});
  const SpuRun quarters = MoveBlocks(p, {.block_bytes = 32, .in_flight = 8, .bytes_each = 1 << 14});
  EXPECT_EQ(lines.memory_read_lines, quarters.memory_read_lines);
  EXPECT_NEAR(quarters.GigabytesPerSecond(p) / lines.GigabytesPerSecond(p), 0.25, 0.02);
}

TEST(DmaProperties, MixedReadsAndWritesPayForTurning) {
  const CellMemoryParameters p;
  const auto rate = [&](bool get, bool put) {
    return MoveBlocks(p, {.in_flight = 4,
                          .get = get,
                          .put = put,
                          .bytes_each = get && put ? 1u << 20 : 1u << 18})
        .GigabytesPerSecond(p);
  };
  const double reads = rate(true, false), writes = rate(false, true), copies = rate(true, true);
  std::printf("without availability: reads %.2f, writes %.2f, copies %.2f GB/s\n", reads, writes,
              copies);
  EXPECT_NEAR(writes, reads, 0.5);
  EXPECT_NEAR(copies, 21.0, 0.5);
}

TEST(DmaProperties, WhatIsAskedForIsMoved) {
  const CellMemoryParameters p;
  const SpuRun run =
      MoveBlocks(p, {.block_bytes = 2048, .in_flight = 4, .put = true, .bytes_each = 1 << 17});
  EXPECT_EQ(run.Bytes(), 2u * 6 << 17);
  EXPECT_EQ(run.memory_read_lines, 6u * (1 << 17) / 128);
  EXPECT_EQ(run.memory_write_lines, run.memory_read_lines);
  EXPECT_EQ(run.bus_lines, run.memory_read_lines + run.memory_write_lines);
  uint64_t counted = 0;
  for (const DmaCounts& c : run.counts) counted += c.lines;
  EXPECT_EQ(counted, run.bus_lines);
}

TEST(DmaProperties, SharesAreFair) {
  const CellMemoryParameters p;
  const SpuRun run = MoveBlocks(p, {.block_bytes = 16384, .in_flight = 2});
  const auto [first, last] =
      std::minmax_element(run.spus.begin(), run.spus.end(),
                          [](const SpuTimes& a, const SpuTimes& b) { return a.finish < b.finish; });
  EXPECT_LE(double(last->finish) / double(first->finish), 1.03);
}

TEST(DmaProperties, ARunHasOneResult) {
  const CellMemoryParameters p;
  const SpuRun a = MoveBlocks(p, {.spus = 5, .block_bytes = 1024, .in_flight = 3, .put = true}),
               b = MoveBlocks(p, {.spus = 5, .block_bytes = 1024, .in_flight = 3, .put = true});
  EXPECT_EQ(a.cycles, b.cycles);
  for (size_t s = 0; s < a.spus.size(); ++s) {
    EXPECT_EQ(a.spus[s].finish, b.spus[s].finish);
    EXPECT_EQ(a.spus[s].tag_stall, b.spus[s].tag_stall);
  }
}

TEST(DmaProperties, DoubleBufferingHidesTransfersBehindWork) {
  const CellMemoryParameters p;
  const auto run = [&](uint32_t buffers, Cycles compute) {
    StreamWork work;
    work.block_count = 32;
    work.buffers = buffers;
    work.put = true;
    work.put_address = 1 << 24;
    work.compute_cycles = compute;
    return MustRun(p, {DoubleBuffer(work)});
  };
  const Cycles compute = 40000;  // far more than a block's way there and back
  const SpuRun one = run(1, compute), two = run(2, compute);
  EXPECT_EQ(two.spus[0].compute, 32 * compute);
  EXPECT_LT(two.cycles, 32 * compute * 103 / 100);
  EXPECT_GT(one.cycles, two.cycles * 110 / 100);
}

// As a frame model uses it: whoever hands out chunks does so beside the memory, on the same clock.
TEST(SpuProgram, IsHandedWorkAsTimeGoesOn) {
  const CellMemoryParameters p;
  EventQueue queue;
  const auto memory = CellMemory::Make(p, queue).OrThrow();
  std::vector<SpuStep> todo;
  int finished = 0;
  SpuProgram spu(
      *memory, 2,
      [&](SpuStep& step) {
        if (todo.empty()) return false;
        step = todo.back();
        todo.pop_back();
        return true;
      },
      [&] { ++finished; });
  for (const Cycles time : {1000, 50000}) {
    queue.At(time, [&] {
      todo = {Compute(300), WaitTags(1), Dma(MakeDma(DmaKind::kGet, 0, 0, 16384, 0))};
      spu.Start();
    });
  }
  queue.Run();
  EXPECT_EQ(finished, 2);
  EXPECT_EQ(spu.times().compute, 600);
  EXPECT_GT(spu.times().finish, 50000 + 16384 / 8 + 300);
  EXPECT_EQ(memory->counts(2).get_bytes, 2u * 16384);
}

// ---- The MFC's queue, lists, fences -------------------------------------------------------------

// Gives all commands at once; completion times in their order.
std::vector<Cycles> Complete(const CellMemoryParameters& p, const std::vector<DmaCommand>& commands,
                             DmaCounts* counts = nullptr) {
  EventQueue queue;
  std::string error;
  const auto memory = CellMemory::Make(p, queue).OrThrow();
  std::vector<Cycles> done(commands.size(), -1);
  for (size_t i = 0; i < commands.size(); ++i)
    EXPECT_TRUE(memory->Submit(
        0, commands[i], [] {}, [&, i] { done[i] = queue.now(); }, error))
        << error;
  queue.Run();
  if (counts) *counts = memory->counts(0);
  return done;
}

TEST(Mfc, QueueHoldsSixteenAndListsTakeOnePlace) {
  const CellMemoryParameters p;
  std::vector<DmaCommand> commands(40, MakeDma(DmaKind::kGet, 0, 0, 128, 0));
  DmaCounts counts;
  const std::vector<Cycles> done = Complete(p, commands, &counts);
  EXPECT_EQ(counts.most_queued, 16u);
  EXPECT_EQ(std::count(done.begin(), done.end(), Cycles(-1)), 0);

  DmaCommand list = MakeDma(DmaKind::kGet, 0, 0, 64, 0);
  list.list = true;
  list.elements.assign(2048, {0, 64});
  Complete(p, {list}, &counts);
  EXPECT_EQ(counts.most_queued, 1u);
  EXPECT_EQ(counts.list_elements, 2048u);
  EXPECT_EQ(counts.lines, 2048u);
}

TEST(Mfc, FencesAndBarriersOrderATag) {
  const CellMemoryParameters p;
  const DmaCommand big = MakeDma(DmaKind::kGet, 0, 0, 16384, 3);
  DmaCommand small = MakeDma(DmaKind::kGet, 0x8000, 0x8000, 16, 3);
  const DmaCommand other = MakeDma(DmaKind::kGet, 0x9000, 0x9000, 16, 4);

  small.order = DmaOrder::kFence;
  std::vector<Cycles> done = Complete(p, {big, small, small, other});
  EXPECT_GT(done[1], done[0]);
  EXPECT_LT(done[3], done[1]) << "another tag passes";

  DmaCommand barrier = small, after = small;
  barrier.order = DmaOrder::kBarrier;
  after.order = DmaOrder::kNone;
  done = Complete(p, {big, barrier, after, other});
  EXPECT_GT(done[1], done[0]);
  EXPECT_GT(done[2], done[1]) << "later ones of the tag wait for a barrier";
  EXPECT_LT(done[3], done[1]);

  done = Complete(p, {big, small, after});
  EXPECT_LT(done[2], done[1]) << "and pass a fence";
}

TEST(Mfc, UnalignedCommandsMoveMoreLines) {
  const CellMemoryParameters p;
  EXPECT_EQ(DmaLines(p, 0, {0, 128}), 1u);
  EXPECT_EQ(DmaLines(p, 16, {16, 128}), 2u);
  EXPECT_EQ(DmaLines(p, 0, {16, 128}), 2u);
  EXPECT_EQ(DmaLines(p, 0, {127, 1}), 1u);
  EXPECT_EQ(DmaLines(p, 0x70, {0x70, 16384}), 129u);
}

TEST(DmaErrors, SayWhatTheHardwareDemands) {
  const CellMemoryParameters p;
  const auto why = [&](DmaCommand command) {
    std::string error;
    EXPECT_FALSE(CheckDma(p, command, error));
    return error;
  };
  const auto get = [](uint32_t local, uint64_t address, uint32_t bytes) {
    return MakeDma(DmaKind::kGet, local, address, bytes, 0);
  };
  EXPECT_NE(why(get(0, 0, 24)).find("multiple of 16"), std::string::npos);
  EXPECT_NE(why(get(0, 0, 0)).find("multiple of 16"), std::string::npos);
  EXPECT_NE(why(get(0, 0, 16400)).find("at most 16384"), std::string::npos);
  EXPECT_NE(why(get(4, 4, 8)).find("multiples of 8"), std::string::npos);
  EXPECT_NE(why(get(8, 8, 16)).find("multiples of 16"), std::string::npos);
  EXPECT_NE(why(get(0, 4, 4)).find("low 4 bits"), std::string::npos);
  EXPECT_NE(why(get(0x3fff0, 0, 32)).find("16 bytes behind"), std::string::npos);
  EXPECT_NE(why(get(0, ~uint64_t{15}, 16384)).find("behind the last"), std::string::npos);
  DmaCommand command = get(0, 0x3fff0, 32);
  command.far = DmaFar::kLocalStore;
  command.far_spu = 1;
  EXPECT_NE(why(command).find("local store of SPU 1"), std::string::npos);
  command = get(0, 0, 16);
  command.tag = 32;
  EXPECT_NE(why(command).find("tags are 0 to 31"), std::string::npos);
  command = get(0, 0, 16);
  command.list = true;
  command.elements.assign(2049, {0, 16});
  EXPECT_NE(why(command).find("2048 at most"), std::string::npos);
  command.elements.assign(3, {0, 16});
  command.elements[2].bytes = 17;
  EXPECT_NE(why(command).find("list element 2"), std::string::npos);
  command.elements.clear();
  EXPECT_NE(why(command).find("no element"), std::string::npos);
  for (uint32_t bytes : {1u, 2u, 4u, 8u, 16u, 4096u, 16384u}) {
    std::string error;
    EXPECT_TRUE(CheckDma(p, get(0, bytes < 16 ? bytes : 0, bytes), error) || bytes < 16) << error;
  }
}

TEST(DmaErrors, ReachTheOneWhoRunsAProgram) {
  const CellMemoryParameters p;
  int steps = 0;
  SpuRun run;
  std::string error;
  EXPECT_FALSE(RunSpus(p, {[&](SpuStep& step) {
                         step = Dma(MakeDma(DmaKind::kPut, 0, 0, 12, 0));
                         return ++steps < 10;
                       }},
                       run, error));
  EXPECT_NE(error.find("SPU 0: illegal DMA put: 12 bytes"), std::string::npos) << error;
  EXPECT_FALSE(RunSpus(p, std::vector<SpuProgram::NextStep>(7, DoubleBuffer({})), run, error));
}

TEST(DmaSplit, CoversTheBlockOnceWithLegalCommands) {
  const CellMemoryParameters p;
  for (uint32_t low = 0; low < 16; ++low)
    for (uint32_t bytes : {0u, 1u, 3u, 15u, 16u, 31u, 100u, 16384u, 16385u, 50001u}) {
      std::vector<DmaCommand> commands;
      std::string error;
      ASSERT_TRUE(SplitDma(p, MakeDma(DmaKind::kGet, low, 0x1000 + low, bytes, 1), commands, error))
          << error;
      uint64_t next = 0x1000 + low;
      for (const DmaCommand& c : commands) {
        EXPECT_TRUE(CheckDma(p, c, error)) << error;
        EXPECT_EQ(c.elements[0].address, next);
        EXPECT_EQ(c.local_address, next - 0x1000);
        next += c.elements[0].bytes;
      }
      EXPECT_EQ(next, 0x1000u + low + bytes);
    }
  std::vector<DmaCommand> commands;
  std::string error;
  EXPECT_FALSE(SplitDma(p, MakeDma(DmaKind::kGet, 0, 1, 64, 0), commands, error));
  EXPECT_NE(error.find("low 4 bits"), std::string::npos);
}

}  // namespace
}  // namespace pelt::testing
