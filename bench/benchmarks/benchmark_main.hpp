// The main of benchmarks that run whole scenes: what a figure was measured on goes in front of all
// figures, and bad input is one line.
#pragma once

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstdio>
#include <exception>

#include "bench/report/machine.hpp"

namespace pelt {

// `register_all` adds the benchmarks, and context of its own if it has any. The exit code.
int RunBenchmarks(int argc, char** argv, const auto& register_all) {
  try {
    benchmark::Initialize(&argc, argv);
    if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
    const Machine machine = DescribeMachine();
    benchmark::AddCustomContext("processor", machine.processor);
    benchmark::AddCustomContext("compiler", machine.compiler);
    benchmark::AddCustomContext("commit", machine.commit);
    register_all();
    benchmark::RunSpecifiedBenchmarks();
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", argv[0], error.what());
    return 1;
  }
}

}  // namespace pelt
