"""Robot: a description of a hand, an arm or another tree of links; robots of the library, from files, and of your own."""
from __future__ import annotations

import ctypes
import os
from ctypes import byref, c_int32
from functools import lru_cache
from typing import Any, NamedTuple, Optional, Union

import numpy as np

from . import _abi, _discovery
from ._definition import fill, plain, pose_of
from ._error import UsageError
from ._files import write_whole
from ._import_abi import ImportNote, NoteKind
from ._library import check, encoded, filled, flag, lib, real, sized
from ._paths import named
from ._rows import Array, DoubleArray, given

# Of functions that take a robot: its name or alias, its file, or what robot(name) gave.
RobotName = Union[str, "os.PathLike[str]", "Robot"]


class Note(ImportNote):
    """A note about a file that was read: what is not in the robot (NoteKind.DROPPED), is in another form (CHANGED), was
    guessed (GUESSED) or found by a trial (CHECK); line counts from 1, 0: no line."""

    kind: NoteKind

    def __init__(self, struct: Any) -> None:
        super().__init__(struct)
        self.__dict__["kind"] = NoteKind(struct.kind)


class Poses(NamedTuple):
    """Frames of a robot in its root frame, position (m) and quaternion (x, y, z, w); None where it has no such frame."""

    links: DoubleArray  # [num_joints][7] of each link, which joint i moves
    flange: Optional[DoubleArray]  # [7] of an arm
    tips: DoubleArray  # [fingers][3] the ends of the fingers, m
    palm: Optional[DoubleArray]  # [7] of a hand: origin where a held object is, y into the palm, z as the fingers point


_notes: dict[int, tuple[Note, ...]] = {}  # of robots that came from a file
added: set[int] = set()  # numbers of those that are not the library's own


class Robot(_abi.Robot):
    """A robot description with its joints by name.

        robot = redman.robot("shadow_hand")             # name or alias, or redman.load_robot("my.urdf")
        robot.poses().tips                              # where its fingers end at home
        pool = redman.Pool("grasp", options={"hand": "my.urdf"})

        longer = redman.robot("tripod").definition      # a dict, as rdm_robot_def of redman/robot.h
        redman.Robot.create(**{**longer, "name": "my_hand", "alias": None})
    """

    joints: dict[str, _discovery.Joint]
    number: int  # of the robot in this process

    def __init__(self, index: int) -> None:
        super().__init__(filled(_abi.rdm_robot, lib.rdm_robot_at, index))
        self.__dict__["number"] = index
        self.__dict__["joints"] = {joint.name: joint for joint in _discovery.all_of(
            _discovery.Joint, _abi.rdm_joint_info, lib.rdm_robot_joint_at, index)}

    @classmethod
    def create(cls, **definition: Any) -> Robot:
        """Adds a robot of your own under its name; the keywords are those of rdm_robot_def: name, kind, links, shapes, ...

            redman.Robot.create(name="door", num_commands=-1, links=[
                {"name": "leaf", "joint": "hinge", "parent": "root", "kind": "revolute", "axis": [0, 0, 1], "lower": 0,
                 "upper": 1.6, "kp": 1, "kd": 0.1, "effort": 5, "mass": 8, "moment": [0.5, 0.5, 0.9, 0, 0, 0]}])

        Where a row of links is expected, a text is the name of the link. ArgumentError names the row and the member that is
        wrong.
        """
        struct = sized(_abi.rdm_robot_def)
        check(lib.rdm_robot_def_init(byref(struct), ctypes.sizeof(struct)))
        kept = fill(struct, definition, "robot")
        out = created(struct)
        del kept
        return out

    @property
    def definition(self) -> dict[str, Any]:
        """What the robot was made from, in the form that create takes: rdm_robot_def as a dict. Rows of links are numbers."""
        struct = filled(_abi.rdm_robot_def, lib.rdm_robot_get_def, self.number)
        out = plain(struct)
        for name, call, kind in (("links", lib.rdm_robot_link_at, _abi.rdm_robot_link),
                                 ("shapes", lib.rdm_robot_shape_at, _abi.rdm_robot_shape),
                                 ("pairs", lib.rdm_robot_pair_at, _abi.rdm_robot_pair),
                                 ("couplings", lib.rdm_robot_coupling_at, _abi.rdm_robot_coupling),
                                 ("curves", lib.rdm_robot_curve_at, _abi.rdm_robot_curve),
                                 ("fingers", lib.rdm_robot_finger_at, _abi.rdm_robot_finger)):
            out[name] = [plain(filled(kind, call, self.number, i)) for i in range(getattr(struct, f"num_{name}"))]
        commands = max(struct.num_commands, 0)
        rows: dict[str, Array] = {"commands": np.zeros(commands, np.int32), "home": np.zeros(struct.num_links),
                "folded": np.zeros(struct.num_links), "closed": np.zeros(commands, np.float32)}
        check(lib.rdm_robot_get_postures(self.number, *(array.ctypes.data for array in rows.values())))
        out.update((name, array.tolist()) for name, array in rows.items()
                   if name == "home" or array.any())  # folded and closed are 0 where it has none
        if struct.num_commands < 0:
            out["num_commands"] = struct.num_commands
        return out

    @property
    def home(self) -> DoubleArray:
        """[num_joints] the start pose, rad (m)."""
        return np.array(self.definition["home"])

    def poses(self, q: Any = None) -> Poses:
        """The robot's frames with its joints at q [num_joints], rad (m); None: at home."""
        struct = filled(_abi.rdm_robot_def, lib.rdm_robot_get_def, self.number)
        joints = self._given("rdm_robot_get_poses", self.home if q is None else q)
        links, tips = np.empty((self.num_joints, 7)), np.empty((struct.num_fingers, 3))
        flange = np.empty(7) if struct.flange_link != _abi.LinkRow.NONE else None
        palm = np.empty(7) if struct.palm_link != _abi.LinkRow.NONE else None
        check(lib.rdm_robot_get_poses(self.number, joints.ctypes.data, links.ctypes.data,
                                      None if flange is None else flange.ctypes.data, tips.ctypes.data,
                                      None if palm is None else palm.ctypes.data))
        return Poses(links, flange, tips, palm)

    def reach(self, flange: Any, q: Any = None) -> Optional[DoubleArray]:
        """[num_joints] joint positions that bring the flange of an arm to a pose in its root frame, searched from q (None:
        home); None where the search ends elsewhere. UnsupportedError for a robot without a flange."""
        joints = self._given("rdm_robot_reach", self.home if q is None else q).copy()
        wanted, found = np.array([*(pose := pose_of(flange, "flange")).p, *pose.q]), c_int32()
        check(lib.rdm_robot_reach(self.number, wanted.ctypes.data, joints.ctypes.data, byref(found)))
        return joints if found.value else None

    def mounted(self, hand: RobotName, name: str, *, yaw: float = 0.0, adapter: float = 0.0, left: bool = False) -> Robot:
        """This arm with a hand on its flange, as a robot of its own under a new name: the hand is rotated by yaw (rad) about
        the flange's z and moved out by adapter (m); left: its mirror image."""
        out = c_int32()
        check(lib.rdm_robot_create_mounted(byref(out), encoded(name, "name"), self.number, robot(hand).number,
                                            real(yaw, "yaw"), real(adapter, "adapter"), flag(left, "left")))
        added.add(out.value)
        return robot_at(out.value)

    @property
    def notes(self) -> tuple[Note, ...]:
        """What was dropped, changed and guessed when its file was read; empty for other robots."""
        return _notes.get(self.number, ())

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes a .robot file at path, which load_robot reads back the same to the last bit."""
        from ._importer import robot_text
        write_whole(path, robot_text(self.number), "robot")

    def remove(self) -> None:
        """Removes a robot of your own, or of a file, from this process; pools that have it keep it."""
        check(lib.rdm_robot_destroy(self.number))

    def _given(self, function: str, q: Any) -> DoubleArray:
        rows = _abi.FUNCTIONS[function].rows["q"]
        return given(q, rows, {"num_links": self.num_joints}, "q")

    def __repr__(self) -> str:
        return f"<Robot {self.name}: {self.num_joints} joints{self.summary and f'; {self.summary}'}>"


def created(struct: _abi.rdm_robot_def, notes: tuple[Note, ...] = ()) -> Robot:
    """The robot of a struct."""
    out = c_int32()
    check(lib.rdm_robot_create(byref(out), byref(struct)))
    added.add(out.value)
    if notes:
        _notes[out.value] = notes
    return robot_at(out.value)


@lru_cache(maxsize=None)
def robot_at(index: int) -> Robot:
    return Robot(index)


def robots() -> dict[str, Robot]:
    """All robot descriptions by name, and by alias: robots()["shadow"]."""
    return _discovery.Listed(
        _discovery.listed(robot_at, _abi.rdm_robot, lib.rdm_robot_at, lib.rdm_robot_count()), robot)


def robot(name: RobotName) -> Robot:
    """One robot by its name or alias, or from a file, as load_robot reads it. NotFoundError offers the nearest name."""
    if isinstance(name, Robot):
        return name
    if not isinstance(name, (str, os.PathLike)):
        raise UsageError(f"robot: it must be a name or a file, not {name!r}")
    return robot_at(_discovery.find(lib.rdm_robot_find, named("robot", name)))
