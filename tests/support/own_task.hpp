// A task through the public header alone: a paddle on a rail pushes a ball over the ground. Small, fast, and
// with a fault where one is asked for.
#pragma once
#define RDM_EXPERIMENTAL
#include <redman/redman.h>

#include <atomic>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace rdm::test {

// What one of the functions does wrong.
enum class Fault {
  kNone,
  kBuildFails,
  kBuildReturnsNonsense,
  kBuildThrows,
  kResetHidden,  // draws from a count of its own
  kResetFails,
  kStatePast,  // control writes behind the state
  kStateBefore,
  kRowPast,   // observe writes behind the row
  kRowShort,  // leaves the last entry out
  kRowNan,
  kRowBound,        // beyond the field's bounds
  kObserveState,    // observe changes the state
  kObserveCounts,   // writes a count of its calls
  kObserveSets,     // tries to change the world
  kControlAction,   // changes the action
  kControlNan,      // gives a target that is not finite, and the error back
  kControlTouches,  // acts on contacts, which a saved world has not
  kJudgeNan,
  kJudgeRawNan,
  kJudgeNegative,
  kJudgeHidden,  // a reward out of a count of its own
  kJudgeLeaks,
  kStateOutside,    // keeps what check_state refuses
  kStateElsewhere,  // keeps a number outside of the state
  kHoldFlies,
};

struct BallUser {
  Fault fault = Fault::kNone;
  std::atomic<int> released{0}, built{0};
  std::atomic<int64_t> calls{0};
  double hidden = 0;
  std::vector<void*> leaked;
  ~BallUser() {
    for (void* p : leaked) std::free(p);
  }
};

struct BallIds {
  int32_t ball, paddle, rail, touch, ground;
  double push;
};

struct BallState {
  double start;
  rdm_random draws;
  float action[2];
  int64_t steps;
};

inline constexpr int kBallObs = 9, kBallActions = 2, kBallCosts = 2;

inline rdm_result ball_build(void* user, rdm_scene* scene, void* instance) {
  auto* u = static_cast<BallUser*>(user);
  auto* ids = static_cast<BallIds*>(instance);
  ++u->built;
  if (u->fault == Fault::kBuildFails) return rdm_fail(RDM_ERROR_RANGE, "the ball is too large");
  if (u->fault == Fault::kBuildReturnsNonsense) return 7;
  if (u->fault == Fault::kBuildThrows) throw 7;
  rdm_result r = rdm_scene_add_material(scene, "rubber");
  if (r == RDM_OK) r = rdm_scene_set_friction(scene, "rubber", "default", 0.8);
  rdm_robot_link link{};
  link.name = "plate", link.joint = "rail";
  link.parent = RDM_LINK_ROOT, link.kind = RDM_JOINT_PRISMATIC;
  link.pose.q[3] = 1, link.axis[0] = 1;
  link.lower = -0.3, link.upper = 0.3, link.kp = 200, link.kd = 10, link.effort = 20, link.velocity = 2;
  link.mass = 0.2;
  for (int k = 0; k < 3; ++k) link.moment[k] = 1e-3;
  rdm_robot_shape plate{};
  plate.name = "plate", plate.kind = RDM_SHAPE_BOX, plate.pose.q[3] = 1;
  plate.size[0] = 0.01, plate.size[1] = 0.1, plate.size[2] = 0.05;
  rdm_robot_def d;
  if (r == RDM_OK) r = rdm_robot_def_init(&d, sizeof d);
  d.name = "pusher", d.links = &link, d.num_links = 1, d.shapes = &plate, d.num_shapes = 1;
  rdm_scene_robot robot{};
  robot.struct_size = sizeof robot, robot.own = &d, robot.name = "paddle", robot.pose.p[2] = 0.06;
  if (r == RDM_OK) r = rdm_scene_add_robot(scene, &robot, &ids->paddle);
  rdm_shape_def sphere{};
  sphere.kind = RDM_SHAPE_SPHERE, sphere.size[0] = 0.05, sphere.material = "rubber";
  rdm_body_def ball{};
  ball.struct_size = sizeof ball, ball.name = "ball", ball.shapes = &sphere, ball.num_shapes = 1;
  ball.mass = 0.1, ball.pose.p[0] = 0.15, ball.pose.p[2] = 0.05, ball.angular_damping = 0.5;
  if (r == RDM_OK) r = rdm_scene_add_body(scene, &ball, &ids->ball);
  rdm_shape_def ground{};
  ground.name = "ground", ground.kind = RDM_SHAPE_PLANE;
  if (r == RDM_OK) r = rdm_scene_add_static(scene, &ground);
  if (r == RDM_OK) r = rdm_scene_get_number(scene, "push", &ids->push);
  if (r == RDM_OK) r = rdm_scene_find(scene, RDM_SCENE_JOINT, "paddle_rail", &ids->rail);
  if (r == RDM_OK) r = rdm_scene_find(scene, RDM_SCENE_SHAPE, "ground", &ids->ground);
  if (r == RDM_OK) r = rdm_scene_add_touch(scene, "paddle*", "ball", &ids->touch);
  return r;
}

inline rdm_result ball_reset(void* user, const void* instance, rdm_world* world, void* state,
                             rdm_random* random) {
  auto* u = static_cast<BallUser*>(user);
  const auto* ids = static_cast<const BallIds*>(instance);
  auto* s = static_cast<BallState*>(state);
  if (u->fault == Fault::kResetFails) return RDM_ERROR_STATE;
  s->start = rdm_random_uniform(random, 0.12, 0.2);
  if (u->fault == Fault::kResetHidden) s->start += 1e-3 * static_cast<double>(++u->calls % 7);
  rdm_random_split(random, &s->draws);
  rdm_motion m{};
  m.pose.p[0] = s->start, m.pose.p[2] = 0.05, m.pose.q[3] = 1;
  const double q = -0.1;
  const rdm_result r = rdm_world_set_body(world, ids->ball, &m);
  return r != RDM_OK ? r : rdm_world_set_joints(world, ids->paddle, &q, nullptr, 1);
}

inline rdm_result ball_control(void* user, const void* instance, rdm_world* world, void* state,
                               const float* action) {
  auto* u = static_cast<BallUser*>(user);
  const auto* ids = static_cast<const BallIds*>(instance);
  auto* s = static_cast<BallState*>(state);
  std::memcpy(s->action, action, sizeof s->action);
  ++s->steps;
  auto* bytes = static_cast<unsigned char*>(state);
  if (u->fault == Fault::kStatePast) bytes[sizeof(BallState) + 2] = 1;
  if (u->fault == Fault::kStateBefore) bytes[-1] = 1;
  if (u->fault == Fault::kControlAction) const_cast<float*>(action)[0] = 0;
  double command = static_cast<double>(action[0]);
  if (u->fault == Fault::kControlNan) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    return rdm_world_set_targets(world, ids->rail, &nan, 1);
  }
  size_t contacts = 0;
  if (u->fault == Fault::kControlTouches) rdm_world_get_contacts(world, nullptr, 0, &contacts);
  if (u->fault == Fault::kStateElsewhere) {
    command += u->hidden;
    u->hidden = 0.01 * static_cast<double>(action[1]);
  }
  // draws within the episode belong to the state
  const double jitter = 0.01 * rdm_random_normal(&s->draws);
  const double pushed = ids->push * static_cast<double>(action[1]) + jitter;
  const double force[3] = {pushed + static_cast<double>(contacts), 0, 0}, none[3] = {0, 0, 0};
  const double blast[3] = {1e308, 0, 0};
  rdm_result r = rdm_world_set_commands(world, ids->paddle, &command, 1);
  if (r == RDM_OK) r = rdm_world_push_body(world, ids->ball, force, none);
  if (u->fault == Fault::kHoldFlies && action[0] == 0.25f)
    for (int twice = 0; twice < 2; ++twice) rdm_world_push_body(world, ids->ball, blast, none);
  if (u->fault == Fault::kStateOutside && s->steps == 5) s->start = 100;
  return r;
}

inline rdm_result ball_judge(void* user, const void* instance, rdm_world* world, void* state, int32_t,
                             rdm_verdict* out) {
  auto* u = static_cast<BallUser*>(user);
  const auto* ids = static_cast<const BallIds*>(instance);
  auto* s = static_cast<BallState*>(state);
  rdm_motion ball;
  int32_t pairs = 0;
  double force = 0;
  rdm_result r = rdm_world_get_body(world, ids->ball, &ball);
  if (r == RDM_OK) r = rdm_world_get_touch(world, ids->touch, &pairs, &force);
  out->reward = ball.v[0];
  out->cost[0] = pairs > 0;
  out->cost_raw[0] = force;
  out->cost[1] = out->cost_raw[1] = std::fabs(ball.v[0]);
  out->terminated = std::fabs(ball.pose.p[0]) > 2;
  out->success = ball.pose.p[0] > 0.5;
  switch (u->fault) {
    case Fault::kJudgeNan:
      out->reward = s->steps == 3 ? NAN : 0;
      break;
    case Fault::kJudgeRawNan:
      out->cost_raw[1] = NAN;
      break;
    case Fault::kJudgeNegative:
      out->cost[1] = -0.5;
      break;
    case Fault::kJudgeHidden:
      out->reward += static_cast<double>(++u->calls % 5);
      break;
    case Fault::kJudgeLeaks:
      u->leaked.push_back(std::malloc(100));
      break;
    default:
      break;
  }
  return r;
}

inline rdm_result ball_observe(void* user, const void* instance, const rdm_world* world, const void* state,
                               float* obs) {
  auto* u = static_cast<BallUser*>(user);
  const auto* ids = static_cast<const BallIds*>(instance);
  const auto* s = static_cast<const BallState*>(state);
  rdm_motion ball;
  rdm_joints joints{};
  joints.struct_size = sizeof joints;
  rdm_result r = rdm_world_get_body(world, ids->ball, &ball);
  if (r == RDM_OK) r = rdm_world_get_joints(world, &joints);
  if (r != RDM_OK) return r;
  for (int k = 0; k < 3; ++k) obs[k] = static_cast<float>(ball.pose.p[k]);
  for (int k = 0; k < 3; ++k) obs[3 + k] = static_cast<float>(ball.v[k]);
  obs[6] = static_cast<float>(joints.q[ids->rail]);
  obs[7] = s->action[0];
  if (u->fault != Fault::kRowShort) obs[8] = s->action[1];
  switch (u->fault) {
    case Fault::kRowPast:
      obs[9] = 0;
      break;
    case Fault::kRowNan:
      if (s->steps == 2) obs[4] = NAN;
      break;
    case Fault::kRowBound:
      obs[8] = 1.5f;
      break;
    case Fault::kObserveState:
      ++const_cast<BallState*>(s)->steps;
      break;
    case Fault::kObserveCounts:
      obs[0] += static_cast<float>(++u->calls);
      break;
    case Fault::kObserveSets: {
      rdm_motion m{};
      m.pose.q[3] = 1;
      return rdm_world_set_body(const_cast<rdm_world*>(world), ids->ball, &m);
    }
    default:
      break;
  }
  return RDM_OK;
}

inline rdm_result ball_check_state(void*, const void*, const void* state) {
  const auto* s = static_cast<const BallState*>(state);
  if (!(std::fabs(s->start) <= 1)) return rdm_fail(RDM_ERROR_FORMAT, "start is not within +-1");
  for (const float a : s->action)
    if (!(std::fabs(a) <= 1)) return rdm_fail(RDM_ERROR_FORMAT, "an action is not within +-1");
  if (s->steps < 0 || s->steps > 1000000) return rdm_fail(RDM_ERROR_FORMAT, "steps are outside [0, 1e6]");
  return RDM_OK;
}

// The description, with all it points to.
struct BallTask {
  BallUser user;
  std::vector<rdm_field_def> fields = {{"ball.position", "m", 3, 0, 0, 0},
                                       {"ball.velocity", "m/s", 3, 0, 0, 0},
                                       {"paddle.position", "m", 1, -0.4f, 0.4f, 0},
                                       {"action", "1", kBallActions, -1, 1, 0}};
  std::vector<rdm_cost_def> costs = {{"touch", "the paddle touches the ball", 5},
                                     {"speed", "of the ball", -1}};
  std::vector<rdm_option_def> options = {
      {"push", "force of an action entry of 1 on the ball, N", nullptr, nullptr, 0.05, 0, 10, RDM_KIND_NUMBER,
       0},
      {"mood", "does nothing", "calm", "calm|wild", 0, 0, 0, RDM_KIND_TEXT, 0},
      {"frequency", nullptr, nullptr, nullptr, 50, 0, 0, RDM_KIND_NUMBER, 0}};
  std::vector<rdm_camera_def> cameras = {{"front", {0, -1.0f, 0.5f}, {0, 0, 0}, 0.8f, 0, {}, 0, 0, 0}};
  std::vector<rdm_option> defaults = {{"hidden", "16,16", 0}, {"horizon", nullptr, 64}};
  float hold[kBallActions] = {0.25f, 0};
  rdm_task_def def;

  explicit BallTask(const char* name, Fault fault = Fault::kNone) {
    user.fault = fault;
    rdm_task_def_init(&def, sizeof def);
    def.name = name;
    def.summary = "push a ball with a paddle";
    def.max_steps = 40;
    def.action_dim = kBallActions;
    def.hold = hold;
    def.obs_limit = 5;
    def.state_bytes = sizeof(BallState);
    def.instance_bytes = sizeof(BallIds);
    def.user = &user;
    def.build = ball_build;
    def.reset = ball_reset;
    def.control = ball_control;
    def.judge = ball_judge;
    def.observe = ball_observe;
    def.check_state = ball_check_state;
    def.release = [](void* u) { ++static_cast<BallUser*>(u)->released; };
    bind();
  }
  void bind() {
    def.fields = fields.data(), def.num_fields = static_cast<int32_t>(fields.size());
    def.costs = costs.data(), def.num_costs = static_cast<int32_t>(costs.size());
    def.options = options.data(), def.num_options = static_cast<int32_t>(options.size());
    def.cameras = cameras.data(), def.num_cameras = static_cast<int32_t>(cameras.size());
    def.defaults = defaults.data(), def.num_defaults = static_cast<int32_t>(defaults.size());
  }
};

// A task in the list while it lives.
class Registered {
 public:
  explicit Registered(const rdm_task_def& def) {
    if (rdm_task_create(&task_, &def) == RDM_OK) return;
    std::fprintf(stderr, "%s\n", rdm_last_error());
    std::abort();
  }
  ~Registered() { rdm_task_destroy(task_); }
  Registered(const Registered&) = delete;
  Registered& operator=(const Registered&) = delete;
  int32_t index() const { return task_; }

 private:
  int32_t task_ = -1;
};

}  // namespace rdm::test
