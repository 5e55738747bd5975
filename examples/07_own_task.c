/* 07: a task of your own: a scene, an observation, a reward and costs, for all that the library does with tasks.
 *
 *   07_own_task [epochs]
 *   cc -shared -fPIC 07_own_task.c -lredman -o press.so;  redman --plugin ./press.so train --task press
 *
 * A Shadow Hand over the ground presses a button with its first finger. Beside the button stands a cup, where the other
 * fingers would press: touching it costs 1 per step. */
#define RDM_EXPERIMENTAL
#include <math.h>
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { JOINTS = 24, COMMANDS = 20, TIP = 3 };
/* What build leaves for the other functions, and what a world keeps from step to step. */
typedef struct press_ids {
  int32_t hand, button, cup, spring, tip, touch;
} press_ids;
typedef struct press_state {
  float action[COMMANDS];
} press_state;

static rdm_result build(void* user, rdm_scene* scene, void* instance) {
  press_ids* ids = instance;
  const double down[4] = {0, 1, 0, 0}, button_at[3] = {-0.033, -0.37, 0.03};
  const rdm_robot_shape top = {.name = "top", .kind = RDM_CYLINDER, .size = {0.012, 0.006}, .q = {0, 0, 0, 1}};
  const rdm_robot_link slide = {.name = "cap", .joint = "spring", .parent = RDM_ROOT_LINK, .kind = RDM_PRISMATIC,
                                .q = {0, 0, 0, 1}, .axis = {0, 0, 1}, .lower = -0.01, .upper = 0, .kp = 100, .kd = 2,
                                .effort = 2, .mass = 0.02, .moment = {1e-5, 1e-5, 1e-5}};
  const rdm_shape_def ground = {.name = "ground", .kind = RDM_PLANE};
  const rdm_shape_def side = {.kind = RDM_CYLINDER, .size = {0.02, 0.025}, .color = {200, 60, 60, 255}};
  rdm_robot_def press;
  rdm_scene_robot hand = {.struct_size = sizeof hand, .name = "hand", .p = {0, 0, 0.1}};
  rdm_scene_robot button = {.struct_size = sizeof button, .name = "button", .def = &press};
  rdm_body_def cup = {.struct_size = sizeof cup, .name = "cup", .shapes = &side, .num_shapes = 1, .mass = 0.1,
                      .p = {0.012, -0.385, 0.025}};
  rdm_result r = rdm_robot_def_init(&press, sizeof press);
  (void)user;
  press.name = "button", press.links = &slide, press.num_links = 1, press.shapes = &top, press.num_shapes = 1;
  memcpy(hand.q, down, sizeof down);
  memcpy(button.p, button_at, sizeof button_at);
  if (!r) r = rdm_robot_find("shadow_hand", &hand.robot);
  if (!r) r = rdm_scene_add_robot(scene, &hand, &ids->hand);
  if (!r) r = rdm_scene_add_robot(scene, &button, &ids->button);
  if (!r) r = rdm_scene_add_body(scene, &cup, &ids->cup);
  if (!r) r = rdm_scene_add_static(scene, &ground);
  if (!r) r = rdm_scene_find(scene, RDM_SCENE_JOINT, "button_spring", &ids->spring);
  if (!r) r = rdm_scene_find(scene, RDM_SCENE_SENSOR, "hand_ffdistal", &ids->tip);
  if (!r) r = rdm_scene_find(scene, RDM_SCENE_LINK, "hand_ffdistal", &ids->tip);
  if (!r) r = rdm_scene_touch(scene, "hand", "cup", &ids->touch);
  return r;
}

static rdm_result reset(void* user, const void* instance, rdm_world* world, void* state, rdm_random* random) {
  const press_ids* ids = instance;
  double q[JOINTS];
  (void)user, (void)state;
  for (int i = 0; i < JOINTS; ++i) q[i] = rdm_random_uniform(random, 0, 0.1);
  return rdm_world_set_joints(world, ids->hand, q, NULL, JOINTS);
}

static rdm_result control(void* user, const void* instance, rdm_world* world, void* state, const float* action) {
  const press_ids* ids = instance;
  press_state* s = state;
  double command[COMMANDS];
  (void)user;
  for (int i = 0; i < COMMANDS; ++i) command[i] = s->action[i] = action[i];
  return rdm_world_command(world, ids->hand, command, COMMANDS);
}

/* How far the button is pressed, 0 to 1, and how far the first finger's last link is from it, m. */
static rdm_result look(const press_ids* ids, const rdm_world* world, rdm_joints* joints, double* pressed, double* gap) {
  rdm_motion tip, cap;
  rdm_result r = rdm_world_joints(world, joints);
  if (!r) r = rdm_world_link(world, ids->tip, &tip);
  if (!r) r = rdm_world_link(world, ids->spring, &cap);
  if (r) return r;
  *pressed = joints->q[ids->spring] / -0.01;
  *gap = sqrt(pow(tip.p[0] - cap.p[0], 2) + pow(tip.p[1] - cap.p[1], 2) + pow(tip.p[2] - cap.p[2], 2));
  return r;
}
