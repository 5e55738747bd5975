/* Four worlds that hold their start pose, then the same four moved by a saved policy: what the other
 * languages' folders repeat, line by line of output.
 *
 *   hello POLICY [bench]
 *
 * bench: what a step costs, in CPU time. */
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static void check(rdm_result result) {
  if (result == RDM_OK) return;
  fprintf(stderr, "hello: %s\n", rdm_last_error());
  exit(1);
}

/* Worlds at the start of their first episode, with actions that hold the start pose. */
static rdm_pool* make_pool(const char* task, int32_t num_envs, uint64_t seed) {
  rdm_pool_config config;
  rdm_pool* pool = NULL;
  check(rdm_pool_config_init(&config, sizeof config));
  config.task = task;
  config.num_envs = num_envs;
  config.seed = seed;
  config.autoreset = RDM_AUTORESET_NEXT_STEP; /* ended worlds rest until the next step */
  check(rdm_pool_create(&pool, &config));
  check(rdm_pool_reset(pool, NULL, NULL));
  check(rdm_pool_baseline(pool, RDM_BASELINE_HOLD));
  return pool;
}

typedef struct outcome {
  double sum, cost; /* of world 0 */
  uint64_t hash;    /* of all states */
} outcome;

/* 75 steps; policy NULL: the start pose is held. */
static outcome play(const rdm_policy* policy) {
  rdm_pool* pool = make_pool("hand_over_safe_finger", 4, 7);
  rdm_spec spec = {.struct_size = sizeof spec};
  rdm_buffers rows = {.struct_size = sizeof rows};
  rdm_policy_info info = {.struct_size = sizeof info};
  outcome o = {0, 0, 0};
  void* scratch = NULL;
  size_t size = 0;
  check(rdm_pool_get_spec(pool, &spec));
  check(rdm_pool_get_buffers(pool, &rows));
  if (policy) {
    check(rdm_policy_check(policy, &spec));
    check(rdm_policy_get_info(policy, &info));
    size = rdm_policy_scratch(policy, 4);
    scratch = malloc(size);
    if (!scratch) abort();
  }
  for (int t = 0; t < 75; ++t) {
    if (policy && t % info.action_repeat == 0)
      check(rdm_policy_act(policy, rows.obs, 4, NULL, rows.action, scratch, size));
    check(rdm_pool_step(pool));
    o.sum += rows.reward[0];
    o.cost += rows.cost[0];
  }
  check(rdm_pool_get_hash(pool, -1, &o.hash));
  free(scratch);
  rdm_pool_destroy(pool);
  return o;
}

/* CPU seconds of one step of the pool. */
static double measure(const char* task, int32_t num_envs, int calls) {
  rdm_pool* pool = make_pool(task, num_envs, 0);
  for (int t = 0; t < calls; ++t) check(rdm_pool_step(pool)); /* warms up */
  const clock_t start = clock();
  for (int t = 0; t < calls; ++t) check(rdm_pool_step(pool));
  const double seconds = (double)(clock() - start) / CLOCKS_PER_SEC;
  rdm_pool_destroy(pool);
  return seconds / calls;
}

int main(int argc, char** argv) {
  rdm_policy* policy = NULL;
  if (argc < 2) {
    fprintf(stderr, "usage: hello POLICY [bench]\n");
    return 2;
  }
  outcome o = play(NULL);
  printf("hold cost %.0f hash %016llx\n", o.cost, (unsigned long long)o.hash);
  check(rdm_policy_read_file(&policy, argv[1]));
  o = play(policy);
  printf("policy return %.4f cost %.0f hash %016llx\n", o.sum, o.cost, (unsigned long long)o.hash);
  rdm_policy_destroy(policy);
  if (argc > 2) {
    printf("bandit %.0f ns a step\n", 1e9 * measure("bandit", 1, 1000000));
    printf("hand_over %.0f steps/s of 1 world\n", 1 / measure("hand_over_safe_finger", 1, 40000));
    printf("hand_over %.0f steps/s of 64 worlds\n", 64 / measure("hand_over_safe_finger", 64, 1000));
  }
  return 0;
}
