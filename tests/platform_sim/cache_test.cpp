// What the caches of the PPE and the Xenon must do. Their rows are in measured_rows_test.cpp.

#include <gtest/gtest.h>

#include "platform_sim/memory/xenon_memory.hpp"
#include "platform_sim/rows/row_work.hpp"

namespace pelt {
namespace {

using Accesses = std::vector<MemoryAccess>;

CacheMemoryRun RunCaches(const CacheMemoryParameters& p, const std::vector<Accesses>& traces) {
  CacheMemoryRun run;
  std::string error;
  EXPECT_TRUE(RunCacheMemory(p, traces, run, error)) << error;
  return run;
}

// Through `bytes` in one random cycle, a line after the other, each load waiting for the last one.
Accesses Chase(uint32_t bytes) {
  Accesses trace;
  for (const uint32_t line : WalkAtRandom(bytes / 128, 1).loads)
    trace.push_back({AccessKind::kLoad, 8, uint64_t{line} * 128, Cycles(trace.size()) * 6, 0});
  return trace;
}

TEST(CacheLines, LeastRecentlyUsedGoesFirst) {
  Cache cache(4 * 128, 4, 128);  // one set
  for (uint64_t line = 0; line < 4; ++line) EXPECT_FALSE(cache.Fill(line, line == 1).any);
  EXPECT_TRUE(cache.Touch(0, false));
  const Cache::Evicted evicted = cache.Fill(9, false);
  EXPECT_TRUE(evicted.any && evicted.dirty);
  EXPECT_EQ(evicted.line, 1u);
  EXPECT_FALSE(cache.Touch(1, false));
  cache.Drop(0);
  EXPECT_FALSE(cache.Touch(0, false));
}

TEST(XenonMemory, MissesCostWhatTheirLevelIsAway) {
  const XenonParameters p;
  const CacheMemoryRun run = RunCaches(p, {{{AccessKind::kLoad, 4, 0, 0, 0},
                                            {AccessKind::kLoad, 4, 64, 10, 0},
                                            {AccessKind::kLoad, 4, 4096, 20, 100}}});
  const ThreadMemoryTimes& t = run.threads[0];
  EXPECT_EQ(t.loads, 3u);
  EXPECT_EQ(t.l1_misses, 2u);
  EXPECT_EQ(t.l2_misses, 2u);
  EXPECT_EQ(t.memory_stall, 610 - 6 + 610 - 6 - 100);
  EXPECT_EQ(run.bus_read_bytes, 256u);
}

TEST(XenonMemory, StoresGoThroughL1AndFillOnlyL2) {
  const XenonParameters p;
  CacheMemoryRun run =
      RunCaches(p, {{{AccessKind::kStore, 16, 0, 0, 0}, {AccessKind::kLoad, 16, 64, 2000, 0}}});
  EXPECT_EQ(run.threads[0].store_l2_misses, 1u);
  EXPECT_EQ(run.threads[0].l1_misses, 1u) << "no write-allocate in L1";
  EXPECT_EQ(run.threads[0].l2_misses, 0u);
  EXPECT_EQ(run.threads[0].l2_stall, 40 - 6);
  // Dirty lines that leave L2 go back over the bus; lines made of zeros were never read.
  Accesses trace;
  for (uint32_t line = 0; line < 3 * 8192; ++line)
    trace.push_back({AccessKind::kLineZero, 128, uint64_t(line) * 128, Cycles(line) * 40, 0});
  run = RunCaches(p, {trace});
  EXPECT_EQ(run.bus_read_bytes, 0u);
  EXPECT_EQ(run.bus_write_bytes, 2u * 8192 * 128);
}

TEST(XenonMemory, LoadHitStoreIsFoundFromAddresses) {
  const XenonParameters p;
  const auto stall = [&](uint64_t store, uint32_t store_bytes, uint64_t load, uint32_t load_bytes,
                         Cycles apart) {
    const CacheMemoryRun run =
        RunCaches(p, {{{AccessKind::kLoad, 4, 0, 0, 0},
                       {AccessKind::kStore, store_bytes, store, 1000, 0},
                       {AccessKind::kLoad, load_bytes, load, 1000 + apart, 0}}});
    EXPECT_EQ(run.threads[0].load_hit_stores, run.threads[0].load_hit_store_stall > 0 ? 1u : 0u);
    return run.threads[0].load_hit_store_stall;
  };
  EXPECT_EQ(stall(16, 4, 16, 4, 2), 38);
  EXPECT_EQ(stall(16, 4, 16, 4, 30), 10);
  EXPECT_EQ(stall(16, 4, 16, 4, 40), 0) << "late enough";
  EXPECT_EQ(stall(16, 16, 31, 1, 2), 38) << "overlap";
  EXPECT_EQ(stall(16, 4, 20, 4, 2), 0) << "beside";
}

TEST(XenonMemory, AFetchedLineTakesTheL1WhileItComesIn) {
  XenonParameters p;
  p.l1_fill_cycles = 8;
  Accesses trace = {{AccessKind::kLoad, 4, 0, 0, 0}};  // brings its line into L2 and L1
  trace.push_back({AccessKind::kPrefetch, 4, 0, 5000, 0});
  const Cycles in_l1 = RunCaches(p, {trace}).threads[0].l2_stall;
  EXPECT_EQ(in_l1, 0) << "it is there";
  trace.back().address = 4096;
  trace.push_back({AccessKind::kLoad, 4, 4096, 9000, 0});
  const ThreadMemoryTimes t = RunCaches(p, {trace}).threads[0];
  EXPECT_EQ(t.l2_stall, 8);
  EXPECT_EQ(t.memory_stall, 610 - 6) << "of the first load only";
}

// With one thread running every cycle is its own; two have every other one.
TEST(XenonMemory, StallsEndInAThreadsOwnCycle) {
  XenonParameters p;
  p.l2_hit_cycles = 41;
  const Accesses trace = {{AccessKind::kStore, 4, 0, 0, 0}, {AccessKind::kLoad, 4, 64, 5000, 0}};
  const Accesses far = {{AccessKind::kLoad, 4, 1 << 20, 0, 0}};
  EXPECT_EQ(RunCaches(p, {trace}).threads[0].l2_stall, 41 - 6);
  EXPECT_EQ(RunCaches(p, {trace, far}).threads[0].l2_stall, 42 - 6);
  EXPECT_EQ(RunCaches(p, {trace, {}, far}).threads[0].l2_stall, 41 - 6) << "on another core";
}

TEST(XenonMemory, AtMostEightMissesOfACoreAreOut) {
  const auto run = [](uint32_t misses) {
    XenonParameters p;
    p.outstanding_misses = misses;
    Accesses trace;
    for (uint32_t i = 0; i < 512; ++i)
      trace.push_back({AccessKind::kPrefetch, 1, uint64_t(i) * 128, Cycles(i) * 2, 0});
    return RunCaches(p, {trace});
  };
  // Little's law: eight lines in 610 cycles.
  EXPECT_NEAR(double(run(8).finish), 512 / 8 * 610, 1500);
  EXPECT_GT(run(4).finish, run(8).finish * 19 / 10);
  EXPECT_GT(run(8).threads[0].miss_queue_stall, 0);
}

TEST(XenonMemory, RatesAreShared) {
  const auto rate = [](uint32_t threads, uint32_t gpu_permille) {
    XenonParameters p;
    p.gpu_permille = gpu_permille;
    p.outstanding_misses = 64;  // so that the bus is the limit
    std::vector<Accesses> traces(threads);
    for (uint32_t t = 0; t < threads; ++t)
      for (uint32_t i = 0; i < 2048; ++i)
        traces[t].push_back(
            {AccessKind::kPrefetch, 1, (uint64_t(t) << 28) + uint64_t(i) * 128, Cycles(i) * 2, 0});
    const CacheMemoryRun run = RunCaches(p, traces);
    return double(run.bus_read_bytes) / double(run.finish) * 3.2;
  };
  EXPECT_NEAR(rate(1, 0), 10.8, 0.3);
  EXPECT_NEAR(rate(6, 0), 10.8, 0.3);
  EXPECT_NEAR(rate(6, 750), 22.4 / 4, 0.3) << "the GPU takes three quarters";
}

TEST(XenonMemory, ThreadsOfACoreShareItsL1) {
  const XenonParameters p;
  const auto sweep = [](uint64_t base, Cycles start) {
    Accesses t;
    for (int r = 0; r < 4; ++r)
      for (uint32_t at = 0; at < 24 * 1024; at += 128, start += 700)
        t.push_back({AccessKind::kLoad, 4, base + at, start, 0});
    return t;
  };
  const Accesses a = sweep(0, 0), b = sweep(1 << 20, 350);
  const uint64_t alone = RunCaches(p, {a}).threads[0].l1_misses;
  const uint64_t together = RunCaches(p, {a, b}).threads[0].l1_misses;
  const uint64_t apart = RunCaches(p, {a, {}, b}).threads[0].l1_misses;
  EXPECT_EQ(alone, 192u);
  EXPECT_GT(together, alone * 2) << "48 KB do not fit into 32";
  EXPECT_EQ(apart, alone) << "another core has its own";
}

TEST(XenonMemory, ARunHasOneResult) {
  const XenonParameters p;
  const std::vector<Accesses> traces = {Chase(1 << 16), Chase(1 << 17), Chase(1 << 18)};
  const CacheMemoryRun a = RunCaches(p, traces), b = RunCaches(p, traces);
  EXPECT_EQ(a.finish, b.finish);
  for (size_t t = 0; t < traces.size(); ++t) EXPECT_EQ(a.threads[t].finish, b.threads[t].finish);
}

TEST(XenonMemory, ImpossibleInputIsRefused) {
  XenonParameters p;
  CacheMemoryRun run;
  std::string error;
  p.l1_ways = 3;
  EXPECT_FALSE(RunCacheMemory(p, {}, run, error));
  EXPECT_NE(error.find("ways"), std::string::npos);
  p = XenonMemory();
  const std::vector<Accesses> seven(7);
  EXPECT_FALSE(RunCacheMemory(p, seven, run, error));
  const std::vector<Accesses> back = {
      {{AccessKind::kLoad, 4, 0, 5, 0}, {AccessKind::kLoad, 4, 0, 4, 0}}};
  EXPECT_FALSE(RunCacheMemory(p, back, run, error));
  EXPECT_NE(error.find("access 1"), std::string::npos);
}

}  // namespace
}  // namespace pelt
