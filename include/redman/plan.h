/* redman/plan.h: actors and planners, which choose actions. Experimental. */
#ifndef REDMAN_PLAN_H
#define REDMAN_PLAN_H
#include <redman/sense.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- actors: a policy that plays ------------------------------------------------------------- */
/* A policy decides every rdm_policy_info.action_repeat control steps, and its action is held
 * between. An actor does the counting for worlds of a pool, or of an environment of your own, so
 * that a policy behaves the same everywhere:
 *
 *   rdm_actor_config c;  rdm_actor *actor;
 *   rdm_actor_config_init(&c, sizeof c);
 *   c.policy = policy;  c.spec = &spec;  c.num_envs = n;              // spec: of rdm_pool_get_spec
 *   if (rdm_actor_create(&actor, &c)) puts(rdm_last_error());
 *   for (...) {
 *     rdm_actor_act(actor, b.obs, NULL, NULL, b.action);  rdm_pool_step(pool);
 *     rdm_actor_reset(actor, b.terminated, b.truncated);      // RDM_AUTORESET_SAME_STEP
 *   }
 *   rdm_actor_destroy(actor);
 *
 * With RDM_AUTORESET_OFF, reset the actor wherever the pool is reset; with RDM_AUTORESET_NEXT_STEP,
 * after the step that resets, with the end flags of the step before. One thread at a time. The same
 * policy, seed and calls give the same bytes. */
typedef struct rdm_actor rdm_actor; /* handle */
typedef struct rdm_actor_config { /* what an actor is made from */
  uint32_t struct_size;      /* bytes, set by rdm_actor_config_init */
  int32_t num_envs;          /* rows of an act, 1..65536, required */
  const rdm_policy *policy;  /* required; must outlive the actor */
  const rdm_spec *spec;      /* of the pool that it plays in, checked as rdm_policy_check does;
                              * its action_repeat must divide the policy's. NULL: nothing is
                              * checked, and a step is one control step */
  uint64_t seed;             /* of the noise; default 0 */
  int32_t stochastic;        /* 1: actions are sampled, with the noise correlation of the policy;
                              * default 0: the mean */
  int32_t reserved;          /* 0 */
  const float *center;       /* [action_dim] offset in [-1, 1] that the environment adds to every
                              * action; the actor subtracts it, so that the sum is the policy's
                              * action up to rounding; copied; NULL: 0 */
  const rdm_host *host;      /* hooks of this handle, copied; NULL: those of rdm_init */
  char *error;               /* [error_size] receives the text when a call that takes this config
                              * fails; NULL: not wanted */
  int32_t error_size;        /* bytes, terminator included; a longer text is cut */
  int32_t reserved2;         /* 0 */
} rdm_actor_config;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
 * version's. */
RDM_API rdm_result rdm_actor_config_init(rdm_actor_config *c, size_t size);
/* *bytes that creation takes from the alloc hook, exact. */
RDM_API rdm_result rdm_actor_config_memory(const rdm_actor_config *c, size_t *bytes);
/* Makes the actor; every world begins an episode. ARGUMENT for a step that does not divide the
 * policy's decision, VERSION_MISMATCH for a spec that the policy does not fit, RANGE for sizes and
 * a center out of bounds. */
RDM_API rdm_result rdm_actor_create(rdm_actor **out, const rdm_actor_config *c);
RDM_API void rdm_actor_destroy(rdm_actor *actor);             /* NULL is fine */
RDM_API const char *rdm_actor_error(const rdm_actor *actor); /* last failure on this handle; ""
                                                              * at first */
/* action [num_envs][action_dim] for one step of the worlds whose mask [num_envs] is not 0 (NULL:
 * all): a new decision on obs [num_envs][obs_dim] where one is due, else the one that is held; rows
 * of other worlds are not written. points: clouds of the worlds for a policy that reads points,
 * NULL for others. No heap. ARGUMENT for rows that are not finite where a decision is due: nothing
 * is counted then. */
RDM_API rdm_result rdm_actor_act(rdm_actor *actor, const float *obs, const rdm_points *points,
                                 const uint8_t *mask, float *action);
/* Begins new episodes where terminated [num_envs] or truncated [num_envs] is not 0: a decision is
 * due there, with fresh noise. Either may be NULL; both NULL: everywhere. Any mask may be given as
 * one of them. */
RDM_API rdm_result rdm_actor_reset(rdm_actor *actor, const uint8_t *terminated,
                                   const uint8_t *truncated);
/* Held actions, counts and noise as bytes [capacity]; NULL asks for the size. An actor of the same
 * policy and config that reads them continues with the same bytes. */
RDM_API rdm_result rdm_actor_write_state(const rdm_actor *actor, void *bytes, size_t capacity,
                                         size_t *size);
/* Of bytes [size]. FORMAT for bytes that are truncated or of another actor; nothing changes
 * then. */
RDM_API rdm_result rdm_actor_read_state(rdm_actor *actor, const void *bytes, size_t size);

/* ---- planning: actions by trying them out ---------------------------------------------------- */
/* A planner simulates many copies of a world from its present state, each with a noisy variation of
 * a plan, and moves the plan towards what went best (predictive sampling, cross-entropy, model
 * predictive path integral). Costs come first: among plans within what the episode's limits leave,
 * the one with the highest return is best; all others rank behind them, by their cost.
 *
 *   rdm_planner_config c;  rdm_planner *planner;
 *   rdm_planner_config_init(&c, sizeof c);
 *   c.pool = pool;  c.settings = "method=cem\nsamples=128\nhorizon=20";
 *   if (rdm_planner_create(&planner, &c)) puts(rdm_last_error());
 *   for (...) { rdm_planner_act(planner, pool, 0, b.action, NULL);  rdm_pool_step(pool); }
 *   rdm_planner_destroy(planner);
 *
 * A control loop with little time sets `stop`: the action is then the best of what was finished.
 * The library reads no clock; the result depends on the answers of `stop` alone.
 *
 *   static int32_t late(void *until, int64_t steps) { return now_ns() > *(int64_t *)until; }
 *   c.stop = late;  c.user = &until;  ... until = now_ns() + 2000000;  rdm_planner_act(...) ...
 *
 * The model is the world itself: rollouts know even the random numbers that it will draw. One
 * planner follows one world's episode: call rdm_planner_reset when another begins. The planner
 * keeps the state of a policy with a memory and the history of an agent's critic, from what the
 * world shows in each call, so call it in each step: both go along in the rollouts, and begin anew
 * where an episode begins. One thread at a time. The same seed and calls give the same bytes for
 * any number of threads. A plan is an action for each of the next `horizon` steps of the pool. */
typedef struct rdm_planner rdm_planner; /* handle */
typedef struct rdm_planner_config { /* what a planner is made from */
  uint32_t struct_size;      /* bytes, set by rdm_planner_config_init */
  int32_t num_threads;       /* threads of the rollouts; 0: as many as the pool has; default 0 */
  const rdm_pool *pool;      /* rollouts have its task and options; required; needed only during
                              * creation */
  uint64_t seed;             /* of the noise; default 0 */
  const float *noise;        /* [action_dim] standard deviation of each entry, 0 to 10, copied;
                              * NULL: option noise */
  const double *cost_limits; /* [cost_dim] limit on the sum of each cost over an episode, < 0: none,
                              * copied; NULL: those of the pool, of column 0 the limit that
                              * the episode has */
  const rdm_policy *policy;  /* proposes plans: sample 0 of the first iteration is its rollout, the
                              * others add noise to that; must outlive the planner; NULL: none */
  const rdm_agent *agent;    /* its critic values the states at the horizon's end; must outlive the
                              * planner, and no other thread may use it while one plans; NULL:
                              * none */
  const rdm_option *options; /* [num_options] as rdm_planner_option_at lists them, copied; NULL:
                              * none */
  int32_t num_options;       /* count, default 0 */
  int32_t reserved;          /* 0 */
  const rdm_host *host;      /* hooks of this handle, copied; NULL: those of rdm_init */
  const char *settings;      /* options as lines key=value, which override `options`, copied; NULL:
                              * none */
  char *error;               /* [error_size] receives the text when a call that takes this config
                              * fails; NULL: not wanted */
  int32_t error_size;        /* bytes, terminator included; a longer text is cut */
  int32_t reserved2;         /* 0 */
  rdm_stop stop;             /* asked by rdm_planner_act before every step of its rollouts; NULL:
                              * plans are always finished */
  void *user;                /* given to `stop`; may be NULL */
} rdm_planner_config;
typedef struct rdm_planner_spec { /* sizes of a planner */
  uint32_t struct_size;      /* in: bytes */
  int32_t samples;           /* worlds rolled out in an iteration */
  int32_t horizon;           /* steps of the pool */
  int32_t knots;             /* support points of the noise, at most `horizon` */
  int32_t action_dim;        /* count */
  int32_t cost_dim;          /* count */
} rdm_planner_spec;
typedef struct rdm_plan_info { /* what a call of rdm_planner_act found */
  uint32_t struct_size;      /* in: bytes */
  int32_t planned;           /* 1: it planned; 0: the plan was followed, and all else but cut and
                              * steps is 0 */
  int32_t best;              /* sample that is best in the last iteration that was finished */
  int32_t cut;               /* 1: config.stop ended it early; else 0 */
  double ret;                /* of that sample: discounted sum of rewards plus the critic's value */
  double cost[RDM_MAX_COSTS]; /* of that sample, sums of each column */
  double feasible_share;     /* share of that iteration's samples within what the limits leave */
  int64_t steps;             /* control steps of all rollouts */
  int32_t iterations;        /* iterations finished: option iterations, or fewer with cut */
  int32_t reserved;          /* 0 */
} rdm_plan_info;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
 * version's. */
RDM_API rdm_result rdm_planner_config_init(rdm_planner_config *c, size_t size);
/* Makes the planner and its worlds. ARGUMENT, RANGE, NOT_FOUND name what is wrong; VERSION_MISMATCH
 * for a policy that does not fit the pool, UNSUPPORTED for an agent whose critics have no unit
 * (rdm_agent_get_values). */
RDM_API rdm_result rdm_planner_create(rdm_planner **out, const rdm_planner_config *c);
RDM_API void rdm_planner_destroy(rdm_planner *planner);           /* NULL is fine */
RDM_API const char *rdm_planner_error(const rdm_planner *planner); /* last failure on this
                                                                    * handle; "" at first */
RDM_API rdm_result rdm_planner_get_spec(const rdm_planner *planner,
                                        rdm_planner_spec *io); /* fills io */
/* Option i of planners: method, samples, horizon, knots, interpolation, noise, elites, temperature,
 * iterations, costs, and others. RANGE past the end. */
RDM_API rdm_result rdm_planner_option_at(int32_t i, rdm_option_spec *io);
/* All options as text [capacity] of lines key=value: given as settings they make a planner of the
 * same options. */
RDM_API rdm_result rdm_planner_get_settings(const rdm_planner *planner, char *text, size_t capacity,
                                            size_t *size);

/* Plans from the state that world env of the pool is in now, and writes the plan's first action to
 * action [action_dim]. The pool is only read; it must have the task and options of the one that the
 * planner was made for, else ARGUMENT. io may be NULL. STATE where no episode runs. No heap. When
 * config.stop ends it early, action, plan and all that follows have the bytes of a planner whose
 * option iterations is io.iterations. When no iteration was finished, the plan of before is
 * followed, shifted by a step (without one: the policy's rollout so far, or
 * rdm_pool_get_initial_mean), and the next call plans. CANCELLED after rdm_planner_cancel; as after
 * every error, plan, noise, action and io are as before. */
RDM_API rdm_result rdm_planner_act(rdm_planner *planner, const rdm_pool *pool, int32_t env,
                                   float *action, rdm_plan_info *io);
/* Async-signal-safe, from any thread: the running rdm_planner_act returns CANCELLED before the next
 * step of its rollouts, or else the next one does. NULL is fine. */
RDM_API void rdm_planner_cancel(rdm_planner *planner);
/* Forgets the plan, and what a policy with a memory remembers; the stream of noise continues. The
 * next plan begins at rdm_pool_get_initial_mean, or the policy's rollout. */
RDM_API rdm_result rdm_planner_reset(rdm_planner *planner);
/* Writes the present plan to plan [horizon][action_dim]: row 0 is the action that rdm_planner_act
 * gave. */
RDM_API rdm_result rdm_planner_get_plan(const rdm_planner *planner, float *plan);
/* The next rdm_planner_act begins at plan [horizon][action_dim], clipped to [-1, 1] and not
 * shifted. ARGUMENT for entries that are not finite. With a policy it is tried as sample 1. */
RDM_API rdm_result rdm_planner_set_plan(rdm_planner *planner, const float *plan);
/* Plan, memory, noise and counters as bytes [capacity]; NULL asks for the size. A planner of the
 * same task, options, noise and limits that reads them continues with the same bytes. */
RDM_API rdm_result rdm_planner_write_state(const rdm_planner *planner, void *bytes, size_t capacity,
                                           size_t *size);
/* Of bytes [size]. FORMAT for bytes that are truncated or of another planner; nothing changes
 * then. */
RDM_API rdm_result rdm_planner_read_state(rdm_planner *planner, const void *bytes, size_t size);

/* What the agent's critics predict for obs [rows][obs_dim], any number of rows: to value [rows] the
 * discounted sum of future rewards, and to cost [rows][RDM_MAX_COSTS] that of each cost column
 * which the agent limits, 0 in others; cost may be NULL. UNSUPPORTED with options normalize_reward
 * or normalize_cost, under which critics have no unit, and with option history, as rows alone do
 * not contain the decisions before; a planner supports that option. */
RDM_API rdm_result rdm_agent_get_values(const rdm_agent *a, const float *obs, int32_t rows,
                                        float *value, float *cost);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_PLAN_H */
