// Worlds of shapes, as page.c and `redman view` tell them, laid out as openScene wants it: a mesh for each shape, a node for
// each of each world, and tracks of one moment that pose() overwrites.
'use strict';

// Kinds of enum rdm_shape_kind.
const SPHERE = 0, CAPSULE = 1, BOX = 2, CYLINDER = 3, PLANE = 4, ELLIPSOID = 5;

// A grid of points around z with their normals: rings of [radius, height, outward, upward], `slope` scaled by axes.
function turned(rings, axes) {
  const around = 28, position = [], normal = [], index = [];
  rings.forEach(([r, z, nr, nz], i) => {
    for (let k = 0; k <= around; ++k) {
      const a = 2 * Math.PI * k / around, c = Math.cos(a), s = Math.sin(a);
      position.push(r * c * axes[0], r * s * axes[1], z * axes[2]);
      const n = [nr * c / axes[0], nr * s / axes[1], nz / axes[2]], length = Math.hypot(...n);
      normal.push(...n.map(v => v / length));
      if (i === 0 || k === around) continue;
      const b = i * (around + 1) + k, below = b - around - 1;
      index.push(below, below + 1, b, b, below + 1, b + 1);
    }
  });
  return { position, normal, index };
}
// Half circles from the south pole up, drawn apart by 2 * half.
function capsule(radius, half, axes = [1, 1, 1]) {
  const rings = [], n = 10;
  for (let side = -1; side <= 1; side += 2)
    for (let i = 0; i <= n; ++i) {
      const a = (side < 0 ? -0.5 + 0.5 * i / n : 0.5 * i / n) * Math.PI;
      rings.push([radius * Math.cos(a), radius * Math.sin(a) + side * half, Math.cos(a), Math.sin(a)]);
    }
  return turned(rings, axes);
}
function cylinder(radius, half) {
  return turned([[0, -half, 0, -1], [radius, -half, 0, -1], [radius, -half, 1, 0], [radius, half, 1, 0], [radius, half, 0, 1], [0, half, 0, 1]], [1, 1, 1]);
}
function box(x, y, z) {
  const position = [], normal = [], index = [], size = [x, y, z];
  for (let axis = 0; axis < 3; ++axis)
    for (let side = -1; side <= 1; side += 2) {
      const first = position.length / 3, u = (axis + 1) % 3, v = (axis + 2) % 3;
      for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, 1]]) {
        const p = [0, 0, 0], n = [0, 0, 0];
        p[axis] = side * size[axis];
        p[u] = side * a * size[u];
        p[v] = b * size[v];
        n[axis] = side;
        position.push(...p);
        normal.push(...n);
      }
      index.push(first, first + 1, first + 2, first, first + 2, first + 3);
    }
  return { position, normal, index };
}
function meshOf({ kind, size, mesh }) {
  if (mesh) return mesh;
  switch (kind) {
    case SPHERE: return capsule(size[0], 0);
    case ELLIPSOID: return capsule(1, 0, size);
    case CAPSULE: return capsule(size[0], size[1]);
    case CYLINDER: return cylinder(size[0], size[1]);
    case PLANE: return box(1, 1, 1e-3);  // openScene has a floor of its own
    default: return box(...size);        // of a hull that brings no mesh: its box
  }
}

// {json, array} for openScene, and pose(rows of seven numbers): of all shapes of the worlds, one after the other, or of those that
// move alone. place(world) is where on the ground one stands; a plane is drawn once.
function modelOf(shapes, poses, worlds = 1, place = () => [0, 0]) {
  const arrays = [], linear = v => (v <= 10 ? v / 255 / 12.92 : Math.pow((v / 255 + 0.055) / 1.055, 2.4));
  const keep = a => arrays.push(a) - 1;
  const json = { meshes: [], materials: [], nodes: [], accessors: [{ count: 1 }], animations: [{ samplers: [{ input: 0 }], channels: [] }] };
  keep(new Float32Array(1));
  const tracks = [], clip = json.animations[0];
  shapes.forEach((shape, i) => {
    const mesh = meshOf(shape);
    json.materials.push({ pbrMetallicRoughness: { baseColorFactor: [...shape.color.map(linear), 1] } });
    json.meshes.push({ primitives: [{
      attributes: { POSITION: keep(new Float32Array(mesh.position)), NORMAL: keep(new Float32Array(mesh.normal)) },
      indices: keep(new Uint16Array(mesh.index)), material: i }] });
  });
  for (let w = 0; w < worlds; ++w)
    shapes.forEach((shape, i) => {
      const at = 7 * (w * shapes.length + i), [x, y] = place(w);
      const translation = new Float32Array(poses.subarray(at, at + 3)), rotation = new Float32Array(poses.subarray(at + 3, at + 7));
      translation[0] += x;
      translation[1] += y;
      const node = { name: shape.name, extras: { plane: shape.kind === PLANE }, translation: Array.from(translation), rotation: Array.from(rotation) };
      if (w === 0 || shape.kind !== PLANE) node.mesh = i;
      const number = json.nodes.push(node) - 1;
      if (shape.fixed) return;
      for (const [path, output] of [['translation', translation], ['rotation', rotation]])
        clip.channels.push({ sampler: clip.samplers.push({ input: 0, output: keep(output) }) - 1, target: { node: number, path } });
      tracks.push({ at, x, y, translation, rotation });
    });
  return {
    json, array: i => arrays[i],
    pose(rows) {
      const moving = rows.length === 7 * tracks.length;
      tracks.forEach(({ at, x, y, translation, rotation }, k) => {
        const from = moving ? 7 * k : at;
        translation.set(rows.subarray(from, from + 3));
        rotation.set(rows.subarray(from + 3, from + 7));
        translation[0] += x;
        translation[1] += y;
      });
    },
  };
}
