// Numbers of live worlds: a row for each cost against its limit, curves, and how they are written.
'use strict';

const number = v => (Number.isInteger(v) ? String(v) : Math.abs(v) >= 1000 ? v.toFixed(0) : Math.abs(v) >= 10 ? v.toFixed(1) : v.toFixed(2));
const thousands = v => Math.round(v).toString().replace(/\B(?=(\d{3})+$)/g, '\u2009');
const ink = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const words = name => name.replace(/_/g, ' ');

// costs: [{name, help, limit}], a limit below 0 is none.
function costRows(box, costs) {
  box.replaceChildren(...costs.map(c => {
    const row = document.createElement('div');
    row.className = 'cost';
    row.title = c.help;
    row.innerHTML = '<div class="line"><span></span><span class="value number"></span></div>' + (c.limit >= 0 ? '<div class="bar"><i></i><u></u></div>' : '');
    row.querySelector('span').textContent = words(c.name);
    return row;
  }));
}
function showCosts(box, costs, sum) {
  costs.forEach((c, k) => {
    const row = box.children[k];
    row.querySelector('.value').textContent = c.limit >= 0 ? `${number(sum[k])} of ${number(c.limit)}` : number(sum[k]);
    row.classList.toggle('over', c.limit >= 0 && sum[k] > c.limit);
    if (c.limit >= 0) row.querySelector('i').style.width = Math.min(100, sum[k] ? 80 * (c.limit > 0 ? sum[k] / c.limit : 2) : 0) + '%';
  });
}

// A scene anew in the place of the canvas of id "scene"; before: the view that was there, or null. make(): its model (shapes.js). Gives
// {model, view} with the mouse's arrow in it, nulls where there is nothing to see: the element of id "message" says why.
function showScene(before, shapes, make, contacts, arrow) {
  const $ = id => document.getElementById(id), shown = { model: null, view: null };
  const say = text => { $('message').textContent = text; $('message').hidden = !text; };
  if (before) before.end();
  const old = $('scene'), canvas = old.cloneNode();  // a context of its own
  old.replaceWith(canvas);
  say(shapes.length ? '' : 'This task has nothing to look at: its world is numbers.');
  if (!shapes.length) return shown;
  try {
    shown.model = make();
    shown.view = openScene(canvas, shown.model, contacts);
    shown.view.add(arrow);
    shown.view.setContacts($('contacts').checked);
  } catch (e) {
    say('This browser shows no WebGL here (' + e.message + '); the numbers work all the same.');
  }
  return shown;
}
// A button for each camera by its name.
function cameraButtons(box, names, look) {
  box.replaceChildren(...names.map(name => {
    const b = document.createElement('button');
    b.textContent = name;
    b.onclick = () => look(name);
    return b;
  }));
}

// ys against xs, which ascend, with the limit dashed (null: none) and, where `at` is one of xs, a cursor there.
function plot(canvas, xs, ys, limit, title, color, at = null) {
  const ratio = window.devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
  canvas.width = Math.round(w * ratio);
  canvas.height = Math.round(h * ratio);
  const g = canvas.getContext('2d');
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, w, h);
  const left = 46, top = 18, right = w - 4, bottom = h - 16;
  g.font = '11px system-ui, "DejaVu Sans", sans-serif';
  g.fillStyle = ink('--soft');
  g.textBaseline = 'top';
  g.fillText(title, left, 2);
  let low = limit ?? Infinity, high = limit ?? -Infinity;
  for (const v of ys) low = Math.min(low, v), high = Math.max(high, v);
  if (!ys.length) low = 0, high = 1;
  if (limit !== null) low = Math.min(low, 0);
  if (high - low < 1e-9) high = low + 1;
  const least = at === null ? 0 : xs[0] || 0, most = Math.max(xs[xs.length - 1] || 1, least + 1), x = v => left + (v - least) / (most - least) * (right - left), y = v => bottom - (v - low) / (high - low) * (bottom - top);
  g.strokeStyle = ink('--edge');
  g.beginPath();
  for (const v of [low, high]) g.moveTo(left, Math.round(y(v)) + 0.5), g.lineTo(right, Math.round(y(v)) + 0.5);
  g.stroke();
  g.textAlign = 'right';
  g.textBaseline = 'middle';
  if (ys.length) for (const v of [low, high]) g.fillText(number(v), left - 6, y(v));
  g.textBaseline = 'bottom';
  if (ys.length) g.fillText(thousands(most) + ' steps', right, h);
  if (limit !== null) {
    g.strokeStyle = g.fillStyle = ink('--bad');
    g.setLineDash([5, 4]);
    g.beginPath();
    g.moveTo(left, y(limit));
    g.lineTo(right, y(limit));
    g.stroke();
    g.setLineDash([]);
    const above = y(limit) - top > 14;
    g.textBaseline = above ? 'bottom' : 'top';
    g.fillText('limit ' + number(limit), right, y(limit) + (above ? -1 : 3));
  }
  g.textAlign = 'left';
  g.strokeStyle = color;
  g.lineWidth = 2;
  g.lineJoin = 'round';
  g.beginPath();
  ys.forEach((v, i) => g.lineTo(x(xs[i]), y(v)));
  g.stroke();
  if (at === null) return;
  g.strokeStyle = ink('--ink');
  g.lineWidth = 1;
  g.beginPath();
  g.moveTo(x(at), top);
  g.lineTo(x(at), bottom);
  g.stroke();
}
