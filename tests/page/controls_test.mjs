// What a user changes on the page of `pelt view`, in headless Chromium: node controls_test.mjs PELT CHROMIUM WORK_DIR
//
// Every key of every layer by its control, setups of many characters, and fingers. Exit code 77: no module.
import fs from 'node:fs';
import {PageTests, click, differing, frame, pixels, set, settled, step, textOf, verdict} from './shown_page.mjs';

const tests = new PageTests();
const check = tests.check.bind(tests);
const kTiny = tests.write('tiny');

// In the page: sets each control of a layer to another value, runs so many frames from the first one on, and puts it
// back. Returns {key, text, to, digest, fault} of each, and last the digest of what was put back.
const kTryLayer = `async (layer, frames) => {
  const digestOfRun = () => new Promise((done) => {
    const before = worker.onmessage;
    worker.onmessage = (event) => {
      before(event);
      if (event.data.frame?.frame !== frames - 1) return;
      worker.onmessage = before;
      done(event.data.frame.run_digest);
    };
    tell({restart: frames});
  });
  const own = setups[0], number = described.setups[0].layers.findIndex(({name}) => name === layer);
  const inputOf = (key) => document.querySelector('[data-key="' + layer + '.' + key + '"] :is(input[type=number], input[type=checkbox], input[type=color], select)');
  const other = (input) => {
    if (input.type === 'checkbox') return !input.checked;
    if (input.type === 'color') return input.value === '#3377aa' ? '#aa7733' : '#3377aa';
    if (input.type !== 'number') return input.options[(input.selectedIndex + 1) % input.options.length].value;
    const [low, high, now] = [input.min, input.max || 1000, input.value].map(Number);
    // Half as much again, within the bounds; so that what is a count stays small.
    const step = Math.max(Math.abs(now) / 2, Math.min((high - low) / 4, input.step === '1' ? 1 : Infinity));
    const to = now + step <= high ? now + step : now - step;
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
    const from = input.type === 'checkbox' ? input.checked : input.value, to = other(input);
    showFault('');
    put(key, to);
    const digest = await digestOfRun();
    found.push({key, text, to, digest, fault: $('fault').hidden ? '' : $('fault').textContent});
    // A colour that the setup does not say is the mesh's own, which none of a control is.
    if (input.type === 'color') tell({setup: [own, 0]});
    else if (!found.at(-1).fault) put(key, from);
  }
  return {found, back: await digestOfRun()};
}`;

// What a key's text says before its colon: where alone it acts.
const kModes = ['pbd', 'verlet', 'modal', 'shells', 'soaked', 'lit'];
function actsIn(text, layer) {
  const said = /^([a-z, ]+): /.exec(text)?.[1].split(', ').filter((word) => kModes.includes(word)) ?? [];
  return said.length === 0 || said.includes(layer.solver) || (said.includes('soaked') && layer.wet);
}

async function keys() {
  // Frames run without WebGL, too, and sooner.
  const page = await tests.launch('--disable-gpu', '--disable-software-rasterizer').open(`file://${kTiny}?still`, 1000, 800);
  await page.until('document.body.dataset.opened', 'opening');
  check((await textOf(page, 'fault')).includes('no WebGL2'), `without WebGL the page says so (${await textOf(page, 'fault')})`);
  const kFrames = 14;  // of rain from the eighth on
  await settled(page, {restart: kFrames});
  check(await verdict(page) === 'same', 'and runs the native frames');
  const own = await page.evaluate('document.body.dataset.digest');
  const layers = await page.evaluate('described.setups[0].layers.map(({name}) => name)');
  const keyCount = await page.evaluate('described.keys.length');
  for (const name of layers) {
    const solver = JSON.parse(await page.evaluate(`described.setups[0].layers.find(({name}) => name === '${name}').values[described.keys.findIndex(({key}) => key === 'solver')]`));
    const {found, back} = await page.evaluate(`(${kTryLayer})('${name}', ${kFrames})`);
    const idle = [], odd = [], refused = [];
    for (const {key, text, to, digest, fault} of found) {
      if (fault) refused.push(`${key} = ${to}: ${fault}`);
      else if (actsIn(text, {solver, wet: true}) && digest === own) idle.push(`${key} = ${to}`);
      else if (!actsIn(text, {solver, wet: true}) && digest !== own) odd.push(`${key} = ${to}`);
    }
    console.log(JSON.stringify({name, solver, idle, odd, refused, keyCount, n: found.length}, null, 1));
    check(back === own, `layer ${name}: ${found.length} keys, and each can be put back`);
  }
  tests.noErrors(page);
}

// A finger, or two, as a touch screen tells of them: places in shares of the canvas.
async function touches(page, ...steps) {
  const at = await page.evaluate(`(({x, y, width, height}) => [x, y, width, height])(document.getElementById('picture').getBoundingClientRect())`);
  const send = (type, places) => page.send('Input.dispatchTouchEvent', {type, touchPoints: places.map(([x, y], id) => ({x: at[0] + x * at[2], y: at[1] + y * at[3], id}))});
  await send('touchStart', steps[0]);
  for (const places of steps.slice(1)) await send('touchMove', places);
  await send('touchEnd', []);
  await settled(page);
  return page.evaluate('changes.camera && orbit');
}

async function fingers() {
  const page = await tests.open(kTiny);
  await page.send('Emulation.setTouchEmulationEnabled', {enabled: true, maxTouchPoints: 2});
  const start = await page.evaluate('firstOrbit'), seen = await pixels(page);
  const turned = await touches(page, [[0.5, 0.5]], [[0.55, 0.5]], [[0.6, 0.55]]);
  check(Math.abs(turned.yaw - start.yaw + 0.4) < 0.02 && Math.abs(turned.elevation - start.elevation - 0.1) < 0.02 && turned.distance === start.distance,
    `one finger turns the camera (by ${(turned.yaw - start.yaw).toFixed(2)} and ${(turned.elevation - start.elevation).toFixed(2)} rad)`);
  check(differing(seen, await pixels(page)) > 1000 && await page.evaluate('document.body.dataset.frame') === '0', 'at once, and no frame has run for that');
  const near = await touches(page, [[0.45, 0.5], [0.55, 0.5]], [[0.4, 0.5], [0.6, 0.5]], [[0.35, 0.5], [0.65, 0.5]]);
  check(Math.abs(near.distance * 3 / turned.distance - 1) < 0.02 && near.yaw === turned.yaw, `two that part go nearer (${turned.distance.toFixed(2)} to ${near.distance.toFixed(2)} m)`);
  const moved = await touches(page, [[0.4, 0.5], [0.6, 0.5]], [[0.45, 0.6], [0.65, 0.6]], [[0.5, 0.7], [0.7, 0.7]]);
  const by = Math.hypot(...moved.target.map((v, i) => v - near.target[i]));
  check(Math.abs(moved.distance / near.distance - 1) < 0.02 && moved.target[1] > near.target[1] && by > 0.05, `two that go on together move it (${by.toFixed(2)} m)`);

  // The first stroke makes another scene, of lit layers: one without paint is what the next is held against.
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
  const page = await tests.openAt(`file://${tests.write('cast', 4)}`, 'still&width=64&height=48');
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
  const again = await tests.browser.open(link, 1000, 800);
  await again.until("setups[16]?.includes('weight = 4.0')", 'a link');
  check(true, 'a link has it');
  await click(page, 'reset');
  await frame(page, 0);
  await step(page, 3);
  check(await verdict(page) === 'same' && await page.evaluate('setups[16]') === own, 'reset takes it back');
  tests.noErrors(page, again);
}

await tests.end([keys, fingers, cast]);
