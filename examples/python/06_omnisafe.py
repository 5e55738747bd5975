"""06: an algorithm of OmniSafe learns a task.

    python3 06_omnisafe.py [steps]                  needs: pip install omnisafe

Every task has the id Redman<Task>-v0. `configs` says the task's learning defaults in the words of OmniSafe.
"""
import sys
import tempfile

try:
    import omnisafe
except ModuleNotFoundError as missing:
    print(f"This example needs OmniSafe: pip install omnisafe ({missing})")
    sys.exit(77)

import redman.omnisafe

steps, task = float(sys.argv[1]) if len(sys.argv) > 1 else 8_000, "ball_run"

settings = redman.omnisafe.configs(task, "PPOLag", steps=steps, num_envs=8)
settings["logger_cfgs"] = {"use_wandb": False, "use_tensorboard": False, "log_dir": tempfile.mkdtemp(), "save_model_freq": 1000}
agent = omnisafe.Agent("PPOLag", redman.omnisafe.env_id(task), custom_cfgs=settings)
agent.learn()
print(f"{agent.cfgs.train_cfgs.total_steps} decisions in {settings['train_cfgs']['vector_env_nums']} worlds")
agent.evaluate(num_episodes=2)
