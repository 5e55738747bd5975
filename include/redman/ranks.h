/* redman/ranks.h: one learner of many processes. Experimental. */
#ifndef REDMAN_RANKS_H
#define REDMAN_RANKS_H
#include <redman/agent.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Each process has a pool and an agent of num_envs worlds; together they are one learner with ranks
 * * num_envs of them, whose bytes are those of one process with as many worlds and the same option
 * `blocks`, for any number of ranks. redman links no MPI: messages go through a hook.
 *
 *   rdm_ranks r = {.struct_size = sizeof r, .rank = 1, .ranks = 4, .user = &mine,
 *                  .gather = my_allgather};
 *   rdm_pool_set_rank(pool, r.rank, r.ranks);
 *   c.settings = "blocks=16";    // ranks times a power of two, which divides all worlds
 *   rdm_agent_create_ranked(&agent, &c, &r);
 *   for (...) rdm_agent_rollout(agent, pool, &e);
 *                                // e, policy and saved state are the same on each rank
 *
 * Configs are the same on all ranks but for num_threads, hooks and texts. All of them make the same
 * calls of rollout, act with RDM_ACT_SAMPLE, record, put, update, save with memory,
 * rdm_checkpoint_write: these exchange messages, in one order. Each cuts its updates into slices as
 * it likes, which wait for the others' where they exchange; what ends one is rdm_agent_cancel.
 * Loading exchanges nothing: each takes its own part. A state that was saved by some ranks
 * continues with any other number that `blocks` allows.
 *   - CANCELLED: a hook failed (a rank is gone), or rdm_agent_cancel was called on one rank, which
 *     stops all of them at one place. The handles are good; after a failed hook, what ranks have
 *     learned may differ: load a state that was saved.
 *   - STATE: ranks are set up differently, which the first exchange looks for (the rank and number
 *     of ranks, the library's version, seed, sizes and options of agent and pool); or are out of
 *     step; or one has drifted, which each update looks for. The text names what and whose.
 *   - a rank whose call fails otherwise leaves the others waiting in their hooks, unless it ends
 *     and these notice. */
typedef struct rdm_ranks {  /* who learns together, and how messages go from one to the other */
  uint32_t struct_size;     /* bytes */
  int32_t rank;             /* of this process, 0..ranks - 1; its world 0 is number rank *
                             * num_envs of all */
  int32_t ranks;            /* processes, 1..4096 */
  int32_t reserved;         /* 0 */
  void *user;               /* passed back to the hooks; may be NULL */
  /* An allgather: `mine`, `bytes` of them, stands at `all` + r * bytes for each rank r afterwards,
   * on all ranks; bytes is the same on each. Blocks until all have come. Any number but 0 is a
   * failure. NULL only for one rank. */
  int32_t (*gather)(void *user, const void *mine, size_t bytes, void *all);
  /* Sends mine to rank `partner`, which sends as much here: `theirs`. Takes the place of gather in
   * sums of gradients where ranks is a power of two: each receives 2 of them in 2 log2(ranks)
   * messages, not ranks - 1. NULL on all ranks, or on none. */
  int32_t (*swap)(void *user, int32_t partner, const void *mine, size_t bytes, void *theirs);
} rdm_ranks;
/* As rdm_agent_create, of a rank's agent: c.num_envs worlds of ranks * c.num_envs. Takes more
 * memory than rdm_agent_config_memory says: a message, half a MiB at most where rows are no wider,
 * for each rank. The hooks must outlive the agent. */
RDM_API rdm_result rdm_agent_create_ranked(rdm_agent **out, const rdm_agent_config *c,
                                           const rdm_ranks *ranks);
/* Worlds of the pool are numbers rank * num_envs on of ranks * num_envs: of their streams, and of a
 * state of all worlds (env -1), from which read_state takes them. Before the first reset; STATE
 * afterwards. rdm_agent_rollout needs agent and pool of one rank. */
RDM_API rdm_result rdm_pool_set_rank(rdm_pool *p, int32_t rank, int32_t ranks);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_RANKS_H */
