/* Whole control steps of 16 worlds of hand_over_safe_finger in a second of processor time, under random
 * actions. */
#include <redman/redman.h>
#include <stdio.h>
#include <time.h>

int main(void) {
  rdm_pool_config config;
  rdm_pool* pool = NULL;
  if (rdm_pool_config_init(&config, sizeof config) != RDM_OK) return 1;
  config.task = "hand_over_safe_finger";
  config.num_envs = 16;
  if (rdm_pool_create(&pool, &config) != RDM_OK || rdm_pool_reset(pool, NULL, NULL) != RDM_OK) return 2;
  long steps = 0;
  const clock_t begin = clock();
  do {
    for (int i = 0; i < 20; ++i)
      if (rdm_pool_baseline(pool, RDM_BASELINE_RANDOM) != RDM_OK || rdm_pool_step(pool) != RDM_OK) return 3;
    steps += 20 * 16;
  } while (clock() - begin < 2 * CLOCKS_PER_SEC);
  printf("%.0f\n", (double)steps * CLOCKS_PER_SEC / (double)(clock() - begin));
  return 0;
}
