// What stands in Clean House: broom, trash, chair and dustpan.
#pragma once
#include "physics/model/scene.hpp"

namespace rdm {

// Bodies of the scene, in this order.
enum : int32_t { kBroom = 0, kTrash, kChair };

// Rows of the friction table that a house needs; `pan` is the dustpan's, through which the broom passes.
struct HouseMaterials {
  int32_t handle, head, trash, chair, pan;
};

struct HouseDef {
  double trash_mass = 0.06;  // kg
  double chair_mass = 4;     // kg
  double sink = 0;           // m, how deep things that rest are in the floor
};

inline constexpr double kHandleHalf = 1.05;  // m, of the broom's handle
// Points of the broom from its middle, in its own axes: where the hands hold it, and its lower edge. m.
inline constexpr Vec3 kRightHold = {0, 0, 0.2}, kLeftHold = {0, 0, 0.5}, kBroomBottom = {0, -0.05, -1.05};
inline constexpr double kTrashRadius = 0.0395, kTrashHalf = 0.1375;  // m

void add_house(const HouseDef& house, const HouseMaterials& materials, SceneDef* scene);

// The middle of the broom's handle, in the frame of its body, whose origin is the centre of mass.
Vec3 broom_middle();

}  // namespace rdm
