"""Tasks as environments of OmniSafe.

    import omnisafe, redman.omnisafe
    agent = omnisafe.Agent("PPOLag", "RedmanHandOverSafeFinger-v0",
                           custom_cfgs=redman.omnisafe.configs("hand_over_safe_finger", steps=2e6))
    agent.learn()

Every task has the id Redman<Task>-v0: a step is a decision of the task's own learner, and actions are relative to its start
pose. The four ids of OmniSafe's GPU tasks (ShadowHandOverSafeFinger, ...) exist here too, with single control steps and
plain actions, so that OmniSafe's published settings for them apply unchanged. register() adds ids with options; algorithms
with env_cfgs take options there, too. The cost is the task's own, column 0.
"""
from __future__ import annotations

from typing import Any, ClassVar, Mapping, Optional

import numpy as np

from ._defaults import Defaults, defaults
from ._discovery import tasks
from ._error import ArgumentError, NotFoundError
from ._names import nearest
from ._rows import Array
from ._worlds import Worlds
from .gym import camel

try:
    import torch
    from gymnasium.spaces import Box
    from omnisafe.algorithms import ALGORITHM2TYPE, registry
    from omnisafe.algorithms.on_policy import NaturalPG
    from omnisafe.envs.core import CMDP, ENV_REGISTRY
    from omnisafe.envs.safety_isaac_gym_env import SafetyIsaacGymEnv
    from omnisafe.utils.config import get_default_kwargs_yaml
except ImportError as error:
    raise ImportError(f"redman.omnisafe needs OmniSafe and what it needs: {error}") from error

__all__ = ["Defaults", "Redman", "configs", "defaults", "env_id", "register"]

_GPU_TASKS = {
    "ShadowHandOverSafeFinger": "hand_over_safe_finger",
    "ShadowHandOverSafeJoint": "hand_over_safe_joint",
    "ShadowHandCatchOver2UnderarmSafeFinger": "catch_underarm_safe_finger",
    "ShadowHandCatchOver2UnderarmSafeJoint": "catch_underarm_safe_joint",
}


def env_id(task: str) -> str:
    """The id under which OmniSafe has a task.

        redman.omnisafe.env_id("ball_run")              # RedmanBallRun-v0

    task: its name.
    """
    return f"Redman{camel(task)}-v0"


_VECTORS = "observations of OmniSafe are vectors; redman.gym has pictures and clouds"
_Settings = dict[str, Any]
_DECISIONS: _Settings = {"action_repeat": "task", "center": "initial"}
_IDS: dict[str, tuple[str, _Settings]] = {
    **{env_id(task): (task, _DECISIONS) for task in tasks()},
    **{name: (task, {}) for name, task in _GPU_TASKS.items() if task in tasks()}}


class Redman(CMDP):
    """num_envs worlds of a task; a world whose episode ends begins another in the same step. OmniSafe makes it by itself; you
    need it only to step worlds by hand.

        env = redman.omnisafe.Redman("RedmanBallRun-v0", num_envs=4)
        obs, info = env.reset(seed=7)                                           # a tensor [4][obs_dim]
        action = torch.zeros(4, env.action_space.shape[0])
        obs, reward, cost, terminated, truncated, info = env.step(action)
        env.close()

    env_id: an id of this module (redman.omnisafe.env_id, register). num_envs: worlds, 1 or more. device: of the tensors that
    reset and step return, such as "cpu". render_mode: None or "rgb_array". width, height: of a picture, in pixels.
    settings: options, action_repeat, center, threads, shield, shield_policy, as in redman.gym.VectorEnv; they override those
    of the id. With a shield, an info has "applied" and "intervened" as tensors, and "shield", a list of texts. camera_name
    and camera_id are for OmniSafe's evaluator (its default "track" is the task's first camera). Actions are bounded by -1
    and 1, with a `center` too. Option modality raises UnsupportedError; other errors are those of redman.gym.VectorEnv.
    """

    need_auto_reset_wrapper = False
    need_time_limit_wrapper = False
    _support_envs: ClassVar[list[str]] = list(_IDS)

    def __init__(self, env_id: str, num_envs: int = 1, device: Any = "cpu", *, render_mode: Optional[str] = None,
                 camera_name: Optional[str] = None, camera_id: Optional[int] = None, width: int = 256,
                 height: int = 256, **settings: Any) -> None:
        super().__init__(env_id)
        if render_mode not in (None, "rgb_array"):
            raise ArgumentError(f'render_mode: it must be None or "rgb_array", not {render_mode!r}')
        task, own = _IDS[env_id]
        self._num_envs, self._device = num_envs, torch.device(device)
        self._worlds = Worlds(task, num_envs, autoreset="same_step", width=width, height=height, senses=_VECTORS,
                              **{**own, **settings})
        cameras = list(self._worlds.pool.cameras)
        named = cameras[camera_id] if camera_name is None and camera_id is not None else camera_name
        self._worlds.camera = None if named == "track" and named not in cameras else named
        self._observation_space = Box(self._worlds.obs_low, self._worlds.obs_high, dtype=np.float32)
        self._action_space = Box(-1, 1, (self._worlds.pool.action_dim,), np.float32)
        self._metadata = {"render_modes": ["rgb_array"], "render_fps": max(1, round(1 / self._worlds.seconds))}

    @property
    def max_episode_steps(self) -> int:
        """Steps of a whole episode."""
        return self._worlds.max_episode_steps

    def set_seed(self, seed: int) -> None:
        """Sets the seeds of the next reset: seed + i for world i. seed: 0 to 2^64 - 1."""
        self._worlds.seed = int(seed)

    def reset(self, seed: Optional[int] = None, options: Optional[dict[str, Any]] = None) -> tuple[Any, dict[str, Any]]:
        """Begins new episodes everywhere and returns (observations [num_envs][obs_dim], info), tensors; of a single world [obs_dim].

        seed: 0 to 2^64 - 1, seed + i for world i; None: that of set_seed, or the next of the worlds' own streams. options: None
        or an empty dict; ArgumentError for others."""
        self._worlds.no_options(options)
        self._worlds.reset(seed)
        return self._tensor(self._worlds.obs), {**self._flags(), **self._shielded(began=True)}

    def step(self, action: Any) -> tuple[Any, ...]:
        """Makes a step and returns (observation, reward, cost, terminated, truncated, info), tensors with a row or entry for each
        world; of a single world without that axis.

        action: a tensor [num_envs][action_dim] in [-1, 1]. reward, cost: sums over the control steps; the cost is the task's
        own, column 0. info["final_observation"]: the last observations of the episodes that ended."""
        w = self._worlds
        w.act(action.detach().cpu().numpy().reshape(w.action.shape))
        w.pool.step()
        info = {**self._flags(), **self._shielded()}
        ended = w.terminated | w.truncated
        if ended.any():
            info["final_observation"] = self._tensor(w.final_obs)
            info["_final_observation"] = torch.from_numpy(ended if self._num_envs > 1 else ended[0:1])
        return (*map(self._tensor, (w.obs, w.reward, w.cost[:, 0], w.terminated, w.truncated)), info)

    def _flags(self) -> dict[str, Any]:
        """What went wrong in each world: RDM_STATUS_* of the step, and all of the episode."""
        w = self._worlds
        return {key: torch.from_numpy(rows.astype(np.int64))
                for key, rows in (("status", w.status), ("episode_status", w.episode_status))}

    def _shielded(self, began: bool = False) -> dict[str, Any]:
        """What the shield did in each world; empty for worlds that have just begun an episode."""
        told = self._worlds.shielded()
        if not told:
            return {}
        applied, intervened, names = told.values()
        one = self._num_envs == 1
        if began:
            applied, intervened, names = np.zeros_like(applied), np.zeros_like(intervened), np.full_like(names, "")
        return {"applied": self._tensor(applied), "intervened": torch.from_numpy(intervened[0:1] if one else intervened),
                "shield": names.tolist()}

    def _tensor(self, rows: Array) -> Any:
        """A copy: OmniSafe keeps tensors of earlier steps."""
        return torch.tensor(rows if self._num_envs > 1 else rows[0], dtype=torch.float32, device=self._device)

    def render(self) -> Array:
        """A picture [height][width][3] uint8 of the first world."""
        return self._worlds.render()

    def close(self) -> None:
        """Destroys the worlds; nothing else may be called afterwards."""
        self._worlds.close()


def register(name: str, task: str, **settings: Any) -> str:
    """Registers an id of your own for a task with settings, and returns it.

        redman.omnisafe.register("ShortBallRun-v0", "ball_run", options={"max_steps": 100})
        settings = redman.omnisafe.configs("ball_run", options={"max_steps": 100})  # omnisafe.Agent("PPOLag", id, custom_cfgs=settings)

    name: the id, without /; ArgumentError if it is taken. task: its name. settings: options, action_repeat, center, threads,
    shield and shield_policy, as those of redman.gym.VectorEnv; action_repeat and center are the task's own unless given.
    """
    if "/" in name or name in _IDS:
        raise ArgumentError(f"{name}: an id without / that is not taken")
    _IDS[name] = task, {**_DECISIONS, **settings}
    Redman._support_envs.append(name)  # the registry holds this list
    return name


def configs(task: str, algo: str = "PPOLag", steps: float = 2e6, options: Optional[Mapping[str, Any]] = None,
            num_envs: int = 64) -> dict[str, Any]:
    """custom_cfgs with which an algorithm of OmniSafe learns Redman<Task>-v0 like redman's own: discount, initial standard
    deviation, limit, normalisation, networks and learning rates, as far as the algorithm has them. A nested dict.

        settings = redman.omnisafe.configs("ball_run", "PPOLag", steps=1e6, num_envs=32)
        settings["algo_cfgs"]["cost_limit"] = 10        # omnisafe.Agent("PPOLag", "RedmanBallRun-v0", custom_cfgs=settings)

    task: its name. algo: of OmniSafe; NotFoundError for one that it does not have. steps: control steps summed over worlds, rounded
    to whole epochs. num_envs: worlds, 1 or more. options: of the task; if an algorithm has no env_cfgs for them, use an id of
    register() with the same options. You may change the returned dict before passing it on.
    """
    if algo not in ALGORITHM2TYPE:
        raise NotFoundError(f"algorithm {algo!r}: OmniSafe has no algorithm of that name{nearest(algo, ALGORITHM2TYPE)}")
    d, kind = defaults(task, options), ALGORITHM2TYPE[algo]
    # An epoch of OmniSafe begins with a reset: whole episodes, or their ends are never seen.
    decisions = num_envs * d.episode * -(-2 * d.horizon // d.episode)
    epochs = max(1, round(steps / (d.action_repeat * decisions)))
    wanted: dict[str, Any] = {
        "train_cfgs": {"vector_env_nums": num_envs, "total_steps": epochs * decisions},
        "algo_cfgs": {"gamma": d.discount, "cost_gamma": d.discount, "obs_normalize": d.normalize_obs},
    }
    if options:
        wanted["env_cfgs"] = {"options": dict(options)}
    if kind == "on-policy":
        trusts = issubclass(registry.get(algo), NaturalPG)
        wanted["algo_cfgs"].update(
            steps_per_epoch=decisions, update_iters=d.passes, batch_size=decisions // d.minibatches,
            target_kl=d.trust_kl if trusts else d.kl_target, lam=d.gae_lambda, lam_c=d.gae_lambda, clip=d.clip,
            max_grad_norm=d.max_grad_norm)
        network = {"hidden_sizes": list(d.hidden), "activation": d.activation, "lr": d.learning_rate}
        wanted["model_cfgs"] = {"actor": network, "critic": dict(network), "exploration_noise_anneal": True,
                                "std_range": [d.init_std, 0.375 * d.init_std]}
    if d.cost_limit is not None:
        wanted["algo_cfgs"]["cost_limit"] = d.cost_limit
        wanted["lagrange_cfgs"] = {"cost_limit": d.cost_limit, "lambda_lr": d.multiplier_lr, "lambda_optimizer": "SGD"}
    return _known(wanted, get_default_kwargs_yaml(algo, env_id(task), kind).todict())


def _known(wanted: dict[str, Any], known: dict[str, Any]) -> dict[str, Any]:
    """The settings that an algorithm has."""
    return {key: _known(value, known[key]) if isinstance(value, dict) and key != "env_cfgs" else value
            for key, value in wanted.items() if key in known}


ENV_REGISTRY.unregister(SafetyIsaacGymEnv)
ENV_REGISTRY.register(Redman)
