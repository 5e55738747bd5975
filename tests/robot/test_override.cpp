#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "base/error.hpp"
#include "robot/override.hpp"
#include "robot/robot.hpp"

namespace rdm {
namespace {

ArticulationDef hand() {
  return make_articulation(kShadowHand, Side::kRight, {}, "right_");
}

TEST(Override, ChangesOneJoint) {
  ArticulationDef def = hand();
  const ArticulationDef before = hand();
  override_joint(&def, "right_", "FFJ2", JointField::kKp, 3);
  override_joint(&def, "right_", "right_FFJ2", JointField::kKd, 0.5);
  override_joint(&def, "right_", "ffj2", JointField::kEffort, 2);
  override_joint(&def, "right_", "FFJ2", JointField::kFriction, 0.01);
  override_joint(&def, "right_", "FFJ2", JointField::kArmature, 0.002);
  const JointDef& joint = def.links[3].joint;
  EXPECT_EQ(joint.kp, 3);
  EXPECT_EQ(joint.kd, 0.5);
  EXPECT_EQ(joint.effort, 2);
  EXPECT_EQ(joint.friction, 0.01);
  EXPECT_EQ(joint.armature, 0.002);
  for (size_t i = 0; i < def.links.size(); ++i)
    EXPECT_EQ(def.links[i].joint.kp, i == 3 ? 3 : before.links[i].joint.kp);
}

TEST(Override, MassTakesItsMomentsAlong) {
  ArticulationDef def = hand();
  override_mass(&def, "right_", "palm", 0.6);
  EXPECT_EQ(def.links[1].inertia.mass, 0.6);
  EXPECT_DOUBLE_EQ(def.links[1].inertia.moment[0], 2e-3);
}

TEST(Override, ScalesTheWholeRobot) {
  ArticulationDef def = hand();
  const ArticulationDef before = hand();
  scale_joints(&def, JointField::kKp, 2);
  scale_mass(&def, 0.5);
  set_material(&def, 3);
  for (size_t i = 0; i < def.links.size(); ++i) {
    EXPECT_EQ(def.links[i].joint.kp, 2 * before.links[i].joint.kp);
    EXPECT_EQ(def.links[i].inertia.mass, 0.5 * before.links[i].inertia.mass);
  }
  EXPECT_EQ(def.base.mass, 0.5 * before.base.mass);
  for (const ArticulationShape& s : def.shapes) EXPECT_EQ(s.shape.material, 3);
}

TEST(Override, RefusesUnknownNamesAndBadValues) {
  ArticulationDef def = hand();
  try {
    override_joint(&def, "right_", "FFJ22", JointField::kKp, 1);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code, Code::kNotFound);
    EXPECT_NE(std::strstr(e.text, "FFJ2"), nullptr);
  }
  EXPECT_THROW(override_mass(&def, "right_", "tail", 1), Error);
  EXPECT_THROW(override_mass(&def, "right_", "palm", 0), Error);
  EXPECT_THROW(override_joint(&def, "right_", "FFJ2", JointField::kKp, -1), Error);
  EXPECT_THROW(scale_joints(&def, JointField::kKd, std::numeric_limits<double>::quiet_NaN()), Error);
  EXPECT_THROW(scale_mass(&def, 0), Error);
}

TEST(Override, FieldsHaveNames) {
  EXPECT_STREQ(kJointFields[static_cast<int>(JointField::kKp)], "kp");
  EXPECT_STREQ(kJointFields[static_cast<int>(JointField::kKd)], "kd");
  EXPECT_STREQ(kJointFields[static_cast<int>(JointField::kEffort)], "effort");
  EXPECT_STREQ(kJointFields[static_cast<int>(JointField::kFriction)], "friction");
  EXPECT_STREQ(kJointFields[static_cast<int>(JointField::kArmature)], "armature");
}

}  // namespace
}  // namespace rdm
