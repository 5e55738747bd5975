// onnx_compare.cjs MODULES FILE.onnx PROBE.json TOLERANCE: runs the file in onnxruntime-node on the
// observations of the probe, in batches of 1 and of 7 and all at once, and compares with the actions in it. Of a policy with
// a memory one after the other, with the state that the one before gave. Of one with
// eyes also with the points backwards and some of them twice, and with the first one alone, which has to make a difference.
const path = require('path');
const fs = require('fs');
const [modules, model, probe, tolerance] = process.argv.slice(2);
const ort = require(path.join(path.resolve(modules), 'node_modules', 'onnxruntime-node'));

async function main() {
  const want = JSON.parse(fs.readFileSync(probe, 'utf8'));
  const obs = Float32Array.from(want.obs);
  const session = await ort.InferenceSession.create(model);
  let largest = 0;
  let spread = 0;
  const count = want.num_points || 0;
  const points = Float32Array.from(want.points || []);
  const classes = Uint8Array.from(want.point_class || []);
  const colors = Uint8Array.from(want.point_color || []);
  // Point order[i] of each of the rows' clouds.
  const cloud = (begin, rows, order) => {
    const seen = new Float32Array(rows * order.length * 3);
    const kinds = new Uint8Array(rows * order.length);
    const tints = new Uint8Array(rows * order.length * 3);
    for (let r = 0; r < rows; ++r) {
      order.forEach((p, i) => {
        const from = (begin + r) * count + p, to = r * order.length + i;
        seen.set(points.subarray(3 * from, 3 * from + 3), 3 * to);
        kinds[to] = classes.length ? classes[from] : 0;
        if (colors.length) tints.set(colors.subarray(3 * from, 3 * from + 3), 3 * to);
      });
    }
    const feeds = { points: new ort.Tensor('float32', seen, [rows, order.length, 3]) };
    if (classes.length) feeds.point_class = new ort.Tensor('uint8', kinds, [rows, order.length]);
    if (colors.length) feeds.point_color = new ort.Tensor('uint8', tints, [rows, order.length, 3]);
    return feeds;
  };
  const all = Array.from({ length: count }, (_, i) => i);
  let state = new Float32Array(want.state_dim || 0);
  const compare = async (begin, rows, order = all) => {
    const data = obs.slice(begin * want.obs_dim, (begin + rows) * want.obs_dim);
    const feeds = { obs: new ort.Tensor('float32', data, [rows, want.obs_dim]) };
    if (count) Object.assign(feeds, cloud(begin, rows, order));
    if (want.state_dim) feeds.state = new ort.Tensor('float32', state, [1, want.state_dim]);
    const out = await session.run(feeds);
    if (want.state_dim) state = Float32Array.from(out.next_state.data);
    const shape = [rows, want.action_dim];
    if (String(out.action.dims) !== String(shape)) throw new Error(`action is ${out.action.dims}, not ${shape}`);
    const stds = out.log_std.dims;
    if (stds[stds.length - 1] !== want.action_dim || (stds.length > 1 && stds[0] !== rows)) throw new Error(`log_std is ${out.log_std.dims}`);
    out.action.data.forEach((a, i) => {
      const gap = Math.abs(a - want.action[begin * want.action_dim + i]);
      if (!(gap <= largest)) largest = gap;
      if (Math.abs(a - Math.min(1, Math.max(-1, out.mean.data[i]))) !== 0) throw new Error('action is not clip(mean)');
      spread = Math.max(spread, Math.abs(a - out.action.data[0]));
    });
  };
  const play = async (order) => {
    if (!want.state_dim) return compare(0, want.rows, order);
    state = new Float32Array(want.state_dim);
    for (let row = 0; row < want.rows; ++row) await compare(row, 1, order);
  };
  await play();
  if (!want.state_dim) {
    for (let begin = 0; begin + 7 <= want.rows; begin += 7) await compare(begin, 7);
    for (let begin = 0; begin < Math.min(want.rows, 100); ++begin) await compare(begin, 1);
  }
  if (count) await play([...all].reverse().concat(all.slice(0, 5)));
  console.log(`${want.rows} rows, largest difference ${largest.toExponential(2)}, actions spread over ${spread.toFixed(3)}`);
  if (!(largest <= Number(tolerance))) throw new Error(`the difference is above ${tolerance}`);
  if (spread === 0) throw new Error('all actions are the same: nothing was compared');
  if (count) {
    if (!want.played) throw new Error('no row of the probe was played');
    largest = 0;
    await play([0]);
    if (!(largest > 100 * Number(tolerance))) throw new Error(`one point gives the same actions as ${count}, within ${largest}`);
  }
}
main().catch((e) => {
  console.error(`${model}: ${e.message}`);
  process.exit(1);
});
