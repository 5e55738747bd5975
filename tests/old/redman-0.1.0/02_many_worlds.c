/* 02: many worlds in one pool, stepped by two threads.
 *
 *   02_many_worlds [steps] [threads]
 *
 * Row i of every buffer belongs to world i. Episodes that end start again by themselves; in that step
 * `terminated` or `truncated` is set and `episode_return` holds the finished episode's sum. */
#define _POSIX_C_SOURCE 199309L
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

enum { WORLDS = 16 };

static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

int main(int argc, char** argv) {
  const int steps = argc > 1 ? atoi(argv[1]) : 1000;
  rdm_pool_config config;
  rdm_pool* pool = NULL;
  rdm_spec spec = {.struct_size = sizeof spec};
  rdm_buffers b = {.struct_size = sizeof b};
  double returns = 0, costs = 0;
  int episodes = 0, status = 1;
  uint64_t hash = 0;

  if (rdm_pool_config_init(&config, sizeof config)) goto done;
  config.task = "hand_over_safe_finger";
  config.num_envs = WORLDS;
  config.num_threads = argc > 2 ? atoi(argv[2]) : 2;
  config.seed = 1;
  if (rdm_pool_create(&pool, &config)) goto done;
  if (rdm_pool_get_spec(pool, &spec) || rdm_pool_buffers(pool, &b)) goto done;
  if (rdm_pool_reset(pool, NULL, NULL)) goto done;

  const double start = seconds();
  for (int s = 0; s < steps; ++s) {
    if (rdm_pool_baseline(pool, RDM_BASELINE_RANDOM) || rdm_pool_step(pool)) goto done;
    for (int i = 0; i < WORLDS; ++i) {
      if (!b.terminated[i] && !b.truncated[i]) continue;
      returns += (double)b.episode_return[i];
      costs += (double)b.episode_cost[i * spec.cost_dim];
      ++episodes;
    }
  }
  const double elapsed = seconds() - start;
  if (rdm_pool_hash(pool, -1, &hash)) goto done;

  printf("%d worlds, %d threads: %.0f steps/s\n", WORLDS, (int)config.num_threads, WORLDS * steps / elapsed);
  if (episodes)
    printf("%d episodes of random actions: mean return %.3f, mean cost %.2f\n", episodes, returns / episodes,
           costs / episodes);
  printf("state hash %016llx: the same for any number of threads\n", (unsigned long long)hash);
  status = 0;
done:
  if (status) fprintf(stderr, "02_many_worlds: %s\n", rdm_last_error());
  rdm_pool_destroy(pool);
  return status;
}
