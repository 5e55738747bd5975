"""Tasks as environments of Gymnasium (0.28 to 1.x).

    import gymnasium, redman.gym
    env = gymnasium.make("redman/HandOverSafeFinger-v0", render_mode="rgb_array")
    envs = gymnasium.make_vec("redman/HandOverSafeFinger-v0", num_envs=64, action_repeat="task")

Env is one world, VectorEnv many in one pool, equal bit for bit to Gymnasium's SyncVectorEnv over as many Env. The info of a
step has its costs: "cost", the task's own (column 0), and "costs" [cost_dim], in the order of cost_names; and "success",
"status" (redman.h, RDM_STATUS_*: 0 where nothing went wrong) and "episode_status", all its bits since the episode began.
Infos of a reset have the same keys, all 0 except where the first observation was not finite (2). An episode depends on its
seed alone: world i of reset(seed=s) has the episode of an Env with reset(seed=s + i).

With shield=True a redman.Shield checks every action, and accepts it only if it cannot lead to a cost. Infos then have
"applied", the executed action in the learner's terms; "intervened", whether it differs from the learner's; and "shield",
what was done: "own", "changed", "plan", "unproven" or "projected" (redman.ShieldKind), "" in a reset. Where the shield tries
noisy actions (shield={"noise": 0} does not), its own noise continues from episode to episode.

With option modality (rgb, depth, segmentation, points, voxels joined by +) an observation is a dict: "state", the row, and
an entry for each of them; pictures of one camera are [height][width]..., of several [cameras][height][width]... With
named=True it is a dict too, with an entry for each field instead of "state", in the row's order, so that Gymnasium's flatten
gives the row.

Without Gymnasium the two classes have the same methods over spaces of their own, and no id is registered.
"""
from __future__ import annotations

import copy
from typing import TYPE_CHECKING, Any, Mapping, Optional, Union

import numpy as np

from ._defaults import Defaults, defaults
from ._discovery import tasks
from ._error import ArgumentError
from ._library import whole
from ._names import nearest
from ._policy import Backup
from ._pool import Pool
from ._rows import Array
from ._shield import Shield, Shielding
from ._worlds import Center, Observe, Seeds, Worlds

try:
    import gymnasium
    from gymnasium import Env as _Env
    from gymnasium.spaces import Box, Dict
    from gymnasium.vector import VectorEnv as _VectorEnv
    from gymnasium.vector.utils import batch_space
except ImportError as error:
    if getattr(error, "name", None) != "gymnasium":  # it is there, and something that it needs is not
        raise
    gymnasium = None
    from ._spaces import Box, Dict, Env as _Env, VectorEnv as _VectorEnv, batch_space

try:
    from gymnasium.vector import AutoresetMode
except ImportError:  # before 1.1
    AutoresetMode = str

__all__ = ["Defaults", "Env", "VectorEnv", "camel", "defaults", "env_id", "register"]

Info = dict[str, Any]
_MODES = {"NextStep": "next_step", "SameStep": "same_step", "Disabled": "off"}
_NO_LAST_LOOK = ("SameStep has no last picture or cloud of an episode that ended; take autoreset_mode \"NextStep\" or "
                 "\"Disabled\", or single environments")
_OLD = gymnasium is not None and gymnasium.__version__.startswith("0.")


_PICTURES = {"rgb_array": "rgb", "depth_array": "depth"}  # render_mode: what Pool.render calls it
_MODES_OF_RENDER = [*_PICTURES, *(f"{mode}_list" for mode in _PICTURES)]


class _Named:
    """What Env and VectorEnv have in common."""

    worlds: Worlds
    metadata = {"render_modes": _MODES_OF_RENDER, "render_fps": 60}
    _spec: Any = None
    _kept: list[list[Array]] = []  # pictures of each world since render(), in the modes that end in _list

    def _begin(self, worlds: Worlds, render_mode: Optional[str], named: bool) -> tuple[Any, Any]:
        """Takes over the worlds; returns the spaces of one of them."""
        if render_mode is not None and render_mode not in _MODES_OF_RENDER:
            raise ArgumentError(f"render_mode: {render_mode!r} is none of None, {', '.join(map(repr, _MODES_OF_RENDER))}")
        if render_mode is not None and render_mode.endswith("_list"):
            self._kept = [[] for _ in range(worlds.pool.num_envs)]
        self.worlds, self.render_mode, self.named = worlds, render_mode, named
        self.fields, self.cost_names = worlds.fields, worlds.cost_names
        self.metadata = {"render_modes": _MODES_OF_RENDER, "render_fps": max(1, round(1 / worlds.seconds))}
        low, high = worlds.obs_low, worlds.obs_high
        obs: Any = Box(low, high, dtype=np.float32)
        if named:
            obs = {name: Box(low[at], high[at], dtype=np.float32) for name, at in self.fields.items()}
        elif worlds.senses:
            obs = {"state": obs}
        if isinstance(obs, dict):  # as pairs: Gymnasium sorts a dict by name
            obs = Dict(list({**({} if worlds.stateless else obs), **worlds.senses.spaces(Box)}.items()))
        return obs, Box(worlds.action_low, worlds.action_high, dtype=np.float32)

    @property
    def max_episode_steps(self) -> int:
        """Steps of a whole episode, which the worlds count themselves."""
        return self.worlds.max_episode_steps

    @property
    def spec(self) -> Any:  # type: ignore[override]
        """Gymnasium's spec with this environment's own max_episode_steps. The spec of the id has none, since make() would
        wrap the environment in a time limit of its own, while option max_steps can change the length of an episode."""
        return self._spec

    @spec.setter
    def spec(self, spec: Any) -> None:
        if spec is not None:
            spec = copy.copy(spec)
            spec.max_episode_steps = self.max_episode_steps
        self._spec = spec

    @property
    def pool(self) -> Pool:
        """The worlds as redman.Pool."""
        return self.worlds.pool

    @property
    def shield(self) -> Optional[Shield]:
        """The shield that checks every action, or None."""
        return self.worlds.shield

    @property
    def cost_limits(self) -> Array:
        """[cost_dim] limit on each cost's sum over an episode; NaN where there is none."""
        return np.array([c.limit for c in self.pool.costs.values()], np.float64)

    def _seen(self, rows: Array, env: Any = slice(None)) -> Any:
        """Observations in the form of the observation space, with what the worlds see."""
        if not self.named and not self.worlds.senses:
            return rows
        if self.worlds.stateless:
            return self.worlds.senses.seen(env)
        entries = {name: rows[..., at] for name, at in self.fields.items()} if self.named else {"state": rows}
        return {**entries, **self.worlds.senses.seen(env)}

    def _told(self) -> dict[str, Array]:
        """The entries of infos after a step, a row for each world."""
        w = self.worlds
        return {"cost": w.cost[:, 0].astype(np.float64), "costs": w.cost.copy(), "success": w.success.copy(),
                **{key: rows.astype(np.int64) for key, rows in self._flags().items()}, **w.shielded()}

    def _told_of(self, i: int) -> Info:
        """The same of one world."""
        w = self.worlds
        return {"cost": w.cost.item(i, 0), "costs": w.cost[i].copy(), "success": w.success.item(i),
                **{key: rows.item(i) for key, rows in self._flags().items()}, **shielded_of(w, i)}

    def _flags(self) -> dict[str, Array]:
        """What went wrong in each world."""
        return {"status": self.worlds.status, "episode_status": self.worlds.episode_status}

    def _began_of(self, i: int) -> Info:
        """The entries of infos after a reset: the same keys with empty values, but for what went wrong in the reset."""
        nothing = {key: np.zeros_like(value) if isinstance(value, np.ndarray) else type(value)()
                   for key, value in self._told_of(i).items()}
        return {**nothing, **{key: rows.item(i) for key, rows in self._flags().items()}}

    def _picture(self, i: int) -> Array:
        return self.worlds.render(i, _PICTURES[str(self.render_mode).removesuffix("_list")])

    def _pictured(self, i: int) -> Any:
        """The picture of a world, in the form of render_mode; in a mode that ends in _list, those since the last call."""
        if not self._kept:
            return self._picture(i)
        pictures, self._kept[i] = self._kept[i], []
        return pictures

    def _keep(self, mask: Optional[Array] = None) -> None:
        """Draws the worlds that were stepped or reset, where render() gives all pictures."""
        for i, pictures in enumerate(self._kept):
            if mask is None or mask[i]:
                pictures.append(self._picture(i))


class Env(_Named, _Env):
    """One world of a task.

        env = redman.gym.Env("ball_run", seed=7, action_repeat="task")
        obs, info = env.reset()
        for _ in range(20):
            obs, reward, terminated, truncated, info = env.step(env.action_space.sample())
            print(reward, info["cost"])
        env.close()

    task: its name (redman.tasks()) or a .task file. An observation is [obs_dim] float32, an action [action_dim] float32 in
    [-1, 1], or, with a center, in [-1 - |center|, 1 + |center|].
    seed: 0 to 2^64 - 1, used by the first reset() without a seed; None draws one from the system.
    options: of the task, a dict, as `redman tasks NAME` prints them.
    action_repeat: control steps of a step, 1 or more, whose rewards and costs are summed; "task": those of a decision of the
    task's own learner.
    center: what an action of 0 does, [action_dim] in [-1, 1]; "initial": the pose with which the task's own learner begins; None:
    the middle of the range of each joint.
    shield: True, or a dict of the options of a redman.Shield, its budgets, seed and threads; None: no shield. shield_policy: its
    first backup, a policy, its file or run folder, or "trained"; it must hold its actions for as many control steps as a step has.
    render_mode: what render() returns, "rgb_array", "depth_array", or those with "_list"; None: nothing. camera: its name; None: the
    task's first. width, height: of a picture, in pixels.
    named: observations are a dict with an entry for each field.
    observe: what an observation has, of "state", "rgb", "depth", "segmentation", "points" and "voxels", as a list or joined by +:
    option modality in other words. Without "state" it has no row.

    Errors: NotFoundError for a task, an option or a camera that does not exist, RangeError and ArgumentError for a value that
    is out of its range or has a wrong shape; each says what it may be.
    """

    def __init__(self, task: str, *, seed: Optional[int] = None, options: Optional[Mapping[str, Any]] = None,
                 render_mode: Optional[str] = None, camera: Optional[str] = None, width: int = 320, height: int = 240,
                 action_repeat: Union[int, str] = 1, center: Center = None, named: bool = False, shield: Shielding = None,
                 shield_policy: Optional[Backup] = None, observe: Observe = None) -> None:
        worlds = Worlds(task, 1, seed=seed, options=options, observe=observe, action_repeat=action_repeat, center=center,
                        camera=camera, width=width, height=height, shield=shield, shield_policy=shield_policy)
        self.observation_space, self.action_space = self._begin(worlds, render_mode, named)

    def reset(self, *, seed: Optional[int] = None, options: Optional[dict[str, Any]] = None) -> tuple[Any, Info]:
        """Begins a new episode and returns (observation, info).

        seed: 0 to 2^64 - 1, the episode of this seed; None: the next of the world's own stream. options: None or an empty
        dict, since the task's are given to Env; others raise ArgumentError."""
        self.worlds.no_options(options)
        seed = None if seed is None else whole(seed, "seed", 0, (1 << 64) - 1)
        super().reset(seed=seed)
        self.worlds.reset(seed if seed is None else [seed])
        self._keep()
        return self._seen(self.worlds.obs[0].copy(), 0), self._began_of(0)

    def step(self, action: Any) -> tuple[Any, float, bool, bool, Info]:
        """Makes a step and returns (observation, reward, terminated, truncated, info).

        action: [action_dim]; entries outside of [-1, 1] are clipped, and one that is not finite ends the episode. reward: the
        sum over the control steps. terminated: the episode ended by what happened in it; truncated: by its length, or as
        something went wrong (info["status"]). ArgumentError for another shape, StateError before the first reset and after
        an end."""
        w = self.worlds
        w.act_alone(action)
        w.pool.step()
        if self._kept:
            self._keep()
        return (self._seen(w.obs[0].copy(), 0), w.reward.item(0), w.terminated.item(0), w.truncated.item(0),
                self._told_of(0))

    def render(self) -> Any:
        """A picture [height][width][3] uint8 or depth [height][width] in m, 0 where there is nothing; None without a render_mode. With
        "rgb_array_list" and "depth_array_list", a list of those of all steps and resets since the last call."""
        return self._pictured(0) if self.render_mode else None

    def close(self) -> None:
        """Destroys the world; nothing else may be called afterwards."""
        self.worlds.close()
        super().close()


class VectorEnv(_Named, _VectorEnv):
    """num_envs worlds of a task, stepped together on `threads` threads.

        envs = redman.gym.VectorEnv("ball_run", 8, seed=7, action_repeat="task")
        obs, infos = envs.reset()                                               # [8][obs_dim]
        for _ in range(20):
            obs, reward, terminated, truncated, infos = envs.step(envs.action_space.sample())
            print(reward.mean(), infos["cost"].mean())
        envs.close()

    task, seed, options, action_repeat, center, named, shield, shield_policy, observe, render_mode, camera, width, height: as
    those of Env; world i begins with seed + i. Observations are [num_envs][obs_dim], actions [num_envs][action_dim].
    num_envs: worlds, 1 or more. threads: that step them; 0: as many as there are cores; results are the same for any number.
    max_episode_steps: what gymnasium.make_vec hands on: None, or the length that an episode has; option max_steps sets it.
    autoreset_mode: "NextStep", "SameStep", "Disabled" or Gymnasium's AutoresetMode; None: Gymnasium's default.
    copy: False returns the pool's observations, which the next call overwrites.

    In SameStep mode, info["cost"] of worlds whose episode ended is in info["final_info"], as in Gymnasium; the attributes
    cost [num_envs] and costs [num_envs][cost_dim] are those of the last step in every mode. SameStep refuses option
    modality, since the last pictures of an episode are overwritten by then.
    """

    _old = _OLD  # infos as Gymnasium 0.x has them

    def __init__(self, task: str, num_envs: int = 1, *, seed: Optional[int] = None,
                 options: Optional[Mapping[str, Any]] = None, threads: int = 0, autoreset_mode: Any = None,
                 copy: bool = True, render_mode: Optional[str] = None, camera: Optional[str] = None, width: int = 320,
                 height: int = 240, action_repeat: Union[int, str] = 1, center: Center = None,
                 named: bool = False, max_episode_steps: Optional[int] = None, shield: Shielding = None,
                 shield_policy: Optional[Backup] = None, observe: Observe = None) -> None:
        usual = "SameStep" if _OLD else "NextStep"
        mode = usual if autoreset_mode is None else getattr(autoreset_mode, "value", autoreset_mode)
        if not isinstance(mode, str) or mode not in _MODES:
            raise ArgumentError(f"autoreset_mode: {mode!r} is none of {', '.join(_MODES)}")
        worlds = Worlds(task, num_envs, seed=seed, autoreset=_MODES[mode], options=options, threads=threads,
                        action_repeat=action_repeat, center=center, camera=camera, width=width, height=height,
                        shield=shield, shield_policy=shield_policy, observe=observe,
                        senses=_NO_LAST_LOOK if mode == "SameStep" else "")
        if max_episode_steps not in (None, worlds.max_episode_steps):  # what make_vec hands on of a spec is our own
            raise ArgumentError(f"max_episode_steps: {max_episode_steps}, but an episode has {worlds.max_episode_steps} "
                                "steps; options={'max_steps': n} makes it n control steps")
        obs, action = self._begin(worlds, render_mode, named)
        num_envs = worlds.pool.num_envs
        if _OLD:
            _VectorEnv.__init__(self, num_envs, obs, action)
        else:
            self.num_envs, self.single_observation_space, self.single_action_space = num_envs, obs, action
            self.observation_space, self.action_space = batch_space(obs, num_envs), batch_space(action, num_envs)
        self.mode, self.copy = mode, copy
        self.metadata["autoreset_mode"] = AutoresetMode(mode)
        self._ended, self._all = np.zeros(num_envs, bool), np.ones(num_envs, bool)

    def reset(self, *, seed: Seeds = None, options: Optional[dict[str, Any]] = None) -> tuple[Any, Info]:
        """Begins new episodes, everywhere or where options["reset_mask"] [num_envs] is True, and returns (observations, infos).

        seed: an int s from 0 to 2^64 - 1, which means s + i for world i, or a list with one for each world; where it is None,
        worlds continue with the streams that they have. options: None, or a dict of reset_mask alone, an array of bool with
        at least one True; ArgumentError for others."""
        self.worlds.no_options(options, ("reset_mask",))
        mask = (options or {}).get("reset_mask")
        if mask is not None and not (isinstance(mask, np.ndarray) and mask.shape == (self.num_envs,)
                                     and mask.dtype == bool and mask.any()):
            raise ArgumentError(f"reset_mask: it must be an array of {self.num_envs} bool, at least one of them True")
        self.worlds.reset(seed, mask)
        self._ended = np.zeros(self.num_envs, bool) if mask is None else self._ended & ~mask
        began = np.ones(self.num_envs, bool) if mask is None else mask
        self._keep(mask)
        return self._observed(), self._rows(self._told_but(began), began)

    def step(self, actions: Any) -> tuple[Any, Array, Array, Array, Info]:
        """Makes a step and returns (observations, rewards, terminated, truncated, infos), each with a row or entry for each world.

        actions: [num_envs][action_dim]; entries outside of [-1, 1] are clipped. rewards: [num_envs], sums over the control
        steps. infos: arrays by name, each with a mask of the worlds that have an entry ("_cost" of "cost"). ArgumentError for
        another shape, StateError before the first reset."""
        w = self.worlds
        w.act(actions)
        w.pool.step()
        if self._kept:
            self._keep()
        was_ended, self._ended = self._ended, w.terminated | w.truncated
        return (self._observed(), w.reward.astype(np.float64), w.terminated.copy(), w.truncated.copy(),
                self._infos(was_ended))

    @property
    def cost(self) -> Array:
        """[num_envs] the task's cost of the last step."""
        return np.array(self.worlds.cost[:, 0])

    @property
    def costs(self) -> Array:
        """[num_envs][cost_dim] all costs of the last step."""
        return np.array(self.worlds.cost)

    def _observed(self) -> Any:
        return self._seen(self.worlds.obs.copy() if self.copy else self.worlds.obs)

    def _told_but(self, began: Array) -> dict[str, Array]:
        """The rows of infos, with those of a reset for worlds that have begun a new episode."""
        told = self._told()
        if not began.any():
            return told
        for key, values in told.items():
            if self.mode == "SameStep" or key not in self._flags():  # else those rows are the reset's own
                values[began] = "" if values.dtype == object else 0
        return told

    def _infos(self, was_ended: Array) -> dict[str, Any]:
        """Infos in the form of Gymnasium's SyncVectorEnv."""
        ended = self._ended
        infos: Info = {}
        began = np.zeros(self.num_envs, bool)
        if self.mode == "NextStep":
            began = was_ended
        elif self.mode == "SameStep" and ended.any():
            began = ended
            final_obs = "final_observation" if self._old else "final_obs"
            final_rows = self.worlds.final_obs.copy()
            infos[final_obs] = _objects(ended, lambda i: self._seen(final_rows[i]))
            told = self._told()
            infos["final_info"] = _objects(ended, self._told_of) if self._old else self._rows(told, ended)
            infos["_" + final_obs], infos["_final_info"] = ended.copy(), ended.copy()
        infos.update(self._rows(self._told_but(began), self._all))
        return infos

    def _rows(self, told: dict[str, Array], here: Array) -> Info:
        """The rows with a mask of the worlds that have one; 0 or None elsewhere."""
        rows: Info = {}
        everywhere, told_of = bool(here.all()), here.copy()
        for key, values in told.items():
            if (self._old and values.ndim > 1) or values.dtype == object:
                rows[key] = _objects(here, lambda i, values=values: values[i])
            else:
                rows[key] = values if everywhere else np.where(here.reshape(-1, *[1] * (values.ndim - 1)), values,
                                                               values.dtype.type(0))
            rows["_" + key] = told_of
        return rows

    def step_async(self, actions: Any) -> None:
        """With step_wait(), the two halves of a step that wrappers of Gymnasium 0.x call. actions: as those of step."""
        self._actions = actions

    def step_wait(self, **_: Any) -> Any:
        """Makes the step of step_async() and returns what step() returns."""
        return self.step(self._actions)

    def reset_async(self, seed: Seeds = None, options: Optional[dict[str, Any]] = None) -> None:
        """With reset_wait(), the two halves of a reset that wrappers of Gymnasium 0.x call. seed, options: as those of reset."""

    def reset_wait(self, seed: Seeds = None, options: Optional[dict[str, Any]] = None) -> Any:
        """reset(). seed, options: as those of reset."""
        return self.reset(seed=seed, options=options)

    def render(self) -> Optional[tuple[Any, ...]]:
        """A picture of each world, or None without a render_mode; in the modes that end in _list, a list for each world."""
        return tuple(self._pictured(i) for i in range(self.num_envs)) if self.render_mode else None

    def close_extras(self, **_: Any) -> None:
        """Destroys the worlds; close() of Gymnasium calls it."""
        if hasattr(self, "worlds"):  # it is also called for what was never made
            self.worlds.close()

    def __enter__(self) -> VectorEnv:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


def shielded_of(worlds: Worlds, i: int) -> Info:
    """The entries of infos about the shield in one world."""
    return {key: rows[i].copy() if rows.ndim > 1 else rows.item(i) for key, rows in worlds.shielded().items()}


def _objects(where: Array, make: Any) -> Array:
    """An array of objects: make(world) where the mask is true, else None."""
    out = np.full(len(where), None, object)
    for i in np.flatnonzero(where):
        out[i] = make(i)
    return out


def camel(task: str) -> str:
    """The name of a task as ids have it.

        redman.gym.camel("hand_over_safe_finger")       # HandOverSafeFinger

    task: its name.
    """
    return "".join(word.capitalize() for word in task.split("_"))


def env_id(task: str) -> str:
    """The id under which Gymnasium has a task.

        redman.gym.env_id("ball_run")                   # redman/BallRun-v0

    task: its name.
    """
    return f"redman/{camel(task)}-v0"


def register() -> None:
    """Gives Gymnasium an id for every task; importing this module does it. Call it again for tasks that were added since, such as
    those of redman.load_task. ImportError without Gymnasium.

        redman.gym.register()
    """
    if gymnasium is None:
        raise ImportError("redman.gym.register: Gymnasium is not installed; Env and VectorEnv work without it")
    for task in tasks():
        if env_id(task) not in gymnasium.registry:
            gymnasium.register(env_id(task), entry_point="redman.gym:Env", kwargs={"task": task},
                               vector_entry_point=_vector_entry(task) if _OLD else "redman.gym:VectorEnv")


def _vector_entry(task: str) -> Any:
    """Needed because make_vec of Gymnasium 0.x does not pass the spec on."""
    def make(num_envs: int = 1, max_episode_steps: Optional[int] = None, **kwargs: Any) -> VectorEnv:
        return VectorEnv(task, num_envs, max_episode_steps=max_episode_steps,
                         **{k: v for k, v in kwargs.items() if k != "task"})
    return make


if not TYPE_CHECKING:

    def __getattr__(name: str) -> Any:
        """For names of Gymnasium, the error says what to write instead."""
        said = {"make": "redman.make(task)", "make_vec": "redman.make_vec(task, num_envs)", "VecEnv": "redman.gym.VectorEnv"}.get(name)
        raise AttributeError(f"redman.gym.{name}: {said or 'there is no such name' + nearest(name, __all__)}")


if gymnasium is not None:
    register()
