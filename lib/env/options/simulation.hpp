// Options of time and solver that every task has.
#pragma once
#include "env/dynamics_draw.hpp"
#include "env/option_table.hpp"
#include "physics/world.hpp"

namespace rdm {

void add_sim_options(OptionTable& table);

EngineKind engine_from(const Options& options);
// Solver settings; h follows from frequency and substeps.
SolverDef solver_from(const Options& options);
// Gravity along -z, m/s2, and what worlds draw of it.
Vec3 gravity_from(const Options& options);
DrawnOption drawn_gravity(const Options& options);

}  // namespace rdm
