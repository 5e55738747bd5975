/* redman/shield.h: a predictive shield, under which no cost exceeds its budget. Experimental. */
#ifndef REDMAN_SHIELD_H
#define REDMAN_SHIELD_H
#include <redman/plan.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A shield stands between who proposes actions and a pool. It lets an action through only where an
 * exact copy of the world, going on by a known plan, keeps within the budget of every cost until
 * the episode ends; else another action takes its place. The rest of a plan is a plan again, so
 * what holds for the first decision of an episode holds for all of them: no cost exceeds its
 * budget, whatever is proposed.
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
 * actions before the first backup. Backups are policies (their mean actions), action 0 and the
 * hold action for ever. Where nothing is clean the plan that was made before goes on. An agent's
 * rollout (rdm_agent_set_shield) asks for blocks of decisions at once, which costs an eleventh.
 *
 * What it cannot see. An exact copy knows what its world has drawn and will draw: where a robot is
 * real, the proof is one for the model. With option copies=K each way is tried in K copies, which
 * draw dynamics (option level, ranges) and noise of their own, and is clean where it is in all of
 * them: no proof then, but the more agree, the less comes. Costs are looked at as the pool counts
 * them, once a control step. Policies that see points cannot be backups.
 *
 * Price: for n worlds, n (block + 1 + tries + 1) copies in memory, with option copies n K (2 + 1 +
 * tries); time is that of the steps that
 * copies take (rdm_shield_stats.copied). No heap after creation. One thread at a time. Same seed,
 * same calls: the same bytes, for any threads. */
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
  RDM_SHIELD_UNPROVEN = 3  /* nothing that was tried is clean: with option unproven=least what
                            * exceeds the budgets least */
};
typedef struct rdm_shield_row { /* what was done in a world's last decision, and why */
  uint32_t struct_size;      /* in: bytes */
  int32_t kind;              /* RDM_SHIELD_* */
  int32_t column;            /* of what was refused: the cost that it would have met, -1: it was
                              * not, or the copy diverged */
  int32_t ahead;             /* control steps until that, 0: nothing was refused */
  int32_t backup;            /* that the plan goes on by: a policy's number, then zero, then hold,
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
} rdm_shield_stats;
/* Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
 * version's. */
RDM_API rdm_result rdm_shield_config_init(rdm_shield_config *c, size_t size);
/* Makes the shield and its copies. ARGUMENT, RANGE, NOT_FOUND name what is wrong; of the policy as
 * rdm_shield_add_policy. */
RDM_API rdm_result rdm_shield_create(rdm_shield **out, const rdm_shield_config *c);
/* One backup more, behind the policies that it has: its mean actions. It must outlive the shield.
 * VERSION_MISMATCH for one that does not fit the pool, ARGUMENT for one that holds its actions for
 * another time than a decision, UNSUPPORTED for one that sees points, RANGE from the seventh on or
 * where option tries is too small. Plans stay. */
RDM_API rdm_result rdm_shield_add_policy(rdm_shield *shield, const rdm_policy *policy);
RDM_API void rdm_shield_destroy(rdm_shield *shield);            /* NULL is fine */
RDM_API const char *rdm_shield_error(const rdm_shield *shield); /* last failure on this handle; ""
                                                                 * at first */
/* Option i of shields: block, look, tries, rounds, copies, noise, choose, zero, hold, unproven.
 * RANGE past the end. */
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
 * clean, which the text names: nothing is written then. */
RDM_API rdm_result rdm_shield_act(rdm_shield *shield, const rdm_pool *pool, const uint8_t *mask,
                                  const float *proposed, float *action);
/* What was done in the last decision of world env. */
RDM_API rdm_result rdm_shield_get_row(const rdm_shield *shield, const rdm_pool *pool, int32_t env,
                                      rdm_shield_row *io);
/* The plan of world env as it is to plan [capacity] numbers, a row of action_dim for each decision
 * from now to the end; *size is how many numbers there are, 0: it has none. */
RDM_API rdm_result rdm_shield_get_plan(const rdm_shield *shield, const rdm_pool *pool, int32_t env,
                                       float *plan, size_t capacity, size_t *size);
RDM_API rdm_result rdm_shield_get_stats(const rdm_shield *shield, rdm_shield_stats *io);
/* Forgets the plans of the worlds whose mask [num_envs] is not 0; NULL: all. */
RDM_API rdm_result rdm_shield_reset(rdm_shield *shield, const uint8_t *mask);
/* Plans, noise and counts as bytes [capacity]; NULL asks for the size. A shield of the same config
 * that reads them goes on with the same bytes, beside a pool that was set to the state of that
 * moment. */
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
 * from, with its own density. What is learned from what it refuses is the agent's option
 * shield_learn:
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
