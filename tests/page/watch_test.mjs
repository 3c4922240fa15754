// `pelt view --watch` with headless Chromium as the artist's browser: node watch_test.mjs PELT CHROMIUM WORK_DIR
//
// A setup, a map that it names and a mistyped key are saved, and the open page takes them: frame, camera and settings
// stay, an error is told at its line, and the digests are those of the changed files. Exit code 77: no module or server.
import {spawn} from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import {Browser} from './devtools.mjs';

const [pelt, chromium, work] = process.argv.slice(2);
let failures = 0;
const check = (is, what) => {
  if (!is) ++failures;
  console.log(`${is ? 'ok    ' : 'FAILED'} ${what}`);
};

const kSetup = path.join(work, 'my_fur.toml'), kFrames = 8;
const setupText = (line) => `[[layer]]\nname = "coat"\nmask = { materials = ["body", "head"] }\ndensity = 20_000\n${line}\n`;
// As most editors save: a new file in the place of the old.
const save = (line) => {
  fs.writeFileSync(`${kSetup}~`, setupText(line));
  fs.renameSync(`${kSetup}~`, kSetup);
};

// The program and what it said, until its address is known.
async function serve() {
  const {DISPLAY, WAYLAND_DISPLAY, BROWSER, ...env} = process.env;
  const program = spawn(pelt, ['view', '--watch', kSetup, '--frames', String(kFrames)], {cwd: work, env});
  const served = {program, said: '', ended: new Promise((done) => program.on('exit', (code) => done(code)))};
  for (const stream of [program.stdout, program.stderr]) stream.setEncoding('utf8').on('data', (text) => { served.said += text; });
  process.on('exit', () => program.kill('SIGKILL'));
  while (!/http:\S+/.test(served.said)) {
    if (program.exitCode !== null) {
      console.error(`${/without (the page|a server)/.test(served.said) ? 'SKIPPED: ' : ''}${served.said.trim()}`);
      process.exit(/without (the page|a server)/.test(served.said) ? 77 : 1);
    }
    await new Promise((done) => setTimeout(done, 50));
  }
  served.address = /http:\S+/.exec(served.said)[0];
  return served;
}

save('max_strands = 300');
const served = await serve();
check(served.said.includes('no browser to open here'), 'without a desktop it says so and goes on');
const browser = new Browser(chromium);
process.on('exit', () => browser.close());

const page = await browser.open(`${served.address}?still&width=320&height=240&samples=1`, 1000, 800);
await page.until('document.body.dataset.opened', 'opening');
let tokens = 0;
// Until the worker has answered all that was said to it.
async function settled() {
  const token = `watch ${++tokens}`;
  await page.evaluate(`new Promise((done) => { const before = worker.onmessage; worker.onmessage = (event) => { before(event); if (event.data.token === '${token}') { worker.onmessage = before; setTimeout(done, 100); } }; tell({describe: '${token}'}); })`);
}
const tell = async (message) => {
  await page.evaluate(`tell(${JSON.stringify(message)})`);
  await settled();
};
const frame = async () => Number(await page.evaluate('document.body.dataset.frame'));
const told = () => page.evaluate("document.getElementById('watch').textContent");
const pixels = () => page.evaluate(`(() => {
  const copy = document.createElement('canvas');
  [copy.width, copy.height] = [320, 240];
  const context = copy.getContext('2d', {willReadFrequently: true});
  context.drawImage(document.getElementById('picture'), 0, 0, 320, 240);
  return Array.from(context.getImageData(0, 0, 320, 240).data);
})()`);
function psnr(a, b) {
  const sum = a.reduce((s, v, i) => s + (i % 4 === 3 ? 0 : (v - b[i]) ** 2), 0);
  return 10 * Math.log10(255 * 255 * 0.75 * a.length / Math.max(sum, 1));
}
// Until the page has the version in which this is true.
const taken = async (what, condition) => {
  await page.until(condition, what);
  await settled();
};

check(await page.evaluate('document.body.dataset.verdict') === 'same', 'the first frame is the same as the native one');
await tell({step: 5});
await page.evaluate('turn(0.9, 0.1)');
await page.evaluate(`(() => { const input = document.querySelector('[data-key="sun"] input[type=number]'); input.value = 0.5; input.onchange(); })()`);
await settled();
const camera = await page.evaluate('changes.camera'), before = await frame(), picture = await pixels();
check(before >= 6 && camera.length === 6, `frames were run (${before}) and the camera turned`);

// The same fur, in a file that is another.
save('max_strands = 300\n# as it was');
await taken('another text', "setup.includes('as it was')");
check(await frame() === before + 1, `the next frame is the next (${await frame()})`);
check(JSON.stringify(await page.evaluate('changes.camera')) === JSON.stringify(camera), 'the page keeps its camera');
check(await page.evaluate("described.settings.find((row) => row.key === 'sun').value") === 0.5, 'and its settings');
const kept = psnr(picture, await pixels());
await page.evaluate("document.getElementById('own-camera').click()");
await settled();
const turned = psnr(picture, await pixels());
check(kept > 25 && kept > turned + 6, `the picture is seen from where it was (${kept.toFixed(1)} dB; from elsewhere ${turned.toFixed(1)})`);

const saved_ms = Date.now();
save('max_strands = 120');
await page.until('described.strands === 120', 'fewer strands');
console.log(`       ${Date.now() - saved_ms} ms from the save to the page`);
await taken('fewer strands', 'described.strands === 120');
check((await page.evaluate('setup')).includes('max_strands = 120'), 'a saved setup is shown');
check(await frame() > before, 'and time goes on');
await page.until(`given.native.digests.length === ${kFrames}`, 'the digests of what was saved');
await settled();
await page.evaluate("document.getElementById('restart').click()");
await settled();
await tell({step: kFrames - 1});
check(await page.evaluate('document.body.dataset.verdict') === 'same', `its frames are the same as the native ones (${await page.evaluate("document.getElementById('digest').textContent")})`);

save('max_strnds = 50');
await page.until("document.getElementById('watch').textContent !== ''", 'an error');
check(/my_fur\.toml:5: .*max_strands/.test(await told()), `a mistyped key is told at its line: ${await told()}`);
check(await page.evaluate("document.getElementById('fault').hidden"), 'the page itself is well');
const wrong = await frame();
await tell({step: 1});
check(await frame() === wrong + 1 && await page.evaluate('described.strands') === 120, 'and goes on with the last that was right');

// Written in two pieces, the first of which is a setup, too.
fs.writeFileSync(kSetup, '');
await new Promise((done) => setTimeout(done, 500));
fs.writeFileSync(kSetup, setupText('max_strands = 80'));
await taken('a right setup', 'described.strands === 80');
await page.until("document.getElementById('watch').textContent === ''", 'no error');
check(await frame() > wrong, 'it heals');

// A page that is loaded again has the files as they are.
const again = await browser.open(`${served.address}?still&width=64&height=48&samples=1`, 800, 600);
await again.until('document.body.dataset.opened', 'opening again');
check(await again.evaluate('described.strands') === 80, 'a page that is loaded later has what was saved');
check(page.errors.length === 0 && again.errors.length === 0, `no script error ${[...page.errors, ...again.errors].join('; ')}`);

served.program.kill('SIGINT');
check(await served.ended === 0, 'Ctrl-C ends the program');
await page.until("document.getElementById('watch').textContent.includes('ended')", 'that the program ended');
check(served.said.includes('taken: ') && served.said.includes('my_fur.toml:5'), 'the terminal says what was taken and what was wrong');
process.exit(failures ? 1 : 0);
