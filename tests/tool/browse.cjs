// Opens a page in headless Chromium over its debugging pipe and asks it things; used by test_tool_pages.sh.
//   const page = await open(file, {width, height, dark});  await page.ask('1 + 1');  await page.picture('a.png');
// page.problems are console errors, exceptions and failed or outgoing requests so far.
'use strict';
const { spawn } = require('child_process');
const fs = require('fs'), os = require('os'), path = require('path');

const chromium = process.env.CHROMIUM || 'chromium';

async function open(file, { width = 1280, height = 800, dark = false } = {}) {
  const home = fs.mkdtempSync(path.join(os.tmpdir(), 'page-'));
  const browser = spawn(chromium, ['--headless', '--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader',
    '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync', '--disable-dev-shm-usage',
    '--hide-scrollbars', '--user-data-dir=' + home, '--remote-debugging-pipe', 'about:blank'],
    { stdio: ['ignore', 'ignore', 'ignore', 'pipe', 'pipe'] });
  const waiting = new Map(), events = [];
  let last = 0, left = '';
  const send = (method, params = {}, sessionId) => new Promise((resolve, reject) => {
    waiting.set(++last, { resolve, reject, method });
    browser.stdio[3].write(JSON.stringify({ id: last, method, params, sessionId }) + '\0');
  });
  browser.stdio[3].on('error', () => {});  // a browser that has gone is told below
  browser.stdio[4].setEncoding('utf8').on('data', chunk => {
    const messages = (left + chunk).split('\0');
    left = messages.pop();
    for (const m of messages.map(t => JSON.parse(t))) {
      const asker = waiting.get(m.id);
      if (!asker) { events.push(m); continue; }
      waiting.delete(m.id);
      if (m.error) asker.reject(new Error(asker.method + ': ' + m.error.message));
      else asker.resolve(m.result);
    }
  });
  browser.on('exit', () => { for (const { reject } of waiting.values()) reject(new Error('the browser went away')); });

  const { targetInfos } = await send('Target.getTargets');
  const { sessionId } = await send('Target.attachToTarget', { targetId: targetInfos.find(t => t.type === 'page').targetId, flatten: true });
  const call = (method, params) => send(method, params, sessionId);
  for (const domain of ['Page', 'Runtime', 'Log', 'Network']) await call(domain + '.enable');
  await call('Emulation.setDeviceMetricsOverride', { width, height, deviceScaleFactor: 1, mobile: false });
  await call('Emulation.setEmulatedMedia', { features: [{ name: 'prefers-color-scheme', value: dark ? 'dark' : 'light' }] });
  await call('Page.navigate', { url: file.startsWith('http:') ? file : 'file://' + path.resolve(file) });
  const until = Date.now() + 120000;
  while (!events.some(e => e.method === 'Page.loadEventFired') && Date.now() < until) await new Promise(r => setTimeout(r, 50));

  const ask = async expression => {
    const r = await call('Runtime.evaluate', { expression, awaitPromise: true, returnByValue: true });
    if (r.exceptionDetails) throw new Error(expression + ': ' + (r.exceptionDetails.exception || r.exceptionDetails).description);
    return r.result.value;
  };
  return {
    ask,
    call,
    // Two frames of the browser later, so that what was asked for is drawn.
    drawn: () => ask('new Promise(r => requestAnimationFrame(() => requestAnimationFrame(() => r(true))))'),
    async picture(to) {
      const { data } = await call('Page.captureScreenshot', { format: 'png' });
      if (to) fs.writeFileSync(to, Buffer.from(data, 'base64'));
      return data;
    },
    get problems() {
      return events.flatMap(({ method, params: p }) => {
        if (method === 'Runtime.exceptionThrown') return ['exception: ' + (p.exceptionDetails.exception || {}).description];
        if (method === 'Runtime.consoleAPICalled' && p.type === 'error') return ['console: ' + p.args.map(a => a.value || a.description).join(' ')];
        if (method === 'Log.entryAdded' && p.entry.level === 'error') return ['log: ' + p.entry.text];
        if (method === 'Network.requestWillBeSent' && !/^(file:|data:|blob:|http:\/\/127\.0\.0\.1)/.test(p.request.url)) return ['request: ' + p.request.url];
        return [];
      });
    },
    async close() {
      await send('Browser.close').catch(() => {});
      if (browser.exitCode === null && browser.signalCode === null) await new Promise(r => browser.on('exit', r));
      fs.rmSync(home, { recursive: true, force: true, maxRetries: 5 });
    },
  };
}
// For ask: how many colours the scene of a page has, and a sum that changes with the picture.
const colours = `(() => {
  const copy = document.createElement('canvas');
  copy.width = 160; copy.height = 100;
  const g = copy.getContext('2d');
  return new Promise(r => requestAnimationFrame(() => requestAnimationFrame(() => {
    g.drawImage(document.getElementById('scene'), 0, 0, 160, 100);
    const d = g.getImageData(0, 0, 160, 100).data, seen = new Set();
    let sum = 0;
    for (let i = 0; i < d.length; i += 4) { seen.add(d[i] << 16 | d[i + 1] << 8 | d[i + 2]); sum = (sum * 31 + d[i] + d[i + 1] + d[i + 2]) % 1000000007; }
    r({ count: seen.size, sum });
  })));
})()`;
module.exports = { open, colours };
