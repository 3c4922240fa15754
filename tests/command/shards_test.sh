#!/usr/bin/env bash
# The long matrix on many processes, as it is run: shards one by one, and three at once by mpirun.
# Both must merge to what one process prints.
#   shards_test.sh PELT SOURCE_DIR
set -euo pipefail
. "$(dirname "$0")/head.sh" "$@"
golden=$source_dir/traces/golden
matrix=(verify --scene tiny --frames 1 --isa reference --json)
"$pelt" "${matrix[@]}" >whole.json

# same MERGED: byte for byte what one process printed.
same() { cmp whole.json "$1" || fail "$1 is not what one process prints"; }
for i in 0 1 2; do "$pelt" "${matrix[@]}" --shard "$i/3" >"$i.json"; done
"$pelt" verify --merge 2.json 0.json 1.json --json >merged.json
same merged.json
"$pelt" verify --merge 0.json 1.json 2.json | grep -q '^verdict: SAME BITS in all' || fail "no verdict"
echo "three shards one by one: the whole run's report"

for i in 0 1; do "$pelt" golden --check "$golden" --scene tiny --json --shard "$i/2" >"g$i.json"; done
"$pelt" golden --merge g0.json g1.json | grep -q '^verdict: SAME BITS in all 2 cases' || fail "golden shards"

expect 2 "missing: 1/3" -- verify --merge 0.json 2.json
expect 2 "both shard 0/3" -- verify --merge 0.json 0.json 1.json
expect 2 "printed by pelt golden" -- verify --merge 0.json g1.json
expect 2 "nowhere.json" -- verify --merge nowhere.json
head -c 2000 1.json >cut.json
expect 2 "cut.json: not one whole JSON value" -- verify --merge 0.json cut.json 2.json
"$pelt" verify --scene tiny --frames 2 --isa reference --json --shard 1/3 >other.json
expect 2 "'frames'" -- verify --merge 0.json other.json 2.json
expect 2 "from 0/3 to 2/3" -- verify --scene tiny --shard 3/3
expect 2 "no launcher" -- verify --scene tiny --shard env
expect 2 --merge -- verify --merge 0.json --scene tiny
expect 2 "for --check" -- golden --renew . --scene tiny --shard 0/2
[ ! -e tiny.digests ] || fail "a refused renewal wrote"

[ "$failures" -eq 0 ] || exit 1
command -v mpirun >/dev/null || { echo "SKIPPED: no mpirun here; the same by three processes at once"; exit 77; }
OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1 OMPI_MCA_rmaps_base_oversubscribe=1 \
  mpirun -n 3 --oversubscribe sh -c '"$0" "$@" --shard env >"rank$OMPI_COMM_WORLD_RANK.json"' "$pelt" "${matrix[@]}"
"$pelt" verify --merge rank0.json rank1.json rank2.json --json >mpi.json
same mpi.json
echo "mpirun -n 3: the whole run's report"
[ "$failures" -eq 0 ] || exit 1
