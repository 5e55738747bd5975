/* A host written in C99: version, discovery, a pool of the first task, a few steps. */
#include <redman/redman.h>
#include <stdio.h>

static int failed(const char* what) {
  printf("%s: %s\n", what, rdm_last_error());
  return 1;
}

int main(void) {
  rdm_task task = {sizeof task};
  rdm_pool_config config;
  rdm_buffers rows = {sizeof rows};
  rdm_pool* pool = NULL;
  int step;

  if (rdm_check_abi(RDM_ABI, RDM_VERSION)) return failed("check_abi");
  if (!(rdm_features() & RDM_FEATURE_SIM)) return rdm_task_count() == 0 ? 0 : failed("features");
  if (rdm_task_at(0, &task)) return failed("task_at");
  if (rdm_pool_config_init(&config, sizeof config)) return failed("config_init");
  config.task = task.name;
  config.num_envs = 2;
  if (rdm_pool_create(&pool, &config)) return failed("create");
  if (rdm_pool_get_buffers(pool, &rows)) return failed("buffers");
  if (rdm_pool_reset(pool, NULL, NULL)) return failed("reset");
  for (step = 0; step < 5; ++step)
    if (rdm_pool_step(pool)) return failed("step");
  if (rows.episode_step[1] != 5) return failed("episode_step");
  printf("%s: 5 steps of %d worlds\n", task.name, (int)config.num_envs);
  rdm_pool_destroy(pool);
  return 0;
}
