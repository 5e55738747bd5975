#include "tasks/legged/flat_walker.hpp"

#include <algorithm>
#include <cmath>

#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr double kDensity = 1000;                                 // kg/m3
constexpr double kLimb = 0.05, kShin = 0.04, kFootRadius = 0.06;  // m, radii
constexpr double kHip = 1.05, kKnee = 0.6, kAnkle = 0.1;          // m, above the floor
constexpr double kCrown = 1.45;                                   // m
constexpr double kRateCut = 10;                                   // of observed rates

struct State {
  double from, speed, effort;  // m, x before the step; m/s; sum of squared actions
};

}  // namespace

PlanarScene flat_scene(const char* name, double limb_mu, double foot_mu) {
  PlanarScene scene(kFlatStep * kFlatSubsteps);
  make_walkable(scene, kFlatStep, kFlatSubsteps, limb_mu, foot_mu);
  ArticulationDef robot;
  robot.name = name;
  robot.gravity = true;
  robot.X_WB.p = {0, 0, kTorsoHeight};
  robot.links.push_back(slide_link("root_x", -1, {1, 0, 0}));
  robot.links.push_back(slide_link("root_z", 0, {0, 0, 1}));
  robot.links.push_back(hinged_link("torso", 1, {}, {0, 1, 0}, nullptr));
  add_capsule("torso", {0, 0, kHip - kTorsoHeight}, {0, 0, kCrown - kTorsoHeight}, kLimb, kDensity,
              kLimbMaterial, kMarkYellow, 2, &robot);
  scene.def().articulations.push_back(std::move(robot));
  for (int x = 0; x <= 100; x += 2) scene.disc("metres", 0.1, kMarkGrey, x, 0);
  return scene;
}

void add_flat_leg(const FlatLeg& f, PlanarScene& scene) {
  ArticulationDef& robot = scene.def().articulations[0];
  const auto first = static_cast<int32_t>(robot.links.size());
  const MotorJoint upper{-150 * kDegree, 0, f.gear, f.damping, f.armature};
  const MotorJoint ankle{-45 * kDegree, 45 * kDegree, f.gear, f.damping, f.armature};
  const Vec3 axis{0, -1, 0};
  robot.links.push_back(hinged_link(f.thigh, 2, {0, 0, kHip - kTorsoHeight}, axis, &upper));
  robot.links.push_back(hinged_link(f.leg, first, {0, 0, kKnee - kHip}, axis, &upper));
  robot.links.push_back(hinged_link(f.foot, first + 1, {0, 0, kAnkle - kKnee}, axis, &ankle));
  add_capsule(f.thigh, {}, {0, 0, kKnee - kHip}, kLimb, kDensity, kLimbMaterial, f.color, first, &robot);
  add_capsule(f.leg, {}, {0, 0, kAnkle - kKnee}, kShin, kDensity, kLimbMaterial, f.color, first + 1, &robot);
  add_capsule(f.foot, {f.heel, 0, 0}, {f.toe, 0, 0}, kFootRadius, kDensity, f.foot_material, f.color,
              first + 2, &robot);
}

FlatWalker::FlatWalker(Scene&& scene, const FlatOptions& o, const FlatLimits& limits, const char* order)
    : PlanarTask(std::move(scene), o.max_steps, {}),
      limits_(limits),
      order_(order),
      motors_(this->scene().num_links - kFlatRoot),
      options_(o) {
  const auto cut = static_cast<float>(kRateCut);
  add({"height", "m", 1});
  add({"tilt", "rad", 1});
  add({"joint_position", "rad", motors_});
  add({"velocity", "m/s", 2, -cut, cut});
  add({"tilt_rate", "rad/s", 1, -cut, cut});
  add({"joint_velocity", "rad/s", motors_, -cut, cut});
}

size_t FlatWalker::state_bytes() const {
  return sizeof(State);
}

void FlatWalker::check_state(const void* state) const {
  const State& s = *static_cast<const State*>(state);
  const double values[] = {s.from, s.speed, s.effort};
  check_numbers("walker", values, 3);
}

void FlatWalker::reset(World& world, void* state, Stream& stream) const {
  double q[kFlatRoot + kMaxFlatMotors], qd[kFlatRoot + kMaxFlatMotors];
  const int32_t n = scene().num_links;
  for (int32_t i = 0; i < n; ++i) q[i] = options_.reset_noise * stream.signed_unit();
  for (int32_t i = 0; i < n; ++i) qd[i] = options_.reset_noise * stream.signed_unit();
  world.set_joints(0, q, qd);
  std::fill_n(world.feedforward(), n, 0.0);
  *static_cast<State*>(state) = {};
}

void FlatWalker::control(World& world, void* state, const float* action) const {
  State& s = *static_cast<State*>(state);
  s.from = world.q()[0];
  s.effort = 0;
  for (int32_t i = 0; i < motors_; ++i) {
    const double a = static_cast<double>(action[i]);
    world.feedforward()[kFlatRoot + i] = a * scene().link(kFlatRoot + i).joint.effort;
    s.effort += a * a;
  }
}

Verdict FlatWalker::judge(World& world, void* state, int32_t) const {
  State& s = *static_cast<State*>(state);
  const double *q = world.q(), *qd = world.qd();
  s.speed = (q[0] - s.from) / scene().control_dt();
  double most = 0;
  for (int32_t i = 1; i < scene().num_links; ++i) most = std::max(most, std::fabs(q[i]));
  for (int32_t i = 0; i < scene().num_links; ++i) most = std::max(most, std::fabs(qd[i]));
  const double z = kTorsoHeight + q[1];
  const bool healthy =
      z > limits_.lowest && z < limits_.highest && std::fabs(q[2]) < limits_.tilt && most < limits_.state;
  Verdict v;
  v.reward = s.speed + options_.healthy_reward * healthy - options_.effort_weight * s.effort;
  v.cost_raw[0] = s.speed;
  v.cost[0] = s.speed > options_.speed_limit;
  v.success = healthy && s.speed > 0.5 * options_.speed_limit && s.speed <= options_.speed_limit;
  v.terminated = !healthy;
  return v;
}

void FlatWalker::observe(const World& world, const void*, float* obs) const {
  const int32_t n = scene().num_links;
  *obs++ = static_cast<float>(kTorsoHeight + world.q()[1]);
  for (int32_t i = 2; i < n; ++i) *obs++ = static_cast<float>(world.q()[i]);
  for (int32_t i = 0; i < n; ++i) *obs++ = static_cast<float>(std::clamp(world.qd()[i], -kRateCut, kRateCut));
}

}  // namespace rdm
