// ---- Grooming: comb vectors on the skin, maps painted over it, undo, save and load ------------------------------------

// Maps that are painted: a name, the layer's key, and what stands where there is no map yet.
const kMaps = [['density', 'density', 1], ['length', 'length', 1], ['width', 'width', 1], ['bald', 'mask.bald', 0], ['type', 'type_map', 0]];
const kMapSides = [64, 128, 256, 512, 1024];
// How near a handle is to a pointer that takes it, of a finger's size.
const kGrab_px = 24;

$('tool').append(element('option', {value: 'comb', textContent: 'comb the fur'}));
for (const [i, [name]] of kMaps.entries()) $('tool').append(element('option', {value: `map ${i}`, textContent: `paint the map of ${name}`}));
for (const side of kMapSides) $('map-side').append(element('option', {value: side, textContent: side, selected: side === 256}));

const isGroomTool = (tool) => tool === 'comb' || tool.startsWith('map ');
let combs = [], chosen = -1, groomDrag = null, ring = null;

// What belongs to the tool that is chosen, for the layers of the setup that is shown.
function showGroom() {
  const tool = $('tool').value.split(' ')[0], layers = described?.setups[shownSetup]?.layers ?? [];
  $('groom').hidden = Boolean(described?.recording);
  for (const part of $('groom').querySelectorAll('[data-tool]')) part.hidden = !part.dataset.tool.split(' ').includes(tool);
  const select = $('groom-layer'), before = select.value;
  select.replaceChildren(...layers.map(({name}) => element('option', {textContent: name, selected: name === before})));
  if (tool !== 'comb') [combs, chosen] = [[], -1];
  ring = null;
  if (described && !described.recording) tell({combing: tool === 'comb' && select.value ? {setup: shownSetup, layer: select.value} : null});
  drawMarks();
}
$('tool').onchange = $('groom-layer').onchange = () => {
  chosen = -1;
  showGroom();
};

// ---- What is drawn over the picture

const placeOf = ([x, y]) => [x * canvas.clientWidth, y * canvas.clientHeight];

function drawComb(comb, isChosen) {
  const [x, y] = placeOf(comb.root), [tipX, tipY] = placeOf(comb.tip), angle = Math.atan2(tipY - y, tipX - x);
  const barb = (by) => `L${tipX - 14 * Math.cos(angle + by)} ${tipY - 14 * Math.sin(angle + by)}`;
  const part = drawing($('marks'), 'g', {class: `${isChosen ? 'chosen ' : ''}${comb.faces ? '' : 'behind'}`});
  drawing(part, 'circle', {class: 'reach', cx: x, cy: y, r: comb.ring * canvas.clientHeight});
  drawing(part, 'path', {d: `M${x} ${y}L${tipX} ${tipY}${barb(0.4)}M${tipX} ${tipY}${barb(-0.4)}`});
  for (const [cx, cy] of [[x, y], [tipX, tipY]]) drawing(part, 'circle', {class: 'handle', cx, cy, r: 6});
}

function drawMarks() {
  const marks = $('marks');
  for (const [side, size] of [['left', canvas.offsetLeft], ['top', canvas.offsetTop], ['width', canvas.clientWidth], ['height', canvas.clientHeight]]) marks.style[side] = `${size}px`;
  marks.replaceChildren();
  for (const [i, comb] of combs.entries()) {
    if (comb.root.every((share) => Math.abs(share) < 3)) drawComb(comb, i === chosen);
  }
  $('comb-drop').disabled = !combs[chosen];
  if (!ring) return;
  const [cx, cy] = placeOf(ring.at);
  drawing(marks, 'circle', {class: 'reach', cx, cy, r: ring.ring * canvas.clientHeight});
}

// ---- The pointer

// The handle that is there; or a vector that begins there.
function grab(at) {
  const [x, y] = placeOf(at);
  let best = {index: combs.length, part: 'tip', from: at}, least = kGrab_px;
  for (const [index, comb] of combs.entries())
    for (const part of comb.faces ? ['tip', 'root'] : []) {
      const [handleX, handleY] = placeOf(comb[part]), far = Math.hypot(handleX - x, handleY - y);
      if (far < least) [least, best] = [far, {index, part, from: at}];
    }
  return best;
}

function groom(tool, at, down) {
  if (down && tool === 'comb') {
    groomDrag = grab(at);
    chosen = groomDrag.index;
    if (combs[chosen]) $('comb-lift').value = combs[chosen].lift;
    return drawMarks();
  }
  if (down) groomDrag = {};
  if (!groomDrag) return;
  groomDrag.moved = true;
  if (tool === 'comb') return tell({comb: {...groomDrag, to: at, lift: Number($('comb-lift').value)}});
  const [, key, empty] = kMaps[Number(tool.slice(4))];
  const [radius, hardness, value, side] = ['brush-size', 'brush-hardness', 'brush-value', 'map-side'].map((id) => Number($(id).value));
  tell({brush: {setup: shownSetup, layer: $('groom-layer').value, key, side, empty, radius, hardness, value, at}});
}

function endGroom() {
  if (groomDrag?.moved) tell(groomDrag.part ? {combEnd: true} : {brush: null});
  groomDrag = ring = null;
  drawMarks();
}

$('comb-drop').onclick = () => {
  tell({combDrop: chosen});
  chosen = -1;
};
$('undo').onclick = () => tell({undo: true});
$('redo').onclick = () => tell({redo: true});

// ---- What the worker says

function takeGroom(data) {
  if (data.combs) combs = data.combs;
  if (data.brushed) ring = groomDrag && data.brushed.ring ? data.brushed : null;
  if (data.combs || data.brushed) drawMarks();
  if (data.edits) {
    [$('undo').disabled, $('redo').disabled] = data.edits.map((count) => count === 0);
    stroke ||= data.edits[0] > 0;  // frames are other than the native ones
  }
  if (data.keys) {
    changes.keys = data.keys;
    remember();
  }
  if (data.saved) save(data.saved);
}

let costs = [];
// Of each layer beside its name, all its stages in the last frame that was timed.
function showCosts(now = costs) {
  costs = now;
  for (const group of $('controls').querySelectorAll('details[data-layer]')) {
    const ns = costs[shownSetup]?.[group.dataset.layer], summary = group.firstChild;
    const cost = summary.querySelector('.cost') ?? summary.appendChild(element('span', {className: 'cost'}));
    cost.textContent = ns ? `${Math.round(ns).toLocaleString('en')} ns` : '';
  }
}

// ---- Files

$('save').onclick = () => tell({save: shownSetup});

function save({file, files, digest, outside}) {
  const href = URL.createObjectURL(new Blob(zipParts(files), {type: 'application/zip'}));
  element('a', {href, download: file.replace(/\.toml$/, '.zip')}).click();
  setTimeout(() => URL.revokeObjectURL(href), 60_000);
  $('copied').textContent = `saved: ${Object.keys(files).join(', ')}; pelt bake --setup ${file} prints the digest ${digest}`;
  if (outside.length) showFault(`Not saved, as the setup names them outside of its folder: ${outside.join(', ')}`);
}

// Maps without their folder get the one that the setup names.
function nameInSetup(name, text) {
  if (name.includes('/')) return name;
  const written = name.replace(/[.*+?^${}()|[\]\\]/g, '\\$&');
  return (new RegExp(`["']([^"'\n]*/)${written}["']`).exec(text)?.[1] ?? '') + name;
}

async function loadFiles(chosenFiles) {
  showFault('');
  const found = {};
  for (const file of chosenFiles) {
    const bytes = new Uint8Array(await file.arrayBuffer());
    try {
      Object.assign(found, /\.zip$/i.test(file.name) ? await unzip(bytes) : {[file.name]: bytes});
    } catch (error) {
      return showFault(`${file.name} cannot be read: ${error.message}`);
    }
  }
  const tomls = Object.keys(found).filter((name) => /\.toml$/i.test(name));
  if (tomls.length !== 1) return showFault(`${tomls.length} setups (.toml) are among the files; one is loaded at a time`);
  const text = new TextDecoder().decode(found[tomls[0]]), own = tomls[0].slice(0, tomls[0].lastIndexOf('/') + 1), files = {};
  for (const [name, bytes] of Object.entries(found))
    if (/\.(png|jpe?g)$/i.test(name)) files[nameInSetup(name.startsWith(own) ? name.slice(own.length) : name, text)] = bytes;
  tell({load: {setup: shownSetup, text, files}});
}
$('load').onclick = () => $('load-files').click();
$('load-files').onchange = async ({target}) => {
  await loadFiles([...target.files]);
  target.value = '';  // the same may be chosen again
};
