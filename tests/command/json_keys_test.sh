#!/usr/bin/env bash
# What the commands print with --json is as bench/report/json_keys.txt says: every key documented, of the type that it
# says, and no key missing; and `pelt --json-keys` prints that list.
#   json_keys_test.sh PELT SOURCE_DIR
set -uo pipefail
. "$(dirname "$0")/head.sh" "$@"
command -v python3 >/dev/null || { echo "SKIPPED: no python3"; exit 77; }
check=$source_dir/tests/command/json_keys.py
declare -A seen
python3 "$check" --self-test || fail "the checker itself"
"$pelt" --json-keys >keys.txt || fail "pelt --json-keys: exit $?"
cmp keys.txt "$source_dir/bench/report/json_keys.txt" || fail "pelt --json-keys is another list"

# hold SECTION arguments...: what pelt prints is JSON by that section; the exit code may be a verdict.
hold() {
  local section=$1
  shift
  seen[$section]=1
  "$pelt" "$@" --json >out.json 2>err.txt
  local code=$?
  [ "$code" -le 1 ] || is_unsure "$code" out.json err.txt || fail "pelt $* --json: $(cat err.txt)"
  python3 "$check" keys.txt "$section" out.json >faults.txt || fail "pelt $* --json: $(cat faults.txt)"
}

printf 'loop: lqd $4, 0($3); fa $4, $4, $5; ai $7, $7, -1\n stqd $4, 0($3); ai $3, $3, 16; brnz $7, loop\n' >add.s
printf 'loop: lwz 4,0(3); addi 3,3,4; bdnz loop\n' >load.s
printf 'loop: fadd 1,1,2; bdnz loop\n' >sum.s
# What proves, searches or prices is asked about one layer: of a scene it takes minutes.
printf '[[layer]]\nname = "a"\nsolver = "modal"\ndensity = 2000\nmax_strands = 100\n' >one.toml
grep -v solver one.toml >plain.toml
"$pelt" bake --setup tiny --seed 1 --out a.groom >/dev/null 2>&1
"$pelt" bake --setup tiny --seed 2 --out b.groom >/dev/null 2>&1
"$pelt" trace record --scene tiny --frames 3 --out tiny.peltinput >/dev/null 2>&1
"$pelt" trace record --scene tiny --frames 3 --lod --out lod.peltinput >/dev/null 2>&1

hold bake bake --setup tiny
hold bake bake --setup tiny --stats --out c.groom
hold bake bake --setup tiny --flow-map flow.png --height-field hairs.png --flow-side 64
cp "$source_dir/tests/fuzz/corpus/gltf/builtin.glb" coarse.glb
printf 'chain_mesh = "coarse.glb"\n[[layer]]\nname = "a"\ndensity = 20000\n' >coarse.toml
hold bake bake --setup ./coarse.toml --skin-map skin.png --stencil-map stencil.png --flow-side 64
hold show show scorpion
hold run run --scene tiny --frames 2
hold run run --scene tiny --frames 1 --executor local-store
"$pelt" calibrate --scenes everything,tiny --frames 2 --out host.toml >calibrate.txt || fail "calibrate: exit $?"
hold run run --scene tiny --frames 2 --lod --budget-us 100 --costs host.toml
hold run run --scene tiny --frames 1 --no-sleep --fps 30 --mud 0.5
hold run run --scene tiny --frames 1 --picture tiny.png --picture-width 64 --picture-height 48
hold run run --scene tiny --frames 1 --picture tiny.png --picture-width 64 --picture-height 48 --relief all
"$pelt" run --scene tiny --frames 20 --json >one.json 2>/dev/null
"$pelt" run --scene tiny --frames 20 --isa reference --no-digest --json >two.json 2>/dev/null
hold compare compare one.json one.json
hold compare compare one.json two.json
hold compare compare --rounds 6 --commands 'cat one.json' 'cat two.json'
hold plan plan --scene tiny
hold plan plan --scene tiny --local-store --unfused
hold plan plan --setup ./one.toml --platform ps3
hold verify verify --setup ./plain.toml --frames 1 --isa reference
hold verify verify --scene tiny --frames 1 --isa reference --shard 1/3 --no-checks
hold golden golden --check "$source_dir/traces/golden" --scene tiny
hold diff diff a.groom b.groom
hold diff diff a.groom a.groom
hold diff diff tiny.peltinput lod.peltinput
hold trace_show trace show tiny.peltinput
hold trace_replay trace replay tiny.peltinput
hold conformance conformance --door inline
hold budget budget --setup ./one.toml --frames 2
hold budget budget --setup ./one.toml --frames 2 --platform ps3 --target-ms 0.01
hold budget budget --setup ./one.toml --frames 2 --platform ps3 --local-store-kib 64
hold budget budget --setup ./one.toml --frames 2 --platform ps3 --qualities
hold budget_validate budget --validate
hold fit fit --setup ./one.toml --frames 4 --warm-up 4 --target-ms 0.6
hold fit fit --setup ./one.toml --frames 4 --warm-up 4 --platform ps3 --target-ms 0.01
hold timing timing add.s --trip loop=8
hold timing_pair timing load.s --core ppe --second-thread sum.s
hold timing_kernel timing --kernel skin
# hold_file SECTION arguments...: commands that write their JSON to a file.
hold_file() {
  local section=$1
  shift
  seen[$section]=1
  "$pelt" "$@" --json file.json >/dev/null 2>err.txt || fail "pelt $* --json: $(cat err.txt)"
  python3 "$check" keys.txt "$section" file.json >faults.txt || fail "pelt $* --json: $(cat faults.txt)"
}
hold_file stress stress --quick --solvers modal --links 3 --rates 60 --isa reference
hold_file accuracy accuracy --quick --presets soft
hold_file accuracy_scene accuracy --quick --scene tiny --frames 12
printf '[[layer]]\ncharacter = 0\nname = "vertex"\nsolver = "modal"\nquality = "fast"\n' >plan.toml
hold_file accuracy_scene accuracy --quick --scene tiny --frames 12 --plan plan.toml
hold_file accuracy_features accuracy --quick --features --links 3

# A key that the list does not document, and one that went missing, are seen.
sed 's/"scene": /"scenery": /' <("$pelt" run --scene tiny --frames 1 --json 2>/dev/null) >renamed.json
python3 "$check" keys.txt run renamed.json >faults.txt && fail "a renamed key passes"
grep -q "'scenery' is not documented" faults.txt || fail "the renamed key is not named: $(cat faults.txt)"
grep -q "has no 'scene'" faults.txt || fail "the missing key is not named: $(cat faults.txt)"

for section in $(python3 "$check" keys.txt); do
  [ -n "${seen[$section]:-}" ] || fail "no output is checked by the section $section"
done
[ "$failures" -eq 0 ] || exit 1
echo "all passed: ${#seen[@]} sections"
