"""Records: what the library fills in a struct, as plain Python values; and its enums."""
from __future__ import annotations

import ctypes
import enum
from typing import Any


def _plain(value: Any) -> Any:
    if isinstance(value, bytes):
        return value.decode("utf-8", errors="replace")
    return tuple(value) if isinstance(value, ctypes.Array) else value


class Members(enum.EnumMeta):
    """Makes help and completion of an enum show only its members, not the methods of int."""

    def __dir__(cls) -> list[str]:
        return ["__doc__", "__module__", *cls.__members__]


class Record:
    """Values of a struct by name, not to be changed: texts are str, arrays are tuples, a NULL text is None."""

    def __init__(self, struct: ctypes.Structure) -> None:
        for kind in type(self).__mro__:
            for name in kind.__dict__.get("__annotations__", ()):
                if hasattr(struct, name):
                    self.__dict__[name] = _plain(getattr(struct, name))

    def __setattr__(self, name: str, value: Any) -> None:
        raise AttributeError(f"{type(self).__name__}.{name} is what the library said; it cannot be set")

    def __eq__(self, other: object) -> bool:
        return type(self) is type(other) and self.__dict__ == other.__dict__

    def __hash__(self) -> int:
        return hash((type(self), repr(self)))

    def __repr__(self) -> str:
        return f"{type(self).__name__}({', '.join(f'{name}={value!r}' for name, value in self.__dict__.items())})"
