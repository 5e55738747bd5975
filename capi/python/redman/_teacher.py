"""What a run learns from before it learns from rewards: a policy or a recording, or a teacher that acts (_taught.py)."""
from __future__ import annotations

import copy
import math
import os
from dataclasses import dataclass, field
from typing import Any, Mapping, Optional, Sequence, Union

from . import _discovery
from ._agent import Agent
from ._error import ArgumentError, UnsupportedError, UsageError
from ._library import flag, real, whole
from ._names import nearest
from ._options import Value, as_dict, shown
from ._policy import Backup, Policy, policy_of
from ._pool import Pool
from ._recording import Recording

# A policy, its file or run folder, "trained", a run; a recording or its file (.npz).
Teacher = Union[Backup, Recording, Any]

_POLICY_SAMPLES = 100_000.0  # that a policy's statistics of observations count for
# Options of the learner that keep what was taught, under the caller's own.
_TAUGHT: tuple[tuple[str, Value], ...] = (
    ("std_min", "0.01"), ("init_std", "0.03"), ("learning_rate", "1e-9"), ("critic_learning_rate", "1e-3"),
    ("lr_schedule", "kl"), ("kl_target", "0.02"), ("lr_min", "1e-9"), ("warm_epochs", "10"), ("obs_freeze", "1"))
# Of a student, all of which but an encoder stays as it was taught (latent_from=history).
_ADAPTING: tuple[tuple[str, Value], ...] = (("std_min", "0.01"), ("learning_rate", "1e-3"), ("lr_schedule", "linear"))
_SETTINGS: dict[str, Any] = {
    "decisions": 640, "noise": 0.05, "success_only": False, "clone_epochs": 20, "clone_patience": 0, "clone_rate": 1e-3,
    "validation": 0.1, "pretrain": 0, "pretrain_epochs": 10, "dagger": 0, "beta": 0.5, "start_share": 0.0,
    "start_share_end": 0.0}
_ACTING = ("decisions", "noise", "pretrain", "pretrain_epochs", "dagger", "beta")  # of teachers that act
_MOST = {"validation": 0.9, "beta": 1.0, "dagger": 1000, "decisions": 1 << 24, "pretrain": 1 << 20}


def _is_recording(teacher: Any) -> bool:
    return isinstance(teacher, Recording) or (isinstance(teacher, (str, os.PathLike)) and
                                              str(teacher).lower().endswith(".npz"))


@dataclass
class Teach:
    """The arguments from_ and teach of train, and teach_cfgs of config.json."""

    teacher: Any  # as it was given
    settings: dict[str, Any] = field(default_factory=lambda: dict(_SETTINGS))
    said: str = ""  # what config.json calls the teacher
    policy: Optional[Policy] = None  # or
    recording: Optional[Recording] = None
    acts: bool = False  # the command teaches

    @classmethod
    def wanted(cls, teacher: Any, settings: Optional[Mapping[str, Any]], task: Optional[str]) -> Optional[Teach]:
        """The teacher that was asked for; None: there is none."""
        teach = cls(teacher)
        if isinstance(settings, (str, os.PathLike)):
            raise UsageError(f"teach: it must be a dict of settings, such as {{\"success_only\": True}}, not {settings!r}; the teacher is "
                             f"from_={os.fspath(settings)!r}")
        settings = as_dict(settings, "teach")
        for key, value in settings.items():
            teach._set(key, value)
        if teacher is None and not teach.settings["pretrain"]:
            if settings:
                raise UsageError("teach: it needs a teacher: give from_= a policy, a run folder, a recording (.npz), or \"demo\"")
            return None
        if hasattr(teacher, "policy") and hasattr(teacher, "env_steps"):  # a run
            teach.teacher = teacher.policy
        word = teacher if isinstance(teacher, str) else ""
        if word in ("zero", "hold", "random"):
            raise ArgumentError(f"from_={word!r}: this is no teacher: give a policy, a run folder, a recording (.npz), or \"demo\"")
        demo = word == "demo" or str(teacher).endswith(".demo")
        teach.acts = bool(demo or teach.settings["pretrain"] or teach.settings["dagger"])
        if teach.acts:
            teach.said = "" if teacher is None else os.fspath(teacher) if isinstance(teacher, (str, os.PathLike)) else "a policy"
            return teach
        odd = [key for key in settings if key in _ACTING]
        if odd:
            raise UsageError(f"teach: {odd[0]} needs a teacher that acts: give from_=\"demo\", a .demo file, or teach={{\"dagger\": 2}}")
        if _is_recording(teacher):
            teach.recording = teacher if isinstance(teacher, Recording) else Recording.load(teacher)
            teach.said = "a recording" if isinstance(teacher, Recording) else os.fspath(teacher)
        else:
            if word == "trained" and task is None:
                raise UsageError("from_=\"trained\": the task is missing: give task=")
            teach.policy = policy_of(teach.teacher, task or "", "from_")
            origin = teach.policy.origin
            named = isinstance(teacher, (str, os.PathLike))
            teach.said = os.fspath(teacher) if named else origin.folder if origin and origin.folder else "a policy"
        return teach

    @classmethod
    def of_config(cls, said: Mapping[str, Any]) -> Teach:
        """The teacher of a run that is resumed, which is read again only where the run still needs it."""
        teach = cls(said["from"], {**_SETTINGS, **{key: value for key, value in said.items() if key != "from"}}, said["from"])
        return teach

    def config(self) -> dict[str, Any]:
        return {"from": self.said, **self.settings}

    def _set(self, key: str, value: Any) -> None:
        if key not in _SETTINGS or key == "start_share_end":
            raise UsageError(f"teach: no {key}{nearest(key, set(_SETTINGS) - {'start_share_end'})}; there are "
                             f"{', '.join(name for name in _SETTINGS if name != 'start_share_end')}")
        if key == "start_share":
            pair = list(value) if isinstance(value, (tuple, list)) else [value, value]
            first, last = (real(share, "teach: start_share") for share in (pair if len(pair) == 2 else [math.nan, math.nan]))
            if not (0 <= first <= 1 and 0 <= last <= 1):
                raise ArgumentError(f"teach: start_share: {value!r} is not a share from 0 to 1 or a pair of shares")
            self.settings.update(start_share=first, start_share_end=last)
        elif isinstance(_SETTINGS[key], bool):
            self.settings[key] = bool(flag(value, f"teach: {key}"))
        elif isinstance(_SETTINGS[key], int):
            least = 1 if key in ("clone_epochs", "decisions") else 0
            self.settings[key] = whole(value, f"teach: {key}", least, int(_MOST.get(key, 100_000)))
        else:
            most = _MOST.get(key, 10.0)
            number = real(value, f"teach: {key}")
            if not 0 <= number <= most:
                raise ArgumentError(f"teach: {key}: {value!r} is not between 0 and {most}")
            self.settings[key] = number

    @property
    def task(self) -> Optional[str]:
        """The task of the teacher; None where the command finds it."""
        if self.policy is not None:
            return self.policy.info.task or None
        return None if self.recording is None else self.recording.info.task or None

    def task_options(self, task: str) -> list[tuple[str, Value]]:
        """Options of the task as the teacher had them, which the caller's override."""
        if self.policy is None:
            return []
        out: list[tuple[str, Value]] = []
        origin, info = self.policy.origin, self.policy.info
        if origin is not None and origin.task == task == info.task:
            out += origin.options.items()
        if info.num_points:
            out += eyes(info.num_points, info.action_repeat, "true" if info.point_color else "false")
        return out

    def algo_options(self, given: Sequence[tuple[str, Value]]) -> tuple[tuple[str, Value], ...]:
        return _ADAPTING if dict(given).get("latent_from") == "history" else _TAUGHT

    def apply(self, agent: Agent, pool: Pool, seed: int) -> None:
        """Gives the agent what it learns by imitation, and the worlds their starts."""
        if self.policy is not None:
            self.policy.check(pool)
            agent.warm_start(self.policy, _POLICY_SAMPLES)
        recording = self.recording
        if recording is not None:
            if self.settings["success_only"]:
                recording = self.recording = copy.deepcopy(recording)  # it may be the caller's
                recording.filter(True)
                if not len(recording):
                    raise ArgumentError("teach: success_only: no episode of the recording succeeded")
            agent.clone(recording, epochs=self.settings["clone_epochs"], patience=self.settings["clone_patience"],
                        learning_rate=self.settings["clone_rate"], learning_rate_end=self.settings["clone_rate"] / 100,
                        validation=self.settings["validation"], seed=seed)
        imitates = imitates_of(agent)
        if recording is None:
            if imitates or self.starts:
                raise UsageError("teach: start_share and option imitation need a recording: from_=\"demo.npz\"")
            return
        if imitates:
            agent.recording = recording
        if self.starts:
            pool.set_starts(recording, self.settings["start_share"])

    def again(self, agent: Agent, pool: Pool, seed: int) -> None:
        """Does the same for a run that is resumed, where the run still needs it."""
        if not imitates_of(agent) and not self.starts:
            return
        if self.recording is None and not _is_recording(self.teacher):
            raise UnsupportedError(f"resume: it still learns from {self.said!r}, which the command plays: redman train --resume")
        if self.recording is None:
            self.recording = Recording.load(self.teacher)
        self.apply(agent, pool, seed)

    @property
    def starts(self) -> bool:
        """Whether episodes start from states of the recording."""
        return bool(self.settings["start_share"] > 0 or self.settings["start_share_end"] > 0)

    def draw_starts(self, pool: Pool, done: float) -> None:
        """Moves the share of such starts from its first value to its last, in step with the run."""
        if self.starts:
            first, last = self.settings["start_share"], self.settings["start_share_end"]
            pool.set_starts(None, first + done * (last - first))


def imitates_of(agent: Agent) -> bool:
    """Whether the agent stays near a recording while it learns, which some algorithms have no option for."""
    return float(agent.options.get("imitation", 0)) > 0


def eyes(points: int, repeat: int, color: str) -> list[tuple[str, Value]]:
    """Options of a task that let its worlds show what a network of points reads."""
    return [("modality", "points"), ("points", str(points)), ("sampling", "voxel"), ("point_color", color),
            ("sense_every", str(repeat))]


def eyes_of(task: str, algo: str, of_algo: Mapping[str, Value]) -> list[tuple[str, Value]]:
    """The same for an agent of these options; empty without an encoder, which some algorithms have no option for."""
    known = _discovery.algo(algo).options
    if "encoder" not in known:
        return []
    defaults = _discovery.task(task).defaults

    def value(key: str) -> str:
        return shown(key, of_algo[key] if key in of_algo else defaults.get(key, known[key].default))

    if not value("encoder"):
        return []
    return eyes(max(1, int(float(value("encoder_points")))), max(1, int(float(value("action_repeat")))),
                value("encoder_color"))
