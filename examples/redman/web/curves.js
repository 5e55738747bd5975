// Reward and costs against time: a panel each, the running sum as a line, the steps as bars under it, the limit
// dashed, and a cursor at the frame that is shown. A pointer on a panel moves the time.
'use strict';

// curves: [{name, help, step, sum, limit}], typed arrays of `frames` values; limit null: none.
function openCurves(box, curves, frames, seek) {
  const number = v => (Number.isInteger(v) ? String(v) : Math.abs(v) >= 1000 ? v.toFixed(0) : v.toPrecision(3));
  const panels = curves.map(c => {
    const figure = document.createElement('figure'), caption = document.createElement('figcaption');
    const name = document.createElement('b'), value = document.createElement('span'), canvas = document.createElement('canvas');
    name.textContent = c.name;
    value.className = 'value';
    figure.title = c.help;
    caption.append(name, value);
    figure.append(caption, canvas);
    box.append(figure);
    const at = e => seek(Math.round((e.clientX - canvas.getBoundingClientRect().left) / canvas.clientWidth * (frames - 1)));
    canvas.addEventListener('pointerdown', e => { canvas.setPointerCapture(e.pointerId); at(e); });
    canvas.addEventListener('pointermove', e => { if (e.buttons) at(e); });
    let low = Math.min(0, c.limit ?? 0), high = Math.max(0, c.limit ?? 0), most = 0;
    for (let k = 0; k < frames; ++k) {
      low = Math.min(low, c.sum[k]);
      high = Math.max(high, c.sum[k]);
      most = Math.max(most, Math.abs(c.step[k]));
    }
    if (high - low < 1e-9) {  // nothing happens here
      high = low + 1;
      figure.classList.add('flat');
    }
    return { c, figure, value, canvas, low, high, most };
  });

  function draw(p, k) {
    const { c, canvas, low, high, most } = p, ratio = window.devicePixelRatio || 1;
    const w = canvas.clientWidth, h = canvas.clientHeight, style = getComputedStyle(document.documentElement);
    const ink = name => style.getPropertyValue(name).trim();
    if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
      canvas.width = Math.round(w * ratio);
      canvas.height = Math.round(h * ratio);
    }
    const g = canvas.getContext('2d');
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, w, h);
    const x = i => 1 + i / Math.max(1, frames - 1) * (w - 2), y = v => 5 + (high - v) / (high - low) * (h - 10);
    g.strokeStyle = ink('--edge');
    g.lineWidth = 1;
    g.beginPath();
    g.moveTo(0, y(0));
    g.lineTo(w, y(0));
    g.stroke();
    g.fillStyle = ink('--accent');
    g.globalAlpha = 0.3;
    if (most > 0)
      for (let i = 1; i < frames; ++i) {
        const tall = c.step[i] / most * 0.3 * h;
        g.fillRect(x(i - 1), y(0) - Math.max(tall, 0), Math.max(x(i) - x(i - 1), 0.7), Math.abs(tall));
      }
    g.globalAlpha = 1;
    const line = (from, to, color, width) => {
      g.strokeStyle = color;
      g.lineWidth = width;
      g.beginPath();
      for (let i = from; i <= to; ++i) g.lineTo(x(i), y(c.sum[i]));
      g.stroke();
    };
    g.globalAlpha = 0.35;
    line(0, frames - 1, ink('--accent'), 1.5);
    g.globalAlpha = 1;
    const over = c.limit === null ? -1 : c.sum.findIndex(v => v > c.limit), first = over < 0 || over > k ? k : over;
    line(0, first, ink('--accent'), 2);
    if (first < k) line(first, k, ink('--bad'), 2);
    if (c.limit !== null) {
      g.strokeStyle = g.fillStyle = ink('--bad');
      g.lineWidth = 1;
      g.setLineDash([5, 4]);
      g.beginPath();
      g.moveTo(0, y(c.limit));
      g.lineTo(w, y(c.limit));
      g.stroke();
      g.setLineDash([]);
      g.font = '10px system-ui, sans-serif';
      g.textBaseline = y(c.limit) > 16 ? 'bottom' : 'top';
      g.fillText('limit ' + number(c.limit), 3, y(c.limit) + (y(c.limit) > 16 ? -1 : 2));
    }
    g.strokeStyle = ink('--ink');
    g.lineWidth = 1;
    g.beginPath();
    g.moveTo(x(k), 0);
    g.lineTo(x(k), h);
    g.stroke();
    p.value.textContent = number(c.sum[k]) + (c.step[k] ? ' (' + (c.step[k] > 0 ? '+' : '') + number(c.step[k]) + ')' : '');
    p.figure.classList.toggle('over', c.limit !== null && c.sum[k] > c.limit);
  }
  return { show(k) { for (const p of panels) draw(p, k); } };
}
