#!/usr/bin/env bash
# The same bits on other processors: big-endian PowerPC with AltiVec (the consoles' family) and AArch64.
# Builds tests/porting/cross with Debian's cross compilers, runs it under qemu, compares what it prints with
# the host's, and holds what it computes from a recording of tiny against the golden digests. Exit code 77, and
# why, when a compiler or qemu is missing.
#   cross_test.sh BUILD_DIR SOURCE_DIR COMPILER PELT HOST_DIR [FRAMES]
# COMPILER is the host's; PELT bakes the groom; HOST_DIR has the host's cross_frames and cross_golden.
set -uo pipefail
export CCACHE_NOHASHDIR=1
mkdir -p "$1/cross_test"
kept=$(realpath "$1")/cross_test
source_dir=$(realpath "$2") compiler=$3 pelt=$(realpath "$4") host_dir=$(realpath "$5") frames=${6:-8}

for tool in powerpc-linux-gnu-g++ qemu-ppc aarch64-linux-gnu-g++ qemu-aarch64; do
  command -v "$tool" >/dev/null || missing+=("$tool")
done
if [ -n "${missing[*]:-}" ]; then
  echo "skipped, missing: ${missing[*]} (Debian: g++-powerpc-linux-gnu g++-aarch64-linux-gnu qemu-user)"
  exit 77
fi

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
# try NAME "RUN PREFIX" CMAKE ARGUMENTS...: builds and runs.
try() {
  local name=$1 prefix=$2 start=$SECONDS
  shift 2
  { cmake -G Ninja -S "$source_dir/tests/porting/cross" -B "$kept/$name" -DCMAKE_BUILD_TYPE=Release -DFMT_INCLUDE="$kept/include" \
    "${launcher[@]}" "$@" && cmake --build "$kept/$name" --target cross_frames cross_golden; } >"$kept/$name.log" 2>&1 ||
    { grep -E -A 20 -m 3 'FAILED|error:' "$kept/$name.log" >&2; fail "$name: build"; return; }
  echo "== $name: built in $((SECONDS - start)) s"
  run "$name" "$prefix" "$kept/$name"
}
# run NAME "RUN PREFIX" DIR: the programs in DIR; what the first printed goes into NAME.out.
run() {
  local name=$1 prefix=$2 dir=$3 start=$SECONDS
  # shellcheck disable=SC2086
  $prefix "$dir/cross_frames" "$kept/tiny.groom" "$frames" >"$kept/$name.out" || fail "$name: exit $?"
  echo "== $name: ran in $((SECONDS - start)) s"
  cat "$kept/$name.out"
  rm -f "$kept/$name.digests"
  # shellcheck disable=SC2086
  $prefix "$dir/cross_golden" "$kept/tiny.peltinput" "$kept/$name.digests" || fail "$name: another digest than recorded"
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
grep -q 'big-endian' "$kept/powerpc.out" || fail "powerpc is not big-endian"
[ "$failures" -eq 0 ] || exit 1
echo "the same bits on all three"
