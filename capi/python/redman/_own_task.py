"""Task: a task of your own in Python; its functions handle all worlds of a pool at once, as rows of numpy arrays."""
from __future__ import annotations

import ctypes
import re
from ctypes import byref, c_int32, c_void_p
from typing import Any, Callable, ClassVar, Mapping, NamedTuple, Optional

import numpy as np

from . import _abi
from ._abi import OptionKind
from ._error import ArgumentError, UsageError
from ._library import assign, check, encoded, guarded, lib, sized
from ._names import nearest
from ._options import option_array, shown
from ._scene import SceneBuilder
from ._worlds_rows import Worlds

_MEMBERS = {"reward": "f8", "cost": ("f8", (_abi.RDM_MAX_COSTS,)), "cost_raw": ("f8", (_abi.RDM_MAX_COSTS,)),
            "terminated": "i4", "success": "i4"}
_VERDICT = np.dtype({"names": list(_MEMBERS), "formats": list(_MEMBERS.values()), "itemsize": ctypes.sizeof(_abi.rdm_verdict),
                     "offsets": [getattr(_abi.rdm_verdict, name).offset for name in _MEMBERS]})


# rdm_task_rows with plain addresses, which are read in every call.
class _Rows(ctypes.Structure):
    _fields_ = [(name, of if of in (ctypes.c_uint32, c_int32) else c_void_p) for name, of, *_ in _abi.rdm_task_rows._fields_]


_STREAM = "random stream"  # in the state of a task that draws

_MANY = ctypes.CFUNCTYPE(c_int32, c_void_p, c_void_p, c_void_p)


class Verdict(NamedTuple):
    """What Task.judge returns for n worlds: each member is [n], or one number for all of them."""

    reward: Any
    cost: Mapping[str, Any] = {}  # by name, at least 0 (a flag counts 1); what is left out is 0
    raw: Mapping[str, Any] = {}  # the measured value behind a cost; the cost itself where it is left out
    terminated: Any = False  # the episode ends here
    success: Any = False


class Task:
    """A task of your own: subclass it, and give the class wherever a task's name can be given.

        class PushBall(redman.Task):
            "Push a ball to the origin."
            max_steps, action_dim = 100, 2
            fields = {"position": (2, "m"), "velocity": (2, "m/s")}
            costs = {"right": (5, "x above 0.5 m")}
            options = {"mass": 0.2}

            def scene(self, s):
                self.ball = s.sphere("ball", 0.05, mass=s.option("mass"))
                s.plane()

            def reset(self, w):
                w.set_body(self.ball, p=np.c_[w.uniform(-1, 1, 2), np.full(w.n, 0.05)])

            def control(self, w, action):
                w.push(self.ball, force=np.c_[action, np.zeros(w.n)])

            def judge(self, w):
                x = w.position(self.ball)
                return redman.Verdict(-np.linalg.norm(x[:, :2], axis=1), {"right": x[:, 0] > 0.5})

            def observe(self, w):
                return w.position(self.ball)[:, :2], w.velocity(self.ball)[:, :2]

        redman.check_task(PushBall)
        run = redman.train(PushBall, steps=3e5)

    w is a Worlds of n rows: all worlds of the pool, or some of them; a row must depend on its own world alone, which
    check_task tests. What an episode has to remember is in `state`. An exception in a function is the cause of the
    redman.ArgumentError that Pool, reset or step raises; in a step it ends the episodes of the worlds in that call.
    """

    name: ClassVar[str] = ""  # letters, digits, '_'; the class's own name in lower case unless it is set
    max_steps: ClassVar[int] = 100  # control steps of an episode
    action_dim: ClassVar[int] = 0  # entries of an action, each in [-1, 1]; required
    fields: ClassVar[Mapping[str, Any]] = {}  # of an observation: name -> count, or (count, unit), or (count, unit, low, high)
    costs: ClassVar[Any] = {}  # name -> limit on an episode's sum, None: no limit; or (limit, help). The first is the one learners limit
    # name -> default: a number, a bool, a text; or (low, high), a range: scene gets it from s.option, and reset draws from it
    options: ClassVar[Mapping[str, Any]] = {}
    state: ClassVar[Mapping[str, int]] = {}  # name -> count of numbers that a world keeps over an episode: Worlds.state
    draws: ClassVar[bool] = False  # w.uniform and w.normal work in control and judge, too
    defaults: ClassVar[Mapping[str, Any]] = {}  # options of agents that learn it
    hold: ClassVar[Any] = None  # [action_dim] the action that holds still; None: 0
    mean: ClassVar[Any] = None  # [action_dim] that a new policy starts from; None: 0
    obs_limit: ClassVar[float] = 0.0  # entries of observations are cut at +- this; 0: none are

    _number: ClassVar[Optional[int]] = None  # of the class itself, while it is registered

    def scene(self, s: SceneBuilder) -> None:
        """Makes the world by s, a SceneBuilder, once a pool; keep the numbers of its parts in self."""

    def reset(self, w: Worlds) -> None:
        """Starts episodes: the worlds are as scene made them. w.uniform and w.normal draw random numbers."""

    def control(self, w: Worlds, action: Any) -> None:
        """Before a control step: from the clipped action [n][action_dim] to targets and pushes."""

    def judge(self, w: Worlds) -> Any:
        """After a control step: a Verdict, or the rewards [n] alone. w.step [n] counts from 1."""
        raise NotImplementedError(f"{type(self).__name__}.judge must be defined: it returns the reward")

    def observe(self, w: Worlds) -> Any:
        """The observations: a dict by field, a sequence in the order of `fields`, or one array [n][entries]."""
        raise NotImplementedError(f"{type(self).__name__}.observe must be defined: it returns the observation")

    def __init__(self) -> None:
        """No arguments: the library makes one for each pool."""

    @classmethod
    def register(cls) -> str:
        """Adds the task to the list of tasks, once, and returns its name. Functions that take a task call it."""
        if cls.__dict__.get("_number") is None:  # a subclass is a task of its own
            cls._number = _Description(cls).create()
        return cls.task_name()

    @classmethod
    def unregister(cls) -> None:
        """Removes it from the list, so that a changed class of that name can be registered; pools that have it keep it."""
        number = cls.__dict__.get("_number")
        if number is not None:
            check(lib.rdm_task_destroy(number))
            cls._number = None

    @classmethod
    def task_name(cls) -> str:
        """The name under which it is registered."""
        return cls.name or re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", cls.__name__).lower()


class RowTask(Task):
    """A task without bodies: a world is its state alone, and step computes the next one. Subclass it like Task, with step
    instead of scene, control and judge; w is a Worlds of n rows.

        class Cart(redman.RowTask):
            action_dim, fields, costs = 1, {"position": 1, "velocity": 1}, {"fast": (1, "faster than 1 m/s")}
            state = {"position": 1, "velocity": 1}

            def reset(self, w):
                w.state["position"] = w.uniform(-1, 1, 1)

            def step(self, w, action):
                s = w.state
                s["velocity"] += 0.05 * action
                s["position"] += 0.05 * s["velocity"]
                return redman.Verdict(-s["position"][:, 0] ** 2, {"fast": np.abs(s["velocity"][:, 0]) > 1})

            def observe(self, w):
                return w.state["position"], w.state["velocity"]
    """

    def __init_subclass__(cls, **more: Any) -> None:
        super().__init_subclass__(**more)
        cls.state = {**cls.state, "last_action": cls.action_dim}

    def scene(self, s: SceneBuilder) -> None:
        """Adds one body to s that nothing moves, since an engine needs something to step."""
        s.sphere("marker", 0.01, mass=0.01, weightless=True)

    def step(self, w: Worlds, action: Any) -> Any:
        """Computes the next state of the worlds w from the clipped action [n][action_dim]; returns a Verdict, or the rewards
        [n] alone."""
        raise NotImplementedError(f"{type(self).__name__}.step must be defined: it makes the next state and returns the reward")

    def control(self, w: Worlds, action: Any) -> None:
        """Keeps the action [n][action_dim] for step."""
        w.state["last_action"] = action

    def judge(self, w: Worlds) -> Any:
        """Returns the verdict of step."""
        return self.step(w, w.state["last_action"].astype(np.float32))


def _pair(value: Any) -> bool:
    return isinstance(value, (tuple, list)) and len(value) == 2 and all(isinstance(v, (int, float)) for v in value)


class _Description:
    """The rdm_task_def of a class, with everything that it points at and the functions that the library calls."""

    def __init__(self, kind: type[Task]) -> None:
        self.kind, self.kept = kind, list[Any]()
        self.made, self.made_of = list[Task](), dict[Any, int]()  # a task for each choice of options, and its place there
        self.where = kind.__name__
        if not isinstance(kind.action_dim, int) or kind.action_dim < 1:
            raise UsageError(f"{self.where}.action_dim: it must be the number of entries of an action, not {kind.action_dim!r}")
        if not kind.fields:
            raise UsageError(f"{self.where}.fields: it is empty: give the fields of the observation, such as {{\"position\": (3, \"m\")}}")
        self.fields = {name: self._field(name, row) for name, row in kind.fields.items()}
        self.width = sum(count for count, *_ in self.fields.values())
        self.costs = self._costs()
        self.columns = {name: k for k, name in enumerate(self.costs)}
        self.state, self.state_bytes = self._state()
        self.arrays: dict[tuple[int, Any], Any] = {}

    def _field(self, name: str, row: Any) -> tuple[int, str, float, float]:
        listed = [row] if isinstance(row, int) else list(row)
        if not listed or len(listed) not in (1, 2, 4) or not isinstance(listed[0], int):
            raise UsageError(f"{self.where}.fields[{name!r}]: it must be a count, (count, unit) or (count, unit, low, high), not {row!r}")
        low, high = (listed[2], listed[3]) if len(listed) == 4 else (0.0, 0.0)
        return listed[0], str(listed[1]) if len(listed) > 1 else "1", float(low), float(high)

    def _costs(self) -> dict[str, tuple[float, str]]:
        given = self.kind.costs if isinstance(self.kind.costs, Mapping) else {name: None for name in self.kind.costs}
        if not given:
            raise UsageError(f"{self.where}.costs: give at least one, such as {{\"right\": (5, \"x above 0.5 m\")}}; the limit None "
                             "means no limit")
        out = {}
        for name, row in given.items():
            limit, told = row if isinstance(row, (tuple, list)) else (row, name)
            out[name] = (-1.0 if limit is None else float(limit), str(told))
        return out

    def _state(self) -> tuple[Any, int]:
        if not self.kind.state and not self.kind.draws:
            return None, 0
        rows: list[Any] = [(name, "f8", (int(count),)) for name, count in self.kind.state.items()]
        if self.kind.draws:
            rows.append((_STREAM, f"V{ctypes.sizeof(_abi.rdm_random)}"))
        dtype = np.dtype(rows)
        return dtype, dtype.itemsize

    def create(self) -> int:
        kind, d = self.kind, sized(_abi.rdm_task_def)
        check(lib.rdm_task_def_init(byref(d), ctypes.sizeof(d)))
        summary = (kind.__doc__ or "").strip().split("\n")[0] if kind.__doc__ is not Task.__doc__ else ""
        d.name, d.summary = encoded(kind.task_name(), f"{self.where}.name"), encoded(summary, f"{self.where}.__doc__")
        assign(d, {"max_steps": kind.max_steps, "action_dim": kind.action_dim, "obs_limit": kind.obs_limit})
        d.state_bytes, d.instance_bytes = self.state_bytes, ctypes.sizeof(c_void_p)
        rows = (_abi.rdm_field_def * len(self.fields))()
        for row, (name, (count, unit, low, high)) in zip(rows, self.fields.items()):
            row.name, row.unit = encoded(name, f"{self.where}.fields"), encoded(unit, f"{self.where}.fields")
            row.count, row.low, row.high = count, low, high
        d.fields, d.num_fields = rows, len(rows)
        costs = (_abi.rdm_cost_def * len(self.costs))()
        for cost, (name, (limit, told)) in zip(costs, self.costs.items()):
            cost.name, cost.help, cost.limit = encoded(name, f"{self.where}.costs"), encoded(told, f"{self.where}.costs"), limit
        d.costs, d.num_costs = costs, len(costs)
        options = (_abi.rdm_option_def * len(kind.options))()
        for option, (key, value) in zip(options, kind.options.items()):
            self._option(option, key, value)
        d.options, d.num_options = options, len(options)
        defaults = option_array(kind.defaults, {key: OptionKind.TEXT for key in kind.defaults})
        d.defaults, d.num_defaults = defaults, len(defaults)
        self.kept += [rows, costs, options, defaults]
        for member in ("hold", "mean"):
            given = getattr(kind, member)
            if given is not None:
                array = np.ascontiguousarray(given, np.float32)
                if array.shape != (kind.action_dim,):
                    raise ArgumentError(f"{self.where}.{member}: its shape is {array.shape}, but must be ({kind.action_dim},)")
                setattr(d, member, array.ctypes.data)
                self.kept.append(array)
        kinds: dict[str, Any] = {field[0]: field[1] for field in _abi.rdm_task_def._fields_}
        for member in ("build", "reset_many", "control_many", "judge_many", "observe_many"):
            name = "scene" if member == "build" else member.replace("_many", "")
            call = guarded(f"{self.where}.{name}", getattr(self, "_" + member))
            function = kinds[member](call) if member == "build" else _MANY(call)
            setattr(d, member, ctypes.cast(function, kinds[member]))
            self.kept.append(function)
        out = c_int32()
        check(lib.rdm_task_create(byref(out), byref(d)))
        _descriptions[out.value] = self  # the library calls these functions as long as a pool has the task
        return out.value

    def _option(self, row: Any, key: str, value: Any) -> None:
        row.key, row.help = encoded(key, f"{self.where}.options"), encoded(f"of {self.where}", "help")
        if _pair(value):
            row.kind, row.choices, row.text = OptionKind.NUMBER, b"a..b", encoded(shown(key, value), key)
            row.number = (value[0] + value[1]) / 2
        elif isinstance(value, bool):
            row.kind, row.number = OptionKind.FLAG, int(value)
        elif isinstance(value, int):
            row.kind, row.number = OptionKind.INTEGER, value
        elif isinstance(value, float):
            row.kind, row.number = OptionKind.NUMBER, value
        elif isinstance(value, str):
            row.kind, row.text = OptionKind.TEXT, encoded(value, key)
        else:
            raise UsageError(f"{self.where}.options[{key!r}]: it must be a number, a bool, a text or (low, high), not {value!r}")
        row.low, row.high = (-2147483648, 2147483647) if row.kind == OptionKind.INTEGER else (-1e9, 1e9)

    # --- what the library calls

    def _build(self, user: Any, scene: Any, instance: Any) -> None:
        options = {key: self._value(scene, key, default) for key, default in self.kind.options.items()}
        task = self.kind()
        s = SceneBuilder(scene, options)
        try:
            task.scene(s)
        finally:
            s._end()
        # the same options make the same scene: one task for all pools of them
        chosen = tuple(options.values())
        if chosen not in self.made_of:
            self.made_of[chosen] = len(self.made)
            self.made.append(task)
        c_void_p.from_address(instance).value = 1 + self.made_of[chosen]

    def _value(self, scene: Any, key: str, default: Any) -> Any:
        if isinstance(default, str):
            out = ctypes.c_char_p()
            check(lib.rdm_scene_get_text(scene, encoded(key, "key"), byref(out)))
            return (out.value or b"").decode()
        low, high = ctypes.c_double(), ctypes.c_double()
        if _pair(default):
            check(lib.rdm_scene_get_range(scene, encoded(key, "key"), byref(low), byref(high)))
            return low.value, high.value
        check(lib.rdm_scene_get_number(scene, encoded(key, "key"), byref(low)))
        return type(default)(low.value)

    def _task(self, instance: int) -> Task:
        return self.made[(c_void_p.from_address(instance).value or 0) - 1]

    def _rows(self, at: int) -> tuple[Worlds, Any]:
        rows = _Rows.from_address(at)
        return Worlds(rows, self.state, self._array), rows

    def _stream(self) -> tuple[int, int]:
        """Offset of the stream in a state, and the bytes of a state."""
        return self.state.fields[_STREAM][1], self.state_bytes

    def _array(self, address: int, n: int, dtype: Any, width: int = 0) -> Any:
        """Rows of the library's memory, which it reuses between calls."""
        key = address, dtype
        known = self.arrays.get(key)
        if known is None or len(known) < n:
            size = np.dtype(dtype).itemsize * max(width, 1) * n
            memory: Any = (ctypes.c_char * size).from_address(address)
            known = np.frombuffer(memory, dtype)
            if width:
                known = known.reshape(n, width)
            if len(self.arrays) > 64:
                self.arrays.clear()
            self.arrays[key] = known
        return known[:n]

    def _reset_many(self, user: Any, instance: int, at: int) -> None:
        w, rows = self._rows(at)
        self._task(instance).reset(w)
        if self.kind.draws:
            w._keep_streams(rows.states, *self._stream())

    def _control_many(self, user: Any, instance: int, at: int) -> None:
        w, rows = self._rows(at)
        if self.kind.draws:
            w._draw_from(rows.states, *self._stream())
        self._task(instance).control(w, self._array(rows.actions, w.n, np.float32, self.kind.action_dim))

    def _judge_many(self, user: Any, instance: int, at: int) -> None:
        w, rows = self._rows(at)
        w.step = self._array(rows.steps, w.n, np.int32)
        if self.kind.draws:
            w._draw_from(rows.states, *self._stream())
        verdict = self._task(instance).judge(w)
        out = self._verdict_columns(rows.verdicts, w.n)
        if not isinstance(verdict, Verdict):
            verdict = Verdict(verdict)
        out["reward"][:w.n] = verdict.reward
        out["terminated"][:w.n], out["success"][:w.n] = verdict.terminated, verdict.success
        for name, value in verdict.cost.items():
            k = self._column(name)
            out["cost"][:w.n, k] = value
            if name not in verdict.raw:
                out["cost_raw"][:w.n, k] = value
        for name, value in verdict.raw.items():
            out["cost_raw"][:w.n, self._column(name)] = value

    def _verdict_columns(self, address: int, n: int) -> dict[str, Any]:
        """The members of at least n verdicts as arrays."""
        known = self.arrays.get((address, "columns"))
        if known is None or len(known["reward"]) < n:
            whole = self._array(address, n, _VERDICT)
            known = self.arrays[address, "columns"] = {name: whole[name] for name in _VERDICT.names or ()}
        return known

    def _column(self, name: str) -> int:
        if name not in self.columns:
            raise ArgumentError(f"{self.where}.judge: the task has no cost {name!r}{nearest(name, self.columns)}")
        return self.columns[name]

    def _observe_many(self, user: Any, instance: int, at: int) -> None:
        w, rows = self._rows(at)
        given = self._task(instance).observe(w)
        out = self._array(rows.obs, w.n, np.float32, self.width)
        if isinstance(given, Mapping):
            if given.keys() != self.fields.keys():
                odd = sorted(set(given) ^ set(self.fields))
                raise ArgumentError(f"{self.where}.observe: {', '.join(map(repr, odd))} should be both in fields and in what it returns")
            given = [given[name] for name in self.fields]
        if isinstance(given, np.ndarray):
            if given.shape != (w.n, self.width):
                raise ArgumentError(f"{self.where}.observe: shape {given.shape} is not ({w.n}, {self.width})")
            out[:] = given
            return
        if len(given) != len(self.fields):
            raise ArgumentError(f"{self.where}.observe: it returned {len(given)} arrays, but there are {len(self.fields)} fields")
        column = 0
        for array, (name, (count, *_)) in zip(given, self.fields.items()):
            shown = np.asarray(array)
            try:
                out[:, column:column + count] = shown if shown.ndim != 1 or count != 1 else shown[:, None]
            except ValueError:
                raise ArgumentError(f"{self.where}.observe: field {name!r} has shape {shown.shape}, not ({w.n}, {count})") from None
            column += count


_descriptions: dict[int, _Description] = {}
