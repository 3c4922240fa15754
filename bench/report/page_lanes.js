// Lanes over time, as workers in a frame or units of a console: zoom by dragging, by buttons and by keys, and a search.
'use strict';
const kMostZoom = 256;
const kFoundWidth = 24;  // px that what was found is widened to, and that are left beside it where it is wide

// Of many bars, those of a kind as one path each: what the search does not find is dimmed, what it finds is never too
// narrow to be seen.
class Bars {
  constructor(x, query, textOf) {
    this.x = x;
    this.query = query.trim().toLowerCase();
    this.textOf = textOf;
    this.found = [];
  }
  startLane() {
    this.paths = new Map();
  }
  add(kind, top, tall, slice) {
    const found = this.query !== '' && this.textOf(slice).toLowerCase().includes(this.query);
    if (found) this.found.push({begin: slice.begin, end: slice.end, top, tall});
    const from = this.x(slice.begin), to = Math.max(this.x(slice.end), found ? from + 1 : 0);
    if (from.toFixed(2) === to.toFixed(2)) return;
    const key = this.query === '' || found ? kind : kind + ' dim';
    this.paths.set(key, (this.paths.get(key) || '') + `M${from.toFixed(2)} ${top}H${to.toFixed(2)}v${tall}H${from.toFixed(2)}Z`);
  }
  endLane(svg) {
    for (const [kind, d] of this.paths) add(svg, 'path', {class: 'band ' + kind, d});
  }
}

// The part of a picture between two places, taken by dragging with a mouse or pen: a finger scrolls.
function selectByDragging(scroll, use) {
  scroll.addEventListener('pointerdown', (start) => {
    const svg = start.target.closest('svg');
    if (!svg || start.button !== 0 || start.pointerType === 'touch') return;
    const at = (event) => Math.max(0, Math.min(event.clientX - svg.getBoundingClientRect().left, svg.width.baseVal.value));
    const from = at(start), box = add(svg, 'rect', {class: 'selection', y: 0, height: '100%', x: from, width: 0});
    const range = (event) => [Math.min(from, at(event)), Math.max(from, at(event))];
    const move = (event) => {
      const [left, right] = range(event);
      box.setAttribute('x', left);
      box.setAttribute('width', right - left);
    };
    const end = (event) => {
      for (const [name, listener] of [['pointermove', move], ['pointerup', end], ['pointercancel', end]]) removeEventListener(name, listener);
      box.remove();
      const [left, right] = range(event);
      if (event.type === 'pointerup' && right - left > 4) use(left / svg.width.baseVal.value, right / svg.width.baseVal.value);
    };
    for (const [name, listener] of [['pointermove', move], ['pointerup', end], ['pointercancel', end]]) addEventListener(name, listener);
  });
}

// A picture with a name beside each lane and a table below. `draw` draws it so many times as wide as its box, with what
// a search is for, and returns what was found, in ns of `ns`. Returns what draws it again.
function fillLanes(parent, {heading, label, names, height, ns, draw, details}) {
  const box = add(parent, 'div', {class: 'timeline'});
  const head = add(box, 'div', {class: 'timeline-head'});
  add(head, 'h3', {}, heading);
  const search = add(head, 'input', {type: 'search', placeholder: 'Search: stage, layer, chunk', 'aria-label': `Search in the ${label}`, spellcheck: false});
  const said = add(head, 'output', {class: 'note'});
  const buttons = add(head, 'div', {role: 'group', 'aria-label': `Zoom of the ${label}`});
  const body = add(box, 'div', {class: 'timeline-body'});
  const column = add(body, 'svg', {width: 64, height, 'aria-hidden': 'true'});
  for (const name of names) add(column, 'text', {x: 0, y: name.y}, name.text);
  const scroll = add(body, 'div', {class: 'scroll lanes', tabindex: 0, role: 'region', 'aria-label': label[0].toUpperCase() + label.slice(1) + ', picture'});
  const more = add(box, 'details');
  add(more, 'summary', {}, 'Table of the picture');
  details(more);
  const once = () => Math.max(kLeastWidth, scroll.clientWidth);  // of the picture as it comes
  let zoom = 1, found = [], shown = -1;
  const redraw = () => {
    found = draw(scroll, zoom, search.value);
    for (const button of buttons.children) button.setAttribute('aria-pressed', Number(button.dataset.zoom) === zoom);
    const sum = found.reduce((all, f) => all + f.end - f.begin, 0);
    said.textContent = search.value.trim() ? `${number(found.length)} found, ${ms(sum / 1e6)} ms` + (found.length ? '; Enter: the next' : '') : '';
    const at = found[shown];
    if (!at) return;
    const svg = scroll.querySelector('svg'), width = svg.width.baseVal.value, left = width * at.begin / ns;
    add(svg, 'rect', {class: 'found', x: left - 2, y: at.top - 1, width: Math.max(1, width * at.end / ns - left) + 4, height: at.tall + 2});
  };
  // `share`: of the picture, comes to the middle.
  const zoomTo = (factor, share) => {
    zoom = Math.max(1, Math.min(factor, kMostZoom));
    redraw();
    scroll.scrollLeft = share * scroll.scrollWidth - scroll.clientWidth / 2;
  };
  const middle = () => (scroll.scrollLeft + scroll.clientWidth / 2) / scroll.scrollWidth;
  for (const factor of [1, 4, 16, 64]) {
    const button = add(buttons, 'button', {type: 'button', 'data-zoom': factor}, factor + '×');
    button.addEventListener('click', () => zoomTo(factor, middle()));
  }
  selectByDragging(scroll, (from, to) => zoomTo(scroll.clientWidth / once() / (to - from), (from + to) / 2));
  scroll.addEventListener('dblclick', () => zoomTo(1, 0.5));
  scroll.addEventListener('keydown', (event) => {
    const factor = {'+': 2 * zoom, '=': 2 * zoom, '-': zoom / 2, '0': 1}[event.key];
    if (factor && !event.ctrlKey && !event.metaKey) zoomTo(factor, middle());
  });
  search.addEventListener('input', () => {
    shown = -1;
    redraw();
  });
  search.addEventListener('keydown', (event) => {
    if (event.key !== 'Enter' || !found.length) return;
    shown = (shown + (event.shiftKey ? found.length - 1 : 1) + found.length) % found.length;
    const {begin, end} = found[shown];
    const zoomOf = (width) => width * ns / (Math.max(1, end - begin) * once());
    // As it is, unless what is shown would be too narrow to see or wider than what one sees.
    zoomTo(Math.min(Math.max(zoom, zoomOf(kFoundWidth)), zoomOf(scroll.clientWidth - kFoundWidth)), (begin + end) / 2 / ns);
  });
  return redraw;
}
