// The page of `redman view`: what the program tells of its worlds is drawn, and what is done here is told to it. It keeps
// curves, and nothing else of the worlds. Others may steer it: window.redman = {ready, state, ask(what), ...}.
'use strict';
const redman = window.redman = {};
(() => {
  const $ = id => document.getElementById(id);
  let world = null, view = null, model = null, frame = null, extent = 1, contactPeak = 1e-6, mine = 0;
  let newest = null, asked = 0, errorTimer = 0, curvesAt = 0, limitAt = 0;
  const waiting = new Map(), times = [];
  const contacts = { xyz: new Float32Array(3 * 128), force: new Float32Array(3 * 128), unit: 1, end: [0], most: 128 };
  const curve = { at: [], ret: [], sums: [], watched: 0 };

  // ---- the program ----
  const socket = new WebSocket('ws://' + location.host + location.pathname + 'live');
  socket.binaryType = 'arraybuffer';
  const tell = what => { if (socket.readyState === 1) socket.send(JSON.stringify(what)); };
  // The same, with the answer.
  const ask = what => new Promise((resolve, reject) => {
    waiting.set(++asked, { resolve, reject });
    tell({ ...what, id: asked });
  });
  function complain(text) {
    $('error').textContent = text;
    $('error').hidden = !text;
    clearTimeout(errorTimer);
    errorTimer = setTimeout(() => { $('error').hidden = true; }, 8000);
  }
  const request = what => ask(what).catch(e => complain(e.message));
  socket.onclose = () => {
    $('message').textContent = 'The program has ended.';
    $('message').hidden = false;
  };
  let opened;
  redman.ready = new Promise(r => { opened = r; });
  socket.onmessage = ({ data }) => {
    if (typeof data !== 'string') return void (newest = readFrame(data));  // tick() draws it
    const said = JSON.parse(data);
    if (said.say === 'scene') return open(said);
    const asker = waiting.get(said.id);
    waiting.delete(said.id);
    if (!asker) return void (said.error && complain(said.error));
    if (said.error) asker.reject(new Error(said.error));
    else asker.resolve(said);
  };

  const hand = openHand($('sliders'), (entry, value) => {
    mine = performance.now();
    tell({ do: 'action', entry, value });
  });

  // ---- worlds ----
  // In rows, the first one where it stands by itself.
  const columns = () => Math.ceil(Math.sqrt(world.worlds));
  const place = w => (world.worlds === 1 ? [0, 0] : [1.15 * extent * (w % columns()), 1.15 * extent * Math.floor(w / columns())]);
  function sizeOf() {
    const low = [Infinity, Infinity], high = [-Infinity, -Infinity];
    world.shapes.forEach((s, i) => {
      if (s.kind === PLANE) return;
      const r = Math.max(...s.size);
      for (let k = 0; k < 2; ++k) {
        low[k] = Math.min(low[k], world.poses[7 * i + k] - r);
        high[k] = Math.max(high[k], world.poses[7 * i + k] + r);
      }
    });
    return Math.max(0.3, Math.hypot(high[0] - low[0], high[1] - low[1]) || 0);
  }
  function open(told) {
    const first = !world;
    world = told;
    world.poses = new Float32Array(told.poses);
    extent = sizeOf();
    frame = newest = null;
    Object.assign(curve, { at: [], ret: [], sums: [] });
    ({ model, view } = showScene(view, world.shapes, () => modelOf(world.shapes, world.poses, world.worlds, place), contacts, mouse.arrow));
    $('task').textContent = words(world.task);
    $('summary').textContent = `${world.summary}. ${world.obs} observations, ${world.actions.length} actions, ${Math.round(1 / world.dt)} steps in a second.`;
    $('picture').replaceChildren(new Option('no picture', ''), ...world.cameras.map(c => new Option('seen by ' + words(c.name), c.name)));
    showPicture('');
    const stands = world.cameras.filter(c => !c.mounted && !c.name.startsWith('cloud'));
    cameraButtons($('cameras'), (world.worlds > 1 ? ['all'] : []).concat(stands.map(c => c.name)), look);
    $('actors').replaceChildren(...world.actors.map(who => {
      const b = document.createElement('button');
      b.textContent = who.split('/').pop();
      b.title = who;
      b.dataset.actor = who;
      b.onclick = () => request({ do: 'act', who });
      return b;
    }));
    $('world-box').hidden = world.worlds === 1;
    $('world').replaceChildren(...Array.from({ length: world.worlds }, (_, w) => new Option(String(w), w)));
    costRows($('costs'), world.costs);
    $('curves').replaceChildren(...[null, ...world.costs].map(() => document.createElement('canvas')));
    hand.open(world.actions);
    for (const id of ['again', 'picture', 'actors', 'stops-box', 'options-card']) $(id).hidden = !!world.fed;
    $('shield').hidden = !!world.fed && !world.shields;
    $('take').hidden = !world.record;
    const leads = !world.fed || world.leads;  // another program has to try what an action does
    $('mouse').querySelector('[value=lead]').disabled = !leads;
    if (!leads) $('mouse').value = 'pull';
    $('limit-box').hidden = !world.limit_range;
    if (world.limit_range) [$('limit').min, $('limit').max] = world.limit_range;
    options();
    look(!first ? looking : world.worlds > 1 ? 'all' : /^(hand_over|catch)/.test(world.task) ? 'close' : 'front');
    opened(true);
  }
  let looking = 'front';
  // All worlds, from where the first camera is, as much further away as they are wider.
  function overview() {
    const c = world.cameras[0], times = 0.75 * columns() + 0.25, [wide] = place(columns() - 1), [, deep] = place(world.worlds - 1);
    const target = [c.target[0] + wide / 2, c.target[1] + deep / 2, c.target[2]], arm = c.eye.map((v, k) => v - c.target[k]);
    arm[2] += 0.5 * Math.hypot(...arm);
    return { name: 'all', fov_y: c.fov_y, target, eye: target.map((v, k) => v + times * arm[k]), all: true };
  }
  function look(name) {
    const c = name === 'all' && world.worlds > 1 && world.cameras.length ? overview() : world.cameras.find(c => c.name === name) || world.cameras[0];
    if (!c || !view) return;
    looking = c.name;
    const [x, y] = c.all ? [0, 0] : place(frame ? frame.watched : 0), moved = p => [p[0] + x, p[1] + y, p[2]];
    view.look({ ...c, eye: moved(c.eye), target: moved(c.target) });
    for (const b of $('cameras').children) b.setAttribute('aria-pressed', b.textContent === c.name);
  }

  // A frame that is not drawn, as a later one came, has its rows for the curves all the same.
  function readFrame(data) {
    const size = new DataView(data).getUint32(0, true), head = JSON.parse(new TextDecoder().decode(new Uint8Array(data, 4, size)));
    head.values = new Float32Array(data, 4 + size);
    if (curve.watched !== head.watched) Object.assign(curve, { at: [], ret: [], sums: [], watched: head.watched });
    while (curve.at.length && curve.at[curve.at.length - 1] > head.last) curve.at.pop(), curve.ret.pop(), curve.sums.pop();
    while (curve.at.length && curve.at[0] < head.first) curve.at.shift(), curve.ret.shift(), curve.sums.shift();
    head.rows.forEach(([ret, ...sums], k) => {
      const at = head.at - head.rows.length + 1 + k;
      if (curve.at.length && at <= curve.at[curve.at.length - 1]) return;
      curve.at.push(at);
      curve.ret.push(ret);
      curve.sums.push(sums);
    });
    return head;
  }
  function showFrame(head) {
    const before = frame, values = head.values, poses = 7 * world.worlds * world.moving.length;
    frame = head;
    times.push(performance.now());
    while (times.length > 90 || (times.length && times[times.length - 1] - times[0] > 3000)) times.shift();
    if (view) {
      model.pose(values.subarray(0, poses));
      const rows = values.subarray(poses, poses + 6 * frame.contacts), [x, y] = place(frame.watched);
      for (let i = 0; i < frame.contacts; ++i)
        for (let k = 0; k < 3; ++k) {
          const force = rows[6 * i + 3 + k];
          contactPeak = Math.max(contactPeak, Math.abs(force));
          contacts.xyz[3 * i + k] = rows[6 * i + k] + (k === 0 ? x : k === 1 ? y : 0);
          contacts.force[3 * i + k] = force / contactPeak * 32767;
        }
      contacts.end[0] = frame.contacts;
      const from = poses + 6 * frame.contacts;
      showCloud(values.subarray(from, from + 3 * frame.points), values.subarray(from + 3 * frame.points, from + 4 * frame.points), [x, y]);
      view.show(0);
      if (mouse.grabbed) mouse.pull(newton());
      if (before && before.watched !== frame.watched) look(looking);
    }
    showNumbers(frame.watched);
  }
  // The cloud, coloured by what its points lie on.
  const inks = ['#0072b2', '#e69f00', '#009e73', '#cc79a7', '#56b4e9', '#d55e00', '#f0e442', '#000000'].map(c => new THREE.Color(c));
  let cloud = null;
  function showCloud(rows, kinds, [x, y]) {
    const count = kinds.length;
    if (!cloud || cloud.view !== view || cloud.count !== count) {
      if (!count && !(cloud && cloud.view === view)) return;
      if (!cloud || cloud.view !== view) {
        const shape = new THREE.BufferGeometry();
        cloud = { view, object: new THREE.Points(shape, new THREE.PointsMaterial({ size: 3.5, sizeAttenuation: false, vertexColors: true })) };
        if (parseInt(THREE.REVISION) < 114) cloud.object.material.vertexColors = THREE.VertexColors || 2;
        cloud.object.frustumCulled = false;
        view.add(cloud.object);
      }
      cloud.count = count;
      for (const name of ['position', 'color']) cloud.object.geometry.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * count), 3));
      cloud.object.geometry.setDrawRange(0, count);
    }
    const at = cloud.object.geometry.attributes;
    for (let i = 0; i < count; ++i) {
      const c = inks[kinds[i] % inks.length];
      at.position.setXYZ(i, rows[3 * i] + x, rows[3 * i + 1] + y, rows[3 * i + 2]);
      at.color.setXYZ(i, c.r, c.g, c.b);
    }
    at.position.needsUpdate = at.color.needsUpdate = true;
  }
  // A picture by a camera of the world, a few times a second.
  let pictured = '', pictureAt = 0, asking = false;
  function showPicture(camera) {
    pictured = $('picture').value = camera;
    pictureAt = 0;
    $('inset').hidden = !camera;
  }
  async function fetchPicture(now) {
    if (!pictured || asking || now - pictureAt < 200 || !frame) return;
    asking = true;
    pictureAt = now;
    const told = await request({ do: 'picture', camera: pictured });
    asking = false;
    if (told) $('inset').src = 'data:image/png;base64,' + told.png;
    else showPicture('');
  }

  const pressed = (id, on) => $(id).setAttribute('aria-pressed', on);
  function showNumbers(w) {
    $('return').textContent = number(frame.return[w]);
    $('reward').textContent = number(frame.reward[w]);
    $('episode').textContent = `step ${frame.step[w]} of ${world.steps} · ${(frame.step[w] * world.dt).toFixed(2)} s`;
    $('rate').textContent = frame.plays && times.length > 5 ? (1000 * (times.length - 1) / (times[times.length - 1] - times[0])).toFixed(0) : '\u2013';
    if (frame.limit !== undefined) {
      world.costs[0].limit = frame.limit;
      $('limit-text').textContent = number(frame.limit);
      if (performance.now() - limitAt > 400) $('limit').value = frame.limit;  // else it lags behind the slider
    }
    showCosts($('costs'), world.costs, frame.sum);
    $('time').min = frame.first;
    $('time').max = frame.last;
    if (document.activeElement !== $('time') || frame.plays) $('time').value = frame.at;
    const back = frame.last - frame.at;
    $('where').textContent = back ? `${back} steps back` : `${frame.last - frame.first} steps kept`;
    $('play').innerHTML = frame.plays ? '&#10074;&#10074;' : '&#9654;';
    const text = frame.success[w] ? 'success' : frame.ended[w] === 2 ? 'ended' : frame.ended[w] ? 'time is up' : '';
    $('state').hidden = !text;
    $('state').textContent = text;
    $('state').className = 'state ' + (frame.success[w] ? 'good' : 'bad');
    for (const b of $('actors').children) b.setAttribute('aria-pressed', b.dataset.actor === frame.who);
    pressed('hand', frame.hand);
    pressed('shield', frame.shield);
    $('view').classList.toggle('stepped-in', !!frame.stepped_in[w]);
    $('world').value = w;
    $('stops').checked = frame.stops;
    $('speed').value = [...$('speed').options].reduce((a, o) => (Math.abs(o.value - frame.speed) < Math.abs(a - frame.speed) ? o.value : a), 1);
    $('take').classList.toggle('on', !!frame.take);
    $('take').textContent = frame.take ? `recording: ${frame.take.episodes} kept` + (frame.take.pushed ? ', this one was pulled' : '') : 'record';
    if (!frame.hand || performance.now() - mine > 400) hand.show(frame.action);  // else it lags behind the sliders
    curvesOld = true;
  }
  let curvesOld = false;
  function drawCurves(now = 0) {
    curvesAt = now;
    if (now && !curvesOld) return;
    curvesOld = false;
    if (!frame || !$('curves-box').open || !curve.at.length) return;
    plot($('curves').children[0], curve.at, curve.ret, null, 'return', ink('--accent'), frame.at);
    world.costs.forEach((c, k) => plot($('curves').children[k + 1], curve.at, curve.sums.map(s => s[k]), c.limit >= 0 ? c.limit : null, words(c.name), ink('--ink'), frame.at));
  }

  // ---- options ----
  const NUMBER = 0, INTEGER = 1, FLAG = 2;
  function options() {
    const give = (key, value) => request({ do: 'set', key, value: String(value) });
    $('options').replaceChildren(...world.options.filter(o => o.level === 0).flatMap(o => {
      const label = document.createElement('label');
      label.textContent = words(o.key);
      label.title = o.help;
      let input = document.createElement('input');
      const words_ = o.choices && o.kind > FLAG ? o.choices.split('|') : null;
      if (o.kind === FLAG) {
        Object.assign(input, { type: 'checkbox', checked: o.value === 'true' || o.value === '1' });
        input.onchange = () => give(o.key, input.checked);
      } else if (words_) {
        input = document.createElement('select');
        input.append(...words_.map(w => new Option(w, w)));
        input.value = o.value;
        input.onchange = () => give(o.key, input.value);
      } else if ((o.kind === NUMBER || o.kind === INTEGER) && o.high - o.low <= 100 && Number.isFinite(Number(o.value))) {
        const range = document.createElement('input'), text = document.createElement('span');
        Object.assign(range, { type: 'range', min: o.low, max: o.high, step: o.kind === INTEGER ? 1 : 'any', value: o.value });
        text.className = 'number';
        text.textContent = o.value;
        range.oninput = () => { text.textContent = o.kind === INTEGER ? range.value : Number(range.value).toPrecision(3); };
        range.onchange = () => give(o.key, text.textContent);
        input = document.createElement('div');
        input.className = 'range';
        input.append(range, text);
      } else {
        Object.assign(input, { type: 'text', value: o.value });
        input.onchange = () => give(o.key, input.value);
      }
      return [label, input];
    }));
  }

  // ---- the mouse, buttons and keys ----
  const shapeOf = index => ({ shape: index % world.shapes.length, w: Math.floor(index / world.shapes.length) });
  const mouse = openPush($('view'), () => view && {
    view, extent, can: i => !world.shapes[shapeOf(i).shape].fixed,
    text: i => world.shapes[shapeOf(i).shape].name + (world.worlds > 1 ? ', world ' + shapeOf(i).w : ''),
  }, () => {
    const g = mouse.grabbed;
    if (!g) return tell({ do: 'release' });
    const { shape, w } = shapeOf(g.index), [x, y] = place(w);
    tell({ do: 'grab', world: w, shape, local: g.local.toArray(), to: [g.to.x - x, g.to.y - y, g.to.z], newton: newton(), reach: mouse.reach(), leads: $('mouse').value === 'lead' });
    mouse.pull(newton());
    view.show(0);
  });
  const newton = () => Math.pow(10, Number($('strength').value));
  const showNewton = () => { const v = newton(); $('newton').textContent = (v < 10 ? v.toFixed(1) : v.toFixed(0)) + ' N'; };
  const play = on => request({ do: 'play', on });
  const seek = at => request({ do: 'seek', at: Math.max(frame.first, Math.min(frame.last, at)) });
  const step = by => (by > 0 && frame.at === frame.last ? request({ do: 'step' }) : seek(frame.at + by));
  async function take() {
    const told = await request({ do: 'record', on: !frame.take });
    if (told && told.episodes !== undefined)
      complain(told.file ? `wrote ${told.file}: ${told.episodes} episodes, ${told.steps} steps` : 'nothing was written: no episode came to its end' +
        (told.dropped ? ` without a pull, ${told.dropped} with one` : ''));
  }
  $('limit').oninput = e => {
    limitAt = performance.now();
    request({ do: 'limit', value: Number(e.target.value) });
  };
  $('play').onclick = () => play(!frame.plays);
  $('step').onclick = () => step(1);
  $('back').onclick = () => step(-1);
  $('again').onclick = () => request({ do: 'reset' });
  $('time').oninput = e => seek(Number(e.target.value));
  $('speed').onchange = e => request({ do: 'speed', times: Number(e.target.value) });
  $('stops').onchange = e => request({ do: 'stops', on: e.target.checked });
  $('contacts').onchange = e => {
    request({ do: 'contacts', on: e.target.checked });
    if (view) view.setContacts(e.target.checked);
  };
  $('hand').onclick = () => request({ do: 'hand', on: !frame.hand });
  $('shield').onclick = () => request({ do: 'shield', on: !frame.shield });
  $('world').onchange = e => request({ do: 'watch', world: Number(e.target.value) });
  $('strength').oninput = showNewton;
  $('picture').onchange = e => showPicture(e.target.value);
  $('take').onclick = take;
  $('curves-box').ontoggle = () => drawCurves();
  document.addEventListener('keydown', e => {
    if (!frame || ['SELECT', 'INPUT'].includes(e.target.tagName) || e.ctrlKey || e.metaKey || e.altKey) return;
    if (e.key === ' ' && e.target.tagName !== 'BUTTON') play(!frame.plays);
    else if (e.key === 'ArrowLeft') step(-1);
    else if (e.key === 'ArrowRight') step(1);
    else return;
    e.preventDefault();
  });
  window.addEventListener('resize', () => drawCurves());
  matchMedia('(prefers-color-scheme: dark)').addEventListener('change', () => drawCurves());

  let before = 0;
  function tick(now) {
    if (frame && before) hand.drive(Math.min(0.1, (now - before) / 1000));
    before = now;
    const head = newest;
    newest = null;
    if (head) showFrame(head);
    if (view) view.draw();
    if (head) tell({ do: 'shown' });  // the program sends no faster than is drawn here
    if (now - curvesAt > 100) drawCurves(now);
    fetchPicture(now);
    requestAnimationFrame(tick);
  }
  showNewton();
  requestAnimationFrame(tick);

  Object.defineProperty(redman, 'state', { get: () => frame });
  Object.defineProperty(redman, 'world', { get: () => world });
  Object.assign(redman, {
    ask, look, take, curve, hand,
    position: name => (view ? view.position(name) : null),
    // Where a point, m, is in the page, in pixels.
    pixel(point) {
      const r = $('view').getBoundingClientRect(), [x, y] = view.screen(point);
      return { x: r.left + (x + 1) / 2 * r.width, y: r.top + (1 - y) / 2 * r.height };
    },
    // Where the point that is held is, m, or null.
    held: () => (mouse.grabbed ? mouse.grabbed.object.localToWorld(mouse.grabbed.local.clone()).toArray() : null),
    // Where a shape is in the page, in pixels, and what of it can be hit: {name, x, y}, or null.
    movable(wanted) {
      const r = $('view').getBoundingClientRect();
      view.draw();
      for (let row = 1; row < 72; ++row)
        for (let k = 1; k < 96; ++k) {
          const hit = view.hitAt(k / 48 - 1, 1 - row / 36);
          if (hit && !world.shapes[shapeOf(hit.index).shape].fixed && (!wanted || hit.name === wanted))
            return { name: hit.name, x: r.left + k / 96 * r.width, y: r.top + row / 72 * r.height };
        }
      return null;
    },
  });
})();
