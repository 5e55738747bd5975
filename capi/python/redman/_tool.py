"""Runs the command-line tool, for what only the tool can do, and is the commands `redman` and `python -m redman`."""
from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path
from typing import Optional

from ._error import ArgumentError, FileError, UnsupportedError
from ._files import must_exist
from ._library import lib


def tool_path() -> Optional[str]:
    """The path of the tool: REDMAN_TOOL, beside this package or the library, or on PATH; None if there is none. MissingFileError or
    FileError if REDMAN_TOOL names no program."""
    named = os.environ.get("REDMAN_TOOL")
    if not named:
        return _found()
    must_exist(named, "REDMAN_TOOL:")
    if not (os.path.isfile(named) and os.access(named, os.X_OK)):
        raise FileError(f"REDMAN_TOOL: {named}: it is not a program that can be run")
    return os.path.abspath(named)


def _found() -> Optional[str]:
    here, library = Path(__file__).resolve().parent, Path(lib._name).absolute()
    places = [here / "bin", here, *([library.parent / "bin"] if os.path.dirname(lib._name) else [])]
    tools = (place / "redman" for place in [*places, *map(Path, os.get_exec_path())])
    return next((str(tool) for tool in tools if _is_tool(tool)), None)


def _is_tool(path: Path) -> bool:
    """Whether it is a program, and not the script by which pip starts main()."""
    if not path.is_file() or not os.access(path, os.X_OK):
        return False
    try:
        with path.open("rb") as file:
            return b"redman._tool" not in file.read(4096)
    except OSError:  # a program that may be run and not read
        return True


def main() -> None:
    """Becomes the tool, with the arguments of this command. REDMAN_TOOL, which may name this very command, is not read.
    `data convert` of HDF5 files is done here."""
    words = sys.argv[1:]
    if words[:2] == ["data", "convert"] and any(w.lower().endswith((".hdf5", ".h5", ".minari", ".lerobot")) for w in words):
        from . import data
        from ._error import Error
        try:
            sys.exit(data.main(words[2:]))
        except (Error, OSError) as e:
            sys.exit(f"redman: {e}")
    tool = _found()
    if tool is None:
        sys.exit("redman: there is no command-line tool in this package, beside its library or on PATH")
    for name in ("SIGPIPE", "SIGXFSZ"):  # Python ignores them, and what it becomes would too
        if hasattr(signal, name):
            signal.signal(getattr(signal, name), signal.SIG_DFL)
    os.execv(tool, [tool, *sys.argv[1:]])


def run_tool(*arguments: str, why: str) -> None:
    """Runs the tool; its message becomes the text of the error."""
    tool = tool_path()
    if tool is None:
        raise UnsupportedError(f"{why} needs the command redman, which was not found: it is not in this package, it is not on PATH, and "
                               "REDMAN_TOOL is not set")
    done = subprocess.run([tool, *arguments], capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.returncode:
        said = (done.stderr.strip() or done.stdout.strip()).splitlines()
        raise ArgumentError(said[-1].removeprefix("redman: ") if said else f"{why}: redman ended with {done.returncode}")
