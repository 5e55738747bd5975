"""redman: safe dexterous manipulation. Worlds, learners and policies of the library libredman, for numpy.

    import redman

    # worlds; a step fills pool.obs, pool.reward, pool.cost, ...
    pool = redman.Pool("hand_over_safe_finger", num_envs=16, seed=7)
    pool.reset()
    pool.step(pool.baseline("random"))

    # a policy
    run = redman.train("hand_over_safe_finger", steps=1e6, out="runs/first")
    print(run.evaluate())
    actor = redman.load("runs/first").actor(pool)
    pool.step(actor())

These are the public names; help(redman.Pool), for example, describes one of them.

    what exists     tasks, task, algos, algo, robots, robot, objects,
                    planner_options, shield_options
    files           load; load_robot, load_object, load_task
    worlds          Pool, Sensors, Guard; spec, memory; Map, sample_furthest
    learners        Agent, Epoch, CostLimits, Options; Recording, CloneReport;
                    Ranks
    policies        Policy, Actor, Origin, HoldWarning; Planner, PlanInfo;
                    Shield, ShieldRow, project
    teams           groups, Group; Policy.groups, Policy.group; algorithms
                    mappo, mappo_lag, happo, macpo, ippo, ippo_lag
    runs            train, sweep, Run; callbacks, Callback, Training; evaluate,
                    Evaluation, Player; compare, Comparison; curve, Curve,
                    Curves; stats; Episode; view, Window
    your own        Rows, Costs: rewards and costs of train and evaluate; Task,
                    RowTask, Verdict, Worlds, SceneBuilder; Robot.create,
                    Object.create, a .task file; check_task, c_function
    environments    redman.gym, redman.sb3, redman.safety, redman.omnisafe,
                    redman.pettingzoo; make, make_vec
    data sets       redman.data: load, save and convert sets of episodes (.npz,
                    .hdf5, .minari, .lerobot, .mcap); data.score
    sharing         redman.hub: a policy with its card, in a folder or on the
                    hub of models
    records         Algo, Build, Camera, Cost, Field, Joint, MapInfo, Note,
                    Object, Option, PlannerSpec, PolicyInfo, PoolStats, Poses,
                    PretrainReport, RayHit, RecordingInfo, Robot, Shape,
                    ShieldStats, Spec, TaskInfo
    numbers         Autoreset, BaselineKind, Feature, JointKind, NoteKind,
                    OptionKind, OptionLevel, ResultCode, RobotKind, Scale,
                    ShapeKind, ShieldKind, Status
    errors          Error, of which are AllocationError, ArgumentError,
                    CancelledError, FileError, FormatError, InternalError,
                    MissingFileError, NotFoundError, PhysicsError, RangeError,
                    StateError, UnsupportedError, UsageError, VersionError
    the library     build, features, version

Arrays are numpy's, [rows][...], in SI units: m, rad, N, s. pool.obs, pool.reward and the like are views that the next
step overwrites: copy what you want to keep. The same seed gives the same bytes for any number of threads. For a wrong
argument, the error says what it may be; an error is also the Python exception that one would expect: a NotFoundError is a
LookupError. A file may be given instead of a name: Pool("press.task"), options={"hand": "my.urdf", "object": "mug.object"},
evaluate("runs/first").
"""
from __future__ import annotations

from typing import TYPE_CHECKING

try:
    import numpy as _numpy
except ImportError as error:
    if error.name != "numpy":  # it is there, and something that it needs is not
        raise
    raise ImportError("redman needs numpy: apt-get install python3-numpy, or pip install numpy") from error

from . import callbacks, stats
from ._abi import (Autoreset, BaselineKind, Build, Feature, JointKind, MapInfo, OptionKind, OptionLevel, PlannerSpec, PolicyInfo,
                   PoolStats, PretrainReport, RayHit, RecordingInfo, ResultCode, RobotKind, Scale, ShapeKind, ShieldKind, ShieldStats,
                   Spec, Status)
from ._actor import Actor
from ._agent import Agent, Epoch
from ._callbacks import c_function
from ._compare import Comparison, compare
from ._curve import Curve, Curves, curve
from ._episode import Episode
from ._discovery import (Algo, Camera, Cost, Field, Joint, Option, Shape, TaskInfo, algo, algos, build, features, planner_options,
                         shield_options, task, tasks)
from ._error import (AllocationError, ArgumentError, CancelledError, Error, FileError, FormatError, InternalError,
                     MissingFileError, NotFoundError, PhysicsError, RangeError, StateError, UnsupportedError, UsageError,
                     VersionError)
from ._hold import HoldWarning
from ._import_abi import NoteKind
from ._importer import load_object, load_robot, load_task
from ._limits import CostLimits
from ._load import load
from ._make import make, make_vec
from ._map import Map, sample_furthest
from ._names import moved
from ._object import Object, objects
from ._options import Options
from ._own_costs import Costs, Rows
from ._own_task import RowTask, Task, Verdict
from ._planner import PlanInfo, Planner
from ._play import Evaluation, Player, evaluate
from ._policy import Origin, Policy
from ._pool import Guard, Pool, Sensors, check_task, memory, spec
from ._ranks import Ranks
from ._recording import Recording
from ._robot import Note, Poses, Robot, robot, robots
from ._scene import SceneBuilder
from ._shield import Shield, ShieldRow, project
from ._sweep import sweep
from ._teach import CloneReport
from ._team import Group, groups
from ._run import Run
from ._train import train
from ._window import Window, view
from ._worlds_rows import Worlds
from .callbacks import Callback, Training

__version__ = version = build().version

__all__ = [
    "Actor", "Agent", "Algo", "AllocationError", "ArgumentError", "Autoreset", "BaselineKind", "Build", "Callback", "Camera",
    "CancelledError", "CloneReport", "Comparison", "Cost", "CostLimits", "Costs", "Curve", "Curves", "Episode", "Epoch", "Error",
    "Evaluation", "Feature", "Field", "FileError", "FormatError", "Group", "Guard", "HoldWarning", "InternalError", "Joint", "JointKind",
    "Map", "MapInfo",
    "MissingFileError", "NotFoundError", "Note", "NoteKind", "Object", "Option", "OptionKind", "OptionLevel", "Options",
    "Origin", "PhysicsError", "PlanInfo", "Planner", "PlannerSpec", "Player", "Policy", "PolicyInfo", "Pool", "PoolStats",
    "Poses", "PretrainReport", "RangeError", "Ranks", "RayHit", "Recording", "RecordingInfo", "ResultCode", "Robot",
    "RobotKind", "RowTask", "Rows", "Run", "Scale", "SceneBuilder", "Sensors", "Shape", "ShapeKind", "Shield", "ShieldKind", "ShieldRow", "ShieldStats", "Spec",
    "__version__", "algo", "algos", "build", "c_function", "callbacks", "check_task", "compare", "curve", "evaluate", "features", "groups",
    "load", "load_object", "load_robot", "load_task", "make", "StateError", "Status", "Task", "TaskInfo", "Training", "UnsupportedError",
    "UsageError", "Verdict", "VersionError", "Window", "Worlds",
    "make_vec", "memory", "objects", "planner_options", "project", "robot", "robots", "sample_furthest", "shield_options",
    "spec", "stats", "sweep", "task", "tasks", "train", "version", "view",
]

moved(globals(), __all__)  # what is public is of this module, in texts and in pickles

if not TYPE_CHECKING:  # a type checker would take it for every name

    def __getattr__(name):
        """Imports an adapter when it is first used; for names of other libraries, the error says what to write instead."""
        import importlib
        from ._names import module_hint
        if name in ("data", "gym", "hub", "omnisafe", "pettingzoo", "safety", "sb3"):
            return importlib.import_module(f".{name}", __name__)
        raise AttributeError(module_hint(name, __all__))
