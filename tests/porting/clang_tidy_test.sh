#!/usr/bin/env bash
# Holds the .cpp files at the top of core, jobs, platform_sim and traces, with the headers they include from there,
# to .clang-tidy; and that .clang-tidy finds a fault that is planted.
# Not the folders below, the tests and the command: a file takes some 10 s, most of it for its headers.
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

printf '#include <string>\n#include <utility>\nsize_t f(std::string a) {\n  std::string b = std::move(a);\n  return a.size() + b.size();\n}\n' \
  >"$work/planted.cpp"
"$tidy" --quiet --config-file="$source/.clang-tidy" "$work/planted.cpp" -- -std=c++20 >"$work/log" 2>&1 &&
  { echo "FAILED: a string that is used after it was moved goes unseen"; exit 1; }
grep -q 'bugprone-use-after-move' "$work/log" || { echo "FAILED: a planted fault is refused for another reason:"; cat "$work/log"; exit 1; }

# How each file is compiled; a build of everything knows eights of them only (PELT_WHOLE).
database=$build/clang_tidy
cmake -S "$source" -B "$database" -G Ninja -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=RelWithDebInfo -DPELT_WHOLE=OFF \
  -DPELT_ISAS=reference -DPELT_TEST_WIDE_KERNELS=OFF -DCMAKE_EXPORT_COMPILE_COMMANDS=ON >"$work/log" 2>&1 ||
  { tail -n 40 "$work/log"; echo "FAILED: cmake"; exit 1; }
cd "$source" || exit 1
files=(core/*.cpp jobs/*.cpp platform_sim/*.cpp traces/*.cpp)
[ "${#files[@]}" -ge 30 ] || { echo "FAILED: looked at ${#files[@]} files only"; exit 1; }
printf '%s\n' "${files[@]}" | xargs -P "$(nproc)" -n 2 "$tidy" --quiet -p "$database" 2>"$work/errors" ||
  { cat "$work/errors"; echo "FAILED: what is said above; a false alarm is named in .clang-tidy, with the reason"; exit 1; }
echo "${#files[@]} files hold to .clang-tidy"
