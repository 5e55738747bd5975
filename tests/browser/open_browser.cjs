// open_browser.cjs PAGE PICTURES: opens the page of cmake/browser.sh in headless Chromium as a file. Its bytes are the
// recorded ones, what the tool demonstrated is played again to the bit, buttons and the mouse do what they say, training learns.
'use strict';
const path = require('path');
const { open, colours } = require('../tool/browse.cjs');
const [file, pictures] = process.argv.slice(2);
let passed = 0, failed = 0;
function expect(good, text) {
  if (good) return void ++passed;
  ++failed;
  console.log('FAILED: ' + text);
}
const wait = ms => new Promise(r => setTimeout(r, ms));
const click = (page, selector) => page.ask(`document.querySelector('${selector}').click()`);
const text = (page, id) => page.ask(`document.getElementById('${id}').textContent`);

async function whole() {
  const page = await open(file, { width: 1360, height: 860 });
  try {
    expect(await page.ask('redman.ready'), 'the page does not come up');
    console.log(await text(page, 'about'));

    const proof = await page.ask('redman.pause(), redman.prove()');
    expect(proof.done >= 31 && proof.wrong.length === 0, 'hashes: ' + await text(page, 'proof'));

    // buttons
    await click(page, '#play');
    expect(await page.ask('redman.state.playing'), 'play does not play');
    await page.ask(`document.getElementById('speed').value = '4'`);
    for (let i = 0; i < 600 && (await page.ask('redman.state.finished')) < 1; ++i) await wait(200);
    expect(await page.ask('redman.state.finished') >= 1, 'no episode ends in two minutes');
    await click(page, '#play');
    expect(!(await page.ask('redman.state.playing')), 'pause does not pause');
    expect((await text(page, 'episodes')).includes('with success'), 'no success is counted: ' + await text(page, 'episodes'));
    const before = await page.ask('redman.state.step');
    await click(page, '#step');
    expect(await page.ask('redman.state.step') === before + 1 || before > 60, 'step is not one step');
    expect(await page.ask(`document.querySelectorAll('#costs .cost').length`) === await page.ask('redman.last.cost.length'), 'a cost is not shown');

    const first = await page.ask('redman.begin(5), ' + colours);
    expect(first.count > 60, `the scene shows ${first.count} colours`);
    const moved = await page.ask(`redman.step(25), ` + colours);
    expect(moved.sum !== first.sum, 'the picture does not move');
    await page.picture(path.join(pictures, 'throw.png'));
    const other = await page.ask(`document.querySelector('#cameras button').click(), ` + colours);
    expect(other.sum !== moved.sum, 'a camera does not change the picture');
    const mouse = (type, x, y) => page.call('Input.dispatchMouseEvent', { type, x, y, button: 'left', buttons: type === 'mouseReleased' ? 0 : 1, clickCount: 1 });
    const spot = await page.ask(`(() => { const r = document.getElementById('view').getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; })()`);
    await mouse('mousePressed', spot[0] + 30, spot[1] + spot[3] - 40);  // the floor
    await mouse('mouseMoved', spot[0] + 130, spot[1] + spot[3] - 70);
    await mouse('mouseReleased', spot[0] + 130, spot[1] + spot[3] - 70);
    expect((await page.ask(colours)).sum !== other.sum, 'a drag does not turn the view');

    // who acts: the same start, another course
    const course = async who => page.ask(`(() => {
      document.querySelector('#actors button[data-actor=${who}]').click();
      redman.begin(7);
      let sum = 0;
      for (let i = 0; i < 30; ++i) { redman.step(); sum += redman.last.reward; }
      return [redman.state.actor, sum];
    })()`);
    const zero = await course('zero'), trained = await course('trained');
    expect(zero[0] === 'zero' && trained[0] === 'trained' && trained[1] > zero[1], `zero ${zero[1]}, trained ${trained[1]}`);

    // what the tool's script did there is done here, to the bit
    for (const task of await page.ask('Object.keys(redmanDemonstrations)')) {
      const [ret, recorded, steps, actor] = await page.ask(`(() => {
        redman.choose('${task}');
        document.querySelector('#actors button[data-actor=demonstration]').click();
        const d = redmanDemonstrations['${task}'];
        const finished = redman.state.finished;
        redman.step(d.steps);
        return [redman.finished.ret, d.return, redman.finished.step, redman.state.actor];
      })()`);
      expect(actor === 'demonstration' && ret === recorded, `${task}: the demonstration gives ${ret} after ${steps} steps, where it was recorded ${recorded}`);
    }

    // the mouse pushes what it is dragged on
    await page.ask(`redman.choose('jenga'), redman.act('zero'), document.getElementById('strength').value = 2`);
    const place = await page.ask(`redman.movable()`);
    expect(place !== null, 'nothing that moves is in sight');
    const still = await page.ask(`redman.begin(3), redman.step(20), redman.position('${place.name}')`);
    await page.ask('redman.begin(3)');
    await mouse('mouseMoved', place.x, place.y);
    await mouse('mousePressed', place.x, place.y);
    await mouse('mouseMoved', place.x + 160, place.y - 60);
    const pushed = await page.ask(`redman.step(20), redman.position('${place.name}')`);
    await page.drawn();
    await page.picture(path.join(pictures, 'push.png'));
    await mouse('mouseReleased', place.x + 160, place.y - 60);
    const far = Math.hypot(...pushed.map((v, i) => v - still[i]));
    expect(far > 0.005, `pushed ${place.name} moved by ${far} m`);

    // training, seen from the first epochs on
    await page.ask(`redman.choose('ball_run'), redman.act('zero'), redman.play(), document.getElementById('train').click()`);
    const rows = [];
    for (let i = 0; i < 900; ++i) {
      await wait(200);
      const e = await page.ask('redman.epoch || null');
      if (e && e.episodes > 0 && (!rows.length || rows[rows.length - 1].epoch !== e.epoch)) rows.push(e);
      if (e && e.steps >= 60000) break;
    }
    const start = rows[0], end = rows[rows.length - 1];
    console.log(`training: return ${start.ret.toFixed(1)} after ${start.steps} steps, ${end.ret.toFixed(1)} after ${end.steps}; ${Math.round(end.rate)} samples/s`);
    expect(end.ret > start.ret + 50, `training does not improve: ${start.ret} to ${end.ret}`);
    for (let i = 0; i < 50 && (await page.ask('redman.state.learned')) !== 'ball_run'; ++i) await wait(100);
    await page.ask(`document.querySelector('#actors button[data-actor=learned]').click()`);
    expect(await page.ask('redman.state.actor') === 'learned', 'what was learned does not act');
    await wait(1500);
    await page.picture(path.join(pictures, 'training.png'));
    // of many short whiles the best: other work on the machine counts little
    const rate = await page.ask(`(() => {
      redman.pause();
      const e = redman.engine, worlds = 16, best = { steps: 0, acts: 0 };
      const time = (n, f) => { const began = performance.now(); f(n); return n / (performance.now() - began) * 1000; };
      e.learn('hand_over_safe_finger', 'ppo_lag', worlds, 0, 0);
      redman.choose('hand_over_safe_finger');
      redman.act('trained');
      for (let i = 0; i < 60; ++i) {
        best.steps = Math.max(best.steps, worlds * time(50, n => e.steps(n)));
        best.acts = Math.max(best.acts, time(1000, n => e.acts(n)));
      }
      return best;
    })()`);
    console.log(`Chromium: ${Math.round(rate.steps)} steps/s of hand_over_safe_finger, ${Math.round(rate.acts)} acts/s`);
    await page.ask(`redman.choose('ball_run')`);
    await click(page, '#train');
    expect(!(await page.ask('redman.training')), 'training does not stop');

    // one policy for any limit: what is left of it is observed, so another limit is another course
    await page.ask(`redman.act('zero'), document.getElementById('any-limit').click(), document.getElementById('train').click()`);
    for (let i = 0; i < 300 && ((await page.ask('redman.epoch.steps')) < 10000 || (await page.ask('redman.state.learned')) !== 'ball_run'); ++i) await wait(200);
    await click(page, '#train');
    const limited = await page.ask(`(() => {
      const slider = document.getElementById('limit'), hidden = document.getElementById('limit-box').hidden;
      document.querySelector('#actors button[data-actor=learned]').click();
      const course = value => {
        slider.value = value;
        slider.oninput();
        redman.begin(7);
        redman.step(30);
        return redman.last.ret;
      };
      return { hidden, shown: !document.getElementById('limit-box').hidden, range: [Number(slider.min), Number(slider.max)],
        courses: [slider.min, slider.max, slider.min].map(course), text: document.getElementById('limit-text').textContent };
    })()`);
    expect(limited.hidden && limited.shown && limited.range[0] * 8 === limited.range[1], 'the slider of the limit: ' + JSON.stringify(limited));
    expect(limited.courses[0] === limited.courses[2] && limited.courses[0] !== limited.courses[1], 'a limit changes nothing: ' + limited.courses);
    await page.picture(path.join(pictures, 'limit.png'));
    await page.ask(`redman.act('zero'), document.getElementById('any-limit').click()`);
    expect(await page.ask(`document.getElementById('limit-box').hidden`), 'the slider stays where there is no such policy');

    // every task opens, steps and is drawn
    for (const task of await page.ask('Array.from(document.getElementById("task").options, o => o.value)')) {
      const sum = await page.ask(`(() => { redman.pause(); redman.choose('${task}'); redman.step(3); return redman.last.ret; })()`);
      expect(Number.isFinite(sum), `${task}: return ${sum}`);
    }
    expect(page.problems.length === 0, 'problems: ' + page.problems);
  } finally {
    await page.close();
  }
}

async function look(name, size, task, steps) {
  const page = await open(file, size);
  try {
    await page.ask(`redman.ready.then(() => { redman.pause(); redman.choose('${task}'); redman.begin(2); redman.step(${steps}); })`);
    const seen = await page.ask(colours);
    expect(seen.count > 40, `${name}: the scene shows ${seen.count} colours`);
    await page.picture(path.join(pictures, name + '.png'));
    expect(page.problems.length === 0, `${name}: ${page.problems}`);
  } finally {
    await page.close();
  }
}

(async () => {
  await whole();
  await look('dark', { width: 1360, height: 860, dark: true }, 'jenga', 120);
  await look('narrow', { width: 420, height: 1100 }, 'clean_house', 60);
  console.log(`${passed} passed, ${failed} failed`);
  process.exitCode = failed ? 1 : 0;
})();
