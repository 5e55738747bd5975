// view_page.cjs: the command `view` and its page in headless Chromium, as a person uses them.
//   const program = await view(tool, '--task', ...);  const w = await window_(program.address, {width, height});
//   await w.click('#step');  await w.state('at');  await w.end();  await program.end();
'use strict';
const { spawn } = require('child_process');
const path = require('path');
const { open } = require('./browse.cjs');
const wait = ms => new Promise(r => setTimeout(r, ms));
function expect(good, text) {
  if (good) return;
  console.log(text);
  process.exitCode = 1;
}

// The command, its address, and what it prints in the end.
const children = [];
async function view(tool, ...words) {
  const child = spawn(tool, ['view', '--json', ...words], { stdio: ['ignore', 'pipe', 'pipe'] });
  children.push(child);
  let out = '', err = '';
  child.stdout.on('data', d => { out += d; });
  child.stderr.on('data', d => { err += d; });
  const gone = new Promise(r => child.on('exit', r));
  for (let i = 0; i < 600 && !/\n/.test(err) && child.exitCode === null; ++i) await wait(50);
  const address = (/http:\S+/.exec(err) || [])[0];
  if (!address) throw new Error('view: ' + err);
  return {
    address,
    async end() {
      child.kill('SIGINT');
      expect(await gone === 0, `view ends with ${child.exitCode} ${child.signalCode}: ${err}`);
      return JSON.parse(out);
    },
  };
}

async function window_(address, { width = 900, height = 600 } = {}) {
  const page = await open(address, { width, height });
  await page.ask('redman.ready');
  const mouse = (type, x, y) => page.call('Input.dispatchMouseEvent', { type, x, y, button: 'left', buttons: type === 'mouseReleased' ? 0 : 1, clickCount: 1 });
  const middle = selector => page.ask(`(() => { const r = document.querySelector('${selector}').getBoundingClientRect(); return [r.left + r.width / 2, r.top + r.height / 2, r.left, r.width]; })()`);
  const until = async (condition, text) => {
    for (let i = 0; i < 1200; ++i) {
      if (await page.ask(`!!(redman.state && (${condition}))`)) return;
      await wait(50);
    }
    throw new Error(`${text}: ${await page.ask('JSON.stringify({ ...redman.state, rows: 0, action: 0, values: 0 })')} ${page.problems}`);
  };
  await until('true', 'no frame comes');
  return {
    page, mouse, middle, until,
    ask: page.ask,
    state: key => page.ask('redman.state.' + key),
    told: what => page.ask(`redman.ask(${JSON.stringify(what)})`),
    hash: async () => (await page.ask(`redman.ask({ do: 'hash' })`)).hash,
    async click(selector) {
      const [x, y] = await middle(selector);
      await mouse('mousePressed', x, y);
      await mouse('mouseReleased', x, y);
    },
    async key(key, type) {
      await page.call('Input.dispatchKeyEvent', { type, key, text: type === 'keyDown' && key.length === 1 ? key : undefined });
    },
    async picture(name) {
      await page.drawn();
      await page.picture(name);
    },
    async end() {
      expect(page.problems.length === 0, `problems: ${page.problems}`);
      await page.close();
    },
  };
}

module.exports = { view, window_, expect, wait, children };
