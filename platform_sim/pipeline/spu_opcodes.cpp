// Every instruction of the SPU: the SPU Instruction Set Architecture 1.2 of the first Cell, in the
// assembler's spelling. Class and operands only; what an instruction computes is no matter here.
//
// Not in it: the double-precision compares of the later PowerXCell 8i (dfceq, dfcgt ...), which no
// PlayStation 3 has.
#include "platform_sim/pipeline/instruction_set.hpp"
#include "platform_sim/platforms/spu.hpp"

namespace pelt {
namespace {

constexpr uint8_t Id(SpuClass c) { return uint8_t(c); }

constexpr OpcodeGroup kGroups[] = {
    {Id(SpuClass::kFx2), "ws rs rs",
     "a ah sf sfh cg bg and andc or orc xor nand nor eqv ceq ceqh ceqb cgt cgth cgtb clgt clgth "
     "clgtb fceq fcmeq fcgt fcmgt"},
    {Id(SpuClass::kFx2), "ws rs i",
     "ai ahi sfi sfhi andi andhi andbi ori orhi orbi xori xorhi xorbi ceqi ceqhi ceqbi cgti cgthi "
     "cgtbi clgti clgthi clgtbi"},
    {Id(SpuClass::kFx2), "us rs rs", "addx sfx cgx bgx"},
    {Id(SpuClass::kFx2), "ws rs", "clz xsbh xshw xswd lr not"},
    {Id(SpuClass::kFx2), "ws i", "il ilh ilhu ila"},
    {Id(SpuClass::kFx2), "us i", "iohl"},
    {Id(SpuClass::kFx2), "ws rs rs rs", "selb"},
    {Id(SpuClass::kFx2), "i? rs rs", "heq hgt hlgt"},
    {Id(SpuClass::kFx2), "i? rs i", "heqi hgti hlgti"},
    {Id(SpuClass::kFx3), "ws rs rs", "shlh shl roth rot rothm rotm rotmah rotma"},
    {Id(SpuClass::kFx3), "ws rs i", "shlhi shli rothi roti rothmi rotmi rotmahi rotmai"},
    {Id(SpuClass::kFxb), "ws rs rs", "absdb avgb sumb"},
    {Id(SpuClass::kFxb), "ws rs", "cntb"},
    {Id(SpuClass::kFp6), "ws rs rs", "fa fs fm"},
    {Id(SpuClass::kFp6), "ws rs rs rs", "fma fms fnms"},
    {Id(SpuClass::kFp7), "ws rs rs", "mpy mpyu mpyh mpys mpyhh mpyhhu fi"},
    {Id(SpuClass::kFp7), "ws rs i", "mpyi mpyui csflt cflts cuflt cfltu"},
    {Id(SpuClass::kFp7), "ws rs rs rs", "mpya"},
    {Id(SpuClass::kFp7), "us rs rs", "mpyhha mpyhhau"},
    {Id(SpuClass::kFp7), "ws", "fscrrd"},
    {Id(SpuClass::kFp7), "rs", "fscrwr"},
    {Id(SpuClass::kFpd), "ws rs rs", "dfa dfs dfm"},
    {Id(SpuClass::kFpd), "us rs rs", "dfma dfms dfnms dfnma"},
    {Id(SpuClass::kFpd), "ws rs", "fesd frds"},
    {Id(SpuClass::kShuffle), "ws rs rs rs", "shufb"},
    {Id(SpuClass::kShuffle), "ws rs rs",
     "shlqbi shlqby shlqbybi rotqbi rotqby rotqbybi rotqmbi rotqmby rotqmbybi cbx chx cwx cdx"},
    {Id(SpuClass::kShuffle), "ws rs i", "shlqbii shlqbyi rotqbii rotqbyi rotqmbii rotqmbyi"},
    {Id(SpuClass::kShuffle), "ws rs", "gb gbh gbb fsm fsmh fsmb orx"},
    {Id(SpuClass::kShuffle), "ws i", "fsmbi"},
    {Id(SpuClass::kShuffle), "ws ms", "cbd chd cwd cdd"},
    {Id(SpuClass::kEstimate), "ws rs", "frest frsqest"},
    {Id(SpuClass::kLoad), "ws ms", "lqd"},
    {Id(SpuClass::kLoad), "ws rs rs", "lqx"},
    {Id(SpuClass::kLoad), "ws i", "lqa lqr"},
    {Id(SpuClass::kStore), "rs ms", "stqd"},
    {Id(SpuClass::kStore), "rs rs rs", "stqx"},
    {Id(SpuClass::kStore), "rs i", "stqa stqr"},
    {Id(SpuClass::kBranch), "l", "br bra", Flow::kAlways},
    {Id(SpuClass::kBranch), "rs l", "brz brnz brhz brhnz", Flow::kConditional},
    {Id(SpuClass::kBranch), "ws i", "brsl brasl", Flow::kCall},
    {Id(SpuClass::kBranch), "ws rs", "bisl bisled bisld bisle bisledd bislede", Flow::kCall},
    {Id(SpuClass::kBranch), "rs", "bi bid bie", Flow::kEnd},
    {Id(SpuClass::kBranch), "rs?", "iret iretd irete", Flow::kEnd},
    {Id(SpuClass::kBranch), "rs rs",
     "biz binz bihz bihnz bizd bize binzd binze bihzd bihze bihnzd bihnze", Flow::kConditional},
    {Id(SpuClass::kHint), "h l", "hbra hbrr", Flow::kHint},
    {Id(SpuClass::kHint), "h rs", "hbr", Flow::kHint},
    {Id(SpuClass::kLnop), "", "hbrp"},
    {Id(SpuClass::kChannel), "ws n", "rdch rchcnt"},
    {Id(SpuClass::kChannel), "n rs", "wrch"},
    {Id(SpuClass::kChannel), "ws i", "mfspr"},
    {Id(SpuClass::kChannel), "i rs", "mtspr"},
    {Id(SpuClass::kNop), "i?", "nop"},
    {Id(SpuClass::kLnop), "", "lnop"},
    {Id(SpuClass::kSync), "", "sync syncc dsync"},
    {Id(SpuClass::kSync), "i?", "stop", Flow::kEnd},
    {Id(SpuClass::kSync), "rs rs rs", "stopd", Flow::kEnd},
};

constexpr RegisterFile kFiles[] = {{'s', 0, 128, "$ r", "SPU register"}};

std::span<const Opcode> Opcodes() {
  static const std::vector<Opcode> opcodes = ExpandGroups(kGroups);
  return opcodes;
}

std::optional<Opcode> Find(std::string_view mnemonic) { return FindOpcode(Opcodes(), mnemonic); }

}  // namespace

const InstructionSet& SpuInstructionSet() {
  static constexpr InstructionSet kSet{"SPU", kFiles, "nop", "lnop", Find};
  return kSet;
}

}  // namespace pelt
