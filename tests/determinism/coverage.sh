#!/usr/bin/env bash
# Builds Pelt with clang's coverage of regions, reference kernels alone, runs the courses of `pelt verify` and holds what
# of core/kernels and jobs they never run against the list of what may remain (coverage_known.txt).
#   coverage.sh BUILD_DIR
# Exit code 77: no clang, or no llvm-cov of its version.
set -euo pipefail
build=$1
source=$(cd "$(dirname "$0")/../.." && pwd)
version=$(clang++ -dumpversion 2>/dev/null | cut -d. -f1) || true
cov=$(command -v "llvm-cov-$version" llvm-cov | head -n 1) || true
profdata=$(command -v "llvm-profdata-$version" llvm-profdata | head -n 1) || true
[ -n "$cov" ] && [ -n "$profdata" ] || { echo "SKIPPED: no clang++ with its llvm-cov"; exit 77; }
mkdir -p "$build"
cmake -S "$source" -B "$build" -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_BUILD_TYPE=Debug -DPELT_ISAS=reference \
  "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -fprofile-instr-generate -fcoverage-mapping" -DPELT_TEST_WIDE_KERNELS=OFF >"$build/log.txt"
LLVM_PROFILE_FILE=/dev/null cmake --build "$build" --target pelt >>"$build/log.txt" ||
  { tail -n 40 "$build/log.txt"; exit 1; }
run() { LLVM_PROFILE_FILE="$build/course-%p.profraw" "$build/bench/pelt" verify "$@" | tail -n 1; }
rm -f "$build"/course-*.profraw
run --scene tiny --frames 8
run --random 200 --seed 1000
"$profdata" merge -sparse "$build"/course-*.profraw -o "$build/course.profdata"
"$cov" export "$build/bench/pelt" -instr-profile "$build/course.profdata" -skip-functions >"$build/course.json"
python3 "$source/tests/determinism/coverage.py" "$build/course.json" "$source" \
  "$source/tests/determinism/coverage_known.txt"
