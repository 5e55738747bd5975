// Heavy on light and light on heavy stand for 10 s, by default; and what is thinner than the usual contact
// layer rests too: it carries its weight and sinks by a small share of its own thickness.
#include <algorithm>

#include "lab.hpp"
#include "table.hpp"

namespace truth {
namespace {

void ratios(Rows& rows) {
  for (const int ratio : {10, 100, 1000})
    for (const bool heavy_on_top : {true, false}) {
      double sinks = 0, aside = 0;
      std::string note;
      try {
        for (const int sub : {2, 8}) {
          Scene s;
          for (int i = 0; i < 2; ++i) {
            Body b;
            b.shapes = {box(0.05, 0.05, 0.05)}, b.p = {0, 0, 0.05 + 0.1 * i};
            b.mass = 0.1 * ((i == 1) == heavy_on_top ? ratio : 1);
            s.bodies.push_back(b);
          }
          s.statics = {plane()};
          s.friction = 0.5;
          s.settings = text("substeps=%d", sub);
          Lab lab(std::move(s));
          lab.step(600);
          sinks = std::max(sinks, std::fabs(1e3 * (0.15 - lab.p(1)[2])));
          aside = std::max(aside, 1e3 * std::hypot(lab.p(1)[0], lab.p(1)[1]));
        }
      } catch (const Failure& e) {
        note = e.what();
        sinks = aside = std::nan("");
      }
      const std::string at = text("box %d times as %s on top for 10 s, 2 and 8 substeps: ", ratio,
                                  heavy_on_top ? "heavy" : "light");
      const char* const fell = heavy_on_top && ratio == 1000  ? "100 (h 1/120)"
                               : heavy_on_top && ratio == 100 ? "2.5 (h 1/120)"
                                                              : "";
      rows.add({at + "sinks", 0, 4, "mm", fell}, sinks, note);
      rows.add({at + "goes aside", 0, 2, "mm"}, aside, note);
    }
}

void thin(Rows& rows) {
  struct Thing {
    const char* said;
    Shape shape;
    double mass, height;
    int count;
  };
  const Thing things[] = {{"cube of 1 mm", box(0.0005, 0.0005, 0.0005), 2.7e-6, 0.0005, 1},
                          {"plate of 1 mm", box(0.05, 0.05, 0.0005), 0.027, 0.0005, 1},
                          {"stack of 5 plates of 1 mm", box(0.05, 0.05, 0.0005), 0.027, 0.0005, 5}};
  for (const Thing& t : things) {
    double sinks = 0, force = 1, speed = 0;
    std::string note;
    try {
      for (const int sub : {2, 8}) {
        Scene s;
        for (int i = 0; i < t.count; ++i) {
          Body b;
          b.shapes = {t.shape}, b.mass = t.mass, b.p = {0, 0, t.height * (2 * i + 1) + 0.0005 * (i + 1)};
          s.bodies.push_back(b);
        }
        s.statics = {plane()};
        s.friction = 0.5;
        s.settings = text("substeps=%d", sub);
        Lab lab(std::move(s));
        lab.step(300);
        const double top = static_cast<double>(t.count - 1);
        sinks =
            std::max(sinks, std::fabs(1e3 * (t.height * (2 * top + 1) - lab.p(lab.bodies.size() - 1)[2])));
        const double carried = -lab.force_on(t.count)[2] / (t.mass * t.count * kG);  // the plane's
        if (!(std::fabs(carried - 1) <= std::fabs(force - 1))) force = carried;
        for (size_t i = 0; i < lab.bodies.size(); ++i) speed = std::max(speed, norm(lab.v(i)));
      }
    } catch (const Failure& e) {
      note = e.what();
      sinks = force = speed = std::nan("");
    }
    const std::string at = text("%s, dropped .5 mm each, 2 and 8 substeps: ", t.said);
    rows.add({at + "sinks", 0, 0.1 * t.count, "mm"}, sinks, note);
    rows.add({at + "force on the ground / weight", 1, 1e-3}, force, note);
    rows.add({at + "speed", 0, 1e-4, "m/s"}, speed, note);
  }
}

}  // namespace

void add_mass_ratios(Checks& checks) {
  const char* group = "Heavy, light, thin";
  checks.push_back({group, "mass ratios", true, ratios});
  checks.push_back({group, "thin things", true, thin});
}

}  // namespace truth
