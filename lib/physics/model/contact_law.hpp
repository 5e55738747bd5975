// How two materials meet beside their friction: bounce, friction of turning, softness.
//
//   restitution  a point that closes faster than kBounceSpeed parts at e times that speed
//   torsional    turning about the normal is opposed by at most torsional n, n the normal force
//   rolling      turning about the tangents likewise, by at most rolling n
//   softness     with a time constant a contact is a spring and a damper, as MuJoCo's solref and solimp are
//                (its documentation, "Computation: constraint model"): with the depth r and the rate of
//                closing v of the substep's start,
//                  a + R f = a_ref = -b v + k r     b = 2 / (d_max T),  k = d(r) / (d_max^2 T^2 zeta^2)
//                  R = (1 - d) / d A,               A = 1/m of both sides in the scene's zero pose
//                d(r) rises from impedance_min to impedance_max over impedance_width: two parabolas that meet
//                half way. T is at least two substeps. The damper acts on the mean rate of the substep.
//                Against a plane the point is half way between the surfaces.
//   pyramid      of soft contacts: friction by four edges f_e >= 0, n +- mu t, (with torsional and rolling
//                friction ten) each of softness 2 mu^2 (1 + mu^2) R: what MuJoCo does unless told otherwise.
//                A contact is then the softer the more it rubs, and sliding lifts it.
#pragma once
#include <cstdint>

namespace rdm {

inline constexpr double kBounceSpeed = 0.05;  // m/s

struct ContactLaw {
  double restitution = 0;                            // of hard contacts
  double torsional = 0, rolling = 0;                 // m
  double time_constant = 0;                          // s; 0: hard
  double damping_ratio = 1;                          // zeta
  double impedance_min = 0.9, impedance_max = 0.95;  // d, within (0, 1)
  double impedance_width = 0.001;                    // m
  bool pyramid = false;
  double margin = 0;  // m, by which shapes were widened that meet planes (tasks/legged): where a point is

  bool soft() const { return time_constant > 0; }
  // False: as every contact is.
  bool differs() const { return restitution > 0 || torsional > 0 || rolling > 0 || soft(); }
  bool operator==(const ContactLaw& o) const {
    return restitution == o.restitution && torsional == o.torsional && rolling == o.rolling &&
           time_constant == o.time_constant && damping_ratio == o.damping_ratio &&
           impedance_min == o.impedance_min && impedance_max == o.impedance_max &&
           impedance_width == o.impedance_width && pyramid == o.pyramid && margin == o.margin;
  }
};

// A soft row of depth r in a substep of h, for the velocities of its end:  v1 + softness impulse >= keep v0 +
// push, with softness = weight A.
struct SoftRow {
  double weight, keep, push;
};
SoftRow soft_row(const ContactLaw& law, double depth, double h);

// Error(kRange) for a number outside its bounds; the text names it.
void check_law(const ContactLaw& law);

}  // namespace rdm
