// A chain of equal thin rods that hangs and swings in a plane, about y: the exact motion, for what is
// measured against it.
#pragma once
#include <vector>

namespace truth {

struct PlanarState {
  std::vector<double> q, qd;  // of the joints, rad, rad/s
};
// n rods of `length` (m) and `mass` (kg) from rest at q0, after `seconds`: by RK4 at 1e-4 s, right to 1e-9 rad.
//   sum_j M_ij (cos(a_i - a_j) a_j'' + sin(a_i - a_j) a_j'^2) = -g sum_k m A_ki sin a_i
//   M_ij = sum_k m A_ki A_kj + [i = j] J
// a_i the angle of rod i from hanging down, A_ki how far the centre of mass of rod k goes with rod i: length,
// half of it, 0. J stands in the first sum alone, where it is multiplied by 1.
PlanarState planar_chain(const std::vector<double>& q0, double length, double mass, double seconds);

}  // namespace truth
