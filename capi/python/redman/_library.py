"""Finds and loads the shared library, and calls it: failures become exceptions, texts become str."""
from __future__ import annotations

import ctypes
import operator
import os
import re
import sys
import threading
from ctypes import byref, c_size_t
from pathlib import Path
from typing import Any, Callable, Mapping, Optional, TypeVar

import numpy as np

from . import _abi
from ._abi import ResultCode
from ._error import ArgumentError, Error, RangeError, UsageError, error_of

Struct = TypeVar("Struct", bound=ctypes.Structure)
Thing = TypeVar("Thing")


def _candidates() -> list[str]:
    """Where the library may be, the most specific place first."""
    named = os.environ.get("REDMAN_LIBRARY")
    if named:
        return [named]
    here = Path(__file__).resolve().parent
    places = [here]  # a wheel
    if len(here.parents) > 2 and (here.parents[2] / "include" / "redman" / "redman.h").is_file():  # the project's tree
        places += [here.parents[2] / "build" / preset for preset in ("release", "dev")]
    suffix = "dylib" if sys.platform == "darwin" else "so"
    found = [str(path) for place in places for path in sorted(place.glob(f"libredman.{suffix}*"))[:1]]
    return found + [f"libredman.so.{_abi.RDM_ABI}"]


def _load() -> ctypes.CDLL:
    tried = []
    for path in _candidates():
        try:
            library = ctypes.CDLL(path)
        except OSError as error:
            tried.append(str(error))
            continue
        try:
            _abi.declare(library)
        except AttributeError as error:
            tried.append(f"{path}: older than this package ({error})")
            continue
        if (library.rdm_check_abi(_abi.RDM_ABI, _abi.RDM_VERSION)
                or library.rdm_check_experimental(_abi.RDM_VERSION)):
            tried.append(f"{path}: {library.rdm_last_error().decode(errors='replace')}")
            continue
        return library
    raise ImportError("redman: no shared library: " + "; ".join(tried) +
                      ". Set REDMAN_LIBRARY to the path of libredman.so")


lib = _load()


def policy_folders() -> list[Path]:
    """Where the bundled policies may be: in a wheel, in the project's tree, beside an installed library."""
    here = Path(__file__).resolve().parent
    library = Path(lib._name)
    beside = library.resolve().parent.parent if library.is_absolute() else Path(sys.prefix)
    places = [here / "share" / "redman" / "policies"]  # where a wheel's tool looks too
    if len(here.parents) > 2 and (here.parents[2] / "include" / "redman" / "redman.h").is_file():
        places.append(here.parents[2] / "examples" / "policies")
    places += [prefix / "share" / "redman" / "policies"
               for prefix in (beside, beside.parent, Path("/usr/local"), Path("/usr"))]
    return places


def text(value: bytes | None) -> str:
    """A text of the library; "" for NULL."""
    return "" if value is None else value.decode("utf-8", errors="replace")


def encoded(value: str | os.PathLike[str], name: str) -> bytes:
    """A text or a path, encoded for the library. name: of the argument."""
    try:
        out = os.fsencode(value)
    except TypeError:
        raise UsageError(f"{name}: it must be a text or a path, not {value!r}") from None
    if b"\0" in out:
        raise ArgumentError(f"{name}: {value!r} must not contain a zero byte")
    return out


# What a function of Python that the library called has raised, (function, exception), until the call from Python that ran it
# tells it: by thread, under 0 where the library may have called it on another one.
raised: dict[int, tuple[str, BaseException]] = {}


def guarded(name: str, function: Callable[..., Any], anywhere: bool = False) -> Callable[..., int]:
    """The function as the library can call it: what it raises is kept, and ARGUMENT is returned. anywhere: on any thread."""
    def call(*arguments: Any) -> int:
        thread = 0 if anywhere else threading.get_ident()
        kept = raised.pop(thread, None)  # of the same call; calls within this function must not tell it
        try:
            answer = function(*arguments)
            code = 0 if answer is None else int(answer)
        except BaseException as error:
            code = int(ResultCode.ARGUMENT)
            if kept is None or not isinstance(error, Exception):  # the first one is told, unless it is Ctrl-C
                kept = name, error
        if kept is not None:
            raised[thread] = kept
            kept = None  # no cycle with the traceback
        return code
    return call


# What the library's texts tell to call, as it is said here.
_CALLS = {
    "rdm_agent_set_recording": "agent.recording = recording", "rdm_agent_update_slice": "agent.update_slice()",
    "rdm_agent_clone": "agent.clone()", "rdm_agent_discard": "agent.discard()",
    "rdm_policy_act_points": "policy.act(obs, points=points)",
    "rdm_policy_act_points_state": "policy.act(obs, points=points, state=state)",
    "rdm_policy_act_state": "policy.act(obs, state)", "rdm_policy_act": "policy.act()", "rdm_policy_sample": "policy.sample()"}


def failure(code: int) -> Error:
    """The exception of the call that has just failed on this thread."""
    said = text(lib.rdm_last_error())
    said = re.sub(r"\bsettings line \d+: ", "", said)  # a dict of options has no lines
    error = error_of(code, re.sub(r"\brdm_\w+", lambda found: _CALLS.get(found[0], found[0]), said))
    return _of_python(error) or error


def forget_raised() -> None:
    """After a call whose failure is no error."""
    for thread in (threading.get_ident(), 0):
        raised.pop(thread, None)


def _of_python(error: Error) -> Optional[Error]:
    """The error, with the exception that a function of Python raised in this call as its cause; None if there is none."""
    found = raised.get(threading.get_ident()) or raised.get(0)
    if found is None:
        return None
    forget_raised()
    name, cause = found
    if not isinstance(cause, Exception):  # Ctrl-C
        raise cause
    said = f"{name} raised {type(cause).__name__}: {cause}"
    told = type(error)(f"{error}; {said}" if str(error) else said)
    told.code, told.__cause__ = error.code, cause
    return told


def check(code: int) -> None:
    """Raises unless code is RDM_OK and no function of Python raised in the call, which may succeed if that ended only an
    episode."""
    if code:
        raise failure(code)
    if raised and (error := _of_python(ArgumentError())):
        raise error


def sized(kind: type[Struct]) -> Struct:
    """A struct with its struct_size set and everything else 0."""
    value = kind()
    value.struct_size = ctypes.sizeof(kind)
    return value


def whole(value: Any, name: str, low: int, high: int) -> int:
    """An integer argument within low and high."""
    try:
        number = operator.index(value)
    except TypeError:
        raise UsageError(f"{name}: it must be a whole number, not {value!r}") from None
    if not low <= number <= high:
        raise RangeError(f"{name}: {number} is not in {low} to {high}")
    return number


def real(value: Any, name: str) -> float:
    """A number argument."""
    try:
        if not isinstance(value, (str, bytes, bytearray)):
            return float(value)
    except (TypeError, ValueError, OverflowError):
        pass
    raise UsageError(f"{name}: it must be a number, not {value!r}")


def flag(value: Any, name: str) -> int:
    """An argument that is True or False."""
    if not isinstance(value, (int, np.bool_)):  # a bool is an int
        raise UsageError(f"{name}: it must be True or False, not {value!r}")
    return int(bool(value))


def raw(value: Any, name: str) -> bytes:
    """A bytes argument."""
    try:
        return bytes(memoryview(value))
    except TypeError:
        raise UsageError(f"{name}: it must be bytes, not {value!r}") from None


def instance(value: Any, kind: type[Thing], name: str, instead: str = "") -> Thing:
    """An argument that must be an object of a public class. instead: what else a user may have meant."""
    if not isinstance(value, kind):
        raise UsageError(f"{name}: it must be a redman.{kind.__name__}, not {value!r}{instead}")
    return value


def all_cores(threads: Optional[int], worlds: int) -> int:
    """The number of threads; None: as many as this process has cores, but no more than worlds."""
    if threads is not None:
        return whole(threads, "threads", 0, (1 << 31) - 1)
    has = getattr(os, "sched_getaffinity", None)
    return max(1, min(len(has(0)) if has else os.cpu_count() or 1, worlds, 256))


def int32(value: Any, name: str) -> int:
    """An integer argument; ctypes alone would truncate numbers that do not fit."""
    return whole(value, name, -(1 << 31), (1 << 31) - 1)


def assign(struct: ctypes.Structure, values: Mapping[str, Any]) -> None:
    """Sets fields to numbers; an integer that does not fit is refused."""
    kinds = dict((field[0], field[1]) for field in struct._fields_)
    for name, value in values.items():
        if kinds[name] in (ctypes.c_double, ctypes.c_float):
            value = real(value, name)
        else:
            bits = 8 * ctypes.sizeof(kinds[name])
            signed = kinds[name](-1).value < 0
            low, high = (-(1 << bits - 1), (1 << bits - 1) - 1) if signed else (0, (1 << bits) - 1)
            value = whole(value, name, low, high)
        setattr(struct, name, value)


def filled(kind: type[Struct], call: Callable[..., int], *before: Any) -> Struct:
    """The struct that call(*before, &struct) fills."""
    value = sized(kind) if kind._fields_[0][0] == "struct_size" else kind()
    check(call(*before, byref(value)))
    return value


def bytes_of(call: Callable[..., int], *before: Any) -> bytes:
    """The bytes that call(*before, bytes, capacity, &size) writes; asks for their size first."""
    size = c_size_t()
    check(call(*before, None, 0, byref(size)))
    raw = ctypes.create_string_buffer(max(size.value, 1))
    check(call(*before, raw, size.value, byref(size)))
    return raw.raw[:size.value]


class Handle:
    """Owns what a create function made, and destroys it when nothing needs it any more."""

    __slots__ = ("value", "_destroy", "__weakref__")

    def __init__(self, create: Callable[..., int], destroy: Callable[[Any], None], *arguments: Any) -> None:
        self.value: int | None = None
        self._destroy = destroy
        out = ctypes.c_void_p()
        check(create(byref(out), *arguments))
        self.value = out.value

    def __del__(self) -> None:
        if self.value is not None:
            self._destroy(self.value)
