/* 04: run a trained policy, as a robot's controller would: all memory up front, none afterwards.
 *
 *   04_act [policy file] [calls]
 *
 * Without a file it makes a small untrained policy first. The observation here is all zero; a controller
 * fills it with its sensor readings, in the order of the task's fields. */
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>

/* The whole file, NULL when it cannot be read. */
static void* read_file(const char* path, size_t* size) {
  FILE* file = fopen(path, "rb");
  char* bytes = NULL;
  if (!file) return NULL;
  if (fseek(file, 0, SEEK_END) == 0 && ftell(file) > 0) {
    *size = (size_t)ftell(file);
    rewind(file);
    bytes = malloc(*size);
    if (bytes && fread(bytes, 1, *size, file) != *size) {
      free(bytes);
      bytes = NULL;
    }
  }
  fclose(file);
  return bytes;
}

/* The bytes of an untrained policy, NULL on failure. */
static void* make_policy(size_t* size) {
  rdm_agent_config config;
  rdm_agent* agent = NULL;
  void* bytes = NULL;
  if (rdm_agent_config_init(&config, sizeof config)) return NULL;
  config.obs_dim = 8;
  config.action_dim = 2;
  config.num_envs = 1;
  if (rdm_agent_create(&agent, &config)) return NULL;
  if (rdm_agent_write_policy(agent, NULL, 0, size) == RDM_OK && (bytes = malloc(*size)) != NULL &&
      rdm_agent_write_policy(agent, bytes, *size, size) != RDM_OK) {
    free(bytes);
    bytes = NULL;
  }
  rdm_agent_destroy(agent);
  return bytes;
}

int main(int argc, char** argv) {
  const char* path = argc > 1 ? argv[1] : "";
  const int calls = argc > 2 ? atoi(argv[2]) : 1000;
  rdm_policy* policy = NULL;
  rdm_policy_info info = {.struct_size = sizeof info};
  size_t size = 0;
  void* bytes = path[0] ? read_file(path, &size) : make_policy(&size);
  if (!bytes) {
    fprintf(stderr, "04_act: %s%s\n", path[0] ? "cannot read " : "", path[0] ? path : rdm_last_error());
    return 1;
  }
  const rdm_result loaded = rdm_policy_read(&policy, bytes, size);
  free(bytes); /* the policy has its own copy */
  if (loaded || rdm_policy_get_info(policy, &info)) {
    fprintf(stderr, "04_act: %s\n", rdm_last_error());
    rdm_policy_destroy(policy);
    return 1;
  }

  /* All memory in one block: the two rows, then scratch. */
  const size_t scratch_size = rdm_policy_scratch(policy, 1);
  float* obs = calloc(1, sizeof(float) * (size_t)(info.obs_dim + info.action_dim) + scratch_size);
  if (!obs) {
    fprintf(stderr, "04_act: out of memory\n");
    rdm_policy_destroy(policy);
    return 1;
  }
  float* action = obs + info.obs_dim;
  void* scratch = action + info.action_dim;

  /* From here on nothing asks for memory. NULL noise: the mean action, as a controller wants it. */
  int status = 0;
  for (int i = 0; i < calls && status == 0; ++i)
    if (rdm_policy_act(policy, obs, 1, NULL, action, scratch, scratch_size)) status = 1;

  if (status)
    fprintf(stderr, "04_act: %s\n", rdm_last_error());
  else
    printf("%d observations to %d actions, %zu bytes of scratch, %d calls; first action %.4f\n",
           (int)info.obs_dim, (int)info.action_dim, scratch_size, calls, (double)action[0]);
  free(obs);
  rdm_policy_destroy(policy);
  return status;
}
