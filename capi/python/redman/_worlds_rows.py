"""Worlds: how the functions of a task in Python read a pool's worlds and act on them."""
from __future__ import annotations

import ctypes
from ctypes import c_void_p
from typing import Any, Callable, Optional

import numpy as np

from . import _abi
from ._abi import Quantity, ResultCode
from ._error import ArgumentError
from ._library import check, lib

_get_many = lib["rdm_world_get_many"]  # functions of their own: called in every step
_set_many = lib["rdm_world_set_many"]
for _function in (_get_many, _set_many):
    _function.argtypes = [c_void_p, ctypes.c_size_t, ctypes.c_int32, ctypes.c_int32, ctypes.c_size_t, c_void_p]
_uniform = lib["rdm_random_uniform"]
_normal = lib["rdm_random_normal"]
_split = lib["rdm_random_split"]
_split.argtypes = [c_void_p, c_void_p]
_uniform.argtypes, _uniform.restype = [c_void_p, ctypes.c_double, ctypes.c_double], ctypes.c_double
_normal.argtypes, _normal.restype = [c_void_p], ctypes.c_double

_WIDTH: dict[int, int] = {Quantity.LINK: 13, Quantity.BASE: 13, Quantity.BODY: 13, Quantity.SHAPE: 7, Quantity.SENSOR: 6, Quantity.TOUCH: 2}
_UNIT_Q = np.array([0.0, 0.0, 0.0, 1.0])


class Worlds:
    """n worlds within a call of a task's function. Each array has a row for each of them; it is a copy, which cannot be written.

    Positions p are in m, quaternions q (x, y, z, w), velocities v and w in m/s and rad/s, force in N, torque in N m. Parts are
    given by the numbers that SceneBuilder returned. In observe nothing can be set.
    """

    __slots__ = ("n", "step", "_worlds", "_randoms", "_stride", "_results", "_seen", "_states", "_array", "_count")

    def __init__(self, rows: Any, state: Any, array: Callable[..., Any]) -> None:
        self.n: int = rows.count
        self.step: Any = None  # [n] in judge: control steps of the episode, from 1
        self._worlds: int = rows.worlds
        self._randoms: Optional[int] = rows.randoms
        self._stride = ctypes.sizeof(_abi.rdm_random)
        self._results: int = rows.results
        self._seen: dict[tuple[int, int], Any] = {}  # what was asked for since something was set
        self._states = array(rows.states, self.n, state) if state is not None else None
        self._array = array

    # --- what they are

    @property
    def state(self) -> Any:
        """The state that the task keeps (Task.state), by name: w.state["goal"] is [n][count] and can be written."""
        if self._states is None:
            raise ArgumentError("state: the class of the task has no state: give it one, such as state = {\"goal\": 3}")
        return self._states

    @property
    def number(self) -> Any:
        """[n] the numbers of the worlds in the pool; results must not depend on them."""
        return np.array([lib.rdm_world_number(self._world(i)) for i in range(self.n)], np.int32)

    @property
    def q(self) -> Any:
        """[n][joints] positions of all joints of all robots, rad (m)."""
        return self._joints(Quantity.Q)

    @property
    def qd(self) -> Any:
        """[n][joints] their velocities, rad/s (m/s)."""
        return self._joints(Quantity.QD)

    @property
    def target(self) -> Any:
        """[n][joints] targets of their drives, rad (m)."""
        return self._joints(Quantity.TARGET)

    @property
    def torque(self) -> Any:
        """[n][joints] torques of their drives, mean over the step, N m (N)."""
        return self._joints(Quantity.TORQUE)

    def joint(self, i: int) -> Any:
        """[n] the coordinate of joint i, rad (m)."""
        return self._get(Quantity.Q, i)[:, 0]

    def position(self, body: int) -> Any:
        """[n][3] position of a body's centre of mass."""
        return self._get(Quantity.BODY, body)[:, 0:3]

    def rotation(self, body: int) -> Any:
        """[n][4] the quaternion of a body."""
        return self._get(Quantity.BODY, body)[:, 3:7]

    def velocity(self, body: int) -> Any:
        """[n][3] velocity of a body's centre of mass."""
        return self._get(Quantity.BODY, body)[:, 7:10]

    def spin(self, body: int) -> Any:
        """[n][3] angular velocity of a body, world axes."""
        return self._get(Quantity.BODY, body)[:, 10:13]

    def body(self, body: int) -> Any:
        """[n][13] position, quaternion, velocity, angular velocity of a body."""
        return self._get(Quantity.BODY, body)

    def link(self, link: int) -> Any:
        """[n][13] the same of a link, at the frame of its joint."""
        return self._get(Quantity.LINK, link)

    def base(self, robot: int) -> Any:
        """[n][13] the same of a robot's base."""
        return self._get(Quantity.BASE, robot)

    def shape(self, shape: int) -> Any:
        """[n][7] position and quaternion of a shape."""
        return self._get(Quantity.SHAPE, shape)

    def sensor(self, sensor: int) -> Any:
        """[n][6] contact force and torque on the fingertip of a sensor, mean over the step, in the link's frame."""
        return self._get(Quantity.SENSOR, sensor)

    def touching(self, group: int) -> Any:
        """[n] whether anything of a group of SceneBuilder.touch touches; of the step just made, in judge and observe."""
        return self._get(Quantity.TOUCH, group)[:, 0] > 0

    def touch_force(self, group: int) -> Any:
        """[n] the sum of the contact forces of the group, N."""
        return self._get(Quantity.TOUCH, group)[:, 1]

    def contacts(self, row: int) -> list[_abi.rdm_contact]:
        """The contacts of one row's world in the last substep: shape_a, shape_b, position, normal, force (N), depth (m)."""
        world, count = self._world(row), ctypes.c_size_t()
        check(lib.rdm_world_get_contacts(world, None, 0, ctypes.byref(count)))
        rows = (_abi.rdm_contact * count.value)()
        check(lib.rdm_world_get_contacts(world, rows, count.value, ctypes.byref(count)))
        return list(rows)

    def overlap(self, body: int) -> Any:
        """[n] how deep a body is inside something that it can touch, m; 0: it is free. Not in observe."""
        depth, out = ctypes.c_double(), np.empty(self.n)
        for i in range(self.n):
            check(lib.rdm_world_get_overlap(self._world(i), body, ctypes.byref(depth)))
            out[i] = depth.value
        return out

    def gravity_efforts(self, robot: int, joints: int) -> Any:
        """[n][joints] efforts that hold a robot of that many joints against gravity in its present pose, N m (N)."""
        out = np.empty((self.n, joints))
        for i in range(self.n):
            check(lib.rdm_world_get_gravity(self._world(i), robot, out[i].ctypes.data, joints))
        return out

    # --- what is done to them

    def set_body(self, body: int, p: Any, q: Any = None, v: Any = 0.0, w: Any = 0.0) -> None:
        """Places a body: p [n][3], q [n][4] (None: no rotation), v [n][3], w [n][3]; a single row is for all worlds."""
        self._set(Quantity.BODY, body, self._motions(p, q, v, w), 13)

    def set_base(self, robot: int, p: Any, q: Any = None, v: Any = 0.0, w: Any = 0.0) -> None:
        """Places the free base of a robot, as set_body."""
        self._set(Quantity.BASE, robot, self._motions(p, q, v, w), 13)

    def set_joints(self, robot: int, q: Any, qd: Any = 0.0) -> None:
        """Places all joints of a robot: q [n][its joints], qd likewise; its drives then hold them there."""
        rows = np.empty((self.n, np.shape(q)[-1], 2))
        rows[:, :, 0], rows[:, :, 1] = q, qd
        self._set(Quantity.JOINT, robot, rows, 2)

    def set_targets(self, first: int, targets: Any) -> None:
        """Sets the targets of the drives of the joints from `first` on: [n][count], rad (m)."""
        self._set(Quantity.TARGET, first, self._rows(targets), 1)

    def command(self, robot: int, commands: Any) -> None:
        """Sets all commands [n][count] of a robot, in [-1, 1]: they become targets within the ranges of its joints."""
        self._set(Quantity.COMMAND, robot, self._rows(commands), 1)

    def set_feedforward(self, first: int, efforts: Any) -> None:
        """Sets efforts [n][count] that are added to those of the drives from joint `first` on, N m (N)."""
        self._set(Quantity.FEEDFORWARD, first, self._rows(efforts), 1)

    def push(self, body: int, force: Any, torque: Any = 0.0) -> None:
        """Pushes a body in the next step: force [n][3] at the centre of mass and torque [n][3], world axes."""
        self._set(Quantity.BODY_PUSH, body, self._pair(force, torque), 6)

    def push_base(self, robot: int, force: Any, torque: Any = 0.0) -> None:
        """The same on the free base of a robot."""
        self._set(Quantity.BASE_PUSH, robot, self._pair(force, torque), 6)

    def push_link(self, link: int, force: Any, point: Any) -> None:
        """Pushes a link in the next step: force [n][3] at a point [n][3] of the world."""
        self._set(Quantity.LINK_PUSH, link, self._pair(force, point), 6)

    def set_factors(self, what: int, index: int, factor: Any, other: int = 0) -> None:
        """Scales a constant of the scene by a factor [n] in each world until its episode ends; needs SceneBuilder.adjustable.
        what: a redman.Scale; index: the number of the part that has it; other: of the second material of a friction."""
        row = _abi.rdm_factor(what=int(what), index=index, other=other)
        for i, value in enumerate(np.broadcast_to(factor, (self.n,))):
            row.factor = float(value)
            check(lib.rdm_world_set_factors(self._world(i), ctypes.byref(row), 1))

    def fail(self, rows: Any) -> None:
        """Ends the episodes of the rows [n] that are true, as truncated and with Status.TASK; the others continue."""
        results = self._array(self._results, self.n, np.int32)
        results[np.broadcast_to(rows, (self.n,)).astype(bool)] = int(ResultCode.STATE)

    # --- draws

    def uniform(self, low: Any, high: Any, count: Optional[int] = None) -> Any:
        """[n], or [n][count], random numbers, uniform in [low, high), from each world's own stream: the same for the same
        seed."""
        return self._draw(lambda at: float(_uniform(at, low, high)), count)

    def normal(self, count: Optional[int] = None) -> Any:
        """[n], or [n][count], normal random numbers of mean 0 and standard deviation 1."""
        return self._draw(_normal, count)

    # ---

    def _keep_streams(self, states: int, offset: int, stride: int) -> None:
        """After reset: stores a stream for the episode in the state."""
        for i in range(self.n):
            check(_split((self._randoms or 0) + i * self._stride, states + i * stride + offset))

    def _draw_from(self, states: int, offset: int, stride: int) -> None:
        self._randoms, self._stride = states + offset, stride

    def _draw(self, draw: Callable[[int], float], count: Optional[int]) -> Any:
        if not self._randoms:
            raise ArgumentError("uniform, normal: they can only be used in reset; with draws = True in the class of the task also in control and judge")
        first, stride = self._randoms, self._stride
        out = np.array([[draw(first + i * stride) for _ in range(1 if count is None else count)] for i in range(self.n)])
        return out[:, 0] if count is None else out

    def _world(self, row: int) -> int:
        return int(self._array(self._worlds, self.n, np.uintp)[row])

    def _joints(self, what: int) -> Any:
        if not hasattr(self, "_count"):
            row = _abi.rdm_joints(struct_size=ctypes.sizeof(_abi.rdm_joints))
            check(lib.rdm_world_get_joints(self._world(0), ctypes.byref(row)))
            self._count = row.count
        out = np.empty((self.n, self._count))
        check(_get_many(self._worlds, self.n, what, 0, self._count, out.ctypes.data))
        return out

    def _get(self, what: int, first: int) -> Any:
        out = self._seen.get((what, first))
        if out is None:
            out = np.empty((self.n, _WIDTH.get(what, 1)))
            code = _get_many(self._worlds, self.n, what, first, 1, out.ctypes.data)
            if code:
                check(code)
            out.flags.writeable = False  # the next call may have it again
            self._seen[what, first] = out
        return out

    def _set(self, what: int, first: int, rows: Any, width: int) -> None:
        self._seen = {}
        code = _set_many(self._worlds, self.n, what, first, rows.size // (self.n * width), rows.ctypes.data)
        if code:
            check(code)

    def _rows(self, given: Any) -> Any:
        array = np.asarray(given, np.float64)
        if array.ndim < 2:
            array = np.broadcast_to(array, (self.n, array.size))
        if array.shape[0] != self.n:
            raise ArgumentError(f"an array of shape {array.shape} was given, but it must have a row for each of {self.n} worlds")
        return np.ascontiguousarray(array)

    def _motions(self, p: Any, q: Any, v: Any, w: Any) -> Any:
        rows = np.empty((self.n, 13))
        rows[:, 0:3], rows[:, 3:7], rows[:, 7:10], rows[:, 10:13] = p, _UNIT_Q if q is None else q, v, w
        return rows

    def _pair(self, a: Any, b: Any) -> Any:
        rows = np.empty((self.n, 6))
        rows[:, 0:3], rows[:, 3:6] = a, b
        return rows
