"""Actor: plays a policy and holds each of its actions as long as a decision lasts."""
from __future__ import annotations

import contextlib
import ctypes
import sys
from ctypes import byref
from typing import TYPE_CHECKING, Any, Iterator, Optional

import numpy as np

from . import _abi
from ._error import ArgumentError, UnsupportedError, VersionError
from ._library import Handle, assign, bytes_of, check, lib, sized
from ._pool import Pool
from ._rows import Array, address, clouds, given

if TYPE_CHECKING:
    from ._policy import Policy


@contextlib.contextmanager
def on_task(pool: Optional[Pool]) -> Iterator[None]:
    """Adds to an error about a policy that does not fit the name of the task."""
    try:
        yield
    except VersionError as error:
        if pool is None:
            raise
        raise VersionError(f"on task {pool.task.name}: {error}") from None


def worlds_of(where: Any) -> tuple[Optional[Pool], Any]:
    """The pool of an environment and its worlds, for environments of redman.gym, sb3, safety and omnisafe, wrapped or not."""
    if isinstance(where, Pool):
        return where, None
    inner: Any = where
    for _ in range(64):  # wrappers
        worlds: Any = getattr(inner, "worlds", None) or getattr(inner, "_worlds", None)
        if isinstance(getattr(worlds, "pool", None), Pool):
            return worlds.pool, worlds
        inside = next((getattr(inner, name, None) for name in ("env", "venv", "_env")
                       if getattr(inner, name, None) not in (None, inner)), None)
        if inside is None:
            break
        inner = inside
    return None, None


class Actor:
    """Actions of a policy for worlds that step faster than it decides: each is held until the next decision.

        pool = redman.Pool("hand_over_safe_finger", 16)      env = gymnasium.make("redman/HandOverSafeFinger-v0")
        pool.reset()                                         obs, info = env.reset()
        actor = policy.actor(pool)                           actor = policy.actor(env)
        for _ in range(75):                                  for _ in range(75):
            pool.step(actor())                                   obs, ... = env.step(actor(obs))

    In a pool, or in an environment of redman.gym, sb3, safety or omnisafe (wrapped or not), it finds out how many control
    steps a step has, the center that is added to actions, what the worlds see and where episodes have begun, so that a
    policy behaves the same in all of them. For worlds of another kind give num_envs=, action_repeat= and center=, and call
    reset(mask) where episodes begin.
    """

    def __init__(self, policy: Policy, where: Any = None, *, num_envs: Optional[int] = None, action_repeat: int = 1,
                 center: Any = None, stochastic: bool = False, seed: int = 0) -> None:
        self.policy, self.stochastic = policy, stochastic
        self._pool, self._worlds = worlds_of(where)
        if where is not None and self._pool is None:
            raise ArgumentError(f"actor: {type(where).__name__} has no worlds of redman that it could ask; say num_envs=, "
                                "action_repeat= and center=")
        if (self._pool is None) == (num_envs is None):
            raise ArgumentError("actor: a pool, an environment or num_envs=")
        spec = sized(_abi.rdm_spec)
        if self._pool is not None:
            if action_repeat != 1 or center is not None:
                raise ArgumentError("actor: action_repeat and center are those of the worlds that were given")
            num_envs, center = self._pool.num_envs, getattr(self._worlds, "center", None)
            spec = self._pool._spec
        else:
            i = policy.info
            assign(spec, {"obs_dim": i.obs_dim, "action_dim": i.action_dim, "action_repeat": action_repeat})
            spec.control_dt, spec.layout_hash = i.control_dt, i.layout_hash
            if action_repeat < 1:
                raise ArgumentError(f"action_repeat: {action_repeat} is less than 1")
        self._repeat = spec.action_repeat
        self.num_envs: int = int(num_envs or 0)
        self._center = None if center is None else np.asarray(center, np.float64)
        if self._center is not None and self._center.shape != (policy.info.action_dim,):
            raise ArgumentError(f"center: shape {self._center.shape} does not fit ({policy.info.action_dim},)")
        config = sized(_abi.rdm_actor_config)
        check(lib.rdm_actor_config_init(byref(config), ctypes.sizeof(config)))
        config.policy, config.spec = policy._open(), ctypes.pointer(spec)
        assign(config, {"num_envs": self.num_envs, "seed": seed, "stochastic": int(stochastic)})
        with on_task(self._pool):
            self._handle = Handle(lib.rdm_actor_create, lib.rdm_actor_destroy, byref(config))
        self._lengths = {"num_envs": self.num_envs, "obs_dim": policy.info.obs_dim, "action_dim": policy.info.action_dim}
        self._action = np.zeros((self.num_envs, policy.info.action_dim), np.float32)
        self._rows = _abi.FUNCTIONS["rdm_actor_act"].rows
        self._clouds = self._seen() if policy.info.num_points else None

    @property
    def hold(self) -> int:
        """Number of pool or environment steps for which a decision is held."""
        return self.policy.info.action_repeat // self._repeat

    def __call__(self, obs: Any = None, began: Any = None, mask: Any = None, points: Any = None, point_class: Any = None,
                 point_color: Any = None) -> Any:
        """Actions [num_envs][action_dim] for the next step; [action_dim] for one observation [obs_dim].

        obs None: the worlds' own observations. Others are compared with these, and refused where a wrapper has changed an
        observation that the policy learned without the wrapper. began: where episodes have begun, in addition to those that
        the actor knows of. mask: where a step will be taken. points, point_class, point_color: the clouds of worlds of
        another kind.
        """
        rows, single = self._observed(obs)
        begun = self._begun()
        if begun is not None and begun.any():
            self.reset(begun)
        if began is not None and np.any(began):
            self.reset(began)
        chosen = None if mask is None else given(mask, self._rows["mask"], self._lengths, "mask")
        cloud, kept = self._cloud(points, point_class, point_color)
        check(lib.rdm_actor_act(self._handle.value, rows.ctypes.data, cloud, address(chosen), self._action.ctypes.data))
        del kept
        # in double precision the sum with the center is the policy's action again, to the bit
        action = self._action.copy() if self._center is None else self._action - self._center
        return self._as_given(action[0] if single else action, obs)

    def reset(self, mask: Any = None) -> None:
        """Begins new episodes, everywhere or where mask [num_envs] is true: a decision is due there."""
        chosen = None if mask is None else given(mask, self._rows["mask"], self._lengths, "mask", spread=True)
        check(lib.rdm_actor_reset(self._handle.value, address(chosen), None))

    def predict(self, observation: Any, state: Any = None, episode_start: Any = None,
                deterministic: bool = True) -> tuple[Any, Any]:
        """Like predict of a Stable-Baselines3 model: returns (action, state). The actor holds actions itself and returns
        state unchanged."""
        if deterministic == self.stochastic:
            raise ArgumentError(f"predict: deterministic={deterministic}, but this actor "
                                f"{'samples' if self.stochastic else 'takes the mean'} (policy.actor(..., stochastic=...))")
        return self(observation, began=episode_start), state

    def state(self) -> bytes:
        """Held actions, counts and noise."""
        return bytes_of(lib.rdm_actor_write_state, self._handle.value)

    def set_state(self, state: bytes) -> None:
        """Continues from state(), with the same bytes."""
        check(lib.rdm_actor_read_state(self._handle.value, bytes(state), len(state)))

    def _observed(self, obs: Any) -> tuple[Array, bool]:
        """Rows, and whether they were given as one row without the axis of worlds."""
        own = None if self._pool is None else self._pool.obs
        if obs is None:
            if own is None:
                raise ArgumentError("obs: an actor without a pool or an environment needs them")
            return own, False
        single = self._single(obs)
        rows = self._flat(obs)
        if rows.ndim != (1 if single else 2):
            raise ArgumentError(f"obs: shape {rows.shape} does not fit ({self.num_envs}, {self.policy.info.obs_dim})")
        rows = given(rows.reshape(-1, rows.shape[-1]), self._rows["obs"], self._lengths, "obs")
        if own is not None and not np.array_equal(rows, own):
            raise ArgumentError("obs: not what the worlds show now: a wrapper has changed it, or it is an older one. Give "
                                "none, or take policy.actor(num_envs=...)")
        return rows, single

    @staticmethod
    def _single(obs: Any) -> bool:
        entry = next(iter(obs.values())) if isinstance(obs, dict) and "state" not in obs else obs
        return np.ndim(entry["state"] if isinstance(entry, dict) else entry) == 1

    def _flat(self, obs: Any) -> Array:
        """The row of an observation in any form of the adapters: a row, {"state": row, ...}, a dict with an entry for each
        field, or a tensor."""
        if isinstance(obs, dict):
            if "state" in obs:
                obs = obs["state"]
            elif self._pool is not None and all(name in obs for name in self._pool.fields):
                obs = np.concatenate([np.asarray(obs[name]) for name in self._pool.fields], axis=-1)
            else:
                raise ArgumentError("obs: a dict without \"state\" and without the fields of these worlds")
        return np.asarray(obs.detach().cpu() if hasattr(obs, "detach") else obs)

    @staticmethod
    def _as_given(action: Array, obs: Any) -> Any:
        """A tensor where observations are tensors."""
        return sys.modules["torch"].from_numpy(action) if hasattr(obs, "detach") else action

    def _begun(self) -> Optional[Array]:
        """Worlds whose rows show the first moment of an episode."""
        if self._pool is None:
            return None
        begun: Array = self._pool.episode_step == 0
        if self._pool.autoreset == "same_step":
            begun |= self._pool.terminated | self._pool.truncated
        return begun

    def _seen(self) -> Optional[_abi.rdm_points]:
        """The worlds' clouds, which stay where they are."""
        if self._pool is None:
            return None
        seen, i = self._pool.sensors, self.policy.info
        if seen.points is None or seen.points.shape[1] != i.num_points:
            raise UnsupportedError(f"actor: the policy reads clouds of {i.num_points} points: options modality=points and "
                                   f"points={i.num_points}")
        raw = _abi.rdm_sensors(struct_size=ctypes.sizeof(_abi.rdm_sensors))
        check(lib.rdm_pool_get_sensors(self._pool._open(), byref(raw)))
        self._kept = seen
        return _abi.rdm_points(struct_size=ctypes.sizeof(_abi.rdm_points), num_points=raw.num_points, points=raw.points,
                               point_class=raw.point_class, point_color=raw.point_color)

    def _cloud(self, points: Any, point_class: Any, point_color: Any) -> tuple[Any, Any]:
        if points is not None:
            cloud, kept = clouds(points, point_class, point_color, self.num_envs)
            return byref(cloud), (cloud, kept)
        return None if self._clouds is None else byref(self._clouds), None

    def __repr__(self) -> str:
        where = self._pool.task.name if self._pool is not None else "worlds of your own"
        return f"<Actor of {self.policy!r} in {self.num_envs} of {where}>"
