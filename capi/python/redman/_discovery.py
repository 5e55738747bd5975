"""Lists of tasks, algorithms, robots and objects, each with all that the library says about it."""
from __future__ import annotations

import ctypes
import os
import re
from ctypes import byref, c_int32
from functools import lru_cache
from typing import TYPE_CHECKING, Any, Callable, Dict, Iterable, Iterator, Optional, TypeVar, Union

from . import _abi
from ._abi import OptionKind, OptionLevel
from ._error import NotFoundError, UsageError
from ._library import check, encoded, filled, forget_raised, lib, sized
from ._names import nearest
from ._options import Value, default_of, laid
from ._paths import is_file, named
from ._record import Record

if TYPE_CHECKING:
    from ._own_task import Task

R = TypeVar("R", bound=Record)


class Option(_abi.OptionSpec):
    """One row of an option table; the type of default follows its kind: a text, a number or a flag."""

    kind: OptionKind
    level: OptionLevel
    default: Value

    def __init__(self, struct: _abi.rdm_option_spec) -> None:
        super().__init__(struct)
        self.__dict__.update(kind=OptionKind(struct.kind), level=OptionLevel(struct.level), default=default_of(struct))


class Cost(_abi.CostInfo):
    """A cost column. limit: the limit on its sum over an episode, None where there is none."""

    limit: Optional[float]  # type: ignore[assignment]

    def __init__(self, struct: _abi.rdm_cost_info) -> None:
        super().__init__(struct)
        self.__dict__["limit"] = None if struct.limit < 0 else struct.limit


class Field(_abi.FieldInfo):
    """Consecutive entries of an observation, obs[:, field.slice], and their bounds; nan: none."""

    @property
    def slice(self) -> slice:
        """The slice of its entries in a row."""
        return slice(self.offset, self.offset + self.count)

    @property
    def scale(self) -> float:
        """The value in SI units of an entry of 1: 5 for "5 m/s", 1 for "m"; nan if the entries of the field differ."""
        number, _, rest = self.unit.partition(" ")
        if not rest:
            return 1.0
        try:
            return float(number)
        except ValueError:  # "N m", or "2, 20 rad/s"
            return float("nan") if "," in number else 1.0


class Camera(_abi.CameraInfo):
    """A pinhole camera: its optical axis runs from eye to target, and meets the picture cx of its width to the right of
    its centre, cy of its height below it."""


class Shape(_abi.ShapeInfo):
    """A shape of the scene; kind is a redman.ShapeKind."""


class Joint(_abi.JointInfo):
    """A joint of a robot, or of a pool's worlds; kind is a redman.JointKind."""


class Named(Dict[str, R]):
    """What a task, an algorithm or a pool has, by name. NotFoundError offers the nearest name."""

    def __init__(self, rows: Iterable[R], what: str, owner: str) -> None:
        super().__init__((getattr(row, "name", "") or getattr(row, "key"), row) for row in rows)
        self._what, self._owner = what, owner

    def unknown(self, name: object) -> NotFoundError:
        return NotFoundError(f"{self._what} {name}: {self._owner} has none of that name{nearest(str(name), self)}")

    def __missing__(self, name: object) -> R:
        raise self.unknown(name)

    def copy(self) -> Named[R]:
        return Named(self.values(), self._what, self._owner)


def fields_of(owner: int, name: str, count: int, call: Callable[..., int]) -> Named[Field]:
    """All fields of a task or a pool by name."""
    return Named(_records(Field, _abi.rdm_field_info, call, count, owner), "field", name)


def _records(kind: type[R], struct: type[ctypes.Structure], call: Callable[..., int], count: int, *before: Any) -> Iterator[R]:
    """Records of all i that call(*before, i, &struct) knows."""
    return (kind(filled(struct, call, *before, i)) for i in range(count))


def all_of(kind: type[R], struct: type[ctypes.Structure], call: Callable[..., int], *before: Any) -> list[R]:
    """Records of all rows that call(*before, i, &struct) gives, until it returns RANGE."""
    out: list[R] = []
    row = sized(struct)
    while not call(*before, len(out), byref(row)):
        out.append(kind(row))
    return out


class Listed(Dict[str, R]):
    """A dict of what exists, by name; other names that the library knows, such as aliases, are found too. NotFoundError
    offers the nearest name."""

    def __init__(self, rows: Iterable[R], called: Callable[[str], R]) -> None:
        super().__init__((getattr(row, "name"), row) for row in rows)
        self._called = called

    def __missing__(self, name: str) -> R:
        return self._called(name)


class TaskInfo(_abi.Task):
    """A task with its default options; fields, costs, options and cameras by name, in their order."""

    number: int  # of the task in this process
    fields: dict[str, Field]
    costs: dict[str, Cost]
    options: dict[str, Option]
    cameras: dict[str, Camera]
    defaults: dict[str, Value]  # of learner options: rdm_task_default_at

    def __init__(self, index: int) -> None:
        super().__init__(filled(_abi.rdm_task, lib.rdm_task_at, index))
        said = self.__dict__
        said["number"] = index
        said["fields"] = fields_of(index, self.name, self.num_fields, lib.rdm_task_field_at)
        for what, kind, struct, call, count in (
                ("cost", Cost, _abi.rdm_cost_info, lib.rdm_task_cost_at, self.cost_dim),
                ("option", Option, _abi.rdm_option_spec, lib.rdm_task_option_at, self.num_options),
                ("camera", Camera, _abi.rdm_camera_info, lib.rdm_task_camera_at, self.num_cameras)):
            said[f"{what}s"] = Named(_records(kind, struct, call, count, index), what, self.name)
        said["defaults"] = laid(
            filled(_abi.rdm_option, lib.rdm_task_default_at, index, i) for i in range(self.num_defaults))

    def __repr__(self) -> str:
        return f"<Task {self.name}: {self.summary}>"

    def remove(self) -> None:
        """Removes a task of your own, or of a .task file, from this process; pools that have it keep it."""
        check(lib.rdm_task_destroy(self.number))


class Algo(_abi.Algo):
    """A learner with its options by name."""

    options: dict[str, Option]

    def __init__(self, index: int) -> None:
        super().__init__(filled(_abi.rdm_algo, lib.rdm_algo_at, index))
        self.__dict__["options"] = Named(
            _records(Option, _abi.rdm_option_spec, lib.rdm_algo_option_at, self.num_options, index), "option", self.name)

    def __repr__(self) -> str:
        return f"<Algo {self.name}: {self.summary}>"


# Of functions that take a task: its name, its .task file, its id in Gymnasium, what task(name) gave, or the class of your own.
TaskName = Union[str, "os.PathLike[str]", TaskInfo, "type[Task]"]


@lru_cache(maxsize=None)
def task_at(index: int) -> TaskInfo:
    return TaskInfo(index)


@lru_cache(maxsize=None)
def algo_at(index: int) -> Algo:
    return Algo(index)


def find(call: Callable[..., int], name: str) -> int:
    """The index of a task or an algorithm by its name."""
    index = c_int32()
    check(call(encoded(name, "name"), byref(index)))
    return index.value


def listed(at: Callable[[int], R], struct: type[ctypes.Structure], call: Callable[..., int], count: int) -> Iterator[R]:
    """Records of the numbers below count, without those that were destroyed or whose class has a scene that raises; the library is
    asked for cached ones too."""
    row = sized(struct)
    for index in range(count):
        if call(index, byref(row)) == 0:
            yield at(index)
        else:
            forget_raised()


def tasks() -> dict[str, TaskInfo]:
    """All tasks by name; empty in a build without simulation. A class of your own whose scene raises is left out; redman.Pool
    raises its error."""
    return Listed(listed(task_at, _abi.rdm_task, lib.rdm_task_at, lib.rdm_task_count()), task)


def algos() -> dict[str, Algo]:
    """All learners by name; empty in a build without learning."""
    return Listed(map(algo_at, range(lib.rdm_algo_count())), algo)


def task(name: TaskName) -> TaskInfo:
    """One task; case is ignored and '-' equals '_'. NotFoundError offers the nearest name."""
    return task_at(find(lib.rdm_task_find, task_name(name)))


def task_name(task: TaskName) -> str:
    """The name of a task that is given by its name, as a TaskInfo, a .task file, an id of its environments (redman/BallRun-v0),
    or as the class of a task in Python, which is then registered."""
    if isinstance(task, TaskInfo):
        return task.name
    if isinstance(task, type) and hasattr(task, "register"):
        return task.register()
    if not isinstance(task, (str, os.PathLike)):
        raise UsageError(f"task: it must be the name of a task, a .task file or a subclass of redman.Task, not {task!r}")
    return _of_id(named("task", task))


# Ids of redman.gym, safety and omnisafe, also without their prefix or version.
_ID = re.compile(r"(?:redman/|SafetyRedman|Safety|Redman)?(\w+?)(?:-v\d+)?")


def _of_id(word: str) -> str:
    """The task that an id stands for; a word that is no id stays."""
    found = _ID.fullmatch(word)
    if not found or not lib.rdm_task_find(encoded(word, "task"), byref(c_int32())):
        return word
    short = found[1].replace("_", "").lower()
    return next((name for name in tasks() if name.replace("_", "").lower() == short), found[1])


def task_kept(task: TaskName) -> TaskName:
    """What another process needs to make the task again: its class, its file, or its name."""
    name = task_name(task)
    if isinstance(task, type):
        return task
    return os.path.abspath(os.fspath(task)) if not isinstance(task, TaskInfo) and is_file("task", task) else name


def algo(name: str) -> Algo:
    """One learner by its name, found as task() finds."""
    return algo_at(find(lib.rdm_algo_find, name))


def options_of(call: Callable[..., int]) -> dict[str, Option]:
    """All options by key that call(i, &row) gives."""
    return {option.key: option for option in all_of(Option, _abi.rdm_option_spec, call)}


@lru_cache(maxsize=None)
def _shield_options() -> dict[str, Option]:
    return options_of(lib.rdm_shield_option_at)


def shield_options() -> dict[str, Option]:
    """The options of a Shield by name, each with its help, default and bounds; empty in a build without simulation."""
    return dict(_shield_options())


@lru_cache(maxsize=None)
def _planner_options() -> dict[str, Option]:
    return options_of(lib.rdm_planner_option_at)


def planner_options() -> dict[str, Option]:
    """The options of a Planner by name, each with its help, default and bounds; empty in a build without simulation."""
    return dict(_planner_options())


def features() -> _abi.Feature:
    """The parts that this library was built with: Feature.SIM | Feature.LEARN | Feature.POLICY."""
    return _abi.Feature(lib.rdm_features())


def build() -> _abi.Build:
    """Version and build of the loaded library."""
    return _abi.Build(filled(_abi.rdm_build, lib.rdm_build_info))
