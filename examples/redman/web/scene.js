// An episode in three dimensions: our own .glb file, or what is laid out like one (examples/browser), read into
// three, posed at any time, with a camera that a pointer turns. The world is z-up here; the file's root node, which
// turns it for other viewers, is left out.
'use strict';

// Typed arrays of a .glb file by accessor, and its JSON.
function readGlb(bytes) {
  const words = new DataView(bytes.buffer, bytes.byteOffset);
  const jsonSize = words.getUint32(12, true);
  const json = JSON.parse(new TextDecoder().decode(bytes.subarray(20, 20 + jsonSize)));
  const kinds = { 5122: Int16Array, 5123: Uint16Array, 5126: Float32Array };
  const widths = { SCALAR: 1, VEC3: 3, VEC4: 4 };
  const array = index => {
    const a = json.accessors[index], view = json.bufferViews[a.bufferView];
    return new kinds[a.componentType](bytes.buffer, bytes.byteOffset + 28 + jsonSize + view.byteOffset, a.count * widths[a.type]);
  };
  return { json, array };
}

// three answers alike from r111 (Debian's) on, but for colours and the unit of lights.
function makeRenderer(canvas) {
  const renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, preserveDrawingBuffer: true });
  if (!('outputColorSpace' in renderer)) {
    renderer.gammaOutput = true;
    renderer.gammaFactor = 2.2;
  }
  renderer.shadowMap.enabled = true;
  renderer.shadowMap.type = THREE.PCFSoftShadowMap;
  return renderer;
}
const lightUnit = () => (parseInt(THREE.REVISION) >= 155 ? Math.PI : 1);

// A checkered floor that fades into the distance; squares of `square` m.
function makeFloor(square) {
  const tile = document.createElement('canvas');
  tile.width = tile.height = 256;
  const paint = tile.getContext('2d');
  paint.fillStyle = '#ffffff';
  paint.fillRect(0, 0, 256, 256);
  paint.fillStyle = '#dcdcdc';
  paint.fillRect(0, 0, 128, 128);
  paint.fillRect(128, 128, 128, 128);
  const texture = new THREE.CanvasTexture(tile);
  if ('colorSpace' in texture) texture.colorSpace = 'srgb';
  else texture.encoding = THREE.sRGBEncoding;
  const size = 400 * square;
  texture.wrapS = texture.wrapT = THREE.RepeatWrapping;
  texture.repeat.set(size / (2 * square), size / (2 * square));
  texture.anisotropy = 8;
  return new THREE.Mesh(new (THREE.PlaneBufferGeometry || THREE.PlaneGeometry)(size, size),
                        new THREE.MeshStandardMaterial({ map: texture, roughness: 0.95, metalness: 0 }));
}

// show(frame) poses everything (frames may be fractions), look({eye, target, fov_y}) places the camera,
// draw() renders. model: {json, array}, as of readGlb; contacts: {xyz, force, unit, end, most}: see player.js.
function openScene(canvas, model, contacts) {
  const { json, array } = model;
  const renderer = makeRenderer(canvas), world = new THREE.Scene();
  const camera = new THREE.PerspectiveCamera(45, 1, 0.005, 500);
  camera.up.set(0, 0, 1);

  const geometries = (json.meshes || []).map(mesh => {
    const part = mesh.primitives[0], g = new THREE.BufferGeometry();
    g.setAttribute('position', new THREE.BufferAttribute(array(part.attributes.POSITION), 3));
    g.setAttribute('normal', new THREE.BufferAttribute(array(part.attributes.NORMAL), 3));
    g.setIndex(new THREE.BufferAttribute(array(part.indices), 1));
    return g;
  });
  const colors = (json.materials || []).map(m => m.pbrMetallicRoughness.baseColorFactor);
  const materials = colors.map(c => new THREE.MeshStandardMaterial({ color: new THREE.Color(c[0], c[1], c[2]), roughness: 0.55, metalness: 0 }));

  // What is not a plane decides how large the scene is.
  const low = new THREE.Vector3(Infinity, Infinity, Infinity), high = low.clone().negate();
  const solid = json.nodes.filter(n => n.mesh !== undefined && !(n.extras && n.extras.plane));
  for (const n of solid) {
    const g = geometries[n.mesh], at = new THREE.Vector3().fromArray(n.translation);
    g.computeBoundingSphere();
    low.min(at.clone().subScalar(g.boundingSphere.radius));
    high.max(at.clone().addScalar(g.boundingSphere.radius));
  }
  const extent = solid.length ? Math.max(0.3, high.distanceTo(low)) : 1;
  const square = extent < 4 ? 0.1 : Math.pow(10, Math.floor(Math.log10(extent / 4)));

  const floors = [];
  const objects = json.nodes.map(n => {
    if (n.mesh === undefined) return null;
    const plane = n.extras && n.extras.plane, part = json.meshes[n.mesh].primitives[0], c = colors[part.material];
    const o = plane ? makeFloor(square) : new THREE.Mesh(geometries[n.mesh], materials[part.material]);
    o.receiveShadow = true;
    if (plane) floors.push({ material: o.material, color: new THREE.Color(c[0], c[1], c[2]) });
    else o.castShadow = true;
    o.name = n.name;
    o.position.fromArray(n.translation);
    o.quaternion.fromArray(n.rotation);
    world.add(o);
    return o;
  });
  const tracks = new Map();
  for (const clip of json.animations || [])
    for (const { sampler, target } of clip.channels) {
      const t = tracks.get(target.node) || tracks.set(target.node, {}).get(target.node);
      t[target.path] = array(clip.samplers[sampler].output);
    }

  const sky = new THREE.HemisphereLight('#f2f6ff', '#8a8178', 0.58 * lightUnit());
  sky.position.set(0, 0, 1);
  const key = new THREE.DirectionalLight('#fff4e6', 0.82 * lightUnit());
  key.castShadow = true;
  key.shadow.mapSize.set(2048, 2048);
  key.shadow.bias = -0.0004;
  if ('normalBias' in key.shadow) key.shadow.normalBias = 0.002 * extent;
  key.shadow.radius = 3;
  const reach = 0.85 * Math.min(extent, 12);
  Object.assign(key.shadow.camera, { left: -reach, right: reach, top: reach, bottom: -reach, near: 0.1 * reach, far: 8 * reach });
  world.add(sky, key, key.target);

  // Contact points: a ball each, and a line along the force.
  const touch = new THREE.Group(), most = contacts ? contacts.most : 0;
  const ball = new THREE.MeshBasicMaterial({ color: '#e0102a' });
  const round = new (THREE.SphereBufferGeometry || THREE.SphereGeometry)(0.004 * Math.max(1, extent), 10, 8);
  const lines = new THREE.BufferGeometry();
  lines.setAttribute('position', new THREE.BufferAttribute(new Float32Array(6 * most), 3));
  for (let i = 0; i < most; ++i) touch.add(new THREE.Mesh(round, ball));
  const forces = new THREE.LineSegments(lines, new THREE.LineBasicMaterial({ color: '#e0102a' }));
  forces.frustumCulled = false;
  touch.add(forces);
  touch.visible = false;
  world.add(touch);

  const target = new THREE.Vector3(), eye = new THREE.Vector3(), q = new THREE.Quaternion();
  let follow = false, followed = null, dirty = true, frame = 0;

  // The middle of what moves.
  function middle(k) {
    const sum = new THREE.Vector3();
    let n = 0;
    for (const t of tracks.values()) {
      sum.add(new THREE.Vector3(t.translation[3 * k], t.translation[3 * k + 1], t.translation[3 * k + 2]));
      ++n;
    }
    return n ? sum.divideScalar(n) : sum;
  }

  function showContacts(k) {
    const first = k > 0 ? contacts.end[k - 1] : 0, count = contacts.end[k] - first, at = lines.attributes.position;
    for (let i = 0; i < most; ++i) {
      const o = touch.children[i], c = 3 * (first + i);
      o.visible = i < count;
      if (!o.visible) continue;
      o.position.set(contacts.xyz[c], contacts.xyz[c + 1], contacts.xyz[c + 2]).multiplyScalar(contacts.unit);
      at.setXYZ(2 * i, o.position.x, o.position.y, o.position.z);
      const length = 0.15 * Math.max(1, extent) / 32767;  // of the largest force
      at.setXYZ(2 * i + 1, o.position.x + contacts.force[c] * length, o.position.y + contacts.force[c + 1] * length,
                o.position.z + contacts.force[c + 2] * length);
    }
    lines.setDrawRange(0, 2 * count);
    at.needsUpdate = true;
  }

  function show(time) {
    const k = Math.floor(time), part = time - k;
    frame = k;
    for (const [node, t] of tracks) {
      const o = objects[node], a = 3 * k, b = 4 * k;
      o.position.fromArray(t.translation, a);
      o.quaternion.set(t.rotation[b], t.rotation[b + 1], t.rotation[b + 2], t.rotation[b + 3]).normalize();
      if (part > 0 && b + 7 < t.rotation.length) {
        o.position.lerp(new THREE.Vector3().fromArray(t.translation, a + 3), part);
        q.set(t.rotation[b + 4], t.rotation[b + 5], t.rotation[b + 6], t.rotation[b + 7]).normalize();
        o.quaternion.slerp(q, part);
      }
    }
    if (touch.visible) showContacts(k);
    if (follow) {
      const now = middle(k), move = now.clone().sub(followed);
      target.add(move);
      eye.add(move);
      followed = now;
    }
    dirty = true;
  }

  function look(from) {
    eye.fromArray(from.eye);
    target.fromArray(from.target);
    camera.fov = from.fov_y * 180 / Math.PI;
    if (follow) {  // as it would stand beside what has moved on
      const move = middle(frame).sub(middle(0));
      eye.add(move);
      target.add(move);
    }
    dirty = true;
  }

  function orbit(dx, dy) {
    const arm = eye.clone().sub(target), r = arm.length();
    const turn = Math.atan2(arm.y, arm.x) - dx, rise = Math.min(1.55, Math.max(-1.55, Math.asin(arm.z / r) + dy));
    eye.set(Math.cos(turn) * Math.cos(rise), Math.sin(turn) * Math.cos(rise), Math.sin(rise)).multiplyScalar(r).add(target);
    dirty = true;
  }
  function pan(dx, dy) {
    const scale = 2 * Math.tan(camera.fov * Math.PI / 360) * eye.distanceTo(target) / canvas.clientHeight;
    const move = new THREE.Vector3(-dx * scale, dy * scale, 0).applyQuaternion(camera.quaternion);
    eye.add(move);
    target.add(move);
    dirty = true;
  }
  function zoom(factor) {
    eye.sub(target).multiplyScalar(factor).add(target);
    dirty = true;
  }

  const pointers = new Map();
  let spread = 0;
  canvas.addEventListener('pointerdown', e => {
    canvas.setPointerCapture(e.pointerId);
    pointers.set(e.pointerId, e);
    spread = 0;
  });
  for (const end of ['pointerup', 'pointercancel']) canvas.addEventListener(end, e => pointers.delete(e.pointerId));
  canvas.addEventListener('pointermove', e => {
    const before = pointers.get(e.pointerId);
    if (!before) return;
    const dx = e.clientX - before.clientX, dy = e.clientY - before.clientY;
    pointers.set(e.pointerId, e);
    if (pointers.size === 2) {  // two fingers: pinch and pan
      const [a, b] = [...pointers.values()], wide = Math.hypot(a.clientX - b.clientX, a.clientY - b.clientY);
      if (spread) zoom(spread / wide);
      spread = wide;
      pan(dx / 2, dy / 2);
    } else if (e.buttons & 6 || e.shiftKey) {
      pan(dx, dy);
    } else {
      orbit(dx * 0.007, dy * 0.007);
    }
  });
  canvas.addEventListener('wheel', e => {
    e.preventDefault();
    zoom(Math.exp(Math.max(-1, Math.min(1, e.deltaY * 0.0015))));
  }, { passive: false });
  canvas.addEventListener('contextmenu', e => e.preventDefault());

  const dark = matchMedia('(prefers-color-scheme: dark)');
  function paintSky() {
    const color = getComputedStyle(document.documentElement).getPropertyValue('--sky').trim();
    world.fog = new THREE.Fog(color, 4 * extent, 16 * extent);
    for (const f of floors) f.material.color.copy(f.color).multiplyScalar(dark.matches ? 0.3 : 1);
    dirty = true;
  }
  if (dark.addEventListener) dark.addEventListener('change', paintSky);
  else dark.addListener(paintSky);
  paintSky();

  function draw() {
    const w = canvas.clientWidth, h = canvas.clientHeight, ratio = Math.min(window.devicePixelRatio || 1, 2);
    const sized = canvas.width === Math.floor(w * ratio) && canvas.height === Math.floor(h * ratio);
    if (sized && !dirty) return;
    dirty = false;
    if (!sized) {
      renderer.setPixelRatio(ratio);
      renderer.setSize(w, h, false);
    }
    camera.aspect = w / h;
    camera.updateProjectionMatrix();
    camera.position.copy(eye);
    camera.lookAt(target);
    key.target.position.copy(target);
    key.position.set(0.42, -0.38, 0.82).normalize().multiplyScalar(4 * reach).add(target);
    renderer.render(world, camera);
  }

  // x, y in [-1, 1]. What is there: {index: of the node, object, name, point: m}, or null.
  const ray = new THREE.Raycaster();
  function hitAt(x, y) {
    ray.setFromCamera(new THREE.Vector2(x, y), camera);
    const hit = ray.intersectObjects(objects.filter(o => o), false)[0];
    return hit ? { index: objects.indexOf(hit.object), object: hit.object, name: hit.object.name, point: hit.point } : null;
  }
  // The point there as far away as `through` is.
  function pointAt(x, y, through) {
    ray.setFromCamera(new THREE.Vector2(x, y), camera);
    const ahead = target.clone().sub(eye).normalize();
    const far = through.clone().sub(eye).dot(ahead) / ray.ray.direction.dot(ahead);
    return ray.ray.direction.clone().multiplyScalar(far).add(eye);
  }

  // x, y in [-1, 1] of a point.
  function screen(point) {
    camera.updateMatrixWorld();
    return new THREE.Vector3(...point).project(camera).toArray();
  }

  let travel = 0;  // m, of the middle of what moves
  if (tracks.size) {
    const start = middle(0), frames = json.accessors[json.animations[0].samplers[0].input].count;
    for (let k = 0; k < frames; ++k) travel = Math.max(travel, middle(k).distanceTo(start));
  }
  return {
    show, look, draw, hitAt, pointAt, screen, travel, extent, objects: objects.filter(o => o),
    nameAt(x, y) { const hit = hitAt(x, y); return hit ? hit.name : ''; },
    add(object) { world.add(object); dirty = true; },
    end() {  // browsers give few canvases a context at a time
      if (dark.removeEventListener) dark.removeEventListener('change', paintSky);
      renderer.dispose();
      renderer.forceContextLoss();
    },
    setFollow(on) { follow = on; followed = middle(frame); },
    setContacts(on) { touch.visible = on; if (on) showContacts(frame); dirty = true; },
    position(name) { const o = world.getObjectByName(name); return o ? o.position.toArray() : null; },
  };
}
