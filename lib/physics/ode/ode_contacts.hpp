// Collision from the scene's fixed pair list, contact joints under a cap, and their forces.
#pragma once
#include <ode/ode.h>

#include "base/arena.hpp"
#include "physics/collision/broadphase.hpp"
#include "physics/collision/shapes.hpp"
#include "physics/world.hpp"

namespace rdm {

class OdeContacts {
 public:
  OdeContacts() = default;
  OdeContacts(const OdeContacts&) = delete;
  OdeContacts& operator=(const OdeContacts&) = delete;

  void carve(const Scene& scene, Arena& arena);
  void make(const Scene& scene);
  // A geom for every colliding shape. `body` and `com` (of that body, in the carrier's frame) are null
  // and 0 for shapes at rest.
  void make_geom(const Scene& scene, int32_t shape, dBodyID body, const Vec3& com);
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
    dBodyID body;  // null: at rest
    Vec3 offset;   // of the shape's centre from the body's, body axes
    Vec3 axis;     // of the capsule about it, body axes
  };
  // One call of collide.
  struct Search {
    OdeContacts* self;
    dWorldID world;
    const Scene& scene;
    Contact* contacts;
    uint8_t* touched;
    Found* found;
  };
  void update_bounds();
  void add_points(const Search& search, int32_t pair);
  void make_joint(dWorldID world, const Scene& scene, const dContactGeom& geom, double mu, double layer,
                  const ContactLaw* law, dBodyID a, dBodyID b, int32_t index);

  Shape* shapes_ = nullptr;
  dJointFeedback* feedback_ = nullptr;
  dJointGroupID group_ = nullptr;
  BroadPhase broad_;
  int32_t num_shapes_ = 0;
};

}  // namespace rdm
