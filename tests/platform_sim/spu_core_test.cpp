// The SPU's issue, rule by rule. The measured rows are in timing_rows_test.cpp.
#include "platform_sim/pipeline/spu_core.hpp"

#include <gtest/gtest.h>

#include "platform_sim/pipeline/issue_walk.hpp"
#include "tests/platform_sim/timing_rows.hpp"

namespace pelt::testing {
namespace {

// ---- rules -----------------------------------------------------------------------------------

TEST(SpuCore, PairsEvenFirstInOneFetchGroup) {
  EXPECT_EQ(CyclesOf("ai 3,4,1; lnop; ai 5,6,1; lqd 7,0(8)"), (At{0, 0, 1, 1}));
}

TEST(SpuCore, OddFirstWaits) {
  EXPECT_EQ(CyclesOf("lnop; ai 3,4,1; ai 5,6,1; lnop"), (At{0, 1, 2, 2}));
}

TEST(SpuCore, APairAcrossFetchGroupsPairsOnlyByOrder) {
  const std::string text = "lnop; ai 3,4,1; lqd 5,0(6); ai 7,8,1";
  EXPECT_EQ(CyclesOf(text), (At{0, 1, 2, 3}));
  EXPECT_EQ(CyclesOf(text, {}, {.pair_by_order = true}), (At{0, 1, 1, 2}));
  EXPECT_EQ(TimeOnSpu(text).first_pass[2].unpaired, Unpaired::kAddress);
}

TEST(SpuCore, TheSecondOfAGroupWaitsForItsOperandAndHoldsTheNextGroup) {
  // lqd reads what ai wrote: 2 cycles; the next group waits though it is ready.
  EXPECT_EQ(CyclesOf("ai 3,4,1; lqd 5,0(3); ai 6,6,1; lnop"), (At{0, 2, 3, 3}));
  const IssueSlot slot = TimeOnSpu("ai 3,4,1; lqd 5,0(3)").first_pass[1];
  EXPECT_EQ(slot.unpaired, Unpaired::kNotReady);
  ASSERT_EQ(slot.stall_count, 1);
  EXPECT_EQ(slot.stalls[0].reg, 3u);
  EXPECT_EQ(slot.stalls[0].cycles, 1u);  // the other cycle is its own
}

TEST(SpuCore, LatenciesAreThoseOfTheClasses) {
  const struct {
    const char* text;
    int64_t cycles;
  } kCases[] = {
      {"ai 3,4,1; nop; or 5,3,3", 2},       {"selb 3,4,5,6; nop; or 5,3,3", 2},
      {"fcgt 3,4,5; nop; or 5,3,3", 2},     {"shli 3,4,1; nop; or 5,3,3", 4},
      {"rotmai 3,4,1; nop; or 5,3,3", 4},   {"cntb 3,4; nop; or 5,3,3", 4},
      {"fa 3,4,5; nop; or 5,3,3", 6},       {"mpyi 3,4,5; nop; or 5,3,3", 7},
      {"fi 3,4,5; nop; or 5,3,3", 7},       {"csflt 3,4,155; nop; or 5,3,3", 7},
      {"dfm 3,4,5; nop; or 5,3,3", 13},     {"shufb 3,4,5,6; lnop; or 5,3,3", 4},
      {"frsqest 3,4; lnop; or 5,3,3", 4},   {"lqx 3,4,5; lnop; or 5,3,3", 6},
      {"rdch 3,$ch24; lnop; or 5,3,3", 6},  {"fsmbi 3,15; lnop; or 5,3,3", 4},
      {"rotqbyi 3,4,1; lnop; or 5,3,3", 4}, {"cwd 3,4(1); lnop; or 5,3,3", 4},
      {"orx 3,4; lnop; or 5,3,3", 4},       {"mpya 3,4,5,6; nop; or 5,3,3", 7},
  };
  for (const auto& c : kCases) EXPECT_EQ(CyclesOf(c.text).back(), c.cycles) << c.text;
}

TEST(SpuCore, StoresReadWhatTheyStoreAndAccumulatorsWhatTheyWrite) {
  EXPECT_EQ(CyclesOf("lqd 3,0(4); lnop; stqd 3,0(5)").back(), 6);
  EXPECT_EQ(CyclesOf("fa 3,4,5; lnop; addx 3,6,7").back(), 6);
  EXPECT_EQ(CyclesOf("fa 3,4,5; lnop; iohl 3,1").back(), 6);
  // A plain write of the same register does not wait.
  EXPECT_EQ(CyclesOf("fa 3,4,5; lnop; a 3,6,7").back(), 1);
}

TEST(SpuCore, AnFp6RightAfterAnFp7LosesOneCycle) {
  EXPECT_EQ(CyclesOf("mpy 3,4,5; lnop; fa 6,7,8; lnop"), (At{0, 0, 2, 2}));
  EXPECT_EQ(CyclesOf("mpy 3,4,5; lnop; ai 9,9,1; lnop; fa 6,7,8; lnop"), (At{0, 0, 1, 1, 2, 2}));
  EXPECT_EQ(CyclesOf("mpy 3,4,5; lnop; mpy 6,7,8; lnop"), (At{0, 0, 1, 1}));
  const IssueTotals totals = TimeOnSpu("mpy 3,4,5; lnop; fa 6,7,8").totals;
  EXPECT_EQ(totals.stall_cycles[uint32_t(StallCause::kAfterFp7)], 1u);
}

TEST(SpuCore, DoublePrecisionStopsBothPipesAndNeverPairs) {
  EXPECT_EQ(CyclesOf("dfa 3,4,5; lnop; dfa 6,7,8; lnop"), (At{0, 7, 8, 15}));
  EXPECT_EQ(TimeOnSpu("dfa 3,4,5; lnop").first_pass[1].unpaired, Unpaired::kNever);
}

TEST(SpuCore, AHintHoldsWhenItLeadsFarEnough) {
  const auto iteration = [](int fillers, const char* hint) {
    std::string text = std::string("loop:\n  ") + hint + "\n";
    for (int i = 0; i < fillers; ++i) text += "  lnop\n";
    text += "back: brnz 7,loop\n";
    return CyclesPerIteration(TimeOnSpu(text));
  };
  EXPECT_EQ(iteration(14, "hbrr back,loop"), 16.0);     // hint at 0, branch at 15
  EXPECT_EQ(iteration(20, "hbrr back,loop"), 22.0);     // earlier is no better
  EXPECT_EQ(iteration(13, "hbrr back,loop"), 16.0);     // waits for the hint's target
  EXPECT_EQ(iteration(8, "hbrr back,loop"), 16.0);      // the last that the hint reaches
  EXPECT_EQ(iteration(7, "hbrr back,loop"), 9.0 + 18);  // fetched before the hint was seen
  EXPECT_EQ(iteration(0, "hbrr back,loop"), 2.0 + 18);
  EXPECT_EQ(iteration(14, "lnop"), 16.0 + 18);
  EXPECT_EQ(iteration(14, "hbr back,3"), 16.0);
  EXPECT_EQ(iteration(14, "hbrr back,back"), 16.0 + 18);  // another target
}

TEST(SpuCore, WaitingForAHintsTargetIsAStallOfItsOwn) {
  std::string text = "loop:\n  hbrr back,loop\n";
  for (int i = 0; i < 10; ++i) text += "  lnop\n";
  const IssueChart chart = TimeOnSpu(text + "back: brnz 7,loop\n", {}, {}, 100);
  ExpectAllCyclesAccountedFor(chart.totals);
  // The branch comes 11 cycles after its hint and waits 4, in every iteration.
  EXPECT_EQ(chart.totals.stall_cycles[uint32_t(StallCause::kHintTarget)], 400u);
}

TEST(SpuCore, AHintForABranchThatFallsThroughCostsThePenaltyOnce) {
  std::string text = "loop:\n  hbrr back,loop\n";
  for (int i = 0; i < 15; ++i) text += "  lnop\n";
  text += "back: brnz 7,loop\n  lnop\n";
  // 10 iterations of 17, the last one left against its hint.
  EXPECT_EQ(TimeOnSpu(text, {}, {}, 10).totals.cycles, 170 + 18 + 1);
}

TEST(SpuCore, LeapingOverIterationsChangesNothing) {
  for (const std::string& text :
       {NewtonSteps(), DoublePrecisionFma(), UnhintedBranch(), PublishedListing()}) {
    const IssueChart few = TimeOnSpu(text, {}, {}, 40), more = TimeOnSpu(text, {}, {}, 41),
                     many = TimeOnSpu(text, {}, {}, 1'000'000'040);
    ASSERT_EQ(few.loops.size(), 1u);
    const int64_t iteration = few.loops[0].period_cycles;
    EXPECT_EQ(few.loops[0].period_iterations, 1u);
    EXPECT_EQ(more.totals.cycles - few.totals.cycles, iteration);
    EXPECT_EQ(many.totals.cycles - few.totals.cycles, iteration * 1'000'000'000);
    ExpectAllCyclesAccountedFor(many.totals);
    ExpectAllCyclesAccountedFor(many.loops[0].period);
    ExpectAllCyclesAccountedFor(many.first_pass_totals);
  }
}

TEST(SpuCore, ANewtonStepOneWideWaitsForItself) {
  const Listing listing =
      ReadListing(ReadListingFile("newton.s"), "newton.s", SpuInstructionSet()).OrThrow();
  const TripCount trips[] = {{listing.FindLabel("newton")->index, 64}};
  const auto chart = TimeOnSpu(listing.program, trips, {}, {});
  ASSERT_TRUE(chart) << chart.error();
  // lqd 6, frest 4, fi 7, fnms 6, fma 6, stqd 1, ai and brnz, and the next lqd waits for ai: 32.
  // The hint goes under the rest, but for a cycle of the first iteration, and holds in every
  // iteration but the last, which goes on to bi.
  EXPECT_EQ(CyclesPerIteration(*chart), 32.0);
  EXPECT_EQ(chart->totals.cycles, 1 + 64 * 32 - 1 + 18 + 1);
  EXPECT_EQ(chart->totals.stall_cycles[uint32_t(StallCause::kAfterFp7)], 0u);  // hidden by fi
  EXPECT_EQ(BindingResource(*chart, chart->loops[0].period), "register");
}

TEST(SpuCore, NestedLoopsRunTheirTrips) {
  const std::string text = "outer: lnop\ninner: lnop; lnop\nbrnz 3,inner\nlnop\nbrnz 4,outer";
  const Listing listing = ReadListing(text, "nest.s", SpuInstructionSet()).OrThrow();
  const TripCount trips[] = {{0, 5}, {1, 300}};
  const auto chart = TimeOnSpu(listing.program, trips, {}, {});
  ASSERT_TRUE(chart) << chart.error();
  EXPECT_EQ(chart->totals.instructions, 5u * (1 + 300 * 3 + 2));
  // 299 taken inner branches and 4 outer ones are mispredicted.
  EXPECT_EQ(uint64_t(chart->totals.cycles), chart->totals.instructions + 18 * (5 * 299 + 4));
  EXPECT_EQ(chart->loops.size(), 2u);
}

TEST(SpuCore, CountsLiveRegisters) {
  EXPECT_EQ(TimeOnSpu("a 3,4,5; a 6,3,4; stqd 6,0(5)").live[0].most, 3u);
  // What a loop's next iteration reads is live at its branch.
  EXPECT_EQ(TimeOnSpu("loop: a 3,4,5; ai 7,7,-1; brnz 7,loop").live[0].most, 4u);
  EXPECT_EQ(TimeOnSpu("il 3,1; il 3,2").live[0].most, 1u);
}

TEST(SpuCore, TakesRecordedValuesWithoutText) {
  // 200 values that live until their sum: more than there are registers.
  std::vector<Instruction> program;
  for (uint32_t i = 0; i < 200; ++i) {
    Instruction load;
    load.op_class = uint8_t(SpuClass::kLoad);
    load.writes.Add(i);
    load.location_bytes = 4 * i;
    program.push_back(load);
  }
  for (uint32_t i = 1; i < 200; ++i) {
    Instruction add;
    add.op_class = uint8_t(SpuClass::kFp6);
    add.reads.Add(i - 1);
    add.reads.Add(i);
    add.writes.Add(i);
    add.location_bytes = 4 * (199 + i);
    program.push_back(add);
  }
  const auto chart = TimeOnSpu(program, {}, {}, {});
  ASSERT_TRUE(chart) << chart.error();
  EXPECT_EQ(chart->live[0].most, 200u);
  EXPECT_GT(chart->live[0].most, chart->live[0].limit);
  EXPECT_EQ(BindingResource(*chart, chart->totals), "register");
}

TEST(SpuCore, RefusesProgramsItCannotRun) {
  const auto refusal = [](std::vector<Instruction> program, std::vector<TripCount> trips) {
    return TimeOnSpu(program, trips, {}, {}).error();
  };
  Instruction bad;
  bad.op_class = 200;
  EXPECT_NE(refusal({bad}, {}).find("class"), std::string::npos);
  Instruction wild;
  wild.reads.Add(kNoRegister - 1);
  EXPECT_NE(refusal({wild}, {}).find("register"), std::string::npos);
  Instruction call;
  call.flow = Flow::kCall;
  EXPECT_NE(refusal({call}, {}).find("inlined"), std::string::npos);
  Instruction away;
  away.flow = Flow::kAlways;
  away.target = 7;
  EXPECT_NE(refusal({away}, {}).find("target"), std::string::npos);
  EXPECT_NE(refusal({Instruction{}}, {{0, 5}}).find("trip count"), std::string::npos);
  Instruction loop;
  loop.flow = Flow::kConditional;
  loop.target = 0;
  EXPECT_NE(refusal({loop}, {{0, 0}}).find("trip count"), std::string::npos);
}

TEST(SpuParameters, SayWhatTheyAreAndHowSure) {
  for (const PlatformNumber& number : DescribeNumbers(SpuParameters{})) {
    EXPECT_FALSE(number.name.empty());
    EXPECT_FALSE(number.unit.empty()) << number.name;
    EXPECT_FALSE(number.source.empty()) << number.name;
  }
}

}  // namespace
}  // namespace pelt::testing
