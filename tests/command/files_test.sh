#!/usr/bin/env bash
# The files of the `pelt` command as a user meets them: what is written where a link, a FIFO, a long
# name or a protected file is; what is refused before the work begins; what may be read. The options
# are taken from the help texts, where each shows its type, so that a new one is tested too.
#   files_test.sh PELT SOURCE_DIR [outputs|conflicts|inputs|codes|full]...   (all, if none is named)
# Nothing here writes to a device but the shell, and that only to standard output.
set -uo pipefail
. "$(dirname "$0")/head.sh" "$@"

# options_of SUBCOMMAND TYPE: the names of its options and positionals of that type.
options_of() {
  # shellcheck disable=SC2086
  "$pelt" $1 --help-all | grep -oE "^  (-{0,2}[a-z][a-z-]*) $2( |$)" | awk '{print $1}'
}

# What a subcommand needs besides the output, and how much of it: as little as there is.
base_of() {
  case "$1 $2" in
    'bake --strip') echo --strip-from photo.png ;;
    'bake '*) echo --setup tiny ;;
    'show '*) echo builtin ;;
    'run '*) echo --scene tiny --frames 2 ;;
    'report '*) echo --scene tiny --frames 2 --no-consoles ;;
    'compare '*) echo run.json run.json ;;
    'trace record '*) echo --scene tiny --frames 2 ;;
    'trace replay '*) echo tiny.peltinput ;;
    'budget '*) echo --setup ./one.toml --frames 2 --platform ps3 --no-advice --target-ms 1000 ;;
    'fit '*) echo --setup ./one.toml --frames 4 --warm-up 4 --platform xbox360 ;;
    'calibrate '*) echo --scenes tiny --frames 2 ;;
    'accuracy --json') echo --quick --presets soft ;;
    'stress '*) echo --quick --solvers modal --links 3 --rates 60 --isa reference ;;
    *) return 1 ;;
  esac
}
extension_of() {
  case $1 in
    --out) [[ "$2" =~ ^(show|fit|calibrate)$ ]] && echo .toml || echo .out ;;
    --picture | --animation | --steps | --flow-map | --height-field | --skin-map | --stencil-map | --strip | --uv-template) echo .png ;;
    *) echo .out ;;
  esac
}

make_inputs() {
  "$pelt" trace record --scene tiny --frames 2 --out tiny.peltinput >/dev/null || fail "trace record"
  "$pelt" bake --setup tiny --out tiny.groom >/dev/null || fail "bake"
  "$pelt" run --scene tiny --frames 6 --json 2>/dev/null | as_own >run.json || fail "run --json"
  cp "$source_dir/bench/scenarios/setups/tiny.toml" tiny.toml
  cp "$source_dir/bench/picture/monster.png" photo.png
  printf '[[layer]]\nname = "a"\nsolver = "modal"\ndensity = 2000\nmax_strands = 100\n' >one.toml
}

no_debris() {
  local left
  left=$(find . -name '*partial*')
  [ -z "$left" ] || fail "$1: left behind: $left"
}

# check_output SUBCOMMAND OPTION
check_output() {
  local run=() ending name base
  base=$(base_of "$1" "$2") || { fail "no test for the output $2 of pelt $1: tell base_of"; return; }
  # shellcheck disable=SC2206
  run=($1 $base)
  ending=$(extension_of "$2" "$1")
  expect 2 "$2" "/nowhere" -- "${run[@]}" "$2" "/nowhere/x$ending"
  # One run: a link to a file of mode 600 that has as long a name as there can be.
  mkdir -p there
  name=$(printf 'n%.0s' $(seq $((255 - ${#ending}))))$ending
  printf 'old' >"there/$name"
  chmod 600 "there/$name"
  ln -sf "there/$name" "link$ending"
  "$pelt" "${run[@]}" "$2" "link$ending" >out.txt 2>&1 || fail "pelt ${run[*]} $2: $(tail -n 3 out.txt)"
  [ -L "link$ending" ] || fail "pelt $1 $2: a link was replaced"
  [ "$(stat -c %a "there/$name")" = 600 ] || fail "pelt $1 $2: mode 600 is $(stat -c %a "there/$name")"
  [ "$(stat -c %s "there/$name")" -gt 3 ] || fail "pelt $1 $2: nothing written through the link"
  # A FIFO's reader gets what a file gets, once, and it is a FIFO still.
  mkfifo "fifo$ending"
  timeout 300 cat "fifo$ending" >got.txt &
  timeout 300 "$pelt" "${run[@]}" "$2" "fifo$ending" >out.txt 2>&1 || fail "pelt ${run[*]} $2 FIFO: $(tail -n 3 out.txt)"
  wait $!
  [ -p "fifo$ending" ] || fail "pelt $1 $2: a FIFO was replaced"
  [ "$(head -c 16 got.txt | od -An -c)" = "$(head -c 16 "there/$name" | od -An -c)" ] && [ -s got.txt ] ||
    fail "pelt $1 $2: the FIFO got $(stat -c %s got.txt) bytes of something else"
  no_debris "pelt $1 $2"
  rm -r there "link$ending" "fifo$ending"
}

check_outputs() {
  local subcommand option count=0
  while read -r subcommand; do
    while read -r option; do
      check_output "$subcommand" "$option"
      count=$((count + 1))
    done < <(options_of "$subcommand" OUTPUT-FILE)
  done < <(subcommands '')
  [ "$count" -ge 10 ] || fail "only $count outputs in the help texts"
  echo "$count outputs"
  expect 2 'a folder' -- bake --setup tiny --out .
  expect 2 'too long' -- bake --setup tiny --out "$(printf 'n%.0s' {1..256})"
  expect 2 'is not a folder' -- bake --setup tiny --out tiny.toml/x
  ln -s nowhere/x dangling
  expect 2 "'nowhere' is not there" -- bake --setup tiny --out dangling
  ln -s loop loop
  expect 2 'symbolic links' -- bake --setup tiny --out loop
  ln -sf new.groom dangling
  "$pelt" bake --setup tiny --out dangling >/dev/null || fail "bake to a link without an end"
  [ -L dangling ] && [ -s new.groom ] || fail "a link without an end was replaced"
  expect 2 'the path is empty' -- bake --setup tiny --out ''
  expect 2 .png -- run --scene tiny --picture x.jpg
  expect 2 'not a folder' -- golden --renew tiny.toml/x --scene tiny
  if [ "$(id -u)" -ne 0 ]; then
    mkdir locked && chmod 500 locked
    expect 2 "'locked'" 'ermission' -- bake --setup tiny --out locked/x.groom
    cp tiny.toml readonly && chmod 400 readonly
    expect 2 'may not be written' -- bake --setup tiny --out readonly
  fi
  check_kept
}

# What fails later leaves an output as it was.
check_kept() {
  printf 'kept' >kept.json
  head -c 5000 tiny.groom >cut.groom
  expect 2 cut.groom -- run --groom cut.groom --trace kept.json
  [ "$(cat kept.json)" = kept ] || fail "a run that failed has changed its output"
  # No room: 1 KiB is all that a file may have.
  (trap '' XFSZ && ulimit -f 1 && exec "$pelt" run --scene tiny --frames 1 --trace kept.json) 2>&1 | cat >full.txt
  [ "${PIPESTATUS[0]}" -eq 2 ] || fail "no room for a trace: not exit 2"
  grep -q "kept.json': cannot be written: File too large" full.txt || fail "no room: $(tail -n 2 full.txt)"
  [ "$(cat kept.json)" = kept ] || fail "a file was lost to one that found no room"
  grep -q '^digest ' full.txt || fail "the figures were lost to a trace that found no room"
  no_debris "no room"
}

check_conflicts() {
  cp tiny.toml setup.toml
  ln setup.toml hard.toml
  ln -s setup.toml soft.toml
  mkdir -p folder
  local before name
  before=$(cksum <setup.toml)
  for name in setup.toml ./setup.toml folder/../setup.toml "$work/setup.toml" hard.toml soft.toml; do
    expect 2 --out --setup -- bake --setup ./setup.toml --out "$name"
    expect 2 --trace --setup -- run --setup ./setup.toml --trace "$name"
  done
  [ "$(cksum <setup.toml)" = "$before" ] || fail "a setup was overwritten"
  for name in new.json ./new.json folder/../new.json "$work/new.json"; do
    expect 2 --trace --digest-log -- run --scene tiny --trace new.json --digest-log "$name"
  done
  ln -s folder other
  expect 2 --trace --digest-log -- run --scene tiny --trace folder/a --digest-log other/a
  expect 2 --picture --trace -- run --scene tiny --picture a.png --trace a.png
  expect 2 --groom --digest-log -- run --groom tiny.groom --digest-log tiny.groom
  cp "$source_dir/bench/scenarios/lights/night.toml" night.toml
  expect 2 --trace --lights -- run --scene tiny --lights ./night.toml --trace night.toml
  expect 2 --out --groom -- trace record --groom tiny.groom --frames 1 --out tiny.groom
  expect 2 --digest-log file -- trace replay tiny.peltinput --digest-log ./tiny.peltinput
  printf '{}' >accuracy.json
  expect 2 --out --accuracy -- report --scene tiny --accuracy accuracy.json --out accuracy.json
  cp accuracy.json report.html
  expect 2 --out --accuracy -- report --scene tiny --accuracy report.html
  # What a setup or a model leads to is read too.
  printf '[[layer]]\nname = "a"\ndensity = { value = 10, map = "map.png" }\n' >mapped.toml
  cp "$source_dir/bench/picture/monster.png" map.png
  before=$(cksum <map.png)
  expect 2 --picture map.png -- run --setup ./mapped.toml --frames 1 --picture map.png
  expect 2 --out map.png -- bake --setup ./mapped.toml --out "$work/map.png"
  cp "$source_dir/tests/fuzz/corpus/gltf/builtin.glb" coarse.glb
  printf 'chain_mesh = "coarse.glb"\n[[layer]]\nname = "a"\n' >coarse.toml
  expect 2 --out coarse.glb -- bake --setup ./coarse.toml --out "$work/coarse.glb"
  [ "$(cksum <map.png)" = "$before" ] || fail "a map was overwritten"
  # What the shell opened for standard output.
  "$pelt" bake --setup tiny --out same.txt >same.txt 2>err.txt
  [ $? -eq 2 ] && grep -q 'standard output' err.txt || fail "an output that is standard output: $(cat err.txt)"
  # A pipe may have both.
  "$pelt" trace replay tiny.peltinput --digest-log /dev/stdout | grep -c whole_frame >/dev/null || fail "no log in the pipe"
  no_debris conflicts
}

# SUBCOMMAND OPTION: what an input may be. `files` has something to read for each.
check_input() {
  local file=$3
  shift 3
  mkfifo in
  timeout 300 cat "$file" >in &
  timeout 300 "$pelt" "$@" >out.txt 2>err.txt || fail "pelt $*: a FIFO is not read: $(cat err.txt)"
  wait $!
  rm in
  mkdir in
  expect 2 'a folder, not a file' -- "$@"
  rmdir in
  ln -s missing in
  expect 2 'a link to what is not there' -- "$@"
  rm in
  expect 2 'no such file' -- "$@"
}

check_inputs() {
  check_input bake --setup tiny.toml bake --setup ./in
  check_input run --groom tiny.groom run --frames 1 --groom in
  printf '[lights.sun]\ncolour = [1, 1, 1]\n' >lights.toml
  check_input run --lights lights.toml run --scene tiny --frames 1 --lights ./in
  cp "$source_dir/tests/fuzz/corpus/gltf/builtin.glb" some.glb
  check_input bake --strip-from photo.png bake --strip-from in --strip strip.png
  check_input show character some.glb show ./in
  check_input 'trace replay' file tiny.peltinput trace replay in
  check_input 'trace show' file tiny.peltinput trace show in
  check_input diff left tiny.groom diff in tiny.groom
  check_input diff right tiny.groom diff tiny.groom in
  check_input compare left run.json compare in run.json
  check_input compare right run.json compare run.json in
  printf 'nop\n' >nop.s
  check_input timing file nop.s timing in
  # A byte more than is read of each: it is not read at all. Holes take no room.
  local limit words
  while read -r limit words; do
    truncate -s $((limit + 1)) huge
    # shellcheck disable=SC2086
    expect 2 "larger than $limit bytes" -- $words
  done <<<"$((256 << 20)) verify --merge huge
$((16 << 20)) report --scene tiny --frames 1 --accuracy huge --out page.html
$((64 << 20)) timing huge
$((64 << 20)) compare huge huge
$((4 << 20)) bake --setup ./huge
$((4 << 20)) run --scene tiny --frames 1 --lights ./huge"
  rm huge
  "$pelt" timing - <nop.s >/dev/null || fail "timing of standard input"
  expect 2 'not readable' -- bake --character <(printf '{}') --setup tiny
  expect 2 'a folder, not a file' -- bake --character . --setup tiny
}

# What reads the input OPTION of SUBCOMMAND, "@" in its place.
reader_of() {
  local needs=
  case $1 in
    report) needs='--no-consoles --out page.html' ;;
    'trace record') needs='--out made.peltinput' ;;
    view) needs='--out page.html' ;;
  esac
  case "$1 $2" in
    'report --accuracy') echo "$1 --scene tiny --accuracy @ $needs" ;;
    'diff left' | 'compare left') echo "$1 @ tiny.groom" ;;
    'diff right') echo "$1 tiny.groom @" ;;
    'compare right') echo "$1 run.json @" ;;
    'timing --second-thread') echo "$1 nop.s --core ppe --second-thread @" ;;
    *' --merge') echo "$1 --merge @" ;;
    'view --replay') echo "$1 --replay @ $needs" ;;
    'view --watch') echo "$1 --watch @" ;;
    *' --character') echo "$1 --character ./@ --setup tiny $needs" ;;
    *' --setup') echo "$1 --setup ./@ $needs" ;;
    *' --groom') echo "$1 --groom @ $needs" ;;
    'run --costs') echo "$1 --scene tiny --frames 1 --budget-us 100 --costs @" ;;
    'fit --costs') echo "$1 --scene tiny --platform host --costs @" ;;
    'plan --times') echo "$1 --scene tiny --workers 2 --times @" ;;
    *' --plan') echo "$1 --scene tiny --plan @ $needs" ;;
    'bake --strip-from') echo "$1 --strip-from @ --strip strip.png" ;;
    *' --lights') echo "$1 --scene tiny --lights ./@ $needs" ;;
    *' --haircut') echo "$1 --scene tiny --frames 1 --haircut @ $needs" ;;
    'show character') echo "$1 ./@" ;;
    *' file') echo "$1 @" ;;
    *) return 1 ;;
  esac
}

# An input that is not there, a folder, or nothing that the command knows: 2 of every command and option that its help
# names. And what a verdict is: 1, or 3 where not all could be looked at.
check_codes() {
  local subcommand option type line file count=0
  "$pelt" run --scene tiny --frames 2 --json 2>/dev/null | as_own >run.json || fail "run --json"
  printf '\177ELF \1\2\3 garbage\n%.0s' {1..100} >noise
  printf 'nop\n' >nop.s
  mkdir -p heap
  while read -r subcommand; do
    for type in INPUT-FILE 'INPUT-FILE\|NAME'; do
      while read -r option; do
        line=$(reader_of "$subcommand" "$option") || { fail "no test for the input $option of pelt $subcommand: tell reader_of"; continue; }
        for file in missing noise heap; do
          # shellcheck disable=SC2086
          expect 2 -- ${line//@/$file}
          count=$((count + 1))
        done
      done < <(options_of "$subcommand" "$type")
    done
  done < <(subcommands '')
  [ "$count" -ge 90 ] || fail "only $count inputs in the help texts"
  echo "$count inputs that cannot be read"

  "$pelt" bake --setup tiny --seed 3 --out other.groom >/dev/null || fail "bake --seed"
  "$pelt" trace record --scene tiny --frames 2 --no-cull --out other.peltinput >/dev/null || fail "trace record"
  mkdir -p golden
  "$pelt" golden --renew golden --scene tiny >/dev/null || fail "golden --renew"
  sed -i 's/^19 whole_frame all .*/19 whole_frame all 0000000000000001/' golden/tiny.digests
  "$pelt" verify --scene tiny --frames 1 --isa reference --no-skips --no-checks --json >whole.json 2>/dev/null ||
    fail "verify --no-checks"
  printf '[[layer]]\nname = "a"\ndensity = 100\nenabled = false\n' >off.toml
  sed 's/"missing": \[\]/"missing": ["waking, coming to rest: no chunk sleeps"]/' whole.json >missing.json
  sed '0,/"name"/s/"passed": true/"passed": false/; 0,/"place"/!s/"passed": true/"passed": false/' whole.json >failed.json
  local code words
  while read -r code words; do
    # shellcheck disable=SC2086
    timeout 300 "$pelt" $words >out.txt 2>err.txt
    [ $? -eq "$code" ] || fail "pelt $words: not exit $code: $(tail -n 1 out.txt err.txt)"
    [ ! -s err.txt ] || fail "pelt $words: a verdict on standard error: $(cat err.txt)"
  done <<'EOF'
0 diff tiny.groom tiny.groom
1 diff tiny.groom other.groom
1 diff tiny.peltinput other.peltinput
0 trace replay tiny.peltinput
1 golden --check golden --scene tiny
1 budget --scene tiny --frames 2 --platform ps3 --no-advice --target-ms 0.001
1 fit --scene tiny --frames 2 --warm-up 2 --platform ps3 --target-ms 0.001
0 verify --merge whole.json
3 verify --setup ./off.toml --frames 1 --isa reference --no-skips
1 verify --merge failed.json
3 verify --merge missing.json
EOF
}

# Standard output with no room: for all that prints, the exit code says that the output was lost.
check_full() {
  local count=0 words
  while read -r -a words; do
    timeout 300 "$pelt" "${words[@]}" >/dev/full 2>err.txt && fail "pelt ${words[*]}: exit 0 on a full standard output"
    grep -q '^pelt: standard output: No space left' err.txt || fail "pelt ${words[*]}: $(cat err.txt)"
    [ "$(wc -l <err.txt)" -eq 1 ] || fail "pelt ${words[*]}: not one line of error: $(cat err.txt)"
    count=$((count + 1))
  done < <(
    echo --help
    echo --version
    subcommands '' | sed 's/$/ --help/'
    echo bake --keys
    echo bake --setup tiny
    echo run --scene tiny --frames 1
    echo report --scene tiny --frames 1 --no-consoles --out page.html
    echo plan --scene tiny
    echo verify --scene tiny --frames 1 --isa reference --no-skips
    echo trace record --scene tiny --frames 1 --out again.peltinput
    echo trace replay tiny.peltinput
    echo trace show tiny.peltinput
    echo diff tiny.groom tiny.groom
    echo "golden --check $source_dir/traces/golden --scene tiny"
    echo timing --kernel skin
    echo budget --numbers
    echo budget --validate
    echo conformance --door inline
    echo stress --quick --solvers modal --links 3 --rates 60 --isa reference
  )
  [ "$count" -ge 31 ] || fail "only $count commands"
  echo "$count commands with a full standard output"
  "$pelt" diff tiny.groom tiny.groom >&- 2>/dev/null && fail "exit 0 on a closed standard output"
  "$pelt" nonsense 2>&-
  [ $? -eq 2 ] || fail "a closed standard error: exit $?"
}

make_inputs
run_parts outputs=check_outputs conflicts=check_conflicts inputs=check_inputs codes=check_codes full=check_full
