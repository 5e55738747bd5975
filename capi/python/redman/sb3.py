"""Tasks as vectorised environments of Stable-Baselines3.

    import redman.sb3
    from stable_baselines3 import PPO
    from stable_baselines3.common.vec_env import VecNormalize
    env = redman.sb3.VecEnv("hand_over_safe_finger", 64, action_repeat="task", center="initial")
    env = VecNormalize(env, norm_reward=False, clip_obs=5)
    PPO("MlpPolicy", env, **redman.sb3.ppo_kwargs("hand_over_safe_finger")).learn(500_000)

Its learners ignore costs: each info has "cost", "costs", "success", "status" and "episode_status" as in redman.gym, and
penalty=w subtracts w times the cost from the reward; shield=True works as there. The info at the end of an episode has
"episode" {r, l, t}, as Monitor writes it, "is_success" (whether there was one) and "episode_cost", the sum of each cost by
name. CostCallback logs those sums: learn(500_000, callback=redman.sb3.CostCallback()) adds rollout/ep_cost_mean/<name> to
the log.
"""
from __future__ import annotations

import math
import time
from collections import deque
from typing import Any, Iterable, Mapping, Optional, Union

import numpy as np

from ._defaults import Defaults, defaults
from ._error import ArgumentError
from ._policy import Backup
from ._pool import Pool
from ._rows import Array
from ._shield import Shield, Shielding
from ._worlds import Center, Worlds

try:
    from gymnasium.spaces import Box
    from stable_baselines3.common.callbacks import BaseCallback as _BaseCallback
    from stable_baselines3.common.monitor import Monitor as _Monitor
    from stable_baselines3.common.vec_env import VecEnv as _VecEnv
except ImportError as error:
    raise ImportError(f"redman.sb3 needs Stable-Baselines3 and what it needs: {error}") from error

__all__ = ["CostCallback", "Defaults", "VecEnv", "defaults", "ppo_kwargs"]

_NO_LAST_LOOK = ("Stable-Baselines3 wants the last observation of an ended episode, and pictures and clouds of it are gone; "
                 "DummyVecEnv([lambda: redman.gym.Env(task, options=...)]) with \"MultiInputPolicy\" has them")
Indices = Union[None, int, Iterable[int]]


class VecEnv(_VecEnv):
    """num_envs worlds of a task in one pool; a world whose episode ends begins another in the same step, and the last
    observation is info["terminal_observation"].

        env = redman.sb3.VecEnv("ball_run", 8, seed=7, action_repeat="task", center="initial", penalty=0.1)
        obs = env.reset()                                                       # [8][obs_dim]
        for _ in range(20):
            actions = [env.action_space.sample() for _ in range(env.num_envs)]
            obs, rewards, ended, infos = env.step(actions)
        env.close()

    penalty: subtracted from the reward, times the task's own cost (column 0); 0 leaves the reward as it is.
    render_mode: None or "rgb_array". task, num_envs, seed, options, threads, action_repeat, center, camera, width, height, shield,
    shield_policy: as those of redman.gym.VectorEnv, with its errors. Option modality raises UnsupportedError: with
    DummyVecEnv, redman.gym.Env has pictures and clouds.

    seed(s) sets the seeds of the next reset, s + i for world i. The worlds are not separate objects: attributes and methods
    of "an environment" are those of this class, the same for all, except in env_method("render").
    """

    def __init__(self, task: str, num_envs: int = 1, *, seed: Optional[int] = None,
                 options: Optional[Mapping[str, Any]] = None, threads: int = 0, render_mode: Optional[str] = None,
                 camera: Optional[str] = None, width: int = 320, height: int = 240,
                 action_repeat: Union[int, str] = 1, center: Center = None, penalty: float = 0.0,
                 shield: Shielding = None, shield_policy: Optional[Backup] = None) -> None:
        if render_mode not in (None, "rgb_array"):
            raise ArgumentError(f'render_mode: it must be None or "rgb_array", not {render_mode!r}')
        self.worlds = Worlds(task, num_envs, seed=seed, autoreset="same_step", options=options, threads=threads,
                             action_repeat=action_repeat, center=center, camera=camera, width=width, height=height,
                             shield=shield, shield_policy=shield_policy, senses=_NO_LAST_LOOK)
        self.render_mode, self.penalty = render_mode, penalty
        self.fields, self.cost_names = self.worlds.fields, self.worlds.cost_names
        super().__init__(num_envs, Box(self.worlds.obs_low, self.worlds.obs_high, dtype=np.float32),
                         Box(self.worlds.action_low, self.worlds.action_high, dtype=np.float32))
        self.metadata["render_fps"] = max(1, round(1 / self.worlds.seconds))
        self._began = time.time()
        self._return, self._length = np.zeros(num_envs), np.zeros(num_envs, np.int64)  # of the episodes so far
        self._costs, self._success = np.zeros((num_envs, self.pool.cost_dim)), np.zeros(num_envs, bool)

    @property
    def shield(self) -> Optional[Shield]:
        """The shield that checks every action, or None."""
        return self.worlds.shield

    @property
    def pool(self) -> Pool:
        """The worlds as redman.Pool."""
        return self.worlds.pool

    def reset(self) -> Array:
        """Begins new episodes everywhere, those of seed(), else the next of the worlds' own streams, and returns the observations
        [num_envs][obs_dim]. set_options() must not have been given any: ArgumentError."""
        for options in self._options:
            self.worlds.no_options(options)
        self.worlds.reset(None if all(s is None for s in self._seeds) else self._seeds)
        self._reset_seeds()
        self._reset_options()
        w, no = self.worlds, np.zeros(self.num_envs, bool)
        nothing = self._infos(np.zeros_like(w.cost), no, w.status, w.episode_status, no, self._nothing(w.shielded()))
        self.reset_infos: list[dict[str, Any]] = nothing
        self._first_info = nothing[0]
        self._first_info["costs"].flags.writeable = False  # of all later ones too
        for sums in (self._return, self._length, self._costs, self._success):
            sums[...] = 0
        return np.array(self.pool.obs)

    def step_async(self, actions: Array) -> None:
        """Takes the actions [num_envs][action_dim] of the step that step_wait makes; ArgumentError for another shape."""
        self.worlds.act(actions)

    def step_wait(self) -> tuple[Array, Array, Array, list[dict[str, Any]]]:
        """Makes the step and returns observations [num_envs][obs_dim], rewards [num_envs], whether episodes ended [num_envs], and a
        list of infos, one for each world."""
        w = self.worlds
        w.pool.step()
        costs, ended = w.cost.copy(), w.terminated | w.truncated
        reward = w.reward - self.penalty * costs[:, 0] if self.penalty else w.reward.copy()
        infos = self._infos(costs, w.success, w.status, w.episode_status, w.truncated & ~w.terminated, w.shielded())
        self._return += reward
        self._length += 1
        self._costs += costs
        self._success |= w.success
        if ended.any():
            self._finish(ended, infos)
        return w.obs.copy(), reward.astype(np.float32, copy=False), ended, infos

    @staticmethod
    def _infos(costs: Array, success: Array, status: Array, all_status: Array, cut: Array,
               shielded: Mapping[str, Array]) -> list[dict[str, Any]]:
        """The info of a step for each world."""
        infos = [{"cost": cost, "costs": row, "success": won, "status": bits, "episode_status": all_bits, "TimeLimit.truncated": late}
                 for cost, row, won, bits, all_bits, late in zip(
                     costs[:, 0].tolist(), costs, success.tolist(), status.astype(np.int64).tolist(),
                     all_status.astype(np.int64).tolist(), cut.tolist())]
        for key, rows in shielded.items():
            for info, value in zip(infos, list(rows) if rows.ndim > 1 else rows.tolist()):
                info[key] = value
        return infos

    @staticmethod
    def _nothing(shielded: Mapping[str, Array]) -> dict[str, Array]:
        """The entries about a shield after a reset."""
        return {key: np.full_like(rows, "" if rows.dtype == object else 0) for key, rows in shielded.items()}

    def _finish(self, ended: Array, infos: list[dict[str, Any]]) -> None:
        """Adds the further entries of the infos at the end of episodes, whose sums begin anew."""
        sums = (self._return, self._length, self._costs, self._success)
        seconds = round(time.time() - self._began, 6)
        for i, last, ret, length, costs, won in zip(np.flatnonzero(ended).tolist(), self.worlds.final_obs[ended], *(s[ended].tolist() for s in sums)):
            infos[i].update(terminal_observation=last, episode={"r": round(ret, 6), "l": length, "t": seconds}, is_success=won,
                            episode_cost=dict(zip(self.cost_names, costs)))
            self.reset_infos[i] = dict(self._first_info)
        for rows in sums:
            rows[ended] = 0

    def close(self) -> None:
        """Destroys the worlds."""
        self.worlds.close()

    def get_images(self) -> list[Array]:
        """A list with a picture [height][width][3] uint8 of each world."""
        return [self.worlds.render(i) for i in range(self.num_envs)]

    def get_attr(self, attr_name: str, indices: Indices = None) -> list[Any]:
        """A list of this object's attribute attr_name, once for each world of indices: a number, several, or None for all."""
        value = getattr(self, attr_name)
        return [value for _ in self._get_indices(indices)]

    def set_attr(self, attr_name: str, value: Any, indices: Indices = None) -> None:
        """Sets this object's attribute attr_name to value. All worlds share it: indices must be None or name all of them, else
        ValueError."""
        if len(list(self._get_indices(indices))) != self.num_envs:
            raise ValueError(f"{attr_name}: the worlds of a pool share it: set it for all of them")
        setattr(self, attr_name, value)

    def env_method(self, method_name: str, *method_args: Any, indices: Indices = None, **method_kwargs: Any) -> list[Any]:
        """Calls a method of the pool that takes a world, for each world of indices (a number, several, or None for all), and returns
        a list of the results. method_name: render, state, set_state, hash, poses or contacts; AttributeError for others.
        method_args, method_kwargs: the method's own, without env."""
        if method_name not in ("render", "state", "set_state", "hash", "poses", "contacts"):
            raise AttributeError(f"{method_name}: no method of one world")
        chosen = self._get_indices(indices)
        if method_name == "render":
            return [self.worlds.render(i) for i in chosen]
        method = getattr(self.pool, method_name)
        return [method(*method_args, env=i, **method_kwargs) for i in chosen]

    def env_is_wrapped(self, wrapper_class: type, indices: Indices = None) -> list[bool]:
        """For each world of indices (None: all) whether wrapper_class is around it. No world has a wrapper, but infos have what a
        Monitor writes, so the answer for Monitor is true."""
        return [wrapper_class is _Monitor for _ in self._get_indices(indices)]


class CostCallback(_BaseCallback):
    """Logs the mean cost of the last hundred episodes, rollout/ep_cost_mean/<name>, when a rollout ends. It takes no arguments,
    and needs the infos of a VecEnv of this module.

        log = redman.sb3.CostCallback()                 # model.learn(500_000, callback=log)
    """

    def __init__(self) -> None:
        super().__init__()
        self._episodes: deque[dict[str, float]] = deque(maxlen=100)

    def _on_step(self) -> bool:
        self._episodes.extend(info["episode_cost"] for info in self.locals["infos"] if "episode_cost" in info)
        return True

    def _on_rollout_end(self) -> None:
        for name in self._episodes[0] if self._episodes else ():
            mean = sum(costs[name] for costs in self._episodes) / len(self._episodes)
            self.logger.record(f"rollout/ep_cost_mean/{name}", mean)


def ppo_kwargs(task: str, options: Optional[Mapping[str, Any]] = None, num_envs: int = 64) -> dict[str, Any]:
    """Arguments with which Stable-Baselines3's PPO learns a task like redman's own, a dict. They are for VecNormalize(VecEnv(task,
    num_envs, action_repeat="task", center="initial"), norm_reward=False, clip_obs=5), and need torch.

        env = redman.sb3.VecEnv("ball_run", 64, action_repeat="task", center="initial")
        settings = redman.sb3.ppo_kwargs("ball_run", num_envs=64)       # PPO("MlpPolicy", VecNormalize(env, ...), **settings)

    task: its name. options: of the task, as those of VecEnv. num_envs: worlds of that VecEnv, 1 or more. NotFoundError for a
    task or an option that does not exist.
    """
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
