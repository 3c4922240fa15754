// Recorded operations as instructions of the PPE and the Xenon core: vectors in VMX, scalar words
// on the fixed-point unit, and between the two only memory. A vector stored and read back as a
// scalar is a load that hits a store: the issue model sees it by its address.
#include "platform_sim/platforms/ppe.hpp"
#include "platform_sim/pricing/code_writer.hpp"

namespace pelt {
namespace {

constexpr MachineOperation Op(std::string_view name, PpeClass c) { return {name, uint8_t(c)}; }
constexpr MachineOperation Simple(std::string_view name) {
  return Op(name, PpeClass::kVectorSimple);
}
constexpr MachineOperation Permuting(std::string_view name) {
  return Op(name, PpeClass::kVectorPermute);
}
constexpr MachineOperation Complex(std::string_view name) {
  return Op(name, PpeClass::kVectorComplex);
}
constexpr MachineOperation Float(std::string_view name) { return Op(name, PpeClass::kVectorFloat); }
constexpr MachineOperation Estimate(std::string_view name) {
  return Op(name, PpeClass::kVectorEstimate);
}
constexpr MachineOperation Integer(std::string_view name) { return Op(name, PpeClass::kInteger); }
constexpr MachineOperation kLoadVector = Op("lvx", PpeClass::kVectorLoad),
                           kStoreVector = Op("stvx", PpeClass::kVectorStore),
                           kBranchOn = Op("bc", PpeClass::kBranch);

// Where vectors and scalars meet: in front of the temporaries.
constexpr int32_t kExchange = (1 << 20) - 4096;
constexpr int32_t kExchangeBytes = 4096;

enum VmxConstant : uint32_t {
  kSign,
  kMinusZero,  // what a product adds
  kOne,
  kHalf,
  kThreeEighths,
  kSeed,
  kIotas,
  kZero,
  kShiftBy,
  kJoin,
  kJoinMask,
  kIterationCounter,
  kBase,
  kWordConstant,
};
constexpr ValueFile kGeneral = ValueFile::kGeneral, kCondition = ValueFile::kCondition;

class VmxLowering {
 public:
  explicit VmxLowering(const LoweringRules& rules) : rules_(rules) {}

  void Lower(const RecordedOperation& o) {
    using Kind = RecordedKind;
    switch (o.kind) {
      case Kind::kSplat:
        return Bind(o, Splat(o));
      case Kind::kIota:
        return Bind(o, writer_.Emit(Simple("vadduwm"), {Vector(kIotas), Vector(kShiftBy)}));
      case Kind::kLoad:
        return Bind(o, LoadQuad(o.address));
      case Kind::kLoadRecord:
        return Bind(o, LoadRecord(o.address));
      case Kind::kLoadBytes: {
        const uint32_t quad = writer_.EmitLoad(kLoadVector, QuadOf(o.address), kQuadBytes);
        return Bind(o, writer_.Emit(Permuting("vperm"), {quad, Vector(kZero), Vector(kJoin)}));
      }
      case Kind::kLoadSplat:
        return Bind(o, LoadSplat(o));
      case Kind::kStore:
        return StoreQuad(o.address, In(o, 0));
      case Kind::kAdd:
        return Two(o, Float("vaddfp"));
      case Kind::kSubtract:
        return Two(o, Float("vsubfp"));
      case Kind::kMultiply:
        return Bind(o, Product(In(o, 0), In(o, 1)));
      case Kind::kMultiplyAdd:
        return Three(o, Float("vmaddfp"));
      case Kind::kSubtractMultiply:
        return Three(o, Float("vnmsubfp"));
      case Kind::kMultiplySubtract:
        return Bind(o, writer_.Emit(Float("vsubfp"), {Product(In(o, 0), In(o, 1)), In(o, 2)}));
      case Kind::kDivide:
        return Bind(o, Divide(In(o, 0), In(o, 1)));
      case Kind::kReciprocalRoot:
        return Bind(o, rules_.host_operations ? SeededRoot(In(o, 0)) : Root(In(o, 0)));
      case Kind::kReciprocalEstimate:
        return Bind(o, writer_.Emit(Estimate("vrefp"), {In(o, 0)}));
      case Kind::kReciprocalRootEstimate:
        return Bind(o, writer_.Emit(Estimate("vrsqrtefp"), {In(o, 0)}));
      case Kind::kNegate:
        return Bind(o, writer_.Emit(Simple("vxor"), {In(o, 0), Vector(kSign)}));
      case Kind::kMin:
        return Two(o, Simple("vminfp"));
      case Kind::kMax:
        return Two(o, Simple("vmaxfp"));
      case Kind::kLess:
        return Bind(o, writer_.Emit(Simple("vcmpgtfp"), {In(o, 1), In(o, 0)}));
      case Kind::kLessEqual:
        return Bind(o, writer_.Emit(Simple("vcmpgefp"), {In(o, 1), In(o, 0)}));
      case Kind::kEqual:
        return Two(o, Simple("vcmpeqfp"));
      case Kind::kMaskNot:
        return Bind(o, writer_.Emit(Simple("vnor"), {In(o, 0), In(o, 0)}));
      case Kind::kMaskAnd:
      case Kind::kIntAnd:
        return Two(o, Simple("vand"));
      case Kind::kMaskOr:
      case Kind::kIntOr:
        return Two(o, Simple("vor"));
      case Kind::kIntXor:
        return Two(o, Simple("vxor"));
      case Kind::kAny:
      case Kind::kAllSet:
        return writer_.EmitBranch(
            kBranchOn, {writer_.Emit(Simple("vcmpequw."), {In(o, 0), Vector(kZero)}, kCondition)});
      case Kind::kSelect:
        return Bind(o, writer_.Emit(Simple("vsel"), {In(o, 2), In(o, 1), In(o, 0)}));
      case Kind::kIntAdd:
        return Two(o, Simple("vadduwm"));
      case Kind::kIntSubtract:
        return Two(o, Simple("vsubuwm"));
      case Kind::kIntMultiply:
        return Bind(o, MultiplyWords(In(o, 0), In(o, 1)));
      case Kind::kIntShiftLeft:
        return Bind(o, writer_.Emit(Simple("vslw"), {In(o, 0), Vector(kShiftBy)}));
      case Kind::kIntShiftRight:
        return Bind(o, writer_.Emit(Simple("vsrw"), {In(o, 0), Vector(kShiftBy)}));
      case Kind::kIntEqual:
        return Two(o, Simple("vcmpequw"));
      case Kind::kIntLess:
        return Bind(o, writer_.Emit(Simple("vcmpgtsw"), {In(o, 1), In(o, 0)}));
      case Kind::kTruncate:
        return Bind(o, writer_.Emit(Float("vctsxs"), {In(o, 0)}));
      case Kind::kToFloat:
        return Bind(o, writer_.Emit(Float("vcfsx"), {In(o, 0)}));
      case Kind::kTranspose:
        return Transpose(o);
      case Kind::kSplatInFours:
        return Bind(o, writer_.Emit(Permuting("vspltw"), {In(o, 0)}));
      case Kind::kExtract:
        return Extract(o);
      case Kind::kWordLoad:
        return Bind(o, LoadWord(o));
      case Kind::kWordStore:
        return StoreWord(o);
      case Kind::kWordAdd:
        return Words(o, "add");
      case Kind::kWordSubtract:
        return Words(o, "subf");
      case Kind::kWordAnd:
        return Words(o, "and");
      case Kind::kWordOr:
        return Words(o, "or");
      case Kind::kWordShiftLeft:
        return Words(o, "slwi");
      case Kind::kWordShiftRight:
        return Words(o, "srwi");
      case Kind::kWordDiffers:
        return Differs(o);
      case Kind::kCount:
        return;
    }
  }

  // Branches of a loop are foretold by the machine; there is nothing to hint.
  void EndIterations(uint32_t iterations) {
    for (uint32_t t = 0; t < iterations; ++t) {
      const uint32_t counter =
          writer_.Emit(Integer("addi"), {writer_.Constant(kIterationCounter, kGeneral)}, kGeneral);
      writer_.EmitBranch(kBranchOn,
                         {writer_.Emit(Op("cmpwi", PpeClass::kCompare), {counter}, kCondition)});
    }
  }

  LoweredCode Take() { return writer_.Take(); }

 private:
  uint32_t Vector(VmxConstant name) { return writer_.Constant(name); }
  uint32_t In(const RecordedOperation& o, uint32_t operand) {
    return writer_.Of(o.operand[operand]);
  }
  uint32_t InWord(const RecordedOperation& o, uint32_t operand) {
    const uint32_t recorded = o.operand[operand];
    return recorded == kNoValue ? writer_.Constant(kWordConstant, kGeneral)
                                : writer_.Of(recorded, kGeneral);
  }
  void Bind(const RecordedOperation& o, uint32_t value) { writer_.Bind(o.result, value); }
  void Two(const RecordedOperation& o, MachineOperation operation) {
    Bind(o, writer_.Emit(operation, {In(o, 0), In(o, 1)}));
  }
  void Three(const RecordedOperation& o, MachineOperation operation) {
    Bind(o, writer_.Emit(operation, {In(o, 0), In(o, 1), In(o, 2)}));
  }
  uint32_t Product(uint32_t a, uint32_t b) {
    return writer_.Emit(Float("vmaddfp"), {a, b, Vector(kMinusZero)});
  }

  uint32_t Splat(const RecordedOperation& o) {
    const auto value = int32_t(o.bits);
    if (value >= -16 && value < 16) return writer_.Emit(Permuting("vspltisw"), {});
    const uint32_t word = writer_.EmitLoad(kLoadVector, QuadOf(o.address), kQuadBytes);
    return writer_.Emit(Permuting("vspltw"), {word});
  }

  uint32_t LoadQuad(int32_t address) {
    const uint32_t quad = writer_.EmitLoad(kLoadVector, QuadOf(address), kQuadBytes);
    if (IsAligned(address)) return quad;
    const uint32_t next =
        writer_.EmitLoad(kLoadVector, QuadOf(address) + int32_t(kQuadBytes), kQuadBytes);
    return writer_.Emit(Permuting("vperm"), {quad, next, Vector(kJoin)});
  }

  // An indexed word is turned to the front first.
  uint32_t LoadSplat(const RecordedOperation& o) {
    const int32_t quad = QuadOf(o.address);
    if (o.operand_count == 0)
      return writer_.Emit(Permuting("vspltw"), {writer_.EmitLoad(kLoadVector, quad, kQuadBytes)});
    const uint32_t offset = Offset(o, 0);
    const uint32_t turn = writer_.EmitLoad(Op("lvsl", PpeClass::kVectorLoad), 0, 0, {offset});
    const uint32_t word = writer_.EmitLoad(kLoadVector, quad, kQuadBytes, {offset});
    return writer_.Emit(Permuting("vspltw"),
                        {writer_.Emit(Permuting("vperm"), {word, word, turn})});
  }

  // Its number is a byte somewhere near; loaded, made an offset, and followed.
  uint32_t LoadRecord(int32_t address) {
    uint32_t offset = 0;
    if (const uint32_t* known = lookups_.Find(address)) {
      offset = *known;
    } else {
      const uint32_t index = writer_.EmitLoad(Op("lbz", PpeClass::kLoad), 0, 0,
                                              {writer_.Constant(kBase, kGeneral)}, kGeneral);
      offset = writer_.Emit(Integer("slwi"), {index}, kGeneral);
      lookups_.Remember(address, offset);
    }
    return writer_.EmitLoad(kLoadVector, QuadOf(address), kQuadBytes, {offset});
  }

  // No unaligned store: what was there is read, merged and written.
  void StoreQuad(int32_t address, uint32_t value) {
    if (IsAligned(address)) return writer_.EmitStore(kStoreVector, address, kQuadBytes, {value});
    const uint32_t turned = writer_.Emit(Permuting("vperm"), {value, value, Vector(kJoin)});
    for (const int32_t quad : {QuadOf(address), QuadOf(address) + int32_t(kQuadBytes)}) {
      const uint32_t before = writer_.EmitLoad(kLoadVector, quad, kQuadBytes);
      const uint32_t merged = writer_.Emit(Simple("vsel"), {before, turned, Vector(kJoinMask)});
      writer_.EmitStore(kStoreVector, quad, kQuadBytes, {merged});
    }
  }

  // vrefp has 12 bits: one Newton step, the product, and what it still lacks.
  uint32_t Divide(uint32_t a, uint32_t b) {
    const uint32_t estimate = writer_.Emit(Estimate("vrefp"), {b});
    const uint32_t error = writer_.Emit(Float("vnmsubfp"), {estimate, b, Vector(kOne)});
    const uint32_t y = writer_.Emit(Float("vmaddfp"), {error, estimate, estimate});
    const uint32_t quotient = Product(a, y);
    const uint32_t rest = writer_.Emit(Float("vnmsubfp"), {quotient, b, a});
    return writer_.Emit(Float("vmaddfp"), {rest, y, quotient});
  }

  uint32_t Root(uint32_t a) {
    const uint32_t y = writer_.Emit(Estimate("vrsqrtefp"), {a});
    const uint32_t error = writer_.Emit(Float("vnmsubfp"), {Product(a, y), y, Vector(kOne)});
    return writer_.Emit(Float("vmaddfp"), {Product(y, Vector(kHalf)), error, y});
  }

  // Rsqrt of core/simd/maths.hpp, operation for operation.
  uint32_t SeededRoot(uint32_t a) {
    const auto plus = [&](uint32_t x, uint32_t y) { return writer_.Emit(Float("vaddfp"), {x, y}); };
    const auto error = [&](uint32_t y) {
      return writer_.Emit(Float("vsubfp"), {Vector(kOne), Product(Product(a, y), y)});
    };
    const uint32_t half_bits = writer_.Emit(Simple("vsrw"), {a, Vector(kShiftBy)});
    uint32_t y = writer_.Emit(Simple("vsubuwm"), {Vector(kSeed), half_bits});
    const uint32_t e = error(y);
    const uint32_t step = plus(Vector(kHalf), Product(Vector(kThreeEighths), e));
    y = plus(y, Product(Product(y, e), step));
    // One at a time: the order of arguments is the compiler's.
    const uint32_t half = Product(y, Vector(kHalf)), rest = error(y);
    return plus(y, Product(half, rest));
  }

  // 16 bits at a time: cross products, shifted, and the low one.
  uint32_t MultiplyWords(uint32_t a, uint32_t b) {
    const uint32_t turned = writer_.Emit(Simple("vrlw"), {b, Vector(kShiftBy)});
    const uint32_t low = writer_.Emit(Complex("vmulouh"), {a, b});
    const uint32_t cross = writer_.Emit(Complex("vmsumuhm"), {a, turned, Vector(kZero)});
    const uint32_t high = writer_.Emit(Simple("vslw"), {cross, Vector(kShiftBy)});
    return writer_.Emit(Simple("vadduwm"), {high, low});
  }

  void Transpose(const RecordedOperation& o) {
    const uint32_t a = In(o, 0), b = In(o, 1), c = In(o, 2), d = In(o, 3);
    const auto high = [&](uint32_t x, uint32_t y) {
      return writer_.Emit(Permuting("vmrghw"), {x, y});
    };
    const auto low = [&](uint32_t x, uint32_t y) {
      return writer_.Emit(Permuting("vmrglw"), {x, y});
    };
    const uint32_t ac = high(a, c), ac_low = low(a, c), bd = high(b, d), bd_low = low(b, d);
    const uint32_t out[4] = {high(ac, bd), low(ac, bd), high(ac_low, bd_low), low(ac_low, bd_low)};
    for (uint32_t r = 0; r < 4; ++r) writer_.Bind(o.result + r, out[r]);
  }

  // Lanes of one vector are read from one store of it.
  void Extract(const RecordedOperation& o) {
    const auto [at, is_new] = exchanged_.try_emplace(o.operand[0], 0);
    if (is_new) {
      at->second = kExchange + next_exchange_;
      next_exchange_ = (next_exchange_ + int32_t(kQuadBytes)) % kExchangeBytes;
      writer_.EmitStore(kStoreVector, at->second, kQuadBytes, {In(o, 0)});
    }
    writer_.EmitLoad(Op("lwz", PpeClass::kLoad), at->second + 4 * int32_t(o.bits), 4, {}, kGeneral);
  }

  uint32_t Offset(const RecordedOperation& o, uint32_t operand) {
    const uint32_t index = InWord(o, operand);
    const auto [at, is_new] = offsets_.try_emplace({index, o.size_bytes}, 0);
    if (is_new) at->second = writer_.Emit(Integer("slwi"), {index}, kGeneral);
    return at->second;
  }
  uint32_t LoadWord(const RecordedOperation& o) {
    const bool wide = o.size_bytes == 8;
    if (o.operand_count == 0)
      return writer_.EmitLoad(Op(wide ? "ld" : "lwz", PpeClass::kLoad), o.address, o.size_bytes, {},
                              kGeneral);
    return writer_.EmitLoad(Op(wide ? "ldx" : "lwzx", PpeClass::kLoad), o.address, o.size_bytes,
                            {Offset(o, 0)}, kGeneral);
  }
  void StoreWord(const RecordedOperation& o) {
    const bool wide = o.size_bytes == 8;
    const uint32_t value = InWord(o, 0);
    if (o.operand_count == 1)
      return writer_.EmitStore(Op(wide ? "std" : "stw", PpeClass::kStore), o.address, o.size_bytes,
                               {value});
    writer_.EmitStore(Op(wide ? "stdx" : "stwx", PpeClass::kStore), o.address, o.size_bytes,
                      {value, Offset(o, 1)});
  }

  // A constant operand is in the instruction.
  void Words(const RecordedOperation& o, std::string_view name) {
    const bool immediate = o.operand[0] == kNoValue || o.operand[1] == kNoValue;
    const uint32_t a = InWord(o, o.operand[0] == kNoValue ? 1 : 0);
    Bind(o, immediate ? writer_.Emit(Integer(name), {a}, kGeneral)
                      : writer_.Emit(Integer(name), {a, InWord(o, 1)}, kGeneral));
  }
  // (x ^ y) is not 0, without a branch: addic, subfe.
  void Differs(const RecordedOperation& o) {
    const uint32_t difference =
        writer_.Emit(Integer("xor"), {InWord(o, 0), InWord(o, 1)}, kGeneral);
    const uint32_t borrow = writer_.Emit(Integer("addic"), {difference}, kGeneral);
    Bind(o, writer_.Emit(Integer("subfe"), {borrow, difference}, kGeneral));
  }

  const LoweringRules rules_;
  CodeWriter writer_;
  RecordLookups lookups_;
  std::map<uint32_t, int32_t> exchanged_;  // place of a recorded vector that was stored
  int32_t next_exchange_ = 0;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> offsets_;
};

}  // namespace

LoweredCode LowerToVmx(std::span<const RecordedOperation> operations, uint32_t iterations,
                       const LoweringRules& rules) {
  VmxLowering lowering(rules);
  for (const RecordedOperation& operation : operations) lowering.Lower(operation);
  lowering.EndIterations(iterations);
  return lowering.Take();
}

}  // namespace pelt
