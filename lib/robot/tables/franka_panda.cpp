// The Franka Emika Panda: seven joints, 16.7 kg, 3 kg at 0.85 m.
//
// Frames: the manufacturer's, root link0 on its base plate, z up, x ahead; the flange looks along z of link7.
// Kinematics, limits, the identified masses and the capsules of self-collision are the manufacturer's
// description (franka_ros, Apache-2.0); drive gains and armature are those of its MuJoCo model (Apache-2.0).
// The source's damping of 0.003 N m s/rad is nothing beside the drives' and left out.
#include "robot/tables/rows.hpp"

namespace rdm {
namespace {

using namespace rows;

constexpr RobotLink kLinks[] = {
    turning("link1", "joint1", -1, {0, 0, 0.333}, {}, kZ, {-2.8973, 2.8973},
            {4.970684,
             {0.003875, 0.002081, -0.04762},
             {0.70337, 0.70661, 0.009117, -0.000139, 0.006772, 0.019169}},
            {4500, 450, 87, 2.175, 0.1}),
    turning("link2", "joint2", 0, {}, {-kQuarter, 0, 0}, kZ, {-1.7628, 1.7628},
            {0.646926,
             {-0.003141, -0.02872, 0.003495},
             {0.007962, 0.02811, 0.025995, -0.003925, 0.010254, 0.000704}},
            {4500, 450, 87, 2.175, 0.1}),
    turning("link3", "joint3", 1, {0, -0.316, 0}, {kQuarter, 0, 0}, kZ, {-2.8973, 2.8973},
            {3.228604,
             {0.027518, 0.039252, -0.066502},
             {0.037242, 0.036155, 0.01083, -0.004761, -0.011396, -0.012805}},
            {3500, 350, 87, 2.175, 0.1}),
    turning("link4", "joint4", 2, {0.0825, 0, 0}, {kQuarter, 0, 0}, kZ, {-3.0718, -0.0698},
            {3.587895,
             {-0.05317, 0.104419, 0.027454},
             {0.025853, 0.019552, 0.028323, 0.007796, -0.001332, 0.008641}},
            {3500, 350, 87, 2.175, 0.1}),
    turning("link5", "joint5", 3, {-0.0825, 0.384, 0}, {-kQuarter, 0, 0}, kZ, {-2.8973, 2.8973},
            {1.225946,
             {-0.011953, 0.041065, -0.038437},
             {0.035549, 0.029474, 0.008627, -0.002117, -0.004037, 0.000229}},
            {2000, 200, 12, 2.61, 0.1}),
    turning("link6", "joint6", 4, {}, {kQuarter, 0, 0}, kZ, {-0.0175, 3.7525},
            {1.666555,
             {0.060149, -0.014117, -0.010517},
             {0.001964, 0.004354, 0.005433, 0.000109, -0.001158, 0.000341}},
            {2000, 200, 12, 2.61, 0.1}),
    turning("link7", "joint7", 5, {0.088, 0, 0}, {kQuarter, 0, 0}, kZ, {-2.8973, 2.8973},
            {0.735522,
             {0.010517, -0.004252, 0.061597},
             {0.012516, 0.010027, 0.004815, -0.000428, -0.001196, -0.000741}},
            {2000, 200, 12, 2.61, 0.1}),
};

constexpr Color kBase = {235, 235, 232}, kArm = {225, 226, 224}, kEnd = {150, 154, 158};

constexpr RobotShape kShapes[] = {
    capsule(-1, "base", 0.06, 0.015, {-0.075, 0, 0.06}, kBase, kAlongX),
    capsule(0, "link1", 0.06, 0.1415, {0, 0, -0.1915}, kArm),
    capsule(1, "link2", 0.06, 0.06, {}, kArm),
    capsule(2, "link3", 0.06, 0.075, {0, 0, -0.145}, kArm),
    capsule(3, "link4", 0.06, 0.06, {}, kArm),
    capsule(4, "link5", 0.06, 0.05, {0, 0, -0.26}, kArm),
    capsule(4, "link5_2", 0.025, 0.07, {0, 0.08, -0.13}, kArm),
    capsule(5, "link6", 0.05, 0.04, {0, 0, -0.03}, kArm),
    capsule(6, "link7", 0.04, 0.07, {0, 0, 0.01}, kEnd),
    capsule(6, "link7_2", 0.03, 0.005, {0.0424264069, 0.0424264069, 0.082}, kEnd,
            {0.653281, -0.270598, 0.653281, 0.270598}),
};

// Rows of kShapes that may touch.
constexpr int32_t kBaseShape = 0, kLink1 = 1, kLink2 = 2, kLink5 = 5, kLink52 = 6, kLink6 = 7, kLink7 = 8,
                  kLink72 = 9;
constexpr RobotPair kPairs[] = {
    {kBaseShape, kLink5},  {kBaseShape, kLink52}, {kBaseShape, kLink6}, {kBaseShape, kLink7},
    {kBaseShape, kLink72}, {kLink1, kLink5},      {kLink1, kLink52},    {kLink1, kLink6},
    {kLink1, kLink7},      {kLink1, kLink72},     {kLink2, kLink52},    {kLink2, kLink6},
    {kLink2, kLink7},      {kLink2, kLink72},     {kLink52, kLink72},
};

constexpr double kHome[] = {0, -kQuarter / 2, 0, -1.5 * kQuarter, 0, kQuarter, kQuarter / 2};

}  // namespace

extern constinit const Robot kFrankaPanda = {
    .name = "franka_panda",
    .help = "Franka Emika Panda, arm of seven joints",
    .kind = RobotKind::kArm,
    .alias = "panda",
    .X_BR = {},
    .root = {0.629769,
             {-0.041018, -0.00014, 0.049974},
             {0.00315, 0.00388, 0.004285, 8.2904e-7, 0.00015, 8.2299e-6}},
    .links = table(kLinks),
    .shapes = table(kShapes),
    .self_pairs = table(kPairs),
    .home = table(kHome),
    .flange = 6,
    .X_LF = {{0, 0, 0.107}, {}},
};

}  // namespace rdm
