// open_pages.cjs MODULES PAGES: opens what test_tool_pages.sh made in headless Chromium. Pages show something, move with
// the time and have no errors; another viewer (three's GLTFLoader) sees the shapes where our page has them.
'use strict';
const fs = require('fs'), http = require('http'), path = require('path');
const { open } = require('./browse.cjs');
const [modules, pages] = process.argv.slice(2);
const at = name => path.join(pages, name);
function expect(good, text) {
  if (good) return;
  console.log(text);
  process.exitCode = 1;
}
const near = (a, b, gap) => a.every((v, i) => Math.abs(v - b[i]) <= gap);

// How many colours the canvas has, and a sum that changes with the picture.
const colours = `(() => {
  const c = document.getElementById('scene'), copy = document.createElement('canvas');
  copy.width = 160; copy.height = 100;
  const g = copy.getContext('2d');
  return new Promise(r => requestAnimationFrame(() => {
    g.drawImage(c, 0, 0, 160, 100);
    const d = g.getImageData(0, 0, 160, 100).data, seen = new Set();
    let sum = 0;
    for (let i = 0; i < d.length; i += 4) { seen.add(d[i] << 16 | d[i + 1] << 8 | d[i + 2]); sum = (sum * 31 + d[i] + d[i + 1] + d[i + 2]) % 1000000007; }
    r({ count: seen.size, sum });
  }));
})()`;

async function player(name, { moving, fixed, dark, scene = true }) {
  const page = await open(at(name + '.html'), { dark });
  try {
    const frames = await page.ask('redman.frames');
    if (scene) {
      const first = await page.ask('redman.seek(0), ' + colours), from = await page.ask(`redman.position('${moving}')`);
      expect(first.count > 50, `${name}: the canvas shows ${first.count} colours`);
      const middle = Math.floor(frames / 2);
      const then = await page.ask(`redman.seek(${middle}), ` + colours), to = await page.ask(`redman.position('${moving}')`);
      expect(then.sum !== first.sum, `${name}: the picture does not change with the time`);
      expect(!near(from, to, 1e-4), `${name}: ${moving} does not move: ${from} ${to}`);
      if (fixed) expect(near(await page.ask(`redman.position('${fixed}')`), [0, 0, 0], 5), `${name}: ${fixed} is not there`);
      const other = await page.ask(`redman.camera('top'), ` + colours);
      expect(other.sum !== then.sum, `${name}: the camera does not change the picture`);
      await page.ask(`document.getElementById('contacts').click()`);
      // a drag turns the view
      const drag = (type, x, y) => page.call('Input.dispatchMouseEvent', { type, x, y, button: 'left', buttons: type === 'mouseReleased' ? 0 : 1 });
      await drag('mousePressed', 500, 300);
      await drag('mouseMoved', 620, 340);
      await drag('mouseReleased', 620, 340);
      expect((await page.ask(colours)).sum !== other.sum, `${name}: a drag does not turn the view`);
      await page.ask(`redman.camera(document.querySelector('#cameras button').textContent)`);
    }
    await page.ask(`redman.seek(${frames - 2}), redman.play()`);
    for (let i = 0; i < 300 && (await page.ask('redman.step')) < frames - 1; ++i) await new Promise(r => setTimeout(r, 50));
    expect(await page.ask('redman.step') === frames - 1, `${name}: playing does not reach the end`);
    const panels = await page.ask(`document.querySelectorAll('#curves canvas').length`);
    expect(panels >= 2, `${name}: ${panels} curves`);
    await page.ask(`redman.seek(${Math.floor(frames / 3)})`);
    await page.drawn();
    await page.picture(at(name + '.png'));
    expect(page.problems.length === 0, `${name}: ${page.problems}`);
  } finally {
    await page.close();
  }
}

// Frames in which the shield stepped in have a border, others none.
async function bordered(name) {
  const page = await open(at(name + '.html'));
  try {
    const frames = await page.ask('redman.frames');
    const marked = await page.ask(`JSON.parse(document.getElementById('episode').textContent).stepped_in`);
    expect(marked.length > 0 && marked.length < frames, `${name}: the shield stepped in in ${marked.length} of ${frames} frames`);
    for (let k = 0; k < frames; ++k) {
      const width = await page.ask(`redman.seek(${k}), parseFloat(getComputedStyle(document.getElementById('view'), '::after').borderTopWidth) || 0`);
      expect((width > 0) === marked.includes(k), `${name}: frame ${k} has a border of ${width} pixels`);
    }
    expect(page.problems.length === 0, `${name}: ${page.problems}`);
  } finally {
    await page.close();
  }
}

async function report(dark) {
  const page = await open(at('report.html'), { height: 1500, dark });
  try {
    expect(await page.ask(`document.querySelectorAll('svg.chart path.line').length`) >= 6, 'report: curves are missing');
    expect(await page.ask(`document.querySelectorAll('svg.chart path.band').length`) >= 1, 'report: no band over seeds');
    expect(await page.ask(`[...document.querySelectorAll('.strip img')].every(i => i.naturalWidth > 1000)`), 'report: strips are missing');
    const box = await page.ask(`(() => { const r = document.querySelector('svg.chart').getBoundingClientRect(); return [r.left + r.width / 2, r.top + r.height / 2]; })()`);
    await page.call('Input.dispatchMouseEvent', { type: 'mouseMoved', x: box[0], y: box[1] });
    expect(await page.ask(`!document.querySelector('.read').hidden && document.querySelector('.read').textContent.includes('steps')`), 'report: no readout under the pointer');
    await page.ask(`document.querySelector('.legend button').click()`);
    expect(await page.ask(`document.querySelector('svg.chart .s0').style.display`) === 'none', 'report: a line cannot be hidden');
    await page.ask(`document.querySelector('.legend button').click()`);
    await page.picture(at(dark ? 'report-dark.png' : 'report.png'));
    expect(page.problems.length === 0, `report: ${page.problems}`);
  } finally {
    await page.close();
  }
}

// Our file in a viewer that is not ours; its page comes from a server of this machine alone.
async function otherViewer(name, shape) {
  const three = path.join(path.resolve(modules), 'node_modules', 'three');
  const html = `<!doctype html><style>body{margin:0}</style><canvas id="scene" width="900" height="600"></canvas>
    <script type="importmap">{"imports":{"three":"/build/three.module.js"}}</script>
    <script type="module">
      import * as THREE from 'three';
      import { GLTFLoader } from '/examples/jsm/loaders/GLTFLoader.js';
      const gltf = await new GLTFLoader().loadAsync('/${name}.glb');
      const renderer = new THREE.WebGLRenderer({ canvas: document.getElementById('scene'), antialias: true }), scene = new THREE.Scene();
      scene.background = new THREE.Color('#cfd8e0');
      scene.add(gltf.scene, new THREE.HemisphereLight('#ffffff', '#666666', 3));
      const camera = gltf.cameras[0];
      camera.aspect = 1.5;
      camera.updateProjectionMatrix();
      const mixer = new THREE.AnimationMixer(gltf.scene);
      for (const clip of gltf.animations) mixer.clipAction(clip).play();
      window.show = t => { mixer.setTime(t); scene.updateMatrixWorld(true); renderer.render(scene, camera); };
      window.where = n => { const v = new THREE.Vector3(); gltf.scene.getObjectByName(THREE.PropertyBinding.sanitizeNodeName(n)).getWorldPosition(v); return v.toArray(); };
      window.facts = { clips: gltf.animations.length, duration: gltf.animations[0].duration, cameras: gltf.cameras.length };
      show(0);
    </script>`;
  const kinds = { '.js': 'text/javascript', '.glb': 'model/gltf-binary' };
  const server = http.createServer((request, answer) => {
    const file = request.url === '/' ? null : request.url.endsWith('.glb') ? at(request.url.slice(1)) : path.join(three, request.url);
    if (file && !fs.existsSync(file)) return answer.writeHead(request.url === '/favicon.ico' ? 204 : 404).end();
    answer.writeHead(200, { 'content-type': file ? kinds[path.extname(file)] || 'text/plain' : 'text/html' }).end(file ? fs.readFileSync(file) : html);
  });
  await new Promise(r => server.listen(0, '127.0.0.1', r));
  const ours = await open(at(name + '.html'));
  const theirs = await open('http://127.0.0.1:' + server.address().port + '/', { width: 900, height: 600 });
  try {
    for (let i = 0; i < 400 && !(await theirs.ask('!!window.facts')); ++i) await new Promise(r => setTimeout(r, 50));
    const facts = await theirs.ask('window.facts'), frames = await ours.ask('redman.frames');
    expect(facts && facts.clips === 1 && facts.cameras > 0, `${name}.glb: ${JSON.stringify(facts)}, ${theirs.problems}`);
    const dt = facts.duration / (frames - 1);
    for (const k of [0, Math.floor(frames / 3), Math.floor(frames / 2), frames - 1]) {
      const [x, y, z] = await ours.ask(`redman.seek(${k}), redman.position('${shape}')`);
      // just before a frame, as a clip starts anew at its end
      const there = await theirs.ask(`show(${Math.max(0, k * dt - 1e-6)}), where('${shape}')`);
      expect(near(there, [x, z, -y], 1e-4), `${name}.glb: at frame ${k} ${shape} is at ${there}, in our page at ${[x, y, z]}`);
    }
    await theirs.ask(`show(${Math.floor(frames / 3) * dt})`);
    await theirs.picture(at(name + '-gltf.png'));
  } finally {
    await ours.close();
    await theirs.close();
    server.close();
  }
}

(async () => {
  await player('hand', { moving: 'object', fixed: 'right_palm' });
  await player('jenga', { moving: 'target', dark: true });
  await player('one', { scene: false });
  await bordered('wall');
  await report(false);
  await report(true);
  await otherViewer('hand', 'object');
})().catch(e => { console.log(e.message); process.exitCode = 1; });
