#!/usr/bin/env bash
# Compiles every shader in jobs/shaders, and holds that each output of core/outputs.hpp has one in GLSL
# and one in HLSL, which jobs/DRAWING.md names.
# Arguments: glslangValidator (empty: not here), the source directory.
set -uo pipefail
glslang=$1 source=$2
failed=0
fail() {
  echo "FAILED: $*"
  failed=1
}
outputs=$(sed -n '/ kRows\[\] = {/,/^};/p' "$source/core/outputs.hpp" | grep -oE '"[a-z_]+"' | tr -d '"')
[ "$(wc -w <<<"$outputs")" -ge 2 ] || fail "no outputs found in core/outputs.hpp"
for output in $outputs; do
  for shader in "$output.vert" "$output.vs.hlsl"; do
    [ -f "$source/jobs/shaders/$shader" ] || fail "the output $output has no jobs/shaders/$shader"
    grep -q "shaders/$shader" "$source/jobs/DRAWING.md" || fail "jobs/DRAWING.md does not name $shader"
  done
done
[ -n "$glslang" ] || { echo "glslang is not here: shaders are not compiled"; exit $((failed ? 1 : 77)); }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
compile() {
  "$glslang" "$@" -o "$work/out.spv" >"$work/log" 2>&1 || { cat "$work/log"; fail "$*"; }
}
for shader in "$source"/jobs/shaders/*.vert; do
  compile -V "$shader"
  compile -G "$shader"
done
for shader in "$source"/jobs/shaders/*.hlsl; do compile -V -D -e main -S vert "$shader"; done
[ "$failed" -eq 0 ] && echo "compiled for Vulkan, OpenGL and Direct3D: $(ls "$source/jobs/shaders" | wc -l) files"
exit "$failed"
