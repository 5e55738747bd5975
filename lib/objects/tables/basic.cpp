// What the tasks began with: forms for throwing, and nine of the YCB set as single primitives.
#include "objects/objects.hpp"
#include "objects/tables/rows.hpp"

namespace rdm {
namespace {

using namespace object_rows;

constexpr Color kEgg = {240, 225, 190};
constexpr Vec3 kOctahedron[] = {{0.035, 0, 0},  {-0.035, 0, 0}, {0, 0.035, 0},
                                {0, -0.035, 0}, {0, 0, 0.035},  {0, 0, -0.035}};

constexpr ObjectShape kEggShape[] = {capsule(0.03, 0.02, {}, kEgg)};
constexpr ObjectShape kBall[] = {sphere(0.0333, {}, {220, 80, 60})};
constexpr ObjectShape kHeavyBall[] = {sphere(0.0375, {}, {120, 60, 60})};
constexpr ObjectShape kCube[] = {box(0.05, 0.05, 0.05, {}, {90, 150, 90})};
constexpr ObjectShape kCrackerBox[] = {box(0.16, 0.21, 0.06, {}, {200, 40, 40})};
constexpr ObjectShape kSoupCan[] = {cylinder(0.033, 0.101, {}, {210, 60, 50})};
constexpr ObjectShape kMustard[] = {box(0.058, 0.095, 0.19, {}, {230, 190, 40})};
constexpr ObjectShape kMeatCan[] = {box(0.05, 0.097, 0.082, {}, {60, 80, 160})};
constexpr ObjectShape kMug[] = {cylinder(0.04, 0.081, {}, {200, 50, 50})};
constexpr ObjectShape kBaseball[] = {sphere(0.0375, {}, {235, 235, 230})};
constexpr ObjectShape kTennisBall[] = {sphere(0.033, {}, {200, 220, 60})};
constexpr ObjectShape kFoamBrick[] = {box(0.05, 0.075, 0.05, {}, {180, 60, 60})};
constexpr ObjectShape kRubiksCube[] = {box(0.057, 0.057, 0.057, {}, {60, 120, 200})};
constexpr ObjectShape kEllipsoidEgg[] = {ellipsoid(0.03, 0.03, 0.04, {}, kEgg)};
constexpr ObjectShape kHull[] = {hull(kOctahedron, {}, {150, 140, 200})};

// egg: mass and moments of the ellipsoid 0.03, 0.03, 0.04 m at 500 kg/m3, seen and touched as a capsule.
constexpr Object kObjects[] = {
    {"egg",
     nullptr,
     "an egg that rolls; its mass is that of an ellipsoid at 500 kg/m3",
     "capsule r 0.03, straight part 0.02",
     kShell,
     0.0754,
     table(kEggShape),
     {3.77e-5, 3.77e-5, 2.71e-5}},
    {"ball", nullptr, "a ball of the egg's mass", "sphere r 0.0333", kRubber, 0.0754, table(kBall)},
    {"heavy_ball", nullptr, "a heavy ball", "sphere r 0.0375", kRubber, 0.25, table(kHeavyBall)},
    {"cube", nullptr, "a light cube", "box 0.05 x 0.05 x 0.05", kWood, 0.071, table(kCube)},
    {"cracker_box", "003_cracker_box", "YCB 003; mass and size as published", "box 0.16 x 0.21 x 0.06",
     kCardboard, 0.411, table(kCrackerBox)},
    {"soup_can", "005_tomato_soup_can", "YCB 005; mass and size as published", "cylinder r 0.033, h 0.101",
     kMetal, 0.349, table(kSoupCan)},
    {"mustard_bottle", "006_mustard_bottle", "YCB 006; mass and size as published",
     "box 0.058 x 0.095 x 0.19", kPlastic, 0.603, table(kMustard)},
    {"potted_meat_can", "010_potted_meat_can", "YCB 010; mass and size as published",
     "box 0.05 x 0.097 x 0.082", kMetal, 0.37, table(kMeatCan)},
    {"mug", nullptr, "YCB 025 without its handle, filled; mass and size as published",
     "cylinder r 0.04, h 0.081", kMetal, 0.118, table(kMug)},
    {"baseball", "055_baseball", "YCB 055; mass and size as published", "sphere r 0.0375", kLeather, 0.148,
     table(kBaseball)},
    {"tennis_ball", "056_tennis_ball", "YCB 056; mass and size as published", "sphere r 0.033", kFelt, 0.058,
     table(kTennisBall)},
    {"foam_brick", "061_foam_brick", "YCB 061; mass and size as published", "box 0.05 x 0.075 x 0.05", kFoam,
     0.028, table(kFoamBrick)},
    {"rubiks_cube", "077_rubiks_cube", "YCB 077; mass and size as published", "box 0.057 x 0.057 x 0.057",
     kPlastic, 0.094, table(kRubiksCube)},
    {"ellipsoid_egg", nullptr, "the egg as an exact ellipsoid", "ellipsoid 0.03 x 0.03 x 0.04 (half axes)",
     kShell, 0.0754, table(kEllipsoidEgg)},
    {"hull", nullptr, "hull of the points in option hull, by default an octahedron, at 500 kg/m3",
     "convex hull of the points of option hull", kPlastic, 0.0286, table(kHull)},
};

}  // namespace

Table<Object> basic_objects() {
  return table(kObjects);
}

}  // namespace rdm
