"""Texts of a task, robots and objects of your own that a run folder keeps in config.json, so that it is complete on other
machines: the members task_file, robot_files and object_files, as the command `redman train` writes and reads them."""
from __future__ import annotations

from typing import Any, Iterator, Mapping

from ._discovery import find
from ._error import ArgumentError, NotFoundError, UnsupportedError
from ._importer import load_object, load_robot, load_task, object_text, robot_text
from ._library import lib
from ._object import objects
from ._robot import added, robots

MEMBERS = ("task_file", "robot_files", "object_files")


def kept(options: Mapping[str, Any]) -> dict[str, dict[str, str]]:
    """robot_files and object_files for the options of a task: one for each name that is not the library's own."""
    names = {str(value) for value in options.values()}
    every = {"robot_files": {name: (robot_text, robot.number) for name, robot in robots().items() if robot.number in added},
             "object_files": {name: (object_text, thing.number) for name, thing in objects().items() if thing.own}}
    out: dict[str, dict[str, str]] = {}
    for member, rows in every.items():
        for name in names & rows.keys():
            text, number = rows[name]
            try:
                out.setdefault(member, {})[name] = text(number).decode()
            except UnsupportedError:  # no importer here, nor where one would read it
                pass
    return out


def load_kept(config: Mapping[str, Any], where: str) -> None:
    """Registers what a config.json holds and this process does not have yet. ArgumentError if the name is used by something
    else."""
    for kind, name, data in _texts(config):
        if not _is_known(kind, name):
            _LOADERS[kind](data)
        elif kind != "task" and _TEXTS[kind](_number(kind, name)) != data:
            raise ArgumentError(f"{where}: its {kind} {name} differs from the one of that name that is loaded already")


def _texts(config: Mapping[str, Any]) -> Iterator[tuple[str, str, bytes]]:
    for member in ("robot_files", "object_files"):
        for name, text in dict(config.get(member) or {}).items():
            yield member[:-len("_files")], str(name), str(text).encode()
    if config.get("task_file"):
        yield "task", str(config["task"]), str(config["task_file"]).encode()


_LOADERS: dict[str, Any] = {
    "robot": lambda data: load_robot(data, format="robot"), "object": load_object, "task": load_task}
_TEXTS = {"robot": robot_text, "object": object_text}


def _number(kind: str, name: str) -> int:
    return find({"task": lib.rdm_task_find, "robot": lib.rdm_robot_find, "object": lib.rdm_object_find}[kind], name)


def _is_known(kind: str, name: str) -> bool:
    try:
        return _number(kind, name) >= 0
    except NotFoundError:
        return False
