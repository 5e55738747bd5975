"""Tasks as environments of Safety-Gymnasium: a step returns six values, the third of which is the cost.

    import safety_gymnasium, redman.safety
    env = safety_gymnasium.make("SafetyRedmanHandOverSafeFinger-v0")
    obs, reward, cost, terminated, truncated, info = env.step(action)

Every task has the id SafetyRedman<Task>-v0, and Safety<Task>-v0 too where Safety-Gymnasium has no such id of its own:
SafetyPointGoal1-v0 and eleven more are its own environments, not ours.

info names the costs as Safety-Gymnasium does: cost_sum is the task's own (column 0), cost_<name> is each other one.
shield=True is as in redman.gym. Env and VectorEnv need at most Gymnasium; the ids need Safety-Gymnasium. VectorEnv treats
the end of an episode like SafetySyncVectorEnv: a new episode in the same step, with info["final_observation"] and
info["final_info"].
"""
from __future__ import annotations

from typing import Any, Callable, Optional

import numpy as np

from . import gym
from ._defaults import Defaults, defaults
from ._discovery import tasks
from ._rows import Array
from ._worlds import Worlds

__all__ = ["Defaults", "Env", "VectorEnv", "defaults", "env_id", "register", "unregistered"]


class _Told:
    worlds: Worlds
    cost_names: tuple[str, ...]
    _flags: Callable[[], dict[str, Array]]

    def _told(self) -> dict[str, Array]:
        w = self.worlds
        costs = w.cost.T.astype(np.float64)
        return {"cost_sum": costs[0], **{f"cost_{name}": c for name, c in zip(self.cost_names[1:], costs[1:])},
                "success": w.success.copy(), **{key: rows.astype(np.int64) for key, rows in self._flags().items()},
                **w.shielded()}

    def _told_of(self, i: int) -> gym.Info:
        w = self.worlds
        costs = w.cost[i].tolist()
        return {"cost_sum": costs[0], **{f"cost_{name}": c for name, c in zip(self.cost_names[1:], costs[1:])},
                "success": w.success.item(i), **{key: rows.item(i) for key, rows in self._flags().items()},
                **gym.shielded_of(w, i)}


class Env(_Told, gym.Env):
    """One world of a task, with the cost as the third value of a step.

        env = redman.safety.Env("ball_run", seed=7, action_repeat="task")
        obs, info = env.reset()
        for _ in range(20):
            obs, reward, cost, terminated, truncated, info = env.step(env.action_space.sample())
        env.close()

    task, seed, options, action_repeat, center, shield, shield_policy, render_mode, camera, width, height, named, observe: as those of
    redman.gym.Env, and so are observations, actions, reset, render and errors.
    """

    def step(self, action: Any) -> tuple[Any, float, float, bool, bool, gym.Info]:  # type: ignore[override]
        """Makes a step and returns (observation, reward, cost, terminated, truncated, info).

        action: [action_dim], as that of redman.gym.Env. cost: info["cost_sum"], the task's own cost (column 0), summed over
        the control steps like the reward."""
        obs, reward, terminated, truncated, info = super().step(action)
        return obs, reward, info["cost_sum"], terminated, truncated, info


class VectorEnv(_Told, gym.VectorEnv):
    """num_envs worlds of a task in one pool, with the costs as the third value of a step. A world whose episode ends begins
    another in the same step.

        envs = redman.safety.VectorEnv("ball_run", 8, seed=7, action_repeat="task")
        obs, infos = envs.reset()                                               # [8][obs_dim]
        for _ in range(20):
            obs, reward, cost, terminated, truncated, infos = envs.step(envs.action_space.sample())
        envs.close()

    task: its name or a .task file. num_envs: worlds, 1 or more. kwargs: the other arguments of redman.gym.VectorEnv, without
    autoreset_mode. Option modality raises UnsupportedError, since the last pictures of an episode are overwritten by then.
    """

    _old = True

    def __init__(self, task: str, num_envs: int = 1, **kwargs: Any) -> None:
        super().__init__(task, num_envs, autoreset_mode="SameStep", **kwargs)  # modalities are refused there

    def step(self, actions: Any) -> tuple[Any, Array, Array, Array, Array, gym.Info]:  # type: ignore[override]
        """Makes a step and returns (observations, rewards, costs, terminated, truncated, infos).

        actions: [num_envs][action_dim], as those of redman.gym.VectorEnv. rewards, costs, terminated, truncated: [num_envs];
        a cost is the task's own (column 0), summed over the control steps."""
        obs, reward, terminated, truncated, info = super().step(actions)
        return obs, reward, self.cost.astype(np.float64), terminated, truncated, info


def env_id(task: str) -> str:
    """The id of a task that belongs to no other environment.

        redman.safety.env_id("ball_run")                # SafetyRedmanBallRun-v0

    task: its name.
    """
    return f"SafetyRedman{gym.camel(task)}-v0"


def _plain_id(task: str) -> str:
    return f"Safety{gym.camel(task)}-v0"


def register() -> None:
    """Gives Safety-Gymnasium ids for every task; importing this module does it where it can, and redman.safety.unregistered says
    why it could not. ImportError without Safety-Gymnasium.

        redman.safety.register()                        # also for tasks that were added since
    """
    import safety_gymnasium
    from gymnasium.envs.registration import registry
    for task in tasks():
        for name in (env_id(task), _plain_id(task)):
            if name not in registry:
                safety_gymnasium.register(id=name, entry_point="redman.safety:Env", kwargs={"task": task})


unregistered: Optional[str] = None  # why there are no ids
try:
    register()
except Exception as error:  # its import runs a simulator's, which fails in ways of its own
    unregistered = f"Safety-Gymnasium: {type(error).__name__}: {error}"
