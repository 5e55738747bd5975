// Bias forces by the difference quotients of both sides of a pose, for robots that keep their energy: a free
// base without damping to speak of. Part of stepper_v*.cpp.
//
// With p(q, v) the momenta of all bodies (velocity of each centre of mass, angular momentum about it) at the rates
// v, the motion of a substep changes them at constant rates by
//   D = p(q + h v, v) - p(q, v),
// which is h times Coriolis and centrifugal terms. The quotient of the step before the pose alone lags by half a
// step, and a free base gains energy from that without bound. So each body stores the momentum of the middle
// between two poses, P = p(q, v) + D / 2, and a substep from P- solves for v
//   J^T M (p(q, v) + D / 2 - d P-) = h J^T (forces),          d: what damping keeps
// the trapezoidal rule in joint coordinates: a leapfrog, symmetric in time, whose energy swings and does not drift.
// D depends on v: first D = 2 (p(q, v-) - P-), that of the last substep; then, from the solution, kinematics of the
// pose to come. One such pass is enough, and its D is the one that P is stored with, so that what one substep's
// bias leaves out the next one's has: the momentum of the whole is kept. Only a robot that turns far in the substep
// (kFarTurn) takes a second one, without which it would lose some .5 % of its energy in a second. The mass matrix is
// the same in all solves.
#pragma once
#include "physics/articulated/joint_limits.inl"

namespace rdm {
namespace {

// The velocity of a body's centre of mass c and its angular momentum about c: the link's origin moves by v, w.
template <class V>
inline void momentum_of(const LinkWork<V>& b, const PersistentLink<V>& self, bool isotropic, V* linear,
                        V* angular) {
  V arm[3], w_x_arm[3];
  for (int r = 0; r < 3; ++r) arm[r] = b.c[r] - self.P[r];
  cross(self.w, arm, w_x_arm);
  for (int r = 0; r < 3; ++r) linear[r] = self.v[r] + w_x_arm[r];
  if (isotropic)
    for (int r = 0; r < 3; ++r) angular[r] = b.moment[0] * self.w[r];
  else
    multiply(b.moment, self.w, angular);
}

constexpr double kFarTurn = 0.15;  // rad in a substep, of a joint or a base

// The lanes in which v1 turns a joint or the base by more than kFarTurn.
template <class L>
typename L::Mask turn_far(const TreeBatch<L>& t) {
  using V = typename L::V;
  using S = typename L::Scalar;
  const Tree& tree = *t.tree;
  const V most = L::all(S(kFarTurn) * t.inv_h);
  typename L::Mask far = L::nothing();
  if (tree.free_base) {
    const V w[3] = {t.coord[3].v1, t.coord[4].v1, t.coord[5].v1};
    far = far | (dot(w, w) > most * most);
  }
  for (int i = 0; i < tree.num_links; ++i) {
    if (tree.links[static_cast<size_t>(i)].prismatic) continue;
    const V& rate = t.coord[tree.coord(0) + i].v1;
    far = far | (rate > most) | (rate < -most);
  }
  return far;
}

// D of the last substep, from the momenta as stored.
template <class L>
void guess_ahead(TreeBatch<L>& t) {
  using V = typename L::V;
  using S = typename L::Scalar;
  const Tree& tree = *t.tree;
  const S twice = S(2);
  for (int r = 0; r < 3; ++r) t.base.ahead_v[r] = t.base.ahead_n[r] = V{};
  if (tree.free_base) {
    V w[3], spin[3];
    for (int r = 0; r < 3; ++r) w[r] = t.coord[3 + r].qd;
    multiply(t.base.moment, w, spin);
    for (int r = 0; r < 3; ++r) t.base.ahead_n[r] = twice * (spin[r] - t.base_state.angular[r]);
  }
  for (int i = 0; i < tree.num_links; ++i) {
    const TreeLink& link = tree.links[static_cast<size_t>(i)];
    const PersistentLink<V>& self = t.state[i];
    LinkWork<V>& b = t.work[i];
    if (link.massless) continue;
    V linear[3], angular[3];
    momentum_of(b, self, link.isotropic, linear, angular);
    for (int r = 0; r < 3; ++r) {
      b.ahead_v[r] = twice * (linear[r] - self.linear[r]);
      b.ahead_n[r] = twice * (angular[r] - self.angular[r]);
    }
  }
}

// The base as the rates t.coord[].qd move it in h: R <- exp(h w) R. Its centre of mass keeps its velocity, so
// that of its origin turns with it. D of the base is that of its angular momentum alone.
template <class L>
void move_base_ahead(TreeBatch<L>& t, typename L::Mask lanes) {
  using V = typename L::V;
  using S = typename L::Scalar;
  V w[3], arm[3], x[3], center_v[3], spin[3], sine, cosine;
  for (int r = 0; r < 3; ++r) w[r] = t.coord[3 + r].qd;
  rotate(t.base_R, t.base_com, arm);
  cross(w, arm, x);
  for (int r = 0; r < 3; ++r) center_v[r] = t.coord[r].qd + x[r];
  const V rate = L::root(dot(w, w)) + L::all(S(1e-12));  // an axis for a base that does not turn
  sine_cosine<L>(V(t.h * rate), &sine, &cosine);
  V n[3];
  for (int r = 0; r < 3; ++r) n[r] = w[r] / rate;
  for (int k = 0; k < 3; ++k) {  // Rodrigues' formula, column by column
    const V column[3] = {t.base_R[k], t.base_R[3 + k], t.base_R[6 + k]};
    V turned[3];
    cross(n, column, turned);
    const V along = (S(1) - cosine) * dot(n, column);
    for (int r = 0; r < 3; ++r) t.base_R[3 * r + k] = cosine * column[r] + sine * turned[r] + along * n[r];
  }
  LinkWork<V> next;
  const V origin[3] = {};
  link_inertia<L>(t.base_R, origin, t.base_com, t.base_moment, false, &next);
  multiply(t.base.moment, w, x);
  multiply(next.moment, w, spin);
  for (int r = 0; r < 3; ++r) t.base.ahead_n[r] = L::select(lanes, V(spin[r] - x[r]), t.base.ahead_n[r]);
  cross(w, next.c, x);
  for (int r = 0; r < 3; ++r) t.coord[r].qd = center_v[r] - x[r];
}

// D of a substep with the rates v1, of the lanes in `lanes`. Nothing but D is changed.
template <class L>
void look_ahead(TreeBatch<L>& t, typename L::Mask lanes) {
  using V = typename L::V;
  const Tree& tree = *t.tree;
  const int offset = tree.coord(0);
  V *const rates = t.present, *const angles = t.present + tree.num_coords;
  V R[9];
  for (int k = 0; k < 9; ++k) R[k] = t.base_R[k];
  for (int c = 0; c < tree.num_coords; ++c) {
    rates[c] = t.coord[c].qd;
    t.coord[c].qd = t.coord[c].v1;
  }
  for (int i = 0; i < tree.num_links; ++i) {
    angles[i] = t.work[i].q;
    t.trial[i] = t.state[i];
  }
  std::swap(t.state, t.trial);

  const auto stored = t.base_state;
  momenta(t);  // p(q, v1)
  t.base_state = stored;
  // p(q + h v1, v1)
  if (tree.free_base) move_base_ahead(t, lanes);
  for (int i = 0; i < tree.num_links; ++i) t.work[i].q += t.h * t.coord[offset + i].qd;
  kinematics(t);
  for (int i = 0; i < tree.num_links; ++i) {
    const TreeLink& link = tree.links[static_cast<size_t>(i)];
    if (link.massless) continue;
    LinkWork<V>& b = t.work[i];
    LinkWork<V> next;
    V linear[3], angular[3];
    link_inertia<L>(t.state[i].R, t.state[i].P, t.model[i].com, t.model[i].moment, link.isotropic, &next);
    momentum_of(next, t.state[i], link.isotropic, linear, angular);
    for (int r = 0; r < 3; ++r) {
      b.ahead_v[r] = L::select(lanes, V(linear[r] - t.state[i].linear[r]), b.ahead_v[r]);
      b.ahead_n[r] = L::select(lanes, V(angular[r] - t.state[i].angular[r]), b.ahead_n[r]);
    }
  }

  std::swap(t.state, t.trial);
  for (int k = 0; k < 9; ++k) t.base_R[k] = R[k];
  for (int c = 0; c < tree.num_coords; ++c) t.coord[c].qd = rates[c];
  for (int i = 0; i < tree.num_links; ++i) t.work[i].q = angles[i];
}

// v1 of the lanes in `lanes` anew, with the bias of the motion that v1 is.
template <class L>
void solve_ahead(TreeBatch<L>& t, typename L::Mask lanes) {
  look_ahead(t, lanes);
  body_forces(t);
  bias_forces(t);
  solve_without_contacts(t, lanes, true);
}

// The momenta as they are stored: from those at the solved rates to those of the middle.
template <class L>
void add_half_ahead(TreeBatch<L>& t) {
  using S = typename L::Scalar;
  const S half = S(0.5);
  for (int r = 0; r < 3; ++r) t.base_state.angular[r] += half * t.base.ahead_n[r];
  for (int i = 0; i < t.tree->num_links; ++i) {
    if (t.tree->links[static_cast<size_t>(i)].massless) continue;
    for (int r = 0; r < 3; ++r) {
      t.state[i].linear[r] += half * t.work[i].ahead_v[r];
      t.state[i].angular[r] += half * t.work[i].ahead_n[r];
    }
  }
}

}  // namespace
}  // namespace rdm
