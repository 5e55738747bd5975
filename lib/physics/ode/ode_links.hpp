// The ODE bodies and joints of the articulations, and the way between them and joint coordinates.
//
// ODE only supplies rates: after each substep they are read about the axes the solver used, integrated
// here, and every body is put back exactly where forward kinematics says. As rates are kept and not momenta,
// the velocity products (Coriolis, centrifugal) are pushed from outside, and a free robot keeps the momentum that
// the solver left it.
#pragma once
#include <ode/ode.h>

#include "base/arena.hpp"
#include "physics/model/drive.hpp"
#include "physics/world.hpp"

namespace rdm {

// What ODE's objects are made from and written from: the arrays of a World.
struct LinkState {
  const Scene* scene;
  double *q, *qd, *target, *torque;
  const double* feedforward;  // null: none
  Motion *links, *bases;
  Mat3 *link_R, *base_R;
  Vec3* axes;
};

class OdeLinks {
 public:
  void carve(const Scene& scene, Arena& arena);
  // Makes bodies and joints at the poses in `state`, which must be those of q = 0.
  void make(dWorldID world, const LinkState& state);

  // Body of a link; a link without one of its own (massless, two axes at one origin) has its child's.
  dBodyID body(int32_t link) const { return links_[link].body; }
  dBodyID base(int32_t articulation) const { return bases_[articulation].body; }  // null: fixed
  // Centre of mass of that body, in the link's frame.
  const Vec3& com(int32_t link) const { return links_[link].com; }
  const Vec3& base_com(int32_t articulation) const { return bases_[articulation].com; }
  // Share of the link's moment that is its own and not armature: damping acts on that.
  double own_share(int32_t link) const { return links_[link].own_share; }

  // Pushes what carries the links' momenta on while the rates stay: the velocity products of the next substep.
  void push_velocity_products(const LinkState& state);
  // Motor rows for the next substep.
  void drive(const LinkState& state);
  // Reads rates, adds each row's torque x weight, integrates and clamps q. False: a rate is out of bounds.
  bool integrate(const LinkState& state, double weight);
  // Motion of a free base from its body.
  void read_base(int32_t articulation, const LinkState& state);
  // Into its body, and back again: the bits the body holds are the state.
  void write_base(int32_t articulation, const LinkState& state);
  // Poses and velocities of all links of one articulation into their bodies.
  void write(int32_t articulation, const LinkState& state);
  // A free robot's momentum as the solver left it, less what the products pushed; and that momentum given back by
  // the base's rates, once the links are written. What a joint's end stops would be lost otherwise.
  void note_momentum(int32_t articulation, const LinkState& state);
  void restore_momentum(int32_t articulation, const LinkState& state) const;
  double drift(const Scene& scene) const;

 private:
  enum class Row : int32_t { kHinge, kSlider, kUniversal1, kUniversal2 };
  struct Link {
    dBodyID body;
    bool owner;  // false: the body belongs to the child
    Vec3 com;
    double own_share;
  };
  struct Momentum {
    double mass;
    Vec3 center, linear, angular;  // angular about the centre of mass
    Mat3 moment;                   // likewise
  };
  struct Joint {
    dJointID id;
    const JointDef* def;
    const dReal *w_child, *w_parent;  // angular velocities; linear ones for a slider
    dBodyID child, parent;
    Row row;
    double sign;        // of the row's rate against the joint's
    double cfm, force;  // what ODE was told last
    MotorRow motor;     // the drive's law
    int32_t other;      // flat link a coupled joint follows, -1
  };
  struct Bias {
    Vec3 linear, angular;  // acceleration of a link's origin, while those of joints and bases are 0
    Vec3 force, moment;    // that it takes, about the base's origin; then of all that is behind the joint
  };
  bool merges(const Scene& scene, int32_t link) const;
  Momentum momentum(int32_t articulation, const LinkState& state) const;
  void make_bodies(dWorldID world, int32_t articulation, const LinkState& state);
  void make_joint(dWorldID world, int32_t link, const LinkState& state);
  void tell(Joint& joint, const MotorRow& row) const;
  double rate(const Joint& joint, const Vec3& axis) const;

  Link* links_ = nullptr;
  Link* bases_ = nullptr;
  Joint* joints_ = nullptr;
  Bias* bias_ = nullptr;          // [num_links]
  Wrench* pushed_ = nullptr;      // [articulations] of the base, by the products
  Momentum* momentum_ = nullptr;  // [articulations]
  int32_t num_links_ = 0;
};

}  // namespace rdm
