// open_view.cjs TOOL PICTURES: `redman view` in headless Chromium, by the pointer, keys and buttons: steps, going back to the
// byte, pulling and leading, sliders, a recording, several worlds. Pages of others get nothing, even with the address.
'use strict';
const fs = require('fs'), http = require('http'), path = require('path');
const { open, colours } = require('./browse.cjs');
const { view: begin, window_, expect, wait, children } = require('./view_page.cjs');
const [tool, pictures] = process.argv.slice(2);
const view = (...words) => begin(tool, ...words);
const shot = name => path.join(pictures, name);

async function hands() {
  const file = path.join(pictures, 'by_hand.npz');
  const program = await view('--task', 'hand_over_safe_finger', '--policy', 'hold', '--policy', 'random', '--seed', '3', '--paused', '--record', file);
  const w = await window_(program.address);
  try {
    expect((await w.ask(colours)).count > 50, 'the scene shows few colours');
    expect(await w.state('at') === 0 && !(await w.state('plays')), 'it does not begin paused');
    const start = await w.hash();

    // time
    await w.click('#step');
    await w.until('redman.state.at === 1', 'a step is not one');
    await w.click('#play');
    await w.until('redman.state.at > 20', 'it does not play');
    await w.click('#play');
    await w.until('!redman.state.plays', 'it does not stop');
    const at = await w.state('at'), there = await w.hash(), rows = await w.ask('redman.curve.at.length');
    expect(rows === at + 1, `${rows} rows of curves after ${at} steps`);
    for (let k = 1; k <= 3; ++k) {
      await w.click('#back');
      await w.until(`redman.state.at === ${at - k}`, 'going back is not by one step');
    }
    const [x, y, left, wide] = await w.middle('#time');
    await w.mouse('mousePressed', x, y);
    await w.mouse('mouseMoved', left + 3, y);
    await w.mouse('mouseReleased', left + 3, y);
    await w.until('redman.state.at === 0', 'the slider does not go back to the start');
    expect(await w.hash() === start, 'the start is another state than it was');
    await w.mouse('mousePressed', left + 3, y);
    await w.mouse('mouseMoved', left + wide - 3, y);
    await w.mouse('mouseReleased', left + wide - 3, y);
    await w.until(`redman.state.at === ${at}`, 'the slider does not come back');
    expect(await w.hash() === there, 'the last state is another than it was');

    // the camera
    const before = await w.ask(colours);
    const box = await w.ask(`(() => { const r = document.getElementById('view').getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; })()`);
    await w.mouse('mousePressed', box[0] + 40, box[1] + box[3] - 90);
    await w.mouse('mouseMoved', box[0] + 140, box[1] + box[3] - 60);
    await w.mouse('mouseReleased', box[0] + 140, box[1] + box[3] - 60);
    expect((await w.ask(colours)).sum !== before.sum, 'a drag on the floor does not turn the view');
    await w.ask(`redman.look('close')`);

    // the object follows the pointer
    const go = async n => { for (let k = 0; k < n; ++k) await w.told({ do: 'step' }); };
    const from = await w.ask(`redman.ask({ do: 'reset', seed: 7 })`) && await w.state('last');
    await go(8);
    await w.until(`redman.state.at === ${from} + 8 || redman.state.step[0] === 8`, 'eight steps do not come');
    await w.page.drawn();
    const still = await w.ask(`redman.position('object')`);
    await w.told({ do: 'reset', seed: 7 });
    await w.until('redman.state.step[0] === 0', 'it does not begin anew');
    await w.page.drawn();
    const egg = await w.ask(`document.getElementById('strength').value = 1.3, redman.movable('object')`);
    expect(egg !== null, 'the object is not in sight');
    await w.mouse('mouseMoved', egg.x, egg.y);
    await w.mouse('mousePressed', egg.x, egg.y);
    await w.mouse('mouseMoved', egg.x - 20, egg.y - 120);
    await go(8);
    await w.until('redman.state.step[0] === 8 && redman.state.force > 0', 'nothing is pulled');
    await w.page.drawn();
    const pulled = await w.ask(`redman.position('object')`);
    await w.picture(shot('pull.png'));
    await w.mouse('mouseReleased', egg.x - 20, egg.y - 120);
    expect(pulled[2] > still[2] + 0.02, `the object is at ${pulled}, left alone at ${still}`);
    await go(1);
    await w.until('redman.state.force === undefined', 'it is not let go');

    // contacts, a picture
    await w.told({ do: 'reset', seed: 7 });
    await go(6);
    await w.click('#contacts');
    await w.until('redman.state.contacts > 0', 'no contact is shown');
    await w.ask(`(() => { const s = document.getElementById('picture'); s.value = 'right_palm'; s.onchange({ target: s }); })()`);
    for (let i = 0; i < 200 && !(await w.ask(`document.getElementById('inset').naturalWidth`)); ++i) await wait(50);
    expect(await w.ask(`document.getElementById('inset').naturalWidth`) === 320, 'no picture by the palm\'s camera');
    await w.picture(shot('contacts.png'));
    await w.ask(`(() => { const s = document.getElementById('picture'); s.value = ''; s.onchange({ target: s }); })()`);

    // by hand: a finger that is led, a slider, keys, a gamepad
    expect(!(await w.state('hand')), 'it is acted in by hand from the start');
    await w.ask(`document.getElementById('mouse').value = 'lead'`);
    const tip = await w.ask(`redman.movable('right_ff_distal')`), action = await w.state('action');
    await w.mouse('mouseMoved', tip.x, tip.y);
    await w.mouse('mousePressed', tip.x, tip.y);
    await w.mouse('mouseMoved', tip.x + 10, tip.y - 40);
    await go(8);
    await w.mouse('mouseReleased', tip.x + 10, tip.y - 40);
    await w.until('redman.state.hand', 'leading is not by hand');
    const led = await w.state('action');
    expect(led.some((v, i) => Math.abs(v - action[i]) > 0.05), 'leading changes no action');
    await w.ask(`document.getElementById('mouse').value = 'pull'`);
    const entry = await w.ask(`redman.world.actions.indexOf(redman.hand.groups[0][0])`), value = await w.state(`action[${entry}]`);
    await w.ask('document.activeElement.blur()');
    const up = value < 0 ? 'q' : 'a';
    await w.key(up, 'keyDown');
    await wait(400);
    await w.key(up, 'keyUp');
    await w.until(`Math.abs(redman.state.action[${entry}] - ${value}) > 0.02`, 'a key moves no action');
    const keyed = await w.state(`action[${entry}]`), by = keyed < 0 ? 1 : -1;
    await w.ask(`navigator.getGamepads = () => [{ mapping: 'standard', axes: [${by}, 0, 0, 0], buttons: Array.from({ length: 16 }, () => ({ value: 0, pressed: false })) }]`);
    await w.until(`Math.abs(redman.state.action[${entry}] - ${keyed}) > 0.05`, 'a gamepad moves no action');
    await w.ask(`navigator.getGamepads = () => []`);

    // a demonstration
    await w.click('#take');
    await w.until('redman.state.take && redman.state.step[0] === 0', 'nothing is recorded');
    await w.click('#play');
    await w.until('redman.state.take.episodes >= 1', 'no episode is kept');
    await w.click('#take');
    await w.until('!redman.state.take', 'the recording does not end');
    for (let i = 0; i < 100 && !fs.existsSync(file); ++i) await wait(50);
    expect(fs.existsSync(file), 'no file was written');

    // somebody else acts; an option
    await w.click('#play');
    await w.click('#actors [data-actor=random]');
    await w.until(`redman.state.who === 'random' && !redman.state.hand`, 'nobody else acts');
    await w.told({ do: 'set', key: 'object', value: 'tennis_ball' });
    await w.until(`redman.world.options.find(o => o.key === 'object').value === 'tennis_ball'`, 'an option does not change');
    const said = await w.told({ do: 'set', key: 'object', value: 'elephant' }).catch(e => e.message);
    expect(/elephant/.test(said), `a wrong option is answered by ${said}`);
    await w.ask(`redman.ask({ do: 'play', on: true })`);
    const result = await program.end();
    for (let i = 0; i < 100 && await w.ask(`document.getElementById('message').hidden`); ++i) await wait(50);
    expect(/has ended/.test(await w.ask(`document.getElementById('message').textContent`)), 'the page does not say that the program has ended');
    expect(result.task === 'hand_over_safe_finger' && result.frames > 0 && result.steps > 50, `it tells ${JSON.stringify(result)}`);
  } finally {
    await w.end();
  }
}

async function several() {
  const program = await view('--task', 'hand_over_safe_finger', '--policy', 'demo', '--envs', '4', '--set', 'modality=points', '--set', 'points=512');
  const w = await window_(program.address, { width: 1280, height: 800 });
  try {
    await w.until('redman.state.at > 25', 'it does not play');
    await w.told({ do: 'play', on: false });
    await w.told({ do: 'watch', world: 3 });
    await w.until('redman.state.watched === 3 && redman.state.points === 512', 'no cloud of another world');
    await w.picture(shot('all.png'));
    await w.ask(`redman.look('close')`);
    expect((await w.ask(colours)).count > 50, 'the scene shows few colours');
    const row = await w.ask('redman.curve.at.length');
    expect(row === await w.state('at') - await w.state('first') + 1, `${row} rows of curves of another world`);
    await w.picture(shot('several.png'));
  } finally {
    await w.end();
    await program.end();
  }
}

// A page of this machine that is not ours, and knows the address.
async function foreign() {
  const program = await view('--task', 'ball_run', '--paused');
  const server = http.createServer((_, answer) => answer.writeHead(200, { 'content-type': 'text/html' }).end('<!doctype html><link rel="icon" href="data:,"><p>another page'));
  await new Promise(r => server.listen(0, '127.0.0.1', r));
  const page = await open('http://127.0.0.1:' + server.address().port + '/', { width: 300, height: 200 });
  try {
    const live = program.address.replace('http:', 'ws:') + 'live';
    expect(await page.ask(`new Promise(r => { const s = new WebSocket('${live}'); s.onopen = () => r('open'); s.onmessage = () => r('heard'); s.onclose = () => r('closed'); })`) === 'closed',
      'another page opens a window');
    expect(await page.ask(`fetch('${program.address}').then(a => a.text().then(t => 'read ' + t.length), e => 'nothing')`) === 'nothing', 'another page reads the page');
    const local = program.address.replace('127.0.0.1', 'localhost').replace('http:', 'ws:') + 'live';
    expect(await page.ask(`new Promise(r => { const s = new WebSocket('${local}'); s.onopen = () => r('open'); s.onclose = () => r('closed'); })`) === 'closed', 'by another name, another page opens a window');
  } finally {
    await page.close();
    server.close();
    await program.end();
  }
}

(async () => {
  await foreign();
  await hands();
  await several();
})().catch(e => { console.log(e.stack); process.exitCode = 1; }).then(() => {
  for (const child of children) child.kill();
  process.exit();
});
