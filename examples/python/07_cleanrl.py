"""07: ids of Gymnasium, as CleanRL and other programs of one file take them.

    python3 07_cleanrl.py [steps]                   needs: pip install gymnasium

CleanRL's own program needs no change: the part before the colon is the module that Gymnasium imports first.

    python3 cleanrl/ppo_continuous_action.py --env-id redman.gym:redman/BallRun-v0 --num-envs 8
"""
import sys

import numpy as np

try:
    import gymnasium
except ModuleNotFoundError as missing:
    print(f"This example needs Gymnasium: pip install gymnasium ({missing})")
    sys.exit(77)

steps = int(sys.argv[1]) if len(sys.argv) > 1 else 500


def make_env():
    """One environment with the wrappers of CleanRL's programs for continuous actions."""
    env = gymnasium.make("redman.gym:redman/BallRun-v0")
    env = gymnasium.wrappers.RecordEpisodeStatistics(gymnasium.wrappers.FlattenObservation(env))
    return gymnasium.wrappers.NormalizeObservation(gymnasium.wrappers.ClipAction(env))


envs = gymnasium.vector.SyncVectorEnv([make_env] * 4)
obs, info = envs.reset(seed=1)
print(f"observations {obs.shape}, actions {envs.single_action_space}, costs {envs.envs[0].unwrapped.cost_names}")
cost = np.zeros(envs.num_envs)
for _ in range(steps):
    obs, reward, terminated, truncated, info = envs.step(envs.action_space.sample())
    cost += info["cost"]                            # the task's own, of each step; info["costs"] has all columns
print(f"{steps} steps of {envs.num_envs} environments: cost {cost.mean():.1f} on average")
envs.close()

# The same worlds in one pool, without wrappers of each: bit for bit equal to SyncVectorEnv, and about three times as fast.
envs = gymnasium.make_vec("redman.gym:redman/BallRun-v0", num_envs=64)
envs.reset(seed=1)
obs, reward, *_ = envs.step(envs.action_space.sample())
print(f"make_vec: observations {obs.shape}, mean reward {reward.mean():.2f}")
