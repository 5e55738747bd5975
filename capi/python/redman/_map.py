"""Map: what is occupied, free and unknown in space. Experimental, like redman/map.h."""
from __future__ import annotations

import ctypes
import os
import threading
import warnings
from ctypes import byref, c_int32, c_size_t, c_uint64
from typing import TYPE_CHECKING, Any, Mapping, Optional, Sequence, Union

import numpy as np

from . import _abi
from ._abi import MapFormat
from ._error import ArgumentError, StateError, UsageError
from ._library import Handle, assign, bytes_of, check, encoded, failure, filled, flag, instance, int32, lib, raw, real, sized
from ._names import Hinted, nearest, one_of
from ._pool import Pool
from ._rows import Array, FloatArray, address, array_of, given

if TYPE_CHECKING:
    import numpy.typing as npt

_FORMATS = {"bt": MapFormat.BINARY, "ot": MapFormat.FULL}


def _points(points: Any, name: str = "points") -> Array:
    rows = np.ascontiguousarray(array_of(points, name, np.float32))
    if rows.ndim != 2 or rows.shape[1] != 3:
        raise ArgumentError(f"{name}: its shape is {rows.shape}, but must be (count, 3)")
    return rows


class Map(Hinted):
    """An occupancy map made from scans: point clouds of your own, or scans by a pool's cameras.

        m = redman.Map(resolution=0.02)
        m.scan(pool, env=0, camera="top", width=96, height=96)
        m.insert(origin, points)
        m.query(points)                     # probability of occupied, -1 where unknown

    points are [count][3], m; origin, direction, low and high [3] of a ray or a box too; pose is [7], a position and a
    quaternion (x, y, z, w). More keywords: memory (bytes, 64 MiB), max_range (m, 4; 0: no limit), hit, miss, low, high,
    threshold. dropped: voxels left out so far because the map was full.
    """

    dropped: int = 0

    def __init__(self, resolution: float = 0.02, **config: float) -> None:
        self._lock = threading.RLock()
        self._config: dict[str, float] = {"resolution": resolution, **config}
        struct = sized(_abi.rdm_map_config)
        check(lib.rdm_map_config_init(byref(struct), ctypes.sizeof(struct)))
        known = {name for name, kind in struct._fields_ if kind is ctypes.c_double} | {"memory"}
        for name, value in self._config.items():
            if name not in known:
                raise UsageError(f"Map: {name!r} is none of {', '.join(sorted(known))}{nearest(name, known)}")
            assign(struct, {name: value})
        self._handle: Optional[Handle] = Handle(lib.rdm_map_create, lib.rdm_map_destroy, byref(struct))
        self._m = self._handle.value
        self._memory, self._max_range = int(struct.memory), float(struct.max_range)

    def insert(self, origin: Sequence[float], points: Any) -> int:
        """Adds one scan: rays from origin to points. Returns how many voxels a full map left out, and warns if there were
        any."""
        rows, at = _points(points), self._given("rdm_map_insert", "origin", origin)
        if "max_range" not in self._config:
            far = int(np.count_nonzero(np.linalg.norm(rows - at, axis=1) > self._max_range))
            if far:
                warnings.warn(f"{far} of {len(rows)} points are farther than max_range = {self._max_range:g} m, its default: "
                              "their rays clear the way so far and the points are left out; say max_range=...",
                              RuntimeWarning, stacklevel=2)
        dropped = c_uint64()
        with self._lock:
            self._check(lib.rdm_map_insert(self._m, at.ctypes.data, rows.ctypes.data, len(rows), byref(dropped)))
        return self._left_out(dropped.value)

    def scan(self, pool: Pool, env: int = 0, camera: Optional[str] = None, width: int = 96, height: int = 96,
             skip: Sequence[int] = ()) -> int:
        """Adds one scan by a camera of the pool's task (None: its first) in world env, of width x height rays; rays that end on
        a shape in skip are left out. Returns how many voxels a full map left out (0 in one that is large enough), and warns if
        there were any."""
        instance(pool, Pool, "pool")
        left = np.ascontiguousarray(array_of(skip, "skip", np.int32))
        dropped = c_uint64()
        name = next(iter(pool.cameras), "") if camera is None else camera
        env, width, height = int32(env, "env"), int32(width, "width"), int32(height, "height")
        with self._lock, pool._lock:
            self._check(lib.rdm_map_scan(self._m, pool._open(), env, encoded(name, "camera"), width, height,
                                         address(left) if len(left) else None, len(left), byref(dropped)))
        return self._left_out(dropped.value)

    def _left_out(self, dropped: int) -> int:
        """Warns that the map is full: space that is not in it is not free space."""
        self.dropped += dropped
        if dropped:
            warnings.warn(f"a full map left out {dropped} voxels: raise memory (it has {self._memory} bytes) or resolution, "
                          "or lower max_range", RuntimeWarning, stacklevel=3)
        return dropped

    def query(self, points: Any) -> FloatArray:
        """[count] probability that the voxel of each point is occupied; -1: unknown."""
        rows = _points(points)
        out = np.empty(len(rows), np.float32)
        self._check(lib.rdm_map_get_probabilities(self._open(), rows.ctypes.data, len(rows), out.ctypes.data))
        return out

    def box(self, low: Sequence[float], high: Sequence[float]) -> Array:
        """Occupied voxels that overlap the box: rows of centre [3] and side, m."""
        corners = [self._given("rdm_map_get_voxels", name, value) for name, value in (("low", low), ("high", high))]
        out = np.empty(0, np.dtype(_abi.rdm_voxel))
        count = c_size_t()
        while True:
            rows = out.ctypes.data_as(ctypes.POINTER(_abi.rdm_voxel))
            self._check(lib.rdm_map_get_voxels(self._open(), *(c.ctypes.data for c in corners), rows, len(out), byref(count)))
            if count.value <= len(out):
                return out[:count.value]
            out = np.empty(count.value, out.dtype)

    def meets(self, pose: Sequence[float], half: Sequence[float]) -> bool:
        """Whether an occupied voxel overlaps the box of half sizes half at pose, a position and quaternion."""
        meets = c_int32()
        self._check(lib.rdm_map_meets(self._open(), self._given("rdm_map_meets", "pose", pose).ctypes.data,
                                      self._given("rdm_map_meets", "half", half).ctypes.data, byref(meets)))
        return bool(meets.value)

    def raycast(self, origin: Sequence[float], direction: Sequence[float], range: float,
                through_unknown: bool = False) -> Optional[FloatArray]:
        """The point where the ray enters the first occupied voxel within range, m, or None. through_unknown: goes on where
        nothing is known; else an unknown voxel ends it."""
        rays = [self._given("rdm_map_raycast", name, value)
                for name, value in (("origin", origin), ("direction", direction))]
        hit = np.empty(3, np.float32)
        found = c_int32()
        self._check(lib.rdm_map_raycast(self._open(), *(row.ctypes.data for row in rays), real(range, "range"),
                                        flag(through_unknown, "through_unknown"), hit.ctypes.data, byref(found)))
        return hit if found.value else None

    def distance(self, points: Any, most: float) -> FloatArray:
        """[count] distance from each point to the nearest occupied voxel, m; `most` where none is that near."""
        rows = _points(points)
        out = np.empty(len(rows), np.float32)
        self._check(lib.rdm_map_get_distances(self._open(), rows.ctypes.data, len(rows), real(most, "most"), out.ctypes.data))
        return out

    def grid(self, pose: Sequence[float], n: Sequence[int], side: float) -> npt.NDArray[np.int8]:
        """[n0][n1][n2] cells, n = [n0, n1, n2] of 1 to 1024, of `side` m around pose: 1 occupied, 0 free, -1 unknown."""
        counts = self._given("rdm_map_get_grid", "n", n)
        fits = all(1 <= count <= 1024 for count in counts)  # if not, the call says so
        out = np.empty(tuple(counts) if fits else 0, np.int8)
        self._check(lib.rdm_map_get_grid(self._open(), self._given("rdm_map_get_grid", "pose", pose).ctypes.data,
                                     counts.ctypes.data, real(side, "side"), out.ctypes.data))
        return out

    def clear(self) -> None:
        """Makes everything unknown again."""
        with self._lock:
            self._check(lib.rdm_map_clear(self._m))

    @property
    def info(self) -> _abi.MapInfo:
        """Resolution, nodes and bytes."""
        return _abi.MapInfo(filled(_abi.rdm_map_info, lib.rdm_map_get_info, self._open()))

    def save(self, format: str = "ot") -> bytes:
        """The bytes of an OctoMap file of a format: "ot" with probabilities, "bt" occupied or free."""
        return bytes_of(lib.rdm_map_write, self._open(), one_of(format, _FORMATS, "format"))

    def load(self, data: bytes) -> None:
        """Replaces the contents of the map by data, a file's bytes. FormatError for others."""
        data = raw(data, "data")
        with self._lock:
            self._check(lib.rdm_map_read(self._m, data, len(data)))

    def save_file(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes a .bt or .ot file at path, by its ending, entirely or not at all."""
        self._check(lib.rdm_map_write_file(self._open(), encoded(path, "path")))

    def load_file(self, path: Union[str, os.PathLike[str]]) -> None:
        """Reads a .bt or .ot file at path."""
        with self._lock:
            self._check(lib.rdm_map_read_file(self._m, encoded(path, "path")))

    def close(self) -> None:
        """Destroys the map. A second call does nothing."""
        with self._lock:
            self._handle = None
            self._m = None

    def __enter__(self) -> Map:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __getstate__(self) -> dict[str, Any]:
        return {"config": self._config, "map": self.save()}

    def __setstate__(self, saved: Mapping[str, Any]) -> None:
        Map.__init__(self, **saved["config"])
        self.load(saved["map"])

    def __repr__(self) -> str:
        return "<Map, closed>" if self._m is None else f"<Map of {self.info.resolution} m: {self.info.nodes} nodes>"

    def _given(self, function: str, name: str, value: Any) -> Array:
        return given(value, _abi.FUNCTIONS[function].rows[name], {}, name)

    def _open(self) -> int:
        if self._m is None:
            raise StateError("map: it was closed")
        return self._m

    def _check(self, code: int) -> None:
        if code:
            raise StateError("map: it was closed") if self._m is None else failure(code)


def sample_furthest(points: Any, wanted: int, start: int = 0) -> npt.NDArray[np.int32]:
    """Farthest point sampling: the numbers of `wanted` of points [count][3], each the farthest from all chosen before; start:
    the first of them."""
    rows = _points(points)
    wanted, start = int32(wanted, "wanted"), int32(start, "start")
    chosen = np.empty(max(wanted, 0), np.int32)
    size = lib.rdm_sample_scratch(len(rows))
    scratch = np.empty(size, np.uint8)
    check(lib.rdm_sample_furthest(rows.ctypes.data, len(rows), wanted, start, chosen.ctypes.data,
                                  scratch.ctypes.data, size))
    return chosen
