"""Replacements for the classes of Gymnasium that environments need, for when it is not installed."""
from __future__ import annotations

import sys
from typing import Any, Optional

import numpy as np

from ._rows import Array


class Box:
    """Arrays between two bounds."""

    def __init__(self, low: Any, high: Any, shape: Optional[tuple[int, ...]] = None, dtype: Any = np.float32,
                 seed: Optional[int] = None) -> None:
        self.dtype = np.dtype(dtype)
        self.shape = np.shape(low) if shape is None else tuple(shape)
        self.low = np.broadcast_to(np.asarray(low, dtype), self.shape).copy()
        self.high = np.broadcast_to(np.asarray(high, dtype), self.shape).copy()
        self._random = np.random.default_rng(seed)

    def seed(self, seed: Optional[int] = None) -> None:
        """Seeds the random numbers of sample()."""
        self._random = np.random.default_rng(seed)

    def sample(self) -> Array:
        """Uniform between bounds; standard normal where there are none."""
        bounded = np.isfinite(self.low) & np.isfinite(self.high)
        low, high = np.where(bounded, self.low, 0), np.where(bounded, self.high, 0)
        drawn = np.where(bounded, self._random.uniform(low, high), self._random.standard_normal(self.shape))
        return np.clip(drawn, self.low, self.high).astype(self.dtype)

    def contains(self, x: Any) -> bool:
        """Whether x is such an array."""
        return (isinstance(x, np.ndarray) and x.shape == self.shape and np.can_cast(x.dtype, self.dtype)
                and bool(np.all((x >= self.low) & (x <= self.high))))

    __contains__ = contains

    def __eq__(self, other: object) -> bool:
        return (isinstance(other, Box) and self.shape == other.shape and self.dtype == other.dtype
                and np.array_equal(self.low, other.low) and np.array_equal(self.high, other.high))

    def __repr__(self) -> str:
        return f"Box({self.low.min()}, {self.high.max()}, {self.shape}, {self.dtype})"


class Dict(dict[str, Any]):
    """Named spaces."""

    def seed(self, seed: Optional[int] = None) -> None:
        """Seeds the random numbers of sample()."""
        for i, space in enumerate(self.values()):
            space.seed(None if seed is None else seed + i)

    def sample(self) -> dict[str, Any]:
        """One of each."""
        return {name: space.sample() for name, space in self.items()}

    def contains(self, x: Any) -> bool:
        """Whether x has one of each and nothing else."""
        return isinstance(x, dict) and x.keys() == self.keys() and all(self[name].contains(v) for name, v in x.items())

    __contains__ = contains


class Env:
    """What gymnasium.Env gives its subclasses."""

    metadata: dict[str, Any] = {"render_modes": []}
    render_mode: Optional[str] = None
    spec: Any = None
    _np_random: Optional[np.random.Generator] = None

    @property
    def unwrapped(self) -> "Env":
        """The environment without wrappers."""
        return self

    @property
    def np_random(self) -> np.random.Generator:
        """The random generator, which reset(seed=) seeds."""
        if self._np_random is None:
            self._np_random = np.random.default_rng()
        return self._np_random

    def reset(self, *, seed: Optional[int] = None, options: Optional[dict[str, Any]] = None) -> Any:
        if seed is not None:
            self._np_random = np.random.default_rng(seed)

    def close(self) -> None:
        pass

    def __enter__(self) -> "Env":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()


class VectorEnv(Env):
    """What gymnasium.vector.VectorEnv gives its subclasses."""

    num_envs = 0
    closed = False

    def close(self, **kwargs: Any) -> None:
        if not self.closed:
            self.close_extras(**kwargs)
        self.closed = True

    def close_extras(self, **kwargs: Any) -> None:
        pass


def batch_space(space: Any, n: int) -> Any:
    """The space of n rows."""
    if isinstance(space, Dict):
        return Dict({name: batch_space(s, n) for name, s in space.items()})
    return Box(np.stack([space.low] * n), np.stack([space.high] * n), dtype=space.dtype)


def box(low: Any, high: Any) -> Any:
    """A Box of float32; Gymnasium's where that was imported."""
    spaces = sys.modules.get("gymnasium.spaces")
    return (Box if spaces is None else spaces.Box)(low, high, dtype=np.float32)
