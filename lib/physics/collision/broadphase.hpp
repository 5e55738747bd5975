// Which pairs of a scene may touch at the present poses: most are passed over by bounds alone.
//
// Every shape stands in a sphere and, more tightly, in a capsule (a segment c +- u with a radius). A search:
//   1. an axis-aligned box around each articulation's spheres, and around each part of it: a few shapes in a
//      row, a finger's as a rule;
//   2. per run of pairs of one shape with one articulation: the shape's sphere against that box,
//      |max(low - c, c - high, 0)|^2 < r^2, and that articulation's shapes against the box of its own;
//   3. of pairs of a link with what is no link: the other's sphere, or its plane, against the box of the
//      link's part;
//   4. of the pairs that are left, four at a time: spheres, |c_a - c_b|^2 < (r_a + r_b)^2, then, of those
//   that
//      meet, four at a time again, the distance of the segments (Ericson, Real-Time Collision Detection,
//      2005, section 5.1.9). Planes: n . c - d < r.
// All in floats, with a slack for their rounding: a pair that touches is never passed over, so what is found
// does not depend on the bounds. A bound with a number missing (NaN) touches nothing.
#pragma once
#include "base/arena.hpp"
#include "physics/model/scene.hpp"

namespace rdm {

// The capsule about a shape: its half axis in the shape's frame, and its radius, m. Along the longest way of
// long bodies and things at rest, along capsules; else a sphere, without an axis.
struct Capsule {
  Vec3 axis;
  double radius;
};
Capsule capsule_around(const SceneShape& shape);

// Which pairs of runs without an articulation to search: indices of Scene::pairs, ascending. A search skips
// the others.
struct PairList {
  const int32_t* pairs;
  int32_t count;
};

// Where a shape is, roughly: inside its capsule. World, m.
struct Bound {
  float center[4];  // x y z, radius of the sphere that holds the shape
  float axis[4];    // x y z, radius of the capsule
};

// Pose of a shape that does not move. Of one that does, its pose in the frame that carries it.
Pose rest_pose(const Scene& scene, const SceneShape& shape);

class BroadPhase {
 public:
  using Visit = void (*)(void* context, int32_t pair);

  void carve(const Scene& scene, Arena& arena);
  // Bounds of shapes at rest, and radii of all.
  void make(const Scene& scene);

  // [shapes]. Centres and axes of shapes that move are the caller's to set before each search; of an
  // adjustable scene the radii of bodies' shapes too.
  Bound* bounds() { return bounds_; }

  // Calls visit for each pair that may touch, in the order of Scene::pairs; null: of all pairs.
  void search(const Scene& scene, const PairList* listed, Visit visit, void* context);
  // Of the listed ones alone.
  void search_listed(const PairList& listed, Visit visit, void* context);
  // For a single pair.
  bool near(int32_t pair) const;

 private:
  struct Pair {
    int32_t a, b;
    int32_t plane;  // index of planes_ when b is one: only its own test counts; else -1
  };
  struct Plane {
    Vec3 n;
    double d;  // n . x = d on it, m
  };
  struct Box {
    float low[4], high[4];
  };
  // Four boxes, by coordinate.
  struct BoxLanes {
    float low[3][4], high[3][4];
  };
  // Shapes of one articulation that stand in a row.
  struct Part {
    int32_t articulation, first, end;
  };
  // Pairs in a row, of a run without an articulation. With a part: of one of its shapes with others that
  // stand in a row too, all in one word of near_.
  struct Row {
    int32_t first, count;
    int32_t part, first_other;  // -1: pairs of any kind
  };
  template <class Use>
  void each_row(const Scene& scene, const Use& use) const;
  uint64_t near_others(const Row& row) const {
    const uint64_t word = near_[row.part * words_ + row.first_other / 64] >> (row.first_other % 64);
    return row.count == 64 ? word : word & ((uint64_t{1} << row.count) - 1);
  }
  void update_boxes(const Scene& scene);
  void mark_neighbours(const Scene& scene, int32_t articulation, const Box& box);
  void mark_others();
  void visit_near(int32_t* list, int32_t count, Visit visit, void* context) const;
  bool on_plane(const Pair& pair) const;
  // Bit k: the spheres, or the capsules, of pair list[k] meet, or one of them is a plane; four of them.
  uint32_t spheres_meet(const int32_t* list) const;
  uint32_t capsules_meet(const int32_t* list) const;
  static bool near(const Bound& bound, const Box& box);
  // Bit k: box k of the four.
  static uint32_t near(const Bound& bound, const BoxLanes& boxes);
  static bool near(const Plane& plane, const Box& box);

  Bound* bounds_ = nullptr;
  Pair* pairs_ = nullptr;
  Plane* planes_ = nullptr;
  Box* boxes_ = nullptr;            // [articulations]
  Part* parts_ = nullptr;           // of all articulations, in their order
  Box* part_boxes_ = nullptr;       // [parts]
  BoxLanes* part_lanes_ = nullptr;  // [parts / 4, rounded up] the same, four side by side
  int32_t* other_plane_ = nullptr;  // [others] index of planes_; -1
  uint8_t* neighbours_ = nullptr;   // [shapes] near the other articulation of a run
  uint64_t* near_ = nullptr;        // [parts][words_] bit k: other k is near the part
  Row* rows_ = nullptr;             // in the order of their pairs
  int32_t num_parts_ = 0, num_rows_ = 0, words_ = 0;
  int32_t first_other_ = 0, num_others_ = 0;  // others: shapes of no articulation
};

}  // namespace rdm
