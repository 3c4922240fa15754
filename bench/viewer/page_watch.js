// ---- What changes in the files --------------------------------------------------------------------------------------

// Only where `pelt view --watch` serves the page: asks it what is new, and has the worker take it. Camera, time and
// settings stay; of the setup's keys that were changed here the file's win, once it is saved.
const kAskEvery_ms = 400;
let takenVersion = given.watched_from, watchedRun = null;

const watchLine = element('p', {id: 'watch', hidden: true});
watchLine.setAttribute('role', 'alert');
$('fault').after(watchLine);

function tellWatch(text) {
  if (watchLine.textContent === text) return;
  watchLine.textContent = text;
  watchLine.hidden = !text;
}

const bytesOf = (base64) => Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));

function takeNews(news) {
  // The program was started anew: what this page has of the files may be any version of its.
  if (watchedRun && news.run !== watchedRun) return location.reload();
  watchedRun = news.run;
  if (news.digests) given.native.digests = news.digests;
  if (news.version !== takenVersion) {
    takenVersion = news.version;
    document.body.dataset.version = news.version;
    if (news.setup !== undefined) {
      changes.keys = [];
      remember();
    }
    const files = Object.fromEntries(Object.entries(news.files ?? {}).map(([path, text]) => [path, bytesOf(text)]));
    if (news.files) {
      showFault('');
      document.body.dataset.verdict = '';
    }
    if (news.files || news.digests) tell({files: {files, setup: news.setup, compared: given.native.digests.length}});
  }
  tellWatch(news.error ? `${news.error} (what is shown is the last that was right)` : '');
}

async function watchFiles() {
  for (;;) {
    await new Promise((done) => setTimeout(done, kAskEvery_ms));
    if (!document.body.dataset.opened) continue;
    let news;
    try {
      news = await (await fetch(`changes?since=${takenVersion}`)).json();
    } catch {
      tellWatch('The program that watched the files has ended, and no change is seen any more.');
      continue;
    }
    takeNews(news);
  }
}
if (takenVersion !== undefined) watchFiles().catch((error) => showFault(String(error)));
