// Draws the report of a run from its data.
const stageClass = (stage) => stage.colour < 0 ? 'others' : 's' + stage.colour;
const coloured = data.stages.filter((s) => s.colour >= 0).sort((a, b) => a.colour - b.colour);
const seen = data.stages.filter((s) => s.ran + s.skipped > 0);

function timeCells(spread, limit) {
  return [spread.median, spread.p95, spread.p99, spread.worst].map((value) => ({text: ms(value), class: limit && value > limit ? 'over' : ''}));
}

function fillFacts() {
  const title = 'Pelt report: ' + data.scene;
  document.title = title;
  byId('title').textContent = title;
  const facts = [
    ['strands', number(data.strands)],
    ['chunks, layers, characters', `${number(data.chunks)}, ${number(data.layers)}, ${number(data.characters)}`],
    ['frames', number(data.frames)],
    ['last frame', `${number(data.live_strands)} strands live, ${number(data.drawn_strands)} drawn`],
    ['executor', data.executor === 'tbb' ? `tbb, ${data.workers} workers (${data.workers_observed} observed)` : data.executor],
    ['kernels, plan', `${data.isa}, ${data.fused ? 'fused' : 'unfused'}`],
    ['machine', `${data.processor} (${data.cores} cores)`],
    ['built with', `${data.compiler}, ${data.build_type}`],
    ['commit', data.commit],
    ['digest', data.digest],
  ];
  for (const [name, value] of facts) {
    const pair = add(byId('facts'), 'div');
    add(pair, 'dt', {}, name);
    add(pair, 'dd', name === 'digest' || name === 'commit' ? {class: 'digest'} : {}, value);
  }
  const over = kLinesMs.map((line) => `${data.columns.filter((c) => c.ms > line).length} over ${line} ms`);
  byId('verdict').textContent =
      `The median frame takes ${ms(data.frame_ms.median)} ms, the worst ${ms(data.frame_ms.worst)} ms. Of ${data.columns.length} ` +
      `${data.frames_a_column > 1 ? 'columns' : 'frames'}, ${over.join(' and ')}.` +
      (data.disturbances.length ? ` The machine was not the run's own: ${data.disturbances.join('; ')}.` : '');
}

function fillTables() {
  const rows = [
    ['whole frame', ...timeCells(data.frame_ms, kLinesMs[1])],
    ['poses and parameters (caller)', ...timeCells(data.caller_ms)],
    {heading: 'stages, core ms'},
    ...seen.map((s) => [s.name, ...timeCells(s.core_ms)]),
    {heading: 'passes, wall ms'},
    ...data.passes.map((p) => [p.name, ...timeCells(p.wall_ms)]),
  ];
  table(byId('times'), 'Times', ['ms', 'median', 'p95', 'p99', 'worst'], rows);

  const largest = Math.max(...data.memory.map((m) => m.bytes));
  byId('memory-note').textContent =
      `${kb(data.memory_bytes)} KB in all: ${Math.round(data.memory_bytes / data.strands)} bytes per strand, ` +
      `${data.state_bytes_per_strand.toFixed(1)} of them simulation state.`;
  table(byId('memory'), 'Memory by name', ['name', 'role', 'blocks', 'KB', ''],
        [...data.memory].sort((a, b) => b.bytes - a.bytes).map((m) => [
          m.name, {text: m.role, class: 'text'}, number(m.blocks), kb(m.bytes),
          {class: 'bar', bar: [[m.bytes / largest, '']]}]), {wide: true});

  table(byId('skips'), 'Items run and skipped', ['stage', 'of each', 'run', 'skipped', 'MB moved', 'run against skipped'],
        seen.map((s) => [
          s.name, {text: s.domain, class: 'text'}, s.ran.toFixed(1), s.skipped.toFixed(1), (s.bytes / 1e6).toFixed(2),
          {class: 'bar', bar: [[s.ran / (s.ran + s.skipped), ''], [s.skipped / (s.ran + s.skipped), 'skipped']]}]), {wide: true});

  table(byId('plan'), 'Plan', ['pass', 'a', 'items', 'resident', 'get', 'put', 'stages'],
        data.passes.map((p, i) => [
          i, {text: p.domain, class: 'text'}, number(p.items), number(p.resident), number(p.get), number(p.put),
          {text: data.stages.slice(p.first_stage, p.first_stage + p.stage_count).map((s) => s.name).join(', '), class: 'text'}]));
}

// The dearest first, with all of them at the end.
function fillCosts() {
  const all = data.cost.core_ms.median, times = (cost) => [cost.core_ms.median, cost.core_ms.p95, cost.core_ms.worst].map(ms);
  const perStrand = (cost) => cost.strands ? (1e6 * cost.core_ms.median / cost.strands).toFixed(1) : '';
  const share = (cost, most) => ({class: 'bar', bar: [[cost.core_ms.median / most.core_ms.median || 0, '']]});
  const part = (cost) => percent(cost.core_ms.median / all || 0);
  const sorted = (costs) => costs.map((cost, i) => ({...cost, i})).sort((a, b) => b.core_ms.median - a.core_ms.median);
  const quality = (l) => l.ran ? [l.ran.map((frames) => (100 * frames / data.frames).toFixed(0)).join(', '), l.error_px.toFixed(2)] : [l.solver, ''];
  const layers = sorted(data.layer_costs), characters = sorted(data.character_costs);
  table(byId('layers'), 'Cost by layer', ['layer', 'character', 'strands', 'median ms', 'p95', 'worst', 'ns/strand', 'of all', 'ran, % fast, fine, best', '99 % within px', 'its dearest stage', ''], [
    ...layers.map((l) => [`${l.i} ${l.name}`, l.character, number(l.strands), ...times(l), perStrand(l), part(l), ...quality(l),
      {text: `${data.stages[l.most_stage].name} ${percent(l.most_share)}`, class: 'text'}, share(l, layers[0])]),
    ['all stages', '', number(data.strands), ...times(data.cost), perStrand({...data.cost, strands: data.strands}), part(data.cost), '', '', {text: '', class: 'text'}, ''],
  ], {wide: true, tall: true});
  table(byId('characters'), 'Cost by character', ['character', 'layers', 'strands', 'median ms', 'p95', 'worst', 'ns/strand', 'of all', 'pose and joints, ms', ''], [
    ...characters.map((c) => [`character ${c.i}`, c.layers, number(c.strands), ...times(c), perStrand(c), part(c), ms(c.own_ms), share(c, characters[0])]),
    ['the scene itself', '', '', ...times(data.scene_cost), '', part(data.scene_cost), '', ''],
  ], {wide: true, tall: true});
}

// ---- pictures --------------------------------------------------------------------------------------

const bands = [
  {name: 'poses and parameters', kind: 'caller', of: (c) => c.caller},
  ...coloured.map((s, i) => ({name: s.name, kind: stageClass(s), of: (c) => c.stages[i]})),
  {name: 'other stages', kind: 'others', of: (c) => c.others},
  {name: 'waiting and hand-out', kind: 'waiting', of: (c) => c.waiting},
];

// What others took of a frame's cores, as the system counted it.
function waitText(of) {
  const waited = of.waited_ms === undefined ? [] : [`threads ready for ${ms(of.waited_ms)} ms without a core`];
  return [...waited, `${of.preemptions} preemptions`].join(', ');
}

function drawFrames() {
  const top = framesTop(data.frame_ms.median, data.frame_ms.worst);
  const tip = (c) => [`frame ${c.frame}: ${ms(c.ms)} ms`, ...bands.map((b) => `${b.name} ${ms(b.of(c))}`), ...(c.disturbed ? [waitText(c)] : [])].join('\n');
  const columns = data.columns.map((column) => ({...column, tip: () => tip(column)}));
  const cut = plotFrames(byId('frames'), {
    columns, top, picture: 'frames',
    label: `Stage times over ${data.frames} frames, stacked, against 5 and 8 ms. Median ${ms(data.frame_ms.median)} ms, ` +
        `worst ${ms(data.frame_ms.worst)} ms. The table below has the same figures.`,
    drawBelow: ({svg, x, y}) => {
      const below = columns.map(() => 0);
      for (const band of bands) {
        // Steps, so that a slow frame stands as wide as any other.
        let over = '', under = '';
        columns.forEach((column, i) => {
          const from = below[i], to = from + band.of(column);
          below[i] = to;
          over += `L${x(i).toFixed(1)} ${y(to).toFixed(1)}H${x(i + 1).toFixed(1)}`;
          under = `L${x(i + 1).toFixed(1)} ${y(from).toFixed(1)}H${x(i).toFixed(1)}` + under;
        });
        add(svg, 'path', {class: 'band ' + band.kind, d: 'M' + over.slice(1) + under + 'Z'});
      }
      columns.forEach((column, i) => {
        if (column.disturbed) add(svg, 'rect', {class: 'taken', x: x(i), y: y(0) + 2, width: Math.max(1, x(i + 1) - x(i)), height: 4});
      });
    },
  });
  const notes = ['In ms. A stage stands for its core time divided by the workers; what is left of the frame is waiting and handing out work.'];
  if (data.frames_a_column > 1) notes.push(`Each column is the slowest of ${data.frames_a_column} frames.`);
  if (cut) notes.push(`${cut} of the columns are cut off at ${+top.toFixed(1)} ms, with what the slowest took above them.`);
  const disturbed = columns.filter((column) => column.disturbed).length;
  if (disturbed) notes.push(`Red below the axis: in ${disturbed} of the columns threads waited for cores that others had.`);
  for (const line of kLinesMs.filter((l) => l > top)) notes.push(`The ${line} ms line is ${(line / data.frame_ms.worst).toFixed(0)} times the worst frame, above the picture.`);
  byId('frames-note').textContent = notes.join(' ');
}

function fillFramesTable() {
  for (const band of bands) {
    const item = add(byId('legend'), 'li');
    add(item, 'span', {class: 'swatch ' + band.kind, 'aria-hidden': 'true'});
    item.append(band.name);
  }
  table(byId('frames-table'), 'Frames, ms', ['frame', 'ms', ...bands.map((b) => b.name)],
        data.columns.map((c) => [c.frame, {text: ms(c.ms), class: c.ms > kLinesMs[1] ? 'over' : ''}, ...bands.map((b) => ms(b.of(c)))]), {tall: true});
}

// A worker's runs lie one after the other: stage, item, begin and end in ns.
const kRun = 4;
const runCount = (worker) => worker.runs.length / kRun;
const runAt = (worker, i) => ({
  stage: worker.runs[kRun * i], item: worker.runs[kRun * i + 1],
  begin: worker.runs[kRun * i + 2], end: worker.runs[kRun * i + 3],
});

// The run at `ns`, or one that ends or begins within `slack` of it.
function findRun(worker, ns, slack) {
  let low = 0, high = runCount(worker);
  while (low < high) {
    const middle = (low + high) >> 1;
    if (worker.runs[kRun * middle + 3] < ns - slack) low = middle + 1; else high = middle;
  }
  const found = low < runCount(worker) ? runAt(worker, low) : undefined;
  return found && found.begin <= ns + slack ? found : undefined;
}

// Items during which others likely had the worker's core: begin and end, and how much longer than usual, in ns.
const preemptedOf = (worker) => Array.from({length: worker.preempted.length / 3}, (_, i) => ({
  begin: worker.preempted[3 * i], end: worker.preempted[3 * i + 1], over: worker.preempted[3 * i + 2],
}));

const kLane = {first: 22, height: 26, step: 32, axis: 20};

const runText = (run) => data.stages[run.stage].name + ' ' + data.items[data.stages[run.stage].domain][run.item];

// Passes run side by side: each in the first row that is free when it begins. `times`: begin and end of each.
function passRows(times) {
  const rows = [], ends = [], passes = Array.from({length: times.length / 2}, (_, p) => p);
  for (const p of passes.sort((a, b) => times[2 * a] - times[2 * b])) {
    const free = ends.findIndex((end) => end <= times[2 * p]);
    rows[p] = free < 0 ? ends.length : free;
    ends[rows[p]] = times[2 * p + 1];
  }
  return {rows, height: 16 / Math.max(1, ends.length)};
}

function drawPasses(svg, times, x) {
  const {rows, height} = passRows(times);
  rows.forEach((row, p) => {
    const from = x(times[2 * p]), to = x(times[2 * p + 1]), y = row * height;
    add(svg, 'rect', {class: 'pass-' + p % 2, x: from, y, width: to - from, height});
    if (to - from > 16 && height > 5) add(svg, 'text', {class: 'pass-text', x: (from + to) / 2, y: y + height / 2 + 4}, p);
  });
}

function drawTimeline(timeline, scroll, zoom, query) {
  scroll.replaceChildren();
  const width = Math.floor(Math.max(kLeastWidth, scroll.clientWidth) * zoom);
  const height = kLane.first + kLane.step * timeline.workers.length + kLane.axis;
  const x = (ns) => width * ns / timeline.ns;
  const svg = add(scroll, 'svg', {
    width, height, role: 'img', 'data-picture': 'timeline',
    'aria-label': `What each worker did in the ${timeline.title}, frame ${timeline.frame}, ${ms(timeline.ns / 1e6)} ms. The table below has the sums.`,
  });
  drawPasses(svg, timeline.passes, x);
  const bars = new Bars(x, query, (run) => run.stage === undefined ? 'poses and parameters' : runText(run));
  timeline.workers.forEach((worker, w) => {
    const y = kLane.first + kLane.step * w;
    add(svg, 'rect', {class: 'lane', x: 0, y, width, height: kLane.height});
    bars.startLane();
    if (w === 0) bars.add('caller', y, kLane.height, {begin: 0, end: timeline.caller_ns});
    for (let i = 0; i < runCount(worker); ++i) {
      const run = runAt(worker, i);
      bars.add(stageClass(data.stages[run.stage]), y, kLane.height, run);
    }
    bars.endLane(svg);
    for (const {begin, end} of preemptedOf(worker))
      add(svg, 'rect', {class: 'taken', x: x(begin), y: y + kLane.height + 1, width: Math.max(2, x(end) - x(begin)), height: 4});
  });
  const step = tickStep(timeline.ns, Math.max(2, width / 110));
  for (let ns = 0; ns < timeline.ns; ns += step)
    add(svg, 'text', {x: x(ns) + 2, y: height - 5}, +(ns / 1e6).toFixed(4) + (ns ? '' : ' ms'));
  svg.addEventListener('pointermove', (event) => {
    const box = svg.getBoundingClientRect();
    const ns = (event.clientX - box.left) / width * timeline.ns, down = event.clientY - box.top;
    const lane = Math.floor((down - kLane.first) / kLane.step);
    showTip(event, lane < 0 ? passText(timeline, data.passes, ns, down) : workerText(timeline, lane, ns, 1.5 / width * timeline.ns));
  });
  svg.addEventListener('pointerleave', () => showTip());
  return bars.found;
}

function passText(timeline, passes, ns, down) {
  const {height, rows} = passRows(timeline.passes), row = Math.floor(down / height);
  const p = rows.findIndex((of, i) => of === row && ns >= timeline.passes[2 * i] && ns <= timeline.passes[2 * i + 1]);
  return p < 0 ? '' : `${passes[p].name}\n${((timeline.passes[2 * p + 1] - timeline.passes[2 * p]) / 1e3).toFixed(1)} µs, from its first item to its last`;
}

function workerText(timeline, lane, ns, slack) {
  const worker = timeline.workers[lane];
  if (!worker) return '';
  if (lane === 0 && ns < timeline.caller_ns) return `poses and parameters\n${(timeline.caller_ns / 1e3).toFixed(1)} µs`;
  const run = findRun(worker, ns, slack);
  if (!run) return `${worker.name}: waiting`;
  const stage = data.stages[run.stage], taken = preemptedOf(worker).find((p) => p.begin <= run.begin && run.end <= p.end);
  return `${stage.name}\n${data.items[stage.domain][run.item]}\n${((run.end - run.begin) / 1e3).toFixed(2)} µs, from ${(run.begin / 1e6).toFixed(3)} ms` +
      (taken ? `\nits item took ${ms(taken.over / 1e6)} ms longer than usual: others had the core` : '');
}

function fillTimelineTable(timeline, parent) {
  const sums = timeline.workers.map((worker) => {
    const of = data.stages.map(() => 0);
    for (let i = 0; i < runCount(worker); ++i) {
      const run = runAt(worker, i);
      of[run.stage] += run.end - run.begin;
    }
    return of;
  });
  const row = (name, values) => [name, ...values.map((ns) => ms(ns / 1e6)), ms(values.reduce((a, b) => a + b, 0) / 1e6)];
  const busy = sums.map((of, w) => of.reduce((a, b) => a + b, 0) + (w ? 0 : timeline.caller_ns));
  table(parent, `Workers in the ${timeline.title}, ms`, ['ms', ...timeline.workers.map((w) => w.name), 'all'], [
    row('busy', busy), row('not busy', busy.map((ns) => timeline.ns - ns)),
    row('poses and parameters', sums.map((of, w) => w ? 0 : timeline.caller_ns)),
    ...data.stages.map((stage, s) => [stage, s]).filter(([stage, s]) => sums.some((of) => of[s])).map(([stage, s]) => row(stage.name, sums.map((of) => of[s]))),
  ]);
}

function fillTimeline(timeline) {
  const title = timeline.title[0].toUpperCase() + timeline.title.slice(1);
  return fillLanes(byId('timelines'), {
    heading: `${title}: frame ${timeline.frame}, ${ms(timeline.ns / 1e6)} ms` + (timeline.disturbed ? `; disturbed: ${waitText(timeline)}` : ''),
    label: timeline.title,
    names: [{y: 12, text: 'pass'}, ...timeline.workers.map((worker, w) => ({y: kLane.first + kLane.step * w + 17, text: 'worker ' + w}))],
    height: kLane.first + kLane.step * timeline.workers.length,
    ns: timeline.ns,
    draw: (scroll, zoom, query) => drawTimeline(timeline, scroll, zoom, query),
    details: (parent) => fillTimelineTable(timeline, parent),
  });
}

// ---- consoles --------------------------------------------------------------------------------------

// A unit's lane: a strip of transfers in, what the unit does, a strip of transfers out.
const kUnit = {first: 22, strip: 6, height: 20, step: 40, axis: 20};
// By name, so that an order that changes there does not repaint things here.
const workClass = {
  dispatch: 'dispatch', commands: 'commands', code: 'code', 'get stall': 'stall', compute: 's0',
  'put stall': 'stall', imbalance: 'waiting', barrier: 'caller',
};
const unitTop = (u) => kUnit.first + kUnit.step * u;

// A unit's slices lie one after the other: work, pass, item, begin and end in ns; its transfers too,
// with 0 for in and 1 for out first.
const kSlice = 5;
const sliceAt = (runs, i) => ({
  kind: runs[kSlice * i], pass: runs[kSlice * i + 1], item: runs[kSlice * i + 2],
  begin: runs[kSlice * i + 3], end: runs[kSlice * i + 4],
});
function slicesOf(runs) {
  return Array.from({length: runs.length / kSlice}, (_, i) => sliceAt(runs, i));
}

function drawConsole(frame, scroll, zoom, query) {
  scroll.replaceChildren();
  const width = Math.floor(Math.max(kLeastWidth, scroll.clientWidth) * zoom);
  const height = unitTop(frame.units.length) + kUnit.axis;
  const x = (ns) => width * ns / frame.ns;
  const svg = add(scroll, 'svg', {
    width, height, role: 'img', 'data-picture': 'console',
    'aria-label': `What each unit of the ${frame.name} does in frame ${frame.frame}, ${ms(frame.ns / 1e6)} ms. The table below has the sums.`,
  });
  drawPasses(svg, frame.passes, x);
  const bars = new Bars(x, query, (slice) => sliceText(frame, slice, slice.work));
  frame.units.forEach((unit, u) => {
    const y = unitTop(u);
    add(svg, 'rect', {class: 'lane', x: 0, y, width, height: kUnit.height + 2 * kUnit.strip});
    bars.startLane();
    for (const slice of slicesOf(unit.slices)) bars.add(workClass[frame.works[slice.kind]], y + kUnit.strip, kUnit.height, {...slice, work: frame.works[slice.kind]});
    for (const transfer of slicesOf(unit.transfers)) {
      const top = transfer.kind ? y + kUnit.strip + kUnit.height : y;
      bars.add(transfer.kind ? 'put' : 'get', top, kUnit.strip, {...transfer, work: transferName(transfer.kind)});
    }
    bars.endLane(svg);
  });
  const step = tickStep(frame.ns, Math.max(2, width / 110));
  for (let ns = 0; ns < frame.ns; ns += step)
    add(svg, 'text', {x: x(ns) + 2, y: height - 5}, +(ns / 1e6).toFixed(4) + (ns ? '' : ' ms'));
  svg.addEventListener('pointermove', (event) => {
    const box = svg.getBoundingClientRect();
    showTip(event, consoleText(frame, (event.clientX - box.left) / width * frame.ns, event.clientY - box.top));
  });
  svg.addEventListener('pointerleave', () => showTip());
  return bars.found;
}

const transferName = (kind) => kind ? 'transfer out' : 'transfer in';
function sliceText(frame, slice, work) {
  const pass = frame.plan[slice.pass], lines = [work];
  if (pass) lines.push(pass.name);
  if (pass && slice.item >= 0) lines.push(data.items[pass.domain][slice.item]);
  return lines.join('\n');
}

function consoleText(frame, ns, down) {
  if (down < kUnit.first) return passText(frame, frame.plan, ns, down);
  const u = Math.floor((down - kUnit.first) / kUnit.step), unit = frame.units[u];
  if (!unit) return '';
  const inside = down - unitTop(u);
  const strip = inside < kUnit.strip ? 0 : inside >= kUnit.strip + kUnit.height ? 1 : -1;
  const runs = slicesOf(strip < 0 ? unit.slices : unit.transfers);
  const found = runs.find((run) => (strip < 0 || run.kind === strip) && run.begin <= ns && ns <= run.end);
  if (!found) return strip < 0 ? unit.name : '';
  return `${sliceText(frame, found, strip < 0 ? frame.works[found.kind] : transferName(strip))}\n` +
      `${((found.end - found.begin) / 1e3).toFixed(2)} µs, from ${(found.begin / 1e6).toFixed(3)} ms`;
}

function fillConsoleTables(frame, parent) {
  const sums = frame.units.map((unit) => {
    const of = frame.works.map(() => 0);
    for (const slice of slicesOf(unit.slices)) of[slice.kind] += slice.end - slice.begin;
    return of;
  });
  table(parent, `Units of the ${frame.name}, ms`, ['ms', ...frame.units.map((unit) => unit.name), 'all'],
        frame.works.map((work, w) => [work, ...sums.map((of) => ms(of[w] / 1e6)), ms(sums.reduce((all, of) => all + of[w], 0) / 1e6)]));
}

// "core 1 thread 0" in two lines: the column beside the picture is narrow.
function unitNames(name, y) {
  const words = name.split(' ');
  if (words.length < 4) return [{y: y + 14, text: name}];
  return [{y: y + 8, text: words.slice(0, 2).join(' ')}, {y: y + 20, text: words.slice(2).join(' ')}];
}

function fillConsole(frame) {
  const part = add(byId('consoles'), 'div');
  add(part, 'p', {}, frame.verdict);
  if (frame.units.length === 0) return () => {};  // the scene does not fit there; the verdict says why
  const draw = fillLanes(part, {
    heading: `${frame.name}: frame ${frame.frame}, ${ms(frame.ns / 1e6)} ms`,
    label: 'frame on the ' + frame.name,
    names: [{y: 12, text: 'pass'}, ...frame.units.flatMap((unit, u) => unitNames(unit.name, unitTop(u) + kUnit.strip))],
    height: unitTop(frame.units.length),
    ns: frame.ns,
    draw: (scroll, zoom, query) => drawConsole(frame, scroll, zoom, query),
    details: (parent) => fillConsoleTables(frame, parent),
  });
  table(part, `Stages on the ${frame.name}, ms of all units`, ['stage', 'items', 'core ms', 'of the compute', ''],
        frame.stages.map((s) => [s.name, s.items.toFixed(1), ms(s.core_ms), (100 * s.share).toFixed(1) + ' %', {class: 'bar', bar: [[s.share, '']]}]), {wide: true});
  return draw;
}

function fillConsoles() {
  byId('consoles-section').hidden = data.consoles.length === 0;
  const kinds = [['get', 'transfer in'], ['s0', 'compute'], ['put', 'transfer out'], ['stall', 'waiting for a transfer'], ['code', 'loading code'], ['dispatch', 'taking an item'], ['commands', 'giving transfers'], ['waiting', 'nothing is open'], ['caller', 'an end that is not yet seen']];
  for (const [kind, name] of kinds) {
    const item = add(byId('consoles-legend'), 'li');
    add(item, 'span', {class: 'swatch ' + kind, 'aria-hidden': 'true'});
    item.append(name);
  }
  return data.consoles.map(fillConsole);
}

// ---- all of it -------------------------------------------------------------------------------------

fillFacts();
fillTables();
fillCosts();
fillFramesTable();
const draws = [drawFrames, ...data.timelines.map(fillTimeline), ...fillConsoles(), fillRod(), fillAccuracy(), fillWays()];
const drawAll = () => draws.forEach((draw) => draw());
drawAll();
let drawnWidth = innerWidth;
addEventListener('resize', () => {
  if (drawnWidth === innerWidth) return;
  drawnWidth = innerWidth;
  drawAll();
});
