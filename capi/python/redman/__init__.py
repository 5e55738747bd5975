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

from typing import TYPE_CHECKING

from . import stats
from ._abi import (Autoreset, BaselineKind, Build, JointKind, MapInfo, OptionKind, OptionLevel, PolicyInfo, PoolStats,
                   RayHit, ResultCode, ShapeKind, ShieldKind, ShieldStats, Spec, Status)
from ._actor import Actor
from ._agent import Agent, Epoch
from ._callbacks import c_function
from ._curve import Curve, Curves, curve
from ._discovery import (Algo, Camera, Cost, Field, Joint, Object, Option, Robot, Shape, Task, algo, algos, build,
                         objects, robots, shield_options, task, tasks)
from ._error import (AllocationError, ArgumentError, CancelledError, Error, FileError, FormatError, InternalError,
                     MissingFileError, NotFoundError, PhysicsError, RangeError, StateError, UnsupportedError, UsageError,
                     VersionError)
from ._hold import HoldWarning
from ._limits import CostLimits
from ._map import Map, sample_furthest
from ._names import moved
from ._options import Options
from ._play import Evaluation, Player, evaluate
from ._policy import Origin, Policy
from ._pool import Guard, Pool, Sensors, memory
from ._shield import Shield, ShieldRow, project
from ._train import Callback, Run, train

__version__ = version = build().version

__all__ = [
    "Actor", "Agent", "Algo", "AllocationError", "ArgumentError", "Autoreset", "BaselineKind", "Build", "Callback", "Camera",
    "CancelledError", "Cost", "CostLimits", "Curve", "Curves", "Epoch", "Error", "Evaluation", "Field", "FileError",
    "FormatError", "Guard", "HoldWarning", "InternalError", "Joint", "JointKind", "Map", "MapInfo", "MissingFileError",
    "NotFoundError", "Object", "Option", "OptionKind", "OptionLevel", "Options", "Origin", "PhysicsError", "Player", "Policy", "PolicyInfo",
    "Pool", "PoolStats", "RangeError", "RayHit", "ResultCode", "Robot", "Run", "Sensors", "Shape", "ShapeKind", "Shield", "ShieldKind", "ShieldRow", "ShieldStats", "Spec", "StateError", "Status", "Task",
    "UnsupportedError", "UsageError", "VersionError", "__version__", "algo", "algos", "build", "c_function", "curve",
    "evaluate", "memory", "objects", "project", "robots", "sample_furthest", "shield_options", "stats", "task", "tasks", "train", "version",
]

moved(globals(), __all__)  # what is public is of this module, in texts and in pickles

if not TYPE_CHECKING:  # a type checker would take it for every name

    def __getattr__(name):
        """Adapters are imported when they are asked for; other libraries' words say what to write instead."""
        import importlib
        from ._names import module_hint
        if name in ("gym", "omnisafe", "safety", "sb3"):
            return importlib.import_module(f".{name}", __name__)
        raise AttributeError(module_hint(name, __all__))
