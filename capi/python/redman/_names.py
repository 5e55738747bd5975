"""Unknown names: the nearest known one, or what to write instead."""
from __future__ import annotations

import ctypes
import functools
import inspect
from typing import TYPE_CHECKING, Any, Callable, ClassVar, Iterable, Mapping, TypeVar

from . import _abi
from ._error import ArgumentError, UsageError
from ._library import Thing, check, encoded, lib, text
from ._options import as_dict

Function = TypeVar("Function", bound=Callable[..., Any])

# What other libraries call our options.
WORDS = {
    "lr": "learning_rate", "gamma": "discount", "lam": "lambda", "gae_lambda": "lambda", "clip_range": "clip",
    "clip_ratio": "clip", "ent_coef": "entropy", "entropy_coef": "entropy", "hidden_sizes": "hidden",
    "net_arch": "hidden", "n_epochs": "passes", "update_iters": "passes", "target_kl": "kl_target",
    "n_steps": "horizon", "frame_skip": "action_repeat", "max_episode_steps": "max_steps", "episode_length": "max_steps",
    "lambda_lr": "multiplier_lr", "obs_normalize": "normalize_obs"}


def folded(name: str) -> str:
    """As the library compares names: case is ignored, and "-" equals "_"."""
    return name.lower().replace("-", "_")


def meant(name: str, known: Iterable[str]) -> str:
    """The known name that another library's word stands for; "" for none."""
    own = WORDS.get(folded(name), "")
    return own if own in set(known) else ""


def nearest(name: str, known: Iterable[str]) -> str:
    """'; nearest is NAME', or several, or "" where none is near, as in the library's error texts."""
    names = sorted(known)
    if own := meant(name, names):
        return f"; nearest is {own}"
    out = ctypes.create_string_buffer(4 * _abi.RDM_TEXT_SIZE)
    check(lib.rdm_nearest_names(encoded(name.replace("\0", " "), "name"), encoded("\n".join(names), "names"), out, len(out)))
    return text(out.value)


def one_of(value: Any, known: Mapping[str, Thing], name: str) -> Thing:
    """What a word stands for that an argument must be."""
    if not isinstance(value, str) or value not in known:
        raise ArgumentError(f"{name}: {value!r} is none of {', '.join(known)}{nearest(str(value), known)}")
    return known[value]


def keywords(*, aliases: Mapping[str, str] = {}, hints: Mapping[str, str] = {},
             options: bool = False) -> Callable[[Function], Function]:
    """A function that also accepts aliases of its arguments; for other unknown ones, the error says what to write instead.

    options: the name of the argument that keywords which are options of a task, an algorithm, a shield or a planner go into.
    """
    def wrap(function: Function) -> Function:
        names = list(inspect.signature(function).parameters)
        known = frozenset(names)

        @functools.wraps(function)
        def call(*args: Any, **given: Any) -> Any:
            if not known.issuperset(given):
                given = _known(function, names[:len(args)], given, known, aliases, hints, options)
            return function(*args, **given)

        return call  # type: ignore[return-value]
    return wrap


def _known(function: Callable[..., Any], placed: list[str], given: dict[str, Any], known: frozenset[str],
           aliases: Mapping[str, str], hints: Mapping[str, str], options: bool) -> dict[str, Any]:
    name = function.__qualname__.replace(".__init__", "")
    out: dict[str, Any] = {}
    for key, value in given.items():
        own = aliases.get(key, key)
        option = _option(key) if options and own not in known and key not in hints else ""
        if option:
            laid = as_dict(given.get("options"))
            if option in laid or option in out.get("options", {}):
                raise UsageError(f"{name}: option {option} is given twice")
            out["options"] = {**laid, **out.get("options", {}), option: value}
            continue
        if own not in known:
            raise UsageError(f"{name}({key}=...): {_advice(key, known | _every_option() if options else known, hints)}")
        if own == "options" and own in out:  # laid already
            continue
        if own in out or own in placed:
            raise UsageError(f"{name}: {key} and {own} mean the same argument: give one of them")
        out[own] = value
    return out


def _advice(key: str, known: frozenset[str], hints: Mapping[str, str]) -> str:
    return hints.get(key) or f"there is no such argument{nearest(key, known - {'self'})}"


def _option(key: str) -> str:
    """The option of a task or an algorithm that a word stands for; "" for none."""
    every = _every_option()
    return next((word for word in (key, WORDS.get(key, "")) if word in every), "")


def _every_option() -> set[str]:
    """All options of tasks, algorithms, shields and planners."""
    from . import _discovery
    every = {name for algo in _discovery.algos().values() for name in algo.options}
    every |= {*_discovery.shield_options(), *_discovery.planner_options()}
    return every | {name for task in _discovery.tasks().values() for name in task.options}


class Hinted:
    """An object whose error for an unknown attribute, read or set, says what to write instead.

    A class annotates its public attributes. Each is set once, and one with a default in the class at any time. Subclasses
    that users write may have attributes of their own.
    """

    _hints: ClassVar[Mapping[str, str]] = {}
    _set_option: ClassVar[str] = ""  # what is written to set an option, {}: option=value

    _attributes: ClassVar[frozenset[str]] = frozenset()  # the public ones: members, and what is annotated

    def __init_subclass__(cls, **more: Any) -> None:
        super().__init_subclass__(**more)
        names = {*dir(cls), *(name for base in cls.__mro__ for name in getattr(base, "__annotations__", ()))}
        cls._attributes = frozenset(name for name in names if name[0] != "_")

    def _option_names(self) -> Iterable[str]:
        return ()

    if not TYPE_CHECKING:  # a type checker would take them for all attributes

        def __getattr__(self, name: str) -> Any:
            if name.startswith("_"):
                raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")
            raise self._no_attribute(name)

        def __setattr__(self, name: str, value: Any) -> None:
            kind = type(self)
            if name[0] != "_" and not hasattr(kind, name) and kind.__module__.split(".")[0] == __package__:
                if name in vars(self):
                    raise AttributeError(f"{kind.__name__}.{name}: it cannot be changed")
                if name not in kind._attributes:
                    raise self._no_attribute(name)
            super().__setattr__(name, value)

    def _no_attribute(self, name: str) -> AttributeError:
        kind, options = type(self), frozenset(self._option_names())
        said = kind._hints.get(name)
        if said is None and (meant(name, options) or name) in options:
            said = "it is an option: " + kind._set_option.format(meant(name, options) or name)
        elif said is None:
            said = "there is no such attribute" + nearest(name, kind._attributes | options)
        return AttributeError(f"{kind.__name__}.{name}: {said}")


# Of the module: what to write instead.
_MODULE_HINTS = {
    "save": "policy.save(path), agent.save(path), redman.train(..., out=folder)",
    "learn": "redman.train(task, steps=...)", "PPO": "redman.train(task, algo='ppo')",
    "envs": "redman.tasks()", "list_tasks": "redman.tasks()", "registry": "redman.tasks()", "Env": "redman.gym.Env",
    "VectorEnv": "redman.gym.VectorEnv", "VecEnv": "redman.sb3.VecEnv", "render": "Pool.render"}


def module_hint(name: str, known: Iterable[str]) -> str:
    """The error for a name that the module does not have."""
    said = _MODULE_HINTS.get(name) or f"there is no such name{nearest(name, known)}"
    return f"redman.{name}: {said}"


def moved(names: Mapping[str, Any], public: Iterable[str]) -> None:
    """Makes classes and functions of private modules appear as members of the package."""
    for name in public:
        thing = names[name]
        if isinstance(thing, (type, type(moved))) and str(thing.__module__).startswith(("redman._", "redman.callbacks")):
            thing.__module__ = "redman"
