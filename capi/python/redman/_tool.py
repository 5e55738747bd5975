"""The command-line tool, for what it alone can do."""
from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path
from typing import Optional

from ._error import ArgumentError, UnsupportedError
from ._library import lib


def tool_path() -> Optional[str]:
    """The tool: REDMAN_TOOL, beside this package or the library, or on PATH; None: there is none."""
    named = os.environ.get("REDMAN_TOOL")
    if named:
        return named
    here, library = Path(__file__).resolve().parent, Path(lib._name).absolute()
    places = [here / "bin", here, *([library.parent / "bin"] if os.path.dirname(lib._name) else [])]
    for place in places:
        if (place / "redman").is_file() and os.access(place / "redman", os.X_OK):
            return str(place / "redman")
    return shutil.which("redman")


def run_tool(*arguments: str, why: str) -> None:
    """Runs the tool; its words are those of the error."""
    tool = tool_path()
    if tool is None:
        raise UnsupportedError(f"{why} is made by the command redman, which is not on PATH, nor where REDMAN_TOOL says")
    done = subprocess.run([tool, *arguments], capture_output=True, text=True, stdin=subprocess.DEVNULL)
    if done.returncode:
        said = (done.stderr.strip() or done.stdout.strip()).splitlines()
        raise ArgumentError(said[-1].removeprefix("redman: ") if said else f"{why}: redman ended with {done.returncode}")
