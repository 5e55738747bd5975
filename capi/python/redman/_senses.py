"""What worlds see beside their rows (option modality), as entries of an observation that is a dict."""
from __future__ import annotations

from typing import Any

import numpy as np

from ._pool import Pool
from ._rows import Array

# Entries and their bounds; None: those of the type. What is left of redman.Sensors (point_shape, point_count) tells
# how a cloud was made and is no input of a learner.
_BOUNDS: dict[str, tuple[Any, Any]] = {
    "rgb": (0, 255), "depth": (0, np.inf), "segmentation": (-1, None), "points": (-np.inf, np.inf),
    "point_class": (0, 255), "point_color": (0, 255), "voxels": (-1, 1)}


class Senses:
    """Views [num_envs][...] of the library's memory by name, the same until the pool is closed. A single camera has no axis
    of its own."""

    def __init__(self, pool: Pool) -> None:
        self.rows: dict[str, Array] = {}
        if pool.options.get("modality", "state") == "state":
            return
        sensors = pool.sensors
        for name in _BOUNDS:
            array = getattr(sensors, name, None)
            if array is not None:
                one = name in ("rgb", "depth", "segmentation") and array.shape[1] == 1
                self.rows[name] = array[:, 0] if one else array

    def __bool__(self) -> bool:
        return bool(self.rows)

    def spaces(self, box: Any) -> dict[str, Any]:
        """A Box for each entry of one world."""
        out = {}
        for name, array in self.rows.items():
            low, high = _BOUNDS[name]
            if high is None:
                high = np.iinfo(array.dtype).max
            out[name] = box(low, high, array.shape[1:], dtype=array.dtype.type)
        return out

    def seen(self, env: Any = slice(None)) -> dict[str, Array]:
        """Copies, of one world or of all."""
        return {name: array[env].copy() for name, array in self.rows.items()}
