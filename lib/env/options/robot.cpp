#include "env/options/robot.hpp"

#include <algorithm>
#include <cstdio>

#include "robot/override.hpp"

namespace rdm {
namespace {

struct JointRow {
  JointField field;
  double RobotLink::*value;
  double high;
  const char* help;
};

constexpr JointRow kJointRows[] = {
    {JointField::kKp, &RobotLink::kp, 1000, "drive stiffness, N m/rad"},
    {JointField::kKd, &RobotLink::kd, 100, "drive damping, N m s/rad"},
    {JointField::kEffort, &RobotLink::effort, 1000, "bound of the drive's torque, N m"},
    {JointField::kFriction, &RobotLink::friction, 10, "dry friction torque, N m"},
    {JointField::kArmature, &RobotLink::armature, 1, "inertia added about the axis, kg m2"},
};

constexpr OptionSpec kScales[] = {
    number_option("scale.kp", 1, 0, 100, "factor on the stiffness of all drives"),
    number_option("scale.kd", 1, 0.01, 100, "factor on the damping of all drives"),
    number_option("scale.mass", 1, 0.1, 100, "factor on all link masses and moments"),
    number_option("scale.friction", 1, 0, 100, "factor on the dry friction of all joints"),
};

const char* field_name(JointField field) {
  return kJointFields[static_cast<int>(field)];
}

void make_key(char* key, const char* first, const char* name, const char* last) {
  std::snprintf(key, OptionTable::kKeySize, "%s.%s.%s", first, name, last);
}

}  // namespace

void add_robot_rows(const Robot& robot, OptionTable& table) {
  char key[OptionTable::kKeySize];
  for (const RobotLink& link : robot.links)
    for (const JointRow& row : kJointRows) {
      // an undamped joint could gain energy
      const double low = row.field == JointField::kKd ? std::min(1e-4, link.kd) : 0;
      make_key(key, "joint", link.joint, field_name(row.field));
      if (table.has(key)) continue;  // of both hands
      table.add("joint", link.joint, field_name(row.field),
                number_option("", link.*row.value, low, std::max(row.high, link.*row.value), row.help));
    }
  for (const RobotLink& link : robot.links) {
    make_key(key, "link", link.name, "mass");
    if (link.mass == 0 || table.has(key)) continue;
    table.add("link", link.name, "mass",
              number_option("", link.mass, 1e-4, 1000, "mass, kg; moments follow"));
  }
}

void add_robot_scales(OptionTable& table) {
  table.add(kScales);
}

void apply_robot_options(const Options& options, const Robot& robot, const char* prefix,
                         ArticulationDef* def) {
  char key[OptionTable::kKeySize];
  for (const RobotLink& link : robot.links) {
    for (const JointRow& row : kJointRows) {
      make_key(key, "joint", link.joint, field_name(row.field));
      if (options.given(key)) override_joint(def, prefix, link.joint, row.field, options.number(key));
    }
    make_key(key, "link", link.name, "mass");
    if (link.mass > 0 && options.given(key)) override_mass(def, prefix, link.name, options.number(key));
  }
  scale_joints(def, JointField::kKp, options.number("scale.kp"));
  scale_joints(def, JointField::kKd, options.number("scale.kd"));
  scale_joints(def, JointField::kFriction, options.number("scale.friction"));
  scale_mass(def, options.number("scale.mass"));
}

}  // namespace rdm
