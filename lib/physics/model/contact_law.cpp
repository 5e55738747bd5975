#include "physics/model/contact_law.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

double impedance(const ContactLaw& law, double depth) {
  const double x = std::min(std::fabs(depth) / law.impedance_width, 1.0);
  const double share = x < 0.5 ? 2 * x * x : 1 - 2 * (1 - x) * (1 - x);
  return law.impedance_min + share * (law.impedance_max - law.impedance_min);
}

void need(double value, double low, double high, const char* field) {
  if (!(value >= low && value <= high))
    fail(Code::kRange, "contact law: %s: %s is outside [%s, %s]", field, Number(value).text, Number(low).text,
         Number(high).text);
}

}  // namespace

SoftRow soft_row(const ContactLaw& law, double depth, double h) {
  const double d = impedance(law, depth), T = std::max(law.time_constant, 2 * h), most = law.impedance_max;
  const double b = 2 / (most * T), k = d / (most * most * T * T * law.damping_ratio * law.damping_ratio);
  const double whole = 1 + 0.5 * h * b;
  return {(1 - d) / (d * whole), (1 - 0.5 * h * b) / whole, h * k * depth / whole};
}

void check_law(const ContactLaw& law) {
  need(law.restitution, 0, 1, "restitution");
  need(law.torsional, 0, 10, "torsional");
  need(law.rolling, 0, 10, "rolling");
  need(law.time_constant, 0, 10, "time_constant");
  need(law.damping_ratio, 0.01, 100, "damping_ratio");
  need(law.impedance_min, 1e-4, 0.9999, "impedance_min");
  need(law.impedance_max, 1e-4, 0.9999, "impedance_max");
  need(law.impedance_width, 1e-9, 10, "impedance_width");
  if (law.soft() && law.restitution > 0)
    fail(Code::kArgument,
         "contact law: restitution is for hard contacts only; a soft contact bounces by its damping_ratio");
  if (law.pyramid && !law.soft())
    fail(Code::kArgument, "contact law: a friction pyramid is for soft contacts only; set a time_constant");
}

}  // namespace rdm
