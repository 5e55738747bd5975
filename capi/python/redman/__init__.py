"""redman: safe dexterous manipulation. Worlds, learners and policies of the library libredman, for numpy.

    import redman
    pool = redman.Pool("hand_over_safe_finger", num_envs=16)
    pool.reset()
    agent = redman.Agent(pool)
    for _ in range(10):
        print(agent.rollout(pool))
    agent.policy().save("policy.rdm")
"""
from __future__ import annotations

from ._abi import Autoreset, BaselineKind, OptionKind, ResultCode, ShapeKind, Status
from ._actor import Actor
from ._agent import Agent, Epoch
from ._curve import Curve, Curves, curve
from ._discovery import Algo, Field, Option, Robot, Task, algo, algos, build, objects, robots, task, tasks
from ._error import (AllocationError, ArgumentError, CancelledError, Error, FileError, FormatError, InternalError,
                     MissingFileError, NotFoundError, PhysicsError, RangeError, StateError, UnsupportedError,
                     VersionError)
from ._hold import HoldWarning
from ._map import Map, sample_furthest
from ._play import Evaluation, evaluate
from ._policy import Origin, Policy
from ._pool import Pool, Sensors, memory
from ._train import Run, train

__version__ = version = build().version

__all__ = [
    "Actor", "Agent", "Algo", "AllocationError", "ArgumentError", "Autoreset", "BaselineKind", "CancelledError", "Curve",
    "Curves", "Epoch", "Error", "Evaluation", "Field", "FileError", "FormatError", "HoldWarning", "InternalError", "Map",
    "MissingFileError", "NotFoundError", "Option", "OptionKind", "Origin", "PhysicsError", "Policy", "Pool", "RangeError",
    "ResultCode", "Robot", "Run", "Sensors", "ShapeKind", "StateError", "Status", "Task", "UnsupportedError",
    "VersionError", "__version__", "algo", "algos", "build", "curve", "evaluate", "memory", "objects", "robots",
    "sample_furthest", "task", "tasks", "train", "version",
]
