#!/usr/bin/env bash
# Installs what is missing, builds, bakes and runs the built-in character for 300 frames on all
# cores, prints the frame budget, runs short benchmarks, and ends with a verdict for host, PS3 and
# Xbox 360 on the scene that the originals' 5-8 ms were for.
#   bash bench/run.sh          all of it
#   bash bench/run.sh frame    the frame budget and the verdict only
set -euo pipefail
cd "$(dirname "$0")/.."
what=${1:-all}
[[ "$what" == all || "$what" == frame ]] || { echo "usage: bash bench/run.sh [all|frame]" >&2; exit 2; }
bash .ci/setup.sh

build=build/bench
mkdir -p "$build"
targets=(pelt)
[ "$what" = all ] && targets+=(pelt_benchmarks)
echo "building in $build"
{ cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DPELT_TESTS=OFF &&
  cmake --build "$build" --target "${targets[@]}"; } >"$build/build.log" 2>&1 ||
  { tail -n 60 "$build/build.log" >&2; exit 1; }

pelt=$build/bench/pelt
"$pelt" bake --character builtin --setup monster --out "$build/monster.groom"
echo
"$pelt" run --scene monster --frames 300
# A scene that does not fit is a verdict, not a failure of this script.
verdict() {
  echo
  "$pelt" budget --scene cast --frames 60 --target-ms 8 || [ $? -eq 1 ]
}
if [ "$what" = frame ]; then
  verdict
  exit 0
fi

for benchmark in "$build"/bench/pelt_*_benchmark; do
  echo
  # Kernel benchmarks on x86 are built for AVX2.
  if [[ "$(basename "$benchmark")" != pelt_frame_benchmark && "$(uname -m)" == x86_64 ]] &&
    ! grep -qw avx2 /proc/cpuinfo; then
    echo "$(basename "$benchmark"): skipped, this processor has no AVX2"
    continue
  fi
  arguments=()
  # Kernels in short runs; frames have their own number of iterations.
  [ "$(basename "$benchmark")" = pelt_frame_benchmark ] || arguments=(--benchmark_min_time=0.05)
  "$benchmark" ${arguments[@]+"${arguments[@]}"}
done
verdict
