// The page: one world in the main thread, stepped in time with the clock; training in a worker.
// Others may steer it: window.redman = {ready, task(name), actor(name), play(), pause(), step(n), reset(seed), ...}.
'use strict';
const redman = window.redman = {};
redman.ready = (async () => {
  const $ = id => document.getElementById(id);
  const bytesOf = base64 => Uint8Array.from(atob(base64), c => c.charCodeAt(0));
  const unpacked = async bytes =>
    new Uint8Array(await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'))).arrayBuffer());
  const sleep = () => new Promise(r => setTimeout(r));

  const wasm = await unpacked(bytesOf($('wasm').textContent));
  const engine = openEngine(await createRedman({ wasmBinary: wasm }));
  const about = engine.about();
  $('about').textContent = `redman ${about.version} in WebAssembly, ${thousands(wasm.length / 1024)} kB`;

  let task = '', actor = 'zero', world = null, view = null, model = null, playing = false, owed = 0, before = 0, seed = 1;
  let settings = '', learned = null, learnedTask = '', learnedLimits = null, played = 0, contactPeak = 1e-6, shown = '';
  const finished = { count: 0, success: 0 }, timed = { ms: 0, steps: 0 };  // of the last hundred or so steps
  const contacts = { xyz: new Float32Array(3 * 128), force: new Float32Array(3 * 128), unit: 1, end: [0], most: 128 };

  // ---- what is shown ----
  function showNumbers(n) {
    $('return').textContent = number(n.ret);
    $('reward').textContent = number(n.reward);
    $('rate').textContent = timed.steps > 5 ? thousands(1000 * timed.steps / timed.ms) : '\u2013';
    $('where').textContent = `step ${n.step} of ${world.steps} · ${(n.step * world.dt).toFixed(2)} s`;
    const success = finished.count ? `, ${(100 * finished.success / finished.count).toFixed(0)}% with success` : '';
    $('episodes').textContent = `${finished.count} finished${success}`;
    showCosts($('costs'), world.costs, n.sum);
  }
  function showState(text, good) {
    $('state').hidden = !text;
    $('state').textContent = text;
    $('state').className = 'state ' + (good ? 'good' : 'bad');
    shown = text;
  }
  function pose() {
    if (!view) return;
    model.pose(engine.poses(world.shapes.length));
    if ($('contacts').checked) {
      const { count, rows } = engine.contacts();
      for (let i = 0; i < count; ++i)
        for (let k = 0; k < 3; ++k) {
          const force = rows[6 * i + 3 + k];
          contactPeak = Math.max(contactPeak, Math.abs(force));
          contacts.xyz[3 * i + k] = rows[6 * i + k];
          contacts.force[3 * i + k] = force / contactPeak * 32767;
        }
      contacts.end[0] = count;
    }
    view.show(0);
  }
  function look(name) {
    const c = world.cameras.find(c => c.name === name) || world.cameras[0];
    if (!c || !view) return;
    view.look(c);
    for (const b of $('cameras').children) b.setAttribute('aria-pressed', b.textContent === c.name);
  }

  // ---- the world ----
  const demonstration = () => redmanDemonstrations[task];
  // A policy for any limit observes what is left of it, so its world tells it.
  const rangeOf = limits => `limit_range=${limits[0]}..${limits[1]}`;
  const settingsOf = who => who === 'demonstration' && demonstration() ? demonstration().settings || ''
    : who === 'learned' && learnedLimits ? 'budget=show\n' + rangeOf(learnedLimits) : '';
  function setLimit() {
    if ($('limit-box').hidden) return;
    const limit = Number($('limit').value);
    engine.limit(limit);
    world.costs[0].limit = limit;
    $('limit-text').textContent = number(limit);
  }
  function begin(from) {
    seed = actor === 'demonstration' ? demonstration().seed : from;
    engine.reset(seed);
    setLimit();
    played = 0;
    pose();
    showNumbers({ reward: 0, ret: 0, step: 0, sum: world.costs.map(() => 0) });
  }
  function open(name) {
    settings = settingsOf(actor);
    engine.open(name, 1, settings);
    world = engine.scene();
    world.limit = world.costs.length ? world.costs[0].limit : -1;
    task = name;
    const any = actor === 'learned' && learnedLimits;
    $('limit-box').hidden = !any;
    if (any) Object.assign($('limit'), { min: any[0], max: any[1], value: any[1] });
    $('any-limit').disabled = !(world.limit > 0);
    finished.count = finished.success = 0;
    timed.ms = timed.steps = 0;
    ({ model, view } = showScene(view, world.shapes, () => modelOf(world.shapes, engine.poses(world.shapes.length)), contacts, mouse.arrow));
    cameraButtons($('cameras'), world.cameras.map(c => c.name).filter(name => !name.startsWith('cloud')), look);  // not what eyes look from
    look(/^(hand_over|catch)/.test(task) ? 'close' : 'front');
    costRows($('costs'), world.costs);
    $('summary').textContent = `${world.summary}. ${world.obs} observations, ${world.actions} actions, ${Math.round(1 / world.dt)} steps in a second.`;
    $('task').value = name;
  }
  function can(who) {
    return who === 'trained' ? task in redmanPolicies : who === 'demonstration' ? task in redmanDemonstrations : who === 'learned' ? learnedTask === task : true;
  }
  function showActors() {
    for (const b of $('actors').children) {
      b.setAttribute('aria-pressed', b.dataset.actor === actor);
      b.disabled = !can(b.dataset.actor);
    }
  }
  function act(who) {
    if (!can(who)) return;
    actor = who;
    if (settingsOf(who) !== settings) open(task);
    if (who === 'trained') engine.policy(bytesOf(redmanPolicies[task]));
    if (who === 'learned') engine.policy(learned);
    showState('');
    begin(seed);
    showActors();
  }
  function choose(name) {
    mouse.end();
    actor = 'zero';
    open(name);
    act(['trained', 'learned', 'demonstration', 'zero'].find(can));
  }
  // One control step; false at the end of an episode.
  function step() {
    const given = actor === 'demonstration' ? demonstration() : null;
    if (given && !given.rows) given.rows = new Float32Array(bytesOf(given.actions).buffer);
    push();
    const began = performance.now();
    if (given) engine.step(engine.actors.given, given.rows.slice(played * world.actions, (played + 1) * world.actions));
    else engine.step(engine.actors[actor === 'trained' || actor === 'learned' ? 'policy' : actor]);
    timed.ms = 0.99 * timed.ms + performance.now() - began;
    timed.steps = 0.99 * timed.steps + 1;
    ++played;
    const n = redman.last = engine.numbers(world.costs.length);
    showState(n.success ? 'success' : shown === 'success' && !n.terminated ? 'success' : n.terminated ? 'ended' : '', n.success || shown === 'success');
    const over = n.terminated || n.truncated || (given && (played + 1) * world.actions > given.rows.length);
    if (over) {
      ++finished.count;
      if (shown === 'success') ++finished.success;
      redman.finished = n;
      played = 0;
      if (actor === 'learned') engine.policy(learned);
      setLimit();
    }
    showNumbers(n);
    if (over && given) begin(0);
    return !over;
  }
  function play(on) {
    playing = on;
    owed = 0;
    $('play').innerHTML = on ? '&#10074;&#10074;' : '&#9654;';
  }

  // ---- the mouse pushes ----
  const mouse = openPush($('view'), () => view && { view, can: i => !world.shapes[i].fixed, text: i => world.shapes[i].name }, () => {
    if (!mouse.grabbed) pose();
  });
  const newton = () => Math.pow(10, Number($('strength').value));
  const showNewton = () => { const v = newton(); $('newton').textContent = (v < 10 ? v.toFixed(1) : v.toFixed(0)) + ' N'; };
  function push() {
    if (!mouse.grabbed) return;
    pose();
    const force = mouse.pull(newton());
    engine.push(mouse.grabbed.index, force.x, force.y, force.z);
  }

  // ---- training ----
  let worker = null, run = 0;
  const curve = { steps: [], ret: [], cost: [] };
  function drawCurves() {
    $('return-curve').hidden = $('cost-curve').hidden = !curve.task;
    if (!curve.task) return;
    const limit = world && world.limit >= 0 && !curve.limits ? world.limit : null;
    plot($('return-curve'), curve.steps, curve.ret, null, 'return of an episode', ink('--accent'));
    plot($('cost-curve'), curve.steps, curve.cost, curve.task === task || !curve.task ? limit : null, 'cost of an episode', ink('--ink'));
  }
  function stopTraining() {
    ++run;
    if (worker) worker.postMessage({ stop: true });
    $('train').textContent = 'train';
    redman.training = false;
  }
  function startTraining(most = 1e9) {
    const name = task, mine = ++run;
    if (!worker) {
      const source = ['glue', 'engine', 'worker'].map(id => $(id).textContent).join('\n');
      worker = new Worker(URL.createObjectURL(new Blob([source], { type: 'text/javascript' })));
      worker.onerror = e => { $('training').textContent = 'The worker failed: ' + e.message; };
      worker.onmessage = ({ data }) => {
        if (data.run !== run) return;
        if (data.error) $('training').textContent = data.error;
        if (data.error || data.ended) return void stopTraining();
        const e = data.epoch;
        redman.epoch = { ...e, rate: data.rate };
        if (e.episodes > 0) {
          curve.steps.push(e.steps);
          curve.ret.push(e.ret);
          curve.cost.push(e.cost[0] ?? 0);
        }
        if (curve.steps.length > 400) for (const k of ['steps', 'ret', 'cost']) curve[k] = curve[k].filter((_, i) => i % 2 || i === 0);
        $('samples').textContent = `${thousands(data.rate)} samples / s`;
        $('training').textContent = `epoch ${e.epoch}, ${thousands(e.steps)} steps, ${thousands(e.episodes)} episodes` +
          (e.episodes ? `, success ${(100 * e.success).toFixed(0)}%` : '') + `, multiplier ${e.multiplier.toFixed(3)}`;
        if (data.policy) {
          learned = data.policy;
          learnedTask = curve.task;
          learnedLimits = curve.limits;
          if (actor !== 'learned') showActors();
        }
        drawCurves();
      };
    }
    const limits = $('any-limit').checked && world.limit > 0 ? [world.limit / 8, world.limit] : null;
    Object.assign(curve, { steps: [], ret: [], cost: [], task: name, limits });
    if (actor === 'learned') act('zero');
    learnedTask = '';
    showActors();
    worker.postMessage({ start: { run: mine, wasm, task: name, algo: $('algo').value, worlds: Number($('worlds').value), seed: Number($('seed').value), settings: '',
      worldSettings: limits ? 'budget=saute\n' + rangeOf(limits) : '', most } });
    $('train').textContent = 'stop';
    drawCurves();
    $('training').textContent = 'making worlds and networks';
    redman.training = true;
  }

  // ---- proof ----
  async function prove(most = Infinity) {
    const rows = JSON.parse($('golden').textContent), wrong = [];
    let done = 0;
    $('prove').disabled = true;
    for (const [name, kind, hash] of rows.slice(0, most)) {
      $('proof').textContent = `${done} of ${rows.length} equal: ${name} ${kind === '-' ? '' : kind}`;
      await sleep();
      if (engine.hash(name, kind) === hash) ++done;
      else wrong.push(name);
    }
    $('proof').textContent = `${done} of ${Math.min(most, rows.length)} hashes are those recorded on x86-64` + (wrong.length ? '; not: ' + wrong.join(', ') : '.');
    $('prove').disabled = false;
    return { done, wrong };
  }

  // ---- buttons ----
  for (const t of about.tasks) $('task').append(new Option(words(t.name), t.name));
  for (const a of about.algos) $('algo').append(new Option(words(a.name), a.name, false, a.name === 'ppo_lag'));
  $('task').onchange = e => choose(e.target.value);
  for (const b of $('actors').children) b.onclick = () => act(b.dataset.actor);
  $('play').onclick = () => play(!playing);
  $('step').onclick = () => { play(false); step(); pose(); };
  $('again').onclick = () => begin(seed + 1);
  $('contacts').onchange = e => { if (view) view.setContacts(e.target.checked); pose(); };
  $('limit').oninput = setLimit;
  $('strength').oninput = showNewton;
  $('train').onclick = () => (redman.training ? stopTraining() : startTraining());
  $('prove').onclick = () => prove();
  document.addEventListener('keydown', e => {
    if (['SELECT', 'INPUT', 'BUTTON'].includes(e.target.tagName) || e.key !== ' ') return;
    play(!playing);
    e.preventDefault();
  });
  window.addEventListener('resize', drawCurves);
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', drawCurves);

  function frame(now) {
    if (playing && before) {
      owed = Math.min(owed + (now - before) / 1000 / world.dt * Number($('speed').value), 12);
      const until = performance.now() + 14;
      for (; owed >= 1 && performance.now() < until; --owed) step();
      pose();
    }
    before = now;
    if (view) view.draw();
    requestAnimationFrame(frame);
  }

  showNewton();
  choose('hand_over_safe_finger');
  drawCurves();
  play(!matchMedia('(prefers-reduced-motion: reduce)').matches);
  requestAnimationFrame(frame);
  Object.defineProperty(redman, 'state', { get: () => ({ task, actor, playing, seed, step: redman.last ? redman.last.step : 0, finished: finished.count, learned: learnedTask }) });
  Object.assign(redman, {
    engine, prove, look, choose, act, begin, play: () => play(true), pause: () => play(false), train: startTraining, stop: stopTraining,
    step(n = 1) {
      for (let i = 0; i < n; ++i) step();
      pose();
    },
    position: name => (view ? view.position(name) : null),
    movable() {  // something in sight that a mouse can push: {name, x, y}, in pixels of the page
      const r = $('view').getBoundingClientRect();
      view.draw();
      for (let row = 1; row < 24; ++row)
        for (let k = 1; k < 32; ++k) {
          const hit = view.hitAt(k / 16 - 1, 1 - row / 12);
          if (hit && !world.shapes[hit.index].fixed) return { name: hit.name, x: r.left + k / 32 * r.width, y: r.top + row / 24 * r.height };
        }
      return null;
    },
  });
  return true;
})();
redman.ready.catch(e => { document.getElementById('message').textContent = 'This page cannot run here: ' + e.message; });
