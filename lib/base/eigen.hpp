// The one door to Eigen: small dense algebra of fixed sizes, outside inner loops.
//
// Eigen chooses its instructions by the machine it is compiled for, which changes the order of sums. With
// vectorization off it is plain C++ that our flags (-ffp-contract=off) compile to the same bytes on every
// machine for a given Eigen release; where a release may change the last bits, the golden hashes tell. Use
// fixed sizes only (no heap), and nothing that calls the C library's mathematics: SelfAdjointEigenSolver's
// compute() does not, its computeDirect() (cos, atan2) and Quaternion's slerp() (acos, sin) do.
#pragma once
#if defined(EIGEN_CORE_H)
#error "include base/eigen.hpp, never Eigen itself: these settings must come first"
#endif
#define EIGEN_DONT_VECTORIZE
#define EIGEN_DONT_PARALLELIZE
#define EIGEN_MPL2_ONLY
#define EIGEN_NO_IO
#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>

#include "base/vec.hpp"

namespace rdm {

inline Eigen::Vector3d to_eigen(const Vec3& a) {
  return {a.x, a.y, a.z};
}
inline Vec3 to_vec3(const Eigen::Vector3d& a) {
  return {a.x(), a.y(), a.z()};
}
inline Eigen::Matrix3d to_eigen(const Mat3& a) {
  return Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(a.m);
}
inline Mat3 to_mat3(const Eigen::Matrix3d& a) {
  Mat3 m;
  Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> rows(m.m);
  rows = a;
  return m;
}

}  // namespace rdm
