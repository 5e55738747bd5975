#pragma once
#include "physics/model/scene.hpp"

namespace rdm {

// How far a joint goes beyond its range before it is clamped, rad (m). A soft limit, which takes the place of
// limit_stiffness and limit_margin, pushes it back before.
inline double stop_margin(const SolverDef& solver) {
  return solver.limit_law.soft() ? 10 : solver.limit_margin;
}

}  // namespace rdm
