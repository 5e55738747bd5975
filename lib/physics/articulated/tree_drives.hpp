// Drives, effort bounds and joint limits of a tree by lanes: implicit in the mass matrix, as an active set.
//
// A drive's torque spring - gain v1 (v1: rate after the step) is inside its bound or at one end of it; a
// limit's spring pushes or not. Given the sets the step is linear; where the outcome contradicts a set it
// is changed and the step solved again. Part of stepper_v*.cpp.
#pragma once
#include "physics/articulated/tree_lanes.hpp"
#include "physics/model/drive.hpp"

namespace rdm {
namespace {

constexpr int kSetPasses = 24;  // then the most damped choice is taken
constexpr int kAllPasses = 4;   // that change all contradictions at once; after them the first alone (Murty)

template <class L, class V>
[[gnu::always_inline]] inline V clamp(const V& x, const V& low, const V& high) {
  const V a = L::select(x < low, low, x);
  return L::select(a > high, high, a);
}

// Spring, gain and bound of each drive for this substep: rdm::motor_row without the limit.
template <class L>
void set_drives(TreeBatch<L>& t) {
  using V = typename L::V;
  using S = typename L::Scalar;
  const Tree& tree = *t.tree;
  const int offset = tree.coord(0);
  for (int i = 0; i < tree.num_links; ++i) {
    const LinkLanes<L>& bone = t.bones[i];
    LinkWork<V>& me = t.work[i];
    V target = me.target;
    const int other = tree.links[static_cast<size_t>(i)].other;
    if (other >= 0) {
      const V middle = bone.ratio * (t.work[other].q + t.h * t.coord[offset + other].qd);
      target = clamp<L>(me.q, V(middle - bone.slack), V(middle + bone.slack));
    }
    target = clamp<L>(target, bone.lower, bone.upper);
    V kp = bone.kp, bound = bone.effort, spring = kp * (target - me.q);
    if (t.spring_only) {
      const V size = L::select(spring < V{}, V(-spring), spring);
      const V share = L::select(size > bound, V(bound / size), L::all(1));
      spring = spring * share;
      kp = kp * share;
      bound = L::all(S(1e30));
    }
    const V qd = t.coord[offset + i].qd, speed = L::select(qd < V{}, V(-qd), qd);
    const V slow = L::all(S(kFrictionSpeed));
    me.spring = spring;
    me.gain = t.h * kp + bone.kd + bone.friction / L::select(speed > slow, speed, slow);
    me.bound = bound;
  }
}

// One solution for the present sets: v1 of the lanes in `lanes`.
template <class L>
void solve_sets(TreeBatch<L>& t, typename L::Mask lanes) {
  using V = typename L::V;
  using S = typename L::Scalar;
  const Tree& tree = *t.tree;
  const int offset = tree.coord(0), entries = static_cast<int>(tree.path.size());
  for (int k = 0; k < entries; ++k) t.factor[k] = t.mass_matrix[k];
  for (int c = 0; c < offset; ++c) t.coord[c].dv = -(t.h * t.coord[c].bias);
  for (int i = 0; i < tree.num_links; ++i) {
    const LinkLanes<L>& bone = t.bones[i];
    const LinkWork<V>& me = t.work[i];
    const LinkState<V>& sets = t.keep[i];
    CoordWork<V>& c = t.coord[offset + i];
    const V free = S(1) - sets.saturated * sets.saturated, on = sets.limited * sets.limited;
    const V limit_gain = on * (t.h * t.limit_stiffness), gain = me.gain * free + limit_gain;
    const V edge = L::select(sets.limited < V{}, bone.lower, bone.upper);
    t.factor[tree.row[static_cast<size_t>(offset + i)] + tree.depth[static_cast<size_t>(offset + i)]] +=
        t.h * gain;
    c.dv = t.h * (me.spring * free + sets.saturated * me.bound - c.bias - c.qd * gain +
                  on * t.limit_stiffness * (edge - me.q));
  }
  factorise(t);
  for (int c = 0; c < tree.num_coords; ++c)
    t.coord[c].v1 = L::select(lanes, V(t.coord[c].qd + t.coord[c].dv), t.coord[c].v1);
}

// Changes the sets of the lanes in `lanes` where v1 contradicts them; the lanes that changed. `single`: at
// most the first contradiction of a lane, its limit before its drive.
template <class L>
typename L::Mask revise_sets(TreeBatch<L>& t, typename L::Mask lanes, bool single) {
  using V = typename L::V;
  using Mask = typename L::Mask;
  const Tree& tree = *t.tree;
  const int offset = tree.coord(0);
  const V one = L::all(1), zero{};
  Mask changed = L::nothing();
  for (int i = 0; i < tree.num_links; ++i) {
    const LinkLanes<L>& bone = t.bones[i];
    const LinkWork<V>& me = t.work[i];
    LinkState<V>& sets = t.keep[i];
    const V v1 = t.coord[offset + i].v1, torque = me.spring - me.gain * v1;
    // never from one end of the bound to the other at once: that kicks
    const V high = L::select(torque > me.bound, one, zero),
            low = L::select(torque < -me.bound, V(-one), zero);
    const V saturated = L::select(
        sets.saturated > zero, L::select(torque >= me.bound, one, zero),
        L::select(sets.saturated < zero, L::select(torque <= -me.bound, V(-one), zero), V(high + low)));
    const V next = me.q + t.h * v1;
    const V below = L::select(next < bone.lower, V(-one), zero),
            above = L::select(next > bone.upper, one, zero);
    const V limited =
        L::select(sets.limited < zero, below, L::select(sets.limited > zero, above, V(below + above)));
    const Mask limit_flips = limited != sets.limited, drive_flips = saturated != sets.saturated;
    Mask flips = (limit_flips | drive_flips) & (lanes & (lanes ^ t.frozen));
    if (single) flips = flips & (flips ^ changed);  // lanes that have not changed yet
    if (L::bits(flips) == 0) continue;
    const Mask drive = single ? Mask(flips & (drive_flips & (limit_flips ^ drive_flips))) : flips;
    sets.limited = L::select(flips, limited, sets.limited);
    sets.saturated = L::select(drive, saturated, sets.saturated);
    changed = changed | flips;
  }
  return changed;
}

// The most damped choice, for lanes where no set agrees with itself: drives inside their bounds, limits by
// today's angle. They stay so for this substep.
template <class L>
void damp_sets(TreeBatch<L>& t, typename L::Mask lanes) {
  using V = typename L::V;
  t.frozen = t.frozen | lanes;
  const V one = L::all(1), zero{};
  for (int i = 0; i < t.tree->num_links; ++i) {
    const LinkLanes<L>& bone = t.bones[i];
    LinkState<V>& sets = t.keep[i];
    const V q = t.work[i].q;
    const V limited = L::select(q < bone.lower, V(-one), L::select(q > bone.upper, one, zero));
    sets.saturated = L::select(lanes, zero, sets.saturated);
    sets.limited = L::select(lanes, limited, sets.limited);
  }
}

// The step without contacts: v1 of all lanes.
template <class L>
void solve_drives(TreeBatch<L>& t) {
  using Mask = typename L::Mask;
  const Mask everyone = L::mask(~0u);
  t.frozen = L::nothing();
  solve_sets(t, everyone);
  for (int pass = 0;; ++pass) {
    const Mask changed = revise_sets(t, everyone, pass >= kAllPasses);
    if (L::bits(changed) == 0) return;
    if (pass >= kSetPasses) {
      damp_sets(t, changed);
      solve_sets(t, everyone);
      return;
    }
    solve_sets(t, everyone);
  }
}

// Torque at the step's end, added to `torque` times `weight`.
template <class L>
void add_torques(TreeBatch<L>& t, typename L::Scalar weight) {
  using V = typename L::V;
  const int offset = t.tree->coord(0);
  for (int i = 0; i < t.tree->num_links; ++i) {
    const LinkLanes<L>& bone = t.bones[i];
    LinkWork<V>& me = t.work[i];
    const LinkState<V>& sets = t.keep[i];
    const V v1 = t.coord[offset + i].v1;
    const V drive = clamp<L>(V(me.spring - me.gain * v1), V(-me.bound), me.bound);
    const V edge = L::select(sets.limited < V{}, bone.lower, bone.upper);
    const V limit = sets.limited * sets.limited * t.limit_stiffness * (edge - me.q - t.h * v1);
    me.torque += weight * (drive + limit);
  }
}

// q <- q + h v1, kept within range and margin; qd <- v1. Lanes whose rates are not below `bound` are given
// back and stand still.
template <class L>
typename L::Mask integrate(TreeBatch<L>& t, typename L::Scalar margin, typename L::Scalar bound) {
  using V = typename L::V;
  using Mask = typename L::Mask;
  const Tree& tree = *t.tree;
  const int offset = tree.coord(0);
  const V low = L::all(-bound), high = L::all(bound), zero{};
  Mask good = L::mask(~0u);
  for (int c = 0; c < tree.num_coords; ++c) good = good & (t.coord[c].v1 > low) & (t.coord[c].v1 < high);
  for (int c = 0; c < offset; ++c) t.coord[c].qd = L::select(good, t.coord[c].v1, zero);
  for (int i = 0; i < tree.num_links; ++i) {
    const LinkLanes<L>& bone = t.bones[i];
    V v = L::select(good, t.coord[offset + i].v1, zero), q = t.work[i].q + t.h * v;
    const V bottom = bone.lower - margin, top = bone.upper + margin;
    const Mask under = q<bottom, over = q> top;
    v = L::select(under & (v < zero), zero, v);
    v = L::select(over & (v > zero), zero, v);
    q = L::select(under, bottom, L::select(over, top, q));
    t.work[i].q = q;
    t.coord[offset + i].qd = v;
  }
  return good;
}

}  // namespace
}  // namespace rdm
