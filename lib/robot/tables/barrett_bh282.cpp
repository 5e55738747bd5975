// The Barrett BH8-282: three fingers of two joints, of which two also turn about the palm; 8 joints, 4
// motors.
//
// Frames: root is the base, the palm faces z, 6 cm above the mounting face. Finger 3 stands still on the +y
// side; at spread 0 fingers 1 and 2 oppose it, at pi they stand beside it. Kinematics, limits and couplings
// are those of barrett_hand_common (BSD-3-Clause), boxes of the fingers those of dex-urdf (BSD), the others
// fits to the meshes. Ours: the maker's 0.98 kg split over the links and the moments of the shapes (the
// source's are placeholders), efforts, gains. Not modelled: the clutch that lets a finger's outer link go on
// when the inner one is held; the outer joint follows at its ratio. "Left" is the mirror image, on which
// fingers 1 and 2 change places.
#include "robot/tables/rows.hpp"

namespace rdm {
namespace {

using namespace rows;

constexpr Range kSpread = {0, 3.1416}, kBend = {0, 2.44};

// Fingers 1 and 2, about the palm.
constexpr RobotLink spreading(const char* name, const char* joint, double x, Vec3 axis) {
  return turning(name, joint, -1, {x, 0, 0.0252}, {0, 0, kQuarter}, axis, kSpread,
                 {0.06, {-0.02959, 0, 0.01943}, {1.458e-5, 4.09e-5, 3.237e-5, 0, 6.738e-6, 0}},
                 {20, 1, 2, 2});
}
constexpr RobotLink inner(const char* name, const char* joint, int32_t parent, Vec3 p, double yaw) {
  return turning(name, joint, parent, p, {kQuarter, 0, yaw}, {0, 0, -1}, kBend,
                 {0.09, {-0.03868, 0.00247, 0.001}, {5.522e-6, 3.098e-5, 3.341e-5, 5.608e-8, 0, 0}},
                 {20, 1, 2.5, 2});
}
constexpr RobotLink outer(const char* name, const char* joint, int32_t parent) {
  return turning(name, joint, parent, {-0.069936, 0.003, 0}, {}, {0, 0, -1}, {0, 0.84},
                 {0.05, {-0.01676, 0.01672, 0}, {1.076e-5, 1.209e-5, 1.952e-5, 8.675e-6, 0, 0}},
                 {8, 0.4, 1, 2});
}

constexpr RobotLink kLinks[] = {
    spreading("bh_finger_11_link", "bh_j11_joint", -0.025, {0, 0, -1}),
    inner("bh_finger_12_link", "bh_j12_joint", 0, {-0.05, 0, 0.0339}, 0),
    outer("bh_finger_13_link", "bh_j13_joint", 1),
    spreading("bh_finger_21_link", "bh_j21_joint", 0.025, kZ),
    inner("bh_finger_22_link", "bh_j22_joint", 3, {-0.05, 0, 0.0339}, 0),
    outer("bh_finger_23_link", "bh_j23_joint", 4),
    inner("bh_finger_32_link", "bh_j32_joint", -1, {0, 0.05, 0.0591}, -kQuarter),
    outer("bh_finger_33_link", "bh_j33_joint", 6),
};

constexpr Color kBase = {96, 98, 102}, kBone = {176, 180, 184}, kTip = {120, 124, 128};

constexpr RobotShape foot(int32_t link, const char* name) {
  return box(link, name, {0.0192, 0.0123, 0.0175}, {-0.007, 0, 0.0125}, kBone);
}
constexpr RobotShape knuckle(int32_t link, const char* name) {
  return box(link, name, {0.0192, 0.0123, 0.0244}, {-0.0458, 0, 0.0244}, kBone);
}
constexpr RobotShape bone(int32_t link, const char* name) {
  return box(link, name, {0.0395, 0.011, 0.005}, {-0.0375, 0.002, 0.001}, kBone);
}
constexpr RobotShape rib(int32_t link, const char* name) {
  return box(link, name, {0.018, 0.012, 0.009}, {-0.04, 0.003, 0.001}, kBone);
}
// The bent outer link, in three pieces.
constexpr RobotShape heel(int32_t link, const char* name) {
  return box(link, name, {0.009, 0.011, 0.01}, {-0.002, 0.002, 0}, kBone, {0.925554, 0, 0, 0.378616});
}
constexpr RobotShape pad(int32_t link, const char* name) {
  return box(link, name, {0.007, 0.019, 0.01}, {-0.022, 0.023, 0}, kTip, {0.900708, 0, 0, 0.434425});
}
constexpr RobotShape tip(int32_t link, const char* name) {
  return box(link, name, {0.006, 0.006, 0.01}, {-0.038, 0.034, 0}, kTip, {0.691668, 0, 0, 0.722215});
}

constexpr RobotShape kShapes[] = {
    box(-1, "palm", {0.0443, 0.0442, 0.03}, {0, 0, 0.03}, kBase),
    box(-1, "f3_knuckle", {0.012, 0.013, 0.0215}, {0, 0.0482, 0.0467}, kBone),
    foot(0, "f1_foot"),
    knuckle(0, "f1_knuckle"),
    bone(1, "f1_inner"),
    rib(1, "f1_rib"),
    heel(2, "f1_heel"),
    pad(2, "f1_pad"),
    tip(2, "f1_tip"),
    foot(3, "f2_foot"),
    knuckle(3, "f2_knuckle"),
    bone(4, "f2_inner"),
    rib(4, "f2_rib"),
    heel(5, "f2_heel"),
    pad(5, "f2_pad"),
    tip(5, "f2_tip"),
    bone(6, "f3_inner"),
    rib(6, "f3_rib"),
    heel(7, "f3_heel"),
    pad(7, "f3_pad"),
    tip(7, "f3_tip"),
};

// Rows of kShapes that may touch. The inner links pass the corners of the box, which the round palm has not.
constexpr int32_t kPalm = 0, kF3Knuckle = 1, kF1Foot = 2, kF1Knuckle = 3, kF1Inner = 4, kF1Rib = 5,
                  kF1Heel = 6, kF1Pad = 7, kF1Tip = 8, kF2Foot = 9, kF2Knuckle = 10, kF2Inner = 11,
                  kF2Rib = 12, kF2Heel = 13, kF2Pad = 14, kF2Tip = 15, kF3Inner = 16, kF3Rib = 17,
                  kF3Heel = 18, kF3Pad = 19, kF3Tip = 20;

constexpr RobotPair kPairs[] = {
    {kPalm, kF1Pad},      {kPalm, kF1Tip},      {kPalm, kF2Pad},      {kPalm, kF2Tip},
    {kPalm, kF3Pad},      {kPalm, kF3Tip},      {kF3Knuckle, kF1Pad}, {kF3Knuckle, kF1Tip},
    {kF3Knuckle, kF2Pad}, {kF3Knuckle, kF2Tip}, {kF1Foot, kF2Pad},    {kF1Foot, kF2Tip},
    {kF1Knuckle, kF3Rib}, {kF1Knuckle, kF3Pad}, {kF1Knuckle, kF3Tip}, {kF1Inner, kF2Pad},
    {kF1Inner, kF2Tip},   {kF1Inner, kF3Inner}, {kF1Inner, kF3Rib},   {kF1Inner, kF3Heel},
    {kF1Inner, kF3Pad},   {kF1Rib, kF2Tip},     {kF1Rib, kF3Rib},     {kF1Heel, kF2Pad},
    {kF1Heel, kF2Tip},    {kF1Heel, kF3Inner},  {kF1Heel, kF3Rib},    {kF1Heel, kF3Heel},
    {kF1Heel, kF3Pad},    {kF1Pad, kF2Foot},    {kF1Pad, kF2Inner},   {kF1Pad, kF2Heel},
    {kF1Pad, kF2Pad},     {kF1Pad, kF2Tip},     {kF1Pad, kF3Inner},   {kF1Pad, kF3Rib},
    {kF1Pad, kF3Heel},    {kF1Pad, kF3Pad},     {kF1Pad, kF3Tip},     {kF1Tip, kF2Foot},
    {kF1Tip, kF2Inner},   {kF1Tip, kF2Rib},     {kF1Tip, kF2Heel},    {kF1Tip, kF2Pad},
    {kF1Tip, kF2Tip},     {kF1Tip, kF3Inner},   {kF1Tip, kF3Rib},     {kF1Tip, kF3Heel},
    {kF1Tip, kF3Pad},     {kF1Tip, kF3Tip},     {kF2Knuckle, kF3Rib}, {kF2Knuckle, kF3Pad},
    {kF2Knuckle, kF3Tip}, {kF2Inner, kF3Inner}, {kF2Inner, kF3Rib},   {kF2Inner, kF3Heel},
    {kF2Inner, kF3Pad},   {kF2Heel, kF3Inner},  {kF2Heel, kF3Rib},    {kF2Heel, kF3Heel},
    {kF2Heel, kF3Pad},    {kF2Pad, kF3Inner},   {kF2Pad, kF3Rib},     {kF2Pad, kF3Heel},
    {kF2Pad, kF3Pad},     {kF2Pad, kF3Tip},     {kF2Tip, kF3Inner},   {kF2Tip, kF3Rib},
    {kF2Tip, kF3Heel},    {kF2Tip, kF3Pad},     {kF2Tip, kF3Tip},
};

constexpr double kOuterShare = 0.344262295082;
constexpr RobotCoupling kCouplings[] = {
    {2, 1, kOuterShare, 0}, {3, 0, 1, 0}, {5, 4, kOuterShare, 0}, {7, 6, kOuterShare, 0}};

constexpr Vec3 kTipPoint = {-0.0443, 0.0395, 0};
constexpr RobotTip kTips[] = {{2, kTipPoint}, {5, kTipPoint}, {7, kTipPoint}};
constexpr RobotFinger kFingers[] = {{"f1", 0, 0, 1, -1}, {"f2", 3, -1, 4, -1}, {"f3", 6, -1, 6, -1, true}};

constexpr double kFolded[] = {0, 0, 0, 0, 0, 0, 0, 0};
constexpr float kClosed[] = {-1, 0.2f, 0.2f, 0.2f};

}  // namespace

extern constinit const Robot kBarrettBh282 = {
    .name = "barrett_bh282",
    .help = "Barrett BH8-282, three fingers, 8 joints of which 4 are driven",
    .kind = RobotKind::kHand,
    .alias = "barrett",
    .X_BR = {},
    // base and the still foot of finger 3 as one body
    .root = {0.44, {0, 0.0032864, 0.031139}, {0.00046905, 0.00040506, 0.00060328, 0, 0, -2.2502e-5}},
    .links = table(kLinks),
    .shapes = table(kShapes),
    .self_pairs = table(kPairs),
    .couplings = table(kCouplings),
    .tips = table(kTips),
    .palm = kRootLink,
    .p_palm = {0, 0, 0.06},
    .n_palm = {0, 0, 1},
    .z_palm = {0, -1, 0},  // from finger 3 to the pair
    .mirror = 0,
    .fingers = table(kFingers),
    .poses = {table(kFolded), table(kClosed)},
    .p_hold = {0, 0, 0.07},
};

}  // namespace rdm
