// Written into a copy of the report's page: reports to the page around it what only a running page knows. That one
// holds it in a frame of the wanted width, as a window has a least width.
addEventListener("error", (e) => parent.postMessage({error: e.message}, "*"));
// What is wrong with the diagram of errors off the rod: points that are missing, or stand elsewhere than their figures.
function rodFaults() {
  const accuracy = JSON.parse(document.getElementById("data").textContent).accuracy.find((a) => a.panels);
  const section = document.getElementById("rod-section");
  if (!accuracy) return section.hidden ? [] : ["shown without data"];
  const faults = [], svg = document.querySelector("svg[data-picture=rod]"), rows = accuracy.model_error[0].rows.filter((r) => r.ns > 0);
  const expect = (what, is, wanted) => is === wanted || faults.push(`${what}: ${is}, not ${wanted}`);
  if (!svg) return ["no picture"];
  const marks = [...svg.querySelectorAll("path.mark")];
  expect("points", marks.length, rows.length);
  expect("rings", svg.querySelectorAll("circle.ring").length, rows.filter((r) => r.pareto_optimal).length);
  expect("rows of the table", document.querySelectorAll("#rod-table tbody tr").length, accuracy.model_error[0].rows.length);
  expect("buttons", document.querySelectorAll("#rod-motions button").length, accuracy.model_error.length);
  const at = marks.map((m) => m.getAttribute("transform").match(/[-\d.]+/g).map(Number));
  const check = (what, places, values) => {
    const low = values.indexOf(Math.min(...values)), high = values.indexOf(Math.max(...values));
    values.forEach((value, i) => {
      const wanted = places[low] + Math.log(value / values[low]) / Math.log(values[high] / values[low]) * (places[high] - places[low]);
      if (!(Math.abs(places[i] - wanted) < 0.3)) faults.push(`${what} of ${rows[i].model}, ${rows[i].moved}: ${places[i]}, not ${wanted}`);
    });
    if (!(places[high] - places[low] > 100)) faults.push(`no ${what} axis`);
  };
  if (marks.length !== rows.length) return faults;
  check("x", at.map((a) => a[0]), rows.map((r) => r.ns));
  check("y", at.map((a) => -a[1]), rows.map((r) => r.pooled));
  return faults;
}
// What is wrong with the diagrams of the ways to run a scene, compared with what the page was given.
function waysFaults() {
  const ways = JSON.parse(document.getElementById("data").textContent).accuracy.find((a) => a.rows);
  const section = document.getElementById("ways-section");
  if (!ways) return section.hidden ? [] : ["shown without data"];
  const faults = [], rows = ways.rows, panels = [...document.querySelectorAll("svg[data-picture=ways]")];
  const expect = (what, is, wanted) => is === wanted || faults.push(`${what}: ${is}, not ${wanted}`);
  expect("panels", panels.length, 2);
  expect("rows of the table", document.querySelectorAll("#ways-table tbody tr").length, rows.length);
  panels.forEach((svg, p) => {
    const time = ["frame", "simulate"][p], all = (of) => [...svg.querySelectorAll(of)], marks = all("path.mark");
    expect(`points of ${time}`, marks.length, rows.length);
    if (marks.length !== rows.length) return;
    // Between the least and the most they stand by their logarithms; a lower error stands lower.
    const at = marks.map((m) => m.getAttribute("transform").match(/[-\d.]+/g).map(Number));
    const check = (what, places, values) => {
      const low = values.indexOf(Math.min(...values)), high = values.indexOf(Math.max(...values));
      values.forEach((value, i) => {
        const share = Math.log(value / values[low]) / Math.log(values[high] / values[low]);
        const wanted = places[low] + share * (places[high] - places[low]);
        if (!(Math.abs(places[i] - wanted) < 0.3)) faults.push(`${what} of ${rows[i].label}: ${places[i]}, not ${wanted}`);
      });
      return places[high] - places[low];
    };
    if (!(check(`${time} x`, at.map((a) => a[0]), rows.map((r) => r[time + "_ns"])) > 100)) faults.push("no time axis");
    if (!(check(`${time} y`, at.map((a) => -a[1]), rows.map((r) => r.error)) > 100)) faults.push("no error axis");
    const best = rows.filter((r) => r[time + "_pareto_optimal"]).length;
    expect("rings", all("circle.ring").length, best);
    const hollow = (mark) => getComputedStyle(mark).fill !== getComputedStyle(mark).stroke;
    expect("hollow points", marks.filter(hollow).length, rows.filter((r) => !r.reference_material).length);
    expect("steps of the front", (all("path.front")[0]?.getAttribute("d").match(/[MH]/g) || []).length, best);
    expect("dashed lines", all("line.input").length, 1);
    expect("ticks", all("line.axis").length > 3, true);
    // Some points lie on each other, by times that this machine measured; where there is no room for a name there is none.
    const names = all("text.name").map((t) => t.getBBox());
    if (names.length < rows.length - 4) faults.push(`${names.length} names of ${rows.length}`);
    names.forEach((a, i) => names.slice(0, i).forEach((b) => {
      if (a.x < b.x + b.width && b.x < a.x + a.width && Math.abs(a.y - b.y) < 10) faults.push("names lie on each other");
    }));
    if (names.some((a) => a.x < 0 || a.x + a.width > svg.width.baseVal.value)) faults.push("a name is cut off");
    const box = marks[0].getBoundingClientRect();
    marks[0].dispatchEvent(new PointerEvent("pointermove", {clientX: box.left, clientY: box.top}));
    const tip = document.getElementById("tip").textContent;
    if (!tip.startsWith(rows[0].label) || !tip.includes(rows[0][time + "_ns"].toFixed(1))) faults.push(`pointing says ${tip}`);
  });
  return faults;
}
// What is wrong with the picture of the frames: lines that cannot be distinguished, slow frames without a mark.
function framesFaults() {
  const data = JSON.parse(document.getElementById("data").textContent), faults = [];
  const svg = document.querySelector("svg[data-picture=frames]"), top = Number(svg?.dataset.top);
  if (!svg) return ["no picture"];
  const all = (of) => [...svg.querySelectorAll(of)], cut = data.columns.filter((c) => c.ms > top);
  const expect = (what, is, wanted) => is === wanted || faults.push(`${what}: ${is}, not ${wanted}`);
  expect("marks of slow frames", all("path.cut").length, cut.length);
  const said = all("text.cut").map((t) => t.textContent);
  if (cut.length) expect("the slowest", said.includes(`${data.frame_ms.worst.toFixed(0)} ms`), true);
  const boxes = [...all("text.cut"), ...all("text.limit-text")].map((t) => t.getBBox());
  boxes.forEach((a, i) => boxes.slice(0, i).forEach((b) => {
    if (a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height) faults.push("texts lie on each other");
  }));
  if (boxes.some((a) => a.x < 0 || a.x + a.width > svg.width.baseVal.value)) faults.push("a text is cut off");
  if (data.frame_ms.median < 19 && data.frame_ms.worst > 23) expect("top", top, 24);
  expect("marks of disturbed frames", all("rect.taken").length, data.columns.filter((c) => c.disturbed).length);
  // With a median frame of up to 8 ms, the lines stand in the upper four fifths, well apart.
  const lines = all("line.limit").map((l) => Number(l.getAttribute("y1")));
  expect("lines", lines.length, [5, 8].filter((line) => line <= top).length);
  if (lines.length === 2 && data.frame_ms.median <= 8 && !(lines[0] - lines[1] > 25 && lines[0] < 210)) faults.push(`5 and 8 ms at ${lines}`);
  return faults;
}
// What is wider than the page scrolls in a box of its own; nothing is cut off.
function cutOff() {
  const scrolls = (box) => box && (getComputedStyle(box).overflowX === "auto" ? box.scrollWidth > box.clientWidth : scrolls(box.parentElement));
  return [...document.querySelectorAll("svg[role=img], table")].filter((e) => {
    const box = e.getBoundingClientRect(), around = e.parentElement.getBoundingClientRect();
    return (box.right > innerWidth || box.right > around.right + 1) && !scrolls(e.parentElement);
  }).map((e) => e.dataset.picture || e.parentElement.getAttribute("aria-label"));
}
// Layers and characters stand in their tables by what they cost, the dearest first.
function costFaults() {
  const data = JSON.parse(document.getElementById("data").textContent), faults = [];
  for (const [id, costs] of [["layers", data.layer_costs], ["characters", data.character_costs]]) {
    const rows = [...document.querySelectorAll(`#${id} tbody tr`)].slice(0, -1);
    if (rows.length !== costs.length) faults.push(`${rows.length} ${id}, not ${costs.length}`);
    const shown = rows.map((row) => Number(row.cells[3].textContent));
    if (shown.some((ms, i) => i && ms > shown[i - 1])) faults.push(`${id} are not by cost`);
    const sum = costs.reduce((a, c) => a + c.strands, 0);
    if (sum !== data.strands) faults.push(`${id} have ${sum} strands of ${data.strands}`);
  }
  const dearest = [...data.layer_costs].sort((a, b) => b.core_ms.median - a.core_ms.median)[0];
  const first = document.querySelector("#layers tbody tr").textContent;
  if (!first.includes(dearest.name) || !first.includes(data.stages[dearest.most_stage].name)) faults.push(`first is ${first}`);
  return faults;
}
// Dragging over a part of the first timeline shows that part; a search finds what the data has, and Enter goes there.
function lanesFaults() {
  const data = JSON.parse(document.getElementById("data").textContent), faults = [];
  const timeline = data.timelines[0], box = document.querySelector(".timeline"), scroll = box.querySelector(".lanes");
  const svg = () => scroll.querySelector("svg"), width = () => svg().width.baseVal.value;
  const near = (what, is, wanted, by) => Math.abs(is - wanted) <= by || faults.push(`${what}: ${is}, not ${wanted}`);
  const at = (type, share, target) => {
    const place = svg().getBoundingClientRect();
    target.dispatchEvent(new PointerEvent(type, {bubbles: true, button: 0, pointerType: "mouse", clientX: place.left + share * place.width, clientY: place.top + 30}));
  };
  const taken = timeline.workers.reduce((sum, w) => sum + w.preempted.length / 3, 0);
  near("marks of preempted items", svg().querySelectorAll("rect.taken").length, taken, 0);
  if (timeline.disturbed !== box.querySelector("h3").textContent.includes("disturbed: ")) faults.push("disturbed or not");
  const drag = (from, to) => (at("pointerdown", from, svg()), at("pointermove", to, window), at("pointerup", to, window));
  const once = width(), shown = scroll.clientWidth;  // of a narrow page, less
  drag(0.75, 0.5);  // backwards, too
  near("width after dragging over a quarter", width(), 4 * shown, 4);
  near("left edge", scroll.scrollLeft, 2 * shown, 6);
  drag(0.6, 0.6 + 1 / width());
  near("width after a click", width(), 4 * shown, 4);
  if (svg().querySelector(".selection")) faults.push("a selection stays");
  scroll.dispatchEvent(new KeyboardEvent("keydown", {key: "+"}));
  near("width after +", width(), 8 * shown, 8);
  scroll.dispatchEvent(new MouseEvent("dblclick", {bubbles: true}));
  near("width after two clicks", width(), once, 0);
  // The stage that most bars are of, on its last item.
  const search = box.querySelector("input[type=search]"), said = box.querySelector("output");
  const look = (text) => {
    search.value = text;
    search.dispatchEvent(new Event("input"));
  };
  const runs = timeline.workers.flatMap((w) => Array.from({length: w.runs.length / 4}, (_, i) => w.runs.slice(4 * i, 4 * i + 4)));
  const of = runs.filter((run) => run[0] === runs[runs.length - 1][0]), name = data.stages[of[0][0]].name;
  look(` ${name.toUpperCase()} `);
  if (!said.textContent.startsWith(`${of.length} found`)) faults.push(`${name}: ${said.textContent}, not ${of.length}`);
  const lit = [...svg().querySelectorAll("path.band:not(.dim)")], dim = [...svg().querySelectorAll("path.band.dim")];
  near("bars lit", lit.reduce((sum, p) => sum + (p.getAttribute("d") || "").split("M").length - 1, 0), of.length, 0);
  if (!dim.length || getComputedStyle(dim[0]).opacity > 0.5) faults.push("the others are not dimmed");
  search.dispatchEvent(new KeyboardEvent("keydown", {key: "Enter", shiftKey: true}));
  search.dispatchEvent(new KeyboardEvent("keydown", {key: "Enter", shiftKey: true}));
  search.dispatchEvent(new KeyboardEvent("keydown", {key: "Enter"}));
  const found = svg().querySelectorAll("rect.found");
  near("marks of what is shown", found.length, 1, 0);
  if (found.length) {
    const mark = found[0].getBoundingClientRect(), view = scroll.getBoundingClientRect();
    const outside = mark.left < view.left - 3 || mark.right > view.right + 3;  // all of it is seen, if a picture can be that small
    if ((outside && width() > once) || (mark.width < 20 && width() < 255 * once)) faults.push(`the mark is at ${mark.left} to ${mark.right}`);
  }
  look("no such stage");
  if (!said.textContent.startsWith("0 found")) faults.push(`nothing: ${said.textContent}`);
  look("");
  if (said.textContent || svg().querySelector(".dim, .found")) faults.push("an empty search leaves marks");
  return faults;
}
addEventListener("load", () => setTimeout(() => {
  const pictures = [...document.querySelectorAll("svg[role=img]")];
  const section = document.getElementById("consoles-section");
  const names = [...document.querySelectorAll(".timeline-body > svg")];
  // The colour of a class that the style does not know.
  const uncoloured = (path) => getComputedStyle(path).getPropertyValue("--s") === "";
  const console_ = document.querySelector("svg[data-picture=console]");
  if (console_) {
    const box = console_.getBoundingClientRect();
    console_.dispatchEvent(new PointerEvent("pointermove", {clientX: box.left + box.width / 2, clientY: box.top + 38}));
  }
  const filled = (svg) => [...svg.querySelectorAll("path")].filter((p) => p.getBBox().width > 0 && p.getBBox().height > 0).length;
  parent.postMessage({
    inner: innerWidth, scroll: document.documentElement.scrollWidth,
    named: pictures.filter((p) => p.getAttribute("aria-label")).length,
    pictures: pictures.map((p) => p.dataset.picture + ":" + filled(p)).join(" "),
    tables: [...document.querySelectorAll("table")].filter((t) => t.tBodies[0].rows.length > 1).length,
    section: Number(section.getBoundingClientRect().height > 0), tip: document.getElementById("tip").textContent.split("\n").join(", "),
    clipped: names.flatMap((svg) => [...svg.querySelectorAll("text")].filter((t) => t.getBBox().width > svg.width.baseVal.value)).length,
    uncoloured: [...document.querySelectorAll("path.band")].filter(uncoloured).length,
    costs: costFaults().slice(0, 3).join("; "),
    frames: framesFaults().slice(0, 3).join("; "),
    ways: waysFaults().slice(0, 3).join("; "),
    rod: rodFaults().slice(0, 3).join("; "),
    lanes: lanesFaults().slice(0, 3).join("; "),
    cut: cutOff().slice(0, 3).join("; "),
    planted: document.querySelectorAll("b.planted").length, hostile: String(window.hostile),
  }, "*");
}, 100));
