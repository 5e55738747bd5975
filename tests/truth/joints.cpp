// Joints. Dry friction sticks below its torque and takes it away above; a coupling ties both ways, q2 = r q1,
// and the leader feels r^2 times the follower's inertia; a limit stops a joint the same at all substeps, and
// moves no momentum of a free body.
#include <algorithm>

#include "lab.hpp"
#include "table.hpp"

namespace truth {
namespace {

Link hinge(double inertia) {
  Link l;
  l.mass = 0.1, l.moment = {inertia, inertia, inertia};
  return l;
}

Scene of(Robot r, int sub) {
  r.gravity = r.free_base ? false : r.gravity;
  Scene s;
  s.robots = {std::move(r)};
  s.settings = text("substeps=%d", sub);
  return s;
}

double rate_after_push(double share, double effort, int sub, bool angle) {
  Robot r;
  r.gravity = false;
  r.links = {hinge(1e-3)}, r.links[0].friction = 0.05, r.links[0].effort = effort;
  r.q0 = {0};
  Scene s = of(r, sub);
  s.feedforward = true;
  s.control = [share](const Lab&, rdm_world* world) {
    const double torque = 0.05 * share;
    check(rdm_world_set_feedforward(world, 0, &torque, 1));
  };
  Lab lab(std::move(s));
  lab.step(60);
  return angle ? lab.q[0] : lab.qd[0];
}

void dry_friction(Rows& rows) {
  for (const double share : {0.5, 0.9, 1.1, 1.5})
    for (const int sub : {2, 16}) {
      const double exact = std::max(0.0, (share - 1) * 0.05 / 1e-3);
      rows.add({text("dry friction, %g of breakaway, %d substeps: rate after 1 s", share, sub), exact,
                share < 1 ? 1e-4 : 0.02 * exact, "rad/s",
                sub != 2       ? ""
                : share == 0.5 ? ".026 (h 1/120)"
                : share == 0.9 ? ".047 (h 1/120)"
                               : ".004 (h 1/120)"},
               [&] { return rate_after_push(share, 10, sub, false); });
    }
  rows.add({"dry friction, 1.5 of breakaway, 2 substeps: angle after 1 s", 12.5, 0.25, "rad"},
           [] { return rate_after_push(1.5, 10, 2, true); });
  // its bound is its own: a drive of no effort has no part in it
  rows.add({"dry friction without a drive, from 20 rad/s, 2 substeps: angle to rest", 4, 0.08, "rad",
            ".082 (h 1/120)"},
           [] {
             Robot r;
             r.gravity = false;
             r.links = {hinge(1e-3)}, r.links[0].friction = 0.05;
             r.q0 = {0}, r.qd0 = {20};
             Lab lab(of(r, 2));
             lab.step(60);
             return lab.q[0];
           });
  // held against gravity: .9 of the breakaway torque at the start, m g l
  rows.add({"arm held level by dry friction of 1.1 m g l, 2 substeps: falls in 5 s", 0, 1e-3, "rad"}, [] {
    Robot r;
    Link l = hinge(1e-3);
    l.com = {0.1, 0, 0}, l.friction = 1.1 * 0.1 * kG * 0.1, l.effort = 10;
    r.links = {l}, r.q0 = {0};
    Lab lab(of(r, 2));
    lab.step(300);
    return lab.q[0];
  });
}

void couplings(Rows& rows) {
  for (const double ratio : {1.0, 2.0, -0.5})
    for (const int sub : {2, 16}) {
      double leader = std::nan(""), gap = std::nan(""), back = std::nan("");
      std::string note;
      const double inertia = 1e-3 + ratio * ratio * 1e-3, exact = 0.01 / inertia / 8;  // after .5 s
      try {
        for (const int pushed : {0, 1}) {
          Robot r;
          r.gravity = false;
          r.links = {hinge(1e-3), hinge(1e-3)};
          r.links[0].effort = r.links[1].effort = 10;
          r.links[1].kp = 10, r.links[1].p = {0.1, 0, 0};
          Coupling c;
          c.ratio = ratio;
          r.couplings = {c};
          r.q0 = {0, 0};
          Scene s = of(r, sub);
          s.feedforward = true;
          s.control = [pushed](const Lab&, rdm_world* world) {
            const double torque[2] = {pushed == 0 ? 0.01 : 0, pushed == 1 ? 0.01 : 0};
            check(rdm_world_set_feedforward(world, 0, torque, 2));
          };
          Lab lab(std::move(s));
          lab.step(30);
          if (pushed == 0) leader = lab.q[0], gap = lab.q[1] - ratio * lab.q[0];
          if (pushed == 1) back = lab.q[0];
        }
      } catch (const Failure& e) {
        note = e.what();
      }
      const std::string at = text("coupling of ratio %g, %d substeps: ", ratio, sub);
      rows.add({at + "leader pushed for .5 s turns", exact, 0.03 * exact, "rad",
                sub == 2 ? text("%.2g (h 1/120)", 0.017 * exact) : ""},
               leader, note);
      rows.add({at + "follower's gap", 0, 0.005, "rad", sub == 2 ? "4e-4 (h 1/120)" : ""}, gap, note);
      rows.add({at + "follower pushed for .5 s, leader turns", ratio * exact, 0.03 * std::fabs(ratio * exact),
                "rad"},
               back, note);
    }
}

void limits(Rows& rows) {
  struct Case {
    double inertia, rate;
  };
  for (const Case& c : {Case{1e-3, 5}, Case{1e-3, 50}, Case{1e-5, 50}, Case{0.5, 10}}) {
    double back[3] = {}, beyond = 0;
    std::string note;
    try {
      int i = 0;
      for (const int sub : {2, 8, 16}) {
        Robot r;
        r.gravity = false;
        r.links = {hinge(c.inertia)}, r.links[0].lower = -1, r.links[0].upper = 1;
        r.q0 = {0}, r.qd0 = {c.rate};
        Lab lab(of(r, sub));
        for (int k = 0; k < 60; ++k) {
          lab.step();
          back[i] = std::max(back[i], -lab.qd[0] / c.rate);
          beyond = std::max(beyond, lab.q[0] - 1);
        }
        ++i;
      }
    } catch (const Failure& e) {
      note = e.what();
      back[0] = beyond = std::nan("");
    }
    const std::string at = text("limit, %g kg m2 at %g rad/s, ", c.inertia, c.rate);
    rows.add({at + "2, 8, 16 substeps: speed back / in, spread", 0, 0.02},
             std::max({back[0], back[1], back[2]}) - std::min({back[0], back[1], back[2]}), note);
    rows.add({at + "2, 8, 16 substeps: beyond", 0, 0.1, "rad"}, beyond, note);
  }
  // two bodies of a free base on a limit: inner forces move no momentum
  for (const int sub : {2, 16})
    rows.add({text("limit of a free two-body robot at 20 rad/s, %d substeps: angular momentum, change", sub),
              0, 0.01},
             [&] {
               Robot r;
               r.free_base = true;
               r.root_mass = 0.1, r.root_com = {0, 0, 0.1}, r.root_moment = {1e-4, 1e-4, 1e-4};
               r.links = {hinge(1e-4)};
               r.links[0].com = {0, 0, -0.1}, r.links[0].lower = -0.5, r.links[0].upper = 0.5;
               r.q0 = {0}, r.qd0 = {20};
               Lab lab(of(r, sub));
               const auto about = [&] {
                 V3 sum{};
                 const rdm_motion* at[2] = {lab.bases.data(), lab.links.data()};
                 for (int i = 0; i < 2; ++i) {
                   const V4 q = {at[i]->pose.q[0], at[i]->pose.q[1], at[i]->pose.q[2], at[i]->pose.q[3]};
                   const V3 arm = rotate(q, {0, 0, i == 0 ? 0.1 : -0.1});
                   sum = sum +
                         0.1 * cross(vec(at[i]->pose.p) + arm, vec(at[i]->v) + cross(vec(at[i]->w), arm)) +
                         1e-4 * vec(at[i]->w);
                 }
                 return sum;
               };
               const V3 start = about();
               lab.step(60);
               return norm(about() - start) / norm(start);
             });
}

}  // namespace

void add_joints(Checks& checks) {
  const char* group = "Joints";
  checks.push_back({group, "dry friction", true, dry_friction});
  checks.push_back({group, "couplings", true, couplings});
  checks.push_back({group, "limits", true, limits});
}

}  // namespace truth
