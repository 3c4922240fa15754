// Error against run time: of solvers, of strands off a rod, of the ways to run a scene.
// Around (0, 0); by a family's place, so that not only colour distinguishes them.
const kMarks = [
  'M-4 0A4 4 0 1 0 4 0A4 4 0 1 0-4 0Z', 'M-4-4L4 4M4-4L-4 4', 'M-1.5-4H1.5V4H-1.5Z', 'M-4-1.5H4V1.5H-4Z',
  'M0-5L5 0L0 5L-5 0Z', 'M0 5L5-4H-5Z', 'M0-5L5 4H-5Z', 'M-4-4H4V4H-4Z',
  'M-5 0L4-5V5Z', 'M5 0L-4-5V5Z', 'M-5-2H5V2H-5Z',
  'M-4-4H4L-4 4H4Z', 'M-4-4V4L4-4V4Z', 'M-4-4H4V-1.5H-4ZM-4 1.5H4V4H-4Z', 'M-4-4H-1.5V4H-4ZM1.5-4H4V4H1.5Z',
  'M-4-4L4-4L4 4Z', 'M-4-4L-4 4L4 4Z',
];
const kColours = 8;  // families beyond them share one, with another mark
const percent = (share) => (100 * share).toPrecision(100 * share < 9.995 ? 2 : 3) + ' %';

// [1, 3]: 1, 3, 10, 30 and so on.
function decades(steps, least, most) {
  const ticks = [];
  for (let power = Math.floor(Math.log10(least)); 10 ** power <= most; ++power)
    for (const step of steps) ticks.push(+(step * 10 ** power).toPrecision(1));
  return ticks.filter((tick) => tick >= least && tick <= most);
}

// Logarithmic axes: ns to the right, errors in per cent upwards. What lies outside stands on the edge.
function logPlot(parent, {picture, label, title, height, ns, errors}) {
  const width = Math.max(200, Math.floor(parent.clientWidth));
  const box = {left: 42, right: width - 14, top: 22, bottom: height - 34};
  const share = (value, {least, most}) => Math.min(1, Math.max(0, Math.log(value / least) / Math.log(most / least)));
  const x = (time) => box.left + (box.right - box.left) * share(time, ns);
  const y = (error) => box.bottom - (box.bottom - box.top) * share(100 * error, errors);
  const svg = add(parent, 'svg', {width, height, role: 'img', 'data-picture': picture, 'aria-label': label});
  add(svg, 'rect', {class: 'frame', x: box.left, y: box.top, width: box.right - box.left, height: box.bottom - box.top});
  add(svg, 'text', {class: 'panel-title', x: box.left, y: 14}, title);
  for (const tick of decades(errors.steps, errors.least, errors.most)) {
    add(svg, 'line', {class: 'axis', x1: box.left, x2: box.right, y1: y(tick / 100), y2: y(tick / 100)});
    add(svg, 'text', {x: box.left - 5, y: y(tick / 100) + 4, 'text-anchor': 'end'}, tick + '%');
  }
  for (const tick of decades(ns.steps, ns.least, ns.most)) {
    add(svg, 'line', {class: 'axis', x1: x(tick), x2: x(tick), y1: box.top, y2: box.bottom});
    add(svg, 'text', {x: x(tick), y: box.bottom + 13, 'text-anchor': 'middle'}, tick);
  }
  add(svg, 'text', {x: (box.left + box.right) / 2, y: height - 5, 'text-anchor': 'middle'}, 'ns per strand and frame');
  return {svg, box, x, y};
}

function addFloor({svg, box, y}, error) {
  add(svg, 'line', {class: 'input', x1: box.left, x2: box.right, y1: y(error), y2: y(error)});
}

// Ringed: nothing as cheap is more exact.
function addPoint(svg, [x, y], kind, d, ringed, tip) {
  const mark = add(svg, 'path', {class: 'mark ' + kind, d, transform: `translate(${x} ${y}) scale(0.8)`});
  if (ringed) add(svg, 'circle', {class: 'ring ' + kind, cx: x, cy: y, r: 7});
  mark.addEventListener('pointermove', (event) => showTip(event, tip));
  mark.addEventListener('pointerleave', () => showTip());
}

function fillFamilies(parent, families, marks) {
  families.forEach((family, f) => {
    const item = add(parent, 'li');
    const swatch = add(item, 'svg', {class: 'swatch', viewBox: '-6 -6 12 12', 'aria-hidden': 'true'});
    add(swatch, 'path', {class: 'mark s' + f % kColours, d: marks[f % marks.length]});
    item.append(family);
  });
}

// ---- strands against the rod -----------------------------------------------------------------------

const rodGroup = (row) => `${row.model}, ${row.family}`;

function drawRod(accuracy, panel) {
  const rows = panel.rows.filter((r) => r.ns > 0 && r.pooled > 0);
  byId('rod').replaceChildren();
  if (!rows.length) return;
  // Every family of motions has the same axes.
  const times = rows.map((r) => r.ns), errors = accuracy.model_error.flatMap((p) => p.rows.filter((r) => r.ns > 0 && r.pooled > 0).map((r) => 100 * r.pooled));
  const front = rows.filter((r) => r.pareto_optimal).sort((a, b) => a.ns - b.ns);
  const plot = logPlot(byId('rod'), {
    picture: 'rod', title: `${panel.motion} motions, 60 Hz`, height: 420,
    label: `Error off a rod against ns per strand, ${panel.motion} motions. Pareto-optimal: ${front.map((r) => `${r.model} ${r.moved} ${percent(r.pooled)}`).join(', ')}. The table below has all figures.`,
    ns: {least: 0.8 * Math.min(...times), most: 1.25 * Math.max(...times), steps: [1, 2, 5]},
    errors: {least: 0.7 * Math.min(...errors), most: 1.5 * Math.max(...errors), steps: [1, 2, 5]},
  });
  const at = (r) => [plot.x(r.ns), plot.y(r.pooled)], taken = rows.map(at).map(([x, y]) => ({left: x - 5, right: x + 5, top: y - 5, bottom: y + 5}));
  [...new Set(rows.map(rodGroup))].forEach((group, g) => {
    const members = rows.filter((r) => rodGroup(r) === group), kind = 's' + g % kColours;
    add(plot.svg, 'path', {class: 'curve ' + kind, d: 'M' + members.map((r) => at(r).map((v) => v.toFixed(1)).join(' ')).join('L')});
    for (const row of members)
      addPoint(plot.svg, at(row).map((v) => v.toFixed(1)), kind, kMarks[g % kMarks.length], row.pareto_optimal,
          `${row.model}, ${row.moved}\n${percent(row.pooled)} off the rod\n${row.ns.toFixed(1)} ns`);
  });
  for (const row of rows) addName(plot, taken, row.moved, row.pareto_optimal, ...at(row));
}

function fillRodTable(panel) {
  byId('rod-table').replaceChildren();
  const share = (value) => value === null ? 'not finite' : percent(value);
  table(byId('rod-table'), `Off the rod, ${panel.motion} motions: RMS over materials but the stiff; of each the median (90 % are below) of ${panel.cases} cases`,
        ['model', 'moved', 'ns', 'all', 'well-posed', ...panel.rows[0].presets.map((p) => p.preset)],
        panel.rows.map((r) => [r.model, {text: r.moved, class: 'text'}, r.ns > 0 ? r.ns.toFixed(1) : '', share(r.pooled), share(r.pooled_well_posed),
          ...r.presets.map((p) => `${share(p.median)} (${share(p.ninth_tenth)})`)]), {tall: true});
}

function fillRod() {
  const accuracy = data.accuracy.find((a) => a.panels);
  byId('rod-section').hidden = !accuracy;
  if (!accuracy) return () => {};
  const panels = accuracy.model_error;
  fillFamilies(byId('rod-legend'), [...new Set(panels[0].rows.filter((r) => r.ns > 0).map(rodGroup))], kMarks);
  const draw = () => {
    drawRod(accuracy, panels[motionAt()]);
    fillRodTable(panels[motionAt()]);
  };
  const motionAt = chooser(byId('rod-motions'), panels, (p) => p.motion, 0, draw);
  return draw;
}

// ---- accuracy of solvers ---------------------------------------------------------------------------

const shownScore = (row, rate) => row.ns > 0 && row.scores[rate].finite;

// The newest method first: it is the one to look at.
function familiesOf(accuracy) {
  return [...new Set(accuracy.panels.flatMap((p) => p.rows.map((r) => r.family)))].reverse();
}

function drawPanel(parent, accuracy, panel, rate, families) {
  const times = accuracy.panels.flatMap((p) => p.rows.map((r) => r.ns)).filter((ns) => ns > 0);
  const front = panel.rows.filter((r) => shownScore(r, rate) && r.scores[rate].pareto_optimal).map((r) => `${r.label} ${percent(r.scores[rate].error)}`);
  const title = `${panel.preset}, ${panel.links} links, ${accuracy.rates[rate]} Hz`;
  const plot = logPlot(parent, {
    picture: 'accuracy', title, height: 250,
    label: `Error against ns per strand, ${title}. Pareto-optimal: ${front.join(', ')}. The table below has all figures.`,
    ns: {least: 0.8 * Math.min(...times), most: 1.25 * Math.max(...times), steps: [1, 3]},
    errors: {least: 0.02, most: 300, steps: [1]},
  });
  addFloor(plot, panel.input_errors[rate]);
  families.forEach((family, f) => {
    const rows = panel.rows.filter((r) => r.family === family && shownScore(r, rate));
    const at = rows.map((r) => [plot.x(r.ns).toFixed(1), plot.y(r.scores[rate].error).toFixed(1)]);
    if (at.length) add(plot.svg, 'path', {class: 'curve s' + f % kColours, d: 'M' + at.map((p) => p.join(' ')).join('L')});
    rows.forEach((row, i) => addPoint(plot.svg, at[i], 's' + f % kColours, kMarks[f % kMarks.length], row.scores[rate].pareto_optimal,
        `${row.label}\n${percent(row.scores[rate].error)} wrong\n${row.ns.toFixed(1)} ns, ${row.of_pbd.toFixed(2)} of PBD's`));
  });
}

function fillAccuracyTable(accuracy, panels, rate) {
  byId('accuracy-table').replaceChildren();
  table(byId('accuracy-table'), 'Error against run time', ['solver', ...panels.flatMap((p) => [`${p.preset}: ns`, 'of PBD', 'error'])],
        panels[0].rows.map((row, i) => [row.label, ...panels.flatMap((p) => {
          const r = p.rows[i];
          return r ? [r.ns.toFixed(1), r.of_pbd.toFixed(2), r.scores[rate].finite ? percent(r.scores[rate].error) : 'not finite'] : ['', '', ''];
        })]), {tall: true});
}

// The modal solver at every rate, for one number of links.
function fillShipped(accuracy, links) {
  byId('accuracy-shipped').replaceChildren();
  const panel = accuracy.shipped.find((p) => p.links === links);
  if (!panel) return;
  const rates = panel.rows[0].scores.map((s) => s.rate);
  const cell = (s) => s.finite ? `${percent(s.rms)} (${percent(s.median)}, ${percent(s.worst_case)})` : 'not finite';
  table(byId('accuracy-shipped'), `Modal solver: RMS of the error over drawn cases (median, worst), seed ${accuracy.seed}`,
        ['material', 'quality', ...rates.map((r) => r + ' Hz'), 'cases'],
        panel.rows.map((row) => [row.preset, row.solver + (row.velocities ? ', velocities' : ''), ...row.scores.map(cell), row.scores[0].cases]),
        {tall: true});
}

// A button for each value; returns a function that gives the chosen one's place.
function chooser(parent, values, name, chosen, redraw) {
  const buttons = values.map((value, i) => {
    const button = add(parent, 'button', {type: 'button', 'aria-pressed': i === chosen}, name(value));
    button.addEventListener('click', () => {
      chosen = i;
      buttons.forEach((other, o) => other.setAttribute('aria-pressed', o === i));
      redraw();
    });
    return button;
  });
  return () => chosen;
}

function fillAccuracy() {
  const accuracy = data.accuracy.find((a) => a.panels);
  byId('accuracy-section').hidden = !accuracy;
  if (!accuracy) return () => {};
  const families = familiesOf(accuracy), links = [...new Set(accuracy.panels.map((p) => p.links))];
  byId('accuracy-note').textContent =
      `${accuracy.processor}, one core, ${accuracy.isa} kernels, ${accuracy.timed_strands} strands, median frame of ${accuracy.rounds} rounds taken in turn; ` +
      `${accuracy.compiler}, ${accuracy.build_type}, commit ${accuracy.commit}; digest of the errors ${accuracy.error_digest}.` +
      (accuracy.problems === 'tuned' ? ' The suite that chose the constants of the modal solver.' : ` Motions and strands drawn from seed ${accuracy.seed}.`) +
      (accuracy.calibrated ? ' Strands with calibrated coefficients.' : '') +
      (accuracy.quick ? ' Quick: few solvers, cases and rounds.' : '');
  fillFamilies(byId('accuracy-legend'), families, kMarks);
  const draw = () => {
    const rate = rateAt(), panels = accuracy.panels.filter((p) => p.links === links[linksAt()]);
    byId('accuracy').replaceChildren();
    const boxes = panels.map(() => add(byId('accuracy'), 'div'));
    panels.forEach((panel, i) => drawPanel(boxes[i], accuracy, panel, rate, families));
    fillShipped(accuracy, links[linksAt()]);
    fillAccuracyTable(accuracy, panels, rate);
  };
  const linksAt = chooser(byId('accuracy-links'), links, (n) => n + ' links', 0, draw);
  const rateAt = chooser(byId('accuracy-rates'), accuracy.rates, (r) => r + ' Hz', Math.max(0, accuracy.rates.indexOf(60)), draw);
  return draw;
}

// ---- accuracy of a scene's frames ------------------------------------------------------------------

// Of marks that have an inside: a hollow one is another material.
const kSolidMarks = [kMarks[0], ...kMarks.slice(4), 'M-1.5-5H1.5V-1.5H5V1.5H1.5V5H-1.5V1.5H-5V-1.5H-1.5Z'];
const kWayTimes = [
  {name: 'whole frame', ns: 'frame_ns', of_pbd: 'frame_of_pbd', pareto_optimal: 'frame_pareto_optimal'},
  {name: 'simulation', ns: 'simulate_ns', of_pbd: 'simulate_of_pbd', pareto_optimal: 'simulate_pareto_optimal'},
];
const shownWay = (row, time) => row[time.ns] > 0 && row.error !== null;

// Beside the point, else further away with a line to it, where it covers nothing; else the point has none.
function addName({svg, box}, taken, name, strong, x, y) {
  const text = add(svg, 'text', {class: 'name' + (strong ? ' strong' : '')}, name);
  const width = text.getBBox().width, half = 6;
  const within = (value, least, most) => Math.max(least, Math.min(value, most));
  const place = [0, 13, 26, 39, 52, 65].flatMap((away) => [x + 8, x - 8 - width].flatMap((left) => [y - away, y + away].map((middle) => {
    const from = away ? within(left, box.left, box.right - width) : left;
    return {left: from, right: from + width, top: middle - half, bottom: middle + half};
  }))).find((b) => b.left >= box.left && b.right <= box.right && b.top >= box.top && b.bottom <= box.bottom &&
    !taken.some((t) => b.left < t.right && t.left < b.right && b.top < t.bottom && t.top < b.bottom));
  if (!place) return text.remove();
  taken.push(place);
  text.setAttribute('x', place.left);
  text.setAttribute('y', place.bottom - 3);
  const end = within(y, place.top, place.bottom);
  if (end !== y) add(svg, 'line', {class: 'leader', x1: x, y1: y, x2: within(x, place.left, place.right), y2: end});
}

function drawWays(parent, ways, time, families) {
  const rows = ways.rows.filter((r) => shownWay(r, time));
  if (!rows.length) return;
  const times = rows.map((r) => r[time.ns]);
  // Both panels have the same errors.
  const errors = [100, ...[ways.reference_self_error, ...ways.rows.map((r) => r.error)].filter((error) => error > 0).map((error) => 100 * error)];
  const front = rows.filter((r) => r[time.pareto_optimal]).sort((a, b) => a[time.ns] - b[time.ns]);
  const plot = logPlot(parent, {
    picture: 'ways', title: time.name, height: 420,
    label: `Error against ns per strand, ${time.name} of scene ${ways.scene}. Pareto-optimal: ${front.map((r) => `${r.label} ${percent(r.error)}`).join(', ')}. The table below has all figures.`,
    ns: {least: 0.8 * Math.min(...times), most: 1.3 * Math.max(...times), steps: [1, 2, 5]},
    errors: {least: 0.7 * Math.min(...errors), most: 1.5 * Math.max(...errors), steps: [1, 3]},
  });
  if (ways.reference_self_error > 0) addFloor(plot, ways.reference_self_error);
  // From the cheapest to the most exact.
  const stairs = front.map((r) => `${plot.x(r[time.ns]).toFixed(1)} ${plot.y(r.error).toFixed(1)}`).map((at, i) => i ? `H${at.replace(' ', 'V')}` : 'M' + at);
  add(plot.svg, 'path', {class: 'front', d: stairs.join('')});
  const taken = rows.map((r) => [plot.x(r[time.ns]), plot.y(r.error)]).map(([x, y]) => ({left: x - 5, right: x + 5, top: y - 5, bottom: y + 5}));
  for (const row of rows) {
    const f = families.indexOf(row.family), at = [plot.x(row[time.ns]), plot.y(row.error)];
    addPoint(plot.svg, at.map((value) => value.toFixed(1)), `s${f}${row.reference_material ? '' : ' hollow'}`, kSolidMarks[f % kSolidMarks.length], row[time.pareto_optimal],
        `${row.label}\n${percent(row.error)} wrong\n${row[time.ns].toFixed(1)} ns, ${row[time.of_pbd].toFixed(2)} of PBD's`);
    addName(plot, taken, row.label, row[time.pareto_optimal], ...at);
  }
}

function fillWaysTable(ways) {
  table(byId('ways-table'), 'Ways to run the scene', ['way', ...kWayTimes.flatMap((time) => [`${time.name}: ns`, 'of PBD']), 'error', 'off, mm', 'off its rod', 'strands live', 'nothing as cheap is more exact'],
        ways.rows.map((row) => [
          row.label, ...kWayTimes.flatMap((time) => [row[time.ns].toFixed(1), row[time.of_pbd].toFixed(2)]),
          row.error === null ? 'not finite' : percent(row.error), row.off_m === null ? '' : (1e3 * row.off_m).toFixed(3), row.rod_error === null ? '' : percent(row.rod_error), percent(row.live_share),
          {text: row.reference_material ? kWayTimes.filter((time) => row[time.pareto_optimal]).map((time) => time.name).join(', ') : 'another material', class: 'text'}]), {tall: true});
}

function fillWays() {
  const ways = data.accuracy.find((a) => a.rows);
  byId('ways-section').hidden = !ways;
  if (!ways) return () => {};
  const families = [...new Set(ways.rows.map((r) => r.family))].sort();
  byId('h-ways').textContent = `Every way to run scene ${ways.scene}: error against run time`;
  byId('ways-note').textContent =
      `${number(ways.strands)} strands, ${ways.layers} layers, ${ways.contact ? '' : 'no contacts, '}${ways.frames} frames at ${ways.frames_per_second} a second, ` +
      `${ways.warm_up_frames} of them to warm up, and ${ways.still_frames} still ones; ${ways.processor}, one core, ${ways.isa} kernels, fastest of ${ways.rounds} rounds; ` +
      `${ways.compiler}, ${ways.build_type}, commit ${ways.commit}; digest of the errors ${ways.error_digest}.` + (ways.quick ? ' Quick: few frames, one round.' : '') +
      (ways.notes.length ? ` Left out: ${ways.notes.join('; ')}.` : '');
  fillFamilies(byId('ways-legend'), families, kSolidMarks);
  fillWaysTable(ways);
  return () => {
    byId('ways').replaceChildren();
    const boxes = kWayTimes.map(() => add(byId('ways'), 'div'));
    kWayTimes.forEach((time, i) => drawWays(boxes[i], ways, time, families));
  };
}
