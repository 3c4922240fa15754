// The caches against the PPE's rows, and what the Xenon's must do.
#include "platform_sim/memory/cache.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>

#include "platform_sim/memory/xenon_memory.hpp"
#include "tests/platform/platform_rows.hpp"

namespace pelt {
namespace {

using namespace testing;
using Trace = std::vector<MemoryAccess>;

constexpr double kAllowedPercent = 5.0;

CacheMemoryRun MustRun(const CacheMemoryParameters& p, const std::vector<Trace>& traces) {
  CacheMemoryRun run;
  std::string error;
  EXPECT_TRUE(RunCacheMemory(p, traces, run, error)) << error;
  return run;
}

// `rounds` times through 8-byte pointers in one random cycle, each load waiting for the one before:
// 5 cycles, and the thread goes on every other one.
Trace Chase(const CacheMemoryParameters& p, uint32_t bytes, uint32_t rounds) {
  std::vector<uint32_t> order(bytes / 8);
  std::iota(order.begin(), order.end(), 0);
  uint64_t seed = 1;
  for (uint32_t i = uint32_t(order.size()) - 1; i > 0; --i) {
    seed = seed * 6364136223846793005u + 1442695040888963407u;
    std::swap(order[i], order[(seed >> 33) % (i + 1)]);
  }
  const Cycles slot = p.dispatch_slot_cycles;
  const Cycles hit = (p.l1_hit_cycles + slot - 1) / slot * slot;
  Trace trace;
  for (uint32_t r = 0; r < rounds; ++r)
    for (const uint32_t i : order)
      trace.push_back({AccessKind::kLoad, 8, uint64_t(i) * 8, Cycles(trace.size()) * hit, 0});
  return trace;
}

// Cycles a load takes, measured in the rounds after the first.
double ChaseCycles(const CacheMemoryParameters& p, uint32_t bytes) {
  const Trace once = Chase(p, bytes, 1), thrice = Chase(p, bytes, 3);
  const Cycles cycles = MustRun(p, {thrice}).finish - MustRun(p, {once}).finish;
  return double(cycles) / double(thrice.size() - once.size()) * 1000.0 / p.availability_permille;
}

// Eight vector loads, eight float adds on four sums, in order, a slot every other cycle: the loads
// take eight slots, the first four adds the next four; the other four wait 12 cycles for them.
constexpr Cycles kStreamTurn = 8 * 2 + 12 + 4 * 2;

double StreamGigabytesPerSecond(const CacheMemoryParameters& p, uint32_t bytes, uint32_t rounds) {
  const auto trace = [&](uint32_t n) {
    Trace t;
    Cycles turn = 0;
    for (uint32_t r = 0; r < n; ++r)
      for (uint32_t at = 0; at < bytes; at += 128, turn += kStreamTurn) {
        for (uint32_t i = 0; i < 8; ++i)
          t.push_back({AccessKind::kLoad, 16, at + i * 16, turn + 2 * i, 0});
      }
    return t;
  };
  const Cycles cycles = MustRun(p, {trace(rounds + 1)}).finish - MustRun(p, {trace(1)}).finish;
  return double(bytes) * rounds * 3.2 / double(cycles) * p.availability_permille / 1000.0;
}

TEST(PpeRows, P1AndP3PointerChases) {
  const CacheMemoryParameters p = PpeMemory();
  ExpectRow("P1", ChaseCycles(p, 28 * 1024), 6.4, "cyc", kAllowedPercent);
  ExpectRow("P3", ChaseCycles(p, 256 * 1024), 36.0, "cyc", kAllowedPercent);
}

TEST(PpeRows, P5VectorStream) {
  ExpectRow("P5", StreamGigabytesPerSecond(PpeMemory(), 28 * 1024, 4), 10.3, "GB/s",
            kAllowedPercent);
}

TEST(PpePlanted, WrongNumbersAreNoticedByARow) {
  const auto off = [](double predicted, double measured) {
    return std::abs(PercentOff(predicted, measured));
  };
  CacheMemoryParameters p = PpeMemory();
  p.l1_hit_cycles = 10;
  EXPECT_GT(off(ChaseCycles(p, 28 * 1024), 6.4), kAllowedPercent) << "L1 latency doubled";
  p = PpeMemory();
  p.l2_hit_cycles *= 2;
  EXPECT_GT(off(ChaseCycles(p, 256 * 1024), 36.0), kAllowedPercent) << "L2 latency doubled";
  p = PpeMemory();
  p.l1_bytes = 16 * 1024;
  EXPECT_GT(off(ChaseCycles(p, 28 * 1024), 6.4), kAllowedPercent) << "half the L1";
  EXPECT_GT(off(StreamGigabytesPerSecond(p, 28 * 1024, 4), 10.3), kAllowedPercent);
  p = PpeMemory();
  p.l2_bytes = 128 * 1024;
  EXPECT_GT(off(ChaseCycles(p, 256 * 1024), 36.0), kAllowedPercent) << "a small L2";
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
  const CacheMemoryParameters p = XenonMemory();
  const CacheMemoryRun run = MustRun(p, {{{AccessKind::kLoad, 4, 0, 0, 0},
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
  const CacheMemoryParameters p = XenonMemory();
  CacheMemoryRun run =
      MustRun(p, {{{AccessKind::kStore, 16, 0, 0, 0}, {AccessKind::kLoad, 16, 64, 2000, 0}}});
  EXPECT_EQ(run.threads[0].store_l2_misses, 1u);
  EXPECT_EQ(run.threads[0].l1_misses, 1u) << "no write-allocate in L1";
  EXPECT_EQ(run.threads[0].l2_misses, 0u);
  EXPECT_EQ(run.threads[0].l2_stall, 40 - 6);
  // Dirty lines that leave L2 go back over the bus; lines made of zeros were never read.
  Trace trace;
  for (uint32_t line = 0; line < 3 * 8192; ++line)
    trace.push_back({AccessKind::kLineZero, 128, uint64_t(line) * 128, Cycles(line) * 40, 0});
  run = MustRun(p, {trace});
  EXPECT_EQ(run.bus_read_bytes, 0u);
  EXPECT_EQ(run.bus_write_bytes, 2u * 8192 * 128);
}

TEST(XenonMemory, LoadHitStoreIsFoundFromAddresses) {
  const CacheMemoryParameters p = XenonMemory();
  const auto stall = [&](uint64_t store, uint32_t store_bytes, uint64_t load, uint32_t load_bytes,
                         Cycles apart) {
    const CacheMemoryRun run =
        MustRun(p, {{{AccessKind::kLoad, 4, 0, 0, 0},
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

TEST(XenonMemory, AtMostEightMissesOfACoreAreOut) {
  const auto run = [](uint32_t misses) {
    CacheMemoryParameters p = XenonMemory();
    p.outstanding_misses = misses;
    Trace trace;
    for (uint32_t i = 0; i < 512; ++i)
      trace.push_back({AccessKind::kPrefetch, 1, uint64_t(i) * 128, Cycles(i) * 2, 0});
    return MustRun(p, {trace});
  };
  // Little's law: eight lines in 610 cycles.
  EXPECT_NEAR(double(run(8).finish), 512 / 8 * 610, 1500);
  EXPECT_GT(run(4).finish, run(8).finish * 19 / 10);
  EXPECT_GT(run(8).threads[0].miss_queue_stall, 0);
}

TEST(XenonMemory, RatesAreShared) {
  const auto rate = [](uint32_t threads, uint32_t gpu_permille) {
    CacheMemoryParameters p = XenonMemory();
    p.gpu_permille = gpu_permille;
    p.outstanding_misses = 64;  // so that the bus is the limit
    std::vector<Trace> traces(threads);
    for (uint32_t t = 0; t < threads; ++t)
      for (uint32_t i = 0; i < 2048; ++i)
        traces[t].push_back(
            {AccessKind::kPrefetch, 1, (uint64_t(t) << 28) + uint64_t(i) * 128, Cycles(i) * 2, 0});
    const CacheMemoryRun run = MustRun(p, traces);
    return double(run.bus_read_bytes) / double(run.finish) * 3.2;
  };
  EXPECT_NEAR(rate(1, 0), 10.8, 0.3);
  EXPECT_NEAR(rate(6, 0), 10.8, 0.3);
  EXPECT_NEAR(rate(6, 750), 22.4 / 4, 0.3) << "the GPU takes three quarters";
}

TEST(XenonMemory, ThreadsOfACoreShareItsL1) {
  const CacheMemoryParameters p = XenonMemory();
  const auto sweep = [](uint64_t base, Cycles start) {
    Trace t;
    for (int r = 0; r < 4; ++r)
      for (uint32_t at = 0; at < 24 * 1024; at += 128, start += 700)
        t.push_back({AccessKind::kLoad, 4, base + at, start, 0});
    return t;
  };
  const Trace a = sweep(0, 0), b = sweep(1 << 20, 350);
  const uint64_t alone = MustRun(p, {a}).threads[0].l1_misses;
  const uint64_t together = MustRun(p, {a, b}).threads[0].l1_misses;
  const uint64_t apart = MustRun(p, {a, {}, b}).threads[0].l1_misses;
  EXPECT_EQ(alone, 192u);
  EXPECT_GT(together, alone * 2) << "48 KB do not fit into 32";
  EXPECT_EQ(apart, alone) << "another core has its own";
}

TEST(XenonMemory, ARunHasOneResult) {
  const CacheMemoryParameters p = XenonMemory();
  const std::vector<Trace> traces = {Chase(p, 1 << 16, 1), Chase(p, 1 << 17, 1),
                                     Chase(p, 1 << 18, 1)};
  const CacheMemoryRun a = MustRun(p, traces), b = MustRun(p, traces);
  EXPECT_EQ(a.finish, b.finish);
  for (size_t t = 0; t < traces.size(); ++t) EXPECT_EQ(a.threads[t].finish, b.threads[t].finish);
}

TEST(XenonMemory, ImpossibleInputIsRefused) {
  CacheMemoryParameters p = XenonMemory();
  CacheMemoryRun run;
  std::string error;
  p.l1_ways = 3;
  EXPECT_FALSE(RunCacheMemory(p, {}, run, error));
  EXPECT_NE(error.find("ways"), std::string::npos);
  p = XenonMemory();
  const std::vector<Trace> seven(7);
  EXPECT_FALSE(RunCacheMemory(p, seven, run, error));
  const std::vector<Trace> back = {
      {{AccessKind::kLoad, 4, 0, 5, 0}, {AccessKind::kLoad, 4, 0, 4, 0}}};
  EXPECT_FALSE(RunCacheMemory(p, back, run, error));
  EXPECT_NE(error.find("access 1"), std::string::npos);
}

}  // namespace
}  // namespace pelt
