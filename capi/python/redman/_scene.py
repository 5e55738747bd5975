"""SceneBuilder: builds the scene of a task of your own."""
from __future__ import annotations

import ctypes
from ctypes import byref, c_double, c_int32, c_void_p
from typing import TYPE_CHECKING, Any, Mapping, Optional, Sequence, Union

from . import _abi
from ._abi import ScenePart
from ._definition import fill, pose_of
from ._error import ArgumentError
from ._library import check, encoded, int32, lib, real, sized, text
from ._names import Hinted, one_of
from ._options import Told
from ._rows import given

if TYPE_CHECKING:
    from ._robot import RobotName

_PARTS = {part.name.lower(): int(part) for part in ScenePart}


class SceneBuilder(Hinted):
    """Task.scene adds robots, bodies and shapes to it; each call returns the number that identifies the part in Worlds.

        def scene(self, s):
            self.hand = s.robot("shadow_hand", "hand", pose=[0, 0, 0.1])
            self.ball = s.sphere("ball", 0.035, mass=0.06, pose=[0, -0.4, 0.3])
            s.plane("ground")
            self.touch = s.touch("hand", "ball")
            self.tip = s.find("link", "hand_ff_distal")

    pose is [x, y, z], m, or [x, y, z, qx, qy, qz, qw]; name is that of the part in this scene; mass is in kg; a and b are names
    of materials. The error for a wrong name offers the nearest one. Everything must be added before the first find, touch or
    joint.
    """

    options: Mapping[str, Any]  # values of the task's own options in this pool; (low, high) where one is a range

    def __init__(self, handle: int, options: Mapping[str, Any]) -> None:
        self._handle: Optional[int] = handle
        self.options = Told(options, "Pool(task, options={...})")

    def option(self, key: str) -> Any:
        """The value of the option `key` in this pool: a number, a text, or (low, high) of a range."""
        if key in self.options:
            return self.options[key]
        value = c_double()
        check(lib.rdm_scene_get_number(self._scene(), encoded(key, "key"), byref(value)))
        return value.value

    # --- bodies

    def body(self, name: str, shapes: Sequence[Mapping[str, Any]], mass: float, pose: Any = (0, 0, 0), **more: Any) -> int:
        """A free body of shapes, each a dict with kind, size (m), pose, material, color (as redman.Object.definition shows them); mass, kg. More: moment,
        linear_damping, angular_damping, weightless."""
        row = sized(_abi.rdm_body_def)
        kept = fill(row, {"name": name, "shapes": shapes, "mass": mass, "pose": pose, **more}, f"body {name}")
        out = self._added(lib.rdm_scene_add_body, row)
        del kept
        return out

    def sphere(self, name: str, radius: float, mass: float, pose: Any = (0, 0, 0), **more: Any) -> int:
        """A free ball; radius, m, mass, kg. Further keywords of body and its shapes: material, color, angular_damping, ..."""
        return self._one(name, "sphere", [radius], mass, pose, more)

    def box(self, name: str, size: Any, mass: float, pose: Any = (0, 0, 0), **more: Any) -> int:
        """A free box; size, half of its edges [3], m."""
        return self._one(name, "box", size, mass, pose, more)

    def capsule(self, name: str, radius: float, half_length: float, mass: float, pose: Any = (0, 0, 0), **more: Any) -> int:
        """A free capsule along z; radius and half_length, half of the length between the centres of its ends, m."""
        return self._one(name, "capsule", [radius, half_length], mass, pose, more)

    def cylinder(self, name: str, radius: float, half_length: float, mass: float, pose: Any = (0, 0, 0), **more: Any) -> int:
        """A free cylinder along z; radius and half_length, half of its length, m."""
        return self._one(name, "cylinder", [radius, half_length], mass, pose, more)

    def object(self, object_name: str, name: Optional[str] = None, pose: Any = (0, 0, 0), scale: float = 1.0) -> int:
        """One of redman.objects() by its object_name, or the file of one, as a free body; name: its name in this scene, None:
        as it is called; scale: of its lengths."""
        from ._object import objects
        from ._paths import named
        out, at, called = c_int32(), pose_of(pose), named("object", object_name)
        check(lib.rdm_scene_add_object(self._scene(), objects()[called].number, encoded(name or called, "name"),
                                       byref(at), real(scale, "scale"), byref(out)))
        return out.value

    # --- what stands still, robots

    def static(self, kind: str, size: Any = (), name: Optional[str] = None, pose: Any = (0, 0, 0), **more: Any) -> None:
        """A fixed shape: kind "box", "sphere", "plane", ..., size, m, as for a free one."""
        row = _abi.rdm_shape_def()
        kept = fill(row, {"kind": kind, "size": size, "pose": pose, **({"name": name} if name else {}), **more}, f"static {kind}")
        check(lib.rdm_scene_add_static(self._scene(), byref(row)))
        del kept

    def plane(self, name: str = "ground", pose: Any = (0, 0, 0), **more: Any) -> None:
        """The ground: everything below z = 0 of its pose is solid."""
        self.static("plane", (), name, pose, **more)

    def robot(self, robot: Union[RobotName, Mapping[str, Any]], name: str, pose: Any = (0, 0, 0), **more: Any) -> int:
        """A robot of redman.robots(), from a file, or of redman.Robot.create; or a dict of what create takes, for this scene alone
        (a button). name is the prefix of the names of its links, joints and shapes. More: material, base_damping, free_base, left,
        gravity."""
        from ._robot import robot as robot_of
        row = sized(_abi.rdm_scene_robot)
        check(lib.rdm_scene_robot_init(byref(row), ctypes.sizeof(row)))
        kept: list[Any] = []
        if isinstance(robot, Mapping):
            own = sized(_abi.rdm_robot_def)
            check(lib.rdm_robot_def_init(byref(own), ctypes.sizeof(own)))
            kept += fill(own, {"name": name, **robot}, f"robot {name}")
            row.own = ctypes.pointer(own)
        else:
            row.robot = robot_of(robot).number
        kept += fill(row, {"name": name, "pose": pose, **more}, f"robot {name}")
        out = self._added(lib.rdm_scene_add_robot, row)
        del kept
        return out

    # --- materials

    def material(self, name: str, **friction: float) -> None:
        """A new material; friction: its coefficients with existing materials, as in material("rubber", default=0.9)."""
        check(lib.rdm_scene_add_material(self._scene(), encoded(name, "name")))
        for other, mu in friction.items():
            self.friction(name, other, mu)

    def friction(self, a: str, b: str, mu: Optional[float]) -> None:
        """The coefficient of friction mu between two materials, 1 unless set; None: they pass through each other."""
        value = -1.0 if mu is None else real(mu, "mu")
        check(lib.rdm_scene_set_friction(self._scene(), encoded(a, "a"), encoded(b, "b"), value))

    def contact_law(self, a: str, b: str, **law: float) -> None:
        """Contacts of two materials, apart from their friction: restitution, torsional, rolling, time_constant,
        damping_ratio, impedance_min, impedance_max, impedance_width, pyramid."""
        row = sized(_abi.rdm_contact_law)
        check(lib.rdm_contact_law_init(byref(row), ctypes.sizeof(row)))
        fill(row, law, "contact_law")
        check(lib.rdm_scene_set_contact_law(self._scene(), encoded(a, "a"), encoded(b, "b"), byref(row)))

    def gravity(self, g: Sequence[float]) -> None:
        """Gravity g [3], m/s2, instead of the option's."""
        row = given(g, _abi.FUNCTIONS["rdm_scene_set_gravity"].rows["gravity"], {}, "g")
        check(lib.rdm_scene_set_gravity(self._scene(), (c_double * 3)(*row)))

    def adjustable(self) -> None:
        """Allows Worlds.set_factors: masses, gains and friction of each world's own."""
        check(lib.rdm_scene_set_adjustable(self._scene()))

    def feedforward(self) -> None:
        """Allows Worlds.set_feedforward: efforts that are added to those of the drives."""
        check(lib.rdm_scene_set_feedforward(self._scene()))

    # --- numbers that follow from options

    def field(self, name: str, count: int) -> None:
        """Sets another count of entries for the field `name` of the observation in this pool."""
        check(lib.rdm_scene_set_field(self._scene(), encoded(name, "name"), int32(count, "count")))

    # --- what is there

    def find(self, part: str, name: str) -> int:
        """The number of a part, "robot", "body", "link", "joint", "shape", "sensor" or "material", by its name."""
        out = c_int32()
        check(lib.rdm_scene_find(self._scene(), one_of(part, _PARTS, "part"), encoded(name, "name"), byref(out)))
        return out.value

    def touch(self, a: str, b: str) -> int:
        """Returns a number for Worlds.touching and touch_force: all contacts of shapes of a with those of b; each is the
        name of a shape, body or robot, or a pattern of such names with * and ?."""
        out = c_int32()
        check(lib.rdm_scene_add_touch(self._scene(), encoded(a, "a"), encoded(b, "b"), byref(out)))
        return out.value

    def joints(self) -> dict[str, int]:
        """Numbers of all joints of all robots by name, in the order of Worlds.q."""
        row, out = sized(_abi.rdm_joint_info), dict[str, int]()
        while not lib.rdm_scene_joint_at(self._scene(), len(out), byref(row)):
            out[text(row.name)] = len(out)
        return out

    # ---

    def _one(self, name: str, kind: str, size: Any, mass: float, pose: Any, more: Mapping[str, Any]) -> int:
        of_body = {key for key, *_ in _abi.rdm_body_def._fields_}
        shape = {"kind": kind, "size": size, **{key: value for key, value in more.items() if key not in of_body}}
        return self.body(name, [shape], mass, pose, **{key: value for key, value in more.items() if key in of_body})

    def _added(self, function: Any, row: ctypes.Structure) -> int:
        out = c_int32()
        check(function(self._scene(), byref(row), byref(out)))
        return out.value

    def _scene(self) -> c_void_p:
        if self._handle is None:
            raise ArgumentError("scene: it can only be used within Task.scene")
        return c_void_p(self._handle)

    def _end(self) -> None:
        self._handle = None
