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
RDM_API int32_t rdm_algo_count(void); /* number of algorithms; 0 without the learning half */
RDM_API rdm_result rdm_algo_at(int32_t index, rdm_algo *io); /* RANGE past the end */
RDM_API rdm_result rdm_algo_find(const char *name,
                                 int32_t *index); /* NOT_FOUND: nearest in the text */
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
  int32_t num_threads;        /* 0 or 1: the caller's only; up to 256; default 0 */
  const char *algo;           /* "ppo", "ppo_lag"; copied; default "ppo_lag" */
  const char *task;           /* kept in policy files, "" for a host's own environment; copied */
  uint64_t seed;              /* of weights, noise, shuffling; default 0 */
  uint64_t layout_hash;       /* kept in policy files; 0: unknown */
  float control_dt;           /* s, kept in policy files; 0: unknown */
  int32_t max_steps;          /* control steps of an episode: one that is longer is counted as
                               * ended there; 0: unknown */
  const float *initial_mean;  /* [action_dim] mean action of the new policy, copied; NULL: 0 */
  const rdm_option *defaults; /* [num_defaults] laid under options (a task's); "algo:key" is for
                               * one algo */
  const rdm_option *options;  /* [num_options] the caller's; NULL: none */
  int32_t num_defaults;       /* count, default 0 */
  int32_t num_options;        /* count, default 0 */
  const double *cost_limits;  /* [cost_dim] on the sum over an episode, < 0: none; NULL: option
                               * cost_limit for column 0, which stands over [0] where both are
                               * given */
  const rdm_host *host;       /* hooks of this handle, copied; NULL: those of rdm_init */
  const char *settings;       /* options as lines key=value, laid over `options`, copied; NULL:
                               * none */
  char *error;                /* [error_size] the text of a failing call that takes this config;
                               * NULL */
  int32_t error_size;         /* bytes, terminator included; what is longer is cut */
  int32_t reserved2;          /* 0 */
  const rdm_field *fields;    /* [num_fields] parts of a row of obs, for actor_obs and
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
/* Bytes that creation takes from the alloc hook, exact. */
RDM_API rdm_result rdm_agent_config_memory(const rdm_agent_config *c, size_t *bytes);
/* Makes the agent; the config's arrays are copied. */
RDM_API rdm_result rdm_agent_create(rdm_agent **out, const rdm_agent_config *c);
RDM_API void rdm_agent_destroy(rdm_agent *a);               /* NULL is fine */
RDM_API const char *rdm_agent_error(const rdm_agent *a); /* last failure on this handle; "" at
                                                          * first */

/* action [num_envs][action_dim]: a sample (it is remembered, and record must follow) or the mean of
 * the policy for obs [num_envs][obs_dim] (nothing is remembered). One call is one decision: hold
 * the action for the option action_repeat control steps. Samples are not clipped. */
RDM_API rdm_result rdm_agent_act(rdm_agent *a, const float *obs, int32_t mode, float *action);
typedef struct rdm_transition { /* what followed the last sampled actions; a row per environment */
  uint32_t struct_size;       /* bytes */
  uint32_t reserved;          /* 0 */
  const float *reward;        /* [num_envs] summed over the decision, required */
  const float *cost;          /* [num_envs][cost_dim] likewise; NULL only if cost_dim is 0 */
  const uint8_t *terminated;  /* [num_envs] NULL: none */
  const uint8_t *truncated;   /* [num_envs] NULL: none */
  const float *final_obs;     /* [num_envs][obs_dim] read where truncated; NULL: truncation has
                               * value 0 */
  const uint8_t *valid;       /* [num_envs] 0: not learned from; NULL: all valid */
  const uint8_t *success;     /* [num_envs] for the statistics; NULL: none */
  const int32_t *steps;       /* [num_envs] control steps in this decision; NULL: action_repeat */
  const uint32_t *status;     /* [num_envs] RDM_STATUS_* of the decision, for the epoch's counts;
                               * NULL: none */
  uint64_t generation;        /* rdm_policy_info.generation of the policy that sampled; 0: not
                               * checked */
} rdm_transition;
/* STATE unless a sampled act came before, or when the horizon is full. ARGUMENT for a flag that is
 * neither 0 nor 1, a cost that is not finite or below 0, in any row, and for a reward or final_obs
 * that is not finite in a valid one. A row with valid 0 is not learned from and its reward does not
 * count; its cost counts, and an end in it ends the episode. Its steps count too, but in a row that
 * neither ends an episode nor follows another row of one: that is what next-step autoreset returns
 * for the step that only resets. An episode that is not over after max_steps control steps counts
 * as one there (RDM_EPOCH_CUT): its sums are closed and begin anew. The path continues, so the
 * value of the next observation follows, as after a truncation. Option episode_steps sets that
 * length, cost_limit_per_step a limit on the cost per control step, which needs no ends. */
RDM_API rdm_result rdm_agent_record(rdm_agent *a, const rdm_transition *t);
/* A decision that was taken elsewhere, by a robot or another process: obs [num_envs][obs_dim],
 * action [num_envs][action_dim] as the policy of this epoch sampled it, not clipped
 * (rdm_policy_sample), and what followed. It stands where rdm_agent_act with RDM_ACT_SAMPLE and
 * rdm_agent_record stand, the two may take turns, and its log-probability and values are computed
 * here: an agent of the same config and seed learns the same from it as one that acted, but the
 * streams of noise stay where they are. Rows of one environment are one path, in their order; with
 * option noise_correlation its noise is taken to continue from decision to decision. Option
 * normalize_obs keeps counting with each row, as in rdm_agent_act, while a policy file does not
 * change: obs_freeze ends that.
 * STATE as for rdm_agent_act, and for a generation that is not the agent's: its data are stale.
 * RANGE for an action beyond +-1e5, ARGUMENT as for rdm_agent_record; then nothing has changed.
 * UNSUPPORTED for an agent with option encoder, and for a generation where option average is on: a
 * policy file is the average then, and not what has to sample. */
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
  double cost[RDM_MAX_COSTS]; /* sum of each cost column of an episode, of what cost_signal says */
  double cost_per_step;       /* column 0, per control step; of this epoch's decisions while no
                               * episode has ended, and with option cost_limit_per_step */
  double length;              /* control steps of an episode */
  double fall_rate;           /* share of episodes that terminated */
  double success_rate;        /* share of episodes with at least one success */
  double multiplier[RDM_MAX_COSTS]; /* of each cost, 0 where the algorithm has none */
  /* KL(old || new), summed over action dimensions. First-order algorithms: the mean over the last
   * pass, of each minibatch before its step, so 0 after one pass in one step. Trust regions: of the
   * step that was taken. */
  double kl;
  double entropy;             /* of the policy */
  double learning_rate;       /* of the actor, used in this epoch */
  double action_std;          /* mean over dimensions */
  double loss_policy;         /* mean over minibatches */
  double loss_reward_value;   /* mean squared error */
  double loss_cost_value;     /* mean squared error */
  double clip_fraction;       /* share of samples whose ratio was clipped */
  double value_reward;        /* mean prediction over the batch */
  double value_cost;          /* mean prediction over the batch */
  int32_t passes;             /* over the data, fewer after an early stop */
  int32_t reserved;           /* 0 */
  int32_t cost_signal;        /* costs are sums of 0: costs, 1: their magnitudes (option
                               * cost_signal=raw) */
  int32_t reserved2;          /* 0 */
  uint32_t flags;             /* RDM_EPOCH_* */
  uint32_t reserved3;         /* 0 */
  int64_t skipped_gradients;  /* in this epoch, as all counts below: steps left out */
  int64_t invalid_rows;       /* decisions with valid 0 that did not only reset */
  int64_t diverged;           /* decisions flagged RDM_STATUS_DIVERGED */
  int64_t contacts_left_out;  /* decisions flagged RDM_STATUS_CONTACTS */
  int64_t bad_actions;        /* decisions flagged RDM_STATUS_BAD_ACTION */
  int64_t task_failed;        /* decisions flagged RDM_STATUS_TASK */
  int64_t unconverged;        /* decisions flagged RDM_STATUS_SOLVER */
  int64_t slowed;             /* decisions flagged RDM_STATUS_SLOWED */
  int64_t violations;         /* control steps in which column 0, or a cost with a limit by the
                               * task, was above 0; -1: not an epoch of rdm_agent_rollout */
  int64_t refused;            /* decisions that a shield changed; -1: there was none */
  int64_t unproven;           /* of these, where nothing was known to be clean; -1: likewise */
  int64_t copied;             /* control steps of the shield's copies; -1: likewise */
} rdm_epoch;
/* Learns from a full horizon; last_obs [num_envs][obs_dim] follows the last record. io may be NULL.
 * CANCELLED after rdm_agent_cancel: the horizon is dropped, full or not, and the policy is as
 * before. STATE when the horizon is not full. */
RDM_API rdm_result rdm_agent_update(rdm_agent *a, const float *last_obs, rdm_epoch *io);
/* The same in slices, for a control loop that must not wait: a robot at 1 kHz.
 *   rdm_agent_update_begin(agent, obs);
 *   for (int32_t done = 0; !done;) {
 *     wait_for_tick(obs);
 *     rdm_agent_act(agent, obs, RDM_ACT_MEAN, action);
 *     rdm_agent_update_slice(agent, 1, &done, &e);
 *   }
 * begin takes last_obs [num_envs][obs_dim], returns what rdm_agent_update returns before it learns,
 * and takes about as long as an rdm_agent_act. A slice does `units` (> 0) pieces of work; *done
 * becomes 1 with the last one, and io (may be NULL) is filled then. Pieces follow from the data
 * alone, and any slices give the bytes of one rdm_agent_update. The largest piece is one network
 * forth and back, or a trust region's product with it, over 256 rows on each thread, or over 64
 * where a minibatch has no more than 256; or some plain sums over all decisions of the horizon, or
 * over all parameters.
 * Between two slices the policy of before acts with RDM_ACT_MEAN and is what rdm_agent_write_policy
 * writes. Whatever would change the agent or read what is half learned returns STATE: sampled acts,
 * record, put, rollouts, options, tensors, values, states, checkpoints. rdm_agent_discard, a cancel
 * that the next slice hears (CANCELLED), and rdm_agent_read_state drop the update. The policy is
 * then as it was before; critics, optimisers and multipliers keep what they have learned. */
RDM_API rdm_result rdm_agent_update_begin(rdm_agent *a, const float *last_obs);
RDM_API rdm_result rdm_agent_update_slice(rdm_agent *a, int32_t units, int32_t *done,
                                          rdm_epoch *io);
/* One epoch natively: act, step (action_repeat control steps), record until the horizon is full,
 * then update. The pool must have been reset and must not have autoreset off; dims and num_envs
 * must agree. A pool that repeats actions itself takes as many steps at a time: the agent's
 * action_repeat must be a multiple of the pool's, as the defaults are that
 * rdm_agent_config_for_pool sets. With the agent's option cost_signal=raw the costs are sums over
 * control steps of cost_raw where that is above 0. */
RDM_API rdm_result rdm_agent_rollout(rdm_agent *a, rdm_pool *p, rdm_epoch *io);
/* Async-signal-safe, from any thread: the running rollout or update returns CANCELLED. A horizon
 * that has begun by act and record is dropped by its update; between horizons, the next rollout,
 * update or first act with RDM_ACT_SAMPLE returns CANCELLED, before anything is collected. */
RDM_API void rdm_agent_cancel(rdm_agent *a);
/* Drops the horizon that has begun, an update in slices, and a cancel that waits: from any state
 * back to between epochs. The policy learns nothing from what it drops. Running episodes
 * continue, with what was recorded of them. */
RDM_API rdm_result rdm_agent_discard(rdm_agent *a);
/* Changes a live option. NOT_FOUND, RANGE, or STATE when it is not live. */
RDM_API rdm_result rdm_agent_set_option(rdm_agent *a, const rdm_option *option);
/* What option i of the algorithm is in this agent: key (static) and the value as
 * text [RDM_TEXT_SIZE], which reads back exactly. RANGE for a text that is longer:
 * rdm_agent_get_settings has it. */
RDM_API rdm_result rdm_agent_setting_at(const rdm_agent *a, int32_t i, const char **key,
                                        char *text);
/* All options as text [capacity] of lines key=value: given as settings they make an agent of the
 * same options. */
RDM_API rdm_result rdm_agent_get_settings(const rdm_agent *a, char *text, size_t capacity,
                                          size_t *size);

RDM_API rdm_result rdm_agent_tensor_at(const rdm_agent *a, int32_t i,
                                       rdm_tensor *out); /* RANGE ends the list */
/* Copies the named tensor to out [count] or from values [count]; count must be rows * cols.
 * NOT_FOUND, RANGE. */
RDM_API rdm_result rdm_agent_get_tensor(const rdm_agent *a, const char *name, float *out,
                                        size_t count);
RDM_API rdm_result rdm_agent_set_tensor(rdm_agent *a, const char *name, const float *values,
                                        size_t count);

/* The frozen policy as the bytes [capacity] of a policy file; NULL asks for the size. */
RDM_API rdm_result rdm_agent_write_policy(const rdm_agent *a, void *bytes, size_t capacity,
                                          size_t *size);
RDM_API rdm_result rdm_agent_write_policy_file(const rdm_agent *a,
                                               const char *path); /* replaced atomically */
/* The agent's network and statistics as they are now, into a policy of the same sizes, without
 * memory: afterwards p is what rdm_agent_write_policy writes, but for the names of its fields.
 * ARGUMENT names what differs, in network, entries that it reads, normaliser, layout_hash or
 * action_repeat, and p is as it was. Nobody else may be in a call with p, nor an actor or planner
 * that plays it: a rdm_policy_act meanwhile is STATE. */
RDM_API rdm_result rdm_policy_update_from(rdm_policy *p, const rdm_agent *a);
/* All state of the agent (networks, optimiser, multipliers, normaliser, streams, counters), between
 * epochs: STATE inside a horizon. load needs an agent of the same config and changes nothing when
 * it fails. */
RDM_API rdm_result rdm_agent_write_state(const rdm_agent *a, void *bytes, size_t capacity,
                                         size_t *size); /* to bytes [capacity]; NULL asks for the
                                                         * size */
RDM_API rdm_result rdm_agent_read_state(rdm_agent *a, const void *bytes,
                                        size_t size); /* of bytes [size] */
/* Agent, pool (may be NULL) and a note [note_size] of the host's own, to 2^29 bytes, in one file,
 * replaced atomically. */
RDM_API rdm_result rdm_checkpoint_write(const char *path, const rdm_agent *a, const rdm_pool *p,
                                        const void *note, size_t note_size);
/* Reads it back; note [capacity] gets as many bytes, *note_size is how many there are. Nothing
 * changes on failure. */
RDM_API rdm_result rdm_checkpoint_read(const char *path, rdm_agent *a, rdm_pool *p, void *note,
                                       size_t capacity, size_t *note_size);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_AGENT_H */
