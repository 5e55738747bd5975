// What walkers on the floor are made of: capsules of one density on hinges with motors, in the scene of a
// task that the articulated engine moves.
//
// A motor is a torque, World::feedforward; damping is the drive's, its spring is 0. Contacts and joint limits
// are hard, but for walkers of MuJoCo (soften), whose springs, dampers and pyramids of friction are then
// theirs. What still differs from MuJoCo: joints are implicit, positions go by semi-implicit steps, not by
// RK4; nothing of a walker touches itself.
#pragma once
#include "tasks/planar/planar_scene.hpp"

namespace rdm {

inline constexpr int32_t kFloorMaterial = 0, kLimbMaterial = 1, kFootMaterial = 2;

struct MotorJoint {
  double lower, upper;             // rad
  double gear, damping, armature;  // N m, N m s/rad, kg m2
};

// The floor carries, gravity pulls, a control step is `substeps` of h s; mu of limbs and feet on the floor.
void make_walkable(PlanarScene& scene, double h, int32_t substeps, double limb_mu, double foot_mu);

// What a published MuJoCo model says of its contacts, beside friction.
struct MujocoContact {
  double impedance_min, impedance_max, width;  // solimp; width and margin in m
  double margin;                               // contacts act from this far on
};
// Contacts and limits as MuJoCo's, solref "0.02 1"; after the robot is in. Its shapes are wider by the margin.
void soften(const MujocoContact& contact, PlanarScene& scene);

// A link from a hinge at `at`, in its parent's frame; without a motor: joint is null, and free.
LinkDef hinged_link(const char* name, int32_t parent, const Vec3& at, const Vec3& axis,
                    const MotorJoint* joint);
// A slide of no mass along `axis`.
LinkDef slide_link(const char* name, int32_t parent, const Vec3& axis);

// A capsule from p to q, in the link's frame: its shape joins `robot` (link -1: the base), its mass the link.
void add_capsule(const char* name, const Vec3& p, const Vec3& q, double radius, double density,
                 int32_t material, Color color, int32_t link, ArticulationDef* robot);
void add_sphere(const char* name, double radius, double density, Color color, int32_t link,
                ArticulationDef* robot);

}  // namespace rdm
