// The SPU rows' listings.

#include <string_view>

#include "core/format.hpp"
#include "platform_sim/rows/row_listings.hpp"

namespace pelt {
namespace {

class ListingText {
 public:
  void Line(const std::string& statement) { text += "  " + statement + "\n"; }
  // "{0}" is the chain, from 0; an lnop behind each for the odd pipe.
  void Chains(uint32_t count, fmt::string_view statement) {
    for (uint32_t i = 0; i < count; ++i) {
      Line(Format(fmt::runtime(statement), i));
      Line("lnop");
    }
  }

  std::string text;
};

std::string CountedLoop(const ListingText& body) {
  return ".align 3\nloop:\n" + body.text + "  ai $7, $7, -1\n  brnz $7, loop\n";
}

}  // namespace

std::string SinglePrecisionFma() {
  ListingText body;
  for (int r = 0; r < 64; ++r) body.Chains(6, "fma $2{0}, $2{0}, $10, $11");
  return CountedLoop(body);
}

std::string IntegerMultiplyAdd() {
  ListingText body;
  for (int r = 0; r < 32; ++r) body.Chains(7, "mpya $2{0}, $2{0}, $10, $11");
  return CountedLoop(body);
}

// Five chains of shuffles, each of which reads the next one's result, and four of rotates.
std::string Shuffles() {
  constexpr const char* kOps[] = {
      "shufb $20, $20, $21, $10", "shufb $21, $21, $22, $10", "shufb $22, $22, $23, $10",
      "shufb $23, $23, $24, $10", "shufb $24, $24, $20, $10", "rotqbi $30, $30, $11",
      "rotqbi $31, $31, $11",     "shlqbi $32, $32, $11",     "shlqbi $33, $33, $11"};
  ListingText body;
  for (int r = 0; r < 64; ++r)
    for (const char* op : kOps) {
      body.Line("nop");
      body.Line(op);
    }
  return CountedLoop(body);
}

std::string FmaBesideShuffles() {
  constexpr const char* kOdd[] = {"shufb $30, $30, $31, $12", "shufb $31, $31, $32, $12",
                                  "rotqbi $32, $32, $13",     "rotqbi $33, $33, $13",
                                  "shufb $34, $34, $35, $12", "shlqbi $35, $35, $13"};
  ListingText body;
  for (int r = 0; r < 64; ++r)
    for (int i = 0; i < 6; ++i) {
      body.Line(Format("fma $2{0}, $2{0}, $10, $11", i));
      body.Line(kOdd[i]);
    }
  return CountedLoop(body);
}

std::string NewtonStepsWithEvenNops() {
  std::string text = NewtonSteps();
  constexpr std::string_view kAnd = "  and ", kOddNop = "lnop";
  for (size_t at = text.find(kAnd); at != text.npos; at = text.find(kAnd, at + 1))
    text.replace(text.find(kOddNop, at), kOddNop.size(), "nop");
  return text;
}

std::string NewtonSteps() {
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
  return CountedLoop(body);
}

std::string DoublePrecisionFma() {
  ListingText body;
  for (int r = 0; r < 16; ++r) body.Chains(13, "dfma $1{0:02}, $10, $11");
  return CountedLoop(body);
}

// Twelve instructions, of which the last is taken.
std::string UnhintedBranch() {
  ListingText body;
  for (int i = 0; i < 5; ++i) body.Line("lnop");
  body.Line("ai $7, $7, -1");
  for (int i = 0; i < 5; ++i) body.Line("lnop");
  body.Line("branch: brnz $7, loop");
  return "loop:\n" + body.text;
}

std::string HintedBranch() {
  std::string text = UnhintedBranch();
  return text.insert(text.find('\n') + 1, "  hbrr branch, loop\n");
}

// With the operands that the print leaves out: what ila and lqa load, where brnz goes.
std::string PublishedListing() {
  return "loop:\n"
         "  a 49,8,10; lqx 51,6,9; ila 47,66051; lqx 52,6,11\n"
         "  ai 7,7,-1; fma 50,51,12,52; stqx 50,6,11; lqx 48,8,10\n"
         "  ai 8,8,4; lqa 44,0; lqx 43,6,9; rotqby 46,48,49\n"
         "  shufb 45,46,46,47; fm 42,12,45; fma 41,42,44,43; stqx 41,6,9\n"
         "  ai 6,6,16; brnz 7,loop\n";
}

}  // namespace pelt
