// Statics and Newton's law: drives carry m g l, contacts carry what lies on a robot, efforts of
// rdm_world_get_gravity hold an arm, and of each body in a pile m dv = h (sum of its listed contact forces + m g)
// in every substep.
#include <algorithm>

#include "lab.hpp"
#include "table.hpp"

namespace truth {
namespace {

Robot arm(double kp, double kd) {
  Link a, b;
  a.mass = 1, a.com = {0.2, 0, 0}, a.moment = {1e-3, 1e-2, 1e-2};
  b.parent = 0, b.p = {0.4, 0, 0}, b.mass = 0.5, b.com = {0.15, 0, 0}, b.moment = {1e-3, 5e-3, 5e-3};
  Robot r;
  for (Link* l : {&a, &b}) l->kp = kp, l->kd = kd, l->effort = 100;
  r.links = {a, b}, r.q0 = {0, 0};
  return r;
}

void held_arm(Rows& rows) {
  double error[2] = {std::nan(""), std::nan("")};
  std::string note;
  try {
    Scene s;
    s.robots = {arm(1000, 20)};
    Lab lab(std::move(s));
    lab.step(300);
    const double q0 = lab.q[0], q1 = lab.q[0] + lab.q[1], outer = 0.5 * kG * 0.15 * std::cos(q1);
    const double exact[2] = {-(kG * (0.2 + 0.5 * 0.4) * std::cos(q0) + outer), -outer};
    for (size_t i = 0; i < 2; ++i) error[i] = std::fabs(lab.torque[i] / exact[i] - 1);
  } catch (const Failure& e) {
    note = e.what();
  }
  rows.add({"arm of two links held level: torque of the shoulder / m g l, off by", 0, 1e-4}, error[0], note);
  rows.add({"arm of two links held level: torque of the elbow / m g l, off by", 0, 1e-4}, error[1], note);
  rows.add({"arm held by rdm_world_get_gravity's efforts alone for 5 s: moves", 0, 1e-3, "rad"}, [] {
    Scene s;
    s.robots = {arm(0, 0.5)};
    s.feedforward = true;
    s.control = [](const Lab&, rdm_world* world) {
      double efforts[2];
      check(rdm_world_get_gravity(world, 0, efforts, 2));
      check(rdm_world_set_feedforward(world, 0, efforts, 2));
    };
    Lab lab(std::move(s));
    lab.step(300);
    return std::max(std::fabs(lab.q[0]), std::fabs(lab.q[1]));
  });
}

void lift(Rows& rows) {
  double carried = std::nan(""), effort = std::nan("");
  std::string note;
  try {
    Link l;
    l.kind = RDM_JOINT_PRISMATIC, l.axis = {0, 0, 1}, l.kp = 2000, l.kd = 100, l.effort = 1000, l.mass = 2,
    l.lower = -1, l.upper = 1;
    l.moment = {1e-2, 1e-2, 1e-2};
    Robot r;
    r.links = {l}, r.q0 = {0};
    r.shapes = {{0, box(0.2, 0.2, 0.02)}};
    Body b;
    b.shapes = {box(0.05, 0.05, 0.05)}, b.mass = 3, b.p = {0, 0, 0.07};
    Scene s;
    s.robots = {r}, s.bodies = {b};
    Lab lab(std::move(s));
    lab.step(300);
    carried = lab.force_on(1)[2] / (3 * kG);
    effort = lab.torque[0] / (5 * kG);
  } catch (const Failure& e) {
    note = e.what();
  }
  rows.add({"box of 3 kg on a lift of 2 kg: contact forces on the box / its weight", 1, 1e-4}, carried, note);
  rows.add({"box of 3 kg on a lift of 2 kg: force of the drive / both weights", 1, 1e-4}, effort, note);
}

// One substep a step, so that the listed forces are those of the whole step.
void newton(Rows& rows) {
  rows.add({"pile of 8 boxes falling down, each substep: |m dv / h - forces - m g| / m g, largest", 0, 1e-4},
           [] {
             Scene s;
             for (int i = 0; i < 8; ++i) {
               Body b;
               b.shapes = {box(0.05, 0.04, 0.03)}, b.p = {0.02 * (i % 3), 0.015 * (i % 2), 0.1 + 0.11 * i};
               b.q = turn({1, 0.5 * i, 0.3}, 0.4 * i);
               s.bodies.push_back(b);
             }
             s.statics = {plane()};
             s.settings = "substeps=1\nfrequency=240\ncontacts_max=200";
             Lab lab(std::move(s));
             double worst = 0;
             for (int k = 0; k < 480; ++k) {
               std::vector<V3> before;
               for (size_t i = 0; i < lab.bodies.size(); ++i) before.push_back(lab.v(i));
               lab.step();
               for (size_t i = 0; i < lab.bodies.size(); ++i) {
                 const V3 force = lab.force_on(static_cast<int32_t>(i)) + V3{0, 0, -kG};
                 worst = std::max(worst, norm(240.0 * (lab.v(i) - before[i]) - force) / kG);
               }
             }
             return worst;
           });
}

}  // namespace

void add_statics(Checks& checks) {
  const char* group = "Statics";
  checks.push_back({group, "held arm", true, held_arm});
  checks.push_back({group, "lift", true, lift});
  checks.push_back({group, "Newton", true, newton});
}

}  // namespace truth
