/* 05: the agent learns a world of your own, without a pool: act, record, update.
 *
 *   05_own_environment [epochs [algorithm]]
 *
 * The world: a cart with a throttle. Reward is the distance driven; going faster than 1 m/s costs 1 per step.
 * At full throttle an episode of 50 steps costs more than 40. The limit is 5, so the agent must learn to
 * drive just below 1 m/s. The policy begins near full throttle, to show the cost coming down. */
#include <math.h>
#include <redman/redman.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { CARTS = 32, LENGTH = 50, HORIZON = 100 };

typedef struct cart {
  float speed;
  int step;
} cart;

/* One step of 0.1 s. Returns the reward and sets the cost. */
static float drive(cart* c, float throttle, float* cost) {
  throttle = fminf(1.0f, fmaxf(-1.0f, throttle));
  c->speed += 0.1f * (4.0f * throttle - 2.0f * c->speed); /* top speed 2 m/s */
  c->step += 1;
  *cost = c->speed > 1.0f ? 1.0f : 0.0f;
  return 0.1f * c->speed;
}

static void observe(const cart* c, float* obs) {
  obs[0] = c->speed;
  obs[1] = (float)c->step / LENGTH;
}

int main(int argc, char** argv) {
  const int epochs = argc > 1 ? atoi(argv[1]) : 60;
  const double limit = 5;
  const float start = 0.8f;
  const rdm_option options[] = {{"hidden", "32,32", 0}, {"horizon", NULL, HORIZON}};
  rdm_agent_config config;
  rdm_agent* agent = NULL;
  rdm_epoch e = {.struct_size = sizeof e};
  cart carts[CARTS];
  float obs[CARTS][2], final_obs[CARTS][2], action[CARTS][1], reward[CARTS], cost[CARTS][1];
  uint8_t truncated[CARTS];
  int status = 1;

  if (rdm_agent_config_init(&config, sizeof config)) goto done;
  config.obs_dim = 2;
  config.action_dim = 1;
  config.num_envs = CARTS;
  config.algo = argc > 2 ? argv[2] : "ppo_lag";
  config.cost_limits = &limit;
  config.initial_mean = &start;
  config.max_steps = LENGTH;
  config.options = options;
  config.num_options = 2;
  if (rdm_agent_create(&agent, &config)) goto done;

  memset(carts, 0, sizeof carts);
  for (int i = 0; i < CARTS; ++i) observe(&carts[i], obs[i]);
  for (int epoch = 0; epoch < epochs; ++epoch) {
    for (int s = 0; s < HORIZON; ++s) {
      if (rdm_agent_act(agent, obs[0], RDM_ACT_SAMPLE, action[0])) goto done;
      for (int i = 0; i < CARTS; ++i) {
        reward[i] = drive(&carts[i], action[i][0], &cost[i][0]);
        truncated[i] = carts[i].step == LENGTH;
        observe(&carts[i], final_obs[i]);
        if (truncated[i]) memset(&carts[i], 0, sizeof carts[i]);
        observe(&carts[i], obs[i]);
      }
      rdm_transition t = {.struct_size = sizeof t};
      t.reward = reward;
      t.cost = cost[0];
      t.truncated = truncated;
      t.final_obs = final_obs[0];
      if (rdm_agent_record(agent, &t)) goto done;
    }
    if (rdm_agent_update(agent, obs[0], &e)) goto done;
    if (epoch % 10 == 0 || epoch == epochs - 1)
      printf("epoch %3d: return %6.3f, cost %6.2f (limit %g), multiplier %.3f\n", (int)e.epoch, e.ret,
             e.cost[0], limit, e.multiplier[0]);
  }
  status = 0;
done:
  if (status) fprintf(stderr, "05_own_environment: %s\n", rdm_last_error());
  rdm_agent_destroy(agent);
  return status;
}
