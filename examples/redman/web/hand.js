// A person's action: a slider for each entry, and for each group of entries whose names differ by a digit; keys and a gamepad
// move groups. Nine groups at a time have keys: those of the bank that is marked.
'use strict';

// give(entry, value): the person wants that. Gives {open(names of the entries), show(action), drive(seconds)}.
function openHand(box, give) {
  const pairs = ['QA', 'WS', 'ED', 'RF', 'TG', 'YH', 'UJ', 'IK', 'OL'], rate = 1.5;  // of the range [-1, 1], in a second
  const down = new Set();
  let groups = [], rows = [], values = new Float32Array(0), bank = 0, held = null;

  function slider(label, entries, title) {
    const name = document.createElement('label'), range = document.createElement('input'), value = document.createElement('span');
    name.textContent = label;
    name.title = title;
    value.className = 'value number';
    Object.assign(range, { type: 'range', min: -1, max: 1, step: 0.01, value: 0 });
    range.setAttribute('aria-label', label);
    const row = { entries, range, value, name };
    range.addEventListener('pointerdown', () => { held = row; });
    range.addEventListener('input', () => {
      for (const entry of entries) give(entry, values[entry] = Number(range.value));
      show(values);
    });
    rows.push(row);
    box.append(name, range, value);
    return row;
  }
  function open(names) {
    groups = [];
    rows = [];
    bank = 0;
    held = null;
    values = new Float32Array(names.length);
    box.replaceChildren();
    names.forEach((name, entry) => {
      const stem = name.replace(/\d+$/, ''), last = groups[groups.length - 1];
      if (last && last.stem === stem) last.entries.push(entry);
      else groups.push({ stem, entries: [entry], names });
    });
    for (const group of groups) {
      const several = group.entries.length > 1, first = names[group.entries[0]];
      const row = slider(several ? group.stem.replace(/_$/, '') : first, group.entries, several ? 'All of them; a click shows each' : first);
      row.name.className = 'group-name';
      group.chip = document.createElement('kbd');
      row.name.append(group.chip);
      if (!several) continue;
      const own = group.entries.map(entry => slider(names[entry], [entry], names[entry]));
      const fold = hidden => own.forEach(r => [r.name, r.range, r.value].forEach(e => { e.hidden = hidden; }));
      row.name.onclick = () => fold(!own[0].range.hidden);
      fold(true);
    }
    mark();
  }
  function mark() {
    groups.forEach((group, g) => {
      const k = g - 9 * bank;
      group.chip.hidden = k < 0 || k >= 9;
      group.chip.textContent = group.chip.hidden ? '' : pairs[k].split('').join(' ');
    });
  }
  function show(action) {
    action.forEach((v, i) => { values[i] = v === null ? 0 : v; });
    for (const row of rows) {
      const mean = row.entries.reduce((sum, e) => sum + values[e], 0) / row.entries.length;
      if (row !== held) row.range.value = mean;
      row.value.textContent = mean.toFixed(2);
    }
  }

  function move(k, by) {  // the k-th group of the bank
    const group = groups[9 * bank + k];
    for (const entry of group ? group.entries : []) {
      const to = Math.max(-1, Math.min(1, values[entry] + by));
      if (to !== values[entry]) give(entry, values[entry] = to);
    }
  }
  function turn(by) {
    const banks = Math.ceil(groups.length / 9);
    bank = (bank + by + banks) % banks;
    mark();
  }
  function press(key, seconds) {
    const k = pairs.findIndex(p => p.includes(key));
    move(k, (pairs[k][0] === key ? 1 : -1) * rate * seconds);
  }
  const writes = e => ['SELECT', 'TEXTAREA'].includes(e.target.tagName) || (e.target.tagName === 'INPUT' && e.target.type === 'text');
  window.addEventListener('pointerup', () => { held = null; });
  document.addEventListener('keydown', e => {
    if (writes(e) || e.ctrlKey || e.metaKey || e.altKey || e.repeat) return;
    const key = e.key.toUpperCase();
    if (key === 'Z' || key === 'X') return turn(key === 'X' ? 1 : -1);
    if (!pairs.some(p => p.includes(key))) return;
    down.add(key);
    press(key, 1 / 30);  // however short it is
  });
  document.addEventListener('keyup', e => down.delete(e.key.toUpperCase()));
  window.addEventListener('blur', () => down.clear());

  // Of the standard layout: sticks and triggers move the first six groups of the bank, shoulders change it.
  let pressed = [];
  function pad(seconds) {
    const p = navigator.getGamepads ? [...navigator.getGamepads()].find(g => g && g.mapping === 'standard') : null;
    if (!p) return;
    const trigger = k => p.buttons[k].value * (p.buttons[11].pressed ? -1 : 1);  // the right stick pressed: down
    [p.axes[0], -p.axes[1], p.axes[2], -p.axes[3], trigger(6), trigger(7)].forEach((v, k) => {
      if (Math.abs(v) > 0.15) move(k, v * rate * seconds);
    });
    const now = p.buttons.map(b => b.pressed);
    if (now[4] && !pressed[4]) turn(-1);
    if (now[5] && !pressed[5]) turn(1);
    pressed = now;
  }
  return {
    open, show,
    drive(seconds) {  // what is held down moves on
      for (const key of down) press(key, seconds);
      pad(seconds);
    },
    get groups() { return groups.map(g => g.entries.map(e => g.names[e])); },
  };
}
