// Headless Chromium by its DevTools protocol, over two pipes: no port is opened.
//
//   const browser = new Browser('/usr/bin/chromium');
//   const page = await browser.open('file:///page.html', 800, 600);
//   await page.evaluate('document.title');
//   page.errors                                 // what scripts threw, here and in workers
//   await browser.close();
import {spawn} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';

export class Browser {
  #child;
  #profile = fs.mkdtempSync(path.join(os.tmpdir(), 'pelt-browser-'));
  #waiting = new Map();
  #last = 0;
  #pages = new Map();

  // `options`: the browser's own, besides.
  constructor(program, options = []) {
    this.#child = spawn(program, [...options, '--headless', '--no-sandbox', '--remote-debugging-pipe', '--enable-unsafe-swiftshader', '--use-angle=swiftshader',
      '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync',
      '--disable-dev-shm-usage', '--hide-scrollbars', `--user-data-dir=${this.#profile}`],
    {stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe']});
    let rest = '';
    this.#child.stdio[4].setEncoding('utf8').on('data', (data) => {
      const texts = (rest + data).split('\0');
      rest = texts.pop();
      for (const text of texts) this.#take(JSON.parse(text));
    });
    this.#child.on('exit', () => {
      for (const {fail} of this.#waiting.values()) fail(new Error('the browser ended'));
    });
  }

  #take(message) {
    const waits = this.#waiting.get(message.id);
    this.#waiting.delete(message.id);
    if (waits) return message.error ? waits.fail(new Error(message.error.message)) : waits.done(message.result);
    this.#pages.get(message.sessionId)?.take(message);
  }

  send(method, params = {}, sessionId = undefined) {
    const id = ++this.#last;
    this.#child.stdio[3].write(JSON.stringify({id, method, params, sessionId}) + '\0');
    return new Promise((done, fail) => this.#waiting.set(id, {done, fail}));
  }

  async open(url, width, height) {
    const {targetId} = await this.send('Target.createTarget', {url: 'about:blank'});
    const {sessionId} = await this.send('Target.attachToTarget', {targetId, flatten: true});
    const page = new Page(this, sessionId);
    await page.send('Target.setAutoAttach', {autoAttach: true, waitForDebuggerOnStart: false, flatten: true});
    this.#pages.set(sessionId, page);
    for (const domain of ['Runtime', 'Log', 'Page']) await page.send(`${domain}.enable`);
    await page.resize(width, height);
    await page.send('Page.navigate', {url});
    await page.until("location.href !== 'about:blank' && document.readyState === 'complete'", 'loading');
    return page;
  }

  async close() {
    this.#child.kill();
    await new Promise((done) => (this.#child.exitCode === null && !this.#child.killed ? this.#child.on('exit', done) : setTimeout(done, 500)));
    fs.rmSync(this.#profile, {recursive: true, force: true, maxRetries: 5});
  }
}

class Page {
  errors = [];
  #worker;
  constructor(browser, session) {
    this.send = (method, params) => browser.send(method, params, session);
    // In the scope of its worker's script.
    this.evaluateInWorker = (expression) => browser.send('Runtime.evaluate', {expression, awaitPromise: true}, this.#worker);
  }
  take({method, params}) {
    if (method === 'Target.attachedToTarget' && params.targetInfo.type === 'worker') this.#worker = params.sessionId;
    if (method === 'Runtime.exceptionThrown') this.errors.push(params.exceptionDetails.exception?.description ?? params.exceptionDetails.text);
    if (method === 'Log.entryAdded' && params.entry.level === 'error') this.errors.push(params.entry.text);
  }
  // The value of an expression, which may be a promise.
  async evaluate(expression) {
    const {result, exceptionDetails} = await this.send('Runtime.evaluate', {expression, awaitPromise: true, returnByValue: true});
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  }
  // Until the expression is true.
  async until(expression, what, limit_s = 120) {
    for (const end = Date.now() + 1000 * limit_s; Date.now() < end; await new Promise((done) => setTimeout(done, 50)))
      if (await this.evaluate(`Boolean(${expression})`)) return;
    throw new Error(`${what}: not within ${limit_s} s; the page says: ${await this.evaluate("document.getElementById('fault')?.textContent")}`);
  }
  resize(width, height) {
    return this.send('Emulation.setDeviceMetricsOverride', {width, height, deviceScaleFactor: 1, mobile: false});
  }
  // What the reader's system prefers: 'light' or 'dark'.
  scheme(value) {
    return this.send('Emulation.setEmulatedMedia', {features: [{name: 'prefers-color-scheme', value}]});
  }
  async screenshot(file) {
    fs.writeFileSync(file, Buffer.from((await this.send('Page.captureScreenshot')).data, 'base64'));
  }
}
