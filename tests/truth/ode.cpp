// Engine ode as a cross-check: the same scenes as ODE's bodies and joints. Fast motion has its velocity
// products, a free robot at a limit keeps its momentum, things at rest are carried.
#include <algorithm>

#include "convergence.hpp"
#include "lab.hpp"
#include "table.hpp"

namespace truth {
namespace {

void pendulum(Rows& rows) {
  rows.add({"ode: double pendulum from (1, .5) rad after 1 s, 2 substeps: error", 0, 0.06, "rad"},
           [] { return pendulum_error("engine=ode\nsubsteps=2"); });
  rows.add({"ode: double pendulum, direct solver, 16 substeps: error", 0, 0.015, "rad"},
           [] { return pendulum_error("engine=ode\nsubsteps=16\nexact_solver=1"); });
}

void free_limit(Rows& rows) {
  Robot r;
  r.free_base = true, r.gravity = false;
  r.root_mass = 0.1, r.root_com = {0, 0, 0.1}, r.root_moment = {1e-4, 1e-4, 1e-4};
  Link l;
  l.mass = 0.1, l.com = {0, 0, -0.1}, l.moment = {1e-4, 1e-4, 1e-4}, l.lower = -0.5, l.upper = 0.5;
  r.links = {l}, r.q0 = {0}, r.qd0 = {20};
  double lost_linear = std::nan(""), lost_angular = std::nan("");
  std::string note;
  try {
    Scene s;
    s.robots = {r};
    s.settings = "engine=ode\nsubsteps=2";
    Lab lab(std::move(s));
    const auto sums = [&] {
      V3 linear{}, angular{};
      const rdm_motion* at[2] = {lab.bases.data(), lab.links.data()};
      for (int i = 0; i < 2; ++i) {
        const V4 q = {at[i]->pose.q[0], at[i]->pose.q[1], at[i]->pose.q[2], at[i]->pose.q[3]};
        const V3 arm = rotate(q, {0, 0, i == 0 ? 0.1 : -0.1}), v = vec(at[i]->v) + cross(vec(at[i]->w), arm);
        linear = linear + 0.1 * v;
        angular = angular + 0.1 * cross(vec(at[i]->pose.p) + arm, v) + 1e-4 * vec(at[i]->w);
      }
      return std::array<V3, 2>{linear, angular};
    };
    const auto start = sums();
    lab.step(60);
    const auto end = sums();
    lost_linear = norm(end[0] - start[0]) / norm(start[0]);
    lost_angular = norm(end[1] - start[1]) / norm(start[1]);
  } catch (const Failure& e) {
    note = e.what();
  }
  rows.add({"ode: limit of a free two-body robot at 20 rad/s, 2 substeps: momentum, change", 0, 0.01},
           lost_linear, note);
  rows.add({"ode: limit of a free two-body robot at 20 rad/s, 2 substeps: angular momentum, change", 0, 0.05},
           lost_angular, note);
}

void resting(Rows& rows) {
  const Shape shapes[] = {box(0.05, 0.05, 0.05), cylinder(0.05, 0.05), block(0.05, 0.05, 0.05), sphere(0.05)};
  const char* const said[] = {"box", "cylinder", "hull", "sphere"};
  for (int i = 0; i < 4; ++i)
    rows.add({text("ode: %s at rest, 2 and 8 substeps: contact forces / weight", said[i]), 1, 1e-3}, [&] {
      double worst = 1;
      for (const int sub : {2, 8}) {
        Scene s;
        Body b;
        b.shapes = {shapes[i]}, b.p = {0, 0, 0.051};
        s.bodies = {b}, s.statics = {plane()}, s.friction = 0.5;
        s.settings = text("engine=ode\nsubsteps=%d", sub);
        Lab lab(std::move(s));
        lab.step(120);
        const double carried = lab.force_on(0)[2] / kG;
        if (!(std::fabs(carried - 1) <= std::fabs(worst - 1))) worst = carried;
      }
      return worst;
    });
  rows.add({"ode: sliding from 2 m/s, mu .4, 8 substeps: way", 4 / (2 * 0.4 * kG), 0.003, "m"}, [] {
    Scene s;
    Body b;
    b.shapes = {box(0.05, 0.05, 0.02)}, b.p = {0, 0, 0.02}, b.v = {2, 0, 0};
    s.bodies = {b}, s.statics = {plane()}, s.friction = 0.4;
    s.settings = "engine=ode\nsubsteps=8";
    Lab lab(std::move(s));
    lab.step(180);
    return lab.p()[0];
  });
}

}  // namespace

void add_ode(Checks& checks) {
  const char* group = "Engine ode";
  checks.push_back({group, "pendulum", true, pendulum});
  checks.push_back({group, "free limit", true, free_limit});
  checks.push_back({group, "resting", true, resting});
}

}  // namespace truth
