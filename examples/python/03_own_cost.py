"""03: a cost of your own on a bundled task: the ball may be faster than 2 m/s in 20 steps of an episode at most.

    python3 03_own_cost.py [steps]

`Agent.act`, `Agent.record` and `Agent.update` are the three calls of a rollout. What `record` gets as cost is what the agent
limits, so it can be any function of what the worlds show.
"""
import sys

import numpy as np

import redman

steps = float(sys.argv[1]) if len(sys.argv) > 1 else 160_000
TOP_SPEED, LIMIT = 2.0, 20  # m/s; steps of an episode

pool = redman.Pool("ball_run", num_envs=16, seed=0)
pool.reset()
# An agent of a pool has its sizes, names and defaults. Column 0 is what `cost_limits=LIMIT` limits: we replace it below.
agent = redman.Agent(pool, algo="ppo_lag", seed=1, cost_limits=LIMIT)
velocity = pool.fields["velocity"]
print(f"velocity: columns {velocity.slice.start} to {velocity.slice.stop - 1}, {velocity.scale} m/s for an entry of 1")

epochs = max(1, round(steps / (pool.num_envs * agent.options["horizon"])))
for epoch in range(epochs):
    for _ in range(agent.options["horizon"]):
        action = agent.act(pool.obs)                        # samples, each for option action_repeat steps: 1 in this task
        pool.step(np.clip(action, -1, 1))
        speed = velocity.scale * np.linalg.norm(pool.final_obs[:, velocity.slice], axis=1)
        cost = pool.cost.copy()
        cost[:, 0] = speed > TOP_SPEED                      # instead of the task's own
        agent.record(pool.reward, cost, pool.terminated, pool.truncated, pool.final_obs)
    row = agent.update(pool.obs)
    if epoch % 10 == 9 or epoch == epochs - 1:
        print(f"epoch {epoch + 1:3}: return {row.ret:6.1f}, steps above {TOP_SPEED} m/s: {row.cost[0]:5.1f} of {LIMIT}, "
              f"multiplier {row.multiplier[0]:.2f}")

# evaluate() counts the task's own costs; of ours we count the steps ourselves, without noise
pool = redman.Pool("ball_run", num_envs=16, seed=5)
pool.reset()
actor, fast = agent.policy().actor(pool), np.zeros(16)
for _ in range(pool.max_steps):
    pool.step(actor())
    fast += velocity.scale * np.linalg.norm(pool.final_obs[:, velocity.slice], axis=1) > TOP_SPEED
print(f"without noise: return {pool.episode_return.mean():.1f}, {fast.mean():.1f} steps above {TOP_SPEED} m/s")
