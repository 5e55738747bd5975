// page.c as functions of JavaScript: strings and arrays in, objects out; a call that fails throws what the library says.
// For the page, its worker and Node alike.
'use strict';
function openEngine(m) {
  const fail = () => { throw new Error(m.UTF8ToString(m._page_error())); };
  const good = r => (r < 0 ? fail() : r);
  const read = p => (p ? m.UTF8ToString(p) : fail());
  // Calls f with the addresses of what lies in the library's memory meanwhile.
  const lend = (values, f) => {
    const at = values.map(v => {
      const bytes = typeof v === 'string' ? new TextEncoder().encode(v + '\0') : new Uint8Array(v.buffer, v.byteOffset, v.byteLength);
      const p = m._malloc(bytes.length + 1);
      m.HEAPU8.set(bytes, p);
      return p;
    });
    try {
      return f(...at);
    } finally {
      at.forEach(p => m._free(p));
    }
  };
  const floats = (p, n) => m.HEAPF32.subarray(p >> 2, (p >> 2) + n);
  return {
    actors: { zero: 0, policy: 1, given: 2, random: 3 },
    about: () => JSON.parse(read(m._page_about())),
    open: (task, seed, settings = '') => lend([task, settings], (t, s) => good(m._page_open(t, seed, s))),
    scene: () => JSON.parse(read(m._page_scene())),
    reset: seed => good(m._page_reset(seed)),
    policy: bytes => lend([bytes], p => good(m._page_policy(p, bytes.length))),
    step(actor, given) {
      if (given) lend([given], p => good(m._page_step(actor, p)));
      else good(m._page_step(actor, 0));
    },
    // reward, return, step, terminated, truncated, success; cost, its sum and its raw value of each column
    numbers(costs) {
      const p = m._page_numbers() >> 3, v = m.HEAPF64.subarray(p, p + 6 + 3 * costs);
      const row = k => Array.from(v.subarray(6 + k * costs, 6 + (k + 1) * costs));
      return { reward: v[0], ret: v[1], step: v[2], terminated: v[3] > 0, truncated: v[4] > 0, success: v[5] > 0, cost: row(0), sum: row(1), raw: row(2) };
    },
    poses: shapes => floats(m._page_poses() || fail(), 7 * shapes),
    contacts() {
      const count = good(m._page_contacts());
      return { count, rows: floats(m._page_touches(), 6 * count) };
    },
    limit: value => good(m._page_limit(value)),
    push: (shape, x, y, z) => good(m._page_push(shape, x, y, z)),
    learn: (task, algo, worlds, poolSeed, seed, settings = '', worldSettings = '') =>
      lend([task, algo, settings, worldSettings], (t, a, s, w) => good(m._page_learn(t, a, worlds, poolSeed, seed, s, w))),
    epoch: () => JSON.parse(read(m._page_epoch())),
    learned() {
      const size = good(m._page_freeze()), p = m._page_learned();
      return m.HEAPU8.slice(p, p + size);
    },
    hash: (task, engine) => lend([task, engine], (t, e) => read(m._page_hash(t, e))),
    learnerHash: (algo, task) => lend([algo, task], (a, t) => read(m._page_learner_hash(a, t))),
    steps: n => good(m._page_steps(n)),
    acts: n => good(m._page_acts(n)),
  };
}
if (typeof module !== 'undefined' && module.exports) module.exports = { openEngine };
