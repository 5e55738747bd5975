/* The least that learns: 16 worlds, two epochs with default options or with `settings`. train TASK
 * [KEY=VALUE...] */
#include <redman/redman.h>
#include <string.h>

#include "peak.h"

int main(int argc, char** argv) {
  rdm_pool_config worlds;
  rdm_agent_config learner;
  rdm_pool* pool = NULL;
  rdm_agent* agent = NULL;
  char settings[512] = "";
  size_t pool_bytes = 0, agent_bytes = 0;
  if (argc < 2 || rdm_pool_config_init(&worlds, sizeof worlds) != RDM_OK) return 1;
  worlds.task = argv[1];
  worlds.num_envs = 16;
  for (int i = 2; i < argc && strlen(settings) + strlen(argv[i]) + 2 < sizeof settings; ++i)
    strcat(strcat(settings, argv[i]), "\n");
  if (rdm_pool_config_memory(&worlds, &pool_bytes, NULL) != RDM_OK ||
      rdm_pool_create(&pool, &worlds) != RDM_OK || rdm_pool_reset(pool, NULL, NULL) != RDM_OK ||
      rdm_agent_config_init(&learner, sizeof learner) != RDM_OK ||
      rdm_agent_config_for_pool(&learner, pool) != RDM_OK)
    return 2;
  learner.settings = settings;
  if (rdm_agent_config_memory(&learner, &agent_bytes) != RDM_OK ||
      rdm_agent_create(&agent, &learner) != RDM_OK)
    return 3;
  for (int epoch = 0; epoch < 2; ++epoch)
    if (rdm_agent_rollout(agent, pool, NULL) != RDM_OK) return 4;
  printf("%ld %zu\n", peak_kb(), pool_bytes + agent_bytes);
  return 0;
}
