#include "physics/model/inertia.hpp"

#include "base/eigen.hpp"
#include "base/error.hpp"

// Moments of inertia (Featherstone, Rigid Body Dynamics Algorithms, 2008, section 2.13), with I about the
// centre of mass c:
//   another frame    I_A = R_AB I_B R_AB^T,  c_A = X_AB c_B
//   two bodies       c = (m1 c1 + m2 c2) / m,  I = sum_i I_i + m_i (|d_i|^2 1 - d_i d_i^T),  d_i = c_i - c
// Eigen's products and dots of three add in another order than ours, which would change the last bits of
// every world: they stay ours. Its elementwise sums, outer products and Cholesky's verdict agree.
namespace rdm {
namespace {

// Of a point mass at c.
Eigen::Matrix3d point_moment(double mass, const Vec3& c) {
  const Eigen::Vector3d d = to_eigen(c);
  return mass * (dot(c, c) * Eigen::Matrix3d::Identity() - d * d.transpose());
}

Inertia diagonal(double mass, double xx, double yy, double zz) {
  Inertia out;
  out.mass = mass;
  out.moment[0] = xx, out.moment[1] = yy, out.moment[2] = zz;
  return out;
}

struct Solid {
  double volume;
  Inertia unit;  // of 1 kg, in the shape's frame
};

Solid solid_of(const ShapeDef& s) {
  const Vec3& d = s.size;
  switch (s.kind) {
    case ShapeKind::kSphere:
      return {4 * kPi / 3 * d.x * d.x * d.x, sphere_inertia(1, d.x)};
    case ShapeKind::kCapsule:
      return {kPi * d.x * d.x * (2 * d.y + 4 * d.x / 3), capsule_inertia(1, d.x, d.y)};
    case ShapeKind::kBox:
      return {8 * d.x * d.y * d.z, box_inertia(1, d)};
    case ShapeKind::kCylinder:
      return {2 * kPi * d.x * d.x * d.y, cylinder_inertia(1, d.x, d.y)};
    case ShapeKind::kEllipsoid:
      return {4 * kPi / 3 * d.x * d.y * d.z, ellipsoid_inertia(1, d)};
    case ShapeKind::kHull: {
      const Hull hull = make_hull(s.points.data(), static_cast<int32_t>(s.points.size()), s.name.text);
      return {hull.volume, hull_inertia(1, hull)};
    }
    case ShapeKind::kPlane:
      break;
  }
  fail(Code::kArgument, "shape %s: kind %d cannot be part of a body", s.name.text, static_cast<int>(s.kind));
}

}  // namespace

Mat3 moment_matrix(const Inertia& inertia) {
  const double* m = inertia.moment;
  return {{m[0], m[3], m[4], m[3], m[1], m[5], m[4], m[5], m[2]}};
}

void set_moment(Inertia* inertia, const Mat3& a) {
  const double m[6] = {a(0, 0), a(1, 1), a(2, 2), a(0, 1), a(0, 2), a(1, 2)};
  for (int i = 0; i < 6; ++i) inertia->moment[i] = m[i];
}

Inertia transformed(const Inertia& inertia, const Pose& X_AB) {
  Inertia out;
  out.mass = inertia.mass;
  out.com = X_AB * inertia.com;
  const Mat3 r = to_matrix(X_AB.q);
  set_moment(&out, r * moment_matrix(inertia) * transpose(r));
  return out;
}

Inertia combined(const Inertia& a, const Inertia& b) {
  Inertia out;
  out.mass = a.mass + b.mass;
  if (out.mass <= 0) return out;
  out.com = (1 / out.mass) * (a.mass * a.com + b.mass * b.com);
  const Eigen::Matrix3d sum = to_eigen(moment_matrix(a)) + to_eigen(moment_matrix(b)) +
                              point_moment(a.mass, a.com - out.com) + point_moment(b.mass, b.com - out.com);
  set_moment(&out, to_mat3(sum));
  return out;
}

bool positive_definite(const Mat3& a) {
  return to_eigen(a).llt().info() == Eigen::Success;
}

Vec3 principal_moments(const Mat3& a) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(to_eigen(a), Eigen::EigenvaluesOnly);
  return to_vec3(solver.eigenvalues());
}

Inertia sphere_inertia(double mass, double radius) {
  const double i = 0.4 * mass * radius * radius;
  return diagonal(mass, i, i, i);
}

Inertia box_inertia(double mass, const Vec3& half) {
  const double x = half.x * half.x, y = half.y * half.y, z = half.z * half.z;
  return diagonal(mass, mass / 3 * (y + z), mass / 3 * (x + z), mass / 3 * (x + y));
}

Inertia capsule_inertia(double mass, double r, double h) {
  const double straight = 2 * h, ball = 4.0 / 3 * r;  // volumes over pi r^2
  const double mc = mass * straight / (straight + ball), ms = mass - mc;
  const double along = 0.5 * mc * r * r + 0.4 * ms * r * r;
  const double across = mc * (r * r / 4 + h * h / 3) + ms * (0.4 * r * r + h * h + 0.75 * h * r);
  return diagonal(mass, across, across, along);
}

Inertia cylinder_inertia(double mass, double r, double h) {
  const double across = mass * (r * r / 4 + h * h / 3);
  return diagonal(mass, across, across, 0.5 * mass * r * r);
}

Inertia ellipsoid_inertia(double mass, const Vec3& half) {
  const double x = half.x * half.x, y = half.y * half.y, z = half.z * half.z;
  return diagonal(mass, mass / 5 * (y + z), mass / 5 * (x + z), mass / 5 * (x + y));
}

Inertia hull_inertia(double mass, const Hull& hull) {
  Inertia out;
  out.mass = mass;
  out.com = hull.com;
  for (int i = 0; i < 6; ++i) out.moment[i] = mass * hull.moment[i];
  return out;
}

Inertia shapes_inertia(const ShapeDef* shapes, int32_t count, double mass) {
  Inertia sum;
  double volume = 0;
  for (int32_t i = 0; i < count; ++i) {
    const ShapeDef& s = shapes[i];
    Solid solid = solid_of(s);
    if (!(solid.volume > 0 && solid.volume < 1e12) || !finite(s.X_LS.p))
      fail(Code::kRange, "shape %s: a size or its position is out of bounds", s.name.text);
    volume += solid.volume;
    solid.unit.mass *= solid.volume;
    for (double& m : solid.unit.moment) m *= solid.volume;
    Pose X = s.X_LS;
    X.q = normalized(X.q);
    const Inertia placed = transformed(solid.unit, X);
    sum = sum.mass > 0 ? combined(sum, placed) : placed;
  }
  sum.mass = mass;
  for (double& m : sum.moment) m *= mass / volume;
  return sum;
}

}  // namespace rdm
