// YCB 019 to 033: what stands in a kitchen. Walls are four millimetres thick or more, and what they hold is
// hollow: a thing that meets them at 0.5 m/s stays in, one at 1 m/s moves by 8 mm in a substep and may pass.
// They stand on their foot alone, so that a few contacts carry them.
#include "objects/objects.hpp"
#include "objects/tables/rows.hpp"

namespace rdm {
namespace {

using namespace object_rows;

constexpr Color kBlue = {40, 90, 160}, kRed = {200, 50, 50}, kSteel = {180, 184, 190}, kBlack = {40, 40, 44},
                kWhite = {235, 235, 235}, kClear = {190, 210, 220};

constexpr Wall kPitcherWall({0.05, 0.005}, {0.054, 0.235}, 0.004);
constexpr Turned<2> kPitcherBase({{0.05, 0}, {0.05, 0.005}});
constexpr ObjectShape kPitcher[] = {
    hull(kPitcherBase.points, {}, kBlue),
    RDM_WALL(kPitcherWall, Vec3{}, kBlue),
    rod({0.05, 0, 0.06}, {0.09, 0, 0.08}, 0.008, kBlue),
    rod({0.09, 0, 0.08}, {0.09, 0, 0.18}, 0.008, kBlue),
    rod({0.09, 0, 0.18}, {0.05, 0, 0.205}, 0.008, kBlue),
};
constexpr Turned<2> kShoulders({{0.03, 0.19}, {0.018, 0.215}});
constexpr ObjectShape kBleach[] = {
    box(0.065, 0.098, 0.19, {0, 0, 0.095}, kWhite),
    hull(kShoulders.points, {}, kWhite),
    cylinder(0.018, 0.035, {0, 0, 0.2325}, kBlue),
};
constexpr ObjectShape kWindex[] = {
    box(0.06, 0.105, 0.17, {0, 0, 0.085}, {80, 140, 210}),
    cylinder(0.018, 0.05, {0, 0, 0.195}, {80, 140, 210}),
    box(0.028, 0.08, 0.05, {0, 0.0125, 0.245}, kWhite),
    rod({0, 0.045, 0.222}, {0, 0.035, 0.19}, 0.006, kWhite),
};
constexpr Wall kGlassWall({0.02, 0.075}, {0.0445, 0.137}, 0.004);
constexpr ObjectShape kWineGlass[] = {
    cylinder(0.0365, 0.004, {0, 0, 0.002}, kClear),
    cylinder(0.0045, 0.069, {0, 0, 0.0385}, kClear),
    cylinder(0.0185, 0.005, {0, 0, 0.0745}, kClear),
    RDM_WALL(kGlassWall, Vec3{}, kClear),
};
constexpr Wall kBowlLow({0.044, 0.003}, {0.068, 0.02}, 0.012),
    kBowlHigh({0.068, 0.02}, {0.0795, 0.053}, 0.004);
constexpr Turned<2> kBowlBase({{0.036, 0}, {0.04, 0.006}});
constexpr ObjectShape kBowl[] = {
    hull(kBowlBase.points, {}, kRed),
    RDM_WALL(kBowlLow, Vec3{}, kRed),
    RDM_WALL(kBowlHigh, Vec3{}, kRed),
};
constexpr Wall kMugWall({0.04, 0.005}, {0.04, 0.082}, 0.004);
constexpr Turned<2> kMugBase({{0.04, 0}, {0.04, 0.005}});
constexpr ObjectShape kMug[] = {
    hull(kMugBase.points, {}, kRed),
    RDM_WALL(kMugWall, Vec3{}, kRed),
    rod({0.038, 0, 0.02}, {0.062, 0, 0.028}, 0.0045, kRed),
    rod({0.062, 0, 0.028}, {0.062, 0, 0.055}, 0.0045, kRed),
    rod({0.062, 0, 0.055}, {0.038, 0, 0.064}, 0.0045, kRed),
};
constexpr ObjectShape kSponge[] = {box(0.072, 0.114, 0.014, {}, {230, 210, 90})};
constexpr Wall kPanWall({0.12, 0.004}, {0.135, 0.025}, 0.005);
constexpr Turned<2> kPanBase({{0.12, 0}, {0.12, 0.004}});
constexpr ObjectShape kSkillet[] = {
    hull(kPanBase.points, {}, kBlack),
    RDM_WALL(kPanWall, Vec3{}, kBlack),
    rod({0.125, 0, 0.018}, {0.29, 0, 0.03}, 0.01, kBlack),
};
constexpr ObjectShape kSkilletLid[] = {
    cylinder(0.135, 0.01, {0, 0, 0.005}, kClear),
    cylinder(0.02, 0.012, {0, 0, 0.016}, kBlack),
};
constexpr Wall kPlateRim({0.088, 0.003}, {0.129, 0.024}, 0.012);
constexpr Turned<2> kPlateBase({{0.076, 0}, {0.082, 0.006}});
constexpr ObjectShape kPlate[] = {
    hull(kPlateBase.points, {}, kRed),
    RDM_WALL(kPlateRim, Vec3{}, kRed),
};
constexpr ObjectShape kFork[] = {
    box(0.125, 0.014, 0.004, {0.0625, 0, 0.002}, kSteel),
    box(0.028, 0.02, 0.004, {0.139, 0, 0.002}, kSteel),
    rod({0.152, -0.0082, 0.0035}, {0.196, -0.0082, 0.0105}, 0.0018, kSteel),
    rod({0.152, -0.0027, 0.0035}, {0.196, -0.0027, 0.0105}, 0.0018, kSteel),
    rod({0.152, 0.0027, 0.0035}, {0.196, 0.0027, 0.0105}, 0.0018, kSteel),
    rod({0.152, 0.0082, 0.0035}, {0.196, 0.0082, 0.0105}, 0.0018, kSteel),
};
constexpr ObjectShape kSpoon[] = {
    box(0.135, 0.014, 0.004, {0.0675, 0, 0.002}, kSteel),
    ellipsoid(0.033, 0.02, 0.006, {0.162, 0, 0.004}, kSteel),
};
constexpr Vec3 kKnifeBlade[] = {{0.105, -0.007, 0},  {0.105, 0.01, 0},       {0.19, 0.01, 0},
                                {0.215, -0.007, 0},  {0.105, -0.007, 0.002}, {0.105, 0.01, 0.002},
                                {0.19, 0.01, 0.002}, {0.215, -0.007, 0.002}};
constexpr ObjectShape kKnife[] = {
    box(0.105, 0.014, 0.006, {0.0525, 0, 0.001}, kSteel),
    hull(kKnifeBlade, {}, kSteel),
};
constexpr ObjectShape kSpatula[] = {
    rod({0.008, 0, 0.03}, {0.25, 0, 0.02}, 0.008, kBlack),
    box(0.1, 0.083, 0.004, {0.3, 0, 0.012}, kBlack, turn(1, 0.06)),
};

constexpr Object kObjects[] = {
    {"pitcher_base", "019_pitcher_base", "YCB 019; mass as published, size approximate",
     "open, r 0.054, h 0.235, a handle", kPlastic, 0.178, table(kPitcher)},
    {"bleach_cleanser", "021_bleach_cleanser", "YCB 021; mass as published, size approximate",
     "box 0.065 x 0.098 x 0.19, shoulders, neck to 0.25", kPlastic, 1.131, table(kBleach)},
    {"windex_bottle", "022_windex_bottle", "YCB 022; mass as published, size approximate",
     "box 0.06 x 0.105 x 0.17, neck, head to 0.27", kPlastic, 1.022, table(kWindex)},
    {"wine_glass", "023_wine_glass", "YCB 023; mass as published, size approximate",
     "foot, stem and open cup, r 0.0445, h 0.137", kGlass, 0.133, table(kWineGlass)},
    {"bowl", "024_bowl", "YCB 024; mass as published, size approximate", "open, r 0.0795, h 0.053", kMetal,
     0.147, table(kBowl)},
    {"mug_with_handle", "025_mug", "YCB 025; mass as published, size approximate",
     "open, r 0.04, h 0.082, a handle to 0.0665", kMetal, 0.118, table(kMug)},
    {"sponge", "026_sponge", "YCB 026; mass as published, size approximate", "box 0.072 x 0.114 x 0.014",
     kFoam, 0.0062, table(kSponge)},
    {"skillet", "027_skillet", "YCB 027; mass as published, size approximate",
     "open, r 0.135, h 0.025, a handle to 0.3", kMetal, 0.95, table(kSkillet)},
    {"skillet_lid", "028_skillet_lid", "YCB 028; mass as published, size approximate",
     "cylinder r 0.135, h 0.01, a knob to 0.022", kGlass, 0.652, table(kSkilletLid)},
    {"plate", "029_plate", "YCB 029; mass as published, size approximate", "r 0.129, h 0.024, a rim",
     kPlastic, 0.279, table(kPlate)},
    {"fork", "030_fork", "YCB 030; mass as published, size approximate",
     "2 boxes, 4 tines, 0.198 long, 0.02 wide", kMetal, 0.034, table(kFork)},
    {"spoon", "031_spoon", "YCB 031; mass as published, size approximate",
     "box and ellipsoid, 0.195 long, 0.04 wide", kMetal, 0.03, table(kSpoon)},
    {"knife", "032_knife", "YCB 032; mass as published, size approximate",
     "box and blade, 0.215 long, 0.017 wide", kMetal, 0.031, table(kKnife)},
    {"spatula", "033_spatula", "YCB 033; mass as published, size approximate",
     "handle and blade, 0.35 long, 0.083 wide", kPlastic, 0.0515, table(kSpatula)},
};

}  // namespace

Table<Object> ycb_kitchen() {
  return table(kObjects);
}

}  // namespace rdm
