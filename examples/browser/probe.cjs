// probe.cjs BUILD ROOT [bench [TASK]]: in Node, are the bytes of worlds and learners those recorded; with bench, rates instead.
'use strict';
const fs = require('fs'), path = require('path');
const { openEngine } = require('./engine.js');
const [build, root, what, task = 'hand_over_safe_finger'] = process.argv.slice(2);
const recorded = name => {
  const file = path.join(root, 'tests/golden', name);
  return fs.existsSync(file) ? fs.readFileSync(file, 'utf8').split('\n').filter(l => l && l[0] !== '#').map(l => l.split(' ')) : [];
};
// Calls f(n) for at least a second, n growing; calls a second.
function rate(f) {
  for (let n = 1; ; n *= 2) {
    const began = process.cpuUsage();
    f(n);
    const { user, system } = process.cpuUsage(began), seconds = (user + system) / 1e6;
    if (seconds > 1) return n / seconds;
  }
}
(async () => {
  const engine = openEngine(await require(path.resolve(build, 'redman.js'))({ wasmBinary: fs.readFileSync(path.join(build, 'redman.wasm')) }));
  if (what === 'bench') {
    const worlds = 16, round = v => Math.round(v);
    engine.learn(task, 'ppo_lag', worlds, 0, 0);
    const steps = worlds * rate(n => engine.steps(n));
    let before = 0;
    const samples = rate(n => { for (let i = 0; i < n; ++i) before = engine.epoch().steps; }) * before / engine.epoch().epoch;
    const policy = path.join(root, 'examples/policies', task + '.rdm');
    engine.open(task, 0);
    let acts = 0;
    if (fs.existsSync(policy)) {
      engine.policy(fs.readFileSync(policy));
      acts = rate(n => engine.acts(n));
    }
    console.log(JSON.stringify({ task, worlds, steps_per_s: round(steps), samples_per_s: round(samples), acts_per_s: round(acts) }));
    return;
  }
  let good = 0, bad = 0;
  const check = (name, now, then) => {
    if (now === then) return void ++good;
    ++bad;
    console.log(`${name}: ${now}, recorded is ${then}`);
  };
  for (const [name, kind, hash] of recorded('tasks.txt')) check(`${name} ${kind}`, engine.hash(name, kind), hash);
  for (const [algo, name, hash] of recorded('learners.txt')) if (algo !== 'policy') check(`${algo} on ${name}`, engine.learnerHash(algo, name), hash);
  console.log(`${good} hashes equal, ${bad} not`);
  process.exitCode = bad ? 1 : 0;
})();
