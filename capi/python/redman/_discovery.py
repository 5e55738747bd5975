"""What exists: tasks, algorithms, robots, objects, each with all that the library says of it."""
from __future__ import annotations

import ctypes
import re
from ctypes import byref, c_int32
from functools import lru_cache
from typing import Any, Callable, Iterator, Optional, TypeVar, Union

from . import _abi
from ._abi import OptionKind, OptionLevel
from ._error import NotFoundError, UsageError
from ._library import encoded, filled, check, lib, sized
from ._options import Value, default_of, laid
from ._record import Record

R = TypeVar("R", bound=Record)


class Option(_abi.OptionSpec):
    """One row of an option table; default is as its kind says: a text, a number or a flag."""

    kind: OptionKind
    level: OptionLevel
    default: Value

    def __init__(self, struct: _abi.rdm_option_spec) -> None:
        super().__init__(struct)
        self.__dict__.update(kind=OptionKind(struct.kind), level=OptionLevel(struct.level), default=default_of(struct))


class Cost(_abi.CostInfo):
    """A cost column. limit: on its sum over an episode, None where there is none."""

    limit: Optional[float]  # type: ignore[assignment]

    def __init__(self, struct: _abi.rdm_cost_info) -> None:
        super().__init__(struct)
        self.__dict__["limit"] = None if struct.limit < 0 else struct.limit


class Field(_abi.FieldInfo):
    """A run of observation entries, obs[:, field.slice], and the bounds that they keep; nan: none."""

    @property
    def slice(self) -> slice:
        return slice(self.offset, self.offset + self.count)


class Camera(_abi.CameraInfo):
    """A pinhole camera: its optical axis runs from eye to target, and meets the picture cx of its width to the right of
    its centre, cy of its height below it."""


class Shape(_abi.ShapeInfo):
    """A part of what the scene is made of; kind is a redman.ShapeKind."""


class Object(_abi.ObjectInfo):
    """An object by name, for option object; kind is the redman.ShapeKind of its only shape, -1 where it has several."""


class Joint(_abi.JointInfo):
    """A joint of a robot, or of a pool's worlds; kind is a redman.JointKind."""


def fields_of(owner: int, count: int, call: Callable[..., int]) -> dict[str, Field]:
    """All fields of a task or a pool by name."""
    return _records(Field, _abi.rdm_field_info, call, count, owner)


def _records(kind: type[R], struct: type[ctypes.Structure], call: Callable[..., int], count: int,
             *before: Any) -> dict[str, R]:
    """name -> record for all i that call(*before, i, &struct) knows."""
    rows = (kind(filled(struct, call, *before, i)) for i in range(count))
    return {getattr(row, "name", "") or getattr(row, "key"): row for row in rows}


class Task(_abi.Task):
    """A task with its default options; fields, costs, options and cameras by name, in their order."""

    fields: dict[str, Field]
    costs: dict[str, Cost]
    options: dict[str, Option]
    cameras: dict[str, Camera]
    defaults: dict[str, Value]  # of learner options: rdm_task_default_at

    def __init__(self, index: int) -> None:
        super().__init__(filled(_abi.rdm_task, lib.rdm_task_at, index))
        said = self.__dict__
        said["fields"] = fields_of(index, self.num_fields, lib.rdm_task_field_at)
        said["costs"] = _records(Cost, _abi.rdm_cost_info, lib.rdm_task_cost_at, self.cost_dim, index)
        said["options"] = _records(Option, _abi.rdm_option_spec, lib.rdm_task_option_at, self.num_options, index)
        said["cameras"] = _records(Camera, _abi.rdm_camera_info, lib.rdm_task_camera_at, self.num_cameras, index)
        said["defaults"] = laid(
            filled(_abi.rdm_option, lib.rdm_task_default_at, index, i) for i in range(self.num_defaults))

    def __repr__(self) -> str:
        return f"<Task {self.name}: {self.summary}>"


class Algo(_abi.Algo):
    """A learner with its options by name."""

    options: dict[str, Option]

    def __init__(self, index: int) -> None:
        super().__init__(filled(_abi.rdm_algo, lib.rdm_algo_at, index))
        self.__dict__["options"] = _records(
            Option, _abi.rdm_option_spec, lib.rdm_algo_option_at, self.num_options, index)

    def __repr__(self) -> str:
        return f"<Algo {self.name}: {self.summary}>"


class Robot(_abi.Robot):
    """A robot description with its joints by name."""

    joints: dict[str, Joint]

    def __init__(self, index: int) -> None:
        super().__init__(filled(_abi.rdm_robot, lib.rdm_robot_at, index))
        self.__dict__["joints"] = _records(
            Joint, _abi.rdm_joint_info, lib.rdm_robot_joint_at, self.num_joints, index)


@lru_cache(maxsize=None)
def task_at(index: int) -> Task:
    return Task(index)


@lru_cache(maxsize=None)
def algo_at(index: int) -> Algo:
    return Algo(index)


def find(call: Callable[..., int], name: str) -> int:
    """The index of a task or an algorithm by its name."""
    index = c_int32()
    check(call(encoded(name), byref(index)))
    return index.value


def _listed(at: Callable[[int], R], count: int) -> Iterator[R]:
    """Those of the numbers below count that were not destroyed since."""
    for index in range(count):
        try:
            yield at(index)
        except NotFoundError:
            pass


def tasks() -> dict[str, Task]:
    """All tasks by name; empty without the simulation half."""
    return {task.name: task for task in _listed(task_at, lib.rdm_task_count())}


def algos() -> dict[str, Algo]:
    """All learners by name; empty without the learning half."""
    return {algo.name: algo for algo in map(algo_at, range(lib.rdm_algo_count()))}


def task(name: Union[str, Task]) -> Task:
    """One task; case is ignored and '-' equals '_'. NotFoundError offers the nearest name."""
    return task_at(find(lib.rdm_task_find, task_name(name)))


def task_name(task: Union[str, Task]) -> str:
    """The name of a task that is given as its name, as Task, or as its id in Gymnasium (redman/BallRun-v0)."""
    if isinstance(task, Task):
        return task.name
    if not isinstance(task, str):
        raise UsageError(f"task: the name of a task, not {task!r}")
    found = re.fullmatch(r"redman/(\w+)-v\d+", task)
    return found[1] if found else task


def algo(name: str) -> Algo:
    """One learner, found as task() finds."""
    return algo_at(find(lib.rdm_algo_find, name))


def robots() -> dict[str, Robot]:
    """All robot descriptions by name."""
    return {robot.name: robot for robot in _listed(Robot, lib.rdm_robot_count())}


@lru_cache(maxsize=None)
def _shield_options() -> dict[str, Option]:
    row = sized(_abi.rdm_option_spec)
    out: dict[str, Option] = {}
    while not lib.rdm_shield_option_at(len(out), byref(row)):
        option = Option(row)
        out[option.key] = option
    return out


def shield_options() -> dict[str, Option]:
    """The options of a Shield by name, each with its help, default and bounds; empty without the simulation half."""
    return dict(_shield_options())


def objects() -> dict[str, Object]:
    """All objects by name, for option object."""
    return {thing.name: thing for thing in _listed(
        lambda index: Object(filled(_abi.rdm_object_info, lib.rdm_object_info_at, index)), lib.rdm_object_count())}


def build() -> _abi.Build:
    """Version and build of the library that runs."""
    return _abi.Build(filled(_abi.rdm_build, lib.rdm_build_info))
