// What the listing reader takes and what it refuses, and how it says so.
#include "platform_sim/pipeline/listing.hpp"

#include <gtest/gtest.h>

#include "platform_sim/platforms/ppe.hpp"
#include "platform_sim/platforms/spu.hpp"

namespace pelt {
namespace {

Listing Spu(std::string_view text) {
  return ReadListing(text, "t.s", SpuInstructionSet()).OrThrow();
}
Listing Ppe(std::string_view text) {
  return ReadListing(text, "t.s", PpeInstructionSet()).OrThrow();
}
std::string Refusal(std::string_view text, const InstructionSet& set = SpuInstructionSet()) {
  const auto listing = ReadListing(text, "t.s", set);
  EXPECT_FALSE(listing) << text;
  return listing.error();
}
std::vector<uint32_t> List(const auto& registers) { return {registers.begin(), registers.end()}; }
using R = std::vector<uint32_t>;

TEST(Listing, RegistersInEverySpelling) {
  for (const char* text : {"fma $1,$2,$3,$4", "fma 1,2,3,4", "fma r1, r2 ,r3,\tr4"}) {
    const Instruction fma = Spu(text).program.at(0);
    EXPECT_EQ(fma.op_class, uint8_t(SpuClass::kFp6));
    EXPECT_EQ(List(fma.writes), R{1});
    EXPECT_EQ(List(fma.reads), (R{2, 3, 4}));
  }
  EXPECT_EQ(List(Spu("ai $sp,$lr,-16").program[0].writes), R{1});
}

TEST(Listing, MemoryOperandsOfEveryForm) {
  const Instruction load = Spu("lqd $4, -16($5)").program[0];
  EXPECT_EQ(List(load.reads), R{5});
  EXPECT_EQ(load.address.base, 5u);
  EXPECT_EQ(load.address.displacement_bytes, -16);
  EXPECT_EQ(List(Spu("lqd $4, ($5)").program[0].reads), R{5});
  EXPECT_EQ(List(Spu("stqx $4,$5,$6").program[0].reads), (R{4, 5, 6}));
  EXPECT_TRUE(List(Spu("stqx $4,$5,$6").program[0].writes).empty());
  EXPECT_TRUE(List(Spu("lqa $4, table+16").program[0].reads).empty());
  EXPECT_EQ(List(Spu("cwd $4, 4($5)").program[0].reads), R{5});
}

TEST(Listing, CommentsAndSeparators) {
  const Listing listing =
      Spu("# one\n"
          "; two\n"
          "  ; three ; nop\n"
          "nop ; lnop   # four; nop\n"
          "nop /* five\n lnop\n */ ; lnop // six\n"
          "lnop ;; seven; nop\r\n");
  EXPECT_EQ(listing.program.size(), 5u);
  EXPECT_EQ(listing.line, (R{4, 4, 5, 7, 8}));
}

TEST(Listing, LabelsAndTargets) {
  const Listing listing =
      Spu(".L1: top: nop\n"
          "1: brnz $3, 1b\n"
          "brnz $3, 1f\n"
          "1: brz $3, top\n"
          "br .+8\n"
          "lnop\n"
          "hbrr 2f, .L1\n"
          "2: br end\n"
          "end:\n");
  EXPECT_EQ(listing.program[1].target, 1u);
  EXPECT_EQ(listing.program[2].target, 3u);
  EXPECT_EQ(listing.program[3].target, 0u);
  EXPECT_EQ(listing.program[4].target, 6u);
  EXPECT_EQ(listing.program[6].hinted, 7u);
  EXPECT_EQ(listing.program[6].target, 0u);
  EXPECT_EQ(listing.program[7].target, 8u);
}

TEST(Listing, DirectivesAreSkippedAndAlignmentIsFilled) {
  const Listing listing =
      Spu("\t.file \"a.c\"\n.text\n.global f\n.type f, @function\nnop\n.align 4\nf: nop\n"
          ".size f, .-f\n");
  ASSERT_EQ(listing.program.size(), 5u);
  EXPECT_EQ(listing.text[1], "lnop");
  EXPECT_EQ(listing.text[2], "nop");
  EXPECT_EQ(listing.text[3], "lnop");
  EXPECT_EQ(listing.program[4].location_bytes, 16u);
  EXPECT_EQ(listing.FindLabel("f")->index, 4u);
}

TEST(Listing, ReadModifyWrite) {
  EXPECT_EQ(List(Spu("dfma 1,2,3").program[0].reads), (R{1, 2, 3}));
  EXPECT_EQ(List(Spu("iohl 1,5").program[0].reads), R{1});
  EXPECT_EQ(List(Spu("mpyhha 1,2,3").program[0].reads), (R{1, 2, 3}));
  EXPECT_EQ(List(Spu("selb 1,2,3,4").program[0].reads), (R{2, 3, 4}));
  EXPECT_EQ(List(Spu("wrch $ch16,$3").program[0].reads), R{3});
  EXPECT_TRUE(List(Spu("hbrr 0f, 0f; 0:").program[0].reads).empty());
}

// Every mnemonic of the architecture that a PlayStation 3's SPU has.
TEST(Listing, KnowsEverySpuOpcode) {
  const char* kMnemonics =
      "lqd lqx lqa lqr stqd stqx stqa stqr cbd cbx chd chx cwd cwx cdd cdx ilh ilhu il ila iohl "
      "fsmbi ah ahi a ai sfh sfhi sf sfi addx cg cgx sfx bg bgx mpy mpyu mpyi mpyui mpya mpyh mpys "
      "mpyhh mpyhha mpyhhu mpyhhau clz cntb fsmb fsmh fsm gbb gbh gb avgb absdb sumb xsbh xshw "
      "xswd and andc andbi andhi andi or orc orbi orhi ori orx xor xorbi xorhi xori nand nor eqv "
      "selb shufb shlh shlhi shl shli shlqbi shlqbii shlqby shlqbyi shlqbybi roth rothi rot roti "
      "rotqby rotqbyi rotqbybi rotqbi rotqbii rothm rothmi rotm rotmi rotqmby rotqmbyi rotqmbybi "
      "rotqmbi rotqmbii rotmah rotmahi rotma rotmai heq heqi hgt hgti hlgt hlgti ceqb ceqbi ceqh "
      "ceqhi ceq ceqi cgtb cgtbi cgth cgthi cgt cgti clgtb clgtbi clgth clgthi clgt clgti br bra "
      "brsl brasl bi iret bisled bisl brnz brz brhnz brhz biz binz bihz bihnz hbr hbra hbrr hbrp "
      "fa dfa fs dfs fm dfm fma dfma fnms dfnms fms dfms dfnma frest frsqest fi csflt cflts cuflt "
      "cfltu frds fesd fceq fcmeq fcgt fcmgt fscrwr fscrrd stop stopd lnop nop sync dsync mfspr "
      "mtspr rdch rchcnt wrch";
  std::string_view rest = kMnemonics;
  uint32_t count = 0;
  while (!rest.empty()) {
    const size_t end = std::min(rest.find(' '), rest.size());
    EXPECT_TRUE(SpuInstructionSet().find(rest.substr(0, end))) << rest.substr(0, end);
    rest.remove_prefix(std::min(end + 1, rest.size()));
    ++count;
  }
  EXPECT_GT(count, 190u);
}

TEST(Listing, PpeOperands) {
  const Instruction load = Ppe("lwzx r3, 0, r5").program[0];
  EXPECT_EQ(load.address.base, kNoRegister);
  EXPECT_EQ(List(load.reads), R{5});
  EXPECT_EQ(List(Ppe("lvx v3,r4,r5").program[0].writes), R{kPpeVector + 3});
  EXPECT_EQ(List(Ppe("lfs f3,8(1)").program[0].writes), R{kPpeFloat + 3});
  EXPECT_EQ(List(Ppe("stwu 5,8(4)").program[0].writes), R{4});
  EXPECT_EQ(List(Ppe("cmpwi 3,0").program[0].writes), R{kPpeCr});
  EXPECT_EQ(List(Ppe("cmpwi cr7,3,0").program[0].writes), R{kPpeCr + 7});
  EXPECT_EQ(List(Ppe("add. 3,4,5").program[0].writes), (R{3, kPpeCr}));
  EXPECT_EQ(List(Ppe("vcmpgtfp. 3,4,5").program[0].writes), (R{kPpeVector + 3, kPpeCr + 6}));
  EXPECT_EQ(List(Ppe("x: bdnz+ x").program[0].reads), R{kPpeCount});
  EXPECT_EQ(List(Ppe("x: bc 12,4*cr7+eq,x").program[0].reads), R{kPpeCr + 7});
  EXPECT_EQ(List(Ppe("x: beq- x").program[0].reads), R{kPpeCr});
  EXPECT_EQ(List(Ppe("addi 3,0,5").program[0].reads), R{});
}

TEST(Listing, RefusesWithPlaceReasonAndExpectation) {
  const struct {
    const char *text, *place, *words;
  } kCases[] = {
      {"nop\nfmaa 1,2,3,4", "t.s:2:", "no SPU opcode"},
      {"fma 1,2,3", "t.s:1:", "3 operands; expected register, register, register, register"},
      {"lnop 1", "t.s:1:", "1 operand; expected none"},
      {"ai 128,1,1", "t.s:1:", "r0 to r127"},
      {"ai $1,$-1,1", "t.s:1:", "'$-1'"},
      {"a $1,$2,99999999999999999999", "t.s:1:", "register"},
      {"a $1,,$2", "t.s:1:", "''"},
      {"ai 1,2,$3", "t.s:1:", "expected an immediate"},
      {"lqd 1,2", "t.s:1:", "16($3)"},
      {"lqd 1,16(200)", "t.s:1:", "r127"},
      {"lqd 1,$2($3)", "t.s:1:", "offset"},
      {"rdch 1,$ch128", "t.s:1:", "channel"},
      {"nop\n\nbrnz 3, nowhere\nhere:", "t.s:3:", "labels: here"},
      {"br 1b", "t.s:1:", "1b"},
      {"br .+4096", "t.s:1:", ".+4096"},
      {"br .+3", "t.s:1:", ".+3"},
      {"a: nop\na: nop", "t.s:2:", "second time"},
      {"nop\n/* open\n", "t.s:2:", "*/"},
      {"", "t.s:1:", "no instruction"},
      {"# nothing", "t.s:1:", "no instruction"},
      {".align 40\nnop", "t.s:1:", "power of two"},
      {".balign 12\nnop", "t.s:1:", "power of two"},
      {".irp x,1\nnop\n.endr", "t.s:1:", "written out"},
      {"lwz 3,0(3)", "t.s:1:", "one of the PPE's"},
      {"ceqi 1,2,3,4\n", "t.s:1:", "4 operands"},
      {"nop\n\x01\xff\x80", "t.s:2:", "no SPU opcode"},
  };
  for (const auto& c : kCases) {
    const std::string error = Refusal(c.text);
    EXPECT_EQ(error.rfind(c.place, 0), 0u) << c.text << ": " << error;
    EXPECT_NE(error.find(c.words), std::string::npos) << c.text << ": " << error;
    EXPECT_EQ(error.find('\n'), std::string::npos);
  }
  EXPECT_NE(Refusal("lvx 3,4", PpeInstructionSet()).find("3,4"), 0u);
  EXPECT_NE(Refusal("shufb 1,2,3,4", PpeInstructionSet()).find("one of the SPU's"),
            std::string::npos);
  EXPECT_NE(Refusal("fadd f32,f1,f2", PpeInstructionSet()).find("f31"), std::string::npos);
  EXPECT_NE(Refusal("beq cr8,1f;1:", PpeInstructionSet()).find("cr7"), std::string::npos);
}

TEST(Listing, EveryCutOfAListingIsReadOrRefused) {
  const std::string text =
      ".align 3\nloop: lqd $4,16($3); fma $5,$4,$6,$5 /* x */\n hbrr back,loop # y\n"
      "back: brnz $7,loop; rdch $3,$ch24; .balign 16\n 1: br 1b; lqa $4,table@l+4\n";
  for (size_t cut = 0; cut <= text.size(); ++cut)
    for (const char garble : {'\0', '(', ')', ',', ';', ':', '$', '.', '\xff'}) {
      std::string changed = text.substr(0, cut) + garble;
      changed += text.substr(std::min(cut + 1, text.size()));
      for (const std::string& each : {text.substr(0, cut), changed})
        if (const auto listing = ReadListing(each, "t.s", SpuInstructionSet()); !listing) {
          EXPECT_EQ(listing.error().rfind("t.s:", 0), 0u) << listing.error();
        }
    }
}

// ---- .rept -------------------------------------------------------------------------------------

TEST(ListingRepeats, AreWrittenOutOnTheLinesTheyStandOn) {
  const Listing listing =
      Spu("loop: .rept 3\n"
          "fa $4,$5,$6\n"
          ".rept 2; lnop; .endr\n"
          "9: .endr\n"
          "brnz $7, loop\n");
  EXPECT_EQ(listing.line, (R{2, 3, 3, 2, 3, 3, 2, 3, 3, 5}));
  EXPECT_EQ(listing.FindLabel("loop")->index, 0u);
  EXPECT_EQ(listing.program.back().target, 0u);
}

TEST(ListingRepeats, GiveTheSameProgramAsWrittenOutByHand) {
  const std::string fma = "fma $20,$20,$10,$11\nlnop\n", tail = "ai $7,$7,-1\nbrnz $7,loop\n";
  std::string by_hand = "loop:\n";
  for (int i = 0; i < 64; ++i) by_hand += fma;
  const Listing written = Spu(by_hand + tail);
  const Listing repeated = Spu("loop:\n.rept 64\n" + fma + ".endr\n" + tail);
  EXPECT_EQ(repeated.text, written.text);
  ASSERT_EQ(repeated.program.size(), written.program.size());
  for (size_t i = 0; i < written.program.size(); ++i)
    EXPECT_EQ(repeated.program[i].location_bytes, written.program[i].location_bytes);
}

TEST(ListingRepeats, NoneLeavesNothingAndNumericLabelsRepeat) {
  EXPECT_EQ(Spu(".rept 0\nlnop\n.rept 5\nnop\n.endr\n.endr\nnop").program.size(), 1u);
  const Listing listing = Spu(".rept 2\n1: nop\nbrnz $3, 1b\n.endr");
  EXPECT_EQ(listing.program[1].target, 0u);
  EXPECT_EQ(listing.program[3].target, 2u);
}

TEST(ListingRepeats, SayWhereTheyAreWrong) {
  EXPECT_EQ(Refusal("nop\n.endr"), "t.s:2: .endr without a .rept before it");
  EXPECT_EQ(Refusal("nop\n.rept 2\nnop\n.rept 3\nnop\n.endr"),
            "t.s:2: .rept without an .endr behind it");
  for (const char* count : {"", "x", "-1", "2000000", "99999999999999999999"}) {
    const std::string error = Refusal(std::string("nop\n.rept ") + count + "\nnop\n.endr");
    EXPECT_TRUE(error.starts_with("t.s:2: .rept")) << error;
    EXPECT_NE(error.find("expected how often, 0 to "), error.npos) << error;
  }
  EXPECT_NE(Refusal(".rept 2\nhere: nop\n.endr").find("t.s:2: label 'here' a second time"),
            std::string::npos);
  EXPECT_TRUE(Refusal(".irp x,1,2\nnop\n.endr").starts_with("t.s:"));
}

// Counts that multiply beyond all memory, and nesting that would be beyond all stack.
TEST(ListingRepeats, AreBounded) {
  std::string bomb = "nop\n";
  for (int i = 0; i < 12; ++i) bomb = ".rept 1000\n" + bomb + ".endr\n";
  EXPECT_NE(Refusal(bomb).find("written out"), std::string::npos);
  std::string deep;
  for (int i = 0; i < 100'000; ++i) deep += ".rept 1\n";
  deep += "nop\n";
  for (int i = 0; i < 100'000; ++i) deep += ".endr\n";
  EXPECT_EQ(Spu(deep).program.size(), 1u);
  EXPECT_NE(Refusal(".rept 500000\nnop\n.endr").find("instructions"), std::string::npos);
}

}  // namespace
}  // namespace pelt
