// The Robotiq 3-Finger Adaptive Gripper: three fingers of three joints, two of them on a scissor; 11 joints,
// 4 motors.
//
// Frames: root is the palm, which faces y; fingers 1 and 2 stand on the -x side at z = +-36 mm, the middle
// one opposes them; the mount is behind the palm. Kinematics, limits and masses are those of ros-industrial's
// description (BSD-2-Clause), moments and shapes fits to its meshes (its own moments are implausible, its
// efforts and velocities placeholders). The real fingers adapt to what they touch; here a motor's command
// says all three joints of a finger, by the map of the source's state publisher without its two jumps: ours,
// with efforts, gains and velocities. "Left" is the mirror image, on which fingers 1 and 2 change places.
#include "robot/tables/rows.hpp"

namespace rdm {
namespace {

using namespace rows;

constexpr RobotLink root_of_finger(const char* name, const char* joint, double z, Range range) {
  return turning(name, joint, -1, {-0.0455, 0.0214, z}, {0, kPi, -kQuarter}, kY, range,
                 {0.05, {0.0047, 0.0079, 0}, {1.217e-5, 1.173e-5, 1.599e-5, 0, 0, 0}}, {20, 1, 3, 2});
}
constexpr RobotLink proximal(const char* name, const char* joint, int32_t parent, Vec3 p, double yaw) {
  return turning(name, joint, parent, p, {0, 0, yaw}, kZ, {0.0495, 1.2218},
                 {0.15, {0.0207, -0.0228, 0}, {6.113e-5, 0.0001252, 0.0001626, 4.592e-5, 0, 0}},
                 {30, 1.5, 5, 2});
}
constexpr RobotLink middle(const char* name, const char* joint, int32_t parent) {
  return turning(name, joint, parent, {0.05, -0.028, 0}, {0, 0, -0.52}, kZ, {0, 1.5708},
                 {0.15, {0.0121, -0.0102, -0.0005}, {2.752e-5, 7.523e-5, 7.903e-5, 0, 0, 0}}, {20, 1, 3, 2});
}
constexpr RobotLink distal(const char* name, const char* joint, int32_t parent) {
  return turning(name, joint, parent, {0.039, 0, 0}, {}, kZ, {-1.2217, -0.0523},
                 {0.05, {0.0112, 0.0035, 0}, {1.163e-5, 1.182e-5, 1.554e-5, -5.485e-6, 0, 0}},
                 {10, 0.5, 1.5, 2});
}

constexpr RobotLink kLinks[] = {
    root_of_finger("finger_1_link_0", "palm_finger_1_joint", 0.036, {-0.1784, 0.192}),
    proximal("finger_1_link_1", "finger_1_joint_1", 0, {0.02, 0, 0}, 0),
    middle("finger_1_link_2", "finger_1_joint_2", 1),
    distal("finger_1_link_3", "finger_1_joint_3", 2),
    root_of_finger("finger_2_link_0", "palm_finger_2_joint", -0.036, {-0.192, 0.1784}),
    proximal("finger_2_link_1", "finger_2_joint_1", 4, {0.02, 0, 0}, 0),
    middle("finger_2_link_2", "finger_2_joint_2", 5),
    distal("finger_2_link_3", "finger_2_joint_3", 6),
    proximal("finger_middle_link_1", "finger_middle_joint_1", -1, {0.0455, 0.0414, 0}, kQuarter),
    middle("finger_middle_link_2", "finger_middle_joint_2", 8),
    distal("finger_middle_link_3", "finger_middle_joint_3", 9),
};

constexpr Color kPalmColor = {66, 68, 72}, kBone = {86, 88, 92}, kTip = {150, 154, 158};

constexpr RobotShape root_shape(int32_t link, const char* name) {
  return box(link, name, {0.0216, 0.0222, 0.0154}, {0.0047, 0.0079, 0}, kPalmColor);
}
constexpr RobotShape proximal_shape(int32_t link, const char* name) {
  return box(link, name, {0.0524, 0.0225, 0.0154}, {0.0207, -0.0228, 0}, kBone, {0.97123, 0, 0, -0.238141});
}
constexpr RobotShape middle_shape(int32_t link, const char* name) {
  return box(link, name, {0.0356, 0.0177, 0.0154}, {0.0121, -0.0102, -0.0005}, kBone);
}
constexpr RobotShape distal_shape(int32_t link, const char* name) {
  return box(link, name, {0.0282, 0.0117, 0.0154}, {0.0112, 0.0035, 0}, kTip, {0.92552, 0, 0, 0.3787});
}

constexpr RobotShape kShapes[] = {
    box(-1, "palm", {0.0664, 0.0524, 0.0651}, {-0.0035, -0.0016, 0}, kPalmColor),
    box(-1, "middle_root", {0.0222, 0.0216, 0.0154}, {0.0376, 0.0261, 0}, kPalmColor),
    root_shape(0, "f1_root"),
    proximal_shape(1, "f1_proximal"),
    middle_shape(2, "f1_middle"),
    distal_shape(3, "f1_distal"),
    root_shape(4, "f2_root"),
    proximal_shape(5, "f2_proximal"),
    middle_shape(6, "f2_middle"),
    distal_shape(7, "f2_distal"),
    proximal_shape(8, "middle_proximal"),
    middle_shape(9, "middle_middle"),
    distal_shape(10, "middle_distal"),
};

// Rows of kShapes that may touch.
constexpr int32_t kPalm = 0, kMiddleRoot = 1, kF1Root = 2, kF1Proximal = 3, kF1Middle = 4, kF1Distal = 5,
                  kF2Root = 6, kF2Proximal = 7, kF2Middle = 8, kF2Distal = 9, kMiddleProximal = 10,
                  kMiddleMiddle = 11, kMiddleDistal = 12;

constexpr RobotPair kPairs[] = {
    {kPalm, kF1Middle},
    {kPalm, kF1Distal},
    {kPalm, kF2Middle},
    {kPalm, kF2Distal},
    {kPalm, kMiddleMiddle},
    {kPalm, kMiddleDistal},
    {kMiddleRoot, kF1Middle},
    {kMiddleRoot, kF1Distal},
    {kMiddleRoot, kF2Middle},
    {kMiddleRoot, kF2Distal},
    {kF1Root, kMiddleMiddle},
    {kF1Root, kMiddleDistal},
    {kF1Proximal, kF2Proximal},
    {kF1Proximal, kF2Middle},
    {kF1Proximal, kF2Distal},
    {kF1Proximal, kMiddleProximal},
    {kF1Proximal, kMiddleMiddle},
    {kF1Proximal, kMiddleDistal},
    {kF1Middle, kF2Proximal},
    {kF1Middle, kF2Middle},
    {kF1Middle, kF2Distal},
    {kF1Middle, kMiddleProximal},
    {kF1Middle, kMiddleMiddle},
    {kF1Middle, kMiddleDistal},
    {kF1Distal, kF2Proximal},
    {kF1Distal, kF2Middle},
    {kF1Distal, kF2Distal},
    {kF1Distal, kMiddleProximal},
    {kF1Distal, kMiddleMiddle},
    {kF1Distal, kMiddleDistal},
    {kF2Root, kMiddleMiddle},
    {kF2Root, kMiddleDistal},
    {kF2Proximal, kMiddleProximal},
    {kF2Proximal, kMiddleMiddle},
    {kF2Proximal, kMiddleDistal},
    {kF2Middle, kMiddleProximal},
    {kF2Middle, kMiddleMiddle},
    {kF2Middle, kMiddleDistal},
    {kF2Distal, kMiddleProximal},
    {kF2Distal, kMiddleMiddle},
    {kF2Distal, kMiddleDistal},
};

// The counts 0..255 of a motor as a command in [-1, 1].
constexpr double count(double g) {
  return g / 127.5 - 1;
}
// A finger's first joint closes up to count 140, the second from there to 240; the third first bends back as
// much as the first closes, which keeps the tip parallel, then comes forward by 15 degrees. All within
// limits.
constexpr double kStop = 70 * kDegree, kStop3 = -1.2217;
constexpr RobotCurve first_joint(int32_t row) {
  return {row, row, 2, {count(0.0495 / kStop * 140), count(140)}, {0.0495, kStop}};
}
constexpr RobotCurve second_joint(int32_t row, int32_t driver) {
  return {row, driver, 2, {count(140), count(240)}, {0, 90 * kDegree}};
}
constexpr RobotCurve third_joint(int32_t row, int32_t driver) {
  return {row,
          driver,
          3,
          {count(0.0523 / kStop * 140), count(140), count(240)},
          {-0.0523, kStop3, -55 * kDegree}};
}
// The scissor goes from 11 degrees apart at count 15 to 11 degrees together at 240, or as far as its limit.
constexpr double kApart = 11 * kDegree, kTogether = -0.1784;
constexpr double kScissorEnd = count(15 + 225 * (kApart - kTogether) / (2 * kApart));
constexpr RobotCurve kCurves[] = {
    {0, 0, 2, {count(15), kScissorEnd}, {kApart, kTogether}},
    first_joint(1),
    second_joint(2, 1),
    third_joint(3, 1),
    {4, 0, 2, {count(15), kScissorEnd}, {-kApart, -kTogether}},
    first_joint(5),
    second_joint(6, 5),
    third_joint(7, 5),
    first_joint(8),
    second_joint(9, 8),
    third_joint(10, 8),
};
constexpr int32_t kCommands[] = {1, 5, 8, 0};  // fingers 1, 2, middle; scissor

constexpr Vec3 kTipPoint = {0.0297, 0.0232, 0};
constexpr RobotTip kTips[] = {{3, kTipPoint}, {7, kTipPoint}, {10, kTipPoint}};
constexpr RobotFinger kFingers[] = {{"f1", 0, 0, 1, -1}, {"f2", 4, -1, 5, -1}, {"mid", 8, -1, 8, -1, true}};

constexpr double kOpen[] = {0, 0.0495, 0, -0.0523, 0, 0.0495, 0, -0.0523, 0.0495, 0, -0.0523};
constexpr float kClosed[] = {-0.25f, -0.25f, -0.4f, 0};

}  // namespace

extern constinit const Robot kRobotiq3f = {
    .name = "robotiq_3f",
    .help = "Robotiq 3-Finger Adaptive Gripper, 11 joints, 4 motors",
    .kind = RobotKind::kHand,
    .alias = "robotiq",
    .X_BR = {},
    // palm and the still root of the middle finger as one body
    .root = {1.35, {-0.0019778, -0.00057407, 0}, {0.0030747, 0.0038405, 0.0032343, -5.4815e-5, 0, 0}},
    .links = table(kLinks),
    .shapes = table(kShapes),
    .self_pairs = table(kPairs),
    .curves = table(kCurves),
    .commands = table(kCommands),
    .home = table(kOpen),
    .tips = table(kTips),
    .palm = kRootLink,
    .p_palm = {0, 0.0508, 0},
    .n_palm = {0, 1, 0},
    .z_palm = {-1, 0, 0},  // from the middle finger to the pair
    .mirror = 2,
    .X_RM = {{0, -0.054, 0}, {kRoot, -kRoot, 0, 0}},
    .fingers = table(kFingers),
    .poses = {table(kOpen), table(kClosed)},
    .p_hold = {0, 0.0608, 0},
};

}  // namespace rdm
