"""01: worlds of a task, one step after the other.

    python3 01_step.py [steps]

Four worlds are one `Pool`. Its rows are numpy arrays that each step writes anew, with a row for each world: copy what you keep.
"""
import sys

import numpy as np

import redman

steps = int(sys.argv[1]) if len(sys.argv) > 1 else 75

pool = redman.Pool("hand_over_safe_finger", num_envs=4, seed=7, options={"object": "egg"})
print(f"{pool.task.name}: observations {pool.obs.shape}, actions {pool.action.shape} in [-1, 1], {pool.control_dt:.4f} s a step")
print(f"costs: {', '.join(pool.cost_names)}; limit on an episode's sum of the first: {pool.costs['cost'].limit}")

field = pool.fields["object.position"]          # columns of an observation have names and units
pool.reset()
returns, costs = [], []
for _ in range(steps):
    pool.step(pool.baseline("random"))          # or any array [num_envs][action_dim]
    ended = pool.terminated | pool.truncated    # the next episode has begun there; final_obs has the last row of the old one
    returns += pool.episode_return[ended].tolist()
    costs += pool.episode_cost[ended, 0].tolist()

print(f"object.position, {field.unit}, in each world:")
print(np.round(pool.obs[:, field.slice], 3))
print(f"{len(returns)} episodes ended: return {np.round(returns, 2)}, cost {np.round(costs, 1)}")
print(f"hash of all states: {pool.hash()}, the same for any number of threads")
