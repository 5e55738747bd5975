/* What a network would cost a learner of many processes, on a machine that has neither.
 *
 *   distributed_simulate [worlds of each rank] [epochs] [task] [algorithm] [most ranks]
 *
 * One rank runs for real, its messages come back as the others': so it computes what each would, the sums
 * over all ranks among it. Its hooks count for how long a switched network would hold a message up: `delay`
 * and a byte at `rate` for each step, of which an allgather by a ring of log-many latencies has ranks - 1
 * rows, an exchange of two one. Time is the processor's, so that other programs do not count; efficiency is
 * the time of a process alone over that of a rank with its messages. */
#define RDM_EXPERIMENTAL
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

typedef struct {
  const char* name;
  double delay, rate; /* s, bytes/s of payload */
} network;
static const network networks[] = {{"1 Gbit", 50e-6, 0.94 * 125e6}, {"10 Gbit", 20e-6, 0.94 * 1250e6}};
enum { NETWORKS = sizeof networks / sizeof *networks };

typedef struct {
  int ranks;
  double held[NETWORKS], inside; /* s that messages took there, and that the hooks took here */
  long messages;
  double bytes; /* received */
} wire;

static double now(void) {
  return (double)clock() / CLOCKS_PER_SEC;
}

static void count(wire* w, double steps, double bytes) {
  for (int i = 0; i < NETWORKS; ++i) w->held[i] += steps * networks[i].delay + bytes / networks[i].rate;
  ++w->messages;
  w->bytes += bytes;
}

static int32_t gather(void* user, const void* mine, size_t bytes, void* all) {
  wire* w = user;
  const double begin = now();
  double steps = 0;
  for (int r = 1; r < w->ranks; r *= 2) ++steps;
  for (int r = 0; r < w->ranks; ++r) memcpy((char*)all + (size_t)r * bytes, mine, bytes);
  count(w, steps, (double)(w->ranks - 1) * (double)bytes);
  w->inside += now() - begin;
  return 0;
}

static int32_t swap(void* user, int32_t partner, const void* mine, size_t bytes, void* theirs) {
  wire* w = user;
  const double begin = now();
  (void)partner;
  memcpy(theirs, mine, bytes);
  count(w, 1, (double)bytes);
  w->inside += now() - begin;
  return 0;
}

/* Seconds of the fastest epoch without messages; samples: decisions in it. */
static int run(const char* task, const char* algo, int worlds, int ranks, int epochs, int swaps, wire* w,
               double* seconds, double* samples) {
  rdm_pool_config pool_config;
  rdm_agent_config agent_config;
  rdm_pool* pool = NULL;
  rdm_agent* agent = NULL;
  rdm_epoch e = {.struct_size = sizeof e};
  rdm_ranks hooks = {.struct_size = sizeof hooks, .ranks = ranks, .user = w, .gather = gather};
  char settings[32];
  int status = 1;
  memset(w, 0, sizeof *w);
  w->ranks = ranks;
  if (swaps) hooks.swap = swap;

  if (rdm_pool_config_init(&pool_config, sizeof pool_config)) goto done;
  pool_config.task = task;
  pool_config.num_envs = worlds;
  if (rdm_pool_create(&pool, &pool_config) || rdm_pool_set_rank(pool, 0, ranks)) goto done;
  if (rdm_pool_reset(pool, NULL, NULL)) goto done;
  if (rdm_agent_config_init(&agent_config, sizeof agent_config)) goto done;
  if (rdm_agent_config_for_pool(&agent_config, pool)) goto done;
  snprintf(settings, sizeof settings, "blocks=%d", ranks);
  agent_config.algo = algo;
  agent_config.settings = settings;
  if (rdm_agent_create_ranked(&agent, &agent_config, &hooks)) goto done;
  if (rdm_agent_rollout(agent, pool, &e)) goto done; /* memory is touched the first time */
  memset(w, 0, sizeof *w);
  w->ranks = ranks;
  const double before = (double)e.env_steps;
  *seconds = 1e30; /* the least: what else runs here slows it down */
  for (int i = 0; i < epochs; ++i) {
    const double begin = now() - w->inside;
    if (rdm_agent_rollout(agent, pool, &e)) goto done;
    const double took = now() - w->inside - begin;
    if (took < *seconds) *seconds = took;
  }
  *samples = ((double)e.env_steps - before) / epochs;
  for (int i = 0; i < NETWORKS; ++i) w->held[i] /= epochs;
  w->messages /= epochs;
  w->bytes /= epochs;
  status = 0;
done:
  if (status) fprintf(stderr, "%s\n", rdm_last_error());
  rdm_agent_destroy(agent);
  rdm_pool_destroy(pool);
  return status;
}

int main(int argc, char** argv) {
  const int worlds = argc > 1 ? atoi(argv[1]) : 64, epochs = argc > 2 ? atoi(argv[2]) : 2;
  const char *task = argc > 3 ? argv[3] : "hand_over_safe_finger", *algo = argc > 4 ? argv[4] : "ppo_lag";
  const int most = argc > 5 ? atoi(argv[5]) : 256;
  wire w;
  double alone, seconds, samples;
  if (run(task, algo, worlds, 1, epochs, 0, &w, &alone, &samples)) return 1;
  printf("%s, %s, %d worlds a rank: alone %.3f s an epoch, %.0f steps/s\n", task, algo, worlds, alone,
         samples / alone);
  printf("ranks  sums by  messages  MB received  compute s");
  for (int i = 0; i < NETWORKS; ++i) printf("  %s: s  eff.", networks[i].name);
  printf("\n");
  static const int sizes[] = {8, 32, 256};
  for (int k = 0; k < 3 && sizes[k] <= most; ++k)
    for (int swaps = sizes[k] > 32; swaps < 2; ++swaps) { /* by gather more would be hopeless */
      const int ranks = sizes[k];
      if (run(task, algo, worlds, ranks, epochs, swaps, &w, &seconds, &samples)) return 1;
      printf("%5d  %7s  %8ld  %11.2f  %9.3f", ranks, swaps ? "swap" : "gather", w.messages, w.bytes / 1e6,
             seconds);
      for (int i = 0; i < NETWORKS; ++i)
        printf("  %*s%.3f  %4.2f", (int)strlen(networks[i].name) - 2, "", w.held[i],
               alone / (seconds + w.held[i]));
      printf("\n");
    }
  return 0;
}
