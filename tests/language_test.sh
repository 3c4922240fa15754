#!/usr/bin/env bash
# language_test.sh SOURCE_DIR: no file has a word that CONTRIBUTING.md, "Language", lists as (not: WORD, WORD).
# The changelog is history, kept digests and pictures are no text.
set -euo pipefail
cd "$1"
mapfile -t words < <(sed -n '/^## Language/,$p' CONTRIBUTING.md | tr '\n' ' ' | grep -o '(not: [^)]*)' |
  sed 's/(not: //; s/)//; s/, */\n/g' | sed 's/  */ /g')
[ "${#words[@]}" -ge 8 ] || { echo "FAILED: CONTRIBUTING.md lists ${#words[@]} words" >&2; exit 1; }
pattern=$(IFS='|'; echo "${words[*]}")
files() { find README.md bench core jobs platform_sim tests traces CMakeLists.txt -type f ! -name '*.png' ! -name '*.digests' \
  ! -path '*/golden/*' ! -path '*/corpus/*'; }
# The pattern finds what it should, and no other word.
[ "$(printf '%s so\n' "${words[@]}" "${words[0]^^}" "${words[0]}s" | grep -ciwE "$pattern")" -eq $((${#words[@]} + 1)) ] ||
  { echo "FAILED: pattern $pattern" >&2; exit 1; }
if files | tr '\n' '\0' | xargs -0 grep -nIiwE "$pattern" >&2; then
  echo "FAILED: words that CONTRIBUTING.md, 'Language', replaces" >&2
  exit 1
fi
