"""A policy as a file of another program."""
from __future__ import annotations

import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Optional, Union

from ._error import ArgumentError
from ._files import as_path
from ._library import encoded
from ._names import nearest
from ._tool import run_tool

if TYPE_CHECKING:
    from ._policy import Policy

_FLAGS = {".c": "--c", ".onnx": "--onnx", ".safetensors": "--safetensors"}


def export(policy: Policy, path: Union[str, os.PathLike[str]], name: Optional[str], int8: bool) -> None:
    """Policy.export."""
    target = as_path(path)
    ending = target.suffix.lower()
    if ending == ".rdm":
        policy.save(target)
        return
    if ending not in _FLAGS:
        raise ArgumentError(f"export: {target.name!r} ends in none of .rdm, {', '.join(_FLAGS)}{nearest(ending, _FLAGS)}")
    if ending != ".c" and (name is not None or int8):
        raise ArgumentError("export: name and int8 can only be given for a .c file")
    word = [] if name is None else ["--name", os.fsdecode(encoded(name, "name"))]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "policy.rdm")
        file.write_bytes(bytes(policy))
        more = word + (["--int8"] if int8 else [])
        run_tool("export", "--policy", str(file), _FLAGS[ending], str(target), *more, why=f"a {ending} file")
