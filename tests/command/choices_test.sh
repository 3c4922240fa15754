#!/usr/bin/env bash
# Every value that a help text lists for an option runs, and every solver on every number of links:
# it does what it is asked, or says in one line why not. The options are taken from the help texts, so
# that a new one is tested too. Before a release, under the sanitizers as well.
#   choices_test.sh PELT SOURCE_DIR [values_0|values_1|values_2|solvers]...   (all, if none is named)
set -uo pipefail
. "$(dirname "$0")/head.sh" "$@"

# What a subcommand needs besides the option, and how much of it: as little as there is.
base_of() {
  local scene=(--scene tiny)
  [ "$2" = --scene ] && scene=()
  case "$1 $2" in
    'accuracy --presets') echo --quick ;;
    'accuracy --rates' | 'accuracy --isa') echo --quick --presets soft ;;
    'accuracy --links') echo --features --quick ;;
    'accuracy --scene') echo --frames 2 --quick ;;
    'budget '*) echo "${scene[@]}" --frames 1 --no-advice ;;
    'calibrate '*) echo --frames 1 --out host.toml ;;
    'conformance '*) echo ;;
    'fit --platform') echo "${scene[@]}" --frames 2 --warm-up 2 --target-ms 1000 ;;
    'fit '*) echo "${scene[@]}" --frames 2 --warm-up 2 ;;
    'golden '*) echo --check "$source_dir/traces/golden" --shard 0/64 ;;
    'plan '*) echo "${scene[@]}" ;;
    'report '*) echo "${scene[@]}" --frames 1 --no-consoles --out out.html ;;
    'run --light' | 'run --renderer') echo "${scene[@]}" --frames 1 --picture out.png --picture-width 64 --picture-height 48 ;;
    'run '*) echo "${scene[@]}" --frames 1 ;;
    'stress --links') echo --quick --rates 60 --isa reference --solvers modal ;;
    'stress '*) echo --quick --solvers modal,xpbd-2 --links 3 --isa reference ;;
    'timing '*) echo --kernel fit_cubic_4 ;;
    'trace record '*) echo "${scene[@]}" --frames 1 --out out.peltinput ;;
    'trace replay '*) echo tiny.peltinput ;;
    'verify '*) echo "${scene[@]}" --frames 1 --no-skips --no-checks --shard 0/64 ;;
    'view '*) echo "${scene[@]}" --out out.html ;;
    *) return 1 ;;
  esac
}

# ran ARGS: it ended by itself; with 0, with a verdict (1 and something printed, or UNSURE), or with one line of error.
ran() {
  local code=0 leaks=1
  # An OpenGL driver leaves memory behind, and is unloaded by then.
  [[ "$*" == *'--renderer gl'* ]] && leaks=0
  ASAN_OPTIONS=detect_leaks=$leaks timeout 1800 "$pelt" "$@" >out.txt 2>err.txt || code=$?
  count=$((count + 1))
  [ "$code" -eq 0 ] && return
  [ "$code" -eq 1 ] && [ -s out.txt ] && [[ "$1" =~ ^(budget|fit|golden|stress|verify)$ ]] && return
  is_unsure "$code" out.txt err.txt && return
  [ "$code" -le 3 ] && [ "$(wc -l <err.txt)" -eq 1 ] && grep -q '^pelt: ' err.txt && return
  fail "pelt $*: exit $code: $(head -c 400 err.txt)"
}

# check_values N: every third value from the N-th on, so that three tests share the time.
check_values() {
  local count=0 seen=0 subcommand option values value base
  "$pelt" trace record --scene tiny --frames 2 --out tiny.peltinput >/dev/null || fail "trace record"
  while read -r subcommand; do
    # As "  --scene TEXT:{monster,cast} Excludes: ...".
    while IFS=' ' read -r option values; do
      base=$(base_of "$subcommand" "$option") || { fail "nothing is known of $subcommand $option"; continue; }
      for value in ${values//,/ }; do
        [ $((seen++ % 3)) -eq "$1" ] || continue
        # Minutes each, under sanitizers an hour, and the scenes themselves are run.
        [[ "$subcommand $value" =~ ^(accuracy|budget|fit|calibrate)\ (monster|stage|cast|everything)$ ]] && continue
        # shellcheck disable=SC2086
        ran $subcommand $base "$option" "$value"
      done
    # shellcheck disable=SC2086
    done < <("$pelt" $subcommand --help-all | sed -nE 's/^  (--[a-z-]+) [A-Z]+:\{([^}]*)\}.*/\1 \2/p')
  done < <(subcommands '')
  [ "$count" -ge 33 ] || fail "only $count values in the help texts"
  echo "$count values"
}

# Every solver with strands of 3, 4 and 8 links; what it cannot run is reported before anything is computed.
check_solvers() {
  local count=0 links name
  "$pelt" stress --solvers none 2>err.txt
  # "... there are modal, modal-fine, pbd, pbd-N (N from 1 to 64)"
  read -ra names < <(sed -n 's/.*there are \(.*\) (N from.*/\1/p' err.txt | tr -d ',' | sed 's/-N\b/-2/g')
  [ "${#names[@]}" -ge 15 ] || fail "only ${#names[@]} solvers in: $(cat err.txt)"
  for links in 3 4 8; do
    for name in "${names[@]}"; do
      ran stress --quick --solvers "$name" --links "$links" --rates 60 --isa reference
      if [ "$links" -ne 8 ] || [[ "$name" =~ ^modal(-fine|-best)?$ ]]; then
        [ -s out.txt ] || fail "$name does not run $links links: $(cat err.txt)"
      else
        grep -q -- "--solvers.*not of 8" err.txt || fail "$name, 8 links: $(cat out.txt err.txt)"
      fi
    done
  done
  echo "$count solvers"
}

check_values_0() { check_values 0; }
check_values_1() { check_values 1; }
check_values_2() { check_values 2; }
run_parts values_0=check_values_0 values_1=check_values_1 values_2=check_values_2 solvers=check_solvers
