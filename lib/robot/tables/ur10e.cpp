// The Universal Robots UR10e: six joints, 33 kg, 10 kg at 1.3 m.
//
// Frames: the manufacturer's, root base_link_inertia, z up, which is the controller's base frame (base_link
// turned by half about z): at home the arm looks along y. Kinematics, limits, masses and moments are those of
// the manufacturer's description (BSD-3-Clause); gains and armature those of its MuJoCo model (BSD-3-Clause).
// Shapes are fits to the meshes of the former, the end link's a disc that ends at the flange. Ours: five
// times the source's damping of the wrists, with which one that comes free would turn at 100 rad/s.
#include "robot/tables/rows.hpp"

namespace rdm {
namespace {

using namespace rows;

constexpr RobotLink kLinks[] = {
    turning("shoulder_link", "shoulder_pan_joint", -1, {0, 0, 0.1807}, {}, kZ, {-6.283185, 6.283185},
            {7.369, {0.021, -0.027, 0}, {0.03408, 0.02156, 0.03529, 0.00425, 2e-5, -8e-5}},
            {4000, 350, 330, 2.094395, 0.1}),
    turning("upper_arm_link", "shoulder_lift_joint", 0, {}, {kQuarter, 0, 0}, kZ, {-6.283185, 6.283185},
            {13.051, {-0.2327, 0, 0.158}, {0.02814, 0.77068, 0.76943, 5e-5, -0.01561, 2e-5}},
            {4000, 350, 330, 2.094395, 0.1}),
    turning("forearm_link", "elbow_joint", 1, {-0.6127, 0, 0}, {}, kZ, {-3.141593, 3.141593},
            {3.989, {-0.33155, 0, 0.068}, {0.01014, 0.30928, 0.30646, 8e-5, 0.00916, 0}},
            {3500, 200, 150, 3.141593, 0.1}),
    turning("wrist_1_link", "wrist_1_joint", 2, {-0.57155, 0, 0.17415}, {}, kZ, {-6.283185, 6.283185},
            {2.1, {0, -0.018, 0.007}, {0.00296, 0.00258, 0.00222, 0, -1e-5, 0.00024}},
            {3200, 160, 54, 3.141593, 0.1}),
    turning("wrist_2_link", "wrist_2_joint", 3, {0, -0.11985, 0}, {kQuarter, 0, 0}, kZ, {-6.283185, 6.283185},
            {1.98, {0, 0.018, -0.007}, {0.00296, 0.00258, 0.00222, 0, 1e-5, 0.00024}},
            {3200, 160, 54, 3.141593, 0.1}),
    turning("wrist_3_link", "wrist_3_joint", 4, {0, 0.11655, 0}, {kQuarter, kPi, kPi}, kZ,
            {-6.283185, 6.283185}, {0.615, {0, 0, -0.026}, {0.0004, 0.00041, 0.00034, 0, 0, 0}},
            {3200, 160, 54, 3.141593, 0.1}),
};

constexpr Color kBase = {150, 154, 158}, kArm = {198, 204, 208}, kEnd = {92, 112, 132};

constexpr RobotShape kShapes[] = {
    capsule(-1, "base", 0.0943, 0.0083, {-0.0004, 0.0002, 0.0356}, kBase, kAlongX),
    box(0, "shoulder_link", {0.0761, 0.0852, 0.0873}, {0, -0.0094, 0.0056}, kArm),
    box(1, "upper_arm_link", {0.3733, 0.0757, 0.0867}, {-0.2976, 0, 0.1815}, kArm),
    capsule(2, "forearm_link", 0.0721, 0.2687, {-0.2845, 0.0002, 0.0494}, kArm, kAlongX),
    box(3, "wrist_1_link", {0.0466, 0.0618, 0.0574}, {0, -0.0048, -0.0108}, kArm),
    capsule(4, "wrist_2_link", 0.0563, 0.0284, {-0.0002, 0.0123, -0.0106}, kArm, kAlongY),
    cylinder(5, "wrist_3_link", 0.0463, 0.0284, {0, -0.0001, -0.0284}, kEnd),
};

// Rows of kShapes that may touch.
constexpr int32_t kBaseShape = 0, kShoulderLink = 1, kUpperArmLink = 2, kForearmLink = 3, kWrist1Link = 4,
                  kWrist2Link = 5, kWrist3Link = 6;
constexpr RobotPair kPairs[] = {
    {kBaseShape, kForearmLink},   {kBaseShape, kWrist1Link},     {kBaseShape, kWrist2Link},
    {kBaseShape, kWrist3Link},    {kShoulderLink, kForearmLink}, {kShoulderLink, kWrist2Link},
    {kShoulderLink, kWrist3Link}, {kUpperArmLink, kWrist1Link},  {kUpperArmLink, kWrist2Link},
    {kUpperArmLink, kWrist3Link}, {kForearmLink, kWrist3Link},
};

constexpr double kHome[] = {-kQuarter, -kQuarter, kQuarter, -kQuarter, -kQuarter, 0};

}  // namespace

extern constinit const Robot kUr10e = {
    .name = "ur10e",
    .help = "Universal Robots UR10e, arm of six joints",
    .kind = RobotKind::kArm,
    .X_BR = {},
    .root = {4, {}, {0.006106333, 0.006106333, 0.01125, 0, 0, 0}},
    .links = table(kLinks),
    .shapes = table(kShapes),
    .self_pairs = table(kPairs),
    .home = table(kHome),
    .flange = 5,
};

}  // namespace rdm
