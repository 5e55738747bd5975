"""Definitions of robots, objects and bodies, as dicts with the member names of the header's structs.

A row of a list is a dict too; kinds are words ("revolute", "box"), a pose is [x, y, z] or [x, y, z, qx, qy, qz, qw], and
counts are taken from the lists. A row of links may be given by the link's name.
"""
from __future__ import annotations

import ctypes
import enum
from typing import Any, Iterable, Mapping, Optional

import numpy as np

from . import _abi
from ._error import ArgumentError, UsageError
from ._library import assign, encoded, real, text
from ._names import nearest
from ._rows import array_of

_KINDS: dict[tuple[type[ctypes.Structure], str], type[enum.IntEnum]] = {
    (_abi.rdm_robot_link, "kind"): _abi.JointKind, (_abi.rdm_robot_shape, "kind"): _abi.ShapeKind,
    (_abi.rdm_shape_def, "kind"): _abi.ShapeKind, (_abi.rdm_robot_def, "kind"): _abi.RobotKind}
# Members that are a row of the robot's links.
_LINKS = ("parent", "link", "other", "driver", "first", "tip", "lateral", "proximal", "middle", "flange_link", "palm_link")
_NO_ROW = {"root": int(_abi.LinkRow.ROOT), "none": int(_abi.LinkRow.NONE)}


def pose_of(value: Any, where: str = "pose") -> _abi.rdm_pose:
    """The struct of a pose: 3 numbers, m, or 7 with a quaternion (x, y, z, w)."""
    numbers = array_of(value, where, np.float64).ravel()
    if numbers.size not in (3, 7):
        raise ArgumentError(f"{where}: give the 3 numbers of a position, or 7 with a quaternion, not {numbers.size}")
    pose = _abi.rdm_pose()
    pose.p = type(pose.p)(*numbers[:3])
    if numbers.size == 7:
        pose.q = type(pose.q)(*numbers[3:])
    return pose


def fill(struct: ctypes.Structure, values: Mapping[str, Any], where: str, links: Iterable[str] = ()) -> list[Any]:
    """Writes values into an initialised struct; returns what it points at, which must be kept as long as the struct is used."""
    if not isinstance(values, Mapping):
        raise UsageError(f"{where}: it must be a dict, not {values!r}")
    kind, kept = type(struct), list[Any]()
    members = {name: of for name, of, *_ in kind._fields_ if name != "struct_size" and not name.startswith("reserved")}
    rows = list(links)
    if kind is _abi.rdm_robot_def:
        rows = [str(link.get("name")) for link in values.get("links") or () if isinstance(link, Mapping)]
    for name, value in values.items():
        if name not in members:
            raise UsageError(f"{where}: there is no {name!r}{nearest(name, members)}")
        if value is not None:
            try:
                kept += _set(struct, name, members[name], value, f"{where}: {name}", rows)
            except (TypeError, ValueError) as error:
                if isinstance(error, ArgumentError):
                    raise
                raise UsageError(f"{where}: {name}: {error}") from None
    return kept


def _set(struct: ctypes.Structure, name: str, of: Any, value: Any, where: str, links: list[str]) -> list[Any]:
    table = _abi.ROWS.get(type(struct).__name__, {})
    if of is ctypes.c_char_p:
        setattr(struct, name, encoded(value, where))
    elif of is _abi.rdm_pose:
        setattr(struct, name, pose_of(value, where))
    elif name in table:
        array = np.ascontiguousarray(array_of(value, where, table[name].dtype))
        setattr(struct, name, array.ctypes.data)
        if table[name].shape[0] == f"num_{name}":
            setattr(struct, f"num_{name}", len(array))
        return [array]
    elif issubclass(of, ctypes.Array):
        listed = np.asarray(value).ravel().tolist()
        if name == "color" and len(listed) == 3:
            listed.append(255)
        if len(listed) > of._length_ or (len(listed) < of._length_ and name != "size"):  # a radius alone is a size
            raise ArgumentError(f"{where}: give {of._length_} numbers, not {len(listed)}")
        setattr(struct, name, of(*listed))
    elif hasattr(of, "contents"):
        rows = (of._type_ * len(value))()
        kept = [part for i, row in enumerate(value) for part in fill(rows[i], row, f"{where}[{i}]", links)]
        setattr(struct, name, rows)
        setattr(struct, f"num_{name}", len(rows))
        return [rows, *kept]
    elif isinstance(value, str):
        setattr(struct, name, _word(type(struct), name, value, where, links))
    elif of in (ctypes.c_double, ctypes.c_float):
        setattr(struct, name, real(value, where))
    else:
        assign(struct, {name: int(value) if isinstance(value, (bool, np.bool_)) else value})
    return []


def _word(kind: type[ctypes.Structure], name: str, word: str, where: str, links: list[str]) -> int:
    """The number of a kind or of a link that is given by its name."""
    if (kind, name) in _KINDS:
        known = {member.name.lower(): int(member) for member in _KINDS[kind, name]}
    elif name in _LINKS:
        known = {**_NO_ROW, **{link: i for i, link in enumerate(links)}}
    else:
        raise UsageError(f"{where}: it must be a number, not {word!r}")
    if word not in known:
        raise ArgumentError(f"{where}: {word!r} is none of {', '.join(known)}{nearest(word, known)}")
    return known[word]


def plain(struct: ctypes.Structure) -> dict[str, Any]:
    """A struct without its arrays and their counts, in the form that fill takes."""
    out: dict[str, Any] = {}
    for name, of, *_ in type(struct)._fields_:
        if name == "struct_size" or name.startswith(("reserved", "num_")):
            continue
        value = getattr(struct, name)
        if of is ctypes.c_char_p:
            if value is not None:
                out[name] = text(value)
        elif of is _abi.rdm_pose:
            out[name] = [*value.p, *value.q]
        elif of is ctypes.c_void_p or hasattr(of, "contents"):
            continue
        elif issubclass(of, ctypes.Array):
            out[name] = list(value)
        elif (type(struct), name) in _KINDS:
            out[name] = _KINDS[type(struct), name](value).name.lower()
        else:
            out[name] = value
    return out


def numbers(at: Optional[int], count: int, kind: Any) -> list[Any]:
    """The numbers that a member points at."""
    return [] if not at else list(ctypes.cast(at, ctypes.POINTER(kind))[:count])
