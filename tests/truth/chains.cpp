// Chains of rods without drives: what energy and momentum they keep. Free base: rods of .3 m and .1 kg joined
// about y, x, y, x, no gravity, tumbling; energy, momentum and angular momentum stay. Fixed base: pendulums
// about y; energy stays.
#include <algorithm>

#include "lab.hpp"
#include "table.hpp"

namespace truth {
namespace {

constexpr double kLength = 0.3, kMass = 0.1, kAcross = kMass * kLength * kLength / 12;
constexpr V3 kCom = {0, 0, -kLength / 2};

struct Sums {
  double energy = 0;  // J
  V3 momentum{}, about{}, center{};
};

// Of links whose frames are at a joint and whose centres of mass are at `com`.
void add_link(const rdm_motion& m, double mass, const V3& com, const V3& moment, Sums* out) {
  const V4 q = {m.pose.q[0], m.pose.q[1], m.pose.q[2], m.pose.q[3]};
  const V3 arm = rotate(q, com), w = vec(m.w), v = vec(m.v) + cross(w, arm), inside = unrotate(q, w);
  const V3 spin = {moment[0] * inside[0], moment[1] * inside[1], moment[2] * inside[2]};
  out->energy += (mass * dot(v, v) + dot(inside, spin)) / 2;
  out->momentum = out->momentum + mass * v;
  out->about = out->about + mass * cross(vec(m.pose.p) + arm, v) + rotate(q, spin);
  out->center = out->center + mass * (vec(m.pose.p) + arm);
}

Robot free_chain(int joints, double axial) {
  const double q0[] = {0.5, -0.4, 0.8, 0.2}, qd0[] = {3, -5, 4, 2};
  Robot r;
  r.free_base = true, r.gravity = false;
  r.root_mass = kMass, r.root_com = kCom, r.root_moment = {kAcross, kAcross, axial};
  r.v = {0.3, 0.2, 0.1}, r.w = {2, -3, 1};
  for (int i = 0; i < joints; ++i) {
    Link l;
    l.parent = i - 1, l.p = {0, 0, -kLength}, l.axis = i % 2 == 0 ? V3{0, 1, 0} : V3{1, 0, 0};
    l.mass = kMass, l.com = kCom, l.moment = r.root_moment;
    r.links.push_back(l);
    r.q0.push_back(q0[i]), r.qd0.push_back(qd0[i]);
  }
  return r;
}

Sums sums_of(const Lab& lab, const V3& moment) {
  Sums s;
  add_link(lab.bases[0], kMass, kCom, moment, &s);
  for (const rdm_motion& m : lab.links) add_link(m, kMass, kCom, moment, &s);
  const double n = static_cast<double>(lab.links.size() + 1);
  s.center = 1 / (kMass * n) * s.center;
  s.about = s.about - kMass * n * cross(s.center, 1 / (kMass * n) * s.momentum);  // about the centre of mass
  return s;
}

struct FreeCase {
  int joints;
  double axial;
  const char* said;
  const char* mujoco;  // Euler, implicit, RK4: energy after 10 s, h 1/120
};
const FreeCase kFree[] = {
    {1, 1e-4, "2 rods, axial 1e-4 kg m2", ".064, .027, 0 (Euler, implicit, RK4)"},
    {1, kAcross, "2 rods, axial 7.5e-4 kg m2", ".031, .026, 0"},
    {2, 1e-4, "3 rods, axial 1e-4 kg m2", ".022, .006, 0"},
    {3, 1e-5, "4 rods, axial 1e-5 kg m2", "lost after 9.8 s, .068, 0"},
    {3, kAcross, "4 rods, axial 7.5e-4 kg m2", "2.2, .017, .001"},
};

void free_chains(Rows& rows) {
  const auto kept = [](const FreeCase& c, int sub) {
    Scene s;
    s.robots = {free_chain(c.joints, c.axial)};
    s.settings = text("substeps=%d", sub);
    Lab lab(std::move(s));
    const V3 moment = lab.scene.robots[0].root_moment;
    const double e0 = sums_of(lab, moment).energy;
    lab.step(600);
    return sums_of(lab, moment).energy / e0;
  };
  for (const FreeCase& c : kFree) {
    rows.add({text("free %s, 2 substeps: energy after 10 s / start", c.said), 1, 0.05, "", c.mujoco},
             [&] { return kept(c, 2); });
    rows.add({text("free %s, 1, 4, 16 substeps: energy after 10 s, largest change", c.said), 0, 0.05}, [&] {
      double worst = 0;
      for (const int sub : {1, 4, 16}) worst = std::max(worst, std::fabs(kept(c, sub) - 1));
      return worst;
    });
  }
}

// The centre of mass keeps its velocity over 20 s, and the angular momentum its mean over a second.
void momenta(Rows& rows) {
  for (const FreeCase& c : {kFree[0], kFree[2], kFree[3], kFree[4]})
    for (const int sub : {2, 8}) {
      double path = std::nan(""), turned = std::nan("");
      std::string note;
      try {
        Scene s;
        s.robots = {free_chain(c.joints, c.axial)};
        s.settings = text("substeps=%d", sub);
        Lab lab(std::move(s));
        const V3 moment = lab.scene.robots[0].root_moment;
        const Sums start = sums_of(lab, moment);
        V3 first{}, last{}, first_center{};
        for (int k = 0; k < 1200; ++k) {
          lab.step();
          const Sums now = sums_of(lab, moment);
          if (k < 60) first = first + now.about;
          if (k == 59) first_center = now.center;
          if (k >= 1140) last = last + now.about;
        }
        const V3 v1 = first_center - start.center,
                 v2 = 1 / 19.0 * (sums_of(lab, moment).center - first_center);
        path = norm(v2 - v1) / norm(v1);
        turned = norm(last - first) / norm(first);
      } catch (const Failure& e) {
        note = e.what();
      }
      const std::string at = text("free %s, %d substeps", c.said, sub);
      rows.add({at + ": speed of the centre of mass, change in 20 s", 0, 0.001, ""}, path, note);
      rows.add({at + ": angular momentum, change in 20 s", 0, sub == 2 ? 0.05 : 0.01, ""}, turned, note);
    }
}

// Two equal bodies on one passive hinge, 20 rad/s.
void hinge(Rows& rows) {
  for (const int sub : {2, 8}) {
    double second = std::nan(""), ten = std::nan("");
    std::string note;
    try {
      const V3 moment = {1e-4, 1e-4, 1e-4};
      Robot r;
      r.free_base = true, r.gravity = false;
      r.root_mass = 0.1, r.root_com = {0, 0, 0.1}, r.root_moment = moment;
      Link l;
      l.mass = 0.1, l.com = {0, 0, -0.1}, l.moment = moment;
      r.links = {l}, r.q0 = {0}, r.qd0 = {20};
      Scene s;
      s.robots = {r};
      s.settings = text("substeps=%d", sub);
      Lab lab(std::move(s));
      const auto energy = [&] {
        Sums sums;
        add_link(lab.bases[0], 0.1, {0, 0, 0.1}, moment, &sums);
        add_link(lab.links[0], 0.1, {0, 0, -0.1}, moment, &sums);
        return sums.energy;
      };
      const double e0 = energy();
      lab.step(60);
      second = energy() / e0;
      lab.step(540);
      ten = energy() / e0;
    } catch (const Failure& e) {
      note = e.what();
    }
    const std::string at = text("free hinge at 20 rad/s, %d substeps: energy after ", sub);
    rows.add({at + "1 s / start", 1, 0.05, "", sub == 2 ? ".32, .14, 0 (Euler, implicit, RK4)" : ""}, second,
             note);
    rows.add({at + "10 s / start", 1, 0.1, "", sub == 2 ? "2.3, 1.6e8, 4e-4 (Euler, implicit, RK4)" : ""},
             ten, note);
  }
}

struct Pendulum {
  std::vector<double> energy;  // of each control step, above hanging down, / start
};

Pendulum swing(std::vector<double> q0, int sub, const char* settings, int seconds) {
  const V3 moment = {kAcross, kAcross, 1e-6};
  Robot r;
  for (size_t i = 0; i < q0.size(); ++i) {
    Link l;
    l.parent = static_cast<int32_t>(i) - 1, l.p = {0, 0, i == 0 ? 0 : -kLength};
    l.mass = kMass, l.com = kCom, l.moment = moment;
    r.links.push_back(l);
  }
  r.q0 = q0;
  Scene s;
  s.robots = {r};
  s.settings = text("substeps=%d\n%s", sub, settings);
  Lab lab(std::move(s));
  double low = 0;
  for (size_t i = 0; i < q0.size(); ++i) low -= kMass * kG * kLength * (static_cast<double>(i) + 0.5);
  const auto energy = [&] {
    Sums sums;
    for (const rdm_motion& m : lab.links) add_link(m, kMass, kCom, moment, &sums);
    return sums.energy + kG * sums.center[2] - low;
  };
  const double e0 = energy();
  Pendulum p;
  for (int k = 0; k < 60 * seconds; ++k) {
    lab.step();
    p.energy.push_back(energy() / e0);
  }
  return p;
}

void pendulums(Rows& rows) {
  // As it is by default: a damped order 1.
  rows.add(
      {"pendulum from 90 deg: energy after 1 s / start, 2 substeps", 1, 0.035, "", ".012 (Euler), 0 (RK4)"},
      [] { return swing({kPi / 2}, 2, "", 1).energy.back(); });
  rows.add({"pendulum from 90 deg: largest energy gained in 10 s, 2 substeps", 0, 0.01}, [] {
    const Pendulum p = swing({kPi / 2}, 2, "", 10);
    return std::max(0.0, *std::max_element(p.energy.begin(), p.energy.end()) - 1);
  });
  struct Kept {
    const char* said;
    std::vector<double> q0;
    int sub;
    double tolerance;
    const char* mujoco;
  };
  // 5 rods swing chaotically: their energy alone is compared
  for (const Kept& k :
       {Kept{"pendulum from 90 deg", {kPi / 2}, 2, 0.01, ".012 (Euler), 0 (RK4)"},
        Kept{"double pendulum from (2, 1) rad", {2, 1}, 2, 0.15, ".75, 5.9, .008 (Euler, implicit, RK4)"},
        Kept{"double pendulum from (2, 1) rad", {2, 1}, 8, 0.05, ""},
        Kept{
            "chain of 5", {1.2, 0.3, 0.2, 0.1, 0}, 8, 0.15, "14.5, 1, .065 (Euler, implicit, RK4; h 1/120)"}})
    rows.add({text("%s, integrator=trapezoid: energy after 10 s / start, %d substeps", k.said, k.sub), 1,
              k.tolerance, "", k.mujoco},
             [&] { return swing(k.q0, k.sub, "integrator=trapezoid", 10).energy.back(); });
}

}  // namespace

void add_chains(Checks& checks) {
  const char* group = "Chains without drives";
  checks.push_back({group, "free chains", true, free_chains});
  checks.push_back({group, "momenta", true, momenta});
  checks.push_back({group, "hinge", true, hinge});
  checks.push_back({group, "pendulums", true, pendulums});
}

}  // namespace truth
