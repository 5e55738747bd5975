/* redman/team.h: several policies that act together. Experimental. */
#ifndef REDMAN_TEAM_H
#define REDMAN_TEAM_H
#include <redman/agent.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A team is an agent whose action is divided among groups, such as the two hands. Each group has
 * its own actor, which reads the fields of its group and returns the action entries of its group.
 * Algorithms mappo, mappo_lag, happo, macpo, ippo and ippo_lag learn teams. Their option `groups`
 * names a set of groups that the task defines, or lists groups as NAME:FIELDS:FIRST-LAST;...
 *
 *   c.algo = "mappo_lag";
 *   c.settings = "groups=hands";      // of a task with two hands: right, left
 *   rdm_agent_create(&agent, &c);     // an agent like others; rdm_policy_act acts for all groups
 *   rdm_policy_write_group(policy, 1, bytes, capacity, &size);
 *                                     // the left hand's policy alone: 20 actions, its own file
 *
 * The tensors of a team's policy are those of one network in which the weights between groups are
 * 0, so programs that read tensors need not know about groups. */

typedef struct rdm_group {  /* one agent of a team */
  uint32_t struct_size;     /* in: bytes */
  int32_t first;            /* first entry of its action */
  int32_t count;            /* number of entries of its action */
  int32_t num_columns;      /* entries of the observation that it observes */
} rdm_group;
/* Group i of a text that option `groups` would take, for an agent of this config; NULL is "auto":
 * the set that the task has first, or one group of all. Writes its name to name [RDM_TEXT_SIZE],
 * and up to capacity of the entries of an observation that it observes, ascending, to columns
 * [capacity]; of these its network reads those that option actor_obs has too. RANGE past the last
 * group. NOT_FOUND for a set that the task does not have, with those that it does; ARGUMENT or
 * RANGE for a text that is no list of groups. No agent is made. */
RDM_API rdm_result rdm_agent_group_at(const rdm_agent_config *c, const char *groups, int32_t i,
                                      rdm_group *io, char *name, int32_t *columns,
                                      size_t capacity);

/* The name of group i of a policy; lives as long as the policy. NULL ends the list, which is empty
 * for a policy of one network. */
RDM_API const char *rdm_policy_group_name(const rdm_policy *p, int32_t i);
/* The policy of group i alone as the bytes [capacity] of a policy file; NULL asks for the size. It
 * takes the same rows as the whole policy, of which it reads its group's entries, and gives its
 * group's entries of the action. STATE for a policy of one network, RANGE past the last group.
 * rdm_policy_novelty is UNSUPPORTED on it. */
RDM_API rdm_result rdm_policy_write_group(const rdm_policy *p, int32_t i, void *bytes,
                                          size_t capacity, size_t *size);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_TEAM_H */
