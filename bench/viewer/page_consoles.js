// ---- Consoles -------------------------------------------------------------------------------------------------------

// What each unit of a console does in a modelled frame of this scene, and this page's own last frame above it, on one
// clock. What pelt report --out shows with search and zoom.
const kUnitColours = {compute: '#4a7fb5', 'get stall': '#c2452d', 'put stall': '#c2452d', code: '#b58a2a', dispatch: '#7a55a8', commands: '#7a55a8', imbalance: '#9a9a9a', barrier: '#9a9a9a'};
const kUnitRow = 16, kUnitHeight = 12, kUnitLeft = 130, kUnitsWide = 1000;

const drawing = (parent, tag, attributes, text) => {
  const made = document.createElementNS('http://www.w3.org/2000/svg', tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (text !== undefined) made.textContent = text;
  parent.append(made);
  return made;
};

// Slices of a unit as one path a kind of work: work, pass, item, begin and end in ns.
function drawUnit(svg, unit, works, y, ns) {
  drawing(svg, 'text', {x: 0, y: y + kUnitHeight - 2}, unit.name);
  const paths = new Map(), sums = new Map();
  for (let i = 0; i < unit.slices.length; i += 5) {
    const [work, , , begin, end] = unit.slices.slice(i, i + 5), name = works[work];
    const from = kUnitLeft + kUnitsWide * begin / ns, to = kUnitLeft + kUnitsWide * end / ns;
    paths.set(name, (paths.get(name) ?? '') + `M${from.toFixed(1)} ${y}H${to.toFixed(1)}v${kUnitHeight}H${from.toFixed(1)}Z`);
    sums.set(name, (sums.get(name) ?? 0) + end - begin);
  }
  for (const [name, d] of paths) drawing(drawing(svg, 'path', {d, fill: kUnitColours[name] ?? '#9a9a9a', 'data-work': name}), 'title', {}, `${unit.name}: ${name}, ${(sums.get(name) / 1e6).toFixed(2)} ms`);
}

// This page's frame above a console's: longer than the picture is wide, it is cut and its time says so.
const ownBars = [];
function drawOwn({bar, time, ns}) {
  const own_ms = Number(document.body.dataset.ms ?? 0), width = kUnitsWide * Math.min(own_ms * 1e6 / ns, 1);
  bar.setAttribute('width', width);
  time.textContent = `${own_ms.toFixed(1)} ms`;
  time.setAttribute('x', kUnitLeft + Math.min(width + 4, kUnitsWide - 50));
}

function drawConsole(frame) {
  const part = element('figure', {});
  part.append(element('figcaption', {textContent: frame.verdict}));
  $('consoles').append(part);
  if (!frame.units.length) return;
  const ns = 1.2 * frame.ns, height = kUnitRow * (frame.units.length + 2);
  const svg = drawing(part, 'svg', {viewBox: `0 0 ${kUnitLeft + kUnitsWide} ${height}`, role: 'img', 'aria-label': `${frame.name}: what each unit does in frame ${frame.frame}, ${(frame.ns / 1e6).toFixed(2)} ms`});
  drawing(svg, 'text', {x: 0, y: kUnitHeight - 2}, 'this page');
  ownBars.push({bar: drawing(svg, 'rect', {x: kUnitLeft, y: 0, height: kUnitHeight, fill: '#7fa6cc'}), time: drawing(svg, 'text', {y: kUnitHeight - 2}), ns});
  drawOwn(ownBars.at(-1));
  frame.units.forEach((unit, u) => drawUnit(svg, unit, frame.works, kUnitRow * (u + 1), ns));
  for (const line_ms of [5, 8, frame.ns * 1e-6]) {
    if (line_ms * 1e6 > ns) continue;
    const x = kUnitLeft + kUnitsWide * line_ms * 1e6 / ns;
    drawing(svg, 'path', {d: `M${x} 0V${height - kUnitRow}`, stroke: 'currentColor'});
    drawing(svg, 'text', {x: x + 3, y: height - 4}, `${Number(line_ms.toFixed(2))} ms`);
  }
}

function drawConsoles() {
  if (!$('consoles').open || ownBars.length) return;
  const legend = element('ul', {});
  for (const [name, colour] of Object.entries(kUnitColours)) {
    const item = element('li', {textContent: name});
    item.style.borderLeft = `12px solid ${colour}`;
    item.style.paddingLeft = '4px';
    legend.append(item);
  }
  $('consoles').append(legend);
  for (const frame of given.consoles) drawConsole(frame);
  setInterval(() => ownBars.forEach(drawOwn), 500);
}
$('consoles').hidden = !given.consoles;
$('consoles').ontoggle = drawConsoles;
