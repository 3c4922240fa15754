#!/usr/bin/env bash
# Pelt as other projects get it: installed and found by CMake, installed and found by pkg-config, and part
# of their own build, without exceptions and RTTI. Each builds the program in tests/porting/outside
# and the README's example; those that print a digest must
# print the same one, and the example, which prints what it would draw, the same lines.
#   package_test.sh BUILD_DIR SOURCE_DIR COMPILER PELT
# BUILD_DIR has everything built; PELT is the command, which bakes the groom.
set -uo pipefail
export CCACHE_NOHASHDIR=1
build=$(realpath "$1") source_dir=$(realpath "$2") compiler=$3 pelt=$(realpath "$4")
outside=$source_dir/tests/porting/outside
# Parts of another build share what they compiled with the last run of this test.
kept=$build/package_test
mkdir -p "$kept"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failures=0
fail() {
  echo "FAILED: $*" >&2
  failures=$((failures + 1))
}
quietly() {  # command...: its output only if it fails
  "$@" >"$work/log" 2>&1 || { tail -n 40 "$work/log" >&2; fail "$*"; return 1; }
}
launcher=()
command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
outside_build() {  # folder, cmake arguments...
  local folder=$1
  shift
  quietly cmake -G Ninja -S "$outside" -B "$folder" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release "$@" &&
    quietly cmake --build "$folder"
}

# The first C++ block of the README, without the fences, is a whole program.
awk '/^```cpp$/ { inside = 1; next } /^```$/ { if (inside) exit } inside' "$source_dir/README.md" >"$work/embedding.cpp"
grep -q 'int main' "$work/embedding.cpp" || fail "the README's first cpp block is no program"
lines=$(grep -c . "$work/embedding.cpp")
[ "$lines" -le 25 ] || fail "the README's example has grown to $lines lines"
"$pelt" bake --setup tiny --out "$work/tiny.groom" >/dev/null || fail "pelt bake"

expect_digest() {  # how it was built, program
  local found
  found=$(set -o pipefail; "$2" "$work/tiny.groom" | tail -n 1) || fail "$1: the program failed"
  [[ "$found" =~ ^[0-9a-f]{16}$ ]] || fail "$1: printed '$found', no digest"
  : "${digest:=$found}"
  [ "$found" = "$digest" ] || fail "$1: digest $found, not $digest"
  echo "$1: $found"
}

expect_draws() {  # how it was built, the README's example
  local found
  found=$("$2" "$work/tiny.groom") || fail "$1: the example failed"
  grep -qE '^ribbons: [1-9][0-9]* strands, [1-9][0-9]* bytes' <<<"$found" || fail "$1: no ribbons in '$found'"
  : "${draws:=$found}"
  [ "$found" = "$draws" ] || fail "$1: draws '$found', not '$draws'"
  echo "$1: $(wc -l <<<"$found") layers to draw"
}

# The porting guide describes every member of the frame.
members=$("$compiler" -x c -fpreprocessed -E -P "$source_dir/jobs/pelt.h" |
  sed -n '/^typedef struct PeltFrame {/,/^} PeltFrame;/p' | sed 's/^} PeltFrame.*//' |
  grep -oE '[a-z_]+(\)?\[[0-9]+\])?[,;]' | grep -oE '^[a-z_]+' | sort -u)
[ "$(wc -w <<<"$members")" -ge 40 ] || fail "found $(wc -w <<<"$members") members of PeltFrame only"
for member in $members; do
  [ "$member" = wind ] || grep -q "^|.*|.*\`$member\`.*|.*|.*|" "$source_dir/jobs/README.md" || fail "jobs/README.md does not describe $member"
done

# 1. Installed, and then moved: nothing may remember where it was built or first installed.
quietly cmake --install "$build" --prefix "$work/first"
mv "$work/first" "$work/moved"
grep -rlF -e "$build" -e "$source_dir" -e "$work/first" "$work/moved" --include='*.cmake' --include='*.pc' --include='*.hpp' &&
  fail "an installed file names the build"
outside_build "$work/found" "${launcher[@]}" -DCMAKE_PREFIX_PATH="$work/moved" -DEMBEDDING="$work/embedding.cpp" && {
  expect_draws "find_package" "$work/found/embedding"
  expect_digest "find_package, an engine in C" "$work/found/c_program"
  expect_digest "find_package, an engine in C++" "$work/found/cpp_program"
  expect_digest "find_package, second program" "$work/found/no_exceptions"
  expect_digest "find_package, in a shared library" "$work/found/plugin_host"
  "$work/found/own_names" || fail "own_names"
}
# The pages for engines and the shaders lie there too, and every link of theirs leads to something.
pages=$work/moved/share/pelt/jobs
for page in README.md DRAWING.md; do
  [ -s "$pages/$page" ] || fail "$page is not installed"
  links=$(grep -oE '\]\([^)#:]+' "$pages/$page" | sed 's/^](//')
  [ "$(wc -l <<<"$links")" -ge 5 ] || fail "$page has lost its links"
  for link in $links; do [ -e "$pages/$link" ] || fail "$page links $link, which is not installed"; done
done
diff -r "$source_dir/jobs/shaders" "$pages/shaders" || fail "other shaders are installed"
# What was not asked for is not needed; what is asked for and was never built is refused by name.
if cmake -S "$outside" -B "$work/none" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_PREFIX_PATH="$work/nowhere" \
  >"$work/log" 2>&1; then
  fail "found a pelt that is not there"
fi
mkdir "$work/extra"
cat >"$work/extra/CMakeLists.txt" <<'EOF'
cmake_minimum_required(VERSION 3.24)
project(extra LANGUAGES CXX)
find_package(pelt REQUIRED COMPONENTS groom tbb)
add_executable(extra extra.cpp)
target_link_libraries(extra PRIVATE pelt::groom pelt::tbb)
EOF
cat >"$work/extra/extra.cpp" <<'EOF'
#include "pelt/core/character/builtin_character.hpp"
#include "pelt/core/character/gltf_import.hpp"
#include "pelt/core/character/pose.hpp"
#include "pelt/core/groom/bake.hpp"
#include "pelt/jobs/tbb_executor.hpp"
int main() {
  pelt::TbbExecutor executor(2);
  try {
    pelt::ReadFurSetup("[[layer]]\nlenght = 1\n", "typo.toml", ".");
  } catch (const pelt::Error&) {
    return executor.workers() == 2 ? 0 : 1;
  }
  return 1;
}
EOF
quietly cmake -G Ninja -S "$work/extra" -B "$work/extra/build" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_PREFIX_PATH="$work/moved" &&
  quietly cmake --build "$work/extra/build" && quietly "$work/extra/build/extra"
sed -i 's/groom tbb/teapot/' "$work/extra/CMakeLists.txt"
cmake -S "$work/extra" -B "$work/teapot" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_PREFIX_PATH="$work/moved" >"$work/log" 2>&1 &&
  fail "a component that does not exist was found"
grep -q teapot "$work/log" || fail "the missing component is not named"
# The yardstick as a project of its own; two of its files, for the time it takes.
quietly cmake -G Ninja -S "$source_dir/bench/accuracy" -B "$work/accuracy" "${launcher[@]}" -DCMAKE_CXX_COMPILER="$compiler" \
  -DCMAKE_PREFIX_PATH="$work/moved" &&
  quietly cmake --build "$work/accuracy" --target CMakeFiles/pelt_accuracy.dir/{modal_solver,curve_strand}.cpp.o

# 2. pkg-config; and every public header compiles alone.
if command -v pkg-config >/dev/null; then
  export PKG_CONFIG_PATH
  PKG_CONFIG_PATH=$(dirname "$(find "$work/moved" -name pelt.pc)")
  read -ra flags <<<"$(pkg-config --cflags pelt)"
  read -ra libs <<<"$(pkg-config --static --libs pelt)"
  quietly "$compiler" -std=c++20 "${flags[@]}" "$work/embedding.cpp" "${libs[@]}" -o "$work/by_pkg_config" &&
    expect_draws "pkg-config" "$work/by_pkg_config"
  quietly "$compiler" -std=c++20 "${flags[@]}" "$outside/no_exceptions.cpp" "${libs[@]}" -o "$work/all_libs" &&
    expect_digest "pkg-config, second program" "$work/all_libs"
  # The two command lines of the porting guide, as they stand there; c_program and draw_frame.h need the maths library.
  lines=$(grep -E '^    c(c|\+\+) .*pkg-config' "$source_dir/jobs/README.md")
  [ "$(wc -l <<<"$lines")" -eq 2 ] || fail "jobs/README.md has no two command lines"
  mkdir "$work/engine"
  cp "$outside"/draw_frame.h "$work/engine"
  cp "$outside/c_program.c" "$work/engine/engine.c"
  cp "$outside/cpp_program.cpp" "$work/engine/engine.cpp"
  while read -r line; do
    line=${line/#cc /gcc } line=${line/#c++ /"$compiler" }
    rm -f "$work/engine/engine"
    (cd "$work/engine" && quietly bash -c "$line") || fail "$line"
    expect_digest "${line%% *}, as jobs/README.md has it" "$work/engine/engine"
  done <<<"$lines"
  # Each header of the list compiles alone, those whose library is here; nothing else lies there but what they include.
  list=$source_dir/core/package/public_headers.txt
  alone() {  # header
    printf '#include "pelt/%s"\n' "$1" >"$work/alone_${1//\//_}.cpp"
    quietly "$compiler" -std=c++20 -fsyntax-only -Wall -Wextra "${flags[@]}" "$work/alone_${1//\//_}.cpp" ||
      fail "pelt/$1 does not compile alone"
  }
  for header in $(grep '^[a-z]' "$list" | grep -vE 'adapters/(bullet|openmp|tbb)'); do alone "$header"; done
  (cd "$work/moved/include/pelt" && find . -type f | sed 's,^\./,,' | sort) >"$work/installed"
  for header in core/float_rules.hpp core/kernels/wind.hpp core/groom/groom_fields.hpp jobs/input_check.hpp; do
    grep -qx "$header" "$work/installed" && fail "$header is Pelt's own, and was installed"
  done
else
  echo "pkg-config is missing: not tested" >&2
fi

# 3. Part of the project's own build, without exceptions and RTTI: Pelt adds its five libraries and nothing to see or to
# test. With files by eights and no vectors, for the time it takes; what a file forgets to include, cross_test.sh sees.
outside_build "$kept/part" "${launcher[@]}" -DOUTSIDE_PELT_SOURCE="$source_dir" -DPELT_WHOLE=ON -DPELT_ISAS=reference \
  "-DCMAKE_CXX_FLAGS=-fno-exceptions -fno-rtti" -DEMBEDDING="$work/embedding.cpp" && {
  expect_draws "FetchContent" "$kept/part/embedding"
  expect_digest "FetchContent, an engine in C" "$kept/part/c_program"
  expect_digest "FetchContent, in a shared library" "$kept/part/plugin_host"
  expect_digest "FetchContent, second program" "$kept/part/no_exceptions"
  "$kept/part/own_names" || fail "own_names as part of the build"
  cmake -N -L "$kept/part" | grep '^PELT_' && fail "options of Pelt's show in the parent's cache"
  (cd "$kept/part" && ctest -N) | grep -q 'Total Tests: 0' || fail "Pelt's tests are among the parent's"
  cmake --build "$kept/part" --target help | grep -E 'pelt_\w*(test|bench|scenarios|groom|tbb)|gtest|benchmark' &&
    fail "targets that the parent did not ask for"
}

# The kernels with vectors, which that build leaves out, under the same warnings and without exceptions and RTTI.
if [ "$(uname -m)" = x86_64 ]; then
  kernels() {  # vector, flags...
    quietly "$compiler" -std=c++20 -ffp-contract=off -fno-exceptions -fno-rtti -fsyntax-only -I"$source_dir" -DPELT_CHUNK_STRANDS=128 -DPELT_KERNELS=Kernels \
      -DPELT_VECTOR="Vec<$1>" "${@:2}" -Wall -Wextra -Wpedantic -Wold-style-cast -Wshadow -Wcast-qual -Wextra-semi -Wundef -Werror \
      "$source_dir/core/kernels/frame_table.cpp"
  }
  kernels IsaSse4 -msse4.1
  kernels IsaAvx2 -mavx2 -mno-fma
  kernels IsaAvx512 -mavx512f -mavx512dq -mavx512bw -mavx512vl
fi

[ "$failures" -eq 0 ] || exit 1
echo "all passed"
