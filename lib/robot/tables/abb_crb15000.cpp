// The ABB CRB 15000-5/0.95 "GoFa": six joints, 28 kg, 5 kg at 0.95 m.
//
// Frames: root base_link, z up, x ahead; all link frames are parallel at q = 0. The flange's z is x of
// link_6. Kinematics and limits are those of abb_experimental (Apache-2.0); shapes are fits to its collision
// meshes. Ours: the data sheet's mass shared out by mesh volume, moments of the shapes, efforts of about
// twice the static need, gains. Take its dynamics as plausible only.
#include "robot/tables/rows.hpp"

namespace rdm {
namespace {

using namespace rows;

constexpr RobotLink kLinks[] = {
    turning("link_1", "joint_1", -1, {0, 0, 0.265}, {}, kZ, {-kPi, kPi},
            {3.189, {0, 0.0134, -0.0065}, {0.0155, 0.009508, 0.01459, 0, 0, 0}}, {3000, 300, 330, 2.181662}),
    turning("link_2", "joint_2", 0, {}, {}, kY, {-kPi, kPi},
            {6.319, {0, -0.129, 0.222}, {0.1758, 0.181, 0.01299, 0, 0, 0}}, {3000, 300, 330, 2.181662}),
    turning("link_3", "joint_3", 1, {0, 0, 0.444}, {}, kY, {-3.926991, 1.48353},
            {4.321, {0.0158, 0.0133, 0.048}, {0.03218, 0.02753, 0.02318, 0, 0, 0}},
            {2500, 250, 150, 2.443461}),
    turning("link_4", "joint_4", 2, {0, 0, 0.11}, {}, kX, {-kPi, kPi},
            {5.007, {0.3078, 0.0327, 0}, {0.01681, 0.0788, 0.08634, 0, 0, 0}}, {1000, 100, 40, 3.490659}),
    turning("link_5", "joint_5", 3, {0.47, 0, 0}, {}, kY, {-kPi, kPi},
            {4.028, {-0.0293, -0.0093, 0.0396}, {0.02102, 0.0243, 0.02214, 0, 0, 0}},
            {1000, 100, 40, 3.490659}),
    turning("link_6", "joint_6", 4, {0.101, 0, 0.08}, {}, kX, {-kPi, kPi},
            {0.211, {-0.0163, 0.0004, -0.0001}, {0.0003716, 0.0002052, 0.0002038, 0, 0, 0}},
            {800, 80, 20, 3.490659}),
};

constexpr Color kBase = {206, 208, 210}, kArm = {224, 226, 228}, kEnd = {120, 122, 128};

constexpr RobotShape kShapes[] = {
    box(-1, "base", {0.1062, 0.0824, 0.0937}, {-0.0183, 0, 0.0937}, kBase),
    box(0, "link_1", {0.0636, 0.0984, 0.07}, {0, 0.0134, -0.0065}, kArm),
    box(1, "link_2", {0.0657, 0.043, 0.2857}, {0, -0.129, 0.222}, kArm),
    box(2, "link_3", {0.0802, 0.0983, 0.1126}, {0.0158, 0.0133, 0.048}, kArm),
    box(3, "link_4", {0.2108, 0.0854, 0.0527}, {0.3078, 0.0327, 0}, kArm),
    box(4, "link_5", {0.0973, 0.0838, 0.0929}, {-0.0293, -0.0093, 0.0396}, kArm),
    box(5, "link_6", {0.0163, 0.0513, 0.0515}, {-0.0163, 0.0004, -0.0001}, kEnd),
};

// Rows of kShapes that may touch.
constexpr int32_t kBaseShape = 0, kLink1 = 1, kLink2 = 2, kLink3 = 3, kLink4 = 4, kLink5 = 5, kLink6 = 6;
constexpr RobotPair kPairs[] = {
    {kBaseShape, kLink3}, {kBaseShape, kLink4}, {kBaseShape, kLink5}, {kBaseShape, kLink6}, {kLink1, kLink4},
    {kLink1, kLink5},     {kLink1, kLink6},     {kLink2, kLink4},     {kLink2, kLink5},     {kLink2, kLink6},
};

}  // namespace

extern constinit const Robot kAbbCrb15000 = {
    .name = "abb_crb15000",
    .help = "ABB CRB 15000-5/0.95 (GoFa), arm of six joints",
    .kind = RobotKind::kArm,
    .alias = "crb15000",
    .X_BR = {},
    .root = {4.926, {-0.0183, 0, 0.0937}, {0.02557, 0.03294, 0.02967, 0, 0, 0}},
    .links = table(kLinks),
    .shapes = table(kShapes),
    .self_pairs = table(kPairs),
    .flange = 5,
    .X_LF = {{}, kAlongX},
};

}  // namespace rdm
