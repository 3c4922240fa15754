#include "platform_sim/rows/row_listings.hpp"

#include <string_view>
#include <vector>

#include "core/format.hpp"

namespace pelt {

// ---- SPU ----------------------------------------------------------------------------------------

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

namespace {

// C13: two blocks of 8 x 16 of C alternately, 32 registers each, all 64 steps of k written out; what a
// multiply-add needs is loaded and spread on the odd pipe under the multiply-adds of the step
// before, and one block is stored and loaded under the other's.
class MatrixSchedule {
 public:
  // Empty when the pipes have no room for it: then the placing below is wrong.
  std::string Text() {
    At(kFmas - 40) = "hbrr back, loop";
    for (int step = 0; step < kBlocks * kSteps; ++step) PlaceStep(step);
    for (int acc = 0; acc < kBlocks * kStep; ++acc) PlaceBlockMove(acc);
    if (!fits_) return {};
    std::string text = ".align 3\nloop:\n";
    for (int i = 0; i < kFmas; ++i) {
      const int step = i / kStep, row = i % kStep / kColumns, column = i % kColumns;
      text += Format("fnms ${0}, ${1}, ${2}, ${0}\n", Sum(i / (kStep * kSteps), i % kStep),
                     Spread(step, row), RowOfB(step, column));
      text += (At(i).empty() ? "lnop" : At(i)) + "\n";
    }
    return text +
           "ai $7, $7, -1; lnop\nai $4, $4, 64; lnop\nai $6, $6, 64; lnop\nai $5, $5, 64\n"
           "back: brnz $7, loop\n";
  }

  static constexpr int kSteps = 64, kRows = 8, kColumns = 4, kBlocks = 2;
  static constexpr int kStep = kRows * kColumns, kFmas = kBlocks * kSteps * kStep;

 private:
  static int Sum(int block, int acc) { return 8 + block * kStep + acc; }
  static int RowOfB(int step, int column) { return 72 + step % 2 * kColumns + column; }
  static int Spread(int step, int row) { return 80 + step % 2 * kRows + row; }
  static int QuadOfA(int step, int row) { return 96 + step / 4 % 2 * kRows + row; }

  std::string& At(int slot) { return odd_[size_t((slot + kFmas) % kFmas)]; }

  // In the first free slot of the odd pipe; slots are counted in FMAs, around into the next
  // iteration.
  void Place(int earliest, int latest, const std::string& statement) {
    for (int slot = earliest; slot <= latest; ++slot)
      if (At(slot).empty()) {
        At(slot) = statement;
        return;
      }
    fits_ = false;
  }

  void PlaceStep(int step) {
    const int now = kStep * step, before = now - kStep;
    for (int column = 0; column < kColumns; ++column)
      Place(before + column, now + column - 6,
            Format("lqd ${}, {}($6)", RowOfB(step, column), 64 * (step % kSteps) + 16 * column));
    for (int row = 0; row < kRows; ++row)
      Place(before + 4 * row, now + 4 * row - 4,
            Format("shufb ${0}, ${1}, ${1}, ${2}", Spread(step, row), QuadOfA(step, row),
                   112 + step % 4));
    if (step % 4 != 0) return;
    for (int row = 0; row < kRows; ++row)
      Place(now - 4 * kStep + 4 * row, before - 6,
            Format("lqd ${}, {}($3)", QuadOfA(step, row), 256 * row + 4 * (step % kSteps)));
  }

  void PlaceBlockMove(int acc) {
    const int block = acc / kStep, i = acc % kStep, half = kSteps * kStep;
    const int last_fma = (block + 1) * half - kStep + i;
    Place(last_fma + 6, last_fma + half / 2, Format("stqd ${}, {}($4)", Sum(block, i), 16 * i));
    Place(last_fma + half / 2 + 1, last_fma + half - kStep,
          Format("lqd ${}, {}($5)", Sum(block, i), 16 * i));
  }

  bool fits_ = true;
  std::vector<std::string> odd_ = std::vector<std::string>(kFmas);
};

static_assert(MatrixSchedule::kFmas == kMatrixMultiplyFmas);

}  // namespace

std::string MatrixMultiply() { return MatrixSchedule().Text(); }

// ---- PPE and Xenon ------------------------------------------------------------------------------
//
// The PPE's are cellmark's: its sources say which instructions run, its tuning page shows the loops
// as its compiler left them (the chases whole, the streams in words: addresses are extended once
// per iteration, offsets stand in registers, eight loads, then eight adds on four sums). What it
// does not show is the order of the few instructions around the loads.

namespace {

constexpr int kVectors = 8, kSums = 4;

std::string ReadALine() {
  std::string text;
  for (int i = 0; i < kVectors; ++i) text += Format(" lvx v{}, r{}, r11\n", i, 12 + i);
  text += " addi r9, r9, 128\n";
  for (int i = 0; i < kVectors; ++i)
    text += Format(" vaddfp v{0}, v{0}, v{1}\n", 16 + i % kSums, i);
  return text + " bdnz loop\n";
}

// Eight rounds of eight chains.
std::string EightChains(fmt::string_view statement) {
  std::string text = "loop:\n";
  for (int round = 0; round < 8; ++round)
    for (int i = 0; i < 8; ++i) text += Format(fmt::runtime(statement), i);
  return text + " bdnz loop\n";
}

}  // namespace

std::string PointerChase() {
  return "loop: clrldi r11, r9, 32\n lwz r10, 0(r11)\n lwz r9, 0(r10)\n lwz r6, 0(r9)\n"
         " lwz r5, 0(r6)\n lwz r4, 0(r5)\n lwz r12, 0(r4)\n lwz r11, 0(r12)\n"
         " lwz r9, 0(r11)\n bdnz loop\n";
}

std::string IndexChase() {
  return "loop: rlwinm r9, r9, 2, 0, 29\n extsw r9, r9\n add r9, r9, r10\n"
         " lwz r9, -20480(r9)\n bdnz loop\n";
}

std::string VectorStream() { return "loop: clrldi r11, r9, 32\n" + ReadALine(); }

std::string PrefetchedVectorStream() {
  return "loop: cmplw cr7, r9, r8\n bge cr7, read\n addi r10, r9, 512\n clrldi r10, r10, 32\n"
         " dcbt 0, r10\nread: clrldi r11, r9, 32\n" +
         ReadALine();
}

std::string VectorFmaChains() {
  constexpr int kChains = 6, kRounds = 8;
  std::string text = "loop:\n";
  for (int r = 0; r < kRounds; ++r)
    for (int i = 1; i <= kChains; ++i) text += Format(" vmaddfp v{0}, v{0}, v10, v11\n", i);
  return text + " bdnz loop\n";
}

std::string ScalarFmaChains() { return EightChains(" fmadd f{0}, f{0}, f10, f11\n"); }

std::string IntegerAddChains() { return EightChains(" add r{0}, r{0}, r20\n"); }

// Points by a 3 x 4 matrix, rows of x, y and z: three loads, nine multiply-adds, three stores for
// four points; three vectors side by side, which is what 32 registers hold beside the matrix's 12,
// and the next iteration's loads before this iteration's stores, where the multiply-adds are waited
// for.
//
// Microsoft did not say of what code its 10 to 20 % are. What a second thread gains is what the
// first one waits: nothing of code that never waits, everything of P7's six chains, which dispatch
// in half of their cycles. This is code as a careful compiler leaves it.
std::string MixedVectorKernel() {
  constexpr int kVectors = 3, kAxes = 3, kMatrix = 20;
  const auto in = [](int vector, int axis) { return vector * kAxes + axis; };
  const auto out = [](int vector, int axis) { return kVectors * kAxes + vector * kAxes + axis; };
  std::string text = "loop:\n";
  // out = translation + x * column 0, then + y * column 1, then + z * column 2.
  for (int step = 0; step < kAxes; ++step)
    for (int v = 0; v < kVectors; ++v)
      for (int a = 0; a < kAxes; ++a)
        text +=
            Format(" vmaddfp v{}, v{}, v{}, v{}\n", out(v, a), in(v, step),
                   kMatrix + step * kAxes + a, step == 0 ? kMatrix + kAxes * kAxes + a : out(v, a));
  for (int v = 0; v < kVectors; ++v)
    for (int a = 0; a < kAxes; ++a) text += Format(" lvx v{}, r{}, r3\n", in(v, a), 5 + in(v, a));
  text += " addi r3, r3, 144\n";
  for (int v = 0; v < kVectors; ++v)
    for (int a = 0; a < kAxes; ++a) text += Format(" stvx v{}, r{}, r4\n", out(v, a), 5 + in(v, a));
  return text + " addi r4, r4, 144\n bdnz loop\n";
}

std::string LoadHitStore() { return "stfs f1, 8(r1)\n lwz r3, 8(r1)\n"; }

}  // namespace pelt
