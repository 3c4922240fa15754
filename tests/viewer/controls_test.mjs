// What a user changes on the page of `pelt view`, in headless Chromium: node controls_test.mjs PELT CHROMIUM WORK_DIR
//
// Every key of every layer by its control, setups of many characters, and fingers. Exit code 77: no module.
import fs from 'node:fs';
import {PageTests, click, differing, frame, pixels, set, settled, step, textOf, touch, verdict} from './shown_page.mjs';

const tests = new PageTests();
const check = tests.check.bind(tests);
const kTiny = tests.write('tiny');

// In the page: sets each control of a layer to another value, runs so many frames from the first one on, and puts it
// back. Returns {key, text, to, digest, fault} of each, and last the digest of what was put back.
const kTryLayer = `async (layer, frames) => {
  let fault = '';
  const digestOfRun = () => new Promise((done) => {
    const before = worker.onmessage;
    worker.onmessage = (event) => {
      before(event);
      fault = event.data.fault ?? fault;
      if (event.data.token !== 'run') return;
      worker.onmessage = before;
      done(document.body.dataset.digest);
    };
    tell({restart: frames});
    tell({token: 'run'});
  });
  const own = setups[0], number = described.setups[0].layers.findIndex(({name}) => name === layer);
  const inputOf = (key) => document.querySelector('[data-key="' + layer + '.' + key + '"] :is(input[type=number], input[type=checkbox], input[type=color], select)');
  // What half as much again would not be far enough from, or nowhere.
  const far = {inertia_speed: () => 0.1, sort_bias: (now) => (now > 0 ? -20 : 20), quality: (now) => (now === 'best' ? 'fast' : 'best')};
  const other = (key, input) => {
    if (far[key]) return far[key](input.value);
    if (input.type === 'checkbox') return !input.checked;
    if (input.type === 'color') return input.value === '#3377aa' ? '#aa7733' : '#3377aa';
    if (input.type !== 'number') return input.options[(input.selectedIndex + 1) % input.options.length].value;
    const [low, high, now] = [input.min, input.max || 1000, input.value].map(Number);
    // Half as much again, within the bounds; so that what is a count stays small.
    const step = Math.max(Math.abs(now) / 2, Math.min((high - low) / 4, input.step === '1' ? 1 : Infinity));
    const to = now + step <= high ? now + step : now - step >= low ? now - step : now < high ? high : low;
    return input.step === '1' ? Math.round(to) : Number(to.toPrecision(4));
  };
  const put = (key, value) => {
    const input = inputOf(key);
    input[input.type === 'checkbox' ? 'checked' : 'value'] = value;
    input.onchange();
  };
  const found = [];
  for (const {key, text} of described.keys) {
    const input = inputOf(key);
    if (!input) continue;
    const from = input.type === 'checkbox' ? input.checked : input.value, to = other(key, input);
    fault = '';
    put(key, to);
    const digest = await digestOfRun();
    found.push({key, text, to, digest, fault});
    // A colour that the setup does not say is the mesh's own, which none of a control is.
    if (input.type === 'color') tell({load: {setup: 0, text: own, files: {}}});
    else if (!fault) put(key, from);
  }
  return {found, back: await digestOfRun()};
}`;

// What a key's text says before its colon: where alone it acts. The scene has weather.
const kModes = ['pbd', 'verlet', 'modal', 'shells', 'lit'];
const isOfMode = (text, mode) => {
  const said = /^([a-z, ]+): /.exec(text)?.[1].split(', ').filter((word) => kModes.includes(word)) ?? [];
  return said.length === 0 || said.includes(mode);
};
// How many strands there are says max_strands, and density where they are thicker.
const kEither = new Set(['density']);
// Where besides a key changes nothing in this scene, by the layer's values.
const hasItsFrequency = (v) => v.solver === 'modal' && v.frequency > 0;
const kIdle = {
  twist: (v) => v.curl === 0,
  curl_follows: (v) => v.curl === 0,
  comb_normal_weight: () => true,  // there are no comb vectors
  shadow_share: () => true,  // is what shadow passes draw
  bounce: (v) => v.solver === 'modal' && v.points === 5,  // whose tips meet the soft skin too slowly
  tip_width: (v) => v.output === 'instances',  // whose shader does it
  backface_tolerance: (v) => !v.backface_cull,
  angular_hardness_middle: (v) => v.solver === 'verlet' || hasItsFrequency(v),
  angular_hardness_end: (v) => v.solver === 'verlet' || hasItsFrequency(v),
};
function acts({key, text}, values) {
  // Where no frequency is said, it is worked out from these too.
  if (key === 'iterations' && values.solver === 'modal') return !hasItsFrequency(values);
  return isOfMode(text, values.solver) && !kIdle[key]?.(values);
}

// Without WebGL frames run, too, and sooner.
let blind;
async function openBlind(file) {
  blind ??= tests.launch('--disable-gpu', '--disable-software-rasterizer');
  const page = await blind.open(`file://${file}?still`, 1000, 800);
  await page.until('document.body.dataset.opened', 'opening');
  return page;
}

async function keys() {
  const page = await openBlind(kTiny);
  check((await textOf(page, 'fault')).includes('no WebGL2'), `without WebGL the page says so (${await textOf(page, 'fault')})`);
  const kFrames = 14;  // of rain from the eighth on
  await settled(page, {restart: kFrames});
  check(await verdict(page) === 'same', 'and runs the native frames');
  const own = await page.evaluate('document.body.dataset.digest');
  const layers = await page.evaluate(`described.setups[0].layers.map(({name, values}) => ({name, values: Object.fromEntries(values.flatMap((value, i) => {
    try { return [[described.keys[i].key, JSON.parse(value)]]; } catch { return []; }
  }))}))`);
  for (const {name, values} of layers) {
    const {found, back} = await page.evaluate(`(${kTryLayer})('${name}', ${kFrames})`);
    const wrong = found.filter((tried) => !tried.fault && !kEither.has(tried.key) && acts(tried, values) !== (tried.digest !== own)).map(({key, to}) => `${key} = ${to}`);
    check(found.length > 60 && wrong.length === 0, `layer ${name}: each of ${found.length} keys changes bits where it acts, and there alone ${wrong.join(', ')}`);
    const untold = found.filter(({key, fault}) => fault && !fault.includes(`layer '${name}': key '`)).map(({key, fault}) => `${key}: ${fault}`);
    check(untold.length === 0, `what the layer cannot be (${found.filter(({fault}) => fault).map(({key}) => key).join(', ')}) is reported with its reason ${untold.join('; ')}`);
    check(back === own, 'and each can be put back');
  }
  // The one that artists ask for first.
  await set(page, 'strand5.stiffness', 0.6);
  await settled(page, {restart: kFrames});
  check(await verdict(page) === 'other', 'stiffness changes bits');
  await click(page, 'reset');
  await settled(page, {step: kFrames - 1});
  check(await verdict(page) === 'same' && await page.evaluate('document.body.dataset.digest') === own, 'and "Reset all" takes it back');
  tests.noErrors(page);
}

async function touches(page, ...steps) {
  await touch(page, ...steps);
  return page.evaluate('changes.camera && orbit');
}

async function fingers() {
  const page = await tests.open(kTiny);
  await page.send('Emulation.setTouchEmulationEnabled', {enabled: true, maxTouchPoints: 2});
  const start = await page.evaluate('firstOrbit'), seen = await pixels(page);
  // The canvas is as high as what is below leaves it: how far down a finger goes is known but roughly.
  const turned = await touches(page, [[0.5, 0.5]], [[0.55, 0.5]], [[0.6, 0.55]]);
  check(Math.abs(turned.yaw - start.yaw + 0.4) < 0.02 && turned.elevation > start.elevation + 0.03 && turned.distance === start.distance,
    `one finger turns the camera (by ${(turned.yaw - start.yaw).toFixed(2)} and ${(turned.elevation - start.elevation).toFixed(2)} rad)`);
  check(differing(seen, await pixels(page)) > 1000 && await page.evaluate('document.body.dataset.frame') === '0', 'at once, and no frame has run for that');
  const near = await touches(page, [[0.45, 0.5], [0.55, 0.5]], [[0.4, 0.5], [0.6, 0.5]], [[0.35, 0.5], [0.65, 0.5]]);
  check(Math.abs(near.distance * 3 / turned.distance - 1) < 0.02 && near.yaw === turned.yaw, `two that part go nearer (${turned.distance.toFixed(2)} to ${near.distance.toFixed(2)} m)`);
  const moved = await touches(page, [[0.4, 0.5], [0.6, 0.5]], [[0.45, 0.6], [0.65, 0.6]], [[0.5, 0.7], [0.7, 0.7]]);
  const by = Math.hypot(...moved.target.map((v, i) => v - near.target[i]));
  check(Math.abs(moved.distance / near.distance - 1) < 0.02 && moved.target[1] > near.target[1] && by > 0.05, `two that go on together move it (${by.toFixed(2)} m)`);

  // The first stroke makes another scene, of lit layers: the next picture is compared with one without paint.
  await set(page, 'brush_radius', 0.3);
  await settled(page, {camera: null});
  await page.evaluate("document.getElementById('tool').value = 'paint 1'");
  const painted = async (amount) => {
    await set(page, 'brush_amount', amount);
    await settled(page, {restart: 1});
    await touches(page, [[0.5, 0.5]]);
    await step(page, 4);
    return pixels(page);
  };
  await painted(0);
  const bare = await painted(0), snowy = await painted(1);
  const whiter = snowy.filter((v, i) => i % 4 !== 3 && v > bare[i] + 40).length;
  check(whiter > 1500, `a finger paints snow (${whiter} values are brighter)`);
  tests.noErrors(page);
}

// Setups that the scene makes itself, one for each character.
async function cast() {
  const page = await openBlind(tests.write('cast', 4));
  await settled(page, {restart: 4});
  check(await verdict(page) === 'same', 'cast: 4 frames are the same as the native ones');
  const groups = () => page.evaluate("[...document.querySelectorAll('#controls details')].map((group) => group.dataset.group).filter((name) => name.startsWith('layer')).length");
  check(await page.evaluate('described.setups.length') === 17 && await groups() === 10, `17 setups, and the layers of one of them (${await groups()})`);
  await set(page, 'setup', 16);
  check(await groups() === 9, 'of any');
  const own = await page.evaluate('setups[16]'), layer = await page.evaluate('described.setups[16].layers[1].name');
  await set(page, `${layer}.weight`, 4);
  await settled(page, {restart: 4});
  check(await verdict(page) === 'other', 'a key of its layers changes bits');
  const copied = await page.evaluate('setups[16]');
  check(copied !== own && copied.includes('weight = 4.0') && await page.evaluate('setups[3]') !== own, 'and its setup alone');
  fs.writeFileSync(tests.file('copied.toml'), copied);
  check(tests.run('run', '--character', 'builtin', '--setup', './copied.toml', '--frames', '1').includes('digest'), 'which pelt takes');
  const link = await page.evaluate('location.href');
  const again = await blind.open(link, 1000, 800);
  await again.until("setups[16]?.includes('weight = 4.0')", 'a link');
  check(true, 'a link has it');
  await click(page, 'reset');
  await frame(page, 0);
  await step(page, 3);
  check(await verdict(page) === 'same' && await page.evaluate('setups[16]') === own, 'reset takes it back');
  tests.noErrors(page, again);
}

await tests.end([keys, fingers, cast]);
