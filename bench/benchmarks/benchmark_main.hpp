// The main of all benchmarks: what a figure was measured on goes in front of all figures, and bad
// input is one line.
#pragma once

#include <benchmark/benchmark.h>
#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <iostream>
#include <memory>
#include <streambuf>
#include <string>

#include "bench/report/machine.hpp"

namespace pelt {

// Standard error, without what Debian's library says of itself: that it checks its own assertions
// (DEBUG) costs nothing inside of what is timed, which is compiled here.
class WithoutDebugWarning : public std::streambuf {
 private:
  int_type overflow(int_type c) override {
    if (c == traits_type::eof()) return traits_type::not_eof(c);
    line_ += char(c);
    if (c == '\n') sync();
    return c;
  }
  int sync() override {
    if (line_.find("Library was built as DEBUG") == std::string::npos) std::cerr << line_;
    line_.clear();
    return 0;
  }

  std::string line_;
};

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
    WithoutDebugWarning buffer;
    std::ostream errors(&buffer);
    const std::unique_ptr<benchmark::BenchmarkReporter> reporter(
        benchmark::CreateDefaultDisplayReporter());
    reporter->SetErrorStream(&errors);
    benchmark::RunSpecifiedBenchmarks(reporter.get());
    return 0;
  } catch (const std::exception& error) {
    fmt::print(stderr, "{}: {}\n", argv[0], error.what());
    return 1;
  }
}

}  // namespace pelt
