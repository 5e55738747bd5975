/* The least that simulates: worlds of a task under random actions, 200 steps. worlds TASK COUNT */
#include <redman/redman.h>
#include <stdlib.h>

#include "peak.h"

int main(int argc, char** argv) {
  rdm_pool_config config;
  rdm_pool* pool = NULL;
  size_t bytes = 0;
  if (argc < 3 || rdm_pool_config_init(&config, sizeof config) != RDM_OK) return 1;
  config.task = argv[1];
  config.num_envs = atoi(argv[2]);
  if (rdm_pool_config_memory(&config, &bytes, NULL) != RDM_OK || rdm_pool_create(&pool, &config) != RDM_OK)
    return 2;
  if (rdm_pool_reset(pool, NULL, NULL) != RDM_OK) return 3;
  for (int i = 0; i < 200; ++i)
    if (rdm_pool_baseline(pool, RDM_BASELINE_RANDOM) != RDM_OK || rdm_pool_step(pool) != RDM_OK) return 4;
  printf("%ld %zu\n", peak_kb(), bytes);
  return 0;
}
