// Collision from the scene's fixed pair list, contact joints under a cap, and their forces.
#pragma once
#include <ode/ode.h>

#include "base/arena.hpp"
#include "physics/collision/shapes.hpp"
#include "physics/world.hpp"

namespace rdm {

class OdeContacts {
 public:
  OdeContacts() = default;
  OdeContacts(const OdeContacts&) = delete;
  OdeContacts& operator=(const OdeContacts&) = delete;

  void carve(const Scene& scene, Arena& arena);
  // A geom for every colliding shape. `body` and `com` (of that body, in the carrier's frame) are null
  // and 0 for shapes at rest, which stand at X_WC * X_LS.
  void make_geom(const Scene& scene, int32_t shape, dBodyID body, const Vec3& com, const Pose& X_WC);
  void make_group();
  // Ends what was made, as far as it was. Before its bodies go.
  void destroy();
  // Fills the group with as many contacts as may ever be, between the given bodies, so that ODE's memory
  // is all there before the first step; empty() follows after one solver step.
  void fill(dWorldID world, const Scene& scene, const dBodyID* bodies, int32_t count);
  void empty();

  struct Found {
    int32_t count;
    bool overflow;
  };
  // Finds contacts and makes their joints; contacts[] gets all but the force. touched[] is only set.
  Found collide(dWorldID world, const Scene& scene, Contact* contacts, uint8_t* touched);
  // Forces of the last solver step, on shape_a.
  void read_forces(int32_t count, Contact* contacts) const;
  double overlap(const Scene& scene, int32_t body);

 private:
  struct Shape {
    Geom geom;
    dBodyID body;
    const dReal *p, *r;    // position and rotation of the body, or of the geom at rest
    Vec3 offset;           // of the shape's centre, from p, in r's axes
    Vec3 axis;             // of a capsule along its body's z: world direction
    Vec3 center;           // world; of a plane: its normal
    int32_t articulation;  // -1: none
    double radius;         // of a plane: its constant (normal . x = radius on it)
    bool rest;
    bool slender;  // a capsule with `axis`
  };
  struct Box {
    Vec3 low, high;  // around the bounding spheres of an articulation's shapes, world
  };
  void update_centers();
  bool near(const ShapePair& pair) const;
  bool near(const Shape& shape, const Box& box) const;
  static bool beside(const Shape& shape, const Shape& capsule, const Vec3& d);
  // Contacts of one pair, appended; true when there is any.
  bool touch(dWorldID world, const Scene& scene, const ShapePair& pair, Contact* contacts, Found* found);
  void make_joint(dWorldID world, const Scene& scene, const dContactGeom& geom, double mu, dBodyID a,
                  dBodyID b, int32_t index);

  Shape* shapes_ = nullptr;
  dJointFeedback* feedback_ = nullptr;
  dJointGroupID group_ = nullptr;
  Box* boxes_ = nullptr;  // [num_articulations_]
  int32_t num_shapes_ = 0, num_articulations_ = 0;
};

}  // namespace rdm
