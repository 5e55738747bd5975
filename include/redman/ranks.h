/* redman/ranks.h: learning in several processes together. Experimental. */
#ifndef REDMAN_RANKS_H
#define REDMAN_RANKS_H
#include <redman/agent.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Several processes, the ranks, learn together. Each has a pool and an agent of num_envs worlds;
 * together they are one learner with ranks * num_envs worlds, which learns the same bytes as one
 * process with as many worlds and the same option `blocks`, for any number of ranks. redman links
 * no MPI: messages are exchanged by hooks of yours.
 *
 *   rdm_ranks r = {.struct_size = sizeof r, .rank = 1, .ranks = 4, .user = &mine,
 *                  .gather = my_allgather};
 *   rdm_pool_set_rank(pool, r.rank, r.ranks);
 *   c.settings = "blocks=16";    // ranks times a power of two, which divides all worlds
 *   rdm_agent_create_ranked(&agent, &c, &r);
 *   for (...) rdm_agent_rollout(agent, pool, &e);
 *                                // e, policy and saved state are the same on each rank
 *
 * Configs must be the same on all ranks except for num_threads, hooks and texts. All ranks must
 * make the same calls of rollout, act with RDM_ACT_SAMPLE, record, put, update, write_state with
 * memory and rdm_checkpoint_write in the same order: these exchange messages. Each rank may divide
 * its updates into slices as it likes, which wait for the other ranks where messages are exchanged;
 * only rdm_agent_cancel ends an update early. Reading a state exchanges nothing: each rank takes
 * its own part. A state that was written by some number of ranks can be continued by any other
 * number that `blocks` allows.
 *   - CANCELLED: a hook failed (a rank is gone), or rdm_agent_cancel was called on one rank, which
 *     stops all ranks at the same point. The handles stay usable; after a failed hook the ranks may
 *     differ in what they have learned: read a saved state.
 *   - STATE: ranks are set up differently, which the first exchange checks (the rank and number of
 *     ranks, the library's version, seed, sizes and options of agent and pool); or their calls are
 *     out of step; or the networks have drifted apart, which each update checks. The text says what
 *     differs, and on which rank.
 *   - When a call fails on one rank for any other reason, the other ranks wait in their hooks until
 *     that process ends and the hooks notice. */
typedef struct rdm_ranks {  /* which processes learn together, and how they exchange messages */
  uint32_t struct_size;     /* bytes */
  int32_t rank;             /* of this process, 0..ranks - 1; its world 0 is number rank *
                             * num_envs of all */
  int32_t ranks;            /* processes, 1..4096 */
  int32_t reserved;         /* 0 */
  void *user;               /* passed back to the hooks; may be NULL */
  /* An allgather: afterwards, `all` + r * bytes holds the `mine` of rank r, `bytes` long, on all
   * ranks; bytes is the same on each. Blocks until all ranks have called it. Returns 0, or any
   * other number for a failure. NULL only for a single rank. */
  int32_t (*gather)(void *user, const void *mine, size_t bytes, void *all);
  /* Sends `mine` to rank `partner` and receives that rank's message of the same size in `theirs`.
   * Used instead of gather to sum gradients where ranks is a power of two: each rank then receives
   * the data of 2 gradients in 2 log2(ranks) messages, instead of ranks - 1. NULL on all ranks, or
   * on none. */
  int32_t (*swap)(void *user, int32_t partner, const void *mine, size_t bytes, void *theirs);
} rdm_ranks;
/* As rdm_agent_create, for the agent of one rank: c.num_envs of the ranks * c.num_envs worlds.
 * Takes more memory than rdm_agent_config_memory says: a message for each rank, of at most half a
 * MiB unless a row is longer. The hooks must outlive the agent. */
RDM_API rdm_result rdm_agent_create_ranked(rdm_agent **out, const rdm_agent_config *c,
                                           const rdm_ranks *ranks);
/* Numbers the worlds of the pool from rank * num_envs on, of ranks * num_envs in all. The numbers
 * choose their random streams, and the part that read_state takes from a state of all worlds (env
 * -1). Call it before the first reset; STATE afterwards. rdm_agent_rollout needs an agent and a
 * pool of the same rank. */
RDM_API rdm_result rdm_pool_set_rank(rdm_pool *p, int32_t rank, int32_t ranks);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_RANKS_H */
