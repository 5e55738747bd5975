// The ABB IRB 4600-60/2.05: six joints, 425 kg, 60 kg at 2 m.
//
// Frames: root base_link on the floor, z up, x ahead; all link frames are parallel at q = 0. The flange's z
// is x of link_6. Kinematics and limits are those of abb_experimental (Apache-2.0); shapes are fits to its
// collision meshes, link_6 a disc that ends at the flange. Ours: the data sheet's mass shared out by mesh
// volume, moments of the shapes, efforts of about twice the static need, gains. Take its dynamics as
// plausible only.
#include "robot/tables/rows.hpp"

namespace rdm {
namespace {

using namespace rows;

constexpr RobotLink kLinks[] = {
    turning("link_1", "joint_1", -1, {0, 0, 0.495}, {}, kZ, {-3.141, 3.141},
            {136.397, {0.067, 0.0328, -0.0694}, {4.997, 5.726, 5.272, -0.394, -0.7518, -0.3285}},
            {200000, 20000, 6500, 3.054}),
    turning("link_2", "joint_2", 0, {0.175, 0, 0}, {}, kY, {-1.57, 2.617},
            {68.718, {0.0006, -0.1664, 0.412}, {6.265, 6.265, 0.6441, 0, 0, 0}},
            {200000, 20000, 6500, 3.054}),
    turning("link_3", "joint_3", 1, {0, 0, 0.9}, {}, kY, {-3.141, 1.308},
            {104.749, {0.0489, 0.0469, 0.0938}, {2.935, 3.817, 3.817, 0, 0, 0}},
            {100000, 10000, 2500, 3.054}),
    turning("link_4", "joint_4", 2, {0, 0, 0.175}, {}, kX, {-6.981, 6.981},
            {39.453, {0.7016, -0.0045, -0.0018}, {0.294, 1.787, 1.787, 0, 0, 0}}, {20000, 2000, 600, 4.363}),
    turning("link_5", "joint_5", 3, {0.96, 0, 0}, {}, kY, {-2.181, 2.094},
            {3.531, {0.0002, -0.0024, -0.0003}, {0.009567, 0.01018, 0.01018, 0, 0, 0}},
            {20000, 2000, 600, 4.363}),
    turning("link_6", "joint_6", 4, {0.135, 0, 0}, {}, kX, {-6.981, 6.981},
            {0.845, {-0.0155, -0.0002, 0.0006}, {0.001348, 0.001348, 0.001207, 0, 0, 0}},
            {10000, 1000, 300, 6.283}),
};

constexpr Color kBase = {90, 92, 96}, kArm = {222, 120, 48}, kEnd = {84, 86, 90};

constexpr RobotShape kShapes[] = {
    box(-1, "base", {0.3361, 0.2493, 0.1044}, {-0.063, 0.0007, 0.1044}, kBase),
    capsule(0, "link_1", 0.2663, 0.0913, {0.067, 0.0328, -0.0694}, kArm, {0.896398, -0.177465, 0.406173, 0}),
    capsule(1, "link_2", 0.1395, 0.4132, {0.0006, -0.1664, 0.412}, kArm),
    capsule(2, "link_3", 0.2557, 0.0681, {0.0489, 0.0469, 0.0938}, kArm, kAlongX),
    capsule(3, "link_4", 0.1251, 0.2661, {0.7016, -0.0045, -0.0018}, kArm, kAlongX),
    capsule(4, "link_5", 0.0814, 0.0053, {0.0002, -0.0024, -0.0003}, kArm, kAlongX),
    cylinder(5, "link_6", 0.0587, 0.0155, {-0.0155, -0.0002, 0.0006}, kEnd, kAlongX),
};

// Rows of kShapes that may touch.
constexpr int32_t kBaseShape = 0, kLink1 = 1, kLink2 = 2, kLink3 = 3, kLink4 = 4, kLink5 = 5, kLink6 = 6;
constexpr RobotPair kPairs[] = {
    {kBaseShape, kLink2}, {kBaseShape, kLink3}, {kBaseShape, kLink4}, {kBaseShape, kLink5},
    {kBaseShape, kLink6}, {kLink1, kLink4},     {kLink1, kLink5},     {kLink1, kLink6},
};

}  // namespace

extern constinit const Robot kAbbIrb4600 = {
    .name = "abb_irb4600",
    .help = "ABB IRB 4600-60/2.05, arm of six joints",
    .kind = RobotKind::kArm,
    .alias = "irb4600",
    .X_BR = {},
    .root = {71.307, {-0.063, 0.0007, 0.1044}, {1.736, 2.944, 4.162, 0, 0, 0}},
    .links = table(kLinks),
    .shapes = table(kShapes),
    .self_pairs = table(kPairs),
    .flange = 5,
    .X_LF = {{}, kAlongX},
};

}  // namespace rdm
