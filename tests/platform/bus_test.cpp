// The EIB against its rows, wrong numbers, and what the rings must never do. Also the platform's
// limits: what a Cell may be, what a local store holds.
#include "platform_sim/memory/bus.hpp"

#include <set>

#include "platform_sim/memory/local_store_budget.hpp"
#include "tests/platform/cell_work.hpp"
#include "tests/platform/platform_rows.hpp"

namespace pelt {
namespace {

using namespace testing;

constexpr double kAllowedPercent = 5.0;

double RowE8(const CellMemoryParameters& p) {
  double sum = 0.0;
  for (int reader = 0; reader < 6; ++reader)
    for (int far = 0; far < 6; ++far) {
      if (reader == far) continue;
      std::vector<int> reads(6, -1);
      reads[size_t(reader)] = far;
      sum += Measured(p, ReadLocalStores(p, reads));
    }
  return sum / 30;
}

TEST(BusRows, E1ThreePairsBothWays) {
  const CellMemoryParameters p;
  const MeanAndRange pairs = PairsOverConsoles(p);
  std::printf("E1 over the 28 consoles: %.1f to %.1f GB/s; the default one %.1f\n", pairs.least,
              pairs.most, Measured(p, ReadLocalStores(p, {1, 0, 3, 2, 5, 4})));
  ExpectRow("E1", pairs.mean, 114.73, "GB/s", kAllowedPercent);
}

TEST(BusRows, E8OnePairAfterAnother) { ExpectRow("E8", RowE8({}), 23.42, "GB/s", kAllowedPercent); }

TEST(BusPlanted, WrongNumbersAreNoticedByARow) {
  const auto off = [](double predicted, double measured) {
    return std::abs(PercentOff(predicted, measured));
  };
  CellMemoryParameters p;
  p.rings = 2;
  EXPECT_GT(off(PairsOverConsoles(p).mean, 114.73), kAllowedPercent) << "two rings";
  p = {};
  p.ring_start_bus_cycles = 12;
  EXPECT_GT(off(PairsOverConsoles(p).mean, 114.73), kAllowedPercent) << "starts too far apart";
  p = {};
  p.ring_bytes = 8;
  EXPECT_GT(off(RowE8(p), 23.42), kAllowedPercent) << "half the width";
  p = {};
  p.local_store_cycles *= 2;
  EXPECT_GT(off(RowE8(p), 23.42), kAllowedPercent) << "latency doubled";
  p = {};
  p.lines_in_flight = 8;
  EXPECT_GT(off(RowE8(p), 23.42), kAllowedPercent) << "half the lines in flight";
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
  const auto why = [](const CellMemoryParameters& p) {
    std::string error;
    EXPECT_FALSE(CheckCellMemory(p, error));
    return error;
  };
  CellMemoryParameters p;
  std::string error;
  EXPECT_TRUE(CheckCellMemory(p, error)) << error;
  p.spu_count = 0;
  EXPECT_NE(why(p).find("no SPU"), std::string::npos);
  p = {};
  p.local_store_bytes = 16 * 1024;
  EXPECT_NE(why(p).find("local store of 16384 bytes"), std::string::npos);
  p = {};
  p.rings = 3;
  EXPECT_NE(why(p).find("2 or 4"), std::string::npos);
  p = {};
  p.memory_line_cycles = 0;
  EXPECT_NE(why(p).find("is zero"), std::string::npos);
  p = {};
  p.missing_spe[1] = p.missing_spe[0];
  EXPECT_NE(why(p).find("missing_spe"), std::string::npos);
  p = {};
  p.spu_count = 8;
  EXPECT_NE(why(p).find("at most 6"), std::string::npos);
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

TEST(CellPlatform, DescribesEveryNumberWithItsSource) {
  for (const PlatformNumber& n : DescribeCellMemory({})) {
    EXPECT_FALSE(n.name.empty());
    EXPECT_FALSE(n.source.empty()) << n.name;
  }
}

}  // namespace
}  // namespace pelt
