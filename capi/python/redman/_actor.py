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
from ._library import Handle, assign, bytes_of, check, flag, instance, int32, lib, raw, sized
from ._names import Hinted
from ._pool import Pool
from ._rows import Array, address, array_of, clouds, given

if TYPE_CHECKING:
    from ._policy import Policy


@contextlib.contextmanager
def on_task(pool: Optional[Pool]) -> Iterator[None]:
    """Adds the name of the task to an error about a policy that does not fit."""
    try:
        yield
    except VersionError as error:
        if pool is None:
            raise
        raise VersionError(f"on task {pool.task.name}: {error}") from None


def worlds_of(where: Any) -> tuple[Optional[Pool], Any]:
    """The pool and the worlds of an environment of redman.gym, sb3, safety or omnisafe, wrapped or not."""
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


class Actor(Hinted):
    """Plays a policy in worlds that step faster than the policy decides. It holds each action until the next decision.

        pool = redman.Pool("hand_over_safe_finger", 16)      env = gymnasium.make("redman/HandOverSafeFinger-v0")
        pool.reset()                                         obs, info = env.reset()
        actor = policy.actor(pool)                           actor = policy.actor(env)
        for _ in range(75):                                  for _ in range(75):
            pool.step(actor())                                   obs, ... = env.step(actor(obs))

    The second argument is a pool, or an environment of redman.gym, sb3, safety or omnisafe, wrapped or not. The actor reads
    from it how many control steps a step has, the center that is added to actions, the point clouds, and where episodes have
    begun. So a policy behaves the same in all of them. For other worlds give num_envs=, action_repeat= and center=, and call
    reset(mask) where episodes begin. stochastic: samples actions, with noise from the seed.
    """

    policy: Policy
    stochastic: bool
    num_envs: int

    def __init__(self, policy: Policy, where: Any = None, *, num_envs: Optional[int] = None, action_repeat: int = 1,
                 center: Any = None, stochastic: bool = False, seed: int = 0) -> None:
        from ._policy import Policy
        self.policy, self.stochastic = instance(policy, Policy, "policy"), stochastic
        self._pool, self._worlds = worlds_of(where)
        if where is not None and self._pool is None:
            raise ArgumentError(f"actor: {type(where).__name__} is not a pool or an environment of redman: give num_envs=, "
                                "action_repeat= and center= instead")
        if (self._pool is None) == (num_envs is None):
            raise ArgumentError("actor: give either a pool or environment, or num_envs=")
        spec = sized(_abi.rdm_spec)
        action_repeat = int32(action_repeat, "action_repeat")
        if self._pool is not None:
            if action_repeat != 1 or center is not None:
                raise ArgumentError("actor: action_repeat and center cannot be given with a pool or an environment, which "
                                    "has its own")
            num_envs, center = self._pool.num_envs, getattr(self._worlds, "center", None)
            spec = self._pool._spec
        else:
            i = policy.info
            assign(spec, {"obs_dim": i.obs_dim, "action_dim": i.action_dim, "action_repeat": action_repeat})
            spec.control_dt, spec.layout_hash = i.control_dt, i.layout_hash
            if action_repeat < 1:
                raise ArgumentError(f"action_repeat: {action_repeat} is less than 1")
        self._repeat = spec.action_repeat
        self.num_envs = int32(0 if num_envs is None else num_envs, "num_envs")
        self._center = None if center is None else array_of(center, "center", np.float64)
        if self._center is not None and self._center.shape != (policy.info.action_dim,):
            raise ArgumentError(f"center: its shape is {self._center.shape}, but must be ({policy.info.action_dim},)")
        config = sized(_abi.rdm_actor_config)
        check(lib.rdm_actor_config_init(byref(config), ctypes.sizeof(config)))
        config.policy, config.spec = policy._open(), ctypes.pointer(spec)
        assign(config, {"num_envs": self.num_envs, "seed": seed, "stochastic": flag(stochastic, "stochastic")})
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
        """Returns the actions [num_envs][action_dim] for the next step, or [action_dim] for one observation [obs_dim].

        obs: the observations; None takes those of the worlds. Observations that differ from those of the worlds are refused,
        since a wrapper has changed what the policy learned to read. began: worlds in which an episode has begun, in addition
        to those that the actor knows of. mask: worlds that will take a step. points, point_class, point_color: the point
        clouds, for worlds that are not in a pool.
        """
        rows, single = self._observed(obs)
        begun = self._begun()
        if begun is not None and begun.any():
            self.reset(begun)
        if began is not None:
            self.reset(given(began, self._rows["mask"], self._lengths, "began", spread=True))
        chosen = None if mask is None else given(mask, self._rows["mask"], self._lengths, "mask")
        cloud, kept = self._cloud(points, point_class, point_color)
        check(lib.rdm_actor_act(self._handle.value, rows.ctypes.data, cloud, address(chosen), self._action.ctypes.data))
        del kept
        # in double precision the sum with the center is the policy's action again, to the bit
        action = self._action.copy() if self._center is None else self._action - self._center
        return self._as_given(action[0] if single else action, obs)

    def reset(self, mask: Any = None) -> None:
        """Begins new episodes in all worlds, or in those where mask [num_envs] is true. The next call decides there anew."""
        chosen = None if mask is None else given(mask, self._rows["mask"], self._lengths, "mask", spread=True)
        check(lib.rdm_actor_reset(self._handle.value, address(chosen), None))

    def predict(self, observation: Any, state: Any = None, episode_start: Any = None,
                deterministic: bool = True) -> tuple[Any, Any]:
        """Returns (action, state) like predict of a Stable-Baselines3 model. The actor holds actions itself and returns state
        unchanged. observation: as obs of a call; episode_start [n]: where an episode has begun; deterministic: must be False
        where the actor samples, and True elsewhere."""
        if flag(deterministic, "deterministic") == self.stochastic:
            raise ArgumentError(f"predict: deterministic={deterministic} cannot be used, since this actor "
                                f"{'samples' if self.stochastic else 'takes the mean'}: make it with "
                                f"policy.actor(..., stochastic={not deterministic})")
        return self(observation, began=episode_start), state

    def state(self) -> bytes:
        """The held actions, their counts and the state of the noise, as bytes."""
        return bytes_of(lib.rdm_actor_write_state, self._handle.value)

    def set_state(self, state: bytes) -> None:
        """Continues from what state() returned; the actions that follow are bitwise the same."""
        data = raw(state, "state")
        check(lib.rdm_actor_read_state(self._handle.value, data, len(data)))

    def _observed(self, obs: Any) -> tuple[Array, bool]:
        """Rows, and whether they were given as one row without the axis of worlds."""
        own = None if self._pool is None else self._pool.obs
        if obs is None:
            if own is None:
                raise ArgumentError("obs: it must be given, since this actor has no pool or environment to read it from")
            return own, False
        single = self._single(obs)
        rows = self._flat(obs)
        if rows.ndim != (1 if single else 2):
            raise ArgumentError(f"obs: its shape is {rows.shape}, but must be ({self.num_envs}, {self.policy.info.obs_dim})")
        rows = given(rows.reshape(-1, rows.shape[-1]), self._rows["obs"], self._lengths, "obs")
        if own is not None and not np.array_equal(rows, own):
            raise ArgumentError("obs: it differs from what the worlds show now: a wrapper has changed it, or it is an older one. "
                                "Call the actor without obs, or make it with policy.actor(num_envs=...)")
        return rows, single

    @staticmethod
    def _single(obs: Any) -> bool:
        entry = next(iter(obs.values())) if isinstance(obs, dict) and "state" not in obs else obs
        return array_of(entry["state"] if isinstance(entry, dict) else entry, "obs").ndim == 1

    def _flat(self, obs: Any) -> Array:
        """The row of an observation in any form of the adapters: a row, {"state": row, ...}, a dict with an entry for each
        field, or a tensor."""
        if isinstance(obs, dict):
            if "state" in obs:
                obs = obs["state"]
            elif self._pool is not None and all(name in obs for name in self._pool.fields):
                obs = np.concatenate([np.asarray(obs[name]) for name in self._pool.fields], axis=-1)
            else:
                raise ArgumentError("obs: a dict must have the entry \"state\" or an entry for each field of these worlds")
        return array_of(obs.detach().cpu() if hasattr(obs, "detach") else obs, "obs")

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
            raise UnsupportedError(f"actor: the policy reads clouds of {i.num_points} points, which these worlds do not have: "
                                   f"make them with the options modality=points and points={i.num_points}")
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
