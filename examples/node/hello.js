// The program of examples/c in JavaScript: Node with koffi, which is told what the stable headers say.
//
//   npm install koffi && node hello.js POLICY [bench]
//
// REDMAN_INCLUDE (the folder of the headers) and REDMAN_LIBRARY say where they are, when not where they were installed.
'use strict';
const koffi = require('koffi');
const header = ['base', 'policy', 'pool', 'agent'].map((name) => require('fs').readFileSync(
  `${process.env.REDMAN_INCLUDE || '/usr/local/include/redman'}/${name}.h`, 'utf8')).join('\n').replace(/\/\*[^]*?\*\//g, '');
const library = koffi.load(process.env.REDMAN_LIBRARY || 'libredman.so.1');

// Constants and functions by the header's names.
const redman = {};
for (const [, name, value] of header.matchAll(/^#define (RDM_\w+) +(\d+)/gm)) redman[name] = Number(value);
for (const [, list] of header.matchAll(/\benum \w*\s*{([^}]*)}/g)) {
  let next = 0;
  for (const [, name, n] of list.matchAll(/(\w+)(?: = (-?\d+))?/g)) next = 1 + (redman[name] = Number(n ?? next));
}
koffi.alias('rdm_result', 'int32_t');
for (const [, name] of header.matchAll(/typedef struct \w+ (\w+);/g)) koffi.opaque(name);
for (const [, body, name] of header.matchAll(/typedef struct \w+ {([^}]*)} (\w+);/g)) {
  const members = {};
  for (const [, type, names] of body.replace(/[\w *]+\(\*(\w+)\)[^;]*/g, 'void *$1').matchAll(/(\w[\w ]*) ([^;]*);/g)) {
    for (const one of names.split(',')) {
      const member = one.match(/\w+/)[0];
      members[member] = type + one.replace(member, '').replace(/RDM_\w+/, (count) => redman[count]);
    }
  }
  koffi.struct(name, members);
}
for (const [, text, name] of header.matchAll(/^RDM_API ([^(]*?(\w+)\([^)]*\));/gm)) {
  const directed = text.replace(/\w+ \*\*out\b/g, '_Out_ $&').replace(/(?<!const )\b\w+ \*(io|c|out)\b/g, '_Inout_ $&');
  redman[name] = library.func(directed.replace(/(\w+)\[\d+\]/g, '*$1'));
}
const clock = koffi.load(null).func('long clock()'); // CPU time of the process, us

function check(result) {
  if (result !== redman.RDM_OK) throw new Error(redman.rdm_last_error());
}

// A struct filled by call.
function filled(name, call) {
  const value = { struct_size: koffi.sizeof(name) };
  check(call(value));
  return value;
}

// Worlds at the start of their first episode, with actions that hold the start pose.
function makePool(task, numEnvs, seed) {
  const config = {}, out = [null];
  check(redman.rdm_pool_config_init(config, koffi.sizeof('rdm_pool_config')));
  const autoreset = redman.RDM_AUTORESET_NEXT_STEP; // ended worlds rest until the next step
  check(redman.rdm_pool_create(out, { ...config, task, num_envs: numEnvs, seed, autoreset }));
  check(redman.rdm_pool_reset(out[0], null, null));
  check(redman.rdm_pool_baseline(out[0], redman.RDM_BASELINE_HOLD));
  return out[0];
}

// 75 steps; without a policy the start pose is held. Return and cost are of world 0, the hash of all states.
function play(policy) {
  const pool = makePool('hand_over_safe_finger', 4, 7);
  const spec = filled('rdm_spec', (s) => redman.rdm_pool_get_spec(pool, s));
  const rows = filled('rdm_buffers', (b) => redman.rdm_pool_get_buffers(pool, b));
  const floats = (row, width) => new Float32Array(koffi.view(row, 4 * 4 * width));
  const reward = floats(rows.reward, 1), costs = floats(rows.cost, spec.cost_dim);
  let scratch, repeat;
  if (policy) {
    check(redman.rdm_policy_check(policy, spec));
    repeat = filled('rdm_policy_info', (i) => redman.rdm_policy_get_info(policy, i)).action_repeat;
    scratch = new Uint8Array(Number(redman.rdm_policy_scratch(policy, 4)));
  }
  let sum = 0, cost = 0;
  for (let t = 0; t < 75; ++t) {
    if (policy && t % repeat === 0) {
      check(redman.rdm_policy_act(policy, rows.obs, 4, null, rows.action, scratch, scratch.length));
    }
    check(redman.rdm_pool_step(pool));
    sum += reward[0];
    cost += costs[0];
  }
  const hash = new BigUint64Array(1);
  check(redman.rdm_pool_get_hash(pool, -1, hash));
  redman.rdm_pool_destroy(pool);
  return [sum, cost, hash[0].toString(16).padStart(16, '0')];
}

// CPU seconds of one step of the pool.
function measure(task, numEnvs, calls) {
  const pool = makePool(task, numEnvs, 0);
  for (let t = 0; t < calls; ++t) check(redman.rdm_pool_step(pool)); // warms up
  const start = clock();
  for (let t = 0; t < calls; ++t) check(redman.rdm_pool_step(pool));
  const seconds = (clock() - start) * 1e-6;
  redman.rdm_pool_destroy(pool);
  return seconds / calls;
}

function main(file, bench) {
  if (!file) throw new Error('usage: hello.js POLICY [bench]');
  let [sum, cost, hash] = play(null);
  console.log(`hold cost ${cost.toFixed(0)} hash ${hash}`);
  const out = [null];
  check(redman.rdm_policy_read_file(out, file));
  [sum, cost, hash] = play(out[0]);
  redman.rdm_policy_destroy(out[0]);
  console.log(`policy return ${sum.toFixed(4)} cost ${cost.toFixed(0)} hash ${hash}`);
  if (bench) {
    console.log(`bandit ${(1e9 * measure('bandit', 1, 1000000)).toFixed(0)} ns a step`);
    console.log(`hand_over ${(1 / measure('hand_over_safe_finger', 1, 40000)).toFixed(0)} steps/s of 1 world`);
    console.log(`hand_over ${(64 / measure('hand_over_safe_finger', 64, 1000)).toFixed(0)} steps/s of 64 worlds`);
  }
}

try {
  main(...process.argv.slice(2));
} catch (error) {
  console.error(`hello: ${error.message}`);
  process.exitCode = 1;
}
