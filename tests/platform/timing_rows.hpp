// Listings of the measured rows (consoles.md), made from what the rows say was run, and what the
// model predicts for them. Nothing is fitted: a prediction comes from SpuParameters alone.
#pragma once

// As in pelt_platform_sim: these tests link no fmt of their own.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "platform_sim/core/listing.hpp"
#include "platform_sim/platforms/spu.hpp"
#include "platform_sim/core/spu_core.hpp"

namespace pelt::testing {

// Statements of `count` registers, each followed by one for the odd pipe.
class ListingText {
 public:
  void Line(const std::string& statement) { text += "  " + statement + "\n"; }
  void WithLnop(const std::string& statement) {
    Line(statement);
    Line("lnop");
  }
  // "{0}" is the chain, from 0.
  void Chains(uint32_t count, fmt::string_view statement) {
    for (uint32_t i = 0; i < count; ++i)
      WithLnop(fmt::vformat(statement, fmt::make_format_args(i)));
  }
  void Label(const std::string& name) { text += name + ":\n"; }

  std::string text;
};

inline std::string CountedLoop(const std::string& body) {
  return ".align 3\nloop:\n" + body + "  ai $7, $7, -1\n  brnz $7, loop\n";
}

// C1: 64 x [6 x (fma r_i,r_i,m,a ; lnop)], ai, brnz unhinted; 3072 flop a turn.
inline std::string SinglePrecisionFma() {
  ListingText body;
  for (int r = 0; r < 64; ++r) body.Chains(6, "fma $2{0}, $2{0}, $10, $11");
  return CountedLoop(body.text);
}

// C2: 32 x [7 x (mpya ; lnop)], ai, brnz; an op is a multiply or an add of a lane.
inline std::string IntegerMultiplyAdd() {
  ListingText body;
  for (int r = 0; r < 32; ++r) body.Chains(7, "mpya $2{0}, $2{0}, $10, $11");
  return CountedLoop(body.text);
}

// C5: 8 x { reciprocal; reciprocal root }, six wide, an lnop behind each; an op is one lane of one
// instruction.
inline std::string NewtonSteps() {
  ListingText body;
  for (int r = 0; r < 8; ++r) {
    body.Chains(6, "frest $3{0}, $2{0}");
    body.Chains(6, "fi $3{0}, $2{0}, $3{0}");
    body.Chains(6, "fnms $4{0}, $2{0}, $3{0}, $10");
    body.Chains(6, "fma $3{0}, $4{0}, $3{0}, $3{0}");
    body.Chains(6, "frsqest $5{0}, $2{0}");
    body.Chains(6, "and $6{0}, $2{0}, $11");
    body.Chains(6, "fi $5{0}, $6{0}, $5{0}");
    body.Chains(6, "fm $7{0}, $5{0}, $12");
    body.Chains(6, "fnms $4{0}, $7{0}, $5{0}, $10");
    body.Chains(6, "fm $7{0}, $5{0}, $4{0}");
    body.Chains(6, "fma $2{0}, $7{0}, $12, $3{0}");
  }
  return CountedLoop(body.text);
}

// C7: 16 x [13 x (dfma ; lnop)], 832 flop a turn.
inline std::string DoublePrecisionFma() {
  ListingText body;
  for (int r = 0; r < 16; ++r) body.Chains(13, "dfma $1{0:02}, $10, $11");
  return CountedLoop(body.text);
}

// C9: lnop x5, ai, lnop x5, brnz.
inline std::string UnhintedBranch() {
  ListingText body;
  body.Label("loop");
  for (int i = 0; i < 5; ++i) body.Line("lnop");
  body.Line("ai $7, $7, -1");
  for (int i = 0; i < 5; ++i) body.Line("lnop");
  body.Line("brnz $7, loop");
  return body.text;
}

inline IssueChart TimeOnSpu(const std::string& text, const SpuParameters& spu = {},
                            const SpuRules& rules = {}, uint64_t turns = 100'000) {
  const Listing listing = ReadListing(text, "row.s", SpuInstructionSet());
  std::vector<TripCount> trips;
  if (const ListingLabel* loop = listing.FindLabel("loop")) trips.push_back({loop->index, turns});
  return ValueOrThrow(
      [&](std::string& error) { return TryTimeOnSpu(listing.program, trips, rules, spu, error); });
}

inline std::string ReadListingFile(const std::string& name) {
  std::ifstream in(std::string(PELT_SOURCE_DIR "/tests/platform/listings/") + name);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

// Issue cycles of the first pass.
inline std::vector<int64_t> Cycles(const std::string& text, const SpuParameters& spu = {},
                                   const SpuRules& rules = {}) {
  std::vector<int64_t> out;
  for (const IssueSlot& slot : TimeOnSpu(text, spu, rules).first_pass) out.push_back(slot.cycle);
  return out;
}

inline void ExpectAllCyclesAccountedFor(const IssueTotals& totals) {
  EXPECT_EQ(uint64_t(totals.cycles), totals.IssueCycles() + totals.AllStallCycles());
  uint64_t unpaired = 0;
  for (const uint64_t count : totals.unpaired) unpaired += count;
  EXPECT_EQ(unpaired, totals.instructions);
  EXPECT_EQ(totals.unpaired[uint32_t(Unpaired::kPaired)], totals.dual_issues);
}

inline double CyclesPerTurn(const IssueChart& chart) {
  return chart.loops.size() == 1 && chart.loops[0].steady ? chart.loops[0].CyclesPerTurn() : -1.0;
}

// A measured rate of all SPUs of a game together.
struct RateRow {
  const char* id;
  std::string (*listing)();
  double operations_per_turn;
  double measured_giga;  // operations a second
};
inline constexpr RateRow kRateRows[] = {
    {"C1", SinglePrecisionFma, 3072, 134.4},
    {"C2", IntegerMultiplyAdd, 32 * 7 * 8, 130.1},
    {"C5", NewtonSteps, 2112, 56.43},
    {"C7", DoublePrecisionFma, 832, 8.65},
};

inline double IssueRateGiga(const RateRow& row, const SpuParameters& spu) {
  return row.operations_per_turn / CyclesPerTurn(TimeOnSpu(row.listing(), spu)) *
         double(spu.clock_hz) * 1e-9 * spu.game_spu_count;
}

// Of the predicted rate, availability included.
inline double RateError(const RateRow& row, const SpuParameters& spu) {
  return IssueRateGiga(row, spu) * kSpuAvailability / row.measured_giga - 1.0;
}

}  // namespace pelt::testing
