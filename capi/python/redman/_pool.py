"""Pool: worlds of one task, stepped together."""
from __future__ import annotations

import ctypes
import math
import operator
import os
import threading
from ctypes import byref, c_size_t, c_uint64
from functools import cached_property
from typing import TYPE_CHECKING, Any, ContextManager, Iterable, Iterator, Mapping, Optional, Sequence, Union

import numpy as np

from . import _abi, _discovery, _png
from ._abi import Autoreset, BaselineKind
from ._error import ArgumentError, Error, NotFoundError, StateError, UsageError
from ._html import image, number, table
from ._hold import LAST, Watch
from ._library import (Handle, assign, check, encoded, failure, filled, instance, int32, lib, raised, raw, real, sized, text,
                       whole)
from ._names import Hinted, keywords, nearest, one_of
from ._options import Options, Told, Value, as_dict, read_settings, settings_of
from ._paths import by_name, named_options
from ._returned import Returned
from ._rows import Array, Borrowed, DoubleArray, FloatArray, address, given, made, shape_of
from ._spaces import box

if TYPE_CHECKING:
    import numpy.typing as npt

    from ._episode import Episode
    from ._ranks import Ranks
    from ._recording import Recording

_AUTORESET = {"samestep": Autoreset.SAME_STEP, "nextstep": Autoreset.NEXT_STEP,
              "off": Autoreset.OFF, "disabled": Autoreset.OFF}
_AUTORESET_NAMES = ("same_step", "next_step", "off")
_BASELINE = {"zero": BaselineKind.ZERO, "hold": BaselineKind.HOLD, "random": BaselineKind.RANDOM}
_FLOAT = np.dtype(np.float32)
_LOOKS = {"fine": _abi.Look.FINE, "plain": _abi.Look.PLAIN}
_PICTURE = {"rgb": ("uint8", (3,)), "depth": ("float32", ()), "segmentation": ("int32", ())}

_step = lib["rdm_pool_step"]  # a function of its own, for the one call that is made a million times
_step.argtypes = [ctypes.c_void_p]


def _autoreset(mode: object) -> int:
    """same_step, next_step, off; also Gymnasium's SameStep, NextStep, Disabled and its enum."""
    named = str(getattr(mode, "value", mode)).lower().replace("_", "").replace("-", "")
    if named not in _AUTORESET:
        raise ArgumentError(f"autoreset: {mode!r} is none of same_step, next_step, off")
    return _AUTORESET[named]


def _struct(own: Mapping[str, Any]) -> _abi.rdm_pool_config:
    """The config struct from plain values."""
    config = sized(_abi.rdm_pool_config)
    check(lib.rdm_pool_config_init(byref(config), ctypes.sizeof(config)))
    config.task = encoded(_discovery.task_name(own["task"]), "task")
    assign(config, {"num_envs": own["num_envs"], "seed": own["seed"], "num_threads": own["threads"]})
    config.autoreset = _autoreset(own["autoreset"])
    config.settings = settings_of(named_options(own["options"]), _kinds(own["task"]) if own["options"] else {})
    return config


def _kinds(task: str) -> dict[str, int]:
    """The kind of each option of a task."""
    return {key: option.kind for key, option in _discovery.task(task).options.items()}


def memory(task: _discovery.TaskName, num_envs: int = 1, options: Optional[Options] = None) -> tuple[int, int]:
    """Bytes that a pool of num_envs worlds of a task with these options would take: by the library, exact, and by the physics engine,
    an estimate. No world is made."""
    config = _struct({"task": _discovery.task_name(task), "num_envs": num_envs, "seed": 0, "threads": 0, "autoreset": "same_step",
                      "options": as_dict(options)})
    ours, engines = c_size_t(), c_size_t()
    check(lib.rdm_pool_config_memory(byref(config), byref(ours), byref(engines)))
    return ours.value, engines.value


def spec(task: _discovery.TaskName, options: Optional[Options] = None) -> _abi.Spec:
    """The sizes that a pool with these options would have; makes the task for a moment and no world."""
    config = _struct({"task": _discovery.task_name(task), "num_envs": 1, "seed": 0, "threads": 0, "autoreset": "same_step",
                      "options": as_dict(options)})
    return _abi.Spec(filled(_abi.rdm_spec, lib.rdm_pool_config_spec, byref(config)))


def check_task(task: _discovery.TaskName, options: Optional[Options] = None) -> None:
    """Tests what a task must promise: the same bytes for the same seed, for any number of threads and after a saved state, rows
    within their fields and bounds, costs of 0 or more. ArgumentError names function, step and entry of the first broken
    promise. Takes seconds; for .task files and tasks of your own. options: those of the task that is tried."""
    name = _discovery.task_name(task)
    settings = settings_of(named_options(as_dict(options)), _kinds(name) if options else {})
    check(lib.rdm_task_check(encoded(name, "task"), settings, _abi.rdm_stop(0), None, None, 0))


class Guard(_abi.Guard):
    """A half space of actions, normal . action <= bound: the cost of its column, called `cost`, is 0 in each step as long as
    all guards of that column are kept. entry: the only entry of normal that is not 0, None where there are several."""

    entry: Optional[int]  # type: ignore[assignment]
    cost: str
    normal: tuple[float, ...]  # [action_dim]

    def __init__(self, struct: _abi.rdm_guard, normal: FloatArray, costs: Sequence[str]) -> None:
        super().__init__(struct)
        self.__dict__.update(entry=None if struct.entry < 0 else struct.entry, cost=costs[struct.column],
                             normal=tuple(map(float, normal)))


class Sensors(Hinted):
    """Pictures, clouds and voxels of the worlds (option modality): arrays in the library's memory, None where a modality is off."""

    rgb: Optional[npt.NDArray[np.uint8]]
    depth: Optional[FloatArray]
    segmentation: Optional[npt.NDArray[np.int32]]
    points: Optional[FloatArray]
    point_shape: Optional[npt.NDArray[np.int32]]
    point_count: Optional[npt.NDArray[np.int32]]
    point_class: Optional[npt.NDArray[np.uint8]]
    point_color: Optional[npt.NDArray[np.uint8]]
    voxels: Optional[npt.NDArray[np.int8]]
    voxel_size: float
    cameras: list[_discovery.Camera]  # of the pictures
    cloud_cameras: list[_discovery.Camera]  # of points and voxels

    def __init__(self, handle: Handle, num_envs: int) -> None:
        s = filled(_abi.rdm_sensors, lib.rdm_pool_get_sensors, handle.value)
        self.voxel_size = s.voxel_size
        lengths = {"num_envs": num_envs, "num_cameras": s.num_cameras, "height": s.height, "width": s.width,
                   "num_points": s.num_points, "num_voxels": s.num_voxels}
        for name, rows in _abi.ROWS["rdm_sensors"].items():
            at = getattr(s, name)
            setattr(self, name, Borrowed(at, rows.dtype, shape_of(rows, lengths), handle).array() if at else None)
        self.cameras, self.cloud_cameras = (list(self._cameras(handle, cloud)) for cloud in (0, 1))

    @staticmethod
    def _cameras(handle: Handle, cloud: int) -> Iterator[_discovery.Camera]:
        row = sized(_abi.rdm_camera_info)
        i = 0
        while not lib.rdm_pool_sensor_camera_at(handle.value, cloud, i, byref(row)):
            yield _discovery.Camera(row)
            i += 1


class Pool(Hinted):
    """N worlds of one task.

        pool = redman.Pool("hand_over_safe_finger", num_envs=16, seed=7)
        pool.reset()
        for _ in range(75):
            pool.baseline("hold")           # or write pool.action, or pool.step(action)
            pool.step()
        print(pool.episode_return, pool.cost)

    Rows (obs, action, reward, cost, ...) are views of memory that reset and step overwrite: copy what you want to keep. They
    stay valid after the pool is closed. One thread at a time uses a pool; others wait. Options are a dict (`pool.options`
    has all); the files of a robot (my.urdf) and an object (mug.object) stand for the names of those in them.
    task: a name, redman.task(name), a .task file, a class of your own (redman.Task), or an id of Gymnasium's. num_envs: worlds, 1
    or more. seed: 0 to 2^64 - 1, of the worlds' own streams. threads: 0 or 1: the caller's thread only; the bytes are the same
    for any number.
    autoreset: what a step does with worlds that ended: "same_step" begins the next episode in it, "next_step" in the step
    that follows, "off" leaves it to reset(mask=...). ranks: this pool has the worlds of one process of several
    (redman.Ranks).

    env, of the methods, is the number of a world, from 0; RangeError for another. Points and vectors are [3], world axes.
    """

    _hints = {
        "close_all": "close()", "num_actions": "action_dim", "num_obs": "obs_dim", "dones": "terminated, truncated",
        "done": "terminated | truncated", "rewards": "reward", "infos": "cost, success, status are rows of the pool",
        "info": "cost, success, status are rows of the pool", "observations": "obs", "actions": "action",
        "get_state": "state(env)", "dt": "control_dt"}
    _lost: Optional[str] = None  # why a copy has no worlds
    _set_option = "Pool(task, {}=...)"

    spec: _abi.Spec
    task: _discovery.TaskInfo
    num_envs: int
    obs_dim: int
    action_dim: int
    cost_dim: int
    max_steps: int  # control steps of an episode
    control_dt: float  # s

    @keywords(aliases={"envs": "num_envs", "num_threads": "threads"}, options=True)
    def __init__(self, task: _discovery.TaskName, num_envs: int = 1, seed: int = 0, threads: int = 0, autoreset: object = "same_step",
                 options: Optional[Options] = None, *, ranks: Optional[Ranks] = None) -> None:
        self._lock = threading.RLock()
        self._config: dict[str, Any] = {
            "task": _discovery.task_kept(task), "num_envs": num_envs, "seed": seed, "threads": threads,
            "autoreset": _AUTORESET_NAMES[_autoreset(autoreset)], "options": by_name(as_dict(options)),
            "ranks": ranks}
        config = _struct(self._config)
        self._handle: Optional[Handle] = Handle(lib.rdm_pool_create, lib.rdm_pool_destroy, byref(config))
        self._p = self._handle.value
        self._spec = filled(_abi.rdm_spec, lib.rdm_pool_get_spec, self._p)
        self.spec = _abi.Spec(self._spec)
        self.task = _discovery.task_at(self.spec.task)
        self.num_envs = config.num_envs
        self.obs_dim, self.action_dim, self.cost_dim = self.spec.obs_dim, self.spec.action_dim, self.spec.cost_dim
        self.max_steps, self.control_dt = self.spec.max_steps, self.spec.control_dt
        self._lengths = {"num_envs": self.num_envs, "obs_dim": self.obs_dim, "action_dim": self.action_dim,
                         "cost_dim": self.cost_dim}
        self._rows = made(_abi.ROWS["rdm_buffers"], self._lengths)
        buffers = sized(_abi.rdm_buffers)
        for name, array in self._rows.items():
            setattr(buffers, name, array.ctypes.data)
        check(lib.rdm_pool_set_buffers(self._p, byref(buffers)))
        self._action = self._rows["action"]
        self._obs = self._rows["obs"]
        self._of_reset, self._of_step = (Returned.of(self._obs, call) for call in ("reset", "step"))
        self._watch = Watch()
        self._begun = False  # whether an episode was begun by reset, set_state or copy
        self._starts: tuple[Optional[Recording], float] = (None, 0.0)
        if ranks is not None:
            from ._ranks import Ranks
            instance(ranks, Ranks, "ranks")
            check(lib.rdm_pool_set_rank(self._p, ranks.rank, ranks.ranks))

    # ---- rows -------------------------------------------------------------------------------------------------

    @property
    def obs(self) -> FloatArray:
        """[num_envs][obs_dim] the present observations."""
        return self._obs

    @property
    def final_obs(self) -> FloatArray:
        """[num_envs][obs_dim] the last observation where an episode ended, else as obs."""
        return self._rows["final_obs"]

    @property
    def action(self) -> FloatArray:
        """[num_envs][action_dim] actions in [-1, 1] for the next step; assignment copies."""
        return self._action

    @action.setter
    def action(self, value: Any) -> None:
        self._write_action(value)

    @property
    def reward(self) -> FloatArray:
        """[num_envs] reward of the last step, summed over its control steps."""
        return self._rows["reward"]

    @property
    def cost(self) -> FloatArray:
        """[num_envs][cost_dim] costs of the last step, not below 0, summed over its control steps; column 0 is the task's own."""
        return self._rows["cost"]

    @property
    def cost_raw(self) -> FloatArray:
        """[num_envs][cost_dim] the measured value behind each cost."""
        return self._rows["cost_raw"]

    @property
    def episode_return(self) -> FloatArray:
        """[num_envs] sum of rewards; the finished episode's where one ended."""
        return self._rows["episode_return"]

    @property
    def episode_cost(self) -> FloatArray:
        """[num_envs][cost_dim] likewise."""
        return self._rows["episode_cost"]

    @property
    def episode_step(self) -> npt.NDArray[np.int32]:
        """[num_envs] control steps, likewise."""
        return self._rows["episode_step"]

    @property
    def status(self) -> npt.NDArray[np.uint32]:
        """[num_envs] bits of the last step or reset, redman.Status: 1 contacts were left out, 2 diverged, 4 bad action, 8
        the task failed, 16 the contact solver did not converge, 32 a body was slowed."""
        return self._rows["status"]

    @property
    def episode_status(self) -> npt.NDArray[np.uint32]:
        """[num_envs] all bits of the episode so far; the finished one's where one ended."""
        return self._rows["episode_status"]

    @property
    def terminated(self) -> npt.NDArray[np.bool_]:
        """[num_envs] the task ended (a fall)."""
        return self._rows["terminated"].view(np.bool_)

    @property
    def truncated(self) -> npt.NDArray[np.bool_]:
        """[num_envs] ended by the time limit or a bad status."""
        return self._rows["truncated"].view(np.bool_)

    @property
    def success(self) -> npt.NDArray[np.bool_]:
        """[num_envs] the task's success holds in this step."""
        return self._rows["success"].view(np.bool_)

    # ---- stepping ---------------------------------------------------------------------------------------------

    def _fail(self, code: int) -> Error:
        if self._lost:
            return NotFoundError(self._lost)
        if self._p is None:
            return StateError("pool: it was closed")
        return failure(code)

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> Any:
            if self._lost and not name.startswith("__"):
                raise NotFoundError(self._lost)
            return super().__getattr__(name)

    def _check(self, code: int) -> None:
        if code:
            raise self._fail(code)
        check(code)

    def watch(self, action: Any, centered: bool = False) -> None:
        """Warns when an action comes directly from a policy at each of several steps, during which one action should be held.
        centered: these worlds add their center to it."""
        if LAST.array is not None:
            rows = self._rows
            ended = rows["terminated"][0] or rows["truncated"][0]  # the row is then the finished episode's
            self._watch.look(action, -1 if ended else int(rows["episode_step"][0]), self.spec.action_repeat, centered)

    def _write_action(self, action: Any) -> None:
        self.watch(action)
        try:
            if type(action) is np.ndarray and action.dtype is _FLOAT:
                self._action[...] = action  # a third of what copyto takes, and casts nothing here
            else:
                np.copyto(self._action, action)
        except (TypeError, ValueError):
            rows = _abi.ROWS["rdm_buffers"]["action"]
            np.copyto(self._action, given(action, rows, self._lengths, "action", spread=True))

    def _mask(self, mask: Any) -> Optional[Array]:
        return None if mask is None else given(
            mask, _abi.FUNCTIONS["rdm_pool_reset"].rows["mask"], self._lengths, "mask", spread=True)

    @keywords(aliases={"seed": "seeds"}, hints={"options": "options are those of the pool: Pool(task, options={...})"})
    def reset(self, seeds: Union[None, int, Sequence[int], Array] = None, mask: Any = None) -> FloatArray:
        """Starts new episodes where mask holds (None: everywhere) and returns obs.

        seeds: one for each world, which determine the episodes; a single seed means seed, seed + 1, ...; None continues the
        worlds' own streams.
        """
        rows = None
        if seeds is not None:
            try:
                first = operator.index(seeds)  # type: ignore[arg-type]
                listed = list(range(first, first + self.num_envs))
            except TypeError:
                try:
                    listed = [operator.index(seed) for seed in seeds]  # type: ignore[union-attr]
                except TypeError:
                    raise UsageError(f"seeds: it must be a whole number, a list with one for each world, or None, not {seeds!r}") from None
            wrong = [seed for seed in listed if not 0 <= seed < 1 << 64]
            if wrong:
                raise ArgumentError(f"seeds: {wrong[0]} is not between 0 and 2^64 - 1")
            table = _abi.FUNCTIONS["rdm_pool_reset"].rows["seeds"]
            rows = given(np.array(listed, np.uint64), table, self._lengths, "seeds")
        chosen = self._mask(mask)
        with self._lock:
            self._check(lib.rdm_pool_reset(self._p, address(rows), address(chosen)))
            self._begun = True
        return self._of_reset

    def step(self, action: Any = None, mask: Any = None) -> FloatArray:
        """One step of every world (or of those where mask is true), of as many control steps as option action_repeat says;
        returns obs.

        action is written to pool.action first; None uses what is there. A single row [action_dim] is for all worlds, and a number
        for all entries. To play a policy, use policy.actor(pool), which
        holds its actions: pool.step(actor()).
        """
        if action is not None and action is not self._action:
            self._write_action(action)
        if mask is None:
            with self._lock:
                code = _step(self._p)
        else:
            chosen = self._mask(mask)
            with self._lock:
                code = lib.rdm_pool_step_masked(self._p, address(chosen))
        if code or raised:
            self._check(code)
        return self._of_step

    def baseline(self, kind: str = "hold") -> FloatArray:
        """Fills pool.action with the actions of a simple baseline, kind "zero", "hold" or "random", and returns it."""
        chosen = one_of(kind, _BASELINE, "kind")
        with self._lock:
            self._check(lib.rdm_pool_baseline(self._p, chosen))
        return self._action

    # ---- state ------------------------------------------------------------------------------------------------

    def state(self, env: int = -1) -> bytes:
        """The complete state of one world, or of all (env -1)."""
        with self._lock:
            size = c_size_t()
            self._check(lib.rdm_pool_write_state(self._p, int32(env, "env"), None, 0, byref(size)))
            raw = ctypes.create_string_buffer(size.value)
            self._check(lib.rdm_pool_write_state(self._p, env, raw, size, byref(size)))
            return raw.raw

    def set_state(self, state: bytes, env: int = -1) -> None:
        """Continues from state(), with the same bytes. Rewrites obs and clears the other rows of that world. env -1: the state
        is that of all worlds. FormatError for bytes of other worlds."""
        data = raw(state, "state")
        with self._lock:
            self._check(lib.rdm_pool_read_state(self._p, int32(env, "env"), data, len(data)))
            self._begun = True

    def set_starts(self, recording: Optional[Recording], share: float) -> None:
        """From the next reset on, worlds begin an episode with probability share (0 to 1) at a state of the recording, which
        has states if it was made from a pool; None: keeps the states of the last call, with another share. Such an episode
        has only the steps that were left of the recorded one. All other random numbers are the same as without."""
        from ._recording import Recording
        if recording is not None:
            instance(recording, Recording, "recording")
        share = real(share, "share")
        with self._lock:
            self._check(lib.rdm_pool_set_starts(self._open(), None if recording is None else recording._handle.value, share))
            self._starts = (self._starts[0] if recording is None else recording, share)

    def hash(self, env: int = -1) -> str:
        """The hash of the state of one world, or of all (env -1), as the tool prints it: 16 hexadecimal digits."""
        out = c_uint64()
        with self._lock:
            self._check(lib.rdm_pool_get_hash(self._p, int32(env, "env"), byref(out)))
        return f"{out.value:016x}"

    # ---- what a world shows -----------------------------------------------------------------------------------

    @property
    def cameras(self) -> dict[str, _discovery.Camera]:
        """All cameras of this pool: the task's, those on its robots, and those for clouds."""
        return self._cameras.copy()

    @cached_property
    def _cameras(self) -> _discovery.Named[_discovery.Camera]:
        return _discovery.Named(_discovery.all_of(_discovery.Camera, _abi.rdm_camera_info, lib.rdm_pool_camera_at, self._open()),
                                "camera", self.task.name)

    def render(self, env: int = 0, camera: Optional[str] = None, width: int = 320, height: int = 240,
               what: str = "rgb", *, num_envs: int = 1, look: str = "fine") -> Array:
        """A picture of one world. what: "rgb" [height][width][3] bytes; "depth" [height][width] in m, 0 where nothing is;
        "segmentation" [height][width], the number of a shape or -1. camera: its name; None: the task's first. width, height:
        pixels, 1 to 8192.

        num_envs: worlds side by side in one scene, from env on, with the camera moved back until all are in sight; shape i of
        world env + k is k * len(shapes) + i. look: "fine", for people, or "plain", as observations look, in half the time."""
        if isinstance(env, (str, os.PathLike)):
            raise UsageError(f"render(env={env!r}): env is the number of a world, and the picture is returned as an array. To write a "
                             "file: with pool.record() as episode: ..., then episode.render(path)")
        if camera is None:
            camera = next(iter(self.task.cameras), "")
        dtype, tail = one_of(what, _PICTURE, "what")
        picture = sized(_abi.rdm_picture)
        picture.env, picture.num_envs = int32(env, "env"), int32(num_envs, "num_envs")
        picture.width, picture.height = int32(width, "width"), int32(height, "height")
        picture.look, picture.camera = one_of(look, _LOOKS, "look"), encoded(camera, "camera")
        fits = 1 <= picture.width <= 8192 and 1 <= picture.height <= 8192  # if not, the call says so
        out = np.empty((picture.height, picture.width, *tail) if fits else 0, dtype)
        setattr(picture, what, out.ctypes.data)
        with self._lock:
            self._check(lib.rdm_pool_draw(self._p, byref(picture)))
        return out

    def _repr_png_(self) -> Optional[bytes]:
        """Up to sixteen worlds side by side, for a notebook."""
        try:
            return _png.encode(self.render(num_envs=min(16, self.num_envs), width=640, height=400))
        except Error:
            return None

    def _repr_html_(self) -> Optional[str]:
        """The same, above the numbers of these worlds; None before the first reset."""
        picture = self._repr_png_()
        if self._p is None or not self._begun:
            return None
        limits = [cost.limit for cost in self.costs.values()]
        heads = ["world", "step", "return"] + [name if limit is None else f"{name} (limit {number(limit)})"
                                               for name, limit in zip(self.cost_names, limits)] + ["success"]
        rows = [[str(i), str(self.episode_step[i]), number(float(self.episode_return[i])),
                 *(number(float(cost)) for cost in self.episode_cost[i]), "yes" if self.success[i] else ""]
                for i in range(min(16, self.num_envs))]
        drawn = "" if picture is None else f"<div>{image('png', picture)}</div>"
        shown = f", the first {len(rows)}" if len(rows) < self.num_envs else ""
        return drawn + table(heads, rows, f"{self.task.name}: {self.num_envs} worlds{shown}")

    def record(self, env: int = 0, actor: str = "python") -> ContextManager[Episode]:
        """Records what is done with one world, until its episode ends: a redman.Episode, which draws itself.

            with pool.record() as episode:
                for _ in range(75):
                    pool.step(actor())
            episode.render("throw.html")

        It records step() and reset() of this object, not Agent.rollout. With autoreset "same_step" the last frame is missing, as
        the step that ends an episode begins the next one."""
        from ._episode import record
        return record(self, range(self.num_envs)[whole(env, "env", -self.num_envs, self.num_envs - 1)], actor)

    @property
    def shapes(self) -> list[_discovery.Shape]:
        """The shapes of the scene, the same for all worlds; kind is a redman.ShapeKind."""
        return list(self._shapes)

    @cached_property
    def _shapes(self) -> list[_discovery.Shape]:
        return [_discovery.Shape(filled(_abi.rdm_shape_info, lib.rdm_pool_shape_at, self._open(), i))
                for i in range(self.spec.num_shapes)]

    def _open(self) -> int:
        if self._p is None:
            raise self._fail(0)
        return self._p

    def poses(self, env: int = 0) -> DoubleArray:
        """[num_shapes][7] position (m) and quaternion (x, y, z, w) of each shape of one world."""
        out = np.empty((self.spec.num_shapes, 7))
        with self._lock:
            self._check(lib.rdm_pool_get_poses(self._p, int32(env, "env"), out.ctypes.data))
        return out

    def hull(self, shape: int) -> FloatArray:
        """[count][3] corners of a shape that is a hull, in its own frame, m. shape: its number in pool.shapes."""
        count = c_size_t()
        self._check(lib.rdm_pool_get_hull(self._open(), int32(shape, "shape"), None, 0, byref(count)))
        out = np.empty((count.value, 3), np.float32)
        self._check(lib.rdm_pool_get_hull(self._p, shape, out.ctypes.data, len(out), byref(count)))
        return out

    @property
    def joints(self) -> list[_discovery.Joint]:
        """The joints of all robots of a world, the same for all worlds."""
        return list(self._joints)

    @cached_property
    def _joints(self) -> list[_discovery.Joint]:
        return [_discovery.Joint(filled(_abi.rdm_joint_info, lib.rdm_pool_joint_at, self._open(), i))
                for i in range(self.spec.num_joints)]

    def joint_positions(self, env: int = 0) -> Array:
        """[num_joints] positions of the joints of one world, rad (m)."""
        return self._joint_row(env, 0)

    def joint_velocities(self, env: int = 0) -> Array:
        """[num_joints] velocities of the joints, rad/s (m/s)."""
        return self._joint_row(env, 1)

    def _joint_row(self, env: int, which: int) -> Array:
        out = np.empty(self.spec.num_joints)
        rows: list[Optional[int]] = [None, None]
        rows[which] = out.ctypes.data
        with self._lock:
            self._check(lib.rdm_pool_get_joints(self._p, int32(env, "env"), *rows, len(out)))
        return out

    def set_joints(self, env: int, q: Optional[npt.ArrayLike] = None, qd: Optional[npt.ArrayLike] = None) -> None:
        """Sets positions q and velocities qd [num_joints] of the joints of one world, rad and rad/s (m and m/s); None:
        unchanged. NaN for a coupled joint: what follows from the joint that it is coupled to.

        Rewrites obs and clears the other rows of that world, as set_state does."""
        kinds, lengths = _abi.FUNCTIONS["rdm_pool_set_joints"].rows, {"count": self.spec.num_joints}
        rows = [None if row is None else given(row, kinds[name], lengths, name) for name, row in (("q", q), ("qd", qd))]
        with self._lock:
            self._check(lib.rdm_pool_set_joints(self._p, int32(env, "env"),
                                                *(None if row is None else row.ctypes.data for row in rows),
                                                self.spec.num_joints))

    def set_limit(self, limit: float, env: int = -1) -> None:
        """Gives the episode that runs in a world, -1: in every world, another cost limit, between the ends of option limit_range.

        What is left of the budget changes by as much, and obs shows both. The next episode draws its limit, or has that of
        option limit."""
        with self._lock:
            self._check(lib.rdm_pool_set_limit(self._p, int32(env, "env"), real(limit, "limit")))

    def raycast(self, env: int, origin: Sequence[float], direction: Sequence[float],
                range: float = math.inf) -> Optional[_abi.RayHit]:
        """The nearest shape that a ray from origin, m, along direction hits within `range` m, with distance, point and normal;
        None if there is none. direction need not have length 1."""
        kinds = _abi.FUNCTIONS["rdm_pool_raycast"].rows
        rows = [given(row, kinds[name], {}, name) for name, row in (("origin", origin), ("direction", direction))]
        hit = sized(_abi.rdm_ray_hit)
        with self._lock:
            self._check(lib.rdm_pool_raycast(self._p, int32(env, "env"), *(row.ctypes.data for row in rows),
                                             real(range, "range"), byref(hit)))
        return None if hit.shape < 0 else _abi.RayHit(hit)

    def contacts(self, env: int = 0) -> Array:
        """Contact points of the last substep: rows of shape_a, shape_b, position, normal, force, depth."""
        out = np.empty(0, np.dtype(_abi.rdm_contact))
        count = c_size_t()
        with self._lock:
            while True:
                rows = out.ctypes.data_as(ctypes.POINTER(_abi.rdm_contact))
                self._check(lib.rdm_pool_get_contacts(self._p, int32(env, "env"), rows, len(out), byref(count)))
                if count.value <= len(out):
                    return out[:count.value]
                out = np.empty(count.value, out.dtype)

    def push(self, env: int, shape: Union[int, str], force: Sequence[float]) -> None:
        """Pushes the body or link that has a shape during the next step: force in N (world axes) at its centre of mass. shape:
        its number or name."""
        if isinstance(shape, str):
            names = [row.name for row in self._shapes]
            if shape not in names:
                raise ArgumentError(f"shape: {shape!r} is none of this scene's{nearest(shape, names)}")
            shape = names.index(shape)
        rows = given(force, _abi.FUNCTIONS["rdm_pool_push"].rows["force"], self._lengths, "force")
        with self._lock:
            self._check(lib.rdm_pool_push(self._p, int32(env, "env"), int32(shape, "shape"), rows.ctypes.data))

    @property
    def sensors(self) -> Sensors:
        """Pictures, clouds and voxels (option modality): arrays in the library's own memory, which they keep alive."""
        self._open()
        assert self._handle is not None
        return Sensors(self._handle, self.num_envs)

    def world_error(self, env: int) -> str:
        """The last failure in one world of a task of your own: "world 3: task press: judge: sensor lost"; "" at first."""
        return text(lib.rdm_pool_world_error(self._open(), int32(env, "env")))

    @property
    def stats(self) -> _abi.PoolStats:
        """Counts of contacts, joint drift and failed worlds so far."""
        return _abi.PoolStats(filled(_abi.rdm_pool_stats, lib.rdm_pool_get_stats, self._open()))

    # ---- what it is -------------------------------------------------------------------------------------------

    @property
    def fields(self) -> dict[str, _discovery.Field]:
        """What each entry of obs means, with this pool's options."""
        return self._fields.copy()

    @cached_property
    def _fields(self) -> _discovery.Named[_discovery.Field]:
        return _discovery.fields_of(self._open(), self.task.name, self.spec.num_fields, lib.rdm_pool_field_at)

    @property
    def bounds(self) -> tuple[FloatArray, FloatArray]:
        """Lowest and highest value of each entry of an observation, infinite where there is no bound."""
        low, high = np.full(self.obs_dim, -np.inf, np.float32), np.full(self.obs_dim, np.inf, np.float32)
        for field in self._fields.values():
            if not math.isnan(field.low):
                low[field.slice] = field.low
            if not math.isnan(field.high):
                high[field.slice] = field.high
        return low, high

    @property
    def initial_mean(self) -> FloatArray:
        """[action_dim] the mean action that a new policy starts from: the task's start pose."""
        out = np.empty(self.action_dim, np.float32)
        self._check(lib.rdm_pool_get_initial_mean(self._p, out.ctypes.data))
        return out

    @property
    def costs(self) -> dict[str, _discovery.Cost]:
        """What each column of cost means."""
        return self.task.costs.copy()

    @property
    def single_observation_space(self) -> Any:
        """The Box of one observation, with the bounds of its entries; Gymnasium's class if that was imported."""
        low, high = self.bounds
        return box(low, high)

    @property
    def single_action_space(self) -> Any:
        """The Box of one action, -1 to 1."""
        return box(np.full(self.action_dim, -1, np.float32), np.full(self.action_dim, 1, np.float32))

    @property
    def observation_space(self) -> Any:
        """The Box of obs [num_envs][obs_dim], as in a vector environment of Gymnasium."""
        one = self.single_observation_space
        return box(*(np.tile(end, (self.num_envs, 1)) for end in (one.low, one.high)))

    @property
    def action_space(self) -> Any:
        """The Box of action [num_envs][action_dim]: pool.step(pool.action_space.sample())."""
        one = self.single_action_space
        return box(*(np.tile(end, (self.num_envs, 1)) for end in (one.low, one.high)))

    @property
    def guards(self) -> list[Guard]:
        """Half spaces of actions in which a cost is 0, for tasks whose cost depends on the action alone, such as throws with
        cost_mode=command. Experimental."""
        out: list[Guard] = []
        struct, normal = sized(_abi.rdm_guard), np.empty(self.action_dim, np.float32)
        with self._lock:
            while True:
                code = lib.rdm_pool_guard_at(self._open(), len(out), byref(struct), normal.ctypes.data)
                if code == _abi.ResultCode.RANGE:
                    return out
                check(code)
                out.append(Guard(struct, normal, self.cost_names))

    @property
    def cost_names(self) -> tuple[str, ...]:
        """Name of each column of cost; the first is "cost", the task's own."""
        return tuple(self.task.costs)

    @property
    def seed(self) -> int:
        """The seed that the pool was made with."""
        return int(self._config["seed"])

    @property
    def options(self) -> Mapping[str, Value]:
        """All options of the task as this pool has them, to be read: changing an entry is an error, and dict(pool.options) is a
        copy. Those of joints and links (joint.NAME.kp, link.NAME.mass) are there where they were set. Pool(task, options={...})
        makes worlds with others."""
        return self._options

    @cached_property
    def _options(self) -> Told:
        return read_settings(lib.rdm_pool_get_settings, self._open(),
                             {key: option.kind for key, option in self.task.options.items()}, "Pool(task, options={...})")

    def _option_names(self) -> Iterable[str]:
        return self.task.options if "task" in vars(self) else ()

    @property
    def autoreset(self) -> str:
        """same_step, next_step or off."""
        return str(self._config["autoreset"])

    def close(self) -> None:
        """Destroys the worlds; rows and sensor arrays that you hold stay valid. A second call does nothing."""
        with self._lock:
            self._handle = None
            self._p = None

    def __enter__(self) -> Pool:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __repr__(self) -> str:
        if self._lost:
            return "<Pool, lost>"
        return f"<Pool {self.task.name}: {self.num_envs} worlds{', closed' if self._p is None else ''}>"

    # ---- copies -----------------------------------------------------------------------------------------------

    def copy(self, src: int, dst: int, other: Optional[Pool] = None) -> None:
        """Puts world dst into the state of world src of this pool, or of another one of the same task and options (other)."""
        source = self if other is None else instance(other, Pool, "other")
        first, second = sorted((self, source), key=id)
        with first._lock, second._lock:
            self._check(lib.rdm_pool_copy(self._p, int32(dst, "dst"), source._open(), int32(src, "src")))
            self._begun = True

    def __getstate__(self) -> dict[str, Any]:
        with self._lock:
            self._open()
            try:
                state = self.state()
            except StateError:  # not reset yet
                state = None
            return {"config": self._config, "state": state, "starts": self._starts,
                    "rows": {name: array.copy() for name, array in self._rows.items()}}

    def __setstate__(self, saved: Mapping[str, Any]) -> None:
        try:
            Pool.__init__(self, **saved["config"])
        except NotFoundError as error:  # raised by the first call instead: a worker that cannot read what it is sent dies
            self._lost = (f"{error}. A process registers its own tasks, robots and objects anew: do it where the module "
                          "is imported, or in the initializer of its workers")
            self._p = self._handle = None
            return
        if saved["starts"][0] is not None:
            self.set_starts(*saved["starts"])
        if saved["state"] is not None:
            self.set_state(saved["state"])
        for name, array in saved["rows"].items():
            self._rows[name][...] = array
