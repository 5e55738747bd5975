/* redman/shield.h: a shield, under which no cost exceeds its budget. Experimental. */
#ifndef REDMAN_SHIELD_H
#define REDMAN_SHIELD_H
#include <redman/plan.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- guards: half spaces that actions are held to -------------------------------------------- */
#define RDM_MAX_GUARDS 32 /* half spaces of an action, at most */
/* Costs that are functions of the action alone are half spaces: normal . action <= bound. The
 * nearest action that keeps them is a perfect shield, without copies: with cost_mode=command of the
 * throws it is a clip of three entries. A learned cost that is linear in the action,
 * c(s) + g(s) . a <= d, is such a half space too (Dalal et al. 2018): normal g, bound d - c. */
typedef struct rdm_guard { /* a half space of a pool's actions, clipped to [-1, 1] */
  uint32_t struct_size;      /* in: bytes */
  int32_t column;            /* of the cost that is 0 in every step while all guards of that column
                              * are kept */
  int32_t entry;             /* the only entry of the normal that is not 0; -1: there are several */
  float bound;               /* of normal . action, at most */
} rdm_guard;
/* Guard i that the pool's task declares, and its normal [action_dim]; NULL: not asked for. RANGE
 * past the end: at 0 for a task whose costs are of states, and wherever what is done is not what
 * the action says: with a measured angle in the place of the command, action_average below 1,
 * another control than position, delayed actions. */
RDM_API rdm_result rdm_pool_guard_at(const rdm_pool *pool, int32_t i, rdm_guard *io, float *normal);
/* nearest [dim], of all in [-1, 1] with normals [count][dim] . nearest <= bounds [count] the one
 * nearest to action [dim] in the Euclidean norm; the two may be the same array. Rows of a single
 * entry are kept to the bit, others to the rounding of a float (2^-24 of the sum of their entries'
 * sizes). Neither pool nor memory is needed. ARGUMENT for a row of zeros, for what is not finite,
 * and where no action keeps all rows; RANGE for a count above RDM_MAX_GUARDS and a dim outside
 * [1, 1024]. */
RDM_API rdm_result rdm_project(const float *normals, const float *bounds, size_t count, size_t dim,
                               const float *action, float *nearest);

/* ---- the shield ------------------------------------------------------------------------------ */
/* A shield stands between who proposes actions and a pool. What is proposed first goes to the
 * nearest action that keeps the guards: the pool's of each cost whose budget is 0, unless option
 * project is false, and the host's own. That goes through only where an exact copy of the world,
 * continued by a known plan, keeps within the budget of every cost until the episode ends; else
 * another action takes its place. The rest of a plan is a plan again, so what holds for the first
 * decision of an episode holds for all of them: no cost exceeds its budget, whatever is proposed.
 * With option predict=false guards alone are kept: no copies are made, and costs that have none may
 * come. What keeps all guards, and is clean, goes through to the bit.
 *
 *   rdm_shield_config c;  rdm_shield *shield;
 *   rdm_shield_config_init(&c, sizeof c);
 *   c.pool = pool;  c.policy = policy;
 *   if (rdm_shield_create(&shield, &c)) puts(rdm_last_error());
 *   for (...) {
 *     rdm_policy_act(policy, b.obs, n, NULL, b.action, scratch, bytes);
 *     rdm_shield_act(shield, pool, NULL, b.action, b.action);
 *     rdm_pool_step(pool);
 *   }
 *   rdm_shield_destroy(shield);
 *
 * How it finds a way. The proposed action is tried in a copy, and behind it the first backup until
 * the episode ends. Where that meets a cost, each backup is tried from the present state, and noisy
 * actions before the first backup. Backups are policies (their mean actions), constant
 * action 0 and the constant hold action. Where nothing is clean the previous plan continues. An
 * agent's rollout (rdm_agent_set_shield) asks for blocks of decisions at once, which costs an
 * eleventh.
 *
 * What it cannot see. An exact copy knows what its world has drawn and will draw: where a robot is
 * real, the proof is one for the model. With option copies=K each way is tried in K copies, which
 * draw dynamics (option level, ranges) and noise of their own, and is clean where it is in all of
 * them: no proof then, but the more agree, the less comes. Costs are looked at as the pool counts
 * them, once a control step. Policies that see points cannot be backups.
 *
 * Price: for n worlds, n (block + 1 + tries + 1) copies in memory, with option copies n K (2 + 1 +
 * tries), none with predict=false; time is that of the steps that copies take
 * (rdm_shield_stats.copied). No heap but in creation and rdm_shield_add_guard. One thread at a
 * time. Same seed, same calls: the same bytes, for any threads. */
typedef struct rdm_shield rdm_shield; /* handle */
typedef struct rdm_shield_config { /* what a shield is made from */
  uint32_t struct_size;      /* bytes, set by rdm_shield_config_init */
  int32_t num_threads;       /* of the copies, 0 to 256; 0: as many as the pool has; default 0 */
  const rdm_pool *pool;      /* whose task, options and number of worlds it is for; required; not
                              * kept */
  uint64_t seed;             /* of noisy actions; default 0 */
  const rdm_policy *policy;  /* the first backup, as rdm_shield_add_policy; NULL: none */
  int32_t steps;             /* of the pool that a decision lasts, 1 to 1000; 0: as long as the
                              * policy holds an action, 1 without; default 0 */
  int32_t reserved;          /* 0 */
  const double *budgets;     /* [cost_dim] on the sum of each cost over an episode, copied; < 0: the
                              * cost is not looked at; NULL: 0 for column 0, others are not looked
                              * at. Of what an episode had spent beyond it before, no more comes */
  const rdm_option *options; /* [num_options] as rdm_shield_option_at lists them, copied; NULL:
                              * none */
  int32_t num_options;       /* count, default 0 */
  int32_t reserved2;         /* 0 */
  const rdm_host *host;      /* hooks of this handle, copied; NULL: those of rdm_init */
  const char *settings;      /* options as lines key=value, laid over `options`, copied; NULL:
                              * none */
  char *error;               /* [error_size] the text of a failing call that takes this config;
                              * NULL */
  int32_t error_size;        /* bytes, terminator included; what is longer is cut */
  int32_t reserved3;         /* 0 */
} rdm_shield_config;
enum rdm_shield_kind { /* what a shield did with a proposed action */
  RDM_SHIELD_OWN = 0,      /* it went through */
  RDM_SHIELD_CHANGED = 1,  /* refused: another one, from which the way is clean */
  RDM_SHIELD_PLAN = 2,     /* refused: the next action of the plan that was made before */
  RDM_SHIELD_UNPROVEN = 3, /* nothing that was tried is clean: with option unproven=least what
                            * exceeds the budgets least */
  RDM_SHIELD_PROJECTED = 4 /* it broke guards: the nearest one that keeps them went through */
};
typedef struct rdm_shield_row { /* what was done in a world's last decision, and why */
  uint32_t struct_size;      /* in: bytes */
  int32_t kind;              /* RDM_SHIELD_* */
  int32_t column;            /* of what was refused: the cost that it would have met, -1: it was
                              * not, or the copy diverged; of what was projected: of the guard that
                              * it broke most, -1: the host's own */
  int32_t ahead;             /* control steps until that, 0: nothing was refused */
  int32_t backup;            /* that the plan continues by: a policy's number, then zero, then hold,
                              * of those that it has; -1: no other way was looked for */
  int32_t planned;           /* decisions that its plan still has, with the one to come next */
} rdm_shield_row;
typedef struct rdm_shield_stats { /* counts since creation, of all worlds */
  uint32_t struct_size;      /* in: bytes */
  int32_t reserved;          /* 0 */
  int64_t decisions;         /* count */
  int64_t inquiries;         /* decisions that copies were asked about */
  int64_t failed;            /* inquiries whose proposed way met a cost */
  int64_t changed;           /* decisions of RDM_SHIELD_CHANGED */
  int64_t planned;           /* of RDM_SHIELD_PLAN */
  int64_t unproven;          /* of RDM_SHIELD_UNPROVEN */
  int64_t copied;            /* control steps that copies took */
  int64_t projected;         /* decisions of RDM_SHIELD_PROJECTED */
} rdm_shield_stats;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
 * version's. */
RDM_API rdm_result rdm_shield_config_init(rdm_shield_config *c, size_t size);
/* Makes the shield and its copies. ARGUMENT, RANGE, NOT_FOUND name what is wrong; of the policy as
 * rdm_shield_add_policy. */
RDM_API rdm_result rdm_shield_create(rdm_shield **out, const rdm_shield_config *c);
/* One backup more, behind the policies that it has: its mean actions. It must outlive the shield.
 * VERSION_MISMATCH for one that does not fit the pool, ARGUMENT for one that holds its actions for
 * another time than a decision and with predict=false, UNSUPPORTED for one that reads points, RANGE
 * from the seventh on or where option tries is too small. Plans stay. */
RDM_API rdm_result rdm_shield_add_policy(rdm_shield *shield, const rdm_policy *policy);
/* One guard more, the host's own, of all worlds: normal [action_dim] . action <= bound, copied.
 * ARGUMENT for a row of zeros, what is not finite, and where no action keeps it beside those that
 * there are; RANGE for one more than RDM_MAX_GUARDS: nothing changes then. Plans are forgotten. */
RDM_API rdm_result rdm_shield_add_guard(rdm_shield *shield, const float *normal, float bound);
/* The host's own guard i, counted from the first that was added, of world env alone from now on:
 * normal [action_dim], as a model says it of the state that the world is in. No heap. The errors of
 * rdm_shield_add_guard: the world's guards stay then. Its plan is forgotten where something
 * differs. */
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
/* action [num_envs][action_dim] for a decision of the worlds whose mask [num_envs] is not 0 (NULL:
 * all), where proposed [num_envs][action_dim] is what each would do; the two may be the same array,
 * and rows of other worlds are not written. The pool is only read; it has the task, options and
 * number of worlds of the one that the shield was made for, else ARGUMENT. The action is then held
 * for config.steps steps of the pool. A world whose episode began anew, or whose state was set, is
 * noticed. STATE for a world without an episode, and for one in which nothing that was tried is
 * clean, which the text names, and with predict=false where there are no guards: nothing is written
 * then. */
RDM_API rdm_result rdm_shield_act(rdm_shield *shield, const rdm_pool *pool, const uint8_t *mask,
                                  const float *proposed, float *action);
/* What was done in the last decision of world env. */
RDM_API rdm_result rdm_shield_get_row(const rdm_shield *shield, const rdm_pool *pool, int32_t env,
                                      rdm_shield_row *io);
/* The RDM_SHIELD_... of each world's last decision to kind [num_envs]. */
RDM_API rdm_result rdm_shield_get_kinds(const rdm_shield *shield, int32_t *kind);
/* plan [decisions][action_dim], of a demonstration or a planner, becomes the plan of world env once
 * it is projected and clean in a copy; where it ends before the episode, a backup goes on. Where
 * nothing new is clean the world then follows it. STATE: a budget is exceeded, which the text names
 * with the control steps until then, or no episode runs; the plan before stays. UNSUPPORTED with
 * copies=K. RANGE: more decisions than an episode has. */
RDM_API rdm_result rdm_shield_set_plan(rdm_shield *shield, const rdm_pool *pool, int32_t env,
                                       const float *plan, size_t decisions);
/* The plan of world env as it is to plan [capacity] numbers, a row of action_dim for each decision
 * from now to the end; *size is how many numbers there are, 0: it has none. */
RDM_API rdm_result rdm_shield_get_plan(const rdm_shield *shield, const rdm_pool *pool, int32_t env,
                                       float *plan, size_t capacity, size_t *size);
RDM_API rdm_result rdm_shield_get_stats(const rdm_shield *shield, rdm_shield_stats *io);
/* Forgets the plans of the worlds whose mask [num_envs] is not 0; NULL: all. */
RDM_API rdm_result rdm_shield_reset(rdm_shield *shield, const uint8_t *mask);
/* Plans, noise, counts and the host's guards as bytes [capacity]; NULL asks for the size. A shield
 * of the same config with as many guards that reads them continues with the same bytes, beside a
 * pool that was set to the state of that moment. */
RDM_API rdm_result rdm_shield_write_state(const rdm_shield *shield, void *bytes, size_t capacity,
                                          size_t *size);
/* Of bytes [size]. FORMAT for bytes that are not whole, or of another shield: nothing changes. */
RDM_API rdm_result rdm_shield_read_state(rdm_shield *shield, const void *bytes, size_t size);

/* ---- learning beside a shield ---------------------------------------------------------------- */
/* rdm_agent_rollout lets the shield look at every decision from now on; NULL: none any more. The
 * shield is for a pool of as many worlds, its decisions last as long as the agent's, else rollouts
 * return ARGUMENT; it must outlive the agent, or be taken off before. Its first backup is then what
 * the agent itself would do without noise. The agent's noise is foreseen for option block decisions
 * at once: where statistics of observations have moved since, what was foreseen runs and is learned
 * from, with its own density. What is learned from what it refuses, or projects, is the agent's
 * option shield_learn:
 *
 *   own      the agent's own action and density, with what came of the one that ran
 *   applied  the action that ran, with its density
 *   cost     own, and the cost of column 0 is 1 for each refused decision; the limit on that
 *            column is then of refusals in an episode: option cost_limit, 1 by default
 *   end      the episode ends before the action runs (a reward of 0, terminated), and the world
 *            begins another; where rewards are below 0 use shield_penalty, or ending is attractive
 *
 * shield_penalty is taken from the reward of refused decisions with each. Plans are state: a run
 * that is resumed to the byte saves the shield's, too. STATE inside a horizon. */
RDM_API rdm_result rdm_agent_set_shield(rdm_agent *a, rdm_shield *shield);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_SHIELD_H */
