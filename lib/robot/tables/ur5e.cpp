// The Universal Robots UR5e: six joints, 21.7 kg, 5 kg at 0.85 m.
//
// Frames: the manufacturer's, root base_link_inertia, z up, which is the controller's base frame (base_link
// turned by half about z): at home the arm looks along y. Kinematics, limits, masses and moments are those of
// the manufacturer's description (BSD-3-Clause); gains and armature those of its MuJoCo model (BSD-3-Clause).
// Shapes are fits to the meshes of the former, the end link's a disc that ends at the flange. Ours: ten
// times the source's damping of the wrists, with which one that comes free would turn at 100 rad/s.
#include "robot/tables/rows.hpp"

namespace rdm {
namespace {

using namespace rows;

constexpr RobotLink kLinks[] = {
    turning("shoulder_link", "shoulder_pan_joint", -1, {0, 0, 0.1625}, {}, kZ, {-6.283185, 6.283185},
            {3.761, {0, -0.00193, -0.02561}, {0.0102675, 0.0102675, 0.00666, 0, 0, 0}},
            {3500, 200, 150, 3.141593, 0.1}),
    turning("upper_arm_link", "shoulder_lift_joint", 0, {}, {kQuarter, 0, 0}, kZ, {-6.283185, 6.283185},
            {8.058, {-0.2125, 0, 0.11336}, {0.0151074, 0.1338858, 0.1338858, 0, 0, 0}},
            {3500, 200, 150, 3.141593, 0.1}),
    turning("forearm_link", "elbow_joint", 1, {-0.425, 0, 0}, {}, kZ, {-3.141593, 3.141593},
            {2.846, {-0.2422, 0, 0.0265}, {0.004095, 0.03120937, 0.03120937, 0, 0, 0}},
            {3500, 200, 150, 3.141593, 0.1}),
    turning("wrist_1_link", "wrist_1_joint", 2, {-0.3922, 0, 0.1333}, {}, kZ, {-6.283185, 6.283185},
            {1.37, {0, -0.01634, -0.0018}, {0.0025599, 0.0025599, 0.0021942, 0, 0, 0}},
            {3000, 150, 28, 3.141593, 0.1}),
    turning("wrist_2_link", "wrist_2_joint", 3, {0, -0.0997, 0}, {kQuarter, 0, 0}, kZ, {-6.283185, 6.283185},
            {1.3, {0, 0.01634, -0.0018}, {0.0025599, 0.0025599, 0.0021942, 0, 0, 0}},
            {3000, 150, 28, 3.141593, 0.1}),
    turning("wrist_3_link", "wrist_3_joint", 4, {0, 0.0996, 0}, {kQuarter, kPi, kPi}, kZ,
            {-6.283185, 6.283185},
            {0.365, {0, 0, -0.001159}, {9.890414e-5, 9.890414e-5, 0.0001321172, 0, 0, 0}},
            {3000, 150, 28, 3.141593, 0.1}),
};

constexpr Color kBase = {150, 154, 158}, kArm = {198, 204, 208}, kEnd = {92, 112, 132};

constexpr RobotShape kShapes[] = {
    capsule(-1, "base", 0.0787, 0.0079, {0.0005, -0.0004, 0.039}, kBase, kAlongY),
    box(0, "shoulder_link", {0.0597, 0.0669, 0.0673}, {0, -0.0075, 0.0034}, kArm),
    box(1, "upper_arm_link", {0.271, 0.0601, 0.0748}, {-0.2122, 0, 0.135}, kArm),
    capsule(2, "forearm_link", 0.0667, 0.1854, {-0.1872, -0.0003, 0.0147}, kArm, kAlongX),
    box(3, "wrist_1_link", {0.039, 0.0549, 0.0558}, {0.0001, 0.0014, -0.0177}, kArm),
    box(4, "wrist_2_link", {0.039, 0.0549, 0.0424}, {-0.0001, -0.0018, -0.0037}, kArm),
    cylinder(5, "wrist_3_link", 0.0396, 0.0255, {0.0002, 0.0003, -0.0255}, kEnd),
};

// Rows of kShapes that may touch.
constexpr int32_t kBaseShape = 0, kShoulderLink = 1, kUpperArmLink = 2, kForearmLink = 3, kWrist1Link = 4,
                  kWrist2Link = 5, kWrist3Link = 6;
constexpr RobotPair kPairs[] = {
    {kBaseShape, kForearmLink},   {kBaseShape, kWrist1Link},     {kBaseShape, kWrist2Link},
    {kBaseShape, kWrist3Link},    {kShoulderLink, kForearmLink}, {kShoulderLink, kWrist1Link},
    {kShoulderLink, kWrist2Link}, {kShoulderLink, kWrist3Link},  {kUpperArmLink, kWrist1Link},
    {kUpperArmLink, kWrist2Link}, {kUpperArmLink, kWrist3Link},  {kForearmLink, kWrist3Link},
};

constexpr double kHome[] = {-kQuarter, -kQuarter, kQuarter, -kQuarter, -kQuarter, 0};

}  // namespace

extern constinit const Robot kUr5e = {
    .name = "ur5e",
    .help = "Universal Robots UR5e, arm of six joints",
    .kind = RobotKind::kArm,
    .X_BR = {},
    .root = {4, {}, {0.004433333, 0.004433333, 0.0072, 0, 0, 0}},
    .links = table(kLinks),
    .shapes = table(kShapes),
    .self_pairs = table(kPairs),
    .home = table(kHome),
    .flange = 5,
};

}  // namespace rdm
