#!/usr/bin/env bash
# particles.cpp, built with an installed Pelt, runs: every executor's bits are one, and an SPU has a price. With a fault
# planted in a kernel of its own it ends with 1 and names kind, stage and stream.
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

# planted NAME WHAT LINE: the same program with one more line in `fall`, behind its first.
planted() {
  local folder=$work/$1
  mkdir "$folder"
  cp "$source_dir/CMakeLists.txt" "$folder"
  awk -v line="$3" '{ print } /Motion& m = / { print line; ++found } END { exit found != 1 }' "$source_dir/particles.cpp" \
    >"$folder/particles.cpp"
  quietly cmake -G Ninja -S "$folder" -B "$folder/build" -DCMAKE_CXX_COMPILER="$compiler" -DCMAKE_BUILD_TYPE=Release \
    -DCMAKE_PREFIX_PATH="$work/pelt" "${launcher[@]}"
  quietly cmake --build "$folder/build"
  if "$folder/build/particles" >"$work/said"; then echo "FAILED: $1 is not found" >&2; exit 1; fi
  grep -q "^$2" "$work/said" || { cat "$work/said" >&2; echo "FAILED: $1 is not named" >&2; exit 1; }
  echo "$1: $(grep -m 1 "^$2" "$work/said")"
}
planted "hidden static" "hidden-state: stage fall, item 0: .*'motion'" \
  '    static float runs = 0.0f; runs += 1.0f; m.velocity[0][0] += 1e-3f * runs;'
planted "undeclared read of a neighbour" "undeclared-read: stage fall, item 0: reads .* of item 1 of stream 'motion'" \
  '    Motion* volatile next = &m + 1; m.velocity[0][0] += 1e-3f * next->position[0][0];'
# What lies behind the last one is the next stream, still in the scene's memory.
planted "undeclared write to a neighbour" "undeclared-write: stage fall, item 0: writes .* of item 1 of stream 'motion'" \
  '    Motion* volatile next = &m + 1; next->position[0][0] = m.velocity[0][1];'
