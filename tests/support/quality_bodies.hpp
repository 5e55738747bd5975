// Experiments with a known answer: pendulum, spin, fall, friction of blocks and spheres.
#pragma once
#include "quality.hpp"

namespace rdm::test {

inline BodyDef make_body(ShapeKind kind, const Vec3& size, const Inertia& inertia, const Pose& X_WB) {
  BodyDef body;
  body.X_WB = X_WB;
  body.inertia = inertia;
  ShapeDef shape;
  shape.kind = kind;
  shape.size = size;
  body.shapes.push_back(shape);
  return body;
}
inline BodyDef make_box(double mass, const Vec3& half, const Pose& X_WB) {
  return make_body(ShapeKind::kBox, half, box_inertia(mass, half), X_WB);
}
inline ShapeDef make_plane(const Quat& q_WP = {}) {
  ShapeDef plane;
  plane.kind = ShapeKind::kPlane;
  plane.X_LS.q = q_WP;
  return plane;
}

// A rod of 0.5 kg and 0.4 m that hangs along -z from a hinge about y; 0.0833 kg m2 about its end, and more
// by its thickness.
inline SceneDef rod_def() {
  SceneDef def;
  ArticulationDef rod;
  LinkDef link;
  link.inertia = box_inertia(0.5, {0.01, 0.01, 0.2});
  link.inertia.com = {0, 0, -0.2};
  link.joint.axis = {0, 1, 0};
  link.joint.lower = -1e4;
  link.joint.upper = 1e4;
  rod.links.push_back(link);
  rod.gravity = true;
  def.articulations.push_back(rod);
  return def;
}

// Period of a pendulum and what is left of its amplitude after ten swings; what is left of the rate of the
// same rod turning at 10 rad/s for a second without gravity. All as shares of the true values.
struct Hinge {
  double period = 0, amplitude = 0, spin = 0;
};
inline Hinge hinge(const Column& column) {
  Hinge out;
  Rig rig(rod_def(), column);
  const double q0 = 0.1, still = 0;
  rig->set_joints(0, &q0, &still);
  const double moment = 0.5 / 3 * (square(0.2) + square(0.01)) + 0.5 * square(0.2);
  const double period = 2 * kPi * std::sqrt(moment / (0.5 * kGravity * 0.2)) * (1 + q0 * q0 / 16);
  double t = 0, before = q0, first = 0, last = 0, peak = 0;
  for (int crossings = 0; crossings < 21 && t < 60; before = rig->q()[0]) {
    rig.tick([] {});
    t += kTick;
    const double q = rig->q()[0];
    if (crossings > 18) peak = std::max(peak, std::fabs(q));
    if ((before > 0) == (q > 0)) continue;
    last = t - q / (q - before) * kTick;
    if (crossings++ == 0) first = last;
  }
  out.period = rig.checked((last - first) / 10 / period);
  out.amplitude = rig.checked(peak / q0);
  SceneDef def = rod_def();
  def.gravity = {};
  Rig wheel(def, column);
  const double rate = 10;
  wheel->set_joints(0, &still, &rate);
  wheel.ticks(60);
  out.spin = wheel.checked(wheel->qd()[0] / rate);
  return out;
}

// A sphere falls for 0.4 s, then to the ground, where it must stay.
struct Fall {
  double way = 0;      // share of g t^2 / 2
  double rebound = 0;  // m, highest place after the impact over that at rest
};
inline Fall fall(const Column& column) {
  SceneDef def;
  const double radius = 0.03, height = 1;
  def.bodies.push_back(make_body(ShapeKind::kSphere, {radius, 0, 0}, sphere_inertia(0.1, radius),
                                 {{0, 0, radius + height}, {}}));
  def.statics.push_back(make_plane());
  Rig rig(def, column);
  Fall out;
  rig.ticks(24);
  out.way = rig.checked((radius + height - rig->body(0).X.p.z) / (0.5 * kGravity * square(0.4)));
  rig.ticks(8);  // the impact is at 0.45 s
  for (int k = 0; k < 60; ++k) {
    rig.tick([] {});
    out.rebound = std::max(out.rebound, rig->body(0).X.p.z - radius);
  }
  return out;
}

inline constexpr int kAzimuths = 8;
inline double azimuth(int i) {
  return 2 * kPi * i / kAzimuths + 0.1;  // off the axes of any pyramid of friction
}

// Whether a box at rest on a slope with this azimuth slides.
inline bool slides(const Column& column, double azimuth, double slope, double mu) {
  const Quat q_WP = axis_angle({-std::sin(azimuth), std::cos(azimuth), 0}, std::atan(slope));
  const Vec3 half = {0.05, 0.05, 0.02};
  SceneDef def;
  def.bodies.push_back(make_box(0.2, half, {rotate(q_WP, {0, 0, half.z - 4e-4}), q_WP}));
  def.statics.push_back(make_plane(q_WP));
  def.friction[0][0].mu = mu;
  Rig rig(def, column);
  rig.ticks(30);
  const Vec3 before = rig->body(0).X.p;
  rig.ticks(30);
  return rig.diverged() || norm(rig->body(0).X.p - before) > 0.005;
}

// Slope at which a box starts to slide, as a share of mu, over all azimuths: 1 for a cone; a pyramid holds
// up to sqrt(2) along its diagonals.
struct Incline {
  double least = 1e9, most = 0;
};
inline Incline incline(const Column& column) {
  const double mu = 0.5;
  Incline out;
  for (int i = 0; i < kAzimuths; ++i) {
    double holds = 0.5, gives = 1.7;
    for (int k = 0; k < 8; ++k) {
      const double middle = 0.5 * (holds + gives);
      (slides(column, azimuth(i), middle * mu, mu) ? gives : holds) = middle;
    }
    out.least = std::min(out.least, holds);
    out.most = std::max(out.most, holds);
  }
  return out;
}

// A box sliding at 1 m/s on level ground: its deceleration over 0.2 s as a share of mu g, and how far it is
// led aside, over all azimuths.
struct Slide {
  double least = 1e9, most = 0;
  double aside = 0;  // largest speed across, share of that lost
};
inline Slide slide(const Column& column) {
  const double mu = 0.3, speed = 1;
  const Vec3 half = {0.05, 0.05, 0.02};
  SceneDef def;
  def.bodies.push_back(make_box(0.2, half, {{0, 0, half.z - 4e-4}, {}}));
  def.statics.push_back(make_plane());
  def.friction[0][0].mu = mu;
  Slide out;
  for (int i = 0; i < kAzimuths; ++i) {
    Rig rig(def, column);
    rig.ticks(15);
    const Vec3 along = {std::cos(azimuth(i)), std::sin(azimuth(i)), 0};
    Motion m = rig->body(0);
    m.v = speed * along;
    rig->set_body(0, m);
    rig.ticks(12);
    const Vec3 lost = speed * along - rig->body(0).v;
    const double share = rig.checked(dot(lost, along) / (12 * kTick * mu * kGravity));
    out.least = std::min(out.least, share);
    out.most = std::max(out.most, share);
    out.aside = std::max(out.aside, norm(cross(lost, along)) / norm(lost));
  }
  return out;
}

// A sphere set sliding at 1 m/s rolls in the end at 5/7 of it.
struct Roll {
  double speed = 0;  // share of 5/7 v0
  double spin = 0;   // share of what rolling at the speed it has asks for
};
inline Roll roll(const Column& column) {
  const double radius = 0.05, speed = 1;
  SceneDef def;
  def.bodies.push_back(make_body(ShapeKind::kSphere, {radius, 0, 0}, sphere_inertia(0.2, radius),
                                 {{0, 0, radius - 4e-4}, {}}));
  def.statics.push_back(make_plane());
  def.friction[0][0].mu = 0.3;
  Rig rig(def, column);
  rig.ticks(15);
  Motion m = rig->body(0);
  m.v = {speed * std::cos(azimuth(1)), speed * std::sin(azimuth(1)), 0};
  rig->set_body(0, m);
  rig.ticks(30);
  const Vec3 v = rig->body(0).v, w = rig->body(0).w;
  return {rig.checked(norm(v) / (5.0 / 7 * speed)), rig.checked(norm(w) * radius / norm(v))};
}

}  // namespace rdm::test
