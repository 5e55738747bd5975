// Contacts of piles: those of free bodies with each other and with static shapes, eight pairs of shapes at a
// time. Part of stepper_v*.cpp.
//
// Equations and updates are contact_solver.inl's. A lane has one pair of shapes, whose points are solved one
// after the other; the pairs of a group share no free body, so that their order does not matter. Groups are
// filled by first fit in the order of the scene's pairs (a greedy colouring of the graph of bodies, as in
// Box2D 3 and Box3D), and solved in the order in which they were begun. Eight lanes on every machine: the
// numbers are those of a scalar loop over groups, lanes and points.
//
// A point's row along an axis f of its frame (normal and tangents), with arms from the centres of mass:
//   a: ( sqrt(1/m_a) f,  C_a^-1 R_a^T (arm_a x f))      b: (-sqrt(1/m_b) f, -C_b^-1 R_b^T (arm_b x f))
// The linear halves need no storage, as they are the axes times sqrt(1/m): while the points of a pair are solved,
// its slip
//   s = sqrt(1/m_a) sum_a - sqrt(1/m_b) sum_b  of the linear halves
// replaces both, an impulse d f changes it by (1/m_a + 1/m_b) d f, and the total is added to the sums at the end.
//
// Each point has to wait for the one before it, so the time is that of the longest chain of operations, not of
// their number. An update is therefore written as  n <- max(0, (c n + k b_n) - k v_n)  with k = inv_n and
// c = 1 - k softness, and the tangents' as their value for the old n, minus the change of n times a constant. The step along
// the conjugate direction that follows a sweep (contact_solver.inl) is taken at the beginning of the next.
#pragma once
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "base/arena.hpp"
#include "base/simd.hpp"
#include "physics/articulated/tree.hpp"

namespace rdm {
namespace {

// Fewer points than this of free bodies are solved one by one.
constexpr int32_t kWideFrom = 24;
constexpr int kWide = 8;
static_assert(kSegment == kWide, "a body's segment is a row of the lanes");

template <class S>
struct WideContacts {
  using L = Simd<S, kWide>;
  using V = typename L::V;
  using Mask = typename L::Mask;
  typedef S Row __attribute__((vector_size(sizeof(S) * kWide)));

  struct Point {
    V axis[3][3];                                // n, t, u
    V turn_a[3][3], turn_b[3][3];                // angular halves of the rows
    V coupling[2];                               // A_nt, A_nu
    V inv_n, inv_tangents[3], inv_t;             // as ContactSolver::Point
    V decay;                                     // c
    V follow[2];                                 // of the tangents, per change of n
    V b[3], impulse[3], delta[3], direction[3];  // b[0] times inv_n
  };
  struct Group {
    int32_t first[kWide], count[kWide];    // points of the lane's pair in the world's list
    int32_t body_a[kWide], body_b[kWide];  // -1: static, or no pair
    int32_t lanes, first_point, most;      // most: points of a lane
    V sqrt_mass_a, sqrt_mass_b, mu;        // sqrt(1/m)
    V linear;                              // 1/m_a + 1/m_b
    S *row_a[kWide], *row_b[kWide];        // of the sums
  };

  Point* points = nullptr;
  Group* groups = nullptr;
  uint64_t* taken = nullptr;  // [groups][words] the bodies of a group, a bit each
  int32_t* level = nullptr;   // [bodies]
  int32_t num_groups = 0, words = 0, count = 0;
  int32_t first_segment = 0, rest = 0;  // of the bodies; of what is at rest

  void carve(Arena& arena, int32_t max_points, int32_t bodies) {
    if (bodies < 2 || max_points < kWideFrom) return;
    const auto n = static_cast<size_t>(max_points);
    words = (bodies + 63) / 64;
    points = arena.make<Point>(n);
    groups = arena.make<Group>(n);
    taken = arena.make<uint64_t>(n * static_cast<size_t>(words));
    level = arena.make<int32_t>(static_cast<size_t>(bodies));
  }
  void begin() { num_groups = count = 0; }
  // The pair with points [first, first + n) of the world's list; b -1: at rest. a is a body.
  void add(int32_t first, int32_t n, int32_t a, int32_t b);
  // After the last pair: where each group's points are.
  void number_points();
  // The height of the pile: the largest number of bodies on a shortest path of contacts from a body down to what
  // is at rest. Bodies without such a path count to those that `held(visit)` calls visit(body) for (held by a
  // robot), or else to any other body.
  template <class Held>
  int32_t levels(const Held& held);

  // The rows of the sums that the lanes work on.
  void rows_of(const int32_t* bodies, Row* sum, S** out) const {
    for (int l = 0; l < kWide; ++l)
      out[l] = reinterpret_cast<S*>(sum + (bodies[l] < 0 ? rest : first_segment + bodies[l]));
  }
  void place_rows(Row* sum) {
    for (int32_t g = 0; g < num_groups; ++g) {
      rows_of(groups[g].body_a, sum, groups[g].row_a);
      rows_of(groups[g].body_b, sum, groups[g].row_b);
    }
  }
  // After the axes, turns, b and the start's impulses of a point are in.
  void prepare(const Group& g, Point* p, const V& softness) const;
  // No impulse in this lane.
  void clear(Point* p, int lane) const {
    for (V* v : {&p->inv_n, &p->inv_t, &p->inv_tangents[0], &p->inv_tangents[1], &p->inv_tangents[2],
                 &p->follow[0], &p->follow[1], &p->b[0]})
      L::set(v, lane, S(0));
  }
  void warm_start(Row* sum);  // which has the sums from now on
  // visit(body) for every body of a pair, perhaps more than once.
  template <class Visit>
  void each_body(const Visit& visit) const {
    each_pair([&](int32_t a, int32_t b) {
      visit(a);
      if (b >= 0) visit(b);
    });
  }
  // As ContactSolver::sweep.
  S sweep(const S* beta, S* impulse_square);
  S residual() const;

 private:
  static constexpr int32_t kNoLevel = 1 << 20;
  template <class Visit>
  void each_pair(const Visit& visit) const {
    for (int32_t g = 0; g < num_groups; ++g)
      for (int l = 0; l < groups[g].lanes; ++l) visit(groups[g].body_a[l], groups[g].body_b[l]);
  }
  void spread_levels();
  [[gnu::always_inline]] static V dot3(const V* a, const V* b) {
    return (a[0] * b[0] + a[1] * b[1]) + a[2] * b[2];
  }
  static S total(const V& v) { return ((v[0] + v[4]) + (v[2] + v[6])) + ((v[1] + v[5]) + (v[3] + v[7])); }
  [[gnu::always_inline]] static V larger(const V& a, const V& b) { return L::select(a > b, a, b); }
};

template <class S>
void WideContacts<S>::add(int32_t first, int32_t n, int32_t a, int32_t b) {
  int32_t g = 0;
  const auto has = [&](int32_t body) {
    return body >= 0 && (taken[g * words + body / 64] >> (body % 64) & 1) != 0;
  };
  while (g < num_groups && (groups[g].lanes == kWide || has(a) || has(b))) ++g;
  Group& group = groups[g];
  if (g == num_groups) {
    ++num_groups;
    group = Group{};
    for (int l = 0; l < kWide; ++l) group.body_a[l] = group.body_b[l] = -1;
    for (int32_t k = 0; k < words; ++k) taken[g * words + k] = 0;
  }
  const int lane = group.lanes++;
  group.first[lane] = first;
  group.count[lane] = n;
  group.body_a[lane] = a;
  group.body_b[lane] = b;
  group.most = n > group.most ? n : group.most;
  for (const int32_t body : {a, b})
    if (body >= 0) taken[g * words + body / 64] |= uint64_t{1} << (body % 64);
  count += n;
}

template <class S>
void WideContacts<S>::number_points() {
  int32_t next = 0;
  for (int32_t g = 0; g < num_groups; ++g) {
    groups[g].first_point = next;
    next += groups[g].most;
  }
}

// Until every body is at most one above the lowest that it touches.
template <class S>
void WideContacts<S>::spread_levels() {
  for (bool changed = true; changed;) {
    changed = false;
    each_pair([&](int32_t a, int32_t b) {
      if (b < 0) return;
      int32_t &x = level[a], &y = level[b];
      if (x > y + 1) x = y + 1, changed = true;
      if (y > x + 1) y = x + 1, changed = true;
    });
  }
}

template <class S>
template <class Held>
int32_t WideContacts<S>::levels(const Held& held) {
  const auto first = [&](int32_t body) {
    if (level[body] == kNoLevel) level[body] = 1;
  };
  each_pair([&](int32_t a, int32_t b) {
    level[a] = kNoLevel;
    if (b >= 0) level[b] = kNoLevel;
  });
  each_pair([&](int32_t a, int32_t b) {
    if (b < 0) first(a);
  });
  spread_levels();
  held(first);
  spread_levels();
  int32_t most = 0;
  each_pair([&](int32_t a, int32_t b) {
    if (level[a] == kNoLevel) {
      first(a);
      spread_levels();
    }
    most = std::max({most, level[a], b < 0 ? 0 : level[b]});
  });
  return most;
}

template <class S>
void WideContacts<S>::prepare(const Group& g, Point* p, const V& softness) const {
  const auto product = [&](int f, int k) {
    return g.linear * dot3(p->axis[f], p->axis[k]) + dot3(p->turn_a[f], p->turn_a[k]) +
           dot3(p->turn_b[f], p->turn_b[k]);
  };
  const V kNone{}, kImmovable = L::all(S(1e-6)), kOne = L::all(S(1));
  const V nn = product(0, 0), tt = product(1, 1), uu = product(2, 2), tu = product(1, 2);
  p->coupling[0] = product(0, 1);
  p->coupling[1] = product(0, 2);
  p->inv_n = L::select(nn > kImmovable, kOne / (nn + softness), kNone);
  const V most = larger(tt, uu), step = most + larger(tu, -tu), determinant = tt * uu - tu * tu;
  const Mask rough = g.mu > kNone,
             regular = rough & (most > kImmovable) & (determinant > S(1e-6) * most * most);
  const V d = kOne / determinant;
  p->inv_t = L::select(rough & (step > kImmovable), kOne / step, kNone);
  p->inv_tangents[0] = L::select(regular, uu * d, p->inv_t);
  p->inv_tangents[1] = L::select(regular, tt * d, p->inv_t);
  p->inv_tangents[2] = L::select(regular, -tu * d, kNone);
  p->decay = kOne - softness * p->inv_n;
  p->b[0] *= p->inv_n;
  p->follow[0] = p->inv_tangents[0] * p->coupling[0] + p->inv_tangents[2] * p->coupling[1];
  p->follow[1] = p->inv_tangents[2] * p->coupling[0] + p->inv_tangents[1] * p->coupling[1];
}

template <class S>
void WideContacts<S>::warm_start(Row* sum) {
  place_rows(sum);
  for (int32_t k = 0; k < num_groups; ++k) {
    const Group& g = groups[k];
    V a[kWide], b[kWide];
    L::gather(g.row_a, kWide, a);
    L::gather(g.row_b, kWide, b);
    for (int32_t i = 0; i < g.most; ++i) {
      const Point& p = points[g.first_point + i];
      for (int f = 0; f < 3; ++f)
        for (int r = 0; r < 3; ++r) {
          const V push = p.axis[f][r] * p.impulse[f];
          a[r] += g.sqrt_mass_a * push;
          b[r] -= g.sqrt_mass_b * push;
          a[3 + r] += p.turn_a[f][r] * p.impulse[f];
          b[3 + r] += p.turn_b[f][r] * p.impulse[f];
        }
    }
    L::scatter(a, kWide, kWide, g.row_a);
    L::scatter(b, kWide, kWide, g.row_b);
  }
}

// One pass over the groups.
template <class S>
S WideContacts<S>::sweep(const S* beta, S* impulse_square) {
  V delta_square{}, square{};
  const V none{};
  for (int32_t k = 0; k < num_groups; ++k) {
    const Group& g = groups[k];
    V a[kWide], b[kWide], slip[3], push[3] = {};  // push: impulse of all points
    L::gather(g.row_a, kWide, a);
    L::gather(g.row_b, kWide, b);
    for (int r = 0; r < 3; ++r) slip[r] = g.sqrt_mass_a * a[r] - g.sqrt_mass_b * b[r];
    for (int32_t i = 0; i < g.most; ++i) {
      Point& p = points[g.first_point + i];
      V last[3], v[3];
      for (int f = 0; f < 3; ++f) {
        last[f] = p.impulse[f];
        if (beta) {
          last[f] += *beta * p.direction[f];
          p.direction[f] = *beta * p.direction[f] + p.delta[f];
        } else {
          p.direction[f] = none;
        }
        v[f] = (dot3(p.axis[f], slip) + dot3(p.turn_a[f], a + 3)) + dot3(p.turn_b[f], b + 3);
      }
      const V e1 = p.b[1] - v[1], e2 = p.b[2] - v[2];
      const V n = larger(none, (p.decay * last[0] + p.b[0]) - p.inv_n * v[0]);
      const V d0 = n - last[0];
      V t1 = (last[1] + (p.inv_tangents[0] * e1 + p.inv_tangents[2] * e2)) - p.follow[0] * d0;
      V t2 = (last[2] + (p.inv_tangents[2] * e1 + p.inv_tangents[1] * e2)) - p.follow[1] * d0;
      const V bound = g.mu * n, bound_square = bound * bound;
      const Mask slides = t1 * t1 + t2 * t2 > bound_square;
      if (L::bits(slides) != 0) {
        const V x1 = last[1] + p.inv_t * (e1 - p.coupling[0] * d0),
                x2 = last[2] + p.inv_t * (e2 - p.coupling[1] * d0);
        const V length = x1 * x1 + x2 * x2;
        const V shrink = L::select(length > bound_square, bound / L::root(length), L::all(S(1)));
        t1 = L::select(slides, x1 * shrink, t1);
        t2 = L::select(slides, x2 * shrink, t2);
      }
      const V d1 = t1 - last[1], d2 = t2 - last[2];
      p.impulse[0] = n;
      p.impulse[1] = t1;
      p.impulse[2] = t2;
      p.delta[0] = d0;
      p.delta[1] = d1;
      p.delta[2] = d2;
      for (int r = 0; r < 3; ++r) {
        const V more = p.axis[0][r] * d0 + p.axis[1][r] * d1 + p.axis[2][r] * d2;
        push[r] += more;
        slip[r] += g.linear * more;
        a[3 + r] += p.turn_a[0][r] * d0 + p.turn_a[1][r] * d1 + p.turn_a[2][r] * d2;
        b[3 + r] += p.turn_b[0][r] * d0 + p.turn_b[1][r] * d1 + p.turn_b[2][r] * d2;
      }
      delta_square += d0 * d0 + d1 * d1 + d2 * d2;
      square += n * n + t1 * t1 + t2 * t2;
    }
    for (int r = 0; r < 3; ++r) {
      a[r] += g.sqrt_mass_a * push[r];
      b[r] -= g.sqrt_mass_b * push[r];
    }
    L::scatter(a, kWide, kWide, g.row_a);
    L::scatter(b, kWide, kWide, g.row_b);
  }
  *impulse_square = total(square);
  return total(delta_square);
}

template <class S>
S WideContacts<S>::residual() const {
  V most{};
  const V none{}, one = L::all(S(1));
  for (int32_t k = 0; k < num_groups; ++k)
    for (int32_t i = 0; i < groups[k].most; ++i) {
      const Point& p = points[groups[k].first_point + i];
      const Mask held = p.inv_n > none;
      const V speed = larger(p.delta[0], -p.delta[0]) / L::select(held, p.inv_n, one);
      most = larger(most, L::select(held, speed, none));
    }
  S all = 0;
  for (int l = 0; l < kWide; ++l) all = std::max(all, L::get(most, l));
  return all;
}

}  // namespace
}  // namespace rdm
