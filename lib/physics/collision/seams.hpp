// Seams: where static shapes lie flush, side by side, as tiles do.
//
// A thing that slides over them touches the edge of the next tile too, and the least overlap with that one may
// well be towards its side, which is inside the floor: a ghost that trips what slides. So of the points of a
// shape A with static shapes, each that A has with B2 is a ghost if there is another, with B1, such that
//   - A stands on a face of B1: the normal there is that face's, f,
//   - a face of B2 is level with it, to kFlush,
//   - the normal with B2 is not f,
//   - and the point is no deeper below the face than A is in B1 (to kFlush). Of one to come: or B1 reaches up
//     to where it is, so that nobody gets there.
// A ghost is left out; where it leans only a little and A has flat sides (a box that stands aslant on both),
// its normal becomes f.
#pragma once
#include "base/arena.hpp"
#include "physics/collision/shapes.hpp"
#include "physics/world.hpp"

namespace rdm {

class Seams {
 public:
  void carve(const Scene& scene, Arena& arena);
  // `geoms` [shapes], those at rest in their places.
  void make(const Scene& scene, const Geom* geoms);
  // Points and their pairs without ghosts, in their order; returns how many are left.
  int32_t smooth(const Geom* geoms, Contact* contacts, int32_t* pairs, int32_t count) const {
    return any_ ? without_ghosts(geoms, contacts, pairs, count) : count;
  }

 private:
  int32_t without_ghosts(const Geom* geoms, Contact* contacts, int32_t* pairs, int32_t count) const;
  bool is_ghost(const Geom* geoms, const Contact& contact, const Contact& other, Vec3* f) const;

  uint8_t* level_ = nullptr;  // [shapes] static, and level with another
  bool any_ = false;
};

}  // namespace rdm
