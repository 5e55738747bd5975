"""The C ABI for ctypes. Written by generate_abi.py from include/redman: change the headers, not this file."""
from __future__ import annotations

import enum
from ctypes import (CDLL, CFUNCTYPE, POINTER, Structure, c_char_p, c_double, c_float, c_int8, c_int32, c_int64,
                    c_size_t, c_uint8, c_uint32, c_uint64, c_void_p)
from typing import Any, NamedTuple

from ._record import Members, Record


class Rows(NamedTuple):
    """What a pointer points at: the numpy type and the shape, its lengths by name."""

    dtype: str
    shape: tuple[str, ...]


class Function(NamedTuple):
    """A function of the library; rows are the arguments that are arrays."""

    result: Any
    arguments: dict[str, Any]
    rows: dict[str, Rows]
    experimental: bool
    doc: str


RDM_VERSION_MAJOR = 1  # The version of this header; rdm_version() is that of the library.
RDM_VERSION_MINOR = 0  # The version of this header; rdm_version() is that of the library.
RDM_VERSION_PATCH = 0  # The version of this header; rdm_version() is that of the library.
RDM_ABI = 1  # also the SONAME; changes only when an old binary would break
RDM_MAX_COSTS = 16  # cost columns of a task or an agent
RDM_TEXT_SIZE = 64  # bytes of an option's text value, terminator included
RDM_MAX_GUARDS = 32  # half spaces of an action, at most
RDM_MAX_LINKS = 64  # links of a robot, at most
RDM_MAX_KNOTS = 4  # knots of a curve, at most
RDM_MAX_SHAPES = 64  # most shapes of an object
RDM_VERSION = RDM_VERSION_MAJOR * 1000000 + RDM_VERSION_MINOR * 1000 + RDM_VERSION_PATCH
VERSION = "1.0.0"  # that these types are of


class ResultCode(enum.IntEnum, metaclass=Members):
    """values of Error.code

    OK = 0
    ARGUMENT = -1: NULL, wrong struct_size, not finite, malformed
    RANGE = -2: outside the documented bounds; index past the end
    STATE = -3: calls in the wrong order
    MEMORY = -4: the allocator refused
    IO = -5: file system
    FORMAT = -6: truncated, corrupt or foreign bytes
    VERSION_MISMATCH = -7: newer file, newer struct, other ABI
    UNSUPPORTED = -8: left out of this build, or not defined for this combination
    PHYSICS = -9: the physics engine failed, and no single world could be flagged
    NOT_FOUND = -10: unknown name (the text offers the nearest), missing file
    CANCELLED = -11: the host ended the call; the handle is still usable
    INTERNAL = -99: a bug in redman
    """

    OK = 0
    ARGUMENT = -1
    RANGE = -2
    STATE = -3
    MEMORY = -4
    IO = -5
    FORMAT = -6
    VERSION_MISMATCH = -7
    UNSUPPORTED = -8
    PHYSICS = -9
    NOT_FOUND = -10
    CANCELLED = -11
    INTERNAL = -99


class Feature(enum.IntFlag, metaclass=Members):
    """Parts of the library that a build may leave out: simulation, learning, and frozen policies, which
    a build may have without learning.

    SIM = 1
    LEARN = 2
    POLICY = 4
    """

    SIM = 1
    LEARN = 2
    POLICY = 4


class OptionKind(enum.IntEnum, metaclass=Members):
    """of an option

    NUMBER = 0
    INTEGER = 1
    FLAG = 2
    TEXT = 3
    """

    NUMBER = 0
    INTEGER = 1
    FLAG = 2
    TEXT = 3


class OptionLevel(enum.IntEnum, metaclass=Members):
    """whom an option is for

    BASIC = 0: for all users: lists begin with these; options of tasks of your own are of this level
    ADVANCED = 1: for tuning
    LEGACY = 2: for comparisons with the paper, an older release or another engine
    """

    BASIC = 0
    ADVANCED = 1
    LEGACY = 2


class ShapeKind(enum.IntEnum, metaclass=Members):
    """of Shape

    SPHERE = 0
    CAPSULE = 1
    BOX = 2
    CYLINDER = 3
    PLANE = 4
    ELLIPSOID = 5
    HULL = 6
    """

    SPHERE = 0
    CAPSULE = 1
    BOX = 2
    CYLINDER = 3
    PLANE = 4
    ELLIPSOID = 5
    HULL = 6


class JointKind(enum.IntEnum, metaclass=Members):
    """of a joint

    REVOLUTE = 0
    PRISMATIC = 1
    """

    REVOLUTE = 0
    PRISMATIC = 1


class Autoreset(enum.IntEnum, metaclass=Members):
    """When a world begins again by itself: in the step that ended its episode, in the next, or
    never.

    SAME_STEP = 0
    NEXT_STEP = 1
    OFF = 2
    """

    SAME_STEP = 0
    NEXT_STEP = 1
    OFF = 2


class Status(enum.IntFlag, metaclass=Members):
    """bits of Pool.status

    CONTACTS = 1: contacts beyond contacts_max were left out
    DIVERGED = 2: a value was not finite: the episode was truncated
    BAD_ACTION = 4: the row of actions was not finite: likewise
    TASK = 8: a function of a host's own task failed: likewise
    SOLVER = 16: the contact solver did not converge (engine ode does not report this): a contact was wrong by
        more than 1 m/s along its normal when the sweeps ended (something light under something much heavier,
        with few iterations), or it kept giving way (contact_max_speed below 0.02 m/s)
    SLOWED = 32: a free body that turned by more than 3 rad in a substep was slowed to that
    """

    CONTACTS = 1
    DIVERGED = 2
    BAD_ACTION = 4
    TASK = 8
    SOLVER = 16
    SLOWED = 32


class BaselineKind(enum.IntEnum, metaclass=Members):
    """simple actions to compare learned ones with

    ZERO = 0
    HOLD = 1
    RANDOM = 2
    """

    ZERO = 0
    HOLD = 1
    RANDOM = 2


class ActMode(enum.IntEnum, metaclass=Members):
    """of rdm_agent_act

    SAMPLE = 0
    MEAN = 1
    """

    SAMPLE = 0
    MEAN = 1


class EpochFlag(enum.IntFlag, metaclass=Members):
    """of rdm_epoch.flags

    NO_EPISODE = 1: no episode has ended so far: ret, cost, length and rates are NaN
    SKIPPED_GRADIENTS = 2: gradients that were not finite were left out
    INVALID_ROWS = 4: rows with valid 0
    CUT = 8: episodes were counted as ended at max_steps or episode_steps
    DIVERGED = 16: decisions flagged Status.DIVERGED
    CONTACTS = 32: decisions flagged Status.CONTACTS
    BAD_ACTION = 64: decisions flagged Status.BAD_ACTION
    TASK = 128: decisions flagged Status.TASK
    SOLVER = 256: decisions flagged Status.SOLVER
    SLOWED = 512: decisions flagged Status.SLOWED
    """

    NO_EPISODE = 1
    SKIPPED_GRADIENTS = 2
    INVALID_ROWS = 4
    CUT = 8
    DIVERGED = 16
    CONTACTS = 32
    BAD_ACTION = 64
    TASK = 128
    SOLVER = 256
    SLOWED = 512


class Look(enum.IntEnum, metaclass=Members):
    """How pictures look.

    FINE = 0: for people: soft shadows, materials, round edges, fingernails
    PLAIN = 1: as rdm_sensors shows them, in half the time or less
    """

    FINE = 0
    PLAIN = 1


class MapFormat(enum.IntEnum, metaclass=Members):
    """OctoMap's files: MapFormat.BINARY (.bt: occupied or free) and MapFormat.FULL (.ot: the probabilities
    too).

    BINARY = 0
    FULL = 1
    """

    BINARY = 0
    FULL = 1


class ShieldKind(enum.IntEnum, metaclass=Members):
    """what a shield did with a proposed action

    OWN = 0: it was executed as proposed
    CHANGED = 1: refused; another action was found whose plan keeps the budgets
    PLAN = 2: refused; the next action of the plan that was made before
    UNPROVEN = 3: nothing that was tried keeps the budgets: with option unproven=least what exceeds them least
    PROJECTED = 4: it broke guards; the nearest action that keeps them was executed
    """

    OWN = 0
    CHANGED = 1
    PLAN = 2
    UNPROVEN = 3
    PROJECTED = 4


class RobotKind(enum.IntEnum, metaclass=Members):
    """of a robot

    OTHER = 0
    HAND = 1
    ARM = 2
    """

    OTHER = 0
    HAND = 1
    ARM = 2


class LinkRow(enum.IntEnum, metaclass=Members):
    """instead of a row of links

    ROOT = -1
    NONE = -2
    """

    ROOT = -1
    NONE = -2


class ScenePart(enum.IntEnum, metaclass=Members):
    """what rdm_scene_find looks for; numbers count from 0 in the order of adding

    ROBOT = 0
    BODY = 1
    LINK = 2: of all robots, robot by robot; joint i moves link i
    JOINT = 3
    SHAPE = 4: as Pool.shapes: of robots, of bodies, then fixed ones
    SENSOR = 5: the link of a fingertip, for rdm_world_get_sensor
    MATERIAL = 6: "default" is 0
    """

    ROBOT = 0
    BODY = 1
    LINK = 2
    JOINT = 3
    SHAPE = 4
    SENSOR = 5
    MATERIAL = 6


class Friction(enum.IntEnum, metaclass=Members):
    """instead of a coefficient

    PASSES = -1
    """

    PASSES = -1


class Scale(enum.IntEnum, metaclass=Members):
    """what a factor scales, and in brackets its bounds

    GRAVITY = 0: [-10, 10]
    LINK_MASS = 1: [0.001, 1000], moments with it; index: link
    LINK_KP = 2
    LINK_KD = 3
    LINK_EFFORT = 4
    LINK_FRICTION = 5
    BASE_MASS = 6: [0.001, 1000] of a free base; index: robot
    BASE_DAMPING = 7: [0, 1000] of all links of a robot with a free base
    BODY_MASS = 8: [0.001, 1000], moments with it; index: body
    BODY_SIZE = 9: [0.05, 20] of all its shapes, moments with the square
    BODY_LINEAR_DAMPING = 10
    BODY_ANGULAR_DAMPING = 11: [0, 1000]
    FRICTION = 12: [0, 1000] of two materials, index and other
    """

    GRAVITY = 0
    LINK_MASS = 1
    LINK_KP = 2
    LINK_KD = 3
    LINK_EFFORT = 4
    LINK_FRICTION = 5
    BASE_MASS = 6
    BASE_DAMPING = 7
    BODY_MASS = 8
    BODY_SIZE = 9
    BODY_LINEAR_DAMPING = 10
    BODY_ANGULAR_DAMPING = 11
    FRICTION = 12


class Quantity(enum.IntEnum, metaclass=Members):
    """a quantity of worlds, and how many doubles it has

    Q = 0: 1: coordinate of a joint, rad (m)
    QD = 1: 1: its velocity, rad/s (m/s)
    TARGET = 2: 1: target of its drive; can be set
    TORQUE = 3: 1: torque of its drive, mean over the step, N m (N)
    LINK = 4: 13: p, q, v, w as rdm_motion
    BASE = 5: 13: likewise, of a robot; can be set where it is free
    BODY = 6: 13: likewise; can be set
    SHAPE = 7: 7: p, q
    SENSOR = 8: 6: force, torque as rdm_world_get_sensor
    TOUCH = 9: 2: pairs and force as rdm_world_get_touch
    JOINT = 10: 2: coordinate and velocity; all joints of robot `first`
    COMMAND = 11: 1: in [-1, 1]; all commands of one robot, whose number is `first`
    FEEDFORWARD = 12: 1: effort of a joint, N m (N)
    BODY_PUSH = 13: 6: force and torque as rdm_world_push_body
    BASE_PUSH = 14: 6: as rdm_world_push_base
    LINK_PUSH = 15: 6: force and point as rdm_world_push_link
    """

    Q = 0
    QD = 1
    TARGET = 2
    TORQUE = 3
    LINK = 4
    BASE = 5
    BODY = 6
    SHAPE = 7
    SENSOR = 8
    TOUCH = 9
    JOINT = 10
    COMMAND = 11
    FEEDFORWARD = 12
    BODY_PUSH = 13
    BASE_PUSH = 14
    LINK_PUSH = 15


class Build(Record):
    """what this library was built from

    abi: the number of the ABI of the library
    version: "1.0.0"
    ode: version of ODE; "" in a build without simulation
    eigen: version of Eigen
    ccd: version of libccd
    octomap: version of OctoMap
    precision: "double physics, float networks"
    compiler: name and version
    kernels: instruction set that networks use on this machine
    differs: "ODE", "libccd" or "ODE, libccd": libraries whose results here differ in their last bits from those
        behind the recorded hashes (another version, or compiled with fused multiply-adds, as Debian does for
        arm64); worlds with contacts differ too then. "": none, or a build without simulation
    """

    abi: int
    version: str
    ode: str
    eigen: str
    ccd: str
    octomap: str
    precision: str
    compiler: str
    kernels: str
    differs: str


class rdm_build(Structure):
    """what this library was built from

    struct_size: in: bytes
    abi: RDM_ABI of the library
    version: "1.0.0"
    ode: version of ODE; "" in a build without simulation
    eigen: version of Eigen
    ccd: version of libccd
    octomap: version of OctoMap
    precision: "double physics, float networks"
    compiler: name and version
    kernels: instruction set that networks use on this machine
    differs: "ODE", "libccd" or "ODE, libccd": libraries whose results here differ in their last bits from those
        behind the recorded hashes (another version, or compiled with fused multiply-adds, as Debian does for
        arm64); worlds with contacts differ too then. "": none, or a build without simulation
    """

    struct_size: int
    abi: int
    version: bytes | None
    ode: bytes | None
    eigen: bytes | None
    ccd: bytes | None
    octomap: bytes | None
    precision: bytes | None
    compiler: bytes | None
    kernels: bytes | None
    differs: bytes | None
    _fields_ = [
        ("struct_size", c_uint32),
        ("abi", c_uint32),
        ("version", c_char_p),
        ("ode", c_char_p),
        ("eigen", c_char_p),
        ("ccd", c_char_p),
        ("octomap", c_char_p),
        ("precision", c_char_p),
        ("compiler", c_char_p),
        ("kernels", c_char_p),
        ("differs", c_char_p),
    ]


rdm_body = CFUNCTYPE(None, c_void_p, c_int32)


rdm_stop = CFUNCTYPE(c_int32, c_void_p, c_int64)


class rdm_host(Structure):
    """memory, log and threads of the host, used instead of the C library's
    and redman's own

    struct_size: bytes
    reserved: 0
    user: passed back to every hook; may be NULL
    alloc: Returns `bytes` of memory at a multiple of `align` (a power of two up to 64), or NULL when there is
        none. Hook NULL: the C library's allocator.
    release: required with alloc
    log: level: 0 info, 1 warning, 2 error; hook NULL: nothing is logged
    parallel: Must call body(context, i) exactly once for each i in [0, n), each call within one OS thread, and
        return when all have returned; one after the other is fine. Hook NULL: redman's own worker threads. If
        it skips an i, repeats one, passes another number or returns early, the redman call that used it returns
        STATE and says so: its work was done in part, and late calls of body do nothing.
    """

    struct_size: int
    reserved: int
    user: int | None
    alloc: Any
    release: Any
    log: Any
    parallel: Any
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("user", c_void_p),
        ("alloc", CFUNCTYPE(c_void_p, c_void_p, c_size_t, c_size_t)),
        ("release", CFUNCTYPE(None, c_void_p, c_void_p, c_size_t, c_size_t)),
        ("log", CFUNCTYPE(None, c_void_p, c_int32, c_char_p)),
        ("parallel", CFUNCTYPE(None, c_void_p, c_int32, rdm_body, c_void_p)),
    ]


class Option(Record):
    """frozen layout: one key and its value

    key: case is ignored and '-' equals '_'
    text: value as one line of text ("0.5", "0.7..1.3", "egg"); NULL: `number` is the value
    number: value when text is NULL
    """

    key: str
    text: str | None
    number: float


class rdm_option(Structure):
    """frozen layout: one key and its value

    key: case is ignored and '-' equals '_'
    text: value as one line of text ("0.5", "0.7..1.3", "egg"); NULL: `number` is the value
    number: value when text is NULL
    """

    key: bytes | None
    text: bytes | None
    number: float
    _fields_ = [
        ("key", c_char_p),
        ("text", c_char_p),
        ("number", c_double),
    ]


class OptionSpec(Record):
    """one row of an option table

    kind: OptionKind.NUMBER, OptionKind.INTEGER, OptionKind.FLAG, OptionKind.TEXT
    live: flag: Agent.set may change it after creation
    level: OptionLevel.BASIC, OptionLevel.ADVANCED, OptionLevel.LEGACY
    key: static; a last word FIELD stands for the name of any field, or a pattern with '*'
    help: one line, with the unit
    text: default of a text option, or of a number whose default is a range; else NULL
    choices: text: the allowed words "a|b|c", NULL: any text; number, integer: "a..b" where a range "0.7..1.3"
        is allowed too, from which each world draws at a reset; else NULL
    number: default of a number, integer or flag; for a range, its middle
    low: inclusive bounds
    high: inclusive bounds
    """

    kind: int
    live: int
    level: int
    key: str
    help: str
    text: str | None
    choices: str | None
    number: float
    low: float
    high: float


class rdm_option_spec(Structure):
    """one row of an option table

    struct_size: in: bytes
    kind: RDM_KIND_NUMBER, RDM_KIND_INTEGER, RDM_KIND_FLAG, RDM_KIND_TEXT
    live: flag: rdm_agent_set_option may change it after creation
    level: RDM_LEVEL_BASIC, RDM_LEVEL_ADVANCED, RDM_LEVEL_LEGACY
    key: static; a last word FIELD stands for the name of any field, or a pattern with '*'
    help: one line, with the unit
    text: default of a text option, or of a number whose default is a range; else NULL
    choices: text: the allowed words "a|b|c", NULL: any text; number, integer: "a..b" where a range "0.7..1.3"
        is allowed too, from which each world draws at a reset; else NULL
    number: default of a number, integer or flag; for a range, its middle
    low: inclusive bounds
    high: inclusive bounds
    """

    struct_size: int
    kind: int
    live: int
    level: int
    key: bytes | None
    help: bytes | None
    text: bytes | None
    choices: bytes | None
    number: float
    low: float
    high: float
    _fields_ = [
        ("struct_size", c_uint32),
        ("kind", c_int32),
        ("live", c_int32),
        ("level", c_int32),
        ("key", c_char_p),
        ("help", c_char_p),
        ("text", c_char_p),
        ("choices", c_char_p),
        ("number", c_double),
        ("low", c_double),
        ("high", c_double),
    ]


class Pose(Record):
    """frozen layout, 7 doubles: where one frame is in another

    p: its origin, m
    q: its rotation, a unit quaternion (x, y, z, w); all 0 in an argument: no rotation
    """

    p: tuple[float, ...]
    q: tuple[float, ...]


class rdm_pose(Structure):
    """frozen layout, 7 doubles: where one frame is in another

    p: its origin, m
    q: its rotation, a unit quaternion (x, y, z, w); all 0 in an argument: no rotation
    """

    p: Any
    q: Any
    _fields_ = [
        ("p", c_double * 3),
        ("q", c_double * 4),
    ]


class Field(Record):
    """frozen layout: consecutive entries of an observation

    name: "right.joint_position"
    unit: what an entry of 1 is: "rad", "5 m/s", "1" for shares
    offset: first entry
    count: entries
    """

    name: str
    unit: str
    offset: int
    count: int


class rdm_field(Structure):
    """frozen layout: consecutive entries of an observation

    name: "right.joint_position"
    unit: what an entry of 1 is: "rad", "5 m/s", "1" for shares
    offset: first entry
    count: entries
    """

    name: bytes | None
    unit: bytes | None
    offset: int
    count: int
    _fields_ = [
        ("name", c_char_p),
        ("unit", c_char_p),
        ("offset", c_int32),
        ("count", c_int32),
    ]


class FieldInfo(Record):
    """what consecutive entries of an observation are

    offset: first entry
    count: entries
    name: "right.joint_position"
    unit: what an entry of 1 is: "rad", "5 m/s", "1" for shares
    low: bounds of every entry; NaN: none
    high: bounds of every entry; NaN: none
    """

    offset: int
    count: int
    name: str
    unit: str
    low: float
    high: float


class rdm_field_info(Structure):
    """what consecutive entries of an observation are

    struct_size: in: bytes
    offset: first entry
    count: entries
    reserved: 0
    name: "right.joint_position"
    unit: what an entry of 1 is: "rad", "5 m/s", "1" for shares
    low: bounds of every entry; NaN: none
    high: bounds of every entry; NaN: none
    """

    struct_size: int
    offset: int
    count: int
    reserved: int
    name: bytes | None
    unit: bytes | None
    low: float
    high: float
    _fields_ = [
        ("struct_size", c_uint32),
        ("offset", c_int32),
        ("count", c_int32),
        ("reserved", c_int32),
        ("name", c_char_p),
        ("unit", c_char_p),
        ("low", c_float),
        ("high", c_float),
    ]


class Tensor(Record):
    """frozen layout: a named block of parameters

    name: "actor.0.weight", "actor.log_std", "reward_critic.1.bias"
    rows: row-major; cols 1 for vectors
    cols: row-major; cols 1 for vectors
    """

    name: str
    rows: int
    cols: int


class rdm_tensor(Structure):
    """frozen layout: a named block of parameters

    name: "actor.0.weight", "actor.log_std", "reward_critic.1.bias"
    rows: row-major; cols 1 for vectors
    cols: row-major; cols 1 for vectors
    """

    name: bytes | None
    rows: int
    cols: int
    _fields_ = [
        ("name", c_char_p),
        ("rows", c_int32),
        ("cols", c_int32),
    ]


class Spec(Record):
    """sizes of a pool's rows; policies are checked against it

    control_dt: s between steps
    obs_dim: count
    action_dim: count
    cost_dim: count
    max_steps: control steps of an episode
    layout_hash: hash of field names, counts and action order; policy files keep it
    num_fields: for Pool.fields
    num_shapes: for Pool.shapes
    num_joints: of all robots
    task: index for Task.number
    action_repeat: control steps in one Pool.step: option action_repeat
    """

    control_dt: float
    obs_dim: int
    action_dim: int
    cost_dim: int
    max_steps: int
    layout_hash: int
    num_fields: int
    num_shapes: int
    num_joints: int
    task: int
    action_repeat: int


class rdm_spec(Structure):
    """sizes of a pool's rows; policies are checked against it

    struct_size: in: bytes
    control_dt: s between steps
    obs_dim: count
    action_dim: count
    cost_dim: count
    max_steps: control steps of an episode
    layout_hash: hash of field names, counts and action order; policy files keep it
    num_fields: for rdm_pool_field_at
    num_shapes: for rdm_pool_shape_at
    num_joints: of all robots
    task: index for rdm_task_at and the like
    action_repeat: control steps in one rdm_pool_step: option action_repeat
    reserved: 0
    """

    struct_size: int
    control_dt: float
    obs_dim: int
    action_dim: int
    cost_dim: int
    max_steps: int
    layout_hash: int
    num_fields: int
    num_shapes: int
    num_joints: int
    task: int
    action_repeat: int
    reserved: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("control_dt", c_float),
        ("obs_dim", c_int32),
        ("action_dim", c_int32),
        ("cost_dim", c_int32),
        ("max_steps", c_int32),
        ("layout_hash", c_uint64),
        ("num_fields", c_int32),
        ("num_shapes", c_int32),
        ("num_joints", c_int32),
        ("task", c_int32),
        ("action_repeat", c_int32),
        ("reserved", c_int32),
    ]


class PolicyInfo(Record):
    """what a policy file says of its network

    obs_dim: count
    action_dim: count
    action_repeat: control steps to hold each action
    control_dt: s, 0: unknown
    noise_correlation: AR(1) coefficient of the noise it was trained with
    layout_hash: 0: unknown
    num_params: of the network
    task: "" for a host's own environment
    activation: of the hidden layers: "tanh", "elu", "relu"; static
    num_points: points of the cloud beside each row, for Policy.act; 0: it reads no clouds
    num_point_classes: number of classes of points that it distinguishes; 0: none
    num_features: number of features that its encoder computes from a cloud; 0: no encoder
    point_color: whether it reads the colours of points: 0, 1
    num_fields: for Policy.fields; 0: the file has none
    novelty: whether Policy.novelty is available: 0, 1
    generation: which network it is: the low 32 bits are the epochs that its agent had learned, the high ones a
        checksum. Data sampled by another generation are stale. 0: unknown
    state_dim: numbers that it remembers of each world, for Policy.act; 0: it has no memory
    """

    obs_dim: int
    action_dim: int
    action_repeat: int
    control_dt: float
    noise_correlation: float
    layout_hash: int
    num_params: int
    task: str
    activation: str
    num_points: int
    num_point_classes: int
    num_features: int
    point_color: int
    num_fields: int
    novelty: int
    generation: int
    state_dim: int


class rdm_policy_info(Structure):
    """what a policy file says of its network

    struct_size: in: bytes
    obs_dim: count
    action_dim: count
    action_repeat: control steps to hold each action
    control_dt: s, 0: unknown
    noise_correlation: AR(1) coefficient of the noise it was trained with
    layout_hash: 0: unknown
    num_params: of the network
    task: "" for a host's own environment
    activation: of the hidden layers: "tanh", "elu", "relu"; static
    num_points: points of the cloud beside each row, for rdm_policy_act_points; 0: it reads no clouds
    num_point_classes: number of classes of points that it distinguishes; 0: none
    num_features: number of features that its encoder computes from a cloud; 0: no encoder
    point_color: whether it reads the colours of points: 0, 1
    num_fields: for rdm_policy_field_at; 0: the file has none
    novelty: whether rdm_policy_novelty is available: 0, 1
    generation: which network it is: the low 32 bits are the epochs that its agent had learned, the high ones a
        checksum. Data sampled by another generation are stale. 0: unknown
    state_dim: numbers that it remembers of each world, for rdm_policy_act_state; 0: it has no memory
    reserved2: 0
    """

    struct_size: int
    obs_dim: int
    action_dim: int
    action_repeat: int
    control_dt: float
    noise_correlation: float
    layout_hash: int
    num_params: int
    task: bytes | None
    activation: bytes | None
    num_points: int
    num_point_classes: int
    num_features: int
    point_color: int
    num_fields: int
    novelty: int
    generation: int
    state_dim: int
    reserved2: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("obs_dim", c_int32),
        ("action_dim", c_int32),
        ("action_repeat", c_int32),
        ("control_dt", c_float),
        ("noise_correlation", c_float),
        ("layout_hash", c_uint64),
        ("num_params", c_uint64),
        ("task", c_char_p),
        ("activation", c_char_p),
        ("num_points", c_int32),
        ("num_point_classes", c_int32),
        ("num_features", c_int32),
        ("point_color", c_int32),
        ("num_fields", c_int32),
        ("novelty", c_int32),
        ("generation", c_uint64),
        ("state_dim", c_int32),
        ("reserved2", c_int32),
    ]


class Task(Record):
    """a task with its default options

    control_dt: s between steps, default options
    name: "hand_over_safe_finger"
    summary: one line
    obs_dim: count, default options
    action_dim: count, default options
    cost_dim: count of cost columns
    max_steps: control steps of an episode, default options
    num_fields: for Task.fields
    num_options: for Task.options
    num_cameras: for Task.cameras
    num_defaults: for Task.defaults
    action_order: what the entries of the action are: "thrust, turn"; for hands groups of entries, "right
        joints, force, torque"; default options
    """

    control_dt: float
    name: str
    summary: str
    obs_dim: int
    action_dim: int
    cost_dim: int
    max_steps: int
    num_fields: int
    num_options: int
    num_cameras: int
    num_defaults: int
    action_order: str


class rdm_task(Structure):
    """a task with its default options

    struct_size: in: bytes
    control_dt: s between steps, default options
    name: "hand_over_safe_finger"
    summary: one line
    obs_dim: count, default options
    action_dim: count, default options
    cost_dim: count of cost columns
    max_steps: control steps of an episode, default options
    num_fields: for rdm_task_field_at
    num_options: for rdm_task_option_at
    num_cameras: for rdm_task_camera_at
    num_defaults: for rdm_task_default_at
    action_order: what the entries of the action are: "thrust, turn"; for hands groups of entries, "right
        joints, force, torque"; default options
    """

    struct_size: int
    control_dt: float
    name: bytes | None
    summary: bytes | None
    obs_dim: int
    action_dim: int
    cost_dim: int
    max_steps: int
    num_fields: int
    num_options: int
    num_cameras: int
    num_defaults: int
    action_order: bytes | None
    _fields_ = [
        ("struct_size", c_uint32),
        ("control_dt", c_float),
        ("name", c_char_p),
        ("summary", c_char_p),
        ("obs_dim", c_int32),
        ("action_dim", c_int32),
        ("cost_dim", c_int32),
        ("max_steps", c_int32),
        ("num_fields", c_int32),
        ("num_options", c_int32),
        ("num_cameras", c_int32),
        ("num_defaults", c_int32),
        ("action_order", c_char_p),
    ]


class CostInfo(Record):
    """a cost column

    name: column 0 is "cost", the paper's
    help: one line
    limit: default limit on the sum over an episode; < 0: none
    """

    name: str
    help: str
    limit: float


class rdm_cost_info(Structure):
    """a cost column

    struct_size: in: bytes
    reserved: 0
    name: column 0 is "cost", the paper's
    help: one line
    limit: default limit on the sum over an episode; < 0: none
    """

    struct_size: int
    reserved: int
    name: bytes | None
    help: bytes | None
    limit: float
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("name", c_char_p),
        ("help", c_char_p),
        ("limit", c_double),
    ]


class CameraInfo(Record):
    """a pinhole camera

    mount: what it is fixed to; 0: the world; k > 0: link k - 1 of the scene; -k: the base of its articulation
        (robot) k - 1
    name: "front"
    eye: m, in the frame that mount names
    target: m, likewise; the optical axis runs from eye to target
    up: likewise: what points up in the picture; where it is parallel to the optical axis, -x of the world is
        used
    fov_y: vertical field of view, rad; the focal length in pixels is half the picture's height / tan(fov_y / 2)
    cx: where the optical axis meets the picture: to the right of its centre, as a share of its width
    cy: likewise: below its centre, as a share of its height
    """

    mount: int
    name: str
    eye: tuple[float, ...]
    target: tuple[float, ...]
    up: tuple[float, ...]
    fov_y: float
    cx: float
    cy: float


class rdm_camera_info(Structure):
    """a pinhole camera

    struct_size: in: bytes
    mount: what it is fixed to; 0: the world; k > 0: link k - 1 of the scene; -k: the base of its articulation
        (robot) k - 1
    name: "front"
    eye: m, in the frame that mount names
    target: m, likewise; the optical axis runs from eye to target
    up: likewise: what points up in the picture; where it is parallel to the optical axis, -x of the world is
        used
    fov_y: vertical field of view, rad; the focal length in pixels is half the picture's height / tan(fov_y / 2)
    cx: where the optical axis meets the picture: to the right of its centre, as a share of its width
    cy: likewise: below its centre, as a share of its height
    """

    struct_size: int
    mount: int
    name: bytes | None
    eye: Any
    target: Any
    up: Any
    fov_y: float
    cx: float
    cy: float
    _fields_ = [
        ("struct_size", c_uint32),
        ("mount", c_int32),
        ("name", c_char_p),
        ("eye", c_float * 3),
        ("target", c_float * 3),
        ("up", c_float * 3),
        ("fov_y", c_float),
        ("cx", c_float),
        ("cy", c_float),
    ]


class Robot(Record):
    """a robot description

    num_joints: count
    num_actuated: count of joints with a motor of their own
    name: "shadow_hand"
    summary: one line
    """

    num_joints: int
    num_actuated: int
    name: str
    summary: str


class rdm_robot(Structure):
    """a robot description

    struct_size: in: bytes
    num_joints: count
    num_actuated: count of joints with a motor of their own
    reserved: 0
    name: "shadow_hand"
    summary: one line
    """

    struct_size: int
    num_joints: int
    num_actuated: int
    reserved: int
    name: bytes | None
    summary: bytes | None
    _fields_ = [
        ("struct_size", c_uint32),
        ("num_joints", c_int32),
        ("num_actuated", c_int32),
        ("reserved", c_int32),
        ("name", c_char_p),
        ("summary", c_char_p),
    ]


class JointInfo(Record):
    """a joint of a robot, a scene or a pool's worlds

    kind: JointKind: revolute joints in rad and N m, prismatic in m and N
    parent: the joint before it on the way from the base, -1: none
    action: the entry of the action that moves it (of a robot, or in a scene: its command); -1: none, or known
        only to the functions of a host's task
    name: "FFJ2"; of a pool "right_FFJ2"
    lower: range, rad (m)
    upper: range, rad (m)
    velocity: how fast its drive's target may move, rad/s (m/s); NaN: not known
    kp: stiffness of its drive, N m/rad (N/m); 0: coupled, or no spring
    kd: damping of its drive, N m s/rad (N s/m)
    effort: largest torque (force) of its drive, N m (N)
    """

    kind: int
    parent: int
    action: int
    name: str
    lower: float
    upper: float
    velocity: float
    kp: float
    kd: float
    effort: float


class rdm_joint_info(Structure):
    """a joint of a robot, a scene or a pool's worlds

    struct_size: in: bytes
    kind: RDM_JOINT_*: revolute joints in rad and N m, prismatic in m and N
    parent: the joint before it on the way from the base, -1: none
    action: the entry of the action that moves it (of a robot, or in a scene: its command); -1: none, or known
        only to the functions of a host's task
    name: "FFJ2"; of a pool "right_FFJ2"
    lower: range, rad (m)
    upper: range, rad (m)
    velocity: how fast its drive's target may move, rad/s (m/s); NaN: not known
    kp: stiffness of its drive, N m/rad (N/m); 0: coupled, or no spring
    kd: damping of its drive, N m s/rad (N s/m)
    effort: largest torque (force) of its drive, N m (N)
    """

    struct_size: int
    kind: int
    parent: int
    action: int
    name: bytes | None
    lower: float
    upper: float
    velocity: float
    kp: float
    kd: float
    effort: float
    _fields_ = [
        ("struct_size", c_uint32),
        ("kind", c_int32),
        ("parent", c_int32),
        ("action", c_int32),
        ("name", c_char_p),
        ("lower", c_double),
        ("upper", c_double),
        ("velocity", c_double),
        ("kp", c_double),
        ("kd", c_double),
        ("effort", c_double),
    ]


class ObjectInfo(Record):
    """an object by name, for option object=...

    kind: ShapeKind of its only shape; -1: it has several
    num_shapes: count
    own: flag: a host's own, by Object.create
    name: "egg"
    alias: another name, "025_mug"; NULL: none
    summary: one line, may be ""
    shape: "capsule r 0.03, straight part 0.02": kind and sizes in m
    mass: kg; for "hull": of its default points, at 500 kg/m3
    friction: friction coefficient, on dry surfaces
    low: m, lowest corner of the box around its touchable shapes, relative to its centre of mass, along the axes
        of its description
    high: m, highest corner of the box
    """

    kind: int
    num_shapes: int
    own: int
    name: str
    alias: str | None
    summary: str
    shape: str
    mass: float
    friction: float
    low: tuple[float, ...]
    high: tuple[float, ...]


class rdm_object_info(Structure):
    """an object by name, for option object=...

    struct_size: in: bytes
    kind: RDM_SHAPE_* of its only shape; -1: it has several
    num_shapes: count
    own: flag: a host's own, by rdm_object_create
    name: "egg"
    alias: another name, "025_mug"; NULL: none
    summary: one line, may be ""
    shape: "capsule r 0.03, straight part 0.02": kind and sizes in m
    mass: kg; for "hull": of its default points, at 500 kg/m3
    friction: friction coefficient, on dry surfaces
    low: m, lowest corner of the box around its touchable shapes, relative to its centre of mass, along the axes
        of its description
    high: m, highest corner of the box
    """

    struct_size: int
    kind: int
    num_shapes: int
    own: int
    name: bytes | None
    alias: bytes | None
    summary: bytes | None
    shape: bytes | None
    mass: float
    friction: float
    low: Any
    high: Any
    _fields_ = [
        ("struct_size", c_uint32),
        ("kind", c_int32),
        ("num_shapes", c_int32),
        ("own", c_int32),
        ("name", c_char_p),
        ("alias", c_char_p),
        ("summary", c_char_p),
        ("shape", c_char_p),
        ("mass", c_double),
        ("friction", c_double),
        ("low", c_double * 3),
        ("high", c_double * 3),
    ]


class rdm_pool_config(Structure):
    """what a pool is made from

    struct_size: bytes, set by rdm_pool_config_init
    num_envs: worlds, 1..65536, default 1
    task: name, required; copied
    seed: world i draws from stream (seed, i), until a reset names another
    num_threads: 0 or 1: the caller's thread only; up to 256; default 0
    autoreset: RDM_AUTORESET_*, default same step
    options: [num_options], copied; NULL: none
    num_options: count, default 0
    reserved: 0
    host: hooks of this handle, copied; NULL: those of rdm_init
    settings: options as lines key=value, which override `options`, copied; NULL: none
    error: [error_size] receives the text when a call that takes this config fails; NULL: not wanted
    error_size: bytes, terminator included; a longer text is cut
    reserved2: 0
    user: for a host's own task, which reads it by rdm_scene_user and rdm_world_user; may be NULL
    """

    struct_size: int
    num_envs: int
    task: bytes | None
    seed: int
    num_threads: int
    autoreset: int
    options: Any
    num_options: int
    reserved: int
    host: Any
    settings: bytes | None
    error: int | None
    error_size: int
    reserved2: int
    user: int | None
    _fields_ = [
        ("struct_size", c_uint32),
        ("num_envs", c_int32),
        ("task", c_char_p),
        ("seed", c_uint64),
        ("num_threads", c_int32),
        ("autoreset", c_int32),
        ("options", POINTER(rdm_option)),
        ("num_options", c_int32),
        ("reserved", c_int32),
        ("host", POINTER(rdm_host)),
        ("settings", c_char_p),
        ("error", c_void_p),
        ("error_size", c_int32),
        ("reserved2", c_int32),
        ("user", c_void_p),
    ]


class rdm_buffers(Structure):
    """Rows of world i begin at i * width. Arrays are 64-byte aligned and keep their addresses until
    rdm_pool_destroy or rdm_pool_set_buffers. The library writes them only within calls that change
    worlds.

    struct_size: in: bytes
    reserved: 0
    obs: [num_envs][obs_dim]; tasks with hands cut each entry at +-5
    final_obs: [num_envs][obs_dim] last observation where an episode ended, else as obs
    action: [num_envs][action_dim] in [-1, 1], clipped; the host writes
    reward: [num_envs]
    cost: [num_envs][cost_dim] >= 0; column 0 is the cost of the paper
    cost_raw: [num_envs][cost_dim] the measured value behind each cost
    episode_return: [num_envs] sum of rewards; the finished episode's where one ended
    episode_cost: [num_envs][cost_dim] likewise
    episode_step: [num_envs] control steps, likewise
    status: [num_envs] RDM_STATUS_* of the last step or reset
    terminated: [num_envs] 1: the task ended (a fall)
    truncated: [num_envs] 1: ended by the time limit or a bad status
    success: [num_envs] 1: the task's success holds in this step
    episode_status: [num_envs] all RDM_STATUS_* of the episode; the finished one's where one ended
    """

    struct_size: int
    reserved: int
    obs: int | None
    final_obs: int | None
    action: int | None
    reward: int | None
    cost: int | None
    cost_raw: int | None
    episode_return: int | None
    episode_cost: int | None
    episode_step: int | None
    status: int | None
    terminated: int | None
    truncated: int | None
    success: int | None
    episode_status: int | None
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("obs", c_void_p),
        ("final_obs", c_void_p),
        ("action", c_void_p),
        ("reward", c_void_p),
        ("cost", c_void_p),
        ("cost_raw", c_void_p),
        ("episode_return", c_void_p),
        ("episode_cost", c_void_p),
        ("episode_step", c_void_p),
        ("status", c_void_p),
        ("terminated", c_void_p),
        ("truncated", c_void_p),
        ("success", c_void_p),
        ("episode_status", c_void_p),
    ]


class ShapeInfo(Record):
    """a shape of the scene, the same for all worlds

    kind: ShapeKind.SPHERE ... ShapeKind.HULL; plane: the half space below z = 0 of its frame
    fixed: flag: never moves
    color: red, green, blue, 255
    name: "right.ff_distal"
    size: m: radius | radius, half length along z | half sizes (hull: of its box)
    """

    kind: int
    fixed: int
    color: tuple[int, ...]
    name: str
    size: tuple[float, ...]


class rdm_shape_info(Structure):
    """a shape of the scene, the same for all worlds

    struct_size: in: bytes
    kind: RDM_SHAPE_SPHERE ... RDM_SHAPE_HULL; plane: the half space below z = 0 of its frame
    fixed: flag: never moves
    color: red, green, blue, 255
    name: "right.ff_distal"
    size: m: radius | radius, half length along z | half sizes (hull: of its box)
    """

    struct_size: int
    kind: int
    fixed: int
    color: Any
    name: bytes | None
    size: Any
    _fields_ = [
        ("struct_size", c_uint32),
        ("kind", c_int32),
        ("fixed", c_int32),
        ("color", c_uint8 * 4),
        ("name", c_char_p),
        ("size", c_double * 3),
    ]


class Contact(Record):
    """frozen layout: one contact point of the last substep

    shape_a: for Pool.shapes
    shape_b: for Pool.shapes
    position: m
    normal: unit, from b into a
    force: N, on a
    depth: m
    """

    shape_a: int
    shape_b: int
    position: tuple[float, ...]
    normal: tuple[float, ...]
    force: tuple[float, ...]
    depth: float


class rdm_contact(Structure):
    """frozen layout: one contact point of the last substep

    shape_a: for rdm_pool_shape_at
    shape_b: for rdm_pool_shape_at
    position: m
    normal: unit, from b into a
    force: N, on a
    depth: m
    """

    shape_a: int
    shape_b: int
    position: Any
    normal: Any
    force: Any
    depth: float
    _fields_ = [
        ("shape_a", c_int32),
        ("shape_b", c_int32),
        ("position", c_float * 3),
        ("normal", c_float * 3),
        ("force", c_float * 3),
        ("depth", c_float),
    ]


class PoolStats(Record):
    """counts since create

    contacts_max: largest number of contacts in the last substep of a control step since create, of all worlds;
        other substeps may have had more
    contacts_mean: mean number of contacts in these substeps; 0 before the first
    joint_drift: m, largest gap in any joint now, of all worlds
    steps: control steps that the engine simulated, summed over worlds
    diverged: steps and resets flagged Status.DIVERGED so far
    overflowed: steps flagged Status.CONTACTS so far
    bad_actions: steps flagged Status.BAD_ACTION so far
    task_failed: steps flagged Status.TASK so far
    unconverged: steps flagged Status.SOLVER so far
    slowed: steps flagged Status.SLOWED so far
    solver_residual: m/s, largest error of a contact's normal velocity that the solver's last sweep of the last
        step found, of all worlds; NaN: engine ode does not measure it
    violations: control steps so far in which column 0, or a cost that the task limits, was above 0
    """

    contacts_max: int
    contacts_mean: float
    joint_drift: float
    steps: int
    diverged: int
    overflowed: int
    bad_actions: int
    task_failed: int
    unconverged: int
    slowed: int
    solver_residual: float
    violations: int


class rdm_pool_stats(Structure):
    """counts since create

    struct_size: in: bytes
    contacts_max: largest number of contacts in the last substep of a control step since create, of all worlds;
        other substeps may have had more
    contacts_mean: mean number of contacts in these substeps; 0 before the first
    joint_drift: m, largest gap in any joint now, of all worlds
    steps: control steps that the engine simulated, summed over worlds
    diverged: steps and resets flagged RDM_STATUS_DIVERGED so far
    overflowed: steps flagged RDM_STATUS_CONTACTS so far
    bad_actions: steps flagged RDM_STATUS_BAD_ACTION so far
    task_failed: steps flagged RDM_STATUS_TASK so far
    unconverged: steps flagged RDM_STATUS_SOLVER so far
    slowed: steps flagged RDM_STATUS_SLOWED so far
    solver_residual: m/s, largest error of a contact's normal velocity that the solver's last sweep of the last
        step found, of all worlds; NaN: engine ode does not measure it
    violations: control steps so far in which column 0, or a cost that the task limits, was above 0
    """

    struct_size: int
    contacts_max: int
    contacts_mean: float
    joint_drift: float
    steps: int
    diverged: int
    overflowed: int
    bad_actions: int
    task_failed: int
    unconverged: int
    slowed: int
    solver_residual: float
    violations: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("contacts_max", c_int32),
        ("contacts_mean", c_double),
        ("joint_drift", c_double),
        ("steps", c_int64),
        ("diverged", c_int64),
        ("overflowed", c_int64),
        ("bad_actions", c_int64),
        ("task_failed", c_int64),
        ("unconverged", c_int64),
        ("slowed", c_int64),
        ("solver_residual", c_double),
        ("violations", c_int64),
    ]


class RayHit(Record):
    """what a ray hits first

    shape: for Pool.shapes; -1: nothing, all else is NaN
    distance: m, from the origin
    point: m, where the ray enters it
    normal: unit, out of the shape there
    """

    shape: int
    distance: float
    point: tuple[float, ...]
    normal: tuple[float, ...]


class rdm_ray_hit(Structure):
    """what a ray hits first

    struct_size: in: bytes
    shape: for rdm_pool_shape_at; -1: nothing, all else is NaN
    distance: m, from the origin
    point: m, where the ray enters it
    normal: unit, out of the shape there
    """

    struct_size: int
    shape: int
    distance: float
    point: Any
    normal: Any
    _fields_ = [
        ("struct_size", c_uint32),
        ("shape", c_int32),
        ("distance", c_double),
        ("point", c_double * 3),
        ("normal", c_double * 3),
    ]


class Algo(Record):
    """an algorithm

    num_options: for Algo.options
    name: "ppo_lag"
    summary: one line with the paper
    """

    num_options: int
    name: str
    summary: str


class rdm_algo(Structure):
    """an algorithm

    struct_size: in: bytes
    num_options: for rdm_algo_option_at
    name: "ppo_lag"
    summary: one line with the paper
    """

    struct_size: int
    num_options: int
    name: bytes | None
    summary: bytes | None
    _fields_ = [
        ("struct_size", c_uint32),
        ("num_options", c_int32),
        ("name", c_char_p),
        ("summary", c_char_p),
    ]


class rdm_agent_config(Structure):
    """what an agent is made from

    struct_size: bytes, set by rdm_agent_config_init
    obs_dim: count, 1..16384, required
    action_dim: count, 1..1024, required
    cost_dim: cost columns recorded, 0..RDM_MAX_COSTS, default 1
    num_envs: rows per act, 1..65536, required
    num_threads: 0 or 1: the caller's thread only; up to 256; default 0
    algo: "ppo", "ppo_lag"; copied; default "ppo_lag"
    task: kept in policy files, "" for a host's own environment; copied
    seed: of weights, noise, shuffling; default 0
    layout_hash: kept in policy files; 0: unknown
    control_dt: s, kept in policy files; 0: unknown
    max_steps: control steps of an episode: one that is longer is counted as ended there; 0: unknown
    initial_mean: [action_dim] mean action of the new policy, copied; NULL: 0
    defaults: [num_defaults] defaults, such as a task's, which `options` override; "algo:key" is for one
        algorithm alone
    options: [num_options] the caller's; NULL: none
    num_defaults: count, default 0
    num_options: count, default 0
    cost_limits: [cost_dim] limit on the sum of each cost over an episode, < 0: none; NULL: option cost_limit
        for column 0, which overrides [0] where both are given
    host: hooks of this handle, copied; NULL: those of rdm_init
    settings: options as lines key=value, which override `options`, copied; NULL: none
    error: [error_size] receives the text when a call that takes this config fails; NULL: not wanted
    error_size: bytes, terminator included; a longer text is cut
    reserved2: 0
    fields: [num_fields] fields of an observation, for options actor_obs and critic_obs, copied; NULL: none
    num_fields: count, 0..4096, default 0
    reserved3: 0
    """

    struct_size: int
    obs_dim: int
    action_dim: int
    cost_dim: int
    num_envs: int
    num_threads: int
    algo: bytes | None
    task: bytes | None
    seed: int
    layout_hash: int
    control_dt: float
    max_steps: int
    initial_mean: int | None
    defaults: Any
    options: Any
    num_defaults: int
    num_options: int
    cost_limits: int | None
    host: Any
    settings: bytes | None
    error: int | None
    error_size: int
    reserved2: int
    fields: Any
    num_fields: int
    reserved3: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("obs_dim", c_int32),
        ("action_dim", c_int32),
        ("cost_dim", c_int32),
        ("num_envs", c_int32),
        ("num_threads", c_int32),
        ("algo", c_char_p),
        ("task", c_char_p),
        ("seed", c_uint64),
        ("layout_hash", c_uint64),
        ("control_dt", c_float),
        ("max_steps", c_int32),
        ("initial_mean", c_void_p),
        ("defaults", POINTER(rdm_option)),
        ("options", POINTER(rdm_option)),
        ("num_defaults", c_int32),
        ("num_options", c_int32),
        ("cost_limits", c_void_p),
        ("host", POINTER(rdm_host)),
        ("settings", c_char_p),
        ("error", c_void_p),
        ("error_size", c_int32),
        ("reserved2", c_int32),
        ("fields", POINTER(rdm_field)),
        ("num_fields", c_int32),
        ("reserved3", c_int32),
    ]


class rdm_transition(Structure):
    """what followed the last sampled actions; a row per environment

    struct_size: bytes
    reserved: 0
    reward: [num_envs] summed over the decision, required
    cost: [num_envs][cost_dim] likewise; NULL only if cost_dim is 0
    terminated: [num_envs] NULL: none
    truncated: [num_envs] NULL: none
    final_obs: [num_envs][obs_dim] last observation of an episode, read where truncated; NULL: what follows a
        truncation is valued 0
    valid: [num_envs] 0: not learned from; NULL: all valid
    success: [num_envs] for the statistics; NULL: none
    steps: [num_envs] control steps in this decision; NULL: action_repeat
    status: [num_envs] RDM_STATUS_* of the decision, for the epoch's counts; NULL: none
    generation: rdm_policy_info.generation of the policy that sampled; 0: not checked
    limit: [num_envs] limit on column 0 that the episode of this row has for itself, read where it ends: what is
        held against cost_limit is then the mean of cost - limit + cost_limit; NULL: cost_limit alone
    """

    struct_size: int
    reserved: int
    reward: int | None
    cost: int | None
    terminated: int | None
    truncated: int | None
    final_obs: int | None
    valid: int | None
    success: int | None
    steps: int | None
    status: int | None
    generation: int
    limit: int | None
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("reward", c_void_p),
        ("cost", c_void_p),
        ("terminated", c_void_p),
        ("truncated", c_void_p),
        ("final_obs", c_void_p),
        ("valid", c_void_p),
        ("success", c_void_p),
        ("steps", c_void_p),
        ("status", c_void_p),
        ("generation", c_uint64),
        ("limit", c_void_p),
    ]


class Epoch(Record):
    """One row of the learning curve; means over the last 100 finished episodes. NaN: nothing was
    measured.

    epoch: count from 1
    env_steps: control steps so far, all environments
    episodes: finished so far
    ret: sum of rewards of an episode
    cost: sum of each cost column over an episode; cost_signal says of what; NaN from cost_dim on
    cost_per_step: column 0, per control step; over this epoch's decisions while no episode has ended, and with
        option cost_limit_per_step
    length: control steps of an episode
    fall_rate: share of episodes that terminated
    success_rate: share of episodes with at least one success
    multiplier: Lagrange multiplier of each cost; 0 where the algorithm has none
    kl: KL divergence of the new policy from the old, KL(old || new), summed over action dimensions. First-order
        algorithms: the mean over the minibatches of the last pass, each measured before its step, so 0 when
        there is a single step. Trust-region algorithms: that of the step taken.
    entropy: of the policy
    learning_rate: of the actor, used in this epoch
    action_std: mean over dimensions
    loss_policy: mean over minibatches
    loss_reward_value: mean squared error
    loss_cost_value: mean squared error; NaN without a critic of costs
    clip_fraction: share of samples whose ratio was clipped; focops: whose KL divergence was above eta, which
        leaves them out; NaN: the algorithm does neither
    value_reward: mean prediction over the batch
    value_cost: mean prediction over the batch; NaN without a critic of costs
    passes: passes over the data; fewer after an early stop
    cost_signal: what costs are sums of; 0: costs, 1: their magnitudes (option cost_signal=raw)
    flags: EpochFlag
    skipped_gradients: steps left out for a gradient that was not finite; in this epoch, as all counts below
    invalid_rows: decisions with valid 0, without those that only reset
    diverged: decisions flagged Status.DIVERGED
    contacts_left_out: decisions flagged Status.CONTACTS
    bad_actions: decisions flagged Status.BAD_ACTION
    task_failed: decisions flagged Status.TASK
    unconverged: decisions flagged Status.SOLVER
    slowed: decisions flagged Status.SLOWED
    violations: control steps in which column 0, or a cost that the task limits, was above 0; -1: not an epoch
        of Agent.rollout
    refused: decisions that a shield changed; -1: there was no shield
    unproven: of these, decisions for which no way within the budgets was found; -1: likewise
    copied: control steps simulated in the shield's copies; -1: likewise
    inevitable: of violations, control steps of the unproven decisions: with exact copies no others violate a
        budget; -1: likewise
    """

    epoch: int
    env_steps: int
    episodes: int
    ret: float
    cost: tuple[float, ...]
    cost_per_step: float
    length: float
    fall_rate: float
    success_rate: float
    multiplier: tuple[float, ...]
    kl: float
    entropy: float
    learning_rate: float
    action_std: float
    loss_policy: float
    loss_reward_value: float
    loss_cost_value: float
    clip_fraction: float
    value_reward: float
    value_cost: float
    passes: int
    cost_signal: int
    flags: int
    skipped_gradients: int
    invalid_rows: int
    diverged: int
    contacts_left_out: int
    bad_actions: int
    task_failed: int
    unconverged: int
    slowed: int
    violations: int
    refused: int
    unproven: int
    copied: int
    inevitable: int


class rdm_epoch(Structure):
    """One row of the learning curve; means over the last 100 finished episodes. NaN: nothing was
    measured.

    struct_size: in: bytes
    epoch: count from 1
    env_steps: control steps so far, all environments
    episodes: finished so far
    ret: sum of rewards of an episode
    cost: sum of each cost column over an episode; cost_signal says of what; NaN from cost_dim on
    cost_per_step: column 0, per control step; over this epoch's decisions while no episode has ended, and with
        option cost_limit_per_step
    length: control steps of an episode
    fall_rate: share of episodes that terminated
    success_rate: share of episodes with at least one success
    multiplier: Lagrange multiplier of each cost; 0 where the algorithm has none
    kl: KL divergence of the new policy from the old, KL(old || new), summed over action dimensions. First-order
        algorithms: the mean over the minibatches of the last pass, each measured before its step, so 0 when
        there is a single step. Trust-region algorithms: that of the step taken.
    entropy: of the policy
    learning_rate: of the actor, used in this epoch
    action_std: mean over dimensions
    loss_policy: mean over minibatches
    loss_reward_value: mean squared error
    loss_cost_value: mean squared error; NaN without a critic of costs
    clip_fraction: share of samples whose ratio was clipped; focops: whose KL divergence was above eta, which
        leaves them out; NaN: the algorithm does neither
    value_reward: mean prediction over the batch
    value_cost: mean prediction over the batch; NaN without a critic of costs
    passes: passes over the data; fewer after an early stop
    reserved: 0
    cost_signal: what costs are sums of; 0: costs, 1: their magnitudes (option cost_signal=raw)
    reserved2: 0
    flags: RDM_EPOCH_*
    reserved3: 0
    skipped_gradients: steps left out for a gradient that was not finite; in this epoch, as all counts below
    invalid_rows: decisions with valid 0, without those that only reset
    diverged: decisions flagged RDM_STATUS_DIVERGED
    contacts_left_out: decisions flagged RDM_STATUS_CONTACTS
    bad_actions: decisions flagged RDM_STATUS_BAD_ACTION
    task_failed: decisions flagged RDM_STATUS_TASK
    unconverged: decisions flagged RDM_STATUS_SOLVER
    slowed: decisions flagged RDM_STATUS_SLOWED
    violations: control steps in which column 0, or a cost that the task limits, was above 0; -1: not an epoch
        of rdm_agent_rollout
    refused: decisions that a shield changed; -1: there was no shield
    unproven: of these, decisions for which no way within the budgets was found; -1: likewise
    copied: control steps simulated in the shield's copies; -1: likewise
    inevitable: of violations, control steps of the unproven decisions: with exact copies no others violate a
        budget; -1: likewise
    """

    struct_size: int
    epoch: int
    env_steps: int
    episodes: int
    ret: float
    cost: Any
    cost_per_step: float
    length: float
    fall_rate: float
    success_rate: float
    multiplier: Any
    kl: float
    entropy: float
    learning_rate: float
    action_std: float
    loss_policy: float
    loss_reward_value: float
    loss_cost_value: float
    clip_fraction: float
    value_reward: float
    value_cost: float
    passes: int
    reserved: int
    cost_signal: int
    reserved2: int
    flags: int
    reserved3: int
    skipped_gradients: int
    invalid_rows: int
    diverged: int
    contacts_left_out: int
    bad_actions: int
    task_failed: int
    unconverged: int
    slowed: int
    violations: int
    refused: int
    unproven: int
    copied: int
    inevitable: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("epoch", c_int32),
        ("env_steps", c_int64),
        ("episodes", c_int64),
        ("ret", c_double),
        ("cost", c_double * RDM_MAX_COSTS),
        ("cost_per_step", c_double),
        ("length", c_double),
        ("fall_rate", c_double),
        ("success_rate", c_double),
        ("multiplier", c_double * RDM_MAX_COSTS),
        ("kl", c_double),
        ("entropy", c_double),
        ("learning_rate", c_double),
        ("action_std", c_double),
        ("loss_policy", c_double),
        ("loss_reward_value", c_double),
        ("loss_cost_value", c_double),
        ("clip_fraction", c_double),
        ("value_reward", c_double),
        ("value_cost", c_double),
        ("passes", c_int32),
        ("reserved", c_int32),
        ("cost_signal", c_int32),
        ("reserved2", c_int32),
        ("flags", c_uint32),
        ("reserved3", c_uint32),
        ("skipped_gradients", c_int64),
        ("invalid_rows", c_int64),
        ("diverged", c_int64),
        ("contacts_left_out", c_int64),
        ("bad_actions", c_int64),
        ("task_failed", c_int64),
        ("unconverged", c_int64),
        ("slowed", c_int64),
        ("violations", c_int64),
        ("refused", c_int64),
        ("unproven", c_int64),
        ("copied", c_int64),
        ("inevitable", c_int64),
    ]


class rdm_sensors(Structure):
    """addresses stay until rdm_pool_destroy; NULL where the modality is off

    struct_size: in: bytes
    num_cameras: of rgb, depth and segmentation, in the order of the option `cameras`
    width: pixels
    height: pixels
    num_points: points of each world, option `points`
    num_voxels: along each side of the local grid, option `voxels`
    voxel_size: m
    reserved: 0
    rgb: [num_envs][num_cameras][height][width][3]
    depth: [num_envs][num_cameras][height][width], m along the optical axis, 0: nothing
    segmentation: [num_envs][num_cameras][height][width], shape of rdm_pool_shape_at, -1: nothing
    points: [num_envs][num_points][3], world, m; planes are left out
    point_shape: [num_envs][num_points], -1: nothing was seen
    point_count: [num_envs] number of different points; later rows repeat them in turn, up to those of option
        goal_points, which come last: the first free body at its goal
    voxels: [num_envs][num_voxels][num_voxels][num_voxels] (x, y, z) around the task's object: 1 occupied, 0
        free, -1 not seen
    point_class: [num_envs][num_points] what a point lies on, numbered in this order: the articulations (a hand
        with its arm), the free bodies, anything else or nothing, and with option goal_points the goal
    num_classes: number of these classes; 0 where points are off
    reserved2: 0
    point_color: [num_envs][num_points][3] colour of what a point lies on, sRGB, 0 for nothing; NULL without
        option point_color
    """

    struct_size: int
    num_cameras: int
    width: int
    height: int
    num_points: int
    num_voxels: int
    voxel_size: float
    reserved: int
    rgb: int | None
    depth: int | None
    segmentation: int | None
    points: int | None
    point_shape: int | None
    point_count: int | None
    voxels: int | None
    point_class: int | None
    num_classes: int
    reserved2: int
    point_color: int | None
    _fields_ = [
        ("struct_size", c_uint32),
        ("num_cameras", c_int32),
        ("width", c_int32),
        ("height", c_int32),
        ("num_points", c_int32),
        ("num_voxels", c_int32),
        ("voxel_size", c_float),
        ("reserved", c_int32),
        ("rgb", c_void_p),
        ("depth", c_void_p),
        ("segmentation", c_void_p),
        ("points", c_void_p),
        ("point_shape", c_void_p),
        ("point_count", c_void_p),
        ("voxels", c_void_p),
        ("point_class", c_void_p),
        ("num_classes", c_int32),
        ("reserved2", c_int32),
        ("point_color", c_void_p),
    ]


class rdm_picture(Structure):
    """What rdm_pool_draw draws.

    struct_size: bytes
    env: world, the first of several
    num_envs: worlds side by side in one scene, from env on; 0: one
    width: pixels, 1..8192
    height: pixels, 1..8192
    look: enum rdm_look
    camera: of the task, by name; it is moved back until several worlds fit into the picture
    rgb: [height][width][3], or NULL
    depth: [height][width] m along the optical axis, 0: nothing; or NULL
    segmentation: [height][width], or NULL: shape i of world env + k is k * num_shapes + i, -1: nothing
    """

    struct_size: int
    env: int
    num_envs: int
    width: int
    height: int
    look: int
    camera: bytes | None
    rgb: int | None
    depth: int | None
    segmentation: int | None
    _fields_ = [
        ("struct_size", c_uint32),
        ("env", c_int32),
        ("num_envs", c_int32),
        ("width", c_int32),
        ("height", c_int32),
        ("look", c_int32),
        ("camera", c_char_p),
        ("rgb", c_void_p),
        ("depth", c_void_p),
        ("segmentation", c_void_p),
    ]


class rdm_points(Structure):
    """a cloud for each row of obs, in the call that takes it

    struct_size: bytes
    num_points: of each cloud: the agent's option encoder_points, the policy's num_points
    points: [rows][num_points][3], world, m, required
    point_class: [rows][num_points] less than option encoder_classes; NULL only where that is 0
    point_color: [rows][num_points][3]; NULL only without option encoder_color
    """

    struct_size: int
    num_points: int
    points: int | None
    point_class: int | None
    point_color: int | None
    _fields_ = [
        ("struct_size", c_uint32),
        ("num_points", c_int32),
        ("points", c_void_p),
        ("point_class", c_void_p),
        ("point_color", c_void_p),
    ]


class PretrainConfig(Record):
    """how Agent.pretrain learns

    num_labels: kinds of points to tell apart, 2..64, required
    epochs: passes over the clouds, 1..100000, default 20
    batch_rows: clouds of a minibatch, 1..4096, default 16
    learning_rate: of Adam, 0..10, default 1e-3, falling linearly to a tenth
    validation: share of the clouds held back for validation, 0..0.9, default 0.1
    seed: of the head's weights, of shuffling and of the choice, default 0
    """

    num_labels: int
    epochs: int
    batch_rows: int
    learning_rate: float
    validation: float
    seed: int


class rdm_pretrain_config(Structure):
    """how rdm_agent_pretrain learns

    struct_size: bytes, set by rdm_pretrain_config_init
    num_labels: kinds of points to tell apart, 2..64, required
    epochs: passes over the clouds, 1..100000, default 20
    batch_rows: clouds of a minibatch, 1..4096, default 16
    learning_rate: of Adam, 0..10, default 1e-3, falling linearly to a tenth
    validation: share of the clouds held back for validation, 0..0.9, default 0.1
    seed: of the head's weights, of shuffling and of the choice, default 0
    """

    struct_size: int
    num_labels: int
    epochs: int
    batch_rows: int
    learning_rate: float
    validation: float
    seed: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("num_labels", c_int32),
        ("epochs", c_int32),
        ("batch_rows", c_int32),
        ("learning_rate", c_double),
        ("validation", c_double),
        ("seed", c_uint64),
    ]


class PretrainReport(Record):
    """what Agent.pretrain did

    train_rows: clouds
    validation_rows: clouds
    train_loss: of the last epoch, mean cross-entropy of a point, nats
    validation_loss: likewise, over the clouds held back; NaN without these
    accuracy: share of points classified correctly, of the clouds held back; without these, of all clouds
    most_common: accuracy of always answering with the most common label
    """

    train_rows: int
    validation_rows: int
    train_loss: float
    validation_loss: float
    accuracy: float
    most_common: float


class rdm_pretrain_report(Structure):
    """what rdm_agent_pretrain did

    struct_size: in: bytes
    train_rows: clouds
    validation_rows: clouds
    reserved: 0
    train_loss: of the last epoch, mean cross-entropy of a point, nats
    validation_loss: likewise, over the clouds held back; NaN without these
    accuracy: share of points classified correctly, of the clouds held back; without these, of all clouds
    most_common: accuracy of always answering with the most common label
    """

    struct_size: int
    train_rows: int
    validation_rows: int
    reserved: int
    train_loss: float
    validation_loss: float
    accuracy: float
    most_common: float
    _fields_ = [
        ("struct_size", c_uint32),
        ("train_rows", c_int32),
        ("validation_rows", c_int32),
        ("reserved", c_int32),
        ("train_loss", c_double),
        ("validation_loss", c_double),
        ("accuracy", c_double),
        ("most_common", c_double),
    ]


class rdm_map_config(Structure):
    """what a map is made from

    struct_size: bytes, set by rdm_map_config_init
    reserved: 0
    resolution: side of a voxel, m, 0.001 to 10, default 0.02
    memory: bytes that tree and workspace may take, 2^20 to 2^36, default 2^26
    max_range: m; longer rays clear voxels up to here and add no occupied one; 0: no limit; default 4, with
        which scans by a pool's cameras fit into memory
    hit: probability that a voxel is occupied where a ray ends, 0.5 to 0.999, default 0.7
    miss: the same where a ray passes, 0.001 to 0.5, default 0.4
    low: lowest probability of a voxel, 0.001 to 0.5, default 0.1192
    high: highest probability of a voxel, 0.5 to 0.999, default 0.971
    threshold: occupied from this probability on, low to high, default 0.5
    host: hooks for the workspace, copied; NULL: those of rdm_init
    error: [error_size] receives the text when a call that takes this config fails; NULL: not wanted
    error_size: bytes, terminator included; a longer text is cut
    reserved2: 0
    """

    struct_size: int
    reserved: int
    resolution: float
    memory: int
    max_range: float
    hit: float
    miss: float
    low: float
    high: float
    threshold: float
    host: Any
    error: int | None
    error_size: int
    reserved2: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("resolution", c_double),
        ("memory", c_uint64),
        ("max_range", c_double),
        ("hit", c_double),
        ("miss", c_double),
        ("low", c_double),
        ("high", c_double),
        ("threshold", c_double),
        ("host", POINTER(rdm_host)),
        ("error", c_void_p),
        ("error_size", c_int32),
        ("reserved2", c_int32),
    ]


class MapInfo(Record):
    """how full a map is

    full: 1: updates have been dropped since create, clear or read
    resolution: m; reading a file takes over the file's
    nodes: of the tree
    bytes: of the tree
    bytes_max: memory less the workspace
    dropped: voxel updates that found no memory, since create, clear or read
    """

    full: int
    resolution: float
    nodes: int
    bytes: int
    bytes_max: int
    dropped: int


class rdm_map_info(Structure):
    """how full a map is

    struct_size: in: bytes
    full: 1: updates have been dropped since create, clear or read
    resolution: m; reading a file takes over the file's
    nodes: of the tree
    bytes: of the tree
    bytes_max: memory less the workspace
    dropped: voxel updates that found no memory, since create, clear or read
    """

    struct_size: int
    full: int
    resolution: float
    nodes: int
    bytes: int
    bytes_max: int
    dropped: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("full", c_uint32),
        ("resolution", c_double),
        ("nodes", c_uint64),
        ("bytes", c_uint64),
        ("bytes_max", c_uint64),
        ("dropped", c_uint64),
    ]


class Voxel(Record):
    """frozen layout

    centre: m
    side: m; a multiple of the resolution where voxels were joined
    """

    centre: tuple[float, ...]
    side: float


class rdm_voxel(Structure):
    """frozen layout

    centre: m
    side: m; a multiple of the resolution where voxels were joined
    """

    centre: Any
    side: float
    _fields_ = [
        ("centre", c_float * 3),
        ("side", c_float),
    ]


class rdm_actor_config(Structure):
    """what an actor is made from

    struct_size: bytes, set by rdm_actor_config_init
    num_envs: rows of an act, 1..65536, required
    policy: required; must outlive the actor
    spec: of the pool that it plays in, checked as rdm_policy_check does; its action_repeat must divide the
        policy's. NULL: nothing is checked, and a step is one control step
    seed: of the noise; default 0
    stochastic: 1: actions are sampled, with the noise correlation of the policy; default 0: the mean
    reserved: 0
    center: [action_dim] offset in [-1, 1] that the environment adds to every action; the actor subtracts it, so
        that the sum is the policy's action up to rounding; copied; NULL: 0
    host: hooks of this handle, copied; NULL: those of rdm_init
    error: [error_size] receives the text when a call that takes this config fails; NULL: not wanted
    error_size: bytes, terminator included; a longer text is cut
    reserved2: 0
    """

    struct_size: int
    num_envs: int
    policy: int | None
    spec: Any
    seed: int
    stochastic: int
    reserved: int
    center: int | None
    host: Any
    error: int | None
    error_size: int
    reserved2: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("num_envs", c_int32),
        ("policy", c_void_p),
        ("spec", POINTER(rdm_spec)),
        ("seed", c_uint64),
        ("stochastic", c_int32),
        ("reserved", c_int32),
        ("center", c_void_p),
        ("host", POINTER(rdm_host)),
        ("error", c_void_p),
        ("error_size", c_int32),
        ("reserved2", c_int32),
    ]


class rdm_planner_config(Structure):
    """what a planner is made from

    struct_size: bytes, set by rdm_planner_config_init
    num_threads: threads of the rollouts; 0: as many as the pool has; default 0
    pool: rollouts have its task and options; required; needed only during creation
    seed: of the noise; default 0
    noise: [action_dim] standard deviation of each entry, 0 to 10, copied; NULL: option noise
    cost_limits: [cost_dim] limit on the sum of each cost over an episode, < 0: none, copied; NULL: those of the
        pool, of column 0 the limit that the episode has
    policy: proposes plans: sample 0 of the first iteration is its rollout, the others add noise to that; must
        outlive the planner; NULL: none
    agent: its critic values the states at the horizon's end; must outlive the planner, and no other thread may
        use it while one plans; NULL: none
    options: [num_options] as rdm_planner_option_at lists them, copied; NULL: none
    num_options: count, default 0
    reserved: 0
    host: hooks of this handle, copied; NULL: those of rdm_init
    settings: options as lines key=value, which override `options`, copied; NULL: none
    error: [error_size] receives the text when a call that takes this config fails; NULL: not wanted
    error_size: bytes, terminator included; a longer text is cut
    reserved2: 0
    stop: asked by rdm_planner_act before every step of its rollouts; NULL: plans are always finished
    user: given to `stop`; may be NULL
    """

    struct_size: int
    num_threads: int
    pool: int | None
    seed: int
    noise: int | None
    cost_limits: int | None
    policy: int | None
    agent: int | None
    options: Any
    num_options: int
    reserved: int
    host: Any
    settings: bytes | None
    error: int | None
    error_size: int
    reserved2: int
    stop: Any
    user: int | None
    _fields_ = [
        ("struct_size", c_uint32),
        ("num_threads", c_int32),
        ("pool", c_void_p),
        ("seed", c_uint64),
        ("noise", c_void_p),
        ("cost_limits", c_void_p),
        ("policy", c_void_p),
        ("agent", c_void_p),
        ("options", POINTER(rdm_option)),
        ("num_options", c_int32),
        ("reserved", c_int32),
        ("host", POINTER(rdm_host)),
        ("settings", c_char_p),
        ("error", c_void_p),
        ("error_size", c_int32),
        ("reserved2", c_int32),
        ("stop", rdm_stop),
        ("user", c_void_p),
    ]


class PlannerSpec(Record):
    """sizes of a planner

    samples: worlds rolled out in an iteration
    horizon: steps of the pool
    knots: support points of the noise, at most `horizon`
    action_dim: count
    cost_dim: count
    """

    samples: int
    horizon: int
    knots: int
    action_dim: int
    cost_dim: int


class rdm_planner_spec(Structure):
    """sizes of a planner

    struct_size: in: bytes
    samples: worlds rolled out in an iteration
    horizon: steps of the pool
    knots: support points of the noise, at most `horizon`
    action_dim: count
    cost_dim: count
    """

    struct_size: int
    samples: int
    horizon: int
    knots: int
    action_dim: int
    cost_dim: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("samples", c_int32),
        ("horizon", c_int32),
        ("knots", c_int32),
        ("action_dim", c_int32),
        ("cost_dim", c_int32),
    ]


class PlanInfo(Record):
    """what a call of Planner.act found

    planned: 1: it planned; 0: the plan was followed, and all else but cut and steps is 0
    best: sample that is best in the last iteration that was finished
    cut: 1: config.stop ended it early; else 0
    ret: of that sample: discounted sum of rewards plus the critic's value
    cost: of that sample, sums of each column
    feasible_share: share of that iteration's samples within what the limits leave
    steps: control steps of all rollouts
    iterations: iterations finished: option iterations, or fewer with cut
    """

    planned: int
    best: int
    cut: int
    ret: float
    cost: tuple[float, ...]
    feasible_share: float
    steps: int
    iterations: int


class rdm_plan_info(Structure):
    """what a call of rdm_planner_act found

    struct_size: in: bytes
    planned: 1: it planned; 0: the plan was followed, and all else but cut and steps is 0
    best: sample that is best in the last iteration that was finished
    cut: 1: config.stop ended it early; else 0
    ret: of that sample: discounted sum of rewards plus the critic's value
    cost: of that sample, sums of each column
    feasible_share: share of that iteration's samples within what the limits leave
    steps: control steps of all rollouts
    iterations: iterations finished: option iterations, or fewer with cut
    reserved: 0
    """

    struct_size: int
    planned: int
    best: int
    cut: int
    ret: float
    cost: Any
    feasible_share: float
    steps: int
    iterations: int
    reserved: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("planned", c_int32),
        ("best", c_int32),
        ("cut", c_int32),
        ("ret", c_double),
        ("cost", c_double * RDM_MAX_COSTS),
        ("feasible_share", c_double),
        ("steps", c_int64),
        ("iterations", c_int32),
        ("reserved", c_int32),
    ]


class Guard(Record):
    """a half space of a pool's actions, clipped to [-1, 1]

    column: of the cost that is 0 in every step as long as all guards of that column are kept
    entry: the only entry of the normal that is not 0; -1: there are several
    bound: largest value of normal . action
    """

    column: int
    entry: int
    bound: float


class rdm_guard(Structure):
    """a half space of a pool's actions, clipped to [-1, 1]

    struct_size: in: bytes
    column: of the cost that is 0 in every step as long as all guards of that column are kept
    entry: the only entry of the normal that is not 0; -1: there are several
    bound: largest value of normal . action
    """

    struct_size: int
    column: int
    entry: int
    bound: float
    _fields_ = [
        ("struct_size", c_uint32),
        ("column", c_int32),
        ("entry", c_int32),
        ("bound", c_float),
    ]


class rdm_shield_config(Structure):
    """what a shield is made from

    struct_size: bytes, set by rdm_shield_config_init
    num_threads: threads of the copies, 0 to 256; 0: as many as the pool has; default 0
    pool: the shield is for its task, options and number of worlds; required; needed only during creation
    seed: of noisy actions; default 0
    policy: the first backup, as rdm_shield_add_policy; NULL: none
    steps: steps of the pool that a decision lasts, 1 to 1000; 0: as long as the policy holds an action, 1
        without a policy; default 0
    reserved: 0
    budgets: [cost_dim] bound on the sum of each cost over an episode, copied; < 0: the cost is ignored; NULL: 0
        for column 0, others are ignored. In an episode that has already exceeded one, no more of that cost is
        allowed
    options: [num_options] as rdm_shield_option_at lists them, copied; NULL: none
    num_options: count, default 0
    reserved2: 0
    host: hooks of this handle, copied; NULL: those of rdm_init
    settings: options as lines key=value, which override `options`, copied; NULL: none
    error: [error_size] receives the text when a call that takes this config fails; NULL: not wanted
    error_size: bytes, terminator included; a longer text is cut
    reserved3: 0
    """

    struct_size: int
    num_threads: int
    pool: int | None
    seed: int
    policy: int | None
    steps: int
    reserved: int
    budgets: int | None
    options: Any
    num_options: int
    reserved2: int
    host: Any
    settings: bytes | None
    error: int | None
    error_size: int
    reserved3: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("num_threads", c_int32),
        ("pool", c_void_p),
        ("seed", c_uint64),
        ("policy", c_void_p),
        ("steps", c_int32),
        ("reserved", c_int32),
        ("budgets", c_void_p),
        ("options", POINTER(rdm_option)),
        ("num_options", c_int32),
        ("reserved2", c_int32),
        ("host", POINTER(rdm_host)),
        ("settings", c_char_p),
        ("error", c_void_p),
        ("error_size", c_int32),
        ("reserved3", c_int32),
    ]


class ShieldRow(Record):
    """what was done in a world's last decision, and why

    kind: ShieldKind
    column: when refused, the cost whose budget it would have exceeded, -1: the copy diverged; when projected,
        the column of the guard that it broke most, -1: the host's own; else -1
    ahead: control steps until that; 0: nothing was refused
    backup: the backup that continues the plan: policies are numbered first, then zero, then hold, of those that
        it has; -1: no other plan was looked for
    planned: decisions that are left in its plan, the next one included
    """

    kind: int
    column: int
    ahead: int
    backup: int
    planned: int


class rdm_shield_row(Structure):
    """what was done in a world's last decision, and why

    struct_size: in: bytes
    kind: RDM_SHIELD_*
    column: when refused, the cost whose budget it would have exceeded, -1: the copy diverged; when projected,
        the column of the guard that it broke most, -1: the host's own; else -1
    ahead: control steps until that; 0: nothing was refused
    backup: the backup that continues the plan: policies are numbered first, then zero, then hold, of those that
        it has; -1: no other plan was looked for
    planned: decisions that are left in its plan, the next one included
    """

    struct_size: int
    kind: int
    column: int
    ahead: int
    backup: int
    planned: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("kind", c_int32),
        ("column", c_int32),
        ("ahead", c_int32),
        ("backup", c_int32),
        ("planned", c_int32),
    ]


class ShieldStats(Record):
    """counts since creation, of all worlds

    decisions: count
    inquiries: decisions that were tried in copies
    failed: of these, those whose proposed action would have exceeded a budget
    changed: decisions of ShieldKind.CHANGED
    planned: decisions of ShieldKind.PLAN
    unproven: decisions of ShieldKind.UNPROVEN
    copied: control steps that copies simulated
    projected: decisions of ShieldKind.PROJECTED
    """

    decisions: int
    inquiries: int
    failed: int
    changed: int
    planned: int
    unproven: int
    copied: int
    projected: int


class rdm_shield_stats(Structure):
    """counts since creation, of all worlds

    struct_size: in: bytes
    reserved: 0
    decisions: count
    inquiries: decisions that were tried in copies
    failed: of these, those whose proposed action would have exceeded a budget
    changed: decisions of RDM_SHIELD_CHANGED
    planned: decisions of RDM_SHIELD_PLAN
    unproven: decisions of RDM_SHIELD_UNPROVEN
    copied: control steps that copies simulated
    projected: decisions of RDM_SHIELD_PROJECTED
    """

    struct_size: int
    reserved: int
    decisions: int
    inquiries: int
    failed: int
    changed: int
    planned: int
    unproven: int
    copied: int
    projected: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_int32),
        ("decisions", c_int64),
        ("inquiries", c_int64),
        ("failed", c_int64),
        ("changed", c_int64),
        ("planned", c_int64),
        ("unproven", c_int64),
        ("copied", c_int64),
        ("projected", c_int64),
    ]


class rdm_recording_config(Structure):
    """what a recording is made from

    struct_size: bytes, set by rdm_recording_config_init
    obs_dim: count, 1..16384, required
    action_dim: count, 1..1024, required
    cost_dim: count, 0..RDM_MAX_COSTS, default 0
    task: kept in files, "" for a host's own environment; up to 63 bytes, copied; default ""
    layout_hash: kept in files; 0: unknown
    state_bytes: of one world's state, up to 2^30; 0: no states are kept; default 0
    capacity: rows, 0..2^40, for which memory is taken at once; it grows for more; default 0
    state_stride: begin_step keeps the state of every n-th row of an episode, 1..2^30, default 8
    error_size: bytes of error, terminator included; a longer text is cut
    error: [error_size] receives the text when a call that takes this config fails; NULL: not wanted
    host: hooks of this handle, copied; NULL: those of rdm_init
    num_points: points of the cloud beside each row, 0..65536; 0: no clouds are kept; default 0
    point_color: whether its points have colours: 0, 1; default 0
    """

    struct_size: int
    obs_dim: int
    action_dim: int
    cost_dim: int
    task: bytes | None
    layout_hash: int
    state_bytes: int
    capacity: int
    state_stride: int
    error_size: int
    error: int | None
    host: Any
    num_points: int
    point_color: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("obs_dim", c_int32),
        ("action_dim", c_int32),
        ("cost_dim", c_int32),
        ("task", c_char_p),
        ("layout_hash", c_uint64),
        ("state_bytes", c_uint64),
        ("capacity", c_int64),
        ("state_stride", c_int32),
        ("error_size", c_int32),
        ("error", c_void_p),
        ("host", POINTER(rdm_host)),
        ("num_points", c_int32),
        ("point_color", c_int32),
    ]


class RecordingInfo(Record):
    """what a recording holds

    obs_dim: count
    action_dim: count
    cost_dim: count
    rows: count
    episodes: count, including those that have not ended
    num_states: count
    state_bytes: of each
    layout_hash: 0: unknown
    fingerprint: of obs and label of all rows; checked when an agent that uses them is resumed
    task: "" for a host's own environment
    num_points: points of each row's cloud; 0: there are no clouds
    """

    obs_dim: int
    action_dim: int
    cost_dim: int
    rows: int
    episodes: int
    num_states: int
    state_bytes: int
    layout_hash: int
    fingerprint: int
    task: str
    num_points: int


class rdm_recording_info(Structure):
    """what a recording holds

    struct_size: in: bytes
    obs_dim: count
    action_dim: count
    cost_dim: count
    rows: count
    episodes: count, including those that have not ended
    num_states: count
    state_bytes: of each
    layout_hash: 0: unknown
    fingerprint: of obs and label of all rows; checked when an agent that uses them is resumed
    task: "" for a host's own environment
    num_points: points of each row's cloud; 0: there are no clouds
    reserved: 0
    """

    struct_size: int
    obs_dim: int
    action_dim: int
    cost_dim: int
    rows: int
    episodes: int
    num_states: int
    state_bytes: int
    layout_hash: int
    fingerprint: int
    task: bytes | None
    num_points: int
    reserved: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("obs_dim", c_int32),
        ("action_dim", c_int32),
        ("cost_dim", c_int32),
        ("rows", c_int64),
        ("episodes", c_int64),
        ("num_states", c_int64),
        ("state_bytes", c_uint64),
        ("layout_hash", c_uint64),
        ("fingerprint", c_uint64),
        ("task", c_char_p),
        ("num_points", c_int32),
        ("reserved", c_int32),
    ]


class rdm_recording_rows(Structure):
    """Rows in the order in which they were added; those of an episode are in order of time, those of
    several may alternate.

    struct_size: in: bytes
    reserved: 0
    rows: count
    obs: [rows][obs_dim] before the action
    action: [rows][action_dim] that was done
    label: [rows][action_dim] that the teacher meant; NULL when appending: as action
    reward: [rows] NULL when appending: 0
    cost: [rows][cost_dim] NULL when appending: 0
    terminated: [rows] NULL when appending: none
    truncated: [rows] NULL when appending: none
    success: [rows] NULL when appending: none
    episode: [rows] number of its episode, counted from 0 in the order of first rows; NULL when appending: each
        end begins one
    num_states: count
    state_row: [num_states] row before which the world had the state, ascending
    state: [num_states][state_bytes] what rdm_pool_read_state takes
    points: [rows][num_points][3] mm, world, before the action; NULL without clouds
    point_class: [rows][num_points] as in rdm_sensors; NULL when appending: 0
    point_color: [rows][num_points][3] likewise; NULL without colours
    """

    struct_size: int
    reserved: int
    rows: int
    obs: int | None
    action: int | None
    label: int | None
    reward: int | None
    cost: int | None
    terminated: int | None
    truncated: int | None
    success: int | None
    episode: int | None
    num_states: int
    state_row: int | None
    state: int | None
    points: int | None
    point_class: int | None
    point_color: int | None
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_uint32),
        ("rows", c_int64),
        ("obs", c_void_p),
        ("action", c_void_p),
        ("label", c_void_p),
        ("reward", c_void_p),
        ("cost", c_void_p),
        ("terminated", c_void_p),
        ("truncated", c_void_p),
        ("success", c_void_p),
        ("episode", c_void_p),
        ("num_states", c_int64),
        ("state_row", c_void_p),
        ("state", c_void_p),
        ("points", c_void_p),
        ("point_class", c_void_p),
        ("point_color", c_void_p),
    ]


class rdm_clone_config(Structure):
    """how rdm_agent_clone learns

    struct_size: bytes, set by rdm_clone_config_init
    epochs: passes over the rows, at most, 1..100000, default 30
    batch_rows: of a minibatch, 1..2^20, default 512
    patience: ends after this many epochs without a better validation loss, 0: never; default 5
    learning_rate: of Adam, in the first epoch, 0..10, default 1e-3
    learning_rate_end: in the last epoch, linear in between, 0..10, default 1e-5
    validation: share of the rows held back for validation, in whole episodes, 0..0.9, default 0.1
    action_std: standard deviation of the actor's actions afterwards; 0: unchanged; default 0
    seed: of shuffling and of the choice for validation, default 0
    feed_normalizer: flag: the statistics of observations are first set to the recording's, default 1
    capacity: entries of the two arrays below
    train_loss: [capacity] of each epoch, mean squared error of an entry; NULL: not wanted
    validation_loss: [capacity] likewise, after it; NaN without validation
    """

    struct_size: int
    epochs: int
    batch_rows: int
    patience: int
    learning_rate: float
    learning_rate_end: float
    validation: float
    action_std: float
    seed: int
    feed_normalizer: int
    capacity: int
    train_loss: int | None
    validation_loss: int | None
    _fields_ = [
        ("struct_size", c_uint32),
        ("epochs", c_int32),
        ("batch_rows", c_int32),
        ("patience", c_int32),
        ("learning_rate", c_double),
        ("learning_rate_end", c_double),
        ("validation", c_double),
        ("action_std", c_double),
        ("seed", c_uint64),
        ("feed_normalizer", c_int32),
        ("capacity", c_int32),
        ("train_loss", c_void_p),
        ("validation_loss", c_void_p),
    ]


class CloneReport(Record):
    """what Agent.clone did

    epochs: epochs that were run
    best_epoch: from 1: the epoch whose weights were kept; without validation the last one
    stopped: flag: it ended early
    train_rows: count
    validation_rows: count
    train_loss: of the best epoch, mean squared error of an entry
    validation_loss: likewise, NaN without validation
    """

    epochs: int
    best_epoch: int
    stopped: int
    train_rows: int
    validation_rows: int
    train_loss: float
    validation_loss: float


class rdm_clone_report(Structure):
    """what rdm_agent_clone did

    struct_size: in: bytes
    epochs: epochs that were run
    best_epoch: from 1: the epoch whose weights were kept; without validation the last one
    stopped: flag: it ended early
    train_rows: count
    validation_rows: count
    train_loss: of the best epoch, mean squared error of an entry
    validation_loss: likewise, NaN without validation
    """

    struct_size: int
    epochs: int
    best_epoch: int
    stopped: int
    train_rows: int
    validation_rows: int
    train_loss: float
    validation_loss: float
    _fields_ = [
        ("struct_size", c_uint32),
        ("epochs", c_int32),
        ("best_epoch", c_int32),
        ("stopped", c_int32),
        ("train_rows", c_int64),
        ("validation_rows", c_int64),
        ("train_loss", c_double),
        ("validation_loss", c_double),
    ]


class LearnReport(Record):
    """what Agent.learn_from did

    steps: gradient steps of this call
    rows: count that are learned from
    skipped_gradients: steps left out for a gradient that was not finite
    loss_policy: mean over the steps; NaN without any, as the next four
    loss_reward_value: mean squared error
    loss_cost_value: likewise, of the costs with limits; NaN where there is none
    value_reward: mean prediction
    value_cost: likewise
    cost: what the critics make of the sum of each limited cost over an episode of the policy; NaN for others
    multiplier: of each cost; 0 where there is none
    """

    steps: int
    rows: int
    skipped_gradients: int
    loss_policy: float
    loss_reward_value: float
    loss_cost_value: float
    value_reward: float
    value_cost: float
    cost: tuple[float, ...]
    multiplier: tuple[float, ...]


class rdm_learn_report(Structure):
    """what rdm_agent_learn did

    struct_size: in: bytes
    reserved: 0
    steps: gradient steps of this call
    rows: count that are learned from
    skipped_gradients: steps left out for a gradient that was not finite
    loss_policy: mean over the steps; NaN without any, as the next four
    loss_reward_value: mean squared error
    loss_cost_value: likewise, of the costs with limits; NaN where there is none
    value_reward: mean prediction
    value_cost: likewise
    cost: what the critics make of the sum of each limited cost over an episode of the policy; NaN for others
    multiplier: of each cost; 0 where there is none
    """

    struct_size: int
    reserved: int
    steps: int
    rows: int
    skipped_gradients: int
    loss_policy: float
    loss_reward_value: float
    loss_cost_value: float
    value_reward: float
    value_cost: float
    cost: Any
    multiplier: Any
    _fields_ = [
        ("struct_size", c_uint32),
        ("reserved", c_int32),
        ("steps", c_int64),
        ("rows", c_int64),
        ("skipped_gradients", c_int64),
        ("loss_policy", c_double),
        ("loss_reward_value", c_double),
        ("loss_cost_value", c_double),
        ("value_reward", c_double),
        ("value_cost", c_double),
        ("cost", c_double * RDM_MAX_COSTS),
        ("multiplier", c_double * RDM_MAX_COSTS),
    ]


class rdm_ranks(Structure):
    """which processes learn together, and how they exchange messages

    struct_size: bytes
    rank: of this process, 0..ranks - 1; its world 0 is number rank * num_envs of all
    ranks: processes, 1..4096
    reserved: 0
    user: passed back to the hooks; may be NULL
    gather: An allgather: afterwards, `all` + r * bytes holds the `mine` of rank r, `bytes` long, on all ranks;
        bytes is the same on each. Blocks until all ranks have called it. Returns 0, or any other number for a
        failure. NULL only for a single rank.
    swap: Sends `mine` to rank `partner` and receives that rank's message of the same size in `theirs`. Used
        instead of gather to sum gradients where ranks is a power of two: each rank then receives the data of 2
        gradients in 2 log2(ranks) messages, instead of ranks - 1. NULL on all ranks, or on none.
    """

    struct_size: int
    rank: int
    ranks: int
    reserved: int
    user: int | None
    gather: Any
    swap: Any
    _fields_ = [
        ("struct_size", c_uint32),
        ("rank", c_int32),
        ("ranks", c_int32),
        ("reserved", c_int32),
        ("user", c_void_p),
        ("gather", CFUNCTYPE(c_int32, c_void_p, c_void_p, c_size_t, c_void_p)),
        ("swap", CFUNCTYPE(c_int32, c_void_p, c_int32, c_void_p, c_size_t, c_void_p)),
    ]


class Group(Record):
    """one agent of a team

    first: first entry of its action
    count: number of entries of its action
    num_columns: entries of the observation that it observes
    """

    first: int
    count: int
    num_columns: int


class rdm_group(Structure):
    """one agent of a team

    struct_size: in: bytes
    first: first entry of its action
    count: number of entries of its action
    num_columns: entries of the observation that it observes
    """

    struct_size: int
    first: int
    count: int
    num_columns: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("first", c_int32),
        ("count", c_int32),
        ("num_columns", c_int32),
    ]


class rdm_robot_link(Structure):
    """frozen layout: a link and the joint that moves it; m, rad, kg, N, s

    name: of the link, unique
    joint: of the joint, unique
    parent: an earlier row, RDM_LINK_ROOT
    kind: RDM_JOINT_REVOLUTE, RDM_JOINT_PRISMATIC
    pose: in the parent's frame with the joint at 0
    axis: in the link's own frame, unit
    lower: range, below upper
    upper: range
    velocity: how fast the drive's target may move; 0: at once
    kp: stiffness of the drive, whose effort is kp (target - q) - kd qd
    kd: damping of the drive
    effort: largest effort of the drive, N m (N)
    armature: inertia added about the axis, kg m2; revolute joints alone
    friction: dry friction, N m (N)
    mass: 0 with moments of 0: massless
    com: centre of mass in the link's frame
    moment: xx yy zz xy xz yz about com, axes of the link
    """

    name: bytes | None
    joint: bytes | None
    parent: int
    kind: int
    pose: rdm_pose
    axis: Any
    lower: float
    upper: float
    velocity: float
    kp: float
    kd: float
    effort: float
    armature: float
    friction: float
    mass: float
    com: Any
    moment: Any
    _fields_ = [
        ("name", c_char_p),
        ("joint", c_char_p),
        ("parent", c_int32),
        ("kind", c_int32),
        ("pose", rdm_pose),
        ("axis", c_double * 3),
        ("lower", c_double),
        ("upper", c_double),
        ("velocity", c_double),
        ("kp", c_double),
        ("kd", c_double),
        ("effort", c_double),
        ("armature", c_double),
        ("friction", c_double),
        ("mass", c_double),
        ("com", c_double * 3),
        ("moment", c_double * 6),
    ]


class rdm_robot_shape(Structure):
    """frozen layout: a shape of a link, which can be touched and
    seen

    name: unique
    link: row, RDM_LINK_ROOT
    kind: RDM_SHAPE_SPHERE, RDM_SHAPE_CAPSULE, RDM_SHAPE_BOX, RDM_SHAPE_CYLINDER, RDM_SHAPE_ELLIPSOID
    size: as rdm_shape_info, m
    pose: in the link's frame
    color: red, green, blue, 255
    reserved: 0
    """

    name: bytes | None
    link: int
    kind: int
    size: Any
    pose: rdm_pose
    color: Any
    reserved: Any
    _fields_ = [
        ("name", c_char_p),
        ("link", c_int32),
        ("kind", c_int32),
        ("size", c_double * 3),
        ("pose", rdm_pose),
        ("color", c_uint8 * 4),
        ("reserved", c_uint8 * 4),
    ]


class RobotPair(Record):
    """frozen layout: two shapes of one robot that may touch each other

    a: rows of shapes
    b: rows of shapes
    """

    a: int
    b: int


class rdm_robot_pair(Structure):
    """frozen layout: two shapes of one robot that may touch each other

    a: rows of shapes
    b: rows of shapes
    """

    a: int
    b: int
    _fields_ = [
        ("a", c_int32),
        ("b", c_int32),
    ]


class RobotCoupling(Record):
    """frozen layout: a joint that follows another one, by a tendon or belt

    link: row whose joint follows
    other: row whose joint it follows, which itself follows none
    ratio: q = ratio q_other
    slack: rad; within it the joint moves freely
    """

    link: int
    other: int
    ratio: float
    slack: float


class rdm_robot_coupling(Structure):
    """frozen layout: a joint that follows another one, by a tendon or belt

    link: row whose joint follows
    other: row whose joint it follows, which itself follows none
    ratio: q = ratio q_other
    slack: rad; within it the joint moves freely
    """

    link: int
    other: int
    ratio: float
    slack: float
    _fields_ = [
        ("link", c_int32),
        ("other", c_int32),
        ("ratio", c_double),
        ("slack", c_double),
    ]


class RobotCurve(Record):
    """frozen layout: the target of a joint, a piecewise linear function of a command of -1 to 1

    link: row
    driver: row whose command it is a function of: the same row, or that of the motor
    num_knots: 2 to RDM_MAX_KNOTS
    command: ascending
    angle: in the joint's range, rad (m)
    """

    link: int
    driver: int
    num_knots: int
    command: tuple[float, ...]
    angle: tuple[float, ...]


class rdm_robot_curve(Structure):
    """frozen layout: the target of a joint, a piecewise linear function of a command of -1 to 1

    link: row
    driver: row whose command it is a function of: the same row, or that of the motor
    num_knots: 2 to RDM_MAX_KNOTS
    reserved: 0
    command: ascending
    angle: in the joint's range, rad (m)
    """

    link: int
    driver: int
    num_knots: int
    reserved: int
    command: Any
    angle: Any
    _fields_ = [
        ("link", c_int32),
        ("driver", c_int32),
        ("num_knots", c_int32),
        ("reserved", c_int32),
        ("command", c_double * 4),
        ("angle", c_double * 4),
    ]


class RobotFinger(Record):
    """frozen layout: a finger, whose links are the rows from `first` to `tip`

    name: short; the names of its observations begin with it
    first: row of its first link
    tip: row of its last link, which carries the force sensor
    lateral: row of the joint that spreads it to a side, -1: none
    proximal: row of the joint that bends it at its base, -1: none
    middle: row of the next joint that bends it, -1: none
    thumb: flag
    p_tip: its end, in the frame of `tip`, m
    """

    name: str
    first: int
    tip: int
    lateral: int
    proximal: int
    middle: int
    thumb: int
    p_tip: tuple[float, ...]


class rdm_robot_finger(Structure):
    """frozen layout: a finger, whose links are the rows from `first` to `tip`

    name: short; the names of its observations begin with it
    first: row of its first link
    tip: row of its last link, which carries the force sensor
    lateral: row of the joint that spreads it to a side, -1: none
    proximal: row of the joint that bends it at its base, -1: none
    middle: row of the next joint that bends it, -1: none
    thumb: flag
    p_tip: its end, in the frame of `tip`, m
    """

    name: bytes | None
    first: int
    tip: int
    lateral: int
    proximal: int
    middle: int
    thumb: int
    p_tip: Any
    _fields_ = [
        ("name", c_char_p),
        ("first", c_int32),
        ("tip", c_int32),
        ("lateral", c_int32),
        ("proximal", c_int32),
        ("middle", c_int32),
        ("thumb", c_int32),
        ("p_tip", c_double * 3),
    ]


class rdm_robot_def(Structure):
    """a whole robot; the arrays are copied by rdm_robot_create

    struct_size: bytes, set by rdm_robot_def_init
    kind: RDM_ROBOT_*
    name: letters, digits, '_', '-', '+'; at most 25
    alias: another name; NULL: none
    summary: one line; NULL: none
    links: [num_links] a parent before its children
    shapes: [num_shapes] NULL with num_shapes 0
    pairs: [num_pairs] NULL with num_pairs 0; num_pairs -1: all but neighbours
    couplings: [num_couplings] NULL with num_couplings 0
    curves: [num_curves] NULL with num_curves 0
    commands: [num_commands] rows in the order of actions; NULL, with num_commands 0: all but the followers, by
        row
    fingers: [num_fingers] the first finger first; NULL with num_fingers 0
    home: [num_links] start pose, rad (m); NULL: 0, or the limit nearest to it
    folded: [num_links] of a hand: fingers straight, thumb across the palm; NULL: none
    closed: [num_commands], with 0 of these one for each joint that follows no other, of a hand: commands that
        close it around 5 cm; NULL: none
    num_links: 1 to RDM_MAX_LINKS
    num_shapes: count
    num_pairs: count
    num_couplings: count
    num_curves: count
    num_commands: count; -1: none, springs hold the joints at home (RDM_ROBOT_OTHER, such as a door or scissors)
    num_fingers: count
    mirror: root axis (0, 1, 2) normal to the plane that mirrors it into a left one; -1: none
    root_mass: of the root link, kg
    root_com: in the root frame, m
    root_moment: as rdm_robot_link.moment
    mount: of hands: the frame, z towards the fingers, that is fixed to an arm's flange; in the root frame
    flange: of arms: the frame, z out of the arm, that carries a hand; in flange_link's frame
    flange_link: row, RDM_LINK_NONE
    palm_link: row, RDM_LINK_ROOT, RDM_LINK_NONE
    palm_p: centre of the palm's surface, in palm_link's frame, m
    palm_normal: unit: out of the palm
    palm_fingers: unit: where the fingers point; of a gripper any direction in the palm's plane
    hold_p: where a held object is, in palm_link's frame, m
    """

    struct_size: int
    kind: int
    name: bytes | None
    alias: bytes | None
    summary: bytes | None
    links: Any
    shapes: Any
    pairs: Any
    couplings: Any
    curves: Any
    commands: int | None
    fingers: Any
    home: int | None
    folded: int | None
    closed: int | None
    num_links: int
    num_shapes: int
    num_pairs: int
    num_couplings: int
    num_curves: int
    num_commands: int
    num_fingers: int
    mirror: int
    root_mass: float
    root_com: Any
    root_moment: Any
    mount: rdm_pose
    flange: rdm_pose
    flange_link: int
    palm_link: int
    palm_p: Any
    palm_normal: Any
    palm_fingers: Any
    hold_p: Any
    _fields_ = [
        ("struct_size", c_uint32),
        ("kind", c_int32),
        ("name", c_char_p),
        ("alias", c_char_p),
        ("summary", c_char_p),
        ("links", POINTER(rdm_robot_link)),
        ("shapes", POINTER(rdm_robot_shape)),
        ("pairs", POINTER(rdm_robot_pair)),
        ("couplings", POINTER(rdm_robot_coupling)),
        ("curves", POINTER(rdm_robot_curve)),
        ("commands", c_void_p),
        ("fingers", POINTER(rdm_robot_finger)),
        ("home", c_void_p),
        ("folded", c_void_p),
        ("closed", c_void_p),
        ("num_links", c_int32),
        ("num_shapes", c_int32),
        ("num_pairs", c_int32),
        ("num_couplings", c_int32),
        ("num_curves", c_int32),
        ("num_commands", c_int32),
        ("num_fingers", c_int32),
        ("mirror", c_int32),
        ("root_mass", c_double),
        ("root_com", c_double * 3),
        ("root_moment", c_double * 6),
        ("mount", rdm_pose),
        ("flange", rdm_pose),
        ("flange_link", c_int32),
        ("palm_link", c_int32),
        ("palm_p", c_double * 3),
        ("palm_normal", c_double * 3),
        ("palm_fingers", c_double * 3),
        ("hold_p", c_double * 3),
    ]


class rdm_shape_def(Structure):
    """frozen layout: a shape of a body or an object, or a fixed one

    name: unique in the scene; NULL: that of the body. Unused in an object
    material: of rdm_scene_add_material; NULL: "default". Unused in an object
    points: [num_points][3] of an RDM_SHAPE_HULL: 4 to 32 points, m; else NULL
    num_points: count
    kind: RDM_SHAPE_SPHERE ... RDM_SHAPE_HULL; an RDM_SHAPE_PLANE is fixed
    size: as rdm_shape_info, m; unused in a hull
    pose: in the frame of the body, or in the world
    color: red, green, blue, 255; all 0: grey
    seen_only: flag: it is only seen, nothing touches it
    """

    name: bytes | None
    material: bytes | None
    points: int | None
    num_points: int
    kind: int
    size: Any
    pose: rdm_pose
    color: Any
    seen_only: int
    _fields_ = [
        ("name", c_char_p),
        ("material", c_char_p),
        ("points", c_void_p),
        ("num_points", c_int32),
        ("kind", c_int32),
        ("size", c_double * 3),
        ("pose", rdm_pose),
        ("color", c_uint8 * 4),
        ("seen_only", c_int32),
    ]


class rdm_object_def(Structure):
    """a whole object; rdm_object_create copies it with its shapes

    struct_size: bytes, set by rdm_object_def_init
    num_shapes: 1 to RDM_MAX_SHAPES
    name: letters, digits, '_', '-', '+'; at most 25
    alias: another name; NULL: none
    summary: one line; NULL: none
    material: name of its surface's material in scenes; NULL: "object"
    shapes: [num_shapes] in one frame of your choice; that of a body has its origin at the centre of mass and
        the same axes
    mass: kg, 1e-6 to 1000
    moment: xx yy zz xy xz yz, kg m2; the frame's origin is the centre of mass then. All 0: of the shapes as
        solids of one density; where two overlap, both count
    friction: friction coefficient, on dry surfaces, 0 to 10; default 0.5
    """

    struct_size: int
    num_shapes: int
    name: bytes | None
    alias: bytes | None
    summary: bytes | None
    material: bytes | None
    shapes: Any
    mass: float
    moment: Any
    friction: float
    _fields_ = [
        ("struct_size", c_uint32),
        ("num_shapes", c_int32),
        ("name", c_char_p),
        ("alias", c_char_p),
        ("summary", c_char_p),
        ("material", c_char_p),
        ("shapes", POINTER(rdm_shape_def)),
        ("mass", c_double),
        ("moment", c_double * 6),
        ("friction", c_double),
    ]


class rdm_body_def(Structure):
    """a free body; its frame is at its centre of mass

    struct_size: bytes
    num_shapes: count
    name: unique among bodies and robots
    shapes: [num_shapes] 1 or more
    pose: at the start
    mass: kg
    moment: xx yy zz xy xz yz, kg m2; all 0: of the shapes, solid, of one density
    linear_damping: 1/s
    angular_damping: 1/s; stands for rolling friction
    weightless: flag: feels no gravity
    reserved: 0
    """

    struct_size: int
    num_shapes: int
    name: bytes | None
    shapes: Any
    pose: rdm_pose
    mass: float
    moment: Any
    linear_damping: float
    angular_damping: float
    weightless: int
    reserved: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("num_shapes", c_int32),
        ("name", c_char_p),
        ("shapes", POINTER(rdm_shape_def)),
        ("pose", rdm_pose),
        ("mass", c_double),
        ("moment", c_double * 6),
        ("linear_damping", c_double),
        ("angular_damping", c_double),
        ("weightless", c_int32),
        ("reserved", c_int32),
    ]


class rdm_scene_robot(Structure):
    """a robot in a scene: a registered one, or one of this scene alone (a drawer, a door)

    struct_size: bytes, set by rdm_scene_robot_init
    robot: number from rdm_robot_find; default -1: not given
    own: a robot of this scene alone, instead of `robot`; NULL: none
    name: begins, with '_', the names of its links, joints and shapes; unique
    material: of its shapes; NULL: "default"
    pose: of its base at the start
    base_damping: damping of all links, 1/s; without a free base it has no effect
    free_base: flag: the base moves
    left: flag: the mirror image
    gravity: flag: its links feel gravity
    filled: flag, set by rdm_scene_robot_init; without it robot 0 counts as not given
    """

    struct_size: int
    robot: int
    own: Any
    name: bytes | None
    material: bytes | None
    pose: rdm_pose
    base_damping: float
    free_base: int
    left: int
    gravity: int
    filled: int
    _fields_ = [
        ("struct_size", c_uint32),
        ("robot", c_int32),
        ("own", POINTER(rdm_robot_def)),
        ("name", c_char_p),
        ("material", c_char_p),
        ("pose", rdm_pose),
        ("base_damping", c_double),
        ("free_base", c_int32),
        ("left", c_int32),
        ("gravity", c_int32),
        ("filled", c_int32),
    ]


class ContactLaw(Record):
    """contacts of two materials, apart from their friction

    pyramid: flag, for soft contacts: pyramidal friction, MuJoCo's default, in which contacts are softer the
        more friction they have, and sliding lifts a body
    restitution: 0 to 1: share of its closing speed with which a hard contact opens, where that is above 0.05
        m/s
    torsional: m, 0 to 10: rotation about the normal is opposed by at most this times the normal force
    rolling: m, 0 to 10: rolling likewise
    time_constant: s, up to 10: soft contacts by a spring and damper, as in MuJoCo's solref, of two substeps at
        least; 0: hard contacts
    damping_ratio: of that spring, 0.01 to 100; default 1
    impedance_min: 1e-4 to 0.9999, at first touch, as in MuJoCo's solimp; default 0.9
    impedance_max: likewise, deeper than the width; default 0.95
    impedance_width: m, up to 10; default 0.001
    """

    pyramid: int
    restitution: float
    torsional: float
    rolling: float
    time_constant: float
    damping_ratio: float
    impedance_min: float
    impedance_max: float
    impedance_width: float


class rdm_contact_law(Structure):
    """contacts of two materials, apart from their friction

    struct_size: bytes, set by rdm_contact_law_init
    pyramid: flag, for soft contacts: pyramidal friction, MuJoCo's default, in which contacts are softer the
        more friction they have, and sliding lifts a body
    restitution: 0 to 1: share of its closing speed with which a hard contact opens, where that is above 0.05
        m/s
    torsional: m, 0 to 10: rotation about the normal is opposed by at most this times the normal force
    rolling: m, 0 to 10: rolling likewise
    time_constant: s, up to 10: soft contacts by a spring and damper, as in MuJoCo's solref, of two substeps at
        least; 0: hard contacts
    damping_ratio: of that spring, 0.01 to 100; default 1
    impedance_min: 1e-4 to 0.9999, at first touch, as in MuJoCo's solimp; default 0.9
    impedance_max: likewise, deeper than the width; default 0.95
    impedance_width: m, up to 10; default 0.001
    """

    struct_size: int
    pyramid: int
    restitution: float
    torsional: float
    rolling: float
    time_constant: float
    damping_ratio: float
    impedance_min: float
    impedance_max: float
    impedance_width: float
    _fields_ = [
        ("struct_size", c_uint32),
        ("pyramid", c_int32),
        ("restitution", c_double),
        ("torsional", c_double),
        ("rolling", c_double),
        ("time_constant", c_double),
        ("damping_ratio", c_double),
        ("impedance_min", c_double),
        ("impedance_max", c_double),
        ("impedance_width", c_double),
    ]


class rdm_joints(Structure):
    """the joints of all robots of a world; the addresses are valid during the call

    struct_size: in: bytes
    count: of joints
    control_dt: s of a control step
    q: [count] rad (m)
    qd: [count] rad/s (m/s)
    target: [count] targets of the drives, rad (m)
    torque: [count] of the drives, mean over the step, N m (N)
    """

    struct_size: int
    count: int
    control_dt: float
    q: int | None
    qd: int | None
    target: int | None
    torque: int | None
    _fields_ = [
        ("struct_size", c_uint32),
        ("count", c_int32),
        ("control_dt", c_double),
        ("q", c_void_p),
        ("qd", c_void_p),
        ("target", c_void_p),
        ("torque", c_void_p),
    ]


class rdm_motion(Structure):
    """frozen layout: of a frame, in the world

    pose: where it is
    v: velocity of the frame's origin, m/s
    w: angular velocity, world axes, rad/s
    """

    pose: rdm_pose
    v: Any
    w: Any
    _fields_ = [
        ("pose", rdm_pose),
        ("v", c_double * 3),
        ("w", c_double * 3),
    ]


class Factor(Record):
    """frozen layout: scales a constant of the scene in one world

    what: Scale
    index: of the link, robot or body, or the first material
    other: the second material of a friction
    factor: times the scene's value
    """

    what: int
    index: int
    other: int
    factor: float


class rdm_factor(Structure):
    """frozen layout: scales a constant of the scene in one world

    what: RDM_SCALE_*
    index: of the link, robot or body, or the first material
    other: the second material of a friction
    reserved: 0
    factor: times the scene's value
    """

    what: int
    index: int
    other: int
    reserved: int
    factor: float
    _fields_ = [
        ("what", c_int32),
        ("index", c_int32),
        ("other", c_int32),
        ("reserved", c_int32),
        ("factor", c_double),
    ]


class Random(Record):
    """frozen layout: a stream of random numbers; may be part of a state

    seed: with world and purpose: which stream it is
    counter: draws so far
    world: likewise
    purpose: likewise
    """

    seed: int
    counter: int
    world: int
    purpose: int


class rdm_random(Structure):
    """frozen layout: a stream of random numbers; may be part of a state

    seed: with world and purpose: which stream it is
    counter: draws so far
    world: likewise
    purpose: likewise
    """

    seed: int
    counter: int
    world: int
    purpose: int
    _fields_ = [
        ("seed", c_uint64),
        ("counter", c_uint64),
        ("world", c_uint32),
        ("purpose", c_uint32),
    ]


class Verdict(Record):
    """frozen layout: what judge fills; zeroed before

    reward: of the step
    cost: each column of the step, 0 or more
    cost_raw: the measured value behind each
    terminated: flag: the episode ends here
    success: flag
    """

    reward: float
    cost: tuple[float, ...]
    cost_raw: tuple[float, ...]
    terminated: int
    success: int


class rdm_verdict(Structure):
    """frozen layout: what judge fills; zeroed before

    reward: of the step
    cost: each column of the step, 0 or more
    cost_raw: the measured value behind each
    terminated: flag: the episode ends here
    success: flag
    """

    reward: float
    cost: Any
    cost_raw: Any
    terminated: int
    success: int
    _fields_ = [
        ("reward", c_double),
        ("cost", c_double * RDM_MAX_COSTS),
        ("cost_raw", c_double * RDM_MAX_COSTS),
        ("terminated", c_int32),
        ("success", c_int32),
    ]


class rdm_task_rows(Structure):
    """what a function for many worlds is called with; row i belongs to worlds[i]

    struct_size: bytes
    count: of worlds, 1 to 256
    worlds: [count] in the order of their numbers
    states: [count][state_bytes] copies of the states, written back where the function may change them; NULL
        with state_bytes 0
    results: [count] RDM_OK; any other code makes that world alone fail
    randoms: [count] reset: as its `random`
    actions: [count][action_dim] control
    steps: [count] judge: control steps of the episode, from 1
    verdicts: [count] judge: zeroed before
    obs: [count][obs_dim] observe: all fields
    """

    struct_size: int
    count: int
    worlds: Any
    states: int | None
    results: int | None
    randoms: Any
    actions: int | None
    steps: int | None
    verdicts: Any
    obs: int | None
    _fields_ = [
        ("struct_size", c_uint32),
        ("count", c_int32),
        ("worlds", POINTER(c_void_p)),
        ("states", c_void_p),
        ("results", c_void_p),
        ("randoms", POINTER(rdm_random)),
        ("actions", c_void_p),
        ("steps", c_void_p),
        ("verdicts", POINTER(rdm_verdict)),
        ("obs", c_void_p),
    ]


class FieldDef(Record):
    """frozen layout: a run of observation entries

    name: unique, at most 31 characters: "cup.position"
    unit: what an entry of 1 stands for: "m", "5 rad/s", "1"
    count: entries
    low: lower bound of the entries; low equal to high: no bounds but obs_limit
    high: likewise
    """

    name: str
    unit: str
    count: int
    low: float
    high: float


class rdm_field_def(Structure):
    """frozen layout: a run of observation entries

    name: unique, at most 31 characters: "cup.position"
    unit: what an entry of 1 stands for: "m", "5 rad/s", "1"
    count: entries
    low: lower bound of the entries; low equal to high: no bounds but obs_limit
    high: likewise
    reserved: 0
    """

    name: bytes | None
    unit: bytes | None
    count: int
    low: float
    high: float
    reserved: int
    _fields_ = [
        ("name", c_char_p),
        ("unit", c_char_p),
        ("count", c_int32),
        ("low", c_float),
        ("high", c_float),
        ("reserved", c_int32),
    ]


class CostDef(Record):
    """frozen layout: a cost column

    name: unique: "touch"
    help: one line
    limit: default limit on the sum over an episode; < 0: none
    """

    name: str
    help: str
    limit: float


class rdm_cost_def(Structure):
    """frozen layout: a cost column

    name: unique: "touch"
    help: one line
    limit: default limit on the sum over an episode; < 0: none
    """

    name: bytes | None
    help: bytes | None
    limit: float
    _fields_ = [
        ("name", c_char_p),
        ("help", c_char_p),
        ("limit", c_double),
    ]


class OptionDef(Record):
    """frozen layout: one row of an option table, as rdm_option_spec

    key: letters, digits, '_', '-', '.'
    help: one line, with the unit; unused for an option that every task has
    text: default of a text option, or of a number whose default is a range; else NULL
    choices: text: the allowed words "a|b|c", NULL: any text; number, integer: "a..b" where a range is allowed
        too; else NULL
    number: default of a number, integer or flag; for a range, its middle
    low: inclusive bounds
    high: inclusive bounds
    kind: OptionKind.NUMBER, OptionKind.INTEGER, OptionKind.FLAG, OptionKind.TEXT
    live: unused
    """

    key: str
    help: str
    text: str | None
    choices: str | None
    number: float
    low: float
    high: float
    kind: int
    live: int


class rdm_option_def(Structure):
    """frozen layout: one row of an option table, as rdm_option_spec

    key: letters, digits, '_', '-', '.'
    help: one line, with the unit; unused for an option that every task has
    text: default of a text option, or of a number whose default is a range; else NULL
    choices: text: the allowed words "a|b|c", NULL: any text; number, integer: "a..b" where a range is allowed
        too; else NULL
    number: default of a number, integer or flag; for a range, its middle
    low: inclusive bounds
    high: inclusive bounds
    kind: RDM_KIND_NUMBER, RDM_KIND_INTEGER, RDM_KIND_FLAG, RDM_KIND_TEXT
    live: unused
    """

    key: bytes | None
    help: bytes | None
    text: bytes | None
    choices: bytes | None
    number: float
    low: float
    high: float
    kind: int
    live: int
    _fields_ = [
        ("key", c_char_p),
        ("help", c_char_p),
        ("text", c_char_p),
        ("choices", c_char_p),
        ("number", c_double),
        ("low", c_double),
        ("high", c_double),
        ("kind", c_int32),
        ("live", c_int32),
    ]


class CameraDef(Record):
    """frozen layout: a pinhole camera, as rdm_camera_info

    name: unique: "front"
    eye: m, in the frame that mount names
    target: m, likewise; the optical axis runs from eye to target
    fov_y: vertical field of view, rad, 0.01 to 3
    mount: 0: the world's frame; k > 0: of link k - 1; -k: of base k - 1
    up: likewise: what points up in the picture; all 0: z
    cx: where the optical axis meets the picture: to the right of its centre, as a share of its width, within
        +-10
    cy: likewise: below its centre, as a share of its height
    """

    name: str
    eye: tuple[float, ...]
    target: tuple[float, ...]
    fov_y: float
    mount: int
    up: tuple[float, ...]
    cx: float
    cy: float


class rdm_camera_def(Structure):
    """frozen layout: a pinhole camera, as rdm_camera_info

    name: unique: "front"
    eye: m, in the frame that mount names
    target: m, likewise; the optical axis runs from eye to target
    fov_y: vertical field of view, rad, 0.01 to 3
    mount: 0: the world's frame; k > 0: of link k - 1; -k: of base k - 1
    up: likewise: what points up in the picture; all 0: z
    cx: where the optical axis meets the picture: to the right of its centre, as a share of its width, within
        +-10
    cy: likewise: below its centre, as a share of its height
    reserved: 0
    """

    name: bytes | None
    eye: Any
    target: Any
    fov_y: float
    mount: int
    up: Any
    cx: float
    cy: float
    reserved: int
    _fields_ = [
        ("name", c_char_p),
        ("eye", c_float * 3),
        ("target", c_float * 3),
        ("fov_y", c_float),
        ("mount", c_int32),
        ("up", c_float * 3),
        ("cx", c_float),
        ("cy", c_float),
        ("reserved", c_int32),
    ]


class rdm_task_def(Structure):
    """a whole task; all but `user` is copied by rdm_task_create

    struct_size: bytes, set by rdm_task_def_init
    max_steps: control steps of an episode: default of the option max_steps, 1 to 100000; default 100
    name: letters, digits, '_', '-', '.'; at most 40
    summary: one line; NULL: none
    fields: [num_fields] of an observation, in order
    costs: [num_costs] column 0 is the task's; learners keep limits
    options: [num_options] rows, and defaults of its own for those that every task has
    cameras: [num_cameras] NULL with num_cameras 0: one called "front", which looks at the origin
    defaults: [num_defaults] of agent options; NULL with num_defaults 0
    num_fields: 1 or more
    num_costs: 1 to RDM_MAX_COSTS
    num_options: count
    num_cameras: count
    num_defaults: count
    action_dim: 1 to 1024
    hold: [action_dim] the action that keeps robots still; NULL: 0
    mean: [action_dim] mean action of a new policy; NULL: 0
    action_order: what the entries are, for the layout hash; NULL: "action"
    obs_limit: every observation entry is clipped to +- this; 0: no limit
    state_bytes: size of a world's own state, up to 2^20
    instance_bytes: size of what build leaves for the other functions, up to 2^24
    user: passed to all; may be NULL
    build: makes the scene, and the constants of this pool. Required
    reset: starts an episode; the world is as it was built. Required
    control: before a step: from the clipped action to targets and pushes. Required
    judge: after a step, `step` counts from 1: reward, costs and the end. Required
    observe: writes all entries of the observation, after reset and after judge. Required
    check_state: returns FORMAT for a saved state that no world can have: indices out of range, numbers that are
        not finite. NULL: all are accepted
    release: called once, after the task and its last pool were destroyed. NULL: none
    reset_many: For many worlds at once, instead of the functions above; NULL: none. Where one is given, the
        function for one world may be NULL. A pool calls them on the thread that called it, for up to 256 worlds
        together, between two steps of its engine, so that a runtime is entered once a step and not once a
        world. A row must depend on its own world alone, which rdm_task_check tests. What they return is the
        result of all rows
    control_many: as reset_many, instead of control
    judge_many: as reset_many, instead of judge
    observe_many: as reset_many, instead of observe
    """

    struct_size: int
    max_steps: int
    name: bytes | None
    summary: bytes | None
    fields: Any
    costs: Any
    options: Any
    cameras: Any
    defaults: Any
    num_fields: int
    num_costs: int
    num_options: int
    num_cameras: int
    num_defaults: int
    action_dim: int
    hold: int | None
    mean: int | None
    action_order: bytes | None
    obs_limit: float
    state_bytes: int
    instance_bytes: int
    user: int | None
    build: Any
    reset: Any
    control: Any
    judge: Any
    observe: Any
    check_state: Any
    release: Any
    reset_many: Any
    control_many: Any
    judge_many: Any
    observe_many: Any
    _fields_ = [
        ("struct_size", c_uint32),
        ("max_steps", c_int32),
        ("name", c_char_p),
        ("summary", c_char_p),
        ("fields", POINTER(rdm_field_def)),
        ("costs", POINTER(rdm_cost_def)),
        ("options", POINTER(rdm_option_def)),
        ("cameras", POINTER(rdm_camera_def)),
        ("defaults", POINTER(rdm_option)),
        ("num_fields", c_int32),
        ("num_costs", c_int32),
        ("num_options", c_int32),
        ("num_cameras", c_int32),
        ("num_defaults", c_int32),
        ("action_dim", c_int32),
        ("hold", c_void_p),
        ("mean", c_void_p),
        ("action_order", c_char_p),
        ("obs_limit", c_double),
        ("state_bytes", c_uint64),
        ("instance_bytes", c_uint64),
        ("user", c_void_p),
        ("build", CFUNCTYPE(c_int32, c_void_p, c_void_p, c_void_p)),
        ("reset", CFUNCTYPE(c_int32, c_void_p, c_void_p, c_void_p, c_void_p, POINTER(rdm_random))),
        ("control", CFUNCTYPE(c_int32, c_void_p, c_void_p, c_void_p, c_void_p, c_void_p)),
        ("judge", CFUNCTYPE(c_int32, c_void_p, c_void_p, c_void_p, c_void_p, c_int32, POINTER(rdm_verdict))),
        ("observe", CFUNCTYPE(c_int32, c_void_p, c_void_p, c_void_p, c_void_p, c_void_p)),
        ("check_state", CFUNCTYPE(c_int32, c_void_p, c_void_p, c_void_p)),
        ("release", CFUNCTYPE(None, c_void_p)),
        ("reset_many", CFUNCTYPE(c_int32, c_void_p, c_void_p, POINTER(rdm_task_rows))),
        ("control_many", CFUNCTYPE(c_int32, c_void_p, c_void_p, POINTER(rdm_task_rows))),
        ("judge_many", CFUNCTYPE(c_int32, c_void_p, c_void_p, POINTER(rdm_task_rows))),
        ("observe_many", CFUNCTYPE(c_int32, c_void_p, c_void_p, POINTER(rdm_task_rows))),
    ]


STRUCTS: dict[str, type[Structure]] = {
    "rdm_build": rdm_build,
    "rdm_host": rdm_host,
    "rdm_option": rdm_option,
    "rdm_option_spec": rdm_option_spec,
    "rdm_pose": rdm_pose,
    "rdm_field": rdm_field,
    "rdm_field_info": rdm_field_info,
    "rdm_tensor": rdm_tensor,
    "rdm_spec": rdm_spec,
    "rdm_policy_info": rdm_policy_info,
    "rdm_task": rdm_task,
    "rdm_cost_info": rdm_cost_info,
    "rdm_camera_info": rdm_camera_info,
    "rdm_robot": rdm_robot,
    "rdm_joint_info": rdm_joint_info,
    "rdm_object_info": rdm_object_info,
    "rdm_pool_config": rdm_pool_config,
    "rdm_buffers": rdm_buffers,
    "rdm_shape_info": rdm_shape_info,
    "rdm_contact": rdm_contact,
    "rdm_pool_stats": rdm_pool_stats,
    "rdm_ray_hit": rdm_ray_hit,
    "rdm_algo": rdm_algo,
    "rdm_agent_config": rdm_agent_config,
    "rdm_transition": rdm_transition,
    "rdm_epoch": rdm_epoch,
    "rdm_sensors": rdm_sensors,
    "rdm_picture": rdm_picture,
    "rdm_points": rdm_points,
    "rdm_pretrain_config": rdm_pretrain_config,
    "rdm_pretrain_report": rdm_pretrain_report,
    "rdm_map_config": rdm_map_config,
    "rdm_map_info": rdm_map_info,
    "rdm_voxel": rdm_voxel,
    "rdm_actor_config": rdm_actor_config,
    "rdm_planner_config": rdm_planner_config,
    "rdm_planner_spec": rdm_planner_spec,
    "rdm_plan_info": rdm_plan_info,
    "rdm_guard": rdm_guard,
    "rdm_shield_config": rdm_shield_config,
    "rdm_shield_row": rdm_shield_row,
    "rdm_shield_stats": rdm_shield_stats,
    "rdm_recording_config": rdm_recording_config,
    "rdm_recording_info": rdm_recording_info,
    "rdm_recording_rows": rdm_recording_rows,
    "rdm_clone_config": rdm_clone_config,
    "rdm_clone_report": rdm_clone_report,
    "rdm_learn_report": rdm_learn_report,
    "rdm_ranks": rdm_ranks,
    "rdm_group": rdm_group,
    "rdm_robot_link": rdm_robot_link,
    "rdm_robot_shape": rdm_robot_shape,
    "rdm_robot_pair": rdm_robot_pair,
    "rdm_robot_coupling": rdm_robot_coupling,
    "rdm_robot_curve": rdm_robot_curve,
    "rdm_robot_finger": rdm_robot_finger,
    "rdm_robot_def": rdm_robot_def,
    "rdm_shape_def": rdm_shape_def,
    "rdm_object_def": rdm_object_def,
    "rdm_body_def": rdm_body_def,
    "rdm_scene_robot": rdm_scene_robot,
    "rdm_contact_law": rdm_contact_law,
    "rdm_joints": rdm_joints,
    "rdm_motion": rdm_motion,
    "rdm_factor": rdm_factor,
    "rdm_random": rdm_random,
    "rdm_verdict": rdm_verdict,
    "rdm_task_rows": rdm_task_rows,
    "rdm_field_def": rdm_field_def,
    "rdm_cost_def": rdm_cost_def,
    "rdm_option_def": rdm_option_def,
    "rdm_camera_def": rdm_camera_def,
    "rdm_task_def": rdm_task_def,
}

# The rows that fields of structs point at.
ROWS: dict[str, dict[str, Rows]] = {
    "rdm_buffers": {
        "obs": Rows("float32", ("num_envs", "obs_dim")),
        "final_obs": Rows("float32", ("num_envs", "obs_dim")),
        "action": Rows("float32", ("num_envs", "action_dim")),
        "reward": Rows("float32", ("num_envs",)),
        "cost": Rows("float32", ("num_envs", "cost_dim")),
        "cost_raw": Rows("float32", ("num_envs", "cost_dim")),
        "episode_return": Rows("float32", ("num_envs",)),
        "episode_cost": Rows("float32", ("num_envs", "cost_dim")),
        "episode_step": Rows("int32", ("num_envs",)),
        "status": Rows("uint32", ("num_envs",)),
        "terminated": Rows("uint8", ("num_envs",)),
        "truncated": Rows("uint8", ("num_envs",)),
        "success": Rows("uint8", ("num_envs",)),
        "episode_status": Rows("uint32", ("num_envs",)),
    },
    "rdm_agent_config": {
        "initial_mean": Rows("float32", ("action_dim",)),
        "cost_limits": Rows("float64", ("cost_dim",)),
    },
    "rdm_transition": {
        "reward": Rows("float32", ("num_envs",)),
        "cost": Rows("float32", ("num_envs", "cost_dim")),
        "terminated": Rows("uint8", ("num_envs",)),
        "truncated": Rows("uint8", ("num_envs",)),
        "final_obs": Rows("float32", ("num_envs", "obs_dim")),
        "valid": Rows("uint8", ("num_envs",)),
        "success": Rows("uint8", ("num_envs",)),
        "steps": Rows("int32", ("num_envs",)),
        "status": Rows("uint32", ("num_envs",)),
        "limit": Rows("float32", ("num_envs",)),
    },
    "rdm_sensors": {
        "rgb": Rows("uint8", ("num_envs", "num_cameras", "height", "width", "3")),
        "depth": Rows("float32", ("num_envs", "num_cameras", "height", "width")),
        "segmentation": Rows("int32", ("num_envs", "num_cameras", "height", "width")),
        "points": Rows("float32", ("num_envs", "num_points", "3")),
        "point_shape": Rows("int32", ("num_envs", "num_points")),
        "point_count": Rows("int32", ("num_envs",)),
        "voxels": Rows("int8", ("num_envs", "num_voxels", "num_voxels", "num_voxels")),
        "point_class": Rows("uint8", ("num_envs", "num_points")),
        "point_color": Rows("uint8", ("num_envs", "num_points", "3")),
    },
    "rdm_picture": {
        "rgb": Rows("uint8", ("height", "width", "3")),
        "depth": Rows("float32", ("height", "width")),
        "segmentation": Rows("int32", ("height", "width")),
    },
    "rdm_points": {
        "points": Rows("float32", ("rows", "num_points", "3")),
        "point_class": Rows("uint8", ("rows", "num_points")),
        "point_color": Rows("uint8", ("rows", "num_points", "3")),
    },
    "rdm_actor_config": {
        "center": Rows("float32", ("action_dim",)),
    },
    "rdm_planner_config": {
        "noise": Rows("float32", ("action_dim",)),
        "cost_limits": Rows("float64", ("cost_dim",)),
    },
    "rdm_shield_config": {
        "budgets": Rows("float64", ("cost_dim",)),
    },
    "rdm_recording_rows": {
        "obs": Rows("float32", ("rows", "obs_dim")),
        "action": Rows("float32", ("rows", "action_dim")),
        "label": Rows("float32", ("rows", "action_dim")),
        "reward": Rows("float32", ("rows",)),
        "cost": Rows("float32", ("rows", "cost_dim")),
        "terminated": Rows("uint8", ("rows",)),
        "truncated": Rows("uint8", ("rows",)),
        "success": Rows("uint8", ("rows",)),
        "episode": Rows("int64", ("rows",)),
        "state_row": Rows("int64", ("num_states",)),
        "state": Rows("uint8", ("num_states", "state_bytes")),
        "points": Rows("int16", ("rows", "num_points", "3")),
        "point_class": Rows("uint8", ("rows", "num_points")),
        "point_color": Rows("uint8", ("rows", "num_points", "3")),
    },
    "rdm_clone_config": {
        "train_loss": Rows("float64", ("capacity",)),
        "validation_loss": Rows("float64", ("capacity",)),
    },
    "rdm_robot_def": {
        "commands": Rows("int32", ("num_commands",)),
        "home": Rows("float64", ("num_links",)),
        "folded": Rows("float64", ("num_links",)),
        "closed": Rows("float32", ("num_commands",)),
    },
    "rdm_shape_def": {
        "points": Rows("float64", ("num_points", "3")),
    },
    "rdm_joints": {
        "q": Rows("float64", ("count",)),
        "qd": Rows("float64", ("count",)),
        "target": Rows("float64", ("count",)),
        "torque": Rows("float64", ("count",)),
    },
    "rdm_task_rows": {
        "actions": Rows("float32", ("count", "action_dim")),
        "steps": Rows("int32", ("count",)),
        "obs": Rows("float32", ("count", "obs_dim")),
    },
    "rdm_task_def": {
        "hold": Rows("float32", ("action_dim",)),
        "mean": Rows("float32", ("action_dim",)),
    },
}

FUNCTIONS: dict[str, Function] = {
    "rdm_result_string": Function(
        c_char_p, {"r": c_int32},
        {}, False,
        """static, never NULL, also for unknown
        values
        """),
    "rdm_last_error": Function(
        c_char_p, {},
        {}, False,
        """The text of the last failure on this OS thread, one line. It is valid until the thread's next
        failing rdm call; a call that succeeds does not clear it. Runtimes that move calls between
        threads (Go, asynchronous FFI) should read config.error, rdm_pool_error and the like instead.
        """),
    "rdm_version": Function(
        c_uint32, {},
        {}, False,
        """RDM_VERSION of the library at run time"""),
    "rdm_features": Function(
        c_uint32, {},
        {}, False,
        """RDM_FEATURE_*: what this build has"""),
    "rdm_check_abi": Function(
        c_int32, {"abi": c_uint32, "version": c_uint32},
        {}, False,
        """VERSION_MISMATCH unless the library has this ABI and at least this version."""),
    "rdm_check_experimental": Function(
        c_int32, {"version": c_uint32},
        {}, False,
        """For programs that call experimental functions: VERSION_MISMATCH unless the library has the major
        and minor version of `version`, the RDM_VERSION of the program's header. On ELF systems the
        loader has already checked this by symbol versions; programs that look functions up by name at
        run time, or run where symbols have no versions, should call it.
        """),
    "rdm_build_info": Function(
        c_int32, {"io": POINTER(rdm_build)},
        {}, False,
        """fills io; strings are static"""),
    "rdm_init": Function(
        c_int32, {"host": POINTER(rdm_host)},
        {}, False,
        """Sets process-wide hooks for handles that are made later from configs whose host is NULL; host
        NULL: the defaults. The first call sets them. Later ones are counted and change nothing with
        NULL, and are STATE with hooks, until rdm_shutdown has undone all. Optional.
        """),
    "rdm_shutdown": Function(
        None, {},
        {}, False,
        """undoes one rdm_init; the last one restores the default hooks;
        handles stay valid
        """),
    "rdm_nearest_names": Function(
        c_int32, {"name": c_char_p, "names": c_char_p, "text": c_void_p, "capacity": c_size_t},
        {}, False,
        """Writes to text [capacity] the hint that texts of NOT_FOUND end with, for names of your own: ";
        nearest is gamma", "; nearest are a, b and c" for several that are equally near, or "" when
        `name` resembles none of `names`, which has one name a line; the first 500 count. Case is ignored
        and '-' equals '_'. The hint is cut at capacity (>= 1) bytes; 4 * RDM_TEXT_SIZE are always
        enough.
        """),
    "rdm_policy_read": Function(
        c_int32, {"out": POINTER(c_void_p), "bytes": c_void_p, "size": c_size_t},
        {}, False,
        """copies bytes [size]"""),
    "rdm_policy_read_file": Function(
        c_int32, {"out": POINTER(c_void_p), "path": c_char_p},
        {}, False,
        """NOT_FOUND, FORMAT ..."""),
    "rdm_policy_read_memory": Function(
        c_int32, {"bytes": c_void_p, "size": c_size_t, "memory": c_void_p},
        {}, False,
        """For programs without a heap: the bytes that rdm_policy_read_in needs for the file bytes [size].
        Errors are those of rdm_policy_read, except that of a network which does not reproduce the file's
        example.
        """),
    "rdm_policy_read_in": Function(
        c_int32, {"out": POINTER(c_void_p), "bytes": c_void_p, "size": c_size_t, "memory": c_void_p, "capacity": c_size_t},
        {}, False,
        """As rdm_policy_read of bytes [size], which are not needed afterwards, into memory [capacity] at
        any address, which the caller keeps until the policy is destroyed. Neither this call nor later
        ones on the policy use heap or hooks, except that rdm_policy_get_tensor and calls that fail may
        use the heap for a moment. RANGE where capacity is less than rdm_policy_read_memory says.
        """),
    "rdm_policy_destroy": Function(
        None, {"p": c_void_p},
        {}, False,
        """NULL is fine"""),
    "rdm_policy_get_info": Function(
        c_int32, {"p": c_void_p, "io": POINTER(rdm_policy_info)},
        {}, False,
        """fills io"""),
    "rdm_policy_scratch": Function(
        c_size_t, {"p": c_void_p, "rows": c_int32},
        {}, False,
        """bytes for act, at any
        address; 0: bad
        arguments
        """),
    "rdm_policy_act": Function(
        c_int32, {"p": c_void_p, "obs": c_void_p, "rows": c_int32, "noise": c_void_p, "action": c_void_p, "scratch": c_void_p, "scratch_bytes": c_size_t},
        {"obs": Rows("float32", ("rows", "obs_dim")), "noise": Rows("float32", ("rows", "action_dim")), "action": Rows("float32", ("rows", "action_dim"))}, False,
        """One decision, to be held for rdm_policy_info.action_repeat control steps (rdm_actor_act counts
        them): action [rows][action_dim] = clip(mean + std noise, -1, 1) for obs [rows][obs_dim]. noise
        [rows][action_dim] are standard normal numbers of the caller's; NULL: the mean. scratch
        [scratch_bytes]: rdm_policy_scratch bytes or more, of any alignment. No heap, no hidden state:
        any number of threads, each with its own scratch. ARGUMENT when obs or noise is not finite, or so
        large that the network overflows (action is written then, but meaningless). STATE for a policy
        that reads points or has a memory.
        """),
    "rdm_policy_sample": Function(
        c_int32, {"p": c_void_p, "obs": c_void_p, "rows": c_int32, "noise": c_void_p, "action": c_void_p, "mean": c_void_p, "scratch": c_void_p, "scratch_bytes": c_size_t},
        {"obs": Rows("float32", ("rows", "obs_dim")), "noise": Rows("float32", ("rows", "action_dim")), "action": Rows("float32", ("rows", "action_dim")), "mean": Rows("float32", ("rows", "action_dim"))}, False,
        """The same without clipping, as rdm_agent_act samples, so that an agent can learn from decisions
        that were sampled elsewhere (rdm_agent_put): action [rows][action_dim] = mean + std noise, and
        mean [rows][action_dim], for obs [rows][obs_dim] and noise [rows][action_dim], NULL: none. One of
        action and mean may be NULL. scratch [scratch_bytes] and errors as of rdm_policy_act.
        """),
    "rdm_policy_novelty": Function(
        c_int32, {"p": c_void_p, "obs": c_void_p, "rows": c_int32, "novelty": c_void_p},
        {"obs": Rows("float32", ("rows", "obs_dim")), "novelty": Rows("float32", ("rows",))}, False,
        """How far observations are from those of training: novelty [rows] of obs [rows][obs_dim]. About 1
        is the most that training saw, and 2 is far from it.

          z_j = (x_j - mean_j) / deviation_j, of the m entries x of a row that the policy reads
          novelty = max(sqrt(sum of z_j^2 / m) / a, max of |z_j| / b)

        mean and deviation are those of the normaliser, over all rows in training (with options
        obs_freeze and obs_count_max, over those that it counts); a deviation is at least 0.01. Over the
        last epochs, of 1000 rows or more (after cloning, over the recording), one row in a thousand had
        a root mean square of z above a, and one in a thousand a largest |z| above b. It does not notice
        values that are usual one by one and unusual together, such as a sensor that is stuck at a usual
        value, nor a value that is unusual for its entry but usual for another; it ignores clouds.
        UNSUPPORTED, and rdm_policy_info.novelty 0, where the file lacks these statistics: a file of 0.1,
        or of an agent without normalize_obs, or of one that has not learned from 1000 rows since its
        statistics were given to it. ARGUMENT when obs is not finite. No heap; any number of threads.
        """),
    "rdm_policy_tensor_at": Function(
        c_int32, {"p": c_void_p, "i": c_int32, "out": POINTER(rdm_tensor)},
        {}, False,
        """Tensor i of the policy: "actor.0.weight" (rows outputs, cols inputs) and so on, "actor.log_std"
        or "actor.log_std_bounds", "normalizer.shift|scale|clip", "example.obs|action". RANGE ends the
        list. Inputs are whole rows of obs_dim; weights of entries that the policy does not read are 0.
        In a policy that reads points, "actor.0.weight" has further columns for the features, and there
        are "encoder.0.weight" and so on, "encoder.origin" and "encoder.range", in m,
        "encoder.activation" (0 tanh, 1 elu, 2 relu), "example.points", in m, and
        "example.point_class". In a policy with a GRU there are "memory.input.weight" and ".bias" and
        "memory.state.weight" and ".bias", rows of the gates r, z and n; the GRU stands before the last
        layer. In one with a history "actor.0.weight" has further columns, for its state, and there is
        "history.columns", which entries of a row it keeps of each decision. "action.squash" is there
        where actions are squashed: 1 tanh(mean + noise), 2 tanh(mean) + noise, then the clip.
        """),
    "rdm_policy_get_tensor": Function(
        c_int32, {"p": c_void_p, "name": c_char_p, "out": c_void_p, "count": c_size_t},
        {"out": Rows("float32", ("count",))}, False,
        """Copies the named tensor to out [count]; count must be rows * cols. NOT_FOUND, RANGE."""),
    "rdm_policy_field_at": Function(
        c_int32, {"p": c_void_p, "i": c_int32, "io": POINTER(rdm_field_info)},
        {}, False,
        """Field i of an observation; its strings live as long as the policy, its bounds are unknown. RANGE
        ends the list.
        """),
    "rdm_policy_check": Function(
        c_int32, {"p": c_void_p, "spec": POINTER(rdm_spec)},
        {}, False,
        """Whether the policy fits a pool of this spec: OK, or VERSION_MISMATCH with a text that says which
        member of the spec differs. Where the layout differs, the text names the first field that does,
        if the policy file lists its fields and a pool of the spec's layout exists.
        """),
    "rdm_policy_get_columns": Function(
        c_int32, {"p": c_void_p, "columns": c_void_p, "capacity": c_size_t, "count": c_void_p},
        {"columns": Rows("int32", ("capacity",))}, False,
        """Which entries of a row of obs_dim the policy reads (agent option actor_obs), ascending: writes up
        to capacity of them to columns [capacity]; *count is how many there are.
        """),
    "rdm_task_count": Function(
        c_int32, {},
        {}, False,
        """one more than the highest number of a task; 0 in a build
        without simulation
        """),
    "rdm_task_at": Function(
        c_int32, {"index": c_int32, "io": POINTER(rdm_task)},
        {}, False,
        """NOT_FOUND: destroyed; RANGE: no
        task had this number
        """),
    "rdm_task_find": Function(
        c_int32, {"name": c_char_p, "index": c_void_p},
        {}, False,
        """NOT_FOUND: the text offers the nearest"""),
    "rdm_task_field_at": Function(
        c_int32, {"task": c_int32, "i": c_int32, "io": POINTER(rdm_field_info)},
        {}, False,
        """default options; i < num_fields"""),
    "rdm_task_cost_at": Function(
        c_int32, {"task": c_int32, "i": c_int32, "io": POINTER(rdm_cost_info)},
        {}, False,
        """i < cost_dim"""),
    "rdm_task_option_at": Function(
        c_int32, {"task": c_int32, "i": c_int32, "io": POINTER(rdm_option_spec)},
        {}, False,
        """i < num_options"""),
    "rdm_task_camera_at": Function(
        c_int32, {"task": c_int32, "i": c_int32, "io": POINTER(rdm_camera_info)},
        {}, False,
        """i < num_cameras"""),
    "rdm_task_default_at": Function(
        c_int32, {"task": c_int32, "i": c_int32, "out": POINTER(rdm_option)},
        {}, False,
        """i < num_defaults"""),
    "rdm_robot_count": Function(
        c_int32, {},
        {}, False,
        """as rdm_task_count"""),
    "rdm_robot_at": Function(
        c_int32, {"index": c_int32, "io": POINTER(rdm_robot)},
        {}, False,
        """errors as rdm_task_at"""),
    "rdm_robot_find": Function(
        c_int32, {"name": c_char_p, "index": c_void_p},
        {}, False,
        """name or alias; NOT_FOUND:
        the text offers the
        nearest
        """),
    "rdm_robot_joint_at": Function(
        c_int32, {"robot": c_int32, "i": c_int32, "io": POINTER(rdm_joint_info)},
        {}, False,
        """i < num_joints; RANGE past the end"""),
    "rdm_object_count": Function(
        c_int32, {},
        {}, False,
        """as rdm_task_count"""),
    "rdm_object_info_at": Function(
        c_int32, {"index": c_int32, "io": POINTER(rdm_object_info)},
        {}, False,
        """errors as rdm_task_at"""),
    "rdm_object_find": Function(
        c_int32, {"name": c_char_p, "index": c_void_p},
        {}, False,
        """name or alias; NOT_FOUND:
        the text offers the
        nearest
        """),
    "rdm_pool_config_init": Function(
        c_int32, {"c": POINTER(rdm_pool_config), "size": c_size_t},
        {}, False,
        """Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
        version's.
        """),
    "rdm_pool_config_spec": Function(
        c_int32, {"c": POINTER(rdm_pool_config), "io": POINTER(rdm_spec)},
        {}, False,
        """The sizes that a pool of this config would have. Returns what rdm_pool_create would return,
        memory aside. Makes the task for a moment and no world; nothing is kept.
        """),
    "rdm_pool_config_memory": Function(
        c_int32, {"c": POINTER(rdm_pool_config), "ours": c_void_p, "engines": c_void_p},
        {}, False,
        """Bytes that creation takes: *ours in one block, exact; *engines by the physics engine from the C
        library, an estimate. Either may be NULL. No hook is called: the task is made to find out, in
        memory of the C library that is freed at the end.
        """),
    "rdm_pool_create": Function(
        c_int32, {"out": POINTER(c_void_p), "c": POINTER(rdm_pool_config)},
        {}, False,
        """Makes the worlds. They are not reset yet: call rdm_pool_reset before the first step. A host's
        alloc hook is called once, for one block that holds all of the pool; to know its size the task is
        made once before, as by rdm_pool_config_memory. Without the hook, each part comes from the C
        library.
        """),
    "rdm_pool_create_in": Function(
        c_int32, {"out": POINTER(c_void_p), "c": POINTER(rdm_pool_config), "memory": c_void_p, "bytes": c_size_t},
        {}, False,
        """The same in memory [bytes] at any address: at least *ours of rdm_pool_config_memory, else RANGE,
        and the text says how many are needed. The pool uses the memory until it is destroyed; the caller
        owns it throughout. Neither alloc hook nor C library are asked for memory, now or later, except
        by the physics engine, for threads by the system, and in clean_house by OctoMap for its map
        (0.9 MB); what rdm_pool_set_starts keeps must fit into what is left (MEMORY).
        """),
    "rdm_pool_destroy": Function(
        None, {"p": c_void_p},
        {}, False,
        """NULL is fine"""),
    "rdm_pool_error": Function(
        c_char_p, {"p": c_void_p},
        {}, False,
        """last failure on this handle; "" at
        first
        """),
    "rdm_pool_get_spec": Function(
        c_int32, {"p": c_void_p, "io": POINTER(rdm_spec)},
        {}, False,
        """as rdm_pool_config_spec, for a pool"""),
    "rdm_pool_field_at": Function(
        c_int32, {"p": c_void_p, "i": c_int32, "io": POINTER(rdm_field_info)},
        {}, False,
        """i < num_fields"""),
    "rdm_pool_get_initial_mean": Function(
        c_int32, {"p": c_void_p, "action": c_void_p},
        {"action": Rows("float32", ("action_dim",))}, False,
        """The mean action [action_dim] that a new policy starts from: the task's start pose, which usually
        differs from the action of RDM_BASELINE_HOLD.
        """),
    "rdm_pool_setting_at": Function(
        c_int32, {"p": c_void_p, "i": c_int32, "key": POINTER(c_char_p), "text": c_void_p},
        {}, False,
        """The value of option i of this pool: its key, and the value as text [RDM_TEXT_SIZE], which reads
        back exactly. RANGE for a longer text, with *key set: rdm_pool_get_settings has it. The rows are
        those of rdm_task_option_at, but for joints and links, which are those of the pool's robots. The
        keys with a FIELD that were set follow, in order, then RANGE.
        """),
    "rdm_pool_get_settings": Function(
        c_int32, {"p": c_void_p, "text": c_void_p, "capacity": c_size_t, "size": c_void_p},
        {}, False,
        """All options as text [capacity] of lines key=value, except those that option level draws and those
        of joints and links that were not set; given as settings they make the same pool again.
        """),
    "rdm_pool_get_buffers": Function(
        c_int32, {"p": c_void_p, "io": POINTER(rdm_buffers)},
        {}, False,
        """borrowed pointers"""),
    "rdm_pool_set_buffers": Function(
        c_int32, {"p": c_void_p, "b": POINTER(rdm_buffers)},
        {}, False,
        """Replaces the pool's arrays by those of b that are not NULL (sizes as above, at least 4-byte
        aligned); they must live until the pool is destroyed or they are replaced again. Present contents
        are copied into them.
        """),
    "rdm_pool_reset": Function(
        c_int32, {"p": c_void_p, "seeds": c_void_p, "mask": c_void_p},
        {"seeds": Rows("uint64", ("num_envs",)), "mask": Rows("uint8", ("num_envs",))}, False,
        """Starts new episodes where mask [num_envs] is not 0 (NULL: everywhere). seeds [num_envs] give
        these worlds new random streams, which depend on the seed alone and not on the world's number:
        seed s gives the episode of a pool of one world created with seed s. seeds NULL: the worlds
        continue their own streams, which after create are (config.seed, i). Costs are 0 afterwards. An
        entry of the first observation that is not finite is written as 0, and the world and its episode
        are flagged RDM_STATUS_DIVERGED. Where a host's own task fails, the error of the lowest such
        world is returned; all such worlds are flagged RDM_STATUS_TASK and count as never reset, the
        others have begun.
        """),
    "rdm_pool_step": Function(
        c_int32, {"p": c_void_p},
        {}, False,
        """One control step of every world: reads action, writes all other rows. STATE before the first
        reset, and with autoreset off while a world that ended was not reset. A world that diverges, gets
        an action that is not finite, or whose task of a host's own fails, is truncated and flagged, with
        reward and cost 0 in that step; the call still returns OK. With option action_repeat it makes
        that many control steps with the same action, or as many as the episode has left: reward and cost
        are sums over them, success is 1 if it was in any, status has the bits of all, the other rows are
        those after the last.
        """),
    "rdm_pool_step_masked": Function(
        c_int32, {"p": c_void_p, "mask": c_void_p},
        {"mask": Rows("uint8", ("num_envs",))}, False,
        """The same for worlds whose mask [num_envs] is not 0; rows of the others do not change."""),
    "rdm_pool_baseline": Function(
        c_int32, {"p": c_void_p, "kind": c_int32},
        {}, False,
        """Fills the action buffer: all 0 (the middle of each joint's range), the nominal start pose, or
        uniform in [-1, 1] from the stream (seed, world, policy).
        """),
    "rdm_pool_write_state": Function(
        c_int32, {"p": c_void_p, "env": c_int32, "bytes": c_void_p, "capacity": c_size_t, "size": c_void_p},
        {}, False,
        """to bytes [capacity];
        NULL asks for the
        size
        """),
    "rdm_pool_read_state": Function(
        c_int32, {"p": c_void_p, "env": c_int32, "bytes": c_void_p, "size": c_size_t},
        {}, False,
        """of bytes [size]"""),
    "rdm_pool_get_hash": Function(
        c_int32, {"p": c_void_p, "env": c_int32, "hash": c_void_p},
        {}, False,
        """of the state of world env; -1: of all"""),
    "rdm_pool_shape_at": Function(
        c_int32, {"p": c_void_p, "i": c_int32, "io": POINTER(rdm_shape_info)},
        {}, False,
        """i < num_shapes"""),
    "rdm_pool_get_poses": Function(
        c_int32, {"p": c_void_p, "env": c_int32, "poses": c_void_p},
        {"poses": Rows("float64", ("num_shapes", "7"))}, False,
        """Writes the poses of the shapes of world env to poses [num_shapes], in that world's frame."""),
    "rdm_pool_get_contacts": Function(
        c_int32, {"p": c_void_p, "env": c_int32, "out": POINTER(rdm_contact), "capacity": c_size_t, "count": c_void_p},
        {}, False,
        """Writes up to capacity contacts to out [capacity]; *count is how many there are. Contacts of
        sleeping bodies are those of the moment when they fell asleep.
        """),
    "rdm_pool_render": Function(
        c_int32, {"p": c_void_p, "env": c_int32, "camera": c_char_p, "w": c_int32, "h": c_int32, "rgb": c_void_p, "depth": c_void_p, "segmentation": c_void_p},
        {"rgb": Rows("uint8", ("h", "w", "3")), "depth": Rows("float32", ("h", "w")), "segmentation": Rows("int32", ("h", "w"))}, False,
        """A picture of world env by the task's camera of that name. rgb [h][w][3], depth [h][w] (m along
        the optical axis, 0: nothing hit), segmentation [h][w] (shape, -1: nothing); each may be NULL. 1
        <= w, h <= 8192. The colours are made for people; rdm_pool_draw in sense.h has a plainer look at
        half the price, as observations have it, and draws several worlds in one picture.
        """),
    "rdm_pool_get_stats": Function(
        c_int32, {"p": c_void_p, "io": POINTER(rdm_pool_stats)},
        {}, False,
        """fills io"""),
    "rdm_pool_copy": Function(
        c_int32, {"dst": c_void_p, "dst_env": c_int32, "src": c_void_p, "src_env": c_int32},
        {}, False,
        """Makes world dst_env of dst (-1: every world) a copy of world src_env of src, at the price of
        copying memory: it continues with the same bytes as after write_state and read_state, and its
        rows are copied too, except action and those of rdm_sensors. Both pools must have the same task
        and options; sizes, threads and seeds may differ, and src may be dst. ARGUMENT for pools that
        differ, RANGE for worlds that do not exist; nothing changes then. No heap.
        """),
    "rdm_pool_joint_at": Function(
        c_int32, {"p": c_void_p, "i": c_int32, "io": POINTER(rdm_joint_info)},
        {}, False,
        """RANGE past the end"""),
    "rdm_pool_get_joints": Function(
        c_int32, {"p": c_void_p, "env": c_int32, "q": c_void_p, "qd": c_void_p, "count": c_size_t},
        {"q": Rows("float64", ("count",)), "qd": Rows("float64", ("count",))}, False,
        """Positions q [count] and velocities qd [count] of the joints of world env (rad, rad/s; m, m/s), in
        the order of rdm_pool_joint_at; count: num_joints. Either array may be NULL.
        """),
    "rdm_pool_set_joints": Function(
        c_int32, {"p": c_void_p, "env": c_int32, "q": c_void_p, "qd": c_void_p, "count": c_size_t},
        {"q": Rows("float64", ("count",)), "qd": Rows("float64", ("count",))}, False,
        """Sets positions q [count], and the targets of the drives with them, and velocities qd [count];
        what is NULL stays. RANGE names a joint that is further beyond its range than its ends yield
        (option limit_margin; 10 where ends are soft), or as fast as 1e6; ARGUMENT one that is not
        finite. STATE where no episode runs. Nothing changes then. A coupled joint may be set off its
        coupling; its drive pulls it back. NaN for one means the position, or velocity, that follows from
        the joint that it is coupled to. Bases, bodies and what the task remembers of commands stay.
        Numbers are rounded to float where the engine keeps floats. Like read_state, it rewrites obs and
        what rdm_sensors shows, and clears the other rows. Where a host's own task fails to observe, its
        error is returned; the joints are set then, and obs is as before.
        """),
    "rdm_pool_raycast": Function(
        c_int32, {"p": c_void_p, "env": c_int32, "origin": c_void_p, "direction": c_void_p, "range": c_double, "io": POINTER(rdm_ray_hit)},
        {"origin": Rows("float64", ("3",)), "direction": Rows("float64", ("3",))}, False,
        """Finds the nearest shape of world env that the ray from origin [3] (m, world axes) along direction
        [3] (any length above 0) enters within `range` m (above 0; may be INFINITY). It hits the shapes
        that pictures show, except those that contain the origin.
        """),
    "rdm_pool_push": Function(
        c_int32, {"p": c_void_p, "env": c_int32, "shape": c_int32, "force": c_void_p},
        {"force": Rows("float32", ("3",))}, False,
        """Pushes the body or link that has this shape during the next step: force [3] (N, world axes) at
        its centre of mass.
        """),
    "rdm_pool_world_error": Function(
        c_char_p, {"p": c_void_p, "env": c_int32},
        {}, False,
        """The text of the last failure in world env: "world 3: task press: judge: sensor lost", at most 255
        bytes; "" at first, and always for the library's own tasks. It is kept until the world's next
        failure and is not part of a saved state.
        """),
    "rdm_algo_count": Function(
        c_int32, {},
        {}, False,
        """number of algorithms; 0 in a build without learning"""),
    "rdm_algo_at": Function(
        c_int32, {"index": c_int32, "io": POINTER(rdm_algo)},
        {}, False,
        """RANGE past the end"""),
    "rdm_algo_find": Function(
        c_int32, {"name": c_char_p, "index": c_void_p},
        {}, False,
        """NOT_FOUND: the text offers the nearest"""),
    "rdm_algo_option_at": Function(
        c_int32, {"algo": c_int32, "i": c_int32, "io": POINTER(rdm_option_spec)},
        {}, False,
        """i < num_options"""),
    "rdm_agent_config_init": Function(
        c_int32, {"c": POINTER(rdm_agent_config), "size": c_size_t},
        {}, False,
        """Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
        version's.
        """),
    "rdm_agent_config_for_pool": Function(
        c_int32, {"c": POINTER(rdm_agent_config), "p": c_void_p},
        {}, False,
        """Sets dims, num_envs, task, layout_hash, control_dt, max_steps, defaults, initial_mean,
        cost_limits and fields from a pool. Pointers are borrowed from the pool.
        """),
    "rdm_agent_config_memory": Function(
        c_int32, {"c": POINTER(rdm_agent_config), "bytes": c_void_p},
        {}, False,
        """Bytes that the agent holds of the alloc hook's memory, exact; creation never holds more. The hook
        is called here too, for less, and gets all of it back.
        """),
    "rdm_agent_create": Function(
        c_int32, {"out": POINTER(c_void_p), "c": POINTER(rdm_agent_config)},
        {}, False,
        """Makes the agent; the config's arrays are copied."""),
    "rdm_agent_destroy": Function(
        None, {"a": c_void_p},
        {}, False,
        """NULL is fine"""),
    "rdm_agent_error": Function(
        c_char_p, {"a": c_void_p},
        {}, False,
        """last failure on this handle; "" at
        first
        """),
    "rdm_agent_act": Function(
        c_int32, {"a": c_void_p, "obs": c_void_p, "mode": c_int32, "action": c_void_p},
        {"obs": Rows("float32", ("num_envs", "obs_dim")), "action": Rows("float32", ("num_envs", "action_dim"))}, False,
        """Writes to action [num_envs][action_dim] a sample of the policy for obs [num_envs][obs_dim], which
        is remembered, so that rdm_agent_record must follow; or with RDM_ACT_MEAN its mean, of which
        nothing is remembered. One call is one decision: hold the action for as many control steps as
        option action_repeat says. Samples are not clipped.
        """),
    "rdm_agent_record": Function(
        c_int32, {"a": c_void_p, "t": POINTER(rdm_transition)},
        {}, False,
        """Records what followed the last sampled act. STATE without such an act, or when the horizon is
        full. ARGUMENT for a flag that is neither 0 nor 1, or a cost that is not finite or below 0, in
        any row, and for a reward or final_obs that is not finite in a valid one. A row with valid 0 is
        not learned from and its reward does not count; its cost counts, and an end in it ends the
        episode. Its steps count too, except in a row that neither ends an episode nor follows another
        row of one: next-step autoreset returns such a row for the step that only resets. An episode that
        still runs after max_steps control steps is counted as ended there (RDM_EPOCH_CUT): its sums are
        closed and begin anew. Learning treats that as a truncation, which the value of the next
        observation follows. Option episode_steps sets that length; option cost_limit_per_step limits the
        cost per control step instead, which needs no ends of episodes.
        """),
    "rdm_agent_put": Function(
        c_int32, {"a": c_void_p, "obs": c_void_p, "action": c_void_p, "t": POINTER(rdm_transition)},
        {"obs": Rows("float32", ("num_envs", "obs_dim")), "action": Rows("float32", ("num_envs", "action_dim"))}, False,
        """Records a decision that was taken elsewhere, by a robot or in another process: obs
        [num_envs][obs_dim], action [num_envs][action_dim] as the policy of this epoch sampled it, not
        clipped (rdm_policy_sample), and what followed. It replaces an rdm_agent_act with RDM_ACT_SAMPLE
        and its rdm_agent_record; the two ways may be mixed. Log-probabilities and values are computed
        here, so an agent of the same config and seed learns the same as one that acted, except that its
        streams of noise do not advance. The rows of one environment are one path, in their order; with
        option noise_correlation its noise is taken to continue from decision to decision. With option
        normalize_obs each row updates the statistics, as in rdm_agent_act, while a policy file that
        samples elsewhere stays as it is: obs_freeze stops the updates.
        STATE as for rdm_agent_act, and for a generation that is not the agent's: such data are stale.
        RANGE for an action beyond +-1e5, ARGUMENT as for rdm_agent_record; nothing changes then.
        UNSUPPORTED for an agent with option encoder, and for a generation with option average: a policy
        file then holds the average, which is not the network that must sample.
        """),
    "rdm_agent_update": Function(
        c_int32, {"a": c_void_p, "last_obs": c_void_p, "io": POINTER(rdm_epoch)},
        {"last_obs": Rows("float32", ("num_envs", "obs_dim"))}, False,
        """Learns from a full horizon; last_obs [num_envs][obs_dim] is the observation after the last
        record. io may be NULL. CANCELLED after rdm_agent_cancel: the horizon is dropped, full or not,
        and the policy is as before. STATE when the horizon is not full.
        """),
    "rdm_agent_update_begin": Function(
        c_int32, {"a": c_void_p, "last_obs": c_void_p},
        {"last_obs": Rows("float32", ("num_envs", "obs_dim"))}, False,
        """The same in slices, for a control loop that must not wait, such as that of a robot at 1 kHz.
          rdm_agent_update_begin(agent, obs);
          for (int32_t done = 0; !done;) {
            wait_for_tick(obs);
            rdm_agent_act(agent, obs, RDM_ACT_MEAN, action);
            rdm_agent_update_slice(agent, 1, &done, &e);
          }
        rdm_agent_update_begin takes last_obs [num_envs][obs_dim], returns the errors that
        rdm_agent_update returns before it learns, and takes about as long as an rdm_agent_act. A slice
        does `units` (> 0) pieces of work; with the last piece *done becomes 1 and io (may be NULL) is
        filled. The pieces depend on the data alone, and any division into slices gives the bytes of one
        rdm_agent_update. The largest piece is one forward and backward pass of a network, or one
        Fisher-vector product of a trust region, over 256 rows on each thread, or over 64 where a
        minibatch has no more than 256; or a few plain sums over all decisions of the horizon, or over
        all parameters.
        Between two slices, RDM_ACT_MEAN and rdm_agent_write_policy use the policy from before the
        update. Calls that would change the agent, or read what is not fully learned, return STATE:
        sampled acts, record, put, rollouts, options, tensors, values, states, checkpoints. The update is
        dropped by rdm_agent_discard, by rdm_agent_cancel (the next slice returns CANCELLED) and by
        rdm_agent_read_state. The policy is then as it was before; critics, optimisers and multipliers
        keep what they have learned.
        """),
    "rdm_agent_update_slice": Function(
        c_int32, {"a": c_void_p, "units": c_int32, "done": c_void_p, "io": POINTER(rdm_epoch)},
        {}, False,
        """The same in slices, for a control loop that must not wait, such as that of a robot at 1 kHz.
          rdm_agent_update_begin(agent, obs);
          for (int32_t done = 0; !done;) {
            wait_for_tick(obs);
            rdm_agent_act(agent, obs, RDM_ACT_MEAN, action);
            rdm_agent_update_slice(agent, 1, &done, &e);
          }
        rdm_agent_update_begin takes last_obs [num_envs][obs_dim], returns the errors that
        rdm_agent_update returns before it learns, and takes about as long as an rdm_agent_act. A slice
        does `units` (> 0) pieces of work; with the last piece *done becomes 1 and io (may be NULL) is
        filled. The pieces depend on the data alone, and any division into slices gives the bytes of one
        rdm_agent_update. The largest piece is one forward and backward pass of a network, or one
        Fisher-vector product of a trust region, over 256 rows on each thread, or over 64 where a
        minibatch has no more than 256; or a few plain sums over all decisions of the horizon, or over
        all parameters.
        Between two slices, RDM_ACT_MEAN and rdm_agent_write_policy use the policy from before the
        update. Calls that would change the agent, or read what is not fully learned, return STATE:
        sampled acts, record, put, rollouts, options, tensors, values, states, checkpoints. The update is
        dropped by rdm_agent_discard, by rdm_agent_cancel (the next slice returns CANCELLED) and by
        rdm_agent_read_state. The policy is then as it was before; critics, optimisers and multipliers
        keep what they have learned.
        """),
    "rdm_agent_rollout": Function(
        c_int32, {"a": c_void_p, "p": c_void_p, "io": POINTER(rdm_epoch)},
        {}, False,
        """One epoch within the library: act, step (action_repeat control steps), record until the horizon
        is full, then update. The pool must have been reset and must not have autoreset off; dims and
        num_envs must agree. Where the pool has option action_repeat itself, the agent's action_repeat
        must be a multiple of the pool's, as it is in the defaults that rdm_agent_config_for_pool sets.
        With the agent's option cost_signal=raw the costs are sums over control steps of cost_raw where
        that is above 0. STATE for a pool that was not reset or has autoreset off, and inside a horizon;
        ARGUMENT where sizes or action_repeat differ; nothing changes then. io may be NULL.
        """),
    "rdm_agent_cancel": Function(
        None, {"a": c_void_p},
        {}, False,
        """Async-signal-safe, from any thread: the running rollout or update returns CANCELLED. A horizon
        that was begun by act and record is dropped when its update is called; between horizons, the next
        rollout, update or first act with RDM_ACT_SAMPLE returns CANCELLED, before anything is
        collected.
        """),
    "rdm_agent_discard": Function(
        c_int32, {"a": c_void_p},
        {}, False,
        """Drops a horizon that has begun, an update in slices and a pending cancel: from any state back to
        between epochs. The policy learns nothing from what is dropped. Running episodes continue, with
        what was recorded of them.
        """),
    "rdm_agent_set_option": Function(
        c_int32, {"a": c_void_p, "option": POINTER(rdm_option)},
        {}, False,
        """Changes a live option. NOT_FOUND, RANGE, or STATE when it is not live."""),
    "rdm_agent_setting_at": Function(
        c_int32, {"a": c_void_p, "i": c_int32, "key": POINTER(c_char_p), "text": c_void_p},
        {}, False,
        """The value of option i of the algorithm in this agent: its key (static), and the value as text
        [RDM_TEXT_SIZE], which reads back exactly. RANGE for a longer text: rdm_agent_get_settings has
        it.
        """),
    "rdm_agent_get_settings": Function(
        c_int32, {"a": c_void_p, "text": c_void_p, "capacity": c_size_t, "size": c_void_p},
        {}, False,
        """All options as text [capacity] of lines key=value: given as settings they make an agent of the
        same options.
        """),
    "rdm_agent_tensor_at": Function(
        c_int32, {"a": c_void_p, "i": c_int32, "out": POINTER(rdm_tensor)},
        {}, False,
        """RANGE ends the list"""),
    "rdm_agent_get_tensor": Function(
        c_int32, {"a": c_void_p, "name": c_char_p, "out": c_void_p, "count": c_size_t},
        {"out": Rows("float32", ("count",))}, False,
        """Copies the named tensor to out [count] or from values [count]; count must be rows * cols.
        NOT_FOUND, RANGE. Values of actor.log_std are clipped, at the next act, to what options std_min
        and std_max allow.
        """),
    "rdm_agent_set_tensor": Function(
        c_int32, {"a": c_void_p, "name": c_char_p, "values": c_void_p, "count": c_size_t},
        {"values": Rows("float32", ("count",))}, False,
        """Copies the named tensor to out [count] or from values [count]; count must be rows * cols.
        NOT_FOUND, RANGE. Values of actor.log_std are clipped, at the next act, to what options std_min
        and std_max allow.
        """),
    "rdm_agent_write_policy": Function(
        c_int32, {"a": c_void_p, "bytes": c_void_p, "capacity": c_size_t, "size": c_void_p},
        {}, False,
        """The frozen policy as the bytes [capacity] of a policy file; NULL asks for the size."""),
    "rdm_agent_write_policy_file": Function(
        c_int32, {"a": c_void_p, "path": c_char_p},
        {}, False,
        """replaced atomically"""),
    "rdm_policy_update_from": Function(
        c_int32, {"p": c_void_p, "a": c_void_p},
        {}, False,
        """Copies the agent's present network and statistics into a policy of the same sizes, without
        allocating: afterwards p is what rdm_agent_write_policy writes, but for the names of its fields.
        ARGUMENT where network, entries that are read, normaliser, layout_hash or action_repeat differ:
        the text says which, and p is as before. No other call may use p meanwhile, nor an actor or
        planner that has it: an rdm_policy_act returns STATE then.
        """),
    "rdm_agent_write_state": Function(
        c_int32, {"a": c_void_p, "bytes": c_void_p, "capacity": c_size_t, "size": c_void_p},
        {}, False,
        """to bytes [capacity]; NULL asks for the
        size
        """),
    "rdm_agent_read_state": Function(
        c_int32, {"a": c_void_p, "bytes": c_void_p, "size": c_size_t},
        {}, False,
        """of bytes [size]"""),
    "rdm_checkpoint_write": Function(
        c_int32, {"path": c_char_p, "a": c_void_p, "p": c_void_p, "note": c_void_p, "note_size": c_size_t},
        {}, False,
        """Writes agent, pool (may be NULL) and a note [note_size] of the host's own, of up to 2^29 bytes,
        to one file, which is replaced atomically.
        """),
    "rdm_checkpoint_read": Function(
        c_int32, {"path": c_char_p, "a": c_void_p, "p": c_void_p, "note": c_void_p, "capacity": c_size_t, "note_size": c_void_p},
        {}, False,
        """Reads it back; note [capacity] receives the note, up to that many bytes, and *note_size is its
        size; note may be NULL with capacity 0. With p NULL the file's pool, if any, is not read. FORMAT
        where p is given and the file has none. Nothing changes on failure.
        """),
    "rdm_pool_set_limit": Function(
        c_int32, {"p": c_void_p, "env": c_int32, "limit": c_double},
        {}, True,
        """Gives the episode that runs in world env, -1: in every world, another cost limit, between the
        ends of option limit_range. What is left of the budget changes by as much, what was spent stays
        spent, and obs shows both (fields budget.left, budget.limit); other rows stay. The next episode
        draws its limit, or has that of option `limit`. RANGE for a limit outside of limit_range, STATE
        where no episode runs, UNSUPPORTED without limit_range; nothing changes then. No heap.
        """),
    "rdm_pool_get_sensors": Function(
        c_int32, {"p": c_void_p, "io": POINTER(rdm_sensors)},
        {}, True,
        """fills io"""),
    "rdm_pool_camera_at": Function(
        c_int32, {"p": c_void_p, "i": c_int32, "io": POINTER(rdm_camera_info)},
        {}, True,
        """Camera i of those that this pool knows by name: the task's, then those on its robots
        ("right_palm" and "left_palm" of hands), then those for clouds. RANGE past the end.
        """),
    "rdm_pool_sensor_camera_at": Function(
        c_int32, {"p": c_void_p, "cloud": c_int32, "i": c_int32, "io": POINTER(rdm_camera_info)},
        {}, True,
        """Camera i of the pictures (cloud 0), or of those that points and voxels come from (cloud 1). RANGE
        past the end.
        """),
    "rdm_pool_get_hull": Function(
        c_int32, {"p": c_void_p, "i": c_int32, "points": c_void_p, "capacity": c_size_t, "count": c_void_p},
        {"points": Rows("float32", ("capacity", "3"))}, True,
        """Writes up to capacity corners of shape i, an RDM_SHAPE_HULL, to points [capacity][3], in its own
        frame, m; *count is how many there are.
        """),
    "rdm_pool_draw": Function(
        c_int32, {"p": c_void_p, "picture": POINTER(rdm_picture)},
        {}, True,
        """Draws worlds as rdm_pool_render does, which is this for one world and RDM_LOOK_FINE. Same state,
        same bytes. Depth and segmentation are those of the shapes that collide, whatever the look.
        Several worlds take memory for the time of the call. ARGUMENT without a camera, NOT_FOUND for one
        that the task does not have, RANGE for another member outside of what it may be.
        """),
    "rdm_sample_furthest": Function(
        c_int32, {"points": c_void_p, "count": c_size_t, "wanted": c_size_t, "start": c_int32, "chosen": c_void_p, "scratch": c_void_p, "scratch_bytes": c_size_t},
        {"points": Rows("float32", ("count", "3")), "chosen": Rows("int32", ("wanted",))}, True,
        """Farthest point sampling: chooses `wanted` of points [count][3], first number `start`, then always
        the one that is farthest from all chosen before, and writes their numbers to chosen [wanted].
        Exact. scratch [scratch_bytes]: rdm_sample_scratch bytes or more, of any alignment; no heap.
        """),
    "rdm_sample_scratch": Function(
        c_size_t, {"count": c_size_t},
        {}, True,
        """bytes, at any address; 0: count is outside
        [1, 2^22]
        """),
    "rdm_agent_act_points": Function(
        c_int32, {"a": c_void_p, "obs": c_void_p, "points": POINTER(rdm_points), "mode": c_int32, "action": c_void_p},
        {"obs": Rows("float32", ("num_envs", "obs_dim")), "action": Rows("float32", ("num_envs", "action_dim"))}, True,
        """As rdm_agent_act: action [num_envs][action_dim] for obs [num_envs][obs_dim] and as many clouds,
        of an agent with the option encoder; STATE without it. ARGUMENT for a point that is not finite,
        RANGE for another number of points or a class that does not exist; nothing is remembered then.
        """),
    "rdm_policy_act_points": Function(
        c_int32, {"p": c_void_p, "obs": c_void_p, "points": POINTER(rdm_points), "rows": c_int32, "noise": c_void_p, "action": c_void_p, "scratch": c_void_p, "scratch_bytes": c_size_t},
        {"obs": Rows("float32", ("rows", "obs_dim")), "noise": Rows("float32", ("rows", "action_dim")), "action": Rows("float32", ("rows", "action_dim"))}, True,
        """As rdm_policy_act, of obs [rows][obs_dim], noise [rows][action_dim] or NULL,
        action [rows][action_dim] and scratch [scratch_bytes], for a policy whose num_points is not 0;
        STATE for others, errors as above.
        """),
    "rdm_policy_act_points_state": Function(
        c_int32, {"p": c_void_p, "obs": c_void_p, "points": POINTER(rdm_points), "state": c_void_p, "rows": c_int32, "noise": c_void_p, "action": c_void_p, "scratch": c_void_p, "scratch_bytes": c_size_t},
        {"obs": Rows("float32", ("rows", "obs_dim")), "state": Rows("float32", ("rows", "state_dim")), "noise": Rows("float32", ("rows", "action_dim")), "action": Rows("float32", ("rows", "action_dim"))}, True,
        """As rdm_policy_act_points, of obs [rows][obs_dim], noise [rows][action_dim] or NULL,
        action [rows][action_dim] and scratch [scratch_bytes], for a policy that also has a memory
        (option history beside encoder): state [rows][state_dim] is that of rdm_policy_act_state in
        memory.h; NULL only where state_dim is 0.
        """),
    "rdm_pretrain_config_init": Function(
        c_int32, {"how": POINTER(rdm_pretrain_config), "size": c_size_t},
        {}, True,
        """defaults into the first `size` bytes"""),
    "rdm_agent_pretrain": Function(
        c_int32, {"a": c_void_p, "points": POINTER(rdm_points), "label": c_void_p, "rows": c_int32, "how": POINTER(rdm_pretrain_config), "io": POINTER(rdm_pretrain_report)},
        {"label": Rows("uint8", ("rows", "num_points"))}, True,
        """Trains the agent's encoder to classify the points of clouds [rows] by label [rows][num_points],
        each less than num_labels: a head that reads a point's last hidden layer and the cloud's features
        is added, and thrown away afterwards. Nothing else changes. Same seed, same bytes, for any number
        of threads. STATE inside a horizon or without an encoder; CANCELLED after rdm_agent_cancel: the
        encoder is as before. io may be NULL.
        """),
    "rdm_map_config_init": Function(
        c_int32, {"c": POINTER(rdm_map_config), "size": c_size_t},
        {}, True,
        """Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
        version's.
        """),
    "rdm_map_create": Function(
        c_int32, {"out": POINTER(c_void_p), "c": POINTER(rdm_map_config)},
        {}, True,
        """RANGE outside the bounds"""),
    "rdm_map_destroy": Function(
        None, {"m": c_void_p},
        {}, True,
        """NULL is fine"""),
    "rdm_map_error": Function(
        c_char_p, {"m": c_void_p},
        {}, True,
        """Last failure of a call that may change the map; "" at first. Failures of calls that only read,
        which many threads may make at a time, are in rdm_last_error().
        """),
    "rdm_map_get_info": Function(
        c_int32, {"m": c_void_p, "io": POINTER(rdm_map_info)},
        {}, True,
        """fills io"""),
    "rdm_map_clear": Function(
        c_int32, {"m": c_void_p},
        {}, True,
        """all is unknown again"""),
    "rdm_map_insert": Function(
        c_int32, {"m": c_void_p, "origin": c_void_p, "points": c_void_p, "count": c_size_t, "dropped": c_void_p},
        {"origin": Rows("float32", ("3",)), "points": Rows("float32", ("count", "3"))}, True,
        """Adds one scan: rays from origin [3] to points [count][3]. Each voxel changes once: its
        probability rises where a ray ends, else falls where rays pass. Points that are not finite are
        left out, and those nearer to the origin than a voxel's side: a depth of 0 says that nothing was
        seen. A map has 65536 voxels along each axis, with 0 in its middle: RANGE for an origin outside;
        points outside are left out, and their rays. A full map does not grow further: the call returns
        OK, *dropped (may be NULL) says how many voxels were left out, and voxels that exist are still
        updated.
        """),
    "rdm_map_scan": Function(
        c_int32, {"m": c_void_p, "p": c_void_p, "env": c_int32, "camera": c_char_p, "w": c_int32, "h": c_int32, "skip": c_void_p, "num_skip": c_size_t, "dropped": c_void_p},
        {"skip": Rows("int32", ("num_skip",))}, True,
        """Adds one scan by a camera of the pool's task: depths of w x h rays of world env. Rays that end on
        one of the num_skip shapes in skip [num_skip], or meet nothing, are left out. *dropped as
        above. RANGE for a shape, a world or w, h (1 to 8192) that does not exist.
        """),
    "rdm_map_get_probabilities": Function(
        c_int32, {"m": c_void_p, "points": c_void_p, "count": c_size_t, "probability": c_void_p},
        {"points": Rows("float32", ("count", "3")), "probability": Rows("float32", ("count",))}, True,
        """probability [count] that the voxel of each of points [count][3] is occupied; -1: unknown, also
        outside of the map. ARGUMENT for a point that is not finite; nothing is written then.
        """),
    "rdm_map_get_voxels": Function(
        c_int32, {"m": c_void_p, "low": c_void_p, "high": c_void_p, "out": POINTER(rdm_voxel), "capacity": c_size_t, "count": c_void_p},
        {"low": Rows("float32", ("3",)), "high": Rows("float32", ("3",))}, True,
        """Occupied voxels that overlap the box from low [3] to high [3]: writes up to capacity to out
        [capacity], *count is how many there are.
        """),
    "rdm_map_meets": Function(
        c_int32, {"m": c_void_p, "pose": c_void_p, "half": c_void_p, "meets": c_void_p},
        {"pose": Rows("float64", ("7",)), "half": Rows("float32", ("3",))}, True,
        """meets is 1 when an occupied voxel overlaps the box of half sizes half [3] at `pose`."""),
    "rdm_map_raycast": Function(
        c_int32, {"m": c_void_p, "origin": c_void_p, "direction": c_void_p, "range": c_float, "through_unknown": c_int32, "hit": c_void_p, "found": c_void_p},
        {"origin": Rows("float32", ("3",)), "direction": Rows("float32", ("3",)), "hit": Rows("float32", ("3",))}, True,
        """Where the ray from origin [3] along direction [3] enters the first occupied voxel within `range`
        m: *found is 1 and hit [3] is written. An unknown voxel ends the ray unless through_unknown is
        1.
        """),
    "rdm_map_get_distances": Function(
        c_int32, {"m": c_void_p, "points": c_void_p, "count": c_size_t, "most": c_float, "distance": c_void_p},
        {"points": Rows("float32", ("count", "3")), "distance": Rows("float32", ("count",))}, True,
        """distance [count] from each of points [count][3] to the nearest point of an occupied voxel, m;
        `most` when none is that near. ARGUMENT for a point that is not finite; nothing is written
        then.
        """),
    "rdm_map_get_grid": Function(
        c_int32, {"m": c_void_p, "pose": c_void_p, "n": c_void_p, "side": c_float, "out": c_void_p},
        {"pose": Rows("float64", ("7",)), "n": Rows("int32", ("3",)), "out": Rows("int8", ("n0", "n1", "n2"))}, True,
        """Samples the map at the centres of a grid around `pose`, of n [3] cells (1 to 1024 each) of `side`
        m, to out [n0][n1][n2], x outermost: 1 occupied, 0 free, -1 unknown.
        """),
    "rdm_map_write": Function(
        c_int32, {"m": c_void_p, "format": c_int32, "bytes": c_void_p, "capacity": c_size_t, "size": c_void_p},
        {}, True,
        """The map as the bytes [capacity] of a file; NULL asks for the size."""),
    "rdm_map_write_file": Function(
        c_int32, {"m": c_void_p, "path": c_char_p},
        {}, True,
        """format by the file's ending; replaced
        atomically
        """),
    "rdm_map_read": Function(
        c_int32, {"m": c_void_p, "bytes": c_void_p, "size": c_size_t},
        {}, True,
        """Replaces what the map holds, resolution included, by bytes [size] of a file. FORMAT, or MEMORY
        when it does not fit; the map is unchanged then.
        """),
    "rdm_map_read_file": Function(
        c_int32, {"m": c_void_p, "path": c_char_p},
        {}, True,
        """NOT_FOUND, FORMAT ..."""),
    "rdm_actor_config_init": Function(
        c_int32, {"c": POINTER(rdm_actor_config), "size": c_size_t},
        {}, True,
        """Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
        version's.
        """),
    "rdm_actor_config_memory": Function(
        c_int32, {"c": POINTER(rdm_actor_config), "bytes": c_void_p},
        {}, True,
        """bytes that creation takes from the alloc hook, exact."""),
    "rdm_actor_create": Function(
        c_int32, {"out": POINTER(c_void_p), "c": POINTER(rdm_actor_config)},
        {}, True,
        """Makes the actor; every world begins an episode. ARGUMENT for a step that does not divide the
        policy's decision, VERSION_MISMATCH for a spec that the policy does not fit, RANGE for sizes and
        a center out of bounds.
        """),
    "rdm_actor_destroy": Function(
        None, {"actor": c_void_p},
        {}, True,
        """NULL is fine"""),
    "rdm_actor_error": Function(
        c_char_p, {"actor": c_void_p},
        {}, True,
        """last failure on this handle; ""
        at first
        """),
    "rdm_actor_act": Function(
        c_int32, {"actor": c_void_p, "obs": c_void_p, "points": POINTER(rdm_points), "mask": c_void_p, "action": c_void_p},
        {"obs": Rows("float32", ("num_envs", "obs_dim")), "mask": Rows("uint8", ("num_envs",)), "action": Rows("float32", ("num_envs", "action_dim"))}, True,
        """action [num_envs][action_dim] for one step of the worlds whose mask [num_envs] is not 0 (NULL:
        all): a new decision on obs [num_envs][obs_dim] where one is due, else the one that is held; rows
        of other worlds are not written. points: clouds of the worlds for a policy that reads points,
        NULL for others. No heap. ARGUMENT for rows that are not finite where a decision is due: nothing
        is counted then.
        """),
    "rdm_actor_reset": Function(
        c_int32, {"actor": c_void_p, "terminated": c_void_p, "truncated": c_void_p},
        {"terminated": Rows("uint8", ("num_envs",)), "truncated": Rows("uint8", ("num_envs",))}, True,
        """Begins new episodes where terminated [num_envs] or truncated [num_envs] is not 0: a decision is
        due there, with fresh noise. Either may be NULL; both NULL: everywhere. Any mask may be given as
        one of them.
        """),
    "rdm_actor_write_state": Function(
        c_int32, {"actor": c_void_p, "bytes": c_void_p, "capacity": c_size_t, "size": c_void_p},
        {}, True,
        """Held actions, counts and noise as bytes [capacity]; NULL asks for the size. An actor of the same
        policy and config that reads them continues with the same bytes.
        """),
    "rdm_actor_read_state": Function(
        c_int32, {"actor": c_void_p, "bytes": c_void_p, "size": c_size_t},
        {}, True,
        """Of bytes [size]. FORMAT for bytes that are truncated or of another actor; nothing changes
        then.
        """),
    "rdm_planner_config_init": Function(
        c_int32, {"c": POINTER(rdm_planner_config), "size": c_size_t},
        {}, True,
        """Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
        version's.
        """),
    "rdm_planner_create": Function(
        c_int32, {"out": POINTER(c_void_p), "c": POINTER(rdm_planner_config)},
        {}, True,
        """Makes the planner and its worlds. ARGUMENT, RANGE, NOT_FOUND name what is wrong; VERSION_MISMATCH
        for a policy that does not fit the pool, UNSUPPORTED for an agent whose critics have no unit
        (rdm_agent_get_values).
        """),
    "rdm_planner_destroy": Function(
        None, {"planner": c_void_p},
        {}, True,
        """NULL is fine"""),
    "rdm_planner_error": Function(
        c_char_p, {"planner": c_void_p},
        {}, True,
        """last failure on this
        handle; "" at first
        """),
    "rdm_planner_get_spec": Function(
        c_int32, {"planner": c_void_p, "io": POINTER(rdm_planner_spec)},
        {}, True,
        """fills io"""),
    "rdm_planner_option_at": Function(
        c_int32, {"i": c_int32, "io": POINTER(rdm_option_spec)},
        {}, True,
        """Option i of planners: method, samples, horizon, knots, interpolation, noise, elites, temperature,
        iterations, costs, and others. RANGE past the end.
        """),
    "rdm_planner_get_settings": Function(
        c_int32, {"planner": c_void_p, "text": c_void_p, "capacity": c_size_t, "size": c_void_p},
        {}, True,
        """All options as text [capacity] of lines key=value: given as settings they make a planner of the
        same options.
        """),
    "rdm_planner_act": Function(
        c_int32, {"planner": c_void_p, "pool": c_void_p, "env": c_int32, "action": c_void_p, "io": POINTER(rdm_plan_info)},
        {"action": Rows("float32", ("action_dim",))}, True,
        """Plans from the state that world env of the pool is in now, and writes the plan's first action to
        action [action_dim]. The pool is only read; it must have the task and options of the one that the
        planner was made for, else ARGUMENT. io may be NULL. STATE where no episode runs. No heap. When
        config.stop ends it early, action, plan and all that follows have the bytes of a planner whose
        option iterations is io.iterations. When no iteration was finished, the plan of before is
        followed, shifted by a step (without one: the policy's rollout so far, or
        rdm_pool_get_initial_mean), and the next call plans. CANCELLED after rdm_planner_cancel; as after
        every error, plan, noise, action and io are as before.
        """),
    "rdm_planner_cancel": Function(
        None, {"planner": c_void_p},
        {}, True,
        """Async-signal-safe, from any thread: the running rdm_planner_act returns CANCELLED before the next
        step of its rollouts, or else the next one does. NULL is fine.
        """),
    "rdm_planner_reset": Function(
        c_int32, {"planner": c_void_p},
        {}, True,
        """Forgets the plan, and what a policy with a memory remembers; the stream of noise continues. The
        next plan begins at rdm_pool_get_initial_mean, or the policy's rollout.
        """),
    "rdm_planner_get_plan": Function(
        c_int32, {"planner": c_void_p, "plan": c_void_p},
        {"plan": Rows("float32", ("horizon", "action_dim"))}, True,
        """Writes the present plan to plan [horizon][action_dim]: row 0 is the action that rdm_planner_act
        gave.
        """),
    "rdm_planner_set_plan": Function(
        c_int32, {"planner": c_void_p, "plan": c_void_p},
        {"plan": Rows("float32", ("horizon", "action_dim"))}, True,
        """The next rdm_planner_act begins at plan [horizon][action_dim], clipped to [-1, 1] and not
        shifted. ARGUMENT for entries that are not finite. With a policy it is tried as sample 1.
        """),
    "rdm_planner_write_state": Function(
        c_int32, {"planner": c_void_p, "bytes": c_void_p, "capacity": c_size_t, "size": c_void_p},
        {}, True,
        """Plan, memory, noise and counters as bytes [capacity]; NULL asks for the size. A planner of the
        same task, options, noise and limits that reads them continues with the same bytes.
        """),
    "rdm_planner_read_state": Function(
        c_int32, {"planner": c_void_p, "bytes": c_void_p, "size": c_size_t},
        {}, True,
        """Of bytes [size]. FORMAT for bytes that are truncated or of another planner; nothing changes
        then.
        """),
    "rdm_agent_get_values": Function(
        c_int32, {"a": c_void_p, "obs": c_void_p, "rows": c_int32, "value": c_void_p, "cost": c_void_p},
        {"obs": Rows("float32", ("rows", "obs_dim")), "value": Rows("float32", ("rows",)), "cost": Rows("float32", ("rows", "RDM_MAX_COSTS"))}, True,
        """What the agent's critics predict for obs [rows][obs_dim], any number of rows: to value [rows] the
        discounted sum of future rewards, and to cost [rows][RDM_MAX_COSTS] that of each cost column
        which the agent limits, 0 in others; cost may be NULL. UNSUPPORTED with options normalize_reward
        or normalize_cost, under which critics have no unit, and with option history, as rows alone do
        not contain the decisions before; a planner supports that option.
        """),
    "rdm_pool_guard_at": Function(
        c_int32, {"pool": c_void_p, "i": c_int32, "io": POINTER(rdm_guard), "normal": c_void_p},
        {"normal": Rows("float32", ("action_dim",))}, True,
        """Guard i that the pool's task declares, and its normal [action_dim]; NULL: not wanted. RANGE past
        the end. There is none for a task whose costs depend on states, nor where drives do not follow
        the action exactly: with a measured angle instead of the command, action_average below 1, another
        control than position, or delayed actions.
        """),
    "rdm_project": Function(
        c_int32, {"normals": c_void_p, "bounds": c_void_p, "count": c_size_t, "dim": c_size_t, "action": c_void_p, "nearest": c_void_p},
        {"normals": Rows("float32", ("count", "dim")), "bounds": Rows("float32", ("count",)), "action": Rows("float32", ("dim",)), "nearest": Rows("float32", ("dim",))}, True,
        """Writes to nearest [dim] the point in [-1, 1] with normals [count][dim] . nearest <= bounds
        [count] that is nearest to action [dim] in the Euclidean norm; the two may be the same array.
        Bounds whose normal has a single entry are met exactly, others up to the rounding of a float
        (2^-24 of the sum of the entries' magnitudes). Neither pool nor memory is needed. ARGUMENT for a
        normal of zeros, for numbers that are not finite, and where no point meets all bounds; RANGE for
        a count above RDM_MAX_GUARDS and a dim outside [1, 1024].
        """),
    "rdm_shield_config_init": Function(
        c_int32, {"c": POINTER(rdm_shield_config), "size": c_size_t},
        {}, True,
        """Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
        version's.
        """),
    "rdm_shield_create": Function(
        c_int32, {"out": POINTER(c_void_p), "c": POINTER(rdm_shield_config)},
        {}, True,
        """Makes the shield and its copies. ARGUMENT, RANGE, NOT_FOUND name what is wrong; for the policy,
        errors are those of rdm_shield_add_policy.
        """),
    "rdm_shield_add_policy": Function(
        c_int32, {"shield": c_void_p, "policy": c_void_p},
        {}, True,
        """Adds a policy's mean actions as a backup, after the policies that the shield has. It must outlive
        the shield. VERSION_MISMATCH for one that does not fit the pool, ARGUMENT for one that holds its
        actions longer or shorter than a decision lasts, and with predict=false, UNSUPPORTED for one that
        reads points, RANGE from the seventh on or where option tries is too small. Plans stay.
        """),
    "rdm_shield_add_guard": Function(
        c_int32, {"shield": c_void_p, "normal": c_void_p, "bound": c_float},
        {"normal": Rows("float32", ("action_dim",))}, True,
        """Adds a guard of the host's own for all worlds: normal [action_dim] . action <= bound, copied.
        ARGUMENT for a normal of zeros, for numbers that are not finite, and where no action keeps it
        together with the other guards; RANGE beyond RDM_MAX_GUARDS. Nothing changes then. Plans are
        forgotten.
        """),
    "rdm_shield_set_guard": Function(
        c_int32, {"shield": c_void_p, "env": c_int32, "i": c_int32, "normal": c_void_p, "bound": c_float},
        {"normal": Rows("float32", ("action_dim",))}, True,
        """Sets the host's own guard i, counted from the first that was added, for world env alone from now
        on: for example what a model says of normal [action_dim] and bound in the world's present state.
        No heap. Errors are those of rdm_shield_add_guard, and the world's guards stay then. The world's
        plan is forgotten if the guard differs from before.
        """),
    "rdm_shield_destroy": Function(
        None, {"shield": c_void_p},
        {}, True,
        """NULL is fine"""),
    "rdm_shield_error": Function(
        c_char_p, {"shield": c_void_p},
        {}, True,
        """last failure on this handle; ""
        at first
        """),
    "rdm_shield_option_at": Function(
        c_int32, {"i": c_int32, "io": POINTER(rdm_option_spec)},
        {}, True,
        """Option i of shields: block, look, tries, rounds, copies, noise, choose, zero, hold, unproven,
        project, predict. RANGE past the end.
        """),
    "rdm_shield_get_settings": Function(
        c_int32, {"shield": c_void_p, "text": c_void_p, "capacity": c_size_t, "size": c_void_p},
        {}, True,
        """All options as text [capacity] of lines key=value: given as settings they make a shield of the
        same options.
        """),
    "rdm_shield_act": Function(
        c_int32, {"shield": c_void_p, "pool": c_void_p, "mask": c_void_p, "proposed": c_void_p, "action": c_void_p},
        {"mask": Rows("uint8", ("num_envs",)), "proposed": Rows("float32", ("num_envs", "action_dim")), "action": Rows("float32", ("num_envs", "action_dim"))}, True,
        """Writes to action [num_envs][action_dim] a decision for the worlds whose mask [num_envs] is not 0
        (NULL: all), given the proposed [num_envs][action_dim] one; the two may be the same array, and
        rows of other worlds are not written. The pool is only read; it must have the task, options and
        number of worlds of the one that the shield was made for, else ARGUMENT. Hold the action for
        config.steps steps of the pool. The shield notices when a world began a new episode or its state
        was set. STATE for a world without an episode, for one in which nothing that was tried keeps the
        budgets, which the text names, and with predict=false where there are no guards; nothing is
        written then.
        """),
    "rdm_shield_get_row": Function(
        c_int32, {"shield": c_void_p, "pool": c_void_p, "env": c_int32, "io": POINTER(rdm_shield_row)},
        {}, True,
        """What was done in the last decision of world env; kind OWN before the first one. ARGUMENT for a
        pool that rdm_shield_act does not take.
        """),
    "rdm_shield_get_kinds": Function(
        c_int32, {"shield": c_void_p, "kind": c_void_p},
        {"kind": Rows("int32", ("num_envs",))}, True,
        """Writes the RDM_SHIELD_... of each world's last decision to kind [num_envs]."""),
    "rdm_shield_set_plan": Function(
        c_int32, {"shield": c_void_p, "pool": c_void_p, "env": c_int32, "plan": c_void_p, "decisions": c_size_t},
        {"plan": Rows("float32", ("decisions", "action_dim"))}, True,
        """Makes plan [decisions][action_dim], of a demonstration or a planner, the plan of world env if a
        copy that follows it, projected onto the guards, keeps the budgets; where it ends before the
        episode, a backup continues. The world follows it when nothing new keeps the budgets. STATE where
        a budget is exceeded, which the text names with the control steps until then, or no episode runs;
        the plan from before stays then. UNSUPPORTED with copies=K. RANGE for more decisions than an
        episode has.
        """),
    "rdm_shield_get_plan": Function(
        c_int32, {"shield": c_void_p, "pool": c_void_p, "env": c_int32, "plan": c_void_p, "capacity": c_size_t, "size": c_void_p},
        {"plan": Rows("float32", ("capacity",))}, True,
        """Writes the present plan of world env to plan [capacity], a row of action_dim numbers for each
        decision from now to the end; *size is how many numbers there are, 0 without a plan. ARGUMENT
        for a pool that rdm_shield_act does not take.
        """),
    "rdm_shield_get_stats": Function(
        c_int32, {"shield": c_void_p, "io": POINTER(rdm_shield_stats)},
        {}, True,
        """Writes the present plan of world env to plan [capacity], a row of action_dim numbers for each
        decision from now to the end; *size is how many numbers there are, 0 without a plan. ARGUMENT
        for a pool that rdm_shield_act does not take.
        """),
    "rdm_shield_reset": Function(
        c_int32, {"shield": c_void_p, "mask": c_void_p},
        {"mask": Rows("uint8", ("num_envs",))}, True,
        """Forgets the plans of the worlds whose mask [num_envs] is not 0 (NULL: all), and what backups with
        a memory remember of them.
        """),
    "rdm_shield_write_state": Function(
        c_int32, {"shield": c_void_p, "bytes": c_void_p, "capacity": c_size_t, "size": c_void_p},
        {}, True,
        """Plans, memories, noise, counts and the host's guards as bytes [capacity]; NULL asks for the size.
        A shield of the same config with as many guards that reads them continues with the same bytes, if
        its pool is set to the state of that moment too.
        """),
    "rdm_shield_read_state": Function(
        c_int32, {"shield": c_void_p, "bytes": c_void_p, "size": c_size_t},
        {}, True,
        """Of bytes [size]. FORMAT for bytes that are truncated or of another shield; nothing changes
        then.
        """),
    "rdm_agent_set_shield": Function(
        c_int32, {"a": c_void_p, "shield": c_void_p},
        {}, True,
        """From now on the shield checks every decision of rdm_agent_rollout; NULL: no shield any more. It
        must be for a pool of as many worlds, and its decisions must last as long as the agent's, else
        rollouts return ARGUMENT; it must outlive the agent, or be taken off before. Its first backup is
        then the agent itself without noise, with what the agent remembers (options history and memory),
        which a refusal does not change: it is of observations, not of actions. The shield checks as many
        decisions ahead as its option block says, with the agent's noise; where the statistics of
        observations have changed since, the actions that were checked are executed and learned from,
        with their own density. The agent's option shield_learn says what it learns from decisions that
        the shield refuses or projects:

          own      the agent's own action and density, with the outcome of the one executed
          applied  the action executed, with its density
          cost     as own, but the cost of column 0 is 1 for each refused decision; option cost_limit (1
                   by default) then limits the refusals in an episode
          end      the episode ends before a refused action runs (a reward of 0, terminated), and the
                   world begins another; where rewards are below 0 use shield_penalty, or ending is
                   attractive. A projected action runs and is learned as own

        With each of them, shield_penalty is subtracted from the reward of refused decisions. To resume a
        run with the same bytes, save the state of the shield too, which holds its plans. STATE inside a
        horizon.
        """),
    "rdm_policy_act_state": Function(
        c_int32, {"p": c_void_p, "obs": c_void_p, "state": c_void_p, "rows": c_int32, "noise": c_void_p, "action": c_void_p, "scratch": c_void_p, "scratch_bytes": c_size_t},
        {"obs": Rows("float32", ("rows", "obs_dim")), "state": Rows("float32", ("rows", "state_dim")), "noise": Rows("float32", ("rows", "action_dim")), "action": Rows("float32", ("rows", "action_dim"))}, True,
        """As rdm_policy_act, of obs [rows][obs_dim], noise [rows][action_dim] or NULL, action
        [rows][action_dim] and scratch [scratch_bytes], for any policy that reads no points (for those
        that do, rdm_policy_act_points_state): state [rows][state_dim] is read, and becomes that after
        the decision; NULL only where state_dim is 0. ARGUMENT for a state that is not finite. On errors
        the state stays as it is, except where the network overflows.
        """),
    "rdm_agent_forget": Function(
        c_int32, {"a": c_void_p, "mode": c_int32, "mask": c_void_p},
        {"mask": Rows("uint8", ("num_envs",))}, True,
        """Clears the memory of the worlds where mask [num_envs] is not 0 (NULL: of all worlds). mode: which
        memory, that of RDM_ACT_SAMPLE or of RDM_ACT_MEAN. The two are separate, so that an evaluation by
        RDM_ACT_MEAN does not disturb the collection of data. The memory of RDM_ACT_SAMPLE is also
        cleared where rdm_agent_record or rdm_agent_put reports an end, and in a row with valid 0 that
        only resets; the memory of RDM_ACT_MEAN is cleared only here. STATE while sampled actions of that
        memory wait for their record, or while an update is under way.
        """),
    "rdm_recording_config_init": Function(
        c_int32, {"c": POINTER(rdm_recording_config), "size": c_size_t},
        {}, True,
        """Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
        version's.
        """),
    "rdm_recording_config_for_pool": Function(
        c_int32, {"c": POINTER(rdm_recording_config), "p": c_void_p},
        {}, True,
        """Sets dims, task, layout_hash, state_bytes, num_points and point_color from a pool. Pointers are
        borrowed from the pool.
        """),
    "rdm_recording_create": Function(
        c_int32, {"out": POINTER(c_void_p), "c": POINTER(rdm_recording_config)},
        {}, True,
        """empty"""),
    "rdm_recording_destroy": Function(
        None, {"r": c_void_p},
        {}, True,
        """NULL is fine"""),
    "rdm_recording_error": Function(
        c_char_p, {"r": c_void_p},
        {}, True,
        """Last failure of a call that may change the recording; "" at first. Failures of calls that only
        read are in rdm_last_error().
        """),
    "rdm_recording_get_info": Function(
        c_int32, {"r": c_void_p, "io": POINTER(rdm_recording_info)},
        {}, True,
        """fills io"""),
    "rdm_recording_get_rows": Function(
        c_int32, {"r": c_void_p, "io": POINTER(rdm_recording_rows)},
        {}, True,
        """Borrowed pointers, until the next call that changes the recording."""),
    "rdm_recording_append": Function(
        c_int32, {"r": c_void_p, "rows": POINTER(rdm_recording_rows)},
        {}, True,
        """Adds rows of a host's own; their episodes are numbered after those that are there, and actions
        and labels are clipped to [-1, 1]. ARGUMENT for numbers that are not finite, flags that are not 0
        or 1, states out of order, episodes whose numbers skip one or that go on after their end; nothing
        changes then.
        """),
    "rdm_recording_append_all": Function(
        c_int32, {"r": c_void_p, "other": c_void_p},
        {}, True,
        """Adds all rows of another recording with the same dims, layout_hash and state_bytes."""),
    "rdm_recording_begin_step": Function(
        c_int32, {"r": c_void_p, "p": c_void_p, "label": c_void_p, "mask": c_void_p},
        {"label": Rows("float32", ("num_envs", "action_dim")), "mask": Rows("uint8", ("num_envs",))}, True,
        """Called before and after rdm_pool_step, for worlds whose mask [num_envs] is not 0 (NULL: all):
        begin_step adds a row with the pool's obs and action, and label [num_envs][action_dim] (NULL: as
        the action); actions and labels are clipped to [-1, 1]. end_step adds the step's reward, costs
        and flags to it; several steps between two begin_step make one row, of sums. A world that ended
        begins an episode with its next row; one in which no episode runs, or that a pool with next-step
        autoreset is about to reset, gets no row. STATE for a world that was never reset. A recording
        follows one pool at a time: rows of another one begin new episodes.
        """),
    "rdm_recording_end_step": Function(
        c_int32, {"r": c_void_p, "p": c_void_p, "mask": c_void_p},
        {"mask": Rows("uint8", ("num_envs",))}, True,
        """Called before and after rdm_pool_step, for worlds whose mask [num_envs] is not 0 (NULL: all):
        begin_step adds a row with the pool's obs and action, and label [num_envs][action_dim] (NULL: as
        the action); actions and labels are clipped to [-1, 1]. end_step adds the step's reward, costs
        and flags to it; several steps between two begin_step make one row, of sums. A world that ended
        begins an episode with its next row; one in which no episode runs, or that a pool with next-step
        autoreset is about to reset, gets no row. STATE for a world that was never reset. A recording
        follows one pool at a time: rows of another one begin new episodes.
        """),
    "rdm_recording_filter": Function(
        c_int32, {"r": c_void_p, "need_success": c_int32, "max_cost": c_void_p, "dropped": c_void_p},
        {"max_cost": Rows("float64", ("cost_dim",))}, True,
        """Drops whole episodes: with need_success 1 those without a success, and those whose sum of a cost
        is above its max_cost [cost_dim] (NULL, or a negative number: not checked). *dropped (may be
        NULL) says how many. The others are numbered anew; episodes that still run are closed.
        """),
    "rdm_recording_clear": Function(
        c_int32, {"r": c_void_p},
        {}, True,
        """drops all rows; memory stays"""),
    "rdm_recording_write_file": Function(
        c_int32, {"r": c_void_p, "path": c_char_p},
        {}, True,
        """A file of arrays, .npz, that numpy.load opens: obs, action, label, reward, cost, terminated,
        truncated, success, episode, state_row, state, points, point_class; task, layout_hash, format.
        Replaced atomically.
        """),
    "rdm_recording_read_file": Function(
        c_int32, {"out": POINTER(c_void_p), "path": c_char_p},
        {}, True,
        """Makes a recording from such a file, also one that numpy.savez or `redman rollout --record` wrote.
        NOT_FOUND; FORMAT when a checksum, a shape or a number is wrong, VERSION_MISMATCH for a newer
        file.
        """),
    "rdm_clone_config_init": Function(
        c_int32, {"how": POINTER(rdm_clone_config), "size": c_size_t},
        {}, True,
        """defaults into the first `size` bytes"""),
    "rdm_agent_clone": Function(
        c_int32, {"a": c_void_p, "r": c_void_p, "how": POINTER(rdm_clone_config), "io": POINTER(rdm_clone_report)},
        {}, True,
        """Behaviour cloning: the actor's mean is fitted to the labels by Adam on minibatches, and the
        weights with the least validation loss are kept; critics and multipliers stay, and the actor's
        optimiser begins anew. Between epochs of the agent: STATE inside a horizon. how NULL: defaults;
        io may be NULL. CANCELLED after rdm_agent_cancel: weights and statistics are as before.
        """),
    "rdm_agent_learn": Function(
        c_int32, {"a": c_void_p, "r": c_void_p, "steps": c_int64, "io": POINTER(rdm_learn_report)},
        {}, True,
        """Learns from recorded rows alone, without a world, by an algorithm with a replay memory, such as
        td3_bc_lag: `steps` (0 to 2^40) gradient steps; 0 only fills the memory. The first call with a
        recording fills it with its rows: option replay_rows must hold them, and the longest episode once
        more for each environment of the agent. It sets the statistics of observations
        and takes 8 bytes a row of the host's. Further calls with the same recording continue, with what
        worlds added since; another recording replaces both. A row is a decision:
        the recording's must span the agent's action_repeat. The last row of an episode without a
        termination is not learned from, because what it led to is not in a recording; a time limit is
        never a termination. Limits are held against what the critics make of the first observations of
        episodes. UNSUPPORTED for other algorithms and for options terminal_cost and cost_signal=raw,
        STATE inside a horizon, RANGE and ARGUMENT for rows that do not fit: nothing changes then.
        CANCELLED after rdm_agent_cancel: what the finished steps changed stays. io may be NULL.
        """),
    "rdm_agent_set_recording": Function(
        c_int32, {"a": c_void_p, "r": c_void_p},
        {}, True,
        """Sets the rows that options `imitation` and `imitation_decay` keep the actor near; obs and label
        are copied. NULL: none. A state of the agent that was saved with rows can be read only with the
        same rows set.
        """),
    "rdm_agent_set_policy": Function(
        c_int32, {"a": c_void_p, "p": c_void_p, "samples": c_double},
        {}, True,
        """Warm start: the actor, its standard deviation and the statistics of observations become those of
        the policy; the statistics count for `samples` (2 to 10^12) observations, and the actor's
        optimiser begins anew. STATE inside a horizon; ARGUMENT where layout, hidden layers, activation,
        std_mode, actor_obs, encoder or normalize_obs differ: the text says which, and nothing
        changes.
        """),
    "rdm_pool_set_starts": Function(
        c_int32, {"p": c_void_p, "r": c_void_p, "share": c_double},
        {}, True,
        """Worlds begin an episode, with probability `share` (0 to 1), at a state of the recording. Random
        streams of their own choose it, so all other draws are the same as without. Such an episode has
        only the steps that were left of the recorded one; its sums begin at 0. States are copied after
        each was tried: FORMAT for one that does not fit, and nothing changes. r NULL: keeps the states
        of the last call, with another share; the share is 0 at first. The streams and the share are part
        of the state of all worlds (env -1), which can be read only with the same states set.
        """),
    "rdm_agent_create_ranked": Function(
        c_int32, {"out": POINTER(c_void_p), "c": POINTER(rdm_agent_config), "ranks": POINTER(rdm_ranks)},
        {}, True,
        """As rdm_agent_create, for the agent of one rank: c.num_envs of the ranks * c.num_envs worlds.
        Takes more memory than rdm_agent_config_memory says: a message for each rank, of at most half a
        MiB unless a row is longer. The hooks must outlive the agent.
        """),
    "rdm_pool_set_rank": Function(
        c_int32, {"p": c_void_p, "rank": c_int32, "ranks": c_int32},
        {}, True,
        """Numbers the worlds of the pool from rank * num_envs on, of ranks * num_envs in all. The numbers
        choose their random streams, and the part that read_state takes from a state of all worlds (env
        -1). Call it before the first reset; STATE afterwards. rdm_agent_rollout needs an agent and a
        pool of the same rank.
        """),
    "rdm_agent_group_at": Function(
        c_int32, {"c": POINTER(rdm_agent_config), "groups": c_char_p, "i": c_int32, "io": POINTER(rdm_group), "name": c_void_p, "columns": c_void_p, "capacity": c_size_t},
        {"columns": Rows("int32", ("capacity",))}, True,
        """Group i of a text that option `groups` would take, for an agent of this config; NULL is "auto":
        the set that the task has first, or one group of all. Writes its name to name [RDM_TEXT_SIZE],
        and up to capacity of the entries of an observation that it observes, ascending, to columns
        [capacity]; of these its network reads those that option actor_obs has too. RANGE past the last
        group. NOT_FOUND for a set that the task does not have, with those that it does; ARGUMENT or
        RANGE for a text that is no list of groups. No agent is made.
        """),
    "rdm_policy_group_name": Function(
        c_char_p, {"p": c_void_p, "i": c_int32},
        {}, True,
        """The name of group i of a policy; lives as long as the policy. NULL ends the list, which is empty
        for a policy of one network.
        """),
    "rdm_policy_write_group": Function(
        c_int32, {"p": c_void_p, "i": c_int32, "bytes": c_void_p, "capacity": c_size_t, "size": c_void_p},
        {}, True,
        """The policy of group i alone as the bytes [capacity] of a policy file; NULL asks for the size. It
        takes the same rows as the whole policy, of which it reads its group's entries, and gives its
        group's entries of the action. STATE for a policy of one network, RANGE past the last group.
        rdm_policy_novelty is UNSUPPORTED on it.
        """),
    "rdm_robot_def_init": Function(
        c_int32, {"def": POINTER(rdm_robot_def), "size": c_size_t},
        {}, True,
        """defaults into the first `size` bytes"""),
    "rdm_robot_create": Function(
        c_int32, {"out": c_void_p, "def": POINTER(rdm_robot_def)},
        {}, True,
        """Adds a robot and writes its number to *out, for rdm_robot_at and the functions below. ARGUMENT,
        RANGE: the text names the row; ARGUMENT for a name that is already used. Principal moments must
        be positive and satisfy the triangle inequality.
        """),
    "rdm_robot_destroy": Function(
        c_int32, {"robot": c_int32},
        {}, True,
        """Pools that use it keep it. ARGUMENT for the library's own."""),
    "rdm_robot_create_mounted": Function(
        c_int32, {"out": c_void_p, "name": c_char_p, "arm": c_int32, "hand": c_int32, "yaw": c_double, "adapter": c_double, "left": c_int32},
        {}, True,
        """A hand on an arm as a robot of its own, under `name`: its root and the arm's last link are one
        body. The hand is rotated by `yaw` (rad) about the flange's z and moved out by `adapter` (m);
        left: its mirror image. UNSUPPORTED unless they are an arm and a hand.
        """),
    "rdm_robot_get_def": Function(
        c_int32, {"robot": c_int32, "io": POINTER(rdm_robot_def)},
        {}, True,
        """What rdm_robot_create took, but for the arrays, which are NULL here."""),
    "rdm_robot_link_at": Function(
        c_int32, {"robot": c_int32, "i": c_int32, "out": POINTER(rdm_robot_link)},
        {}, True,
        """i < num_links"""),
    "rdm_robot_shape_at": Function(
        c_int32, {"robot": c_int32, "i": c_int32, "out": POINTER(rdm_robot_shape)},
        {}, True,
        """i < num_shapes"""),
    "rdm_robot_pair_at": Function(
        c_int32, {"robot": c_int32, "i": c_int32, "out": POINTER(rdm_robot_pair)},
        {}, True,
        """i < num_pairs"""),
    "rdm_robot_coupling_at": Function(
        c_int32, {"robot": c_int32, "i": c_int32, "out": POINTER(rdm_robot_coupling)},
        {}, True,
        """i < num_couplings"""),
    "rdm_robot_curve_at": Function(
        c_int32, {"robot": c_int32, "i": c_int32, "out": POINTER(rdm_robot_curve)},
        {}, True,
        """i < num_curves"""),
    "rdm_robot_finger_at": Function(
        c_int32, {"robot": c_int32, "i": c_int32, "out": POINTER(rdm_robot_finger)},
        {}, True,
        """i < num_fingers"""),
    "rdm_robot_get_postures": Function(
        c_int32, {"robot": c_int32, "commands": c_void_p, "home": c_void_p, "folded": c_void_p, "closed": c_void_p},
        {"commands": Rows("int32", ("num_commands",)), "home": Rows("float64", ("num_links",)), "folded": Rows("float64", ("num_links",)), "closed": Rows("float32", ("num_commands",))}, True,
        """Numbers of the robot's poses and commands: commands [num_commands], home [num_links],
        folded [num_links] and closed [num_commands] may be NULL. The counts are those of
        rdm_robot_get_def; folded and closed are 0 where it has none.
        """),
    "rdm_robot_get_poses": Function(
        c_int32, {"robot": c_int32, "q": c_void_p, "links": c_void_p, "flange": c_void_p, "tips": c_void_p, "palm": c_void_p},
        {"q": Rows("float64", ("num_links",)), "links": Rows("float64", ("num_links", "7")), "flange": Rows("float64", ("7",)), "tips": Rows("float64", ("num_fingers", "3")), "palm": Rows("float64", ("7",))}, True,
        """Forward kinematics for joints q [num_links], in the root frame: writes the poses of the links to
        links [num_links], of the flange to *flange, of the fingertips to tips [num_fingers][3] and of
        the palm to *palm (origin at hold_p, y into the palm, z as the fingers point). flange, tips and
        palm may be NULL. UNSUPPORTED where the flange or the palm is asked of a robot without one;
        nothing is written then.
        """),
    "rdm_robot_reach": Function(
        c_int32, {"robot": c_int32, "flange": c_void_p, "q": c_void_p, "found": c_void_p},
        {"flange": Rows("float64", ("7",)), "q": Rows("float64", ("num_links",))}, True,
        """Inverse kinematics: moves joints q [num_links], from where they are, to where the arm's flange
        has the pose `flange` in the root frame. *found is 0 when the least squares end elsewhere.
        UNSUPPORTED for a robot without a flange.
        """),
    "rdm_object_def_init": Function(
        c_int32, {"def": POINTER(rdm_object_def), "size": c_size_t},
        {}, True,
        """defaults into the first `size` bytes"""),
    "rdm_object_get_def": Function(
        c_int32, {"object": c_int32, "io": POINTER(rdm_object_def)},
        {}, True,
        """What rdm_object_create took, with the moments about the centre of mass, but for the shapes, which
        are NULL here. Shape i < num_shapes is in the frame at the centre of mass; the points of a hull
        live as long as the object.
        """),
    "rdm_object_shape_at": Function(
        c_int32, {"object": c_int32, "i": c_int32, "out": POINTER(rdm_shape_def)},
        {}, True,
        """What rdm_object_create took, with the moments about the centre of mass, but for the shapes, which
        are NULL here. Shape i < num_shapes is in the frame at the centre of mass; the points of a hull
        live as long as the object.
        """),
    "rdm_object_create": Function(
        c_int32, {"out": c_void_p, "def": POINTER(rdm_object_def)},
        {}, True,
        """Adds an object and writes its number to *out, for rdm_object_info_at and the functions here.
        ARGUMENT, RANGE: the text names the row; ARGUMENT for a name that is already used. Objects belong
        to the process; any number of threads may read them meanwhile.
        """),
    "rdm_object_check": Function(
        c_int32, {"def": POINTER(rdm_object_def)},
        {}, True,
        """Returns what rdm_object_create would, but for a name that is already used; adds nothing."""),
    "rdm_object_destroy": Function(
        c_int32, {"object": c_int32},
        {}, True,
        """Pools that have it keep it. ARGUMENT for the library's own."""),
    "rdm_fail": Function(
        c_int32, {"code": c_int32, "text": c_char_p},
        {}, True,
        """Sets rdm_last_error of this thread to `text` and returns `code`."""),
    "rdm_scene_robot_init": Function(
        c_int32, {"robot": POINTER(rdm_scene_robot), "size": c_size_t},
        {}, True,
        """Fills the first `size` bytes with defaults. ARGUMENT for NULL or a size below the first
        version's.
        """),
    "rdm_scene_user": Function(
        c_void_p, {"scene": c_void_p},
        {}, True,
        """rdm_pool_config.user of the pool that is being made; NULL where there is no config (rdm_task_at),
        and for an invalid scene.
        """),
    "rdm_scene_get_number": Function(
        c_int32, {"scene": c_void_p, "key": c_char_p, "value": c_void_p},
        {}, True,
        """Value of the pool's option `key`: *value of a number, integer or flag, *text of a text.
        NOT_FOUND, ARGUMENT.
        """),
    "rdm_scene_get_text": Function(
        c_int32, {"scene": c_void_p, "key": c_char_p, "text": POINTER(c_char_p)},
        {}, True,
        """Value of the pool's option `key`: *value of a number, integer or flag, *text of a text.
        NOT_FOUND, ARGUMENT.
        """),
    "rdm_scene_get_range": Function(
        c_int32, {"scene": c_void_p, "key": c_char_p, "low": c_void_p, "high": c_void_p},
        {}, True,
        """Bounds *low and *high of a number or integer whose row takes a range (choices "a..b"), for reset
        to draw from; equal: a number.
        """),
    "rdm_contact_law_init": Function(
        c_int32, {"law": POINTER(rdm_contact_law), "size": c_size_t},
        {}, True,
        """defaults into the first `size` bytes"""),
    "rdm_scene_add_material": Function(
        c_int32, {"scene": c_void_p, "name": c_char_p},
        {}, True,
        """"default" is one, 15 more"""),
    "rdm_scene_set_friction": Function(
        c_int32, {"scene": c_void_p, "a": c_char_p, "b": c_char_p, "mu": c_double},
        {}, True,
        """0 or more"""),
    "rdm_scene_set_contact_law": Function(
        c_int32, {"scene": c_void_p, "a": c_char_p, "b": c_char_p, "law": POINTER(rdm_contact_law)},
        {}, True,
        """RANGE, ARGUMENT: the text names the field. Making the pool is UNSUPPORTED with engine=ode where a
        law has more than a restitution. Sensors of fingertips measure the forces of such contacts, not
        their torsional torques.
        """),
    "rdm_scene_set_gravity": Function(
        c_int32, {"scene": c_void_p, "gravity": c_void_p},
        {"gravity": Rows("float64", ("3",))}, True,
        """m/s2"""),
    "rdm_scene_set_feedforward": Function(
        c_int32, {"scene": c_void_p},
        {}, True,
        """allows
        rdm_world_set_feedforward
        """),
    "rdm_scene_set_adjustable": Function(
        c_int32, {"scene": c_void_p},
        {}, True,
        """allows rdm_world_set_factors"""),
    "rdm_scene_add_robot": Function(
        c_int32, {"scene": c_void_p, "robot": POINTER(rdm_scene_robot), "index": c_void_p},
        {}, True,
        """index may be NULL"""),
    "rdm_scene_add_body": Function(
        c_int32, {"scene": c_void_p, "body": POINTER(rdm_body_def), "index": c_void_p},
        {}, True,
        """index may be NULL"""),
    "rdm_scene_add_object": Function(
        c_int32, {"scene": c_void_p, "object": c_int32, "name": c_char_p, "pose": c_void_p, "scale": c_double, "index": c_void_p},
        {"pose": Rows("float64", ("7",))}, True,
        """Adds an object as a free body with its centre of mass at `pose`, `scale` times as large (0.05 to
        20) and with the same mass; index may be NULL. The body and its first shape are called `name`,
        further shapes name_1, name_2 ... The object's material is added to the scene if it is new: with
        each material that is there it has the object's friction, with that of another object the lower
        of the two.
        """),
    "rdm_scene_add_static": Function(
        c_int32, {"scene": c_void_p, "shape": POINTER(rdm_shape_def)},
        {}, True,
        """a fixed shape"""),
    "rdm_scene_set_field": Function(
        c_int32, {"scene": c_void_p, "field": c_char_p, "count": c_size_t},
        {}, True,
        """For a task whose sizes depend on its options: sets another count for a field, in the order of
        rdm_task_def.fields; or another count of actions, with hold [count] and mean [count] as in
        rdm_task_def (NULL: 0).
        """),
    "rdm_scene_set_actions": Function(
        c_int32, {"scene": c_void_p, "count": c_size_t, "hold": c_void_p, "mean": c_void_p},
        {"hold": Rows("float32", ("count",)), "mean": Rows("float32", ("count",))}, True,
        """For a task whose sizes depend on its options: sets another count for a field, in the order of
        rdm_task_def.fields; or another count of actions, with hold [count] and mean [count] as in
        rdm_task_def (NULL: 0).
        """),
    "rdm_scene_find": Function(
        c_int32, {"scene": c_void_p, "part": c_int32, "name": c_char_p, "index": c_void_p},
        {}, True,
        """NOT_FOUND: nearest"""),
    "rdm_scene_joint_at": Function(
        c_int32, {"scene": c_void_p, "i": c_int32, "io": POINTER(rdm_joint_info)},
        {}, True,
        """of all robots, robot by robot"""),
    "rdm_scene_add_touch": Function(
        c_int32, {"scene": c_void_p, "a": c_char_p, "b": c_char_p, "group": c_void_p},
        {}, True,
        """Makes *group, for rdm_world_get_touch: all contacts of a shape of `a` with one of `b`; each is
        the name of a shape, body or robot, or a pattern of such names with '*' and '?'. NOT_FOUND where
        nothing matches.
        """),
    "rdm_world_number": Function(
        c_int32, {"world": c_void_p},
        {}, True,
        """The number of the world in its pool, from 0; -1 where rdm_task_check tries a world alone, and for
        an invalid world.
        """),
    "rdm_world_user": Function(
        c_void_p, {"world": c_void_p},
        {}, True,
        """rdm_pool_config.user of the world's pool, also after it read states or copied worlds of other
        pools. It is for what is outside of the world (a viewer, a log): what happens in the world must
        depend neither on it nor on the number. NULL for an invalid world.
        """),
    "rdm_world_get_joints": Function(
        c_int32, {"world": c_void_p, "io": POINTER(rdm_joints)},
        {}, True,
        """fills io"""),
    "rdm_world_get_link": Function(
        c_int32, {"world": c_void_p, "link": c_int32, "out": POINTER(rdm_motion)},
        {}, True,
        """of its joint's frame"""),
    "rdm_world_get_base": Function(
        c_int32, {"world": c_void_p, "robot": c_int32, "out": POINTER(rdm_motion)},
        {}, True,
        """of its base"""),
    "rdm_world_get_body": Function(
        c_int32, {"world": c_void_p, "body": c_int32, "out": POINTER(rdm_motion)},
        {}, True,
        """of its centre of mass"""),
    "rdm_world_get_shape": Function(
        c_int32, {"world": c_void_p, "shape": c_int32, "out": c_void_p},
        {"out": Rows("float64", ("7",))}, True,
        """of its frame"""),
    "rdm_world_get_sensor": Function(
        c_int32, {"world": c_void_p, "sensor": c_int32, "force": c_void_p, "torque": c_void_p},
        {"force": Rows("float64", ("3",)), "torque": Rows("float64", ("3",))}, True,
        """Contact force [3] (N) and torque [3] (N m) on a fingertip, mean over the step, in the link's
        frame, about its origin.
        """),
    "rdm_world_get_touch": Function(
        c_int32, {"world": c_void_p, "group": c_int32, "pairs": c_void_p, "force": c_void_p},
        {}, True,
        """pairs is how many pairs of a group's shapes touched in the step, *force (N) the sum of the
        group's contact forces in its last substep. Either may be NULL.
        """),
    "rdm_world_get_contacts": Function(
        c_int32, {"world": c_void_p, "out": POINTER(rdm_contact), "capacity": c_size_t, "count": c_void_p},
        {}, True,
        """Writes up to capacity contacts of the last substep to out [capacity]; *count is how many there
        are. Contacts of sleeping bodies are those of the moment when they fell asleep.
        """),
    "rdm_world_get_overlap": Function(
        c_int32, {"world": c_void_p, "body": c_int32, "depth": c_void_p},
        {}, True,
        """Writes to *depth (m) how deep a body, where it is now, is inside something that it can touch; 0:
        it is free.
        """),
    "rdm_world_set_body": Function(
        c_int32, {"world": c_void_p, "body": c_int32, "motion": POINTER(rdm_motion)},
        {}, True,
        """Place a free body or a free base; or set joints q [n] and velocities qd [n] (NULL: 0) of a robot
        of n joints, clipped to their ranges, and with them the targets of its drives.
        """),
    "rdm_world_set_base": Function(
        c_int32, {"world": c_void_p, "robot": c_int32, "motion": POINTER(rdm_motion)},
        {}, True,
        """STATE: it is fixed"""),
    "rdm_world_set_joints": Function(
        c_int32, {"world": c_void_p, "robot": c_int32, "q": c_void_p, "qd": c_void_p, "n": c_size_t},
        {"q": Rows("float64", ("n",)), "qd": Rows("float64", ("n",))}, True,
        """all n"""),
    "rdm_world_set_targets": Function(
        c_int32, {"world": c_void_p, "first": c_int32, "targets": c_void_p, "n": c_size_t},
        {"targets": Rows("float64", ("n",))}, True,
        """Set the targets of drives: targets [n] (rad, m) of the joints from `first` on; or commands [n],
        clipped to [-1, 1], all n of a robot, which its description turns into targets (by ranges or
        curves, no faster than its joints' velocity).
        """),
    "rdm_world_set_commands": Function(
        c_int32, {"world": c_void_p, "robot": c_int32, "commands": c_void_p, "n": c_size_t},
        {"commands": Rows("float64", ("n",))}, True,
        """Set the targets of drives: targets [n] (rad, m) of the joints from `first` on; or commands [n],
        clipped to [-1, 1], all n of a robot, which its description turns into targets (by ranges or
        curves, no faster than its joints' velocity).
        """),
    "rdm_world_set_feedforward": Function(
        c_int32, {"world": c_void_p, "first": c_int32, "efforts": c_void_p, "n": c_size_t},
        {"efforts": Rows("float64", ("n",))}, True,
        """Adds efforts [n] (N m, N) to those of the drives from `first` on, until they are set again; STATE
        unless the scene allows it (rdm_scene_set_feedforward). rdm_world_get_gravity gives the efforts
        that hold a robot of n joints against gravity where it is.
        """),
    "rdm_world_get_gravity": Function(
        c_int32, {"world": c_void_p, "robot": c_int32, "efforts": c_void_p, "n": c_size_t},
        {"efforts": Rows("float64", ("n",))}, True,
        """Adds efforts [n] (N m, N) to those of the drives from `first` on, until they are set again; STATE
        unless the scene allows it (rdm_scene_set_feedforward). rdm_world_get_gravity gives the efforts
        that hold a robot of n joints against gravity where it is.
        """),
    "rdm_world_set_factors": Function(
        c_int32, {"world": c_void_p, "factors": POINTER(rdm_factor), "count": c_size_t},
        {}, True,
        """Sets factors [count] of the world, and keeps its others; all are 1 at the start of an episode,
        and reset may draw some. On an error none is set. STATE unless the scene allows it
        (rdm_scene_set_adjustable).
        """),
    "rdm_world_push_body": Function(
        c_int32, {"world": c_void_p, "body": c_int32, "force": c_void_p, "torque": c_void_p},
        {"force": Rows("float64", ("3",)), "torque": Rows("float64", ("3",))}, True,
        """Push a body, a base or a link during the next step: force [3] (N, world axes) at the centre of
        mass, of a link at `point` [3] (m), and torque [3] (N m).
        """),
    "rdm_world_push_base": Function(
        c_int32, {"world": c_void_p, "robot": c_int32, "force": c_void_p, "torque": c_void_p},
        {"force": Rows("float64", ("3",)), "torque": Rows("float64", ("3",))}, True,
        """Push a body, a base or a link during the next step: force [3] (N, world axes) at the centre of
        mass, of a link at `point` [3] (m), and torque [3] (N m).
        """),
    "rdm_world_push_link": Function(
        c_int32, {"world": c_void_p, "link": c_int32, "force": c_void_p, "point": c_void_p},
        {"force": Rows("float64", ("3",)), "point": Rows("float64", ("3",))}, True,
        """Push a body, a base or a link during the next step: force [3] (N, world axes) at the centre of
        mass, of a link at `point` [3] (m), and torque [3] (N m).
        """),
    "rdm_world_get_many": Function(
        c_int32, {"worlds": POINTER(c_void_p), "n": c_size_t, "what": c_int32, "first": c_int32, "count": c_size_t, "x": c_void_p},
        {"x": Rows("float64", ("n", "count", "width"))}, True,
        """Gets or sets quantity `what` of items first to first + count - 1 in each of n worlds, in x
        [n][count][width], where width is the number of doubles of one. Setting does what the function
        for one world does, row by row: on an error, the rows before it are set, or written. At most
        65536 worlds and 4096 items. RANGE for items that the scene does not have, and for a count that
        is not that of items which are only set together.
        """),
    "rdm_world_set_many": Function(
        c_int32, {"worlds": POINTER(c_void_p), "n": c_size_t, "what": c_int32, "first": c_int32, "count": c_size_t, "x": c_void_p},
        {"x": Rows("float64", ("n", "count", "width"))}, True,
        """Gets or sets quantity `what` of items first to first + count - 1 in each of n worlds, in x
        [n][count][width], where width is the number of doubles of one. Setting does what the function
        for one world does, row by row: on an error, the rows before it are set, or written. At most
        65536 worlds and 4096 items. RANGE for items that the scene does not have, and for a count that
        is not that of items which are only set together.
        """),
    "rdm_random_bits": Function(
        c_uint64, {"random": POINTER(rdm_random)},
        {}, True,
        """Draw from the stream; 0 if random is NULL. The same numbers on every machine."""),
    "rdm_random_uniform": Function(
        c_double, {"random": POINTER(rdm_random), "low": c_double, "high": c_double},
        {}, True,
        """in [low, high), up to rounding"""),
    "rdm_random_normal": Function(
        c_double, {"random": POINTER(rdm_random)},
        {}, True,
        """mean 0, deviation 1"""),
    "rdm_random_split": Function(
        c_int32, {"random": POINTER(rdm_random), "out": POINTER(rdm_random)},
        {}, True,
        """Makes another stream *out for draws within an episode: call it in reset and keep the stream in
        the state.
        """),
    "rdm_rotation": Function(
        c_int32, {"axis": c_void_p, "angle": c_double, "q": c_void_p},
        {"axis": Rows("float64", ("3",)), "q": Rows("float64", ("4",))}, True,
        """Writes the rotation by `angle` (rad) about the unit vector axis [3] to q [4]: the same bits on
        every machine, which those from a C library's sine are not.
        """),
    "rdm_task_def_init": Function(
        c_int32, {"def": POINTER(rdm_task_def), "size": c_size_t},
        {}, True,
        """defaults into the first `size` bytes"""),
    "rdm_task_create": Function(
        c_int32, {"out": c_void_p, "def": POINTER(rdm_task_def)},
        {}, True,
        """Adds a task and writes its number to *out, for rdm_task_at and the like. ARGUMENT, RANGE: the
        text names the row; ARGUMENT for a name that is already used. Tasks belong to the process; any
        number of threads may read them meanwhile.
        """),
    "rdm_task_destroy": Function(
        c_int32, {"task": c_int32},
        {}, True,
        """Pools that have it keep it. ARGUMENT for the library's own."""),
    "rdm_task_check": Function(
        c_int32, {"task": c_char_p, "settings": c_char_p, "stop": rdm_stop, "user": c_void_p, "error": c_void_p, "error_size": c_size_t},
        {}, True,
        """Tests what a task must promise, for any task: the same bytes for the same seed, with any number
        of threads and after save and restore; rows within their fields and bounds; costs of 0 or more;
        nothing written past a state or a row; no memory left behind. Returns OK, or the error of making
        a pool, or ARGUMENT: the text names the function, the step and the entry of the first broken
        promise, and is also written to error [error_size] (may be NULL). `settings` as in
        rdm_pool_config; NULL: none. It takes seconds: `stop` (NULL: never) is called with `user` before
        every step of its worlds, and ends it with CANCELLED; nothing is left behind then.
        """),
}


def declare(library: CDLL) -> None:
    """Gives each function of the loaded library its types."""
    for name, function in FUNCTIONS.items():
        symbol = getattr(library, name)
        symbol.restype = function.result
        symbol.argtypes = list(function.arguments.values())
