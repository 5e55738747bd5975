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
    row<&SimulationOptions::engine, EngineKind::kArticulated, EngineKind::kOde>(choosing(
        basic(text_option("engine", "articulated", "articulated|ode",
                          "robots in joint coordinates, or bodies and joints of ODE: slow, a cross-check")))),
    row<&SimulationOptions::frequency>(
        basic(number_option("frequency", 60, 10, 1000, "control steps per second, Hz"))),
    row<&SolverDef::substeps>(
        basic(integer_option("substeps", 2, 1, 16, "physics substeps per control step"))),
    row<&SolverDef::iterations>(integer_option(
        "iterations", 8, 1, 1000, "solver iterations per substep, at most; engine ode takes 8 at most")),
    row<&SimulationOptions::gravity>(drawable(
        basic(number_option("gravity", 9.81, 0, 100, "acceleration along -z, m/s2; hands do not feel it")))),
    row<&SolverDef::relaxation>(
        legacy(number_option("relaxation", 1.3, 0.1, 1.9, "over-relaxation factor of the solver"))),
    row<&SolverDef::erp>(
        legacy(number_option("erp", 0.8, 0, 1, "share of a joint error that one substep corrects"))),
    row<&SolverDef::cfm>(legacy(number_option("cfm", 1e-9, 0, 1, "softness of joint constraints"))),
    row<&SolverDef::contact_erp>(
        number_option("contact_erp", 0.2, 0, 1, "share of a contact's depth that one substep corrects")),
    row<&SolverDef::contact_cfm>(number_option("contact_cfm", 1e-4, 0, 1, "softness of contacts")),
    row<&SolverDef::contact_layer>(number_option(
        "contact_layer", 0.0005, 0, 0.01,
        "depth at which bodies rest, m; less for thin ones: a twentieth of half their thickness")),
    row<&SolverDef::contact_max_speed>(
        number_option("contact_max_speed", 0, 0, 100,
                      "bound of depth correction, m/s; 0: 1 in engine ode, 0.4 in engine articulated")),
    row<&SolverDef::contacts_per_pair>(
        integer_option("contacts_per_pair", 4, 1, 8, "contact points of one pair of shapes")),
    row<&SolverDef::contacts_max>(
        integer_option("contacts_max", 36, 0, kMostContacts,
                       "contact points of a world in one substep; 0: as the scene's shapes need")),
    row<&SolverDef::limit_margin>(
        number_option("limit_margin", 5e-3, 0, 0.1, "how far a joint may leave its range, rad")),
    row<&SolverDef::limit_stiffness>(
        number_option("limit_stiffness", 100, 0, 1e5, "stiffness of joint limits, N m/rad")),
    row<&SolverDef::link_armature>(legacy(
        number_option("link_armature", 3e-5, 0, 0.1, "inertia added to finger links in engine ode, kg m2"))),
    row<&SolverDef::spring_only_effort, false, true>(
        text_option("effort_bounds", "drive", "drive|spring",
                    "what a joint's effort limit bounds: spring and damping, or the spring alone")),
    row<&SolverDef::integrator, Integrator::kAuto, Integrator::kEuler, Integrator::kTrapezoid>(
        text_option("integrator", "auto", "auto|euler|trapezoid",
                    "engine articulated: how robots move; auto: trapezoid for free bases that little damps")),
    row<&SolverDef::double_precision, false, true>(
        text_option("precision", "single", "single|double",
                    "engine articulated: arithmetic; double is a reference, half as fast")),
    row<&SolverDef::lanes, 0, 1, 4, 8, 16>(
        text_option("lanes", "auto", "auto|1|4|8|16",
                    "engine articulated: numbers computed at a time; the results are the same")),
    row<&SolverDef::sleep_time>(number_option(
        "sleep_time", 0, 0, 100,
        "engine articulated: bodies that were slow for so long sleep until touched, s; 0: never")),
    row<&SolverDef::sleep_speed>(
        number_option("sleep_speed", 0.01, 0, 10, "speed below which a body is slow, m/s")),
    row<&SolverDef::sleep_spin>(
        number_option("sleep_spin", 0.25, 0, 100, "angular speed below which a body is slow, rad/s")),
    row<&SolverDef::speculative_contacts>(flag_option(
        "speculative_contacts", false,
        "engine articulated: fast bodies stop at what they would pass through; costs some speed")),
    row<&SolverDef::exact>(legacy(flag_option(
        "exact_solver", true,
        "engine ode: the direct solver; false: QuickStep's eight sweeps, in which grips slip, for piles"))));

}  // namespace rdm
