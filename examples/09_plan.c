/* 09: planning in the place of learning.
 *
 *   09_plan [task] [episodes] [planner's options] [task's options], options as key=value with commas between
 *
 * In each step many worlds are rolled out from where the one stands, and the plan moves to what went best.
 * The model is the world itself, so this is what a perfect one gives. */
#define RDM_EXPERIMENTAL
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* Lines of settings out of a list with commas; NULL for one that is longer than text [size]. */
static const char* lines(char* text, size_t size, const char* list) {
  if (strlen(list) >= size) return NULL;
  memcpy(text, list, strlen(list) + 1);
  for (char* c = text; *c; ++c)
    if (*c == ',') *c = '\n';
  return text;
}

int main(int argc, char** argv) {
  const char* task = argc > 1 ? argv[1] : "hand_over_safe_finger";
  const int episodes = argc > 2 ? atoi(argv[2]) : 1;
  char planning[512], options[512];
  rdm_pool_config pool_config;
  rdm_planner_config config;
  rdm_pool* pool = NULL;
  rdm_planner* planner = NULL;
  rdm_buffers b = {.struct_size = sizeof b};
  rdm_plan_info info = {.struct_size = sizeof info};
  double ret = 0, cost = 0, steps = 0, seconds = 0;
  int falls = 0, successes = 0, status = 1;

  if (episodes < 1 || !lines(planning, sizeof planning, argc > 3 ? argv[3] : "samples=32,horizon=20") ||
      !lines(options, sizeof options, argc > 4 ? argv[4] : "")) {
    fprintf(stderr, "09_plan: fewer than 1 episode, or more than 511 characters of options\n");
    return 2;
  }
  if (rdm_pool_config_init(&pool_config, sizeof pool_config)) goto done;
  pool_config.task = task;
  pool_config.autoreset = RDM_AUTORESET_OFF;
  pool_config.settings = options;
  if (rdm_pool_create(&pool, &pool_config)) goto done;
  if (rdm_pool_get_buffers(pool, &b)) goto done;

  if (rdm_planner_config_init(&config, sizeof config)) goto done;
  config.pool = pool; /* its task and options: what the rollouts have */
  config.settings = planning;
  if (rdm_planner_create(&planner, &config)) goto done;

  for (int e = 0; e < episodes; ++e) {
    int success = 0;
    if (rdm_pool_reset(pool, NULL, NULL) || rdm_planner_reset(planner)) goto done;
    do {
      const clock_t begin = clock();
      if (rdm_planner_act(planner, pool, 0, b.action, &info)) goto done;
      seconds += (double)(clock() - begin) / CLOCKS_PER_SEC;
      if (rdm_pool_step(pool)) goto done;
      success |= b.success[0];
    } while (!b.terminated[0] && !b.truncated[0]);
    ret += (double)b.episode_return[0];
    cost += (double)b.episode_cost[0];
    steps += b.episode_step[0];
    falls += b.terminated[0];
    successes += success;
  }
  printf("%s: %d episodes, return %.3f, cost %.3f, %.1f steps, falls %d, success %d\n", task, episodes,
         ret / episodes, cost / episodes, steps / episodes, falls, successes);
  printf("%.2f ms of processor time an action\n", 1e3 * seconds / steps);
  status = 0;

done:
  if (status) fprintf(stderr, "09_plan: %s\n", rdm_last_error());
  rdm_planner_destroy(planner);
  rdm_pool_destroy(pool);
  return status;
}
