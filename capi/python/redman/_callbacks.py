"""Python functions that the library calls, such as those of a task of your own: their exceptions are kept and raised later."""
from __future__ import annotations

import ctypes
from typing import Any, Callable

from . import _abi
from ._error import NotFoundError, UsageError
from ._library import guarded
from ._names import nearest


def c_function(member: str, function: Callable[..., Any]) -> Any:
    """Turns a Python function into a member of a struct of redman.h: c_function("rdm_task_def.judge", judge).

    It is called with the arguments that the header lists; returning None or 0 means success. An exception makes that call
    fail, and is the cause of the redman.Error that the call from Python then raises; in a function that returns nothing,
    such as log, it goes to sys.unraisablehook. Keep the result as long as the library may call it, for a task as long as it is
    registered.
    """
    pointer: Any = getattr(ctypes, "_CFuncPtr")
    members: dict[str, Any] = {f"{key}.{field[0]}": field[1] for key, kind in _abi.STRUCTS.items()
                               for field in kind._fields_ if issubclass(field[1], pointer)}
    if not isinstance(member, str) or member not in members:
        raise NotFoundError(f"{member}: no function of a struct of redman.h{nearest(str(member), members)}")
    if not callable(function):
        raise UsageError(f"{member}: it must be a function, not {function!r}")
    answers = members[member]._restype_ is ctypes.c_int32
    return members[member](guarded(member.partition(".")[2], function, anywhere=True) if answers else function)
