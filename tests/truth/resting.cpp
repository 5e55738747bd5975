// Things at rest: their contacts carry their weight, sink no deeper than the layer that is left alone, and
// stacks, a pyramid and a round arch of nine voussoirs stand where they were put.
#include <algorithm>

#include "lab.hpp"
#include "table.hpp"

namespace truth {
namespace {

struct Thing {
  const char* said;
  Shape shape;
  double mass, height, tolerance;  // tolerance: of what it sinks, mm
};

void weights(Rows& rows) {
  const Thing things[] = {
      {"box of 1 kg", box(0.05, 0.05, 0.05), 1, 0.05, 0.55},
      {"box of 50 kg", box(0.1, 0.1, 0.1), 50, 0.1, 1.05},
      {"box of 1 g", box(0.005, 0.005, 0.005), 0.001, 0.005, 0.55},
      {"cylinder", cylinder(0.05, 0.05), 1, 0.05, 0.55},
      {"hull", block(0.05, 0.05, 0.05), 1, 0.05, 0.55},
      {"capsule", capsule(0.03, 0.05, turn({0, 1, 0}, kPi / 2)), 1, 0.03, 0.55},
  };
  for (const Thing& t : things) {
    double force = 1, sinks = 0, speed = 0;
    for (const int sub : {1, 2, 8}) {
      Scene s;
      s.bodies = {{{t.shape}, t.mass, {0, 0, t.height + 0.001}}};
      s.statics = {plane()};
      s.friction = 0.5;
      s.settings = text("substeps=%d", sub);
      Lab lab(std::move(s));
      lab.step(120);
      const double carried = lab.force_on(0)[2] / (t.mass * kG);
      if (!(std::fabs(carried - 1) <= std::fabs(force - 1))) force = carried;
      speed = std::max(speed, norm(lab.v()));
      if (sub > 1) sinks = std::max(sinks, 1e3 * (t.height - lab.p()[2]));
    }
    rows.add({text("%s, 1, 2, 8 substeps: contact forces / weight", t.said), 1, 1e-4}, force);
    rows.add({text("%s, 1, 2, 8 substeps: speed", t.said), 0, 1e-4, "m/s"}, speed);
    rows.add({text("%s, 2 and 8 substeps: sinks", t.said), 0, t.tolerance, "mm"}, sinks);
  }
}

double farthest(const Lab& lab) {  // mm
  double far = 0;
  for (size_t i = 0; i < lab.bodies.size(); ++i) far = std::max(far, norm(lab.p(i) - lab.scene.bodies[i].p));
  return 1e3 * far;
}

Scene pile(std::vector<Body> bodies, double mu, int sub, const char* settings = "") {
  Scene s;
  s.bodies = std::move(bodies), s.statics = {plane()}, s.friction = mu;
  s.settings = text("substeps=%d\ncontacts_max=300\n%s", sub, settings);
  return s;
}

Body cube(const V3& p) {
  Body b;
  b.shapes = {box(0.05, 0.05, 0.05)}, b.p = p;
  return b;
}

void stacks(Rows& rows) {
  struct Case {
    int boxes;
    double sinks, aside;
  };
  for (const int sub : {2, 8})
    for (const Case& c : {Case{5, 3, 1}, Case{10, 6, 2}, Case{20, 13, 5}}) {
      std::vector<Body> bodies;
      for (int i = 0; i < c.boxes; ++i) bodies.push_back(cube({0, 0, 0.05 + 0.1 * i}));
      Lab lab(pile(bodies, 0.5, sub));
      lab.step(300);
      const size_t top = bodies.size() - 1;
      const std::string at = text("stack of %d boxes after 5 s, %d substeps: top ", c.boxes, sub);
      const char* const mujoco = sub != 2 ? "" : c.boxes == 5 ? ".8" : c.boxes == 10 ? "3.1" : "12";
      rows.add({at + "sinks", 0, c.sinks, "mm", mujoco}, 1e3 * (bodies[top].p[2] - lab.p(top)[2]));
      rows.add({at + "goes aside", 0, c.aside, "mm", sub == 2 && c.boxes == 20 ? "69" : ""},
               1e3 * std::hypot(lab.p(top)[0], lab.p(top)[1]));
    }
}

// Contacts in time find points a little before things touch; what lies is as it was.
void stack_in_time(Rows& rows) {
  rows.add({"stack of 10 boxes after 5 s, speculative_contacts, 2 substeps: top sinks", 0, 6, "mm"}, [] {
    std::vector<Body> bodies;
    for (int i = 0; i < 10; ++i) bodies.push_back(cube({0, 0, 0.05 + 0.1 * i}));
    Lab lab(pile(bodies, 0.5, 2, "speculative_contacts=true"));
    lab.step(300);
    return 1e3 * (bodies[9].p[2] - lab.p(9)[2]);
  });
}

void pyramid(Rows& rows) {
  for (const int sub : {2, 8}) {
    std::vector<Body> bodies;
    for (int row = 0; row < 5; ++row)
      for (int i = 0; i < 5 - row; ++i)
        bodies.push_back(cube({0.11 * (i - (4 - row) / 2.0), 0, 0.05 + 0.1 * row}));
    Lab lab(pile(bodies, 0.5, sub));
    lab.step(300);
    rows.add({text("pyramid of 15 boxes after 5 s, %d substeps: farthest", sub), 0, 3, "mm"}, farthest(lab));
  }
}

void arch(Rows& rows) {
  const int n = 9;
  const double radius[] = {0.45, 0.6};
  for (const int sub : {2, 8}) {
    std::vector<Body> bodies;
    for (int i = 0; i < n; ++i) {
      const double angle[] = {kPi * i / n, kPi * (i + 1) / n};
      // centroid of the quadrilateral, by its edges
      double x[4], z[4], area = 0, cx = 0, cz = 0;
      for (int k = 0; k < 4; ++k) {
        const double a = angle[k / 2], r = radius[k == 1 || k == 2];
        x[k] = std::cos(a) * r, z[k] = std::sin(a) * r;
      }
      for (int k = 0; k < 4; ++k) {
        const int l = (k + 1) % 4;
        const double d = x[k] * z[l] - x[l] * z[k];
        area += d, cx += (x[k] + x[l]) * d, cz += (z[k] + z[l]) * d;
      }
      const V3 c = {cx / (3 * area), 0, cz / (3 * area)};
      std::vector<V3> points;
      for (int k = 0; k < 4; ++k)
        for (const double y : {-0.05, 0.05}) points.push_back(V3{x[k], y, z[k]} - c);
      Body b;
      b.shapes = {hull(points)}, b.p = c;
      bodies.push_back(b);
    }
    Lab lab(pile(bodies, 0.8, sub));
    lab.step(300);
    rows.add({text("arch of 9 voussoirs after 5 s, %d substeps: farthest", sub), 0, 5.5, "mm"},
             farthest(lab));
  }
}

void bounce(Rows& rows) {
  for (const int sub : {2, 8})
    rows.add({text("ball dropped from 1 m, %d substeps: goes up again (restitution 0)", sub), 0, 1, "mm"},
             [sub] {
               Scene s;
               s.bodies = {{{sphere(0.05)}, 0.1, {0, 0, 1.05}}};
               s.statics = {plane()};
               s.settings = text("substeps=%d", sub);
               Lab lab(std::move(s));
               double up = 0;
               bool hit = false;
               for (int k = 0; k < 120; ++k) {
                 lab.step();
                 const double z = lab.p()[2] - 0.05;
                 if (hit) up = std::max(up, z);
                 hit = hit || z < 0.001;
               }
               return 1e3 * up;
             });
}

}  // namespace

void add_resting(Checks& checks) {
  const char* group = "Things at rest";
  checks.push_back({group, "weights", true, weights});
  checks.push_back({group, "stacks", true, stacks});
  checks.push_back({group, "stack in time", true, stack_in_time});
  checks.push_back({group, "pyramid", true, pyramid});
  checks.push_back({group, "arch", true, arch});
  checks.push_back({group, "bounce", true, bounce});
}

}  // namespace truth
