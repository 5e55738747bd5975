// Finds the contact points of a scene's shapes at given poses, from the scene's fixed list of pairs.
//
// Two stages. The broad phase passes over the pairs whose bounds, which the caller gives, do not meet. For
// the others the exact poses are asked for, once per shape and search, and the pair's geoms give the points.
// Holds one ODE geom per shape and no world's state: worlds of one worker share it.
#pragma once
#include "base/arena.hpp"
#include "physics/collision/broadphase.hpp"
#include "physics/collision/seams.hpp"
#include "physics/collision/shapes.hpp"
#include "physics/world.hpp"

namespace rdm {

class Collider {
 public:
  // Exact poses of shapes that move, asked for at most once per shape and search.
  class Poses {
   public:
    virtual ~Poses() = default;
    virtual void place(int32_t shape, Vec3* p_WS, Mat3* R_WS) = 0;
    // Where the substep is about to take a shape's place, m; asked for by searches that look ahead.
    virtual Vec3 way(int32_t) { return {}; }
    // Of a robot's shape, asked for by searches that were told of robots' pairs.
    virtual void bound(int32_t, Bound*) {}
    const SizedShape* sized = nullptr;  // [num_body_shapes] of the world; null: the scene's sizes
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

  // [shapes]; those of shapes at rest are in place. Of an adjustable scene the caller sets the radii of
  // bodies' shapes too.
  Bound* bounds() { return broad_.bounds(); }
  // The next search finds contacts to come too (sweep.hpp), with depth < 0: not yet touched[]. The caller sets
  // the ways of all shapes that move before; see BroadPhase.
  float* ways() { return broad_.ways(); }
  void look_ahead(float link_way) { broad_.look_ahead(link_way); }

  // Contact points in the order of the pairs, without force; `pairs` [contacts_max] gets each point's pair;
  // touched[] is only set. Of runs without an articulation those of `listed` alone, null: all. `near_robots`
  // as in BroadPhase::search: bounds of robots need not be set then, and are afterwards where shape a of a
  // contact is theirs. Never throws.
  Found collide(const Scene& scene, Poses& poses, const PairList* listed, const uint64_t* near_robots,
                Contact* contacts, int32_t* pairs, uint8_t* touched);
  // Of the listed pairs, which no robot has a part in, and no others.
  Found collide_listed(const Scene& scene, Poses& poses, const PairList& listed, Contact* contacts,
                       int32_t* pairs, uint8_t* touched);
  // Deepest overlap of a body's shapes with all that it may touch, m.
  double overlap(const Scene& scene, Poses& poses, int32_t body);
  const BroadPhase& broad() const { return broad_; }

 private:
  // One call of collide.
  struct Search {
    Collider* self;
    const Scene& scene;
    Poses& poses;
    Contact* contacts;
    int32_t* pairs;
    uint8_t* touched;
    Found* found;
    bool fetches;  // bounds of robots' shapes
  };
  template <class Walk>
  Found search(const Search& search, Walk walk);
  bool clears_box(Poses& poses, int32_t shape, int32_t box);
  int touch(Poses& poses, const ShapePair& pair, int most, dContactGeom* out);
  void add_points(const Search& search, int32_t pair);
  bool add_coming(const Search& search, int32_t pair, int more_than);  // false: no more, none added
  void add(const Search& search, int32_t pair, const Contact& contact);
  void put(Poses& poses, int32_t shape);
  void fetch(Poses& poses, int32_t shape);

  Geom* geoms_ = nullptr;
  BroadPhase broad_;
  Seams seams_;
  uint32_t* placed_ = nullptr;   // [shapes] the last search that put the geom in place
  uint32_t* fetched_ = nullptr;  // [shapes of robots] and that asked for its bound
  uint8_t* moves_ = nullptr;
  uint32_t search_ = 0;
  int32_t num_shapes_ = 0, first_body_shape_ = 0;
};

}  // namespace rdm
