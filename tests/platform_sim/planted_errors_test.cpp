// Wrong numbers and missing rules, planted one at a time, and the measured row that must notice
// each; and those that no measured row can notice, with the source that the rule's own test stands
// on instead.
#include <gtest/gtest.h>

#include "platform_sim/measured_rows.hpp"
#include "platform_sim/rows/row_work.hpp"
#include "tests/platform_sim/timing_rows.hpp"

namespace pelt::testing {
namespace {

void AddLatency(PlatformParameters& p, SpuClass op, int cycles) {
  p.cell.spu.Of(op).latency_cycles += uint32_t(cycles);
}

struct PlantedError {
  const char* what;
  const char* row;  // that must notice
  void (*plant)(PlatformParameters& p);
};
using P = PlatformParameters;

const PlantedError kPlanted[] = {
    // The SPU's core.
    {"estimate on the even pipe", "C5",
     [](P& p) { p.cell.spu.Of(SpuClass::kEstimate).pipe = SpuPipe::kEven; }},
    {"FP6 latency 7", "C1", [](P& p) { AddLatency(p, SpuClass::kFp6, 1); }},
    {"FP6 latency 7, by issue times", "C23t", [](P& p) { AddLatency(p, SpuClass::kFp6, 1); }},
    {"FP6 latency 5", "C23t", [](P& p) { AddLatency(p, SpuClass::kFp6, -1); }},
    {"FP7 latency 8", "C2", [](P& p) { AddLatency(p, SpuClass::kFp7, 1); }},
    {"shuffle latency 5", "C23", [](P& p) { AddLatency(p, SpuClass::kShuffle, 1); }},
    {"shuffle latency 3", "C23", [](P& p) { AddLatency(p, SpuClass::kShuffle, -1); }},
    {"load latency 7", "C23", [](P& p) { AddLatency(p, SpuClass::kLoad, 1); }},
    {"load latency 5", "C23", [](P& p) { AddLatency(p, SpuClass::kLoad, -1); }},
    {"shuffle latency 5, in chains", "C3", [](P& p) { AddLatency(p, SpuClass::kShuffle, 1); }},
    {"shuffles on the even pipe", "C4",
     [](P& p) { p.cell.spu.Of(SpuClass::kShuffle).pipe = SpuPipe::kEven; }},
    {"estimate on the even pipe, beside nops of it", "C6",
     [](P& p) { p.cell.spu.Of(SpuClass::kEstimate).pipe = SpuPipe::kEven; }},
    {"mispredict 13", "C9", [](P& p) { p.cell.spu.mispredict_cycles = 13; }},
    {"mispredict 19", "C9", [](P& p) { p.cell.spu.mispredict_cycles = 19; }},
    {"double stalls 5", "C7", [](P& p) { p.cell.spu.Of(SpuClass::kFpd).stall_cycles = 5; }},
    {"double does not stall", "C7", [](P& p) { p.cell.spu.Of(SpuClass::kFpd).stall_cycles = 0; }},
    {"pairing without addresses", "C9", [](P& p) { p.cell.spu.fetch_group_bytes = 1u << 31; }},
    {"hint lead 400", "C13", [](P& p) { p.cell.spu.hint_lead_cycles = 400; }},
    // The system.
    {"availability 1", "C1", [](P& p) { p.cell.availability_permille = 1000; }},
    {"availability 1, DMA", "D1", [](P& p) { p.cell.availability_permille = 1000; }},
    {"5 SPUs", "C2", [](P& p) { p.cell.spu_count = 5; }},
    {"a clock of 3 GHz", "C1", [](P& p) { p.cell.clock_hz = 3'000'000'000; }},
    // MFC, memory.
    {"a queue of one", "D3", [](P& p) { p.cell.queue_commands = 1; }},
    {"2 lines in flight", "D1", [](P& p) { p.cell.lines_in_flight = 2; }},
    {"lines of 512 bytes at the same rate", "D3",
     [](P& p) {
       p.cell.line_bytes = 512;
       p.cell.memory_line_cycles = 64;
     }},
    {"memory four times as far", "D3", [](P& p) { p.cell.memory_access_cycles *= 4; }},
    {"memory 18 cycles per line, written", "D2", [](P& p) { p.cell.memory_line_cycles = 18; }},
    {"memory 18 cycles per line", "D1", [](P& p) { p.cell.memory_line_cycles = 18; }},
    {"refresh takes 400", "D1", [](P& p) { p.cell.refresh_cycles = 400; }},
    {"commands taken up in 600", "D3", [](P& p) { p.cell.command_cycles *= 20; }},
    // Bus.
    {"no snoop", "S1", [](P& p) { p.cell.snoop_cycles = 1; }},
    {"snoop twice as long", "S1", [](P& p) { p.cell.snoop_cycles *= 2; }},
    {"rings of half the width", "E8", [](P& p) { p.cell.ring_bytes = 8; }},
    {"two rings", "E8", [](P& p) { p.cell.rings = 2; }},
    {"rings of half the width, one store", "E2", [](P& p) { p.cell.ring_bytes = 8; }},
    {"local stores twice as far", "E8", [](P& p) { p.cell.local_store_cycles *= 2; }},
    // Jobs.
    {"dispatch not serial", "J4", [](P& p) { p.cell.jobs.ppe_job_ns = 1; }},
    {"an SPE spends 30 us on a job", "J1a", [](P& p) { p.cell.jobs.spe_job_ns = 30000; }},
    // PPE and Xenon.
    {"L1 latency 8", "P1", [](P& p) { p.cell.ppe.load_to_address_cycles = 8; }},
    {"integers in 4 cycles", "P2",
     [](P& p) { p.cell.ppe.Of(PpeClass::kInteger).latency_cycles = 4; }},
    {"L1 of an eighth", "P2", [](P& p) { p.cell.ppe_caches.l1_bytes /= 8; }},
    {"L2 latency doubled", "P3", [](P& p) { p.cell.ppe_caches.l2_hit_cycles *= 2; }},
    {"a quarter of the L2", "P4", [](P& p) { p.cell.ppe_caches.l2_bytes /= 4; }},
    {"half of the L2", "P6", [](P& p) { p.cell.ppe_caches.l2_bytes /= 2; }},
    {"L1 filled for 20 cycles", "P6", [](P& p) { p.cell.ppe_caches.l1_fill_cycles = 20; }},
    {"scalar FP 12", "P8", [](P& p) { p.cell.ppe.Of(PpeClass::kFloat).latency_cycles = 12; }},
    {"scalar FP 20, both threads", "P10",
     [](P& p) { p.cell.ppe.Of(PpeClass::kFloat).latency_cycles = 20; }},
    {"scalar FP not pipelined", "P11",
     [](P& p) { p.cell.ppe.Of(PpeClass::kFloat).blocks_units = uint8_t(PpeUnit::kVsu1); }},
    {"integer latency 10", "P9",
     [](P& p) { p.cell.ppe.Of(PpeClass::kInteger).latency_cycles = 10; }},
    {"integer latency 20, beside another thread", "P12",
     [](P& p) { p.cell.ppe.Of(PpeClass::kInteger).latency_cycles = 20; }},
    {"VMX float 16", "P7", [](P& p) { p.cell.ppe.Of(PpeClass::kVectorFloat).latency_cycles = 16; }},
    {"VMX float 6: nothing to gain", "X6",
     [](P& p) { p.xenon.core.Of(PpeClass::kVectorFloat).latency_cycles = 6; }},
    {"load-hit-store of 60", "X5", [](P& p) { p.xenon.core.load_hit_store_cycles = 60; }},
};

TEST(PlantedErrors, EachIsNoticedByItsRow) {
  for (const PlantedError& planted : kPlanted) {
    PlatformParameters p;
    planted.plant(p);
    EXPECT_TRUE(PredictRow(*FindRow(planted.row), {}).passes) << planted.row << " misses anyway";
    const RowResult row = PredictRow(*FindRow(planted.row), p);
    EXPECT_EQ(row.failure, "") << planted.what;
    EXPECT_FALSE(row.passes) << planted.what << ": " << planted.row << " says " << row.Predicted();
  }
}

// ---- what no measured row can notice -----------------------------------------------------------

// A class whose latency nothing waits for in the rows' work. Their latencies are the SDK tutorial's
// and GCC's, which agree; SpuCore.LatenciesAreThoseOfTheClasses holds each to them.
struct Unseen {
  const char* what;
  std::initializer_list<const char*> rows;  // that come nearest
  void (*plant)(PlatformParameters& p);
};
const Unseen kUnseen[] = {
    {"FX2 latency 3", {"C1", "C9", "C23t"}, [](P& p) { AddLatency(p, SpuClass::kFx2, 1); }},
    {"FX3 latency 5", {"C5", "C23t"}, [](P& p) { AddLatency(p, SpuClass::kFx3, 1); }},
    {"FXB latency 5", {"C5", "C23t"}, [](P& p) { AddLatency(p, SpuClass::kFxb, 1); }},
    {"FP7 latency 6: 7 chains hide it",
     {"C2", "C5"},
     [](P& p) { AddLatency(p, SpuClass::kFp7, -1); }},
    {"FPD latency 14: its stall is longer", {"C7"}, [](P& p) { AddLatency(p, SpuClass::kFpd, 1); }},
    {"estimate latency 5: 6 chains hide it",
     {"C5"},
     [](P& p) { AddLatency(p, SpuClass::kEstimate, 1); }},
    {"a channel operation of 7", {"S1", "D3"}, [](P& p) { AddLatency(p, SpuClass::kChannel, 1); }},
    // In C5 a step six wide waits for fi anyway. SDK; SpuCore.AnFp6RightAfterAnFp7LosesOneCycle.
    {"no loss of an FP6 after an FP7", {"C5"}, [](P& p) { p.cell.spu.fp6_after_fp7_cycles = 0; }},
    // SDK; SpuCore.AHintHoldsWhenItLeadsFarEnough.
    {"hint lead 14", {"C13"}, [](P& p) { p.cell.spu.hint_lead_cycles = 14; }},
    {"hints never reach", {"C13"}, [](P& p) { p.cell.spu.hint_reach_instructions = 1000; }},
    // Rows whose ways cross on a ring there are none: E1's pairs are neighbours. Krolak.
    {"starts 12 bus cycles apart", {"E2", "E8"}, [](P& p) { p.cell.ring_start_bus_cycles = 12; }},
    // A line is 44 cycles of work there, longer than its way from the L2.
    {"one miss of the PPE in flight",
     {"P3", "P6"},
     [](P& p) { p.cell.ppe_caches.outstanding_misses = 1; }},
    // Little's law on D3: six SPEs with 8 x 256 bytes reach 22 GB/s up to a round trip of 560 ns.
    // A memory twice as far stays below that; LittlesLaw below holds the bound itself.
    {"memory latency doubled", {"D1", "D3", "D9"}, [](P& p) { p.cell.memory_access_cycles *= 2; }},
};

TEST(PlantedErrors, SomeAreBeyondAnyRow) {
  for (const Unseen& unseen : kUnseen) {
    PlatformParameters p;
    unseen.plant(p);
    for (const char* row : unseen.rows)
      EXPECT_TRUE(PredictRow(*FindRow(row), p).passes)
          << unseen.what << " is noticed by " << row << ": move it to the others";
  }
}

// Where the rows stop to be satisfied is where consoles.md derives it: a loaded round trip of 256
// bytes beyond 560 ns. So the class L latency of memory is bound from above by measurement.
TEST(PlantedErrors, LittlesLawBoundsTheLatencyOfMemory) {
  const auto alone_ns = [](const CellParameters& cell) {
    std::string error;
    const auto run = RunStream(
        cell, {.spus = 1, .block_bytes = 256, .in_flight = 1, .bytes_each = 1 << 14}, error);
    EXPECT_TRUE(run) << error;
    return cell.Nanoseconds(double(run->cycles) / (1 << 6));
  };
  PlatformParameters p;
  EXPECT_LT(alone_ns(p.cell), 560.0);
  double longest_ns = 0.0, first_missed_ns = 1e9;
  for (uint32_t access = 400; access <= 2400; access += 200) {
    p.cell.memory_access_cycles = access;
    const double ns = alone_ns(p.cell);
    if (PredictRow(*FindRow("D3"), p).passes)
      longest_ns = std::max(longest_ns, ns);
    else
      first_missed_ns = std::min(first_missed_ns, ns);
  }
  EXPECT_GT(first_missed_ns, longest_ns);
  EXPECT_NEAR(longest_ns, 560.0, 100.0);
}

// The rule itself, on work that nothing else holds.
TEST(PlantedErrors, NoLossAfterFp7IsSeenInTheTutorialsOwnCase) {
  std::string text = ".align 3\nloop:\n";
  for (int r = 0; r < 32; ++r) {
    for (int i = 0; i < 7; ++i) text += fmt::format("mpya $2{0}, $2{0}, $10, $11; lnop\n", i);
    for (int i = 0; i < 6; ++i) text += fmt::format("fma $3{0}, $3{0}, $10, $11; lnop\n", i);
  }
  text += "ai $7, $7, -1; brnz $7, loop\n";
  SpuParameters spu;
  EXPECT_EQ(CyclesPerIteration(TimeOnSpu(text, spu)), 32 * 14 + 21);
  spu.fp6_after_fp7_cycles = 0;
  EXPECT_EQ(CyclesPerIteration(TimeOnSpu(text, spu)), 32 * 13 + 21);
}

}  // namespace
}  // namespace pelt::testing
