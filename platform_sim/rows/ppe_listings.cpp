// The listings of the PPE's and the Xenon's rows.
//
// The PPE's are cellmark's: its sources say which instructions run, its tuning page shows the loops
// as its compiler left them (the chases whole, the streams in words: addresses are extended once
// per iteration, offsets stand in registers, eight loads, then eight adds on four sums). What it
// does not show is the order of the few instructions around the loads.

#include "core/format.hpp"
#include "platform_sim/rows/row_listings.hpp"

namespace pelt {
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
