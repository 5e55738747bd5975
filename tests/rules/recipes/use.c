/* What the three recipes made is there, and works: the task is stepped and learned, the robot is listed. */
#include <redman/redman.h>
#include <stdio.h>
#include <string.h>

#define TRY(call)                                  \
  do {                                             \
    if ((call) != RDM_OK) {                        \
      printf("%s: %s\n", #call, rdm_last_error()); \
      return 1;                                    \
    }                                              \
  } while (0)

int main(void) {
  rdm_pool_config c;
  rdm_pool* pool;
  rdm_agent_config a;
  rdm_agent* agent;
  rdm_epoch epoch;
  rdm_robot robot;
  int32_t i, found = 0;
  TRY(rdm_pool_config_init(&c, sizeof c));
  c.task = "fenced_walk";
  c.num_envs = 4;
  TRY(rdm_pool_create(&pool, &c));
  TRY(rdm_pool_reset(pool, NULL, NULL));
  for (i = 0; i < 200; ++i) {
    TRY(rdm_pool_baseline(pool, RDM_BASELINE_RANDOM));
    TRY(rdm_pool_step(pool));
  }
  TRY(rdm_agent_config_init(&a, sizeof a));
  TRY(rdm_agent_config_for_pool(&a, pool));
  a.algo = "priced";
  TRY(rdm_agent_create(&agent, &a));
  memset(&epoch, 0, sizeof epoch);
  epoch.struct_size = sizeof epoch;
  for (i = 0; i < 3; ++i) TRY(rdm_agent_rollout(agent, pool, &epoch));
  rdm_agent_destroy(agent);
  rdm_pool_destroy(pool);
  for (i = 0; i < rdm_robot_count(); ++i) {
    memset(&robot, 0, sizeof robot);
    robot.struct_size = sizeof robot;
    TRY(rdm_robot_at(i, &robot));
    found += !strcmp(robot.name, "one_finger") && robot.num_joints == 2;
  }
  printf("%d steps, %d robots of that name\n", (int)epoch.env_steps, (int)found);
  return found != 1 || epoch.env_steps <= 0;
}
