"""Files of robots, objects and tasks, by the library libredman_import. Experimental, as redman/import.h is."""
from __future__ import annotations

import ctypes
import os
from ctypes import byref, c_int32
from functools import lru_cache
from pathlib import Path
from typing import Any, Callable, Optional, TypeVar, Union

from . import _abi, _import_abi
from ._discovery import TaskInfo, task_at
from ._error import Error, UnsupportedError, error_of
from ._files import must_exist
from ._library import Handle, assign, encoded, flag, lib, sized, text
from ._names import one_of
from ._object import Object, created as object_created, object_at
from ._robot import Note, Robot, created as robot_created, robot_at

Source = Union[str, "os.PathLike[str]", bytes]
Loaded = TypeVar("Loaded", Robot, Object, TaskInfo)


@lru_cache(maxsize=None)
def importer() -> ctypes.CDLL:
    """The library redman_import, which is beside libredman."""
    named, own = os.environ.get("REDMAN_IMPORT_LIBRARY"), Path(lib._name).absolute()
    if named:
        candidates = [named]
    elif os.path.dirname(lib._name):
        candidates = [str(path) for path in sorted(own.parent.glob(f"libredman_import{own.suffixes[0]}*"))[:1]]
    else:
        candidates = [f"libredman_import.so.{_abi.RDM_ABI}"]
    tried = [] if candidates else [f"there is none in {own.parent}"]
    for path in candidates:
        try:
            library = ctypes.CDLL(path)
            _import_abi.declare(library)
            return library
        except (OSError, AttributeError) as error:
            tried.append(str(error))
    raise UnsupportedError("files of robots, objects and tasks are read by libredman_import: " + "; ".join(tried) +
                           ". Set REDMAN_IMPORT_LIBRARY to its path")


def _check(code: int) -> int:
    if code:
        raise error_of(code, text(importer().rdm_import_error()))
    return code


def _read(call: str, *arguments: Any) -> Handle:
    """A handle of the importer."""
    function = importer()[call]
    function.argtypes, function.restype = list(_import_abi.FUNCTIONS[call].arguments.values()), c_int32
    return Handle(lambda *given: _check(function(*given)), importer().rdm_import_destroy, *arguments)


# What a file, by its kind and whole path, was loaded as: its time and size with the settings, and the number.
_loaded: dict[tuple[str, str], tuple[Any, int]] = {}


def _once(kind: str, path: Source, settings: Any, alive: Callable[[int], bool], at: Callable[[int], Loaded],
          make: Callable[[Optional[int]], Loaded]) -> Loaded:
    """What was made from the present version of a file; make is given the number of what was made from an older version."""
    if isinstance(path, bytes):
        return make(None)
    must_exist(path, kind)
    said = os.stat(path)
    key, stamp = (kind, os.path.realpath(path)), (said.st_mtime_ns, said.st_size, settings)
    before = _loaded.get(key)
    old = before[1] if before and alive(before[1]) else None
    if before and old is not None and before[0] == stamp:
        return at(old)
    out = make(old)
    _loaded[key] = (stamp, out.number)
    return out


def load_robot(path: Source, *, name: Optional[str] = None, kind: Optional[str] = None, format: str = "auto",
               root: Optional[str] = None, palm: Optional[str] = None, tips: Union[None, str, list[str]] = None,
               mount: Optional[str] = None, flange: Optional[str] = None, folder: Union[None, str, os.PathLike[str]] = None,
               packages: Union[None, str, os.PathLike[str]] = None, density: float = 0.0, slide_range: float = 0.0,
               skip_meshes: bool = False, mend_inertia: bool = False, check: bool = False) -> Robot:
    """Loads a robot from the URDF, MJCF or .robot file at path, or from the bytes of one, and registers it under its name, for
    option hand or arm of the hand tasks. Its notes say what was dropped, changed and guessed.

        robot = redman.load_robot("my.urdf", tips=["index_tip", "thumb_tip"], check=True)
        for note in robot.notes:
            print(note.line, note.text)

    name: None: the name in the file. kind: "hand", "arm", "other"; None: guessed, as are palm, tips, mount and flange, which
    are links (or sites). format: "urdf", "mjcf", "robot", or "auto": by the first element. root: the link whose subtree is
    read. folder: where meshes are, for bytes. packages: the folder of package:// names. density: kg/m3 of URDF links without
    <inertial>. slide_range: m to either side, range of a sliding joint without limits. skip_meshes: drops meshes that cannot
    be read. mend_inertia: raises moments that violate the triangle inequality. check: tries the robot alone and adds notes
    of what it finds.

    An unchanged file is not read again; a changed one replaces what was loaded from it.
    """
    config = sized(_import_abi.rdm_import_config)
    _check(importer().rdm_import_config_init(byref(config), ctypes.sizeof(config)))
    config.format = one_of(format, _numbers(_import_abi.ImportFormat), "format")
    if kind is not None:
        config.kind = one_of(kind, _numbers(_abi.RobotKind), "kind")
    joined = ",".join(map(str, tips)) if isinstance(tips, (list, tuple)) else tips
    words = {"name": name, "root": root, "palm": palm, "tips": joined, "mount": mount, "flange": flange, "folder": folder,
             "packages": packages}
    for key, value in words.items():
        setattr(config, key, None if value is None else encoded(value, key))
    assign(config, {"density": density, "slide_range": slide_range, "skip_meshes": flag(skip_meshes, "skip_meshes"),
                    "mend_inertia": flag(mend_inertia, "mend_inertia")})

    def make(old: Optional[int]) -> Robot:
        if isinstance(path, bytes):
            read = _read("rdm_import_read", path, len(path), byref(config))
        else:
            read = _read("rdm_import_read_file", encoded(path, "path"), byref(config))
        if flag(check, "check"):
            _check(importer().rdm_import_check(read.value))
        struct = sized(_abi.rdm_robot_def)
        _check(importer().rdm_import_get_robot_def(read.value, byref(struct)))
        if old is not None:
            lib.rdm_robot_destroy(old)
        with _naming(path):
            return robot_created(struct, _notes_of(read))

    settings = (*words.values(), kind, format, density, slide_range, skip_meshes, mend_inertia, check)
    return _once("robot", path, settings, lambda i: _alive(lib.rdm_robot_at, _abi.rdm_robot, i), robot_at, make)


def load_object(path: Source) -> Object:
    """Loads an object from the .object file at path, or from the bytes of one, and registers it under its name, for option
    object.

    An unchanged file is not read again; a changed one replaces what was loaded from it.
    """
    def make(old: Optional[int]) -> Object:
        if isinstance(path, bytes):
            read = _read("rdm_import_read_object", path, len(path))
        else:
            read = _read("rdm_import_read_object_file", encoded(path, "path"))
        struct = sized(_abi.rdm_object_def)
        _check(importer().rdm_import_get_object_def(read.value, byref(struct)))
        if old is not None:
            lib.rdm_object_destroy(old)
        with _naming(path):
            return object_created(struct)

    return _once("object", path, None, lambda i: _alive(lib.rdm_object_info_at, _abi.rdm_object_info, i), object_at, make)


def load_task(path: Source) -> TaskInfo:
    """Loads a task from the .task file at path, or from the bytes of one: its scene, observation, rewards and costs as text. It
    is registered under its name, and can be used wherever a task of the library can.

    An unchanged file is not read again; a changed one replaces what was loaded from it.
    """
    def make(old: Optional[int]) -> TaskInfo:
        if old is not None:
            lib.rdm_task_destroy(old)
        number = c_int32()
        with _naming(path):
            if isinstance(path, bytes):
                _check(importer().rdm_import_read_task(byref(number), path, len(path), None))
            else:
                _check(importer().rdm_import_read_task_file(byref(number), encoded(path, "path")))
        return task_at(number.value)

    return _once("task", path, None, lambda i: _alive(lib.rdm_task_at, _abi.rdm_task, i), task_at, make)


LOADERS: dict[str, Callable[..., Any]] = {"robot": load_robot, "object": load_object, "task": load_task}


def robot_text(number: int) -> bytes:
    """A robot as a .robot file."""
    read = _read("rdm_import_create_robot", number)
    struct = sized(_abi.rdm_robot_def)
    _check(importer().rdm_import_get_robot_def(read.value, byref(struct)))
    return _text_of(importer().rdm_import_write_robot, struct)


def object_text(number: int) -> bytes:
    """An object as an .object file."""
    read = _read("rdm_import_create_object", number)
    struct = sized(_abi.rdm_object_def)
    _check(importer().rdm_import_get_object_def(read.value, byref(struct)))
    return _text_of(importer().rdm_import_write_object, struct)


def _text_of(call: Callable[..., int], struct: ctypes.Structure) -> bytes:
    size = ctypes.c_size_t()
    _check(call(byref(struct), None, 0, byref(size)))
    raw = ctypes.create_string_buffer(size.value + 1)
    _check(call(byref(struct), raw, len(raw), byref(size)))
    return raw.raw[:size.value]


def _notes_of(read: Handle) -> tuple[Note, ...]:
    row, out = _import_abi.rdm_import_note(), []
    for i in range(importer().rdm_import_note_count(read.value)):
        _check(importer().rdm_import_note_at(read.value, i, byref(row)))
        out.append(Note(row))
    return tuple(out)


def _numbers(words: Any) -> dict[str, int]:
    return {member.name.lower(): int(member) for member in words}


def _alive(call: Callable[..., int], kind: type[ctypes.Structure], number: int) -> bool:
    return call(number, byref(sized(kind))) == 0


class _naming:
    """Makes errors begin with the name of the file that they are about."""

    def __init__(self, path: Source) -> None:
        self._file = "" if isinstance(path, bytes) else os.fspath(path)

    def __enter__(self) -> None:
        pass

    def __exit__(self, _: Any, error: Any, __: Any) -> None:
        if isinstance(error, Error) and self._file and not str(error).startswith(self._file):
            told = type(error)(f"{self._file}: {error}")
            told.code = error.code
            raise told from None
