/* redman/shield.h: shields, which keep costs within their budgets. Experimental. */
#ifndef REDMAN_SHIELD_H
#define REDMAN_SHIELD_H
#include <redman/plan.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- guards: half spaces that actions must lie in -------------------------------------------- */
#define RDM_MAX_GUARDS 32 /* half spaces of an action, at most */
/* A cost that depends on the action alone may be 0 exactly in a half space: normal . action <=
 * bound. To execute the nearest action in it is then a perfect shield, which needs no simulation:
 * with cost_mode=command of the throws it clips three entries. A learned cost that is linear in the
 * action, c(s) + g(s) . a <= d, gives such a half space too (Dalal et al. 2018): normal g, bound d
 * - c. */
typedef struct rdm_guard { /* a half space of a pool's actions, clipped to [-1, 1] */
  uint32_t struct_size;      /* in: bytes */
  int32_t column;            /* of the cost that is 0 in every step as long as all guards of that
                              * column are kept */
  int32_t entry;             /* the only entry of the normal that is not 0; -1: there are several */
  float bound;               /* largest value of normal . action */
} rdm_guard;
/* Guard i that the pool's task declares, and its normal [action_dim]; NULL: not wanted. RANGE past
 * the end. There is none for a task whose costs depend on states, nor where drives do not follow
 * the action exactly: with a measured angle instead of the command, action_average below 1, another
 * control than position, or delayed actions. */
RDM_API rdm_result rdm_pool_guard_at(const rdm_pool *pool, int32_t i, rdm_guard *io, float *normal);
/* Writes to nearest [dim] the point in [-1, 1] with normals [count][dim] . nearest <= bounds
 * [count] that is nearest to action [dim] in the Euclidean norm; the two may be the same array.
 * Bounds whose normal has a single entry are met exactly, others up to the rounding of a float
 * (2^-24 of the sum of the entries' magnitudes). Neither pool nor memory is needed. ARGUMENT for a
 * normal of zeros, for numbers that are not finite, and where no point meets all bounds; RANGE for
 * a count above RDM_MAX_GUARDS and a dim outside [1, 1024]. */
RDM_API rdm_result rdm_project(const float *normals, const float *bounds, size_t count, size_t dim,
                               const float *action, float *nearest);

/* ---- the shield ------------------------------------------------------------------------------ */
/* A shield checks every proposed action before a pool executes it. First it replaces the action by
 * the nearest one that keeps the guards: those of the pool for each cost whose budget is 0, unless
 * option project is false, and the host's own. Then it accepts that action only if an exact copy of
 * the world, which takes it and then follows a known plan, keeps every cost within its budget until
 * the episode ends; otherwise it chooses another action. The rest of such a plan is a plan for the
 * next decision, so if the first decision of an episode has one, all have: no cost exceeds its
 * budget, whatever is proposed. An action that keeps all guards and passes the check is executed
 * unchanged, to the bit. With option predict=false only guards are kept: no copies are made, and
 * costs without guards are not prevented.
 *
 *   rdm_shield_config c;  rdm_shield *shield;
 *   rdm_shield_config_init(&c, sizeof c);
 *   c.pool = pool;  c.policy = policy;
 *   if (rdm_shield_create(&shield, &c)) puts(rdm_last_error());
 *   for (...) { // each step of this pool is one decision: its option action_repeat is the policy's
 *     rdm_policy_act(policy, b.obs, n, NULL, b.action, scratch, bytes);
 *     if (rdm_shield_act(shield, pool, NULL, b.action, b.action)) puts(rdm_shield_error(shield));
 *     rdm_pool_step(pool);
 *   }
 *   rdm_shield_destroy(shield);
 *
 * How it finds a plan: a copy takes the proposed action and then follows the first backup until the
 * episode ends. Where that exceeds a budget, each backup is tried from the present state, then
 * noisy actions that the first backup follows. Backups are policies (their mean actions), the
 * constant action 0 and the constant hold action. Where nothing keeps the budgets, the previous
 * plan continues. An agent's rollout (rdm_agent_set_shield) has blocks of decisions checked at
 * once, which takes an eleventh of the time.
 *
 * What it cannot guarantee: an exact copy knows the random numbers that its world has drawn and
 * will draw, so for a real robot the proof holds for the model alone. With option copies=K each
 * plan is tried in K copies, which draw dynamics (option level, ranges) and noise of their own, and
 * is accepted if all of them keep the budgets: that is no proof, but the more copies agree, the
 * rarer costs are. Costs are checked as the pool counts them, once a control step. Policies that
 * read points cannot be backups.
 *
 * A policy with a memory as a backup: the shield keeps its state for each world and each copy. A
 * state depends only on the observations of the decisions so far, and rdm_shield_act reads those of
 * each decision. So the state equals that of an rdm_actor that plays by the same policy, and nobody
 * has to hand it over. It begins anew where a world begins an episode, in each autoreset mode,
 * where a world's state is set to one of another episode or of an earlier step, and by
 * rdm_shield_reset. A decision that rdm_shield_act is not asked about is missing in it. The backup
 * may then find fewer plans, but what is proven never depends on a state, because a plan is actions
 * that were run in a copy.
 *
 * What it takes: for n worlds, memory for n (block + 1 + tries + 1) copies of a world, n K (2 + 1 +
 * tries) with option copies=K, none with predict=false, and as many states of each backup with a
 * memory; and the time of the control steps that copies simulate (rdm_shield_stats.copied). Only
 * creation, rdm_shield_add_policy, rdm_shield_add_guard and rdm_agent_set_shield use the heap.
 * One thread at a time. The same seed and calls give the same bytes for any number of threads. */
typedef struct rdm_shield rdm_shield; /* handle */
typedef struct rdm_shield_config { /* what a shield is made from */
  uint32_t struct_size;      /* bytes, set by rdm_shield_config_init */
  int32_t num_threads;       /* threads of the copies, 0 to 256; 0: as many as the pool has; default
                              * 0 */
  const rdm_pool *pool;      /* the shield is for its task, options and number of worlds; required;
                              * needed only during creation */
  uint64_t seed;             /* of noisy actions; default 0 */
  const rdm_policy *policy;  /* the first backup, as rdm_shield_add_policy; NULL: none */
  int32_t steps;             /* steps of the pool that a decision lasts, 1 to 1000; 0: as long as
                              * the policy holds an action, 1 without a policy; default 0 */
  int32_t reserved;          /* 0 */
  const double *budgets;     /* [cost_dim] bound on the sum of each cost over an episode, copied; <
                              * 0: the cost is ignored; NULL: 0 for column 0, others are ignored. In
                              * an episode that has already exceeded one, no more of that cost is
                              * allowed */
  const rdm_option *options; /* [num_options] as rdm_shield_option_at lists them, copied; NULL:
                              * none */
  int32_t num_options;       /* count, default 0 */
  int32_t reserved2;         /* 0 */
  const rdm_host *host;      /* hooks of this handle, copied; NULL: those of rdm_init */
  const char *settings;      /* options as lines key=value, which override `options`, copied; NULL:
                              * none */
  char *error;               /* [error_size] receives the text when a call that takes this config
                              * fails; NULL: not wanted */
  int32_t error_size;        /* bytes, terminator included; a longer text is cut */
  int32_t reserved3;         /* 0 */
} rdm_shield_config;
enum rdm_shield_kind { /* what a shield did with a proposed action */
  RDM_SHIELD_OWN = 0,      /* it was executed as proposed */
  RDM_SHIELD_CHANGED = 1,  /* refused; another action was found whose plan keeps the budgets */
  RDM_SHIELD_PLAN = 2,     /* refused; the next action of the plan that was made before */
  RDM_SHIELD_UNPROVEN = 3, /* nothing that was tried keeps the budgets: with option unproven=least
                            * what exceeds them least */
  RDM_SHIELD_PROJECTED = 4 /* it broke guards; the nearest action that keeps them was executed */
};
typedef struct rdm_shield_row { /* what was done in a world's last decision, and why */
  uint32_t struct_size;      /* in: bytes */
  int32_t kind;              /* RDM_SHIELD_* */
  int32_t column;            /* when refused, the cost whose budget it would have exceeded, -1: the
                              * copy diverged; when projected, the column of the guard that it broke
                              * most, -1: the host's own; else -1 */
  int32_t ahead;             /* control steps until that; 0: nothing was refused */
  int32_t backup;            /* the backup that continues the plan: policies are numbered first,
                              * then zero, then hold, of those that it has; -1: no other plan was
                              * looked for */
  int32_t planned;           /* decisions that are left in its plan, the next one included */
} rdm_shield_row;
typedef struct rdm_shield_stats { /* counts since creation, of all worlds */
  uint32_t struct_size;      /* in: bytes */
  int32_t reserved;          /* 0 */
  int64_t decisions;         /* count */
  int64_t inquiries;         /* decisions that were tried in copies */
  int64_t failed;            /* of these, those whose proposed action would have exceeded a
                              * budget */
  int64_t changed;           /* decisions of RDM_SHIELD_CHANGED */
  int64_t planned;           /* decisions of RDM_SHIELD_PLAN */
  int64_t unproven;          /* decisions of RDM_SHIELD_UNPROVEN */
  int64_t copied;            /* control steps that copies simulated */
  int64_t projected;         /* decisions of RDM_SHIELD_PROJECTED */
} rdm_shield_stats;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
 * version's. */
RDM_API rdm_result rdm_shield_config_init(rdm_shield_config *c, size_t size);
/* Makes the shield and its copies. ARGUMENT, RANGE, NOT_FOUND name what is wrong; for the policy,
 * errors are those of rdm_shield_add_policy. */
RDM_API rdm_result rdm_shield_create(rdm_shield **out, const rdm_shield_config *c);
/* Adds a policy's mean actions as a backup, after the policies that the shield has. It must outlive
 * the shield. VERSION_MISMATCH for one that does not fit the pool, ARGUMENT for one that holds its
 * actions longer or shorter than a decision lasts, and with predict=false, UNSUPPORTED for one that
 * reads points, RANGE from the seventh on or where option tries is too small. Plans stay. */
RDM_API rdm_result rdm_shield_add_policy(rdm_shield *shield, const rdm_policy *policy);
/* Adds a guard of the host's own for all worlds: normal [action_dim] . action <= bound, copied.
 * ARGUMENT for a normal of zeros, for numbers that are not finite, and where no action keeps it
 * together with the other guards; RANGE beyond RDM_MAX_GUARDS. Nothing changes then. Plans are
 * forgotten. */
RDM_API rdm_result rdm_shield_add_guard(rdm_shield *shield, const float *normal, float bound);
/* Sets the host's own guard i, counted from the first that was added, for world env alone from now
 * on: for example what a model says of normal [action_dim] and bound in the world's present state.
 * No heap. Errors are those of rdm_shield_add_guard, and the world's guards stay then. The world's
 * plan is forgotten if the guard differs from before. */
RDM_API rdm_result rdm_shield_set_guard(rdm_shield *shield, int32_t env, int32_t i,
                                        const float *normal, float bound);
RDM_API void rdm_shield_destroy(rdm_shield *shield);            /* NULL is fine */
RDM_API const char *rdm_shield_error(const rdm_shield *shield); /* last failure on this handle; ""
                                                                 * at first */
/* Option i of shields: block, look, tries, rounds, copies, noise, choose, zero, hold, unproven,
 * project, predict. RANGE past the end. */
RDM_API rdm_result rdm_shield_option_at(int32_t i, rdm_option_spec *io);
/* All options as text [capacity] of lines key=value: given as settings they make a shield of the
 * same options. */
RDM_API rdm_result rdm_shield_get_settings(const rdm_shield *shield, char *text, size_t capacity,
                                           size_t *size);
/* Writes to action [num_envs][action_dim] a decision for the worlds whose mask [num_envs] is not 0
 * (NULL: all), given the proposed [num_envs][action_dim] one; the two may be the same array, and
 * rows of other worlds are not written. The pool is only read; it must have the task, options and
 * number of worlds of the one that the shield was made for, else ARGUMENT. Hold the action for
 * config.steps steps of the pool. The shield notices when a world began a new episode or its state
 * was set. STATE for a world without an episode, for one in which nothing that was tried keeps the
 * budgets, which the text names, and with predict=false where there are no guards; nothing is
 * written then. */
RDM_API rdm_result rdm_shield_act(rdm_shield *shield, const rdm_pool *pool, const uint8_t *mask,
                                  const float *proposed, float *action);
/* What was done in the last decision of world env; kind OWN before the first one. ARGUMENT for a
 * pool that rdm_shield_act does not take. */
RDM_API rdm_result rdm_shield_get_row(const rdm_shield *shield, const rdm_pool *pool, int32_t env,
                                      rdm_shield_row *io);
/* Writes the RDM_SHIELD_... of each world's last decision to kind [num_envs]. */
RDM_API rdm_result rdm_shield_get_kinds(const rdm_shield *shield, int32_t *kind);
/* Makes plan [decisions][action_dim], of a demonstration or a planner, the plan of world env if a
 * copy that follows it, projected onto the guards, keeps the budgets; where it ends before the
 * episode, a backup continues. The world follows it when nothing new keeps the budgets. STATE where
 * a budget is exceeded, which the text names with the control steps until then, or no episode runs;
 * the plan from before stays then. UNSUPPORTED with copies=K. RANGE for more decisions than an
 * episode has. */
RDM_API rdm_result rdm_shield_set_plan(rdm_shield *shield, const rdm_pool *pool, int32_t env,
                                       const float *plan, size_t decisions);
/* Writes the present plan of world env to plan [capacity], a row of action_dim numbers for each
 * decision from now to the end; *size is how many numbers there are, 0 without a plan. ARGUMENT
 * for a pool that rdm_shield_act does not take. */
RDM_API rdm_result rdm_shield_get_plan(const rdm_shield *shield, const rdm_pool *pool, int32_t env,
                                       float *plan, size_t capacity, size_t *size);
RDM_API rdm_result rdm_shield_get_stats(const rdm_shield *shield, rdm_shield_stats *io);
/* Forgets the plans of the worlds whose mask [num_envs] is not 0 (NULL: all), and what backups with
 * a memory remember of them. */
RDM_API rdm_result rdm_shield_reset(rdm_shield *shield, const uint8_t *mask);
/* Plans, memories, noise, counts and the host's guards as bytes [capacity]; NULL asks for the size.
 * A shield of the same config with as many guards that reads them continues with the same bytes, if
 * its pool is set to the state of that moment too. */
RDM_API rdm_result rdm_shield_write_state(const rdm_shield *shield, void *bytes, size_t capacity,
                                          size_t *size);
/* Of bytes [size]. FORMAT for bytes that are truncated or of another shield; nothing changes
 * then. */
RDM_API rdm_result rdm_shield_read_state(rdm_shield *shield, const void *bytes, size_t size);

/* ---- learning beside a shield ---------------------------------------------------------------- */
/* From now on the shield checks every decision of rdm_agent_rollout; NULL: no shield any more. It
 * must be for a pool of as many worlds, and its decisions must last as long as the agent's, else
 * rollouts return ARGUMENT; it must outlive the agent, or be taken off before. Its first backup is
 * then the agent itself without noise, with what the agent remembers (options history and memory),
 * which a refusal does not change: it is of observations, not of actions. The shield checks as many
 * decisions ahead as its option block says, with the agent's noise; where the statistics of
 * observations have changed since, the actions that were checked are executed and learned from,
 * with their own density. The agent's option shield_learn says what it learns from decisions that
 * the shield refuses or projects:
 *
 *   own      the agent's own action and density, with the outcome of the one executed
 *   applied  the action executed, with its density
 *   cost     as own, but the cost of column 0 is 1 for each refused decision; option cost_limit (1
 *            by default) then limits the refusals in an episode
 *   end      the episode ends before a refused action runs (a reward of 0, terminated), and the
 *            world begins another; where rewards are below 0 use shield_penalty, or ending is
 *            attractive. A projected action runs and is learned as own
 *
 * With each of them, shield_penalty is subtracted from the reward of refused decisions. To resume a
 * run with the same bytes, save the state of the shield too, which holds its plans. STATE inside a
 * horizon. */
RDM_API rdm_result rdm_agent_set_shield(rdm_agent *a, rdm_shield *shield);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_SHIELD_H */
