// `pelt view --watch` with headless Chromium as the artist's browser: node watch_test.mjs PELT CHROMIUM WORK_DIR
//
// A setup, a map that it names and a mistyped key are saved, and the open page takes them: frame, camera and settings
// stay, an error shows at its line, and the digests are those of the changed files. Exit code 77: no module or server.
import fs from 'node:fs';
import {PageTests, click, pixels, psnr, set, settled, step, textOf, verdict} from './shown_page.mjs';

const tests = new PageTests();
const check = tests.check.bind(tests);

const kSetup = tests.file('my_fur.toml'), kFrames = 8;
const setupText = (line) => `[[layer]]\nname = "coat"\nmask = { materials = ["body", "head"] }\ndensity = 20_000\n${line}\n`;
// As most editors save: a new file in the place of the old.
const save = (line) => {
  fs.writeFileSync(`${kSetup}~`, setupText(line));
  fs.renameSync(`${kSetup}~`, kSetup);
};

async function watch() {
  save('max_strands = 300');
  const served = await tests.serve('view', '--watch', kSetup, '--frames', String(kFrames));
  const page = await tests.openAt(served.address, 'still&width=320&height=240&samples=1');
  const frame = async () => Number(await page.evaluate('document.body.dataset.frame'));
  const reported = () => textOf(page, 'watch');
  // Until the page has the version in which this is true.
  const taken = async (what, condition) => {
    await page.until(condition, what);
    await settled(page);
  };

  check(await verdict(page) === 'same', 'the first frame is the same as the native one');
  await step(page, 5);
  await page.evaluate('turn(0.9, 0.1)');
  await set(page, 'sun', 0.5);
  const camera = await page.evaluate('changes.camera'), before = await frame(), picture = await pixels(page);
  check(before === 5 && camera.length === 6, `frames were run (${before}), none for turning the camera`);

  // The same fur, in a file that is another.
  save('max_strands = 300\n# as it was');
  await taken('another text', "setups[0].includes('as it was')");
  check(await frame() === before + 1, `the next frame is the next (${await frame()})`);
  check(JSON.stringify(await page.evaluate('changes.camera')) === JSON.stringify(camera), 'the page keeps its camera');
  check(await page.evaluate("described.settings.find((row) => row.key === 'sun').value") === 0.5, 'and its settings');
  const kept = psnr(picture, await pixels(page));
  await click(page, 'own-camera');
  await settled(page);
  const turned = psnr(picture, await pixels(page));
  check(kept > 25 && kept > turned + 6, `the picture is seen from where it was (${kept.toFixed(1)} dB; from elsewhere ${turned.toFixed(1)})`);

  const saved_ms = Date.now();
  save('max_strands = 120');
  await page.until('described.strands === 120', 'fewer strands');
  console.log(`       ${Date.now() - saved_ms} ms from the save to the page`);
  await taken('fewer strands', 'described.strands === 120');
  check((await page.evaluate('setups[0]')).includes('max_strands = 120'), 'a saved setup is shown');
  check(await frame() > before, 'and time goes on');
  await page.until(`given.native.digests.length === ${kFrames}`, 'the digests of what was saved');
  await settled(page);
  await click(page, 'restart');
  await settled(page);
  await step(page, kFrames - 1);
  check(await verdict(page) === 'same', `its frames are the same as the native ones (${await textOf(page, 'digest')})`);

  save('max_strnds = 50');
  await page.until("document.getElementById('watch').textContent !== ''", 'an error');
  check(/my_fur\.toml:5: .*max_strands/.test(await reported()), `a mistyped key is reported at its line: ${await reported()}`);
  check(await page.evaluate("document.getElementById('fault').hidden"), 'the page itself is well');
  const wrong = await frame();
  await step(page, 1);
  check(await frame() === wrong + 1 && await page.evaluate('described.strands') === 120, 'and goes on with the last that was right');

  // Written in two pieces, the first of which is a setup, too.
  fs.writeFileSync(kSetup, '');
  await new Promise((done) => setTimeout(done, 500));
  fs.writeFileSync(kSetup, setupText('max_strands = 80'));
  await taken('a right setup', 'described.strands === 80');
  await page.until("document.getElementById('watch').textContent === ''", 'no error');
  check(await frame() > wrong, 'it heals');

  // A page that is loaded again has the files as they are.
  const again = await tests.openAt(served.address, 'still&width=64&height=48&samples=1');
  check(await again.evaluate('described.strands') === 80, 'a page that is loaded later has what was saved');
  tests.noErrors(page, again);

  served.program.kill('SIGINT');
  check(await served.ended === 0, 'Ctrl-C ends the program');
  await page.until("document.getElementById('watch').textContent.includes('ended')", 'that the program ended');
  check(served.said.includes('taken: ') && served.said.includes('my_fur.toml:5'), 'the terminal says what was taken and what was wrong');
}

// A recording at an address of this machine.
async function recording() {
  tests.run('trace', 'record', '--scene', 'tiny', '--frames', '4', '--out', 'bug.peltinput');
  const served = await tests.serve('view', '--replay', 'bug.peltinput', '--open');
  const page = await tests.openAt(served.address, 'still&width=320&height=240&samples=1');
  await step(page, 3);
  check(await verdict(page) === 'same' && (await textOf(page, 'digest')).includes('frame 3 of 4'), `a recording is served (${await textOf(page, 'digest')})`);
  tests.noErrors(page);
  served.program.kill('SIGINT');
  check(await served.ended === 0, 'until Ctrl-C');
}

await tests.end([watch, recording]);
