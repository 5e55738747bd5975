"""Options as a dict: {"object": "egg", "object_mass": 0.05}."""
from __future__ import annotations

from typing import Any, Mapping, Union

from . import _abi
from ._library import encoded, text

Value = Union[str, float, int, bool]
Options = Mapping[str, Value]


def option_array(options: Options) -> Any:
    """[len(options)] rdm_option, for a config; it holds its texts."""
    array = (_abi.rdm_option * len(options))()
    for row, (key, value) in zip(array, options.items()):
        row.key = encoded(key)
        if isinstance(value, str):
            row.text = encoded(value)
        else:
            try:
                row.number = float(value)
            except (TypeError, ValueError):
                raise TypeError(f"option {key}: a number, a flag or a text, not {type(value).__name__}") from None
    return array


def value_of(info: _abi.rdm_option_info, shown: str) -> Value:
    """The text of an option as its kind says."""
    if info.kind == _abi.RDM_TEXT:
        return shown
    if info.kind == _abi.RDM_FLAG:
        return shown not in ("0", "false", "off", "no")
    return int(float(shown)) if info.kind == _abi.RDM_INTEGER else float(shown)


def default_of(info: _abi.rdm_option_info) -> Value:
    """The default of an option as its kind says."""
    if info.kind == _abi.RDM_TEXT:
        return text(info.text)
    if info.kind == _abi.RDM_FLAG:
        return bool(info.number)
    return int(info.number) if info.kind == _abi.RDM_INTEGER else info.number
