"""redman: safe dexterous manipulation. Worlds, learners and policies of the library libredman, for numpy."""
from __future__ import annotations

from ._discovery import (Algo, Field, Option, Robot, Task, algo, algos, build, objects, robots, task, tasks)
from ._error import (AllocationError, ArgumentError, CancelledError, Error, FileError, FormatError, InternalError,
                     MissingFileError, NotFoundError, PhysicsError, RangeError, StateError, UnsupportedError,
                     VersionError)
from ._pool import SHAPE_KINDS, Pool, Sensors

__version__ = version = build().version
