/* One learner of many processes, through redman.h alone.
 *
 *   distributed_fork [ranks] [worlds] [epochs] [task] [algorithm] [threads] [blocks]
 *   mpirun -n 4 distributed_mpi 0 [worlds] ...
 *
 * The same program twice: with USE_MPI the processes are MPI's. worlds: of all ranks. The last line is a hash
 * of the policy, the same for any number of ranks, and how fast they were. */
#define _POSIX_C_SOURCE 200112L
#define RDM_EXPERIMENTAL
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>
#ifdef USE_MPI
#include "mpi_ranks.h"
#else
#include "fork_ranks.h"
#endif

typedef struct {
  int ranks, worlds, epochs, threads, blocks;
  const char *task, *algo;
} arguments;

static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static unsigned long long hash_of(const unsigned char* bytes, size_t size) {
  unsigned long long hash = 14695981039346656037ull;
  for (size_t i = 0; i < size; ++i) hash = (hash ^ bytes[i]) * 1099511628211ull;
  return hash;
}

static int train(const arguments* a, const rdm_ranks* ranks) {
  rdm_pool_config pool_config;
  rdm_agent_config agent_config;
  rdm_pool* pool = NULL;
  rdm_agent* agent = NULL;
  rdm_epoch e = {.struct_size = sizeof e};
  unsigned char* policy = NULL;
  char settings[32];
  size_t size = 0;
  double *busy = calloc((size_t)ranks->ranks, sizeof *busy), slowest = 0;
  int status = 1;

  if (rdm_pool_config_init(&pool_config, sizeof pool_config)) goto done;
  pool_config.task = a->task;
  pool_config.num_envs = a->worlds / ranks->ranks;
  pool_config.num_threads = a->threads;
  if (rdm_pool_create(&pool, &pool_config)) goto done;
  /* Its worlds have the numbers behind those of the ranks before it. */
  if (rdm_pool_set_rank(pool, ranks->rank, ranks->ranks)) goto done;
  if (rdm_pool_reset(pool, NULL, NULL)) goto done;

  if (rdm_agent_config_init(&agent_config, sizeof agent_config)) goto done;
  if (rdm_agent_config_for_pool(&agent_config, pool)) goto done;
  snprintf(settings, sizeof settings, "blocks=%d", a->blocks);
  agent_config.algo = a->algo;
  agent_config.num_threads = a->threads;
  agent_config.settings = settings;
  if (rdm_agent_create_ranked(&agent, &agent_config, ranks)) goto done;

  const double begin = seconds();
  const clock_t worked = clock();
  for (int i = 0; i < a->epochs; ++i) {
    if (rdm_agent_rollout(agent, pool, &e)) goto done;
    if (ranks->rank == 0)
      printf("epoch %3d  steps %9lld  return %8.3f  cost %7.2f\n", (int)e.epoch, (long long)e.env_steps,
             e.ret, e.cost[0]);
  }
  const double took = seconds() - begin;
  const double mine = (double)(clock() - worked) / CLOCKS_PER_SEC;
  if (!busy || ranks->gather(ranks->user, &mine, sizeof mine, busy)) goto done;
  for (int r = 0; r < ranks->ranks; ++r)
    if (busy[r] > slowest) slowest = busy[r];
  if (rdm_agent_write_policy(agent, NULL, 0, &size) || !(policy = malloc(size))) goto done;
  if (rdm_agent_write_policy(agent, policy, size, &size)) goto done;
  if (ranks->rank == 0)
    printf("ranks %d  threads %d  blocks %d  policy %016llx  %.0f steps/s  %.3f s of the busiest\n",
           (int)ranks->ranks, a->threads, a->blocks, hash_of(policy, size), (double)e.env_steps / took,
           slowest);
  status = 0;
done:
  if (status) fprintf(stderr, "rank %d: %s\n", (int)ranks->rank, rdm_last_error());
  free(busy);
  free(policy);
  rdm_agent_destroy(agent);
  rdm_pool_destroy(pool);
  return status;
}

int main(int argc, char** argv) {
  arguments a = {2, 64, 3, 0, 16, "hand_over_safe_finger", "ppo_lag"};
  rdm_ranks ranks;
  if (argc > 1) a.ranks = atoi(argv[1]);
  if (argc > 2) a.worlds = atoi(argv[2]);
  if (argc > 3) a.epochs = atoi(argv[3]);
  if (argc > 4) a.task = argv[4];
  if (argc > 5) a.algo = argv[5];
  if (argc > 6) a.threads = atoi(argv[6]);
  if (argc > 7) a.blocks = atoi(argv[7]);
#ifdef USE_MPI
  if (mpi_ranks_begin(&ranks)) return 1;
  const int status = train(&a, &ranks);
  mpi_ranks_end(status);
  return status;
#else
  fork_ranks* processes;
  if (a.ranks < 1 || fork_ranks_begin(&processes, a.ranks, &ranks)) {
    perror("fork");
    return 1;
  }
  return fork_ranks_end(processes, train(&a, &ranks));
#endif
}
