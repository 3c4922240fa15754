#!/usr/bin/env bash
# Mistakes in what the `pelt` command is given: each is one line with exit code 2, and says what was meant.
#   errors_test.sh PELT SOURCE_DIR
set -uo pipefail
. "$(dirname "$0")/head.sh" "$@"

# A mistyped word, of every kind of choice.
check_meant() {
  expect 2 "did you mean 'monster'?" -- run --scene mosnter
  expect 2 "did you mean 'permuted'?" -- run --scene tiny --executor permutde
  expect 2 "did you mean 'avx2'?" -- run --scene tiny --isa avx
  expect 2 "did you mean 'modal'?" -- run --scene tiny --solver modla
  expect 2 "did you mean 'backlit'?" -- run --scene tiny --picture x.png --light baklit
  expect 2 "did you mean 'software'?" -- run --scene tiny --picture x.png --renderer sofware
  expect 2 "did you mean 'xbox360'?" -- budget --scene tiny --platform xbox630
  expect 2 "did you mean 'xenon'?" -- timing --kernel skin --core xenom
  expect 2 "did you mean 'simulate_pbd_4'?" -- timing --kernel simulat_pbd_4
  expect 2 "did you mean 'threads'?" -- conformance --door thread
  expect 2 "did you mean 'stiff'?" -- accuracy --quick --presets stif
  expect 2 "did you mean 'modal'?" -- stress --quick --solvers modla
  expect 2 "did you mean 'scorpion'?" -- run --setup scorpoin
  expect 2 "did you mean 'lamps'?" -- run --scene tiny --lights lmaps
  expect 2 "did you mean 'scorpion'?" -- run --character scorpoin --setup tiny
  expect 2 "did you mean 'strand5'?" -- bake --setup tiny --flow-map x.png --flow-layer stand5
  expect 2 "did you mean 'strand5'?" -- run --scene tiny --frames 1 --picture x.png --relief stand5
}

check_errors() {
  expect 2 subcommand --
  expect 2 "no subcommand 'budgte'; did you mean 'budget'" -- budgte --scene tiny
  expect 2 "no subcommand 'xyzzy'; there are: bake, run" -- xyzzy
  expect 2 --sceen -- run --sceen monster
  expect 2 nowhere -- run --scene nowhere
  expect 2 frames -- run --scene tiny --frames many
  expect 2 executor -- run --scene tiny --executor magic
  check_meant
  expect 2 renderer -- run --scene tiny --picture x.png --renderer magic
  expect 2 --setup -- run --character some.glb
  expect 2 --scene -- run --scene tiny --setup tiny
  expect 2 missing.glb -- run --character missing.glb --setup tiny
  expect 2 missing.toml -- bake --setup ./missing.toml
  expect 2 missing.groom -- run --groom missing.groom
  expect 2 there -- run --setup nosuch
  expect 2 "memory budget" -- plan --scene tiny --memory-budget-mb 1
  head -c 4000 /dev/urandom >noise
  cp noise noise.glb
  expect 2 noise.glb -- bake --character noise.glb
  expect 2 noise.groom -- run --groom noise.groom
  printf '[[layer]]\nname = "a"\nlenght = 0.1\n' >typo.toml
  expect 2 typo.toml:3 -- bake --setup ./typo.toml
  grep -q length err.txt || fail "no suggestion for a mistyped key: $(cat err.txt)"
  expect 2 character -- show
  expect 2 missing.glb -- show missing.glb
  expect 2 noise.glb -- show noise.glb
  expect 2 .toml -- show builtin --out fur.txt
  check_lights
  expect 2 /nowhere/ -- bake --setup tiny --out /nowhere/x.groom
  expect 2 /nowhere/ -- run --scene tiny --frames 1 --picture /nowhere/x.png
  # Without a driver: what to install, before anything is run.
  __EGL_VENDOR_LIBRARY_FILENAMES=/nowhere.json expect 2 'no OpenGL' 'apt-get install' -- \
    run --scene tiny --frames 1 --picture x.png --renderer gl
  "$pelt" bake --setup tiny --out tiny.groom >/dev/null || fail "bake tiny"
  head -c 5000 tiny.groom >cut.groom
  expect 2 cut.groom -- run --groom cut.groom
  expect 2 /nowhere/ -- run --scene tiny --frames 1 --trace /nowhere/x.json
  expect 2 /nowhere/ -- report --scene tiny --frames 1 --out /nowhere/x.html
  expect 2 local-store -- run --scene tiny --frames 1 --executor local-store --trace x.json
  expect 2 local-store -- report --scene tiny --frames 1 --executor local-store
  expect 2 noise -- trace replay noise
  expect 2 noise -- trace show noise
  expect 2 noise 'not an input log' -- view --replay noise
  expect 2 missing.peltinput -- view --replay missing.peltinput
  "$pelt" trace record --scene tiny --frames 2 --out whole.peltinput >/dev/null || fail "record tiny"
  head -c 5000 whole.peltinput >cut.peltinput
  expect 2 cut.peltinput 'it was cut' -- view --replay cut.peltinput
  expect 2 --replay -- view --replay whole.peltinput --scene tiny
  expect 2 --replay -- view --replay whole.peltinput --frames 3
  expect 2 noise -- diff noise tiny.groom
  expect 2 'of kind groom' -- diff tiny.groom "$source_dir/traces/golden/tiny.digests"
  expect 2 --out -- trace record --scene tiny
  expect 2 subcommand -- trace
  expect 2 right -- diff tiny.groom
  expect 2 --renew -- golden --scene tiny
  expect 2 tiny.digests -- golden --check nowhere --scene tiny
  expect 2 /nowhere/ -- run --scene tiny --frames 1 --digest-log /nowhere/x.digests
  expect 2 missing.s -- timing missing.s
  expect 2 noise -- timing noise
  printf 'ai 3,4,1\nfma 3,4\n' >short.s
  expect 2 'short.s:2' -- timing short.s
  expect 2 'r127' -- timing <(echo 'ai 128,4,1')
  expect 2 'of the PPE' -- timing <(echo 'lwz r3,0(r3)')
  expect 2 'its loops: a' -- timing <(echo 'a: brnz 3,a') --trip b=3
  expect 2 'LABEL=N' -- timing <(echo 'a: brnz 3,a') --trip a
  expect 2 --core -- timing noise --core gpu
  expect 2 /nowhere/ -- trace record --scene tiny --frames 1 --out /nowhere/x.peltinput
  check_suggestions
  check_ignored
  check_control_characters
  check_timing_errors
  check_second_thread
  check_budget_errors
  check_qualities
  check_compare_errors
  check_accuracy_errors
}

# The user's own lights: all that takes a scene takes them, reports faults by place before any bake, and shows them.
check_lights() {
  local subcommand
  for subcommand in run report plan verify budget 'trace record'; do
    # shellcheck disable=SC2086
    "$pelt" $subcommand --help-all >help.txt
    grep -q -- '^  --lights INPUT-FILE|NAME' help.txt || fail "pelt $subcommand has no --lights"
    # shellcheck disable=SC2086
    timeout 300 "$pelt" ${subcommand/record/record --out x.peltinput} --scene cast --lights ./missing.toml >out.txt 2>err.txt &&
      fail "pelt $subcommand --lights missing.toml: exit 0"
    grep -q 'missing.toml' err.txt || fail "pelt $subcommand --lights missing.toml: $(cat err.txt)"
  done
  expect 2 'there are: lamps, night' -- run --scene cast --lights lamp
  printf '[[layer]]\nname = "a"\n' >bare.toml
  expect 2 'bare.toml:1: there is no [lights] in it' -- run --scene cast --lights ./bare.toml
  printf '[[lights.light]]\nposition = [0, 1, 1]\nradios = 2\n' >radios.toml
  expect 2 'radios.toml:3:' "did you mean 'lights.light[0].radius'?" -- run --scene cast --lights ./radios.toml
  printf '[lights.sun]\ncolour = [0, 0, 0]\n' >black.toml
  expect 2 'black.toml: all of its [lights] are black' -- run --scene cast --lights ./black.toml
  expect 2 --light --lights -- run --scene tiny --lights night --light evening --picture x.png
  # The same lights from a file and by name; others; none.
  cp "$source_dir/bench/scenarios/lights/night.toml" .
  local digests=() lights
  for lights in './night.toml' night lamps ''; do
    digests+=("$("$pelt" run --scene tiny --frames 2 ${lights:+--lights "$lights"} | grep '^digest')")
  done
  [ -n "${digests[0]}" ] && [ "${digests[0]}" = "${digests[1]}" ] || fail "lights by name are not those of their file"
  [ "${digests[1]}" != "${digests[2]}" ] && [ "${digests[2]}" != "${digests[3]}" ] || fail "--lights changes nothing"
}

# A mistyped word is answered with the one that was meant, in every subcommand.
check_suggestions() {
  for subcommand in bake run plan verify timing budget conformance diff golden accuracy stress compare show 'trace show' \
    'trace replay'; do
    # shellcheck disable=SC2086
    expect 2 "no option '--jsno'; did you mean '--json'? (see pelt $subcommand --help)" -- $subcommand --jsno
  done
  expect 2 "no option '--sceen'; did you mean '--scene'" -- run --sceen monster
  expect 2 "no option '--sceen'; did you mean '--scene'" -- run --sceen=monster --frames 1
  expect 2 "did you mean '--out'" -- report --otu x.html
  expect 2 "no subcommand 'recrod'; did you mean 'record'" -- trace recrod --scene tiny
  expect 2 "no option '--versoin'; did you mean '--version'" -- --versoin
  expect 2 "'extra' is one argument too many" -- run extra
  expect 2 "one of --check, --renew and --merge is required (" -- golden --scene tiny
  expect 2 '--character needs --setup or --groom (' -- run --character some.glb
  expect 2 'a listing or --kernel is required (' -- timing
  "$pelt" --version >out.txt || fail "--version"
  for word in '^pelt [0-9]' '^commit' '^compiler' '^instruction_sets .*reference' '^chunk_strands *[0-9]'; do
    grep -q "$word" out.txt || fail "--version says no $word: $(cat out.txt)"
  done
}

# An option without effect is a mistake of a user who thinks that it has one.
check_ignored() {
  expect 2 '--strand-budget requires --lod' -- run --scene tiny --strand-budget 100
  expect 2 '--strand-budget requires --lod' -- budget --scene tiny --strand-budget 100
  for executor in serial permuted local-store; do
    expect 2 --workers -- run --scene tiny --executor $executor --workers 2
    expect 2 --workers -- report --scene tiny --executor $executor --workers 2
    expect 2 --workers -- trace replay tiny.peltinput --executor $executor --workers 2
  done
  expect 2 --rollback -- verify --scene tiny --no-checks --rollback 3
  expect 2 --order-seed -- run --scene tiny --order-seed 3
  expect 2 --picture-width -- run --scene tiny --picture-width 100
  expect 2 --picture-height -- run --scene tiny --picture-height 100
  expect 2 --relief -- run --scene tiny --relief all
  expect 2 '--relief-steps requires --relief' -- run --scene tiny --picture x.png --relief-steps 2,16
  expect 2 'the least, 9' -- run --scene tiny --picture x.png --relief all --relief-steps 9,4
  expect 2 --relief-steps -- run --scene tiny --picture x.png --relief all --relief-steps 4
  expect 2 'has fins' -- run --scene tiny --frames 1 --picture x.png --relief all --relief-rim
  expect 2 --flow-side -- bake --setup tiny --flow-side 100
  expect 2 --flow-layer -- bake --setup tiny --flow-layer head
  expect 2 --renderer -- run --scene tiny --renderer gl
  expect 2 --lighting-buffer -- run --scene tiny --picture x.png --lighting-buffer
  expect 2 --origins -- run --scene tiny --frames 1 --origins --picture x.png
  expect 2 --trace-frames -- run --scene tiny --trace-frames 3
  expect 2 --trace-worst -- run --scene tiny --trace-worst
  expect 2 'no effect with --trace-frames 0' -- run --scene tiny --trace x.json --trace-worst --trace-frames 0
  expect 2 --wet-at -- run --scene tiny --wet-at 3
  expect 2 --seed -- run --groom tiny.groom --seed 3
  expect 2 --quality -- run --scene tiny --solver pbd --quality best
  expect 2 --setup -- bake --keys --setup tiny
  expect 2 --chunk -- plan --scene tiny --json --chunk
  expect 2 --spus -- budget --scene tiny --platform xbox360 --spus 4
  expect 2 --local-store-kib -- budget --scene tiny --platform host --local-store-kib 128
  expect 2 --gpu-percent -- budget --scene tiny --platform ps3 --gpu-percent 4
  expect 2 'pelt calibrate' --costs -- fit --scene tiny --platform host
  expect 2 '--budget-us requires --costs' -- run --scene tiny --budget-us 100
  expect 2 '--budget-us has an effect only with --platform ps3, xbox360 or both' -- budget --scene tiny --budget-us 100
  expect 2 '--worst-px requires --budget-us' -- run --scene tiny --worst-px 1
  expect 2 --costs '--platform host' -- fit --scene tiny --costs host.toml
  expect 2 --solver -- run --scene tiny --solver pbd --plan plan.toml
  expect 2 --solver -- fit --scene tiny --solver pbd
  expect 2 --scene -- accuracy --plan plan.toml
  expect 2 --local-store -- plan --scene tiny --platform ps3 --local-store
  expect 2 --cores -- budget --scene tiny --platform ps3 --cores 2
  expect 2 --no-advice -- budget --scene tiny --platform host --no-advice
  expect 2 --scene -- budget --validate --scene tiny
  expect 2 --frames -- budget --numbers --frames 3
  expect 2 --hinted -- timing short.s --core ppe --hinted
  expect 2 --smt -- timing short.s --smt
  expect 2 --chart -- timing --kernel skin --chart 3 --json
}

# What files say reaches no terminal as it is.
check_control_characters() {
  printf '"\\u001b[2Jlenght" = 1\n[[layer]]\nname = "a"\n' >escape.toml
  expect 2 '\x1b[2Jlenght' -- bake --setup ./escape.toml
  printf '{"asset":{"version":"2\\u001b[2J"}}' >escape.gltf
  expect 2 '2\x1b[2J' -- bake --character escape.gltf --setup tiny
  printf 'b\033[2Jad 3\n' >escape.s
  expect 2 'no SPU opcode' -- timing escape.s
  expect 2 '\x1b[2J.groom' -- run --groom $'no\033[2J.groom'
  grep -q $'\033' err.txt && fail "an escape character on the terminal"
}

check_accuracy_errors() {
  expect 2 --rates -- accuracy --quick --rates 50
  expect 2 --presets -- accuracy --quick --presets hard
  expect 2 --tuned -- accuracy --quick --calibrated
  expect 2 --seed -- accuracy --quick --tuned --seed 3
  expect 2 --seed -- accuracy --features --seed 3
  expect 2 nowhere -- accuracy --scene nowhere
  expect 2 --presets -- accuracy --scene tiny --presets soft
  expect 2 --scene -- accuracy --frames 10
  expect 2 --features -- accuracy --scene tiny --features
  expect 2 --clip -- accuracy --clip walk
  expect 2 --features -- accuracy --setup tiny --features
  expect 2 'walk, idle, shake' -- accuracy --character builtin --setup tiny --clip run
  expect 2 /nowhere/ -- accuracy --scene tiny --quick --frames 12 --json /nowhere/x.json
  expect 2 'no such solver' -- stress --quick --solvers magic
  expect 2 --links -- stress --links 5
  echo 1,2 >list.csv
  expect 2 'not JSON' -- report --scene tiny --frames 1 --accuracy list.csv --out x.html
  printf '{"format": "pelt scene accuracy 0"}' >other.json
  expect 2 'other.json: is not of the format' -- report --scene tiny --frames 1 --accuracy other.json --out x.html
}

# Files and commands that are no runs: reported by name, by place and with the command's own message.
check_compare_errors() {
  "$pelt" run --scene tiny --frames 12 --json 2>/dev/null | as_own >a.json
  # What was asked for differs, and is said; what is as if not asked for, or only written somewhere, does not.
  "$pelt" run --scene tiny --frames 12 --no-sleep --fps 30 --lod --strand-budget 300 --fast-quality-px 0.5 \
    --digest-log b.digests --json 2>/dev/null | as_own >b.json
  "$pelt" compare a.json b.json --json >out.txt || fail "compare of other options"
  local option
  for option in --no-sleep:given --fps:30 --lod:given --strand-budget:300; do
    tr -d '\n' <out.txt | grep -qE "\"differs\": \"${option%%:*}\", *\"b\": \"${option##*:}\"" ||
      fail "compare does not say ${option}: $(cat out.txt)"
  done
  for option in --fast-quality-px --digest-log --json --scene --frames; do
    grep -q -- "\"$option\"" out.txt && fail "compare says $option: $(cat out.txt)"
  done
  sed 's/"--fps": "30"/"--fps": 30/' b.json >number.json
  expect 2 "'number.json': 'options.--fps' is not a text" -- compare a.json number.json
  head -c 3000 a.json >half.json
  sed 's/"samples"/"others"/' a.json >old.json
  expect 2 'two files of pelt run --json, or --commands' -- compare
  expect 2 'two files' -- compare a.json
  expect 2 --commands -- compare a.json a.json --commands true true
  expect 2 --commands -- compare --commands true
  expect 2 --rounds -- compare a.json a.json --rounds 6
  expect 2 --rounds -- compare --commands true true --rounds 5
  expect 2 missing.json -- compare a.json missing.json
  expect 2 "'half.json': not one whole JSON value: line" -- compare half.json a.json
  expect 2 "'old.json': 'samples' is missing" -- compare a.json old.json
  expect 2 "'echo no >&2; exit 3', round 1: exit code 3: no" -- \
    compare --commands 'cat a.json' 'echo no >&2; exit 3'
  expect 2 "'true', round 1: not one whole JSON value" -- compare --commands true 'cat a.json'
  expect 2 "'kill -9 \$\$', round 1: exit code 137" -- compare --commands 'kill -9 $$' 'cat a.json'
  sed -e 's/"isa": "[a-z0-9]*"/"isa": "\\u001b[2J"/' -e 's/"skin"/"\\u001b[2Jskin"/' a.json >escape.json
  "$pelt" compare a.json escape.json >out.txt || fail "compare escape.json"
  grep -q $'\033' out.txt && fail "an escape character of a run on the terminal"
  grep -qF '\x1b[2Jskin' out.txt || fail "no escaped name of a stage: $(cat out.txt)"
  # What was measured beside other processes is no answer, and the output says so.
  sed 's/"disturbances": \[\]/"disturbances": ["others ran"]/' a.json >unsure.json
  local left
  for left in a.json unsure.json; do
    "$pelt" compare "$left" unsure.json --page unsure.html >out.txt 2>err.txt
    is_unsure $? out.txt err.txt || fail "compare $left unsure.json: $(cat out.txt err.txt)"
    grep -q "^UNSURE: the machine was not B's own in 1 of 1 runs: others ran" out.txt || fail "no reason: $(cat out.txt)"
  done
  [ -s unsure.html ] || fail "no page of what is unsure"
  # The two run alternately, and the one that begins changes.
  : >turns
  "$pelt" compare --rounds 12 --commands 'echo a >>turns; cat a.json' 'echo b >>turns; cat a.json' >out.txt ||
    fail "compare --commands: $(cat out.txt)"
  [ "$(tr -d '\n' <turns)" = abbaabbaabbaabbaabbaabba ] || fail "turns: $(tr -d '\n' <turns)"
  tr '\n' ' ' <out.txt | grep -qE 'Intervals: 95 % for all [0-9]+ rows together, by ranks of 12 alternate rounds' || fail "rounds are not printed: $(cat out.txt)"
}

check_timing_errors() {
  printf 'nop\n' >fine.s
  expect 2 --kernel -- timing fine.s --kernel simulate_pbd
  expect 2 --kernel -- timing
  expect 2 --chart -- timing fine.s --chart 4
  expect 2 --trip -- timing --kernel skin --trip a=4
  expect 2 xenon -- timing fine.s --core xenon
  expect 2 'simulate_pbd_4, ' -- timing --kernel simulat_pbd
  expect 2 "begins so" -- timing --kernel ''
  "$pelt" timing --kernel fit_cubic_4 --chart 7 >out.txt || fail "timing --chart"
  [ "$(sed -n '/^ *cycle  pipe/,$p' out.txt | wc -l)" -eq 8 ] || fail "--chart 7 is not 7 lines: $(cat out.txt)"
  # Cut off in the middle; of other machines; a disassembly; no text at all.
  printf 'lqd $4, 0($3)\n ai ' >cut.s
  expect 2 "cut.s:2: 'ai' has 0 operands; expected register" -- timing cut.s
  printf '\t.text\nf:\n\tpushq\t%%rbp\n\tmovaps\t(%%rdi), %%xmm0\n' >x86.s
  expect 2 "x86.s:3: 'pushq' is no SPU opcode" -- timing x86.s
  expect 2 'of another machine' -- timing x86.s
  expect 2 'for the PPE' -- timing x86.s --core ppe
  printf '\na.out:     file format elf32-spu\n   0:\t34 00 01 84\tlqd\t$4,0($3)\n' >dump.s
  expect 2 'a disassembly' -- timing dump.s
  expect 2 'no instruction' -- timing /dev/null
}

# Two loops on the PPE's two threads: each is reported beside what it takes alone, whichever is named first.
check_second_thread() {
  printf 'loop: add r3,r3,r4\n addi r5,r5,1\n bdnz loop\n' >adds.s
  printf 'iteration: vmaddfp v1,v1,v2,v3\n bdnz iteration\n' >chain.s
  printf 'add r3,r3,r4\n' >straight.s
  local pair=(timing adds.s --core ppe --second-thread)
  expect 2 'missing.s: no such file' -- "${pair[@]}" missing.s
  expect 2 'a folder, not a file' -- "${pair[@]}" .
  expect 2 'the path is empty' -- "${pair[@]}" ''
  expect 2 'straight.s: 0 loops' -- "${pair[@]}" straight.s
  expect 2 'straight.s: 0 loops' -- timing straight.s --core ppe --second-thread adds.s
  printf 'a: lqd $4,0($3)\n brnz $7,a\n' >spu.s
  expect 2 "spu.s:1: 'lqd' is no PPE opcode" -- "${pair[@]}" spu.s
  expect 2 '--core ppe' -- timing adds.s --second-thread chain.s
  expect 2 --smt -- "${pair[@]}" chain.s --smt
  expect 2 --trip -- "${pair[@]}" chain.s --trip loop=3
  expect 2 --second-thread -- timing --kernel skin --second-thread chain.s
  expect 2 'standard input is the first listing' -- timing - --core ppe --second-thread -
  "$pelt" "${pair[@]}" chain.s >there.txt || fail "timing --second-thread"
  "$pelt" timing chain.s --core ppe --second-thread adds.s >back.txt || fail "timing --second-thread, the other way"
  grep -q '^adds.s *loop *2.00 *[0-9.]* ' there.txt || fail "first thread: $(cat there.txt)"
  grep -q '^chain.s *iteration *12.00 *12.00 *100$' there.txt || fail "second thread: $(cat there.txt)"
  diff <(sort there.txt) <(sort back.txt) || fail "which thread is named first changes what they take"
  "$pelt" "${pair[@]}" - <chain.s | tr -s ' ' | diff - <(sed 's/^chain.s/standard input/' there.txt | tr -s ' ') ||
    fail "a second thread from a pipe"
  # A loop that leaves no cycle unused has half of them beside itself.
  "$pelt" "${pair[@]}" adds.s >same.txt || fail "timing --second-thread, twice the same"
  [ "$(grep -c '^adds.s *loop *2.00 *4.00 *50$' same.txt)" -eq 2 ] ||
    fail "twice the same: $(cat same.txt)"
  "$pelt" "${pair[@]}" chain.s --json | tr -d ' \n' |
    grep -q '"listing":"chain.s","loop":"iteration","cycles_per_iteration_alone":12' ||
    fail "timing --second-thread --json"
}

# At which error a scene runs, and what better ones cost.
check_qualities() {
  printf '[[layer]]\nname = "a"\nsolver = "modal"\ndensity = 20000\nmax_strands = 600\n' >one.toml
  local budget=(budget --setup ./one.toml --frames 8 --warm-up 8 --no-advice --target-ms 1000 --qualities)
  "$pelt" "${budget[@]}" --platform ps3 --fast-quality-px 0 --quality fast >qualities.txt || fail "budget --qualities: exit $?"
  awk '/^as it is /{off = $4; ms = $6} /^(fine|best) /{n += $2 < 0.9 * off && $4 > 1.2 * ms} /^(fine|best): /{n += /px a millisecond$/}
    END{exit n != 4}' qualities.txt || fail "budget --qualities: $(tail -n 8 qualities.txt)"
  # So far off that `fine` runs in `fast`.
  "$pelt" "${budget[@]}" --platform ps3 --fast-quality-px 1e6 --quality fast | grep -q '^fine is the same here' ||
    fail "fine is not the same in fast"
  "$pelt" "${budget[@]}" --platform xbox360 --fast-quality-px 0 --quality fine >qualities.txt || fail "budget --qualities of fine: exit $?"
  grep -qE '^fast: [0-9.]+ ms less, [0-9.]+ px more$' qualities.txt || fail "what is cheaper: $(cat qualities.txt)"
}

check_budget_errors() {
  local budget=(budget --scene tiny --frames 2)
  expect 2 'gives a game 6' -- "${budget[@]}" --spus 0
  expect 2 '7 SPUs; a retail PS3 gives a game at most 6' -- "${budget[@]}" --spus 7
  expect 2 'at least 65536 are needed' -- "${budget[@]}" --local-store-kib 16
  expect 2 'a Cell has' -- "${budget[@]}" --local-store-kib 99999999
  # A scene the console cannot run is a verdict, in its place in the table, not an error of the command.
  "$pelt" "${budget[@]}" --platform ps3 --local-store-kib 64 >out.txt 2>&1
  [ $? -eq 1 ] || fail "a scene that does not fit a local store: not exit 1"
  tr '\n' ' ' <out.txt | grep -q "CANNOT RUN: tiny on PS3: stage sample_pose: .* beside 1024 of code" || fail "no verdict in: $(cat out.txt)"
  expect 2 'no core' -- "${budget[@]}" --cores 0
  expect 2 '99 cores' -- "${budget[@]}" --cores 99
  expect 2 '4 cores; an Xbox 360 has 3' -- "${budget[@]}" --cores 4
  expect 2 --cores -- "${budget[@]}" --cores -1
  expect 2 tinny -- budget --scene tinny --frames 2
  expect 2 missing.glb -- budget --character missing.glb --setup tiny --frames 2
  expect 2 'leave the cores some' -- "${budget[@]}" --gpu-percent 100
  expect 2 --gpu-percent -- "${budget[@]}" --gpu-percent 101
  expect 2 --target-ms -- "${budget[@]}" --target-ms 0
  expect 2 --target-ms -- "${budget[@]}" --target-ms nan
  expect 2 '{host,ps3,xbox360}' -- "${budget[@]}" --platform wii
  expect 2 --spuz -- "${budget[@]}" --spuz 3
  expect 2 '--trace has an effect only with --platform ps3 or xbox360' -- "${budget[@]}" --platform host --trace x.json
  expect 2 /nowhere/ -- "${budget[@]}" --platform ps3 --trace /nowhere/x.json
  # What does not fit is a verdict: exit code 1, and nothing on standard error.
  "$pelt" "${budget[@]}" --platform ps3,xbox360 --target-ms 0.01 >out.txt 2>err.txt && fail "0.01 ms: exit 0"
  [ -s err.txt ] && fail "a verdict on standard error: $(cat err.txt)"
  [ "$(grep -c 'DOES NOT FIT 0.01 ms' out.txt)" -eq 2 ] || fail "no verdict: $(tail -n 3 out.txt)"
  grep -q '^to fit 0.01 ms: strands: ' out.txt || fail "no advice: $(tail -n 9 out.txt)"
  "$pelt" "${budget[@]}" --platform ps3 --target-ms 0.01 --no-advice | grep -q '^to fit' && fail "--no-advice advises"
}

run_parts errors=check_errors
