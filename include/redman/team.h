/* redman/team.h: several policies that act together. Experimental. */
#ifndef REDMAN_TEAM_H
#define REDMAN_TEAM_H
#include <redman/policy.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A team is an agent whose action is shared out between groups, such as the two hands: each group
 * has an actor of its own, which sees its own fields of the observation and gives its own entries
 * of the action. Algorithms mappo, mappo_lag, happo and macpo learn teams; their option `groups`
 * names a set that the task ships, or lists groups as NAME:FIELDS:FIRST-LAST;...
 *
 *   c.algo = "mappo_lag";
 *   c.settings = "groups=hands";      // of a task with two hands: right, left
 *   rdm_agent_create(&agent, &c);     // learns as any other; rdm_policy_act plays all groups
 *   rdm_policy_write_group(policy, 1, bytes, capacity, &size);
 *                                     // the left hand's policy alone: 20 actions, its own file
 *
 * The tensors of a team's policy are those of one network whose other weights are 0, so whatever
 * reads tensors needs to know nothing of groups. */

/* The name of group i of a policy; lives as long as the policy. NULL ends the list, which is empty
 * for a policy of one network. */
RDM_API const char* rdm_policy_group_name(const rdm_policy* p, int32_t i);
/* The policy of group i alone as the bytes [capacity] of a policy file; NULL asks for the size. It
 * takes the same rows as the whole policy, of which it reads its group's entries, and gives its
 * group's entries of the action. STATE for a policy of one network, RANGE past the last group.
 * rdm_policy_novelty is UNSUPPORTED on it. */
RDM_API rdm_result rdm_policy_write_group(const rdm_policy* p, int32_t i, void* bytes,
                                          size_t capacity, size_t* size);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_TEAM_H */
