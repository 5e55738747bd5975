// Which pairs with a robot's shape may touch, in several worlds at once: the worlds stand in lanes, since the
// pairs are the same in all of them. What BroadPhase (broadphase.hpp) asks of one world's bounds is asked here
// of vectors of bounds, with the same tests in the same order: box against a robot's box, box against box,
// capsule against capsule. The answer is a bit for each world and pair, from which BroadPhase::search goes on.
//
// Part of stepper.inl, and so compiled once per instruction set. F is Simd<float, n>; n worlds are a chunk.
#pragma once
#include <bit>

#include "base/arena.hpp"
#include "base/simd.hpp"
#include "physics/collision/broadphase.hpp"

namespace rdm {
namespace {

template <class F>
class RobotPairs {
 public:
  using V = typename F::V;
  using Mask = typename F::Mask;

  // For `worlds` worlds at most.
  void carve(const Scene& scene, Arena& arena, int32_t worlds);
  void make(const Scene& scene, const BroadPhase& broad);

  int32_t chunks() const { return chunks_; }
  // Before a search: where a shape is. Coordinate r of a centre and of an axis, of chunk c of the worlds.
  V* center(int32_t shape, int32_t c) { return at(shape, c).center; }
  V* axis(int32_t shape, int32_t c) { return at(shape, c).axis; }
  void set(int32_t shape, int32_t world, const Bound& bound);
  // One world's part of it; the radii stay as they are.
  void get(int32_t shape, int32_t world, Bound* bound) const;

  void search(const Scene& scene, const BroadPhase& broad, int32_t worlds);
  // [pairs / 64] of a world after the search: bit k is pair k.
  const uint64_t* near(int32_t world) const { return near_ + static_cast<size_t>(world) * words_; }

 private:
  // A chunk of one shape's bounds, as Bound has them, and half the sides of its box.
  struct Lanes {
    V center[3], axis[3], half[3], radius;
  };
  struct Box {
    V low[3], high[3];
  };
  Lanes& at(int32_t shape, int32_t c) { return shapes_[shape * chunks_ + c]; }
  const Lanes& at(int32_t shape, int32_t c) const { return shapes_[shape * chunks_ + c]; }
  void update_boxes(const Scene& scene, int32_t c);
  static Mask meets(const Lanes& a, const Lanes& b);
  static Mask meets(const Lanes& a, const Box& box);
  static Mask meets(const BroadPhase::Plane& plane, const Box& box);
  static Mask meets(const BroadPhase::Plane& plane, const Lanes& a);
  static Mask capsules_meet(const Lanes& a, const Lanes& b);
  void mark(uint32_t worlds, int32_t c, int32_t pair);

  Lanes* shapes_ = nullptr;     // [shapes][chunks]
  Box* boxes_ = nullptr;        // [articulations]
  uint32_t* beside_ = nullptr;  // [others][articulations] worlds in which the one's box meets the other's
  uint64_t* near_ = nullptr;    // [worlds][words]
  size_t words_ = 0;
  int32_t chunks_ = 0, worlds_ = 0, num_pairs_ = 0;
};

template <class F>
void RobotPairs<F>::carve(const Scene& scene, Arena& arena, int32_t worlds) {
  worlds_ = worlds;
  chunks_ = (worlds + F::kCount - 1) / F::kCount;
  words_ = (scene.pairs.size() + 63) / 64;
  const size_t others = scene.shapes.size() - static_cast<size_t>(scene.first_body_shape);
  shapes_ = arena.make<Lanes>(scene.shapes.size() * static_cast<size_t>(chunks_));
  boxes_ = arena.make<Box>(scene.def.articulations.size());
  beside_ = arena.make<uint32_t>(others * scene.def.articulations.size());
  near_ = arena.make<uint64_t>(words_ * static_cast<size_t>(worlds));
}

// What rests keeps the bounds that it has now, and all their radii.
template <class F>
void RobotPairs<F>::make(const Scene& scene, const BroadPhase& broad) {
  for (int32_t i = 0; i < static_cast<int32_t>(scene.shapes.size()); ++i)
    for (int32_t c = 0; c < chunks_; ++c) {
      const Bound& bound = broad.bound(i);
      Lanes& lanes = at(i, c);
      for (int r = 0; r < 3; ++r) {
        lanes.center[r] = F::all(bound.center[r]);
        lanes.axis[r] = F::all(bound.axis[r]);
        lanes.half[r] = F::all(broad.half_side(i, r));
      }
      lanes.radius = F::all(bound.axis[3]);
    }
}

template <class F>
void RobotPairs<F>::set(int32_t shape, int32_t world, const Bound& bound) {
  Lanes& lanes = at(shape, world / F::kCount);
  const int lane = world % F::kCount;
  for (int r = 0; r < 3; ++r) {
    F::set(&lanes.center[r], lane, bound.center[r]);
    F::set(&lanes.axis[r], lane, bound.axis[r]);
  }
  F::set(&lanes.radius, lane, bound.axis[3]);
}

template <class F>
void RobotPairs<F>::get(int32_t shape, int32_t world, Bound* bound) const {
  const Lanes& lanes = at(shape, world / F::kCount);
  const int lane = world % F::kCount;
  for (int r = 0; r < 3; ++r) {
    bound->center[r] = F::get(lanes.center[r], lane);
    bound->axis[r] = F::get(lanes.axis[r], lane);
  }
}

template <class F>
[[gnu::always_inline]] inline typename F::V magnitude(const typename F::V& v) {
  return F::select(v < -v, -v, v);
}

// Of all that moves, and around each robot.
template <class F>
void RobotPairs<F>::update_boxes(const Scene& scene, int32_t c) {
  const auto measure = [&](Lanes& s) {
    for (int r = 0; r < 3; ++r)
      s.half[r] =
          magnitude<F>(s.axis[r]) + s.radius + kBoundSlack + kBoundCenterSlack * magnitude<F>(s.center[r]);
  };
  for (size_t a = 0; a < scene.def.articulations.size(); ++a) {
    const int32_t first = scene.first_shape[a],
                  end = first + static_cast<int32_t>(scene.def.articulations[a].shapes.size());
    Box box;
    for (int r = 0; r < 3; ++r) {
      box.low[r] = F::all(kBoundFar);
      box.high[r] = F::all(-kBoundFar);
    }
    for (int32_t i = first; i < end; ++i) {
      Lanes& s = at(i, c);
      if (scene.moves(scene.shapes[static_cast<size_t>(i)])) measure(s);
      for (int r = 0; r < 3; ++r) {
        const V low = s.center[r] - s.half[r], high = s.center[r] + s.half[r];
        box.low[r] = F::select(low < box.low[r], low, box.low[r]);
        box.high[r] = F::select(high > box.high[r], high, box.high[r]);
      }
    }
    boxes_[a] = box;
  }
  for (int32_t i = 0; i < scene.num_body_shapes; ++i) measure(at(scene.first_body_shape + i, c));
}

template <class F>
typename F::Mask RobotPairs<F>::meets(const Lanes& a, const Lanes& b) {
  Mask meet = magnitude<F>(a.center[0] - b.center[0]) < a.half[0] + b.half[0];
  for (int r = 1; r < 3; ++r) meet &= magnitude<F>(a.center[r] - b.center[r]) < a.half[r] + b.half[r];
  return meet;
}

template <class F>
typename F::Mask RobotPairs<F>::meets(const Lanes& a, const Box& box) {
  Mask meet = (box.low[0] < a.center[0] + a.half[0]) & (box.high[0] > a.center[0] - a.half[0]);
  for (int r = 1; r < 3; ++r)
    meet &= (box.low[r] < a.center[r] + a.half[r]) & (box.high[r] > a.center[r] - a.half[r]);
  return meet;
}

// The corner farthest below it.
template <class F>
typename F::Mask RobotPairs<F>::meets(const BroadPhase::Plane& plane, const Box& box) {
  V above = F::all(-static_cast<float>(plane.d));
  for (int r = 0; r < 3; ++r)
    above += static_cast<float>(plane.n[r]) * (plane.n[r] > 0 ? box.low[r] : box.high[r]);
  return above < F::all(kBoundSlack);
}

template <class F>
typename F::Mask RobotPairs<F>::meets(const BroadPhase::Plane& plane, const Lanes& a) {
  V above = F::all(-static_cast<float>(plane.d)), reach{};
  for (int r = 0; r < 3; ++r) {
    const float n = static_cast<float>(plane.n[r]);
    above += n * a.center[r];
    reach += (n < 0 ? -n : n) * a.half[r];
  }
  return above < reach;
}

// The distance of two segments p + s u and q + t v, |s|, |t| <= 1, as in broadphase.cpp.
template <class F>
typename F::Mask RobotPairs<F>::capsules_meet(const Lanes& a, const Lanes& b) {
  const auto dot = [](const V* x, const V* y) { return x[0] * y[0] + x[1] * y[1] + x[2] * y[2]; };
  const auto clamp_unit = [](const V& x) {
    const V low = F::select(x > F::all(-1), x, F::all(-1));
    return F::select(low < F::all(1), low, F::all(1));
  };
  const V *u = a.axis, *v = b.axis;
  const V tiny = F::all(1e-10f);
  const V r[3] = {a.center[0] - b.center[0], a.center[1] - b.center[1], a.center[2] - b.center[2]};
  const V uu = dot(u, u) + tiny, vv = dot(v, v) + tiny, uv = dot(u, v), ur = dot(u, r), vr = dot(v, r);
  const V d = uu * vv - uv * uv;
  const V s = clamp_unit(F::select(d > kBoundFlatness * uu * vv, (uv * vr - ur * vv) / d, -ur / uu));
  const V t = (uv * s + vr) / vv, inside = clamp_unit(t);
  const V s2 = F::select(t == inside, s, clamp_unit((uv * inside - ur) / uu));
  V w[3];
  for (int k = 0; k < 3; ++k) w[k] = r[k] + u[k] * s2 - v[k] * inside;
  const V reach = a.radius + b.radius + kBoundSlack;
  return dot(w, w) < reach * reach;
}

template <class F>
void RobotPairs<F>::mark(uint32_t worlds, int32_t c, int32_t pair) {
  const uint64_t bit = uint64_t{1} << (pair % 64);
  uint64_t* const words = near_ + pair / 64 + static_cast<size_t>(c * F::kCount) * words_;
  for (; worlds != 0; worlds &= worlds - 1)
    words[static_cast<size_t>(std::countr_zero(worlds)) * words_] |= bit;
}

template <class F>
void RobotPairs<F>::search(const Scene& scene, const BroadPhase& broad, int32_t worlds) {
  const auto robots = static_cast<int32_t>(scene.def.articulations.size());
  const auto num_others = static_cast<int32_t>(scene.shapes.size()) - scene.first_body_shape;
  std::fill_n(near_, words_ * static_cast<size_t>(worlds), uint64_t{0});
  for (int32_t c = 0; c * F::kCount < worlds; ++c) {
    const int32_t count = std::min(F::kCount, worlds - c * F::kCount);
    const uint32_t all = (1u << count) - 1;
    update_boxes(scene, c);
    for (int32_t i = 0; i < num_others; ++i) {
      const BroadPhase::Plane* plane = broad.plane_of(scene.first_body_shape + i);
      for (int32_t a = 0; a < robots; ++a)
        beside_[i * robots + a] = all & F::bits(plane ? meets(*plane, boxes_[a])
                                                      : meets(at(scene.first_body_shape + i, c), boxes_[a]));
    }
    const auto try_pair = [&](int32_t k, uint32_t among) {
      const Lanes &a = at(broad.pair(k).a, c), &b = at(broad.pair(k).b, c);
      among &= F::bits(meets(a, b));
      if (among != 0) among &= F::bits(capsules_meet(a, b));
      mark(among, c, k);
    };
    for (const BroadPhase::Row& row : broad.rows()) {
      const int32_t end = row.first + row.count;
      if (row.kind == BroadPhase::Row::kOthers) {
        const int32_t robot = scene.shapes[static_cast<size_t>(row.shape)].articulation;
        for (int32_t k = row.first; k < end; ++k) {
          const int32_t other = broad.pair(k).b - scene.first_body_shape;
          const uint32_t among = beside_[other * robots + robot];
          if (among == 0) continue;
          if (const BroadPhase::Plane* plane = broad.plane_of(broad.pair(k).b))
            mark(among & F::bits(meets(*plane, at(row.shape, c))), c, k);
          else
            try_pair(k, among);
        }
      } else if (row.kind == BroadPhase::Row::kRun) {
        const uint32_t among = all & F::bits(meets(at(row.shape, c), boxes_[row.articulation]));
        for (int32_t k = row.first; among != 0 && k < end; ++k) try_pair(k, among);
      } else if (row.kind == BroadPhase::Row::kLink) {
        for (int32_t k = row.first; k < end; ++k) try_pair(k, all);
      }
    }
  }
}

}  // namespace
}  // namespace rdm
