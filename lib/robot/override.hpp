// Changing single numbers of a robot by name: what the options joint.<name>.<field>, link.<name>.mass and
// scale.<field> do.
#pragma once
#include "physics/model/scene.hpp"

namespace rdm {

enum class JointField : int32_t { kKp = 0, kKd, kEffort, kFriction, kArmature };
inline constexpr int kNumJointFields = 5;
extern const char* const kJointFields[kNumJointFields];  // "kp", "kd", ...

// Names may be given with or without the prefix of the articulation ("FFJ2" or "right_FFJ2"); `prefix` is
// that one. Error(kNotFound) with the nearest name, Error(kRange) for a value below 0 or not finite.
void override_joint(ArticulationDef* def, const char* prefix, const char* joint, JointField field,
                    double value);
// The moments keep their ratio to the mass.
void override_mass(ArticulationDef* def, const char* prefix, const char* link, double mass);

// Multiplies kp, kd, mass (with the moments) of everything in the articulation.
void scale_joints(ArticulationDef* def, JointField field, double factor);
void scale_mass(ArticulationDef* def, double factor);

// The material of all its shapes.
void set_material(ArticulationDef* def, int32_t material);

}  // namespace rdm
