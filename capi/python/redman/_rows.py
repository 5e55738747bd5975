"""Rows: arrays that the library reads or writes, named and shaped as the header says."""
from __future__ import annotations

import ctypes
from typing import TYPE_CHECKING, Any, Iterable, Mapping, Optional

import numpy as np

from . import _abi
from ._abi import Rows
from ._error import ArgumentError, UsageError

if TYPE_CHECKING:
    import numpy.typing as npt
    Array = npt.NDArray[Any]
    FloatArray = npt.NDArray[np.float32]
    DoubleArray = npt.NDArray[np.float64]
else:  # numpy.typing alone takes longer to import than redman
    Array = FloatArray = DoubleArray = np.ndarray
ALIGNMENT = 64


def shape_of(rows: Rows, lengths: Mapping[str, int]) -> tuple[int, ...]:
    """The shape with its lengths filled in."""
    return tuple(lengths[name] if name in lengths else int(name) for name in rows.shape)


def aligned(size: int) -> npt.NDArray[np.uint8]:
    """Zero bytes that begin at a multiple of 64."""
    raw = np.zeros(size + ALIGNMENT, np.uint8)
    skip = -raw.ctypes.data % ALIGNMENT
    return raw[skip:skip + size]


def made(table: Mapping[str, Rows], lengths: Mapping[str, int]) -> dict[str, Array]:
    """Zeroed arrays for all rows of a struct, in one block, each aligned."""
    sizes = {name: np.dtype(rows.dtype).itemsize * int(np.prod(shape_of(rows, lengths)))
             for name, rows in table.items()}
    steps = {name: -(-size // ALIGNMENT) * ALIGNMENT for name, size in sizes.items()}
    block = aligned(sum(steps.values()))
    out: dict[str, Array] = {}
    at = 0
    for name, rows in table.items():
        out[name] = block[at:at + sizes[name]].view(rows.dtype).reshape(shape_of(rows, lengths))
        at += steps[name]
    return out


def array_of(value: Any, name: str, dtype: Any = None) -> Array:
    """An argument as an array, of its own type unless another is wanted."""
    try:
        return np.asarray(value, dtype)
    except (TypeError, ValueError, OverflowError) as error:
        raise UsageError(f"{name}: it must be an array of numbers: {error}") from None


def given(value: Any, rows: Rows, lengths: Mapping[str, int], name: str, spread: bool = False) -> Array:
    """The caller's array as the library reads it: no copy where type, shape and order are already right.

    Lengths of 1 may be left out: [n] for [n][1], a number for [1]. With spread, values are repeated along missing axes.
    """
    shape = shape_of(rows, lengths)
    array = _cast(array_of(value, name), np.dtype(rows.dtype), name)
    if array.shape != shape:
        if [length for length in array.shape if length != 1] == [length for length in shape if length != 1]:
            array = array.reshape(shape)
        else:
            try:
                array = np.broadcast_to(array, shape if spread else array.shape)
            except ValueError:
                pass
        if array.shape != shape:
            names = "".join(f"[{length}]" for length in rows.shape)
            raise wrong_shape(name, np.shape(value), shape, names)
    return np.ascontiguousarray(array)


def wrong_shape(name: str, shape: tuple[int, ...], wanted: Any, names: str = "") -> ArgumentError:
    """The error about an array of another shape; names: what its lengths mean, [num_envs][cost_dim]."""
    return ArgumentError(f"{name}: its shape is {shape}, but it must be {wanted}" + (f", which is {names}" if names else ""))


def _cast(array: Array, dtype: np.dtype[Any], name: str) -> Array:
    """The array in another type that can hold its values."""
    if array.dtype == dtype:
        return array
    if array.dtype == np.bool_ and dtype == np.uint8:
        return array.view(np.uint8)
    whole = array.dtype.kind in "iu" and dtype.kind in "iu"
    if not whole and not np.can_cast(array.dtype, dtype, "same_kind"):
        raise ArgumentError(f"{name}: it must be an array of {dtype}, not of {array.dtype}")
    changed = array.astype(dtype)
    if whole and not np.array_equal(changed, array):
        raise ArgumentError(f"{name}: it has a value that {dtype} cannot hold")
    return changed


def address(array: Optional[Array]) -> Optional[int]:
    """Where an array begins, None for None."""
    return None if array is None else array.ctypes.data


class Borrowed:
    """Memory of the library as an array: the array holds this, and this holds the owner."""

    def __init__(self, at: int, dtype: str, shape: Iterable[int], owner: object) -> None:
        self.owner = owner
        self.__array_interface__ = {
            "data": (at, True), "typestr": np.dtype(dtype).str, "shape": tuple(shape), "version": 3}

    def array(self) -> Array:
        return np.asarray(self)


def clouds(points: Any, point_class: Any, point_color: Any, rows: int) -> tuple[_abi.rdm_points, tuple[Any, ...]]:
    """The struct for clouds points [rows][n][3], point_class [rows][n], point_color [rows][n][3] or None, and the arrays
    that it borrows."""
    array = array_of(points, "points")
    if array.ndim == 2 and rows == 1:
        array = array[None]
    if array.ndim != 3 or array.shape[0] != rows or array.shape[2] != 3:
        raise wrong_shape("points", array.shape, f"({rows}, n, 3)")
    table = _abi.ROWS["rdm_points"]
    lengths = {"rows": rows, "num_points": array.shape[1]}
    metres = given(array, table["points"], lengths, "points")
    classes = None if point_class is None else given(point_class, table["point_class"], lengths, "point_class")
    colors = None if point_color is None else given(point_color, table["point_color"], lengths, "point_color")
    out = _abi.rdm_points(struct_size=ctypes.sizeof(_abi.rdm_points), num_points=array.shape[1],
                          points=metres.ctypes.data,
                          point_class=None if classes is None else classes.ctypes.data,
                          point_color=None if colors is None else colors.ctypes.data)
    return out, (metres, classes, colors)
