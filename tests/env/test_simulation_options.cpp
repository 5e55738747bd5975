#include <gtest/gtest.h>

#include "base/error.hpp"
#include "env/options/simulation.hpp"

namespace rdm {
namespace {

Options sim_options(std::initializer_list<OptionInput> inputs) {
  struct Filled : SizedOptionTable<64> {
    Filled() { add_sim_options(*this); }
  };
  static const Filled table;
  Options o;
  o.add_table(table.rows(), table.count());
  for (const OptionInput& in : inputs) o.set(in, "test");
  return o;
}

TEST(SimOptions, DefaultsAreTheSolversOwn) {
  const SolverDef s = solver_from(sim_options({})), d;
  EXPECT_EQ(s.h, d.h);
  EXPECT_EQ(s.substeps, d.substeps);
  EXPECT_EQ(s.iterations, d.iterations);
  EXPECT_EQ(s.relaxation, d.relaxation);
  EXPECT_EQ(s.erp, d.erp);
  EXPECT_EQ(s.cfm, d.cfm);
  EXPECT_EQ(s.contact_erp, d.contact_erp);
  EXPECT_EQ(s.contact_cfm, d.contact_cfm);
  EXPECT_EQ(s.contact_layer, d.contact_layer);
  EXPECT_EQ(s.contact_max_speed, d.contact_max_speed);
  EXPECT_EQ(s.contacts_per_pair, d.contacts_per_pair);
  EXPECT_EQ(s.contacts_max, d.contacts_max);
  EXPECT_EQ(s.limit_margin, d.limit_margin);
  EXPECT_EQ(s.limit_stiffness, d.limit_stiffness);
  EXPECT_EQ(s.link_armature, d.link_armature);
  EXPECT_EQ(s.spring_only_effort, d.spring_only_effort);
  EXPECT_TRUE(s.exact);  // of worlds; a SolverDef alone takes QuickStep
  EXPECT_EQ(s.integrator, d.integrator);
  EXPECT_EQ(s.speculative_contacts, d.speculative_contacts);
  EXPECT_EQ(s.sleep_time, d.sleep_time);
  EXPECT_EQ(s.sleep_speed, d.sleep_speed);
  EXPECT_EQ(s.sleep_spin, d.sleep_spin);
  EXPECT_EQ(engine_from(sim_options({})), EngineKind::kArticulated);
  EXPECT_EQ(gravity_from(sim_options({})).z, -9.81);
}

TEST(SimOptions, EachReachesTheSolver) {
  const Options o = sim_options({{"frequency", nullptr, 30},
                                 {"substeps", nullptr, 4},
                                 {"iterations", nullptr, 6},
                                 {"gravity", nullptr, 1.62},
                                 {"relaxation", nullptr, 1.1},
                                 {"erp", nullptr, 0.5},
                                 {"cfm", nullptr, 1e-8},
                                 {"contact_erp", nullptr, 0.3},
                                 {"contact_cfm", nullptr, 1e-5},
                                 {"contact_layer", nullptr, 0.001},
                                 {"contact_max_speed", nullptr, 2},
                                 {"contacts_per_pair", nullptr, 3},
                                 {"contacts_max", nullptr, 32},
                                 {"limit_margin", nullptr, 1e-3},
                                 {"limit_stiffness", nullptr, 50},
                                 {"link_armature", nullptr, 1e-5},
                                 {"effort_bounds", "spring", 0},
                                 {"exact_solver", "false", 0},
                                 {"integrator", "trapezoid", 0},
                                 {"speculative_contacts", "true", 0},
                                 {"sleep_time", nullptr, 0.5},
                                 {"sleep_speed", nullptr, 0.002},
                                 {"sleep_spin", nullptr, 0.03},
                                 {"engine", "ode", 0}});
  const SolverDef s = solver_from(o);
  EXPECT_DOUBLE_EQ(s.h, 1.0 / 120);
  EXPECT_EQ(s.substeps, 4);
  EXPECT_EQ(s.iterations, 6);
  EXPECT_EQ(s.relaxation, 1.1);
  EXPECT_EQ(s.erp, 0.5);
  EXPECT_EQ(s.cfm, 1e-8);
  EXPECT_EQ(s.contact_erp, 0.3);
  EXPECT_EQ(s.contact_cfm, 1e-5);
  EXPECT_EQ(s.contact_layer, 0.001);
  EXPECT_EQ(s.contact_max_speed, 2);
  EXPECT_EQ(s.contacts_per_pair, 3);
  EXPECT_EQ(s.contacts_max, 32);
  EXPECT_EQ(s.limit_margin, 1e-3);
  EXPECT_EQ(s.limit_stiffness, 50);
  EXPECT_EQ(s.link_armature, 1e-5);
  EXPECT_TRUE(s.spring_only_effort);
  EXPECT_FALSE(s.exact);
  EXPECT_EQ(s.integrator, Integrator::kTrapezoid);
  EXPECT_TRUE(s.speculative_contacts);
  EXPECT_EQ(s.sleep_time, 0.5);
  EXPECT_EQ(s.sleep_speed, 0.002);
  EXPECT_EQ(s.sleep_spin, 0.03);
  EXPECT_EQ(engine_from(o), EngineKind::kOde);
  EXPECT_EQ(gravity_from(o).z, -1.62);
}

TEST(SimOptions, MoreThanAThousandIterationsAreRefused) {
  EXPECT_EQ(guard([] { sim_options({{"iterations", nullptr, 1001}}); }), Code::kRange);
}

}  // namespace
}  // namespace rdm
