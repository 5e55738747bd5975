// The row of bottles of Pick Bottles, and its table.
#pragma once
#include "base/option.hpp"
#include "physics/model/scene.hpp"

namespace rdm {

inline constexpr double kBottleCap = 0.15;     // m along its axis from a bottle's origin
inline constexpr double kBottleFoot = 0.1256;  // m, from the foot to the origin

// A bottle with a neck: a body cylinder and a neck cylinder, 0.275 m high. Centre of mass at the origin.
BodyDef make_bottle(const char* name, double mass, int32_t material, const Vec3& p, const uint8_t* color);

// Where the bottle of a number 1 to 5 stands at rest; `sink`: how deep its foot is in the table, m.
Vec3 bottle_place(int32_t number, double sink);

// Bodies: bottle_2 and bottle_4, which are to be taken, then the others unless they are `fixed`; table.
void add_bottles(double mass, double sink, bool fixed, int32_t picked, int32_t other, int32_t table,
                 SceneDef* scene);

}  // namespace rdm
