// The player: time, speed, cameras, keys; what it holds together is in scene.js and curves.js.
// Others may steer it: window.redman = {frames, step, seek(step), play(), pause(), camera(name), position(shape)}.
'use strict';
(() => {
  const episode = JSON.parse(document.getElementById('episode').textContent), frames = episode.frames;
  const bytes = text => Uint8Array.from(atob(text), c => c.charCodeAt(0));
  const floats = text => new Float32Array(bytes(text).buffer), shorts = text => new Int16Array(bytes(text).buffer);
  const $ = id => document.getElementById(id);
  const glb = bytes(episode.glb);

  let scene = null, time = 0, playing = false, before = 0;
  const curves = openCurves($('curves'), episode.curves.map(c => ({ ...c, step: floats(c.step), sum: floats(c.sum) })), frames, k => seek(k));
  const touch = episode.contacts;
  const contacts = { ...touch, xyz: shorts(touch.xyz), force: shorts(touch.force), most: 0 };
  for (let k = 0; k < frames; ++k) contacts.most = Math.max(contacts.most, contacts.end[k] - (k ? contacts.end[k - 1] : 0));

  function empty(text) {
    $('empty').textContent = text;
    $('empty').hidden = false;
    $('scene').hidden = true;
  }
  if (!episode.shapes) {
    empty('This task has nothing to look at: its world is numbers.');
  } else {
    try {
      scene = openScene($('scene'), readGlb(glb), contacts);
    } catch (e) {
      empty('This browser shows no WebGL here (' + e.message + '); the curves below work all the same.');
    }
  }

  function update() {
    const k = Math.floor(time);
    if (scene) scene.show(time);
    curves.show(k);
    $('time').value = k;
    $('where').textContent = 'step ' + (k + episode.first) + ' of ' + (frames - 1 + episode.first) + ' · ' + (time * episode.dt).toFixed(2) + ' s';
    const last = k === frames - 1, good = episode.success.includes(k), fell = last && episode.terminated && !good;
    $('state').textContent = good ? 'success' : fell ? 'ended' : '';
    $('state').className = good ? 'good' : fell ? 'bad' : '';
    $('view').classList.toggle('stepped-in', episode.stepped_in.includes(k));
  }
  function seek(k) {
    time = Math.min(Math.max(k, 0), frames - 1);
    update();
  }
  function play(on) {
    if (on && time >= frames - 1) time = 0;
    playing = on;
    before = 0;
    $('play').innerHTML = on ? '&#10074;&#10074;' : '&#9654;';
  }
  function camera(name) {
    const c = episode.cameras.find(c => c.name === name);
    if (!c || !scene) return;
    scene.look(c);
    for (const b of $('cameras').children) b.setAttribute('aria-pressed', b.textContent === name);
  }

  for (const c of episode.cameras) {
    const b = document.createElement('button');
    b.textContent = c.name;
    b.onclick = () => camera(c.name);
    $('cameras').append(b, ' ');
  }
  $('time').max = frames - 1;
  $('time').oninput = e => seek(Number(e.target.value));
  $('play').onclick = () => play(!playing);
  $('follow').onchange = e => scene && scene.setFollow(e.target.checked);
  $('contacts').onchange = e => scene && scene.setContacts(e.target.checked);
  $('save').onclick = () => {
    const a = document.createElement('a');
    a.href = URL.createObjectURL(new Blob([glb], { type: 'model/gltf-binary' }));
    a.download = episode.task + '.glb';
    a.click();
    URL.revokeObjectURL(a.href);
  };
  document.addEventListener('keydown', e => {
    if (e.target.tagName === 'SELECT' || e.ctrlKey || e.metaKey || e.altKey) return;
    const jump = { ArrowLeft: -1, ArrowRight: 1, PageUp: -10, PageDown: 10, Home: -frames, End: frames }[e.key];
    if (e.key === ' ') play(!playing);
    else if (jump) play(false), seek(Math.floor(time) + jump);
    else return;
    e.preventDefault();
  });
  $('scene').addEventListener('pointermove', e => {
    const r = $('scene').getBoundingClientRect(), label = $('name');
    const name = e.buttons || playing ? '' : scene.nameAt((e.clientX - r.left) / r.width * 2 - 1, 1 - (e.clientY - r.top) / r.height * 2);
    label.hidden = !name;
    label.textContent = name;
    label.style.left = e.clientX - r.left + 14 + 'px';
    label.style.top = e.clientY - r.top + 10 + 'px';
  });
  $('scene').addEventListener('pointerleave', () => { $('name').hidden = true; });
  window.addEventListener('resize', update);
  matchMedia('(prefers-color-scheme: dark)').onchange = update;

  function tick(now) {
    if (playing && before) {
      time += (now - before) / 1000 / episode.dt * Number($('speed').value);
      if (time >= frames - 1) {
        time = frames - 1;
        play(false);
      }
      update();
    }
    before = now;
    if (scene) scene.draw();
    requestAnimationFrame(tick);
  }

  $('follow-box').hidden = !scene || scene.travel < 0.5;
  if (scene && scene.travel > 10) {  // it leaves what the cameras see
    $('follow').checked = true;
    scene.setFollow(true);
  }
  camera(episode.camera);
  seek(0);
  requestAnimationFrame(tick);
  window.redman = {
    frames, get step() { return Math.floor(time); }, seek, play: () => play(true), pause: () => play(false), camera,
    position: name => (scene ? scene.position(name) : null),
    get shapes() { return scene ? scene.objects.map(o => o.name) : []; },
  };
})();
