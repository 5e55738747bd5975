// The report reads without this; it adds a readout of the curves under the pointer, and hides lines at will.
'use strict';
(() => {
  const data = JSON.parse(document.getElementById('data').textContent);
  const hidden = new Map();  // of a section: colours that are off
  const off = figure => hidden.get(figure.closest('section')) || new Set();
  const count = v => (v >= 1e6 ? (v / 1e6).toPrecision(3) + 'M' : v >= 1e3 ? (v / 1e3).toPrecision(3) + 'k' : String(v));

  for (const button of document.querySelectorAll('.legend button'))
    button.onclick = () => {
      const section = button.closest('section'), set = hidden.get(section) || hidden.set(section, new Set()).get(section);
      const c = Number(button.dataset.c), on = set.has(c);
      on ? set.delete(c) : set.add(c);
      button.setAttribute('aria-pressed', on);
      for (const e of section.querySelectorAll('svg .s' + c)) e.style.display = on ? '' : 'none';
    };

  for (const figure of document.querySelectorAll('figure[data-panel]')) {
    const { lines, share } = data.panels[figure.dataset.panel], svg = figure.querySelector('svg'), box = svg.viewBox.baseVal;
    const [left, width, low, high] = ['left', 'width', 'low', 'high'].map(k => Number(svg.dataset[k]));
    const read = document.createElement('div'), cursor = document.createElementNS('http://www.w3.org/2000/svg', 'line');
    read.className = 'read';
    read.hidden = true;
    figure.append(read);
    cursor.setAttribute('class', 'cursor');
    svg.append(cursor);
    svg.addEventListener('pointermove', e => {
      const r = svg.getBoundingClientRect(), at = (e.clientX - r.left) / r.width * box.width;
      const x = low + (at - left) / width * (high - low);
      read.textContent = '';
      const head = document.createElement('small');
      head.textContent = count(Math.max(0, Math.round(x))) + ' steps';
      read.append(head);
      for (const line of lines) {
        if (off(figure).has(line.c) || !line.x.length) continue;
        let i = line.x.findIndex(v => v >= x);
        if (i < 0) i = line.x.length - 1;
        if (i > 0 && x - line.x[i - 1] < line.x[i] - x) --i;
        const row = document.createElement('div'), chip = document.querySelector('.chip[data-c="' + line.c + '"]').cloneNode();
        row.append(chip, share ? (100 * line.y[i]).toFixed(0) + ' %' : String(Number(line.y[i].toPrecision(4))));
        read.append(row);
      }
      read.hidden = x < low || x > high;
      read.style.left = (at > box.width / 2 ? e.clientX - r.left - 12 - read.offsetWidth : e.clientX - r.left + 14) + 'px';
      read.style.top = '40px';
      for (const [k, v] of Object.entries({ x1: at, x2: at, y1: 34, y2: box.height - 36 })) cursor.setAttribute(k, v);
      cursor.style.display = read.hidden ? 'none' : '';
    });
    svg.addEventListener('pointerleave', () => { read.hidden = true; cursor.style.display = 'none'; });
  }
})();
