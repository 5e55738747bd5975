"""03: a cost of your own on a bundled task: the ball may be faster than 2 m/s in 20 steps of an episode at most.

    python3 03_own_cost.py [steps]

A cost is a function of `redman.Rows`, which has the rows of all worlds after a control step. `train` learns within its limit and
chooses the policy by it; `evaluate` counts it. (A training loop of your own gives such costs to `Agent.record`.)
"""
import sys

import redman

steps = float(sys.argv[1]) if len(sys.argv) > 1 else 160_000
TOP_SPEED, LIMIT = 2.0, 20  # m/s; steps of an episode


def fast(rows):
    """One flag for each world. speed() is in SI units, whatever the unit of the observation."""
    return rows.speed("velocity") > TOP_SPEED


free = redman.train("ball_run", "ppo", steps=steps, envs=16, seed=1, horizon=125, progress=False, costs={"fast": fast})
held = redman.train("ball_run", "ppo_lag", steps=steps, envs=16, seed=1, horizon=125, progress=False, costs={"fast": fast},
                    cost_limits=LIMIT)
for run in (free, held):
    e = run.evaluate(episodes=20)
    print(f"{run.algo:7}: return {e.return_mean:6.1f}, steps above {TOP_SPEED} m/s: {e.cost_mean[0]:5.1f} (limit {LIMIT})")

e = redman.evaluate("trained", "ball_run", episodes=20, costs=[fast], cost_limits=LIMIT)     # the same for any other policy
print(f"bundled: return {e.return_mean:6.1f}, steps above {TOP_SPEED} m/s: {e.cost_mean[0]:5.1f}; feasible: {e.feasible}")
