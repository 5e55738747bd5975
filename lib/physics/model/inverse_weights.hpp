// How easily the things of a scene are moved while all joints are at 0, in the manner of MuJoCo's invweight0:
// what soft contacts and soft limits measure their softness by.
#pragma once
#include "physics/model/scene.hpp"

namespace rdm {

struct InverseWeights {
  Vector<double> links;   // [num_links] mean of J M^-1 J^T over the directions of the centre of mass, 1/kg
  Vector<double> bases;   // [articulations]; 0: it is fixed
  Vector<double> joints;  // [num_links] diagonal of M^-1, 1/(kg m2) (1/kg)
  // Of what carries the shape; 0: it stands still.
  double of(const Scene& scene, const SceneShape& shape) const;
};
InverseWeights inverse_weights(const Scene& scene);

}  // namespace rdm
