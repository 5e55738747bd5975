"""What the adapters share: a pool in the terms in which other libraries see environments.

Bounds of observations and actions, names of entries and costs, seeds as Gymnasium counts them, actions about a start pose. A
learner's action is executed as `center` + action, clipped to [-1, 1] by the pool; without a center as it is.
"""
from __future__ import annotations

import secrets
from typing import Any, Mapping, Optional, Sequence, Union

import numpy as np

from ._abi import ShieldKind
from ._error import ArgumentError, UnsupportedError, UsageError
from ._library import int32, whole
from ._names import nearest
from ._options import as_dict
from ._policy import Backup
from ._pool import Pool
from ._rows import Array, FloatArray, array_of
from ._senses import Senses
from ._shield import NAMES, Shielding, shield_of

Center = Union[None, str, Sequence[float], Array]
Seeds = Union[None, int, Sequence[Optional[int]]]
Observe = Union[None, str, Sequence[str]]  # "state" and words of option modality, as a list or joined by +


def center_of(pool: Pool, center: Center) -> Optional[FloatArray]:
    """[action_dim] what is added to every action; None: nothing."""
    if center is None:
        return None
    if isinstance(center, str):
        if center != "initial":
            raise ArgumentError(f'center: it must be None, "initial" or [{pool.action_dim}] numbers, not "{center}"')
        return pool.initial_mean
    given = np.array(array_of(center, "center", np.float32))
    if given.shape != (pool.action_dim,) or not np.all(np.abs(given) <= 1):
        raise ArgumentError(f"center: it must be [{pool.action_dim}] numbers in [-1, 1], not {given.shape}")
    return given


def _modality(observe: Observe, options: Mapping[str, Any]) -> tuple[dict[str, Any], bool]:
    """The options with observe as modality, and whether there is no row."""
    if observe is None:
        return dict(options), False
    words = observe.split("+") if isinstance(observe, str) else list(observe) if isinstance(observe, (list, tuple)) else []
    given = next((key for key in options if key.lower().replace("-", "_") == "modality"), None)
    if given is not None:
        raise ArgumentError(f"observe and option {given} say the same; give one of them")
    if not words or not all(isinstance(word, str) for word in words) or len(set(words)) < len(words):
        raise ArgumentError(f"observe: {observe!r} is no list of words that differ, such as [\"state\", \"rgb\"]")
    if words == ["state"]:
        return dict(options), False
    return {**options, "modality": "+".join(word for word in words if word != "state")}, "state" not in words


class Worlds:
    """num_envs worlds of a task in one pool.

    seed: used by the first reset() without a seed; None draws one from the system.
    action_repeat: control steps of a step; "task": those of a decision of the task's own learner.
    center: the action for a learner's 0; "initial" for the pose with which the task's own learner begins, or [action_dim].
    shield: a redman.Shield checks every action; True or a dict of its options, budgets, seed and threads; None: no shield.
    shield_policy: its first backup, whose decisions last a step.
    senses: "" where pictures and clouds are observations; else why they cannot be, and option modality is refused.
    observe: option modality in other words.
    """

    def __init__(self, task: str, num_envs: int, *, seed: Optional[int] = None, autoreset: str = "off",
                 options: Optional[Mapping[str, Any]] = None, threads: int = 0,
                 action_repeat: Union[int, str] = 1, center: Center = None, camera: Optional[str] = None,
                 width: int = 320, height: int = 240, shield: Shielding = None, shield_policy: Optional[Backup] = None,
                 senses: str = "", observe: Observe = None) -> None:
        options, self.stateless = _modality(observe, as_dict(options))  # stateless: observations have no row
        repeat = 0 if isinstance(action_repeat, str) and action_repeat == "task" else int32(action_repeat, "action_repeat")
        if repeat != 1:
            options["action_repeat"] = repeat
        self.seed: Seeds = secrets.randbits(63) if seed is None else whole(seed, "seed", 0, (1 << 64) - 1)
        self.pool = Pool(task, num_envs=num_envs, seed=self.seed, threads=threads, autoreset=autoreset, options=options)
        self._take_rows()
        if senses and self.senses:
            raise UnsupportedError(f"option modality={options.get('modality')}: {senses}")
        self.camera, self.width, self.height = camera, width, height
        self.center = center_of(self.pool, center)
        reach = np.ones(self.pool.action_dim, np.float32) if self.center is None else 1 + np.abs(self.center)
        self.action_low, self.action_high = -reach, reach
        self.shield = shield_of(self.pool, shield, shield_policy)
        self._applied, self._kinds = np.zeros_like(self.action), np.zeros(self.pool.num_envs, np.int32)  # of the last step
        low, self.obs_high = self.pool.bounds
        self.obs_low = np.where(low == self.obs_high, low - 1, low)  # checkers take no box without width

    def _take_rows(self) -> None:
        """Stores the pool's rows, whose addresses do not change, to save a look-up at each use."""
        pool = self.pool
        self.obs, self.final_obs, self.action, self.reward = pool.obs, pool.final_obs, pool.action, pool.reward
        self.cost, self.terminated, self.truncated = pool.cost, pool.terminated, pool.truncated
        self.success, self.status, self.episode_status = pool.success, pool.status, pool.episode_status
        self.senses = Senses(pool)

    stateless = False

    def __getstate__(self) -> dict[str, Any]:
        rows = ("obs", "final_obs", "action", "reward", "cost", "terminated", "truncated", "success", "status",
                "episode_status", "senses")
        return {name: value for name, value in self.__dict__.items() if name not in rows}

    def __setstate__(self, saved: dict[str, Any]) -> None:
        self.__dict__.update(saved)
        if not self.pool._lost:  # else the first call says why
            self._take_rows()

    @property
    def fields(self) -> dict[str, slice]:
        """Where each named field of an observation is."""
        return {name: field.slice for name, field in self.pool.fields.items()}

    @property
    def cost_names(self) -> tuple[str, ...]:
        """Name of each cost column; the first is "cost", the task's."""
        return tuple(self.pool.costs)

    @property
    def max_episode_steps(self) -> int:
        """Steps of a whole episode."""
        return -(-self.pool.max_steps // self.pool.spec.action_repeat)

    @property
    def seconds(self) -> float:
        """Duration of a step, s."""
        return float(self.pool.control_dt) * self.pool.spec.action_repeat

    def reset(self, seed: Seeds = None, mask: Optional[Array] = None) -> None:
        """Begins new episodes where mask is true. An int means seed + i for world i; where a list has None, and in a reset
        without seeds, worlds continue with the streams that they have."""
        n = self.pool.num_envs
        if seed is None:  # the first reset names what is drawn, then worlds continue by themselves
            seed, self.seed = self.seed, None
        else:
            self.seed = None
        if isinstance(seed, (int, np.integer)):
            seed = [int(seed) + i for i in range(n)]
        if seed is not None and (isinstance(seed, (str, bytes)) or not hasattr(seed, "__len__")):
            raise UsageError(f"seed: it must be a whole number, a list with one for each world, or None, not {seed!r}")
        seeds: list[Optional[int]] = [None] * n if seed is None else list(seed)
        if len(seeds) != n:
            raise ArgumentError(f"seed: give one for each of the {n} worlds, not {len(seeds)}")
        seeds = [None if s is None else whole(s, "seed", 0, (1 << 64) - 1) for s in seeds]
        chosen = np.ones(n, bool) if mask is None else mask
        named = np.array([s is not None for s in seeds])
        if np.any(chosen & named):
            self.pool.reset(np.array([s or 0 for s in seeds], np.uint64), chosen & named)
        if np.any(chosen & ~named):
            self.pool.reset(None, chosen & ~named)

    def no_options(self, options: Optional[Mapping[str, Any]], known: Sequence[str] = ()) -> None:
        """Refuses options of a reset, since there are none."""
        for key in as_dict(options):
            if key in known:
                continue
            takes = f"reset takes {', '.join(known)}" if known else "reset takes none"
            hint = nearest(key, [*self.pool.task.options, *known])
            if hint and not nearest(key, known):
                own = repr(hint[len("; nearest is "):]) if hint.startswith("; nearest is ") else "name"
                hint = f": an option of the task is given when the environment is made: options={{{own}: ...}}{hint}"
            raise ArgumentError(f"reset: option {key!r} is not used, {takes}{hint}")

    def act(self, actions: Any) -> None:
        """Writes a learner's actions [num_envs][action_dim] for the next step."""
        self._look(self._write(self.action, actions))

    def act_alone(self, action: Any) -> None:
        """The same for a single world: [action_dim]."""
        self._look(self._write(self.action[0], action))

    def _write(self, to: FloatArray, actions: Any) -> Array:
        self.pool.watch(actions, self.center is not None)
        rows = array_of(actions, "action")
        if rows.dtype != np.float64:  # an actor's about the center, whose sum is then exact
            rows = array_of(rows, "action", np.float32)
        if rows.shape != to.shape:
            raise ArgumentError(f"action: its shape must be {to.shape}, not {rows.shape}")
        if self.center is None:
            to[...] = rows
        else:
            np.add(rows, self.center, out=to, casting="same_kind")
        return rows

    def _look(self, actions: Array) -> None:
        """Replaces a learner's actions by those that the shield accepts."""
        if self.shield is None:
            return
        # of worlds that only begin anew there is nothing to ask
        goes_on = ~(self.terminated | self.truncated) if self.pool.autoreset == "next_step" else None
        self._kinds = self.shield.guard(goes_on)
        own = self._kinds == ShieldKind.OWN
        ran = self.action.copy() if self.center is None else self.action - self.center
        self._applied = np.where(own[:, None], actions.reshape(ran.shape), ran).astype(np.float32)

    def shielded(self) -> dict[str, Array]:
        """The entries of infos about the shield's last decision, a row for each world; empty without a shield."""
        if self.shield is None:
            return {}
        return {"applied": self._applied.copy(), "intervened": self._kinds != ShieldKind.OWN, "shield": NAMES[self._kinds]}

    def close(self) -> None:
        """Destroys the worlds and the shield's copies."""
        self.shield = None
        self.pool.close()

    def render(self, env: int = 0, what: str = "rgb") -> Array:
        """A picture [height][width][3] of a world, or its depth [height][width], m."""
        return self.pool.render(env, self.camera, self.width, self.height, what)
