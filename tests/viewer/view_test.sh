#!/usr/bin/env bash
# The page of `pelt view` in a browser, by PART_test.mjs: view_test.sh PELT WORK_DIR view|controls|watch|groom
set -uo pipefail
pelt=$(realpath "$1")
mkdir -p "$2"
skip() {
  echo "SKIPPED: $*" >&2
  exit 77
}
browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) ||
  skip "no Chromium here (Debian: apt-get install chromium)"
command -v node >/dev/null || skip "no Node here (Debian: apt-get install nodejs)"
exec node --no-warnings "$(dirname "$0")/$3_test.mjs" "$pelt" "$browser" "$(realpath "$2")"
