#!/usr/bin/env bash
# Fuzzes what Pelt reads, with libFuzzer under the address and undefined-behaviour sanitizers.
#   bash tests/fuzz/run.sh SECONDS [FORMAT]...      every format, if none is named
# Findings stay in build/fuzz/FORMAT; an empty folder of findings and exit code 0 is what to hope for.
set -euo pipefail
cd "$(dirname "$0")/../.."
[[ ${1:-} =~ ^[0-9]+$ ]] || { echo "usage: bash tests/fuzz/run.sh SECONDS [FORMAT]..." >&2; exit 2; }
seconds=$1
shift
bash .ci/setup.sh clang libclang-rt-14-dev
build=build/fuzz
mkdir -p "$build"
{ cmake -S . -B "$build" -G Ninja -DCMAKE_CXX_COMPILER=clang++ -DCMAKE_BUILD_TYPE=Debug \
    "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -g1" -DPELT_FUZZ=ON -DPELT_SANITIZE=fuzzer-no-link,address,undefined &&
  cmake --build "$build" --target pelt_fuzz; } >"$build/build.log" 2>&1 || { tail -n 60 "$build/build.log" >&2; exit 1; }

formats=("$@")
[ "${#formats[@]}" -gt 0 ] || for target in "$build"/tests/fuzz/pelt_fuzz_*; do formats+=("${target##*pelt_fuzz_}"); done
failed=0
for format in "${formats[@]}"; do
  target=$build/tests/fuzz/pelt_fuzz_$format
  [ -x "$target" ] || { echo "no format '$format'" >&2; exit 2; }
  seeds=(tests/fuzz/corpus/"$format")
  case $format in
    setup) seeds+=(bench/scenarios/setups) ;;
    golden) seeds=(tests/fuzz/corpus/digest_log traces/golden) ;;
  esac
  mkdir -p "$build/$format/corpus"
  largest=$(find "${seeds[@]}" -type f -printf '%s\n' | sort -n | tail -1)
  # What the fuzzer grows stays out of the tree. Memory: fuzz_target.hpp's bound, and the fuzzer's own.
  if "$target" -max_total_time="$seconds" -timeout=20 -rss_limit_mb=3072 -malloc_limit_mb=512 -print_final_stats=1 \
    -max_len=$((largest + 4096)) -artifact_prefix="$build/$format/" "$build/$format/corpus" "${seeds[@]}" >"$build/$format.log" 2>&1; then
    verdict=clean
  else
    verdict="FAILED, see $build/$format.log"
    failed=1
  fi
  echo "$format: $verdict; $(grep -E 'number_of_executed_units|peak_rss_mb' "$build/$format.log" | sed 's/stat:://' | tr -s ' \n' ' ')$(
    grep -oE 'cov: [0-9]+' "$build/$format.log" | tail -1)"
done
exit "$failed"
