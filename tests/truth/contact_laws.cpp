// What two materials may have beside Coulomb's friction. Restitution e: a ball dropped from h comes up to e^2 h. Torsional
// friction c (m): a ball that spins about the normal slows by c m g / I. Rolling friction c: a ball of radius r that rolls
// slows by 5/7 g c / r. Soft contacts, as MuJoCo's solref and solimp: a ball falls onto a plane as MuJoCo has it with a
// fine step.
#include <algorithm>

#include "lab.hpp"
#include "table.hpp"

namespace truth {
namespace {

Scene ball(int sub, const rdm_contact_law& law, double up, const V3& v, const V3& w) {
  Body b;
  b.shapes = {sphere(0.05)}, b.mass = 0.5, b.p = {0, 0, 0.05 + up}, b.v = v, b.w = w;
  Scene s;
  s.bodies = {b}, s.statics = {plane()};
  s.settings = text("substeps=%d", sub);
  s.materials = [law](rdm_scene* scene) { check(rdm_scene_set_contact_law(scene, "m", "m", &law)); };
  return s;
}

rdm_contact_law law_of() {
  rdm_contact_law law;
  check(rdm_contact_law_init(&law, sizeof law));
  return law;
}

void bounce(Rows& rows) {
  for (const double e : {0.5, 0.9})
    for (const int sub : {2, 8})
      rows.add({text("ball with restitution %g dropped from .5 m, %d substeps: comes up", e, sub),
                500 * e * e, 25 * e * e, "mm"},
               [&] {
                 rdm_contact_law law = law_of();
                 law.restitution = e;
                 Lab lab(ball(sub, law, 0.5, {}, {}));
                 double high = 0;
                 bool hit = false;
                 for (int k = 0; k < 60 && !(hit && lab.v()[2] < 0); ++k) {
                   lab.step();
                   hit = hit || lab.v()[2] > 0;
                   // between two steps it goes on as it flies
                   const double v = lab.v()[2];
                   if (hit && v > 0) high = std::max(high, lab.p()[2] - 0.05 + v * v / (2 * kG));
                 }
                 return 1e3 * high;
               });
}

void turning(Rows& rows) {
  for (const int sub : {2, 8}) {
    const double c = 0.001, r = 0.05;
    rows.add(
        {text("ball spinning on the spot at 10 rad/s, torsional friction 1 mm, %d substeps: rate after .5 s",
              sub),
         10 - 0.5 * c * kG / (0.4 * r * r), 0.05, "rad/s"},
        [&] {
          rdm_contact_law law = law_of();
          law.torsional = c;
          Lab lab(ball(sub, law, 0, {}, {0, 0, 10}));
          lab.step(30);
          return lab.w()[2];
        });
    rows.add({text("ball rolling at 1 m/s, rolling friction 1 mm, %d substeps: speed after 2 s", sub),
              1 - 2 * 5.0 / 7 * kG * c / r, 0.01, "m/s"},
             [&] {
               rdm_contact_law law = law_of();
               law.rolling = c;
               Lab lab(ball(sub, law, 0, {1, 0, 0}, {0, 1 / r, 0}));
               lab.step(120);
               return lab.v()[0];
             });
  }
}

// solref (.02, 1), solimp (.9, .95, .001): MuJoCo 2.2.2, Euler at .1 ms. How deep the ball goes depends on where in a
// substep it hits, and what is seen of it on where in a control step: it falls kFalls times, each time from a little
// higher and always with 1 m/s at the plane. With 2 substeps, falls half of kFalls apart hit at one place of a
// substep, and each sees the substeps that the other does not.
void soft(Rows& rows) {
  constexpr int kFalls = 16, kPlaces = kFalls / 2;
  constexpr double kDeepest = 7.442, kUp = 0.1334;
  for (const int sub : {2, 16}) {
    double deepest = std::nan(""), up = std::nan(""), rest = std::nan("");
    std::string note;
    try {
      rdm_contact_law law = law_of();
      law.time_constant = 0.02;
      double deep[kPlaces] = {}, fast[kPlaces] = {};
      for (int fall = 0; fall < kFalls; ++fall) {
        const int place = sub == 2 ? fall % kPlaces : 0;
        const double t = fall / (60.0 * kFalls), v = 1 - kG * t, height = t - 0.5 * kG * t * t;
        Lab lab(ball(sub, law, height, {0, 0, -v}, {}));
        for (int k = 0; k < 60; ++k) {
          lab.step();
          deep[place] = std::max(deep[place], 1e3 * (0.05 - lab.p()[2]));
          fast[place] = std::max(fast[place], lab.v()[2]);
        }
        rest = 1e3 * (0.05 - lab.p()[2]);
      }
      const auto farthest = [&](const double* of, double exact) {
        double off = 0;
        for (int i = 0; i < (sub == 2 ? kPlaces : 1); ++i) off = std::max(off, std::fabs(of[i] - exact));
        return off;
      };
      deepest = farthest(deep, kDeepest), up = farthest(fast, kUp);
    } catch (const Failure& e) {
      note = e.what();
    }
    const std::string at = text("ball at 1 m/s onto a soft plane as MuJoCo's, %d substeps: ", sub);
    const bool two = sub == 2;
    rows.add(
        {at + "deepest (7.442 mm), largest error", 0, two ? 3 : 0.4, "mm", two ? "5.4 (h 1/120)" : ".69"},
        deepest, note);
    rows.add({at + "fastest up (.1334 m/s), largest error", 0, two ? 0.06 : 0.02, "m/s",
              two ? ".096 (h 1/120)" : ".012"},
             up, note);
    rows.add({at + "depth at rest", 0.3672, 0.004, "mm", two ? "0 (h 1/120)" : ""}, rest, note);
  }
}

}  // namespace

void add_contact_laws(Checks& checks) {
  const char* group = "Contact laws";
  checks.push_back({group, "bounce", true, bounce});
  checks.push_back({group, "turning", true, turning});
  checks.push_back({group, "soft", true, soft});
}

}  // namespace truth
