// Contact laws: bounce, friction of turning, soft contacts, against their equations and against MuJoCo.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "articulated.hpp"
#include "base/error.hpp"
#include "quality_bodies.hpp"

namespace rdm::test {
namespace {

constexpr double kRadius = 0.05, kMass = 0.5;  // m, kg

// A sphere above a plane.
SceneDef sphere_def(const ContactLaw& law, double mu, double h, int32_t substeps, double z = kRadius) {
  SceneDef def;
  def.solver.h = h;
  def.solver.substeps = substeps;
  def.solver.contact_layer = 1e-5;
  def.num_materials = 2;
  def.friction[0][1].mu = def.friction[1][0].mu = mu;
  def.laws[0][1] = def.laws[1][0] = law;
  def.bodies.push_back(
      make_body(ShapeKind::kSphere, {kRadius, 0, 0}, sphere_inertia(kMass, kRadius), {{0, 0, z}, {}}));
  def.bodies[0].shapes[0].material = 1;
  def.statics.push_back(make_plane());
  return def;
}

class Ball {
 public:
  explicit Ball(const SceneDef& def, EngineKind engine = EngineKind::kArticulated) : sim_(def, engine) {}
  Motion at() { return sim_->body(0); }
  double time() const { return time_; }
  void put(const Vec3& v, const Vec3& w) {
    Motion m = at();
    m.v = v;
    m.w = w;
    sim_->set_body(0, m);
  }
  void run(double seconds) {
    const double dt = sim_.scene().control_dt();
    for (long i = std::lround(seconds / dt); i > 0; --i) {
      sim_->step();
      time_ += dt;
    }
  }
  World* operator->() { return &*sim_; }

 private:
  Simulation sim_;
  double time_ = 0;
};

TEST(ContactLaws, AThingBouncesToTheSquareOfItsRestitution) {
  for (const double e : {0.6, 0.75, 0.9})
    for (const double fall : {0.2, 0.5}) {
      ContactLaw law;
      law.restitution = e;
      Ball ball(sphere_def(law, 0.5, 1.0 / 960, 4, kRadius + fall));
      ball.run(std::sqrt(2 * fall / kGravity) + 0.02);
      double highest = 0;
      for (int i = 0; i < 240 && ball.at().v.z > -0.2; ++i, ball.run(1.0 / 240))
        highest = std::max(highest, ball.at().X.p.z - kRadius);
      EXPECT_NEAR(highest / fall, e * e, 0.02 * e * e) << e << " from " << fall << " m";
    }
}

// With rows for contacts to come, in long substeps.
TEST(ContactLaws, AThingBouncesOffWhatItSeesComing) {
  ContactLaw law;
  law.restitution = 0.8;
  SceneDef def = sphere_def(law, 0.5, 1.0 / 240, 1, kRadius + 1);
  def.solver.speculative_contacts = true;
  Ball ball(def);
  ball.run(std::sqrt(2 * 1 / kGravity) + 0.02);
  double highest = 0, lowest = kRadius;
  for (int i = 0; i < 240 && ball.at().v.z > -0.2; ++i, ball.run(1.0 / 240))
    highest = std::max(highest, ball.at().X.p.z - kRadius), lowest = std::min(lowest, ball.at().X.p.z);
  EXPECT_NEAR(highest, 0.64, 0.02 * 0.64);
  EXPECT_GT(lowest, kRadius - 1e-3);
}

TEST(ContactLaws, WithoutRestitutionNothingBounces) {
  Ball ball(sphere_def({}, 0.5, 1.0 / 960, 4, kRadius + 0.2));
  ball.run(0.6);
  EXPECT_LT(std::fabs(ball.at().v.z), 1e-3);
}

// (I + m r^2) w' = -rolling m g
TEST(ContactLaws, RollingFrictionStopsARollingBall) {
  for (const double rolling : {0.002, 0.005}) {
    ContactLaw law;
    law.rolling = rolling;
    Ball ball(sphere_def(law, 0.8, 1.0 / 240, 2, kRadius));
    ball.run(0.1);
    const double v = 0.8, x = ball.at().X.p.x, brake = 5.0 / 7 * kGravity * rolling / kRadius;
    ball.put({v, 0, 0}, {0, v / kRadius, 0});
    ball.run(v / brake + 0.2);
    EXPECT_LT(norm(ball.at().v), 1e-3);
    EXPECT_NEAR(ball.at().X.p.x - x, v * v / (2 * brake), 0.02 * v * v / (2 * brake)) << rolling;
  }
}

// I w' = -torsional m g
TEST(ContactLaws, TorsionalFrictionStopsASpinningBall) {
  ContactLaw law;
  law.torsional = 0.002;
  Ball ball(sphere_def(law, 0.8, 1.0 / 240, 1, kRadius));
  ball.run(0.1);
  const double w = 10, brake = 2.5 * law.torsional * kGravity / (kRadius * kRadius);
  ball.put({}, {0, 0, w});
  const double half = 60.0 / 240;
  ball.run(half);
  EXPECT_NEAR(ball.at().w.z, w - brake * half, 0.02 * w);
  ball.run(w / brake - half + 0.02);
  EXPECT_LT(norm(ball.at().w), 1e-3);
}

// As long as less than the bound turns it, it stands.
TEST(ContactLaws, FrictionOfTurningHolds) {
  ContactLaw law;
  law.torsional = law.rolling = 0.002;
  Ball ball(sphere_def(law, 0.8, 1.0 / 240, 1, kRadius));
  ball.run(0.1);
  const double most = law.torsional * kMass * kGravity;
  for (int i = 0; i < 240; ++i) {
    ball->push_body(0, {}, {0, 0.9 * most, 0.9 * most});
    ball->step();
  }
  EXPECT_LT(norm(ball.at().w), 1e-3);
}

// A one-dimensional integration of the law in steps of 1e-5 s, from a touch at kTouch m/s: place, speed and
// deepest place.
constexpr double kTouch = -0.99;
struct Drop {
  double z, v, lowest;
};
Drop drop(const ContactLaw& law, double seconds) {
  const double h = 1e-5;
  Drop s{kRadius, kTouch, kRadius};
  for (long i = std::lround(seconds / h); i > 0; --i) {
    const double depth = kRadius - s.z;
    double push = 0;
    if (depth > 0) {
      const double x = std::min(depth / law.impedance_width, 1.0);
      const double share = x < 0.5 ? 2 * x * x : 1 - 2 * (1 - x) * (1 - x);
      const double d = law.impedance_min + share * (law.impedance_max - law.impedance_min);
      const double most = law.impedance_max, T = law.time_constant, zeta = law.damping_ratio;
      push = -2 / (most * T) * s.v + d / (most * most * T * T * zeta * zeta) * depth;
      push = std::max(0.0, d * (push + kGravity));
    }
    s.v += h * (push - kGravity);
    s.z += h * s.v;
    s.lowest = std::min(s.lowest, s.z);
  }
  return s;
}

TEST(ContactLaws, ASoftContactIsItsSpringAndDamper) {
  ContactLaw plain, bouncy;
  plain.time_constant = 0.02;
  bouncy.time_constant = 0.05;
  bouncy.damping_ratio = 0.3;
  bouncy.impedance_min = bouncy.impedance_max = 0.8;
  bouncy.impedance_width = 0.01;
  for (const ContactLaw& law : {plain, bouncy}) {
    Ball ball(sphere_def(law, 0, 1.0 / 4000, 1));
    ball.put({0, 0, kTouch}, {});
    double lowest = kRadius;
    for (const double t : {0.01, 0.03, 0.1, 0.2, 1.0}) {
      while (ball.time() + 1e-9 < t) {
        ball.run(1.0 / 4000);
        lowest = std::min(lowest, ball.at().X.p.z);
      }
      const Drop exact = drop(law, t);
      EXPECT_NEAR(ball.at().X.p.z, exact.z, 2e-4) << t;
      EXPECT_NEAR(kRadius - lowest, kRadius - exact.lowest, 0.02 * (kRadius - exact.lowest) + 1e-5) << t;
    }
  }
}

// MuJoCo 2.2.2, Euler at 0.1 ms, solref and solimp as they come: a sphere of 50 mm and 0.5 kg that touches a
// plane at 1 m/s. Times, x and z of its middle, their speeds, rate about y.
struct Recorded {
  double t, x, z, vx, vz, wy;
};
void follow(const ContactLaw& law, double mu, const Vec3& v, const Vec3& w, const Recorded (&rows)[4],
            double place, double speed) {
  Ball ball(sphere_def(law, mu, 0.00025, 1));
  ball.put(v, w);
  for (const Recorded& row : rows) {
    ball.run(row.t - ball.time());
    const Motion m = ball.at();
    EXPECT_NEAR(m.X.p.x, row.x, place) << row.t;
    EXPECT_NEAR(m.X.p.z, row.z, place) << row.t;
    EXPECT_NEAR(m.v.x, row.vx, speed) << row.t;
    EXPECT_NEAR(m.v.z, row.vz, speed) << row.t;
    EXPECT_NEAR(m.w.y * kRadius, row.wy * kRadius, speed) << row.t;
  }
}
ContactLaw mujoco_law(bool pyramid) {
  ContactLaw law;
  law.time_constant = 0.02;
  law.pyramid = pyramid;
  return law;
}

TEST(ContactLaws, ADroppedSphereFallsAsInMuJoCo) {
  follow(mujoco_law(false), 0, {0, 0, -1}, {},
         {{0.02, 0, 0.042558, 0, -0.003316, 0},
          {0.05, 0, 0.04575, 0, 0.121552, 0},
          {0.1, 0, 0.049135, 0, 0.026649, 0},
          {0.3, 0, 0.049633, 0, 0, 0}},
         2e-4, 0.01);
}

TEST(ContactLaws, ASphereSlidesAsInMuJoCoByPyramidAndByCone) {
  follow(mujoco_law(true), 0.7, {1, 0, -1}, {},
         {{0.02, 0.016523, 0.0428, 0.731485, 0.006752, 12.865553},
          {0.05, 0.037633, 0.046034, 0.695725, 0.117942, 14.533147},
          {0.1, 0.0726, 0.049273, 0.702447, 0.025355, 14.203904},
          {0.3, 0.213428, 0.049845, 0.704354, 0, 14.108953}},
         5e-4, 0.01);
  follow(mujoco_law(false), 0.7, {1, 0, -1}, {},
         {{0.02, 0.016505, 0.042558, 0.730385, -0.003316, 12.909148},
          {0.05, 0.037584, 0.04575, 0.694809, 0.121552, 14.562995},
          {0.1, 0.072517, 0.049135, 0.701924, 0.026649, 14.215259},
          {0.3, 0.213229, 0.049633, 0.703716, 0, 14.126189}},
         5e-4, 0.01);
}

TEST(ContactLaws, ARollingSphereIsBrakedAsInMuJoCo) {
  ContactLaw law = mujoco_law(true);
  law.torsional = 0.005;
  law.rolling = 0.002;
  follow(law, 0.7, {1, 0, -1}, {0, 20, 3},
         {{0.02, 0.019578, 0.042977, 0.961966, 0.02167, 19.997491},
          {0.05, 0.048325, 0.046785, 0.957738, 0.136431, 19.390426},
          {0.1, 0.096209, 0.049858, 0.956597, -0.02066, 18.79099},
          {0.3, 0.282547, 0.049998, 0.904629, 0, 17.596573}},
         1e-3, 0.02);
}

// A robot on a hinge whose tip meets a ball: all kinds of sides and rows.
SceneDef hinged_def(const ContactLaw& law, int32_t lanes) {
  SceneDef def = sphere_def(law, 0.6, 1.0 / 240, 2, 0.049);
  ArticulationDef robot;
  robot.gravity = true;
  robot.X_WB.p = {0, 0, 0.45};
  for (int32_t i = 0; i < 2; ++i) {
    LinkDef link;
    link.parent = i - 1;
    link.X_PL.p = {0, 0, i ? -0.2 : 0};
    link.inertia = capsule_inertia(0.2, 0.02, 0.1);
    link.inertia.com = {0, 0, -0.1};
    link.joint.axis = {0, 1, 0};
    link.joint.lower = -3;
    link.joint.upper = 3;
    robot.links.push_back(link);
    ArticulationShape shape;
    shape.link = i;
    shape.shape.kind = ShapeKind::kCapsule;
    shape.shape.size = {0.02, 0.08, 0};
    shape.shape.X_LS.p = {0, 0, -0.1};
    shape.shape.material = 1;
    robot.shapes.push_back(shape);
  }
  def.laws[1][1] = law;
  def.articulations.push_back(robot);
  def.solver.lanes = lanes;
  return def;
}

TEST(ContactLaws, LanesDoNotChangeABit) {
  ContactLaw bounce, turning, soft = mujoco_law(true);
  bounce.restitution = 0.5;
  turning.torsional = turning.rolling = 0.003;
  soft.torsional = soft.rolling = 0.003;
  for (const ContactLaw& law : {bounce, turning, soft}) {
    uint64_t hash = 0;
    for (const int32_t lanes : {1, 4, 8, 16}) {
      Simulation sim(hinged_def(law, lanes), EngineKind::kArticulated);
      const double q[2] = {-1.2, 0.2}, qd[2] = {0, 0};
      sim->set_joints(0, q, qd);
      int touched = 0;
      for (int i = 0; i < 120; ++i) {
        sim->step();
        for (int32_t k = 0; k < sim->num_contacts(); ++k) {
          const Contact& c = sim->contacts()[k];
          touched += sim.scene().shapes[static_cast<size_t>(c.shape_a)].articulation >= 0 ||
                     sim.scene().shapes[static_cast<size_t>(c.shape_b)].articulation >= 0;
        }
      }
      EXPECT_GT(touched, 0);
      EXPECT_EQ(sim->status() & kStatusDiverged, 0u);
      const uint64_t h = state_hash(*sim);
      if (lanes == 1) hash = h;
      EXPECT_EQ(h, hash) << lanes;
    }
  }
}

TEST(ContactLaws, ALawThatIsNoneChangesNothing) {
  ContactLaw none;
  none.damping_ratio = 0.5;
  Simulation plain(hinged_def({}, 0), EngineKind::kArticulated),
      same(hinged_def(none, 0), EngineKind::kArticulated);
  EXPECT_TRUE(same.scene().laws.empty());
  for (int i = 0; i < 60; ++i) plain->step(), same->step();
  EXPECT_EQ(state_hash(*plain), state_hash(*same));
}

TEST(ContactLaws, EngineOdeBouncesAndRefusesTheRest) {
  ContactLaw law;
  law.restitution = 0.6;
  Ball ball(sphere_def(law, 0.5, 1.0 / 960, 4, kRadius + 0.5), EngineKind::kOde);
  ball.run(std::sqrt(2 * 0.5 / kGravity) + 0.02);
  double highest = 0;
  for (int i = 0; i < 240; ++i, ball.run(1.0 / 240)) highest = std::max(highest, ball.at().X.p.z - kRadius);
  EXPECT_NEAR(highest / 0.5, 0.36, 0.036);
  law.rolling = 0.1;
  EXPECT_THROW(Ball(sphere_def(law, 0.5, 1.0 / 960, 4), EngineKind::kOde), Error);
  EXPECT_THROW(Ball(sphere_def(mujoco_law(false), 0.5, 1.0 / 960, 4), EngineKind::kOde), Error);
}

TEST(ContactLaws, NumbersOutOfBoundsAreNamed) {
  const auto text_of = [](auto set) -> std::string {
    ContactLaw law;
    set(&law);
    try {
      make_scene(sphere_def(law, 0.5, 0.01, 1));
    } catch (const Error& e) {
      return e.text;
    }
    return "";
  };
  EXPECT_NE(text_of([](ContactLaw* l) { l->restitution = 1.1; }).find("restitution"), std::string::npos);
  EXPECT_NE(text_of([](ContactLaw* l) { l->rolling = NAN; }).find("rolling"), std::string::npos);
  EXPECT_NE(text_of([](ContactLaw* l) { l->impedance_max = 1; }).find("impedance_max"), std::string::npos);
  EXPECT_NE(text_of([](ContactLaw* l) { l->pyramid = true; }).find("time_constant"), std::string::npos);
  EXPECT_NE(
      text_of([](ContactLaw* l) { l->time_constant = 0.1, l->restitution = 0.5; }).find("damping_ratio"),
      std::string::npos);
}

}  // namespace
}  // namespace rdm::test
