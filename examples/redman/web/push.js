// The mouse holds what moves: a point of a shape is grabbed where it is pressed, and dragged in the plane that faces the camera.
'use strict';

// box: the element over the scene, with a canvas of id "scene" and a label of id "name" in it. now(): {view, can(index), text(index)}
// of what is shown, with the extent of one world where there are several, or null. changed(): something was grabbed, moved or let go. Gives {grabbed, pull(newton), end()}.
function openPush(box, now, changed = () => {}) {
  const $ = id => document.getElementById(id);
  const arrow = new THREE.ArrowHelper(new THREE.Vector3(0, 0, 1), new THREE.Vector3(), 0.1, '#e0102a');
  arrow.visible = false;
  const push = { grabbed: null, arrow };
  const spot = e => {
    const r = box.getBoundingClientRect();
    return [(e.clientX - r.left) / r.width * 2 - 1, 1 - (e.clientY - r.top) / r.height * 2];
  };

  // The force in N of a spring that pulls with `newton` from a fifth of the scene on; the arrow shows it.
  push.pull = newton => {
    const g = push.grabbed, { view } = now();
    g.object.updateMatrixWorld();
    const at = g.object.localToWorld(g.local.clone()), pull = g.to.clone().sub(at);
    const force = pull.clone().multiplyScalar(newton / Math.max(push.reach(), pull.length()));
    g.force = force.length();
    arrow.visible = pull.length() > 1e-4;
    arrow.position.copy(at);
    arrow.setDirection(pull.clone().normalize());
    arrow.setLength(Math.max(pull.length(), 1e-3), 0.03 * view.extent, 0.02 * view.extent);
    return force;
  };
  push.reach = () => 0.2 * (now().extent || now().view.extent);
  push.end = () => {
    push.grabbed = null;
    arrow.visible = false;
  };

  box.addEventListener('pointerdown', e => {
    const shown = now();
    if (!shown || e.button !== 0 || e.shiftKey || e.target !== $('scene')) return;
    const hit = shown.view.hitAt(...spot(e));
    if (!hit || !shown.can(hit.index)) return;
    const object = hit.object;
    push.grabbed = { index: hit.index, object, local: object.worldToLocal(hit.point.clone()), to: hit.point, from: hit.point.clone(), force: 0 };
    $('scene').setPointerCapture(e.pointerId);
    e.stopPropagation();  // the view does not turn
    changed();
  }, true);
  box.addEventListener('pointermove', e => {
    const label = $('name'), shown = now();
    if (push.grabbed) {
      push.grabbed.to = shown.view.pointAt(...spot(e), push.grabbed.from);
      e.stopPropagation();
      changed();
    }
    const hit = !shown || (e.buttons && !push.grabbed) ? null : push.grabbed || shown.view.hitAt(...spot(e)), r = box.getBoundingClientRect();
    label.hidden = !hit;
    box.classList.toggle('over', !!hit && shown.can(hit.index));
    if (!hit) return;
    label.textContent = shown.text(hit.index) + (push.grabbed && push.grabbed.force ? ' ' + push.grabbed.force.toFixed(1) + ' N' : '');
    label.style.left = Math.min(e.clientX - r.left + 14, r.width - 150) + 'px';
    label.style.top = e.clientY - r.top + 10 + 'px';
  }, true);
  for (const end of ['pointerup', 'pointercancel', 'pointerleave'])
    box.addEventListener(end, e => {
      if (end === 'pointerleave' && push.grabbed) return;
      push.end();
      $('name').hidden = true;
      changed();
    }, true);
  return push;
}
