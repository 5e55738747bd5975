// Joint and link parameters of robots as options that every task of hands has: joint.<name>.<field>,
// link.<name>.mass, scale.<field>. All robots of a task that have a joint of that name take its value.
#pragma once
#include "base/option.hpp"
#include "env/dynamics_draw.hpp"
#include "env/option_table.hpp"
#include "robot/robot.hpp"

namespace rdm {

// Rows that another robot has added already are left as they are.
void add_robot_rows(const Robot& robot, OptionTable& table);
void add_robot_scales(OptionTable& table);

// Lays the options over articulation number `index`, whose joints begin at flat link `first`, made from
// `robot` with this prefix. Single values first, then the scales. What was given as a range joins `draws`.
void apply_robot_options(const Options& options, const Robot& robot, const char* prefix, int32_t index,
                         int32_t first, ArticulationDef* def, DynamicsDraws* draws);

}  // namespace rdm
