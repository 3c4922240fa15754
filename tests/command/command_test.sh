#!/usr/bin/env bash
# The `pelt` command as a user meets it: the examples of every help text work, pipes get no progress bar, and the
# README shows the real plan.
#   command_test.sh PELT SOURCE_DIR [examples|quick_examples|serving|output|disturbed|readme|pictures]...   (all, if none is named)
set -uo pipefail
. "$(dirname "$0")/head.sh" "$@"

# Every line of a help text that starts with two blanks and "pelt"; quick: but for those that measure or prove for long.
run_examples() {
  run_examples_of bake run plan report trace diff golden timing budget conformance compare show verify accuracy stress calibrate fit
}
run_quick_examples() { run_examples_of bake run plan report trace diff golden timing budget conformance compare show; }
run_examples_of() {
  cp "$source_dir/bench/scenarios/examples/tufts.png" photo.png  # hairs side by side, with alpha
  local count=0 subcommands=("$@")
  # The listing that `pelt timing --help` shows.
  printf 'loop: lqd $4, 0($3); fa $4, $4, $5; ai $7, $7, -1\n stqd $4, 0($3); ai $3, $3, 16; brnz $7, loop\n' >add.s
  # What `pelt compare --help` compares, and runs by the name of the command.
  "$pelt" run --scene tiny --frames 20 --json >a.json 2>/dev/null && cp a.json b.json
  PATH=$(dirname "$pelt"):$PATH
  local subcommand line words
  # A program without the page's module says so, in the one line of an error.
  if "$pelt" view --scene tiny --frames 1 --out tiny.html >/dev/null 2>&1; then
    subcommands+=(view)
  else
    expect 2 PELT_WASM -- view --scene tiny --frames 1 --out tiny.html
  fi
  for subcommand in "${subcommands[@]}"; do
    "$pelt" "$subcommand" --help >help.txt || fail "pelt $subcommand --help"
    while read -r line; do
      eval "words=($line)"  # as a shell reads it: words in quotes are one
      count=$((count + 1))
      "$pelt" "${words[@]:1}" >out.txt 2>err.txt || is_unsure $? out.txt err.txt ||
        fail "${words[*]}: failed: $(cat err.txt)"
      [ -s out.txt ] || fail "${words[*]}: printed nothing"
      [ -s err.txt ] && [[ " ${words[*]} " != *" --json "* ]] &&
        fail "${words[*]}: wrote to standard error in a pipe: $(head -c 200 err.txt)"
    done < <(grep -E '^  pelt [a-z]' help.txt)
  done
  [ "$count" -ge 8 ] || fail "only $count examples in the help texts"
  [ "$("$pelt" run --help | grep -c '^  --')" -le 12 ] || fail "pelt run --help shows more than the first options"
  [ "$("$pelt" run --help-all | grep -c '^  --')" -ge 50 ] || fail "pelt run --help-all does not show all options"
  [ -s monster.groom ] || fail "the bake example wrote no groom"
  grep -q '"traceEvents"' trace.json || fail "the trace example wrote no trace"
  grep -q 'PS3 SPU 5 out' ps3.json || fail "the budget example wrote no trace"
  grep -q '</html>' report.html || fail "the report example wrote no page"
  [ "$(head -c 8 eyepet.png | od -An -tx1 | tr -d ' \n')" = 89504e470d0a1a0a ] ||
    fail "the picture example wrote no PNG"
  echo "$count examples"
}

# `pelt view --open` and --watch: what goes together, and that a signal ends them. The page has its own tests.
check_serving() {
  expect 2 '--port has an effect only with --open or --watch' -- view --scene tiny --port 8000
  expect 2 --port -- view --scene tiny --open --port 70000
  expect 2 file --scene -- view --watch my_fur.toml --scene tiny
  expect 2 file --setup -- view --watch my_fur.toml --setup tiny
  "$pelt" view --scene tiny --frames 1 --out tiny.html >/dev/null 2>&1 || return  # no module
  timeout 300 "$pelt" view --scene tiny --frames 1 --watch >out.txt 2>err.txt
  if grep -q 'libcpp-httplib-dev' err.txt; then return; fi  # no server
  expect 2 'nothing to watch' -- view --scene tiny --frames 1 --watch
  printf '[[layer]]\nname = "a"\nlenght = 0.1\n' >typo.toml
  expect 2 typo.toml:3 -- view --watch typo.toml
  local signal server wait_s
  rm -f view.html
  for signal in INT TERM; do
    rm -f served.txt
    # In the background a shell has it ignore the first, which the program undoes.
    env -u DISPLAY -u WAYLAND_DISPLAY -u BROWSER "$pelt" view --scene tiny --frames 1 --open >served.txt 2>err.txt &
    server=$!
    for ((wait_s = 0; wait_s < 60; ++wait_s)); do
      if grep -qs 'no browser' served.txt; then break; fi
      sleep 1
    done
    grep -q 'http://127.0.0.1:[0-9]*/ ' served.txt || fail "view --open: no address: $(cat served.txt err.txt)"
    [ "$signal" = INT ] && expect 2 taken --port -- view --scene tiny --frames 1 --open \
      --port "$(grep -o '[0-9]*/ ' served.txt | tr -d '/ ')"
    kill "-$signal" "$server"
    wait "$server" || fail "view --open: SIG$signal: exit $?"
  done
  [ ! -e view.html ] || fail "view --open wrote a page that was not asked for"
  # A browser gets the address, and begins with no signal ignored.
  printf '#!/bin/sh\necho "$1" >%s/browsed.txt\nkill -PIPE $$\necho >%s/ignored.txt\n' "$work" "$work" >browser.sh
  chmod +x browser.sh
  env -u DISPLAY -u WAYLAND_DISPLAY BROWSER="$work/browser.sh" "$pelt" view --scene tiny --frames 1 --open >served.txt &
  server=$!
  for ((wait_s = 0; wait_s < 60; ++wait_s)); do
    if [ -s browsed.txt ]; then break; fi
    sleep 1
  done
  kill "$server"
  wait "$server" || fail "view --open with a browser: exit $?"
  [ ! -e ignored.txt ] || fail "a browser begins with SIGPIPE ignored"
  grep -qF "$(cat browsed.txt)" served.txt || fail "the browser got: $(cat browsed.txt), not: $(cat served.txt)"
}

check_output() {
  "$pelt" run --scene tiny --frames 5 --executor serial >serial.txt || fail "run serial"
  "$pelt" run --scene tiny --frames 5 --workers 3 >tbb.txt || fail "run tbb"
  [ "$(grep '^digest' serial.txt)" = "$(grep '^digest' tbb.txt)" ] || fail "digests differ"
  "$pelt" bake --setup tiny --out a.groom >/dev/null && "$pelt" bake --setup tiny --out b.groom >/dev/null
  cmp a.groom b.groom || fail "two bakes differ"
  "$pelt" bake --setup tiny | grep -q 'unit_scale' || fail "bake does not say the unit scale"
  [ "$("$pelt" bake --setup tiny --stats | grep -c '^ *12.5  0')" -eq 8 ] || fail "bake --stats: not each layer's spacing"
  # What is printed is what is written, and it bakes.
  "$pelt" show scorpion | sed '1,/^A setup to start from/d' | sed 1d >printed.toml
  "$pelt" show scorpion --out start.toml | grep -q '^tail .* m\?\|^material' || fail "show --out prints no tables"
  cmp printed.toml start.toml || fail "the setup that is printed is not the one that is written"
  "$pelt" bake --character scorpion --setup ./start.toml | grep -q 'WARNING' && fail "a layer of the setup to start from is bald"
  "$pelt" bake --character scorpion --setup ./start.toml | grep -q '^leg .* density *$' || fail "the setup to start from"
  # Three layers: cut, not reached, without a limit.
  local limit
  for limit in 400 90000 0; do
    printf '[[layer]]\nname = "l%s"\ndensity = 2000\nmax_strands = %s\n' "$limit" "$limit"
  done >limits.toml
  "$pelt" bake --setup ./limits.toml >limits.txt || fail "bake limits.toml"
  grep -Eq '^l400 .* 400  max_strands ' limits.txt || fail "a cut layer: $(cat limits.txt)"
  grep -Eq '^l90000 .* 90000  density *$' limits.txt || fail "a limit that is not reached: $(cat limits.txt)"
  grep -Eq '^l0 .*[0-9] +density *$' limits.txt || fail "a layer without a limit: $(cat limits.txt)"
  grep -q 'max_strands cuts 1 of 3 layers' limits.txt || fail "no word of the cut: $(cat limits.txt)"
  grep -q 'max_strands of 1 of 3 layers is not reached' limits.txt || fail "no word of the idle limit: $(cat limits.txt)"
  # A flow map is read by the line that is printed with it.
  printf '[[layer]]\nname = "a"\ndensity = 2000\n' >flow.toml
  "$pelt" bake --setup ./flow.toml --flow-map flow.png --flow-side 64 >flow.txt || fail "bake --flow-map"
  sed -n 's/^read back by: //p' flow.txt | tee line.txt >>flow.toml
  grep -qx 'flow_map = { map = "flow.png", blue = "length", longest = 0.03 }' line.txt || fail "the line: $(cat flow.txt)"
  "$pelt" bake --setup ./flow.toml --flow-map again.png --flow-side 64 | grep -q 'longest = 0.03 }' || fail "its flow map is not read"
  # Chains stand where a coarser mesh has vertices: the mesh's, those simulated, and the mesh's of them.
  cp "$source_dir/tests/fuzz/corpus/gltf/builtin.glb" coarse.glb
  printf 'chain_mesh = "coarse.glb"\n[[layer]]\nname = "a"\ndensity = 20000\n' >coarse.toml
  "$pelt" bake --setup ./coarse.toml >coarse.txt || fail "bake with a chain_mesh"
  awk '$1 == "a" && $3 < $2 && $4 > 100 { found = 1 } END { exit !found }' coarse.txt || fail "no chains of it: $(cat coarse.txt)"
  "$pelt" bake --setup tiny --seed 9 --out c.groom >/dev/null
  cmp -s a.groom c.groom && fail "another seed gave the same groom"
  for switch in sleep unmoved sort wind cull digest; do
    "$pelt" run --scene tiny --frames 2 "--no-$switch" >/dev/null || fail "--no-$switch"
  done
  "$pelt" trace record --scene tiny --frames 4 --out tiny.peltinput >/dev/null || fail "trace record"
  "$pelt" trace record --scene tiny --frames 4 --lod --strand-budget 300 --out lod.peltinput >/dev/null ||
    fail "trace record --lod"
  for log in tiny lod; do
    "$pelt" trace replay $log.peltinput --executor serial --isa reference | grep -q 'SAME BITS in all 4 frames' ||
      fail "replay of $log"
  done
  "$pelt" diff tiny.peltinput lod.peltinput >diff.txt && fail "diff of different recordings is 0"
  grep -q 'frame 0, input' diff.txt || fail "diff of recordings: $(cat diff.txt)"
  # The slowest frame alone, and among others.
  "$pelt" run --scene tiny --frames 40 --trace worst.json --trace-worst --trace-frames 1 --json >worst.run 2>/dev/null || fail "--trace-worst"
  [ "$(grep -o '"frame [0-9]*"' worst.json | sort -u | wc -l)" -eq 1 ] || fail "--trace-worst: not one frame"
  "$pelt" run --scene tiny --frames 40 --trace around.json --trace-worst --trace-frames 5 >around.txt || fail "--trace-worst of 5"
  local slowest
  slowest=$(sed -n 's/^trace of .*, of which \([0-9]*\) was the slowest of all, around.json$/\1/p' around.txt)
  grep -q "\"frame $slowest\"" around.json || fail "--trace-worst: frame '$slowest' is not in: $(cat around.txt)"
  [ "$(grep -o '"frame [0-9]*"' around.json | sort -u | wc -l)" -le 5 ] || fail "--trace-worst: more than 5 frames"
  if command -v python3 >/dev/null; then
    python3 - <<'PYTHON' || fail "--trace-worst: not the slowest frame"
import json
events = [e for e in json.load(open('worst.json'))['traceEvents'] if e.get('name', '').startswith('frame ')]
begin, = (e['ts'] for e in events if e['ph'] == 'B')
end, = (e['ts'] for e in events if e['ph'] == 'E')
worst = json.load(open('worst.run'))['frame_ms']['worst']
assert abs((end - begin) / 1e3 - worst) < 0.05 * worst + 0.01, (begin, end, worst)
PYTHON
    for arguments in 'trace show tiny.peltinput' 'trace replay tiny.peltinput' 'diff a.groom b.groom' \
      'diff tiny.peltinput tiny.peltinput' \
      'bake --setup tiny --stats' 'run --scene tiny --frames 2' 'plan --scene tiny' \
      'budget --scene tiny --frames 2' 'budget --validate' 'timing --kernel skin' \
      'verify --scene tiny --frames 1 --isa reference --no-skips'; do
      # 1: they differ, or are over the budget; 2: the machine was too busy for a verdict. A refusal prints no JSON.
      # shellcheck disable=SC2086
      { "$pelt" $arguments --json 2>/dev/null || [ $? -le 2 ]; } | python3 -m json.tool >/dev/null ||
        fail "pelt $arguments --json is not JSON"
    done
  fi
}

# Two workers on a core that another process has half of: all of it is reported.
check_disturbed() {
  command -v taskset >/dev/null && [ -r /proc/self/schedstat ] || { echo "SKIPPED: no taskset, or no schedstat"; return; }
  local core
  core=$(taskset -cp $$ | sed 's/.*: *\([0-9]*\).*/\1/')
  taskset -c "$core" sh -c 'while :; do :; done' &
  local other=$!
  taskset -c "$core" "$pelt" run --scene monster --frames 30 --workers 2 >out.txt 2>&1 || fail "run on one core: $(cat out.txt)"
  kill "$other"
  wait "$other" 2>/dev/null
  tr '\n' ' ' <out.txt >line.txt
  grep -q "NOT THE RUN'S OWN MACHINE: 2 workers had 1 core" line.txt || fail "no word of one core: $(head -n 12 out.txt)"
  grep -q "threads were ready for [0-9]* ms without a core" line.txt || fail "no word of waiting: $(head -n 12 out.txt)"
  [ "$(sed -n 's/.*preemptions \([0-9]*\),.*/\1/p' out.txt)" -gt 0 ] || fail "no preemptions: $(head -n 12 out.txt)"
  check_unsure "$core"
}

# On CORE, which another takes too: the host's verdict is UNSURE for any measurement, and a sure no outweighs it.
check_unsure() {
  local core=$1 other platforms target code says
  taskset -c "$core" sh -c 'while :; do :; done' &
  other=$!
  while IFS='|' read -r platforms target code says; do
    local got=0 budget=(budget --scene tiny --frames 200 --platform "$platforms" --target-ms "$target")
    [[ "$platforms" == host ]] || budget+=(--no-advice)
    taskset -c "$core" "$pelt" "${budget[@]}" >unsure.txt 2>err.txt || got=$?
    [ "$got" -eq "$code" ] || fail "${budget[*]}, disturbed: exit $got, not $code: $(cat unsure.txt err.txt)"
    grep -qE '^host( +[0-9.]+){4} +UNSURE ' unsure.txt || fail "no verdict UNSURE: $(cat unsure.txt)"
    tr '\n' ' ' <unsure.txt | grep -q 'host UNSURE, as the machine was not its own: threads were ready for' ||
      fail "UNSURE without a reason: $(cat unsure.txt)"
    grep -q '^UNSURE: exit code 2' unsure.txt && got=says || got=
    [ "$got" = "$says" ] || fail "${budget[*]}, disturbed: exit code 2 is printed or not: $(cat unsure.txt)"
  done <<'END'
host|1000|2|says
host|0.001|2|says
host,ps3|1000|2|says
host,ps3|0.001|1|
END
  taskset -c "$core" "$pelt" budget --scene tiny --frames 200 --platform host --json >unsure.json 2>err.txt
  [ $? -eq 2 ] || fail "budget --json, disturbed: exit $?, not 2"
  [ "$(grep -c '"verdict": "UNSURE"' unsure.json)" -eq 2 ] || fail "no verdict UNSURE: $(cat unsure.json)"
  grep -q '"fits"' unsure.json && fail "UNSURE fits or does not: $(cat unsure.json)"
  kill "$other"
  wait "$other" 2>/dev/null
}

check_readme() {
  "$pelt" budget --validate >/dev/null || fail "budget --validate: a row is missed that is not known to be"
  "$pelt" budget --validate --json >rows.json || fail "budget --validate --json"
  for class in independent derived plausibility parameter; do
    grep -q "\"class\": \"$class\"" rows.json || fail "budget --validate --json has no $class row"
  done
  for part in '"class_because": "repeats D3' '"missed_because": ' '"independent": {'; do
    grep -qF "$part" rows.json || fail "budget --validate --json lacks $part"
  done
  # What pages quote, and the options of commands that they name.
  if command -v python3 >/dev/null; then
    python3 "$source_dir/tests/command/quotes.py" "$pelt" "$source_dir" >quotes.txt || fail "$(cat quotes.txt)"
  else
    echo "SKIPPED: no python3 to compare pages with what is printed"
  fi
}

# The pictures that pages show are what their commands draw.
check_pictures() {
  command -v python3 >/dev/null || { echo "SKIPPED: no python3 to compare pictures with what is drawn"; return; }
  python3 "$source_dir/tests/command/pictures.py" "$pelt" "$source_dir" >pictures.txt || fail "$(cat pictures.txt)"
  grep SKIPPED pictures.txt
}

run_parts examples=run_examples quick_examples=run_quick_examples serving=check_serving output=check_output disturbed=check_disturbed readme=check_readme \
  pictures=check_pictures
