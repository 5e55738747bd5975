// What a robot's joints have to bear of its own weight.
#pragma once
#include "physics/world.hpp"

namespace rdm {

// The torque (N m; N of a prismatic joint) by which each joint holds the present pose against gravity, at
// rest, by the world's own masses: out[links of the articulation]. Weightless links weigh nothing; what a
// free base needs is not told. As feed-forward it lets an arm stand still without a spring.
// Error(kUnsupported) for more than kMaxCoords links.
void gravity_torques(const World& world, int32_t articulation, double* out);

}  // namespace rdm
