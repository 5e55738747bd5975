"""09: no learning: each decision tries plans out in copies of the world and follows the best one within the cost limit.

    python3 09_planner.py [steps]

The ball may be no faster than its limit and may not leave its lane; a plan that does so is followed only where all do.
"""
import sys

import redman

steps = int(sys.argv[1]) if len(sys.argv) > 1 else 100

pool = redman.Pool("ball_run", seed=1)
pool.reset()
planner = redman.Planner(pool, seed=1, cost_limits=0, options={"samples": 32, "horizon": 20})  # redman.planner_options(): all
print(planner, f"of {pool.control_dt:.3f} s")
for step in range(steps):
    pool.step(planner.act())                        # act(env=3) of a pool with more worlds
    if step % 25 == 24:
        found = planner.info
        print(f"step {step + 1:3}: the best plan gains {found.ret:6.2f} at a cost of {found.costs['cost']:.2f}; "
              f"{found.feasible_share:.0%} of the plans are within the limit")
print(f"planned: return {pool.episode_return[0]:.1f}, cost {pool.episode_cost[0, 0]:.0f}")

pool.reset(seeds=pool.seed)
for _ in range(steps):
    pool.step(pool.baseline("random"))
print(f"random:  return {pool.episode_return[0]:.1f}, cost {pool.episode_cost[0, 0]:.0f}")
