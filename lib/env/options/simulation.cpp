#include "env/options/simulation.hpp"

#include <cstdlib>

#include "env/options/simulation_rows.hpp"

namespace rdm {
namespace {

constexpr bool bounds_contacts() {
  for (const OptionSpec& row : kSimulationRows)
    if (row.high == kMostContacts) return true;
  return false;
}
static_assert(bounds_contacts(), "contacts_max goes to kMostContacts");

Integrator integrator_from(const char* text) {
  if (same_name(text, "euler")) return Integrator::kEuler;
  return same_name(text, "trapezoid") ? Integrator::kTrapezoid : Integrator::kAuto;
}

}  // namespace

void add_sim_options(OptionTable& table) {
  table.add(kSimulationRows);
}

EngineKind engine_from(const Options& options) {
  return same_name(options.text("engine"), "ode") ? EngineKind::kOde : EngineKind::kArticulated;
}

SolverDef solver_from(const Options& o) {
  SolverDef s;
  s.substeps = o.integer("substeps");
  s.h = 1 / (o.number("frequency") * s.substeps);
  s.iterations = o.integer("iterations");
  s.relaxation = o.number("relaxation");
  s.erp = o.number("erp");
  s.cfm = o.number("cfm");
  s.contact_erp = o.number("contact_erp");
  s.contact_cfm = o.number("contact_cfm");
  s.contact_layer = o.number("contact_layer");
  s.contact_max_speed = o.number("contact_max_speed");
  s.contacts_per_pair = o.integer("contacts_per_pair");
  s.contacts_max = o.integer("contacts_max");
  s.limit_margin = o.number("limit_margin");
  s.limit_stiffness = o.number("limit_stiffness");
  s.link_armature = o.number("link_armature");
  s.spring_only_effort = same_name(o.text("effort_bounds"), "spring");
  s.exact = o.flag("exact_solver");
  s.integrator = integrator_from(o.text("integrator"));
  s.speculative_contacts = o.flag("speculative_contacts");
  s.double_precision = same_name(o.text("precision"), "double");
  s.lanes = static_cast<int32_t>(std::strtol(o.text("lanes"), nullptr, 10));  // auto: 0
  s.sleep_time = o.number("sleep_time");
  s.sleep_speed = o.number("sleep_speed");
  s.sleep_spin = o.number("sleep_spin");
  return s;
}

Vec3 gravity_from(const Options& options) {
  return {0, 0, -options.number("gravity")};
}

}  // namespace rdm
