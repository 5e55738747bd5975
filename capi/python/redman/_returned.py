"""What Pool.reset and Pool.step return: obs. Unpacking it into Gymnasium's values raises an error that says what to write."""
from __future__ import annotations

import opcode
import sys
from typing import Any, Iterator, Optional

import numpy as np

from ._error import UsageError

_UNPACK = opcode.opmap["UNPACK_SEQUENCE"]
_UNPACK_REST = opcode.opmap["UNPACK_EX"]
_WORDS = {
    "reset": ((2,), "write obs = pool.reset(); redman.make_vec(task, num_envs).reset() returns Gymnasium's (obs, info)"),
    "step": ((4, 5, 6), "write obs = pool.step(action), then pool.reward, pool.cost, pool.terminated and pool.truncated; "
             "redman.make_vec(task, num_envs).step(action) returns Gymnasium's five values")}


class Returned(np.ndarray):  # type: ignore[type-arg]
    """Rows of a pool. Without this class `obs, info = pool.reset()` would give the rows of two worlds, or fail in numpy's
    words."""

    _call: Optional[str] = None  # of an array that was made of this one, None

    @classmethod
    def of(cls, rows: Any, call: str) -> Returned:
        out = rows.view(cls)
        out._call = call
        return out  # type: ignore[no-any-return]

    def __iter__(self) -> Iterator[Any]:
        if self._call is not None:
            frame = sys._getframe(1)
            code, at = frame.f_code.co_code, frame.f_lasti
            counts, words = _WORDS[self._call]
            if code[at] == _UNPACK_REST or (code[at] == _UNPACK and code[at + 1] in counts):
                raise UsageError(f"{self._call}: a pool returns the observations alone: {words}")
        return iter(np.asarray(self))

    def __array_wrap__(self, array: Any, context: Any = None, return_scalar: bool = False) -> Any:
        """Makes results plain arrays."""
        plain = np.asarray(array)
        return plain[()] if plain.ndim == 0 else plain

    def __repr__(self) -> str:
        return repr(np.asarray(self))

    def __reduce__(self) -> Any:
        return np.asarray(self).__reduce__()

    def __deepcopy__(self, memo: Any) -> Any:
        return np.array(self)
