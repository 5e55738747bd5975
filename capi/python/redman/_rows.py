"""Rows: arrays that the library reads or writes, named and shaped as the header says."""
from __future__ import annotations

from typing import Any, Iterable, Mapping, Optional

import numpy as np
import numpy.typing as npt

from ._abi import Rows
from ._error import ArgumentError

Array = npt.NDArray[Any]
FloatArray = npt.NDArray[np.float32]
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
    sizes = {name: np.dtype(rows.dtype).itemsize * int(np.prod(shape_of(rows, lengths))) for name, rows in table.items()}
    steps = {name: -(-size // ALIGNMENT) * ALIGNMENT for name, size in sizes.items()}
    block = aligned(sum(steps.values()))
    out: dict[str, Array] = {}
    at = 0
    for name, rows in table.items():
        out[name] = block[at:at + sizes[name]].view(rows.dtype).reshape(shape_of(rows, lengths))
        at += steps[name]
    return out


def given(value: Any, rows: Rows, lengths: Mapping[str, int], name: str) -> Array:
    """The caller's array as the library reads it: no copy where type, shape and order are already right."""
    shape = shape_of(rows, lengths)
    array = np.asarray(value)
    if array.dtype != rows.dtype:
        if array.dtype == np.bool_ and rows.dtype == "uint8":
            array = array.view(np.uint8)
        elif np.can_cast(array.dtype, rows.dtype, "same_kind") or array.dtype.kind in "iu" and rows.dtype in ("uint64", "int32", "uint8"):
            changed = array.astype(rows.dtype)
            if array.dtype.kind in "iu" and not np.array_equal(changed, array):
                raise ArgumentError(f"{name}: a value that {rows.dtype} cannot hold")
            array = changed
        else:
            raise ArgumentError(f"{name}: an array of {rows.dtype}, not of {array.dtype}")
    if array.shape != shape:
        try:
            array = np.broadcast_to(array, shape)
        except ValueError:
            raise ArgumentError(f"{name}: shape {array.shape} does not fit {shape}") from None
    return np.ascontiguousarray(array)


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
