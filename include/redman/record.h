/* redman/record.h: trajectories as data, and what is learned from them. Experimental. */
#ifndef REDMAN_RECORD_H
#define REDMAN_RECORD_H
#include <redman/agent.h>
#include <redman/policy.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A recording holds rows of observations, executed actions and labels (the actions that a teacher
 * meant), from a pool, from arrays of yours or from a file that numpy can open. An agent can be
 * cloned from it or kept near it while it learns, and worlds can begin at its states.
 *
 *   rdm_recording_config c;  rdm_recording *r;
 *   rdm_recording_config_init(&c, sizeof c);
 *   rdm_recording_config_for_pool(&c, pool);
 *   if (rdm_recording_create(&r, &c)) puts(rdm_last_error());
 *   for (...) {
 *     fill label with what the teacher would do, b.action with label and noise;
 *     rdm_recording_begin_step(r, pool, label, NULL);
 *     rdm_pool_step(pool);
 *     rdm_recording_end_step(r, pool, NULL);
 *   }
 *   rdm_agent_clone(agent, r, NULL, NULL);
 *   rdm_recording_destroy(r);
 *
 * One thread at a time; while none writes, any number may read. */
typedef struct rdm_recording rdm_recording; /* handle */
typedef struct rdm_recording_config { /* what a recording is made from */
  uint32_t struct_size;    /* bytes, set by rdm_recording_config_init */
  int32_t obs_dim;         /* count, 1..16384, required */
  int32_t action_dim;      /* count, 1..1024, required */
  int32_t cost_dim;        /* count, 0..RDM_MAX_COSTS, default 0 */
  const char *task;        /* kept in files, "" for a host's own environment; up to 63 bytes,
                            * copied; default "" */
  uint64_t layout_hash;    /* kept in files; 0: unknown */
  uint64_t state_bytes;    /* of one world's state, up to 2^30; 0: no states are kept; default 0 */
  int64_t capacity;        /* rows, 0..2^40, for which memory is taken at once; it grows for more;
                            * default 0 */
  int32_t state_stride;    /* begin_step keeps the state of every n-th row of an episode,
                            * 1..2^30, default 8 */
  int32_t error_size;      /* bytes of error, terminator included; a longer text is cut */
  char *error;             /* [error_size] receives the text when a call that takes this config
                            * fails; NULL: not wanted */
  const rdm_host *host;    /* hooks of this handle, copied; NULL: those of rdm_init */
  int32_t num_points;      /* points of the cloud beside each row, 0..65536; 0: no clouds are kept;
                            * default 0 */
  int32_t point_color;     /* whether its points have colours: 0, 1; default 0 */
} rdm_recording_config;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
 * version's. */
RDM_API rdm_result rdm_recording_config_init(rdm_recording_config *c, size_t size);
/* Sets dims, task, layout_hash, state_bytes, num_points and point_color from a pool. Pointers are
 * borrowed from the pool. */
RDM_API rdm_result rdm_recording_config_for_pool(rdm_recording_config *c, const rdm_pool *p);
RDM_API rdm_result rdm_recording_create(rdm_recording **out,
                                        const rdm_recording_config *c); /* empty */
RDM_API void rdm_recording_destroy(rdm_recording *r);             /* NULL is fine */
/* Last failure of a call that may change the recording; "" at first. Failures of calls that only
 * read are in rdm_last_error(). */
RDM_API const char *rdm_recording_error(const rdm_recording *r);

typedef struct rdm_recording_info { /* what a recording holds */
  uint32_t struct_size;    /* in: bytes */
  int32_t obs_dim;         /* count */
  int32_t action_dim;      /* count */
  int32_t cost_dim;        /* count */
  int64_t rows;            /* count */
  int64_t episodes;        /* count, including those that have not ended */
  int64_t num_states;      /* count */
  uint64_t state_bytes;    /* of each */
  uint64_t layout_hash;    /* 0: unknown */
  uint64_t fingerprint;    /* of obs and label of all rows; checked when an agent that uses them is
                            * resumed */
  const char *task;        /* "" for a host's own environment */
  int32_t num_points;      /* points of each row's cloud; 0: there are no clouds */
  int32_t reserved;        /* 0 */
} rdm_recording_info;
RDM_API rdm_result rdm_recording_get_info(const rdm_recording *r,
                                          rdm_recording_info *io); /* fills io */

/* Rows in the order in which they were added; those of an episode are in order of time, those of
 * several may alternate. */
typedef struct rdm_recording_rows {
  uint32_t struct_size;       /* in: bytes */
  uint32_t reserved;          /* 0 */
  int64_t rows;               /* count */
  const float *obs;           /* [rows][obs_dim] before the action */
  const float *action;        /* [rows][action_dim] that was done */
  const float *label;         /* [rows][action_dim] that the teacher meant; NULL when appending: as
                               * action */
  const float *reward;        /* [rows] NULL when appending: 0 */
  const float *cost;          /* [rows][cost_dim] NULL when appending: 0 */
  const uint8_t *terminated;  /* [rows] NULL when appending: none */
  const uint8_t *truncated;   /* [rows] NULL when appending: none */
  const uint8_t *success;     /* [rows] NULL when appending: none */
  const int64_t *episode;     /* [rows] number of its episode, counted from 0 in the order of first
                               * rows; NULL when appending: each end begins one */
  int64_t num_states;         /* count */
  const int64_t *state_row;   /* [num_states] row before which the world had the state, ascending */
  const uint8_t *state;       /* [num_states][state_bytes] what rdm_pool_read_state takes */
  const int16_t *points;      /* [rows][num_points][3] mm, world, before the action; NULL without
                               * clouds */
  const uint8_t *point_class; /* [rows][num_points] as in rdm_sensors; NULL when appending: 0 */
  const uint8_t *point_color; /* [rows][num_points][3] likewise; NULL without colours */
} rdm_recording_rows;
/* Borrowed pointers, until the next call that changes the recording. */
RDM_API rdm_result rdm_recording_get_rows(const rdm_recording *r, rdm_recording_rows *io);
/* Adds rows of a host's own; their episodes are numbered after those that are there, and actions
 * and labels are clipped to [-1, 1]. ARGUMENT for numbers that are not finite, flags that are not 0
 * or 1, states out of order, episodes whose numbers skip one or that go on after their end; nothing
 * changes then. */
RDM_API rdm_result rdm_recording_append(rdm_recording *r, const rdm_recording_rows *rows);
/* Adds all rows of another recording with the same dims, layout_hash and state_bytes. */
RDM_API rdm_result rdm_recording_append_all(rdm_recording *r, const rdm_recording *other);
/* Called before and after rdm_pool_step, for worlds whose mask [num_envs] is not 0 (NULL: all):
 * begin_step adds a row with the pool's obs and action, and label [num_envs][action_dim] (NULL: as
 * the action); actions and labels are clipped to [-1, 1]. end_step adds the step's reward, costs
 * and flags to it; several steps between two begin_step make one row, of sums. A world that ended
 * begins an episode with its next row; one in which no episode runs, or that a pool with next-step
 * autoreset is about to reset, gets no row. STATE for a world that was never reset. A recording
 * follows one pool at a time: rows of another one begin new episodes. */
RDM_API rdm_result rdm_recording_begin_step(rdm_recording *r, const rdm_pool *p, const float *label,
                                            const uint8_t *mask);
RDM_API rdm_result rdm_recording_end_step(rdm_recording *r, const rdm_pool *p, const uint8_t *mask);
/* Drops whole episodes: with need_success 1 those without a success, and those whose sum of a cost
 * is above its max_cost [cost_dim] (NULL, or a negative number: not checked). *dropped (may be
 * NULL) says how many. The others are numbered anew; episodes that still run are closed. */
RDM_API rdm_result rdm_recording_filter(rdm_recording *r, int32_t need_success,
                                        const double *max_cost, int64_t *dropped);
RDM_API rdm_result rdm_recording_clear(rdm_recording *r);         /* drops all rows; memory stays */
/* A file of arrays, .npz, that numpy.load opens: obs, action, label, reward, cost, terminated,
 * truncated, success, episode, state_row, state, points, point_class; task, layout_hash, format.
 * Replaced atomically. */
RDM_API rdm_result rdm_recording_write_file(const rdm_recording *r, const char *path);
/* Makes a recording from such a file, also one that numpy.savez or `redman rollout --record` wrote.
 * NOT_FOUND; FORMAT when a checksum, a shape or a number is wrong, VERSION_MISMATCH for a newer
 * file. */
RDM_API rdm_result rdm_recording_read_file(rdm_recording **out, const char *path);

typedef struct rdm_clone_config { /* how rdm_agent_clone learns */
  uint32_t struct_size;       /* bytes, set by rdm_clone_config_init */
  int32_t epochs;             /* passes over the rows, at most, 1..100000, default 30 */
  int32_t batch_rows;         /* of a minibatch, 1..2^20, default 512 */
  int32_t patience;           /* ends after this many epochs without a better validation loss, 0:
                               * never; default 5 */
  double learning_rate;       /* of Adam, in the first epoch, 0..10, default 1e-3 */
  double learning_rate_end;   /* in the last epoch, linear in between, 0..10, default 1e-5 */
  double validation;          /* share of the rows held back for validation, in whole episodes,
                               * 0..0.9, default 0.1 */
  double action_std;          /* standard deviation of the actor's actions afterwards; 0: unchanged;
                               * default 0 */
  uint64_t seed;              /* of shuffling and of the choice for validation, default 0 */
  int32_t feed_normalizer;    /* flag: the statistics of observations are first set to the
                               * recording's, default 1 */
  int32_t capacity;           /* entries of the two arrays below */
  double *train_loss;         /* [capacity] of each epoch, mean squared error of an entry; NULL:
                               * not wanted */
  double *validation_loss;    /* [capacity] likewise, after it; NaN without validation */
} rdm_clone_config;
RDM_API rdm_result rdm_clone_config_init(rdm_clone_config *how,
                                         size_t size); /* defaults into the first `size` bytes */
typedef struct rdm_clone_report { /* what rdm_agent_clone did */
  uint32_t struct_size;       /* in: bytes */
  int32_t epochs;             /* epochs that were run */
  int32_t best_epoch;         /* from 1: the epoch whose weights were kept; without validation the
                               * last one */
  int32_t stopped;            /* flag: it ended early */
  int64_t train_rows;         /* count */
  int64_t validation_rows;    /* count */
  double train_loss;          /* of the best epoch, mean squared error of an entry */
  double validation_loss;     /* likewise, NaN without validation */
} rdm_clone_report;
/* Behaviour cloning: the actor's mean is fitted to the labels by Adam on minibatches, and the
 * weights with the least validation loss are kept; critics and multipliers stay, and the actor's
 * optimiser begins anew. Between epochs of the agent: STATE inside a horizon. how NULL: defaults;
 * io may be NULL. CANCELLED after rdm_agent_cancel: weights and statistics are as before. */
RDM_API rdm_result rdm_agent_clone(rdm_agent *a, const rdm_recording *r,
                                   const rdm_clone_config *how, rdm_clone_report *io);
typedef struct rdm_learn_report { /* what rdm_agent_learn did */
  uint32_t struct_size;       /* in: bytes */
  int32_t reserved;           /* 0 */
  int64_t steps;              /* gradient steps of this call */
  int64_t rows;               /* count that are learned from */
  int64_t skipped_gradients;  /* steps left out for a gradient that was not finite */
  double loss_policy;         /* mean over the steps; NaN without any, as the next four */
  double loss_reward_value;   /* mean squared error */
  double loss_cost_value;     /* likewise, of the costs with limits; NaN where there is none */
  double value_reward;        /* mean prediction */
  double value_cost;          /* likewise */
  double cost[RDM_MAX_COSTS]; /* what the critics make of the sum of each limited cost over an
                               * episode of the policy; NaN for others */
  double multiplier[RDM_MAX_COSTS]; /* of each cost; 0 where there is none */
} rdm_learn_report;
/* Learns from recorded rows alone, without a world, by an algorithm with a replay memory, such as
 * td3_bc_lag: `steps` (0 to 2^40) gradient steps; 0 only fills the memory. The first call with a
 * recording fills it with its rows: option replay_rows must hold them, and the longest episode once
 * more for each environment of the agent. It sets the statistics of observations
 * and takes 8 bytes a row of the host's. Further calls with the same recording continue, with what
 * worlds added since; another recording replaces both. A row is a decision:
 * the recording's must span the agent's action_repeat. The last row of an episode without a
 * termination is not learned from, because what it led to is not in a recording; a time limit is
 * never a termination. Limits are held against what the critics make of the first observations of
 * episodes. UNSUPPORTED for other algorithms and for options terminal_cost and cost_signal=raw,
 * STATE inside a horizon, RANGE and ARGUMENT for rows that do not fit: nothing changes then.
 * CANCELLED after rdm_agent_cancel: what the finished steps changed stays. io may be NULL. */
RDM_API rdm_result rdm_agent_learn(rdm_agent *a, const rdm_recording *r, int64_t steps,
                                   rdm_learn_report *io);
/* Sets the rows that options `imitation` and `imitation_decay` keep the actor near; obs and label
 * are copied. NULL: none. A state of the agent that was saved with rows can be read only with the
 * same rows set. */
RDM_API rdm_result rdm_agent_set_recording(rdm_agent *a, const rdm_recording *r);
/* Warm start: the actor, its standard deviation and the statistics of observations become those of
 * the policy; the statistics count for `samples` (2 to 10^12) observations, and the actor's
 * optimiser begins anew. STATE inside a horizon; ARGUMENT where layout, hidden layers, activation,
 * std_mode, actor_obs, encoder or normalize_obs differ: the text says which, and nothing
 * changes. */
RDM_API rdm_result rdm_agent_set_policy(rdm_agent *a, const rdm_policy *p, double samples);
/* Worlds begin an episode, with probability `share` (0 to 1), at a state of the recording. Random
 * streams of their own choose it, so all other draws are the same as without. Such an episode has
 * only the steps that were left of the recorded one; its sums begin at 0. States are copied after
 * each was tried: FORMAT for one that does not fit, and nothing changes. r NULL: keeps the states
 * of the last call, with another share; the share is 0 at first. The streams and the share are part
 * of the state of all worlds (env -1), which can be read only with the same states set. */
RDM_API rdm_result rdm_pool_set_starts(rdm_pool *p, const rdm_recording *r, double share);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_RECORD_H */
