"""load: reads any file or folder of redman."""
from __future__ import annotations

import os
from typing import Any, Callable, Union

from ._curve import curve
from ._error import FormatError
from ._files import as_path, must_exist
from ._importer import LOADERS
from ._map import Map
from ._paths import ENDINGS
from ._policy import Policy
from ._recording import Recording


def _map(path: Union[str, os.PathLike[str]]) -> Map:
    out = Map()
    out.load_file(path)
    return out


_LOADERS: dict[str, Callable[[Any], Any]] = {
    ".rdm": Policy.load, ".npz": Recording.load, ".ot": _map, ".bt": _map,
    **{ending: LOADERS[kind] for kind in ENDINGS for ending in ENDINGS[kind]}}


def load(path: Union[str, os.PathLike[str]]) -> Any:
    """Loads what the file or the folder at path contains: a Policy (.rdm or a run folder), a Recording (.npz), a Robot (.urdf,
    .xml, .mjcf, .robot), an Object (.object), a Task (.task), a Map (.ot, .bt) or a Curve (progress.csv).

    For what an agent has saved, use Agent.load or Agent.read_checkpoint of an agent with the same configuration.
    """
    must_exist(path, "load")
    file = as_path(path)
    if file.is_dir():
        return Policy.load(file)
    if file.name == "progress.csv":
        return curve(file.parent)
    with open(file, "rb") as opened:
        head = opened.read(8)
    if head in (b"RDMAGENT", b"RDMCHECK"):
        raise FormatError(f"load {file}: an agent has saved it: read it with agent.load(path), or agent.read_checkpoint(path, pool)")
    ending = file.suffix.lower()
    if ending not in _LOADERS:
        raise FormatError(f"load {file}: it is not a run folder, and its name ends in none of {', '.join(_LOADERS)}")
    return _LOADERS[ending](path)
