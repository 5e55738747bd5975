/* 07: a task of your own: its scene, observation, reward and cost, for all that the library does with tasks.
 *
 *   07_own_task [epochs]
 *   cc -shared -fPIC 07_own_task.c -lredman -o press.so && redman --plugin ./press.so train --task press
 *
 * A Shadow Hand presses a button with its first finger; touching the cup beside it costs 1 per step. */
#define RDM_EXPERIMENTAL
#include <math.h>
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>

enum { JOINTS = 24, COMMANDS = 20 };
typedef struct ids { /* what build leaves for the other functions */
  int32_t hand, cup, spring, tip, touch;
} ids;

static rdm_result build(void* user, rdm_scene* scene, void* instance) {
  ids* id = instance;
  /* the button is a tree of one link: a cap on a spring */
  const rdm_robot_shape top = {"top", .kind = RDM_SHAPE_CYLINDER, .size = {0.012, 0.006}, .pose.q[3] = 1};
  rdm_robot_link cap = {"cap", "spring", .parent = RDM_LINK_ROOT, .kind = RDM_JOINT_PRISMATIC, .mass = 0.02};
  const rdm_shape_def side = {.kind = RDM_SHAPE_CYLINDER, .size = {.02, .025}},
                      ground = {"ground", .kind = RDM_SHAPE_PLANE};
  const rdm_body_def cup = {sizeof cup, 1, "cup", &side, .pose.p = {0.01, -0.43, 0.025}, .mass = 0.1};
  rdm_robot_def press;
  rdm_scene_robot hand;
  const rdm_scene_robot button = {sizeof button, .own = &press, .name = "button",
                                  .pose.p = {-0.033, -0.43, 0.03}};
  (void)user;
  cap.pose.q[3] = cap.axis[2] = 1, cap.lower = -0.01, cap.kp = 100, cap.kd = 2, cap.effort = 2;
  cap.moment[0] = cap.moment[1] = cap.moment[2] = 1e-5;
  if (rdm_robot_def_init(&press, sizeof press) || rdm_scene_robot_init(&hand, sizeof hand))
    return RDM_ERROR_ARGUMENT;
  press.name = "button", press.links = &cap, press.num_links = 1, press.shapes = &top, press.num_shapes = 1;
  hand.name = "hand", hand.pose.p[2] = 0.1, hand.pose.q[1] = 1, hand.pose.q[3] = 0;
  if (rdm_robot_find("shadow_hand", &hand.robot) || rdm_scene_add_robot(scene, &hand, &id->hand) ||
      rdm_scene_add_robot(scene, &button, NULL) || rdm_scene_add_body(scene, &cup, &id->cup) ||
      rdm_scene_add_static(scene, &ground) ||
      rdm_scene_find(scene, RDM_SCENE_JOINT, "button_spring", &id->spring) ||
      rdm_scene_find(scene, RDM_SCENE_LINK, "hand_ff_distal", &id->tip))
    return RDM_ERROR_ARGUMENT; /* with the text of what failed */
  return rdm_scene_add_touch(scene, "hand", "cup", &id->touch);
}

static rdm_result reset(void* user, const void* instance, rdm_world* world, void* state, rdm_random* random) {
  double q[JOINTS];
  (void)user, (void)state;
  for (int i = 0; i < JOINTS; ++i) q[i] = rdm_random_uniform(random, 0, 0.1);
  return rdm_world_set_joints(world, ((const ids*)instance)->hand, q, NULL, JOINTS);
}

static rdm_result control(void* user, const void* instance, rdm_world* world, void* state, const float* a) {
  double command[COMMANDS];
  (void)user, (void)state;
  for (int i = 0; i < COMMANDS; ++i) command[i] = a[i];
  return rdm_world_set_commands(world, ((const ids*)instance)->hand, command, COMMANDS);
}

static rdm_result judge(void* user, const void* instance, rdm_world* world, void* state, int32_t step,
                        rdm_verdict* out) {
  const ids* id = instance;
  rdm_joints joints = {.struct_size = sizeof joints};
  rdm_motion tip, cap;
  int32_t touching = 0;
  (void)user, (void)state, (void)step;
  if (rdm_world_get_joints(world, &joints) ||
      rdm_world_get_touch(world, id->touch, &touching, out->cost_raw) ||
      rdm_world_get_link(world, id->tip, &tip) || rdm_world_get_link(world, id->spring, &cap))
    return RDM_ERROR_STATE;
  const double pressed = joints.q[id->spring] / -0.01;
  out->reward = pressed - 5 * (fabs(tip.pose.p[1] - cap.pose.p[1]) + fabs(tip.pose.p[2] - cap.pose.p[2]));
  out->cost[0] = touching > 0;
  out->success = pressed > 0.8;
  return RDM_OK;
}

static rdm_result observe(void* user, const void* instance, const rdm_world* w, const void* state,
                          float* obs) {
  rdm_joints joints = {.struct_size = sizeof joints};
  rdm_motion cup;
  (void)user, (void)state;
  if (rdm_world_get_joints(w, &joints) || rdm_world_get_body(w, ((const ids*)instance)->cup, &cup))
    return RDM_ERROR_STATE;
  for (int i = 0; i <= JOINTS; ++i) *obs++ = (float)joints.q[i]; /* the hand's, then the button's */
  for (int i = 0; i <= JOINTS; ++i) *obs++ = (float)(0.1 * joints.qd[i]);
  for (int k = 0; k < 3; ++k) *obs++ = (float)cup.pose.p[k];
  return RDM_OK;
}

static int32_t task = -1;        /* its number */
rdm_result redman_plugin(void) { /* the tool calls it of a library that is given by --plugin */
  static const rdm_field_def fields[] = {{"joints", "rad", JOINTS + 1, 0, 0, 0},
                                         {"rates", "10 rad/s", JOINTS + 1, 0, 0, 0},
                                         {"cup", "m", 3, 0, 0, 0}};
  static const rdm_cost_def cost = {"touch", "the hand touches the cup; raw: contact force, N", 5};
  rdm_task_def def;
  if (rdm_task_def_init(&def, sizeof def)) return RDM_ERROR_ARGUMENT;
  def.name = "press", def.summary = "press a button; cost: touching the cup beside it";
  def.fields = fields, def.num_fields = 3, def.costs = &cost, def.num_costs = 1;
  def.action_dim = COMMANDS, def.obs_limit = 5, def.instance_bytes = sizeof(ids), def.max_steps = 60;
  def.build = build, def.reset = reset, def.control = control, def.judge = judge, def.observe = observe;
  return rdm_task_create(&task, &def);
}

int main(int argc, char** argv) {
  rdm_pool_config w;
  rdm_agent_config l;
  rdm_pool* pool = NULL;
  rdm_agent* agent = NULL;
  rdm_epoch e = {.struct_size = sizeof e};
  int status = redman_plugin() || rdm_task_check("press", NULL, NULL, NULL, NULL, 0) ||
               rdm_pool_config_init(&w, sizeof w) || rdm_agent_config_init(&l, sizeof l);
  w.task = "press", w.num_envs = 64;
  status = status || rdm_pool_create(&pool, &w) || rdm_pool_reset(pool, NULL, NULL) ||
           rdm_agent_config_for_pool(&l, pool) || rdm_agent_create(&agent, &l);
  for (int i = 0; !status && i < (argc > 1 ? atoi(argv[1]) : 5); ++i) {
    status = rdm_agent_rollout(agent, pool, &e) != RDM_OK;
    if (!status)
      printf("epoch %2d: return %6.2f, cost %5.2f, success %.2f\n", i + 1, e.ret, e.cost[0], e.success_rate);
  }
  if (status) fprintf(stderr, "07_own_task: %s\n", rdm_last_error());
  rdm_agent_destroy(agent);
  rdm_pool_destroy(pool);
  if (task >= 0) rdm_task_destroy(task);
  return status;
}
