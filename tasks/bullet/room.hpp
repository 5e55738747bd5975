// Walls around an arena: the octagon of Circle, the square room of Gather and Reach.
#pragma once
#include "tasks/bullet/agent.hpp"

namespace rdm {

inline constexpr double kRoomHalf = 10, kRoomDraws = 7;  // m; things are drawn within +-7 m

struct Room {
  static constexpr int32_t kMaxWalls = 8;
  int32_t walls = 0;
  double distance = 0;                  // m, of each wall from the middle
  double nx[kMaxWalls], ny[kMaxWalls];  // outward
};
Room regular_room(int32_t walls, double distance);
inline Room square_room() {
  return regular_room(4, kRoomHalf);
}
// For pictures; and walls that an agent of the engine meets.
void add_square_room(PlanarScene& scene);
void add_solid_walls(const Room& room, PlanarScene& scene);
// Did the body touch the agent's articulation in the last control step?
bool body_touched(const World& world, int32_t body);

// An agent that its task moves goes back inside.
template <class A>
void keep_inside(const Room& room, const World& world, typename A::State* s) {
  constexpr double kSlack = 1;  // m: a wall's distance less this is a circle that no wall meets
  const double free = room.distance - A::kSize;
  AgentPlace at = A::look(world, *s);
  if (std::sqrt(at.x * at.x + at.y * at.y) < std::min(room.distance - kSlack, free)) return;
  for (int32_t k = 0; k < room.walls; ++k) {
    const double depth = room.nx[k] * at.x + room.ny[k] * at.y - free;
    if (depth <= 0) continue;
    A::block(room.nx[k], room.ny[k], depth, 0, s);
    at = A::look(world, *s);
  }
}

}  // namespace rdm
