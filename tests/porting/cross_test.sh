#!/usr/bin/env bash
# The same bits on another machine: a Linux under qemu (the case below says which: two byte orders, 32 and 64 bits, with
# vectors and without), Windows (another ABI, C library and thread library) under wine, WebAssembly in Node; and by
# clang for this one. Builds tests/porting/cross with Debian's cross compilers, compares what it prints with the host's,
# what it computes from recordings of SCENES with their golden digests, and the recordings that are kept
# beside those with their own. Exit code 77 if the machine's compiler or emulator is missing.
#   cross_test.sh MACHINE BUILD_DIR SOURCE_DIR COMPILER PELT HOST_DIR SCENES...
# COMPILER is the host's; PELT bakes the groom; HOST_DIR has the host's cross_frames and cross_golden. WebAssembly's are
# built where BUILD_DIR has the module of the page (PELT_WASM), clang's where clang-sanitize stands beside BUILD_DIR: all
# but themselves is compiled there.
set -uo pipefail
export CCACHE_NOHASHDIR=1
machine=$1 build=$(realpath "$2") source_dir=$(realpath "$3") compiler=$4 pelt=$(realpath "$5") host_dir=$(realpath "$6") frames=8
scenes=("${@:7}")
kept=$build/cross_test/$machine
mkdir -p "$kept"

has() {  # its Debian packages, tools...
  local packages=$1 tool
  shift
  for tool in "$@"; do
    [ -n "$tool" ] && command -v "$tool" >/dev/null && continue
    echo "SKIPPED, compiler or emulator missing (Debian: $packages)"
    exit 77
  done
}
failures=0
fail() {
  echo "FAILED: $*" >&2
  failures=$((failures + 1))
}
built() {  # folder, cmake arguments...
  local folder=$1 start=$SECONDS
  shift
  { [ $# -eq 0 ] || cmake -G Ninja -S "$source_dir/tests/porting/cross" -B "$folder" -DCMAKE_BUILD_TYPE=Release \
    -DFMT_INCLUDE="$kept/include" "${launcher[@]}" "$@"; } >"$kept/log" 2>&1 &&
    cmake --build "$folder" --target cross_frames cross_golden >>"$kept/log" 2>&1 ||
    { grep -E -A 20 -m 3 'FAILED|error:' "$kept/log" >&2 || tail -n 40 "$kept/log" >&2; fail "build"; exit 1; }
  echo "== built in $((SECONDS - start)) s"
}
# run NAME DIR ENDING RUN PREFIX...: the programs in DIR; what the first printed goes into NAME.out.
run() {
  local name=$1 dir=$2 end=$3 start=$SECONDS
  shift 3
  "$@" "$dir/cross_frames$end" "$kept/tiny.groom" "$frames" | tr -d '\r' >"$kept/$name.out" || fail "$name: exit $?"
  cat "$kept/$name.out"
  local recording scene
  for recording in "${recordings[@]}"; do
    scene=$(basename "$recording" .peltinput)
    rm -f "$kept/$name.digests"
    "$@" "$dir/cross_golden$end" "$recording" "$kept/$name.digests" || fail "$name, $scene: another digest than recorded"
    [ "$recording" = "$kept/$scene.peltinput" ] || continue
    "$pelt" diff "$golden/$scene.digests" "$kept/$name.digests" || fail "$name, $scene: not the golden digests"
  done
  grep '^same' "$kept/$name.out" >"$kept/$name.same"
  [ "$(wc -l <"$kept/$name.same")" -eq 3 ] || fail "$name: printed no digest"
  echo "== $name: ran in $((SECONDS - start)) s"
}
combinations() { grep -c '^here .*the same digest' "$kept/$1.out"; }  # of kernels and executor

end="" prefix=(env) arguments=() folder=$kept/build programs=$kept/build
linux() {  # COMPILER'S TRIPLET PROCESSOR FLAGS EMULATOR [its arguments]
  local triplet=$1 processor=$2 flags=$3
  shift 3
  has "g++-$triplet qemu-user" "$triplet-g++" "$1"
  prefix=("$@")
  arguments=(-DCMAKE_SYSTEM_NAME=Linux -DCMAKE_SYSTEM_PROCESSOR="$processor" -DCMAKE_CXX_COMPILER="$triplet-g++"
    "-DCMAKE_CXX_FLAGS=$flags" -DCMAKE_EXE_LINKER_FLAGS=-static)
}
case $machine in
powerpc) linux powerpc-linux-gnu ppc "-mcpu=cell -maltivec -mno-powerpc-gpopt -mno-mfcrf" qemu-ppc -cpu 7447a ;;
ppc64le) linux powerpc64le-linux-gnu ppc64le "" qemu-ppc64le ;;
s390x) linux s390x-linux-gnu s390x "" qemu-s390x ;;
aarch64) linux aarch64-linux-gnu aarch64 "" qemu-aarch64 ;;
armhf) linux arm-linux-gnueabihf arm "-mfpu=vfpv3-d16" qemu-arm ;;  # NEON's vectors have no denormals there
riscv64) linux riscv64-linux-gnu riscv64 "" qemu-riscv64 ;;
i686) linux i686-linux-gnu i686 "-msse2 -mfpmath=sse" qemu-i386 ;;
windows)
  # Debian's wine64 is not on the path; the package `wine` puts a wrapper there.
  wine=$(command -v wine64 || command -v wine || { [ -x /usr/lib/wine/wine64 ] && echo /usr/lib/wine/wine64; }) || wine=""
  mingw=$(command -v x86_64-w64-mingw32-g++-posix) || mingw=""
  has "g++-mingw-w64-x86-64-posix wine64" "$mingw" "$wine"
  # The prefix (wine's idea of a disk) stays beside the build; making it takes half a minute, once.
  export WINEPREFIX=$kept/wine WINEDEBUG=-all WINEDLLOVERRIDES="mscoree=;mshtml="
  end=.exe prefix=("$wine")
  arguments=(-DCMAKE_SYSTEM_NAME=Windows -DCMAKE_SYSTEM_PROCESSOR=x86_64 -DCMAKE_CXX_COMPILER="$mingw"
    -DCMAKE_EXE_LINKER_FLAGS=-static) ;;
wasm)
  has "nodejs" node
  folder=$build/bench/viewer/module programs=$build/bench/viewer/module/cross prefix=(node --no-warnings "$source_dir/tests/porting/wasi.mjs") ;;
clang) folder=$build/../clang-sanitize programs=$build/../clang-sanitize/tests/porting/cross ;;
*) echo "no machine '$machine'" >&2; exit 2 ;;
esac
if [ "${#arguments[@]}" -eq 0 ] && [ ! -f "$folder/build.ninja" ]; then
  echo "SKIPPED: there is no build in $folder"
  exit 77
fi

# fmt's headers and nothing else: /usr/include belongs to the host.
mkdir -p "$kept/include"
fmt=$(printf '#include <fmt/core.h>\n' | "$compiler" -xc++ -std=c++20 -M - | tr ' ' '\n' | grep -m 1 '/fmt/core\.h$')
ln -sfn "$(dirname "$fmt")" "$kept/include/fmt"
launcher=()
command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
built "$folder" "${arguments[@]}"

"$pelt" bake --setup tiny --out "$kept/tiny.groom" >/dev/null || exit 1
golden=$source_dir/traces/golden
shopt -s nullglob
recordings=("$golden"/*.peltinput)
for scene in "${scenes[@]}"; do  # as many frames as the golden digests have
  "$pelt" trace record --scene "$scene" --frames "$(sed -n 's/^frames //p' "$golden/$scene.digests")" \
    --out "$kept/$scene.peltinput" >/dev/null || exit 1
  recordings+=("$kept/$scene.peltinput")
done
run host "$host_dir" "" env
run "$machine" "$programs" "$end" "${prefix[@]}"
diff "$kept/host.same" "$kept/$machine.same" >&2 || fail "other bits than the host"
case $machine in
powerpc | s390x) grep -q 'big-endian' "$kept/$machine.out" || fail "$machine is not big-endian" ;;
windows)
  [ "$(combinations windows)" -ge "$(combinations host)" ] || fail "$(combinations windows) combinations of kernels and executor, the host has $(combinations host)" ;;
wasm)
  grep -q '32-bit' "$kept/wasm.out" || fail "wasm has no 32-bit pointers"
  [ "$(combinations wasm)" -eq 6 ] || fail "wasm ran without its vectors" ;;
esac
[ "$failures" -eq 0 ] || exit 1
echo "the same bits here and on $machine"
