// assemble.cjs ROOT BUILD TOOL THREE OUT: the page and its data from what was built.
//   index.html: everything that runs, with the library inside; policies.js, demonstrations.js: what it shows.
'use strict';
const fs = require('fs'), path = require('path'), zlib = require('zlib');
const { execFileSync } = require('child_process');
const [root, build, tool, three, out] = process.argv.slice(2);
const text = file => fs.readFileSync(file, 'utf8');
const here = name => text(path.join(__dirname, name));

// The end of a script inside a page, and the beginning of a comment, are written apart.
const script = source => source.replace(/<\/(script)/gi, '<\\/$1').replace(/<!--/g, '<\\!--');

const golden = text(path.join(root, 'tests/golden/tasks.txt')).split('\n').filter(l => l && l[0] !== '#').map(l => l.split(' '));
const parts = {
  three: script(text(three)),
  'redman.js': script(text(path.join(build, 'redman.js'))),
  wasm: zlib.gzipSync(fs.readFileSync(path.join(build, 'redman.wasm')), { level: 9 }).toString('base64'),
  golden: JSON.stringify(golden),
};
for (const name of ['engine.js', 'worker.js', 'page.js']) parts[name] = script(here(name));
for (const name of ['page.css', 'scene.js', 'shapes.js', 'push.js', 'live.js', 'licence.txt']) parts[name] = script(text(path.join(root, 'examples/redman/web', name)));
fs.mkdirSync(out, { recursive: true });
fs.writeFileSync(path.join(out, 'index.html'), here('page.html').replace(/\{\{(.*?)\}\}/g, (_, name) => {
  if (!(name in parts)) throw new Error('the page asks for ' + name);
  return parts[name];
}));

const policies = {}, folder = path.join(root, 'examples/policies');
for (const file of fs.readdirSync(folder).filter(f => f.endsWith('.rdm')))
  policies[file.slice(0, -4)] = fs.readFileSync(path.join(folder, file)).toString('base64');
fs.writeFileSync(path.join(out, 'policies.js'), 'const redmanPolicies = ' + JSON.stringify(policies) + ';\n');

// A demonstration is the actions that the tool's script made, and what came of them there.
const demonstrations = {}, scripts = path.join(root, 'examples/demos'), seed = 3;
for (const file of fs.readdirSync(scripts).filter(f => f.endsWith('.demo'))) {
  const lines = text(path.join(scripts, file)).split('\n').map(l => l.trim().split(/\s+/));
  const task = lines.find(l => l[0] === 'task')[1];
  if (lines.some(l => l[0] === 'when')) continue;  // another script of a task, for other options
  const settings = lines.filter(l => l[0] === 'set').map(l => l.slice(1).join(' ')).join('\n'), record = path.join(build, 'demonstration.csv');
  const told = JSON.parse(execFileSync(tool, ['rollout', '--task', task, '--policy', 'demo', '--seed', String(seed), '--record', record, '--json'],
    { encoding: 'utf8' }));
  const rows = text(record).trim().split('\n').map(l => l.split(','));
  const columns = rows[0].map((name, i) => (/^action\[\d+\]$/.test(name) ? i : -1)).filter(i => i >= 0);
  const actions = new Float32Array(rows.slice(1).flatMap(r => columns.map(i => Number(r[i]))));
  demonstrations[task] = { seed, settings, steps: rows.length - 1, return: told.return_mean, actions: Buffer.from(actions.buffer).toString('base64') };
}
fs.writeFileSync(path.join(out, 'demonstrations.js'), 'const redmanDemonstrations = ' + JSON.stringify(demonstrations) + ';\n');

const size = name => `${name} ${Math.round(fs.statSync(path.join(out, name)).size / 1000)} kB`;
const raw = fs.statSync(path.join(build, 'redman.wasm')).size;
console.log(`${out}: ${['index.html', 'policies.js', 'demonstrations.js'].map(size).join(', ')}; the library ${Math.round(raw / 1000)} kB, gzipped ` +
  `${Math.round(parts.wasm.length * 3 / 4 / 1000)} kB`);
