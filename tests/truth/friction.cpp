// Coulomb friction. A slope at angle a: rest below atan(mu), else g (sin a - mu cos a); sliding from v: v^2 /
// (2 mu g); a ball that slides ends rolling at 5/7 v; a cylinder rolls down at 2/3 g sin a; four corners at r
// slow a turning box by mu g r m / I.
#include <algorithm>

#include "lab.hpp"
#include "table.hpp"

namespace truth {
namespace {

Body slab() {
  Body b;
  b.shapes = {box(0.05, 0.05, 0.02)}, b.p = {0, 0, 0.02};
  return b;
}

Scene on_plane(Body body, double mu, int sub) {
  Scene s;
  s.bodies = {std::move(body)}, s.statics = {plane()}, s.friction = mu;
  s.settings = text("substeps=%d", sub);
  return s;
}

void slope(Rows& rows) {
  const double mu = 0.5, critical = std::atan(mu);
  for (const double share : {0.5, 0.9, 0.97, 0.99, 1.01, 1.03, 1.1, 1.5}) {
    const double a = critical * share;
    // its default pyramid of friction, headings 0 and 45 deg
    const char* const mujoco = share == 0.5    ? "8e-4, 7e-4 (headings)"
                               : share == 0.9  ? ".002, 2.0 (headings)"
                               : share == 0.99 ? ".007, 3.1 (headings)"
                               : share == 1.01 ? ".016, 3.2 (headings)"
                               : share == 1.1  ? ".08, 3.1 (headings)"
                               : share == 1.5  ? ".38, 2.9 (headings)"
                                               : "";
    const double exact = std::max(0.0, kG * (std::sin(a) - mu * std::cos(a)) * 2.5);
    rows.add({text("slope at %g of the critical angle, mu .5, headings 0 and 45 deg, 2 and 8 substeps: speed "
                   "after 2.5 s",
                   share),
              exact, share < 1 ? 1e-4 : 0.006, "m/s", mujoco},
             [&] {
               double worst = exact;
               for (const int sub : {2, 8})
                 for (const double yaw : {0.0, kPi / 4}) {
                   Scene s = on_plane(slab(), mu, sub);
                   s.gravity = {kG * std::sin(a) * std::cos(yaw), kG * std::sin(a) * std::sin(yaw),
                                -kG * std::cos(a)};
                   Lab lab(std::move(s));
                   lab.step(150);
                   const double v = std::hypot(lab.v()[0], lab.v()[1]);
                   if (!(std::fabs(v - exact) <= std::fabs(worst - exact))) worst = v;
                 }
               return worst;
             });
  }
}

void sliding(Rows& rows) {
  const double tolerance[] = {0.02, 0.01, 0.003};
  int i = 0;
  for (const int sub : {1, 2, 8}) {
    const double exact = 4 / (2 * 0.4 * kG);
    rows.add({text("sliding from 2 m/s, mu .4, headings 0 and 45 deg, %d substeps: way", sub), exact,
              tolerance[i], "m"},
             [&] {
               double worst = exact;
               for (const double yaw : {0.0, kPi / 4}) {
                 Body b = slab();
                 b.v = {2 * std::cos(yaw), 2 * std::sin(yaw), 0};
                 Lab lab(on_plane(b, 0.4, sub));
                 lab.step(180);
                 const double way = std::hypot(lab.p()[0], lab.p()[1]);
                 if (!(std::fabs(way - exact) <= std::fabs(worst - exact))) worst = way;
               }
               return worst;
             });
    ++i;
  }
}

void rolling(Rows& rows) {
  for (const int sub : {2, 8}) {
    Body ball;
    ball.shapes = {sphere(0.05)}, ball.p = {0, 0, 0.05}, ball.v = {2, 0, 0};
    Lab lab(on_plane(ball, 0.5, sub));
    lab.step(60);
    rows.add({text("ball that slides at 2 m/s and then rolls, %d substeps: speed", sub), 10.0 / 7, 0.002,
              "m/s", sub == 2 ? ".008 (h 1/120)" : ""},
             lab.v()[0]);
    rows.add({text("ball that rolls, %d substeps: w r / v", sub), 1, 0.001}, lab.w()[1] * 0.05 / lab.v()[0]);
    lab.step(300);
    rows.add({text("ball that rolls, %d substeps: speed after 6 s", sub), 10.0 / 7, 0.002, "m/s"},
             lab.v()[0]);
    rows.add({text("cylinder down a slope of .2 rad, %d substeps: speed after 1 s", sub),
              2.0 / 3 * kG * std::sin(0.2), 0.001, "m/s"},
             [sub] {
               Body b;
               b.shapes = {cylinder(0.05, 0.03)}, b.p = {0, 0, 0.05}, b.q = turn({1, 0, 0}, kPi / 2);
               Scene s = on_plane(b, 0.9, sub);
               s.gravity = {kG * std::sin(0.2), 0, -kG * std::cos(0.2)};
               Lab down(std::move(s));
               down.step(60);
               return down.v()[0];
             });
  }
}

void on_the_spot(Rows& rows) {
  for (const int sub : {2, 8}) {
    const double r = std::hypot(0.05, 0.05), inertia = 0.02 / 12, slows = 0.4 * kG * r / inertia;
    rows.add({text("box of .1 m spinning at 10 rad/s, mu .4, %d substeps: angle to rest (four corners)", sub),
              100 / (2 * slows), sub == 2 ? 0.05 : 0.015, "rad", sub == 2 ? ".033 (h 1/120)" : ""},
             [sub] {
               Body b = slab();
               b.w = {0, 0, 10};
               Lab lab(on_plane(b, 0.4, sub));
               lab.step(60);
               const V3 x = rotate(lab.turned(), {1, 0, 0});
               return std::atan2(x[1], x[0]);
             });
    rows.add({text("ball spinning on the spot, %d substeps: rate after 5 s (no torsional friction)", sub), 10,
              0.001, "rad/s"},
             [sub] {
               Body b;
               b.shapes = {sphere(0.05)}, b.p = {0, 0, 0.05}, b.w = {0, 0, 10};
               Lab lab(on_plane(b, 0.4, sub));
               lab.step(300);
               return lab.w()[2];
             });
  }
}

}  // namespace

void add_friction(Checks& checks) {
  const char* group = "Friction";
  checks.push_back({group, "slope", true, slope});
  checks.push_back({group, "sliding", true, sliding});
  checks.push_back({group, "rolling", true, rolling});
  checks.push_back({group, "on the spot", true, on_the_spot});
}

}  // namespace truth
