"""Files instead of names: a file that describes a task, a robot or an object stands for the name of what it describes."""
from __future__ import annotations

import os
from typing import Any, Mapping, Union

from ._record import Record

ENDINGS = {"task": (".task",), "robot": (".urdf", ".xml", ".mjcf", ".robot"), "object": (".object",)}


def is_file(kind: str, name: Any) -> bool:
    """Whether a given name of a task, a robot or an object is a file."""
    return isinstance(name, (str, os.PathLike)) and str(name).lower().endswith(ENDINGS[kind])


def named(kind: str, name: Union[str, os.PathLike[str]]) -> str:
    """The name; for a file, the name of what it describes, which is loaded if it was not yet."""
    if not is_file(kind, name):
        return os.fspath(name)
    from . import _importer
    called: str = _importer.LOADERS[kind](name).name
    return called


def by_name(options: Mapping[str, Any]) -> dict[str, Any]:
    """Options with each Robot or Object replaced by its name."""
    return {key: getattr(value, "name") if isinstance(value, Record) else value for key, value in options.items()}


def named_options(options: Mapping[str, Any]) -> dict[str, Any]:
    """Options with each file of a robot or object, and each Robot or Object, replaced by its name."""
    return {key: next((named(kind, value) for kind in ("robot", "object") if is_file(kind, value)), value)
            for key, value in by_name(options).items()}
