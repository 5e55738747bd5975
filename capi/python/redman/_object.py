"""Object: what hands handle; objects of the library, from files, and of your own."""
from __future__ import annotations

import ctypes
import os
from ctypes import byref, c_int32
from functools import lru_cache
from typing import Any, Mapping, Union

from . import _abi, _discovery
from ._definition import fill, numbers, plain
from ._files import write_whole
from ._library import check, filled, lib, sized


class Object(_abi.ObjectInfo):
    """An object by name, for option object; kind is the redman.ShapeKind of its only shape, -1 where it has several.

        redman.objects()["mug"], redman.objects()["025_mug"]
        box = redman.Object.create(name="my_box", mass=0.2, shapes=[{"kind": "box", "size": [0.02, 0.03, 0.06]}])
        pool = redman.Pool("grasp", options={"object": "my_box"})       # or a file: "mug.object"
        box.save("my_box.object")
    """

    number: int  # of the object in this process

    def __init__(self, index: int) -> None:
        super().__init__(filled(_abi.rdm_object_info, lib.rdm_object_info_at, index))
        self.__dict__["number"] = index

    @classmethod
    def create(cls, **definition: Any) -> Object:
        """Adds an object of your own under its name; the keywords are those of rdm_object_def: name, shapes (each with kind,
        size in m, pose, color), mass (kg), moment, friction, material, alias, summary. ArgumentError names what is wrong."""
        struct, kept = _struct(definition)
        out = created(struct)
        del kept
        return out

    @staticmethod
    def check(**definition: Any) -> None:
        """Raises what create would, except for a name that is already used; adds nothing."""
        struct, kept = _struct(definition)
        check(lib.rdm_object_check(byref(struct)))
        del kept

    @property
    def definition(self) -> dict[str, Any]:
        """What the object was made from, in the form that create takes: rdm_object_def as a dict, in the frame at its centre
        of mass."""
        struct = filled(_abi.rdm_object_def, lib.rdm_object_get_def, self.number)
        out = plain(struct)
        out["shapes"] = []
        for i in range(struct.num_shapes):
            shape = filled(_abi.rdm_shape_def, lib.rdm_object_shape_at, self.number, i)
            row = plain(shape)
            if shape.points:
                flat = numbers(shape.points, 3 * shape.num_points, ctypes.c_double)
                row["points"] = [flat[at:at + 3] for at in range(0, len(flat), 3)]
            out["shapes"].append(row)
        return out

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes an .object file at path, which load_object reads back the same to the last bit."""
        from ._importer import object_text
        write_whole(path, object_text(self.number), "object")

    def remove(self) -> None:
        """Removes an object of your own, or of a file, from this process; pools that have it keep it."""
        check(lib.rdm_object_destroy(self.number))

    def __repr__(self) -> str:
        return f"<Object {self.name}: {self.shape}, {self.mass:g} kg>"


def _struct(definition: Mapping[str, Any]) -> tuple[_abi.rdm_object_def, list[Any]]:
    struct = sized(_abi.rdm_object_def)
    check(lib.rdm_object_def_init(byref(struct), ctypes.sizeof(struct)))
    return struct, fill(struct, definition, "object")


def created(struct: _abi.rdm_object_def) -> Object:
    """The object of a struct."""
    out = c_int32()
    check(lib.rdm_object_create(byref(out), byref(struct)))
    return object_at(out.value)


@lru_cache(maxsize=None)
def object_at(index: int) -> Object:
    return Object(index)


def objects() -> dict[str, Object]:
    """All objects by name, for option object; also found by alias: objects()["025_mug"]."""
    return _discovery.Listed(
        _discovery.listed(object_at, _abi.rdm_object_info, lib.rdm_object_info_at, lib.rdm_object_count()),
        lambda name: object_at(_discovery.find(lib.rdm_object_find, name)))
