// The rigid-body dynamics of a batch of robots, one robot (a member of one tree) per lane: kinematics, bias
// forces, mass matrix, its factors. Featherstone's algorithms (Rigid Body Dynamics Algorithms, 2008; "RBDA"),
// in the order in which a substep calls them. Part of stepper_v*.cpp.
//
// Frames. Everything is in world axes relative to the base's origin O, where a float's digits are best: where
// in the room a robot stands does not enter. J is a link's joint frame (tree.hpp), P its parent's, c its
// centre of mass. A spatial motion is (a, s): angular velocity and the velocity of the body's point at O; a
// spatial force is (f, n): force and moment about O.
//
//   kinematics          R_WJ = R_WP R_PJ Rz(q), p_J = p_P + R_WP p_PJ; w_J = w_P + z qd,
//                       v_J = v_P + w_P x (p_J - p_P): the first pass of RNEA, RBDA 5.3
//   orientations        the same for quaternions
//   link_inertias       c and the moments about it in world axes, R I R^T
//   motion_subspaces    the column of a joint: revolute (z, p_J x z), prismatic (0, z); RBDA 4.4
//   body_forces         the force that each body's momentum of the last solve needs in this pose (below)
//   bias_forces         the second pass of RNEA, RBDA 5.3: forces summed from the tips, and of a joint
//                       bias_i = a_i . n_i + s_i . f_i
//   composite_inertias  the mass matrix by composite rigid bodies (CRBA, RBDA 6.2): M_ij = S_j . (I_i S_i)
//                       for i and its ancestors j, with I_i the spatial inertia of all that is behind joint
//                       i: mass m, first moment h = m c, second moments J about O. I (a, s) is the momentum
//                       p = m s + a x h, l = J a + h x s
//   factor, substitute  M = L^T D L, L a lower unit triangle with M's own sparsity (RBDA 6.5): nothing fills
//                       in, and n coordinates of depth d cost n d^2; then x <- L^-1 D^-1 L^-T x
//   momenta             the solved rates' momenta, for the next substep
//
// Bias by momentum balance. A textbook's bias takes w x I w of the step's start and may gain energy at a step
// of any size. Here each body's velocity of c and angular momentum about c are stored as the last solve left
// them (v-, L-: vectors of the world), and the bias is what carries them over into the new pose:
//   f   = m' (v_c(q, qd) - d v-) / h - m g - push             g = 0 of weightless links
//   n_c = (I'(q) w(q, qd) - d L-) / h - torque
// with v_c, w of the rates unchanged since the solve. M dv = h (tau - bias) then leaves each body with d p- and
// what weight, pushes and joints add. A robot whose base is damped keeps d = e^(-h damping) of its momentum and
// meets every force, its joints' and its contacts' too, with the masses m' = m / gain (model/flow.hpp): what a
// flying hand does to the thing that it holds does not depend on the length of a substep.
// No Coriolis term is written: the difference quotient is it. But it is the one of the middle between the two
// poses, and is therefore rotated on by kForwardRotation h w. Of a free base's robot, w is taken against the
// base, and the base takes the reaction, so that the momentum of the whole stays exact. Where a tree looks ahead
// (look_ahead.inl), the quotient is that of both sides of the pose instead.
#pragma once
#include "base/simd.hpp"
#include "physics/articulated/world_state.hpp"

namespace rdm {
namespace {

// Part of a substep by which the difference quotient above is rotated. 0.5 would be the whole way from the
// middle to the step's end; at 0 a free swing loses energy fast.
constexpr double kForwardRotation = 0.4;

// What no step changes, per link: JointDef and Inertia by lanes.
template <class L>
struct LinkModel : LinkConstants<typename L::V> {
  using V = typename L::V;
  V R_PJ[9], q_PJ[4], p_PJ[3], com[3];
  V lower, upper, ratio, slack, limit_stiffness, limit_time, limit_weight;
};

// One substep's values, per link.
template <class V>
struct LinkWork {
  V q, target;
  V c[3], moment[6];      // centre of mass and moments about it, world axes
  V f[3], n[3];           // spatial force, then the sum of those behind the joint
  V mass, h[3], J[6];     // spatial inertia, then that of the composite body behind the joint
  V push[6];              // force and torque about the centre of mass
  V spring, gain, bound;  // drive: torque = spring - gain v1, inside +-bound; of a coupled joint, v1 of both
  V damping;              // beside it, outside of the bound
  V stick, slip,
      sticks;           // dry friction: gain while slip is 0, else a torque against slip; 1: a row of its own
  V uncoupled;          // mass matrix of a coupled joint and the other, without the coupling
  V factored_coupling;  // with it, in the factors
  V limit_gain, limit_push;  // soft limit: torque = gain (push - v1), inwards alone
  V torque;                  // mean over the substeps so far
  V ahead_v[3], ahead_n[3];  // what the coming motion changes (look_ahead.inl): of c's velocity, of the spin
};

// Per coordinate.
template <class V>
struct CoordWork {
  V a[3], s[3];         // motion: angular, linear at the base's origin
  V qd, bias;           // rate at the substep's start; RNEA's force
  V inv_d, inv_sqrt_d;  // 1 / D and its root
  V gain;               // what the active set adds to the diagonal
  V factored_gain;      // that, in the factors
  V v1;                 // rate at the substep's end
};

// The robots of one batch. Arrays are by link, coordinate or shape; a number of each is a V, by lane.
template <class L>
struct TreeBatch : BaseConstants<typename L::V> {
  using S = typename L::Scalar;
  using V = typename L::V;
  using Mask = typename L::Mask;

  const Tree* tree;
  S h, inv_h;
  bool spring_only, any_push, any_stick;
  const ContactLaw* limit_law;  // null: limits are hard
  Mask frozen;                  // lanes whose active sets stay for this substep
  uint32_t pushed;              // lanes that have a contact, a bit each
  V base_R[9], base_q[4], base_com[3];
  PersistentBase<V> base_state;
  LinkWork<V> base;
  LinkModel<L>* model;  // [num_links], as all of these
  PersistentLink<V>* state;
  PersistentLink<V>* trial;  // where the tree looks ahead: the links as they will be
  LinkWork<V>* work;
  CoordWork<V>* coord;
  V *mass_matrix, *reduced, *factor;  // rows as in Tree::path
  V *dv, *push;    // by coordinate: change of the velocity; Z J^T lambda (contact_solver.inl)
  V* feedforward;  // [num_links]; null: none
  V* present;      // where the tree looks ahead: rates [num_coords], then angles [num_links]
  // Shapes: place and half axis (of capsules) in their link's joint frame, and both in world axes from the
  // base's origin.
  V (*shape_p)[3], (*shape_a)[3], (*center)[3], (*axis)[3];
  V* shape_way;  // m, how far each one's place moves in the substep; null: nobody asks
  int32_t world[L::kCount], member[L::kCount];  // of each lane; lanes without a world repeat another's
  bool used[L::kCount];
};

template <class V>
inline void cross(const V* a, const V* b, V* out) {
  out[0] = a[1] * b[2] - a[2] * b[1];
  out[1] = a[2] * b[0] - a[0] * b[2];
  out[2] = a[0] * b[1] - a[1] * b[0];
}
template <class V>
[[gnu::always_inline]] inline V dot(const V* a, const V* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
// out = R v, row-major
template <class V>
inline void rotate(const V* R, const V* v, V* out) {
  for (int r = 0; r < 3; ++r) out[r] = R[3 * r] * v[0] + R[3 * r + 1] * v[1] + R[3 * r + 2] * v[2];
}
template <class V>
inline void multiply(const V* J, const V* v, V* out) {  // symmetric xx yy zz xy xz yz
  out[0] = J[0] * v[0] + J[3] * v[1] + J[4] * v[2];
  out[1] = J[3] * v[0] + J[1] * v[1] + J[5] * v[2];
  out[2] = J[4] * v[0] + J[5] * v[1] + J[2] * v[2];
}
// R I R^T
template <class V>
inline void rotate_inertia(const V* R, const V* I, V* out) {
  V t[9];
  for (int r = 0; r < 3; ++r) {
    const V* row = R + 3 * r;
    t[3 * r] = row[0] * I[0] + row[1] * I[3] + row[2] * I[4];
    t[3 * r + 1] = row[0] * I[3] + row[1] * I[1] + row[2] * I[5];
    t[3 * r + 2] = row[0] * I[4] + row[1] * I[5] + row[2] * I[2];
  }
  constexpr int kRow[6] = {0, 1, 2, 0, 0, 1}, kColumn[6] = {0, 1, 2, 1, 2, 2};
  for (int k = 0; k < 6; ++k) {
    const V *a = t + 3 * kRow[k], *b = R + 3 * kColumn[k];
    out[k] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  }
}

// Pose and velocity of every link from q, the rates and the base.
template <class L>
void kinematics(TreeBatch<L>& t) {
  using V = typename L::V;
  const Tree& tree = *t.tree;
  const int offset = tree.coord(0);
  V base_v[3] = {}, base_w[3] = {}, origin[3] = {};
  if (tree.free_base)
    for (int k = 0; k < 3; ++k) {
      base_v[k] = t.coord[k].qd;
      base_w[k] = t.coord[3 + k].qd;
    }
  for (int i = 0; i < tree.num_links; ++i) {
    const TreeLink& link = tree.links[static_cast<size_t>(i)];
    const LinkModel<L>& model = t.model[i];
    PersistentLink<V>& self = t.state[i];
    const V qd = t.coord[offset + i].qd, q = t.work[i].q;
    const bool on_base = link.parent < 0;
    const PersistentLink<V>& parent = t.state[on_base ? 0 : link.parent];
    const V *A = on_base ? t.base_R : parent.R, *P = on_base ? origin : parent.P,
            *v = on_base ? base_v : parent.v, *w = on_base ? base_w : parent.w;
    V T[9];
    if (link.aligned)
      for (int k = 0; k < 9; ++k) T[k] = A[k];
    else
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          T[3 * r + c] =
              A[3 * r] * model.R_PJ[c] + A[3 * r + 1] * model.R_PJ[3 + c] + A[3 * r + 2] * model.R_PJ[6 + c];
    V arm[3];
    rotate(A, model.p_PJ, arm);
    if (link.prismatic) {
      for (int k = 0; k < 9; ++k) self.R[k] = T[k];
      for (int r = 0; r < 3; ++r) arm[r] += q * T[3 * r + 2];
    } else {
      V s, c;
      sine_cosine<L>(q, &s, &c);
      for (int r = 0; r < 3; ++r) {
        self.R[3 * r] = c * T[3 * r] + s * T[3 * r + 1];
        self.R[3 * r + 1] = c * T[3 * r + 1] - s * T[3 * r];
        self.R[3 * r + 2] = T[3 * r + 2];
      }
    }
    V w_x_arm[3];
    cross(w, arm, w_x_arm);
    for (int r = 0; r < 3; ++r) {
      const V axis_rate = qd * T[3 * r + 2];
      self.P[r] = P[r] + arm[r];
      self.v[r] = link.prismatic ? v[r] + w_x_arm[r] + axis_rate : v[r] + w_x_arm[r];
      self.w[r] = link.prismatic ? w[r] : w[r] + axis_rate;
    }
  }
}

// a b, quaternions with w first
template <class V>
[[gnu::always_inline]] inline void multiply_quaternions(const V* a, const V* b, V* out) {
  out[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
  out[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
  out[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
  out[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

// The links' quaternions. A matrix does not tell a quaternion's sign; along the joints it never jumps.
template <class L>
void orientations(TreeBatch<L>& t) {
  using V = typename L::V;
  using S = typename L::Scalar;
  for (int i = 0; i < t.tree->num_links; ++i) {
    const TreeLink& link = t.tree->links[static_cast<size_t>(i)];
    const V* parent = link.parent < 0 ? t.base_q : t.state[link.parent].q;
    V rotated[4];
    if (link.aligned)
      for (int k = 0; k < 4; ++k) rotated[k] = parent[k];
    else
      multiply_quaternions(parent, t.model[i].q_PJ, rotated);
    V* q = t.state[i].q;
    if (link.prismatic) {
      for (int k = 0; k < 4; ++k) q[k] = rotated[k];
      continue;
    }
    V s, c;
    sine_cosine<L>(V(t.work[i].q * S(0.5)), &s, &c);
    q[0] = c * rotated[0] - s * rotated[3];
    q[1] = c * rotated[1] + s * rotated[2];
    q[2] = c * rotated[2] - s * rotated[1];
    q[3] = c * rotated[3] + s * rotated[0];
  }
}

// Momenta that the solved rates `qd` have in the pose they were solved in: the next substep's bias keeps
// them.
template <class L>
void momenta(TreeBatch<L>& t) {
  using V = typename L::V;
  const Tree& tree = *t.tree;
  const int offset = tree.coord(0);
  V base_v[3] = {}, base_w[3] = {}, origin[3] = {};
  if (tree.free_base) {
    for (int k = 0; k < 3; ++k) {
      base_v[k] = t.coord[k].qd;
      base_w[k] = t.coord[3 + k].qd;
    }
    V w_x_arm[3];
    cross(base_w, t.base.c, w_x_arm);
    for (int k = 0; k < 3; ++k) t.base_state.linear[k] = base_v[k] + w_x_arm[k];
    multiply(t.base.moment, base_w, t.base_state.angular);
  }
  for (int i = 0; i < tree.num_links; ++i) {
    const TreeLink& link = tree.links[static_cast<size_t>(i)];
    PersistentLink<V>& self = t.state[i];
    const bool on_base = link.parent < 0;
    const PersistentLink<V>& parent = t.state[on_base ? 0 : link.parent];
    const V *P = on_base ? origin : parent.P, *v = on_base ? base_v : parent.v,
            *w = on_base ? base_w : parent.w;
    V arm[3], w_x_arm[3];
    for (int r = 0; r < 3; ++r) arm[r] = self.P[r] - P[r];
    cross(w, arm, w_x_arm);
    for (int r = 0; r < 3; ++r) {
      const V axis_rate = t.coord[offset + i].qd * self.R[3 * r + 2];
      self.v[r] = link.prismatic ? v[r] + w_x_arm[r] + axis_rate : v[r] + w_x_arm[r];
      self.w[r] = link.prismatic ? w[r] : w[r] + axis_rate;
    }
    if (link.massless) continue;
    for (int r = 0; r < 3; ++r) arm[r] = t.work[i].c[r] - self.P[r];
    cross(self.w, arm, w_x_arm);
    for (int r = 0; r < 3; ++r) self.linear[r] = self.v[r] + w_x_arm[r];
    if (link.isotropic)
      for (int r = 0; r < 3; ++r) self.angular[r] = t.work[i].moment[0] * self.w[r];
    else
      multiply(t.work[i].moment, self.w, self.angular);
  }
}

// Place of each shape and direction of the slender ones, for the collider's bounds.
template <class L>
void shape_poses(TreeBatch<L>& t) {
  using V = typename L::V;
  const Tree& tree = *t.tree;
  V origin[3] = {};
  for (int k = 0; k < static_cast<int>(tree.shape_links.size()); ++k) {
    const int link = tree.shape_links[static_cast<size_t>(k)];
    const V *R = link < 0 ? t.base_R : t.state[link].R, *P = link < 0 ? origin : t.state[link].P;
    rotate(R, t.shape_p[k], t.center[k]);
    for (int r = 0; r < 3; ++r) t.center[k][r] += P[r];
    if (tree.shape_slender[static_cast<size_t>(k)]) rotate(R, t.shape_a[k], t.axis[k]);
  }
}

// How far each shape's place moves in the substep at the velocities that it begins with.
template <class L>
void shape_ways(TreeBatch<L>& t) {
  using V = typename L::V;
  const Tree& tree = *t.tree;
  for (int k = 0; k < static_cast<int>(tree.shape_links.size()); ++k) {
    const int link = tree.shape_links[static_cast<size_t>(k)];
    if (link < 0 && !tree.free_base) continue;
    V v[3], w[3], arm[3], turn[3];
    for (int r = 0; r < 3; ++r) {
      v[r] = link < 0 ? t.coord[r].qd : t.state[link].v[r];
      w[r] = link < 0 ? t.coord[3 + r].qd : t.state[link].w[r];
      arm[r] = link < 0 ? t.center[k][r] : V(t.center[k][r] - t.state[link].P[r]);
    }
    cross(w, arm, turn);
    for (int r = 0; r < 3; ++r) v[r] += turn[r];
    t.shape_way[k] = t.h * L::root(dot(v, v));
  }
}

// Centre of mass and moments in world axes.
template <class L, class V>
inline void link_inertia(const V* R, const V* P, const V* com, const V* moment, bool isotropic,
                         LinkWork<V>* out) {
  V arm[3];
  rotate(R, com, arm);
  for (int r = 0; r < 3; ++r) out->c[r] = P[r] + arm[r];
  if (!isotropic)
    rotate_inertia(R, moment, out->moment);
  else
    for (int k = 0; k < 6; ++k) out->moment[k] = moment[k];
}

template <class L>
void link_inertias(TreeBatch<L>& t) {
  using V = typename L::V;
  const Tree& tree = *t.tree;
  V origin[3] = {};
  if (tree.free_base) link_inertia<L>(t.base_R, origin, t.base_com, t.base_moment, false, &t.base);
  for (int i = 0; i < tree.num_links; ++i) {
    const TreeLink& link = tree.links[static_cast<size_t>(i)];
    if (!link.massless)
      link_inertia<L>(t.state[i].R, t.state[i].P, t.model[i].com, t.model[i].moment, link.isotropic,
                      &t.work[i]);
  }
}

// The joints' columns of the motion subspace. Those of a free base never change: its linear three are (0,
// e_k), its angular three (e_k, 0).
template <class L>
void motion_subspaces(TreeBatch<L>& t) {
  using V = typename L::V;
  const Tree& tree = *t.tree;
  const int offset = tree.coord(0);
  for (int i = 0; i < tree.num_links; ++i) {
    const PersistentLink<V>& self = t.state[i];
    CoordWork<V>& c = t.coord[offset + i];
    const V z[3] = {self.R[2], self.R[5], self.R[8]};
    if (tree.links[static_cast<size_t>(i)].prismatic) {
      for (int r = 0; r < 3; ++r) c.a[r] = V{}, c.s[r] = z[r];
    } else {
      for (int r = 0; r < 3; ++r) c.a[r] = z[r];
      cross(self.P, z, c.s);
    }
  }
}

// Momentum balance of one body whose origin moves with v, w and lies `arm` before its centre of mass;
// `linear` and `angular` are the momenta of the last solve. `relative_w` (null: none) is its angular velocity
// against the base, by which the quotient is rotated on; `reaction` sums what that adds, as a spatial force.
template <class L, class V>
[[gnu::always_inline]] inline void body_force(const TreeBatch<L>& t, const V* v, const V* w, const V* arm,
                                              const V* linear, const V* angular, const V& mass,
                                              const V* gravity, bool isotropic, const V* relative_w,
                                              V* reaction, LinkWork<V>* b) {
  using S = typename L::Scalar;
  V w_x_arm[3], spin[3], dv[3], dn[3];
  const V* c = b->c;
  cross(w, arm, w_x_arm);
  if (isotropic)
    for (int r = 0; r < 3; ++r) spin[r] = b->moment[0] * w[r];
  else
    multiply(b->moment, w, spin);
  for (int r = 0; r < 3; ++r) {
    dv[r] = (v[r] + w_x_arm[r] - t.linear_damping * linear[r]) * t.inv_h;
    dn[r] = (spin[r] - t.angular_damping * angular[r]) * t.inv_h;
  }
  if (t.tree->looks_ahead) {
    const S half_rate = S(0.5) * t.inv_h;
    for (int r = 0; r < 3; ++r) {
      dv[r] += half_rate * b->ahead_v[r];
      dn[r] += half_rate * b->ahead_n[r];
    }
  } else if (relative_w) {
    const S angle_per_rate = S(kForwardRotation) * t.h;
    V tv[3], tn[3];
    cross(relative_w, dv, tv);
    cross(relative_w, dn, tn);
    for (int r = 0; r < 3; ++r) {
      tv[r] = angle_per_rate * tv[r];
      tn[r] = angle_per_rate * tn[r];
      dv[r] += tv[r];
      dn[r] += tn[r];
    }
    if (reaction) {
      for (int r = 0; r < 3; ++r) tv[r] = mass * tv[r];
      V moment[3];
      cross(c, tv, moment);
      for (int r = 0; r < 3; ++r) {
        reaction[r] += tv[r];
        reaction[3 + r] += moment[r] + tn[r];
      }
    }
  }
  for (int r = 0; r < 3; ++r) b->f[r] = mass * (dv[r] - gravity[r]);
  if (t.any_push)
    for (int r = 0; r < 3; ++r) {
      b->f[r] -= b->push[r];
      dn[r] -= b->push[3 + r];
    }
  cross(c, b->f, b->n);  // from c to O
  for (int r = 0; r < 3; ++r) b->n[r] += dn[r];
}

// A link without mass hands a push on to what hangs on it. The push is about the centre of mass it names.
template <class V>
void push_massless(const PersistentLink<V>& state, const V* com, LinkWork<V>* b) {
  V arm[3];
  rotate(state.R, com, arm);
  for (int r = 0; r < 3; ++r) {
    arm[r] += state.P[r];
    b->f[r] = -b->push[r];
  }
  cross(arm, b->f, b->n);
  for (int r = 0; r < 3; ++r) b->n[r] -= b->push[3 + r];
}

// f, n of every body for the rates qd in the present pose.
template <class L>
void body_forces(TreeBatch<L>& t) {
  using V = typename L::V;
  const Tree& tree = *t.tree;
  V reaction[6] = {}, base_w[3] = {};
  const V weightless[3] = {};
  if (tree.free_base)
    for (int k = 0; k < 3; ++k) base_w[k] = t.coord[3 + k].qd;
  for (int i = 0; i < tree.num_links; ++i) {
    const TreeLink& link = tree.links[static_cast<size_t>(i)];
    const PersistentLink<V>& self = t.state[i];
    LinkWork<V>& b = t.work[i];
    if (link.massless) {
      for (int r = 0; r < 3; ++r) b.f[r] = b.n[r] = V{};
      if (t.any_push) push_massless(self, t.model[i].com, &b);
      continue;
    }
    V arm[3], relative_w[3];
    for (int r = 0; r < 3; ++r) arm[r] = b.c[r] - self.P[r];
    for (int r = 0; r < 3; ++r) relative_w[r] = tree.free_base ? self.w[r] - base_w[r] : self.w[r];
    body_force<L>(t, self.v, self.w, arm, self.linear, self.angular, t.model[i].mass,
                  link.weightless ? weightless : t.gravity, link.isotropic, relative_w,
                  tree.free_base ? reaction : nullptr, &b);
  }
  if (!tree.free_base) return;
  V v[3];
  for (int k = 0; k < 3; ++k) v[k] = t.coord[k].qd;
  body_force<L>(t, v, base_w, t.base.c, t.base_state.linear, t.base_state.angular, t.base_mass, t.gravity,
                false, static_cast<const V*>(nullptr), static_cast<V*>(nullptr), &t.base);
  for (int r = 0; r < 3; ++r) {  // the base takes the reaction: momentum is kept
    t.base.f[r] -= reaction[r];
    t.base.n[r] -= reaction[3 + r];
  }
}

// RNEA's second pass: forces summed from the tips, each joint's part of them its bias.
template <class L>
void bias_forces(TreeBatch<L>& t) {
  using V = typename L::V;
  const Tree& tree = *t.tree;
  const int offset = tree.coord(0);
  for (int i = tree.num_links - 1; i >= 0; --i) {
    const int parent = tree.links[static_cast<size_t>(i)].parent;
    const LinkWork<V>& b = t.work[i];
    CoordWork<V>& c = t.coord[offset + i];
    c.bias = dot(c.a, b.n) + dot(c.s, b.f);
    if (parent < 0 && !tree.free_base) continue;
    LinkWork<V>& inboard = parent < 0 ? t.base : t.work[parent];
    for (int r = 0; r < 3; ++r) {
      inboard.f[r] += b.f[r];
      inboard.n[r] += b.n[r];
    }
  }
  if (!tree.free_base) return;
  for (int k = 0; k < 3; ++k) {
    t.coord[k].bias = t.base.f[k];
    t.coord[3 + k].bias = t.base.n[k];
  }
}

// Mass, first and second moments of one body about O (parallel axes).
template <class V>
[[gnu::always_inline]] inline void spatial_inertia(const V& mass, LinkWork<V>* b) {
  const V* c = b->c;
  for (int r = 0; r < 3; ++r) b->h[r] = mass * c[r];
  b->mass = mass;
  const V x = b->h[0] * c[0], y = b->h[1] * c[1], z = b->h[2] * c[2];
  b->J[0] = b->moment[0] + y + z;
  b->J[1] = b->moment[1] + x + z;
  b->J[2] = b->moment[2] + x + y;
  b->J[3] = b->moment[3] - b->h[0] * c[1];
  b->J[4] = b->moment[4] - b->h[0] * c[2];
  b->J[5] = b->moment[5] - b->h[1] * c[2];
}

// CRBA: the rows of the mass matrix, from the tips; a link's spatial inertia is composite when its turn
// comes.
template <class L>
void composite_inertias(TreeBatch<L>& t) {
  using V = typename L::V;
  const Tree& tree = *t.tree;
  const int offset = tree.coord(0);
  for (int i = 0; i < tree.num_links; ++i) {
    LinkWork<V>& b = t.work[i];
    if (!tree.links[static_cast<size_t>(i)].massless) {
      spatial_inertia(t.model[i].mass, &b);
      continue;
    }
    for (int r = 0; r < 3; ++r) b.h[r] = V{};
    for (int k = 0; k < 6; ++k) b.J[k] = V{};
    b.mass = V{};
  }
  if (tree.free_base) spatial_inertia(t.base_mass, &t.base);
  for (int i = tree.num_links - 1; i >= 0; --i) {
    const int parent = tree.links[static_cast<size_t>(i)].parent;
    const int at = offset + i, depth = tree.depth[static_cast<size_t>(at)];
    const int row = tree.row[static_cast<size_t>(at)];
    const LinkWork<V>& b = t.work[i];
    const V *a = t.coord[at].a, *s = t.coord[at].s;
    V p[3], l[3], x[3];  // momentum of the composite body at unit rate
    cross(a, b.h, x);
    for (int r = 0; r < 3; ++r) p[r] = b.mass * s[r] + x[r];
    multiply(b.J, a, l);
    cross(b.h, s, x);
    for (int r = 0; r < 3; ++r) l[r] += x[r];
    for (int d = 0; d <= depth; ++d) {
      const CoordWork<V>& other = t.coord[tree.path[static_cast<size_t>(row + d)]];
      t.mass_matrix[row + d] =
          tree.moving[static_cast<size_t>(row + d)] ? V(dot(other.a, l) + dot(other.s, p)) : V{};
    }
    t.mass_matrix[row + depth] += t.model[i].armature;
    if (parent < 0 && !tree.free_base) continue;
    LinkWork<V>& inboard = parent < 0 ? t.base : t.work[parent];
    inboard.mass += b.mass;
    for (int r = 0; r < 3; ++r) inboard.h[r] += b.h[r];
    for (int k = 0; k < 6; ++k) inboard.J[k] += b.J[k];
  }
  if (!tree.free_base) return;
  const LinkWork<V>& b = t.base;
  const auto entry = [&](int c, int d) -> V& { return t.mass_matrix[tree.row[static_cast<size_t>(c)] + d]; };
  for (int k = 0; k < 3; ++k) {
    for (int d = 0; d < k; ++d) entry(k, d) = V{};
    entry(k, k) = b.mass;
  }
  // momentum at unit angular rate: linear e_k x h, angular column k of J
  entry(3, 0) = V{}, entry(3, 1) = -b.h[2], entry(3, 2) = b.h[1];
  entry(4, 0) = b.h[2], entry(4, 1) = V{}, entry(4, 2) = -b.h[0];
  entry(5, 0) = -b.h[1], entry(5, 1) = b.h[0], entry(5, 2) = V{};
  entry(3, 3) = b.J[0];
  entry(4, 3) = b.J[3], entry(4, 4) = b.J[1];
  entry(5, 3) = b.J[4], entry(5, 4) = b.J[5], entry(5, 5) = b.J[2];
}

// kCount entries of a row of D L: those of M minus the products with the rows of the coordinates below, the last
// of these first. The sums stay in registers. With the last entries of a row come its diagonal, to which `more`
// is added, and its entry `right` of the right side, which is reduced in the same loop.
template <int kCount, class V>
void reduce_entries(const V* matrix, const V* more, const TreeBelow* below, const TreeBelow* end,
                    const V* factor, const V* reduced, V* out, const V* rights, V* right) {
  V sum[kCount];
  for (int e = 0; e < kCount; ++e) sum[e] = matrix[e];
  if (more) {
    sum[kCount - 1] += *more;
    V x = *right;
    for (; below < end; ++below) {
      const V a = factor[below->row];
      const V* row = reduced + below->row;
      for (int e = 0; e < kCount; ++e) sum[e] -= a * row[e];
      x -= a * rights[below->coord];
    }
    *right = x;
  } else {
    for (; below < end; ++below) {
      const V a = factor[below->row];
      const V* row = reduced + below->row;
      for (int e = 0; e < kCount; ++e) sum[e] -= a * row[e];
    }
  }
  for (int e = 0; e < kCount; ++e) out[e] = sum[e];
}

// Which rows of the factors have to be computed again: those whose gain or coupling changed since they were
// made, and all rows above these on the way to the root.
template <class L>
void find_stale_rows(TreeBatch<L>& t, uint8_t* stale) {
  const Tree& tree = *t.tree;
  const auto differ = [](const typename L::V& a, const typename L::V& b) { return L::bits(a != b) != 0; };
  for (int k = 0; k < tree.num_coords; ++k) stale[k] = differ(t.coord[k].gain, t.coord[k].factored_gain);
  for (const int32_t i : tree.coupled)
    if (differ(t.mass_matrix[tree.links[static_cast<size_t>(i)].coupling_entry], t.work[i].factored_coupling))
      stale[tree.coord(i)] = 1;
  for (int k = tree.num_coords - 1; k >= 0; --k) {
    const auto at = static_cast<size_t>(k);
    const int16_t* above = tree.path.data() + tree.row[at];
    for (int d = 0; stale[k] && d < tree.depth[at]; ++d) stale[above[d]] = 1;
  }
}

// One step of x <- L^-T x: subtracts from t.dv[k] the part that the coordinates below k have.
template <class L>
void reduce_right_side(TreeBatch<L>& t, int k) {
  const Tree& tree = *t.tree;
  const auto at = static_cast<size_t>(k);
  const typename L::V* factor = t.factor + tree.depth[at];
  typename L::V x = t.dv[k];
  for (int32_t b = tree.first_below[at]; b < tree.first_below[at + 1]; ++b) {
    const TreeBelow& below = tree.below[static_cast<size_t>(b)];
    x -= factor[below.row] * t.dv[below.coord];
  }
  t.dv[k] = x;
}

// The rows of t.mass_matrix with the gains on its diagonal: t.factor gets those of L off the diagonal, inv_d
// 1 / D. t.dv becomes L^-T t.dv on the way. `kept`: the factors belong to this matrix except for gains and
// couplings, so that most rows need no work.
template <class L>
void factor(TreeBatch<L>& t, bool kept) {
  using V = typename L::V;
  using S = typename L::Scalar;
  const Tree& tree = *t.tree;
  const int32_t *rows = tree.row.data(), *depths = tree.depth.data();
  V* const dv = t.dv;
  uint8_t stale[kMaxCoords];
  if (kept) find_stale_rows(t, stale);
  for (const int32_t i : tree.coupled)
    t.work[i].factored_coupling = t.mass_matrix[tree.links[static_cast<size_t>(i)].coupling_entry];
  for (int k = tree.num_coords - 1; k >= 0; --k) {
    if (kept && !stale[k]) {
      reduce_right_side(t, k);
      continue;
    }
    t.coord[k].factored_gain = t.coord[k].gain;
    const int depth = depths[k], row = rows[k];
    const TreeBelow *below = tree.below.data() + tree.first_below[static_cast<size_t>(k)],
                    *end = tree.below.data() + tree.first_below[static_cast<size_t>(k) + 1];
    const V *factor = t.factor + depth, *reduced = t.reduced, *from = t.mass_matrix + row;
    V* to = t.reduced + row;
    int left = depth + 1;
    for (; left > 8; left -= 8, from += 8, reduced += 8, to += 8)
      reduce_entries<8, V>(from, nullptr, below, end, factor, reduced, to, nullptr, nullptr);
    const auto rest = [&](auto count) {
      reduce_entries<count.value>(from, &t.coord[k].gain, below, end, factor, reduced, to, dv, dv + k);
    };
    switch (left) {
      case 1:
        rest(std::integral_constant<int, 1>{});
        break;
      case 2:
        rest(std::integral_constant<int, 2>{});
        break;
      case 3:
        rest(std::integral_constant<int, 3>{});
        break;
      case 4:
        rest(std::integral_constant<int, 4>{});
        break;
      case 5:
        rest(std::integral_constant<int, 5>{});
        break;
      case 6:
        rest(std::integral_constant<int, 6>{});
        break;
      case 7:
        rest(std::integral_constant<int, 7>{});
        break;
      default:
        rest(std::integral_constant<int, 8>{});
    }
    const V *whole = t.reduced + row, inv_d = S(1) / whole[depth];
    V* part = t.factor + row;
    t.coord[k].inv_d = inv_d;
    for (int d = 0; d < depth; ++d) part[d] = whole[d] * inv_d;
  }
}

// t.dv <- L^-T t.dv, with the factors at hand.
template <class L>
void reduce_right_side(TreeBatch<L>& t) {
  for (int k = t.tree->num_coords - 1; k >= 0; --k) reduce_right_side(t, k);
}

// t.dv <- L^-1 D^-1 t.dv
template <class L>
void substitute(TreeBatch<L>& t) {
  using V = typename L::V;
  const Tree& tree = *t.tree;
  const int32_t *rows = tree.row.data(), *depths = tree.depth.data();
  V* const dv = t.dv;
  for (int k = 0; k < tree.num_coords; ++k) {
    V x = dv[k] * t.coord[k].inv_d;
    const V* row = t.factor + rows[k];
    const int16_t* path = tree.path.data() + rows[k];
    for (int d = 0; d < depths[k]; ++d) x -= row[d] * dv[path[d]];
    dv[k] = x;
  }
}

}  // namespace
}  // namespace rdm
