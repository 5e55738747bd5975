// Free bodies without contact. Flight: z = z0 + v t - g t^2 / 2. Spin without torque: I w' = I w x w in the
// body's axes, integrated here by RK4 at 1e-4 s; energy and angular momentum stay; a box 1:2:3 about its
// middle axis flips again and again.
#include <algorithm>

#include "lab.hpp"
#include "table.hpp"

namespace truth {
namespace {

const int kSubsteps[] = {1, 2, 8, 16};

void parabola(Rows& rows) {
  for (const int sub : kSubsteps) {
    Row row{text("parabola after 1 s, %d substeps: height", sub), 0, 0.1, "mm"};
    if (sub == 1) row.mujoco = "82 (h 1/60; RK4 0)";
    if (sub == 2) row.mujoco = "41 (h 1/120; RK4 0)";
    rows.add(row, [sub] {
      Scene s;
      s.bodies = {{{sphere(0.05)}, 0.1, {0, 0, 10}, kNoTurn, {3, 0, 4}, {0, 5, 0}}};
      s.settings = text("substeps=%d", sub);
      Lab lab(std::move(s));
      lab.step(60);
      return 1e3 * (lab.p()[2] - (10 + 4 - kG / 2));
    });
  }
}

// Signs of the spin about the middle axis that changed in 10 s, exactly.
int flips_of(const V3& inertia, V3 w) {
  const auto rate = [&](const V3& a) {
    return V3{(inertia[1] - inertia[2]) * a[1] * a[2] / inertia[0],
              (inertia[2] - inertia[0]) * a[2] * a[0] / inertia[1],
              (inertia[0] - inertia[1]) * a[0] * a[1] / inertia[2]};
  };
  int flips = 0;
  const double h = 1e-4;
  for (int k = 0; k < 100000; ++k) {
    const V3 k1 = rate(w), k2 = rate(w + h / 2 * k1), k3 = rate(w + h / 2 * k2), k4 = rate(w + h * k3);
    const V3 next = w + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
    flips += next[1] * w[1] < 0;
    w = next;
  }
  return flips;
}

void spin(Rows& rows, const V3& w0, const char* said, const char* mujoco, const char* turned) {
  const V3 side = {0.1, 0.2, 0.3};
  const V3 inertia = {(side[1] * side[1] + side[2] * side[2]) / 12,
                      (side[0] * side[0] + side[2] * side[2]) / 12,
                      (side[0] * side[0] + side[1] * side[1]) / 12};
  const auto scaled = [&](const V3& w) {
    return V3{inertia[0] * w[0], inertia[1] * w[1], inertia[2] * w[2]};
  };
  const double e0 = dot(w0, scaled(w0));
  double moved = 0, at_2 = std::nan(""), others = 0, flips_off = 0;
  const int exact = flips_of(inertia, w0);
  std::string note;
  try {
    for (const int sub : kSubsteps) {
      Scene s;
      s.bodies = {{{box(side[0] / 2, side[1] / 2, side[2] / 2)}, 1, {}, kNoTurn, {}, w0}};
      s.gravity = {};
      s.settings = text("substeps=%d", sub);
      Lab lab(std::move(s));
      double worst = 0, last = w0[1];
      int flips = 0;
      for (int k = 0; k < 600; ++k) {
        lab.step();
        const V3 w = unrotate(lab.turned(), lab.w());
        moved = std::max(moved, norm(rotate(lab.turned(), scaled(w)) - scaled(w0)) / norm(scaled(w0)));
        worst = std::max(worst, std::fabs(dot(w, scaled(w)) / e0 - 1));
        flips += w[1] * last < 0;
        last = w[1];
      }
      (sub == 2 ? at_2 : others) = sub == 2 ? worst : std::max(others, worst);
      if (sub > 1) flips_off = std::max(flips_off, std::fabs(flips - exact));
    }
  } catch (const Failure& e) {
    note = e.what();
  }
  const std::string at = text("box 1:2:3 spinning at %s rad/s for 10 s", said);
  rows.add({at + ", 2 substeps: energy, largest change", 0, 0.001, "", mujoco}, at_2, note);
  rows.add({at + ", 1, 8, 16 substeps: energy, largest change", 0, 0.003}, others, note);
  rows.add({at + ", 1 to 16 substeps: angular momentum, largest change", 0, 1e-9, "", turned}, moved, note);
  rows.add({text("%s, 2, 8, 16 substeps: flips too many or few, of %d", at.c_str(), exact), 0, 0}, flips_off,
           note);
}

}  // namespace

void add_flight_and_spin(Checks& checks) {
  const char* group = "Flight and spin of free bodies";
  checks.push_back({group, "parabola", true, parabola});
  checks.push_back({group, "spin", true, [](Rows& rows) {
                      spin(rows, {0.02, 8, 0}, "(.02, 8, 0)", ".22, .17, 9e-9 (Euler, implicit, RK4)",
                           ".11, .09, 2e-4 (Euler, implicit, RK4)");
                      spin(rows, {3, -5, 7}, "(3, -5, 7)", "1.8, .43, 2e-8 (Euler, implicit, RK4)",
                           ".78, .33, 4e-4 (Euler, implicit, RK4)");
                    }});
}

}  // namespace truth
