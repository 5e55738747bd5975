"""11: record a demonstration, fit an agent to it (behaviour cloning), go on by reinforcement learning.

    python3 11_offline.py [steps]

The bundled policy plays the teacher; a planner, a script or a person does as well.
"""
import sys
import tempfile
from pathlib import Path

import numpy as np

import redman

steps, task = float(sys.argv[1]) if len(sys.argv) > 1 else 8000, "ball_run"
path, rng = Path(tempfile.mkdtemp()) / "demonstration.npz", np.random.default_rng(1)

pool = redman.Pool(task, num_envs=8, seed=1)
pool.reset()
teacher = redman.Policy.trained(task).actor(pool)
recording = redman.Recording(pool)
for _ in range(pool.max_steps):
    meant = teacher()
    pool.action = np.clip(meant + rng.normal(0, 0.2, meant.shape), -1, 1)   # noise shows the way back
    with recording.step(pool, label=meant):         # a row of each world: what was observed, done, meant and gained
        pool.step()
recording.save(path)
with np.load(path) as file:                         # rows for any other library, too
    print(f"{len(recording)} rows in {path.name}: {', '.join(file.files)}")
print(f"teacher: return {pool.episode_return.mean():.1f}, cost {pool.episode_cost[:, 0].mean():.1f} with noise")

agent = redman.Agent(pool, algo="ppo_lag", seed=1, options={"imitation": 0.1})     # see agent.recording below
untrained = redman.evaluate(agent, task, episodes=16).return_mean
report = agent.clone(redman.load(path), epochs=30)
cloned = redman.evaluate(agent, task, episodes=16)
print(f"cloned: error {report.train_losses[0]:.4f} to {report.train_losses[-1]:.4f} in {report.epochs} epochs; "
      f"return {untrained:.1f} before, {cloned.return_mean:.1f} after, cost {cloned.cost_mean[0]:.1f}")

agent.recording = recording                         # option imitation holds it near these rows while it learns
agent.learn(steps, pool)
after = redman.evaluate(agent, task, episodes=16)
print(f"learned on: return {after.return_mean:.1f}, cost {after.cost_mean[0]:.1f} of {agent.cost_limits[0]}")
