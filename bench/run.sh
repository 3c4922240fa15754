#!/usr/bin/env bash
# Builds what a first verdict needs and says whether six characters fit 8 ms on this machine, a PS3 and an Xbox 360, and
# what costs most; then builds the rest and writes why, at which error, and what a millisecond more would buy, of six and
# of seventeen characters, with the monster's 300 frames and the benchmarks, into a file that it names.
#   bash bench/run.sh                 all of it
#   bash bench/run.sh frame           without the benchmarks
#   bash bench/run.sh view            instead: a page that runs the monster in a browser
#   ... --no-install                  lists the packages that are missing and stops, or goes on where none is
set -euo pipefail
cd "$(dirname "$0")/.."
what=all
for word in "$@"; do
  case $word in
    all | frame | view) what=$word ;;
    --no-install) export PELT_NO_INSTALL=1 ;;
    *) echo "usage: bash bench/run.sh [all|frame|view] [--no-install]" >&2; exit 2 ;;
  esac
done
extra=() options=(-DPELT_WASM=OFF)
if [ "$what" = view ]; then
  extra=(clang lld-14 wasi-libc libc++-16-dev-wasm32 libclang-rt-14-dev-wasm32 libegl-dev libgl-dev)
  options=(-DPELT_WASM=ON)
fi
bash .ci/setup.sh ${extra[@]+"${extra[@]}"}

build=build/bench
mkdir -p "$build"
report=$build/report.txt
# What is built of how much, and for how long: on one line of a terminal, else every 15 seconds.
progress() {
  local line shown=$SECONDS
  while IFS= read -r line; do
    echo "$line" >&3
    [[ $line == \[*/*\]* ]] || continue
    if [ -t 1 ]; then
      printf '\r%s] %d s ' "${line%%]*}" "$SECONDS"
    elif ((SECONDS - shown >= 15)); then
      printf '%s] %d s\n' "${line%%]*}" "$SECONDS"
      shown=$SECONDS
    fi
  done
  if [ -t 1 ]; then printf '\r%40s\r' ''; fi
}
# make TARGETS -- CMAKE ARGUMENTS
make() {
  local targets=()
  while [ "$1" != -- ]; do targets+=("$1"); shift; done
  shift
  { cmake -S . -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DPELT_TESTS=OFF -DPELT_WHOLE=ON "$@" &&
    cmake --build "$build" --target "${targets[@]}"; } 2>&1 | progress 3>>"$build/build.log" ||
    { tail -n 60 "$build/build.log" >&2; exit 1; }
}
: >"$build/build.log"
pelt=$build/bench/pelt
if [ "$what" = view ]; then
  echo "building the page of the monster in $build: 10 to 20 minutes on two cores, the first time"
  make pelt -- -DPELT_FIRST= -DPELT_ISAS= "${options[@]}"
  "$pelt" view --scene monster --out "$build/monster.html"
  echo "open it in a browser: $(realpath "$build/monster.html")"
  exit 0
fi

# This machine's instruction set alone, and what is not measured without optimisation.
isa=
for flag in avx512vl:avx512 avx2:avx2 sse4_1:sse4; do
  if [ -z "$isa" ] && grep -qsw "${flag%:*}" /proc/cpuinfo; then isa=${flag#*:}; fi
done
if [ ! -x "$pelt" ]; then
  echo "building the verdict in $build: 2 to 4 minutes on two cores, the first time"
  make pelt_verdict -- -DPELT_FIRST=verdict "-DPELT_ISAS=$isa" "${options[@]}"
else
  make pelt_verdict -- "${options[@]}"
fi
verdict=$build/bench/pelt_verdict
echo
echo "Six characters of 36,000 strands at 4 to 5 m, with level of detail (the scene 'stage'), 60 frames behind 60 to warm up;"
echo "95th percentile of a frame against 8 ms. The five stages that cost most are below each platform."
echo
# The host first, while nothing else runs; then the consoles side by side. A scene that does not fit is a verdict.
"$verdict" stage host || [ $? -le 2 ]
for console in ps3 xbox360; do
  "$verdict" stage "$console" >"$build/$console.txt" 2>&1 &
done
wait
cat "$build/ps3.txt" "$build/xbox360.txt"
cat <<END

  $pelt run --scene stage          every stage: median, p95, worst, bytes, share of the frame; --json
  $pelt report --scene stage       the same as a page, with workers over time
  $pelt verify --scene tiny        that no executor, thread count or instruction set changes a bit
  README.md                        your own character, your engine's job system

END
targets=(pelt)
[ "$what" = all ] && targets+=(pelt_benchmarks)
echo "building the pelt command$([ "$what" = all ] && echo " and the benchmarks"): 5 to 10 minutes on two cores, the first time"
make "${targets[@]}" -- -DPELT_FIRST= -DPELT_ISAS= "${options[@]}"

# Exit code 2 is a verdict only where the report says so: it is that of every error, too.
is_verdict() { [ "$1" -eq 1 ] || { [ "$1" -eq 2 ] && grep -q '^UNSURE: exit code 2' "$2"; }; }
: >"$report"
for scene in stage cast; do
  echo "measuring the scene $scene here and on both consoles, to $report"
  asked=(--scene "$scene" --lod --frames 60 --target-ms 8)
  # At which error, and what a millisecond more would buy.
  if [ "$scene" = stage ]; then asked+=(--qualities); fi
  "$pelt" budget "${asked[@]}" >"$build/$scene.txt" || is_verdict $? "$build/$scene.txt"
  cat "$build/$scene.txt" >>"$report"
  echo >>"$report"
done
# At which error each way to run the stage is.
sed -n '/^quality /,$p' "$build/stage.txt"
echo "running 300 frames of the monster, to $report"
"$pelt" bake --character builtin --setup monster --out "$build/monster.groom" >>"$report"
"$pelt" run --scene monster --frames 300 >>"$report"
if [ "$what" = all ]; then
  for benchmark in "$build"/bench/pelt_*_benchmark; do
    name=$(basename "$benchmark")
    echo "$name, to $report"
    # Kernel benchmarks on x86 are built for AVX2.
    if [[ "$name" != pelt_frame_benchmark && "$(uname -m)" == x86_64 ]] && ! grep -qw avx2 /proc/cpuinfo; then
      echo "$name: skipped, this processor has no AVX2" | tee -a "$report"
      continue
    fi
    # Kernels in short runs; frames have their own number of iterations.
    arguments=()
    [ "$name" = pelt_frame_benchmark ] || arguments=(--benchmark_min_time=0.05)
    { echo; "$benchmark" ${arguments[@]+"${arguments[@]}"}; } >>"$report"
  done
fi
echo "all of it is in $report"
