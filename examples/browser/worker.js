// Training beside the page: {start: {wasm, task, algo, worlds, seed, settings, worldSettings}} makes an agent and goes on until {stop: true}.
// Every epoch is posted, and about once a second the policy as it is then.
'use strict';
let engine = null, running = 0;
onmessage = async ({ data }) => {
  const run = ++running;
  if (!data.start) return;
  const s = data.start;
  try {
    if (!engine) engine = openEngine(await createRedman({ wasmBinary: s.wasm }));
    engine.learn(s.task, s.algo, s.worlds, s.seed, s.seed, s.settings, s.worldSettings);
    let shown = 0, busy = 0, steps = 0;
    while (run === running) {
      const began = performance.now(), epoch = engine.epoch();
      busy += performance.now() - began;
      const rate = epoch.steps / busy * 1000, now = performance.now();
      const policy = now - shown > 1000 ? engine.learned() : null;
      if (policy) shown = now;
      postMessage({ run: s.run, epoch, rate, policy });
      if (epoch.steps >= s.most) break;
      steps = epoch.steps;
      await new Promise(r => setTimeout(r));  // what the page says meanwhile
    }
    postMessage({ run: s.run, ended: true, steps });
  } catch (e) {
    postMessage({ run: s.run, error: e.message });
  }
};
