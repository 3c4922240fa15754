#!/usr/bin/env bash
# The machinery knows no fur: what plans, runs, hashes, checks and prices a frame sees neither fur's blocks nor its
# streams, not even through another header. And what an engine links without the offline side (README of jobs) includes
# no library.
#   no_fur_test.sh SOURCE_DIR
set -euo pipefail
cd "$1"
# Of fur, by name: the scene, and what is asked of a frame of fur.
fur='^(jobs/(scene|scene_fill|scene_layout|scene_snapshot|scene_strands|pose_gate|input_check|colliders|origins|draws|lod_budget|c_frame|c_interface)|platform_sim/pricing/record_stage)\.cpp$'
files=(traces/digest.cpp jobs/conformance.hpp jobs/*.cpp platform_sim/local_store.cpp platform_sim/pricing/*.cpp
       platform_sim/frame/*.cpp jobs/verify/*.cpp)

includes_of() {  # file...: each, and all that they include of the tree
  local -A seen=()
  local wanted=("$@")
  while [ ${#wanted[@]} -gt 0 ]; do
    local file=${wanted[0]}
    wanted=("${wanted[@]:1}")
    [ -n "${seen[$file]:-}" ] && continue
    seen[$file]=1
    echo "$file"
    mapfile -t -O ${#wanted[@]} wanted < <(sed -n 's/^ *#include "\([^"]*\)".*/\1/p' "$file")
  done
}

looked=()
for file in "${files[@]}"; do [[ $file =~ $fur ]] || looked+=("$file"); done
[ ${#looked[@]} -ge 25 ] || { echo "FAILED: looked at ${#looked[@]} files only"; exit 1; }
# The look itself: the scene does include them.
includes_of jobs/scene.cpp | grep -x 'core/streams.hpp' >/dev/null || { echo "FAILED: sees nothing"; exit 1; }
includes_of "${looked[@]}" | grep -xE 'core/(chunk|layer|streams)\.hpp' && { echo "FAILED: the machinery includes it"; exit 1; }

mapfile -t core < <(sed -n '/^  core$/,/)/s,^  \([a-z_/]*\.cpp\).*,core/\1,p' core/CMakeLists.txt)
[ ${#core[@]} -ge 15 ] || { echo "FAILED: core has ${#core[@]} files only"; exit 1; }
engine=("${core[@]}" core/file_bytes.cpp core/output_place.cpp traces/*.cpp platform_sim/*/*.cpp)
for file in jobs/*.cpp jobs/*/*.cpp; do [ "$file" = jobs/tbb_executor.cpp ] || engine+=("$file"); done
# As <glm/glm.hpp>; fmt is compiled into the libraries, sys is the system's.
libraries() { includes_of "$@" | xargs grep -nE '^ *#include <[A-Za-z_+]+/' | grep -vE '<(fmt|sys)/'; }
libraries core/groom/patches.cpp >/dev/null || { echo "FAILED: sees no library"; exit 1; }
libraries "${engine[@]}" && { echo "FAILED: what an engine links includes a library"; exit 1; }
exit 0
