// The task grasp once more, through the public header alone: the same scene, draws, observations, rewards and
// costs as tasks/hand/grasp.cpp has with its default options.
#pragma once
#include <algorithm>

#include "own_task.hpp"

namespace rdm::test {

inline constexpr int kMostGraspJoints = 32, kMostGraspTips = 8;

struct GraspIds {
  int32_t hand, object, joints, actions, tips;
  double lower[kMostGraspJoints], upper[kMostGraspJoints], effort[kMostGraspJoints], home[kMostGraspJoints];
  double ratio[kMostGraspJoints];
  int32_t leader[kMostGraspJoints];  // of a coupled joint, -1
  int32_t joint[kMostGraspJoints];   // of an action
  int32_t tip[kMostGraspTips], sensor[kMostGraspTips];
  int32_t fingers_from, first_finger_to;
};

// As the library's own: goal, stream, then commands and the action.
struct GraspState {
  double goal[4];  // w, x, y, z
  rdm_random goals;
  double command[20];
  float action[20];
};

inline double to_command(double lower, double upper, double q) {
  return (2 * q - upper - lower) / (upper - lower);
}
// Of (x, y, z, w).
inline void multiply(const double a[4], const double b[4], double out[4]) {
  const double q[4] = {a[3] * b[0] + a[0] * b[3] + a[1] * b[2] - a[2] * b[1],
                       a[3] * b[1] - a[0] * b[2] + a[1] * b[3] + a[2] * b[0],
                       a[3] * b[2] + a[0] * b[1] - a[1] * b[0] + a[2] * b[3],
                       a[3] * b[3] - a[0] * b[0] - a[1] * b[1] - a[2] * b[2]};
  std::copy_n(q, 4, out);
}

#define OWN_TRY(call)                                \
  do {                                               \
    if (const rdm_result r_ = (call); r_) return r_; \
  } while (false)

inline rdm_result grasp_build(void*, rdm_scene* scene, void* instance) {
  auto* ids = static_cast<GraspIds*>(instance);
  for (const char* name : {"hand", "object", "ground"}) OWN_TRY(rdm_scene_add_material(scene, name));
  OWN_TRY(rdm_scene_set_friction(scene, "hand", "hand", 0));
  OWN_TRY(rdm_scene_set_friction(scene, "hand", "object", 0.75));
  rdm_scene_robot hand;
  OWN_TRY(rdm_scene_robot_init(&hand, sizeof hand));
  hand.name = "right", hand.material = "hand";
  hand.pose.p[2] = 0.1, hand.pose.q[1] = 1, hand.pose.q[3] = 0;
  OWN_TRY(rdm_robot_find("shadow_hand", &hand.robot));
  OWN_TRY(rdm_scene_add_robot(scene, &hand, &ids->hand));
  rdm_shape_def box{};
  box.kind = RDM_SHAPE_BOX, box.material = "object", box.size[0] = box.size[1] = box.size[2] = 0.025;
  rdm_body_def cube{};
  cube.struct_size = sizeof cube, cube.name = "object", cube.shapes = &box, cube.num_shapes = 1;
  cube.mass = 0.071, cube.angular_damping = 0.1;
  cube.pose.p[1] = -0.4, cube.pose.p[2] = 0.026;
  const double y = 0.025 * 0.025, moment = cube.mass / 3 * (y + y);
  for (int k = 0; k < 3; ++k) cube.moment[k] = moment * cube.mass / cube.mass;
  OWN_TRY(rdm_scene_add_body(scene, &cube, &ids->object));
  rdm_shape_def ground{};
  ground.name = "ground", ground.kind = RDM_SHAPE_PLANE, ground.material = "ground";
  OWN_TRY(rdm_scene_add_static(scene, &ground));

  rdm_robot_def d;
  OWN_TRY(rdm_robot_def_init(&d, sizeof d));
  OWN_TRY(rdm_robot_get_def(hand.robot, &d));
  ids->joints = d.num_links, ids->actions = d.num_commands, ids->tips = d.num_fingers;
  OWN_TRY(rdm_robot_get_postures(hand.robot, ids->joint, ids->home, nullptr, nullptr));
  std::fill_n(ids->effort, kMostGraspJoints, std::numeric_limits<double>::infinity());
  std::fill_n(ids->leader, kMostGraspJoints, -1);
  for (int32_t i = 0; i < d.num_couplings; ++i) {
    rdm_robot_coupling c;
    OWN_TRY(rdm_robot_coupling_at(hand.robot, i, &c));
    ids->leader[c.link] = c.other, ids->ratio[c.link] = c.ratio;
  }
  for (int32_t i = 0; i < ids->joints; ++i) {
    rdm_joint_info joint = RDM_INIT(rdm_joint_info);
    OWN_TRY(rdm_scene_joint_at(scene, i, &joint));
    ids->lower[i] = joint.lower, ids->upper[i] = joint.upper;
    if (joint.action >= 0 && joint.effort > 0) ids->effort[i] = joint.effort;
  }
  for (int32_t i = 0; i < ids->tips; ++i) {
    rdm_robot_finger finger;
    rdm_robot_link link;
    OWN_TRY(rdm_robot_finger_at(hand.robot, i, &finger));
    OWN_TRY(rdm_robot_link_at(hand.robot, finger.tip, &link));
    const std::string name = std::string("right_") + link.name;
    OWN_TRY(rdm_scene_find(scene, RDM_SCENE_LINK, name.c_str(), &ids->tip[i]));
    OWN_TRY(rdm_scene_find(scene, RDM_SCENE_SENSOR, name.c_str(), &ids->sensor[i]));
    if (i == 0) ids->fingers_from = finger.first, ids->first_finger_to = finger.tip;
  }
  return RDM_OK;
}

inline rdm_result grasp_reset(void*, const void* instance, rdm_world* world, void* state,
                              rdm_random* random) {
  const auto* ids = static_cast<const GraspIds*>(instance);
  auto* s = static_cast<GraspState*>(state);
  constexpr double kPi = 3.14159265358979323846;
  const double x[3] = {1, 0, 0}, y[3] = {0, 1, 0}, z[3] = {0, 0, 1}, start[3] = {0, -0.4, 0.026};
  double u[kMostGraspJoints], q[kMostGraspJoints];
  for (int32_t i = 0; i < ids->joints; ++i) u[i] = rdm_random_uniform(random, 0, 1);
  for (int32_t i = 0; i < ids->joints; ++i) {
    const double l = ids->lower[i], h = ids->upper[i];
    q[i] = std::clamp(ids->home[i] + 0 * (l + (h - l) * u[i]), l, h);
  }
  for (int32_t i = 0; i < ids->joints; ++i)
    if (ids->leader[i] >= 0)
      q[i] = std::clamp(ids->ratio[i] * q[ids->leader[i]], ids->lower[i], ids->upper[i]);
  OWN_TRY(rdm_world_set_joints(world, ids->hand, q, nullptr, ids->joints));
  rdm_joints joints{};
  joints.struct_size = sizeof joints;
  OWN_TRY(rdm_world_get_joints(world, &joints));
  for (int32_t i = 0; i < ids->actions; ++i) {
    const int32_t j = ids->joint[i];
    s->command[i] = to_command(ids->lower[j], ids->upper[j], joints.q[j]);
  }
  rdm_motion m{};
  double depth = 1;
  for (int draw = 0; draw < 100 && depth > 0; ++draw) {
    for (int k = 0; k < 3; ++k) m.pose.p[k] = start[k] + 0.001 * rdm_random_uniform(random, -1, 1);
    OWN_TRY(rdm_rotation(z, kPi * rdm_random_uniform(random, -1, 1), m.pose.q));
    OWN_TRY(rdm_world_set_body(world, ids->object, &m));
    OWN_TRY(rdm_world_get_overlap(world, ids->object, &depth));
  }
  for (int raise = 0; raise < 100 && depth > 0; ++raise) {
    m.pose.p[2] += 0.005;
    OWN_TRY(rdm_world_set_body(world, ids->object, &m));
    OWN_TRY(rdm_world_get_overlap(world, ids->object, &depth));
  }
  double about_x[4], about_y[4], goal[4];
  const double a = kPi * rdm_random_uniform(random, -1, 1), b = kPi * rdm_random_uniform(random, -1, 1);
  OWN_TRY(rdm_rotation(x, a, about_x));
  OWN_TRY(rdm_rotation(y, b, about_y));
  multiply(about_x, about_y, goal);
  s->goal[0] = goal[3];
  std::copy_n(goal, 3, s->goal + 1);
  return rdm_random_split(random, &s->goals);
}

inline rdm_result grasp_control(void*, const void* instance, rdm_world* world, void* state,
                                const float* action) {
  const auto* ids = static_cast<const GraspIds*>(instance);
  auto* s = static_cast<GraspState*>(state);
  std::copy_n(action, ids->actions, s->action);
  for (int32_t i = 0; i < ids->actions; ++i) s->command[i] = static_cast<double>(action[i]);
  return rdm_world_set_commands(world, ids->hand, s->command, ids->actions);
}

inline rdm_result grasp_judge(void*, const void* instance, rdm_world* world, void* state, int32_t,
                              rdm_verdict* out) {
  const auto* ids = static_cast<const GraspIds*>(instance);
  const auto* s = static_cast<const GraspState*>(state);
  rdm_motion cube;
  rdm_joints joints{};
  joints.struct_size = sizeof joints;
  OWN_TRY(rdm_world_get_body(world, ids->object, &cube));
  OWN_TRY(rdm_world_get_joints(world, &joints));
  out->reward = 100 * (cube.pose.p[2] - 0);
  out->success = cube.pose.p[2] >= 0.1;
  double effort = 0, range = 0;
  for (int32_t i = 0; i < ids->actions; ++i) {
    const int32_t j = ids->joint[i];
    if (j < ids->fingers_from) continue;
    effort = std::max(effort, std::fabs(joints.torque[j]) / ids->effort[j]);
    if (j <= ids->first_finger_to) range = std::max(range, std::fabs(s->command[i]));
  }
  out->cost[0] = out->cost[1] = effort > 0.4;
  out->cost_raw[0] = out->cost_raw[1] = effort;
  out->cost[2] = range > 0.9;
  out->cost_raw[2] = range;
  return RDM_OK;
}

inline float* put(const double* v, int n, double scale, float* out) {
  for (int i = 0; i < n; ++i) out[i] = static_cast<float>(scale * v[i]);
  return out + n;
}

inline rdm_result grasp_observe(void*, const void* instance, const rdm_world* world, const void* state,
                                float* obs) {
  const auto* ids = static_cast<const GraspIds*>(instance);
  const auto* s = static_cast<const GraspState*>(state);
  rdm_motion m;
  rdm_joints joints{};
  joints.struct_size = sizeof joints;
  OWN_TRY(rdm_world_get_joints(world, &joints));
  for (int32_t i = 0; i < ids->joints; ++i)
    *obs++ = static_cast<float>(to_command(ids->lower[i], ids->upper[i], joints.q[i]));
  obs = put(joints.qd, ids->joints, 0.2, obs);
  obs = put(joints.torque, ids->joints, 10, obs);
  OWN_TRY(rdm_world_get_body(world, ids->object, &m));
  obs = put(m.pose.p, 3, 1, obs);
  obs = put(m.pose.q, 4, 1, obs);
  obs = put(m.v, 3, 1, obs);
  obs = put(m.w, 3, 0.2, obs);
  const double place[3] = {0, -0.4, 0.1}, goal[4] = {s->goal[1], s->goal[2], s->goal[3], s->goal[0]};
  obs = put(place, 3, 1, obs);
  obs = put(goal, 4, 1, obs);
  const double back[4] = {-goal[0], -goal[1], -goal[2], goal[3]};
  double error[4];
  multiply(m.pose.q, back, error);
  obs = put(error, 4, 1, obs);
  for (int32_t i = 0; i < ids->tips; ++i) {
    OWN_TRY(rdm_world_get_link(world, ids->tip[i], &m));
    obs = put(m.pose.p, 3, 1, obs);
    obs = put(m.pose.q, 4, 1, obs);
    obs = put(m.v, 3, 1, obs);
    obs = put(m.w, 3, 1, obs);
  }
  for (int32_t i = 0; i < ids->tips; ++i) {
    double force[3], torque[3];
    OWN_TRY(rdm_world_get_sensor(world, ids->sensor[i], force, torque));
    obs = put(force, 3, 10, obs);
    obs = put(torque, 3, 10, obs);
  }
  std::copy_n(s->action, ids->actions, obs);
  return RDM_OK;
}

struct GraspTask {
  std::vector<rdm_field_def> fields = {{"joints", "1", 72, 0, 0, 0},
                                       {"object", "1", 24, 0, 0, 0},
                                       {"tips", "1", 95, 0, 0, 0},
                                       {"action", "1", 20, -1, 1, 0}};
  std::vector<rdm_cost_def> costs = {{"cost", "a finger joint strains", 25},
                                     {"finger_effort", "a finger joint's force above 0.4 of its limit", -1},
                                     {"finger_range", "a first finger's command beyond 0.9", -1}};
  rdm_task_def def;
  GraspTask() {
    rdm_task_def_init(&def, sizeof def);
    def.name = "own_grasp";
    def.max_steps = 74;
    def.action_dim = 20;
    def.obs_limit = 5;
    def.state_bytes = sizeof(GraspState);
    def.instance_bytes = sizeof(GraspIds);
    def.fields = fields.data(), def.num_fields = 4;
    def.costs = costs.data(), def.num_costs = 3;
    def.build = grasp_build;
    def.reset = grasp_reset;
    def.control = grasp_control;
    def.judge = grasp_judge;
    def.observe = grasp_observe;
  }
};

}  // namespace rdm::test
