"""Recording: observations, executed actions and labels as data. Experimental, like redman/record.h."""
from __future__ import annotations

import contextlib
import ctypes
import json
import os
import threading
import zipfile
from ctypes import byref, c_int64
from typing import TYPE_CHECKING, Any, Iterator, Mapping, Optional, Union

import numpy as np

from . import _abi
from ._error import ArgumentError
from ._files import must_exist
from ._library import Handle, assign, check, encoded, filled, flag, instance, lib, sized
from ._limits import CostLimits, each_cost
from ._names import Hinted, keywords
from ._pool import Pool
from ._rows import Array, FloatArray, address, array_of, given, shape_of

if TYPE_CHECKING:
    import numpy.typing as npt

_ROWS = ("obs", "action", "label", "reward", "cost", "terminated", "truncated", "success", "episode", "points", "point_class",
         "point_color")
_FLAGS = ("terminated", "truncated", "success")


class Recording(Hinted):
    """Trajectories as data: rows of a pool's steps, of arrays of your own, or of a file that numpy opens.

        recording = redman.Recording(pool)
        for _ in range(75):
            pool.baseline("hold")                       # or what a teacher does; write noise beside it to pool.action
            with recording.step(pool):                  # label=: what the teacher meant, [num_envs][action_dim]
                pool.step()
        recording.save("hold.npz")                      # numpy.load("hold.npz")["obs"] has [rows][obs_dim]
        recording = redman.Recording.load("hold.npz")   # also a file of `redman rollout --record`

        recording = redman.Recording(obs_dim=3, action_dim=1)
        recording.append(obs=obs, action=action, reward=reward, truncated=ends)

    agent.clone(recording) fits an agent to it, agent.recording = recording keeps an agent near it while it learns,
    pool.set_starts(recording) begins episodes at its states, which are kept at every state_stride-th row of an episode. Its
    arrays (obs, action, reward, ...) are copies: read them once, not in a loop.

    Without a pool: cost_dim is the number of costs; task, layout_hash and state_bytes are those of the worlds, "" and 0 where
    they have none; num_points and point_color say what clouds the rows have. capacity: rows whose memory is taken at once.
    """

    _hints = {
        "observations": "obs", "observation": "obs", "actions": "action", "rewards": "reward", "costs": "cost",
        "labels": "label", "terminals": "terminated", "dones": "terminated | truncated", "timeouts": "truncated",
        "write": "save(path)", "read": "redman.Recording.load(path)", "add": "append(obs=..., action=...)",
        "extend": "append(recording)", "close": "a recording ends with its last reference",
        "to_pandas": "pandas.DataFrame({'reward': recording.reward, 'episode': recording.episode})"}

    obs_dim: int
    action_dim: int
    cost_dim: int
    task: str  # "": worlds of your own

    @keywords(aliases={"stride": "state_stride"})
    def __init__(self, pool: Optional[Pool] = None, *, obs_dim: Optional[int] = None, action_dim: Optional[int] = None,
                 cost_dim: int = 0, task: str = "", layout_hash: int = 0, state_bytes: int = 0, num_points: int = 0,
                 point_color: bool = False, capacity: int = 0, state_stride: int = 8) -> None:
        config = sized(_abi.rdm_recording_config)
        check(lib.rdm_recording_config_init(byref(config), ctypes.sizeof(config)))
        if pool is not None:
            instance(pool, Pool, "pool", "; redman.Recording.load(path) reads a file")
            if obs_dim is not None or action_dim is not None:
                raise ArgumentError("recording: give either a pool, or obs_dim and action_dim")
            check(lib.rdm_recording_config_for_pool(byref(config), pool._open()))
        else:
            if obs_dim is None or action_dim is None:
                raise ArgumentError("recording: give a pool, or obs_dim and action_dim")
            config.task = encoded(task, "task")
            assign(config, {"obs_dim": obs_dim, "action_dim": action_dim, "cost_dim": cost_dim, "layout_hash": layout_hash,
                            "state_bytes": state_bytes, "num_points": num_points, "point_color": flag(point_color, "point_color")})
        assign(config, {"capacity": capacity, "state_stride": state_stride})
        self._stride = state_stride
        self._own(Handle(lib.rdm_recording_create, lib.rdm_recording_destroy, byref(config)))

    def _own(self, handle: Handle) -> None:
        self._handle = handle
        self._repeat: Optional[int] = None  # control steps of a row, where its file says it
        self._lock = threading.RLock()
        info = self.info
        self.obs_dim, self.action_dim, self.cost_dim, self.task = info.obs_dim, info.action_dim, info.cost_dim, info.task

    @classmethod
    def load(cls, path: Union[str, os.PathLike[str]]) -> Recording:
        """Reads the .npz file at path that save, numpy.savez or `redman rollout --record` wrote."""
        must_exist(path, "recording")
        out = cls.__new__(cls)
        out._stride = 8
        out._own(Handle(lib.rdm_recording_read_file, lib.rdm_recording_destroy, encoded(path, "path")))
        out._repeat = _repeat_of(path)
        return out

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes an .npz file at path, entirely or not at all."""
        with self._lock:
            check(lib.rdm_recording_write_file(self._handle.value, encoded(path, "path")))

    # ---- adding rows ------------------------------------------------------------------------------------------

    @contextlib.contextmanager
    def step(self, pool: Pool, label: Any = None, mask: Any = None) -> Iterator[None]:
        """For use around pool.step: records observation and action of each world before it, and its outcome after it, as one
        row.

        label [num_envs][action_dim]: the actions that a teacher meant; None: the actions. mask [num_envs]: the worlds to
        record. Several steps inside make one row, with sums. A world that a pool with next_step autoreset is about to reset
        gets no row.
        """
        self.begin_step(pool, label, mask)
        yield
        self.end_step(pool, mask)

    def begin_step(self, pool: Pool, label: Any = None, mask: Any = None) -> None:
        """The first half of step, with the same label and mask: before pool.step."""
        rows = _abi.FUNCTIONS["rdm_recording_begin_step"].rows
        meant = None if label is None else given(label, rows["label"], instance(pool, Pool, "pool")._lengths, "label")
        chosen = instance(pool, Pool, "pool")._mask(mask)
        with pool._lock, self._lock:
            check(lib.rdm_recording_begin_step(self._handle.value, pool._open(), address(meant), address(chosen)))

    def end_step(self, pool: Pool, mask: Any = None) -> None:
        """The second half of step, with the same mask: after pool.step."""
        chosen = instance(pool, Pool, "pool")._mask(mask)
        with pool._lock, self._lock:
            check(lib.rdm_recording_end_step(self._handle.value, pool._open(), address(chosen)))

    def append(self, other: Optional[Recording] = None, *, obs: Any = None, action: Any = None, label: Any = None,
               reward: Any = None, cost: Any = None, terminated: Any = None, truncated: Any = None, success: Any = None,
               episode: Any = None, points: Any = None, point_class: Any = None, point_color: Any = None,
               state_row: Any = None, state: Any = None) -> None:
        """Adds all rows of another recording (other), or rows from arrays: at least obs [n][obs_dim] and action
        [n][action_dim].

        label None: as action; reward, cost None: 0. terminated, truncated and success are flags [n]. episode [n] numbers the
        episodes from 0; None: each end begins one. points [n][num_points][3] are whole mm, with their point_class
        [n][num_points] and point_color [n][num_points][3]. state [m][state_bytes] are those before the rows state_row [m].
        """
        if other is not None:
            instance(other, Recording, "other", "; arrays are append(obs=..., action=...)")
            first, second = sorted((self, other), key=id)
            with first._lock, second._lock:
                empty = not len(self)
                check(lib.rdm_recording_append_all(self._handle.value, other._handle.value))
                self._repeat = other._repeat if empty or self._repeat == other._repeat else None
            return
        if obs is None or action is None:
            raise ArgumentError("append: give a recording, or obs and action")
        said = {"obs": obs, "action": action, "label": label, "reward": reward, "cost": cost, "terminated": terminated,
                "truncated": truncated, "success": success, "episode": episode, "points": points,
                "point_class": point_class, "point_color": point_color, "state_row": state_row, "state": state}
        states = 0 if state_row is None else array_of(state_row, "state_row").size
        lengths = self._lengths(len(np.atleast_2d(array_of(obs, "obs"))), states)
        table = _abi.ROWS["rdm_recording_rows"]
        kept = {name: given(value, table[name], lengths, name) for name, value in said.items() if value is not None}
        struct = sized(_abi.rdm_recording_rows)
        struct.rows, struct.num_states = lengths["rows"], lengths["num_states"]
        for name, array in kept.items():
            setattr(struct, name, array.ctypes.data)
        with self._lock:
            check(lib.rdm_recording_append(self._handle.value, byref(struct)))
        del kept

    def filter(self, success: bool = False, max_cost: CostLimits = None) -> int:
        """Drops whole episodes, and returns how many: with success=True those without a success, and those whose sum of a
        cost is above its max_cost, a number for column 0 or one for each column; None: not checked. Episodes that still run
        are closed."""
        limits = each_cost(max_cost, None, [f"cost {k}" for k in range(self.cost_dim)], "max_cost")
        rows = None if limits is None else np.array(limits, np.float64)
        dropped = c_int64()
        with self._lock:
            check(lib.rdm_recording_filter(self._handle.value, flag(success, "success"), address(rows), byref(dropped)))
        return dropped.value

    def clear(self) -> None:
        """Removes all rows; the memory stays."""
        with self._lock:
            check(lib.rdm_recording_clear(self._handle.value))

    # ---- what it holds ----------------------------------------------------------------------------------------

    @property
    def info(self) -> _abi.RecordingInfo:
        """Sizes, numbers of rows, episodes and states, and the task."""
        return _abi.RecordingInfo(filled(_abi.rdm_recording_info, lib.rdm_recording_get_info, self._handle.value))

    def arrays(self) -> dict[str, Array]:
        """Copies of all rows by name, as the file has them; what it does not keep (points, states) is left out."""
        return {name: array for name in (*_ROWS, "state_row", "state") if (array := self._array(name)) is not None}

    def _array(self, name: str) -> Optional[Array]:
        with self._lock:
            struct = filled(_abi.rdm_recording_rows, lib.rdm_recording_get_rows, self._handle.value)
            at, rows = getattr(struct, name), _abi.ROWS["rdm_recording_rows"][name]
            shape = shape_of(rows, self._lengths(struct.rows, struct.num_states))
            if not at:
                wanted = name in _ROWS and not name.startswith("point")
                return np.empty(shape, rows.dtype) if wanted and 0 in shape else None
            size = int(np.prod(shape)) * np.dtype(rows.dtype).itemsize
            out = np.frombuffer(ctypes.string_at(at, size), rows.dtype).reshape(shape).copy()
        return out.view(np.bool_) if name in _FLAGS else out

    def _lengths(self, rows: int, states: int) -> dict[str, int]:
        info = self.info
        return {"rows": rows, "num_states": states, "obs_dim": info.obs_dim, "action_dim": info.action_dim,
                "cost_dim": info.cost_dim, "num_points": info.num_points, "state_bytes": info.state_bytes}

    def _row(self, name: str) -> Array:
        array = self._array(name)
        assert array is not None
        return array

    @property
    def obs(self) -> FloatArray:
        """[rows][obs_dim] before the action; a copy, as all arrays here."""
        return self._row("obs")

    @property
    def action(self) -> FloatArray:
        """[rows][action_dim] executed action, in [-1, 1]."""
        return self._row("action")

    @property
    def label(self) -> FloatArray:
        """[rows][action_dim] the action that the teacher meant."""
        return self._row("label")

    @property
    def reward(self) -> FloatArray:
        """[rows] of the step that followed."""
        return self._row("reward")

    @property
    def cost(self) -> FloatArray:
        """[rows][cost_dim] likewise."""
        return self._row("cost")

    @property
    def terminated(self) -> npt.NDArray[np.bool_]:
        """[rows] the task ended with this row."""
        return self._row("terminated")

    @property
    def truncated(self) -> npt.NDArray[np.bool_]:
        """[rows] the episode was truncated with this row."""
        return self._row("truncated")

    @property
    def success(self) -> npt.NDArray[np.bool_]:
        """[rows] the task's success held."""
        return self._row("success")

    @property
    def episode(self) -> npt.NDArray[np.int64]:
        """[rows] number of the episode, from 0."""
        return self._row("episode")

    def __len__(self) -> int:
        return self.info.rows

    def __bool__(self) -> bool:
        return True

    def __getstate__(self) -> dict[str, Any]:
        with self._lock:
            info = self.info
            return {"sizes": {"obs_dim": info.obs_dim, "action_dim": info.action_dim, "cost_dim": info.cost_dim,
                              "task": info.task, "layout_hash": info.layout_hash, "state_bytes": info.state_bytes,
                              "num_points": info.num_points, "state_stride": self._stride},
                    "rows": self.arrays(), "repeat": self._repeat}

    def __setstate__(self, saved: Mapping[str, Any]) -> None:
        rows = dict(saved["rows"])
        Recording.__init__(self, **saved["sizes"], point_color="point_color" in rows)
        if len(rows["obs"]):
            self.append(**rows)
        self._repeat = saved.get("repeat")

    def __repr__(self) -> str:
        info = self.info
        return f"<Recording of {info.task or 'worlds of your own'}: {info.rows} rows, {info.episodes} episodes>"


def _repeat_of(path: Union[str, os.PathLike[str]]) -> Optional[int]:
    """The control steps of a row of a data set, which `redman data make` keeps in the metadata; None: unknown."""
    try:
        with np.load(path, allow_pickle=False) as file:
            repeat = json.loads(str(file["metadata"]))["action_repeat"]
    except (OSError, ValueError, KeyError, TypeError, zipfile.BadZipFile):
        return None
    return repeat if isinstance(repeat, int) else None
