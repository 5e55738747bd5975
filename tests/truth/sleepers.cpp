// What sleeps keeps the contacts with which it fell asleep: their forces carry its weight at all times after
// it came to rest.
#include <algorithm>

#include "lab.hpp"
#include "table.hpp"

namespace truth {
namespace {

void weights(Rows& rows) {
  struct Thing {
    const char* said;
    Shape shape;
    double height;
  };
  const Thing things[] = {{"box", box(0.05, 0.05, 0.05), 0.05},
                          {"cylinder", cylinder(0.04, 0.1), 0.1},
                          {"sphere", sphere(0.04), 0.04},
                          {"capsule lying", capsule(0.03, 0.05, turn({0, 1, 0}, kPi / 2)), 0.03},
                          {"hull", block(0.05, 0.05, 0.05), 0.05}};
  for (const Thing& t : things)
    for (const bool table : {false, true})
      rows.add({text("sleeping %s on a %s, 1 and 2 substeps: contact forces / weight", t.said,
                     table ? "table" : "plane"),
                1, 1e-3},
               [&] {
                 double worst = 1;
                 for (const int sub : {1, 2}) {
                   Scene s;
                   for (int i = 0; i < 3; ++i) {
                     Body b;
                     b.shapes = {t.shape}, b.p = {0.5 * i, 0, t.height + 0.002 * i};
                     s.bodies.push_back(b);
                   }
                   s.statics = {table ? box(2, 2, 0.1) : plane()};
                   if (table) s.statics[0].p[2] = -0.1;
                   s.settings = text("sleep_time=.25\nsubsteps=%d", sub);
                   Lab lab(std::move(s));
                   for (int k = 0; k < 180; ++k) {
                     lab.step();
                     if (k < 60) continue;
                     for (int i = 0; i < 3; ++i) {
                       const double carried = lab.force_on(i)[2] / kG;
                       if (!(std::fabs(carried - 1) <= std::fabs(worst - 1))) worst = carried;
                     }
                   }
                   for (size_t i = 0; i < 3; ++i)
                     if (norm(lab.v(i)) != 0) throw Failure("it does not sleep");
                 }
                 return worst;
               });
}

}  // namespace

void add_sleepers(Checks& checks) {
  checks.push_back({"Sleeping things", "weights", true, weights});
}

}  // namespace truth
