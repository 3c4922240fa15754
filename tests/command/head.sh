# Head of the shell tests of the `pelt` command, to be sourced with their arguments:
#   . head.sh PELT SOURCE_DIR [PART]...
# Leaves the test in a folder of its own that goes when it ends, with $pelt, $source_dir and the
# `parts` asked for; a failure is reported and counted, and does not end the test.
pelt=$(realpath "$1")
source_dir=$(realpath "$2")
parts=("${@:3}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cd "$work" || exit 1
failures=0
fail() {
  echo "FAILED: $*" >&2
  failures=$((failures + 1))
}

# expect CODE WORD... -- ARGS: exit code, one line "pelt: ..." without control characters, and every WORD in it.
expect() {
  local code=$1 words=() word got=0
  shift
  while [ "$1" != -- ]; do
    words+=("$1")
    shift
  done
  shift
  timeout 300 "$pelt" "$@" >out.txt 2>err.txt || got=$?
  [ "$got" -eq "$code" ] || fail "pelt $*: exit $got, not $code: $(cat err.txt)"
  [ "$(wc -l <err.txt)" -eq 1 ] || fail "pelt $*: not one line of error: $(cat err.txt)"
  LC_ALL=C grep -q '[^ -~]' err.txt && fail "pelt $*: control characters in: $(cat -v err.txt)"
  grep -q '^pelt: ' err.txt || fail "pelt $*: error does not begin with 'pelt: ': $(cat err.txt)"
  for word in "${words[@]}"; do
    grep -qF -- "$word" err.txt || fail "pelt $*: no '$word' in: $(cat err.txt)"
  done
}

# is_unsure CODE OUT ERR: the answer of a measurement that others disturbed, which no test can keep them from.
is_unsure() {
  [ "$1" -eq 2 ] && grep -qE 'UNSURE|"unsure": \[$' "$2" && ! grep -q '^pelt: ' "$3"
}

# as_own: what pelt run --json prints, as if of a machine of its own.
as_own() {
  sed '/"disturbances": \[$/,/^  \]/c"disturbances": []'
}

# The subcommands that `pelt --help` lists, and those below them.
subcommands() {
  local name below
  for name in $("$pelt" $1 --help | sed -n '/^Subcommands:/,/^[A-Z]\|^$/s/^  \([a-z]*\) .*/\1/p'); do
    below=$(subcommands "$1 $name")
    if [ -n "$below" ]; then echo "$below"; else echo "$1 $name"; fi
  done
}

# run_parts NAME=FUNCTION...: those that were asked for, or all; ends the test.
run_parts() {
  local part pair known
  if [ "${#parts[@]}" -eq 0 ]; then
    for pair in "$@"; do parts+=("${pair%%=*}"); done
  fi
  for part in "${parts[@]}"; do
    known=
    for pair in "$@"; do
      [ "${pair%%=*}" = "$part" ] && known=1 && "${pair#*=}"
    done
    [ -n "$known" ] || fail "no part '$part'"
  done
  [ "$failures" -eq 0 ] || exit 1
  echo "all passed: ${parts[*]}"
}
