// The contact solver of one world: block projected Gauss-Seidel over contact points, on impulses, in
// coordinates where the inverse mass matrix is the identity. Part of stepper_v*.cpp.
//
// Equations. Unknown are the impulses lambda = (normal n, tangents t, u) of each point, N s. With the
// velocities v_free of the substep without contacts, the contact Jacobians J and the mass matrix M (drives
// and joint limits in it: joint_limits.inl), v1 = v_free + M^-1 J^T lambda, and per point
//   normal    0 <= n   complementary to   J_n v1 + softness n >= b,  b = erp (depth - layer) / h, bounded
//   friction  |(t, u)| <= mu n, and J_t v1 = J_u v1 = 0 unless on the cone's edge, there against the slip
// b is the push-out speed of Baumgarte's stabilisation, softness = cfm / h (Catto, Soft Constraints, GDC
// 2011). Under a steady force F a contact so gives way by F cfm h / erp beyond the layer; a point that
// carries more than kMostYield / cfm (stepper.inl) is made stiffer and holds what it must. b is negative above the
// layer: what rests lies equally deep, wherever it started. A
// cone and not a pyramid: sliding is opposed along the slip, and the angle at which a body starts to slide
// does not depend on its heading.
//
// Half solve. M = L^T D L (tree_dynamics.inl), so M^-1 = Z^T Z with Z = D^-1/2 L^-T. A contact row is stored
// as z = Z J^T (MuJoCo's mj_solveM2), for a free body as sqrt(1/m) J_v and C^-1 R^T J_w (I = C C^T). Then
//   A = J M^-1 J^T = z . z          J (v1 - v_free) = z . sum,  sum = sum of z lambda over all points
// so that an update of a point reads and writes only `sum`. A row is not zero only on its two paths to the
// roots: the vector is cut into segments (tree.hpp), runs of a path that fill a register; a free body is one
// segment of six. The rates follow at the end: v1 = v_free + L^-1 D^-1/2 sum (stepper.inl).
//
// One update (Catto's sequential impulses, GDC 2006, with a block per point): normal first,
//   n <- max(0, n + (b_n - z_n . sum - softness n) / (A_nn + softness)),
// then both tangents with the new n: if the 2 x 2 system's solution, which stops the slip, is within the cone
// it stands; else one gradient step of length 1 / (max(A_tt, A_uu) + |A_tu|), a bound on the largest
// eigenvalue, and radial projection onto the cone.
//
// Sweeps visit first the pairs of free bodies of a pile, if there are many (wide_contacts.inl), then all
// other points in the order of the scene's pairs; they start from the last substep's impulses (warm
// start), and from kConjugateFrom points on are accelerated by the non-smooth non-linear conjugate gradient
// method of Silcowitz-Hansen, Niebe and Erleben (2010): a sweep's change d_k is the negative gradient, the
// next search direction p_k = d_k + beta p_(k-1) with beta = |d_k|^2 / |d_(k-1)|^2 (Fletcher and Reeves),
// restarted where beta > 1. At most `iterations` sweeps, for stacks up to kStackFactor times as many: by
// the levels of a pile, or as many as if all points were one stack of boxes, or by the points between free
// bodies; fewer once the squared change of
// a sweep is small against the squared impulses.
//
// Reported, not corrected (kStatusUnconverged): a normal whose velocity was wrong by more than kUnsolvedSpeed when
// the last sweep came to it, as in tall stacks that get heavier upwards (free bodies alone: direct_contacts.inl
// solves them); and a point that gives way although it is pushed out as fast as points are, where the option
// contact_max_speed is below kMostYield.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstdint>

#include "base/arena.hpp"
#include "physics/articulated/contact_laws.inl"
#include "physics/articulated/tree.hpp"
#include "physics/articulated/wide_contacts.inl"

namespace rdm {
namespace {

constexpr int kConjugateFrom = 6;
constexpr int32_t kStackFactor = 4;
// Square of the relative change at which the sweeps end early, and that of a stack: more than kStack points.
constexpr double kTolerance = 1e-9, kStackTolerance = 1e-8;
constexpr int32_t kStack = 64;
// Sweeps for two levels of a pile. Its last kPlainSweeps are not accelerated, so that they correct what a step
// along the conjugate direction overshoots.
constexpr int32_t kSweepsPerTwoLevels = 7;
constexpr int32_t kPlainSweeps = 3;
// Sweeps for each point between two free bodies. With half as many, the error that remains makes a stack of five
// boxes sway at 4 to 26 mm/s.
constexpr int32_t kSweepsOfStacked = 2;
// m/s, of a point along its normal. The ten hand tasks with random, held and trained actions stay below 0.7;
// a cube of 1 kg under one of a ton comes to 7.
constexpr double kUnsolvedSpeed = 1;

template <class S>
struct ContactSolver {
  using Scalar = S;
  typedef S Row __attribute__((vector_size(sizeof(S) * kSegment)));

  // A number each of the normal and the tangents; the fourth is 0.
  typedef S Axes __attribute__((vector_size(sizeof(S) * 4)));

  struct Point {
    Axes b;                    // wanted change of velocity, b - J v_free
    Axes impulse;              // N s
    Axes delta;                // change of the last sweep
    Axes direction;            // conjugate
    Axes coupling;             // of A = J M^-1 J^T: -, nt, nu
    Axes inv_same, inv_other;  // of the tangents' block: -, tt, uu; -, tu, tu
    S inv_n;                   // of nn with softness
    S inv_t;                   // a step that is short enough for both tangents
    S softness, mu;
    int32_t first, count;  // rows and segments of this point
    int32_t axes;          // 3, or 1 without friction
  };

  Point* points = nullptr;                                        // [max_points]
  Row* rows = nullptr;                                            // [max_points][2 * path_segments][3]
  int32_t* segments = nullptr;                                    // [max_points][2 * path_segments]
  int32_t* moved = nullptr;                                       // [num_segments] those of any point
  uint8_t* is_moved = nullptr;                                    // [num_segments]
  Row *sum = nullptr, *previous = nullptr, *direction = nullptr;  // [num_segments]
  int32_t count = 0, num_segments = 0, most_segments = 0;         // most_segments: of a point
  WideContacts<S> wide;                                           // points of piles, beside the others
  LawContacts<S> laws;                                            // those with a law of their own, likewise
  int32_t num_moved = 0;
  bool alone = false;   // of solve
  int32_t levels = 0;   // of the pile, if there is one (wide_contacts.inl)
  int32_t stacked = 0;  // points between two free bodies that are not of the pile

  // The last `bodies` segments are those of the free bodies.
  void carve(Arena& arena, int32_t max_points, int32_t segment_count, int32_t path_segments, int32_t bodies) {
    const auto n = static_cast<size_t>(max_points), k = static_cast<size_t>(2 * path_segments);
    most_segments = 2 * path_segments;
    num_segments = segment_count;
    points = arena.make<Point>(n);
    rows = arena.make<Row>(n * k * 3);
    segments = arena.make<int32_t>(n * k);
    moved = arena.make<int32_t>(static_cast<size_t>(segment_count) + 1);  // list_moved writes behind the last
    is_moved = arena.make<uint8_t>(static_cast<size_t>(segment_count));
    sum = arena.make<Row>(static_cast<size_t>(segment_count) + 1);  // the last for what is at rest: stays 0
    previous = arena.make<Row>(static_cast<size_t>(segment_count));
    direction = arena.make<Row>(static_cast<size_t>(segment_count));
    wide.carve(arena, max_points, bodies);
    wide.first_segment = segment_count - bodies;
    wide.rest = segment_count;
  }

  void begin() {
    count = stacked = 0;
    for (int32_t s = 0; s <= num_segments; ++s) sum[s] = Row{};
    wide.begin();
    laws.count = 0;
  }
  Point& add(S mu, S softness) {
    Point& p = points[count];
    p = Point{};
    p.mu = mu;
    p.softness = softness;
    p.first = count++ * most_segments;
    p.axes = mu > 0 ? 3 : 1;
    return p;
  }
  // The point's rows in a segment, axis by axis.
  Row* segment_rows(Point* p, int32_t segment) {
    int32_t k = 0;
    while (k < p->count && segments[p->first + k] != segment) ++k;
    Row* r = rows + 3 * (p->first + k);
    if (k == p->count) {
      segments[p->first + p->count++] = segment;
      r[0] = r[1] = r[2] = Row{};
    }
    return r;
  }
  // A and its inverses, after the rows of both sides are in.
  void prepare(Point* p);
  void warm_start(Point* p, const S* impulse);
  // `wide_alone`: the points outside of lanes are solved.
  void solve(int32_t iterations, bool wide_alone);
  // The largest error of a point's normal velocity when the last sweep came to it, m/s.
  S residual() const;

 private:
  static S reduce(const Row& r) {
    S t = 0;
    const auto halves = [&](int i) { return r[i] + r[i + 4]; };
    t = (halves(0) + halves(2)) + (halves(1) + halves(3));
    return t;
  }
  // Three sums at once, each summed in the order of reduce().
  static Axes reduce_three(const Row* r) {
    Axes h[3];
    for (int f = 0; f < 3; ++f)
      h[f] =
          __builtin_shufflevector(r[f], r[f], 0, 1, 2, 3) + __builtin_shufflevector(r[f], r[f], 4, 5, 6, 7);
    // (0 + 2, 1 + 3) of rows 0 and 1 side by side, then of row 2
    const Axes a =
        __builtin_shufflevector(h[0], h[1], 0, 1, 4, 5) + __builtin_shufflevector(h[0], h[1], 2, 3, 6, 7);
    const Axes b =
        __builtin_shufflevector(h[2], h[2], 0, 1, 0, 1) + __builtin_shufflevector(h[2], h[2], 2, 3, 2, 3);
    return __builtin_shufflevector(a, b, 0, 2, 4, 4) + __builtin_shufflevector(a, b, 1, 3, 5, 5);
  }
  static S square_of(const Axes& x) {
    const Axes y = x * x;
    return y[0] + y[1] + y[2];
  }
  void list_moved();
  // What an update comes to.
  struct Outcome {
    S delta_square, square;
  };
  // A point's update; kCount segments, 0: any number.
  template <int kCount>
  [[gnu::always_inline]] Outcome update(Point* p);
  template <int kCount>
  [[gnu::always_inline]] Outcome update_normal(Point* p);
  // First a step of `beta` along each point's conjugate direction; null: none.
  S sweep(const S* beta, S* impulse_square);
  S sweep_all(const S* beta, S* impulse_square) {
    if (alone) return wide.sweep(beta, impulse_square);
    if (wide.count + laws.count == 0) return sweep(beta, impulse_square);
    S rest = 0, delta_square = 0;
    *impulse_square = 0;
    if (wide.count > 0) delta_square = wide.sweep(beta, impulse_square);
    delta_square += sweep(beta, &rest);
    *impulse_square += rest;
    if (laws.count > 0) delta_square += laws.sweep(beta, impulse_square, sum);
    return delta_square;
  }
};

template <class S>
void ContactSolver<S>::prepare(Point* p) {
  const auto product = [&](int f, int g) {
    Row r{};
    for (int32_t k = 0; k < p->count; ++k) {
      const Row* z = rows + 3 * (p->first + k);
      r += z[f] * z[g];
    }
    return reduce(r);
  };
  // Along a direction in which neither side can move (an arm's first link on its base pressed onto the
  // ground) no impulse changes anything: none is given. 1/kg; the heaviest arm is far above.
  constexpr S kImmovable = S(1e-6);
  const auto inverse = [](S a) { return a > kImmovable ? 1 / a : S(0); };
  const S nn = product(0, 0);
  p->inv_n = nn > kImmovable ? 1 / (nn + p->softness) : S(0);
  if (p->axes == 1) return;
  const S tt = product(1, 1), uu = product(2, 2), tu = product(1, 2);
  p->coupling = Axes{0, product(0, 1), product(0, 2), 0};
  const S larger = tt > uu ? tt : uu, coupling = tu < 0 ? -tu : tu;
  p->inv_t = inverse(larger + coupling);
  const S determinant = tt * uu - tu * tu;
  if (larger > kImmovable && determinant > S(1e-6) * larger * larger) {
    const S d = 1 / determinant, other = -tu * d;
    p->inv_same = Axes{0, uu * d, tt * d, 0};
    p->inv_other = Axes{0, other, other, 0};
  } else {
    p->inv_same = Axes{0, p->inv_t, p->inv_t, 0};
  }
}

template <class S>
void ContactSolver<S>::warm_start(Point* p, const S* impulse) {
  for (int f = 0; f < p->axes; ++f) p->impulse[f] = impulse[f];
  for (int32_t k = 0; k < p->count; ++k) {
    const Row* z = rows + 3 * (p->first + k);
    Row& s = sum[segments[p->first + k]];
    for (int f = 0; f < p->axes; ++f) s += z[f] * p->impulse[f];
  }
}

template <class S>
template <int kCount>
inline typename ContactSolver<S>::Outcome ContactSolver<S>::update(Point* point) {
  Point& p = *point;
  const int32_t number = kCount > 0 ? kCount : p.count;
  const Row* z = rows + 3 * p.first;
  const int32_t* segment = segments + p.first;
  Row kept[std::max(kCount, 1)];  // the sums, where they fit into registers
  Row r[3] = {};
  for (int32_t k = 0; k < number; ++k) {
    const Row s = sum[segment[k]];
    if (kCount > 0) kept[k] = s;
    for (int f = 0; f < 3; ++f) r[f] += z[3 * k + f] * s;
  }
  const Axes v = reduce_three(r), last = p.impulse;
  S n = last[0] + (p.b[0] - v[0] - p.softness * last[0]) * p.inv_n;
  n = n < 0 ? S(0) : n;
  const Axes e = p.b - v - p.coupling * (n - last[0]);
  const auto with_n = [&](Axes x) {
    x[0] = n;
    x[3] = 0;
    return x;
  };
  // stick: both tangents at once; slip: a gradient step back onto the cone
  Axes t = last + (p.inv_same * e + p.inv_other * __builtin_shufflevector(e, e, 0, 2, 1, 3));
  const S bound = p.mu * n;
  const auto slip_square = [](const Axes& x) {
    const Axes y = x * x;
    return y[1] + y[2];
  };
  if (slip_square(t) > bound * bound) {
    t = last + p.inv_t * e;
    const S square = slip_square(t);
    if (square > bound * bound) t *= bound / std::sqrt(square);
  }
  t = with_n(t);
  const Axes d = t - last;
  for (int32_t k = 0; k < number; ++k) {
    Row& s = sum[segment[k]];
    s = (kCount > 0 ? kept[k] : s) + (z[3 * k] * d[0] + z[3 * k + 1] * d[1] + z[3 * k + 2] * d[2]);
  }
  p.impulse = t;
  p.delta = d;
  return {square_of(d), square_of(t)};
}

// Without friction.
template <class S>
template <int kCount>
inline typename ContactSolver<S>::Outcome ContactSolver<S>::update_normal(Point* point) {
  Point& p = *point;
  const int32_t number = kCount > 0 ? kCount : p.count;
  const Row* z = rows + 3 * p.first;
  const int32_t* segment = segments + p.first;
  Row kept[std::max(kCount, 1)];
  Row r{};
  for (int32_t k = 0; k < number; ++k) {
    const Row s = sum[segment[k]];
    if (kCount > 0) kept[k] = s;
    r += z[3 * k] * s;
  }
  const S last = p.impulse[0];
  S n = last + (p.b[0] - reduce(r) - p.softness * last) * p.inv_n;
  n = n < 0 ? S(0) : n;
  const S d = n - last;
  for (int32_t k = 0; d != 0 && k < number; ++k) {
    Row& s = sum[segment[k]];
    s = (kCount > 0 ? kept[k] : s) + z[3 * k] * d;
  }
  p.impulse[0] = n;
  p.delta[0] = d;
  return {d * d, n * n};
}

// One pass over all points, after the step along their directions. Returns the sum of the squared changes of
// the impulses; `impulse_square` of them.
template <class S>
S ContactSolver<S>::sweep(const S* beta, S* impulse_square) {
  S delta_square = 0, square = 0;
  const S step = beta ? *beta : S(0);
  for (Point *p = points, *end = points + count; p < end; ++p) {
    const bool rough = p->axes == 3;
    if (beta) {
      const Axes way = step * p->direction;
      p->impulse += way;
      p->direction = way + p->delta;
    }
    Outcome outcome;
    switch (rough ? p->count : -p->count) {
      case 1:
        outcome = update<1>(p);
        break;
      case 2:
        outcome = update<2>(p);
        break;
      case 3:
        outcome = update<3>(p);
        break;
      case 4:
        outcome = update<4>(p);
        break;
      case -1:
        outcome = update_normal<1>(p);
        break;
      case -2:
        outcome = update_normal<2>(p);
        break;
      case -3:
        outcome = update_normal<3>(p);
        break;
      case -4:
        outcome = update_normal<4>(p);
        break;
      default:
        outcome = rough ? update<0>(p) : update_normal<0>(p);
    }
    delta_square += outcome.delta_square;
    square += outcome.square;
  }
  *impulse_square = square;
  return delta_square;
}

// All other sums stay 0.
template <class S>
void ContactSolver<S>::list_moved() {
  num_moved = 0;
  std::fill_n(is_moved, num_segments, uint8_t{0});
  const auto add = [&](int32_t segment) {
    moved[num_moved] = segment;
    num_moved += is_moved[segment] == 0;
    is_moved[segment] = 1;
  };
  for (int32_t i = 0; i < count; ++i)
    for (int32_t k = 0; k < points[i].count; ++k) add(segments[points[i].first + k]);
  for (int32_t i = 0; i < laws.count; ++i)
    for (int32_t k = 0; k < laws.points[i].count; ++k) add(laws.segments[laws.points[i].first + k]);
  wide.each_body([&](int32_t body) { add(wide.first_segment + body); });
}

template <class S>
void ContactSolver<S>::solve(int32_t iterations, bool wide_alone) {
  alone = wide_alone;
  S impulse_square = 0;  // sum of squared impulses
  // weight is passed on from body to body, one per sweep, so stacks need more; a box stands on four points
  const int32_t all = count + wide.count + laws.count;
  const S tolerance = all > kStack ? S(kStackTolerance) : S(kTolerance);
  const bool pile = wide.count > 0;
  iterations =
      std::clamp(pile ? kSweepsPerTwoLevels * levels / 2 : std::max(3 * all / 4, kSweepsOfStacked * stacked),
                 iterations, kStackFactor * iterations);
  if (all < kConjugateFrom) {
    for (int32_t k = 0; k < iterations; ++k) {
      const S delta_square = sweep_all(nullptr, &impulse_square);
      if (delta_square <= tolerance * impulse_square) return;
    }
    return;
  }
  list_moved();
  const auto restart = [&] {
    for (int32_t m = 0; m < num_moved; ++m) {
      direction[moved[m]] = Row{};
      previous[moved[m]] = sum[moved[m]];
    }
    for (int32_t i = 0; i < count; ++i) points[i].direction = Axes{};
    for (int32_t i = 0; i < laws.count; ++i) {
      std::fill_n(laws.points[i].direction, laws.kAxes, S(0));
      std::fill_n(laws.points[i].edge_direction, laws.kEdges, S(0));
    }
  };
  restart();
  S last_square = 0, beta = 0;
  bool onward = false;  // along the direction
  for (int32_t k = 0; k < iterations; ++k) {
    const S delta_square = sweep_all(onward ? &beta : nullptr, &impulse_square);
    if (delta_square <= tolerance * impulse_square || k + 1 == iterations) return;
    beta = k ? delta_square / last_square : S(0);
    last_square = delta_square;
    onward = !(beta > 1) && (!pile || k + kPlainSweeps < iterations);
    if (!onward) {
      restart();
      continue;
    }
    for (int32_t m = 0; m < num_moved; ++m) {
      const int32_t s = moved[m];
      const Row d = sum[s] - previous[s];
      sum[s] += beta * direction[s];
      previous[s] = sum[s];
      direction[s] = beta * direction[s] + d;
    }
  }
}

// A sweep changes an impulse by inv_n times the error of the velocity, so the error is the change over inv_n.
template <class S>
S ContactSolver<S>::residual() const {
  S most = wide.count > 0 ? wide.residual() : S(0);
  for (int32_t i = 0; i < count; ++i) {
    const Point& p = points[i];
    const S d = std::abs(p.delta[0]);
    if (d > most * p.inv_n && p.inv_n > 0) most = d / p.inv_n;
  }
  if (laws.count > 0) most = std::max(most, laws.residual());
  return most;
}

}  // namespace
}  // namespace rdm
