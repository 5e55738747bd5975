/* redman/agent.h: one algorithm that acts and learns. Stable since 1.0. */
#ifndef REDMAN_AGENT_H
#define REDMAN_AGENT_H
#include <redman/policy.h>
#include <redman/pool.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct rdm_algo { /* an algorithm */
  uint32_t struct_size;     /* in: bytes                                                      */
  int32_t num_options;      /* for rdm_algo_option_at                                         */
  const char *name;         /* "ppo_lag"                                                      */
  const char *summary;      /* one line with the paper                                        */
} rdm_algo;
RDM_API int32_t rdm_algo_count(void); /* number of algorithms; 0 in a build without learning */
RDM_API rdm_result rdm_algo_at(int32_t index, rdm_algo *io); /* RANGE past the end */
RDM_API rdm_result rdm_algo_find(const char *name,
                                 int32_t *index); /* NOT_FOUND: the text offers the nearest */
RDM_API rdm_result rdm_algo_option_at(int32_t algo, int32_t i,
                                      rdm_option_spec *io); /* i < num_options */

typedef struct rdm_agent rdm_agent; /* handle */
enum rdm_act_mode { RDM_ACT_SAMPLE = 0, RDM_ACT_MEAN = 1 }; /* of rdm_agent_act */
typedef struct rdm_agent_config { /* what an agent is made from */
  uint32_t struct_size;       /* bytes, set by rdm_agent_config_init */
  int32_t obs_dim;            /* count, 1..16384, required */
  int32_t action_dim;         /* count, 1..1024, required */
  int32_t cost_dim;           /* cost columns recorded, 0..RDM_MAX_COSTS, default 1 */
  int32_t num_envs;           /* rows per act, 1..65536, required */
  int32_t num_threads;        /* 0 or 1: the caller's thread only; up to 256; default 0 */
  const char *algo;           /* "ppo", "ppo_lag"; copied; default "ppo_lag" */
  const char *task;           /* kept in policy files, "" for a host's own environment; copied */
  uint64_t seed;              /* of weights, noise, shuffling; default 0 */
  uint64_t layout_hash;       /* kept in policy files; 0: unknown */
  float control_dt;           /* s, kept in policy files; 0: unknown */
  int32_t max_steps;          /* control steps of an episode: one that is longer is counted as
                               * ended there; 0: unknown */
  const float *initial_mean;  /* [action_dim] mean action of the new policy, copied; NULL: 0 */
  const rdm_option *defaults; /* [num_defaults] defaults, such as a task's, which `options`
                               * override; "algo:key" is for one algorithm alone */
  const rdm_option *options;  /* [num_options] the caller's; NULL: none */
  int32_t num_defaults;       /* count, default 0 */
  int32_t num_options;        /* count, default 0 */
  const double *cost_limits;  /* [cost_dim] limit on the sum of each cost over an episode, < 0:
                               * none; NULL: option cost_limit for column 0, which overrides [0]
                               * where both are given */
  const rdm_host *host;       /* hooks of this handle, copied; NULL: those of rdm_init */
  const char *settings;       /* options as lines key=value, which override `options`, copied; NULL:
                               * none */
  char *error;                /* [error_size] receives the text when a call that takes this config
                               * fails; NULL: not wanted */
  int32_t error_size;         /* bytes, terminator included; a longer text is cut */
  int32_t reserved2;          /* 0 */
  const rdm_field *fields;    /* [num_fields] fields of an observation, for options actor_obs and
                               * critic_obs, copied; NULL: none */
  int32_t num_fields;         /* count, 0..4096, default 0 */
  int32_t reserved3;          /* 0 */
} rdm_agent_config;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
 * version's. */
RDM_API rdm_result rdm_agent_config_init(rdm_agent_config *c, size_t size);
/* Sets dims, num_envs, task, layout_hash, control_dt, max_steps, defaults, initial_mean,
 * cost_limits and fields from a pool. Pointers are borrowed from the pool. */
RDM_API rdm_result rdm_agent_config_for_pool(rdm_agent_config *c, const rdm_pool *p);
/* Bytes that the agent holds of the alloc hook's memory, exact; creation never holds more. The hook
 * is called here too, for less, and gets all of it back. */
RDM_API rdm_result rdm_agent_config_memory(const rdm_agent_config *c, size_t *bytes);
/* Makes the agent; the config's arrays are copied. */
RDM_API rdm_result rdm_agent_create(rdm_agent **out, const rdm_agent_config *c);
RDM_API void rdm_agent_destroy(rdm_agent *a);               /* NULL is fine */
RDM_API const char *rdm_agent_error(const rdm_agent *a); /* last failure on this handle; "" at
                                                          * first */

/* Writes to action [num_envs][action_dim] a sample of the policy for obs [num_envs][obs_dim], which
 * is remembered, so that rdm_agent_record must follow; or with RDM_ACT_MEAN its mean, of which
 * nothing is remembered. One call is one decision: hold the action for as many control steps as
 * option action_repeat says. Samples are not clipped. */
RDM_API rdm_result rdm_agent_act(rdm_agent *a, const float *obs, int32_t mode, float *action);
typedef struct rdm_transition { /* what followed the last sampled actions; a row per environment */
  uint32_t struct_size;       /* bytes */
  uint32_t reserved;          /* 0 */
  const float *reward;        /* [num_envs] summed over the decision, required */
  const float *cost;          /* [num_envs][cost_dim] likewise; NULL only if cost_dim is 0 */
  const uint8_t *terminated;  /* [num_envs] NULL: none */
  const uint8_t *truncated;   /* [num_envs] NULL: none */
  const float *final_obs;     /* [num_envs][obs_dim] last observation of an episode, read where
                               * truncated; NULL: what follows a truncation is valued 0 */
  const uint8_t *valid;       /* [num_envs] 0: not learned from; NULL: all valid */
  const uint8_t *success;     /* [num_envs] for the statistics; NULL: none */
  const int32_t *steps;       /* [num_envs] control steps in this decision; NULL: action_repeat */
  const uint32_t *status;     /* [num_envs] RDM_STATUS_* of the decision, for the epoch's counts;
                               * NULL: none */
  uint64_t generation;        /* rdm_policy_info.generation of the policy that sampled; 0: not
                               * checked */
  const float *limit;         /* [num_envs] limit on column 0 that the episode of this row has for
                               * itself, read where it ends: what is held against cost_limit is then
                               * the mean of cost - limit + cost_limit; NULL: cost_limit alone */
} rdm_transition;
/* Records what followed the last sampled act. STATE without such an act, or when the horizon is
 * full. ARGUMENT for a flag that is neither 0 nor 1, or a cost that is not finite or below 0, in
 * any row, and for a reward or final_obs that is not finite in a valid one. A row with valid 0 is
 * not learned from and its reward does not count; its cost counts, and an end in it ends the
 * episode. Its steps count too, except in a row that neither ends an episode nor follows another
 * row of one: next-step autoreset returns such a row for the step that only resets. An episode that
 * still runs after max_steps control steps is counted as ended there (RDM_EPOCH_CUT): its sums are
 * closed and begin anew. Learning treats that as a truncation, which the value of the next
 * observation follows. Option episode_steps sets that length; option cost_limit_per_step limits the
 * cost per control step instead, which needs no ends of episodes. */
RDM_API rdm_result rdm_agent_record(rdm_agent *a, const rdm_transition *t);
/* Records a decision that was taken elsewhere, by a robot or in another process: obs
 * [num_envs][obs_dim], action [num_envs][action_dim] as the policy of this epoch sampled it, not
 * clipped (rdm_policy_sample), and what followed. It replaces an rdm_agent_act with RDM_ACT_SAMPLE
 * and its rdm_agent_record; the two ways may be mixed. Log-probabilities and values are computed
 * here, so an agent of the same config and seed learns the same as one that acted, except that its
 * streams of noise do not advance. The rows of one environment are one path, in their order; with
 * option noise_correlation its noise is taken to continue from decision to decision. With option
 * normalize_obs each row updates the statistics, as in rdm_agent_act, while a policy file that
 * samples elsewhere stays as it is: obs_freeze stops the updates.
 * STATE as for rdm_agent_act, and for a generation that is not the agent's: such data are stale.
 * RANGE for an action beyond +-1e5, ARGUMENT as for rdm_agent_record; nothing changes then.
 * UNSUPPORTED for an agent with option encoder, and for a generation with option average: a policy
 * file then holds the average, which is not the network that must sample. */
RDM_API rdm_result rdm_agent_put(rdm_agent *a, const float *obs, const float *action,
                                 const rdm_transition *t);

enum rdm_epoch_flag {          /* of rdm_epoch.flags */
  RDM_EPOCH_NO_EPISODE = 1,        /* no episode has ended so far: ret, cost, length and rates
                                    * are NaN */
  RDM_EPOCH_SKIPPED_GRADIENTS = 2, /* gradients that were not finite were left out */
  RDM_EPOCH_INVALID_ROWS = 4,      /* rows with valid 0 */
  RDM_EPOCH_CUT = 8,               /* episodes were counted as ended at max_steps or
                                    * episode_steps */
  RDM_EPOCH_DIVERGED = 16,         /* decisions flagged RDM_STATUS_DIVERGED */
  RDM_EPOCH_CONTACTS = 32,         /* decisions flagged RDM_STATUS_CONTACTS */
  RDM_EPOCH_BAD_ACTION = 64,       /* decisions flagged RDM_STATUS_BAD_ACTION */
  RDM_EPOCH_TASK = 128,            /* decisions flagged RDM_STATUS_TASK */
  RDM_EPOCH_SOLVER = 256,          /* decisions flagged RDM_STATUS_SOLVER */
  RDM_EPOCH_SLOWED = 512           /* decisions flagged RDM_STATUS_SLOWED */
};
/* One row of the learning curve; means over the last 100 finished episodes. NaN: nothing was
 * measured. */
typedef struct rdm_epoch {
  uint32_t struct_size;       /* in: bytes */
  int32_t epoch;              /* count from 1 */
  int64_t env_steps;          /* control steps so far, all environments */
  int64_t episodes;           /* finished so far */
  double ret;                 /* sum of rewards of an episode */
  double cost[RDM_MAX_COSTS]; /* sum of each cost column over an episode; cost_signal says of
                               * what; NaN from cost_dim on */
  double cost_per_step;       /* column 0, per control step; over this epoch's decisions while no
                               * episode has ended, and with option cost_limit_per_step */
  double length;              /* control steps of an episode */
  double fall_rate;           /* share of episodes that terminated */
  double success_rate;        /* share of episodes with at least one success */
  double multiplier[RDM_MAX_COSTS]; /* Lagrange multiplier of each cost; 0 where the algorithm has
                                     * none */
  /* KL divergence of the new policy from the old, KL(old || new), summed over action dimensions.
   * First-order algorithms: the mean over the minibatches of the last pass, each measured before
   * its step, so 0 when there is a single step. Trust-region algorithms: that of the step taken. */
  double kl;
  double entropy;             /* of the policy */
  double learning_rate;       /* of the actor, used in this epoch */
  double action_std;          /* mean over dimensions */
  double loss_policy;         /* mean over minibatches */
  double loss_reward_value;   /* mean squared error */
  double loss_cost_value;     /* mean squared error; NaN without a critic of costs */
  double clip_fraction;       /* share of samples whose ratio was clipped; focops: whose KL
                               * divergence was above eta, which leaves them out; NaN: the
                               * algorithm does neither */
  double value_reward;        /* mean prediction over the batch */
  double value_cost;          /* mean prediction over the batch; NaN without a critic of costs */
  int32_t passes;             /* passes over the data; fewer after an early stop */
  int32_t reserved;           /* 0 */
  int32_t cost_signal;        /* what costs are sums of; 0: costs, 1: their magnitudes (option
                               * cost_signal=raw) */
  int32_t reserved2;          /* 0 */
  uint32_t flags;             /* RDM_EPOCH_* */
  uint32_t reserved3;         /* 0 */
  int64_t skipped_gradients;  /* steps left out for a gradient that was not finite; in this epoch,
                               * as all counts below */
  int64_t invalid_rows;       /* decisions with valid 0, without those that only reset */
  int64_t diverged;           /* decisions flagged RDM_STATUS_DIVERGED */
  int64_t contacts_left_out;  /* decisions flagged RDM_STATUS_CONTACTS */
  int64_t bad_actions;        /* decisions flagged RDM_STATUS_BAD_ACTION */
  int64_t task_failed;        /* decisions flagged RDM_STATUS_TASK */
  int64_t unconverged;        /* decisions flagged RDM_STATUS_SOLVER */
  int64_t slowed;             /* decisions flagged RDM_STATUS_SLOWED */
  int64_t violations;         /* control steps in which column 0, or a cost that the task limits,
                               * was above 0; -1: not an epoch of rdm_agent_rollout */
  int64_t refused;            /* decisions that a shield changed; -1: there was no shield */
  int64_t unproven;           /* of these, decisions for which no way within the budgets was found;
                               * -1: likewise */
  int64_t copied;             /* control steps simulated in the shield's copies; -1: likewise */
  int64_t inevitable;         /* of violations, control steps of the unproven decisions: with exact
                               * copies no others violate a budget; -1: likewise */
} rdm_epoch;
/* Learns from a full horizon; last_obs [num_envs][obs_dim] is the observation after the last
 * record. io may be NULL. CANCELLED after rdm_agent_cancel: the horizon is dropped, full or not,
 * and the policy is as before. STATE when the horizon is not full. */
RDM_API rdm_result rdm_agent_update(rdm_agent *a, const float *last_obs, rdm_epoch *io);
/* The same in slices, for a control loop that must not wait, such as that of a robot at 1 kHz.
 *   rdm_agent_update_begin(agent, obs);
 *   for (int32_t done = 0; !done;) {
 *     wait_for_tick(obs);
 *     rdm_agent_act(agent, obs, RDM_ACT_MEAN, action);
 *     rdm_agent_update_slice(agent, 1, &done, &e);
 *   }
 * rdm_agent_update_begin takes last_obs [num_envs][obs_dim], returns the errors that
 * rdm_agent_update returns before it learns, and takes about as long as an rdm_agent_act. A slice
 * does `units` (> 0) pieces of work; with the last piece *done becomes 1 and io (may be NULL) is
 * filled. The pieces depend on the data alone, and any division into slices gives the bytes of one
 * rdm_agent_update. The largest piece is one forward and backward pass of a network, or one
 * Fisher-vector product of a trust region, over 256 rows on each thread, or over 64 where a
 * minibatch has no more than 256; or a few plain sums over all decisions of the horizon, or over
 * all parameters.
 * Between two slices, RDM_ACT_MEAN and rdm_agent_write_policy use the policy from before the
 * update. Calls that would change the agent, or read what is not fully learned, return STATE:
 * sampled acts, record, put, rollouts, options, tensors, values, states, checkpoints. The update is
 * dropped by rdm_agent_discard, by rdm_agent_cancel (the next slice returns CANCELLED) and by
 * rdm_agent_read_state. The policy is then as it was before; critics, optimisers and multipliers
 * keep what they have learned. */
RDM_API rdm_result rdm_agent_update_begin(rdm_agent *a, const float *last_obs);
RDM_API rdm_result rdm_agent_update_slice(rdm_agent *a, int32_t units, int32_t *done,
                                          rdm_epoch *io);
/* One epoch within the library: act, step (action_repeat control steps), record until the horizon
 * is full, then update. The pool must have been reset and must not have autoreset off; dims and
 * num_envs must agree. Where the pool has option action_repeat itself, the agent's action_repeat
 * must be a multiple of the pool's, as it is in the defaults that rdm_agent_config_for_pool sets.
 * With the agent's option cost_signal=raw the costs are sums over control steps of cost_raw where
 * that is above 0. STATE for a pool that was not reset or has autoreset off, and inside a horizon;
 * ARGUMENT where sizes or action_repeat differ; nothing changes then. io may be NULL. */
RDM_API rdm_result rdm_agent_rollout(rdm_agent *a, rdm_pool *p, rdm_epoch *io);
/* Async-signal-safe, from any thread: the running rollout or update returns CANCELLED. A horizon
 * that was begun by act and record is dropped when its update is called; between horizons, the next
 * rollout, update or first act with RDM_ACT_SAMPLE returns CANCELLED, before anything is
 * collected. */
RDM_API void rdm_agent_cancel(rdm_agent *a);
/* Drops a horizon that has begun, an update in slices and a pending cancel: from any state back to
 * between epochs. The policy learns nothing from what is dropped. Running episodes continue, with
 * what was recorded of them. */
RDM_API rdm_result rdm_agent_discard(rdm_agent *a);
/* Changes a live option. NOT_FOUND, RANGE, or STATE when it is not live. */
RDM_API rdm_result rdm_agent_set_option(rdm_agent *a, const rdm_option *option);
/* The value of option i of the algorithm in this agent: its key (static), and the value as text
 * [RDM_TEXT_SIZE], which reads back exactly. RANGE for a longer text: rdm_agent_get_settings has
 * it. */
RDM_API rdm_result rdm_agent_setting_at(const rdm_agent *a, int32_t i, const char **key,
                                        char *text);
/* All options as text [capacity] of lines key=value: given as settings they make an agent of the
 * same options. */
RDM_API rdm_result rdm_agent_get_settings(const rdm_agent *a, char *text, size_t capacity,
                                          size_t *size);

RDM_API rdm_result rdm_agent_tensor_at(const rdm_agent *a, int32_t i,
                                       rdm_tensor *out); /* RANGE ends the list */
/* Copies the named tensor to out [count] or from values [count]; count must be rows * cols.
 * NOT_FOUND, RANGE. Values of actor.log_std are clipped, at the next act, to what options std_min
 * and std_max allow. */
RDM_API rdm_result rdm_agent_get_tensor(const rdm_agent *a, const char *name, float *out,
                                        size_t count);
RDM_API rdm_result rdm_agent_set_tensor(rdm_agent *a, const char *name, const float *values,
                                        size_t count);

/* The frozen policy as the bytes [capacity] of a policy file; NULL asks for the size. */
RDM_API rdm_result rdm_agent_write_policy(const rdm_agent *a, void *bytes, size_t capacity,
                                          size_t *size);
RDM_API rdm_result rdm_agent_write_policy_file(const rdm_agent *a,
                                               const char *path); /* replaced atomically */
/* Copies the agent's present network and statistics into a policy of the same sizes, without
 * allocating: afterwards p is what rdm_agent_write_policy writes, but for the names of its fields.
 * ARGUMENT where network, entries that are read, normaliser, layout_hash or action_repeat differ:
 * the text says which, and p is as before. No other call may use p meanwhile, nor an actor or
 * planner that has it: an rdm_policy_act returns STATE then. */
RDM_API rdm_result rdm_policy_update_from(rdm_policy *p, const rdm_agent *a);
/* All state of the agent (networks, optimiser, multipliers, normaliser, streams, counters), between
 * epochs: STATE inside a horizon. read_state needs an agent of the same config and changes nothing
 * when it fails. */
RDM_API rdm_result rdm_agent_write_state(const rdm_agent *a, void *bytes, size_t capacity,
                                         size_t *size); /* to bytes [capacity]; NULL asks for the
                                                         * size */
RDM_API rdm_result rdm_agent_read_state(rdm_agent *a, const void *bytes,
                                        size_t size); /* of bytes [size] */
/* Writes agent, pool (may be NULL) and a note [note_size] of the host's own, of up to 2^29 bytes,
 * to one file, which is replaced atomically. */
RDM_API rdm_result rdm_checkpoint_write(const char *path, const rdm_agent *a, const rdm_pool *p,
                                        const void *note, size_t note_size);
/* Reads it back; note [capacity] receives the note, up to that many bytes, and *note_size is its
 * size; note may be NULL with capacity 0. With p NULL the file's pool, if any, is not read. FORMAT
 * where p is given and the file has none. Nothing changes on failure. */
RDM_API rdm_result rdm_checkpoint_read(const char *path, rdm_agent *a, rdm_pool *p, void *note,
                                       size_t capacity, size_t *note_size);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_AGENT_H */
