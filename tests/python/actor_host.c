/* A host in C: actor_host POLICY TASK SEED EPISODES SETTINGS plays the episodes SEED, SEED + 1, ..., each in a world of its own,
 * and prints of each: return, control steps, costs; numbers as C's %a. */
#define RDM_EXPERIMENTAL
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>

static int check(rdm_result r) {
  if (r) fprintf(stderr, "actor_host: %s\n", rdm_last_error());
  return r == RDM_OK;
}

int main(int argc, char** argv) {
  if (argc != 6) return 2;
  const int n = atoi(argv[4]);
  uint64_t* seed = calloc((size_t)n, sizeof *seed);
  uint8_t* live = calloc((size_t)n, 1);
  for (int i = 0; i < n; ++i) seed[i] = strtoull(argv[3], NULL, 10) + (uint64_t)i, live[i] = 1;

  rdm_pool* pool = NULL;
  rdm_policy* policy = NULL;
  rdm_actor* actor = NULL;
  rdm_pool_config config;
  rdm_actor_config how;
  rdm_spec spec = {.struct_size = sizeof spec};
  rdm_buffers rows = {.struct_size = sizeof rows};
  if (!check(rdm_pool_config_init(&config, sizeof config)) || !check(rdm_actor_config_init(&how, sizeof how)))
    return 1;
  config.task = argv[2];
  config.num_envs = n;
  config.autoreset = RDM_AUTORESET_OFF;
  config.settings = argv[5];
  if (!check(rdm_pool_create(&pool, &config)) || !check(rdm_pool_get_spec(pool, &spec)) ||
      !check(rdm_pool_get_buffers(pool, &rows)) || !check(rdm_policy_read_file(&policy, argv[1])))
    return 1;
  how.policy = policy;
  how.spec = &spec;
  how.num_envs = n;
  if (!check(rdm_actor_create(&actor, &how)) || !check(rdm_pool_reset(pool, seed, NULL))) return 1;
  for (int left = n; left > 0;) {
    if (!check(rdm_actor_act(actor, rows.obs, NULL, live, rows.action)) ||
        !check(rdm_pool_step_masked(pool, live)))
      return 1;
    for (int i = 0; i < n; ++i)
      if (live[i] && (rows.terminated[i] || rows.truncated[i])) live[i] = 0, --left;
  }
  for (int i = 0; i < n; ++i) {
    printf("%a %d", (double)rows.episode_return[i], (int)rows.episode_step[i]);
    for (int k = 0; k < spec.cost_dim; ++k) printf(" %a", (double)rows.episode_cost[i * spec.cost_dim + k]);
    printf("\n");
  }
  rdm_actor_destroy(actor);
  rdm_policy_destroy(policy);
  rdm_pool_destroy(pool);
  free(seed);
  free(live);
  return 0;
}
