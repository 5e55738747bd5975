#include "env/options/simulation.hpp"

#include "env/options/simulation_rows.hpp"

namespace rdm {

void add_sim_options(OptionTable& table) {
  table.add(kSimulationRows);
}

EngineKind engine_from(const Options& options) {
  return kSimulationRows.read(options).engine;
}

SolverDef solver_from(const Options& options) {
  SimulationOptions o = kSimulationRows.read(options);
  o.h = 1 / (o.frequency * o.substeps);
  return o;
}

Vec3 gravity_from(const Options& options) {
  return {0, 0, -kSimulationRows.read(options).gravity.middle()};
}

DrawnOption drawn_gravity(const Options& options) {
  return drawn_option(options, kSimulationRows.of<&SimulationOptions::gravity>().key);
}

}  // namespace rdm
