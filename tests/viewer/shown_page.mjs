// What the tests of the page of `pelt view` in headless Chromium have in common.
//
//   const tests = new PageTests();                          // PELT CHROMIUM WORK_DIR of the command line
//   const page = await tests.open(tests.write('tiny'));     // still, drawn at 320 x 240
//   await step(page, 3);
//   tests.check(await verdict(page) === 'same', 'frames are the native ones');
//   await tests.end([part, another]);
import {execFileSync, spawn, spawnSync} from 'node:child_process';
import path from 'node:path';
import {Browser} from './devtools.mjs';

export class PageTests {
  failures = 0;
  #browsers = [];
  #plain;
  constructor() {
    [this.pelt, this.chromium, this.work] = process.argv.slice(2);
  }
  get browser() {
    return (this.#plain ??= this.launch());
  }
  launch(...options) {
    const browser = new Browser(this.chromium, options);
    this.#browsers.push(browser);
    return browser;
  }
  check(is, what) {
    if (!is) ++this.failures;
    console.log(`${is ? 'ok    ' : 'FAILED'} ${what}`);
  }
  file(name) {
    return path.join(this.work, name);
  }
  run(...args) {
    return execFileSync(this.pelt, args, {cwd: this.work, encoding: 'utf8', stdio: ['ignore', 'pipe', 'pipe']});
  }
  // The page of a scene, with the native digests of so many frames. Ends the tests where the program has no module.
  write(scene, frames = 24) {
    return this.writeOf(scene, '--scene', scene, '--frames', String(frames));
  }
  writeOf(name, ...args) {
    const file = this.file(`${name}.html`);
    const tried = spawnSync(this.pelt, ['view', ...args, '--out', file], {cwd: this.work, encoding: 'utf8'});
    if (tried.status !== 0) this.skipWithout(tried.stderr);
    return file;
  }
  // For the reason that the program gave: exit code 77 where its build left the module or the server out.
  skipWithout(said) {
    const left_out = /without (the page|a server)/.test(said);
    console.error(`${left_out ? 'SKIPPED: ' : ''}${said.trim()}`);
    process.exit(left_out ? 77 : 1);
  }
  // The program that serves a page, and what it said, until its address is known.
  async serve(...args) {
    const {DISPLAY, WAYLAND_DISPLAY, BROWSER, ...env} = process.env;
    const program = spawn(this.pelt, args, {cwd: this.work, env});
    const served = {program, said: '', ended: new Promise((done) => program.on('exit', (code) => done(code)))};
    for (const stream of [program.stdout, program.stderr]) stream.setEncoding('utf8').on('data', (text) => { served.said += text; });
    process.on('exit', () => program.kill('SIGKILL'));
    while (!served.said.includes('no browser to open here')) {
      if (program.exitCode !== null) this.skipWithout(served.said);
      await new Promise((done) => setTimeout(done, 50));
    }
    served.address = /http:\S+/.exec(served.said)[0];
    return served;
  }
  async open(file, width = 1000) {
    return this.openAt(`file://${file}`, 'still&width=320&height=240&samples=2', width);
  }
  async openAt(address, query, width = 1000) {
    const page = await this.browser.open(`${address}?${query}`, width, 800);
    await page.until('document.body.dataset.opened', 'opening');
    return page;
  }
  noErrors(...pages) {
    const errors = pages.flatMap((page) => page.errors);
    this.check(errors.length === 0, `no script error ${errors.join('; ')}`);
  }
  // Runs the parts one after the other, and ends the program.
  async end(parts) {
    for (const part of parts) {
      const start_ms = Date.now();
      try {
        await part();
      } catch (error) {
        this.check(false, `${part.name}: ${error.message}`);
      }
      console.log(`       ${part.name}: ${((Date.now() - start_ms) / 1000).toFixed(1)} s`);
    }
    for (const browser of this.#browsers) await browser.close();
    process.exit(this.failures ? 1 : 0);
  }
}

// What the canvas shows, or an image that is loaded, as bytes of RGBA at 320 x 240.
const kBytesOf = `(drawn) => {
  const copy = document.createElement('canvas');
  [copy.width, copy.height] = [320, 240];
  const context = copy.getContext('2d', {willReadFrequently: true});
  context.drawImage(drawn, 0, 0, 320, 240);
  const {data} = context.getImageData(0, 0, 320, 240);
  let text = '';
  for (let at = 0; at < data.length; at += 8192) text += String.fromCharCode(...data.subarray(at, at + 8192));
  return btoa(text);
}`;
export const pixels = async (page) => Buffer.from(await page.evaluate(`(${kBytesOf})(document.getElementById('picture'))`), 'base64');
export const pixelsOfPng = async (page, png) => Buffer.from(await page.evaluate(`new Promise((done) => {
  const image = new Image();
  image.onload = () => done((${kBytesOf})(image));
  image.src = 'data:image/png;base64,${png.toString('base64')}';
})`), 'base64');
// Of two such, in dB.
export function psnr(a, b) {
  const sum = a.reduce((s, v, i) => s + (i % 4 === 3 ? 0 : (v - b[i]) ** 2), 0);
  return sum === 0 ? Infinity : 10 * Math.log10(255 * 255 * 0.75 * a.length / sum);
}
// How many of them are off by more than `by` of 255.
export const differing = (a, b, by = 2) => a.filter((v, i) => Math.abs(v - b[i]) > by).length;
export const frame = (page, number) => page.until(`document.body.dataset.frame === '${number}'`, `frame ${number}`);
export const verdict = (page) => page.evaluate('document.body.dataset.verdict');
export const textOf = (page, id) => page.evaluate(`document.getElementById('${id}').hidden ? '' : document.getElementById('${id}').textContent`);
export const click = (page, id) => page.evaluate(`document.getElementById('${id}').click()`);

let tokens = 0;
// Says it to the worker and waits until that, and all that was said before, is done and drawn.
export async function settled(page, ...messages) {
  const token = `test ${++tokens}`;
  await page.evaluate(`new Promise((done) => {
    const before = worker.onmessage;
    worker.onmessage = (event) => {
      before(event);
      if (event.data.token !== '${token}') return;
      worker.onmessage = before;
      setTimeout(done, 100);
    };
    for (const message of ${JSON.stringify([...messages, {token}])}) tell(message);
  })`);
}
export const step = (page, count) => settled(page, {step: count});
// Shares of the canvas, as the browser has them.
async function placesOn(page) {
  const [x, y, width, height] = await page.evaluate(`(({x, y, width, height}) => [x, y, width, height])(document.getElementById('picture').getBoundingClientRect())`);
  return ([shareX, shareY]) => ({x: x + shareX * width, y: y + shareY * height});
}
// A finger, or two, as a touch screen reports them: of each step its places.
export async function touch(page, ...steps) {
  const place = await placesOn(page);
  const send = (type, places) => page.send('Input.dispatchTouchEvent', {type, touchPoints: places.map((at, id) => ({...place(at), id}))});
  await send('touchStart', steps[0]);
  for (const places of steps.slice(1)) await send('touchMove', places);
  await send('touchEnd', []);
  await settled(page);
}
// The mouse with its button held, from the first place to the last.
export async function drag(page, ...places) {
  const place = await placesOn(page);
  const send = (type, at, buttons) => page.send('Input.dispatchMouseEvent', {type, ...place(at), buttons, button: 'left', clickCount: 1});
  await send('mousePressed', places[0], 1);
  for (const at of places.slice(1)) await send('mouseMoved', at, 1);
  await send('mouseReleased', places.at(-1), 0);
  await settled(page);
}
// What a user drops onto the page.
export const drop = (page, name, bytes) => page.evaluate(`(() => {
  const bytes = Uint8Array.from(atob('${bytes.toString('base64')}'), (c) => c.charCodeAt(0));
  const transfer = new DataTransfer();
  transfer.items.add(new File([bytes], '${name}'));
  document.dispatchEvent(new DragEvent('drop', {dataTransfer: transfer, cancelable: true}));
})()`);
// What a user does to a control, by its row.
export async function set(page, key, value) {
  await page.evaluate(`(() => {
    const input = document.querySelector('[data-key="${key}"] :is(input[type=number], input[type=checkbox], input[type=color], select)');
    input[input.type === 'checkbox' ? 'checked' : 'value'] = ${JSON.stringify(value)};
    input.onchange();
  })()`);
  await settled(page);
}
