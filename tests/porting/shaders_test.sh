#!/usr/bin/env bash
# Compiles every shader in jobs/shaders, and holds that each output of core/outputs.hpp has one in GLSL
# and one in HLSL, which jobs/DRAWING.md names. Compiles the functions in bench/shading/shaders as GLSL 3.30 core and
# as ES 3.00 (bench/shading/shading.hpp compiles the same text as C++), and the passes that use them.
# Counts the instructions of relief.frag and of a plain surface, which jobs/DRAWING.md states.
# Arguments: glslangValidator (empty: not here), the source directory.
set -uo pipefail
glslang=$1 source=$2
failed=0
fail() {
  echo "FAILED: $*"
  failed=1
}
rows=$(sed -n '/ kEntries\[\] = {/,/^};/p' "$source/core/outputs.hpp")
outputs=$(grep -oE '"[a-z_]+"' <<<"$rows" | tr -d '"')
of_strands=$(grep -v SkinEntry <<<"$rows" | grep -oE '"[a-z_]+"' | tr -d '"')  # which the passes read as strands
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
for shader in "$source"/jobs/shaders/*.{vert,frag}; do
  compile -V "$shader"
  compile -G "$shader"
done
for shader in "$source"/jobs/shaders/*.vs.hlsl; do compile -V -D -e main -S vert "$shader"; done
for shader in "$source"/jobs/shaders/*.ps.hlsl; do compile -V -D -e main -S frag "$shader"; done
# Instructions of SPIR-V after its optimiser, those of a loop once; other versions of the tools may differ by 5 %.
count() { spirv-opt -O "$work/out.spv" -o "$work/small.spv" && spirv-dis "$work/small.spv" |
  awk '/OpFunction /{in_it = 1} in_it && !/OpFunction|OpLabel|OpVariable|OpReturn/{++n} END{print n + 0}'; }
if { command -v spirv-opt && command -v spirv-dis; } >/dev/null; then
  # The same without what chooses the number of steps.
  sed 's/float steps = ReliefSteps(.*;/float steps = march.most;/' "$source/jobs/shaders/relief.glsl" >"$work/relief.glsl"
  cp "$source/jobs/shaders/relief.frag" "$work/fixed_steps.frag"
  for shader in "$source/jobs/shaders/relief.frag" "$work/fixed_steps.frag" "$source/tests/porting/plain_surface.frag"; do
    compile -V "$shader"
    here=$(count) name=$(basename "$shader")
    stated=$(sed -n "s,.*$name)* | \([0-9]*\) |.*,\1,p" "$source/jobs/DRAWING.md")
    [[ $stated && $((20 * (here > stated ? here - stated : stated - here))) -le $stated ]] ||
      fail "$name has $here instructions; jobs/DRAWING.md says '$stated'"
    echo "$name: $here instructions"
  done
else
  echo "SKIPPED: no spirv-opt or spirv-dis (Debian: spirv-tools): instructions are not counted"
fi
shaders=$source/bench/shading/shaders
# own FILE: behind what it names, and READER where there is one, as a whole of that stage in both versions; what is
# otherwise with cards, in both ways.
own() {
  local file=$1 stage=$2 reader=${3:-}
  for version in "330 core" "300 es" "330 core|#define CARDS" "300 es|#define CARDS"; do
    [[ $version != *CARDS || $file == */strand* ]] || continue
    { echo "#version ${version/|/$'\n'}"
      cat "$shaders/dialect.glsl" "$source/jobs/shaders/fur_vertex.glsl"
      for before in $(sed -n 's,^// After: ,,p' "$file"); do
        cat "$shaders/$before" 2>/dev/null || cat "$source/jobs/shaders/$before"
      done
      [ -z "$reader" ] || cat "$reader"
      cat "$file"; } >"$work/whole.$stage"
    "$glslang" "$work/whole.$stage" >"$work/log" 2>&1 || { cat "$work/log"; fail "$file $reader as $version"; }
  done
}
for functions in "$shaders"/*_*.glsl "$shaders/studio.glsl" "$source/jobs/shaders/relief.glsl"; do own "$functions" frag; done
for pass in "$shaders"/passes/*.vert "$shaders"/passes/*.frag; do
  case $pass in
    */strand*.vert)
      for output in $of_strands; do own "$pass" vert "$shaders/passes/readers/$output.glsl"; done ;;
    *) own "$pass" "${pass##*.}" ;;
  esac
done
[ "$failed" -eq 0 ] && echo "compiled for Vulkan, OpenGL and Direct3D: $(ls "$source"/jobs/shaders/*.{v*,frag,ps.hlsl} | wc -l) files;" \
  "for OpenGL and OpenGL ES: $(find "$source/bench/shading/shaders" -type f | wc -l)"
exit "$failed"
