#include "env/options/robot.hpp"

#include <algorithm>

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
    {JointField::kKp, &RobotLink::kp, 1000, "stiffness of the joint's drive, N m/rad"},
    {JointField::kKd, &RobotLink::kd, 100, "damping of the joint's drive, N m s/rad"},
    {JointField::kEffort, &RobotLink::effort, 1000, "largest torque of the joint's drive, N m"},
    {JointField::kFriction, &RobotLink::friction, 10, "dry friction torque of the joint, N m"},
    {JointField::kArmature, &RobotLink::armature, 1,
     "inertia added about the joint's axis (armature), kg m2"},
};

// What a range of each joint field draws; an armature stays what it is.
constexpr Drawn kDrawnFields[] = {Drawn::kLinkKp, Drawn::kLinkKd, Drawn::kLinkEffort, Drawn::kLinkFriction};

struct ScaleOptions {
  DrawnOption effort, kp, kd, mass, friction;
};
constexpr auto kScales = option_rows<ScaleOptions>(
    row<&ScaleOptions::effort>(
        levelled(number_option("scale.effort", 1, 0.01, 100, "factor on the effort limits of all drives"))),
    row<&ScaleOptions::kp>(
        levelled(number_option("scale.kp", 1, 0, 100, "factor on the stiffness of all drives"))),
    row<&ScaleOptions::kd>(
        levelled(number_option("scale.kd", 1, 0.01, 100, "factor on the damping of all drives"))),
    row<&ScaleOptions::mass>(levelled(number_option(
        "scale.mass", 1, 0.1, 100, "factor on the masses and moments of inertia of all links"))),
    row<&ScaleOptions::friction>(
        levelled(number_option("scale.friction", 1, 0, 100, "factor on the dry friction of all joints"))));

const char* field_name(JointField field) {
  return kJointFields[static_cast<int>(field)];
}

}  // namespace

// One key may stand for links of two robots, and a link that carries a hand weighs more than its own: a default is
// that of the first robot alone, which nothing but a value that was given replaces.
void add_robot_rows(const Robot& robot, OptionTable& table) {
  for (const RobotLink& link : robot.links)
    for (const JointRow& row : kJointRows) {
      // an undamped joint could gain energy
      const double low = row.field == JointField::kKd ? std::min(1e-4, link.kd) : 0;
      const OptionTable::Key key = OptionTable::make_key("joint", link.joint, field_name(row.field));
      if (table.has(key.text)) continue;  // of both hands
      OptionSpec spec = counting_if_given(
          number_option("", link.*row.value, low, std::max(row.high, link.*row.value), row.help));
      spec.range = row.field != JointField::kArmature;
      table.add("joint", link.joint, field_name(row.field), spec);
    }
  for (const RobotLink& link : robot.links) {
    const OptionTable::Key key = OptionTable::make_key("link", link.name, "mass");
    if (link.mass == 0 || table.has(key.text)) continue;
    table.add("link", link.name, "mass",
              counting_if_given(drawable(number_option(
                  "", link.mass, 1e-4, 1000, "mass of the link, kg; its moments of inertia scale with it"))));
  }
}

void add_robot_scales(OptionTable& table) {
  table.add(kScales);
}

void apply_robot_options(const Options& options, const Robot& robot, const char* prefix, int32_t index,
                         int32_t first, ArticulationDef* def, DynamicsDraws* draws) {
  for (int32_t i = 0; i < robot.links.count; ++i) {
    const RobotLink& link = robot.links[i];
    for (const JointRow& row : kJointRows) {
      const OptionTable::Key key = OptionTable::make_key("joint", link.joint, field_name(row.field));
      if (!options.given(key.text)) continue;
      override_joint(def, prefix, link.joint, row.field, options.number(key.text));
      if (row.field != JointField::kArmature)
        draws->add(drawn_option(options, key.text), kDrawnFields[static_cast<int>(row.field)], first + i);
    }
    const OptionTable::Key key = OptionTable::make_key("link", link.name, "mass");
    if (link.mass == 0 || !options.given(key.text)) continue;
    override_mass(def, prefix, link.name, options.number(key.text));
    draws->add(drawn_option(options, key.text), Drawn::kLinkMass, first + i);
  }
  const ScaleOptions scale = kScales.read(options);
  scale_joints(def, JointField::kKp, scale.kp.middle);
  scale_joints(def, JointField::kKd, scale.kd.middle);
  scale_joints(def, JointField::kFriction, scale.friction.middle);
  scale_joints(def, JointField::kEffort, scale.effort.middle);
  scale_mass(def, scale.mass.middle);
  draws->add(scale.kp, Drawn::kLinkKp, first, robot.links.count);
  draws->add(scale.kd, Drawn::kLinkKd, first, robot.links.count);
  draws->add(scale.friction, Drawn::kLinkFriction, first, robot.links.count);
  draws->add(scale.effort, Drawn::kLinkEffort, first, robot.links.count);
  draws->add(scale.mass, Drawn::kLinkMass, first, robot.links.count);
  draws->add(scale.mass, Drawn::kBaseMass, index);
}

}  // namespace rdm
