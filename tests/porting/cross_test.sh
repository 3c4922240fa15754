#!/usr/bin/env bash
# The same bits on other machines: big-endian PowerPC with AltiVec (the consoles' family) and AArch64 under qemu, and
# Windows (another ABI, C library and thread library) under wine, WebAssembly in Node.
# Builds tests/porting/cross with Debian's cross compilers, compares what it prints with the host's, and holds what it
# computes from a recording of tiny against the golden digests. A machine whose compiler or emulator is missing is
# left out, and said to be; exit code 77 when that is all of them. PELT_CROSS_ISAS=all: Windows has every instruction
# set that the host has, and not AVX2 alone, whose vectors are already wider than its stack is aligned.
#   cross_test.sh BUILD_DIR SOURCE_DIR COMPILER PELT HOST_DIR [FRAMES]
# COMPILER is the host's; PELT bakes the groom; HOST_DIR has the host's cross_frames and cross_golden.
set -uo pipefail
export CCACHE_NOHASHDIR=1
mkdir -p "$1/cross_test"
kept=$(realpath "$1")/cross_test
source_dir=$(realpath "$2") compiler=$3 pelt=$(realpath "$4") host_dir=$(realpath "$5") frames=${6:-8}

# Debian's wine64 is not on the path; the package `wine` puts a wrapper there.
wine=$(command -v wine64 || command -v wine || { [ -x /usr/lib/wine/wine64 ] && echo /usr/lib/wine/wine64; }) || wine=""
mingw=$(command -v x86_64-w64-mingw32-g++-posix) || mingw=""
skipped=() left=()
has() {  # machine, its Debian packages, tools...
  local machine=$1 packages=$2 tool
  shift 2
  for tool in "$@"; do
    [ -n "$tool" ] && command -v "$tool" >/dev/null && continue
    skipped+=("$machine (Debian: $packages)")
    return 1
  done
  left+=("$machine")
}
has powerpc "g++-powerpc-linux-gnu qemu-user" powerpc-linux-gnu-g++ qemu-ppc
has aarch64 "g++-aarch64-linux-gnu qemu-user" aarch64-linux-gnu-g++ qemu-aarch64
has windows "g++-mingw-w64-x86-64-posix wine64" "$mingw" "$wine"
wasm_packages="clang-14 lld-14 wasi-libc libc++-16-dev-wasm32 libclang-rt-14-dev-wasm32 nodejs"
if printf '#include <string>\nint main() { std::string().c_str(); }\n' |
  clang++ --target=wasm32-wasi -std=c++20 -fno-exceptions -xc++ - -o "$kept/probe.wasm" 2>/dev/null; then
  has wasm "$wasm_packages" node
else
  skipped+=("wasm (Debian: $wasm_packages)")
fi
if [ "${#skipped[@]}" -gt 0 ]; then printf 'SKIPPED, compiler or emulator missing: %s\n' "${skipped[@]}"; fi
if [ "${#left[@]}" -eq 0 ]; then exit 77; fi
tried() { [[ " ${left[*]} " == *" $1 "* ]]; }

# fmt's headers and nothing else: /usr/include belongs to the host.
mkdir -p "$kept/include"
fmt=$(printf '#include <fmt/core.h>\n' | "$compiler" -xc++ -std=c++20 -M - | tr ' ' '\n' | grep -m 1 '/fmt/core\.h$')
ln -sfn "$(dirname "$fmt")" "$kept/include/fmt"

launcher=()
command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
"$pelt" bake --setup tiny --out "$kept/tiny.groom" >/dev/null || exit 1
# As many frames as the golden digests have.
"$pelt" trace record --scene tiny --frames 20 --out "$kept/tiny.peltinput" >/dev/null || exit 1

failures=0
fail() {
  echo "FAILED: $*" >&2
  failures=$((failures + 1))
}
# try NAME "RUN PREFIX" CMAKE ARGUMENTS...: builds and runs, if NAME's tools are here.
try() {
  local name=$1 prefix=$2 start=$SECONDS
  shift 2
  tried "$name" || return
  { cmake -G Ninja -S "$source_dir/tests/porting/cross" -B "$kept/$name" -DCMAKE_BUILD_TYPE=Release -DFMT_INCLUDE="$kept/include" \
    "${launcher[@]}" "$@" && cmake --build "$kept/$name" --target cross_frames cross_golden; } >"$kept/$name.log" 2>&1 ||
    { grep -E -A 20 -m 3 'FAILED|error:' "$kept/$name.log" >&2; fail "$name: build"; return; }
  echo "== $name: built in $((SECONDS - start)) s"
  run "$name" "$prefix" "$kept/$name"
}
# run NAME "RUN PREFIX" DIR: the programs in DIR; what the first printed goes into NAME.out.
run() {
  local name=$1 prefix=$2 dir=$3 start=$SECONDS end=""
  [ "$name" = windows ] && end=.exe
  # shellcheck disable=SC2086
  $prefix "$dir/cross_frames$end" "$kept/tiny.groom" "$frames" | tr -d '\r' >"$kept/$name.out" || fail "$name: exit $?"
  echo "== $name: ran in $((SECONDS - start)) s"
  cat "$kept/$name.out"
  rm -f "$kept/$name.digests"
  # shellcheck disable=SC2086
  $prefix "$dir/cross_golden$end" "$kept/tiny.peltinput" "$kept/$name.digests" || fail "$name: another digest than recorded"
  "$pelt" diff "$source_dir/traces/golden/tiny.digests" "$kept/$name.digests" || fail "$name: not the golden digests"
  grep '^same' "$kept/$name.out" >"$kept/$name.same"
  [ "$(wc -l <"$kept/$name.same")" -eq 3 ] || fail "$name: printed no digest"
  [ "$name" = host ] || diff "$kept/host.same" "$kept/$name.same" >&2 || fail "$name: other bits than the host"
}
run host "" "$host_dir"
try powerpc "qemu-ppc -cpu 7447a" -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=ppc -DCMAKE_CXX_COMPILER=powerpc-linux-gnu-g++ \
  "-DCMAKE_CXX_FLAGS=-mcpu=cell -maltivec -mno-powerpc-gpopt -mno-mfcrf" -DCMAKE_EXE_LINKER_FLAGS=-static
try aarch64 qemu-aarch64 -DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR=aarch64 \
  -DCMAKE_CXX_COMPILER=aarch64-linux-gnu-g++ -DCMAKE_EXE_LINKER_FLAGS=-static
# The prefix (wine's idea of a disk) stays beside the build; making it takes half a minute, once.
export WINEPREFIX=$kept/wine WINEDEBUG=-all WINEDLLOVERRIDES="mscoree=;mshtml="
narrow=(-DPELT_ISAS=avx2)
if [ "${PELT_CROSS_ISAS:-}" = all ]; then narrow=(-DPELT_ISAS=); fi
try windows "$wine" "${narrow[@]}" -DCMAKE_SYSTEM_NAME=Windows -DCMAKE_SYSTEM_PROCESSOR=x86_64 -DCMAKE_CXX_COMPILER="$mingw" \
  -DCMAKE_EXE_LINKER_FLAGS=-static
try wasm "node --no-warnings $source_dir/tests/porting/wasi.mjs" -DCMAKE_TOOLCHAIN_FILE="$source_dir/bench/page/wasm/toolchain.cmake"
if tried wasm; then  # what a page shows
  "$pelt" trace record --scene monster --frames 10 --out "$kept/monster.peltinput" >/dev/null || exit 1
  node --no-warnings "$source_dir/tests/porting/wasi.mjs" "$kept/wasm/cross_golden" "$kept/monster.peltinput" \
    "$kept/monster.digests" || fail "wasm: another digest of monster than recorded"
  grep -q '32-bit' "$kept/wasm.out" || fail "wasm has no 32-bit pointers"
  [ "$(grep -c '^here .*the same digest' "$kept/wasm.out")" -eq 6 ] || fail "wasm ran without its vectors"
fi
if tried windows; then
  # As many sets of kernels as here, or the reference and one, each with three executors.
  here=$(grep -c '^here .*the same digest' "$kept/host.out") there=$(grep -c '^here .*the same digest' "$kept/windows.out")
  if [ "${PELT_CROSS_ISAS:-}" != all ] && [ "$here" -gt 6 ]; then here=6; fi
  [ "$there" -ge "$here" ] || fail "windows: $there combinations of kernels and executor, the host has $here"
fi
tried powerpc && { grep -q 'big-endian' "$kept/powerpc.out" || fail "powerpc is not big-endian"; }
[ "$failures" -eq 0 ] || exit 1
echo "the same bits here and on: ${left[*]}"
