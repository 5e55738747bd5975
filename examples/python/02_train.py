"""02: a whole run: learn under a cost limit, keep the best policy, evaluate it, write a folder.

    python3 02_train.py [steps]

`train` gives the policy of the command `redman train`, to the byte. 300000 steps (8 s of one core) are enough for a first throw.
"""
import sys
import tempfile
from pathlib import Path

import redman

steps = float(sys.argv[1]) if len(sys.argv) > 1 else 20_000

out = Path(tempfile.mkdtemp()) / "first"        # choose a folder that stays, as runs/first
run = redman.train("hand_over_safe_finger", algo="ppo_lag", steps=steps, seed=1, cost_limits=40, out=out, progress=False)
print(f"{run.env_steps} control steps in {run.seconds:.1f} s; {len(run.curve.returns)} epochs")

evaluation = run.evaluate(episodes=20)
print(f"return {evaluation.return_mean:.2f}, cost {evaluation.cost_mean[0]:.2f} of {evaluation.cost_limits[0]:.0f}")

policy = redman.load(out)                       # the folder is a policy for whatever takes one
pool = redman.Pool(run.task, num_envs=8, seed=3)
pool.reset()
actor, returns = policy.actor(pool), []         # an actor holds each action for policy.info.action_repeat control steps
for _ in range(2 * pool.max_steps):
    pool.step(actor())
    returns += pool.episode_return[pool.terminated | pool.truncated].tolist()
print(f"the loaded policy in {len(returns)} episodes: return {sum(returns) / len(returns):.2f}")
print(f"files: {', '.join(sorted(path.name for path in out.iterdir()))}")
