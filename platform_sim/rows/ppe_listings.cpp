// The listings of the PPE's and the Xenon's rows.
//
// What consoles.md does not say of a row's loop is taken to be: a pointer chase is a load and the
// loop's branch; the vector stream reads a line a turn and adds it to four sums, so that something
// is done with what was read.

#include "core/format.hpp"
#include "platform_sim/rows/row_listings.hpp"

namespace pelt {

std::string PointerChase() { return "loop: ld r3, 0(r3)\n bdnz loop\n"; }

std::string VectorStream() {
  constexpr int kVectors = 8, kSums = 4;
  std::string text = "loop:\n";
  for (int i = 0; i < kVectors; ++i) text += Format(" lvx v{}, r{}, r3\n", i, 4 + i);
  for (int i = 0; i < kVectors; ++i)
    text += Format(" vaddfp v{0}, v{0}, v{1}\n", 16 + i % kSums, i);
  return text + " addi r3, r3, 128\n bdnz loop\n";
}

std::string VectorFmaChains() {
  constexpr int kChains = 6, kRounds = 16;
  std::string text = "loop:\n";
  for (int r = 0; r < kRounds; ++r)
    for (int i = 1; i <= kChains; ++i) text += Format(" vmaddfp v{0}, v{0}, v10, v11\n", i);
  return text + " bdnz loop\n";
}

// Points by a 3 x 4 matrix, rows of x, y and z: three loads, nine multiply-adds, three stores for
// four points; three vectors side by side, which is what 32 registers hold beside the matrix's 12,
// and the next turn's loads before this turn's stores, where the multiply-adds are waited for.
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
