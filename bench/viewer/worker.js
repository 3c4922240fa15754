'use strict';
// Runs the module: simulates, draws, and reports to the page. Of messages, each is {name: arguments}.
let exported, renderer = '', canvas, gl, api, compiled, request, playing = false, due_s = 0, last_ms = 0, dirty = true;
let size = [640, 480, 1], slow_motion = 1, dt_s = 1 / 60, drawn_ms = 0, stdout = '', paint = null;
// What was set since the page opened, for a module that has to begin again; and the recording that is shown, {name, bytes}.
let kept = {settings: {}, camera: null};
const asOpened = () => ({settings: {}, camera: null, setups: [], keys: [], files: {}, maps: {}, recording: request.recording ?? null});

const decoder = new TextDecoder(), encoder = new TextEncoder();
const memory = () => exported.memory;
const bytes = (at, count) => new Uint8Array(memory().buffer, at, count);
const result = (at) => (at ? decoder.decode(bytes(at, exported.TextSize())) : null);

// Calls an export; texts among the arguments become a pointer and a size.
function call(name, ...values) {
  const given = [], blocks = [];
  for (const value of values) {
    if (typeof value === 'number') {
      given.push(value);
      continue;
    }
    const data = typeof value === 'string' ? encoder.encode(value) : value;
    const at = exported.Allocate(data.length + 1);
    bytes(at, data.length).set(data);
    blocks.push(at);
    given.push(at, data.length);
  }
  const found = exported[name](...given);
  for (const at of blocks) exported.Free(at);
  return found;
}

// What WASI programs are given here: a clock, standard error, and the end.
const kBad = 8, kNotHere = 52;
const wasi = {
  clock_time_get: (clock, precision, at) => {
    new DataView(memory().buffer).setBigUint64(at, BigInt(Math.round(performance.now() * 1e6)), true);
    return 0;
  },
  environ_get: () => 0,
  environ_sizes_get: (count, total) => {
    const view = new DataView(memory().buffer);
    view.setUint32(count, 0, true);
    view.setUint32(total, 0, true);
    return 0;
  },
  fd_prestat_get: () => kBad,
  fd_write: (fd, list, count, done) => {
    const view = new DataView(memory().buffer);
    let all = 0;
    for (let i = 0; i < count; ++i) {
      const at = view.getUint32(list + 8 * i, true), length = view.getUint32(list + 8 * i + 4, true);
      stdout += decoder.decode(bytes(at, length));
      all += length;
    }
    view.setUint32(done, all, true);
    return 0;
  },
  proc_exit: (code) => {
    throw new Error(`the module ended with ${code}`);
  },
};

// Null, or what is wrong with it.
const openRecording = ({name, bytes: file}) => result(call('OpenRecording', name, file));

// The canvas has its context again, without any of its objects.
function takeContext() {
  api = WebGl(gl, memory);
  renderer = result(exported.OpenRenderer());
  dirty = true;
  postMessage({fault: renderer ?? ''});
  draw();
}

async function start() {
  const env = {};
  gl = canvas?.getContext('webgl2', {antialias: false, alpha: true, premultipliedAlpha: true, preserveDrawingBuffer: true});
  // No module uses the GL objects that the one before it made.
  api?.DeleteAll();
  api = gl && WebGl(gl, memory);
  for (const {module: from, name} of WebAssembly.Module.imports(compiled))
    (env[from] ??= {})[name] = from === 'gl' ? (...numbers) => api[name](...numbers) : wasi[name] ?? (() => kNotHere);
  exported = (await WebAssembly.instantiate(compiled, env)).exports;
  exported._initialize?.();
  for (const [path, content] of Object.entries({...request.files, ...kept.files})) call('GiveFile', path, content);
  if (kept.recording) {
    const refused = openRecording(kept.recording);
    if (refused) throw new Error(refused);
  } else {
    call('Open', `${request.text}\nsetup_texts = ${JSON.stringify(Array.from(kept.setups, (text) => text ?? ''))}`);
    exported.TakeDigests(request.compared);
  }
  renderer = gl ? result(exported.OpenRenderer()) : 'this browser has no WebGL2: frames run, and nothing is drawn';
  for (const [key, value] of Object.entries(kept.settings)) call('Set', key, value);
  if (kept.camera) call('SetCamera', ...kept.camera);
  endDrags();
  describe();
}

const setupTexts = () => Array.from({length: exported.SetupCount()}, (_, i) => result(exported.SetupText(i)));

function describe() {
  const described = JSON.parse(result(exported.Describe()));
  dt_s = described.dt_s;
  postMessage({described, setups: setupTexts(), renderer});
}

function step() {
  if (paint) call('Paint', ...paint);
  const refused = result(exported.Step());
  dirty = true;
  if (!refused) return;
  if (!kept.recording) throw new Error(refused);
  // What a recording says cannot be taken back: it ends there.
  pause();
  postMessage({fault: refused});
}

function pause() {
  playing = false;
  postMessage({paused: true});
}

// How far the display is on its way from the frame before the last one to it.
const share = () => (playing && exported.HasInBetween() ? Math.min(due_s / dt_s, 1) : 1);

function draw() {
  if (!dirty || gl?.isContextLost()) return;
  dirty = false;
  if (renderer) return;
  const start_ms = performance.now();
  if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
  exported.Draw(...size, share());
  drawn_ms = performance.now() - start_ms;
}

function report() {
  const frame = JSON.parse(result(exported.LastFrame()));
  // A recording's frames have their own.
  dt_s = frame.dt_s || dt_s;
  postMessage({frame, draw_ms: drawn_ms, pages: memory().buffer.byteLength});
  if (combing) showCombs();
}

// A module that stopped begins again, with what was set before.
async function guarded(run) {
  try {
    await run();
  } catch (error) {
    const reason = stdout.trim().split('\n').at(-1) || String(error);
    stdout = '';
    postMessage({fault: reason});
    if (!compiled) return;
    // One that was dropped here may be what ended it.
    if (kept.recording !== (request.recording ?? null)) kept = asOpened();
    try {
      await start();
      step();
      draw();
      report();
    } catch (again) {
      postMessage({fault: String(again), dead: true});
    }
  }
}

const next = self.requestAnimationFrame ? (run) => self.requestAnimationFrame(run) : (run) => setTimeout(() => run(performance.now()), 16);
// Messages of the page and frames run one after the other: a module that begins again is left alone until it has.
let queue = Promise.resolve();
const enqueue = (run) => {
  queue = queue.then(() => guarded(run));
};
function loop(now_ms) {
  next((now) => enqueue(() => loop(now)));
  const passed_s = Math.min((now_ms - last_ms) / 1000, 0.1);
  last_ms = now_ms;
  if (playing) {
    due_s += passed_s * slow_motion;
    let stepped = false;
    // No more than the time allows: what is slower than real time becomes slow motion.
    for (let i = 0; playing && due_s >= dt_s && i < 4; ++i, stepped = true) {
      step();
      due_s -= dt_s;
      if (playing && exported.AtEnd()) pause();
    }
    due_s = Math.min(due_s, dt_s);
    if (stepped) return void (draw(), report());
    dirty ||= exported.HasInBetween() !== 0;
  }
  if (!dirty) return;
  draw();
  if (!playing) report();
}

const place = (x, y) => {
  const at = exported.Pick(x, y);
  return at ? Array.from(new Float32Array(memory().buffer, at, 3)) : null;
};

const handlers = {
  open: async ({module, canvas: given, request: wanted, size: first}) => {
    canvas = given;
    canvas?.addEventListener('webglcontextlost', (event) => {
      event.preventDefault();  // or it does not come back
      postMessage({fault: 'The graphics card was taken away; the picture comes back when it does.'});
    });
    canvas?.addEventListener('webglcontextrestored', () => enqueue(takeContext));
    request = wanted;
    size = first;
    kept = asOpened();
    compiled = await WebAssembly.compile(module);
    await start();
    step();
    draw();
    report();
    postMessage({opened: true});
    last_ms = performance.now();
    next((now) => enqueue(() => loop(now)));
  },
  play: (on) => {
    playing = on;
  },
  // As many frames as asked for, drawn once.
  step: (count) => {
    playing = false;
    for (let i = 0; i < count; ++i) step();
    draw();
    report();
  },
  // And so many frames, drawn once.
  restart: (count) => {
    if (!kept.recording) exported.TakeDigests(request.compared);
    exported.Restart();
    for (let i = 0; i < count; ++i) step();
    draw();
    report();
  },
  // Everything as it was when the page was opened.
  reset: async () => {
    kept = asOpened();
    forgetEdits();
    await start();
    handlers.restart(1);
  },
  set: ([key, value]) => {
    call('Set', key, value);
    kept.settings[key] = value;
    if (key === 'slow_motion') slow_motion = value;
    if (key === 'frame_rate') dt_s = 1 / value;
    // Another scene, which shows nothing before its first frame.
    if (key === 'kernels' && !playing) handlers.step(1);
    dirty = true;
  },
  key: (change, label = `${change[3]} ${change[0]} ${change[1]}`) => {
    const [layer, key, value, setup] = change;
    edit(setup, label, () => call('ChangeKey', setup, layer, key, value), keysWith(change));
    postMessage({setups: {[setup]: kept.setups[setup]}});
    if (!playing) handlers.step(1);
  },
  // Files that are other now, and `setup`, where its own is among them; of none only how many digests are known.
  files: ({files, setup, compared}) => {
    request.compared = compared;
    if (kept.recording) return void Object.assign(request.files, files);  // for when it is left
    if (Object.keys(files).length === 0) return;
    const own = setup === undefined ? kept.setups : [];
    Object.assign(request.files, files);
    for (const path of Object.keys(files)) delete kept.files[path];
    if (setup !== undefined) kept.keys = [];
    forgetEdits();
    kept.setups = [];  // a module that has to begin again begins with what the files have
    for (const [path, content] of Object.entries(files)) call('GiveFile', path, content);
    call('ReplaceSetup', 0, setup ?? (own[0] || result(exported.SetupText(0)) || ''));
    kept.setups = own;
    exported.TakeDigests(0);  // a run that began with other files has none to compare
    describe();
    step();
    draw();
    report();
  },
  camera: (camera) => {
    kept.camera = camera;
    if (camera) call('SetCamera', ...camera);
    else exported.TakeScenesCamera();
    dirty = true;
  },
  // A recording in place of what is shown, which goes on where that cannot be.
  recording: (recording) => {
    const refused = openRecording(recording);
    if (refused) return postMessage({fault: refused});
    kept = {...asOpened(), recording};
    forgetEdits();
    slow_motion = 1;
    paint = null;
    postMessage({replaced: true});
    describe();
    step();
    draw();
    report();
  },
  describe: () => describe(),
  // Comes back when all that was said before is done, and drawn: to ask for errors is to wait for that.
  token: (token) => {
    draw();
    if (gl?.getError() && !gl.isContextLost()) throw new Error('WebGL reports an error');
    postMessage({token});
  },
  size: (wanted) => {
    dirty ||= String(size) !== String(wanted);
    size = wanted;
  },
  sphere: ([x, y]) => {
    const at = place(x, y);
    if (at) exported.MoveSphere(...at);
  },
  // Null: the brush is lifted.
  paint: (stroke) => {
    const at = stroke && place(stroke[1], stroke[2]);
    paint = at ? [stroke[0], ...at] : null;
    if (paint && !playing) handlers.step(1);
  },
};

self.onmessage = ({data}) => {
  for (const [name, value] of Object.entries(data)) enqueue(() => handlers[name](value));
};
