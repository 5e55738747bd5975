// A wall with a rectangular hole, or of the user's own boxes: static shapes "wall1", "wall2", ...
#pragma once
#include "base/option.hpp"
#include "env/option_table.hpp"
#include "physics/model/scene.hpp"

namespace rdm {

inline constexpr int kMaxWallBoxes = 8;

// A plane wall about x = 0, by its options: m, world axes.
struct Wall {
  double y, thickness, width;
  double low_z, high_z;   // outer edges
  double hole_x, hole_z;  // centre
  double hole_width, hole_height;
  double low_x() const { return -high_x(); }
  double high_x() const { return 0.5 * width; }
};

// Options wall.*, wall.hole.* and wall.box1 to wall.box8. A box given there replaces the wall with the hole.
void add_wall_options(OptionTable& table);
// Error(kArgument) for a hole that is not inside the wall.
Wall wall_from(const Options& options);

// Up to four panels around the hole.
Vector<ShapeDef> wall_panels(const Wall& wall, int32_t material);
// The user's boxes, empty when none is given. Error(kArgument) names the option that cannot be read.
Vector<ShapeDef> wall_boxes(const Options& options, int32_t material);

// "x y z  width depth height" in m, optionally followed by a turn "rx ry rz" in degrees about fixed axes.
// False when it is none.
bool parse_box(const char* text, ShapeDef* box);

}  // namespace rdm
