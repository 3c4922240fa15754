#!/usr/bin/env bash
# Holds the .cpp files at the top of core, jobs, platform_sim and traces, with the headers they include from there,
# to .clang-tidy; and that .clang-tidy finds a fault that is planted.
# Not the folders below, the tests and the command, for the time it takes: most of it goes into headers, which is why
# files of a room that a build of everything compiles together (PELT_WHOLE) are one translation unit here too. Of the
# enabled checks misc-unused-alias-decls alone says nothing of what a unit includes.
#   clang_tidy_test.sh BUILD_DIR SOURCE_DIR COMPILER
# Exit code 77 without clang-tidy 14: its checks are groups, and other versions have others in them.
set -uo pipefail
build=$1 source=$2 compiler=$3
tidy=
for candidate in clang-tidy-14 clang-tidy; do
  command -v "$candidate" >/dev/null && "$candidate" --version | grep -q 'version 14\.' && { tidy=$candidate; break; }
done
[ -n "$tidy" ] || { echo "clang-tidy 14 is not here (Debian: clang-tidy): nothing is looked at"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tidy_up() {
  "$tidy" --quiet --config-file="$source/.clang-tidy" --header-filter='/(core|jobs|platform_sim|traces)/(.*\.hpp|[a-z_]+\.cpp)$' "$@"
}
unit_of() { printf '#include "%s"  // NOLINT(bugprone-suspicious-include)\n' "$@"; }

mkdir "$work/core"
printf '#include <string>\n#include <utility>\nsize_t f(std::string a) {\n  std::string b = std::move(a);\n  return a.size() + b.size();\n}\n' \
  >"$work/core/planted.cpp"
unit_of core/planted.cpp >"$work/unit.cpp"
tidy_up "$work/unit.cpp" -- -std=c++20 >"$work/log" 2>&1 &&
  { echo "FAILED: a string that is used after it was moved goes unseen"; exit 1; }
grep -q 'bugprone-use-after-move' "$work/log" || { echo "FAILED: a planted fault is refused for another reason:"; cat "$work/log"; exit 1; }

# How files are compiled, and which of them together.
database=$build/clang_tidy
cmake -S "$source" -B "$database" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DPELT_WHOLE=ON \
  -DPELT_ISAS=reference -DPELT_TESTS=OFF -DPELT_BENCH=OFF -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >"$work/log" 2>&1 ||
  { tail -n 40 "$work/log"; echo "FAILED: cmake"; exit 1; }
cd "$source" || exit 1
sed -n "s,^#include \"$PWD/\(.*\)\"$,\1,p" "$database"/*/CMakeFiles/*/Unity/*.cxx >"$work/together"
files=0 look_at=()
for room in core jobs platform_sim traces; do
  unit=()
  for file in "$room"/*.cpp; do
    if grep -qx "$file" "$work/together"; then unit+=("$file"); else look_at+=("$file"); fi
    files=$((files + 1))
  done
  # In the place of the build's own first one, whose flags are known.
  if [ "${#unit[@]}" -gt 0 ]; then
    place=$database/$room/CMakeFiles/pelt_$room.dir/Unity/unity_0_cxx.cxx
    unit_of "${unit[@]}" >"$place"
    look_at=("$place" "${look_at[@]}")
  fi
done
[ "$files" -ge 30 ] || { echo "FAILED: looked at $files files only"; exit 1; }
export -f tidy_up
export tidy source
printf '%s\n' "${look_at[@]}" | xargs -P "$(nproc)" -n 1 bash -c 'tidy_up --extra-arg=-Wno-unknown-warning-option -p "$0" "$1"' "$database" 2>"$work/errors" ||
  { cat "$work/errors"; echo "FAILED: what is said above; a false alarm is named in .clang-tidy, with the reason"; exit 1; }
echo "$files files hold to .clang-tidy"
