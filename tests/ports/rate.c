/* Whole control steps of 16 worlds of hand_over_safe_finger in a second of processor time, under random
 * actions. */
#include <redman/redman.h>
#include <stdio.h>
#include <time.h>
#if defined(_WIN32)
#include <windows.h>
#endif

/* Processor time, s; Windows' clock() is the wall's. */
static double now(void) {
#if defined(_WIN32)
  FILETIME made, ended, kernel, user;
  GetProcessTimes(GetCurrentProcess(), &made, &ended, &kernel, &user);
  return 1e-7 * (user.dwLowDateTime + 4294967296.0 * user.dwHighDateTime + kernel.dwLowDateTime +
                 4294967296.0 * kernel.dwHighDateTime);
#else
  return (double)clock() / CLOCKS_PER_SEC;
#endif
}

int main(void) {
  rdm_pool_config config;
  rdm_pool* pool = NULL;
  if (rdm_pool_config_init(&config, sizeof config) != RDM_OK) return 1;
  config.task = "hand_over_safe_finger";
  config.num_envs = 16;
  if (rdm_pool_create(&pool, &config) != RDM_OK || rdm_pool_reset(pool, NULL, NULL) != RDM_OK) return 2;
  long steps = 0;
  const double begin = now();
  do {
    for (int i = 0; i < 20; ++i)
      if (rdm_pool_baseline(pool, RDM_BASELINE_RANDOM) != RDM_OK || rdm_pool_step(pool) != RDM_OK) return 3;
    steps += 20 * 16;
  } while (now() - begin < 2);
  printf("%.0f\n", (double)steps / (now() - begin));
  return 0;
}
