// Recorded operations as SPU instructions. Everything is a 128-bit register; a scalar word sits in
// its first slot, and memory moves in aligned quadwords only.
#include "platform_sim/platforms/spu.hpp"
#include "platform_sim/pricing/code_writer.hpp"

namespace pelt {
namespace {

constexpr MachineOperation Fx2(std::string_view name) { return {name, uint8_t(SpuClass::kFx2)}; }
constexpr MachineOperation Fx3(std::string_view name) { return {name, uint8_t(SpuClass::kFx3)}; }
constexpr MachineOperation Fp6(std::string_view name) { return {name, uint8_t(SpuClass::kFp6)}; }
constexpr MachineOperation Fp7(std::string_view name) { return {name, uint8_t(SpuClass::kFp7)}; }
constexpr MachineOperation Shuffle(std::string_view name) {
  return {name, uint8_t(SpuClass::kShuffle)};
}
constexpr MachineOperation Estimate(std::string_view name) {
  return {name, uint8_t(SpuClass::kEstimate)};
}
constexpr MachineOperation kLoadDisplaced{"lqd", uint8_t(SpuClass::kLoad)},
    kLoadIndexed{"lqx", uint8_t(SpuClass::kLoad)},
    kStoreDisplaced{"stqd", uint8_t(SpuClass::kStore)},
    kStoreIndexed{"stqx", uint8_t(SpuClass::kStore)};

// What constants in registers are for.
enum SpuConstant : uint32_t {
  kSign,
  kNoSign,
  kOne,
  kHalf,
  kThreeEighths,
  kSeed,
  kIotas,
  kMergeWords,              // two words of each of two registers
  kSplatLane,               // and the three behind it
  kWiden = kSplatLane + 4,  // four bytes to words, by place in the quadword: four of them
  kJoin = kWiden + 4,       // two quadwords at an odd address
  kWordConstant,            // of sorting code
  kIndexVector,             // places of records
  kPickIndex,
  kIterationCounter,
  kBase,  // of an array that is indexed
};

class SpuLowering {
 public:
  explicit SpuLowering(const LoweringRules& rules) : rules_(rules) {}

  void Lower(const RecordedOperation& o) {
    using Kind = RecordedKind;
    switch (o.kind) {
      case Kind::kSplat:
        return Bind(o, Splat(o));
      case Kind::kIota:
        return Bind(o, writer_.Emit(Fx2("ai"), {writer_.Constant(kIotas)}));
      case Kind::kLoad:
        return Bind(o, LoadQuad(o.address));
      case Kind::kLoadRecord:
        return Bind(o, LoadRecord(o.address));
      case Kind::kLoadBytes:
        return Bind(o, LoadBytes(o.address));
      case Kind::kLoadSplat:
        return Bind(o, SplatLane(LoadWord(o), 0));
      case Kind::kStore:
        return StoreQuad(o.address, In(o, 0));
      case Kind::kAdd:
        return Two(o, Fp6("fa"));
      case Kind::kSubtract:
        return Two(o, Fp6("fs"));
      case Kind::kMultiply:
        return Two(o, Fp6("fm"));
      case Kind::kMultiplyAdd:
        return Three(o, Fp6("fma"));
      case Kind::kMultiplySubtract:
        return Three(o, Fp6("fms"));
      case Kind::kSubtractMultiply:
        return Three(o, Fp6("fnms"));
      case Kind::kDivide:
        return Bind(o, Divide(In(o, 0), In(o, 1)));
      case Kind::kReciprocalRoot:
        return Bind(o, rules_.host_operations ? SeededRoot(In(o, 0)) : Root(In(o, 0)));
      case Kind::kReciprocalEstimate:
        return Bind(o, Interpolated("frest", In(o, 0)));
      case Kind::kReciprocalRootEstimate:
        return Bind(o, Interpolated("frsqest", In(o, 0)));
      case Kind::kNegate:
        return Bind(o, writer_.Emit(Fx2("xor"), {In(o, 0), writer_.Constant(kSign)}));
      case Kind::kMin:
        return Bind(o, Choose(o, In(o, 0), In(o, 1)));
      case Kind::kMax:
        return Bind(o, Choose(o, In(o, 1), In(o, 0)));
      case Kind::kLess:
        return Bind(o, writer_.Emit(Fx2("fcgt"), {In(o, 1), In(o, 0)}));
      case Kind::kLessEqual: {
        const uint32_t above = writer_.Emit(Fx2("fcgt"), {In(o, 0), In(o, 1)});
        return Bind(o, writer_.Emit(Fx2("nor"), {above, above}));
      }
      case Kind::kEqual:
        return Two(o, Fx2("fceq"));
      case Kind::kMaskNot:
        return Bind(o, writer_.Emit(Fx2("nor"), {In(o, 0), In(o, 0)}));
      case Kind::kMaskAnd:
      case Kind::kIntAnd:
        return Two(o, Fx2("and"));
      case Kind::kMaskOr:
      case Kind::kIntOr:
        return Two(o, Fx2("or"));
      case Kind::kIntXor:
        return Two(o, Fx2("xor"));
      case Kind::kAny:
        return Branch("brnz", writer_.Emit(Shuffle("gb"), {In(o, 0)}));
      case Kind::kAllSet:
        return Branch("brz", writer_.Emit(Fx2("ceqi"), {writer_.Emit(Shuffle("gb"), {In(o, 0)})}));
      case Kind::kSelect:
        return Bind(o, writer_.Emit(Fx2("selb"), {In(o, 2), In(o, 1), In(o, 0)}));
      case Kind::kIntAdd:
        return Two(o, Fx2("a"));
      case Kind::kIntSubtract:
        return Two(o, Fx2("sf"));
      case Kind::kIntMultiply:
        return Bind(o, MultiplyWords(In(o, 0), In(o, 1)));
      case Kind::kIntShiftLeft:
        return Bind(o, writer_.Emit(Fx3("shli"), {In(o, 0)}));
      case Kind::kIntShiftRight:
        return Bind(o, writer_.Emit(Fx3("rotmi"), {In(o, 0)}));
      case Kind::kIntEqual:
        return Two(o, Fx2("ceq"));
      case Kind::kIntLess:
        return Bind(o, writer_.Emit(Fx2("cgt"), {In(o, 1), In(o, 0)}));
      case Kind::kTruncate:
        return Bind(o, writer_.Emit(Fp7("cflts"), {In(o, 0)}));
      case Kind::kToFloat:
        return Bind(o, writer_.Emit(Fp7("csflt"), {In(o, 0)}));
      case Kind::kTranspose:
        return Transpose(o);
      case Kind::kSplatInFours:
        return Bind(o, SplatLane(In(o, 0), o.bits));
      case Kind::kExtract:
        if (o.bits) writer_.Emit(Shuffle("rotqbyi"), {In(o, 0)});
        return;
      case Kind::kWordLoad:
        return Bind(o, LoadWord(o));
      case Kind::kWordStore:
        return StoreWord(o);
      case Kind::kWordAdd:
        return Bind(o, AddWords(o, "a", "ai", "cg", "addx"));
      case Kind::kWordSubtract:
        return Bind(o, AddWords(o, "sf", "sfi", "bg", "sfx"));
      case Kind::kWordAnd:
        return Bind(o, Logic(o, "and", "andi"));
      case Kind::kWordOr:
        return Bind(o, Logic(o, "or", "ori"));
      case Kind::kWordShiftLeft:
        return Bind(o, ShiftWord(o, "shli", "shlqbii", "shlqbyi"));
      case Kind::kWordShiftRight:
        return Bind(o, ShiftWord(o, "rotmi", "rotqmbii", "rotqmbyi"));
      case Kind::kWordDiffers:
        return Bind(o, writer_.Emit(Fx2("ai"), {Logic(o, "ceq", "ceqi")}));
      case Kind::kCount:
        return;
    }
  }

  void EndIterations(uint32_t iterations) {
    for (uint32_t t = 0; t < iterations; ++t) {
      const uint32_t counter = writer_.Emit(Fx2("ai"), {writer_.Constant(kIterationCounter)});
      writer_.EmitPlain({"hbrr", uint8_t(SpuClass::kHint)});
      Branch("brnz", counter);
    }
  }

  LoweredCode Take() { return writer_.Take(); }

 private:
  uint32_t In(const RecordedOperation& o, uint32_t operand) {
    const uint32_t recorded = o.operand[operand];
    return recorded == kNoValue ? writer_.Constant(kWordConstant) : writer_.Of(recorded);
  }
  void Bind(const RecordedOperation& o, uint32_t value) { writer_.Bind(o.result, value); }
  void Two(const RecordedOperation& o, MachineOperation operation) {
    Bind(o, writer_.Emit(operation, {In(o, 0), In(o, 1)}));
  }
  void Three(const RecordedOperation& o, MachineOperation operation) {
    Bind(o, writer_.Emit(operation, {In(o, 0), In(o, 1), In(o, 2)}));
  }
  void Branch(std::string_view name, uint32_t condition) {
    writer_.EmitBranch({name, uint8_t(SpuClass::kBranch)}, {condition});
  }
  uint32_t Permute(uint32_t a, uint32_t b, uint32_t pattern) {
    return writer_.Emit(Shuffle("shufb"), {a, b, writer_.Constant(pattern)});
  }

  uint32_t SplatLane(uint32_t a, uint32_t lane) { return Permute(a, a, kSplatLane + lane); }

  // One immediate makes it, or it is loaded and spread.
  uint32_t Splat(const RecordedOperation& o) {
    const auto value = int32_t(o.bits);
    if (value >= -32768 && value < 32768) return writer_.Emit(Fx2("il"), {});
    if ((o.bits & 0xFFFF) == 0) return writer_.Emit(Fx2("ilhu"), {});
    if (o.bits < 1u << 18) return writer_.Emit(Fx2("ila"), {});
    const uint32_t word = writer_.EmitLoad(kLoadDisplaced, QuadOf(o.address), kQuadBytes);
    return SplatLane(word, 0);
  }

  uint32_t LoadQuad(int32_t address) {
    const uint32_t quad = writer_.EmitLoad(kLoadDisplaced, QuadOf(address), kQuadBytes);
    if (IsAligned(address)) return quad;
    const uint32_t next =
        writer_.EmitLoad(kLoadDisplaced, QuadOf(address) + int32_t(kQuadBytes), kQuadBytes);
    return Permute(quad, next, kJoin);
  }

  // Its number picked out of a vector of them, made an offset, and followed.
  uint32_t LoadRecord(int32_t address) {
    uint32_t offset = 0;
    if (const uint32_t* known = lookups_.Find(address)) {
      offset = *known;
    } else {
      const uint32_t index =
          Permute(writer_.Constant(kIndexVector), writer_.Constant(kIndexVector), kPickIndex);
      offset = writer_.Emit(Fx3("shli"), {index});
      lookups_.Remember(address, offset);
    }
    return writer_.EmitLoad(kLoadIndexed, QuadOf(address), kQuadBytes,
                            {offset, writer_.Constant(kBase)});
  }

  uint32_t LoadBytes(int32_t address) {
    const uint32_t quad = writer_.EmitLoad(kLoadDisplaced, QuadOf(address), kQuadBytes);
    return Permute(quad, quad, kWiden + uint32_t(address - QuadOf(address)) / 4);
  }

  void StoreQuad(int32_t address, uint32_t value) {
    if (IsAligned(address)) return writer_.EmitStore(kStoreDisplaced, address, kQuadBytes, {value});
    for (const int32_t quad : {QuadOf(address), QuadOf(address) + int32_t(kQuadBytes)}) {
      const uint32_t before = writer_.EmitLoad(kLoadDisplaced, quad, kQuadBytes);
      writer_.EmitStore(kStoreDisplaced, quad, kQuadBytes, {Permute(value, before, kJoin)});
    }
  }

  // a < b ? first : second; the operands say which is the lesser.
  uint32_t Choose(const RecordedOperation& o, uint32_t lesser, uint32_t greater) {
    const uint32_t is_less = writer_.Emit(Fx2("fcgt"), {greater, lesser});
    return writer_.Emit(Fx2("selb"), {In(o, 1), In(o, 0), is_less});
  }

  // An estimate is a base and a slope until fi makes it a number.
  uint32_t Interpolated(std::string_view estimate, uint32_t a) {
    return writer_.Emit(Fp7("fi"), {a, writer_.Emit(Estimate(estimate), {a})});
  }

  // Estimate, Newton step, product, and what the product still lacks.
  uint32_t Divide(uint32_t a, uint32_t b) {
    uint32_t y = Interpolated("frest", b);
    const uint32_t error = writer_.Emit(Fp6("fnms"), {y, b, writer_.Constant(kOne)});
    y = writer_.Emit(Fp6("fma"), {error, y, y});
    const uint32_t quotient = writer_.Emit(Fp6("fm"), {a, y});
    const uint32_t rest = writer_.Emit(Fp6("fnms"), {quotient, b, a});
    return writer_.Emit(Fp6("fma"), {rest, y, quotient});
  }

  uint32_t Root(uint32_t a) {
    const uint32_t estimate = writer_.Emit(Estimate("frsqest"), {a});
    const uint32_t magnitude = writer_.Emit(Fx2("and"), {a, writer_.Constant(kNoSign)});
    const uint32_t y = writer_.Emit(Fp7("fi"), {magnitude, estimate});
    const uint32_t ay = writer_.Emit(Fp6("fm"), {y, a});
    const uint32_t error = writer_.Emit(Fp6("fnms"), {ay, y, writer_.Constant(kOne)});
    const uint32_t half = writer_.Emit(Fp6("fm"), {y, writer_.Constant(kHalf)});
    return writer_.Emit(Fp6("fma"), {half, error, y});
  }

  // Rsqrt of core/simd/maths.hpp, operation for operation.
  uint32_t SeededRoot(uint32_t a) {
    const auto times = [&](uint32_t x, uint32_t y) { return writer_.Emit(Fp6("fm"), {x, y}); };
    const auto plus = [&](uint32_t x, uint32_t y) { return writer_.Emit(Fp6("fa"), {x, y}); };
    const auto error = [&](uint32_t y) {
      return writer_.Emit(Fp6("fs"), {writer_.Constant(kOne), times(times(a, y), y)});
    };
    const uint32_t half_bits = writer_.Emit(Fx3("rotmi"), {a});
    uint32_t y = writer_.Emit(Fx2("sf"), {half_bits, writer_.Constant(kSeed)});
    const uint32_t e = error(y);
    const uint32_t step = plus(writer_.Constant(kHalf), times(writer_.Constant(kThreeEighths), e));
    y = plus(y, times(times(y, e), step));
    // One at a time: the order of arguments is the compiler's.
    const uint32_t half = times(y, writer_.Constant(kHalf)), rest = error(y);
    return plus(y, times(half, rest));
  }

  uint32_t MultiplyWords(uint32_t a, uint32_t b) {
    const uint32_t high_a = writer_.Emit(Fp7("mpyh"), {a, b});
    const uint32_t high_b = writer_.Emit(Fp7("mpyh"), {b, a});
    const uint32_t low = writer_.Emit(Fp7("mpyu"), {a, b});
    return writer_.Emit(Fx2("a"), {writer_.Emit(Fx2("a"), {high_a, high_b}), low});
  }

  void Transpose(const RecordedOperation& o) {
    const uint32_t a = In(o, 0), b = In(o, 1), c = In(o, 2), d = In(o, 3);
    const auto merge = [&](uint32_t x, uint32_t y) { return Permute(x, y, kMergeWords); };
    const uint32_t ac = merge(a, c), ac_low = merge(a, c), bd = merge(b, d), bd_low = merge(b, d);
    const uint32_t out[4] = {merge(ac, bd), merge(ac, bd), merge(ac_low, bd_low),
                             merge(ac_low, bd_low)};
    for (uint32_t r = 0; r < 4; ++r) writer_.Bind(o.result + r, out[r]);
  }

  // Byte offset of an indexed word.
  uint32_t Offset(const RecordedOperation& o, uint32_t operand) {
    const uint32_t index = In(o, operand);
    const auto [at, is_new] = offsets_.try_emplace({index, o.size_bytes}, 0);
    if (is_new) at->second = writer_.Emit(Fx3("shli"), {index});
    return at->second;
  }

  uint32_t LoadWord(const RecordedOperation& o) {
    const int32_t quad = QuadOf(o.address);
    if (o.operand_count == 0) {
      const uint32_t loaded = writer_.EmitLoad(kLoadDisplaced, quad, kQuadBytes);
      return IsAligned(o.address) ? loaded : writer_.Emit(Shuffle("rotqbyi"), {loaded});
    }
    const uint32_t offset = Offset(o, 0);
    const uint32_t loaded =
        writer_.EmitLoad(kLoadIndexed, quad, kQuadBytes, {offset, writer_.Constant(kBase)});
    return writer_.Emit(Shuffle("rotqby"), {loaded, offset});
  }

  void StoreWord(const RecordedOperation& o) {
    const int32_t quad = QuadOf(o.address);
    const uint32_t value = In(o, 0);
    const bool wide = o.size_bytes == 8;
    if (o.operand_count == 1) {
      const uint32_t before = writer_.EmitLoad(kLoadDisplaced, quad, kQuadBytes);
      const uint32_t pattern =
          writer_.Emit(Shuffle(wide ? "cdd" : "cwd"), {writer_.Constant(kBase)});
      const uint32_t merged = writer_.Emit(Shuffle("shufb"), {value, before, pattern});
      return writer_.EmitStore(kStoreDisplaced, quad, kQuadBytes, {merged});
    }
    const uint32_t offset = Offset(o, 1), base = writer_.Constant(kBase);
    const uint32_t before = writer_.EmitLoad(kLoadIndexed, quad, kQuadBytes, {offset, base});
    const uint32_t pattern = writer_.Emit(Shuffle(wide ? "cdx" : "cwx"), {offset, base});
    const uint32_t merged = writer_.Emit(Shuffle("shufb"), {value, before, pattern});
    writer_.EmitStore(kStoreIndexed, quad, kQuadBytes, {merged, offset, base});
  }

  bool HasConstant(const RecordedOperation& o) const {
    return o.operand[0] == kNoValue || o.operand[1] == kNoValue;
  }
  uint32_t Logic(const RecordedOperation& o, std::string_view registers,
                 std::string_view immediate) {
    if (!HasConstant(o)) return writer_.Emit(Fx2(registers), {In(o, 0), In(o, 1)});
    return writer_.Emit(Fx2(immediate), {In(o, o.operand[0] == kNoValue ? 1 : 0)});
  }
  // Two words carry from the lower to the upper.
  uint32_t AddWords(const RecordedOperation& o, std::string_view registers,
                    std::string_view immediate, std::string_view carry, std::string_view extended) {
    if (o.size_bytes != 8) return Logic(o, registers, immediate);
    const uint32_t a = In(o, 0), b = In(o, 1);
    const uint32_t carries = writer_.Emit(Fx2(carry), {a, b});
    const uint32_t moved = writer_.Emit(Shuffle("shlqbyi"), {carries});
    return writer_.Emit(Fx2(extended), {a, b, moved});
  }
  uint32_t ShiftWord(const RecordedOperation& o, std::string_view word, std::string_view bits,
                     std::string_view bytes) {
    if (o.size_bytes != 8) return writer_.Emit(Fx3(word), {In(o, 0)});
    return writer_.Emit(Shuffle(bytes), {writer_.Emit(Shuffle(bits), {In(o, 0)})});
  }

  const LoweringRules rules_;
  CodeWriter writer_;
  RecordLookups lookups_;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> offsets_;  // of an index, by word size
};

}  // namespace

LoweredCode LowerToSpu(std::span<const RecordedOperation> operations, uint32_t iterations,
                       const LoweringRules& rules) {
  SpuLowering lowering(rules);
  for (const RecordedOperation& operation : operations) lowering.Lower(operation);
  lowering.EndIterations(iterations);
  return lowering.Take();
}

}  // namespace pelt
