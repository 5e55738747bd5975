// Finds the contact points of a scene's shapes at given poses, from the scene's fixed list of pairs.
//
// Holds one ODE geom per shape and no world's state: worlds of one worker share it. Bounds, which the
// caller gives, pass over most pairs; only where two shapes' bounds meet are their geoms put in place and
// asked.
#pragma once
#include "base/arena.hpp"
#include "physics/collision/shapes.hpp"
#include "physics/world.hpp"

namespace rdm {

// The capsule about a shape: its half axis in the shape's frame, and its radius, m. Along the longest way of
// long bodies and things at rest, along capsules; else a sphere, without an axis.
struct Capsule {
  Vec3 axis;
  double radius;
};
Capsule capsule_around(const SceneShape& shape);

// Where a shape is, roughly: inside its capsule. World, m.
struct Bound {
  float center[4];  // x y z, radius of the sphere that holds the shape
  float axis[4];    // x y z, radius of the capsule
};

class Collider {
 public:
  // Exact poses of shapes that move, asked for at most once per shape and search.
  class Poses {
   public:
    virtual ~Poses() = default;
    virtual void place(int32_t shape, Vec3* p_WS, Mat3* R_WS) = 0;
  };
  struct Found {
    int32_t count;
    bool overflow;
    bool failed;  // ODE refused a pose: points may be missing
  };

  Collider() = default;
  ~Collider();
  Collider(const Collider&) = delete;
  Collider& operator=(const Collider&) = delete;

  void carve(const Scene& scene, Arena& arena);
  void make(const Scene& scene);

  // [shapes]; those of shapes at rest are in place.
  Bound* bounds() { return bounds_; }

  // Contact points in the order of the pairs, without force; `pairs` [contacts_max] gets each point's pair;
  // touched[] is only set. Never throws.
  Found collide(const Scene& scene, Poses& poses, Contact* contacts, int32_t* pairs, uint8_t* touched);
  // Deepest overlap of a body's shapes with all that it may touch, m.
  double overlap(const Scene& scene, Poses& poses, int32_t body);

 private:
  struct Pair {
    int32_t a, b;
    float gap, reach;  // m2, squares of the sums of the bounds' capsule and sphere radii
    int32_t plane;     // b is one: only its own test counts
  };
  struct Box {
    float low[4], high[4];
  };
  void update_boxes(const Scene& scene);
  bool above(const Pair& pair) const;
  uint32_t near_four(const int32_t* list) const;
  bool near_one(int32_t pair) const;
  void mark_neighbours(const Scene& scene, int32_t articulation, const Box& box);
  static bool near(const Bound& bound, const Box& box);
  int touch(Poses& poses, int32_t pair, int most, dContactGeom* out);
  void search(const Scene& scene, Poses& poses, Contact* contacts, int32_t* pairs, uint8_t* touched,
              Found* found);
  void add_points(const Scene& scene, Poses& poses, int32_t pair, Contact* contacts, int32_t* pairs,
                  uint8_t* touched, Found* found);
  void put(Poses& poses, int32_t shape);

  Geom* geoms_ = nullptr;
  Bound* bounds_ = nullptr;
  Pair* pairs_ = nullptr;
  Box* boxes_ = nullptr;  // [articulations]
  uint32_t* placed_ = nullptr;
  uint8_t *moves_ = nullptr, *neighbours_ = nullptr;
  uint32_t search_ = 0;
  int32_t num_shapes_ = 0;
};

}  // namespace rdm
