/* What a machine with a trained policy alone runs, from the headers that are installed there: small POLICY CALLS */
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>

int main(int argc, char** argv) {
  rdm_policy* policy = NULL;
  rdm_policy_info info = RDM_INIT(rdm_policy_info);
  if (argc < 3 || rdm_policy_read_file(&policy, argv[1]) || rdm_policy_get_info(policy, &info)) {
    fprintf(stderr, "small: %s\n", rdm_last_error());
    return 1;
  }
  const size_t bytes = rdm_policy_scratch(policy, 1);
  float* obs = calloc((size_t)(info.obs_dim + info.action_dim), sizeof *obs);
  float* action = obs + info.obs_dim;
  void* scratch = malloc(bytes);
  if (!obs || !scratch) return 2;
  for (int i = 0; i < atoi(argv[2]); ++i) {
    for (int j = 0; j < info.obs_dim; ++j) obs[j] = (float)((7 * i + 3 * j) % 21 - 10) * 0.1f;
    if (rdm_policy_act(policy, obs, 1, NULL, action, scratch, bytes)) return 3;
  }
  for (int j = 0; j < info.action_dim; ++j) printf("%.4f ", (double)action[j]);
  printf("\n");
  free(scratch);
  free(obs);
  rdm_policy_destroy(policy);
  return 0;
}
