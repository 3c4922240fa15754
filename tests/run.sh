#!/usr/bin/env bash
# Installs what is missing, builds and runs the tests.
#   bash tests/run.sh          one proof of each kind, in minutes: one build (g++, RelWithDebInfo) with the kernels of this
#                              machine's AVX2, if it has that, without bench/accuracy, pictures and the page
#   bash tests/run.sh all      what CI runs: every instruction set by g++ and as WebAssembly, what needs a browser, Pelt
#                              as a package, big-endian PowerPC under an emulator, clang-tidy; by clang address and
#                              undefined-behaviour sanitizers on what handles memory, and a thread sanitizer on what
#                              runs without oneTBB (whose own synchronisation the sanitizer does not understand)
#   bash tests/run.sh release  before a release: besides that clang Release, g++ Debug, chunks of another size, other
#                              processors, Windows, the kernel tests compiled for AVX-512, sanitizers on all but the slow tests,
#                              each file compiled by itself, a million schedules of the frame's scheduler, and every
#                              instruction set wherever kernels are optimised by another compiler or sanitized
# Needs no terminal, no input and no network once the packages are there. The last lines are ctest's.
set -euo pipefail
cd "$(dirname "$0")/.."
exec </dev/null
what=${1:-one}
[[ $# -le 1 && "$what" =~ ^(one|all|release)$ ]] || { echo "usage: bash tests/run.sh [one|all|release]" >&2; exit 2; }
extra=()
# Without these the tests that need them say that they are skipped.
if [ "$what" != one ]; then
  extra=(ccache clang clang-tidy libclang-rt-14-dev pkg-config chromium g++-powerpc-linux-gnu qemu-user openmpi-bin python3
    libegl1 libgl1-mesa-dri lld-14 wasi-libc libc++-16-dev-wasm32 libclang-rt-14-dev-wasm32)
  command -v npm >/dev/null || extra+=(npm)  # Node's own package brings it along, and refuses Debian's
  if [ "$what" = release ]; then extra+=(llvm g++-{aarch64,powerpc64le,s390x,riscv64,i686}-linux-gnu g++-arm-linux-gnueabihf
    g++-mingw-w64-x86-64-posix wine64); fi
fi
bash .ci/setup.sh ${extra[@]+"${extra[@]}"}
jobs=$(nproc)
export CMAKE_BUILD_PARALLEL_LEVEL=$jobs  # of builds within builds and tests

# build NAME COMPILER BUILD_TYPE "TARGETS" [cmake arguments]: into build/NAME, its output into build/NAME.log.
build() {
  local name=$1 compiler=$2 type=$3 targets start=$SECONDS
  read -ra targets <<<"$4"
  shift 4
  echo "== $name: build, at $SECONDS s"
  cmake -S . -B "build/$name" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE="$type" -DPELT_WHOLE=ON "$@" >"build/$name.log" 2>&1 ||
    { tail -n 60 "build/$name.log"; echo "== $name: cmake failed"; return 1; }
  cmake --build "build/$name" --target "${targets[@]}" --parallel "$jobs" >>"build/$name.log" 2>&1 ||
    { grep -E -A 20 -m 3 'FAILED|error:' "build/$name.log" || tail -n 60 "build/$name.log"; echo "== $name: build failed"; return 1; }
  echo "== $name: built in $((SECONDS - start)) s"
}
# check NAME [ctest arguments]
check() {
  local name=$1
  shift
  echo "== $name: test, at $SECONDS s"
  "${launcher[@]}" ctest --test-dir "build/$name" --output-on-failure --parallel "$jobs" --no-tests=error "$@"
}
launcher=(env)

mkdir -p build
# What the compiler makes of every kernel is seen in the build of everything; the others need one instruction set.
one_set=() narrow=()
if grep -qsw avx2 /proc/cpuinfo; then one_set=(-DPELT_ISAS=avx2); fi
if [ "$what" != release ]; then narrow=(${one_set[@]+"${one_set[@]}"}); fi

sanitized() {
  # Before a release every program but the slow ones, and each file by itself, as a parent's build compiles it: what a
  # file forgets to include is seen.
  local programs=pelt_memory_tests tests=(-L memory) threads=(-DPELT_ISAS=reference)
  if [ "$what" = release ]; then programs=pelt_tests tests=(-LE slow) threads=(-DPELT_WHOLE=OFF); fi
  build clang-sanitize clang++ Debug "$programs" -DPELT_SANITIZE=address,undefined "-DCMAKE_CXX_FLAGS_DEBUG=-O1 -g1" \
    -DPELT_TEST_WIDE_KERNELS=OFF ${narrow[@]+"${narrow[@]}"}
  # Not the longest of what is about figures, which the other builds hold: other tests walk the same paths.
  local figures="PlantedErrors.*:MeasuredRows.HoldAt*:Perlin.HasZero*:Perlin.Neighbouring*:SimulateVerlet.AStillScene*Bias"
  figures+=":SimulatePbd.ComingToRest*:SimulatePbd.MotionDoesNotGrow*:Comparison.ErrorsAre*:Comparison.OurOwn*"
  figures+=":Suite.ReferenceConverges:Modal.ErrorOn*:ModelError.Curl*:Collider.ALinkThatLeans*"
  figures+=":SimulateModalContact.ASoftSurfaceIsAsDeep*:SimulateModalContact.KeepsWithinMaxDistance*"
  figures+=":KernelCost.ScheduledWindows*:SharedTransfers.TakesAsLong*:DmaProperties.NoStage*:ConsoleMachines.AreTimed*"
  figures+=":MeasuredRows.EachIs*:SimulateModal.SameBitsOnEverySet*"
  figures+=":SimulateModalContact.AFastSphereMisses*:SimulateModalFriction.HoldsUp*:SimulateModalFriction.MovingGround*"
  figures+=":Mask.MaterialsJoints*:SimulateModalRest.StrandsInAndAbout*:SimulateModalRest.WhoSettles*:SimulateModalFriction.WhatIsHeld*"
  figures+=":SceneStress.Promises*:FeatureErrors.AreThose*:FeatureErrors.TheReference*:WorkPrecision.ErrorsAre*:InputError.Velocities*"
  figures+=":ModelError.NodesAre*:StageCosts.AreTheSame*:Modal.EveryStress*:ScenePrecision.ErrorsAre*:RodStrike.*:RodContact.StrandsLie*"
  figures+=":Stack.AnItem*"
  UBSAN_OPTIONS=print_stacktrace=1 GTEST_FILTER="-$figures" check clang-sanitize "${tests[@]}"
  build clang-thread clang++ RelWithDebInfo pelt_thread_tests -DPELT_SANITIZE=thread "${threads[@]}"
  # The thread sanitizer wants memory where older ones expect it; not every sandbox lets us ask for that.
  if setarch "$(uname -m)" -R true 2>/dev/null; then launcher=(setarch "$(uname -m)" -R); fi
  check clang-thread -L thread
}
before_a_release() {
  programs() { printf 'pelt_%s_test ' "$@"; }
  pattern() { (IFS='|'; echo "golden_[a-z]+\$|pelt_($*)_test\$"); }
  # What g++ makes of the frame without optimisation; asserts everywhere else are the sanitizer build's.
  build gcc-debug g++ Debug "pelt pelt_determinism_test" "-DCMAKE_CXX_FLAGS_DEBUG=-g1" -DPELT_TEST_WIDE_KERNELS=OFF \
    ${one_set[@]+"${one_set[@]}"}
  check gcc-debug -R 'golden_[a-z]+$|determinism_test'
  # The other capacity: its bits are its own, and the same for all that runs it.
  local chunk64=(jobs determinism kernels) clang_release=(determinism kernels platform_sim accuracy)
  build gcc-chunk64 g++ Debug "$(programs "${chunk64[@]}")" "-DCMAKE_CXX_FLAGS_DEBUG=-g1" \
    -DPELT_CHUNK_STRANDS=64 -DPELT_TEST_WIDE_KERNELS=OFF ${one_set[@]+"${one_set[@]}"}
  check gcc-chunk64 -R "$(pattern "${chunk64[@]}")" -E golden
  # The other compiler, optimised: the bits that are kept.
  build clang-release clang++ Release "pelt $(programs "${clang_release[@]}")" -DPELT_TEST_WIDE_KERNELS=OFF
  check clang-release -R "$(pattern "${clang_release[@]}")|^pelt_verify_tiny\$"
}

# The page's module is another compiler's work, and its test wants a browser.
every=(-DPELT_ISAS= -DPELT_TEST_WIDE_KERNELS=OFF -DPELT_WASM=ON) left_out=(-LE release)
case $what in
one)
  echo "== left to 'bash tests/run.sh all': the rooms' own tests, other instruction sets, sanitizers, other machines, packages"
  build first g++ RelWithDebInfo pelt_first_tests "${narrow[@]:--DPELT_ISAS=}" -DPELT_ACCURACY=OFF -DPELT_PICTURES=OFF -DPELT_FIRST=tests
  check first -L first
  exit ;;
all) echo "== left to 'bash tests/run.sh release': clang Release, g++ Debug, chunks of 64, other machines, more under sanitizers" ;;
release) every=(-DPELT_ISAS= -DPELT_TEST_WIDE_KERNELS=ON -DPELT_WASM=ON) left_out=() ;;
esac
# Beside the build of everything, whose configuration, links and last kernels leave cores idle, as their tests do. In a
# process group of its own, so that nothing of it outlives this script.
set -m
sanitized >build/sanitized.log 2>&1 &
set +m
lane=$!
trap 'kill -- "-$lane" 2>/dev/null || true' EXIT
build gcc g++ RelWithDebInfo all "${every[@]}"
wait "$lane" || { cat build/sanitized.log; exit 1; }
trap - EXIT
cat build/sanitized.log
if [ "$what" = release ]; then
  before_a_release
  export PELT_SCHEDULES=200000
fi
# Last, because it has most tests: its summary is the closing line.
check gcc ${left_out[@]+"${left_out[@]}"}
