#!/usr/bin/env bash
# particles.cpp, built with an installed Pelt, runs: every executor's bits are one, and an SPU has a price.
#   particles_test.sh BUILD_DIR COMPILER
# BUILD_DIR has everything built that is installed.
set -euo pipefail
export CCACHE_NOHASHDIR=1
build=$(realpath "$1") compiler=$2
source_dir=$(dirname "$(realpath "$0")")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
quietly() {
  "$@" >"$work/log" 2>&1 || { tail -n 40 "$work/log" >&2; echo "FAILED: $*" >&2; exit 1; }
}
launcher=()
command -v ccache >/dev/null && launcher=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
# Every line that jobs/README.md shows of it stands in it, in that order.
awk '/^## Kernels of your own/ { there = 1 } /^```$/ { inside = 0 } inside && NF && !/^ *\/\/ \.\.\.$/ { print }
     there && /^```cpp$/ { inside = 1 } /^## Try your door/ { exit }' "$source_dir/../../../jobs/README.md" >"$work/shown"
[ "$(wc -l <"$work/shown")" -ge 40 ] || { echo "FAILED: jobs/README.md shows no program" >&2; exit 1; }
awk 'NR == FNR { shown[++count] = $0; next } at < count && $0 == shown[at + 1] { ++at }
     END { if (at < count) { print "FAILED: not in particles.cpp: " shown[at + 1]; exit 1 } }' \
  "$work/shown" "$source_dir/particles.cpp" >&2
quietly cmake --install "$build" --prefix "$work/pelt"
quietly cmake -G Ninja -S "$source_dir" -B "$work/build" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release \
  -DCMAKE_PREFIX_PATH="$work/pelt" "${launcher[@]}"
quietly cmake --build "$work/build"
"$work/build/particles" | tee "$work/said"
grep -qE '^2 passes, [0-9.]+ us on an SPU, digest [0-9a-f]{16}$' "$work/said"
