// ---- Edits of setups: undone, done again, combed, painted, saved and loaded --------------------------------------------

// An edit: {setup, label, before, after}, both {text, keys, files}: the setup's text, the keys that a link holds, and the
// bytes of files by their paths.
const kMostEdits = 200, kSameEdit_ms = 700;
let past = [], future = [], lastEdit_ms = 0;

function forgetEdits() {
  combing = null;
  endDrags();
  [past, future] = [[], []];
  tellEdits();
}
// What a stroke has baked so far is an edit, even where the next dab ended the module.
function endDrags() {
  const {setup, before, after} = brushing ?? {};
  dragged = brushing = null;
  if (after) record(setup, '', before, after);
}
const tellEdits = () => postMessage({edits: [past.length, future.length]});

const keysWith = (change) => [...kept.keys.filter(([layer, key, , setup]) => layer !== change[0] || key !== change[1] || setup !== change[3]), change];
const fileAt = (path) => kept.files[path] ?? request.files?.[path];
const filesAt = (paths) => Object.fromEntries(paths.filter(fileAt).map((path) => [path, fileAt(path)]));
const stateOf = (setup, paths) => ({text: result(exported.SetupText(setup)), keys: kept.keys, files: filesAt(paths)});

// For a module that has to begin again.
function keep(setup, state) {
  kept.setups[setup] = state.text;
  kept.keys = state.keys;
  Object.assign(kept.files, state.files);
}

// What a slider that is dragged changes within a while is one edit.
function record(setup, label, before, after) {
  const last = past.at(-1), now = performance.now();
  if (label && last?.label === label && now - lastEdit_ms < kSameEdit_ms) last.after = after;
  else past.push({setup, label, before, after});
  if (past.length > kMostEdits) past.shift();
  lastEdit_ms = now;
  future = [];
  tellEdits();
}

// `change` has the module take it, and may end it: then nothing was edited. `files`: those that it gave.
function edit(setup, label, change, keys = kept.keys, files = {}) {
  const before = stateOf(setup, Object.keys(files));
  change();
  const after = {text: result(exported.SetupText(setup)), keys, files};
  keep(setup, after);
  record(setup, label, before, after);
}

function travel(from, to, side) {
  if (brushing || !from.length) return;
  const {setup, [side]: state} = from.at(-1);
  for (const [path, bytes] of Object.entries(state.files)) call('GiveFile', path, bytes);
  call('ReplaceSetup', setup, state.text);
  keep(setup, state);
  to.push(from.pop());
  lastEdit_ms = 0;
  tellEdits();
  postMessage({keys: kept.keys});
  describe();
  if (!playing) handlers.step(1);
}

// ---- Comb vectors

// Whose are shown, {setup, layer, combs}, and the one that is dragged, {index, comb}.
let combing = null, dragged = null;

function showCombs() {
  if (!dragged) combing.combs = JSON.parse(result(call('DescribeCombs', combing.setup, combing.layer)));
  postMessage({combs: combing.combs});
}

const movedComb = (comb, part, at, lift) => JSON.parse(result(call('MoveComb', combing.setup, JSON.stringify(comb), part === 'root' ? 0 : 1, ...at, lift)));

const short = (v) => String(Number(v.toPrecision(5)));
const combText = (combs) => `[${combs.map(({position, direction, reach}) =>
  `{ position = [${position.map(short).join(', ')}], direction = [${direction.map(short).join(', ')}], reach = ${short(reach)} }`).join(', ')}]`;

function takeCombs(combs) {
  dragged = null;
  handlers.key([combing.layer, 'comb', combText(combs), combing.setup], '');
  postMessage({keys: kept.keys});
}

// ---- Maps

// A stroke of the brush: {setup, layer, key, name, path, before, after}, with the states of its edit, where it is (at), and
// whether there is paint that was not baked (stale).
let brushing = null;
let bake_ms = 0, baked_ms = 0;

// Of a layer's map: a name that no other file has.
function mapName(setup, layer, key) {
  const own = `${setup} ${layer} ${key}`, stem = `${layer.replace(/[^\w-]/g, '_')}_${key.replace('mask.', '')}`;
  for (let i = 1; !kept.maps[own]; ++i) {
    const name = `${stem}${i > 1 ? `_${i}` : ''}.png`;
    if (!fileAt(result(call('PathOf', setup, name)))) kept.maps[own] = name;
  }
  return kept.maps[own];
}

function bakeMap() {
  const start_ms = performance.now(), {setup, layer, key, name, path} = brushing;
  const png = bytes(exported.MapPng(), exported.TextSize()).slice();
  call('GiveFile', path, png);
  call('TakeMap', setup, layer, key, name);
  brushing.after = {text: result(exported.SetupText(setup)), keys: kept.keys, files: {[path]: png}};
  keep(setup, brushing.after);
  if (!playing) handlers.step(1);
  brushing.stale = false;
  baked_ms = performance.now();
  bake_ms = baked_ms - start_ms;
}

function endStroke() {
  if (!brushing) return;
  if (brushing.stale) bakeMap();
  endDrags();
  describe();
}

Object.assign(handlers, {
  undo: () => travel(past, future, 'before'),
  redo: () => travel(future, past, 'after'),
  // {setup, layer} whose vectors are to be shown; null: none.
  combing: (wanted) => {
    combing = wanted;
    dragged = null;
    if (combing) showCombs();
  },
  // One behind the last is a new one, from where the pointer went down.
  comb: ({index, part, from, to, lift}) => {
    if (!combing) return;
    if (dragged?.index !== index) {
      dragged = null;
      const fresh = {position: [0, 0, 0], direction: [0, -1, 0], reach: 0.1};
      const comb = combing.combs[index] ?? movedComb(fresh, 'root', from, lift);
      if (!comb) return;
      dragged = {index, comb};
    }
    dragged.comb = movedComb(dragged.comb, part, to, lift) ?? dragged.comb;
    combing.combs[index] = dragged.comb;
    showCombs();
  },
  combEnd: () => {
    if (combing && dragged) takeCombs(combing.combs);
  },
  combDrop: (index) => {
    if (combing?.combs[index]) takeCombs(combing.combs.filter((_, i) => i !== index));
  },
  // {setup, layer, key, side, empty, radius, hardness, value, at}; null: the brush is lifted.
  brush: (wanted) => {
    if (!wanted) return endStroke();
    const {setup, layer, key, side, empty, radius, hardness, value, at} = wanted;
    if (!brushing) {
      const refused = result(call('BeginMap', setup, layer, key, side, empty));
      if (refused) return postMessage({fault: refused});
      const name = mapName(setup, layer, key), path = result(call('PathOf', setup, name));
      brushing = {setup, layer, key, name, path, at, before: stateOf(setup, [path])};
    }
    const ring = exported.PaintMap(...brushing.at, ...at, radius, hardness, value);
    postMessage({brushed: {at, ring}});
    brushing.stale ||= ring > 0 || brushing.ring > 0;
    Object.assign(brushing, {at, ring});
    // As often as it takes a third of the time.
    if (brushing.stale && performance.now() - baked_ms > 2 * bake_ms + 100) bakeMap();
  },
  save: (setup) => {
    const text = result(exported.SetupText(setup));
    if (!text) return postMessage({fault: 'This fur was read as a groom: there is no setup to save.'});
    const {file, maps, digest} = JSON.parse(result(exported.DescribeFiles(setup)));
    const files = {[file]: encoder.encode(text)}, outside = [];
    for (const {name, path} of maps) {
      if (/^\/|^[a-z]:|\\|(^|\/)\.\.(\/|$)/i.test(name)) outside.push(name);
      else files[name] = fileAt(path);
    }
    postMessage({saved: {file, files, digest, outside}});
  },
  // {setup, text, files}: by their names in the setup's folder.
  load: ({setup, text, files}) => {
    const given = Object.fromEntries(Object.entries(files).map(([name, content]) => [result(call('PathOf', setup, name)), content]));
    edit(setup, '', () => {
      for (const [path, content] of Object.entries(given)) call('GiveFile', path, content);
      call('ReplaceSetup', setup, text);
    }, [], given);
    kept.maps = {};  // what was loaded may use their names otherwise
    postMessage({keys: kept.keys});
    describe();
    if (!playing) handlers.step(1);
  },
});
