"""Options as a dict: {"object": "egg", "object_mass": 0.05, "friction": (0.7, 1.3)}."""
from __future__ import annotations

import ctypes
import os
from ctypes import byref, c_size_t
from typing import Any, Callable, Dict, Iterable, Mapping, Optional, Sequence, Union

import numpy as np

from . import _abi
from ._abi import OptionKind
from ._error import ArgumentError, UsageError
from ._library import check, encoded, text
from ._record import Record

Value = Union[str, float, int, bool]
# A pair is a range where an option takes one, from which each world draws at a reset; it is read back as a text. For an
# option whose value is a list in a text, such as hidden, numbers in a list or a tuple are that list. A robot or an object may be
# its file, or a Robot or an Object.
Given = Union[Value, Sequence[float], Sequence[str], "os.PathLike[str]", Record]
Options = Mapping[str, Given]
_COMMAS = ("actor_obs", "critic_obs")  # options whose value is a list of names with commas; of others it has +


class Told(Dict[str, Value]):
    """Options that something has, as a dict that cannot be changed; copies of it can."""

    def __init__(self, options: Mapping[str, Value], instead: str) -> None:
        super().__init__(options)
        self._instead = instead  # what is written to change them

    def _refuse(self, *_: Any, **__: Any) -> Any:
        raise UsageError(f"options: this dict tells what they are and cannot be changed: {self._instead}")

    __setitem__ = __delitem__ = __ior__ = clear = pop = popitem = setdefault = update = _refuse  # type: ignore[assignment]

    def __reduce__(self) -> Any:  # of copies and pickles
        return dict, (dict(self),)


Kinds = Mapping[str, int]  # OptionKind of each key; noise.right.tip_force is one of noise.FIELD


def as_dict(options: Optional[Mapping[str, Any]], name: str = "options") -> dict[str, Any]:
    """An argument that is a dict of options, or None for none."""
    if options is None:
        return {}
    if not isinstance(options, Mapping) or not all(isinstance(key, str) for key in options):
        raise UsageError(f"{name}: it must be a dict of options by name, not {options!r}")
    return dict(options)


def shown(key: str, value: Any, kinds: Kinds = {}) -> str:
    """A value in the text form that the library reads, exact: true, 0.1, 16, egg, 0.7..1.3, 64,64, rgb+depth."""
    if isinstance(value, str):
        return value
    if isinstance(value, (bool, np.bool_)):
        return "true" if value else "false"
    if isinstance(value, (list, tuple, np.ndarray)):
        return _listed(key, list(value), isinstance(value, tuple), kinds)
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise UsageError(f"option {key}: it must be a number, a flag, a text, or a list or pair of numbers, "
                              f"not {type(value).__name__}") from None
    return repr(number)[:-2] if repr(number).endswith(".0") else repr(number)


def _listed(key: str, values: list[Any], pair: bool, kinds: Kinds) -> str:
    if values and all(isinstance(value, str) for value in values):
        return ("," if key in _COMMAS else "+").join(values)
    if values and all(isinstance(value, (list, tuple, np.ndarray)) for value in values):  # points of a hull
        return ";".join(_listed(key, list(value), False, {}) for value in values)
    kind = kind_of(key, kinds)
    ranged = pair if kind is None else kind in (OptionKind.NUMBER, OptionKind.INTEGER)
    if ranged and len(values) != 2:
        raise ArgumentError(f"option {key}: a range must be a pair of numbers, not {len(values)}")
    return (".." if ranged else ",").join(shown(key, value) for value in values)


def settings_of(options: Options, kinds: Kinds = {}) -> bytes:
    """The lines key=value of a config."""
    lines = []
    for key, value in options.items():
        line = f"{key}={shown(key, value, kinds)}"
        if "\n" in line or "=" in key:
            raise ArgumentError(f"option {key!r}: the key must not contain '=', and the value must be one line")
        lines.append(line)
    return encoded("\n".join(lines), "options")


def option_array(options: Options, kinds: Kinds = {}) -> Any:
    """[len(options)] rdm_option, which keeps its texts alive."""
    array = (_abi.rdm_option * len(options))()
    for row, (key, value) in zip(array, options.items()):
        row.key, row.text = encoded(key, "option"), encoded(shown(key, value, kinds), f"option {key}")
    return array


def settings_texts(call: Callable[..., int], handle: Any) -> dict[str, str]:
    """All options of a pool, an agent or a shield, as call(handle, text, capacity, &size) writes them."""
    size = c_size_t()
    check(call(handle, None, 0, byref(size)))
    raw = ctypes.create_string_buffer(size.value + 1)
    check(call(handle, raw, len(raw), byref(size)))
    return dict(line.split("=", 1) for line in text(raw.value).split("\n") if line)


def read_settings(call: Callable[..., int], handle: Any, kinds: Mapping[str, int], instead: str) -> Told:
    """The same as values. instead: what is written to change them."""
    return Told({key: value_of(kind_of(key, kinds), value) for key, value in settings_texts(call, handle).items()}, instead)


def kind_of(key: str, kinds: Kinds) -> Optional[int]:
    """The kind of an option's value; None where the key is not known."""
    folded = key.lower().replace("-", "_")
    for word in (key, folded, key.split(".", 1)[0] + ".FIELD", folded.split(".", 1)[0] + ".FIELD"):
        if word in kinds:
            return kinds[word]
    return None


def value_of(kind: Optional[int], said: str) -> Value:
    """The text of an option as a value of its kind."""
    if kind == OptionKind.TEXT:
        return said
    if kind == OptionKind.FLAG:
        return said == "true"
    if ".." in said:
        return said
    return int(float(said)) if kind == OptionKind.INTEGER else float(said)


def default_of(info: _abi.rdm_option_spec) -> Value:
    """The default of an option as a value of its kind."""
    if info.kind == OptionKind.TEXT:
        return text(info.text)
    if info.kind == OptionKind.FLAG:
        return bool(info.number)
    if info.text is not None:
        return value_of(info.kind, text(info.text))
    return int(info.number) if info.kind == OptionKind.INTEGER else info.number


def laid(rows: Iterable[_abi.rdm_option]) -> dict[str, Value]:
    """Merges rows in order: of several with the same key, the last one counts, and keeps its place."""
    out: dict[str, Value] = {}
    for row in rows:
        key = text(row.key)
        out.pop(key, None)
        out[key] = row.number if row.text is None else _plain(text(row.text))
    return out


def _plain(said: str) -> Value:
    """The text as a number, if it is one."""
    try:
        number = float(said)
    except ValueError:
        return said
    return int(said) if said.lstrip("-").isdecimal() else number
