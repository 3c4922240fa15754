// The instructions of the PPE that a compiler emits: 64-bit PowerPC and VMX, with the assembler's
// short forms. Class and operands only.
//
// Not in it: string and multiple loads and stores (microcoded), privileged instructions, and the
// Xenon core's own VMX128 encodings, whose timings are not published.
#include "platform_sim/pipeline/instruction_set.hpp"
#include "platform_sim/platforms/ppe.hpp"

namespace pelt {
namespace {

constexpr uint8_t Id(PpeClass c) { return uint8_t(c); }

constexpr OpcodeGroup kGroups[] = {
    {Id(PpeClass::kInteger), "wg rg rg",
     "add subf sub and or xor nand nor andc orc eqv addc adde subfc subfe slw srw sraw sld srd "
     "srad rotlw"},
    {Id(PpeClass::kInteger), "wg r0 i", "addi addis subi subis"},
    {Id(PpeClass::kInteger), "wg rg i",
     "addic subfic ori oris xori xoris slwi srwi srawi sldi srdi sradi clrldi clrlwi clrrdi rotlwi "
     "rotldi"},
    {Id(PpeClass::kInteger), "wg rg i +w0", "andi. andis."},
    {Id(PpeClass::kInteger), "wg rg",
     "neg not mr extsb extsh extsw cntlzw cntlzd addze addme subfze"},
    {Id(PpeClass::kInteger), "wg i", "li lis"},
    {Id(PpeClass::kInteger), "wg rg i i", "rldicl rldicr rldic extldi extrdi"},
    {Id(PpeClass::kInteger), "wg rg i i i", "rlwinm"},
    {Id(PpeClass::kInteger), "ug rg i i i", "rlwimi"},
    {Id(PpeClass::kInteger), "ug rg i i", "rldimi"},
    {Id(PpeClass::kInteger), "", "nop"},
    {Id(PpeClass::kCompare), "wc? rg rg", "cmpw cmplw cmpd cmpld"},
    {Id(PpeClass::kCompare), "wc? rg i", "cmpwi cmplwi cmpdi cmpldi"},
    {Id(PpeClass::kMultiplyImmediate), "wg rg i", "mulli"},
    {Id(PpeClass::kMultiplyWord), "wg rg rg", "mullw mulhw mulhwu"},
    {Id(PpeClass::kMultiplyDouble), "wg rg rg", "mulld mulhd mulhdu"},
    {Id(PpeClass::kDivideWord), "wg rg rg", "divw divwu"},
    {Id(PpeClass::kDivideDouble), "wg rg rg", "divd divdu"},
    {Id(PpeClass::kLoad), "wg m0", "lbz", Flow::kNext, 1},
    {Id(PpeClass::kLoad), "wg b0 xg", "lbzx", Flow::kNext, 1},
    {Id(PpeClass::kLoadUpdate), "wg Mg", "lbzu", Flow::kNext, 1},
    {Id(PpeClass::kLoadUpdate), "wg Bg xg", "lbzux", Flow::kNext, 1},
    {Id(PpeClass::kStore), "rg m0", "stb", Flow::kNext, 1, true},
    {Id(PpeClass::kStore), "rg b0 xg", "stbx", Flow::kNext, 1, true},
    {Id(PpeClass::kStoreUpdate), "rg Mg", "stbu", Flow::kNext, 1, true},
    {Id(PpeClass::kStoreUpdate), "rg Bg xg", "stbux", Flow::kNext, 1, true},
    {Id(PpeClass::kLoad), "wg m0", "lhz", Flow::kNext, 2},
    {Id(PpeClass::kLoad), "wg b0 xg", "lhzx", Flow::kNext, 2},
    {Id(PpeClass::kLoadUpdate), "wg Mg", "lhzu", Flow::kNext, 2},
    {Id(PpeClass::kLoadUpdate), "wg Bg xg", "lhzux", Flow::kNext, 2},
    {Id(PpeClass::kStore), "rg m0", "sth", Flow::kNext, 2, true},
    {Id(PpeClass::kStore), "rg b0 xg", "sthx", Flow::kNext, 2, true},
    {Id(PpeClass::kStoreUpdate), "rg Mg", "sthu", Flow::kNext, 2, true},
    {Id(PpeClass::kStoreUpdate), "rg Bg xg", "sthux", Flow::kNext, 2, true},
    {Id(PpeClass::kLoad), "wg m0", "lwz", Flow::kNext, 4},
    {Id(PpeClass::kLoad), "wg b0 xg", "lwzx", Flow::kNext, 4},
    {Id(PpeClass::kLoadUpdate), "wg Mg", "lwzu", Flow::kNext, 4},
    {Id(PpeClass::kLoadUpdate), "wg Bg xg", "lwzux", Flow::kNext, 4},
    {Id(PpeClass::kStore), "rg m0", "stw", Flow::kNext, 4, true},
    {Id(PpeClass::kStore), "rg b0 xg", "stwx", Flow::kNext, 4, true},
    {Id(PpeClass::kStoreUpdate), "rg Mg", "stwu", Flow::kNext, 4, true},
    {Id(PpeClass::kStoreUpdate), "rg Bg xg", "stwux", Flow::kNext, 4, true},
    {Id(PpeClass::kLoad), "wg m0", "ld", Flow::kNext, 8},
    {Id(PpeClass::kLoad), "wg b0 xg", "ldx", Flow::kNext, 8},
    {Id(PpeClass::kLoadUpdate), "wg Mg", "ldu", Flow::kNext, 8},
    {Id(PpeClass::kLoadUpdate), "wg Bg xg", "ldux", Flow::kNext, 8},
    {Id(PpeClass::kStore), "rg m0", "std", Flow::kNext, 8, true},
    {Id(PpeClass::kStore), "rg b0 xg", "stdx", Flow::kNext, 8, true},
    {Id(PpeClass::kStoreUpdate), "rg Mg", "stdu", Flow::kNext, 8, true},
    {Id(PpeClass::kStoreUpdate), "rg Bg xg", "stdux", Flow::kNext, 8, true},
    {Id(PpeClass::kLoadExtend), "wg m0", "lha", Flow::kNext, 2},
    {Id(PpeClass::kLoadExtend), "wg b0 xg", "lhax", Flow::kNext, 2},
    {Id(PpeClass::kLoadExtend), "wg Mg", "lhau", Flow::kNext, 2},
    {Id(PpeClass::kLoadExtend), "wg Bg xg", "lhaux", Flow::kNext, 2},
    {Id(PpeClass::kLoadExtend), "wg m0", "lwa", Flow::kNext, 4},
    {Id(PpeClass::kLoadExtend), "wg b0 xg", "lwax", Flow::kNext, 4},
    {Id(PpeClass::kLoadExtend), "wg Bg xg", "lwaux", Flow::kNext, 4},
    {Id(PpeClass::kFloatLoad), "wf m0", "lfs", Flow::kNext, 4},
    {Id(PpeClass::kFloatLoad), "wf b0 xg", "lfsx", Flow::kNext, 4},
    {Id(PpeClass::kFloatLoad), "wf Mg", "lfsu", Flow::kNext, 4},
    {Id(PpeClass::kFloatLoad), "wf Bg xg", "lfsux", Flow::kNext, 4},
    {Id(PpeClass::kFloatLoad), "wf m0", "lfd", Flow::kNext, 8},
    {Id(PpeClass::kFloatLoad), "wf b0 xg", "lfdx", Flow::kNext, 8},
    {Id(PpeClass::kFloatLoad), "wf Mg", "lfdu", Flow::kNext, 8},
    {Id(PpeClass::kFloatLoad), "wf Bg xg", "lfdux", Flow::kNext, 8},
    {Id(PpeClass::kFloatStore), "rf m0", "stfs", Flow::kNext, 4, true},
    {Id(PpeClass::kFloatStore), "rf b0 xg", "stfsx", Flow::kNext, 4, true},
    {Id(PpeClass::kFloatStore), "rf Mg", "stfsu", Flow::kNext, 4, true},
    {Id(PpeClass::kFloatStore), "rf Bg xg", "stfsux", Flow::kNext, 4, true},
    {Id(PpeClass::kFloatStore), "rf m0", "stfd", Flow::kNext, 8, true},
    {Id(PpeClass::kFloatStore), "rf b0 xg", "stfdx", Flow::kNext, 8, true},
    {Id(PpeClass::kFloatStore), "rf Mg", "stfdu", Flow::kNext, 8, true},
    {Id(PpeClass::kFloatStore), "rf Bg xg", "stfdux", Flow::kNext, 8, true},
    {Id(PpeClass::kFloatStore), "rf b0 xg", "stfiwx", Flow::kNext, 4, true},
    {Id(PpeClass::kVectorLoad), "wv b0 xg", "lvx lvxl lvlx lvlxl lvrx lvrxl", Flow::kNext, 16},
    {Id(PpeClass::kVectorLoad), "wv b0 xg", "lvebx", Flow::kNext, 1},
    {Id(PpeClass::kVectorStore), "rv b0 xg", "stvebx", Flow::kNext, 1, true},
    {Id(PpeClass::kVectorLoad), "wv b0 xg", "lvehx", Flow::kNext, 2},
    {Id(PpeClass::kVectorStore), "rv b0 xg", "stvehx", Flow::kNext, 2, true},
    {Id(PpeClass::kVectorLoad), "wv b0 xg", "lvewx", Flow::kNext, 4},
    {Id(PpeClass::kVectorStore), "rv b0 xg", "stvewx", Flow::kNext, 4, true},
    {Id(PpeClass::kVectorStore), "rv b0 xg", "stvx stvxl stvlx stvlxl stvrx stvrxl", Flow::kNext,
     16, true},
    {Id(PpeClass::kVectorLoad), "wv r0 rg", "lvsl lvsr"},
    {Id(PpeClass::kStore), "b0 xg", "dcbt dcbtst dcbz dcbst dcbf"},
    {Id(PpeClass::kFloat), "wf rf rf", "fadd fadds fsub fsubs fmul fmuls"},
    {Id(PpeClass::kFloat), "wf rf rf rf",
     "fmadd fmadds fmsub fmsubs fnmadd fnmadds fnmsub fnmsubs fsel"},
    {Id(PpeClass::kFloat), "wf rf",
     "fmr fneg fabs fnabs frsp fctiw fctiwz fctid fctidz fcfid fres frsqrte"},
    {Id(PpeClass::kFloatCompare), "wc rf rf", "fcmpu fcmpo"},
    {Id(PpeClass::kFloatDivide), "wf rf rf", "fdiv fdivs"},
    {Id(PpeClass::kFloatRoot), "wf rf", "fsqrt fsqrts"},
    {Id(PpeClass::kVectorSimple), "wv rv rv",
     "vaddubm vadduhm vadduwm vaddubs vadduhs vadduws vaddsbs vaddshs vaddsws vaddcuw vsububm "
     "vsubuhm vsubuwm vsububs vsubuhs vsubuws vsubsbs vsubshs vsubsws vsubcuw vand vandc vor vxor "
     "vnor vmaxub vmaxuh vmaxuw vmaxsb vmaxsh vmaxsw vminub vminuh vminuw vminsb vminsh vminsw "
     "vmaxfp vminfp vavgub vavguh vavguw vavgsb vavgsh vavgsw vslb vslh vslw vsrb vsrh vsrw vsrab "
     "vsrah vsraw vrlb vrlh vrlw vcmpequb vcmpequh vcmpequw vcmpgtub vcmpgtuh vcmpgtuw vcmpgtsb "
     "vcmpgtsh vcmpgtsw vcmpeqfp vcmpgefp vcmpgtfp vcmpbfp"},
    {Id(PpeClass::kVectorSimple), "wv rv", "vmr vnot"},
    {Id(PpeClass::kVectorSimple), "wv rv rv rv", "vsel"},
    {Id(PpeClass::kVectorComplex), "wv rv rv",
     "vmuleub vmuleuh vmulesb vmulesh vmuloub vmulouh vmulosb vmulosh vsumsws vsum2sws vsum4sbs "
     "vsum4shs vsum4ubs"},
    {Id(PpeClass::kVectorComplex), "wv rv rv rv",
     "vmladduhm vmhaddshs vmhraddshs vmsumubm vmsummbm vmsumuhm vmsumuhs vmsumshm vmsumshs"},
    {Id(PpeClass::kVectorPermute), "wv rv rv rv", "vperm"},
    {Id(PpeClass::kVectorPermute), "wv rv rv i", "vsldoi"},
    {Id(PpeClass::kVectorPermute), "wv rv i", "vspltb vsplth vspltw"},
    {Id(PpeClass::kVectorPermute), "wv i", "vspltisb vspltish vspltisw"},
    {Id(PpeClass::kVectorPermute), "wv rv rv",
     "vmrghb vmrghh vmrghw vmrglb vmrglh vmrglw vpkuhum vpkuwum vpkuhus vpkuwus vpkshus vpkswus "
     "vpkshss vpkswss vpkpx vsl vsr vslo vsro"},
    {Id(PpeClass::kVectorPermute), "wv rv", "vupkhsb vupkhsh vupklsb vupklsh vupkhpx vupklpx"},
    {Id(PpeClass::kVectorFloat), "wv rv rv", "vaddfp vsubfp"},
    {Id(PpeClass::kVectorFloat), "wv rv rv rv", "vmaddfp vnmsubfp"},
    {Id(PpeClass::kVectorFloat), "wv rv i", "vcfsx vcfux vctsxs vctuxs"},
    {Id(PpeClass::kVectorFloat), "wv rv", "vrfin vrfiz vrfip vrfim"},
    {Id(PpeClass::kVectorEstimate), "wv rv", "vrefp vrsqrtefp vexptefp vlogefp"},
    {Id(PpeClass::kBranch), "l", "b ba", Flow::kAlways},
    {Id(PpeClass::kBranch), "i", "bl bla", Flow::kCall},
    {Id(PpeClass::kBranch), "", "bctrl blrl", Flow::kCall},
    {Id(PpeClass::kBranch), "+rL", "blr", Flow::kEnd},
    {Id(PpeClass::kBranch), "+rT", "bctr", Flow::kEnd},
    {Id(PpeClass::kBranch), "l +uT", "bdnz bdz", Flow::kConditional},
    {Id(PpeClass::kBranch), "rc? l", "beq bne blt bgt ble bge bso bns bnl bng bun bnu",
     Flow::kConditional},
    {Id(PpeClass::kBranch), "i k l", "bc", Flow::kConditional},
    {Id(PpeClass::kBranch), "k l", "bt bf", Flow::kConditional},
    {Id(PpeClass::kMoveToBranch), "rg +wT", "mtctr"},
    {Id(PpeClass::kMoveToBranch), "rg +wL", "mtlr"},
    {Id(PpeClass::kMoveFromBranch), "wg +rT", "mfctr"},
    {Id(PpeClass::kMoveFromBranch), "wg +rL", "mflr"},
    {Id(PpeClass::kMoveFromCr), "wg", "mfcr"},
    {Id(PpeClass::kInteger), "i rg +w0", "mtcrf"},
    {Id(PpeClass::kCrLogical), "i i i", "crand cror crxor crnand crnor creqv crandc crorc"},
    {Id(PpeClass::kSync), "", "sync lwsync isync eieio ptesync"},
    {Id(PpeClass::kSync), "wg r0 rg", "lwarx ldarx"},
    {Id(PpeClass::kSync), "rg r0 rg +w0", "stwcx. stdcx."},
};

constexpr RegisterFile kFiles[] = {{'g', kPpeGeneral, 32, "%r r", "general register"},
                                   {'f', kPpeFloat, 32, "%f f", "FP register"},
                                   {'v', kPpeVector, 128, "%vr %v vr v", "vector register"},
                                   {'c', kPpeCr, 8, "%cr cr", "condition field"}};

std::span<const Opcode> Opcodes() {
  static const std::vector<Opcode> opcodes = ExpandGroups(kGroups);
  return opcodes;
}

// "add." and "vcmpgtfp." also write a condition field; "bdnz+" says how it will go, which the
// model assumes of every loop anyway.
std::optional<Opcode> Find(std::string_view mnemonic) {
  if (mnemonic.size() > 1 && (mnemonic.back() == '+' || mnemonic.back() == '-'))
    mnemonic.remove_suffix(1);
  if (auto opcode = FindOpcode(Opcodes(), mnemonic)) return opcode;
  if (mnemonic.empty() || mnemonic.back() != '.') return std::nullopt;
  auto opcode = FindOpcode(Opcodes(), mnemonic.substr(0, mnemonic.size() - 1));
  if (!opcode) return std::nullopt;
  const bool vector_compare = mnemonic.starts_with("vcmp");
  const PpeClass op_class = PpeClass(opcode->op_class);
  const bool integer = op_class == PpeClass::kInteger || op_class == PpeClass::kMultiplyWord ||
                       op_class == PpeClass::kMultiplyDouble || op_class == PpeClass::kDivideWord ||
                       op_class == PpeClass::kDivideDouble;
  if (!vector_compare && !integer) return std::nullopt;
  opcode->sets_cr = vector_compare ? kPpeCr + 6 : kPpeCr;
  return opcode;
}

}  // namespace

const InstructionSet& PpeInstructionSet() {
  static constexpr InstructionSet kSet{"PPE", kFiles, "nop", "nop", Find};
  return kSet;
}

}  // namespace pelt
