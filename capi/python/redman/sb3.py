"""Tasks as vectorised environments of Stable-Baselines3.

    import redman.sb3
    from stable_baselines3 import PPO
    from stable_baselines3.common.vec_env import VecNormalize
    env = redman.sb3.VecEnv("hand_over_safe_finger", 64, action_repeat="task", center="initial")
    env = VecNormalize(env, norm_reward=False, clip_obs=5)
    PPO("MlpPolicy", env, **redman.sb3.ppo_kwargs("hand_over_safe_finger")).learn(500_000)

Its learners know no costs: each info has "cost", "costs", "success" and "status" as in redman.gym, and
penalty=w takes w times the cost from the reward.
"""
from __future__ import annotations

import math
from typing import Any, Iterable, Mapping, Optional, Union

import numpy as np

from ._defaults import Defaults, defaults
from ._pool import Pool
from ._rows import Array
from ._worlds import Center, Worlds

try:
    from gymnasium.spaces import Box
    from stable_baselines3.common.vec_env import VecEnv as _VecEnv
except ImportError as error:
    raise ImportError(f"redman.sb3 needs Stable-Baselines3 and what it needs: {error}") from error

__all__ = ["Defaults", "VecEnv", "defaults", "ppo_kwargs"]

Indices = Union[None, int, Iterable[int]]


class VecEnv(_VecEnv):
    """num_envs worlds of a task in one pool; an ended episode begins anew in the same step, and its last observation is
    info["terminal_observation"]. Arguments are those of redman.gym.VectorEnv, and penalty.

    seed(s) names the episodes of the next reset, s + i for world i. The worlds are no objects of their own: attributes
    and methods of "an environment" are those of this class, the same for all; env_method("render") is the exception.
    """

    def __init__(self, task: str, num_envs: int = 1, *, seed: Optional[int] = None,
                 options: Optional[Mapping[str, Any]] = None, threads: int = 0, render_mode: Optional[str] = None,
                 camera: Optional[str] = None, width: int = 320, height: int = 240,
                 action_repeat: Union[int, str] = 1, center: Center = None, penalty: float = 0.0) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ValueError(f'render_mode: None or "rgb_array", not "{render_mode}"')
        self.worlds = Worlds(task, num_envs, seed=seed, autoreset="same_step", options=options, threads=threads,
                             action_repeat=action_repeat, center=center, camera=camera, width=width, height=height)
        self.render_mode, self.penalty = render_mode, penalty
        self.fields, self.cost_names = self.worlds.fields, self.worlds.cost_names
        super().__init__(num_envs, Box(self.worlds.obs_low, self.worlds.obs_high, dtype=np.float32),
                         Box(self.worlds.action_low, self.worlds.action_high, dtype=np.float32))
        self.metadata["render_fps"] = max(1, round(1 / self.worlds.seconds))

    @property
    def pool(self) -> Pool:
        """The worlds as redman.Pool."""
        return self.worlds.pool

    def reset(self) -> Array:
        """New episodes: those of seed(), else the next of the worlds' own streams. Options are not used."""
        self.worlds.reset(None if all(s is None for s in self._seeds) else self._seeds)
        self._reset_seeds()
        self._reset_options()
        self.reset_infos: list[dict[str, Any]] = [{} for _ in range(self.num_envs)]
        return np.array(self.pool.obs)

    def step_async(self, actions: Array) -> None:
        """Takes the actions of the step that step_wait makes."""
        self.worlds.act(actions)

    def step_wait(self) -> tuple[Array, Array, Array, list[dict[str, Any]]]:
        """Observations, rewards, whether episodes ended, infos."""
        w = self.worlds
        w.pool.step()
        costs, ended = w.cost.copy(), w.terminated | w.truncated
        infos: list[dict[str, Any]] = [
            {"cost": cost, "costs": row, "success": success, "status": status, "TimeLimit.truncated": cut}
            for cost, row, success, status, cut in zip(
                costs[:, 0].tolist(), costs, w.success.tolist(), w.status.tolist(),
                (w.truncated & ~w.terminated).tolist())]
        for i in np.flatnonzero(ended):
            infos[i]["terminal_observation"] = w.final_obs[i].copy()
            self.reset_infos[i] = {}
        reward = w.reward - self.penalty * costs[:, 0] if self.penalty else w.reward.copy()
        return w.obs.copy(), reward.astype(np.float32, copy=False), ended, infos

    def close(self) -> None:
        """Ends the worlds."""
        self.pool.close()

    def get_images(self) -> list[Array]:
        """A picture [height][width][3] of each world."""
        return [self.worlds.render(i) for i in range(self.num_envs)]

    def get_attr(self, attr_name: str, indices: Indices = None) -> list[Any]:
        """This object's attribute, once for each world."""
        value = getattr(self, attr_name)
        return [value for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Indices = None) -> None:
        """Sets this object's attribute; all worlds share it."""
        if len(list(self._get_indices(indices))) != self.num_envs:
            raise ValueError(f"{attr_name}: the worlds of a pool share it; set it for all")
        setattr(self, attr_name, value)

    def env_method(self, method_name: str, *method_args: Any, indices: Indices = None, **method_kwargs: Any) -> list[Any]:
        """Calls a method of the pool that takes a world (render, state, set_state, hash, poses, contacts), for each."""
        if method_name not in ("render", "state", "set_state", "hash", "poses", "contacts"):
            raise AttributeError(f"{method_name}: no method of one world")
        chosen = self._get_indices(indices)
        if method_name == "render":
            return [self.worlds.render(i) for i in chosen]
        method = getattr(self.pool, method_name)
        return [method(*method_args, env=i, **method_kwargs) for i in chosen]

    def env_is_wrapped(self, wrapper_class: type, indices: Indices = None) -> list[bool]:
        """No world has a wrapper."""
        return [False for _ in self._get_indices(indices)]


def ppo_kwargs(task: str, options: Optional[Mapping[str, Any]] = None, num_envs: int = 64) -> dict[str, Any]:
    """Arguments with which PPO learns a task as redman's own would, over
    VecNormalize(VecEnv(task, num_envs, action_repeat="task", center="initial"), norm_reward=False, clip_obs=5)."""
    from torch import nn
    d = defaults(task, options)
    rows = num_envs * d.horizon
    return {
        "n_steps": d.horizon, "batch_size": max(1, rows // d.minibatches), "n_epochs": d.passes,
        "learning_rate": d.learning_rate, "target_kl": d.kl_target, "gamma": d.discount, "gae_lambda": d.gae_lambda,
        "clip_range": d.clip, "max_grad_norm": d.max_grad_norm, "normalize_advantage": True,
        "policy_kwargs": {
            "net_arch": list(d.hidden), "log_std_init": math.log(d.init_std),
            "activation_fn": {"tanh": nn.Tanh, "elu": nn.ELU, "relu": nn.ReLU}[d.activation]},
    }
