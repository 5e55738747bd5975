"""Named blocks of parameters, as a mapping from name to array."""
from __future__ import annotations

from ctypes import byref
from typing import Any, Callable, Iterator, Mapping

import numpy as np

from . import _abi
from ._library import check, encoded
from ._rows import FloatArray


class Tensors(Mapping[str, FloatArray]):
    """The parameters of an agent or a policy. Reading copies; vectors are [n], weights [outputs][inputs]."""

    __slots__ = ("_owner", "_at", "_read")

    def __init__(self, owner: Any, at: Callable[..., int], read: Callable[..., int]) -> None:
        self._owner, self._at, self._read = owner, at, read

    def _shapes(self) -> dict[str, tuple[int, ...]]:
        out: dict[str, tuple[int, ...]] = {}
        row = _abi.rdm_tensor()
        while not self._at(self._owner._open(), len(out), byref(row)):
            tensor = _abi.Tensor(row)
            matrix = tensor.cols > 1 or tensor.name.endswith(".weight")
            out[tensor.name] = (tensor.rows, tensor.cols) if matrix else (tensor.rows,)
        return out

    def __getitem__(self, name: str) -> FloatArray:
        shapes = self._shapes()
        if name not in shapes:
            raise KeyError(name)
        out = np.empty(shapes[name], np.float32)
        check(self._read(self._owner._open(), encoded(name, "name"), out.ctypes.data, out.size))
        return out

    def __iter__(self) -> Iterator[str]:
        return iter(self._shapes())

    def __len__(self) -> int:
        return len(self._shapes())

    def __repr__(self) -> str:
        return "{" + ", ".join(f"{name}: {list(shape)}" for name, shape in self._shapes().items()) + "}"
