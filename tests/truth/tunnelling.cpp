// Contacts in time: fast things against thin ones. A thing of 6 cm and .1 kg is shot 24 times at a target,
// from places spread over the way of one substep; "through" is that it crosses the target's middle plane
// within its silhouette. Nothing may go through, whatever the speed, and nothing may leave with more energy
// than it came with. What passes beside a thing, or over the inner edges of flush tiles, is not touched by
// them. All with the option speculative_contacts.
#include <algorithm>

#include "lab.hpp"
#include "table.hpp"

namespace truth {
namespace {

enum class Kind { kWall, kPlate, kFinger };  // stands still; a robot's link, a box; a capsule

struct Target {
  const char* said;
  Kind kind;
  double half;  // m, of its thickness
};

struct Projectile {
  const char* said;
  std::vector<Shape> shapes;
  double half;   // m
  double reach;  // m, its farthest point from the centre
};

std::vector<Projectile> projectiles() {
  const double h = 0.03;
  std::vector<V3> points;
  const V3 rough[] = {{1, 0, 0},  {-1, 0, 0},      {0, 1, 0},          {0, -1, 0},       {0, 0, 1},
                      {0, 0, -1}, {0.6, 0.6, 0.6}, {-0.6, -0.6, -0.6}, {0.6, -0.6, 0.6}, {-0.6, 0.6, -0.6}};
  for (const V3& p : rough) points.push_back(h * p);
  return {{"sphere", {sphere(h)}, h, h},
          {"box", {box(h, h, h)}, h, std::sqrt(3.0) * h},
          {"capsule", {capsule(0.66 * h, h, turn({0, 1, 0}, kPi / 2))}, h, 1.66 * h},
          {"hull", {hull(points)}, h, std::sqrt(3.0) * 0.6 * h}};
}

struct Shots {
  int through = 0, all = 0;
  double deepest = 0;  // mm, of those that stayed before it
  double gained = 0;   // of kinetic energy, / at the start
};

constexpr double kMass = 0.1;  // kg

// The same about all axes, so that the energy of a turn is plain.
double moment_of(const Projectile& p) {
  return 0.4 * kMass * p.half * p.half;
}

Scene range_of(const Target& target, const Projectile& p, int sub) {
  Scene s;
  Body b;
  b.shapes = p.shapes, b.mass = kMass;
  for (double& m : b.moment) m = moment_of(p);
  s.bodies = {b};
  s.gravity = {};
  s.settings = text("speculative_contacts=true\nsubsteps=%d", sub);
  if (target.kind == Kind::kWall) {
    s.statics = {box(target.half, 0.3, 0.3)};
    return s;
  }
  Link l;
  l.axis = {0, 0, 1}, l.kp = 1000, l.kd = 10, l.effort = 1e4, l.moment = {1e-2, 1e-2, 1e-2};
  Robot r;
  r.gravity = false, r.links = {l}, r.q0 = {0};
  r.shapes = {{0, target.kind == Kind::kPlate ? box(target.half, 0.1, 0.1) : capsule(target.half, 0.1)}};
  s.robots = {r};
  return s;
}

double kinetic(const Lab& lab, double inertia) {
  double e = (kMass * dot(lab.v(), lab.v()) + inertia * dot(lab.w(), lab.w())) / 2;
  if (!lab.qd.empty()) e += 1e-2 * lab.qd[0] * lab.qd[0] / 2 + 1000 * lab.q[0] * lab.q[0] / 2;
  return e;
}

void shoot(const Target& target, const Projectile& p, double v, int sub, Shots* out) {
  Lab lab(range_of(target, p, sub));
  const double way = v / 60 / sub;
  const double inertia = moment_of(p);
  for (int k = 0; k < 24; ++k) {
    Body& b = lab.scene.bodies[0];
    const bool small = p.half < 0.01;
    b.p = {-0.25 - way * k / 24, small ? 0 : 0.003 * (k % 5 - 2), small ? 0 : 0.002 * (k % 3 - 1)};
    b.v = {v, 0, 0};
    lab.reset();
    const double start = kinetic(lab, inertia);
    double deepest = 0;
    bool through = false;
    V3 before = lab.p();
    const int steps = std::max(12, static_cast<int>(36 / std::max(v, 0.3)));
    for (int i = 0; i < steps && !through; ++i) {
      lab.step();
      const V3 now = lab.p();
      deepest = std::max(deepest, lab.deepest());
      out->gained = std::max(out->gained, kinetic(lab, inertia) / start - 1);
      if (now[0] > 0 && before[0] <= 0) {
        const double share = -before[0] / (now[0] - before[0]), y = before[1] + share * (now[1] - before[1]);
        // beside it, and out of its reach
        if (target.kind == Kind::kFinger && std::fabs(y) >= target.half + std::min(p.reach, 1.5 * p.half))
          break;
        through = true;
      }
      before = now;
    }
    ++out->all;
    out->through += through;
    if (!through) out->deepest = std::max(out->deepest, 1e3 * deepest);
  }
}

const Target kTargets[] = {
    {"wall of 100 mm", Kind::kWall, 0.05},   {"wall of 20 mm", Kind::kWall, 0.01},
    {"wall of 5 mm", Kind::kWall, 0.0025},   {"plate of 20 mm", Kind::kPlate, 0.01},
    {"plate of 5 mm", Kind::kPlate, 0.0025}, {"finger of 16 mm", Kind::kFinger, 0.008},
};
const double kSpeeds[] = {1, 2, 3, 4, 6, 8, 12};

// Measured in the same shots at h 1/120.
const char* mujoco_through(const Target& t, const Projectile& p) {
  if (t.kind != Kind::kWall || p.shapes[0].kind == RDM_SHAPE_HULL) return "";
  const bool longer = p.shapes[0].kind == RDM_SHAPE_CAPSULE;
  if (t.half == 0.05) return p.shapes[0].kind == RDM_SHAPE_BOX ? "3.6 (h 1/120)" : "4.2 (h 1/120)";
  if (t.half == 0.01) return longer ? "31 (h 1/120)" : "21 (h 1/120)";
  return p.shapes[0].kind == RDM_SHAPE_SPHERE ? "42 at 6 m/s (h 1/120), 100 (h 2 ms)" : "";
}

void through(Rows& rows) {
  const double none = std::nan("");
  for (const Target& t : kTargets) {
    Shots finer, sum;
    std::string notes;
    for (const Projectile& p : projectiles()) {
      Shots shots;
      std::string note;
      try {
        for (const double v : kSpeeds) {
          shoot(t, p, v, 2, &shots);
          shoot(t, p, v, 8, &finer);
        }
      } catch (const Failure& e) {
        note = notes = e.what();
      }
      sum.gained = std::max(sum.gained, shots.gained);
      rows.add({text("%s at a %s, 1 to 12 m/s, 2 substeps: through", p.said, t.said), 0, 0, "%",
                mujoco_through(t, p)},
               note.empty() ? 100.0 * shots.through / shots.all : none, note);
    }
    rows.add({text("all four at a %s, 1 to 12 m/s, 8 substeps: through", t.said), 0, 0, "%"},
             notes.empty() ? 100.0 * finer.through / finer.all : none, notes);
    rows.add({text("all four at a %s, 1 to 12 m/s, 2 and 8 substeps: energy gained", t.said), 0, 0.001},
             notes.empty() ? std::max(sum.gained, finer.gained) : none, notes);
  }
}

void small_balls(Rows& rows) {
  for (const double r : {0.002, 0.005})
    for (const double half : {0.0005, 0.0025, 0.005}) {
      if (r == 0.002 && half == 0.005) continue;
      const Target target = {"", Kind::kWall, half};
      rows.add({text("ball of r %g mm at a plate of %g mm, .5 to 12 m/s, 2 substeps: through", 1e3 * r,
                     2e3 * half),
                0, 0, "%"},
               [&] {
                 Shots shots;
                 for (const double v : {0.5, 1.0, 2.0, 4.0, 12.0})
                   shoot(target, {"ball", {sphere(r)}, r, r}, v, 2, &shots);
                 return 100.0 * shots.through / shots.all;
               });
    }
}

// An egg of 6 cm at 3 m/s.
void depth(Rows& rows) {
  for (const Target& t : {kTargets[0], kTargets[4], kTargets[5]})
    rows.add({text("egg of 3 m/s at a %s, 2 substeps: sinks", t.said), 0, 2, "mm"}, [&] {
      std::vector<V3> points;  // 4.4 x 4.4 x 6 cm
      for (int i = 0; i < 4; ++i)
        for (int k = 0; k < 8; ++k) {
          const double z = std::cos((i + 0.5) * kPi / 4), around = std::sqrt(1 - z * z), a = k * kPi / 4;
          points.push_back({0.03 * z, 0.022 * around * std::cos(a), 0.022 * around * std::sin(a)});
        }
      Shots shots;
      shoot(t, {"egg", {hull(points)}, 0.03, 0.03}, 3, 2, &shots);
      return shots.deepest;
    });
  rows.add({"ball dropped from 3 m onto a plane, 2 substeps: sinks", 0, 2, "mm"}, [] {
    Scene s;
    s.bodies = {{{sphere(0.05)}, 0.1, {0, 0, 3.05}}};
    s.statics = {plane()};
    s.settings = "speculative_contacts=true\nsubsteps=2";
    Lab lab(std::move(s));
    double sinks = 0;
    for (int k = 0; k < 90; ++k) {
      lab.step();
      sinks = std::max(sinks, 1e3 * (0.05 - lab.p()[2]));
    }
    return sinks;
  });
}

// Over tiles that are flush with each other: sliding as on one slab, v0 - mu g t.
void tiles(Rows& rows) {
  struct Slider {
    const char* said;
    Shape shape;
    double height;
  };
  const Slider sliders[] = {{"box", box(0.05, 0.05, 0.02), 0.02},
                            {"ball", sphere(0.03), 0.03},
                            {"cylinder", cylinder(0.05, 0.02), 0.02},
                            {"hull", block(0.05, 0.05, 0.02), 0.02}};
  for (const Slider& s : sliders)
    for (const double laid : {0.0, -0.0005}) {
      double off = 0, hop = 0;
      std::string note;
      try {
        for (const double v : {1.0, 5.0}) {
          Scene scene;
          Body b;
          b.shapes = {s.shape}, b.mass = 0.1, b.p = {0, 0, s.height + laid}, b.v = {v, 0, 0};
          scene.bodies = {b};
          for (int i = 0; i < 40; ++i) {
            scene.statics.push_back(box(0.05, 0.3, 0.05));
            scene.statics.back().p = {0.1 * i, 0, -0.05};
          }
          scene.friction = 0.1;
          scene.settings = "speculative_contacts=true\nsubsteps=2";
          Lab lab(std::move(scene));
          for (int k = 0; k < 36; ++k) {
            lab.step();
            hop = std::max(hop, 1e3 * (lab.p()[2] - s.height));
          }
          const bool rolls = s.shape.kind == RDM_SHAPE_SPHERE && v == 1;  // after .29 s, at 5/7 of its speed
          off = std::max(off, std::fabs(lab.v()[0] - (rolls ? 5.0 / 7 : v - 0.1 * kG * 0.6)));
        }
      } catch (const Failure& e) {
        note = e.what();
        off = hop = std::nan("");
      }
      const std::string at =
          text("%s over tiles, laid %s, 1 and 5 m/s, mu .1: ", s.said, laid == 0 ? "flush" : ".5 mm deep");
      const char* const mujoco = laid != 0                            ? ""
                                 : s.shape.kind == RDM_SHAPE_BOX      ? ".11"
                                 : s.shape.kind == RDM_SHAPE_CYLINDER ? "3.9"
                                                                      : "";
      rows.add({at + "speed after .6 s, off by", 0, 0.03, "m/s", mujoco}, off, note);
      rows.add({at + "hops", 0, 0.6, "mm"}, hop, note);
    }
}

// Past the side of a box, and through a window that is 10 mm wider than the thing.
void ghosts(Rows& rows) {
  for (int what = 0; what < 3; ++what) {
    const char* said[] = {"sphere", "box", "hull"};
    const Shape shapes[] = {sphere(0.03), box(0.03, 0.03, 0.03), block(0.03, 0.03, 0.03)};
    const auto fly = [&](bool window, double v, double clear) {
      double worst = 0;
      for (int k = 0; k < 12; ++k) {
        Body b;
        b.shapes = {shapes[what]}, b.mass = 0.1;
        b.p = {-0.3 - v / 120 * k / 12, window ? 0 : 0.03 + clear, 0}, b.v = {v, window ? 0.05 : 0, 0};
        Scene s;
        s.bodies = {b};
        s.gravity = {};
        if (window) {
          s.statics = {box(0.02, 0.2, 0.3), box(0.02, 0.2, 0.3)};
          s.statics[0].p[1] = 0.235, s.statics[1].p[1] = -0.235;
        } else {
          s.statics = {box(0.05, 0.05, 0.3)};
          s.statics[0].p[1] = -0.05;
        }
        s.settings = "speculative_contacts=true\nsubsteps=2";
        Lab lab(std::move(s));
        lab.step(v > 5 ? 20 : 60);
        worst = std::max(worst, norm(lab.v() - b.v));
      }
      return worst;
    };
    rows.add({text("%s past a box's side, .1, 1, 5 mm clear, 3 and 12 m/s, 2 substeps: change of velocity",
                   said[what]),
              0, 1e-9, "m/s"},
             [&] {
               double worst = 0;
               for (const double v : {3.0, 12.0})
                 for (const double clear : {0.0001, 0.001, 0.005})
                   worst = std::max(worst, fly(false, v, clear));
               return worst;
             });
    rows.add({text("%s through a window 10 mm wider at 12 m/s, 2 substeps: change of velocity", said[what]),
              0, 1e-9, "m/s"},
             [&] { return fly(true, 12, 0); });
  }
}

void manifold(Rows& rows) {
  rows.add({"capsule lying on a box: contact points", 2, 0}, [] {
    Scene s;
    Body b;
    b.shapes = {capsule(0.03, 0.05, turn({0, 1, 0}, kPi / 2))}, b.p = {0, 0, 0.031};
    s.bodies = {b};
    s.statics = {box(0.3, 0.3, 0.05)};
    s.statics[0].p[2] = -0.05;
    Lab lab(std::move(s));
    lab.step(60);
    return static_cast<double>(lab.contacts.size());
  });
}

}  // namespace

void add_tunnelling(Checks& checks) {
  const char* group = "Contacts in time";
  checks.push_back({group, "through", true, through});
  checks.push_back({group, "small balls", true, small_balls});
  checks.push_back({group, "depth", true, depth});
  checks.push_back({group, "tiles", true, tiles});
  checks.push_back({group, "ghosts", true, ghosts});
  checks.push_back({group, "manifold", true, manifold});
}

}  // namespace truth
