// Mass, centre of mass and moments of rigid bodies, and their sums.
#pragma once
#include "physics/model/scene.hpp"

namespace rdm {

// moment[6] is xx yy zz xy xz yz about com, as in Inertia.
Mat3 moment_matrix(const Inertia& inertia);
void set_moment(Inertia* inertia, const Mat3& about_com);

// The same body seen from a frame A in which its frame B has the pose X_AB.
Inertia transformed(const Inertia& inertia, const Pose& X_AB);

// Two bodies in one frame, welded.
Inertia combined(const Inertia& a, const Inertia& b);

bool positive_definite(const Mat3& symmetric);
Vec3 principal_moments(const Mat3& symmetric);  // ascending

// Solid bodies of uniform density with the total mass, com at the origin.
Inertia sphere_inertia(double mass, double radius);
Inertia box_inertia(double mass, const Vec3& half);
Inertia capsule_inertia(double mass, double radius, double half_length);   // along z
Inertia cylinder_inertia(double mass, double radius, double half_length);  // along z
Inertia ellipsoid_inertia(double mass, const Vec3& half);
Inertia hull_inertia(double mass, const Hull& hull);  // com where it is in the hull's frame

// Shapes welded where they stand, solid and of one density, with the total mass; where two overlap, both
// count. Error(kRange) for a size or place out of bounds, Error(kArgument) for a plane; with the shape's
// name.
Inertia shapes_inertia(const ShapeDef* shapes, int32_t count, double mass);

}  // namespace rdm
