// What both pages draw with: nodes, tables, the tip, frames over time. Text from the data is only ever set as text.
'use strict';
const data = JSON.parse(document.getElementById('data').textContent);
const byId = (id) => document.getElementById(id);
const kLinesMs = [5, 8];

function add(parent, tag, attributes = {}, text) {
  const svg = parent.namespaceURI === 'http://www.w3.org/2000/svg' || tag === 'svg';
  const node = svg ? document.createElementNS('http://www.w3.org/2000/svg', tag) : document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  if (text !== undefined) node.textContent = text;
  parent.append(node);
  return node;
}

const number = (value) => value.toLocaleString('en');
const ms = (value) => value.toFixed(value < 0.9995 ? 3 : 2);
const kb = (bytes) => number(Math.round(bytes / 100) / 10);

// ---- tables ----------------------------------------------------------------------------------------

const textual = (rows, column) => rows.some((row) => !row.heading && row[column] && row[column].class === 'text');

// A cell is text, a number with its own format, or {text, class, bar: [[share, class], ...]}.
function table(parent, label, heads, rows, options = {}) {
  const box = add(parent, 'div', {class: 'scroll' + (options.tall ? ' tall' : ''), tabindex: 0, role: 'region', 'aria-label': label});
  const t = add(box, 'table', {class: options.wide ? 'wide' : ''});
  const head = add(add(t, 'thead'), 'tr');
  heads.forEach((name, i) => add(head, 'th', {scope: 'col', class: textual(rows, i) ? 'text' : ''}, name));
  const body = add(t, 'tbody');
  for (const row of rows) {
    const tr = add(body, 'tr', row.heading ? {class: 'group'} : {});
    if (row.heading) {
      add(tr, 'th', {colspan: heads.length, scope: 'rowgroup'}, row.heading);
      continue;
    }
    row.forEach((cell, i) => {
      const is = typeof cell === 'object' ? cell : {text: cell};
      const node = add(tr, i ? 'td' : 'th', i ? {class: is.class || ''} : {scope: 'row'}, is.bar ? undefined : is.text);
      if (!is.bar) return;
      const track = add(node, 'div', {class: 'track', 'aria-hidden': 'true'});
      for (const [share, kind] of is.bar)
        add(track, 'i', {class: kind}).style.width = (100 * share).toFixed(2) + '%';
    });
  }
}

// ---- pictures --------------------------------------------------------------------------------------

function showTip(event, text) {
  const tip = byId('tip');
  tip.hidden = !text;
  if (!text) return;
  tip.textContent = text;
  const box = tip.getBoundingClientRect();
  tip.style.left = Math.max(4, Math.min(event.clientX + 14, innerWidth - box.width - 4)) + 'px';
  tip.style.top = (event.clientY + 18 + box.height > innerHeight ? event.clientY - box.height - 10 : event.clientY + 18) + 'px';
}

// A round step that gives about `count` ticks up to `top`.
function tickStep(top, count) {
  const rough = top / count, power = 10 ** Math.floor(Math.log10(rough));
  return power * [1, 2, 5, 10].find((f) => f * power >= rough);
}

// Narrower than this a picture of many frames or items shows nothing: it scrolls in its box instead.
const kLeastWidth = 480;

// The top of a picture of frames: both lines, unless frames are far below them, and no more than three times the higher
// one, unless the median frame is beyond; slower frames are cut off there, and say what they took.
const kMostMs = 3 * kLinesMs[1];
function framesTop(median, worst) {
  if (worst < 2) return worst * 1.2;
  return Math.max(kLinesMs[1] * 1.1, Math.min(worst * 1.08, Math.max(kMostMs, 1.25 * median)));
}

// An arrow for each of [{ms, at}] that is cut off, and what it took, the slowest first, where there is room.
function markCut(svg, cut, [least, most]) {
  for (const {at} of cut) add(svg, 'path', {class: 'cut', d: `M${(at - 3).toFixed(1)} 20L${at.toFixed(1)} 14L${(at + 3).toFixed(1)} 20Z`});
  const taken = [];
  for (const {ms, at} of cut.sort((a, b) => b.ms - a.ms)) {
    const text = add(svg, 'text', {class: 'cut', y: 11}, `${ms.toFixed(0)} ms`);
    const width = text.getBBox().width, from = Math.max(least, Math.min(at - width / 2, most - width));
    if (taken.some((other) => from < other.to + 4 && other.from < from + width + 4)) text.remove();
    else taken.push({from, to: from + width});
    text.setAttribute('x', from);
  }
  return cut.length;
}

// Frames side by side against 5 and 8 ms: `drawBelow` draws what stands under the lines. `columns`: of each its ms and its
// frame.
function plotFrames(box, {columns, top, picture, label, drawBelow}) {
  box.replaceChildren();
  const scroll = add(box, 'div', {class: 'scroll', tabindex: 0, role: 'region', 'aria-label': 'Picture of the frames'});
  const width = Math.max(kLeastWidth, scroll.clientWidth), height = 280, left = 36, right = 6, up = 22, down = 26;
  const x = (i) => left + (width - left - right) * i / columns.length;
  const y = (value) => up + (height - up - down) * (1 - Math.min(value, top) / top);
  const svg = add(scroll, 'svg', {width, height, role: 'img', 'data-picture': picture, 'data-top': top, 'aria-label': label});
  for (let value = 0, step = tickStep(top, 5); value <= top; value += step) {
    add(svg, 'line', {class: 'axis', x1: left, x2: width - right, y1: y(value), y2: y(value)});
    add(svg, 'text', {x: left - 6, y: y(value) + 4, 'text-anchor': 'end'}, +value.toFixed(3));
  }
  drawBelow({svg, x, y});
  const close = y(kLinesMs[0]) - y(kLinesMs[1]) < 16;  // names beside each other, not on each other
  for (const line of kLinesMs.filter((l) => l <= top)) {
    add(svg, 'line', {class: 'limit-halo', x1: left, x2: width - right, y1: y(line), y2: y(line)});
    add(svg, 'line', {class: 'limit', x1: left, x2: width - right, y1: y(line), y2: y(line)});
    // On the left, which is seen before anything is scrolled.
    add(svg, 'text', {class: 'limit-text', x: left + (close && line === kLinesMs[0] ? 44 : 4), y: y(line) - 5}, line + ' ms');
  }
  const step = Math.max(1, tickStep(columns.length, width / 90));
  for (let i = 0; i < columns.length; i += step)
    add(svg, 'text', {x: x(i), y: height - 8}, (i ? '' : 'frame ') + columns[i].frame);
  const cursor = add(svg, 'line', {class: 'cursor', y1: up, y2: height - down, visibility: 'hidden'});
  svg.addEventListener('pointermove', (event) => {
    const i = Math.floor((event.clientX - svg.getBoundingClientRect().left - left) / (width - left - right) * columns.length);
    cursor.setAttribute('visibility', columns[i] ? 'visible' : 'hidden');
    if (columns[i]) for (const end of ['x1', 'x2']) cursor.setAttribute(end, x(i + 0.5));
    showTip(event, columns[i]?.tip());
  });
  svg.addEventListener('pointerleave', () => {
    cursor.setAttribute('visibility', 'hidden');
    showTip();
  });
  const cut = columns.map((column, i) => ({ms: column.ms, at: x(i + 0.5)})).filter((c) => c.ms > top);
  return markCut(svg, cut, [left, width - right]);
}

