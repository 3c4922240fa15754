#!/usr/bin/env bash
# What can be closed (PELT_ACCURACY, PELT_PICTURES) includes of core, jobs, traces and platform_sim what Pelt installs
# alone, and so does platform_sim of core, jobs and traces: it can be built beside an installed Pelt. Shaders are
# installed as they lie.
#   rooms_test.sh CMAKE SOURCE_DIR
set -uo pipefail
cmake=$1
cd "$2" || exit 1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$cmake" -DPELT_SOURCE_DIR="$PWD" -DPELT_HEADER_DIR="$work" -P core/package/publish_headers.cmake || exit 1
failed=0 seen=0
check() {  # folder, of which rooms
  local file line header
  while IFS=: read -r file line header; do
    seen=$((seen + 1))
    [[ -e $work/pelt/$header || $header == jobs/shaders/* ]] && continue
    echo "FAILED: $file:$line includes $header, which is not installed (core/package/public_headers.txt)"
    failed=1
  done < <(grep -rnE "^ *# *include \"($2)/" "$1" --include='*.hpp' --include='*.cpp' | sed 's/ *# *include "//; s/".*//')
}
for room in bench/accuracy bench/shading bench/picture bench/viewer; do check "$room" 'core|jobs|traces|platform_sim'; done
check platform_sim 'core|jobs|traces'
[ "$seen" -ge 150 ] || { echo "FAILED: saw $seen includes only"; exit 1; }
[ -e "$work/pelt/jobs/pelt.h" ] && [ ! -e "$work/pelt/core/float_rules.hpp" ] || { echo "FAILED: sees nothing"; exit 1; }
exit $failed
