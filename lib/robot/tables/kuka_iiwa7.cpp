// The KUKA LBR iiwa 7 R800: seven joints, 7 kg at 0.8 m.
//
// Frames: root link_0 on its base, z up, x ahead; the flange is bare (the source's media flange is 26 mm
// higher, where the paper fixes its hand). Kinematics, limits, masses and moments are those of iiwa_stack
// (BSD-2-Clause); efforts are the manufacturer's figures and velocities those of dex-urdf (MIT), as the
// source holds placeholders; gains are those of the iiwa 14 in MuJoCo (BSD-3-Clause). Shapes are fits to the
// meshes, link_7 a disc that ends at the flange. The source's damping of 0.5 N m s/rad is in the drives' 200.
#include "robot/tables/rows.hpp"

namespace rdm {
namespace {

using namespace rows;

constexpr RobotLink kLinks[] = {
    turning("link_1", "joint_1", -1, {0, 0, 0.15}, {}, kZ, {-2.96706, 2.96706},
            {3.4525, {0, -0.03, 0.12}, {0.02183, 0.007703, 0.02083, 0, 0, -0.003887}},
            {2000, 200, 176, 1.7104}),
    turning("link_2", "joint_2", 0, {0, 0, 0.19}, {kQuarter, 0, kPi}, kZ, {-2.094395, 2.094395},
            {3.4821, {0.0003, 0.059, 0.042}, {0.02076, 0.02179, 0.00779, 0, -0.003626, 0}},
            {2000, 200, 176, 1.7104}),
    turning("link_3", "joint_3", 1, {0, 0.21, 0}, {kQuarter, 0, kPi}, kZ, {-2.96706, 2.96706},
            {4.05623, {0, 0.03, 0.13}, {0.03204, 0.00972, 0.03042, 0, 0, 0.006227}},
            {2000, 200, 110, 1.7453}),
    turning("link_4", "joint_4", 2, {0, 0, 0.19}, {kQuarter, 0, 0}, kZ, {-2.094395, 2.094395},
            {3.4822, {0, 0.067, 0.034}, {0.02178, 0.02075, 0.007785, 0, 0, -0.003625}},
            {2000, 200, 110, 2.2689}),
    turning("link_5", "joint_5", 3, {0, 0.21, 0}, {-kQuarter, kPi, 0}, kZ, {-2.96706, 2.96706},
            {2.1633, {0.0001, 0.021, 0.076}, {0.01287, 0.005708, 0.01112, 0, 0, -0.003946}},
            {2000, 200, 110, 2.4435}),
    turning("link_6", "joint_6", 4, {0, 0.0607, 0.19}, {kQuarter, 0, 0}, kZ, {-2.094395, 2.094395},
            {2.3466, {0, 0.0006, 0.0004}, {0.006509, 0.006259, 0.004527, 0, 0, 0.00031891}},
            {2000, 200, 40, 3.1416}),
    turning("link_7", "joint_7", 5, {0, 0.081, 0.0607}, {-kQuarter, kPi, 0}, kZ, {-3.054326, 3.054326},
            {3.129, {0, 0, 0.02}, {0.01464, 0.01465, 0.002872, 0.0005912, 0, 0}}, {2000, 200, 40, 3.1416}),
};

constexpr Color kBase = {96, 98, 102}, kArm = {206, 208, 210}, kEnd = {222, 128, 56};

constexpr RobotShape kShapes[] = {
    capsule(-1, "base", 0.1096, 0.0226, {-0.0102, -0.0008, 0.0624}, kBase, kAlongX),
    capsule(0, "link_1", 0.0724, 0.0833, {-0.0005, -0.0277, 0.116}, kArm, {0.992068, 0.125689, 0.001627, 0}),
    capsule(1, "link_2", 0.0725, 0.084, {-0.0003, 0.0753, 0.0268}, kArm, {0.609759, -0.792575, -0.004423, 0}),
    capsule(2, "link_3", 0.0717, 0.0982, {0.0004, 0.0253, 0.0999}, kArm, {0.992892, -0.118996, 0.002267, 0}),
    capsule(3, "link_4", 0.0722, 0.0856, {-0.0009, 0.0761, 0.0274}, kArm, {0.61374, -0.789403, -0.012892, 0}),
    capsule(4, "link_5", 0.07, 0.0261, {-0.0009, 0.0177, 0.0182}, kArm, {0.89933, -0.436523, -0.025564, 0}),
    box(4, "link_5_2", {0.051, 0.0237, 0.0686}, {0.0002, 0.0751, 0.1713}, kArm),
    capsule(5, "link_6", 0.0712, 0.0291, {-0.0006, -0.0011, 0.057}, kArm, kAlongY),
    cylinder(6, "link_7", 0.0545, 0.0213, {0.0004, 0.0015, 0.0237}, kEnd),
};

// Rows of kShapes that may touch.
constexpr int32_t kBaseShape = 0, kLink5 = 5, kLink52 = 6, kLink6 = 7, kLink7 = 8;
constexpr RobotPair kPairs[] = {
    {kBaseShape, kLink5},
    {kBaseShape, kLink52},
    {kBaseShape, kLink6},
    {kBaseShape, kLink7},
};

constexpr double kHome[] = {0, 0.785398, 0, -1.5708, 0, 0, 0};

}  // namespace

extern constinit const Robot kKukaIiwa7 = {
    .name = "kuka_iiwa7",
    .help = "KUKA LBR iiwa 7 R800, arm of seven joints",
    .kind = RobotKind::kArm,
    .alias = "iiwa",
    .X_BR = {},
    .root = {5, {-0.1, 0, 0.07}, {0.05, 0.06, 0.03, 0, 0, 0}},
    .links = table(kLinks),
    .shapes = table(kShapes),
    .self_pairs = table(kPairs),
    .home = table(kHome),
    .flange = 6,
    .X_LF = {{0, 0, 0.045}, {}},
};

}  // namespace rdm
