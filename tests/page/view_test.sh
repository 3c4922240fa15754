#!/usr/bin/env bash
# The page of `pelt view` in a browser (view_test.mjs, watch_test.mjs): view_test.sh PELT WORK_DIR [view|watch]
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
exec node --no-warnings "$(dirname "$0")/${3:-view}_test.mjs" "$pelt" "$browser" "$(realpath "$2")"
