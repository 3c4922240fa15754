// An artist's half hour on the page of `pelt view`, in headless Chromium: node groom_test.mjs PELT CHROMIUM WORK_DIR
//
// A coat is groomed on the built-in character from nothing, with mouse and finger: comb vectors, maps, sliders, undo. What
// is saved bakes to the same groom by `pelt bake`, and can be loaded again. Leaves a picture of each step, half_hour_*.png.
// Exit code 77: this program has no module.
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import {PageTests, click, drag, drop, set, settled, textOf, touch} from './shown_page.mjs';

const tests = new PageTests();
const check = tests.check.bind(tests);
const kFrames = 4;
fs.writeFileSync(tests.file('coat.toml'), '[[layer]]\nname = "coat"\nmask = { materials = ["body"] }\ndensity = 15_000\nlength = 0.05\nwidth = 0.002\n');
const kPage = tests.writeOf('coat', '--character', 'builtin', '--setup', 'coat.toml', '--frames', String(kFrames));

const choose = async (page, tool) => {
  await page.evaluate(`$('tool').value = '${tool}'; $('tool').onchange()`);
  await settled(page);
};
const put = (page, id, value) => page.evaluate(`$('${id}').value = '${value}'`);
const setup = (page) => page.evaluate('setups[0]');
const combs = (page) => page.evaluate('combs');
const press = async (page, id) => {
  await click(page, id);
  await settled(page);
};
// Of the first frames with what the setup is now.
const digest = async (page) => {
  await settled(page, {restart: kFrames});
  return page.evaluate('document.body.dataset.digest');
};
let pictures = 0;
const picture = (page) => page.screenshot(tests.file(`half_hour_${++pictures}.png`));

async function comb(page) {
  const bare = await digest(page);
  await picture(page);
  await choose(page, 'comb');
  await drag(page, [0.5, 0.5], [0.5, 0.55], [0.5, 0.62]);
  const [first] = await combs(page);
  check((await setup(page)).includes('comb = [{ position = ['), 'a drag on the skin is a comb vector of the setup');
  check(Math.hypot(first.root[0] - 0.5, first.root[1] - 0.5) < 0.02 && first.tip[1] > first.root[1] + 0.05, 'from where the pointer went down to where it was lifted');
  check(await page.evaluate("document.querySelectorAll('#marks g').length") === 1, 'it is shown as an arrow');
  const combed = await digest(page);
  check(combed !== bare, 'and combs the coat');
  // The canvas may be anywhere: where the tip is, is asked for.
  const [{tip}] = await combs(page);
  await touch(page, [tip], [[tip[0] + 0.02, tip[1]]], [[tip[0] + 0.06, tip[1] - 0.04]]);
  const turned = await combs(page);
  check(turned.length === 1 && turned[0].tip[0] > tip[0] + 0.02, 'a finger drags its tip');
  check(await digest(page) !== combed, 'which combs otherwise');
  await drag(page, [0.47, 0.56], [0.46, 0.6], [0.45, 0.65]);
  check((await combs(page)).length === 2, 'another drag is another vector');
  await picture(page);
  await press(page, 'comb-drop');
  check((await combs(page)).length === 1, 'the last one is deleted');
  await press(page, 'undo');
  check((await combs(page)).length === 2, 'undo brings it back');
  await press(page, 'redo');
  check((await combs(page)).length === 1, 'and redo takes it away');
  await drag(page, [0.02, 0.02], [0.1, 0.1]);
  check((await combs(page)).length === 1, 'beside the character nothing is combed');
}

async function maps(page) {
  await put(page, 'brush-size', 0.1);
  await put(page, 'map-side', 128);
  const paint = [['length', 0.3, 'length = { value = 0.05, map = "coat_length.png" }'], ['width', 0.6, 'width = { value = 0.002, map = "coat_width.png" }'],
    ['density', 0.5, 'density = { value = 15_000, map = "coat_density.png" }'], ['bald', 1, 'mask = { bald = "coat_bald.png", materials']];
  for (const [i, [name, value, expected]] of paint.entries()) {
    const strands = await page.evaluate('described.strands'), before = await digest(page);
    await choose(page, `map ${await page.evaluate(`kMaps.findIndex(([name]) => name === '${name}')`)}`);
    await put(page, 'brush-value', value);
    if (i % 2) await touch(page, [[0.48, 0.5]], [[0.5, 0.52]], [[0.53, 0.53]]);
    else await drag(page, [0.48, 0.5], [0.5, 0.52], [0.53, 0.53]);
    check((await setup(page)).includes(expected), `a map of ${name} is painted and in the setup`);
    check(await digest(page) !== before, 'and changes bits');
    const left = await page.evaluate('described.strands');
    if (i < 2) check(left === strands, 'of strands that stay');
    else check(left < strands, `with fewer strands (${left} of ${strands})`);
    await picture(page);
  }
}

async function undo(page) {
  const painted = await setup(page), before = await digest(page);
  await set(page, 'coat.frizz', 12);
  check((await setup(page)).includes('frizz = 12.0'), 'a slider is an edit');
  await press(page, 'undo');
  check(await setup(page) === painted && await digest(page) === before, 'and is undone');
  await press(page, 'redo');
  const groomed = await setup(page), after = await digest(page);
  check(groomed.includes('frizz = 12.0') && after !== before, 'and done again');
  let steps = 0;
  for (; !await page.evaluate("$('undo').disabled"); ++steps) await press(page, 'undo');
  check(await setup(page) === fs.readFileSync(tests.file('coat.toml'), 'utf8'), `${steps} edits are undone`);
  while (!await page.evaluate("$('redo').disabled")) await press(page, 'redo');
  check(await setup(page) === groomed && await digest(page) === after, 'and done again, maps too');
}

async function save(page) {
  await tests.browser.send('Browser.setDownloadBehavior', {behavior: 'allow', downloadPath: tests.work});
  const zip = tests.file('coat.zip'), folder = tests.file('saved');
  fs.rmSync(zip, {force: true});
  fs.rmSync(folder, {recursive: true, force: true});
  await click(page, 'save');
  await page.until("$('copied').textContent.includes('coat_bald.png')", 'saving');
  for (const end = Date.now() + 20_000; !fs.existsSync(zip) && Date.now() < end;) await new Promise((done) => setTimeout(done, 50));
  execFileSync('python3', ['-m', 'zipfile', '-e', zip, folder]);
  const saved = `${folder}/coat.toml`;
  check(fs.readFileSync(saved, 'utf8') === await setup(page), 'another program reads the .zip');
  const said = /digest ([0-9a-f]{16})/.exec(await textOf(page, 'copied'))[1];
  check(tests.run('bake', '--character', 'builtin', '--setup', saved, '--out', 'coat.groom').includes(said), `what was saved bakes to the groom of the page, ${said}`);
  const frames = await digest(page);
  check(tests.run('run', '--character', 'builtin', '--groom', 'coat.groom', '--frames', String(kFrames)).includes(frames), `whose frames are the page's, ${frames}`);

  const bytes = fs.readFileSync(zip), other = await tests.open(kPage);
  await drop(other, 'cut.zip', bytes.subarray(0, bytes.length >> 1));
  await other.until("$('fault').textContent.includes('cut.zip')", 'a truncated .zip is reported');
  await drop(other, 'coat.zip', bytes);
  await other.until("setups[0].includes('coat_bald.png')", 'a saved coat is loaded');
  check(await digest(other) === frames, 'and has the same frames');
  await press(other, 'undo');
  check(!(await setup(other)).includes('coat_bald.png'), 'loading is undone');
  tests.noErrors(other);
}

async function groom() {
  const page = await tests.open(kPage);
  check(/^[\d,]+ ns$/.test(await page.evaluate("document.querySelector('[data-layer=coat] .cost').textContent")), "the layer's cost is beside its name");
  await page.send('Emulation.setTouchEmulationEnabled', {enabled: true, maxTouchPoints: 2});
  for (const part of [comb, maps, undo, save]) await part(page);
  tests.noErrors(page);
}

await tests.end([groom]);
