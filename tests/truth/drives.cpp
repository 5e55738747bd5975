// Drives. A step of the target: I q'' = kp (target - q) - kd q', by its two roots; a drive at its bound
// accelerates a link by effort / (I + armature); drives are implicit, so the error is of order 1 in the
// substep.
#include <algorithm>
#include <complex>

#include "lab.hpp"
#include "table.hpp"

namespace truth {
namespace {

Scene driven(double inertia, double kp, double kd, double effort, double armature, double target, int sub) {
  Robot r;
  r.gravity = false;
  Link l;
  l.mass = 0.1, l.moment = {inertia, inertia, inertia};
  l.kp = kp, l.kd = kd, l.effort = effort, l.armature = armature;
  r.links = {l}, r.q0 = {0};
  Scene s;
  s.robots = {r};
  s.settings = text("substeps=%d", sub);
  s.control = [target](const Lab&, rdm_world* world) { check(rdm_world_set_targets(world, 0, &target, 1)); };
  return s;
}

double worst_of_step(double inertia, double kp, double kd, int sub) {
  const std::complex<double> root = std::sqrt(std::complex<double>(kd * kd - 4 * inertia * kp, 0));
  const std::complex<double> a = (-kd + root) / (2 * inertia), b = (-kd - root) / (2 * inertia);
  Lab lab(driven(inertia, kp, kd, 100, 0, 0.5, sub));
  double worst = 0;
  for (int k = 1; k <= 30; ++k) {
    lab.step();
    const double t = k / 60.0;
    const double exact = 0.5 * (1 - ((b * std::exp(a * t) - a * std::exp(b * t)) / (b - a)).real());
    worst = std::max(worst, std::fabs(lab.q[0] - exact));
  }
  return worst;
}

void step_response(Rows& rows) {
  struct Case {
    double inertia, kp, kd, at_2, at_16;
    const char* said;
  };
  for (const Case& c : {Case{1e-3, 1, 0.02, 0.068, 0.0105, "32 rad/s, damping ratio .32"},
                        Case{1e-3, 1, 0.1, 0.0102, 0.0014, "32 rad/s, damping ratio 1.6"},
                        Case{0.05, 5, 0.5, 0.0165, 0.0022, "10 rad/s, damping ratio .5"}})
    for (const int sub : {2, 16})
      rows.add({text("drive of %s, step of .5 rad, %d substeps: worst error", c.said, sub), 0,
                sub == 2 ? c.at_2 : c.at_16, "rad"},
               [&] { return worst_of_step(c.inertia, c.kp, c.kd, sub); });
}

void saturated(Rows& rows) {
  rows.add({"drive at its bound with armature, 1, 2, 8 substeps: rate after 1/12 s", 37.5, 0.01, "rad/s"},
           [] {
             double worst = 37.5;
             for (const int sub : {1, 2, 8}) {
               Lab lab(driven(1e-3, 5, 0, 0.9, 1e-3, 900, sub));
               lab.step(5);
               if (!(std::fabs(lab.qd[0] - 37.5) <= std::fabs(worst - 37.5))) worst = lab.qd[0];
             }
             return worst;
           });
  rows.add({"drive at its bound: torque", 0.9, 1e-6, "N m"}, [] {
    Lab lab(driven(1e-3, 5, 0, 0.9, 1e-3, 900, 2));
    lab.step(5);
    return lab.torque[0];
  });
  rows.add({"action latency: rate after the step of the first target", 0.9 / 2e-3 / 60, 0.01, "rad/s"}, [] {
    Lab lab(driven(1e-3, 5, 0, 0.9, 1e-3, 900, 2));
    lab.step();
    return lab.qd[0];
  });
}

}  // namespace

void add_drives(Checks& checks) {
  const char* group = "Drives";
  checks.push_back({group, "step response", true, step_response});
  checks.push_back({group, "saturated", true, saturated});
}

}  // namespace truth
