// The SCHUNK SVH, right: five fingers, 20 joints, 9 motors.
//
// Frames: root is the base (base_link of the source, with its hand_base and palm e1 as one body), z along the
// fingers; the palm faces x, the thumb is on the +y side, the mount 32 mm below. Of a finger's links x points
// to the tip. Joints are named as in the source, links by what they are. Kinematics, limits and couplings are
// facts of schunk_svh_ros_driver (GPL-3.0: nothing else was taken), boxes and tips of dex-urdf's model. Ours:
// the maker's 1.3 kg shared out by the volume of the shapes and their moments (the source's centres of mass
// lie outside the links), efforts (the source has placeholders), gains, the fold of the palm, which follows
// the thumb's opposition.
#include "robot/tables/rows.hpp"

namespace rdm {
namespace {

using namespace rows;

// Joints with a motor, and those that follow one.
constexpr double kSpeed = 1;  // rad/s
constexpr Drive driven(double effort) {
  return {5, 0.2, effort, kSpeed};
}
constexpr Drive following(double effort) {
  return {3, 0.1, effort, kSpeed};
}

constexpr RobotLink knuckle(const char* name, const char* joint, int32_t parent, Vec3 p, Vec3 rpy,
                            double upper, double z, const Drive& drive) {
  return turning(name, joint, parent, p, rpy, kZ, {0, upper},
                 {0.00653, {0, 0, z}, {2.612e-7, 2.612e-7, 2.612e-7, 0, 0, 0}}, drive);
}
// A link beyond the finger's base, `along` x of its parent.
constexpr RobotLink bone(const char* name, const char* joint, int32_t parent, double along, double upper,
                         const Body& body, const Drive& drive) {
  return turning(name, joint, parent, {along, 0, 0}, {}, kZ, {0, upper}, body, drive);
}

constexpr Body kFfProximalBody = {0.02398, {0.0307, 0.0008, 0}, {1.196e-6, 4.99e-6, 4.99e-6, 0, 0, 0}};
constexpr Body kFfMiddleBody = {0.01878, {0.0115, 0, 0}, {9.205e-7, 2.611e-6, 2.611e-6, 0, 0, 0}};
constexpr Body kMfProximalBody = {0.02481, {0.0318, 0.0009, 0}, {1.24e-6, 5.474e-6, 5.474e-6, 0, 0, 0}};
constexpr Body kRfProximalBody = {0.02429, {0.033, 0, 0}, {1.213e-6, 5.168e-6, 5.168e-6, 0, 0, 0}};
constexpr Body kMiddleBody = {0.02102, {0.0143, 0, 0}, {1.003e-6, 3.718e-6, 3.718e-6, 0, 0, 0}};
constexpr Body kLfProximalBody = {0.0208, {0.0296, 0.0007, 0}, {1.01e-6, 3.508e-6, 3.508e-6, 0, 0, 0}};
constexpr Body kLfMiddleBody = {0.01802, {0.0093, -0.0001, 0}, {9.249e-7, 2.181e-6, 2.181e-6, 0, 0, 0}};
constexpr Body kDistalBody = {0.00799, {0.0076, 0.0003, 0}, {2.495e-7, 5.273e-7, 5.273e-7, 0, 0, 0}};
constexpr Body kThProximalBody = {0.0941, {0.0237, 0.0013, 0}, {1.227e-5, 4.475e-5, 4.475e-5, 0, 0, 0}};
constexpr Body kThMiddleBody = {0.04733, {0.0098, 0, -0.0001}, {5.047e-6, 9.67e-6, 9.67e-6, 0, 0, 0}};
constexpr Body kThDistalBody = {0.01478, {0.0095, 0.001, 0}, {6.967e-7, 1.467e-6, 1.467e-6, 0, 0, 0}};

constexpr Vec3 kBent = {-kQuarter, -kQuarter, 0};

constexpr RobotLink kLinks[] = {
    turning("palm_fold", "j5", -1, {-0.00713, -0.0184, 0.0375}, {0, 0, -kQuarter}, kZ, {0, 0.98786},
            {0.08281,
             {0.01491, -0.00071, 0.02239},
             {3.378e-5, 3.037e-5, 1.333e-5, -6.874e-7, 2.319e-6, 1.504e-6}},
            following(0.9)),
    knuckle("ff_knuckle", "index_spread", -1, {-0.01313, 0.025, 0.11}, {0, -kQuarter, 0}, 0.28833, 0.00121,
            following(0.36)),
    turning("ff_proximal", "Index_Finger_Proximal", 1, {}, {-kQuarter, 0, 0}, kZ, {0, 0.79849},
            kFfProximalBody, driven(1)),
    bone("ff_middle", "Index_Finger_Distal", 2, 0.04804, 1.334, kFfMiddleBody, driven(0.6)),
    bone("ff_distal", "j14", 3, 0.026, 1.394, kDistalBody, following(0.36)),
    turning("mf_proximal", "Middle_Finger_Proximal", -1, {-0.01313, 0, 0.11}, kBent, kZ, {0, 0.79849},
            kMfProximalBody, driven(1)),
    bone("mf_middle", "Middle_Finger_Distal", 5, 0.05004, 1.334, kMiddleBody, driven(0.6)),
    bone("mf_distal", "j15", 6, 0.032, 1.334, kDistalBody, following(0.36)),
    knuckle("rf_knuckle", "ring_spread", 0, {0.003855, -0.006, 0.0655}, kBent, 0.28833, -0.00321,
            following(0.36)),
    turning("rf_proximal", "Ring_Finger", 8, {}, {kQuarter, 0, 0}, kZ, {0, 0.98175}, kRfProximalBody,
            driven(1)),
    bone("rf_middle", "j12", 9, 0.05004, 1.334, kMiddleBody, following(0.6)),
    bone("rf_distal", "j16", 10, 0.032, 1.395, kDistalBody, following(0.6)),
    knuckle("lf_knuckle", "Finger_Spread", 0, {0.025355, -0.006, 0.056}, kBent, 0.5829, -0.00321,
            driven(0.6)),
    turning("lf_proximal", "Pinky", 12, {}, {kQuarter, 0, 0}, kZ, {0, 0.98175}, kLfProximalBody, driven(1)),
    bone("lf_middle", "j13", 13, 0.04454, 1.334, kLfMiddleBody, following(0.6)),
    bone("lf_distal", "j17", 14, 0.022, 1.3971, kDistalBody, following(0.6)),
    turning("th_base", "Thumb_Opposition", -1, {0.01313, 0.0169, 0}, {0, kPi / 12, 0}, {0, 0, -1},
            {0, 0.9879}, {0.02045, {0, 0, 0.03893}, {3.11e-6, 4.863e-6, 3.508e-6, 0, 0, 0}}, driven(1.5)),
    turning("th_proximal", "Thumb_Flexion", 16, {0, 0, 0.04596}, {kQuarter, -0.600396, kQuarter}, kZ,
            {0, 0.9704}, kThProximalBody, driven(1.5)),
    bone("th_middle", "j3", 17, 0.0485, 0.98506, kThMiddleBody, following(0.9)),
    bone("th_distal", "j4", 18, 0.03, 1.406, kThDistalBody, following(0.9)),
};

constexpr Color kPalmColor = {104, 108, 114}, kBone = {196, 200, 204}, kTip = {72, 76, 84};

constexpr RobotShape capsule_x(int32_t link, const char* name, double radius, double half, Vec3 p,
                               Color c = kBone) {
  return capsule(link, name, radius, half, p, c, kAlongX);
}
constexpr RobotShape tip(int32_t link, const char* name) {
  return capsule_x(link, name, 0.0083, 0.0063, {0.0076, 0.0003, 0}, kTip);
}
constexpr RobotShape middle(int32_t link, const char* name) {
  return capsule_x(link, name, 0.0101, 0.0143, {0.0143, 0, 0});
}

constexpr RobotShape kShapes[] = {
    box(-1, "base", {0.04, 0.04, 0.0225}, {0, 0, -0.009}, kPalmColor),
    box(-1, "wrist", {0.025, 0.025, 0.013}, {0, 0, 0.013}, kPalmColor),
    box(-1, "palm", {0.019, 0.0292, 0.03205}, {-0.00963, 0.00573, 0.05747}, kPalmColor),
    box(-1, "palm_top", {0.019, 0.021, 0.0075}, {-0.00963, 0.01, 0.096}, kPalmColor),
    sphere(-1, "mf_knuckle", 0.01, {-0.01634, 0, 0.11}, kBone),
    box(0, "palm_fold", {0.0123, 0.0175, 0.0282}, {0.016, 0, 0.02}, kPalmColor),
    box(0, "palm_fold_top", {0.006, 0.009, 0.0105}, {0.0032, -0.0083, 0.048}, kPalmColor),
    sphere(1, "ff_knuckle", 0.01, {0, 0, 0.00121}, kBone),
    capsule_x(2, "ff_proximal", 0.0103, 0.0162, {0.0307, 0.0008, 0}),
    capsule_x(3, "ff_middle", 0.0103, 0.0112, {0.0115, 0, 0}),
    tip(4, "ff_distal"),
    capsule_x(5, "mf_proximal", 0.0103, 0.017, {0.0318, 0.0009, 0}),
    middle(6, "mf_middle"),
    tip(7, "mf_distal"),
    sphere(8, "rf_knuckle", 0.01, {0, 0, -0.00321}, kBone),
    capsule_x(9, "rf_proximal", 0.0103, 0.0165, {0.033, 0, 0}),
    middle(10, "rf_middle"),
    tip(11, "rf_distal"),
    sphere(12, "lf_knuckle", 0.01, {0, 0, -0.00321}, kBone),
    capsule_x(13, "lf_proximal", 0.0102, 0.0136, {0.0296, 0.0007, 0}),
    capsule_x(14, "lf_middle", 0.0106, 0.0093, {0.0093, -0.0001, 0}),
    tip(15, "lf_distal"),
    box(16, "th_base", {0.012, 0.0094, 0.004}, {0, 0, 0.02842}, kPalmColor),
    box(16, "th_fork", {0.003, 0.012, 0.0165}, {0.0125, 0, 0.04292}, kPalmColor),
    box(16, "th_fork_2", {0.003, 0.012, 0.0165}, {-0.0125, 0, 0.04292}, kPalmColor),
    capsule_x(17, "th_proximal", 0.0167, 0.0233, {0.0237, 0.0013, 0}),
    capsule_x(18, "th_middle", 0.0154, 0.0101, {0.0098, 0, -0.0001}),
    capsule_x(19, "th_distal", 0.0102, 0.0077, {0.0095, 0.001, 0}, kTip),
};

// Rows of kShapes that may touch.
constexpr int32_t kWrist = 1, kPalm = 2, kPalmTop = 3, kMfKnuckle = 4, kPalmFold = 5, kFfProximal = 8,
                  kFfMiddle = 9, kFfDistal = 10, kMfProximal = 11, kMfMiddle = 12, kMfDistal = 13,
                  kRfKnuckle = 14, kRfProximal = 15, kRfMiddle = 16, kRfDistal = 17, kLfKnuckle = 18,
                  kLfProximal = 19, kLfMiddle = 20, kLfDistal = 21, kThProximal = 25, kThMiddle = 26,
                  kThDistal = 27;

constexpr RobotPair kPairs[] = {
    {kWrist, kThProximal},      {kPalm, kRfKnuckle},        {kPalm, kThDistal},
    {kPalmTop, kRfKnuckle},     {kPalmTop, kRfProximal},    {kPalmTop, kThMiddle},
    {kPalmTop, kThDistal},      {kMfKnuckle, kRfKnuckle},   {kMfKnuckle, kRfProximal},
    {kPalmFold, kLfProximal},   {kFfProximal, kMfProximal}, {kFfProximal, kMfMiddle},
    {kFfProximal, kRfProximal}, {kFfProximal, kRfMiddle},   {kFfProximal, kRfDistal},
    {kFfMiddle, kMfProximal},   {kFfMiddle, kMfMiddle},     {kFfMiddle, kRfProximal},
    {kFfMiddle, kRfMiddle},     {kFfMiddle, kRfDistal},     {kFfMiddle, kLfDistal},
    {kFfMiddle, kThMiddle},     {kFfMiddle, kThDistal},     {kFfDistal, kRfMiddle},
    {kFfDistal, kRfDistal},     {kFfDistal, kLfDistal},     {kFfDistal, kThProximal},
    {kFfDistal, kThMiddle},     {kFfDistal, kThDistal},     {kMfProximal, kRfProximal},
    {kMfProximal, kRfMiddle},   {kMfProximal, kRfDistal},   {kMfProximal, kLfProximal},
    {kMfProximal, kLfMiddle},   {kMfProximal, kLfDistal},   {kMfProximal, kThDistal},
    {kMfMiddle, kRfProximal},   {kMfMiddle, kRfMiddle},     {kMfMiddle, kRfDistal},
    {kMfMiddle, kLfProximal},   {kMfMiddle, kLfMiddle},     {kMfMiddle, kLfDistal},
    {kMfMiddle, kThMiddle},     {kMfMiddle, kThDistal},     {kMfDistal, kRfProximal},
    {kMfDistal, kRfMiddle},     {kMfDistal, kRfDistal},     {kMfDistal, kLfProximal},
    {kMfDistal, kLfMiddle},     {kMfDistal, kLfDistal},     {kMfDistal, kThMiddle},
    {kMfDistal, kThDistal},     {kRfKnuckle, kLfKnuckle},   {kRfKnuckle, kLfProximal},
    {kRfProximal, kLfProximal}, {kRfProximal, kLfMiddle},   {kRfProximal, kLfDistal},
    {kRfProximal, kThMiddle},   {kRfProximal, kThDistal},   {kRfMiddle, kLfProximal},
    {kRfMiddle, kLfMiddle},     {kRfMiddle, kLfDistal},     {kRfMiddle, kThProximal},
    {kRfMiddle, kThMiddle},     {kRfMiddle, kThDistal},     {kRfDistal, kThProximal},
    {kRfDistal, kThMiddle},     {kRfDistal, kThDistal},     {kLfProximal, kLfDistal},
    {kLfProximal, kThMiddle},   {kLfProximal, kThDistal},   {kLfMiddle, kThProximal},
    {kLfMiddle, kThMiddle},     {kLfMiddle, kThDistal},     {kLfDistal, kThProximal},
    {kLfDistal, kThMiddle},     {kLfDistal, kThDistal},     {kThProximal, kThDistal},
};

constexpr RobotCoupling kCouplings[] = {
    // the palm folds as the thumb opposes
    {0, 16, 1, 0},
    // first and ring finger spread half as much as the little one
    {1, 12, 0.5, 0},
    {8, 12, 0.5, 0},
    // fingertips of the first two fingers
    {4, 3, 1.045, 0},
    {7, 6, 1.0454, 0},
    // ring finger, little finger and the thumb's flexion have one motor each
    {10, 9, 1.3588, 0},
    {11, 9, 1.42093, 0},
    {14, 13, 1.3588, 0},
    {15, 13, 1.42307, 0},
    {18, 17, 1.01511, 0},
    {19, 17, 1.44889, 0},
};
// Thumb flexion and opposition; first finger distal and proximal; middle finger distal and proximal; ring;
// little; spread.
constexpr int32_t kCommands[] = {17, 16, 3, 2, 6, 5, 9, 13, 12};

constexpr Vec3 kTipPoint = {0.014, 0, 0};
constexpr RobotTip kTips[] = {
    {4, kTipPoint}, {7, kTipPoint}, {11, kTipPoint}, {15, kTipPoint}, {19, {0.0275, 0, 0}}};
constexpr RobotFinger kFingers[] = {
    {"ff", 1, 1, 2, 3},     {"mf", 5, -1, 5, 6},          {"rf", 8, 8, 9, -1},
    {"lf", 12, 12, 13, -1}, {"th", 16, 16, 17, -1, true},
};

constexpr double kFolded[] = {0.083, 0, 0, 0, 0, 0, 0,     0,    0,       0,
                              0,     0, 0, 0, 0, 0, 0.083, 0.97, 0.98466, 1.40542};
constexpr float kClosed[] = {-0.5f, 1, -0.1f, 0.5f, -0.05f, 0.55f, 0, -0.2f, -1};

}  // namespace

extern constinit const Robot kSchunkSvh = {
    .name = "schunk_svh",
    .help = "SCHUNK SVH, five fingers, 20 joints of which 9 are driven",
    .kind = RobotKind::kHand,
    .alias = "svh",
    .X_BR = {},
    .root = {0.81624,
             {-0.0031875, 0.0020143, 0.017555},
             {0.0014532, 0.0014256, 0.00064646, 1.059e-5, 0.00012332, -8.0025e-5}},
    .links = table(kLinks),
    .shapes = table(kShapes),
    .self_pairs = table(kPairs),
    .couplings = table(kCouplings),
    .commands = table(kCommands),
    .tips = table(kTips),
    .palm = kRootLink,
    .p_palm = {0.00937, 0.0057, 0.0575},
    .n_palm = {1, 0, 0},
    .z_palm = {0, 0, 1},
    .mirror = 1,
    .X_RM = {{0, 0, -0.032}, {}},
    .fingers = table(kFingers),
    .poses = {table(kFolded), table(kClosed)},
    .p_hold = {0.0194, 0, 0.09},
};

}  // namespace rdm
