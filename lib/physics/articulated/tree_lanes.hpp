// The articulated-body arithmetic of one tree, by lanes: kinematics, mass matrix, bias forces, factors.
//
// A lane is one robot. Everything is in world axes relative to the base's origin, where the float's digits
// are best. Part of stepper_v*.cpp.
//   kinematics   recursive, root to tip
//   mass matrix  composite rigid bodies; rows hold ancestors alone (Featherstone, Rigid Body Dynamics
//                Algorithms, ch. 6 and 8.6: L^T D L along the tree)
//   bias         momentum balance: each link's momentum of the last solve is carried on and what the joints
//                would have to do against it is projected on this pose. It cannot gain energy at any step
//                size, unlike explicit Coriolis forces.
#pragma once
#include "base/simd.hpp"
#include "physics/articulated/tree.hpp"

namespace rdm {
namespace {

// Turns the mid-step acceleration towards the step's end: 0.5 would be the midpoint, 0 loses energy fast.
constexpr double kTurn = 0.4;

// What never changes, per link.
template <class L>
struct LinkLanes {
  using V = typename L::V;
  V R_PJ[9], q_PJ[4], p_PJ[3], com[3], mass, moment[6];
  V kp, kd, effort, lower, upper, armature, friction, ratio, slack;
};

// What lasts from step to step, per link (and for the base: v, w, momentum). Kept by each world as plain
// numbers in this order.
template <class V>
struct LinkState {
  V R[9], P[3], w[3], v[3];  // R_WJ, origin from the base's, angular velocity, velocity of the origin
  V linear[3], angular[3];   // velocity of the centre of mass and angular momentum, as solved
  V saturated, limited;      // the sets: -1, 0, 1
  V q[4];                    // q_WJ, w first; of the end of the control step
};
template <class V>
struct BaseState {
  V linear[3], angular[3];
};

// One substep's values, per link.
template <class V>
struct LinkWork {
  V q, target;
  V c[3], moment[6];   // centre of mass and moments about it, world axes
  V f[3], n[3];        // momentum balance, summed towards the root; moments about the base's origin
  V mass, h[3], J[6];  // composite: mass, first moment, moments about the base's origin
  V push[6];           // force and torque about the centre of mass
  V spring, gain, bound, torque;
};

// Per coordinate.
template <class V>
struct CoordWork {
  V a[3], s[3];  // motion: angular, linear at the base's origin
  V qd, bias, inverse, root, dv, v1;
};

template <class L>
struct TreeBatch {
  using S = typename L::Scalar;
  using V = typename L::V;
  using Mask = typename L::Mask;

  const Tree* tree;
  S h, inverse_h, limit_stiffness;
  bool spring_only, any_push;
  Mask frozen;                                    // lanes whose sets stay as they are for this substep
  V gravity[3], linear_damping, angular_damping;  // factors of implicit damping, 1 without
  V base_R[9], base_q[4], base_mass, base_com[3], base_moment[6];
  BaseState<V> base_keep;
  LinkWork<V> base;
  LinkLanes<L>* bones;
  LinkState<V>* keep;
  LinkWork<V>* work;
  CoordWork<V>* coord;
  V *mass_matrix, *factor;  // rows as in Tree::path
  // Shapes: place and half axis (of capsules) in their link's joint frame, and both in world axes from the
  // base's origin.
  V (*shape_p)[3], (*shape_a)[3], (*center)[3], (*axis)[3];
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
inline void turn(const V* R, const V* v, V* out) {
  for (int r = 0; r < 3; ++r) out[r] = R[3 * r] * v[0] + R[3 * r + 1] * v[1] + R[3 * r + 2] * v[2];
}
template <class V>
inline void times(const V* J, const V* v, V* out) {  // symmetric xx yy zz xy xz yz
  out[0] = J[0] * v[0] + J[3] * v[1] + J[4] * v[2];
  out[1] = J[3] * v[0] + J[1] * v[1] + J[5] * v[2];
  out[2] = J[4] * v[0] + J[5] * v[1] + J[2] * v[2];
}
// R I R^T
template <class V>
inline void turn_moment(const V* R, const V* I, V* out) {
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
    const LinkLanes<L>& bone = t.bones[i];
    LinkState<V>& me = t.keep[i];
    const V qd = t.coord[offset + i].qd, q = t.work[i].q;
    const bool root = link.parent < 0;
    const LinkState<V>& up = t.keep[root ? 0 : link.parent];
    const V *A = root ? t.base_R : up.R, *P = root ? origin : up.P, *v = root ? base_v : up.v,
            *w = root ? base_w : up.w;
    V T[9];
    if (link.aligned)
      for (int k = 0; k < 9; ++k) T[k] = A[k];
    else
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
          T[3 * r + c] =
              A[3 * r] * bone.R_PJ[c] + A[3 * r + 1] * bone.R_PJ[3 + c] + A[3 * r + 2] * bone.R_PJ[6 + c];
    V arm[3];
    turn(A, bone.p_PJ, arm);
    if (link.prismatic) {
      for (int k = 0; k < 9; ++k) me.R[k] = T[k];
      for (int r = 0; r < 3; ++r) arm[r] += q * T[3 * r + 2];
    } else {
      V s, c;
      sine_cosine<L>(q, &s, &c);
      for (int r = 0; r < 3; ++r) {
        me.R[3 * r] = c * T[3 * r] + s * T[3 * r + 1];
        me.R[3 * r + 1] = c * T[3 * r + 1] - s * T[3 * r];
        me.R[3 * r + 2] = T[3 * r + 2];
      }
    }
    V swing[3];
    cross(w, arm, swing);
    for (int r = 0; r < 3; ++r) {
      const V along = qd * T[3 * r + 2];
      me.P[r] = P[r] + arm[r];
      me.v[r] = link.prismatic ? v[r] + swing[r] + along : v[r] + swing[r];
      me.w[r] = link.prismatic ? w[r] : w[r] + along;
    }
  }
}

// a b, quaternions with w first
template <class V>
[[gnu::always_inline]] inline void times_quaternion(const V* a, const V* b, V* out) {
  out[0] = a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3];
  out[1] = a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2];
  out[2] = a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1];
  out[3] = a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0];
}

// The links' quaternions. A matrix does not tell a quaternion's sign; along the joints it never jumps.
template <class L>
void turns(TreeBatch<L>& t) {
  using V = typename L::V;
  using S = typename L::Scalar;
  for (int i = 0; i < t.tree->num_links; ++i) {
    const TreeLink& link = t.tree->links[static_cast<size_t>(i)];
    const V* up = link.parent < 0 ? t.base_q : t.keep[link.parent].q;
    V turned[4];
    if (link.aligned)
      for (int k = 0; k < 4; ++k) turned[k] = up[k];
    else
      times_quaternion(up, t.bones[i].q_PJ, turned);
    V* q = t.keep[i].q;
    if (link.prismatic) {
      for (int k = 0; k < 4; ++k) q[k] = turned[k];
      continue;
    }
    V s, c;
    sine_cosine<L>(V(t.work[i].q * S(0.5)), &s, &c);
    q[0] = c * turned[0] - s * turned[3];
    q[1] = c * turned[1] + s * turned[2];
    q[2] = c * turned[2] - s * turned[1];
    q[3] = c * turned[3] + s * turned[0];
  }
}

// Momenta that the rates `qd` give in the pose they were solved in: what the next step carries on.
template <class L>
void carry(TreeBatch<L>& t) {
  using V = typename L::V;
  const Tree& tree = *t.tree;
  const int offset = tree.coord(0);
  V base_v[3] = {}, base_w[3] = {}, origin[3] = {};
  if (tree.free_base) {
    for (int k = 0; k < 3; ++k) {
      base_v[k] = t.coord[k].qd;
      base_w[k] = t.coord[3 + k].qd;
    }
    V swing[3];
    cross(base_w, t.base.c, swing);
    for (int k = 0; k < 3; ++k) t.base_keep.linear[k] = base_v[k] + swing[k];
    times(t.base.moment, base_w, t.base_keep.angular);
  }
  for (int i = 0; i < tree.num_links; ++i) {
    const TreeLink& link = tree.links[static_cast<size_t>(i)];
    LinkState<V>& me = t.keep[i];
    const bool root = link.parent < 0;
    const LinkState<V>& up = t.keep[root ? 0 : link.parent];
    const V *P = root ? origin : up.P, *v = root ? base_v : up.v, *w = root ? base_w : up.w;
    V arm[3], swing[3];
    for (int r = 0; r < 3; ++r) arm[r] = me.P[r] - P[r];
    cross(w, arm, swing);
    for (int r = 0; r < 3; ++r) {
      const V along = t.coord[offset + i].qd * me.R[3 * r + 2];
      me.v[r] = link.prismatic ? v[r] + swing[r] + along : v[r] + swing[r];
      me.w[r] = link.prismatic ? w[r] : w[r] + along;
    }
    if (link.massless) continue;
    for (int r = 0; r < 3; ++r) arm[r] = t.work[i].c[r] - me.P[r];
    cross(me.w, arm, swing);
    for (int r = 0; r < 3; ++r) me.linear[r] = me.v[r] + swing[r];
    if (link.round)
      for (int r = 0; r < 3; ++r) me.angular[r] = t.work[i].moment[0] * me.w[r];
    else
      times(t.work[i].moment, me.w, me.angular);
  }
}

// Where the shapes are.
template <class L>
void place_shapes(TreeBatch<L>& t) {
  using V = typename L::V;
  const Tree& tree = *t.tree;
  V origin[3] = {};
  for (int k = 0; k < static_cast<int>(tree.shape_links.size()); ++k) {
    const int link = tree.shape_links[static_cast<size_t>(k)];
    const V *R = link < 0 ? t.base_R : t.keep[link].R, *P = link < 0 ? origin : t.keep[link].P;
    turn(R, t.shape_p[k], t.center[k]);
    for (int r = 0; r < 3; ++r) t.center[k][r] += P[r];
    if (tree.shape_slender[static_cast<size_t>(k)]) turn(R, t.shape_a[k], t.axis[k]);
  }
}

// Centre of mass and moments in world axes.
template <class L, class V>
inline void place_mass(const V* R, const V* P, const V* com, const V* moment, bool round, LinkWork<V>* out) {
  V arm[3];
  turn(R, com, arm);
  for (int r = 0; r < 3; ++r) out->c[r] = P[r] + arm[r];
  if (!round)
    turn_moment(R, moment, out->moment);
  else
    for (int k = 0; k < 6; ++k) out->moment[k] = moment[k];
}

template <class L>
void place_masses(TreeBatch<L>& t) {
  using V = typename L::V;
  const Tree& tree = *t.tree;
  V origin[3] = {};
  if (tree.free_base) place_mass<L>(t.base_R, origin, t.base_com, t.base_moment, false, &t.base);
  for (int i = 0; i < tree.num_links; ++i) {
    const TreeLink& link = tree.links[static_cast<size_t>(i)];
    if (!link.massless)
      place_mass<L>(t.keep[i].R, t.keep[i].P, t.bones[i].com, t.bones[i].moment, link.round, &t.work[i]);
  }
}

// Momentum balance and composite inertia of one body, about the base's origin. With `turning` (its rate
// against the base) the balance is turned from the middle of the step towards its end, without which a free
// swing loses energy fast; `reaction` adds up what that does to the sum of all momenta.
template <class L, class V>
[[gnu::always_inline]] inline void balance(const TreeBatch<L>& t, const V* v, const V* w, const V* arm,
                                           const V* linear, const V* angular, const V& mass, bool round,
                                           const V* turning, V* reaction, LinkWork<V>* b) {
  using S = typename L::Scalar;
  V swing[3], now[3], dv[3], dn[3];
  const V* c = b->c;
  cross(w, arm, swing);
  if (round)
    for (int r = 0; r < 3; ++r) now[r] = b->moment[0] * w[r];
  else
    times(b->moment, w, now);
  for (int r = 0; r < 3; ++r) {
    dv[r] = (v[r] + swing[r] - t.linear_damping * linear[r]) * t.inverse_h;
    dn[r] = (now[r] - t.angular_damping * angular[r]) * t.inverse_h;
  }
  if (turning) {
    const S turn_by = S(kTurn) * t.h;
    V tv[3], tn[3];
    cross(turning, dv, tv);
    cross(turning, dn, tn);
    for (int r = 0; r < 3; ++r) {
      tv[r] = turn_by * tv[r];
      tn[r] = turn_by * tn[r];
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
  for (int r = 0; r < 3; ++r) b->f[r] = mass * (dv[r] - t.linear_damping * t.gravity[r]);
  if (t.any_push)
    for (int r = 0; r < 3; ++r) {
      b->f[r] -= t.linear_damping * b->push[r];
      dn[r] -= t.angular_damping * b->push[3 + r];
    }
  cross(c, b->f, b->n);
  for (int r = 0; r < 3; ++r) {
    b->n[r] += dn[r];
    b->h[r] = mass * c[r];
  }
  b->mass = mass;
  const V x = b->h[0] * c[0], y = b->h[1] * c[1], z = b->h[2] * c[2];
  b->J[0] = b->moment[0] + y + z;
  b->J[1] = b->moment[1] + x + z;
  b->J[2] = b->moment[2] + x + y;
  b->J[3] = b->moment[3] - b->h[0] * c[1];
  b->J[4] = b->moment[4] - b->h[0] * c[2];
  b->J[5] = b->moment[5] - b->h[1] * c[2];
}

// A link without mass hands a push on to what hangs on it. The push is about the centre of mass it names.
template <class L, class V>
void push_massless(const TreeBatch<L>& t, const LinkState<V>& keep, const V* com, LinkWork<V>* b) {
  V arm[3];
  turn(keep.R, com, arm);
  for (int r = 0; r < 3; ++r) {
    arm[r] += keep.P[r];
    b->f[r] = -(t.linear_damping * b->push[r]);
  }
  cross(arm, b->f, b->n);
  for (int r = 0; r < 3; ++r) b->n[r] -= t.angular_damping * b->push[3 + r];
}

// Bias forces and mass matrix of the present pose.
template <class L>
void dynamics(TreeBatch<L>& t) {
  using V = typename L::V;
  const Tree& tree = *t.tree;
  const int offset = tree.coord(0);
  V reaction[6] = {}, base_w[3] = {};
  if (tree.free_base)
    for (int k = 0; k < 3; ++k) base_w[k] = t.coord[3 + k].qd;
  for (int i = 0; i < tree.num_links; ++i) {
    const TreeLink& link = tree.links[static_cast<size_t>(i)];
    const LinkState<V>& me = t.keep[i];
    LinkWork<V>& b = t.work[i];
    CoordWork<V>& c = t.coord[offset + i];
    const V axis[3] = {me.R[2], me.R[5], me.R[8]};
    if (link.prismatic) {
      for (int r = 0; r < 3; ++r) c.a[r] = V{}, c.s[r] = axis[r];
    } else {
      for (int r = 0; r < 3; ++r) c.a[r] = axis[r];
      cross(me.P, axis, c.s);
    }
    if (link.massless) {
      for (int r = 0; r < 3; ++r) b.f[r] = b.n[r] = b.h[r] = V{};
      for (int k = 0; k < 6; ++k) b.J[k] = V{};
      b.mass = V{};
      if (t.any_push) push_massless(t, me, t.bones[i].com, &b);
      continue;
    }
    V arm[3];
    for (int r = 0; r < 3; ++r) arm[r] = b.c[r] - me.P[r];
    V turning[3];
    for (int r = 0; r < 3; ++r) turning[r] = tree.free_base ? me.w[r] - base_w[r] : me.w[r];
    balance<L>(t, me.v, me.w, arm, me.linear, me.angular, t.bones[i].mass, link.round, turning,
               tree.free_base ? reaction : nullptr, &b);
  }
  if (tree.free_base) {
    V v[3];
    for (int k = 0; k < 3; ++k) v[k] = t.coord[k].qd;
    balance<L>(t, v, base_w, t.base.c, t.base_keep.linear, t.base_keep.angular, t.base_mass, false,
               static_cast<const V*>(nullptr), static_cast<V*>(nullptr), &t.base);
    for (int r = 0; r < 3; ++r) {  // the base takes the reaction: momentum is kept
      t.base.f[r] -= reaction[r];
      t.base.n[r] -= reaction[3 + r];
    }
  }
  for (int i = tree.num_links - 1; i >= 0; --i) {
    const TreeLink& link = tree.links[static_cast<size_t>(i)];
    const int at = offset + i, depth = tree.depth[static_cast<size_t>(at)];
    const int row = tree.row[static_cast<size_t>(at)];
    const LinkWork<V>& b = t.work[i];
    CoordWork<V>& me = t.coord[at];
    const V *a = me.a, *s = me.s;
    me.bias = dot(a, b.n) + dot(s, b.f);
    V p[3], l[3], x[3];  // momentum of the composite body at unit rate
    cross(a, b.h, x);
    for (int r = 0; r < 3; ++r) p[r] = b.mass * s[r] + x[r];
    times(b.J, a, l);
    cross(b.h, s, x);
    for (int r = 0; r < 3; ++r) l[r] += x[r];
    for (int d = 0; d <= depth; ++d) {
      const CoordWork<V>& other = t.coord[tree.path[static_cast<size_t>(row + d)]];
      t.mass_matrix[row + d] = dot(other.a, l) + dot(other.s, p);
    }
    t.mass_matrix[row + depth] += t.bones[i].armature;
    if (link.parent < 0 && !tree.free_base) continue;
    LinkWork<V>& up = link.parent < 0 ? t.base : t.work[link.parent];
    up.mass += b.mass;
    for (int r = 0; r < 3; ++r) {
      up.f[r] += b.f[r];
      up.n[r] += b.n[r];
      up.h[r] += b.h[r];
    }
    for (int k = 0; k < 6; ++k) up.J[k] += b.J[k];
  }
  if (!tree.free_base) return;
  const LinkWork<V>& b = t.base;
  const auto entry = [&](int c, int d) -> V& { return t.mass_matrix[tree.row[static_cast<size_t>(c)] + d]; };
  for (int k = 0; k < 3; ++k) {
    t.coord[k].bias = b.f[k];
    t.coord[3 + k].bias = b.n[k];
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

// factor <- L^T D L of the mass matrix with `diagonal[c]` added; dv <- its solution for the right side in dv.
// The factor's rows hold L off the diagonal; inverse[c] = 1 / D.
template <class L>
void factorise(TreeBatch<L>& t) {
  using V = typename L::V;
  using S = typename L::Scalar;
  const Tree& tree = *t.tree;
  const int32_t *rows = tree.row.data(), *depths = tree.depth.data();
  const int16_t* path = tree.path.data();
  V* u = t.factor;
  for (int k = tree.num_coords - 1; k >= 0; --k) {
    const int depth = depths[k];
    V* row = u + rows[k];
    const V inverse = S(1) / row[depth], right = t.coord[k].dv;
    t.coord[k].inverse = inverse;
    for (int d = depth - 1; d >= 0; --d) {
      const int i = path[rows[k] + d];
      const V a = row[d] * inverse;
      V* other = u + rows[i];
      for (int e = 0; e <= d; ++e) other[e] -= a * row[e];
      t.coord[i].dv -= a * right;
      row[d] = a;
    }
  }
  for (int k = 0; k < tree.num_coords; ++k) {
    V x = t.coord[k].dv * t.coord[k].inverse;
    const V* row = u + rows[k];
    for (int d = 0; d < depths[k]; ++d) x -= row[d] * t.coord[path[rows[k] + d]].dv;
    t.coord[k].dv = x;
  }
}

}  // namespace
}  // namespace rdm
