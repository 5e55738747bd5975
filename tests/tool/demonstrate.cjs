// demonstrate.cjs TOOL TASK RECORD EPISODES [PICTURE]: demonstrations of press.task through the page of `redman view`, by a pointer: it takes
// the tip of the first finger and draws it above the button, past the cup, then down. What the pointer aims at is read off the page's
// scene, as a person sees it there.
'use strict';
const { view, window_, expect, children } = require('./view_page.cjs');
const [tool, task, record, episodes, picture] = process.argv.slice(2);
const tip = 'right_ff_tip', button = 'button_top';
const above = 0.09, below = 0.01;  // m, of the tip over the button's top; of the button pressed

(async () => {
  const program = await view(tool, '--task', task, '--policy', 'zero', '--seed', '1', '--paused', '--record', record);
  const w = await window_(program.address);
  await w.ask(`redman.look('front')`);
  const box = await w.ask(`(() => { const r = document.getElementById('view').getBoundingClientRect(); return [r.left, r.top, r.width, r.height]; })()`);
  const [x, y] = [box[0] + box[2] - 160, box[1] + box[3] - 90];
  const turn = async (dx, dy) => {
    await w.mouse('mousePressed', x, y);
    await w.mouse('mouseMoved', x + dx, y + dy);
    await w.mouse('mouseReleased', x + dx, y + dy);
    await w.page.drawn();
  };
  // Look along y, and nearly level: the finger moves in the plane of the screen.
  const off = async () => w.ask(`(() => { const a = redman.pixel([0.45, 0, 0.1]), b = redman.pixel([0.45, 0.1, 0.1]); return [b.x - a.x, b.y - a.y]; })()`);
  await turn(40, -40);
  let last = await off(), by = 40;
  for (let k = 0; k < 12 && Math.abs(last[0]) > 0.3; ++k) {
    await turn(by, 0);
    const now = await off(), slope = (now[0] - last[0]) / by;
    last = now;
    by = Math.max(-80, Math.min(80, -now[0] / (slope || 1)));
  }
  expect(Math.abs(last[0]) < 1, `the view is not from the side: ${last}`);
  await w.ask(`document.getElementById('mouse').value = 'lead'`);
  await w.click('#take');
  await w.until('redman.state.take && redman.state.step[0] === 0', 'nothing is recorded');
  for (let episode = 0; episode < +episodes; ++episode) {
    await w.until('redman.state.step[0] === 0', 'an episode does not begin');
    let held = null;
    for (let k = 0; k < 20 && !(await w.ask('redman.held()')); ++k) {  // what is drawn may be older than the reset
      await w.page.drawn();
      held = await w.ask(`redman.movable('${tip}')`);
      if (!held) continue;
      await w.mouse('mouseMoved', held.x, held.y);
      await w.mouse('mousePressed', held.x, held.y);
    }
    expect(held !== null, 'the finger is not in sight');
    const cap = await w.ask(`redman.position('${button}')`);  // not pressed
    let pressing = false;
    for (let step = 0; await w.state('take.episodes') === episode; ++step) {
      const [finger, taken] = await w.ask(`[redman.position('${tip}'), redman.held()]`);
      const far = Math.abs(cap[0] - finger[0]), top = cap[2] + 0.01 + 0.012;  // of the button, and the tip's radius
      pressing = pressing || far < 0.006;
      // the pointer stands off the point that it has taken by what the finger has to go
      const way = [cap[0] - finger[0], 0, top + (pressing ? -below : above) - finger[2]];
      const to = await w.ask(`redman.pixel(${JSON.stringify(taken.map((v, i) => v + way[i]))})`);
      await w.mouse('mouseMoved', to.x, to.y);
      await w.page.drawn();
      if (picture && episode === 0 && step === 60) await w.picture(picture);
      await w.told({ do: 'step' });
      await w.until(`redman.state.step[0] === ${step + 1} || redman.state.take.episodes > ${episode}`, 'a step does not come');
    }
    await w.mouse('mouseReleased', held.x, held.y);
    await w.told({ do: 'release' });
    await w.told({ do: 'reset' });
  }
  await w.click('#take');
  await w.until('!redman.state.take', 'the recording does not end');
  await w.end();
  await program.end();
})().catch(e => { console.log(e.stack); process.exitCode = 1; }).then(() => {
  for (const child of children) child.kill();
  process.exit();
});
