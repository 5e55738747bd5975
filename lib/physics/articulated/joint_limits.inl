// Drives, effort bounds and joint limits of a batch, implicit in the mass matrix, as an active set. Part of
// stepper_v*.cpp.
//
// The law, per joint, with q and qd of the substep's start and v1 the rate at its end:
//   drive    tau = spring - gain v1                   inside +-bound, else the bound (saturated = +-1)
//            spring = kp (target - q) + feedforward,  gain = h kp + kd:
//            kp (target - (q + h v1)) - kd v1, implicit PD, the same as physics/model/drive.hpp's motor row
//            (target rate spring / gain, softness 1 / gain, force bound)
//   limit    tau = k (edge - q - T v1)                while q + T v1 is beyond the edge: it only pushes inward
//                                                     (limited = +-1); T in seconds, no less than h (tree.cpp)
//   friction tau = -f / kStickSpeed v1                while |v1| <= kStickSpeed (slip = 0), else -f slip,
//            slip = +-1 the way it goes: a bound of its own. Where f is small (below kSmallFriction) against
//            the effort of a drive with a spring, which is what holds such a joint, it is a secant of fixed gain
//            f / max(|qd|, kFrictionSpeed), and no row: fingers turn back all the time, and each
//            row that changes costs a factorisation and a round of contacts.
//   soft limit (SolverDef::limit_law) of a joint that is beyond its edge: that law's row (model/contact_law.hpp)
//            about the joint's inverse inertia at q = 0, which only pushes back:
//            h tau = max(0, keep v0 + push - v1) / softness    inwards
// k is the solver's for light links, and grows with what a heavy joint carries (tree.cpp): past the margin a
// joint is stopped by decree, all others keeping their rates, which feeds energy to a chain that a soft limit
// let there. With spring_only_effort the bound scales the spring, kp with it; damping stays outside.
//
// A coupled joint's target is its own q, clamped to ratio times the other joint's angle -+ slack: a tendon
// between the two. With x = q - ratio q_other and g its gradient, 1 and -ratio, the drive is
//   tau g,  tau = spring - gain g . v1 inside +-bound,  gain = h kp while it is taut, else 0,
// on both joints, which adds h gain g g^T to the mass matrix; kd damps the coupled joint alone, outside the bound,
// and a feed-forward is a torque on it alone.
//
// A step. All laws are linear in v1 for a given active set (who is saturated, at a limit, slipping), so that
//   (M + h G) (v1 - qd) = h (spring' - bias - G qd),  G = diag(gain of those not saturated, + k T of those
//                                                              limited, ...) + couplings,
// spring' with the bound for the saturated and k (edge - q) for the limited: one factorisation. v1 then says
// which set it should have been with: a linear complementarity problem, solved by pivoting on the set: all
// contradictions at once (block principal pivoting: Judice and Pires 1994, a basis-exchange of a few passes),
// after kAllPasses the first contradiction alone (Murty 1974: least index, which for a positive definite
// matrix cannot cycle). Sets of drives and limits last from step to step: a substep starts from the last
// one's; that of friction is told by qd. Where nothing agrees within kSetPasses, and where contacts and sets
// chase each other (stepper.inl), the most damped set is taken and frozen for the substep.
#pragma once
#include "physics/articulated/tree_dynamics.inl"
#include "physics/model/drive.hpp"

namespace rdm {
namespace {

constexpr int kSetPasses = 24;  // then the most damped choice is taken
constexpr int kAllPasses = 4;   // that change all contradictions at once; after them the first alone (Murty)
constexpr double kSmallFriction = 0.02;  // of the drive's effort

template <class L, class V>
[[gnu::always_inline]] inline V clamp(const V& x, const V& low, const V& high) {
  const V a = L::select(x < low, low, x);
  return L::select(a > high, high, a);
}

// Spring, gain and bound of each drive for this substep, and how its friction begins.
template <class L>
void joint_drives(TreeBatch<L>& t) {
  using V = typename L::V;
  using S = typename L::Scalar;
  using Mask = typename L::Mask;
  const Tree& tree = *t.tree;
  const int offset = tree.coord(0);
  const V one = L::all(1), zero{}, slow = L::all(S(kFrictionSpeed)), creep = L::all(S(kStickSpeed));
  Mask any_stick = L::nothing();
  for (int i = 0; i < tree.num_links; ++i) {
    const LinkModel<L>& model = t.model[i];
    const TreeLink& link = tree.links[static_cast<size_t>(i)];
    LinkWork<V>& joint = t.work[i];
    V target = joint.target;
    if (link.coupled_to >= 0) {
      const V middle = model.ratio * t.work[link.coupled_to].q;
      target = clamp<L>(joint.q, V(middle - model.slack), V(middle + model.slack));
    }
    target = clamp<L>(target, model.lower, model.upper);
    V kp = model.kp, bound = model.effort, spring = kp * (target - joint.q);
    if (t.feedforward && link.coupled_to < 0) {  // a zero changes no bit
      const V& extra = t.feedforward[i];
      spring = L::select(extra != V{}, V(spring + extra), spring);
    }
    if (t.spring_only) {
      const V size = L::select(spring < V{}, V(-spring), spring);
      const V share = L::select(size > bound, V(bound / size), L::all(1));
      spring = spring * share;
      kp = kp * share;
      bound = L::all(S(1e30));
    }
    joint.spring = spring;
    joint.gain = t.h * kp + model.kd;
    joint.bound = bound;
    joint.damping = zero;
    if (link.coupled_to >= 0) {
      joint.damping = model.kd;
      joint.gain = L::select(target != joint.q, V(t.h * kp), zero);
      joint.uncoupled = t.mass_matrix[link.coupling_entry];
    }
    const V qd = t.coord[offset + i].qd, speed = L::select(qd < V{}, V(-qd), qd);
    const Mask small = (model.friction < S(kSmallFriction) * model.effort) & (model.kp > zero),
               sticks = (model.friction > zero) & (small ^ L::mask(~0u));
    joint.sticks = L::select(sticks, one, zero);
    joint.stick = model.friction / L::select(sticks, creep, L::select(speed > slow, speed, slow));
    joint.slip = L::select(sticks & (speed > creep), L::select(qd < V{}, V(-one), one), zero);
    any_stick = any_stick | sticks;
  }
  t.any_stick = L::bits(any_stick) != 0;
}

// The rate that a drive acts on, of what is by coordinate.
template <class L, class Of>
[[gnu::always_inline]] inline typename L::V drive_rate(const TreeBatch<L>& t, int i, Of&& of) {
  using V = typename L::V;
  const int offset = t.tree->coord(0), other = t.tree->links[static_cast<size_t>(i)].coupled_to;
  const V rate = of(t.coord[offset + i]);
  return other < 0 ? rate : V(rate - t.model[i].ratio * of(t.coord[offset + other]));
}

// Soft limits: gain and constant part of the torque at each joint's end nearest to it, by soft_row.
template <class L>
void soft_limits(TreeBatch<L>& t) {
  using V = typename L::V;
  using S = typename L::Scalar;
  const int offset = t.tree->coord(0);
  const ContactLaw& law = *t.limit_law;
  const double h = static_cast<double>(t.h), most = law.impedance_max, T = std::max(law.time_constant, 2 * h),
               whole = 1 + h / (most * T);
  const S keep = static_cast<S>((1 - h / (most * T)) / whole), least = static_cast<S>(law.impedance_min),
          rise = static_cast<S>(law.impedance_max - law.impedance_min),
          per_width = static_cast<S>(1 / law.impedance_width), inv_whole = static_cast<S>(1 / whole),
          stiffness =
              static_cast<S>(h / (most * most * T * T * law.damping_ratio * law.damping_ratio * whole));
  const V one = L::all(1), zero{};
  for (int i = 0; i < t.tree->num_links; ++i) {
    const LinkModel<L>& model = t.model[i];
    LinkWork<V>& joint = t.work[i];
    const V under = model.lower - joint.q, over = joint.q - model.upper;
    const V depth = L::select(under > zero, under, L::select(over > zero, over, zero));
    const V x = L::select(depth * per_width < one, V(depth * per_width), one), rest = one - x;
    const V share = L::select(x < S(0.5), V(S(2) * x * x), V(one - S(2) * rest * rest));
    const V d = least + rise * share;
    const V side = L::select(under > zero, one, V(-one));
    joint.limit_gain = (t.inv_h / inv_whole) * d / ((one - d) * model.limit_weight);
    joint.limit_push = keep * t.coord[offset + i].qd + side * (stiffness * d * depth);
  }
}

// What the factors at hand are of: another mass matrix, this one with another active set, or both as they are,
// so that forces alone have changed.
enum class Factors { kOther, kOtherSet, kSame };

// v1 of the lanes in `lanes` for the present active set.
template <class L>
void solve_active_set(TreeBatch<L>& t, typename L::Mask lanes, Factors factors) {
  using V = typename L::V;
  using S = typename L::Scalar;
  const Tree& tree = *t.tree;
  const int offset = tree.coord(0);
  for (int c = 0; c < offset; ++c) {
    t.coord[c].gain = V{};
    t.dv[c] = -(t.h * t.coord[c].bias);
  }
  for (int i = 0; i < tree.num_links; ++i) {
    const LinkModel<L>& model = t.model[i];
    const LinkWork<V>& joint = t.work[i];
    const PersistentLink<V>& active = t.state[i];
    CoordWork<V>& c = t.coord[offset + i];
    const bool coupled = tree.links[static_cast<size_t>(i)].coupled_to >= 0;
    const V free = S(1) - active.saturated * active.saturated, on = active.limited * active.limited;
    V gain = coupled ? joint.damping : V(joint.gain * free);
    V push = joint.spring * free + active.saturated * joint.bound;
    if (coupled && t.feedforward) push += t.feedforward[i];
    if (t.any_stick) {
      gain += joint.stick * (S(1) - joint.slip * joint.slip);
      push -= joint.slip * model.friction;
    } else {
      gain += joint.stick;
    }
    if (t.limit_law) {
      const V limit_gain = on * joint.limit_gain;
      gain += limit_gain;
      c.gain = t.h * gain;
      t.dv[offset + i] = t.h * (push - c.bias - c.qd * gain + limit_gain * joint.limit_push);
      continue;
    }
    gain += on * (model.limit_time * model.limit_stiffness);
    const V edge = L::select(active.limited < V{}, model.lower, model.upper);
    c.gain = t.h * gain;
    t.dv[offset + i] = t.h * (push - c.bias - c.qd * gain + on * model.limit_stiffness * (edge - joint.q));
  }
  for (const int32_t i : tree.coupled) {
    const TreeLink& link = tree.links[static_cast<size_t>(i)];
    const LinkWork<V>& joint = t.work[i];
    const PersistentLink<V>& active = t.state[i];
    const V& ratio = t.model[i].ratio;
    const int self = offset + i, other = offset + link.coupled_to;
    const V free = S(1) - active.saturated * active.saturated, gain = t.h * (joint.gain * free);
    const V pull = gain * drive_rate(t, i, [](const CoordWork<V>& c) { return c.qd; });
    const V push = t.h * (joint.spring * free + active.saturated * joint.bound);
    t.coord[self].gain += gain;
    t.coord[other].gain += gain * (ratio * ratio);
    t.mass_matrix[link.coupling_entry] = joint.uncoupled - gain * ratio;
    t.dv[self] -= pull;
    t.dv[other] -= ratio * (push - pull);
  }
  if (factors == Factors::kSame)
    reduce_right_side(t);
  else
    factor(t, factors == Factors::kOtherSet);
  substitute(t);
  for (int c = 0; c < tree.num_coords; ++c)
    t.coord[c].v1 = L::select(lanes, V(t.coord[c].qd + t.dv[c]), t.coord[c].v1);
}

// Changes the active sets of the lanes in `lanes` where v1 contradicts them; the lanes that changed.
// `single`: at most the first contradiction of a lane, its limit before its drive.
template <class L>
typename L::Mask update_active_set(TreeBatch<L>& t, typename L::Mask lanes, bool single) {
  using V = typename L::V;
  using Mask = typename L::Mask;
  const Tree& tree = *t.tree;
  const int offset = tree.coord(0);
  const V one = L::all(1), zero{};
  Mask changed = L::nothing();
  for (int i = 0; i < tree.num_links; ++i) {
    const LinkModel<L>& model = t.model[i];
    LinkWork<V>& joint = t.work[i];
    PersistentLink<V>& active = t.state[i];
    const V v1 = t.coord[offset + i].v1;
    const V torque = joint.spring - joint.gain * drive_rate(t, i, [](const CoordWork<V>& c) { return c.v1; });
    // never from one end of the bound to the other at once: that kicks
    const V over = L::select(torque > joint.bound, one, zero),
            under = L::select(torque < -joint.bound, V(-one), zero);
    const V saturated =
        L::select(active.saturated > zero, L::select(torque >= joint.bound, one, zero),
                  L::select(active.saturated < zero, L::select(torque <= -joint.bound, V(-one), zero),
                            V(over + under)));
    // one that would pull, as of a joint that comes back, does not act
    const V held = joint.q + model.limit_time * v1;
    V below = L::select(held < model.lower, V(-one), zero), above = L::select(held > model.upper, one, zero);
    if (t.limit_law) {
      below = L::select((joint.q < model.lower) & (v1 < joint.limit_push), V(-one), zero);
      above = L::select((joint.q > model.upper) & (v1 > joint.limit_push), one, zero);
    }
    const V limited =
        L::select(active.limited < zero, below, L::select(active.limited > zero, above, V(below + above)));
    const Mask limit_flips = limited != active.limited, drive_flips = saturated != active.saturated;
    Mask any_flips = limit_flips | drive_flips, slip_flips = L::nothing();
    V slip = joint.slip;
    if (t.any_stick) {
      const V creep = L::all(typename L::Scalar(kStickSpeed)) * joint.sticks;
      const V goes = joint.sticks * (L::select(v1 > creep, one, zero) - L::select(v1 < -creep, one, zero));
      slip = L::select(joint.slip == zero, goes, L::select(joint.slip * v1 < zero, zero, joint.slip));
      slip_flips = slip != joint.slip;
      any_flips = any_flips | slip_flips;
    }
    Mask flips = any_flips & (lanes & (lanes ^ t.frozen));
    if (single) flips = flips & (flips ^ changed);  // lanes that have not changed yet
    if (L::bits(flips) == 0) continue;
    const auto beside = [](const Mask& a, const Mask& b) { return Mask(a & (a ^ (a & b))); };  // a without b
    const Mask drive = single ? Mask(flips & beside(drive_flips, limit_flips)) : flips;
    const Mask rub = single ? Mask(flips & beside(beside(slip_flips, limit_flips), drive_flips)) : flips;
    active.limited = L::select(flips, limited, active.limited);
    active.saturated = L::select(drive, saturated, active.saturated);
    joint.slip = L::select(rub, slip, joint.slip);
    changed = changed | flips;
  }
  return changed;
}

// The most damped choice, for lanes where no set agrees with itself: drives inside their bounds, limits by
// today's angle, friction as a secant. They stay so for this substep.
template <class L>
void damp_active_set(TreeBatch<L>& t, typename L::Mask lanes) {
  using V = typename L::V;
  t.frozen = t.frozen | lanes;
  const V one = L::all(1), zero{}, slow = L::all(typename L::Scalar(kFrictionSpeed));
  const int offset = t.tree->coord(0);
  for (int i = 0; i < t.tree->num_links; ++i) {
    const LinkModel<L>& model = t.model[i];
    PersistentLink<V>& active = t.state[i];
    LinkWork<V>& joint = t.work[i];
    const V q = joint.q;
    const V limited = L::select(q < model.lower, V(-one), L::select(q > model.upper, one, zero));
    active.saturated = L::select(lanes, zero, active.saturated);
    active.limited = L::select(lanes, limited, active.limited);
    if (!t.any_stick) continue;
    const V qd = t.coord[offset + i].qd, speed = L::select(qd < zero, V(-qd), qd);
    const V secant = model.friction / L::select(speed > slow, speed, slow);
    joint.slip = L::select(lanes, zero, joint.slip);
    joint.stick = L::select(lanes, secant, joint.stick);
  }
}

// v1 of the lanes in `lanes` as if nothing touched. `again`: it was called before in this substep, and forces have
// changed.
template <class L>
void solve_without_contacts(TreeBatch<L>& t, typename L::Mask lanes = L::mask(~0u), bool again = false) {
  using Mask = typename L::Mask;
  t.frozen = t.frozen & (t.frozen ^ lanes);
  if (t.limit_law && !again) soft_limits(t);
  solve_active_set(t, lanes, again ? Factors::kSame : Factors::kOther);
  for (int pass = 0;; ++pass) {
    const Mask changed = update_active_set(t, lanes, pass >= kAllPasses);
    if (L::bits(changed) == 0) return;
    if (pass >= kSetPasses) {
      damp_active_set(t, changed);
      solve_active_set(t, lanes, Factors::kOtherSet);
      return;
    }
    solve_active_set(t, lanes, Factors::kOtherSet);
  }
}

// Torque at the step's end, added to `torque` times `weight`.
template <class L>
void joint_torques(TreeBatch<L>& t, typename L::Scalar weight) {
  using V = typename L::V;
  const int offset = t.tree->coord(0);
  for (int i = 0; i < t.tree->num_links; ++i) {
    const LinkModel<L>& model = t.model[i];
    LinkWork<V>& joint = t.work[i];
    const PersistentLink<V>& active = t.state[i];
    const V v1 = t.coord[offset + i].v1;
    const V rate = drive_rate(t, i, [](const CoordWork<V>& c) { return c.v1; });
    const V drive = clamp<L>(V(joint.spring - joint.gain * rate), V(-joint.bound), joint.bound);
    const V edge = L::select(active.limited < V{}, model.lower, model.upper);
    V limit =
        active.limited * active.limited * model.limit_stiffness * (edge - joint.q - model.limit_time * v1);
    if (t.limit_law) limit = active.limited * active.limited * joint.limit_gain * (joint.limit_push - v1);
    V torque = drive - joint.damping * v1 + limit;
    if (t.feedforward && t.tree->links[static_cast<size_t>(i)].coupled_to >= 0) torque += t.feedforward[i];
    joint.torque += weight * torque;
  }
}

// What dry friction takes from the rate of a sliding joint it takes evenly over the substep, so that half of it is
// still there on the way: the rate to be added to v1.
template <class L>
typename L::V rate_on_the_way(const TreeBatch<L>& t, int i, const typename L::V& v1) {
  using V = typename L::V;
  using S = typename L::Scalar;
  const LinkWork<V>& joint = t.work[i];
  const CoordWork<V>& c = t.coord[t.tree->coord(0) + i];
  const V limited = t.state[i].limited, slides = joint.slip * (S(1) - limited * limited);
  const V most = t.h * t.model[i].friction * c.inv_d;
  return S(0.5) * slides * clamp<L>(V(slides * (c.qd - v1)), V{}, most);
}

// q <- q + h v1, kept within range and margin; qd <- v1. Lanes whose rates are not below `bound` are given
// back and stand still.
template <class L>
typename L::Mask integrate_joints(TreeBatch<L>& t, typename L::Scalar margin, typename L::Scalar bound) {
  using V = typename L::V;
  using Mask = typename L::Mask;
  const Tree& tree = *t.tree;
  const int offset = tree.coord(0);
  const V low = L::all(-bound), high = L::all(bound), zero{};
  Mask good = L::mask(~0u);
  for (int c = 0; c < tree.num_coords; ++c) good = good & (t.coord[c].v1 > low) & (t.coord[c].v1 < high);
  for (int c = 0; c < offset; ++c) t.coord[c].qd = L::select(good, t.coord[c].v1, zero);
  for (int i = 0; i < tree.num_links; ++i) {
    const LinkModel<L>& model = t.model[i];
    V v = L::select(good, t.coord[offset + i].v1, zero), q = t.work[i].q + t.h * v;
    if (t.any_stick) q += t.h * L::select(good, rate_on_the_way(t, i, v), zero);
    const V bottom = model.lower - margin, top = model.upper + margin;
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
