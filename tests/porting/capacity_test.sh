#!/usr/bin/env bash
# A program compiled for chunks of another capacity than the library's must not link, and the linker
# must name the capacity it asked for.
# Arguments: the compiler, the source directory, libpelt_core, the library's capacity.
set -euo pipefail
compiler=$1 source=$2 library=$3 capacity=$4
other=64
[ "$capacity" != 64 ] || other=128
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
printf '#include "core/chunk.hpp"\nint main() {}\n' >"$work/program.cpp"
link() { "$compiler" -std=c++20 -I"$source" -DPELT_CHUNK_STRANDS="$1" "$work/program.cpp" "$library" -o "$work/program" 2>&1; }
link "$capacity" || { echo "FAILED: the library's own capacity does not link"; exit 1; }
if out=$(link "$other"); then
  echo "FAILED: a program for chunks of $other strands links with a library for $capacity"
  exit 1
fi
grep -q "pelt_is_built_for_chunks_of_${other}_strands" <<<"$out" || { echo "FAILED: refused for another reason: $out"; exit 1; }
echo "refused, as it must be: chunks of $other strands"
