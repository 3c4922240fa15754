#!/usr/bin/env bash
# Mistakes that the compiler must refuse: see compile_errors.cpp; flags that would change the bits, which the sources
# refuse (core/float_rules.hpp); and compilers that contract all the same, with which configuring fails
# (core/float_probe.cmake).
# Arguments: the compiler, the source directory.
set -euo pipefail
compiler=$1 source=$2
compile() {
  "$compiler" -std=c++20 -ffp-contract=off -fsyntax-only -Werror=format -I"$source" -DFAULT="$1" \
    "$source/tests/determinism/compile_errors.cpp" 2>&1
}
if ! out=$(compile 0); then
  echo "FAILED: the healthy kernel does not compile"; echo "$out"; exit 1
fi
failed=0
expect() {  # fault, what, pattern of the refusal
  local out
  if out=$(compile "$1"); then
    echo "FAILED: $2 compiles"; failed=1
  elif ! grep -qE "$3" <<<"$out"; then
    echo "FAILED: $2 is refused for another reason:"; echo "$out"; failed=1
  else
    echo "refused, as it must be: $2"
  fi
}
expect 1 "a port of no stream" "no_such_stream"
expect 2 "a port of another stream's block" "OrderBlock.* has no member named .key|no member named 'key' in 'pelt::OrderBlock'"
expect 3 "a write through In" "read-only (object|location)|const-qualified|not assignable"
expect 4 "parameters that are not plain data" "is_trivially_copyable"
expect 5 "a block that is no legal DMA transfer" "legal DMA transfer"
expect 6 "a stream that is not named as its member" "a row is named as its member"

# Flags. Any source stands for all that have the header, which every one that computes must have.
refuse() {  # flags, pattern of the reason
  local out
  # shellcheck disable=SC2086
  if out=$("$compiler" -std=c++20 $1 -fsyntax-only -I"$source" "$source/core/wind_setup.cpp" 2>&1); then
    echo "FAILED: builds with $1"; failed=1
  elif ! grep -qE "Pelt's bits need .*$2" <<<"$out"; then
    echo "FAILED: $1 is refused for another reason:"; echo "$out"; failed=1
  else
    echo "refused, as it must be: $1"
  fi
}
refuse -ffast-math ffast-math
refuse -Ofast ffast-math
refuse -ffinite-math-only ffinite-math-only
refuse "-U__FLT_EVAL_METHOD__ -D__FLT_EVAL_METHOD__=2" FLT_EVAL_METHOD
refuse -D_M_FP_CONTRACT contract
if ! "$compiler" --version | grep -q clang; then
  for flag in -funsafe-math-optimizations -freciprocal-math -fno-signed-zeros -fsingle-precision-constant \
    "-fassociative-math -fno-signed-zeros -fno-trapping-math"; do
    refuse "$flag" "funsafe-math"
  done
  if [ "$(uname -m)" = x86_64 ]; then refuse -mfpmath=387 FLT_EVAL_METHOD; fi
fi
while read -r file; do
  grep -q '#include "core/float_rules.hpp"' "$file" && continue
  echo "FAILED: ${file#"$source/"} computes without core/float_rules.hpp"; failed=1
done < <(grep -lE '\b(float|double)\b|PELT_VECTOR' "$source"/core/*.cpp "$source"/core/*/*.cpp "$source"/jobs/*.cpp |
  grep -v float_probe)

# The probe, with the compilers that are here.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/CMakeFiles"
cat >"$work/probe.cmake" <<END
set(PROJECT_SOURCE_DIR [[$source]])
set(PROJECT_BINARY_DIR [[$work]])
set(CMAKE_BUILD_TYPE Release)
set(CMAKE_CXX_FLAGS_RELEASE -O3)
include([[$source/core/float_probe.cmake]])
pelt_probe_floats(\${FLAGS})
END
probe() {  # "passes" or the reason, compiler, cmake arguments...
  local wanted=$1 with=$2 out
  shift 2
  command -v "$with" >/dev/null || { echo "not tried, missing: $with"; return; }
  if out=$(cmake -DCMAKE_CXX_COMPILER="$with" "$@" -P "$work/probe.cmake" 2>&1); then out=passes; fi
  if tr -s ' \n' ' ' <<<"$out" | grep -qF "$wanted"; then
    echo "the probe of $with $*: $wanted"
  else
    echo "FAILED: the probe of $with $*: wanted '$wanted', got: $out"; failed=1
  fi
}
processor=-DCMAKE_SYSTEM_PROCESSOR=$(uname -m) x86=-DCMAKE_SYSTEM_PROCESSOR=x86_64 off=-DFLAGS=-ffp-contract=off
cell="-DCMAKE_CXX_FLAGS=-mcpu=cell -maltivec"
fused="is fused into one" simplified="is simplified" inverse="a product with the inverse"
for with in g++ clang++; do
  probe passes "$with" "$processor" $off
  probe passes "$with" "$processor" $off -DCMAKE_CXX_FLAGS=-ffp-contract=fast
  probe "$fused" "$with" "$processor" -DFLAGS=-ffp-contract=fast
  probe "$simplified" "$with" "$processor" $off -DCMAKE_CXX_FLAGS=-ffast-math
  probe "$inverse" "$with" "$processor" $off -DCMAKE_CXX_FLAGS=-freciprocal-math
done
probe passes powerpc-linux-gnu-g++ "$cell" $off
probe "$fused" powerpc-linux-gnu-g++ "$cell"
probe passes aarch64-linux-gnu-g++ $off
probe "$fused" aarch64-linux-gnu-g++
probe passes x86_64-w64-mingw32-g++-posix $x86 $off
probe "$fused" x86_64-w64-mingw32-g++-posix $x86
for with in clang-cl clang-cl-14; do
  cl=($x86 -DCMAKE_CXX_COMPILER_FRONTEND_VARIANT=MSVC -DCMAKE_CXX_FLAGS=--target=x86_64-pc-windows-msvc)
  probe "$fused" "$with" "${cl[@]}" $off
  probe passes "$with" "${cl[@]}" -DFLAGS=/clang:-ffp-contract=off
done

# The whole of configuring, with a compiler that has never heard of the flag.
cat >"$work/contracting" <<END
#!/usr/bin/env bash
kept=()
for argument in "\$@"; do [ "\$argument" = -ffp-contract=off ] || kept+=("\$argument"); done
exec "$(command -v "$compiler")" -ffp-contract=fast "\${kept[@]}"
END
chmod +x "$work/contracting"
if out=$(cmake -S "$source" -B "$work/build" -DCMAKE_CXX_COMPILER="$work/contracting" -DPELT_BENCH=OFF -DPELT_TESTS=OFF \
  -DPELT_GROOM=OFF -DPELT_TBB=OFF 2>&1); then
  echo "FAILED: a compiler that contracts is configured"; failed=1
elif ! grep -q "is fused into one" <<<"$out"; then
  echo "FAILED: configuring with a compiler that contracts fails for another reason:"; echo "$out"; failed=1
else
  echo "refused, as it must be: a compiler that contracts"
fi
exit $failed
