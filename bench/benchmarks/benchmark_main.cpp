// Of benchmarks that have no main of their own.
#include "bench/benchmarks/benchmark_main.hpp"

int main(int argc, char** argv) {
  return pelt::RunBenchmarks(argc, argv, [] {});
}
