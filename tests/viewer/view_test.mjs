// The page of `pelt view` in headless Chromium: node view_test.mjs PELT CHROMIUM WORK_DIR
//
// Its digests are the program's, its picture is that of the headless OpenGL renderer, its controls do what they say and
// can be taken back, and what is wrong is reported. Exit code 77: this program has no module.
import {spawnSync} from 'node:child_process';
import fs from 'node:fs';
import {PageTests, click, differing, drop, frame, pixels, pixelsOfPng, psnr, set, settled, step, textOf, verdict} from './shown_page.mjs';

const tests = new PageTests();
const check = tests.check.bind(tests);
const kTiny = tests.write('tiny');

const spread = (shown) => {
  const light = shown.filter((_, i) => i % 4 === 1), mean = light.reduce((s, v) => s + v, 0) / light.length;
  return Math.sqrt(light.reduce((s, v) => s + (v - mean) ** 2, 0) / light.length);
};

async function tiny() {
  const page = await tests.open(kTiny);
  check(await verdict(page) === 'same', 'tiny: the first frame is the same as the native one');
  await step(page, 19);
  await frame(page, 19);
  check(await verdict(page) === 'same', 'tiny: 20 frames are the same as the native ones');
  const ours = await page.evaluate('document.body.dataset.digest');
  check(tests.run('run', '--scene', 'tiny', '--frames', '20').includes(ours), `pelt run prints ${ours}, too`);

  const shown = await pixels(page);
  check(spread(shown) > 10, `the picture is not flat (${spread(shown).toFixed(1)})`);
  const picture = tests.file('tiny.png');
  const drawn = spawnSync(tests.pelt, ['run', '--scene', 'tiny', '--frames', '20', '--picture', picture, '--picture-width', '320',
    '--picture-height', '240', '--renderer', 'gl'], {encoding: 'utf8'});
  if (drawn.status === 0) {
    const db = psnr(shown, await pixelsOfPng(page, fs.readFileSync(picture)));
    check(db >= 40, `the picture is that of the OpenGL renderer: ${db.toFixed(1)} dB`);
  } else {
    console.log(`skipped: ${drawn.stderr.trim()}`);
  }

  // The picture's own settings change no bit.
  await set(page, 'sun', 0);
  const darker = await pixels(page);
  check(psnr(shown, darker) < 40, 'the sun changes the picture');
  await step(page, 1);
  check(await verdict(page) === 'same', 'and no bit');

  // What stages computed, one after the other.
  await set(page, 'sun', 1);
  const views = await page.evaluate('described.views.length');
  const alike = [];
  let last = await pixels(page);
  for (let i = 1; i < views; ++i) {
    await click(page, i === 1 ? 'tour' : 'forth');
    await settled(page);
    const now = await pixels(page);
    if (differing(last, now) < 500) alike.push(`${i} (${differing(last, now)})`);
    last = now;
  }
  check(views > 8 && alike.length === 0, `${views - 1} views of stages are different pictures ${alike.join(', ')}`);
  check((await textOf(page, 'view')).includes('order error'), 'and say what they are');
  await click(page, 'leave');
  await step(page, 1);
  check(await verdict(page) === 'same', 'and change no bit');
  check(await page.evaluate("document.querySelectorAll('#plan tbody tr').length") > 3, 'the plan has its passes');

  const names = await page.evaluate(`[...document.querySelectorAll('button, input, select, canvas, textarea')].filter((e) =>
    !e.labels?.length && !e.getAttribute('aria-label') && !e.textContent.trim()).length`);
  check(names === 0, 'every control has a name');

  const layer = await page.evaluate('described.setups[0].layers[0].name');
  await set(page, `${layer}.weight`, 4);
  check(await verdict(page) === 'other', 'a key of a layer changes bits');
  check((await page.evaluate('setups[0]')).includes('weight = 4.0'), 'and stands in the setup');
  check(await page.evaluate('location.hash.length') > 10, 'and in the link');
  await settled(page, {key: [layer, 'weight', '"heavy"', 0]});
  check((await textOf(page, 'fault')).includes('weight'), 'a value of the wrong kind is reported');
  check(await page.evaluate('described.strands') > 0, 'and the page goes on');
  await click(page, 'reset');
  await frame(page, 0);
  await step(page, 5);
  check(await verdict(page) === 'same', `reset takes everything back (${await textOf(page, 'digest')})`);

  // The first stroke makes another scene, of lit layers: the next picture is compared with one without paint.
  await set(page, 'brush_radius', 0.3);
  const paintedWith = async (amount) => {
    await set(page, 'brush_amount', amount);
    await settled(page, {restart: 1}, {paint: [1, 0.5, 0.5]}, {paint: null}, {step: 4});
    return pixels(page);
  };
  await paintedWith(0);
  const bare = await paintedWith(0), snowy = await paintedWith(1);
  check(psnr(bare, await paintedWith(0)) > 60, 'without paint the picture is the same again');
  const whiter = snowy.filter((v, i) => i % 4 !== 3 && v > bare[i] + 40).length;
  check(whiter > 1500, `snow is painted and stays (${whiter} values are brighter)`);

  await step(page, 200);
  const memory = await page.evaluate('document.body.dataset.memory');
  await step(page, 3000);
  check(memory === await page.evaluate('document.body.dataset.memory'), `memory stays ${memory} bytes over 3,000 frames`);

  for (const width of [360, 1400]) {
    await page.resize(width, 800);
    check(await page.evaluate('document.documentElement.scrollWidth <= innerWidth'), `${width} px wide: nothing sticks out`);
  }
  // Dark where the reader's system is.
  const paper = () => page.evaluate('getComputedStyle(document.body).backgroundColor');
  const by_day = await paper();
  await page.scheme('dark');
  check(by_day !== await paper(), `light and dark are ${by_day} and ${await paper()}`);
  await page.screenshot(tests.file('page.png'));
  tests.noErrors(page);
}

// What changes no still picture of this scene: the time between frames, what is exact, tools, and light inside dense fur
// (`monster` has that).
const kUnseen = new Set(['frame_rate', 'slow_motion', 'in_between', 'hold_view', 'sleep', 'unmoved', 'sort', 'cull', 'wind', 'light', 'lod',
  'full_detail', 'min_fraction', 'strand_budget', 'fast_quality', 'brush_radius', 'brush_amount', 'sphere_radius', 'depth', 'kernels']);
// Another value than the row has, far from it.
const farValue = (row) => (row.switch ? 1 - row.value : row.words?.length ? row.low + 2 : row.value < (row.low + row.high) / 2 ? row.high : row.low);

async function sliders() {
  const page = await tests.open(kTiny);
  const picture = async () => {
    await settled(page, {restart: 20});  // before the scene's teleport, in the middle of its weather
    return pixels(page);
  };
  // Gusts and eddies are seen where a wind blows, the ground where strands reach it.
  await set(page, 'wind_speed', 4);
  await set(page, 'turbulence', 3);
  const base = await picture();
  const unseen = [];
  for (const row of await page.evaluate('described.settings')) {
    if (kUnseen.has(row.key)) continue;
    await set(page, row.key, farValue(row));
    const seen = differing(base, await picture());
    if (seen < 20) unseen.push(`${row.key} (${seen})`);
    await set(page, row.key, row.value);
  }
  check(unseen.length === 0, `every setting changes the picture ${unseen.join(', ')}`);
  const back = await picture();
  check(psnr(base, back) > 60, `and can be set back (${psnr(base, back).toFixed(0)} dB)`);
  tests.noErrors(page);
}

async function monster() {
  const file = tests.file('monster.html');
  tests.run('view', '--scene', 'monster', '--frames', '10', '--out', file);
  const size = fs.statSync(file).size;
  check(size <= 8e6, `monster's page has ${(size * 1e-6).toFixed(1)} MB, at most 8`);
  const page = await tests.open(file);
  const opened_ms = Number(await page.evaluate('document.body.dataset.opened'));
  console.log(`       first picture after ${opened_ms} ms`);
  await step(page, 9);
  check(await verdict(page) === 'same', 'monster: 10 frames are the same as the native ones');
  const kernels = await page.evaluate("described.settings.find((row) => row.key === 'kernels').words");
  check(kernels.join() === 'reference,simd128', `the module has the kernels ${kernels.join(' and ')}`);
  await set(page, 'kernels', 0);
  await settled(page, {restart: 10});
  check(await verdict(page) === 'same', 'and with the reference kernels');
  const shown = await pixels(page);
  await set(page, 'depth', 0);
  check(differing(shown, await pixels(page)) > 500, 'light inside its fur can be changed');
  tests.noErrors(page);
}

const digest = (page) => textOf(page, 'digest');
const fault = (page) => textOf(page, 'fault');

// How many values of the picture, which is drawn in a turn of its own, have changed, as soon as `is(count)`; or at last.
// A context that is lost comes back, and with it the same picture.
async function lost() {
  const page = await tests.open(tests.file('tiny.html'));
  await step(page, 3);
  const before = await pixels(page);
  await page.evaluateInWorker("taken = gl.getExtension('WEBGL_lose_context'); taken.loseContext()");
  await page.until("document.getElementById('fault').textContent.includes('taken away')", 'the page says that it is lost');
  await step(page, 2);
  await page.evaluateInWorker('taken.restoreContext()');
  await page.until("document.getElementById('fault').textContent === ''", 'the page says that it is back');
  await step(page, 1);
  await frame(page, 6);
  const after = await pixels(page);
  const fresh = await tests.open(tests.file('tiny.html'));
  await step(fresh, 6);
  await frame(fresh, 6);
  tests.check(differing(after, await pixels(fresh)) === 0, 'a context that came back draws what another draws');
  tests.check(differing(before, after) > 0, 'and not what it drew before');
  tests.check(await verdict(page) === 'same', 'frames went on');
}

async function changed(page, before, is) {
  for (const end = Date.now() + 10_000; ; await settled(page)) {
    const count = differing(before, await pixels(page), 4);
    if (is(count) || Date.now() > end) return count;
  }
}

async function recording() {
  const log = tests.file('bug.peltinput'), file = tests.file('bug.html');
  tests.run('trace', 'record', '--scene', 'tiny', '--frames', '10', '--out', log);
  tests.run('view', '--replay', log, '--out', file);
  const page = await tests.open(file);
  check(await verdict(page) === 'same', `the first frame of a recording is as recorded (${await digest(page)})`);
  check((await textOf(page, 'about')).includes('fur alone is drawn'), 'without a body, and the page says so');
  const groups = await page.evaluate("[...document.querySelectorAll('#controls details')].map((group) => group.dataset.group).join()");
  check(groups === 'time,light,stages', `there are controls of the picture alone (${groups})`);
  const before = await pixels(page);
  await page.evaluate('turn(1, 0.2)');
  const many = (count) => count > 1000, none = (count) => count === 0;
  let count = await changed(page, before, many);
  check(many(count), `the camera turns (${count} values change)`);
  await click(page, 'own-camera');
  count = await changed(page, before, none);
  check(none(count), `and back to the recording's (${count})`);
  await set(page, 'render_fur', false);
  count = await changed(page, before, many);
  check(many(count), `its fur is drawn (${count})`);
  await set(page, 'render_fur', true);
  await page.evaluate('turn(1, 0.2)');
  await click(page, 'play');
  await frame(page, 9);
  await page.until('!playing', 'the last frame is the end');
  check(await verdict(page) === 'same', `and changes no bit of the frames after it (${await digest(page)})`);
  const replayed = tests.run('trace', 'replay', log);
  check(replayed.includes(await page.evaluate('document.body.dataset.digest')), 'their digest is that of pelt trace replay');
  await step(page, 1);
  await frame(page, 0);
  check(await verdict(page) === 'same', 'behind the last frame it begins again');

  // Onto the page of a scene.
  const scene = await tests.open(kTiny);
  await step(scene, 3);
  const bytes = fs.readFileSync(log);
  await drop(scene, 'cut.peltinput', bytes.subarray(0, bytes.length >> 1));
  await scene.until("!document.getElementById('fault').hidden", 'a truncated recording');
  check(/input log 'cut.peltinput': header, byte \d+: .* it was cut/.test(await fault(scene)), `a truncated recording is reported: ${await fault(scene)}`);
  await step(scene, 1);
  check(await scene.evaluate('document.body.dataset.frame') === '4' && await verdict(scene) === 'same', 'and the scene goes on where it was');
  await drop(scene, 'bug.peltinput', bytes);
  await scene.until("document.body.dataset.recording === 'bug.peltinput' && document.body.dataset.frame === '0'", 'a dropped recording');
  await step(scene, 4);
  await frame(scene, 4);
  check(await verdict(scene) === 'same' && (await digest(scene)).includes('as recorded'), `a recording that is dropped is shown (${await digest(scene)})`);
  await drop(scene, 'fur.toml', Buffer.from('[[layer]]'));
  await scene.until("!document.getElementById('fault').hidden", 'a setup on a recording');
  check((await fault(scene)).includes('no setup'), 'it takes no setup');
  await click(scene, 'reset');
  await scene.until("document.body.dataset.recording === '' && document.body.dataset.frame === '0'", 'the scene again');
  await step(scene, 5);
  check(await verdict(scene) === 'same' && (await digest(scene)).includes('pelt run'), `reset shows the scene again (${await digest(scene)})`);

  check(!fs.readFileSync(file, 'utf8').includes(tests.work), 'no path of this machine is in the page');
  tests.noErrors(page, scene);
}

async function plain() {
  const page = await tests.openAt(`file://${kTiny}`, 'still&plain&width=320&height=240');
  check((await page.evaluate("described.settings.find((row) => row.key === 'kernels').words")).join() === 'reference', 'without vectors there are the reference kernels');
  check((await textOf(page, 'fault')).includes('reference kernels'), 'and the page says so');
  await step(page, 19);
  check(await verdict(page) === 'same', 'and 20 frames are the same as the native ones');
  tests.noErrors(page);
}

async function consoles() {
  const file = tests.file('consoles.html');
  tests.run('view', '--scene', 'tiny', '--frames', '2', '--consoles', '--out', file);
  const page = await tests.open(file);
  await page.evaluate("document.getElementById('consoles').open = true");
  await page.until("document.querySelectorAll('#consoles svg').length", 'consoles');
  const lanes = await page.evaluate("[...document.querySelectorAll('#consoles svg')].map((svg) => new Set([...svg.querySelectorAll('path[data-work=compute] title')].map((t) => t.textContent.split(':')[0])).size)");
  check(lanes.length === 2 && lanes.every((n) => n >= 5), `units of both consoles compute (${lanes})`);
  tests.noErrors(page);
  const without = await tests.open(kTiny);
  check(await without.evaluate("document.getElementById('consoles').hidden"), 'a page that was not asked for them has none');
}

async function broken() {
  const page = fs.readFileSync(kTiny, 'utf8');
  const file = tests.file('broken.html');
  const at = page.indexOf('id="module">') + 12;
  fs.writeFileSync(file, page.slice(0, at + 4000) + page.slice(page.indexOf('</script>', at)));
  const shown = await tests.browser.open(`file://${file}?still`, 800, 600);
  await shown.until("!document.getElementById('fault').hidden", 'a truncated module is reported');
  check(true, 'a truncated module is reported');
}

await tests.end([tiny, lost, sliders, recording, monster, plain, consoles, broken]);
