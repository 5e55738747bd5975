// The Shadow Hand: 24 joints, 20 of them driven, five fingers.
//
// Frames: z along the fingers, the palm faces -y, the thumb is on the +x side. The root is the mount, on
// which the forearm sits; with the base at the identity the fingers point to -y and the palm looks up.
// Numbers: the model of the paper's released tasks, joints named as there. The coupled distal joints follow
// 0.00705 q0 = 0.00805 q1 within +-0.001, as a stiff drive instead of a tendon. The source's joint
// armatures (0.005 at the wrist, 0.001 else) are left to the engine's own.
#include "robot/robot.hpp"

namespace rdm {
namespace {

constexpr double kTendonRatio = 0.00805 / 0.00705;
constexpr double kTendonSlack = 0.001 / 0.00705;
constexpr double kQuarter = 0.70710678118654752;  // of a quarter turn's quaternion
constexpr double kFriction = 0.001;               // N m, dry, every joint

// kp 5 and kd 0.5 at the wrist, 1 and 0.1 in the fingers.
constexpr RobotLink wrist(const char* name, const char* joint, int32_t parent, Vec3 p, Vec3 com, Vec3 axis,
                          double lower, double upper, double effort) {
  return {name,
          joint,
          parent,
          p,
          {},
          0.3,
          com,
          {1e-3, 1e-3, 1e-3, 0, 0, 0},
          JointKind::kRevolute,
          axis,
          lower,
          upper,
          5,
          0.5,
          effort,
          0,
          kFriction};
}

// The source inflates the moments of the fingers to 1e-5.
constexpr RobotLink bone(const char* name, const char* joint, int32_t parent, Vec3 p, double mass, Vec3 com,
                         Vec3 axis, double lower, double upper, double effort, double kd = 0.1,
                         Vec3 rpy = {}) {
  return {name,
          joint,
          parent,
          p,
          rpy,
          mass,
          com,
          {1e-5, 1e-5, 1e-5, 0, 0, 0},
          JointKind::kRevolute,
          axis,
          lower,
          upper,
          1,
          kd,
          effort,
          0,
          kFriction};
}

constexpr RobotLink knuckle(const char* name, const char* joint, int32_t parent, Vec3 p) {
  return bone(name, joint, parent, p, 0.008, {}, {0, 1, 0}, -0.349, 0.349, 0.9);
}
constexpr RobotLink proximal(const char* name, const char* joint, int32_t parent) {
  return bone(name, joint, parent, {}, 0.014, {0, 0, 0.023}, {1, 0, 0}, 0, 1.571, 0.9);
}
constexpr RobotLink middle(const char* name, const char* joint, int32_t parent, double com) {
  return bone(name, joint, parent, {0, 0, 0.045}, 0.012, {0, 0, com}, {1, 0, 0}, 0, 1.571, 0.7245);
}
// The follower's drive: 1 N m/rad, at most 0.5 N m.
constexpr RobotLink distal(const char* name, const char* joint, int32_t parent) {
  return bone(name, joint, parent, {0, 0, 0.025}, 0.010, {0, 0, 0.015}, {1, 0, 0}, 0, 1.571, 0.5, 0.05);
}

constexpr Vec3 kArch = {0.57097659, 0, 0.820966341};

constexpr RobotLink kLinks[] = {
    wrist("wrist", "WRJ1", -1, {0, 0.01, 0.256}, {0.003, 0, 0.016}, {0, 1, 0}, -0.489, 0.140, 4.785),
    wrist("palm", "WRJ0", 0, {0, 0, 0.034}, {0.006, 0, 0.036}, {1, 0, 0}, -0.698, 0.489, 2.175),
    knuckle("ff_knuckle", "FFJ3", 1, {0.033, 0, 0.095}),
    proximal("ff_proximal", "FFJ2", 2),
    middle("ff_middle", "FFJ1", 3, 0.011),
    distal("ff_distal", "FFJ0", 4),
    knuckle("mf_knuckle", "MFJ3", 1, {0.011, 0, 0.099}),
    proximal("mf_proximal", "MFJ2", 6),
    middle("mf_middle", "MFJ1", 7, 0.012),
    distal("mf_distal", "MFJ0", 8),
    knuckle("rf_knuckle", "RFJ3", 1, {-0.011, 0, 0.095}),
    proximal("rf_proximal", "RFJ2", 10),
    middle("rf_middle", "RFJ1", 11, 0.012),
    distal("rf_distal", "RFJ0", 12),
    bone("lf_metacarpal", "LFJ4", 1, {-0.017, 0, 0.044}, 0.075, {-0.014, 0.001, 0.014}, kArch, 0, 0.785, 0.9),
    knuckle("lf_knuckle", "LFJ3", 14, {-0.017, 0, 0.044}),
    proximal("lf_proximal", "LFJ2", 15),
    middle("lf_middle", "LFJ1", 16, 0.012),
    distal("lf_distal", "LFJ0", 17),
    bone("th_base", "THJ4", 1, {0.034, -0.009, 0.029}, 0.010, {}, {0, 0, -1}, -1.047, 1.047, 2.3722, 0.1,
         {0, 0.785, 0}),
    bone("th_proximal", "THJ3", 19, {}, 0.016, {0, 0, 0.017}, {1, 0, 0}, 0, 1.222, 1.45),
    bone("th_hub", "THJ2", 20, {0, 0, 0.038}, 0.002, {}, {1, 0, 0}, -0.209, 0.209, 0.99),
    bone("th_middle", "THJ1", 21, {}, 0.016, {0, 0, 0.016}, {0, 1, 0}, -0.524, 0.524, 0.99),
    bone("th_distal", "THJ0", 22, {0, 0, 0.032}, 0.016, {0, 0, 0.016}, {0, 1, 0}, -1.571, 0, 0.81),
};

struct Color {
  uint8_t r, g, b;
};
constexpr Color kBone = {205, 205, 200}, kPalm = {170, 170, 168}, kTip = {214, 186, 160},
                kArm = {120, 122, 126};

// Along z from the link's origin on.
constexpr RobotShape capsule(int32_t link, const char* name, double radius, double half, Color c, double z) {
  return {link, name, ShapeKind::kCapsule, {radius, half, 0}, {0, 0, z}, {}, {c.r, c.g, c.b}};
}
constexpr RobotShape box(int32_t link, const char* name, Vec3 half, Vec3 p) {
  return {link, name, ShapeKind::kBox, half, p, {}, {kPalm.r, kPalm.g, kPalm.b}};
}
constexpr RobotShape proximal_shape(int32_t link, const char* name) {
  return capsule(link, name, 0.0100, 0.0225, kBone, 0.0225);
}
constexpr RobotShape middle_shape(int32_t link, const char* name) {
  return capsule(link, name, 0.00805, 0.0125, kBone, 0.0125);
}
constexpr RobotShape distal_shape(int32_t link, const char* name) {
  return capsule(link, name, 0.00705, 0.012, kTip, 0.012);
}

constexpr RobotShape kShapes[] = {
    {-1, "forearm", ShapeKind::kCapsule, {0.05, 0.075, 0}, {0, 0.01, 0.125}, {}, {kArm.r, kArm.g, kArm.b}},
    {0,
     "wrist",
     ShapeKind::kCapsule,
     {0.015, 0.010, 0},
     {},
     {kQuarter, kQuarter, 0, 0},
     {kPalm.r, kPalm.g, kPalm.b}},
    box(1, "palm", {0.032, 0.0111, 0.049}, {0.011, 0, 0.038}),
    box(1, "palm_side", {0.011, 0.0111, 0.025}, {-0.032, 0, 0.014}),
    proximal_shape(3, "ff_proximal"),
    middle_shape(4, "ff_middle"),
    distal_shape(5, "ff_distal"),
    proximal_shape(7, "mf_proximal"),
    middle_shape(8, "mf_middle"),
    distal_shape(9, "mf_distal"),
    proximal_shape(11, "rf_proximal"),
    middle_shape(12, "rf_middle"),
    distal_shape(13, "rf_distal"),
    box(14, "lf_metacarpal", {0.0095, 0.0111, 0.025}, {-0.0165, 0, 0.010}),
    proximal_shape(16, "lf_proximal"),
    middle_shape(17, "lf_middle"),
    distal_shape(18, "lf_distal"),
    capsule(20, "th_proximal", 0.013, 0.019, kBone, 0.019),
    capsule(22, "th_middle", 0.011, 0.016, kBone, 0.016),
    capsule(23, "th_distal", 0.00918, 0.013, kTip, 0.013),
};

// Rows of kShapes that may touch inside one hand.
constexpr int32_t kLargePalm = 2, kFf = 4, kMf = 7, kRf = 10, kLf = 14, kThumbTip = 19;
constexpr int32_t kProximal = 0, kMiddle = 1, kDistal = 2;  // added to a finger's row

constexpr RobotPair kPairs[] = {
    {kThumbTip, kFf + kDistal},         {kThumbTip, kFf + kMiddle},
    {kThumbTip, kFf + kProximal},       {kThumbTip, kMf + kProximal},
    {kThumbTip, kMf + kDistal},         {kThumbTip, kRf + kDistal},
    {kThumbTip, kLf + kDistal},         {kThumbTip, kLargePalm},
    {kMf + kDistal, kFf + kDistal},     {kRf + kDistal, kMf + kDistal},
    {kLf + kDistal, kRf + kDistal},     {kLf + kDistal, kMf + kDistal},
    {kMf + kProximal, kFf + kProximal}, {kRf + kProximal, kMf + kProximal},
    {kLf + kProximal, kRf + kProximal}, {kLf + kDistal, kRf + kMiddle},
    {kLf + kMiddle, kRf + kDistal},     {kLf + kMiddle, kRf + kMiddle},
};

constexpr RobotCoupling kCouplings[] = {
    {5, 4, kTendonRatio, kTendonSlack},
    {9, 8, kTendonRatio, kTendonSlack},
    {13, 12, kTendonRatio, kTendonSlack},
    {18, 17, kTendonRatio, kTendonSlack},
};

constexpr RobotTip kTips[] = {
    {5, {0, 0, 0.026}}, {9, {0, 0, 0.026}}, {13, {0, 0, 0.026}}, {18, {0, 0, 0.026}}, {23, {0, 0, 0.0275}},
};

constexpr RobotFinger kFingers[] = {
    {"ff", 2, 2, 3, 4},     {"mf", 6, 6, 7, 8},           {"rf", 10, 10, 11, 12},
    {"lf", 14, 15, 16, 17}, {"th", 19, -1, -1, -1, true},
};
constexpr double kFolded[] = {0, 0, 0, 0, 0, 0, 0, 0,     0,   0, 0, 0,
                              0, 0, 0, 0, 0, 0, 0, -1.04, 1.2, 0, 0, -1.57};
constexpr float kClosed[] = {0.4f, 0.7f,  0, 0.3f, 0.1f, 0, 0.1f, 0.1f,  0,     0.35f,
                             0.1f, -0.5f, 0, 0.4f, 0.1f, 1, 0.5f, -0.3f, -0.5f, -0.4f};

// The mount (0.1 kg, 1e-3 kg m2) and the forearm (4 kg, (0.01, 0.01, 0.0075) kg m2, com (0.001, 0.008,
// 0.29)) as one body.
constexpr double kReduced = 0.1 * 4.0 / 4.1;  // kg
constexpr Vec3 kForearmCom = {0.001, 0.008, 0.29};
constexpr Inertia root_inertia() {
  const Vec3 c = kForearmCom;
  return {4.1,
          {c.x * 4.0 / 4.1, c.y * 4.0 / 4.1, c.z * 4.0 / 4.1},
          {0.01 + 1e-3 + kReduced * (c.y * c.y + c.z * c.z), 0.01 + 1e-3 + kReduced * (c.x * c.x + c.z * c.z),
           0.0075 + 1e-3 + kReduced * (c.x * c.x + c.y * c.y), -kReduced * c.x * c.y, -kReduced * c.x * c.z,
           -kReduced * c.y * c.z}};
}

}  // namespace

extern constinit const Robot kShadowHand = {
    .name = "shadow_hand",
    .help = "Shadow Hand, five fingers, 24 joints of which 20 are driven",
    .kind = RobotKind::kHand,
    .alias = "shadow",
    .X_BR = {{}, {0, 0, -kQuarter, kQuarter}},
    .root = root_inertia(),
    .links = table(kLinks),
    .shapes = table(kShapes),
    .self_pairs = table(kPairs),
    .couplings = table(kCouplings),
    .tips = table(kTips),
    .palm = 1,
    .p_palm = {0.011, -0.0111, 0.038},
    .mirror = 1,
    .X_RM = {{0, 0.01, 0}, {}},  // the forearm's
    .fingers = table(kFingers),
    .poses = {table(kFolded), table(kClosed)},
    .p_hold = {0, -0.02, 0.08},
};

}  // namespace rdm
