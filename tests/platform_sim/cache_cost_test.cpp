// What caches add to a price: lines, waits with and without fetching ahead.
#include <gtest/gtest.h>

#include "platform_sim/platforms/xenon.hpp"
#include "platform_sim/pricing/kernel_cost.hpp"

namespace pelt {
namespace {

// Each iteration: `arithmetic` operations, then the next 16 bytes of each of `rows` rows.
Trace RecordRows(uint32_t iterations, uint32_t rows, uint32_t arithmetic, RecordedKind kind) {
  Trace trace;
  for (uint32_t t = 0; t < iterations; ++t) {
    for (uint32_t a = 0; a < arithmetic; ++a)
      trace.operations.push_back({.kind = RecordedKind::kAdd});
    for (uint32_t r = 0; r < rows; ++r)
      trace.operations.push_back(
          {.kind = kind, .size_bytes = 16, .address = int32_t(r * 4096 + t * 16)});
  }
  return trace;
}

CacheCost CostOf(const Trace& trace, uint32_t iterations, double cycles, uint32_t threads = 1,
                 const CacheMemoryParameters& p = XenonMemory()) {
  return PriceCaches(trace, iterations, cycles, threads, p).OrThrow();
}

constexpr uint32_t kIterations = 64;

TEST(CacheCost, EveryLineIsFetchedOnceAndWaitedForOnce) {
  const Trace trace = RecordRows(kIterations, 4, 96, RecordedKind::kLoad);
  const CacheCost cost = CostOf(trace, kIterations, 400.0);
  EXPECT_DOUBLE_EQ(cost.lines_per_iteration, 4.0 / 8);  // 8 iterations per line
  // The way to the second level, beyond what a hit takes, in whole turns to dispatch.
  const CacheMemoryParameters p = XenonMemory();
  const double way = p.l2_hit_cycles - p.core.load_to_address_cycles;
  EXPECT_NEAR(cost.unfetched_wait_cycles_per_iteration, way * 4 / 8, way * 4 / 8 * 0.25);
  // Fetched in time, a line costs its dcbt.
  EXPECT_NEAR(cost.wait_cycles_per_iteration, 4.0 / 8, 1.0);
}

TEST(CacheCost, WhatStaysInTheFirstLevelCostsNothingMore) {
  Trace trace = RecordRows(1, 4, 96, RecordedKind::kLoad);
  const std::vector<RecordedOperation> once = trace.operations;
  for (uint32_t t = 1; t < kIterations; ++t)
    trace.operations.insert(trace.operations.end(), once.begin(), once.end());
  const CacheCost cost = CostOf(trace, kIterations, 400.0);
  EXPECT_DOUBLE_EQ(cost.lines_per_iteration, 4.0 / kIterations);
  EXPECT_LT(cost.unfetched_wait_cycles_per_iteration, 40.0 * 4 / kIterations + 1.0);
}

TEST(CacheCost, StoresAreNotFetched) {
  EXPECT_DOUBLE_EQ(CostOf(RecordRows(kIterations, 4, 96, RecordedKind::kStore), kIterations, 400.0)
                       .lines_per_iteration,
                   0.0);
}

TEST(CacheCost, TwoThreadsFromOneFirstLevelAndFasterTracesWaitMore) {
  const Trace trace = RecordRows(kIterations, 12, 4, RecordedKind::kLoad);
  const CacheCost slow = CostOf(trace, kIterations, 400.0), fast = CostOf(trace, kIterations, 16.0);
  EXPECT_GT(fast.wait_cycles_per_iteration, slow.wait_cycles_per_iteration);
  EXPECT_GE(CostOf(trace, kIterations, 16.0, 2).wait_cycles_per_iteration,
            fast.wait_cycles_per_iteration);
}

// Planted: a second level as near as the first, and one that is far.
TEST(CacheCost, FollowsTheWayToTheSecondLevel) {
  const Trace trace = RecordRows(kIterations, 4, 96, RecordedKind::kLoad);
  CacheMemoryParameters far = XenonMemory();
  far.l2_hit_cycles = 80;
  const double usual = CostOf(trace, kIterations, 400.0).unfetched_wait_cycles_per_iteration;
  EXPECT_GT(CostOf(trace, kIterations, 400.0, 1, far).unfetched_wait_cycles_per_iteration,
            1.8 * usual);
}

TEST(CacheCost, RefusesCachesThatCannotBe) {
  CacheMemoryParameters none = XenonMemory();
  none.l1_bytes = 0;
  EXPECT_NE(PriceCaches(RecordRows(2, 1, 1, RecordedKind::kLoad), 2, 10.0, 1, none).error(), "");
}

}  // namespace
}  // namespace pelt
