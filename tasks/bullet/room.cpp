#include "tasks/bullet/room.hpp"

namespace rdm {

Room regular_room(int32_t walls, double distance) {
  Room room;
  room.walls = walls;
  room.distance = distance;
  for (int32_t k = 0; k < walls; ++k) {
    const elementary::SinCos n = elementary::sincos(2 * kPi * k / walls);
    room.nx[k] = n.cos;
    room.ny[k] = n.sin;
  }
  return room;
}

void add_square_room(PlanarScene& scene) {
  constexpr double h = kRoomHalf;
  scene.wall("wall", kMarkGrey, -h, -h, h, -h)
      .wall("wall", kMarkGrey, -h, h, h, h)
      .wall("wall", kMarkGrey, -h, -h, -h, h)
      .wall("wall", kMarkGrey, h, -h, h, h);
}

}  // namespace rdm
