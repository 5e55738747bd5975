// The Wonik Allegro Hand v4, right: three fingers and a thumb, 16 joints, a motor in each.
//
// Frames: root is the palm, z along the fingers, which begin at z = 0; the palm faces x, the thumb is on the
// +y side, the mount at the lower end. Joints, limits, boxes and tips are those of the MuJoCo model
// (BSD-2-Clause), masses those of the paper's model of it (the maker says 1.08 kg for the whole), moments
// those of the shapes. Gains and effort are the paper's. An angle of 0 is outside the first limit of the
// thumb.
#include "robot/tables/rows.hpp"

namespace rdm {
namespace {

using namespace rows;

constexpr Drive kDrive = {3, 0.1, 0.5, 3.14};

constexpr RobotLink base(const char* name, const char* joint, Vec3 p, double roll) {
  return turning(name, joint, -1, p, {roll, 0, 0}, kZ, {-0.47, 0.47},
                 {0.01135, {0, 0, 0.0082}, {9.697e-7, 6.177e-7, 1.079e-6, 0, 0, 0}}, kDrive);
}
constexpr RobotLink proximal(const char* name, const char* joint, int32_t parent) {
  return turning(name, joint, parent, {0, 0, 0.0164}, {}, kY, {-0.196, 1.61},
                 {0.071189, {0, 0, 0.027}, {2.179e-5, 1.958e-5, 6.765e-6, 0, 0, 0}}, kDrive);
}
constexpr RobotLink medial(const char* name, const char* joint, int32_t parent) {
  return turning(name, joint, parent, {0, 0, 0.054}, {}, kY, {-0.174, 1.709},
                 {0.037589, {0, 0, 0.0192}, {6.988e-6, 5.822e-6, 3.572e-6, 0, 0, 0}}, kDrive);
}
constexpr RobotLink distal(const char* name, const char* joint, int32_t parent) {
  return turning(name, joint, parent, {0, 0, 0.0384}, {}, kY, {-0.227, 1.618},
                 {0.026084, {0, 0, 0.01519}, {4.01e-6, 3.73e-6, 1.977e-6, 0, 0, 0}}, kDrive);
}

constexpr double kFan = 0.0872664626;  // rad: the outer fingers lean outwards

constexpr RobotLink kLinks[] = {
    base("ff_base", "ffj0", {0, 0.0435, -0.001542}, -kFan),
    proximal("ff_proximal", "ffj1", 0),
    medial("ff_medial", "ffj2", 1),
    distal("ff_distal", "ffj3", 2),
    base("mf_base", "mfj0", {0, 0, 0.0007}, 0),
    proximal("mf_proximal", "mfj1", 4),
    medial("mf_medial", "mfj2", 5),
    distal("mf_distal", "mfj3", 6),
    base("rf_base", "rfj0", {0, -0.0435, -0.001542}, kFan),
    proximal("rf_proximal", "rfj1", 8),
    medial("rf_medial", "rfj2", 9),
    distal("rf_distal", "rfj3", 10),
    turning("th_base", "thj0", -1, {-0.0182, 0.019333, -0.045987}, {kPi, -1.4835298642, kQuarter}, {-1, 0, 0},
            {0.263, 1.396}, {0.07981, {-0.0179, 0.009, 0.0145}, {2.146e-5, 2.229e-5, 1.621e-5, 0, 0, 0}},
            kDrive),
    turning("th_proximal", "thj1", 12, {-0.027, 0.005, 0.0399}, {}, kZ, {-0.105, 1.163},
            {0.01135, {0, 0, 0.00885}, {1.012e-6, 6.597e-7, 1.079e-6, 0, 0, 0}}, kDrive),
    turning("th_medial", "thj2", 13, {0, 0, 0.0177}, {}, kY, {-0.189, 1.644},
            {0.040207, {0, 0, 0.0257}, {1.139e-5, 1.014e-5, 3.821e-6, 0, 0, 0}}, kDrive),
    turning("th_distal", "thj3", 14, {0, 0, 0.0514}, {}, kY, {-0.162, 1.719},
            {0.057404, {0, 0, 0.0246}, {1.313e-5, 1.217e-5, 4.655e-6, 0, 0, 0}}, kDrive),
};

constexpr Color kPalmColor = {70, 72, 76}, kBone = {84, 86, 90}, kTip = {222, 222, 216};

// A box as wide and thick as a finger, from the link's origin on.
constexpr RobotShape bone(int32_t link, const char* name, double half) {
  return box(link, name, {0.0098, 0.01375, half}, {0, 0, half}, kBone);
}
constexpr RobotShape tip(int32_t link, const char* name) {
  return capsule(link, name, 0.012, 0.01, {0, 0, 0.019}, kTip);
}

constexpr RobotShape kShapes[] = {
    box(-1, "palm", {0.0204, 0.0565, 0.0475}, {-0.0093, 0, -0.0475}, kPalmColor),
    bone(0, "ff_base", 0.0082),
    bone(1, "ff_proximal", 0.027),
    bone(2, "ff_medial", 0.0192),
    bone(3, "ff_distal", 0.008),
    tip(3, "ff_tip"),
    bone(4, "mf_base", 0.0082),
    bone(5, "mf_proximal", 0.027),
    bone(6, "mf_medial", 0.0192),
    bone(7, "mf_distal", 0.008),
    tip(7, "mf_tip"),
    bone(8, "rf_base", 0.0082),
    bone(9, "rf_proximal", 0.027),
    bone(10, "rf_medial", 0.0192),
    bone(11, "rf_distal", 0.008),
    tip(11, "rf_tip"),
    box(12, "th_base", {0.0179, 0.017, 0.02275}, {-0.0179, 0.009, 0.0145}, kPalmColor),
    bone(13, "th_proximal", 0.00885),
    bone(14, "th_medial", 0.0257),
    bone(15, "th_distal", 0.0157),
    capsule(15, "th_tip", 0.012, 0.008, {0, 0, 0.035}, kTip),
};

// Rows of kShapes that may touch.
constexpr int32_t kPalm = 0, kFfBase = 1, kFfProx = 2, kFfMed = 3, kFfDist = 4, kFfTip = 5, kMfBase = 6,
                  kMfProx = 7, kMfMed = 8, kMfDist = 9, kMfTip = 10, kRfBase = 11, kRfProx = 12, kRfMed = 13,
                  kRfDist = 14, kRfTip = 15, kThBase = 16, kThProx = 17, kThMed = 18, kThDist = 19,
                  kThTip = 20;

constexpr RobotPair kPairs[] = {
    {kPalm, kFfProx},   {kPalm, kFfTip},    {kPalm, kMfTip},    {kPalm, kRfProx},   {kPalm, kRfTip},
    {kPalm, kThMed},    {kPalm, kThDist},   {kPalm, kThTip},    {kFfBase, kThDist}, {kFfBase, kThTip},
    {kFfProx, kMfProx}, {kFfProx, kMfMed},  {kFfProx, kMfDist}, {kFfProx, kMfTip},  {kFfProx, kThDist},
    {kFfProx, kThTip},  {kFfMed, kMfProx},  {kFfMed, kMfMed},   {kFfMed, kMfDist},  {kFfMed, kMfTip},
    {kFfMed, kRfMed},   {kFfMed, kRfDist},  {kFfMed, kRfTip},   {kFfMed, kThMed},   {kFfMed, kThDist},
    {kFfMed, kThTip},   {kFfDist, kMfProx}, {kFfDist, kMfMed},  {kFfDist, kMfDist}, {kFfDist, kMfTip},
    {kFfDist, kRfMed},  {kFfDist, kRfDist}, {kFfDist, kRfTip},  {kFfDist, kThMed},  {kFfDist, kThDist},
    {kFfDist, kThTip},  {kFfTip, kMfProx},  {kFfTip, kMfMed},   {kFfTip, kMfDist},  {kFfTip, kMfTip},
    {kFfTip, kRfMed},   {kFfTip, kRfDist},  {kFfTip, kRfTip},   {kFfTip, kThBase},  {kFfTip, kThProx},
    {kFfTip, kThMed},   {kFfTip, kThDist},  {kFfTip, kThTip},   {kMfBase, kThDist}, {kMfBase, kThTip},
    {kMfProx, kRfProx}, {kMfProx, kRfMed},  {kMfProx, kRfDist}, {kMfProx, kRfTip},  {kMfProx, kThDist},
    {kMfProx, kThTip},  {kMfMed, kRfProx},  {kMfMed, kRfMed},   {kMfMed, kRfDist},  {kMfMed, kRfTip},
    {kMfMed, kThMed},   {kMfMed, kThDist},  {kMfMed, kThTip},   {kMfDist, kRfProx}, {kMfDist, kRfMed},
    {kMfDist, kRfDist}, {kMfDist, kRfTip},  {kMfDist, kThMed},  {kMfDist, kThDist}, {kMfDist, kThTip},
    {kMfTip, kRfProx},  {kMfTip, kRfMed},   {kMfTip, kRfDist},  {kMfTip, kRfTip},   {kMfTip, kThBase},
    {kMfTip, kThProx},  {kMfTip, kThMed},   {kMfTip, kThDist},  {kMfTip, kThTip},   {kRfBase, kThTip},
    {kRfProx, kThTip},  {kRfMed, kThDist},  {kRfMed, kThTip},   {kRfDist, kThDist}, {kRfDist, kThTip},
    {kRfTip, kThMed},   {kRfTip, kThDist},  {kRfTip, kThTip},   {kThBase, kThDist}, {kThBase, kThTip},
};

constexpr RobotTip kTips[] = {
    {3, {0, 0, 0.0387}}, {7, {0, 0, 0.0387}}, {11, {0, 0, 0.0387}}, {15, {0, 0, 0.0543}}};
constexpr RobotFinger kFingers[] = {
    {"ff", 0, 0, 1, 2}, {"mf", 4, 4, 5, 6}, {"rf", 8, 8, 9, 10}, {"th", 12, 12, 13, 14, true}};

constexpr double kHome[] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0.263, 0, 0, 0};
constexpr double kFolded[] = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1.02, 1.16, 1.29, 1.71};
constexpr float kClosed[] = {0, 0.16f, 0.1f, 0.17f, 0,      0.19f, 0.12f, 0.2f,
                             0, 0.16f, 0.1f, 0.17f, -0.05f, 0.23f, 0.69f, 0.5f};

}  // namespace

extern constinit const Robot kAllegroHand = {
    .name = "allegro_hand",
    .help = "Wonik Allegro Hand v4, three fingers and a thumb, 16 joints, all driven",
    .kind = RobotKind::kHand,
    .alias = "allegro",
    .X_BR = {},
    .root = {0.416858, {-0.0093, 0, -0.0475}, {0.0007571, 0.0003713, 0.0005014, 0, 0, 0}},
    .links = table(kLinks),
    .shapes = table(kShapes),
    .self_pairs = table(kPairs),
    .home = table(kHome),
    .tips = table(kTips),
    .palm = kRootLink,
    .p_palm = {0.0111, 0, -0.0475},
    .n_palm = {1, 0, 0},
    .z_palm = {0, 0, 1},
    .mirror = 1,
    .X_RM = {{0, 0, -0.095}, {}},
    .fingers = table(kFingers),
    .poses = {table(kFolded), table(kClosed)},
    .p_hold = {0.0211, 0, -0.02},
};

}  // namespace rdm
