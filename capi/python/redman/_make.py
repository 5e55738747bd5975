"""make and make_vec: environments in the manner of Gymnasium."""
from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ._discovery import TaskName, task_name

if TYPE_CHECKING:
    from . import gym


def make(task: TaskName, **settings: Any) -> gym.Env:
    """One environment with Gymnasium's interface, redman.gym.Env(task, ...), with or without Gymnasium: reset returns (obs,
    info), step five values.

        env = redman.make("ball_run", action_repeat="task")

    task: a name, an id of its environments (redman/BallRun-v0), a .task file, or a class of your own (redman.Task). settings: the
    other arguments of redman.gym.Env."""
    from .gym import Env
    return Env(task_name(task), **settings)


def make_vec(task: TaskName, num_envs: int = 1, **settings: Any) -> gym.VectorEnv:
    """A vector environment with Gymnasium's interface, redman.gym.VectorEnv(task, num_envs, ...), with or without Gymnasium.

        envs = redman.make_vec("ball_run", 64, action_repeat="task")

    task: as that of redman.make. num_envs: worlds, 1 or more. settings: the other arguments of redman.gym.VectorEnv."""
    from .gym import VectorEnv
    return VectorEnv(task_name(task), num_envs, **settings)
