// YCB 053 to 077: balls, cups that go into each other, blocks.
#include "objects/objects.hpp"
#include "objects/tables/rows.hpp"

namespace rdm {
namespace {

using namespace object_rows;

constexpr ObjectShape kSoccerBall[] = {sphere(0.07, {}, {230, 230, 230})};
constexpr ObjectShape kSoftball[] = {sphere(0.048, {}, {220, 230, 90})};
constexpr ObjectShape kRacquetball[] = {sphere(0.02765, {}, {60, 90, 190})};
constexpr ObjectShape kGolfBall[] = {sphere(0.02135, {}, {240, 240, 240})};
constexpr ObjectShape kDice[] = {box(0.0162, 0.0162, 0.0162, {}, {240, 240, 240})};
constexpr ObjectShape kWoodBlock[] = {box(0.026, 0.026, 0.026, {}, {200, 60, 50})};
constexpr ObjectShape kTimer[] = {
    box(0.085, 0.08, 0.03, {0, 0, 0.015}, {235, 235, 235}),
    cylinder(0.025, 0.01, {0, 0, 0.035}, {200, 60, 60}),
};

// Open above, widest there: upper diameter, height.
struct CupForm {
  Wall wall;
  Turned<2> base;
  constexpr CupForm(double diameter, double height)
      : wall({0.43 * diameter, 0.004}, {0.5 * diameter, height}, 0.003),
        base({{0.43 * diameter, 0}, {0.43 * diameter, 0.004}}) {}
};
struct Cup {
  ObjectShape shapes[9];
  constexpr Cup(const CupForm& f, Color c)
      : shapes{hull(f.base.points, {}, c), RDM_WALL(f.wall, Vec3{}, c)} {}
};
constexpr Color kRed = {200, 60, 60}, kYellow = {235, 205, 70}, kGreen = {80, 170, 90},
                kBlue = {60, 110, 190}, kOrange = {235, 140, 50};
constexpr CupForm kFormA(0.055, 0.06), kFormB(0.06, 0.062), kFormC(0.065, 0.064), kFormD(0.07, 0.066),
    kFormE(0.075, 0.068), kFormF(0.08, 0.07), kFormG(0.085, 0.072), kFormH(0.09, 0.074), kFormI(0.095, 0.076),
    kFormJ(0.1, 0.078);
constexpr Cup kCupA(kFormA, kOrange), kCupB(kFormB, kYellow), kCupC(kFormC, kGreen), kCupD(kFormD, kBlue),
    kCupE(kFormE, kRed), kCupF(kFormF, kOrange), kCupG(kFormG, kYellow), kCupH(kFormH, kGreen),
    kCupI(kFormI, kBlue), kCupJ(kFormJ, kRed);

constexpr Object kObjects[] = {
    {"mini_soccer_ball", "053_mini_soccer_ball", "YCB 053; mass as published, size approximate",
     "sphere r 0.07", kLeather, 0.123, table(kSoccerBall)},
    {"softball", "054_softball", "YCB 054; mass as published, size approximate", "sphere r 0.048", kLeather,
     0.191, table(kSoftball)},
    {"racquetball", "057_racquetball", "YCB 057; mass as published, size approximate", "sphere r 0.02765",
     kRubber, 0.041, table(kRacquetball)},
    {"golf_ball", "058_golf_ball", "YCB 058; mass as published, size approximate", "sphere r 0.02135",
     kPlastic, 0.046, table(kGolfBall)},
    {"dice", "062_dice", "YCB 062; mass as published, size approximate", "box 0.0162 x 0.0162 x 0.0162",
     kPlastic, 0.0052, table(kDice)},
    {"cup_a", "065-a_cups", "YCB 065-a; mass as published, size approximate", "open, r 0.0275, h 0.06",
     kPlastic, 0.013, table(kCupA.shapes)},
    {"cup_b", "065-b_cups", "YCB 065-b; mass as published, size approximate", "open, r 0.03, h 0.062",
     kPlastic, 0.014, table(kCupB.shapes)},
    {"cup_c", "065-c_cups", "YCB 065-c; mass as published, size approximate", "open, r 0.0325, h 0.064",
     kPlastic, 0.017, table(kCupC.shapes)},
    {"cup_d", "065-d_cups", "YCB 065-d; mass as published, size approximate", "open, r 0.035, h 0.066",
     kPlastic, 0.019, table(kCupD.shapes)},
    {"cup_e", "065-e_cups", "YCB 065-e; mass as published, size approximate", "open, r 0.0375, h 0.068",
     kPlastic, 0.021, table(kCupE.shapes)},
    {"cup_f", "065-f_cups", "YCB 065-f; mass as published, size approximate", "open, r 0.04, h 0.07",
     kPlastic, 0.026, table(kCupF.shapes)},
    {"cup_g", "065-g_cups", "YCB 065-g; mass as published, size approximate", "open, r 0.0425, h 0.072",
     kPlastic, 0.028, table(kCupG.shapes)},
    {"cup_h", "065-h_cups", "YCB 065-h; mass as published, size approximate", "open, r 0.045, h 0.074",
     kPlastic, 0.031, table(kCupH.shapes)},
    {"cup_i", "065-i_cups", "YCB 065-i; mass as published, size approximate", "open, r 0.0475, h 0.076",
     kPlastic, 0.035, table(kCupI.shapes)},
    {"cup_j", "065-j_cups", "YCB 065-j; mass as published, size approximate", "open, r 0.05, h 0.078",
     kPlastic, 0.038, table(kCupJ.shapes)},
    {"colored_wood_block", "070-a_colored_wood_blocks", "YCB 070-a; mass as published, size approximate",
     "box 0.026 x 0.026 x 0.026", kWood, 0.0108, table(kWoodBlock)},
    {"timer", "076_timer", "YCB 076; mass as published, size approximate",
     "box 0.085 x 0.08 x 0.03, a knob to 0.04", kPlastic, 0.102, table(kTimer)},
};

}  // namespace

Table<Object> ycb_shapes() {
  return table(kObjects);
}

}  // namespace rdm
