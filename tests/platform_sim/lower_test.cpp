// Lowering: known kernels to known instructions, and every instruction to its class.
#include <set>

#include "platform_sim/pipeline/instruction_set.hpp"
#include "platform_sim/pipeline/issue_walk.hpp"
#include "platform_sim/pipeline/spu_core.hpp"
#include "tests/platform_sim/recording.hpp"
#include "tests/platform_sim/timing_rows.hpp"

namespace pelt::testing {
namespace {

Trace DotProduct() {
  return Record([](Rows& rows) {
    const Vec3<V> a = {V::Load(rows.row[0]), V::Load(rows.row[1]), V::Load(rows.row[2])};
    Dot(a, a).Store(rows.row[3]);
  });
}

TEST(SimplifyTrace, ADotProductIsOneProductAndTwoMultiplyAdds) {
  auto kinds = CountKinds(Simplify(DotProduct()));
  EXPECT_EQ(kinds[Kind::kMultiply], 1u);
  EXPECT_EQ(kinds[Kind::kMultiplyAdd], 2u);
  EXPECT_EQ(kinds[Kind::kAdd], 0u);
}

TEST(SimplifyTrace, AProductOfTwoReadersIsNotFused) {
  auto kinds = CountKinds(Simplify(Record([](Rows& rows) {
    const V product = V::Load(rows.row[0]) * V::Load(rows.row[1]);
    (product + V::Load(rows.row[2])).Store(rows.row[3]);
    product.Store(rows.row[4]);
  })));
  EXPECT_EQ(kinds[Kind::kMultiply], 1u);
  EXPECT_EQ(kinds[Kind::kAdd], 1u);
}

TEST(SimplifyTrace, FusesSubtractionBothWays) {
  auto kinds = CountKinds(Simplify(Record([](Rows& rows) {
    const V a = V::Load(rows.row[0]), b = V::Load(rows.row[1]), c = V::Load(rows.row[2]);
    (c - a * b).Store(rows.row[3]);
    (a * c - b).Store(rows.row[4]);
  })));
  EXPECT_EQ(kinds[Kind::kSubtractMultiply], 1u);
  EXPECT_EQ(kinds[Kind::kMultiplySubtract], 1u);
}

TEST(SimplifyTrace, LoadsOnceUntilItIsWritten) {
  const auto loads = [](bool write_between) {
    return CountKinds(Simplify(Record([&](Rows& rows) {
      const V a = V::Load(rows.row[0]);
      // Eight bytes of it are another's.
      if (write_between) (a + a).Store(rows.row[0] + 2);
      (a * V::Load(rows.row[0])).Store(rows.row[3]);
    })))[Kind::kLoad];
  };
  EXPECT_EQ(loads(false), 1u);
  EXPECT_EQ(loads(true), 2u);
}

TEST(SimplifyTrace, DropsWhatNobodyReadsButKeepsWhatIsReadLater) {
  const Trace trace = Record([](Rows& rows) {
    const V a = V::Load(rows.row[0]);
    [[maybe_unused]] const V unused = a * a * a;
    const V later = a + a;
    a.Store(rows.row[1]);
    later.Store(rows.row[2]);
  });
  EXPECT_EQ(Simplify(trace).size(), 4u);
  // Without the last store the sum is still read behind the end.
  EXPECT_EQ(SimplifyTrace(trace, 0, uint32_t(trace.operations.size()) - 1, {}).size(), 3u);
}

TEST(LowerToSpu, ADotProduct) {
  EXPECT_EQ(Text(LowerToSpu(Simplify(DotProduct()), 0, {})), "lqd lqd lqd fm fma fma stqd");
  const LoweredCode unfused = LowerToSpu(Simplify(DotProduct(), false), 0, {});
  EXPECT_EQ(CountName(unfused, "fm"), 3u);
  EXPECT_EQ(CountName(unfused, "fa"), 2u);
}

TEST(LowerToSpu, ExpandsWhatTheMachineLacks) {
  const auto lower = [](auto work, const LoweringRules& rules = {}) {
    return Text(LowerToSpu(Simplify(Record([&](Rows& rows) {
                             work(V::Load(rows.row[0]), V::Load(rows.row[1])).Store(rows.row[2]);
                           })),
                           0, rules));
  };
  EXPECT_EQ(lower([](V a, V b) { return a / b; }), "lqd lqd frest fi fnms fma fm fnms fma stqd");
  EXPECT_EQ(lower([](V a, V) { return Rsqrt(a); }), "lqd frsqest and fi fm fnms fm fma stqd");
  EXPECT_EQ(lower([](V a, V b) { return Min(a, b); }), "lqd lqd fcgt selb stqd");
  EXPECT_EQ(lower([](V a, V b) { return FromBits(Bits(a) * Bits(b)); }),
            "lqd lqd mpyh mpyh mpyu a a stqd");
  // The exact root: 9 products, 3 sums, 2 differences and the seed's two.
  EXPECT_EQ(lower([](V a, V) { return Rsqrt(a); }, {.host_operations = true}),
            "lqd rotmi sf fm fm fs fm fa fm fm fa fm fm fm fs fm fa stqd");
}

TEST(LowerToSpu, AScalarStoreReadsMergesAndWrites) {
  const auto code =
      LowerToSpu(Simplify(Record([](Rows& rows) {
                   const auto key = LoadWord<V>(rows.word, 1u);
                   const auto bin = key & 255u;
                   StoreWord<V>(rows.word + 4, bin, LoadWord<V>(rows.word + 4, bin) + 1u);
                 })),
                 0, {});
  EXPECT_EQ(Text(code), "lqd rotqbyi andi shli lqx rotqby ai lqx cwx shufb stqx");
  // Quadwords, regardless of the word: stores are ordered behind the loads they overlap.
  for (const Instruction& instruction : code.code.program)
    if (instruction.address.size_bytes) {
      EXPECT_EQ(instruction.address.size_bytes, 16u);
      EXPECT_EQ(instruction.address.displacement_bytes % 16, 0);
    }
}

TEST(LowerToSpu, AnIterationCostsACounterAHintAndABranch) {
  EXPECT_EQ(Text(LowerToSpu({}, 2, {})), "ai hbrr brnz ai hbrr brnz");
}

TEST(LowerToVmx, VectorsMeetScalarsInMemory) {
  const auto code = LowerToVmx(Simplify(Record([](Rows& rows) {
                                 const V a = V::Load(rows.row[0]);
                                 static_cast<void>(a[0]);
                                 static_cast<void>(a[2]);
                               })),
                               0, {});
  ASSERT_EQ(Text(code), "lvx stvx lwz lwz");
  const AddressOperand& store = code.code.program[1].address;
  EXPECT_TRUE(store.is_store);
  EXPECT_EQ(code.code.program[3].address.displacement_bytes, store.displacement_bytes + 8);
  EXPECT_EQ(code.code.file[code.code.program[2].writes.number[0]], ValueFile::kGeneral);
}

TEST(LowerToVmx, ExpandsWhatTheMachineLacks) {
  const auto lower = [](auto work) {
    return Text(LowerToVmx(Simplify(Record([&](Rows& rows) {
                             work(V::Load(rows.row[0]), V::Load(rows.row[1])).Store(rows.row[2]);
                           })),
                           0, {}));
  };
  EXPECT_EQ(lower([](V a, V b) { return a / b; }),
            "lvx lvx vrefp vnmsubfp vmaddfp vmaddfp vnmsubfp vmaddfp stvx");
  EXPECT_EQ(lower([](V a, V) { return Rsqrt(a); }),
            "lvx vrsqrtefp vmaddfp vnmsubfp vmaddfp vmaddfp stvx");
  EXPECT_EQ(lower([](V a, V b) { return a * b; }), "lvx lvx vmaddfp stvx");
}

// One of everything there is.
std::vector<RecordedOperation> OneOfEach() {
  std::vector<RecordedOperation> all;
  uint32_t next = 4;
  for (uint32_t k = 0; k < kRecordedKindCount; ++k)
    for (const uint32_t bytes : {4u, 8u})
      for (const uint32_t operands : {1u, 2u}) {
        RecordedOperation o;
        o.kind = RecordedKind(k);
        const bool is_word = o.kind >= Kind::kWordLoad && o.kind <= Kind::kWordDiffers;
        o.size_bytes = uint8_t(is_word ? bytes : 16);
        o.address = 4;
        o.bits = 3;
        o.operand = {0, 1, 2, 3};
        o.operand_count = uint8_t(is_word ? operands : 4);
        if (o.kind == Kind::kWordLoad) o.operand_count = uint8_t(operands - 1);
        if (is_word && operands == 1) o.operand[1] = kNoValue;
        o.result = next;
        o.result_count = 4;
        next += 4;
        all.push_back(o);
      }
  return all;
}

void ExpectKnownOpcodes(const LoweredCode& lowered, const InstructionSet& set) {
  std::set<std::string_view> unknown;
  for (size_t i = 0; i < lowered.name.size(); ++i) {
    const auto opcode = set.find(lowered.name[i]);
    if (!opcode)
      unknown.insert(lowered.name[i]);
    else
      EXPECT_EQ(opcode->op_class, lowered.code.program[i].op_class) << lowered.name[i];
  }
  for (const std::string_view name : unknown) ADD_FAILURE() << name << " is no instruction";
}

TEST(Lowering, EveryInstructionIsOneOfTheMachineAndOfItsClass) {
  ExpectKnownOpcodes(LowerToSpu(OneOfEach(), 1, {}), SpuInstructionSet());
  ExpectKnownOpcodes(LowerToSpu(OneOfEach(), 1, {.host_operations = true}), SpuInstructionSet());
  ExpectKnownOpcodes(LowerToVmx(OneOfEach(), 1, {}), PpeInstructionSet());
  ExpectKnownOpcodes(LowerToVmx(OneOfEach(), 1, {.host_operations = true}), PpeInstructionSet());
}

TEST(Lowering, IsStraightCode) {
  for (const LoweredCode& lowered :
       {LowerToSpu(OneOfEach(), 3, {}), LowerToVmx(OneOfEach(), 3, {})}) {
    std::string error;
    EXPECT_TRUE(CheckStraightCode(lowered.code, 64, error)) << error;
  }
}

// Row C5's work, recorded: six reciprocals and six reciprocal roots side by side, interleaved as
// the listing has them. Divide and root lower to the listing's steps and what the quotient adds.
TEST(Lowering, RecordedNewtonStepsTakeTheListingsCycles) {
  const Trace trace = Record([](Rows& rows) {
    V x[6];
    for (int i = 0; i < 6; ++i) x[i] = V::Load(rows.row[i]);
    for (int i = 0; i < 6; ++i) Rsqrt(x[i]).Store(rows.row[i] + 4);
  });
  const LoweredCode lowered = LowerToSpu(Simplify(trace), 0, {});
  // Six loads, then six times the seven steps of a root and a store: step by step across the six,
  // as the listing goes.
  std::vector<Instruction> program;
  std::string listing;
  const auto take = [&](size_t i) { program.push_back(lowered.code.program[i]); };
  for (size_t i = 0; i < 6; ++i) take(i);
  for (size_t step = 0; step < 7; ++step)
    for (size_t chain = 0; chain < 6; ++chain) take(6 + 8 * chain + step);
  ASSERT_EQ(lowered.name[6], "frsqest");
  ASSERT_EQ(lowered.name[13], "stqd");
  ListingText text;
  for (int i = 0; i < 6; ++i) text.Line(fmt::format("lqd $2{0}, {0}($3)", i));
  text.Line("frsqest $50, $20");
  for (int i = 1; i < 6; ++i) text.Line(fmt::format("frsqest $5{0}, $2{0}", i));
  const auto chains = [&](const char* pattern) {
    for (int i = 0; i < 6; ++i) text.Line(fmt::format(fmt::runtime(pattern), i));
  };
  chains("and $6{0}, $2{0}, $11");
  chains("fi $5{0}, $6{0}, $5{0}");
  chains("fm $7{0}, $5{0}, $2{0}");
  chains("fnms $4{0}, $7{0}, $5{0}, $10");
  chains("fm $7{0}, $5{0}, $12");
  chains("fma $8{0}, $7{0}, $4{0}, $5{0}");
  for (size_t i = 0; i < program.size(); ++i) program[i].location_bytes = 4 * i;
  const IssueChart chart = TimeOnSpu(program, {}, {}, SpuParameters{}).OrThrow();
  std::vector<int64_t> cycles;
  for (const IssueSlot& slot : chart.first_pass) cycles.push_back(slot.cycle);
  EXPECT_EQ(cycles, CyclesOf(text.text));
}

}  // namespace
}  // namespace pelt::testing
