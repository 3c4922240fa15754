// What the rings of the EIB must never do. Also the platform's
// limits: what a Cell may be, what a local store holds.
#include <set>

#include "platform_sim/frame/console_frame.hpp"
#include "platform_sim/frame/console_machine.hpp"
#include "platform_sim/memory/cell_memory.hpp"
#include "tests/platform_sim/cell_work.hpp"

namespace pelt::testing {
namespace {

// Four pairs of SPEs lie opposite each other, and any SPU may be the first.
std::vector<CellMemoryParameters> ConsolesOfOneTopology() {
  std::vector<CellMemoryParameters> consoles;
  for (const auto& [a, b] : {std::pair{0u, 7u}, {1u, 6u}, {2u, 5u}, {3u, 4u}})
    for (uint32_t first = 0; first < 6; ++first) {
      CellMemoryParameters p;
      p.missing_spe[0] = a;
      p.missing_spe[1] = b;
      p.first_spu = first;
      consoles.push_back(p);
    }
  return consoles;
}

TEST(Bus, StopsAreDistinctOnEveryConsole) {
  CellMemoryParameters p;
  for (p.missing_spe[0] = 0; p.missing_spe[0] < 8; ++p.missing_spe[0])
    for (p.missing_spe[1] = p.missing_spe[0] + 1; p.missing_spe[1] < 8; ++p.missing_spe[1]) {
      std::set<uint32_t> stops;
      for (uint32_t s = 0; s < 6; ++s) stops.insert(BusStop(p, s));
      EXPECT_EQ(stops.size(), 6u);
      EXPECT_EQ(stops.count(kPpeStop) + stops.count(kMemoryStop), 0u);
    }
}

// cellmark's thirty pairs: one and two SPUs further on a line goes one way, three further on it may
// go either, as far one way as the other.
TEST(Bus, SpusFollowEachOtherRoundTheRing) {
  for (const CellMemoryParameters& p : ConsolesOfOneTopology())
    for (uint32_t spu = 0; spu < 6; ++spu) {
      const auto up = [&](uint32_t further) {
        return (BusStop(p, (spu + further) % 6) + kBusStops - BusStop(p, spu)) % kBusStops;
      };
      EXPECT_LT(up(1), kBusStops / 2);
      EXPECT_LT(up(2), kBusStops / 2);
      EXPECT_LT(up(1), up(2));
      EXPECT_EQ(up(3), kBusStops / 2);
      EXPECT_GT(up(4), kBusStops / 2);
      EXPECT_GT(up(5), up(4));
    }
}

// Row E1: on none of the consoles that cellmark's topology leaves open do neighbours meet on the
// ring, so which of them it was makes no difference.
TEST(Bus, NeighboursDoNotMeetOnTheRing) {
  const CellMemoryParameters one;
  const double rate = ReadLocalStores(one, {1, 0, 3, 2, 5, 4}).GigabytesPerSecond(one);
  for (const CellMemoryParameters& p : ConsolesOfOneTopology())
    EXPECT_NEAR(ReadLocalStores(p, {1, 0, 3, 2, 5, 4}).GigabytesPerSecond(p) / rate, 1.0, 0.01);
}

TEST(Bus, NeverCarriesMoreThanItsRings) {
  const CellMemoryParameters p;
  for (const std::vector<int>& reads :
       {std::vector<int>{1, 2, 3, 4, 5, 0}, {3, 4, 5, 0, 1, 2}, {5, 4, 3, 2, 1, 0}}) {
    const double rate = ReadLocalStores(p, reads).GigabytesPerSecond(p);
    EXPECT_LE(rate, 204.8);
    EXPECT_LE(rate, 6 * 25.6);
    EXPECT_GE(rate, 25.6);
  }
  // All read one local store: its port is the limit.
  EXPECT_LE(ReadLocalStores(p, {-1, 0, 0, 0, 0, 0}).GigabytesPerSecond(p), 25.6);
}

TEST(Bus, AnEmptyBusTakesALineItsBeatsAndHops) {
  const CellMemoryParameters p;
  EventQueue queue;
  Bus bus(p, queue);
  Cycles arrived = -1;
  bus.Send(3, 5, [&] { arrived = queue.now(); });
  queue.Run();
  EXPECT_EQ(arrived, 2 * (8 + 2));
}

TEST(CellPlatform, ImpossibleOnesAreRefusedWithAReason) {
  std::string error;
  EXPECT_TRUE(CheckCellMemory({}, error)) << error;
  const struct {
    void (*spoil)(CellMemoryParameters& p);
    const char* why;
  } kCases[] = {{[](auto& p) { p.spu_count = 0; }, "no SPU"},
                {[](auto& p) { p.local_store_bytes = 16 * 1024; }, "local store of 16384 bytes"},
                {[](auto& p) { p.clock_hz = 0; }, "clock"},
                {[](auto& p) { p.line_bytes = 100; }, "power of two"},
                {[](auto& p) { p.availability_permille = 0; }, "availability"},
                {[](auto& p) { p.rings = 3; }, "2 or 4"},
                {[](auto& p) { p.memory_line_cycles = 0; }, "is zero"},
                {[](auto& p) { p.missing_spe[1] = p.missing_spe[0]; }, "missing_spe"},
                {[](auto& p) { p.first_spu = 6; }, "first_spu"},
                {[](auto& p) { p.spu_count = 8; }, "at most 6"}};
  for (const auto& c : kCases) {
    CellMemoryParameters bad;
    c.spoil(bad);
    EXPECT_FALSE(CheckCellMemory(bad, error)) << c.why;
    EXPECT_NE(error.find(c.why), std::string::npos) << error;
  }
}

TEST(LocalStoreBudget, SaysByHowMuchItDoesNotFit) {
  const CellMemoryParameters p;
  std::string error;
  uint64_t left = 0;
  LocalStoreUse use = {40000, 16384, 20000, 100000, 2};
  EXPECT_FALSE(FitsLocalStore(p, use, left, error));
  EXPECT_NE(error.find("276384 bytes are needed"), std::string::npos) << error;
  EXPECT_NE(error.find(std::to_string(use.Bytes() - p.local_store_bytes) + " too many"),
            std::string::npos)
      << error;
  use.buffer_sets = 1;
  EXPECT_TRUE(FitsLocalStore(p, use, left, error));
  EXPECT_EQ(left, p.local_store_bytes - use.Bytes());
}

TEST(Platforms, EveryNumberIsToldOnceWithUnitAndSource) {
  for (const auto& numbers : {DescribeCell({}), DescribeXenon({})}) {
    std::set<std::string> names;
    int leads = 0;
    for (const PlatformNumber& n : numbers) {
      EXPECT_TRUE(names.insert(n.name).second) << n.name << " stands twice";
      EXPECT_FALSE(n.name.empty() || n.unit.empty() || n.source.empty()) << n.name;
      leads += n.sure == Sureness::kLead;
    }
    EXPECT_GT(leads, 0);
    EXPECT_LT(leads * 2, int(numbers.size()));
  }
}

TEST(Platforms, ANumberIsToldByItsMember) {
  CellMemoryNumbers numbers;
  numbers.tags = 7;
  numbers.os_call_ns = 1;
  std::vector<PlatformNumber> described;
  TellNumbers(numbers, described, "MFC: ");
  ASSERT_EQ(described.size(), sizeof numbers / sizeof numbers.tags) << "one left out";
  EXPECT_EQ(described[3].name, "MFC: tags");
  EXPECT_EQ(described[3].value, 7.0);
  EXPECT_EQ(described[3].unit, numbers.tags.unit);
  EXPECT_EQ(described[3].source, numbers.tags.source);
  EXPECT_EQ(described.back().value, 1.0);
  // A rate in thousandths is reported as the rate itself.
  EXPECT_EQ(TellNumber(CacheParameters{}.l2_milli_bytes_per_cycle).value, 16.0);
}

TEST(Platforms, WhatIsChangedOnceIsChangedEverywhere) {
  CellParameters cell;
  cell.line_bytes = 64;
  cell.ppe.load_hit_store_cycles = 50;
  cell.memory_line_cycles = 32;
  const CacheMemoryParameters ppe = PpeMemory(cell);
  EXPECT_EQ(ppe.line_bytes, 64u);
  EXPECT_EQ(ppe.core.load_hit_store_cycles, 50u);
  EXPECT_EQ(ppe.memory_milli_bytes_per_cycle, 2000u);
  CellParameters deep;
  deep.runtime.stack_bytes = 1234;
  EXPECT_EQ(MakeCell(deep, deep.jobs).OrThrow().runtime.stack_bytes, 1234u);
  const std::vector<PlatformNumber> described = DescribeCell(deep);
  EXPECT_TRUE(std::any_of(described.begin(), described.end(), [](const PlatformNumber& n) {
    return n.name == "stack" && n.value == 1234.0;
  }));
  std::string error;
  EXPECT_TRUE(CheckPlatforms({}, error)) << error;
  PlatformParameters none;
  none.cell.spu_count = 0;
  EXPECT_FALSE(CheckPlatforms(none, error));
  none = {};
  none.xenon.clock_hz = 0;
  EXPECT_FALSE(CheckPlatforms(none, error));
}

}  // namespace
}  // namespace pelt::testing
