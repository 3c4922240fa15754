#include "bench/report/machine.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <fstream>
#include <thread>

#ifndef PELT_COMMIT
#define PELT_COMMIT "unknown"
#endif
#ifndef PELT_VERSION
#define PELT_VERSION "unknown"
#endif
#ifndef PELT_BUILD_TYPE
#define PELT_BUILD_TYPE "unknown"
#endif

namespace pelt {
namespace {

std::string ProcessorName() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    const size_t colon = line.find(": ");
    if (colon == std::string::npos) continue;
    if (line.starts_with("model name") || line.starts_with("cpu\t")) return line.substr(colon + 2);
  }
  return "unknown processor";
}

}  // namespace

Machine DescribeMachine() {
#ifdef __clang__
  const std::string compiler = fmt::format("clang {}", __clang_version__);
#else
  const std::string compiler = fmt::format("g++ {}", __VERSION__);
#endif
  return {ProcessorName(), std::thread::hardware_concurrency(), compiler, PELT_BUILD_TYPE,
          PELT_COMMIT};
}

std::string_view PeltVersion() { return PELT_VERSION; }

void AddMachine(const Machine& machine, ReportTree& tree) {
  tree.Add({"processor"}, machine.processor).Add({"cores"}, machine.cores);
  tree.Add({"compiler"}, machine.compiler).Add({"build_type"}, machine.build_type);
  tree.Add({"commit"}, machine.commit);
}

bool IsTerminal() { return isatty(STDERR_FILENO) != 0; }

}  // namespace pelt
