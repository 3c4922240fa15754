// Registers in program order: what fits, what spills, and faults planted in finished code.
#include <gtest/gtest.h>

#include "tests/platform_sim/straight_programs.hpp"

namespace pelt::testing {
namespace {

// Makes `count` values of one that is loaded, then reads them one after another.
StraightCode ManyLive(const CoreUnderTest& on, uint32_t count) {
  StraightBuilder b;
  std::vector<uint32_t> values = {b.Load(on.load, 0)};
  values[0] = b.Compute(on.real, {values[0], values[0]});
  while (values.size() < count) values.push_back(b.Compute(on.real, {values[0], values.back()}));
  uint32_t sum = b.Value();
  for (const uint32_t value : values) sum = b.Compute(on.real, {sum, value});
  b.Store(on.store, 0, sum);
  return b.Finish();
}

TEST(Allocation, AsManyValuesAsRegistersDoNotSpill) {
  for (const CoreUnderTest& on : CoresUnderTest()) {
    const uint32_t registers = on.core.Of(ValueFile::kVector).count;
    const StraightCode fits = ManyLive(on, registers - 1);  // and the sum
    const FinishedCode code = InOrder(fits, on.core);
    EXPECT_EQ(code.spill_stores + code.spill_loads, 0u) << on.name;
    EXPECT_EQ(code.most_live_vectors, registers) << on.name;
    EXPECT_TRUE(IsRight(fits, code, on.core)) << on.name;
  }
}

TEST(Allocation, OneMoreSpillsOnceTheOneThatIsReadLast) {
  for (const CoreUnderTest& on : CoresUnderTest()) {
    const uint32_t registers = on.core.Of(ValueFile::kVector).count;
    const StraightCode over = ManyLive(on, registers);
    const FinishedCode code = InOrder(over, on.core);
    EXPECT_EQ(code.spill_stores, 1u) << on.name;
    EXPECT_EQ(code.spill_loads, 1u) << on.name;
    EXPECT_TRUE(IsRight(over, code, on.core)) << on.name;
    // The last load needs room; of those in registers the last but one is read last.
    for (size_t i = 0; i < code.program.size(); ++i) {
      if (code.origin[i] != kSpillStore) continue;
      EXPECT_EQ(code.program[i].reads.number[0], code.program[i - 1].writes.number[0]) << on.name;
    }
  }
}

// A value that is read thrice, with all registers but one taken in between.
template <class Make>
StraightCode ReadThrice(const CoreUnderTest& on, const Make& make) {
  StraightBuilder b;
  const uint32_t kept = make(b);
  for (int iteration = 0; iteration < 3; ++iteration) {
    std::vector<uint32_t> values;
    const uint32_t first = b.Load(on.load, 16);
    values.push_back(b.Compute(on.real, {first, first}));
    while (values.size() < 126)
      values.push_back(b.Compute(on.real, {values.back(), values.back()}));
    for (const uint32_t value : values) b.Store(on.store, 4096, value);
    b.Store(on.store, 8192, kept);
  }
  return b.Finish();
}

TEST(Allocation, ASpilledValueIsStoredOnceHoweverOftenItIsRead) {
  const CoreUnderTest on = SpuUnderTest();
  const StraightCode code = ReadThrice(on, [&](StraightBuilder& b) {
    const uint32_t loaded = b.Load(on.load, 0);
    const uint32_t step = b.Compute(on.real, {loaded, loaded});
    return b.Compute(on.real, {step, loaded});
  });
  const FinishedCode finished = InOrder(code, on.core);
  EXPECT_TRUE(IsRight(code, finished, on.core));
  EXPECT_EQ(finished.spill_stores, 1u);
  EXPECT_EQ(finished.spill_loads, 3u);
  EXPECT_EQ(finished.made_again, 0u);
}

TEST(Allocation, WhatIsCheaplyMadeIsMadeAgainInsteadOfSpilled) {
  const CoreUnderTest on = SpuUnderTest();
  const auto finish = [&](auto&& make) {
    const StraightCode code = ReadThrice(on, make);
    const FinishedCode finished = InOrder(code, on.core);
    EXPECT_TRUE(IsRight(code, finished, on.core));
    return finished;
  };
  const FinishedCode loaded = finish([&](StraightBuilder& b) { return b.Load(on.load, 0); });
  EXPECT_EQ(loaded.spill_stores + loaded.spill_loads, 0u);
  EXPECT_EQ(loaded.made_again, 3u);
  const FinishedCode spread = finish([&](StraightBuilder& b) {
    const uint32_t word = b.Load(on.load, 0);
    return b.Compute(on.permute, {word, word});
  });
  EXPECT_EQ(spread.spill_stores + spread.spill_loads, 0u);
  EXPECT_EQ(spread.made_again, 6u);
  // Its bytes are written while it waits: it has to be kept.
  const FinishedCode written = finish([&](StraightBuilder& b) { return b.Load(on.load, 4104); });
  EXPECT_EQ(written.spill_stores, 1u);
  EXPECT_EQ(written.made_again, 0u);
}

TEST(Allocation, ValuesThatComeInBeyondTheRegistersComeInMemory) {
  const CoreUnderTest on = PpeUnderTest();
  StraightBuilder b;
  std::vector<uint32_t> values;
  for (int v = 0; v < 40; ++v) values.push_back(b.Value());
  for (const uint32_t value : values) b.Store(on.store, int32_t(16 * value), value);
  const StraightCode code = b.Finish();
  const FinishedCode finished = InOrder(code, on.core);
  EXPECT_TRUE(IsRight(code, finished, on.core));
  EXPECT_EQ(finished.spill_stores, 0u);
  EXPECT_EQ(finished.spill_loads, 8u);
}

TEST(Allocation, WhatCannotFitIsRefusedWithItsPlace) {
  CoreUnderTest on = PpeUnderTest();
  StraightBuilder conditions;
  const uint32_t general = conditions.Value(ValueFile::kGeneral);
  std::vector<uint32_t> all;
  for (int c = 0; c < 9; ++c)
    all.push_back(conditions.Compute(on.compare, std::vector{general}, ValueFile::kCondition));
  for (const uint32_t condition : all) conditions.Branch(on.branch, condition);
  EXPECT_EQ(AllocateInOrder(conditions.Finish(), on.core).error(),
            "instruction 8: more values are live than registers, of a kind that the core cannot "
            "store");

  on.core.files[uint32_t(ValueFile::kVector)].count = 2;
  StraightBuilder three;
  three.Compute(on.real, {three.Value(), three.Value(), three.Value()});
  EXPECT_EQ(AllocateInOrder(three.Finish(), on.core).error(),
            "instruction 0: needs more registers than the core has");
}

TEST(Allocation, CodeThatIsNotStraightIsRefused) {
  const CoreUnderTest on = SpuUnderTest();
  StraightBuilder b;
  b.Store(on.store, 0, b.Compute(on.real, {b.Value()}));
  const auto refused = [&](auto&& spoil) {
    StraightCode code = b.Finish();
    spoil(code);
    return AllocateInOrder(code, on.core).error().starts_with("instruction ") &&
           Schedule(code, on.core).error().starts_with("instruction ");
  };
  EXPECT_FALSE(refused([](StraightCode&) {}));
  EXPECT_TRUE(refused([](StraightCode& c) { c.program[0].op_class = 200; }));
  EXPECT_TRUE(refused([](StraightCode& c) { c.program[0].reads.number[0] = 7; }));
  EXPECT_TRUE(refused([](StraightCode& c) { c.program[0].writes.number[0] = 0; }));
  EXPECT_TRUE(refused([](StraightCode& c) { c.program.push_back(c.program[0]); }));
  EXPECT_TRUE(refused([](StraightCode& c) { c.program[0].flow = Flow::kEnd; }));
  EXPECT_TRUE(refused([](StraightCode& c) { c.program[0].target = 0; }));
  EXPECT_TRUE(refused([](StraightCode& c) { c.program[1].address.base = 0; }));
  EXPECT_TRUE(
      refused([](StraightCode& c) { c.program[1].address.displacement_bytes = 0x7FFFFFFF; }));
}

// ---- planted faults ---------------------------------------------------------------------------

class PlantedFaults : public ::testing::Test {
 protected:
  // Spills, stores over loads, pads.
  PlantedFaults() : code_(RandomProgram(on_, 5, {.instructions = 400, .reach = 200})) {
    good_ = Scheduled(code_, on_.core);
    in_order_ = InOrder(code_, on_.core);
    EXPECT_TRUE(IsRight(code_, good_, on_.core));
    EXPECT_TRUE(IsRight(code_, in_order_, on_.core));
    EXPECT_GT(in_order_.spill_loads, 0u);
  }

  std::string FaultOf(const FinishedCode& finished) const {
    std::string error;
    return CheckFinishedCode(code_, finished, on_.core, error) ? "" : error;
  }
  static void Swap(FinishedCode& finished, size_t a, size_t b) {
    std::swap(finished.program[a], finished.program[b]);
    std::swap(finished.program[a].location_bytes, finished.program[b].location_bytes);
    std::swap(finished.origin[a], finished.origin[b]);
  }
  static void Erase(FinishedCode& finished, size_t at) {
    finished.program.erase(finished.program.begin() + ptrdiff_t(at));
    finished.origin.erase(finished.origin.begin() + ptrdiff_t(at));
    for (size_t i = 0; i < finished.program.size(); ++i) finished.program[i].location_bytes = 4 * i;
    for (Instruction& instruction : finished.program)
      if (instruction.target != kNoTarget) instruction.target = uint32_t(finished.program.size());
  }
  static bool HasWord(const std::string& text, std::string_view word) {
    return text.find(word) != std::string::npos;
  }

  const CoreUnderTest on_ = PpeUnderTest();
  const StraightCode code_;
  FinishedCode good_, in_order_;
};

TEST_F(PlantedFaults, SwappedOperandsAreCaught) {
  uint32_t planted = 0;
  for (size_t i = 0; i < good_.program.size(); ++i) {
    auto& reads = good_.program[i].reads;
    if (reads.count < 2 || reads.number[0] == reads.number[1]) continue;
    FinishedCode bad = good_;
    std::swap(bad.program[i].reads.number[0], bad.program[i].reads.number[1]);
    EXPECT_TRUE(HasWord(FaultOf(bad), "operand 0")) << i;
    ++planted;
  }
  EXPECT_GT(planted, 50u);
}

TEST_F(PlantedFaults, AStoreMovedOverALoadOfItsBytesIsCaught) {
  const StraightCode code = RandomProgram(on_, 5, {.instructions = 600, .words = 4});
  const FinishedCode good = InOrder(code, on_.core);
  uint32_t planted = 0;
  for (size_t i = 0; i + 1 < good.program.size(); ++i) {
    // A load and the next store to its bytes, nothing of either's registers between.
    const AddressOperand &a = good.program[i].address, &b = good.program[i + 1].address;
    const bool overlap = a.displacement_bytes < b.displacement_bytes + int32_t(b.size_bytes) &&
                         b.displacement_bytes < a.displacement_bytes + int32_t(a.size_bytes);
    if (!overlap || a.is_store == b.is_store || good.origin[i] >= kPadding ||
        good.origin[i + 1] >= kPadding)
      continue;
    const Instruction& load = good.program[a.is_store ? i + 1 : i];
    const Instruction& store = good.program[a.is_store ? i : i + 1];
    if (load.writes.number[0] == store.reads.number[0]) continue;
    FinishedCode bad = good;
    Swap(bad, i, i + 1);
    std::string error;
    EXPECT_FALSE(CheckFinishedCode(code, bad, on_.core, error)) << i;
    EXPECT_TRUE(HasWord(error, "another store's bytes")) << i << ": " << error;
    ++planted;
  }
  EXPECT_GT(planted, 0u);
}

TEST_F(PlantedFaults, ARegisterReusedTooEarlyIsCaught) {
  uint32_t planted = 0;
  for (size_t i = 0; i < good_.program.size(); i += 7) {
    if (good_.program[i].writes.count == 0 || good_.origin[i] >= kPadding) continue;
    // Instead of into its own register, into one that is read later without being written.
    for (size_t later = i + 1; later < good_.program.size(); ++later) {
      const Instruction& reader = good_.program[later];
      if (reader.reads.count == 0) continue;
      const uint32_t reg = reader.reads.number[0];
      const auto writes = [&](size_t at) {
        const auto& list = good_.program[at].writes;
        return std::find(list.begin(), list.end(), reg) != list.end();
      };
      bool written = false;
      for (size_t at = i; at < later; ++at) written |= writes(at);
      if (written) continue;
      FinishedCode bad = good_;
      bad.program[i].writes.number[0] = reg;
      EXPECT_NE(FaultOf(bad), "") << i;
      ++planted;
      break;
    }
  }
  EXPECT_GT(planted, 10u);
}

TEST_F(PlantedFaults, AMissingReloadAndAMissingSpillAreCaught) {
  for (const uint32_t origin : {kSpillLoad, kSpillStore}) {
    uint32_t planted = 0;
    for (size_t i = 0; i < in_order_.program.size(); ++i) {
      if (in_order_.origin[i] != origin) continue;
      FinishedCode bad = in_order_;
      Erase(bad, i);
      --(origin == kSpillLoad ? bad.spill_loads : bad.spill_stores);
      EXPECT_TRUE(HasWord(FaultOf(bad), origin == kSpillLoad ? "operand" : "holds nothing")) << i;
      ++planted;
    }
    EXPECT_GT(planted, 0u);
  }
}

TEST_F(PlantedFaults, AStoreAheadOfABranchIsCaught) {
  FinishedCode bad = in_order_;
  size_t branch = 0, store = 0;
  for (size_t i = 0; i < bad.program.size() && store == 0; ++i) {
    if (bad.program[i].flow == Flow::kConditional) branch = i;
    if (branch && bad.program[i].address.is_store && bad.origin[i] < kPadding) store = i;
  }
  ASSERT_GT(store, branch);
  for (size_t i = branch; i < store; ++i) Swap(bad, i, i + 1);  // the branch sinks below the store
  EXPECT_TRUE(HasWord(FaultOf(bad), "ahead of a branch"));
}

TEST_F(PlantedFaults, AMissingInstructionAndARegisterOutOfTheFileAreCaught) {
  FinishedCode bad = good_;
  Erase(bad, bad.program.size() - 1);
  EXPECT_NE(FaultOf(bad), "");
  bad = good_;
  for (Instruction& instruction : bad.program)
    if (instruction.writes.count) instruction.writes.number[0] += 128;
  EXPECT_TRUE(HasWord(FaultOf(bad), "is none of those of value"));
  bad = good_;
  bad.program[3].location_bytes += 4;
  EXPECT_TRUE(HasWord(FaultOf(bad), "does not lie behind"));
}

}  // namespace
}  // namespace pelt::testing
