// The PPE's dispatch, rule by rule and against the measured rows.
#include "platform_sim/pipeline/ppe_core.hpp"

#include <gtest/gtest.h>

#include "tests/platform_sim/timing_rows.hpp"

namespace pelt::testing {
namespace {

IssueChart TimeOnPpe(const std::string& text, const PpeParameters& ppe = {},
                     const PpeRules& rules = {}) {
  const Listing listing = ReadListing(text, "row.s", PpeInstructionSet()).OrThrow();
  std::vector<TripCount> trips;
  if (const ListingLabel* loop = listing.FindLabel("loop")) trips.push_back({loop->index, 100'000});
  return pelt::TimeOnPpe(listing.program, trips, rules, ppe).OrThrow();
}

At Issued(const std::string& text, const PpeParameters& ppe = {}, const PpeRules& rules = {}) {
  At out;
  for (const IssueSlot& slot : TimeOnPpe(text, ppe, rules).first_pass) out.push_back(slot.cycle);
  return out;
}

// ---- rules -----------------------------------------------------------------------------------

TEST(PpeCore, TwoOnOneUnitNeverPair) {
  EXPECT_EQ(Issued("add 3,4,5; add 6,7,8"), (At{0, 1}));
  EXPECT_EQ(Issued("add 3,4,5; lwz 6,0(7)"), (At{0, 0}));
  EXPECT_EQ(Issued("lfs 1,0(4); vperm 2,3,4,5"), (At{0, 1}));  // both VSU2
  EXPECT_EQ(Issued("vaddfp 1,2,3; vperm 4,5,6,7"), (At{0, 0}));
  EXPECT_EQ(Issued("vaddfp 1,2,3; fadd 4,5,6"), (At{0, 1}));                // both VSU1
  EXPECT_EQ(Issued("add 3,4,5; lwz 6,0(7); vaddfp 1,2,3"), (At{0, 0, 1}));  // two per cycle
}

TEST(PpeCore, NothingGoesBehindABranchAMultiplyOrADivide) {
  EXPECT_EQ(Issued("beq cr0,out; lwz 3,0(4); out:"), (At{0, 1}));
  EXPECT_EQ(Issued("lwz 3,0(4); beq cr0,out; add 5,6,7; out:"), (At{0, 0, 1}));
  EXPECT_EQ(Issued("lwz 3,0(4); mullw 5,6,7"), (At{0, 0}));
  // A taken branch and what lies at its target are never one group.
  EXPECT_EQ(CyclesPerIteration(TimeOnPpe("loop: lwz 3,0(4); add 5,6,7; bdnz loop")), 2.0);
}

TEST(PpeCore, ResultsAreLaterForAddresses) {
  EXPECT_EQ(Issued("lwz 3,0(4); add 5,3,3").back(), 2);
  EXPECT_EQ(Issued("lwz 3,0(4); lwz 5,0(3)").back(), 6);
  EXPECT_EQ(Issued("addi 3,3,4; dcbt 0,3").back(), 5);
  EXPECT_EQ(Issued("addi 3,3,4; lvx 5,0,3").back(), 5);
  EXPECT_EQ(Issued("addi 3,3,4; stw 3,0(4)").back(), 2);    // data, not address
  EXPECT_EQ(Issued("lwzu 3,4(4); lwzu 3,4(4)").back(), 5);  // the address that it counted up
}

TEST(PpeCore, LatenciesAreThoseOfTheClasses) {
  const struct {
    const char* text;
    int64_t cycles;
  } kCases[] = {
      {"mullw 3,4,5; add 6,3,3", 9},           {"mulld 3,4,5; add 6,3,3", 15},
      {"divw 3,4,5; add 6,3,3", 32},           {"divd 3,4,5; add 6,3,3", 64},
      {"fmadd 1,2,3,4; fadd 5,1,1", 10},       {"fdivs 1,2,3; fadd 5,1,1", 74},
      {"fsqrts 1,2; fadd 5,1,1", 84},          {"vand 1,2,3; vor 4,1,1", 4},
      {"vperm 1,2,3,4; vor 4,1,1", 4},         {"vmsumshm 1,2,3,4; vor 5,1,1", 10},
      {"vmaddfp 1,2,3,4; vor 5,1,1", 12},      {"vrefp 1,2; vor 5,1,1", 14},
      {"fcmpu cr7,1,2; beq cr7,out; out:", 6}, {"cmpw 3,4; beq out; out:", 1},
      {"add. 3,4,5; beq out; out:", 2},        {"mtctr 3; bctr", 10},
  };
  for (const auto& c : kCases) EXPECT_EQ(Issued(c.text).back(), c.cycles) << c.text;
}

TEST(PpeCore, MultiplyAndDivideAreNotPipelined) {
  EXPECT_EQ(Issued("mullw 3,4,5; mullw 6,7,8"), (At{0, 9}));
  EXPECT_EQ(Issued("fdiv 3,4,5; fdiv 6,7,8"), (At{0, 74}));
  EXPECT_EQ(Issued("fdiv 3,4,5; add 6,7,8; add 9,10,11"), (At{0, 1, 2}));  // only its unit
}

TEST(PpeCore, ALoadThatHitsAStoreWaitsForIt) {
  EXPECT_EQ(Issued("stfs 1,8(1); lwz 3,8(1)").back(), 40);
  EXPECT_EQ(Issued("stfs 1,8(1); lwz 3,12(1)").back(), 1);  // beside it
  EXPECT_EQ(Issued("stvx 1,3,4; lwzx 3,3,4").back(), 40);
  EXPECT_EQ(Issued("std 5,8(1); lwz 3,12(1)").back(), 40);            // in it
  EXPECT_EQ(Issued("stw 5,8(1); addi 1,1,8; lwz 3,8(1)").back(), 5);  // elsewhere by now
  EXPECT_EQ(Issued("stwu 5,8(4); lwz 3,0(4)").back(), 40);            // the new base is its address
  std::string late = "stw 5,8(1)";
  for (int i = 0; i < 50; ++i) late += "; add 6,6,6";
  const At cycles = Issued(late + "; lwz 3,8(1)");
  EXPECT_EQ(cycles.back(), cycles[cycles.size() - 2]);  // long out
  const IssueTotals totals = TimeOnPpe("stfs 1,8(1); lwz 3,8(1)").totals;
  EXPECT_EQ(totals.stall_cycles[uint32_t(StallCause::kLoadHitStore)], 39u);
}

TEST(PpeCore, WithTwoThreadsEveryOtherCycleIsItsOwn) {
  EXPECT_EQ(Issued("add 3,4,5; add 6,7,8; lwz 9,0(10); lwz 3,0(9)", {}, {.smt = true}),
            (At{0, 2, 2, 8}));
}

// ---- two threads -----------------------------------------------------------------------------

PpePairTiming TimePair(const std::string& first, const std::string& second,
                       const PpeParameters& ppe = {}) {
  const Listing a = ReadListing(first, "a.s", PpeInstructionSet()).OrThrow();
  const Listing b = ReadListing(second, "b.s", PpeInstructionSet()).OrThrow();
  return TimePpePair({a.program, b.program}, ppe).OrThrow();
}

std::string Adds(int count) {
  std::string text = "loop:\n";
  for (int i = 0; i < count; ++i) text += "add " + std::to_string(3 + i) + ",20,21\n";
  return text + "bdnz loop\n";
}

TEST(PpePair, ThreadsThatNeverWaitHaveEveryOtherCycle) {
  const PpePairTiming same = TimePair(Adds(8), Adds(8));
  EXPECT_EQ(same.CyclesPerIteration(0), 16.0);
  EXPECT_EQ(same.CyclesPerIteration(1), 16.0);
  const PpePairTiming unequal = TimePair(Adds(4), Adds(12));
  EXPECT_EQ(unequal.CyclesPerIteration(0), 8.0);
  EXPECT_EQ(unequal.CyclesPerIteration(1), 24.0);
}

// One thread per cycle, even where the two want different units.
TEST(PpePair, TwoThreadsDoNotShareACycle) {
  std::string loads = "loop:\n";
  for (int i = 0; i < 8; ++i) loads += "lwz " + std::to_string(3 + i) + ",0(20)\n";
  const PpePairTiming both = TimePair(Adds(8), loads + "bdnz loop\n");
  EXPECT_EQ(both.CyclesPerIteration(0), 16.0);
  EXPECT_EQ(both.CyclesPerIteration(1), 16.0);
}

TEST(PpePair, WhatOneThreadWaitsForIsTheOthers) {
  // A chase dispatches once in six cycles; five are left.
  const PpePairTiming both = TimePair("loop: lwz 3,0(3); bdnz loop", Adds(15));
  EXPECT_NEAR(both.CyclesPerIteration(1), 15 * 6.0 / 5.0, 0.1);
  EXPECT_NEAR(both.CyclesPerIteration(0), 6.0, 0.3);
  // Two that wait all the time do not slow each other down.
  const PpePairTiming chases =
      TimePair("loop: lwz 3,0(3); bdnz loop", "loop: lwz 3,0(3); bdnz loop");
  EXPECT_NEAR(chases.CyclesPerIteration(0), 6.0, 1e-9);
  EXPECT_NEAR(chases.CyclesPerIteration(1), 6.0, 1e-9);
}

TEST(PpePair, WhatIsNotPipelinedHoldsBoth) {
  const std::string divide = "loop: fdiv 1,2,3; bdnz loop";
  const PpePairTiming both = TimePair(divide, divide);
  EXPECT_EQ(both.CyclesPerIteration(0), 2 * 74.0);
  const PpePairTiming adds = TimePair("loop: divw 4,5,6; bdnz loop", Adds(1));
  EXPECT_GT(adds.CyclesPerIteration(1), 2.0);
}

TEST(PpePair, TheOrderOfTheThreadsDoesNotMatter) {
  const std::string loops[] = {Adds(7), "loop: lwz 3,0(3); add 4,3,3; bdnz loop",
                               "loop: vmaddfp 1,1,2,3; lvx 4,5,6; addi 6,6,16; bdnz loop"};
  for (const std::string& a : loops)
    for (const std::string& b : loops) {
      const PpePairTiming ab = TimePair(a, b), ba = TimePair(b, a);
      EXPECT_NEAR(ab.CyclesPerIteration(0), ba.CyclesPerIteration(1),
                  0.02 * ab.CyclesPerIteration(0))
          << a << b;
      EXPECT_NEAR(ab.CyclesPerIteration(1), ba.CyclesPerIteration(0),
                  0.02 * ab.CyclesPerIteration(1))
          << a << b;
    }
}

// A forward branch that is always taken is followed, as with one thread.
TEST(PpePair, WhatABranchSkipsDoesNotRun) {
  const std::string skips = "loop: add 3,4,5; b on; divd 6,7,8; divd 9,10,11; on: bdnz loop";
  EXPECT_LT(TimePair(skips, Adds(4)).CyclesPerIteration(0), 10.0);
}

// Loops without a common divisor come back too late to be waited for: the mean is near enough.
TEST(PpePair, LongLoopsAreTimedByTheirMean) {
  std::string text = "loop:\n";
  for (int i = 0; i < 4099; ++i) text += "add " + std::to_string(3 + i % 15) + ",20,21\n";
  const PpePairTiming both = TimePair(Adds(7), text + "bdnz loop\n");
  EXPECT_NEAR(both.CyclesPerIteration(0), 14.0, 0.1);
  EXPECT_NEAR(both.CyclesPerIteration(1), 2 * 4099.0, 100.0);
  EXPECT_FALSE(both.steady);
  EXPECT_TRUE(TimePair(Adds(7), Adds(5)).steady);
}

TEST(PpePair, WhatIsNoPairOfLoopsIsRefused) {
  const auto why = [](const std::string& text, const PpeParameters& ppe) {
    const Listing a = ReadListing(text, "a.s", PpeInstructionSet()).OrThrow();
    const Listing b = ReadListing(Adds(2), "b.s", PpeInstructionSet()).OrThrow();
    return TimePpePair({a.program, b.program}, ppe).error();
  };
  EXPECT_NE(why("add 3,4,5", {}).find("0 loops"), std::string::npos);
  EXPECT_NE(why("a: b: add 3,4,5; bdnz b; bdnz a; c: bdnz c", {}).find("loops"), std::string::npos);
  EXPECT_NE(why("loop: add 3,4,5; b out; bdnz loop; out:", {}).find("instruction 1"),
            std::string::npos);
  EXPECT_NE(why("loop: add 3,4,5; bl far; bdnz loop", {}).find("instruction 1"), std::string::npos);
  EXPECT_NE(why("loop: add 3,4,5; bdnz loop; bdnz loop", {}).find("second branch"),
            std::string::npos);
  PpeParameters one;
  one.smt_threads = 1;
  EXPECT_NE(why(Adds(2), one).find("1 hardware threads"), std::string::npos);
}

TEST(PpeCore, AllCyclesAreAccountedFor) {
  for (const char* text :
       {"loop: lwz 3,0(3); bdnz loop", "loop: stfs 1,8(1); lwz 3,8(1); mullw 4,3,3; bdnz loop",
        "loop: vmaddfp 1,1,2,3; lvx 4,5,6; addi 6,6,16; fdiv 7,8,9; bdnz loop"})
    for (const bool smt : {false, true}) {
      const IssueTotals totals = TimeOnPpe(text, {}, {smt}).totals;
      EXPECT_EQ(uint64_t(totals.cycles), totals.IssueCycles() + totals.AllStallCycles()) << text;
    }
}

TEST(PpeParameters, SayWhatTheyAreAndHowSure) {
  for (const PlatformNumber& number : DescribeNumbers(PpeParameters{})) {
    EXPECT_FALSE(number.unit.empty()) << number.name;
    EXPECT_FALSE(number.source.empty()) << number.name;
  }
}

}  // namespace
}  // namespace pelt::testing
