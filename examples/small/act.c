/* The least that acts: a policy's file, memory of the program's own, 1000 calls. act POLICY */
#include <redman/redman.h>
#include <stdlib.h>

#include "peak.h"

int main(int argc, char** argv) {
  rdm_policy* policy = NULL;
  rdm_policy_info info = {.struct_size = sizeof info};
  if (argc < 2 || rdm_policy_read_file(&policy, argv[1]) != RDM_OK ||
      rdm_policy_get_info(policy, &info) != RDM_OK)
    return 1;
  size_t bytes = rdm_policy_scratch(policy, 1);
  void* scratch = malloc(bytes);
  float *obs = calloc((size_t)info.obs_dim, sizeof *obs),
        *action = calloc((size_t)info.action_dim, sizeof *action);
  if (!scratch || !obs || !action) return 2;
  for (int i = 0; i < 1000; ++i)
    if (rdm_policy_act(policy, obs, 1, NULL, action, scratch, bytes) != RDM_OK) return 3;
  printf("%ld %zu\n", peak_kb(), bytes);
  return 0;
}
