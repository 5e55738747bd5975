// Joint and link parameters of a robot as options that every task has: joint.<name>.<field>,
// link.<name>.mass, scale.<field>. Both hands take the same values.
#pragma once
#include "base/option.hpp"
#include "env/options/table.hpp"
#include "robot/robot.hpp"

namespace rdm {

void add_robot_options(const Robot& robot, OptionTable& table);

// Lays the options over an articulation made from `robot` with this prefix. Single values first, then the
// scales.
void apply_robot_options(const Options& options, const Robot& robot, const char* prefix,
                         ArticulationDef* def);

}  // namespace rdm
