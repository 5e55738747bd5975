// Where the engine goes as the substep goes to 0: the double pendulum from (1, .5) rad, after 1 s, beside its
// exact motion.
#include "convergence.hpp"

#include <algorithm>

#include "lab.hpp"
#include "planar.hpp"
#include "table.hpp"

namespace truth {

double pendulum_error(const std::string& settings) {
  const double length = 0.3, mass = 0.1, across = mass * length * length / 12;
  static const PlanarState exact = planar_chain({1, 0.5}, length, mass, 1);
  Robot r;
  for (int i = 0; i < 2; ++i) {
    Link l;
    l.parent = i - 1, l.p = {0, 0, i == 0 ? 0 : -length};
    l.mass = mass, l.com = {0, 0, -length / 2}, l.moment = {across, across, 1e-6};
    r.links.push_back(l);
  }
  r.q0 = {1, 0.5};
  Scene s;
  s.robots = {r};
  s.settings = settings;
  Lab lab(std::move(s));
  lab.step(60);
  return std::max(std::fabs(lab.q[0] - exact.q[0]), std::fabs(lab.q[1] - exact.q[1]));
}

void add_convergence(Checks& checks) {
  checks.push_back(
      {"Convergence", "double pendulum", true, [](Rows& rows) {
         const double within[] = {0.1, 0.05, 0.025, 0.013, 0.0065};
         int i = 0;
         for (const int sub : {1, 2, 4, 8, 16}) {
           rows.add({text("double pendulum from (1, .5) rad after 1 s, %d substeps: error", sub), 0,
                     within[i++], "rad"},
                    [&] { return pendulum_error(text("precision=double\nsubsteps=%d", sub)); });
         }
         rows.add({"double pendulum, single precision beside double, 2 substeps: error", 0, 1e-4, "rad"}, [] {
           return std::fabs(pendulum_error("substeps=2") - pendulum_error("precision=double\nsubsteps=2"));
         });
       }});
}

}  // namespace truth
