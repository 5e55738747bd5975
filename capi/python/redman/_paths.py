"""Files where a name is meant: a task, a robot or an object that a file describes stands for the name that it has."""
from __future__ import annotations

import os
from typing import Any, Mapping, Union

from ._record import Record

ENDINGS = {"task": (".task",), "robot": (".urdf", ".xml", ".mjcf", ".robot"), "object": (".object",)}


def is_file(kind: str, name: Any) -> bool:
    """Whether a name of a task, a robot or an object is a file of one."""
    return isinstance(name, (str, os.PathLike)) and str(name).lower().endswith(ENDINGS[kind])


def named(kind: str, name: Union[str, os.PathLike[str]]) -> str:
    """The name; that of what a file describes, which is loaded unless it was."""
    if not is_file(kind, name):
        return os.fspath(name)
    from . import _importer
    called: str = _importer.LOADERS[kind](name).name
    return called


def by_name(options: Mapping[str, Any]) -> dict[str, Any]:
    """Options where a Robot or an Object is its name."""
    return {key: getattr(value, "name") if isinstance(value, Record) else value for key, value in options.items()}


def named_options(options: Mapping[str, Any]) -> dict[str, Any]:
    """Options where files of robots and objects, and a Robot or an Object, are the names of these."""
    return {key: next((named(kind, value) for kind in ("robot", "object") if is_file(kind, value)), value)
            for key, value in by_name(options).items()}
