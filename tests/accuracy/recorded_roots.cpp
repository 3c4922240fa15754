// recorded_roots ROOTS.csv: how far every model and solver is off the rod when a root moves as it was recorded
// (recorded_root.hpp has the table's format), per cent of the secondary motion, median of four drawn strands of each
// material. For a motion of your own game.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <fstream>

#include "bench/accuracy/model_error.hpp"
#include "core/isa.hpp"
#include "tests/accuracy/recorded_root.hpp"

namespace pelt::accuracy {
namespace {

void PrintErrors(const char* path) {
  std::ifstream in(path);
  if (!in) throw Error("cannot be read");
  const RecordedRoot root = ReadRecordedRoot(in);
  ModelErrorOptions options;
  options.families = {MotionFamily::kEveryday};
  options.seconds = root.seconds.back();
  options.motion = MotionOf(root);
  options.isa = BestIsa();
  std::string head = fmt::format("{:<44}", "");
  for (const Preset& preset : options.presets) head += fmt::format("{:>8}", preset.name);
  std::puts(head.c_str());
  const ModelErrorTable table = MeasureModelError(options);
  for (const ModelErrorRow& row : table.panels[0].rows) {
    std::string line =
        fmt::format("{:<44}", row.model + (row.solver ? ", " + row.solver->label : ", exactly"));
    for (std::vector<double> errors : row.errors) {
      std::ranges::sort(errors);
      line += fmt::format("{:>8.1f}",
                          50.0 * (errors[(errors.size() - 1) / 2] + errors[errors.size() / 2]));
    }
    std::puts(line.c_str());
  }
}

}  // namespace
}  // namespace pelt::accuracy

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("usage: recorded_roots ROOTS.csv\n", stderr), 2;
  try {
    pelt::accuracy::PrintErrors(argv[1]);
  } catch (const pelt::Error& error) {
    return fmt::print(stderr, "{}: {}\n", argv[1], error.what()), 2;
  }
  return 0;
}
