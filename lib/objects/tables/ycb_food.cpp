// YCB 001 to 018: food, the fruits of hollow plastic.
#include "objects/objects.hpp"
#include "objects/tables/rows.hpp"

namespace rdm {
namespace {

using namespace object_rows;

constexpr Color kYellow = {235, 205, 70}, kBrown = {120, 90, 50};

constexpr ObjectShape kChipsCan[] = {cylinder(0.0375, 0.25, {}, {190, 40, 40})};
constexpr ObjectShape kMasterChefCan[] = {cylinder(0.051, 0.139, {}, {40, 60, 140})};
constexpr ObjectShape kSugarBox[] = {box(0.038, 0.089, 0.175, {}, {230, 200, 60})};
constexpr ObjectShape kTunaFishCan[] = {cylinder(0.0425, 0.033, {}, {60, 120, 180})};
constexpr ObjectShape kPuddingBox[] = {box(0.035, 0.11, 0.089, {}, {130, 80, 60})};
constexpr ObjectShape kGelatinBox[] = {box(0.028, 0.085, 0.073, {}, {200, 70, 80})};

// An arc in its plane, 36 mm thick in the middle, its ends 190 mm apart.
constexpr ObjectShape kBanana[] = {
    rod({-0.08, 0.016, 0}, {-0.052, -0.012, 0}, 0.0145, kYellow),
    rod({-0.052, -0.012, 0}, {-0.018, -0.0265, 0}, 0.0175, kYellow),
    rod({-0.018, -0.0265, 0}, {0.018, -0.0265, 0}, 0.018, kYellow),
    rod({0.018, -0.0265, 0}, {0.052, -0.012, 0}, 0.0175, kYellow),
    rod({0.052, -0.012, 0}, {0.078, 0.014, 0}, 0.0145, kYellow),
    rod({0.078, 0.014, 0}, {0.09, 0.032, 0}, 0.0055, kBrown),
};
constexpr Turned<4> kStrawberryForm({{0.006, -0.0275}, {0.0175, -0.008}, {0.0219, 0.0135}, {0.013, 0.0275}});
constexpr ObjectShape kStrawberry[] = {hull(kStrawberryForm.points, {}, {200, 40, 50})};
constexpr ObjectShape kApple[] = {sphere(0.0375, {}, {190, 40, 40})};
constexpr ObjectShape kLemon[] = {ellipsoid(0.027, 0.027, 0.034, {}, {240, 220, 60})};
constexpr ObjectShape kPeach[] = {sphere(0.0295, {}, {235, 150, 90})};
constexpr Turned<4> kPearForm({{0.02, 0}, {0.0331, 0.03}, {0.0215, 0.07}, {0.011, 0.1}});
constexpr ObjectShape kPear[] = {hull(kPearForm.points, {}, {180, 200, 80})};
constexpr ObjectShape kOrange[] = {sphere(0.0365, {}, {240, 140, 30})};
constexpr ObjectShape kPlum[] = {sphere(0.026, {}, {110, 40, 80})};

constexpr Object kObjects[] = {
    {"chips_can", "001_chips_can", "YCB 001; mass as published, size approximate",
     "cylinder r 0.0375, h 0.25", kCardboard, 0.205, table(kChipsCan)},
    {"master_chef_can", "002_master_chef_can", "YCB 002; mass as published, size approximate",
     "cylinder r 0.051, h 0.139", kMetal, 0.414, table(kMasterChefCan)},
    {"sugar_box", "004_sugar_box", "YCB 004; mass as published, size approximate",
     "box 0.038 x 0.089 x 0.175", kCardboard, 0.514, table(kSugarBox)},
    {"tuna_fish_can", "007_tuna_fish_can", "YCB 007; mass as published, size approximate",
     "cylinder r 0.0425, h 0.033", kMetal, 0.171, table(kTunaFishCan)},
    {"pudding_box", "008_pudding_box", "YCB 008; mass as published, size approximate",
     "box 0.035 x 0.11 x 0.089", kCardboard, 0.187, table(kPuddingBox)},
    {"gelatin_box", "009_gelatin_box", "YCB 009; mass as published, size approximate",
     "box 0.028 x 0.085 x 0.073", kCardboard, 0.097, table(kGelatinBox)},
    {"banana", "011_banana", "YCB 011; mass as published, size approximate",
     "6 capsules along an arc, 0.19 long, 0.036 thick", kPlastic, 0.066, table(kBanana)},
    {"strawberry", "012_strawberry", "YCB 012; mass as published, size approximate",
     "hull of 4 octagons, 0.0438 wide, 0.055 high", kPlastic, 0.018, table(kStrawberry)},
    {"apple", "013_apple", "YCB 013; mass as published, size approximate", "sphere r 0.0375", kPlastic, 0.068,
     table(kApple)},
    {"lemon", "014_lemon", "YCB 014; mass as published, size approximate",
     "ellipsoid 0.027 x 0.027 x 0.034 (half axes)", kPlastic, 0.029, table(kLemon)},
    {"peach", "015_peach", "YCB 015; mass as published, size approximate", "sphere r 0.0295", kPlastic, 0.033,
     table(kPeach)},
    {"pear", "016_pear", "YCB 016; mass as published, size approximate",
     "hull of 4 octagons, 0.0662 wide, 0.1 high", kPlastic, 0.049, table(kPear)},
    {"orange", "017_orange", "YCB 017; mass as published, size approximate", "sphere r 0.0365", kPlastic,
     0.047, table(kOrange)},
    {"plum", "018_plum", "YCB 018; mass as published, size approximate", "sphere r 0.026", kPlastic, 0.025,
     table(kPlum)},
};

}  // namespace

Table<Object> ycb_food() {
  return table(kObjects);
}

}  // namespace rdm
