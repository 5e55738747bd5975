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

void add_solid_walls(const Room& room, PlanarScene& scene) {
  constexpr double kThick = 0.5, kHigh = 2;  // m, half sizes
  const double half = room.distance * elementary::sin(kPi / room.walls) / elementary::cos(kPi / room.walls);
  for (int32_t k = 0; k < room.walls; ++k) {
    const double far = room.distance + kThick;
    scene.mark(
        "wall", ShapeKind::kBox, {kThick, half + kThick, kHigh}, kMarkGrey,
        {{far * room.nx[k], far * room.ny[k], kHigh}, axis_angle({0, 0, 1}, 2 * kPi * k / room.walls)});
    scene.def().statics.back().collides = true;
  }
}

bool body_touched(const World& world, int32_t body) {
  const Scene& scene = world.scene();
  const auto is_body = [&](int32_t shape) {
    const SceneShape& s = scene.shapes[static_cast<size_t>(shape)];
    return s.carrier == Carrier::kBody && s.index == body;
  };
  for (int32_t k = 0; k < static_cast<int32_t>(scene.pairs.size()); ++k) {
    const ShapePair& pair = scene.pairs[static_cast<size_t>(k)];
    if (world.pair_touched(k) && (is_body(pair.a) || is_body(pair.b))) return true;
  }
  return false;
}

}  // namespace rdm
