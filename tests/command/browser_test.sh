#!/usr/bin/env bash
# The report's page and the trace in a real browser: headless Chromium, and speedscope as the trace's viewer.
#   browser_test.sh PELT WORK_DIR report|trace
# `report`: at desktop and phone width the page runs without a script error, its pictures have content and it does
# not scroll sideways. `trace`: speedscope shows the profile of each worker and has nothing to complain about.
# Each check is given broken files too, which it must refuse. Exit code 77 (skipped): no browser, or no viewer, and
# none to be had.
set -uo pipefail
pelt=$(realpath "$1")
mkdir -p "$2"
work=$(realpath "$2")
part=$3
skip() {
  echo "SKIPPED: $*" >&2
  exit 77
}
failures=0
fail() {
  echo "FAILED: $*" >&2
  failures=$((failures + 1))
}

browser=$(command -v chromium || command -v chromium-browser || command -v google-chrome) || browser=
if [ -z "$browser" ] && [ "$(id -u)" -eq 0 ] && command -v apt-get >/dev/null; then
  { apt-get -qq update && DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends chromium; } \
    </dev/null >"$work/apt.log" 2>&1
  browser=$(command -v chromium) || browser=
fi
[ -n "$browser" ] || skip "no Chromium here, and none could be installed (Debian: apt-get install chromium)"

# open URL WIDTH OUT: the page after its script ran in OUT.html, what the browser said in OUT.log.
open() {
  local profile
  profile=$(mktemp -d)
  timeout 150 "$browser" --headless --no-sandbox --disable-gpu --enable-unsafe-swiftshader --disable-quic --no-first-run \
    --disable-background-networking --disable-component-update --disable-sync --disable-dev-shm-usage \
    --user-data-dir="$profile" --window-size="$2,900" --enable-logging=stderr --virtual-time-budget=6000 --dump-dom \
    "$1" >"$3.html" 2>"$3.log" </dev/null
  local code=$?
  rm -rf "$profile"
  return "$code"
}

# ---- the report ------------------------------------------------------------------------------------
probe="<script>$(cat "$(dirname "$0")/report_probe.js")</script>"

attribute() { sed -n "s/.*<html[^>]* data-$2=\"\([^\"]*\)\".*/\1/p" "$1" | head -n 1; }

# check_page PAGE WIDTH [CONSOLES [DIAGRAMS [KIND]]]: silent when all is well, else a line for each fault. CONSOLES: 2
# if not given; DIAGRAMS: panels of error against run time, 0 if not given; KIND: accuracy (of solvers) or ways.
check_page() {
  local page=$1 width=$2 consoles=${3-2} diagrams=${4-0} kind=${5-accuracy} out=$work/page.$2 name=
  local rod=$((diagrams > 0))
  [ "$kind" = accuracy ] || rod=0
  python3 - "$page" "$out.probed.html" "$probe" "$width" <<'PYTHON' || { echo "cannot be probed"; return; }
import sys
width = sys.argv[4]
text = open(sys.argv[1], encoding='utf-8').read()
assert '<style>' in text
open(sys.argv[2], 'w', encoding='utf-8').write(text.replace('<style>', sys.argv[3] + '<style>', 1))
open(sys.argv[2].replace('.probed.', '.framed.'), 'w').write(f'''<!doctype html><html><body>
<iframe src="{sys.argv[2].rpartition("/")[2]}" style="border: 0; width: {width}px; height: 900px"></iframe>
<script>addEventListener("message", (e) => Object.assign(document.documentElement.dataset, e.data));</script>''')
PYTHON
  open "file://$out.framed.html" 1400 "$out" || { echo "the browser failed: $(tail -n 2 "$out.log")"; return; }
  [ -z "$(attribute "$out.html" error)" ] || echo "script error: $(attribute "$out.html" error)"
  grep 'CONSOLE' "$out.log" | head -n 3
  [ "$(attribute "$out.html" inner)" = "$width" ] || echo "the frame is $(attribute "$out.html" inner) wide, not $width"
  [ "$(attribute "$out.html" scroll)" -le "$width" ] 2>/dev/null ||
    echo "the page is $(attribute "$out.html" scroll) wide in a frame of $width"
  local counts
  counts=$(attribute "$out.html" pictures)
  [ "$(wc -w <<<"$counts")" -eq $((3 + consoles + diagrams + rod)) ] ||
    echo "pictures: '$counts', not $((3 + consoles + diagrams + rod))"
  [ "$(grep -o "$kind:" <<<"$counts" | wc -l)" -eq "$diagrams" ] || echo "diagrams: '$counts', not $diagrams"
  [ "$(grep -o 'console:' <<<"$counts" | wc -l)" -eq "$consoles" ] || echo "consoles: '$counts', not $consoles"
  for name in $counts; do
    [ "${name#*:}" -ge 5 ] || echo "picture $name has under 5 filled paths"
  done
  [ "$(attribute "$out.html" named)" = $((3 + consoles + diagrams + rod)) ] || echo "a picture has no name"
  # Two of the costs; of each console: its units, and its stages; of the diagrams: one, of solvers the modal one's, and
  # the rod's.
  local tables=$((9 + 2 * consoles + (diagrams > 0) + 2 * rod))
  [ "$(attribute "$out.html" tables)" = "$tables" ] || echo "$(attribute "$out.html" tables) tables, not $tables"
  [ -z "$(attribute "$out.html" frames)" ] || echo "frames: $(attribute "$out.html" frames)"
  [ -z "$(attribute "$out.html" costs)" ] || echo "costs: $(attribute "$out.html" costs)"
  [ -z "$(attribute "$out.html" lanes)" ] || echo "lanes: $(attribute "$out.html" lanes)"
  [ -z "$(attribute "$out.html" cut)" ] || echo "cut off: $(attribute "$out.html" cut)"
  [ -z "$(attribute "$out.html" rod)" ] || echo "rod: $(attribute "$out.html" rod)"
  [ -z "$(attribute "$out.html" ways)" ] || echo "ways: $(attribute "$out.html" ways)"
  [ "$(attribute "$out.html" section)" = "$((consoles > 0))" ] || echo "section of consoles shown: $(attribute "$out.html" section)"
  [ "$(attribute "$out.html" clipped)" = 0 ] || echo "$(attribute "$out.html" clipped) names of lanes are cut off"
  [ "$(attribute "$out.html" uncoloured)" = 0 ] || echo "$(attribute "$out.html" uncoloured) bars have no colour"
  [ "$consoles" = 0 ] || [[ "$(attribute "$out.html" tip)" == *µs* ]] ||
    echo "pointing at a console says '$(attribute "$out.html" tip)'"
  [ "$(attribute "$out.html" planted)" = 0 ] || echo "text became markup"
  [ "$(attribute "$out.html" hostile)" = undefined ] || echo "text became a script"
}

# must_fail PAGE WORD: the check must see it.
must_fail() {
  local said
  said=$(check_page "$1" 360)
  grep -qF -- "$2" <<<"$said" || fail "$(basename "$1") is broken, and the check said: '$said'"
}

# faulty SED WORD: the page of a scene's ways with a fault in its script.
faulty() {
  sed "$1" "$work/ways.html" >"$work/faulty.html"
  cmp -s "$work/ways.html" "$work/faulty.html" && fail "'$1' changes nothing"
  must_fail "$work/faulty.html" "$2"
}

test_ways() {
  (cd "$work" && "$pelt" accuracy --scene tiny --quick --json scene.json >/dev/null &&
    "$pelt" report --scene tiny --frames 5 --no-consoles --accuracy scene.json --out ways.html) \
    >"$work/ways.log" 2>&1 || { fail "pelt report --accuracy, of a scene: $(cat "$work/ways.log")"; return; }
  local width said
  for width in 1280 360; do
    said=$(check_page "$work/ways.html" "$width" 0 2 ways)
    [ -z "$said" ] || fail "with the ways to run a scene, at $width px: $said"
  done
  # Names that would be markup, of a way and of the scene.
  sed -E "s#\"(label|scene)\": \"(PBD|tiny)\"#\"\1\": \"</script><script>hostile = 1</script><b class='planted'>\"#" \
    "$work/scene.json" >"$work/named.json"
  (cd "$work" && "$pelt" report --scene tiny --frames 5 --no-consoles --accuracy named.json --out named.html) \
    >"$work/named.log" 2>&1 || fail "pelt report --accuracy, of hostile names: $(cat "$work/named.log")"
  grep -q 'u003cb class=.planted' "$work/named.html" || fail "no hostile name in the page"
  said=$(check_page "$work/named.html" 1280 0 2 ways)  # where names that long have room
  [ -z "$said" ] || fail "with hostile names: $said"
  faulty "s/ns: 'simulate_ns'/ns: 'frame_ns'/" 'ways: simulate x of'
  faulty 's|Math.log(value / least)|(value / least)|' ' x of'
  faulty "s/: ' hollow'/: ''/" 'ways: hollow points: 0'
  faulty 's/if (ringed)/if (!ringed)/' 'ways: rings'
  faulty "s/'front', d: stairs.join('')/'front', d: stairs[0]/" 'ways: steps of the front: 1'
  faulty 's/!taken.some(/taken.every(/' 'names'
  faulty 's/if (ways.reference_self_error > 0)/if (false)/' 'ways: dashed lines: 0'
  faulty 's/^  fillWaysTable(ways);//' 'ways: rows of the table: 0'
  faulty 's/, fillWays()\];/];/' 'ways: panels: 0'
}

# spiked PAGE OUT MEDIAN MS...: the page with a median frame of so many ms, and first frames that took others.
spiked() {
  python3 - "$@" <<'PYTHON'
import json, sys
page, out, median, slow = sys.argv[1], sys.argv[2], float(sys.argv[3]), [float(ms) for ms in sys.argv[4:]]
begin, end = '<script type="application/json" id="data">', '</script>'
head, rest = open(page, encoding='utf-8').read().split(begin, 1)
text, tail = rest.split(end, 1)
data = json.loads(text)
times = slow + [median] * (len(data['columns']) - len(slow))
for column, ms in zip(data['columns'], times):
    column['waiting'] += ms - column['ms']
    column['ms'] = ms
for column in data['columns']:
    column['disturbed'] = column['ms'] != median
timeline = data['timelines'][0]
timeline.update(disturbed=True, waited_ms=3.5, preemptions=2)
timeline['workers'][0]['preempted'] = timeline['workers'][0]['runs'][2:4] + [1000]
data['frame_ms'] = dict(median=median, p95=max(times), p99=max(times), worst=max(times))
open(out, 'w', encoding='utf-8').write(head + begin + json.dumps(data).replace('<', '\\u003c') + end + tail)
PYTHON
}

# However slow some frames are, 5 and 8 ms can be read, and the slow ones say what they took.
test_slow_frames() {
  local page=$work/plain.html width said times
  for times in '4 300' '0.4 300 41 8.5 300' '30 300' '120 900 900' '7.5 16.5'; do
    # shellcheck disable=SC2086
    spiked "$page" "$work/spiked.html" $times
    for width in 1280 360; do
      said=$(check_page "$work/spiked.html" "$width" 0)
      [ -z "$said" ] || fail "frames of $times ms at $width px: $said"
    done
  done
  spiked "$page" "$work/spiked.html" 4 300 41
  sed 's/Math.max(kMostMs, 1.25 \* median)/2.5 * worst/' "$work/spiked.html" >"$work/pressed.html"
  must_fail "$work/pressed.html" '5 and 8 ms at'
  sed 's/filter((c) => c.ms > top);/filter((c) => c.ms > 299);/' "$work/spiked.html" >"$work/unmarked.html"
  must_fail "$work/unmarked.html" 'frames: marks of slow frames: 1, not 2'
  sed 's/if (column.disturbed)/if (false)/' "$work/spiked.html" >"$work/undisturbed.html"
  must_fail "$work/undisturbed.html" 'marks of disturbed frames: 0, not 2'
  sed 's/of preemptedOf(worker))/of [])/' "$work/spiked.html" >"$work/taken.html"
  must_fail "$work/taken.html" 'marks of preempted items: 0, not 1'
  sed 's/if (taken.some((other)/if (false \&\& taken.some((other)/' "$work/spiked.html" >"$work/heaped.html"
  must_fail "$work/heaped.html" 'frames: texts lie on each other'
}

# Two runs side by side: what pelt compare --page writes, at both widths.
pair_probe='<script>
addEventListener("error", (e) => parent.postMessage({error: e.message}, "*"));
addEventListener("load", () => setTimeout(() => {
  const data = JSON.parse(document.getElementById("data").textContent);
  const pictures = [...document.querySelectorAll("svg[data-picture=frames]")];
  const cutOff = [...document.querySelectorAll("svg[role=img], table")].filter((e) => e.getBoundingClientRect().right > innerWidth && !e.closest(".scroll"));
  parent.postMessage({
    scroll: document.documentElement.scrollWidth, cut: cutOff.length,
    tops: pictures.map((svg) => svg.dataset.top).join(" "),
    beside: Number(pictures[0].getBoundingClientRect().top === pictures[1].getBoundingClientRect().top),
    rows: document.querySelectorAll("#costs tbody tr").length - data.comparison.costs.length,
    settings: document.querySelectorAll("#settings tbody tr").length - data.comparison.settings.length,
  }, "*");
}, 100));
</script>'
test_pair() {
  local width beside out=$work/pair
  "$pelt" run --scene tiny --frames 24 --json >"$work/a.json" 2>/dev/null
  "$pelt" run --scene tiny --frames 30 --isa reference --json >"$work/b.json" 2>/dev/null
  (cd "$work" && "$pelt" compare a.json b.json --page two.html) >"$work/pair.log" 2>&1 || [ -s "$work/two.html" ] || { fail "compare --page: $(cat "$work/pair.log")"; return; }
  for width in 1280 360; do
    python3 - "$work/two.html" "$out.probed.html" "$pair_probe" "$width" "$out.framed.html" <<'PYTHON'
import sys
text = open(sys.argv[1], encoding='utf-8').read()
open(sys.argv[2], 'w', encoding='utf-8').write(text.replace('<style>', sys.argv[3] + '<style>', 1))
open(sys.argv[5], 'w').write(f'''<!doctype html><html><body>
<iframe src="pair.probed.html" style="border: 0; width: {sys.argv[4]}px; height: 900px"></iframe>
<script>addEventListener("message", (e) => Object.assign(document.documentElement.dataset, e.data));</script>''')
PYTHON
    open "file://$out.framed.html" 1400 "$out" || { fail "the browser, of two runs: $(tail -n 2 "$out.log")"; return; }
    [ -z "$(attribute "$out.html" error)" ] || fail "two runs: script error: $(attribute "$out.html" error)"
    [ "$(attribute "$out.html" scroll)" -le "$width" ] || fail "two runs at $width px: $(attribute "$out.html" scroll) wide"
    [ "$(attribute "$out.html" cut)" = 0 ] || fail "two runs at $width px: something is cut off"
    beside=$((width > 1000))
    [ "$(attribute "$out.html" beside)" = "$beside" ] || fail "two runs at $width px: side by side or not"
    [ "$(attribute "$out.html" tops | tr ' ' '\n' | sort -u | wc -l)" = 1 ] || fail "two runs: two scales"
    [ "$(attribute "$out.html" rows)$(attribute "$out.html" settings)" = 00 ] || fail "two runs: rows are missing"
  done
}

test_report() {
  command -v python3 >/dev/null || skip "no python3"
  cat >"$work/hostile.toml" <<'TOML'
[[layer]]
name = "</script><script>hostile = 1</script><b class='planted'>\"'&<!--"
length = 0.05
density = 4000
TOML
  # A layer of it is too large for an SPU to sort.
  sed 's/density = 4000/density = 20000/' "$work/hostile.toml" >"$work/large.toml"
  (cd "$work" && "$pelt" report --character builtin --setup ./hostile.toml --frames 30 --workers 2 --out report.html) \
    >"$work/report.log" 2>&1 || { cat "$work/report.log"; fail "pelt report"; return; }
  local page=$work/report.html width said
  grep -oE '(src|href)="[^"]*"|https?://[^"'"'"' ]*' "$page" | grep -v 'http://www.w3.org/2000/svg' | head -n 3 >"$work/outside"
  [ -s "$work/outside" ] && fail "the page asks for something outside it: $(cat "$work/outside")"
  for width in 1280 360; do
    said=$(check_page "$page" "$width")
    [ -z "$said" ] || fail "at $width px: $said"
  done
  (cd "$work" && "$pelt" report --scene tiny --frames 20 --no-consoles --out plain.html) >"$work/plain.log" 2>&1 ||
    fail "pelt report --no-consoles"
  said=$(check_page "$work/plain.html" 360 0)
  [ -z "$said" ] || fail "without consoles: $said"
  must_fail "$work/plain.html" "consoles: "
  sed 's|/ (to - from), (from + to)|/ (to - from), 0 * (from + to)|' "$work/plain.html" >"$work/undragged.html"
  must_fail "$work/undragged.html" 'lanes: left edge'
  sed 's/.toLowerCase().includes(this.query)/.includes(this.query)/; s/query.trim().toLowerCase()/query.trim()/' "$work/plain.html" >"$work/blind.html"
  must_fail "$work/blind.html" ' 0 found'
  sed "s/: kind + ' dim'/: kind/" "$work/plain.html" >"$work/bright.html"
  must_fail "$work/bright.html" 'the others are not dimmed'
  sed 's/b.core_ms.median - a.core_ms.median)/a.i - b.i)/' "$work/plain.html" >"$work/unsorted.html"
  must_fail "$work/unsorted.html" 'costs: layers are not by cost'
  test_slow_frames
  test_pair
  (cd "$work" && "$pelt" accuracy --quick --presets soft,stiff --json accuracy.json >/dev/null &&
    "$pelt" report --scene tiny --frames 5 --no-consoles --accuracy accuracy.json --out accuracy.html) \
    >"$work/accuracy.log" 2>&1 || fail "pelt report --accuracy: $(cat "$work/accuracy.log")"
  for width in 1280 360; do
    said=$(check_page "$work/accuracy.html" "$width" 0 2)
    [ -z "$said" ] || fail "with diagrams, at $width px: $said"
  done
  must_fail "$work/accuracy.html" "diagrams: "
  sed 's/r.ns > 0 \&\& r.pooled > 0);/r.ns > 100);/' "$work/accuracy.html" >"$work/fewer.html"
  must_fail "$work/fewer.html" 'rod: points'
  test_ways
  (cd "$work" && "$pelt" report --character builtin --setup ./large.toml --frames 3 --out large.html) >"$work/large.log" 2>&1 ||
    fail "pelt report, of what a PS3 cannot run: $(cat "$work/large.log")"
  said=$(check_page "$work/large.html" 360 1)
  [ -z "$said" ] || fail "without a PS3: $said"
  grep -q 'PS3: cannot run this scene' "$work/large.html" || fail "the page does not say why there is no PS3"
  sed "s/compute: 's0'/compute: 'nowhere'/" "$page" >"$work/uncoloured.html"
  must_fail "$work/uncoloured.html" 'no colour'
  sed 's/words.length < 4/words.length < 5/' "$page" >"$work/clipped.html"
  must_fail "$work/clipped.html" 'cut off'
  sed "s/^fillFacts();/fillFacts(); nowhere();/" "$page" >"$work/thrown.html"
  must_fail "$work/thrown.html" 'script error'
  sed "s/^drawAll();/drawFrames();/" "$page" >"$work/empty.html"
  must_fail "$work/empty.html" "not 5"
  sed "s/'path', {class: 'band ' + kind, d}/'path', {class: 'band ' + kind}/" "$page" >"$work/blank.html"
  must_fail "$work/blank.html" 'filled paths'
  sed 's/^\.scroll { overflow-x: auto; max-width: 100%; }/.scroll { width: 900px; }/' "$page" >"$work/wide.html"
  must_fail "$work/wide.html" 'wide in a frame'
  sed 's/\\u003c/</g' "$page" >"$work/unescaped.html"
  must_fail "$work/unescaped.html" 'text became'
}

# ---- the trace -------------------------------------------------------------------------------------
viewer_version=1.25.0
find_viewer() {
  viewer=$work/speedscope-$viewer_version/package/dist/release/pelt.html
  [ -s "$viewer" ] && return 0
  command -v npm >/dev/null || skip "no npm to get the viewer with"
  (cd "$work" && mkdir -p "speedscope-$viewer_version" && timeout 45 npm pack --silent "speedscope@$viewer_version" &&
    tar -xzf "speedscope-$viewer_version.tgz" -C "speedscope-$viewer_version" &&
    # There is no user to answer a dialog: its text goes to the console.
    sed 's|<head>|<head><script>alert = (text) => console.error("alert: " + text);</script>|' \
      "$(dirname "$viewer")/index.html" >"$viewer") >"$work/npm.log" 2>&1
  [ -s "$viewer" ] || skip "npm could not get speedscope $viewer_version: $(tail -n 1 "$work/npm.log")"
}

# check_trace FILE [FIRST]: silent when speedscope shows a profile for each track that has a slice, the one named
# FIRST among them, without a warning.
check_trace() {
  local first=${2-'pelt tiny (pid 1), worker 0 (caller) (tid 1)'} out=$work/viewer workers
  workers=$(grep '"ph": "B"' "$1" | grep -oE '"tid": [0-9]+' | sort -u | wc -l)
  printf 'speedscope.loadFileFromBase64("trace.json", "%s")\n' "$(base64 -w 0 "$1")" >"$work/profile.js"
  open "file://$viewer#localProfilePath=$work/profile.js" 1280 "$out" || { echo "the browser failed: $(tail -n 2 "$out.log")"; return; }
  grep -qF "$first" "$out.html" || echo "'$first' is not shown"
  [ "$workers" -eq 1 ] || grep -qF "(1/$workers)" "$out.html" ||
    echo "not $workers profiles: $(grep -oE '\([0-9]+/[0-9]+\)' "$out.html" | head -n 1)"
  # All that the viewer has to say, but for where it is and how it draws.
  grep 'CONSOLE' "$out.log" | grep -vE 'speedscope v|Importing as Trace Event|"import: |WebGL' | head -n 3
}

test_trace() {
  find_viewer
  local trace=$work/trace.json said
  # Enough frames for both workers to have a part in some, on any machine.
  "$pelt" run --scene tiny --frames 60 --workers 2 --no-sleep --trace "$trace" --trace-frames 0 >"$work/run.log" 2>&1 ||
    { cat "$work/run.log"; fail "pelt run --trace"; return; }
  said=$(check_trace "$trace")
  [ -z "$said" ] || fail "speedscope: $said"
  "$pelt" budget --scene tiny --frames 5 --platform ps3,xbox360 --trace "$work/consoles.json" >"$work/budget.log" 2>&1 ||
    { cat "$work/budget.log"; fail "pelt budget --trace"; return; }
  said=$(check_trace "$work/consoles.json" 'pelt tiny, modelled (pid 1), PS3 frame (tid 1)')
  [ -z "$said" ] || fail "speedscope, of the consoles: $said"
  # Cut within an event: between two of them the viewer takes what is there for the whole.
  head -n "$(($(wc -l <"$trace") / 2))" "$trace" >"$work/cut.json"
  printf '{"name": "pas' >>"$work/cut.json"
  check_trace "$work/cut.json" | grep -q 'alert' || fail "half a trace passes"
  sed '0,/"ph": "E".*"pass /{//d}' "$trace" >"$work/unended.json"
  check_trace "$work/unended.json" | grep -q 'Tried to end\|still open' || fail "a pass that never ends passes"
}

case $part in
  report) test_report ;;
  trace) test_trace ;;
  *) fail "no part '$part'" ;;
esac
[ "$failures" -eq 0 ] || exit 1
echo "passed: $part"
