"""The importer's C ABI for ctypes. Written by generate_abi.py from redman/import.h: change the header, not this file."""
from __future__ import annotations

import enum
from ctypes import (CDLL, POINTER, Structure, c_char_p, c_double, c_int32, c_size_t, c_uint32, c_void_p)

from ._abi import Function, Rows, rdm_object_def, rdm_robot_def
from ._record import Members, Record


class ImportFormat(enum.IntEnum, metaclass=Members):
    """of a file; AUTO looks at the first element

    AUTO = 0
    URDF = 1
    MJCF = 2
    ROBOT = 3
    """

    AUTO = 0
    URDF = 1
    MJCF = 2
    ROBOT = 3


class NoteKind(enum.IntEnum, metaclass=Members):
    """of a note

    DROPPED = 0: in the file, not in the robot
    CHANGED = 1: in the robot, in another form
    GUESSED = 2: not in the file
    CHECK = 3: found by load_robot(check=True)
    """

    DROPPED = 0
    CHANGED = 1
    GUESSED = 2
    CHECK = 3


class rdm_import_config(Structure):
    """how a file is read; ARGUMENT for root, roles, density or slide_range with a .robot file

    struct_size: bytes, set by rdm_import_config_init
    format: RDM_IMPORT_*
    kind: RDM_ROBOT_*, -1: guessed; default -1
    skip_meshes: flag: meshes that cannot be read are dropped with a note, else refused
    name: of the robot, which then has no alias; NULL: the file's
    folder: folder that the names of meshes in a text start from; NULL: that of the file, or none
    packages: folder that holds the folders of package://; NULL: searched above the file
    root: link (body) whose subtree is read, "world" for all of an MJCF file; NULL: the whole tree, of an MJCF
        file the only body of its world
    palm: link; NULL: guessed
    tips: links or sites, "a,b,c", one for each finger; NULL: guessed
    mount: link or site, or "x y z roll pitch yaw" in the root frame; NULL: guessed
    flange: link or site, "none"; NULL: guessed
    error: [error_size] receives the text when a call that takes this config fails; NULL: not wanted
    error_size: bytes, terminator included; a longer text is cut
    mend_inertia: flag: moments that violate the triangle inequality are raised with a note, else refused
    density: kg/m3, of the <collision> shapes of URDF links without <inertial>; 0: such links are massless.
        ARGUMENT when above 0 with another format, where geoms have their own
    slide_range: m to either side, range of a sliding joint without limits; 0: 2 pi
    """

    struct_size: int
    format: int
    kind: int
    skip_meshes: int
    name: bytes | None
    folder: bytes | None
    packages: bytes | None
    root: bytes | None
    palm: bytes | None
    tips: bytes | None
    mount: bytes | None
    flange: bytes | None
    error: int | None
    error_size: int
    mend_inertia: int
    density: float
    slide_range: float
    _fields_ = [
        ("struct_size", c_uint32),
        ("format", c_int32),
        ("kind", c_int32),
        ("skip_meshes", c_int32),
        ("name", c_char_p),
        ("folder", c_char_p),
        ("packages", c_char_p),
        ("root", c_char_p),
        ("palm", c_char_p),
        ("tips", c_char_p),
        ("mount", c_char_p),
        ("flange", c_char_p),
        ("error", c_void_p),
        ("error_size", c_int32),
        ("mend_inertia", c_int32),
        ("density", c_double),
        ("slide_range", c_double),
    ]


class ImportNote(Record):
    """frozen layout; texts live as long as the handle

    kind: NoteKind
    line: line of the file, from 1; 0: none
    text: one line, with the element and, in an included file, its name
    """

    kind: int
    line: int
    text: str


class rdm_import_note(Structure):
    """frozen layout; texts live as long as the handle

    kind: RDM_NOTE_*
    line: line of the file, from 1; 0: none
    text: one line, with the element and, in an included file, its name
    """

    kind: int
    line: int
    text: bytes | None
    _fields_ = [
        ("kind", c_int32),
        ("line", c_int32),
        ("text", c_char_p),
    ]


STRUCTS: dict[str, type[Structure]] = {
    "rdm_import_config": rdm_import_config,
    "rdm_import_note": rdm_import_note,
}

# The rows that fields of structs point at.
ROWS: dict[str, dict[str, Rows]] = {
}

FUNCTIONS: dict[str, Function] = {
    "rdm_import_config_init": Function(
        c_int32, {"c": POINTER(rdm_import_config), "size": c_size_t},
        {}, True,
        """Fills the first `size` bytes with defaults."""),
    "rdm_import_read_file": Function(
        c_int32, {"out": POINTER(c_void_p), "path": c_char_p, "c": POINTER(rdm_import_config)},
        {}, True,
        """Reads a file; c may be NULL for the defaults. NOT_FOUND, IO; FORMAT: malformed, with its line;
        ARGUMENT, RANGE: an impossible robot, with line and element; UNSUPPORTED: an element that would
        change the robot and is not read. Anything but a regular file is IO and never waited for. A file
        and all that it includes or names may take at most 4096 files, 16 MB of text, 512 MB of meshes
        (64 MB each), 250,000 elements, 400,000 attributes and 10 million steps of work: RANGE beyond.
        """),
    "rdm_import_read": Function(
        c_int32, {"out": POINTER(c_void_p), "bytes": c_void_p, "size": c_size_t, "c": POINTER(rdm_import_config)},
        {}, True,
        """The same for bytes [size] of a file. Without config.folder it has neither meshes nor includes."""),
    "rdm_import_create_robot": Function(
        c_int32, {"out": POINTER(c_void_p), "robot": c_int32},
        {}, True,
        """Makes a handle of an existing robot, such as one of the library's own, so that it can be
        written.
        """),
    "rdm_import_destroy": Function(
        None, {"i": c_void_p},
        {}, True,
        """NULL is fine"""),
    "rdm_import_get_robot_def": Function(
        c_int32, {"i": c_void_p, "io": POINTER(rdm_robot_def)},
        {}, True,
        """What rdm_robot_create takes; texts and arrays live as long as the handle."""),
    "rdm_import_note_count": Function(
        c_int32, {"i": c_void_p},
        {}, True,
        """0 for anything but a handle"""),
    "rdm_import_note_at": Function(
        c_int32, {"i": c_void_p, "n": c_int32, "out": POINTER(rdm_import_note)},
        {}, True,
        """n < the count"""),
    "rdm_import_check": Function(
        c_int32, {"i": c_void_p},
        {}, True,
        """Tries the robot alone and adds notes of kind CHECK: shapes that touch at home or while one joint
        sweeps its range, joints that do not come to rest at home or do not reach the ends of their range
        within 2 s (weightless, own drives, no contacts). Fails as rdm_robot_create would.
        """),
    "rdm_import_write_robot": Function(
        c_int32, {"def": POINTER(rdm_robot_def), "text": c_void_p, "capacity": c_size_t, "size": c_void_p},
        {}, True,
        """The robot as a .robot file, text [capacity]; read back it is the same to the last bit. ARGUMENT
        where a row refers to one that does not exist, for numbers that are not finite and for names that
        are not UTF-8.
        """),
    "rdm_import_read_task_file": Function(
        c_int32, {"task": c_void_p, "path": c_char_p},
        {}, True,
        """Registers the task of a .task file: its scene, observation, rewards and costs as text (TOML, 1:1
        with rdm_task_def and what rdm_scene_* takes, with lists of terms instead of functions). It gets
        the name in the file; *task is for rdm_task_at and rdm_task_destroy. Before that, a world with
        default options is made, reset and stepped. Errors are those of rdm_import_read_file.
        """),
    "rdm_import_read_task": Function(
        c_int32, {"task": c_void_p, "bytes": c_void_p, "size": c_size_t, "file": c_char_p},
        {}, True,
        """The same for bytes [size]; texts of errors begin with `file`; NULL: with nothing."""),
    "rdm_import_read_object_file": Function(
        c_int32, {"out": POINTER(c_void_p), "path": c_char_p},
        {}, True,
        """Objects: an .object file (TOML, 1:1 with rdm_object_def; rows [[shape]]) as a handle for the call
        below, or bytes [size] of one, or an existing object. FORMAT with the line; ARGUMENT, RANGE as
        rdm_object_create.
        """),
    "rdm_import_read_object": Function(
        c_int32, {"out": POINTER(c_void_p), "bytes": c_void_p, "size": c_size_t},
        {}, True,
        """Objects: an .object file (TOML, 1:1 with rdm_object_def; rows [[shape]]) as a handle for the call
        below, or bytes [size] of one, or an existing object. FORMAT with the line; ARGUMENT, RANGE as
        rdm_object_create.
        """),
    "rdm_import_create_object": Function(
        c_int32, {"out": POINTER(c_void_p), "object": c_int32},
        {}, True,
        """Objects: an .object file (TOML, 1:1 with rdm_object_def; rows [[shape]]) as a handle for the call
        below, or bytes [size] of one, or an existing object. FORMAT with the line; ARGUMENT, RANGE as
        rdm_object_create.
        """),
    "rdm_import_get_object_def": Function(
        c_int32, {"i": c_void_p, "io": POINTER(rdm_object_def)},
        {}, True,
        """What rdm_object_create takes; texts and arrays live as long as the handle."""),
    "rdm_import_write_object": Function(
        c_int32, {"def": POINTER(rdm_object_def), "text": c_void_p, "capacity": c_size_t, "size": c_void_p},
        {}, True,
        """The object as an .object file, text [capacity]; read back it is the same to the last bit."""),
    "rdm_import_error": Function(
        c_char_p, {},
        {}, True,
        """This thread's last failure in this library, one line; valid until its next failing call."""),
}


def declare(library: CDLL) -> None:
    """Gives each function of the loaded library its types."""
    for name, function in FUNCTIONS.items():
        symbol = getattr(library, name)
        symbol.restype = function.result
        symbol.argtypes = list(function.arguments.values())
