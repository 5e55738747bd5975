// The rows of time and solver that every task of a world with an engine has, over the engine's own SolverDef. The reader of .task
// files, which is in a library of its own, takes the table from here.
#pragma once
#include "base/option_rows.hpp"
#include "physics/world.hpp"

namespace rdm {

struct SimulationOptions : SolverDef {
  EngineKind engine;
  double frequency;     // Hz
  OptionRange gravity;  // m/s2, along -z
};

// A task may have other numbers for each engine.
inline constexpr auto kSimulationRows = option_rows<SimulationOptions>(
    row<&SimulationOptions::engine, EngineKind::kArticulated, EngineKind::kOde>(choosing(basic(text_option(
        "engine", "articulated", "articulated|ode",
        "articulated: robots in joint coordinates; ode: bodies and joints of ODE, a slow cross-check")))),
    row<&SimulationOptions::frequency>(
        basic(number_option("frequency", 60, 10, 1000, "number of control steps per second, Hz"))),
    row<&SolverDef::substeps>(
        basic(integer_option("substeps", 2, 1, 16, "number of physics substeps in a control step"))),
    row<&SolverDef::iterations>(
        integer_option("iterations", 8, 1, 1000,
                       "largest number of solver iterations per substep; engine=ode uses at most 8")),
    row<&SimulationOptions::gravity>(drawable(basic(number_option(
        "gravity", 9.81, 0, 100, "acceleration of gravity along -z, m/s2; hands are not subject to it")))),
    row<&SolverDef::relaxation>(
        legacy(number_option("relaxation", 1.3, 0.1, 1.9, "over-relaxation factor of the solver"))),
    row<&SolverDef::erp>(legacy(number_option(
        "erp", 0.8, 0, 1, "share of a joint error that one substep corrects (error reduction parameter)"))),
    row<&SolverDef::cfm>(
        legacy(number_option("cfm", 1e-9, 0, 1, "softness of joint constraints (constraint force mixing)"))),
    row<&SolverDef::contact_erp>(number_option(
        "contact_erp", 0.2, 0, 1, "share of a contact's penetration depth that one substep corrects")),
    row<&SolverDef::contact_cfm>(
        number_option("contact_cfm", 1e-4, 0, 1, "softness of contacts (constraint force mixing)")),
    row<&SolverDef::contact_layer>(number_option(
        "contact_layer", 0.0005, 0, 0.01,
        "penetration depth at which bodies rest, m; thin bodies: at most 1/20 of half their thickness")),
    row<&SolverDef::contact_max_speed>(number_option(
        "contact_max_speed", 0, 0, 100,
        "largest speed at which penetration is corrected, m/s; 0: 0.4 with engine=articulated, 1 with ode")),
    row<&SolverDef::contacts_per_pair>(
        integer_option("contacts_per_pair", 4, 1, 8, "largest number of contact points of a pair of shapes")),
    row<&SolverDef::contacts_max>(integer_option(
        "contacts_max", 36, 0, kMostContacts,
        "largest number of contact points of a world in a substep; 0: as many as its shapes need")),
    row<&SolverDef::limit_margin>(
        number_option("limit_margin", 5e-3, 0, 0.1, "angle by which a joint may leave its range, rad")),
    row<&SolverDef::limit_stiffness>(
        number_option("limit_stiffness", 100, 0, 1e5, "stiffness of the joint limits, N m/rad")),
    row<&SolverDef::link_armature>(legacy(number_option(
        "link_armature", 3e-5, 0, 0.1, "inertia added to finger links with engine=ode, kg m2"))),
    row<&SolverDef::spring_only_effort, false, true>(text_option(
        "effort_bounds", "drive", "drive|spring",
        "torque that a joint's effort limit bounds: drive: spring plus damping; spring: the spring alone")),
    row<&SolverDef::integrator, Integrator::kAuto, Integrator::kEuler, Integrator::kTrapezoid>(text_option(
        "integrator", "auto", "auto|euler|trapezoid",
        "integration of robots (engine=articulated); auto: trapezoid for free bases with little damping")),
    row<&SolverDef::double_precision, false, true>(text_option(
        "precision", "single", "single|double",
        "floating-point arithmetic (engine=articulated); double is a reference at half the speed")),
    row<&SolverDef::lanes, 0, 1, 4, 8, 16>(text_option("lanes", "auto", "auto|1|4|8|16",
                                                       "numbers computed at once by a vector instruction "
                                                       "(engine=articulated); results do not depend on it")),
    row<&SolverDef::sleep_time>(
        number_option("sleep_time", 0, 0, 100,
                      "bodies slow for this long are fixed until touched, s (engine=articulated); 0: never")),
    row<&SolverDef::sleep_speed>(number_option(
        "sleep_speed", 0.01, 0, 10, "speed below which a body counts as slow for sleep_time, m/s")),
    row<&SolverDef::sleep_spin>(number_option(
        "sleep_spin", 0.25, 0, 100, "angular speed below which a body counts as slow for sleep_time, rad/s")),
    row<&SolverDef::speculative_contacts>(flag_option(
        "speculative_contacts", false,
        "fast bodies stop at obstacles instead of passing through them (engine=articulated); slower")),
    row<&SolverDef::exact>(legacy(flag_option(
        "exact_solver", true,
        "engine=ode: direct solver; false: QuickStep with 8 sweeps, faster for piles, but grips slip"))));

}  // namespace rdm
