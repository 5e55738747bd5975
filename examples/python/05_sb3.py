"""05: Stable-Baselines3 learns a task.

    python3 05_sb3.py [steps]                       needs: pip install stable-baselines3

Its learners know no costs: `penalty` takes the cost from the reward, and `CostCallback` logs what an episode cost.
"""
import sys

try:
    from stable_baselines3 import PPO
except ModuleNotFoundError as missing:
    print(f"This example needs Stable-Baselines3: pip install stable-baselines3 ({missing})")
    sys.exit(77)

import redman.sb3

steps, task = int(float(sys.argv[1])) if len(sys.argv) > 1 else 20_000, "ball_run"

# action_repeat and center: the decisions of the task's own learner, about the pose that it starts from
env = redman.sb3.VecEnv(task, 16, seed=1, action_repeat="task", center="initial", penalty=10)
settings = {**redman.sb3.ppo_kwargs(task), "n_steps": 250, "batch_size": 500}
model = PPO("MlpPolicy", env, seed=1, device="cpu", **settings)
model.learn(steps, callback=redman.sb3.CostCallback())

# A model knows its environment, so evaluate knows task, decisions and center.
trained, random = redman.evaluate(model, episodes=16), redman.evaluate("random", task, episodes=16)
for name, row in (("random", random), ("PPO", trained)):
    print(f"{name:6}: return {row.return_mean:7.1f}, cost {row.cost_mean[0]:5.1f} (limit of the task: {row.cost_limits[0]:.0f})")
