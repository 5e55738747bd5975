/* 03: an agent learns from a pool.
 *
 *   03_train [epochs] [policy file]
 *
 * PPO with a Lagrange multiplier: reward up, cost under its limit. One call collects and learns one epoch. */
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char** argv) {
  const int epochs = argc > 1 ? atoi(argv[1]) : 5;
  const char* path = argc > 2 ? argv[2] : "policy.rdm";
  rdm_pool_config pool_config;
  rdm_agent_config agent_config;
  rdm_pool* pool = NULL;
  rdm_agent* agent = NULL;
  rdm_epoch e = {.struct_size = sizeof e};
  int status = 1;

  if (rdm_pool_config_init(&pool_config, sizeof pool_config)) goto done;
  pool_config.task = "hand_over_safe_finger";
  pool_config.num_envs = 64;
  if (rdm_pool_create(&pool, &pool_config)) goto done;
  if (rdm_pool_reset(pool, NULL, NULL)) goto done;

  /* Sizes, cost limits and the task's own learner settings come from the pool. */
  if (rdm_agent_config_init(&agent_config, sizeof agent_config)) goto done;
  if (rdm_agent_config_for_pool(&agent_config, pool)) goto done;
  agent_config.algo = "ppo_lag";
  if (rdm_agent_create(&agent, &agent_config)) goto done;

  printf("epoch    steps   return     cost  falls  multiplier\n");
  for (int i = 0; i < epochs; ++i) {
    if (rdm_agent_rollout(agent, pool, &e)) goto done;
    printf("%5d %8lld %8.3f %8.2f %5.0f%% %11.4f\n", (int)e.epoch, (long long)e.env_steps, e.ret, e.cost[0],
           100 * e.fall_rate, e.multiplier[0]);
  }
  if (rdm_agent_policy_file(agent, path)) goto done;
  printf("wrote %s\n", path);
  status = 0;
done:
  if (status) fprintf(stderr, "03_train: %s\n", rdm_last_error());
  rdm_agent_destroy(agent);
  rdm_pool_destroy(pool);
  return status;
}
