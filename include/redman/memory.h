/* redman/memory.h: agents and policies that remember. Experimental. */
#ifndef REDMAN_MEMORY_H
#define REDMAN_MEMORY_H
#include <redman/agent.h>

#ifdef __cplusplus
extern "C" {
#endif

/* With agent option history=k the networks see, behind each observation, those of the last k - 1
 * decisions (option history_fields: of some fields alone). With memory=gru:64 the actor has a gated
 * recurrent unit, which learns what to keep. The memory of a world is a state of
 * rdm_policy_info.state_dim numbers. It is 0 at the start of an episode and changes with each
 * decision. An agent and an rdm_actor keep the states of their worlds themselves; with a policy
 * alone, you keep them:
 *
 *   float state[ROWS * STATE_DIM] = {0};             // a row of zeros for each new episode
 *   rdm_policy_act_state(policy, obs, state, rows, NULL, action, scratch, bytes);
 */
/* As rdm_policy_act, of obs [rows][obs_dim], noise [rows][action_dim] or NULL, action
 * [rows][action_dim] and scratch [scratch_bytes], for any policy that reads no points (for those
 * that do, rdm_policy_act_points_state): state [rows][state_dim] is read, and becomes that after
 * the decision; NULL only where state_dim is 0. ARGUMENT for a state that is not finite. On errors
 * the state stays as it is, except where the network overflows. */
RDM_API rdm_result rdm_policy_act_state(const rdm_policy *p, const float *obs, float *state,
                                        int32_t rows, const float *noise, float *action,
                                        void *scratch, size_t scratch_bytes);
/* Clears the memory of the worlds where mask [num_envs] is not 0 (NULL: of all worlds). mode: which
 * memory, that of RDM_ACT_SAMPLE or of RDM_ACT_MEAN. The two are separate, so that an evaluation by
 * RDM_ACT_MEAN does not disturb the collection of data. The memory of RDM_ACT_SAMPLE is also
 * cleared where rdm_agent_record or rdm_agent_put reports an end, and in a row with valid 0 that
 * only resets; the memory of RDM_ACT_MEAN is cleared only here. STATE while sampled actions of that
 * memory wait for their record, or while an update is under way. */
RDM_API rdm_result rdm_agent_forget(rdm_agent *a, int32_t mode, const uint8_t *mask);

#ifdef __cplusplus
}
#endif
#endif /* REDMAN_MEMORY_H */
