// Which pairs of a scene may touch at the present poses: most are passed over by bounds alone.
//
// Every shape is bounded by a capsule (a segment c +- u with a radius r), and so by a box along the world's
// axes, c +- (|u| + r); of boxes at rest that box is exact. A search:
//   1. the boxes of shapes that move, and one around each articulation;
//   2. each shape that is not a link's (its box, or a plane) against the box of each articulation, then
//      against the boxes of that one's shapes, four at a time: this settles all pairs of a link with such a
//      shape;
//   3. per run of pairs of one shape with one articulation: the shape's box against that one's, and that
//      articulation's shapes against the box of its own;
//   4. of all other pairs the boxes, one by one, or of many bodies in order (crowd.hpp); planes against the
//      lowest corner of the shape's box;
//   5. of what is left, four at a time, the distance of the segments (Ericson, Real-Time Collision Detection,
//      2005, section 5.1.9).
// Looking ahead (speculative contacts), the boxes of bodies' shapes grow by how far they and the fastest link move
// in a substep, and pairs whose capsules may meet within it are visited too, unless both are so slow that their
// overlap is found in time (thin()).
// All in floats, with a slack for their rounding: a pair that touches is never passed over, so what is found
// does not depend on the bounds. A bound with a number missing (NaN) touches nothing.
#pragma once
#include <span>

#include "base/arena.hpp"
#include "physics/collision/crowd.hpp"
#include "physics/model/scene.hpp"

namespace rdm {

// The capsule about a shape: its half axis in the shape's frame, and its radius, m. Along the longest way of
// long bodies and things at rest, along capsules; else a sphere, without an axis.
struct Capsule {
  Vec3 axis;
  double radius;
};
Capsule capsule_around(const SceneShape& shape);

// For the rounding of bounds, m, and the same per metre from the origin; of two axes that count as parallel;
// m, out of reach.
inline constexpr float kBoundSlack = 1e-5f, kBoundCenterSlack = 1e-6f, kBoundFlatness = 1e-6f,
                       kBoundFar = 1e30f;

// Which pairs of runs without an articulation to search: indices of Scene::pairs, ascending, all those among
// them that a link or a base is in. A search skips the others.
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
  struct Pair {
    int32_t a, b;
    int32_t plane;  // index of planes_ when b is one: only its own test counts; else -1
    float thin;     // m, see thin()
  };
  struct Plane {
    Vec3 n;
    double d;  // n . x = d on it, m
  };
  // Pairs in a row.
  struct Row {
    enum Kind : int32_t {
      kPlane,   // one, with a plane
      kLink,    // a shape of an articulation with shapes of it, or of another without a run
      kAny,     // no link among them
      kOthers,  // a shape of an articulation with others that stand in a row too, all in one word of near_
      kRun      // a run of a shape with an articulation
    } kind;
    int32_t first, count;
    int32_t shape;                // of kOthers and kRun
    int32_t word, shift;          // kOthers: the first pair's place in near_
    int32_t articulation, owner;  // kRun; the shape's articulation, -1: none
    // Of the first of several rows in a row with a robot's shape: past the last of them, past its last pair, and
    // how many of their pairs are of runs without an articulation. Else as for one.
    int32_t next, end, listed;

    bool of_robot() const { return kind == kLink || kind == kOthers || kind == kRun; }
  };

  // `ahead`: they do not touch yet, but may before the substep ends.
  using Visit = void (*)(void* context, int32_t pair, bool ahead);

  void carve(const Scene& scene, Arena& arena);
  // Bounds of shapes at rest, and radii of all.
  void make(const Scene& scene);

  // [shapes]. Centres and axes of shapes that move are the caller's to set before each search; of an
  // adjustable scene the radii of bodies' shapes too.
  Bound* bounds() { return bounds_; }

  // [shapes] how far each one's place moves in a substep, m; of those at rest zero. The caller's to set before
  // each search that looks ahead.
  float* ways() { return ways_; }
  // Of the next search: pairs with a body that may touch within the substep are visited too. `link_way`: m, of
  // the fastest link. Nothing is done where all are slow.
  void look_ahead(float link_way);
  bool looks_ahead() const { return ahead_; }
  // m, how far a may move against b in a substep and still be found by their overlap alone, because it cannot
  // pass through; only faster pairs are looked at ahead. Out of reach for pairs without a body.
  float thin(int32_t pair) const { return pairs_[pair].thin; }
  // m, half of the least width of a shape; of a plane out of reach.
  float half_width(int32_t shape) const { return half_widths_[shape]; }
  // What robot_pairs.inl works on.
  std::span<const Row> rows() const { return {rows_, static_cast<size_t>(num_rows_)}; }
  const Pair& pair(int32_t k) const { return pairs_[k]; }
  const Bound& bound(int32_t shape) const { return bounds_[shape]; }
  float half_side(int32_t shape, int axis) const { return extents_[shape].half[axis]; }
  // Null: it is no plane that rests.
  const Plane* plane_of(int32_t shape) const {
    const int32_t plane = shape < first_other_ ? -1 : other_plane_[shape - first_other_];
    return plane < 0 ? nullptr : planes_ + plane;
  }

  // True: the capsule about a shape does not reach a box with these half sides at p_WB, whose axes are R_WB's.
  bool clears_box(int32_t shape, const Vec3& p_WB, const Mat3& R_WB, const Vec3& half) const;
  // True: the bounds of the two do not meet while a moves by `way` against b.
  bool passes(int32_t pair, const Vec3& way) const;

  // Calls visit for each pair that may touch, in the order of Scene::pairs; null: of all pairs. `near_robots`,
  // unless null: [pairs / 64] bit k of pairs with a link or a base is known already (robot_pairs.inl), so that
  // bounds of robots are not looked at.
  void search(const Scene& scene, const PairList* listed, const uint64_t* near_robots, Visit visit,
              void* context);
  // Of the listed ones alone.
  void search_listed(const PairList& listed, Visit visit, void* context);
  // For a single pair.
  bool near(int32_t pair) const;

 private:
  struct Box {
    float low[4], high[4];
  };
  // Up to four shapes in a row of one articulation, their boxes by coordinate.
  struct Block {
    int32_t first, count;
    float center[3][4], half[3][4];
  };
  template <class Use>
  void each_row(const Scene& scene, const Use& use) const;
  void update_extents(int32_t first);  // of the shapes that move, from this one on
  void update_boxes();
  void mark_neighbours(const Scene& scene, int32_t articulation, const Box& box);
  void mark_others();
  void visit_near(int32_t* list, int32_t count, Visit visit, void* context) const;
  bool on_plane(const Pair& pair) const;
  bool boxes_meet(int32_t a, int32_t b) const;
  // Bit k: the capsules of pair list[k] meet, or one of them is a plane; four of them.
  // `ahead`, if given, gets those that meet within their ways.
  uint32_t capsules_meet(const int32_t* list, uint32_t* ahead) const;
  bool near(int32_t shape, const Box& box) const;
  // Bit k: shape k of the block.
  uint32_t near(int32_t shape, const Block& block) const;
  static uint32_t near(const Plane& plane, const Block& block);
  static bool near(const Plane& plane, const Box& box);

  Bound* bounds_ = nullptr;
  Extent* extents_ = nullptr;  // [shapes] half sides of the boxes, with the slack
  Pair* pairs_ = nullptr;
  float *ways_ = nullptr, *half_widths_ = nullptr;  // [shapes]
  Plane* planes_ = nullptr;
  Box* boxes_ = nullptr;            // [articulations]
  Block* blocks_ = nullptr;         // of all articulations, in their order
  int32_t* block_end_ = nullptr;    // [articulations] the first that is none of its blocks
  int32_t* other_plane_ = nullptr;  // [others] index of planes_; -1
  uint8_t* neighbours_ = nullptr;   // [shapes] near the other articulation of a run
  uint64_t* near_ = nullptr;        // [shapes of articulations][words_] bit k: other k is near
  Row* rows_ = nullptr;             // in the order of their pairs
  int32_t num_articulations_ = 0, num_blocks_ = 0, num_rows_ = 0, words_ = 0;
  int32_t first_other_ = 0, num_others_ = 0;  // others: shapes of no articulation
  int32_t num_moving_ = 0;                    // shapes before the first that never moves
  int32_t num_listed_ = 0;                    // pairs of runs without an articulation
  bool ahead_ = false;
  Crowd crowd_;
  float link_way_ = 0, least_thin_ = 0;  // m, of all pairs
};

}  // namespace rdm
