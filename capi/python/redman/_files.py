"""Files that are read and written whole."""
from __future__ import annotations

import contextlib
import errno
import itertools
import os
import stat
from pathlib import Path
from typing import Optional, Union

from ._error import FileError, MissingFileError
from ._library import encoded
from ._names import nearest


def _beside(path: Path) -> str:
    """'; nearest is NAME' of the files beside one that does not exist."""
    try:
        with os.scandir(path.parent) as entries:
            names = [entry.name for entry in itertools.islice(entries, 500)]
    except OSError:
        return f"; there is no folder {path.parent}"
    return nearest(path.name, names)


def as_path(value: Union[str, os.PathLike[str]], name: str = "path") -> Path:
    """An argument that is a path."""
    return Path(os.fsdecode(encoded(value, name)))


def must_exist(path: Union[str, os.PathLike[str]], what: str) -> None:
    """Raises MissingFileError with the nearest name if there is no such file; what: the kind of file."""
    if not as_path(path).exists():
        raise MissingFileError(f"{what} {os.fspath(path)}: there is no such file{_beside(as_path(path))}")


MOST_BYTES = 1 << 28  # of a policy or a checkpoint
MOST_TEXT = 1 << 26  # of a table
MOST_TASK = 1 << 22
MOST_JSON = 1 << 20


def read_bytes(path: Union[str, os.PathLike[str]], most: int) -> bytes:
    """The bytes of a regular file; OSError for anything else (a pipe is never waited for) or a longer file."""
    descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0))
    try:
        said = os.fstat(descriptor)
        if not stat.S_ISREG(said.st_mode):
            raise OSError(errno.EINVAL, "it is not a regular file")
        if said.st_size > most:
            raise OSError(errno.EFBIG, f"it is longer than {most} bytes")
        with open(descriptor, "rb", closefd=False) as file:
            return file.read(said.st_size)
    finally:
        os.close(descriptor)


def read_whole(path: Union[str, os.PathLike[str]], what: str, most: int = MOST_BYTES) -> bytes:
    """The bytes of a file; what: the kind of file, for error texts."""
    try:
        return read_bytes(path, most)
    except FileNotFoundError:
        raise MissingFileError(f"{what} {os.fspath(path)}: there is no such file{_beside(as_path(path))}") from None
    except OSError as error:
        raise FileError(f"{what} {os.fspath(path)}: {error.strerror}") from None


def _mode_of(path: Path) -> Optional[int]:
    """The permissions of a file that is to be replaced, None where there is none. OSError if it may not be."""
    try:
        said = path.stat()
    except FileNotFoundError:
        return None
    if not stat.S_ISREG(said.st_mode):
        raise OSError(errno.EINVAL, "it is not a regular file")
    if not os.access(path, os.W_OK):  # a replacement asks for the right to change the folder alone
        raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    return said.st_mode & 0o777


def write_whole(path: Union[str, os.PathLike[str]], data: bytes, what: str) -> None:
    """Writes a file entirely or leaves the old one: writes under another name first. A file that is replaced keeps its permissions;
    of a link, what it leads to is replaced."""
    target = Path(os.path.realpath(as_path(path)))
    temporary = Path(f"{target}.part")
    try:
        mode = _mode_of(target)
        how = os.O_WRONLY | os.O_CREAT | os.O_TRUNC | getattr(os, "O_BINARY", 0)
        with open(os.open(temporary, how, 0o666 if mode is None else mode), "wb") as file:
            file.write(data)
        if mode is not None:
            os.chmod(temporary, mode)  # what the umask took
        os.replace(temporary, target)
    except OSError as error:
        with contextlib.suppress(OSError):
            temporary.unlink()
        kind = MissingFileError if isinstance(error, FileNotFoundError) else FileError
        folder = as_path(path).parent
        why = f"folder {folder} is not there" if not folder.is_dir() else error.strerror
        raise kind(f"{what} {os.fspath(path)}: cannot be written: {why}") from None
