// C13: two blocks of 8 x 16 of C alternately, 32 registers each, all 64 steps of k written out; what a
// multiply-add needs is loaded and spread on the odd pipe under the multiply-adds of the step
// before, and one block is stored and loaded under the other's.

#include <string>
#include <vector>

#include "core/format.hpp"
#include "platform_sim/rows/row_listings.hpp"

namespace pelt {
namespace {

class Schedule {
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

static_assert(Schedule::kFmas == kMatrixMultiplyFmas);

}  // namespace

std::string MatrixMultiply() { return Schedule().Text(); }

}  // namespace pelt
