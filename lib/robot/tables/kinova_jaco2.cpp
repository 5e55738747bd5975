// The Kinova JACO2 with the curved wrist (j2n6s300) without its gripper: six joints, 3.8 kg.
//
// Frames: the manufacturer's, root link_base, z up; joint angles of 0 are outside the limits of joints 2
// and 3. Kinematics, limits, masses and cylinder moments are those of kinova-ros (BSD-3-Clause), whose
// continuous joints end at 2 pi here; shapes are fits to its meshes. Ours: moments of links 4 and 5 (the
// source's do not belong to their mass), a disc of 0.1 kg in the gripper's place, the flange's height, gains.
#include "robot/tables/rows.hpp"

namespace rdm {
namespace {

using namespace rows;

constexpr RobotLink kLinks[] = {
    turning("link_1", "joint_1", -1, {0, 0, 0.15675}, {0, kPi, 0}, kZ, {-6.283185, 6.283185},
            {0.7477, {0, -0.002, -0.0605}, {0.001520323, 0.001520323, 0.00059816, 0, 0, 0}},
            {800, 80, 40, 0.628319}),
    turning("link_2", "joint_2", 0, {0, 0.0016, -0.11875}, {-kQuarter, 0, kPi}, kZ, {0.820305, 5.462881},
            {0.99, {0, -0.2065, -0.01}, {0.01050225, 0.000792, 0.01050225, 0, 0, 0}},
            {800, 80, 80, 0.628319}),
    turning("link_3", "joint_3", 1, {0, -0.41, 0}, {0, kPi, 0}, kZ, {0.331613, 5.951573},
            {0.6763, {0, 0.081, -0.0086}, {0.00142023, 0.000304335, 0.00142023, 0, 0, 0}},
            {600, 60, 40, 0.628319}),
    turning(
        "link_4", "joint_4", 2, {0, 0.2073, -0.0114}, {-kQuarter, 0, kPi}, kZ, {-6.283185, 6.283185},
        {0.426367, {0, -0.037, -0.0642}, {0.0004612, 0.0003975, 0.0002711, -3.822e-7, -6.601e-7, -0.00011}},
        {200, 20, 20, 0.837758}),
    turning(
        "link_5", "joint_5", 3, {0, -0.03703, -0.06414}, {kPi / 3, 0, kPi}, kZ, {-6.283185, 6.283185},
        {0.426367, {0, -0.037, -0.0642}, {0.0004612, 0.0003975, 0.0002711, -3.822e-7, -6.601e-7, -0.00011}},
        {200, 20, 20, 0.837758}),
    turning("link_6", "joint_6", 4, {0, -0.03703, -0.06414}, {kPi / 3, 0, kPi}, kZ, {-6.283185, 6.283185},
            {0.1, {0, 0, -0.004}, {4.137e-5, 4.137e-5, 4.014e-5, 0, 0, 0}}, {200, 20, 20, 0.837758}),
};

constexpr Color kBase = {52, 54, 58}, kArm = {64, 66, 72}, kEnd = {176, 178, 180};

constexpr RobotShape kShapes[] = {
    capsule(-1, "base", 0.0434, 0.0568, {0, 0.0022, 0.0823}, kBase),
    capsule(0, "link_1", 0.042, 0.055, {-0.0001, -0.0089, -0.066}, kArm, {0.996505, -0.083505, 0.002234, 0}),
    box(1, "link_2", {0.0409, 0.2455, 0.0214}, {0.0001, -0.2048, -0.0214}, kArm),
    box(2, "link_3", {0.0411, 0.0616, 0.0214}, {0, 0.0205, -0.0214}, kArm),
    capsule(2, "link_3_2", 0.0316, 0.0483, {0.0002, 0.1533, -0.0116}, kArm, kAlongY),
    capsule(3, "link_4", 0.0327, 0.0266, {0, -0.0133, -0.0351}, kArm, {0.965765, -0.259412, 0.001556, 0}),
    capsule(4, "link_5", 0.0327, 0.0266, {0, -0.0133, -0.0351}, kArm, {0.965765, -0.259412, 0.001556, 0}),
    cylinder(5, "link_6", 0.0325, 0.0023, {0, 0, -0.004}, kEnd),
};

// Rows of kShapes that may touch.
constexpr int32_t kBaseShape = 0, kLink1 = 1, kLink2 = 2, kLink4 = 5, kLink5 = 6, kLink6 = 7;
constexpr RobotPair kPairs[] = {
    {kBaseShape, kLink4}, {kBaseShape, kLink5}, {kBaseShape, kLink6}, {kLink1, kLink5},
    {kLink1, kLink6},     {kLink2, kLink5},     {kLink2, kLink6},
};

constexpr double kHome[] = {4.8046852, 2.92482, 1.002, 4.2031852, 1.4458, 1.3233};

}  // namespace

extern constinit const Robot kKinovaJaco2 = {
    .name = "kinova_jaco2",
    .help = "Kinova JACO2 with the curved wrist, arm of six joints",
    .kind = RobotKind::kArm,
    .alias = "jaco",
    .X_BR = {},
    .root = {0.46784, {0, 0, 0.1255}, {0.0009512747, 0.0009512747, 0.000374272, 0, 0, 0}},
    .links = table(kLinks),
    .shapes = table(kShapes),
    .self_pairs = table(kPairs),
    .home = table(kHome),
    .flange = 5,
    .X_LF = {{0, 0, -0.0063}, {0, kRoot, kRoot, 0}},
};

}  // namespace rdm
