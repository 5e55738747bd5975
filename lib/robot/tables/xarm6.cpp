// The UFACTORY xArm 6: six joints, 10.5 kg, 5 kg at 0.7 m.
//
// Frames: the manufacturer's, root link_base, z up, x ahead. Kinematics and limits are those of xarm_ros
// (BSD-3-Clause), masses and moments those of the paper's model of it; gains are those of the xArm 7 in
// MuJoCo (BSD-3-Clause), of the same actuators. Ours: moments of link2 and link3 by their shapes (a principal
// moment of the source exceeds the sum of the others), the shapes, which are fits to the meshes. The source's
// damping of 1 N m s/rad is in the drives' 80 to 150.
#include "robot/tables/rows.hpp"

namespace rdm {
namespace {

using namespace rows;

constexpr RobotLink kLinks[] = {
    turning("link1", "joint1", -1, {0, 0, 0.267}, {}, kZ, {-2 * kPi, 2 * kPi},
            {2.16,
             {-0.002, 0.02692, -0.01332},
             {0.00539427, 0.0048979, 0.00311573, 1.095e-5, 1.635e-6, 0.000793}},
            {1500, 150, 50, 3.14, 0, 1}),
    turning("link2", "joint2", 0, {}, {-kQuarter, 0, 0}, kZ, {-2.059, 2.0944},
            {1.71, {0.03531, -0.21398, 0.03386}, {0.01779, 0.00604, 0.01686, 0.002354, 0.0006715, -0.003632}},
            {1500, 150, 50, 3.14, 0, 1}),
    turning(
        "link3", "joint3", 1, {0.0535, -0.2845, 0}, {}, kZ, {-3.927, 0.19198},
        {1.384, {0.06781, 0.10749, 0.01457}, {0.006255, 0.004109, 0.005843, -0.001617, 0.0009145, 0.001661}},
        {1000, 100, 32, 3.14, 0, 1}),
    turning("link4", "joint4", 2, {0.0775, 0.3425, 0}, {-kQuarter, 0, 0}, kZ, {-2 * kPi, 2 * kPi},
            {1.115,
             {-0.00021, 0.02578, -0.02538},
             {0.00439263, 0.0040077, 0.00110321, 5.028e-5, 1.374e-5, 0.00045338}},
            {1000, 100, 32, 3.14, 0, 1}),
    turning("link5", "joint5", 3, {}, {kQuarter, 0, 0}, kZ, {-1.69297, kPi},
            {1.275,
             {0.05428, 0.01781, 0.00543},
             {0.001202758, 0.0022876, 0.0026866, 0.000492428, -0.00039147, -0.0001235}},
            {1000, 100, 32, 3.14, 0, 1}),
    turning("link6", "joint6", 4, {0.076, 0.097, 0}, {-kQuarter, 0, 0}, kZ, {-2 * kPi, 2 * kPi},
            {0.1096, {0, 0.00064, -0.00952}, {4.5293e-5, 4.8111e-5, 7.9715e-5, 0, 0, 0}},
            {800, 80, 20, 3.14, 0, 1}),
};

constexpr Color kBase = {228, 228, 226}, kArm = {236, 236, 234}, kEnd = {120, 124, 130};

constexpr RobotShape kShapes[] = {
    capsule(-1, "base", 0.0693, 0.0417, {-0.01, 0.0003, 0.0608}, kBase),
    box(0, "link1", {0.0481, 0.0656, 0.0799}, {-0.0001, 0.0097, -0.0321}, kArm),
    capsule(1, "link2", 0.074, 0.0998, {0.0189, -0.1782, 0.0202}, kArm, {0.773523, -0.619384, -0.134263, 0}),
    box(1, "link2_2", {0.0472, 0.1003, 0.0187}, {-0.0001, -0.0539, 0.1001}, kArm),
    capsule(2, "link3", 0.0498, 0.0367, {0.0775, 0.1132, 0.0078}, kArm, kAlongY),
    capsule(2, "link3_2", 0.0439, 0.0568, {0.04, 0.0437, 0.0749}, kArm, {0.690867, -0.530997, 0.490658, 0}),
    capsule(3, "link4", 0.0434, 0.0471, {0.0004, 0.0315, -0.122}, kArm, {0.927754, -0.37314, 0.006243, 0}),
    box(3, "link4_2", {0.0375, 0.0408, 0.0417}, {-0.0002, 0.0453, -0.0043}, kArm),
    capsule(4, "link5", 0.0403, 0.0092, {0.0022, 0, 0.0185}, kArm, kAlongX),
    capsule(4, "link5_2", 0.0438, 0.0304, {0.072, 0.0201, 0.0051}, kArm, kAlongY),
    box(5, "link6", {0.0374, 0.0445, 0.014}, {0, -0.0071, -0.014}, kEnd),
};

// Rows of kShapes that may touch.
constexpr int32_t kBaseShape = 0, kLink1 = 1, kLink2 = 2, kLink22 = 3, kLink3 = 4, kLink4 = 6, kLink42 = 7,
                  kLink5 = 8, kLink52 = 9, kLink6 = 10;
constexpr RobotPair kPairs[] = {
    {kBaseShape, kLink2}, {kBaseShape, kLink3},  {kBaseShape, kLink4}, {kBaseShape, kLink42},
    {kBaseShape, kLink5}, {kBaseShape, kLink52}, {kBaseShape, kLink6}, {kLink1, kLink3},
    {kLink1, kLink4},     {kLink1, kLink42},     {kLink1, kLink5},     {kLink1, kLink52},
    {kLink1, kLink6},     {kLink2, kLink4},      {kLink2, kLink52},    {kLink2, kLink6},
    {kLink22, kLink4},    {kLink22, kLink42},    {kLink22, kLink52},   {kLink22, kLink6},
    {kLink4, kLink6},
};

}  // namespace

extern constinit const Robot kXarm6 = {
    .name = "xarm6",
    .help = "UFACTORY xArm 6, arm of six joints",
    .kind = RobotKind::kArm,
    .alias = "xarm",
    .X_BR = {},
    .root = {2.7, {0, 0, 0.09103}, {0.00494875, 0.00494174, 0.002219, -3.5e-6, 1.25e-5, 1.67e-6}},
    .links = table(kLinks),
    .shapes = table(kShapes),
    .self_pairs = table(kPairs),
    .flange = 5,
};

}  // namespace rdm
