'use strict';
const $ = (id) => document.getElementById(id);
const given = JSON.parse($('given').textContent);
const canvas = $('picture');
let described, setups = [], orbit = null, firstOrbit = null, playing = false, stroke = null;
// What differs from the page as it was opened; a link holds it.
let changes = {settings: {}, keys: [], camera: null};

// ---- The worker -----------------------------------------------------------------------------------------------------

const worker = new Worker(URL.createObjectURL(new Blob([$('worker').textContent], {type: 'text/javascript'})));
const tell = (message, moved = []) => worker.postMessage(message, moved);

// `part`: 'module', or 'plain', which has no vectors.
async function moduleBytes(part) {
  const packed = Uint8Array.from(atob($(part).textContent.trim()), (c) => c.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('gzip'));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

// How finely the canvas is drawn: `samples` a side of each pixel; a link or a test may ask for its own size.
const wanted = new URLSearchParams(location.search);
function pictureSize() {
  const samples = Number(wanted.get('samples') ?? 1);
  if (wanted.has('width')) return [Number(wanted.get('width')), Number(wanted.get('height')), samples];
  const scale = Math.min(devicePixelRatio, 2);
  return [Math.max(16, Math.round(canvas.clientWidth * scale)), Math.max(16, Math.round(canvas.clientHeight * scale)), samples];
}

async function open() {
  // {} has the bytes of one vector instruction: a browser that takes none runs the module without.
  const vectors = WebAssembly.validate(new Uint8Array([0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11]));
  const plain = !vectors || wanted.has('plain');
  if (plain) showFault('This browser has no WebAssembly vectors (SIMD): frames run on the reference kernels, and take longer.');
  if (!canvas.transferControlToOffscreen) return showFault('This browser cannot draw from a worker (OffscreenCanvas): take one of 2023 or later.');
  const files = Object.fromEntries(Object.entries(given.files ?? {}).map(([path, text]) => [path, Uint8Array.from(atob(text), (c) => c.charCodeAt(0))]));
  const offscreen = canvas.transferControlToOffscreen();
  const module = await moduleBytes(plain ? 'plain' : 'module');
  const recording = given.recording ? {name: given.recording, bytes: files[given.recording]} : null;
  tell({open: {module, canvas: offscreen, request: {text: given.request, files: recording ? {} : files, recording, compared: given.native.digests.length}, size: pictureSize()}}, [offscreen, module.buffer]);
}

worker.onmessage = ({data}) => {
  if (data.replaced) forget();
  if (data.paused) showPlaying(false);
  if (data.described) show(data);
  if (data.setups) Object.assign(setups, data.setups);
  takeGroom(data);
  if (data.frame) showFrame(data);
  if (data.fault !== undefined) showFault(data.dead ? `${data.fault}\nReload the page.` : data.fault);
  if (data.opened) {
    document.body.dataset.opened = Math.round(performance.now());
    takeLink();
    if (!matchMedia('(prefers-reduced-motion: reduce)').matches && !wanted.has('still')) play(true);
  }
};
worker.onerror = (event) => showFault(event.message);

function showFault(text) {
  $('fault').textContent = text;
  $('fault').hidden = !text;
}

// ---- What is known of the scene -------------------------------------------------------------------------------------

function show(data) {
  described = data.described;
  if (data.renderer && $('fault').hidden) showFault(data.renderer);
  $('name').textContent = described.name;
  $('about').textContent = `${described.strands.toLocaleString('en')} strands on ${described.characters} character${described.characters > 1 ? 's' : ''}`;
  showRecording(described.recording);
  firstOrbit ??= described.camera;
  makeControls();
  fillPlan();
  showView(described.settings.find((row) => row.key === 'show').value);
}

// Of a recording there is nothing to change: what would is not shown.
function showRecording(recording) {
  if (recording) $('about').textContent += `, ${described.frames} frames recorded in ${recording.file}${recording.note ? ` (${recording.note})` : ''}; ${described.notes.join('; ')}`;
  document.body.dataset.recording = recording?.file ?? '';
  $('own-camera').textContent = recording ? "Recording's camera" : "Scene's camera";
  $('toml').hidden = Boolean(recording);
  for (const option of $('tool').options) option.hidden = option.disabled = Boolean(recording) && !['turn', 'pan'].includes(option.value);
  if ($('tool').selectedOptions[0]?.disabled) $('tool').value = 'turn';
}

// ---- A frame --------------------------------------------------------------------------------------------------------

// Digests of runs of the program that wrote this page: of the first frames, as it prints them.
function digestText(frame) {
  if (frame.recorded) return recordedText(frame);
  const last = document.body.dataset.verdict ?? '';
  const native = given.native;
  const at = frame.frame, known = native.digests[at];
  if (!last && !frame.run_digest) return [`frame ${at}${native.digests.length ? `; "Restart" compares the first ${native.digests.length}` : ''}`, ''];
  if (!frame.run_digest || !known) return [`frame ${at}; the first ${native.digests.length} were compared${last ? ` and were ${last === 'same' ? 'the same' : 'others'}` : ''}`, last];
  const ours = `frame ${at}: digest ${frame.run_digest}`;
  if (known === frame.run_digest) return [`${ours}: the same as ${native.command.replace('FRAMES', at + 1)}`, 'same'];
  const changed = changes.camera || changes.keys.length || Object.keys(changes.settings).length || stroke;
  return [`${ours}: other than ${known} of the native run${changed ? ', as something was changed here ("Reset all" takes it back)' : ''}`, 'other'];
}

// Of a recording: each frame's own beside what was recorded with it.
function recordedText(frame) {
  const ours = `frame ${frame.frame} of ${described.frames}: digest ${frame.digest}`;
  const unused = frame.refused_pose ? `; not used, ${frame.refused_pose}` : '';
  if (!frame.others) return [`${ours}: the same as recorded, and so was every frame before${unused}`, 'same'];
  const here = frame.digest === frame.recorded ? 'the same as recorded' : `other than ${frame.recorded}, which was recorded`;
  return [`${ours}: ${here}; the first frame of other bits is ${frame.first_other}${unused}`, 'other'];
}

// ---- What stages computed, one after the other ----------------------------------------------------------------------

function showView(number) {
  const view = described.views[number];
  $('caption').hidden = number === 0;
  $('view').textContent = `${number} of ${described.views.length - 1}: ${view.name}. ${view.text}`;
  // A recording has no names.
  for (const joint of ['joints', 'weights'].includes(view.name) ? described.joints ?? [] : []) {
    const name = document.createElement('span');
    name.textContent = ` ${joint.name}`;
    name.style.color = joint.colour;
    $('view').append(name);
  }
}
function turnPage(by) {
  const select = $('controls').querySelector('[data-key=show] select');
  select.value = (Number(select.value) + by + described.views.length) % described.views.length;
  select.onchange();
}
$('tour').onclick = $('forth').onclick = () => turnPage(1);
$('back').onclick = () => turnPage(-1);
$('leave').onclick = () => {
  const select = $('controls').querySelector('[data-key=show] select');
  select.value = 0;
  select.onchange();
};

function fillPlan() {
  const kb = (bytes) => (bytes / 1024).toFixed(1);
  $('plan').tBodies[0].replaceChildren(...described.passes.map((pass) => {
    const row = document.createElement('tr');
    for (const cell of [pass.domain, pass.items, kb(pass.resident_bytes), kb(pass.get_bytes), kb(pass.put_bytes), pass.stages.join(', ')]) row.append(element('td', {textContent: cell}));
    return row;
  }));
}

function showFrame({frame, draw_ms, pages}) {
  if (frame.camera) firstOrbit = frame.camera;
  showCosts(frame.layer_ns);
  const [text, kind] = digestText(frame);
  $('digest').textContent = text;
  $('digest').className = kind;
  document.body.dataset.frame = frame.frame;
  document.body.dataset.ms = frame.ms;
  document.body.dataset.digest = frame.run_digest;
  document.body.dataset.verdict = kind;
  document.body.dataset.memory = pages;
  $('budget').firstElementChild.style.width = `${Math.min(frame.ms * 10, 100)}%`;
  $('times').textContent = `${frame.ms.toFixed(1)} ms for a frame (lines: 5 and 8 ms), ${draw_ms.toFixed(0)} ms to draw; ${frame.drawn.toLocaleString('en')} of ${frame.live.toLocaleString('en')} strands drawn`;
  if (!$('stages').closest('details').open) return;
  $('stages').tBodies[0].replaceChildren(...frame.stages.map((stage) => {
    const row = document.createElement('tr');
    for (const cell of [stage.name, stage.ms.toFixed(2), stage.ran, stage.of]) row.append(element('td', {textContent: cell}));
    return row;
  }));
}

// ---- Buttons, mouse and keys ----------------------------------------------------------------------------------------

function showPlaying(on) {
  playing = on;
  $('play').textContent = on ? 'Pause' : 'Play';
  $('play').setAttribute('aria-pressed', String(on));
}
function play(on) {
  showPlaying(on);
  tell({play: on});
}
$('play').onclick = () => play(!playing);
$('step').onclick = () => {
  play(false);
  tell({step: 1});
};
$('restart').onclick = () => tell({restart: 1});
function forget() {
  changes = {settings: {}, keys: [], camera: null};
  orbit = firstOrbit = null;
  stroke = null;
  delete document.body.dataset.verdict;
  showFault('');
  $('controls').replaceChildren();
  remember();
}
$('reset').onclick = () => {
  forget();
  tell({reset: true});
};
$('own-camera').onclick = () => {
  orbit = changes.camera = null;
  tell({camera: null});
  remember();
};

function moveCamera(change) {
  orbit ??= {...firstOrbit, target: [...firstOrbit.target]};
  change(orbit);
  orbit.elevation = Math.max(-1.45, Math.min(1.45, orbit.elevation));
  orbit.distance = Math.max(0.1, Math.min(100, orbit.distance));
  changes.camera = [...orbit.target, orbit.yaw, orbit.elevation, orbit.distance];
  tell({camera: changes.camera});
  remember();
}
const zoom = (factor) => moveCamera((o) => { o.distance *= factor; });
const turn = (yaw, elevation) => moveCamera((o) => {
  o.yaw += yaw;
  o.elevation += elevation;
});
function pan(dx, dy) {
  moveCamera((o) => {
    const far = o.distance * 0.8;
    o.target[0] -= far * dx * Math.cos(o.yaw);
    o.target[2] += far * dx * Math.sin(o.yaw);
    o.target[1] += far * dy;
  });
}

const kTools = [['turn', 'turn the camera'], ['pan', 'move the camera'], ['sphere', 'move a ball through the fur']];
function fillTools() {
  for (const [value, textContent] of kTools) $('tool').append(element('option', {value, textContent}));
  for (const [i, name] of ['mud', 'snow', 'wet', 'dust'].entries()) $('tool').append(element('option', {value: `paint ${i}`, textContent: `paint ${name}`}));
}
fillTools();

const pointers = new Map();
const shareOf = (event) => [event.offsetX / canvas.clientWidth, event.offsetY / canvas.clientHeight];
const lift = () => {
  if ($('tool').value.startsWith('paint')) tell({paint: null});
  endGroom();
};
canvas.onpointerdown = (event) => {
  canvas.setPointerCapture(event.pointerId);
  pointers.set(event.pointerId, shareOf(event));
  if (pointers.size === 1) act(event, 0, 0, true);
  else lift();
};
canvas.onpointermove = (event) => {
  const last = pointers.get(event.pointerId);
  if (!last) return;
  const now = shareOf(event);
  pointers.set(event.pointerId, now);
  const by = [now[0] - last[0], now[1] - last[1]];
  if (pointers.size === 1) return act(event, ...by);
  if (pointers.size > 2) return;
  // Two fingers: what is below them stays there.
  const [other] = [...pointers].filter(([id]) => id !== event.pointerId).map(([, at]) => at);
  const apart = (at) => Math.hypot((at[0] - other[0]) * canvas.clientWidth, (at[1] - other[1]) * canvas.clientHeight);
  if (apart(last) > 0 && apart(now) > 0) zoom(apart(last) / apart(now));
  pan(by[0] / 2, by[1] / 2);
};
canvas.onpointerup = canvas.onpointercancel = (event) => {
  pointers.delete(event.pointerId);
  lift();
};
function act(event, dx, dy, down = false) {
  const tool = event.shiftKey ? 'pan' : $('tool').value;
  const [x, y] = shareOf(event);
  if (isGroomTool(tool)) groom(tool, [x, y], down);
  if (tool === 'turn' && (dx || dy)) turn(-4 * dx, 2 * dy);
  if (tool === 'pan' && (dx || dy)) pan(dx, dy);
  if (tool === 'sphere') {
    if (!changes.settings.sphere_radius) {
      changes.settings.sphere_radius = 0.08;
      tell({set: ['sphere_radius', 0.08]});
    }
    tell({sphere: [x, y]});
  }
  if (tool.startsWith('paint')) {
    stroke = true;
    tell({paint: [Number(tool.slice(6)), x, y]});
  }
}
canvas.addEventListener('wheel', (event) => {
  event.preventDefault();
  zoom(Math.exp(event.deltaY * 0.001));
}, {passive: false});
canvas.onkeydown = (event) => {
  if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === 'z') $(event.shiftKey ? 'redo' : 'undo').click();
  const keys = {Delete: () => $('comb-drop').click(), ArrowLeft: () => turn(0.1, 0), ArrowRight: () => turn(-0.1, 0), ArrowUp: () => turn(0, 0.1), ArrowDown: () => turn(0, -0.1),
    '+': () => zoom(0.9), '-': () => zoom(1.1), ' ': () => play(!playing), '.': () => $('step').click()};
  if (!keys[event.key]) return;
  event.preventDefault();
  keys[event.key]();
};
new ResizeObserver(() => described && tell({size: pictureSize()})).observe(canvas);

// ---- Links and setups -----------------------------------------------------------------------------------------------

const remember = () => {
  const any = changes.camera || changes.keys.length || Object.keys(changes.settings).length;
  history.replaceState(null, '', any ? `#${encodeURIComponent(JSON.stringify(changes))}` : location.pathname + location.search);
};

function takeLink() {
  if (location.hash.length < 2) return;
  let link;
  try {
    link = JSON.parse(decodeURIComponent(location.hash.slice(1)));
    // Links of before there was more than one setup have no number.
    for (const change of link.keys ?? []) {
      change[3] ??= 0;
      if (change.length !== 4 || !change.slice(0, 3).every((v) => typeof v === 'string') || !Number.isInteger(change[3])) throw new Error('keys');
    }
  } catch (error) {
    return showFault(`The link's settings cannot be read: ${error.message}`);
  }
  changes = {settings: link.settings ?? {}, keys: link.keys ?? [], camera: link.camera ?? null};
  for (const [key, value] of Object.entries(changes.settings)) tell({set: [key, Number(value)]});
  for (const change of changes.keys) tell({key: change});
  if (changes.camera) tell({camera: changes.camera.map(Number)});
  tell({describe: true});
}

async function copy(text, what) {
  $('setup').hidden = true;
  try {
    await navigator.clipboard.writeText(text);
    $('copied').textContent = `${what} copied`;
  } catch {  // a page that was opened as a file may not
    $('setup').value = text;
    $('setup').hidden = false;
    $('setup').select();
    $('copied').textContent = `${what} is below, to be copied`;
  }
}
$('share').onclick = () => copy(location.href, 'link');
$('toml').onclick = () => (setups[shownSetup] ? copy(setups[shownSetup], 'setup') : showFault('This fur was read as a groom: there is no setup to copy.'));

document.addEventListener('dragover', (event) => event.preventDefault());
document.addEventListener('drop', async (event) => {
  event.preventDefault();
  const files = [...event.dataTransfer.files], file = files[0];
  if (!file) return;
  if (file.name.endsWith('.peltinput')) {
    showFault('');
    return tell({recording: {name: file.name, bytes: new Uint8Array(await file.arrayBuffer())}});
  }
  if (!files.some(({name}) => /\.(toml|zip)$/i.test(name)))
    return showFault(`${file.name}: a setup (.toml) with its maps, a .zip of them or a recording (.peltinput) can be dropped here`);
  if (described?.recording) return showFault(`${file.name}: a recording has no setup that could be another`);
  await loadFiles(files);
});

open().catch((error) => showFault(String(error)));
