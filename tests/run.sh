#!/usr/bin/env bash
# Installs what is missing, builds and runs the tests.
#   bash tests/run.sh        one build (g++, RelWithDebInfo)
#   bash tests/run.sh all    what CI runs: besides it clang Release, g++ Debug, chunks of another size, address
#                            and undefined-behaviour sanitizers, a thread sanitizer on what runs without oneTBB
#                            (whose own synchronisation the sanitizer does not understand), and all that needs
#                            a browser, cross compilers or an emulator
# Needs no terminal, no input and no network once the packages are there. The last lines are ctest's.
set -euo pipefail
cd "$(dirname "$0")/.."
exec </dev/null
what=${1:-one}
[[ $# -le 1 && ("$what" == one || "$what" == all) ]] || { echo "usage: bash tests/run.sh [one|all]" >&2; exit 2; }
extra=()
# Without these the tests that need them say that they are skipped.
if [ "$what" = all ]; then
  extra=(ccache clang libclang-rt-14-dev pkg-config chromium g++-powerpc-linux-gnu g++-aarch64-linux-gnu qemu-user openmpi-bin python3
    g++-mingw-w64-x86-64-posix wine64)
  command -v npm >/dev/null || extra+=(npm)  # Node's own package brings it along, and refuses Debian's
fi
bash .ci/setup.sh ${extra[@]+"${extra[@]}"}
jobs=$(nproc)

# build NAME COMPILER BUILD_TYPE "TARGETS" [cmake arguments]: into build/NAME, its output into build/NAME.log.
build() {
  local name=$1 compiler=$2 type=$3 targets start=$SECONDS
  read -ra targets <<<"$4"
  shift 4
  echo "== $name: build"
  cmake -S . -B "build/$name" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE="$type" "$@" >"build/$name.log" 2>&1 ||
    { tail -n 60 "build/$name.log"; echo "== $name: cmake failed"; return 1; }
  cmake --build "build/$name" --target "${targets[@]}" --parallel "$jobs" >>"build/$name.log" 2>&1 ||
    { grep -E -A 20 -m 3 'FAILED|error:' "build/$name.log" || tail -n 60 "build/$name.log"; echo "== $name: build failed"; return 1; }
  echo "== $name: built in $((SECONDS - start)) s"
}
# check NAME [ctest arguments]
check() {
  local name=$1
  shift
  echo "== $name: test"
  "${launcher[@]}" ctest --test-dir "build/$name" --output-on-failure --parallel "$jobs" --no-tests=error "$@"
}
launcher=(env)

mkdir -p build
if [ "$what" = all ]; then
  # What the compiler makes of every kernel is seen in the sanitizer, Release and last builds; the others need one.
  narrow=()
  if [ "$(uname -m)" = x86_64 ]; then narrow=(-DPELT_ISAS=avx2); fi
  build clang-thread clang++ RelWithDebInfo pelt_thread_tests -DPELT_SANITIZE=thread ${narrow[@]+"${narrow[@]}"}
  # The thread sanitizer wants memory where older ones expect it; not every sandbox lets us ask for that.
  if setarch "$(uname -m)" -R true 2>/dev/null; then launcher=(setarch "$(uname -m)" -R); fi
  check clang-thread -L thread
  launcher=(env)
  build clang-sanitize clang++ Debug pelt_tests -DPELT_SANITIZE=address,undefined "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -g1" \
    -DPELT_TEST_WIDE_KERNELS=OFF -DPELT_PRECOMPILE=ON
  # Not the longest of what is about figures, which the other builds hold: other tests walk the same paths.
  figures="PlantedErrors.*:MeasuredRows.HoldAt*:Perlin.HasZero*:Perlin.Neighbouring*:SimulateVerlet.AStillScene*Bias"
  figures+=":SimulatePbd.ComingToRest*:SimulatePbd.MotionDoesNotGrow*:Comparison.ErrorsAre*:Comparison.OurOwn*"
  figures+=":Suite.ReferenceConverges:Modal.ErrorOn*:Modal.CurlThat*"
  UBSAN_OPTIONS=print_stacktrace=1 GTEST_FILTER="-$figures" check clang-sanitize -LE slow
  # What g++ makes of the frame without optimisation; asserts everywhere else are the sanitizer build's.
  build gcc-debug g++ Debug "pelt pelt_determinism_test" "-DCMAKE_CXX_FLAGS_DEBUG=-g1" -DPELT_TEST_WIDE_KERNELS=OFF \
    ${narrow[@]+"${narrow[@]}"}
  check gcc-debug -R 'golden_[a-z]+$|determinism_test'
  # The other capacity: its bits are its own, and the same whatever runs it.
  build gcc-chunk64 g++ Debug "pelt_kernels_test pelt_jobs_test pelt_determinism_test" "-DCMAKE_CXX_FLAGS_DEBUG=-g1" \
    -DPELT_CHUNK_STRANDS=64 -DPELT_TEST_WIDE_KERNELS=OFF ${narrow[@]+"${narrow[@]}"}
  check gcc-chunk64 -R 'kernels_test|jobs_test|determinism_test'
  build clang-release clang++ Release pelt_tests -DPELT_TEST_WIDE_KERNELS=OFF -DPELT_PRECOMPILE=ON
  check clang-release -LE slow
  # The other compiler as a whole: the kept digests are among the above.
  check clang-release -R '^pelt_verify_tiny$'
fi
# Last, because it has every test: its summary is the closing line.
build gcc g++ RelWithDebInfo all
check gcc
