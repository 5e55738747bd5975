// YCB 035 to 052: tools. What lies apart in two materials weighs as one.
#include "objects/objects.hpp"
#include "objects/tables/rows.hpp"

namespace rdm {
namespace {

using namespace object_rows;

constexpr Color kSteel = {170, 174, 180}, kOrange = {230, 120, 40}, kBlack = {44, 44, 48},
                kRed = {190, 40, 40}, kYellow = {220, 190, 50}, kBlue = {50, 90, 170};

// The chuck points along x; the grip hangs below, the battery at its foot.
constexpr ObjectShape kDrill[] = {
    cylinder(0.0275, 0.12, {0, 0, 0}, kOrange, kAlongX),
    cylinder(0.018, 0.064, {0.092, 0, 0}, kBlack, kAlongX),
    box(0.042, 0.036, 0.1, {-0.03, 0, -0.07}, kOrange, turn(1, 0.07)),
    box(0.09, 0.06, 0.042, {-0.02, 0, -0.139}, kBlack),
};
constexpr ObjectShape kWoodBlock[] = {box(0.085, 0.085, 0.2, {}, {170, 120, 80})};
// Closed: two blades along x, a loop of three rods behind each.
constexpr ObjectShape kScissors[] = {
    box(0.105, 0.016, 0.004, {0.0475, 0.003, 0.003}, kSteel, turn(2, 0.02)),
    box(0.105, 0.016, 0.004, {0.0475, -0.003, -0.003}, kSteel, turn(2, -0.02)),
    rod({-0.005, 0, 0.002}, {-0.03, -0.016, 0.002}, 0.006, kBlue),
    rod({-0.03, -0.016, 0.002}, {-0.09, -0.014, 0.002}, 0.006, kBlue),
    rod({-0.03, -0.016, 0.002}, {-0.062, -0.0375, 0.002}, 0.006, kBlue),
    rod({-0.062, -0.0375, 0.002}, {-0.09, -0.014, 0.002}, 0.006, kBlue),
    rod({-0.005, 0, -0.002}, {-0.03, 0.016, -0.002}, 0.006, kBlue),
    rod({-0.03, 0.016, -0.002}, {-0.094, 0.014, -0.002}, 0.006, kBlue),
    rod({-0.03, 0.016, -0.002}, {-0.064, 0.0375, -0.002}, 0.006, kBlue),
    rod({-0.064, 0.0375, -0.002}, {-0.094, 0.014, -0.002}, 0.006, kBlue),
};
constexpr ObjectShape kPadlock[] = {
    box(0.024, 0.047, 0.036, {0, 0, 0.018}, kYellow),
    rod({0, -0.0165, 0.034}, {0, -0.0165, 0.053}, 0.004, kSteel),
    rod({0, -0.0165, 0.053}, {0, -0.008, 0.061}, 0.004, kSteel),
    rod({0, -0.008, 0.061}, {0, 0.008, 0.061}, 0.004, kSteel),
    rod({0, 0.008, 0.061}, {0, 0.0165, 0.053}, 0.004, kSteel),
    rod({0, 0.0165, 0.034}, {0, 0.0165, 0.053}, 0.004, kSteel),
};
constexpr ObjectShape kLargeMarker[] = {cylinder(0.009, 0.121, {}, kBlack)};
constexpr ObjectShape kSmallMarker[] = {cylinder(0.004, 0.135, {}, kBlack)};
constexpr ObjectShape kWrench[] = {
    box(0.15, 0.022, 0.005, {0.075, 0, 0}, kSteel),
    box(0.03, 0.055, 0.005, {0.163, 0, 0}, kSteel),
    box(0.03, 0.014, 0.005, {0.19, 0.0205, 0}, kSteel),
    box(0.03, 0.014, 0.005, {0.19, -0.0075, 0}, kSteel),
};
constexpr ObjectShape kPhillips[] = {
    cylinder(0.0155, 0.105, {-0.0525, 0, 0}, kRed, kAlongX),
    cylinder(0.0035, 0.11, {0.055, 0, 0}, kSteel, kAlongX),
};
constexpr ObjectShape kFlat[] = {
    cylinder(0.0155, 0.105, {-0.0525, 0, 0}, kRed, kAlongX),
    cylinder(0.0035, 0.1, {0.05, 0, 0}, kSteel, kAlongX),
    box(0.01, 0.008, 0.0016, {0.105, 0, 0}, kSteel),
};
constexpr ObjectShape kBolt[] = {
    cylinder(0.0075, 0.007, {0, 0, 0.0395}, kBlue),
    cylinder(0.004, 0.036, {0, 0, 0.018}, kBlue),
};
constexpr Wall kNutWall({0.0075, 0}, {0.0075, 0.008}, 0.0033);
constexpr ObjectShape kNut[] = {RDM_WALL(kNutWall, Vec3{}, kBlue)};
constexpr ObjectShape kHammer[] = {
    box(0.1, 0.024, 0.024, {0.012, 0, 0}, kSteel),
    cylinder(0.016, 0.035, {-0.0555, 0, 0}, kSteel, kAlongX),
    box(0.028, 0.022, 0.3, {0, 0, -0.162}, kOrange),
};

// A spring clamp, open side along x: two arms that cross at the pivot, jaws and grips apart. The length of an
// arm, half the width at its ends, the thickness.
struct Clamp {
  ObjectShape shapes[5];
  constexpr Clamp(double length, double width, double thickness)
      : shapes{rod({0, 0.2 * width, 0}, {0.5 * length - 0.4 * thickness, 0.12 * width, 0}, 0.4 * thickness,
                   kBlack),
               rod({0, -0.2 * width, 0}, {0.5 * length - 0.4 * thickness, -0.12 * width, 0}, 0.4 * thickness,
                   kBlack),
               rod({0, 0.2 * width, 0}, {-0.5 * length + 0.4 * thickness, 0.5 * width - 0.4 * thickness, 0},
                   0.4 * thickness, kOrange),
               rod({0, -0.2 * width, 0}, {-0.5 * length + 0.4 * thickness, -0.5 * width + 0.4 * thickness, 0},
                   0.4 * thickness, kOrange),
               box(0.12 * length, 0.5 * width, thickness, {}, kBlack)} {}
};
constexpr Clamp kSmallClamp(0.085, 0.065, 0.01), kMediumClamp(0.115, 0.09, 0.027),
    kLargeClamp(0.165, 0.125, 0.032), kExtraLargeClamp(0.213, 0.165, 0.037);

constexpr Object kObjects[] = {
    {"power_drill", "035_power_drill", "YCB 035; mass as published, size approximate",
     "2 cylinders, grip and battery, 0.184 long, 0.19 high", kPlastic, 0.895, table(kDrill)},
    {"wood_block", "036_wood_block", "YCB 036; mass as published, size approximate",
     "box 0.085 x 0.085 x 0.2", kWood, 0.729, table(kWoodBlock)},
    {"scissors", "037_scissors", "YCB 037, closed; mass as published, size approximate",
     "2 blades, 8 rods, 0.2 long, 0.087 wide", kMetal, 0.082, table(kScissors)},
    {"padlock", "038_padlock", "YCB 038; mass as published, size approximate",
     "box 0.024 x 0.047 x 0.036, a shackle to 0.065", kMetal, 0.304, table(kPadlock)},
    {"large_marker", "040_large_marker", "YCB 040; mass as published, size approximate",
     "cylinder r 0.009, h 0.121", kPlastic, 0.0158, table(kLargeMarker)},
    {"small_marker", "041_small_marker", "YCB 041; mass as published, size approximate",
     "cylinder r 0.004, h 0.135", kPlastic, 0.0082, table(kSmallMarker)},
    {"adjustable_wrench", "042_adjustable_wrench", "YCB 042; mass as published, size approximate",
     "4 boxes, 0.205 x 0.055 x 0.005", kMetal, 0.252, table(kWrench)},
    {"phillips_screwdriver", "043_phillips_screwdriver", "YCB 043; mass as published, size approximate",
     "2 cylinders, 0.215 long, r 0.0155", kPlastic, 0.097, table(kPhillips)},
    {"flat_screwdriver", "044_flat_screwdriver", "YCB 044; mass as published, size approximate",
     "2 cylinders, a tip, 0.215 long, r 0.0155", kPlastic, 0.0984, table(kFlat)},
    {"plastic_bolt", "046_plastic_bolt", "YCB 046; mass as published, size approximate",
     "2 cylinders, 0.043 long, r 0.0075", kPlastic, 0.0036, table(kBolt)},
    {"plastic_nut", "047_plastic_nut", "YCB 047; mass as published, size approximate",
     "a ring, r 0.0075, h 0.008", kPlastic, 0.001, table(kNut)},
    {"hammer", "048_hammer", "YCB 048; mass as published, size and handle approximate",
     "head 0.135 x 0.032 x 0.032, handle to 0.33", kMetal, 0.665, table(kHammer)},
    {"small_clamp", "049_small_clamp", "YCB 049; mass as published, size approximate",
     "4 rods and a box, 0.085 x 0.065 x 0.01", kPlastic, 0.0192, table(kSmallClamp.shapes)},
    {"medium_clamp", "050_medium_clamp", "YCB 050; mass as published, size approximate",
     "4 rods and a box, 0.115 x 0.09 x 0.027", kPlastic, 0.059, table(kMediumClamp.shapes)},
    {"large_clamp", "051_large_clamp", "YCB 051; mass as published, size approximate",
     "4 rods and a box, 0.165 x 0.125 x 0.032", kPlastic, 0.125, table(kLargeClamp.shapes)},
    {"extra_large_clamp", "052_extra_large_clamp", "YCB 052; mass as published, size approximate",
     "4 rods and a box, 0.213 x 0.165 x 0.037", kPlastic, 0.202, table(kExtraLargeClamp.shapes)},
};

}  // namespace

Table<Object> ycb_tools() {
  return table(kObjects);
}

}  // namespace rdm
