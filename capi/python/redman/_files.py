"""Files that are read and written whole."""
from __future__ import annotations

import contextlib
import itertools
import os
from pathlib import Path
from typing import Union

from ._error import FileError, MissingFileError
from ._names import nearest


def _beside(path: Path) -> str:
    """'; nearest is NAME' of what stands beside a file that is not there."""
    try:
        with os.scandir(path.parent) as entries:
            names = [entry.name for entry in itertools.islice(entries, 500)]
    except OSError:
        return f"; there is no folder {path.parent}"
    return nearest(path.name, names)


def read_whole(path: Union[str, os.PathLike[str]], what: str) -> bytes:
    """The bytes of a file; what: whose they are, for the text of an error."""
    try:
        return Path(path).read_bytes()
    except FileNotFoundError:
        raise MissingFileError(f"{what} {os.fspath(path)}: there is no such file{_beside(Path(path))}") from None
    except OSError as error:
        raise FileError(f"{what} {os.fspath(path)}: {error.strerror}") from None


def write_whole(path: Union[str, os.PathLike[str]], data: bytes, what: str) -> None:
    """Writes a file, or leaves what was there: under another name first."""
    temporary = Path(f"{os.fspath(path)}.part")
    try:
        temporary.write_bytes(data)
        os.replace(temporary, path)
    except OSError as error:
        with contextlib.suppress(OSError):
            temporary.unlink()
        kind = MissingFileError if isinstance(error, FileNotFoundError) else FileError
        folder = Path(path).parent
        why = f"folder {folder} is not there" if not folder.is_dir() else error.strerror
        raise kind(f"{what} {os.fspath(path)}: cannot be written: {why}") from None
