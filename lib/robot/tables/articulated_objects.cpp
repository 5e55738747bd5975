// Things that move and are no robots: a drawer, a door, a bottle with a screw cap, scissors, a tap.
//
// Nothing drives them: a joint has dry friction, which holds it where it was left, a little damping, and of a
// door's handle a spring. Frames: z up, x out of the front, to
// whom handles them; joints at 0 are closed. Sizes and masses are round figures of such things (K); moments
// are those of solid boxes (D). What slides or turns in a guide does not touch it: the joint and its ends are
// the guide.
#include "robot/tables/rows.hpp"

namespace rdm {
namespace {

using namespace rows;

// A box of uniform density by its sides, m.
constexpr Body slab(double mass, Vec3 com, double x, double y, double z) {
  const double k = mass / 12;
  return {mass, com, {k * (y * y + z * z), k * (x * x + z * z), k * (x * x + y * y), 0, 0, 0}};
}
constexpr Inertia root_of(const Body& b) {
  return {b.mass, b.com, {b.moment[0], b.moment[1], b.moment[2], 0, 0, 0}};
}
constexpr RobotLink sliding(const char* name, const char* joint, int32_t parent, Vec3 p, Vec3 axis,
                            Range range, const Body& b, const Drive& d) {
  RobotLink l = turning(name, joint, parent, p, {}, axis, range, b, d);
  l.kind = JointKind::kPrismatic;
  return l;
}

constexpr Color kWood = {176, 140, 98}, kDark = {120, 92, 62}, kSteel = {178, 182, 188},
                kWhite = {228, 228, 224}, kBlue = {70, 110, 180}, kRed = {190, 60, 56};

// ---- a drawer in its cabinet, 0.4 wide, 0.45 deep, 0.2 high: it comes out by 0.35
constexpr RobotLink kDrawerLinks[] = {
    sliding("drawer", "slide", -1, {0.225, 0, 0.1}, kX, {0, 0.35},
            slab(1.8, {-0.2, 0, -0.02}, 0.42, 0.34, 0.14), {0, 4, 200, 0, 0, 3}),
};
constexpr RobotShape kDrawerShapes[] = {
    box(-1, "floor", {0.225, 0.2, 0.008}, {0, 0, 0.008}, kDark),
    box(-1, "roof", {0.225, 0.2, 0.008}, {0, 0, 0.192}, kDark),
    box(-1, "right_wall", {0.225, 0.008, 0.084}, {0, -0.192, 0.1}, kDark),
    box(-1, "left_wall", {0.225, 0.008, 0.084}, {0, 0.192, 0.1}, kDark),
    box(-1, "back_wall", {0.008, 0.184, 0.084}, {-0.217, 0, 0.1}, kDark),
    box(0, "front", {0.009, 0.18, 0.08}, {0.009, 0, 0}, kWood),
    box(0, "bottom", {0.205, 0.17, 0.006}, {-0.205, 0, -0.07}, kWood),
    box(0, "right_side", {0.205, 0.006, 0.05}, {-0.205, -0.164, -0.014}, kWood),
    box(0, "left_side", {0.205, 0.006, 0.05}, {-0.205, 0.164, -0.014}, kWood),
    box(0, "back", {0.006, 0.158, 0.05}, {-0.404, 0, -0.014}, kWood),
    capsule(0, "bar", 0.007, 0.06, {0.055, 0, 0.01}, kSteel, kAlongY),
    capsule(0, "bar_right", 0.006, 0.014, {0.036, -0.055, 0.01}, kSteel, kAlongX),
    capsule(0, "bar_left", 0.006, 0.014, {0.036, 0.055, 0.01}, kSteel, kAlongX),
};

// ---- a cupboard's door, 0.5 wide, 0.8 high, hinged on its left, with a lever that a spring holds level
constexpr RobotLink kDoorLinks[] = {
    turning("leaf", "hinge", -1, {0, 0.25, 0.42}, {}, kZ, {0, 1.9},
            slab(5, {0.012, -0.25, 0}, 0.024, 0.5, 0.8), {0, 0.15, 100, 0, 0, 0.25}),
    turning("lever", "latch", 0, {0.03, -0.44, 0}, {}, kX, {0, 0.8},
            slab(0.15, {0.03, 0.045, 0}, 0.05, 0.11, 0.016), {1.2, 0.03, 20, 0, 0, 0.01}),
};
constexpr RobotShape kDoorShapes[] = {
    box(-1, "hinge_post", {0.02, 0.02, 0.42}, {0, 0.285, 0.42}, kDark),
    box(-1, "latch_post", {0.02, 0.02, 0.42}, {0, -0.285, 0.42}, kDark),
    box(-1, "lintel", {0.02, 0.305, 0.02}, {0, 0, 0.86}, kDark),
    box(0, "leaf", {0.012, 0.25, 0.4}, {0.012, -0.25, 0}, kWood),
    capsule(1, "spindle", 0.009, 0.012, {0.018, 0, 0}, kSteel, kAlongX),
    capsule(1, "lever", 0.009, 0.045, {0.039, 0.045, 0}, kSteel, kAlongY),
};

// ---- a bottle, 0.07 wide, 0.22 high; its cap takes one and a half turns, and does not rise
constexpr Body kBottleBody = slab(0.4, {0, 0, 0.085}, 0.06, 0.06, 0.17);
constexpr RobotLink kBottleLinks[] = {
    turning("cap", "thread", -1, {0, 0, 0.205}, {}, kZ, {0, 3 * kPi},
            slab(0.012, {0, 0, 0.0125}, 0.034, 0.034, 0.025), {0, 0.0005, 5, 0, 1e-5, 0.12}),
};
constexpr RobotShape kBottleShapes[] = {
    cylinder(-1, "body", 0.035, 0.08, {0, 0, 0.08}, kBlue),
    cylinder(-1, "shoulder", 0.025, 0.0125, {0, 0, 0.1725}, kBlue),
    cylinder(-1, "neck", 0.014, 0.011, {0, 0, 0.196}, kBlue),
    cylinder(0, "cap", 0.019, 0.0125, {0, 0, 0.0125}, kWhite),
    box(0, "rib", {0.0212, 0.002, 0.011}, {0, 0, 0.0125}, kWhite),
};

// ---- scissors, 0.2 long: the pivot in the middle, blades along x
constexpr Body kBladeBody = slab(0.045, {-0.01, -0.004, 0}, 0.19, 0.025, 0.006);
constexpr RobotLink kScissorsLinks[] = {
    turning("upper", "pivot", -1, {}, {}, kZ, {0, 1.2}, slab(0.045, {-0.01, 0.004, 0}, 0.19, 0.025, 0.006),
            {0, 0.0005, 10, 0, 1e-5, 0.02}),
};
constexpr RobotShape kScissorsShapes[] = {
    box(-1, "blade", {0.05, 0.006, 0.002}, {0.045, -0.004, -0.002}, kSteel),
    capsule(-1, "shank", 0.005, 0.014, {-0.022, 0.008, -0.002}, kRed,
            {0.6963642403, -0.1227878, 0.6963642403, -0.1227878}),
    capsule(-1, "finger_near", 0.005, 0.027, {-0.065, 0.012, -0.002}, kRed, kAlongX),
    capsule(-1, "finger_far", 0.005, 0.02, {-0.065, 0.04, -0.002}, kRed, kAlongX),
    capsule(-1, "finger_front", 0.005, 0.014, {-0.038, 0.026, -0.002}, kRed, kAlongY),
    capsule(-1, "finger_back", 0.005, 0.014, {-0.092, 0.026, -0.002}, kRed, kAlongY),
    box(0, "upper_blade", {0.05, 0.006, 0.002}, {0.045, 0.004, 0.003}, kSteel),
    capsule(0, "upper_shank", 0.005, 0.014, {-0.022, -0.008, 0.003}, kRed,
            {0.6963642403, 0.1227878, 0.6963642403, 0.1227878}),
    capsule(0, "thumb_near", 0.005, 0.024, {-0.06, -0.012, 0.003}, kRed, kAlongX),
    capsule(0, "thumb_far", 0.005, 0.018, {-0.06, -0.036, 0.003}, kRed, kAlongX),
    capsule(0, "thumb_front", 0.005, 0.012, {-0.036, -0.024, 0.003}, kRed, kAlongY),
    capsule(0, "thumb_back", 0.005, 0.012, {-0.084, -0.024, 0.003}, kRed, kAlongY),
};

// ---- a tap with one lever: it turns for warm and cold, and is lifted for water
constexpr Body kTapBody = slab(1.2, {0.05, 0, 0.07}, 0.16, 0.05, 0.14);
constexpr RobotLink kTapLinks[] = {
    turning("collar", "mix", -1, {0, 0, 0.15}, {}, kZ, {-0.9, 0.9}, slab(0.1, {0, 0, 0.01}, 0.04, 0.04, 0.02),
            {0, 0.01, 20, 0, 0, 0.15}),
    turning("lever", "lift", 0, {0, 0, 0.02}, {}, {0, -1, 0}, {0, 0.6},
            slab(0.08, {0.012, 0, 0.012}, 0.1, 0.02, 0.012), {0, 0.01, 20, 0, 0, 0.2}),
};
constexpr RobotShape kTapShapes[] = {
    cylinder(-1, "foot", 0.028, 0.004, {0, 0, 0.004}, kSteel),
    cylinder(-1, "pillar", 0.021, 0.071, {0, 0, 0.079}, kSteel),
    capsule(-1, "spout", 0.012, 0.065, {0.08, 0, 0.1}, kSteel, kAlongX),
    cylinder(-1, "mouth", 0.012, 0.012, {0.145, 0, 0.084}, kSteel),
    cylinder(0, "collar", 0.022, 0.01, {0, 0, 0.01}, kWhite),
    sphere(1, "hub", 0.017, {0, 0, 0.008}, kSteel),
    box(1, "lever", {0.05, 0.009, 0.005}, {0.055, 0, 0.016}, kSteel),
};

}  // namespace

extern constinit const Robot kDrawer = {
    .name = "drawer",
    .help = "a drawer with a bar, in its cabinet; slides out by 0.35 m, 3 N of friction",
    .X_BR = {},
    .root = root_of(slab(6, {0, 0, 0.1}, 0.45, 0.4, 0.2)),
    .links = table(kDrawerLinks),
    .shapes = table(kDrawerShapes),
    .passive = true,
};
extern constinit const Robot kDoor = {
    .name = "door",
    .help = "a cupboard's door with a sprung lever; opens by 1.9 rad, 0.25 N m of friction",
    .X_BR = {},
    .root = root_of(slab(4, {0, 0, 0.42}, 0.04, 0.6, 0.84)),
    .links = table(kDoorLinks),
    .shapes = table(kDoorShapes),
    .passive = true,
};
extern constinit const Robot kScrewBottle = {
    .name = "screw_bottle",
    .help = "a bottle with a screw cap; one and a half turns, 0.12 N m of friction",
    .X_BR = {},
    .root = root_of(kBottleBody),
    .links = table(kBottleLinks),
    .shapes = table(kBottleShapes),
    .passive = true,
};
extern constinit const Robot kScissors = {
    .name = "scissors",
    .help = "scissors; open by 1.2 rad, 0.02 N m of friction",
    .X_BR = {},
    .root = root_of(kBladeBody),
    .links = table(kScissorsLinks),
    .shapes = table(kScissorsShapes),
    .passive = true,
};
extern constinit const Robot kTap = {
    .name = "tap",
    .help = "a tap with one lever: turns by 0.9 rad to either side, is lifted by 0.6 rad",
    .X_BR = {},
    .root = root_of(kTapBody),
    .links = table(kTapLinks),
    .shapes = table(kTapShapes),
    .passive = true,
};

}  // namespace rdm
