"""The files of a run folder, byte for byte as `redman train` writes them: config.json, progress.csv, its event file for
TensorBoard, policy.rdm, and the note in checkpoint.rdm. Test test_python_runs compares whole folders."""
from __future__ import annotations

import contextlib
import json
import math
import os
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Iterable, Mapping, NamedTuple, Optional, Sequence, Union

from . import _events
from ._agent import Epoch
from ._error import FileError, FormatError, MissingFileError, StateError
from ._files import MOST_JSON, MOST_TEXT, read_bytes, read_whole, write_whole

FolderPath = Union[str, "os.PathLike[str]"]

# What the files of a run begin with; of config.json it is keys that no other program's has.
_HEADS = {"progress.csv": b"Train/Epoch,Train/TotalSteps,TotalEnvSteps,", "policy.rdm": b"RDMPOLIC",
          "checkpoint.rdm": b"RDMCHECK", "config.json": b""}
_CONFIG_KEYS = {"task", "algo", "seed", "train_cfgs", "algo_cfgs", "layout_hash"}


class Score(NamedTuple):
    """How good an evaluation was."""

    feasible: bool
    excess: float  # minus the sum of limited costs above their limits, as shares of them
    ret: float


class Tested(NamedTuple):
    """The result of an evaluation during training."""

    ret: float = math.nan
    cost: float = math.nan


class Times(NamedTuple):
    """Seconds of an epoch, of the evaluation after it, and of the run so far."""

    epoch: float
    evaluation: float
    total: float


# ---- progress.csv


def progress_row(e: Epoch, costs: Sequence[str], limits: Sequence[Optional[float]], steps: int, tested: Tested,
                 times: Times) -> dict[str, float]:
    """One row by the names of its columns. steps: those of this epoch."""
    def episodic(value: float) -> float:
        return value if e.episodes > 0 else math.nan

    def counted(value: Optional[int]) -> float:
        return math.nan if value is None else value

    def named(text: str, k: int) -> str:
        return text if k == 0 else f"{text}/{costs[k]}"

    row: dict[str, float] = {"Train/Epoch": e.epoch, "Train/TotalSteps": e.env_steps, "TotalEnvSteps": e.env_steps,
                             "Metrics/EpRet": episodic(e.ret)}
    row.update((named("Metrics/EpCost", k), episodic(e.cost[k])) for k in range(len(costs)))
    row.update({"Metrics/EpLen": episodic(e.length), "Metrics/FallRate": episodic(e.fall_rate),
                "Metrics/SuccessRate": episodic(e.success_rate), "Metrics/CostPerStep": e.cost_per_step,
                "Metrics/Episodes": e.episodes, "Metrics/Violations": counted(e.violations)})
    row.update((named("Metrics/LagrangeMultiplier", k), e.multiplier[k]) for k in range(len(costs))
               if k == 0 or limits[k] is not None)
    row.update({
        "Train/KL": e.kl, "Train/LR": e.learning_rate, "Train/Entropy": e.entropy, "Train/PolicyStd": e.action_std,
        "Train/ClipFraction": e.clip_fraction, "Train/StopIter": e.passes, "Loss/Loss_pi": e.loss_policy,
        "Loss/Loss_reward_critic": e.loss_reward_value, "Loss/Loss_cost_critic": e.loss_cost_value,
        "Value/reward": e.value_reward, "Value/cost": e.value_cost, "Metrics/TestEpRet": tested.ret,
        "Metrics/TestEpCost": tested.cost, "Shield/Refused": counted(e.refused), "Shield/Unproven": counted(e.unproven),
        "Shield/Inevitable": counted(e.inevitable), "Shield/Copied": counted(e.copied), "Time/Epoch": times.epoch,
        "Time/Evaluation": times.evaluation, "Time/FPS": steps / times.epoch, "Time/Total": times.total,
        "Trouble/Diverged": e.diverged, "Trouble/ContactsLeftOut": e.contacts_left_out, "Trouble/Unconverged": e.unconverged,
        "Trouble/Slowed": e.slowed,
        "Trouble/BadActions": e.bad_actions, "Trouble/TaskFailed": e.task_failed, "Trouble/InvalidRows": e.invalid_rows,
        "Trouble/SkippedGradients": e.skipped_gradients})
    return row


def _cells(row: Iterable[float]) -> str:
    return ",".join("nan" if math.isnan(value) else f"{value:.9g}" for value in row)


def read_progress(folder: Path) -> dict[str, list[float]]:
    """The columns of progress.csv. A last row that a kill cut off is left out."""
    lines = read_whole(folder / "progress.csv", "run", MOST_TEXT).decode(errors="replace").split("\n")
    names = lines[0].split(",")
    out: dict[str, list[float]] = {name: [] for name in names}
    for line in lines[1:]:
        cells = line.split(",")
        if len(cells) != len(names):
            continue
        for name, cell in zip(names, cells):
            try:
                out[name].append(float(cell))
            except ValueError:
                out[name].append(math.nan)
    return out


# ---- the note of checkpoint.rdm


@dataclass
class Note:
    """What a run remembers besides the states of its agent and its worlds."""

    epoch: int = 0
    env_steps: int = 0
    progress_bytes: int = 0
    seconds: float = 0.0
    last: Tested = Tested()
    best: Optional[Score] = None
    best_policy: bytes = b""  # empty without `best`
    shield: bytes = b""  # its state, empty without one
    # Options of the task that Training.set has changed, and the epoch in which it made the worlds that have them. Those of the
    # learner are in its state.
    changed: dict[str, Any] = field(default_factory=dict)

    def __bytes__(self) -> bytes:
        """A line of JSON, then the state of the shield and the best policy."""
        said: dict[str, Any] = {"epoch": self.epoch, "env_steps": self.env_steps, "progress_bytes": self.progress_bytes,
                                "seconds": self.seconds}
        if not math.isnan(self.last.ret):
            said["last"] = list(map(_finite, self.last))
        if self.best is not None:  # an excess of -0.0 is none
            said["best"] = [self.best.feasible, _finite(self.best.ret), _finite(0.0 - self.best.excess)]
        if self.shield:
            said["shield_bytes"] = len(self.shield)
        if self.changed:
            said["changed"] = self.changed
        line = json.dumps(said, separators=(",", ":"), ensure_ascii=False, allow_nan=False)
        return f"{line}\n".encode() + self.shield + self.best_policy

    @classmethod
    def of(cls, data: bytes) -> Note:
        """Reads a note; raises FormatError where it is none."""
        line, _, rest = data.partition(b"\n")
        try:
            said = json.loads(line)
            note = cls(int(said["epoch"]), int(said["env_steps"]), int(said["progress_bytes"]))
            seconds = said["seconds"]
            if isinstance(seconds, (int, float)) and 0 <= seconds <= 1e12:  # a clock that jumped is no reason to lose the run
                note.seconds = float(seconds)
            if "last" in said:
                note.last = Tested(*(_read(value, worst) for value, worst in zip(said["last"], (-math.inf, math.inf))))
            size = int(said.get("shield_bytes", 0))
            note.shield, rest = rest[:size], rest[size:]
            note.changed = dict(said.get("changed", {}))
            if "best" in said:
                feasible, ret, excess = said["best"]
                note.best, note.best_policy = Score(bool(feasible), -_read(excess, math.inf), _read(ret, -math.inf)), rest
        except (ValueError, KeyError, TypeError) as error:
            raise FormatError(f"its note was not written by redman: {error!r}") from None
        return note


def _finite(value: float) -> Optional[float]:
    """None for a number that JSON cannot hold."""
    return value if math.isfinite(value) else None


def _read(value: Optional[float], otherwise: float) -> float:
    return otherwise if value is None else float(value)


# ---- the folder


def _is_own(path: Path) -> bool:
    """Whether redman wrote the file."""
    if path.name == "config.json":
        try:
            config = json.loads(read_bytes(path, MOST_JSON))
        except (OSError, ValueError):
            return False
        return isinstance(config, dict) and _CONFIG_KEYS <= config.keys()
    return _begins(path, _HEADS[path.name])


def _begins(path: Path, head: bytes) -> bool:
    with open(path, "rb") as file:
        return file.read(len(head)) == head


def read_config(folder: FolderPath) -> dict[str, Any]:
    """Reads config.json of a run folder. Raises MissingFileError where there is none, FormatError where it is no run's."""
    path = Path(folder)
    if not (path / "config.json").is_file():
        raise MissingFileError(f"run {path}: " + ("it has no config.json" if path.is_dir() else "there is no such folder") +
                               f"; redman.train(task, out={os.fspath(folder)!r}) begins one")
    try:
        config = json.loads(read_bytes(path / "config.json", MOST_JSON))
    except OSError as error:
        raise FileError(f"run {path}: config.json: {error.strerror}") from None
    except ValueError as error:
        raise FormatError(f"run {path}: config.json: {error}") from None
    if not isinstance(config, dict) or not _CONFIG_KEYS <= config.keys():
        raise FormatError(f"run {path}: config.json is not a run's")
    return config


class RunFolder:
    """A run folder that is being written. Files are written entirely or not at all, and the folder is locked meanwhile. If it has
    files of these names that redman did not write, they stay and the run is refused."""

    def __init__(self, path: FolderPath, *, overwrite: bool = False, goes_on: bool = False) -> None:
        self.path = Path(path)
        if goes_on:
            read_config(path)
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            self._lock = os.open(self.path, os.O_RDONLY)
        except OSError as error:
            raise FileError(f"cannot make folder {self.path}: {error.strerror}") from None
        try:
            self._take(overwrite, goes_on)
        except BaseException:
            self.close()
            raise
        self.progress_bytes = 0
        self._header = ""
        self._begun = int(time.time())
        self._events: Optional[Path] = None

    def _take(self, overwrite: bool, goes_on: bool) -> None:
        try:
            import fcntl
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            raise StateError(f"another process is training in {self.path}") from None
        except (ImportError, OSError):
            pass  # a system or a file system without locks
        there = [self.path / name for name in _HEADS if os.path.lexists(self.path / name)]
        foreign = [path for path in there if not path.is_file() or not _is_own(path)]
        if foreign:
            raise StateError(f"{foreign[0]} was not written by redman: move it away, or give another folder")
        if there and not overwrite and not goes_on:
            what = "a run" if len(there) > 1 else f"{there[0].name} of a run"
            raise StateError(f"{self.path} holds {what} already: continue it with resume={os.fspath(self.path)!r}, begin again "
                             "with overwrite=True, or give another folder")

    def close(self) -> None:
        os.close(self._lock)

    @property
    def checkpoint(self) -> Path:
        return self.path / "checkpoint.rdm"

    def check(self) -> None:
        """Raises StateError if the folder is gone, or another one has its name."""
        try:
            same = os.path.samestat(os.fstat(self._lock), os.stat(self.path))
        except OSError:
            same = False
        if not same:
            raise StateError(f"the run folder {self.path} was removed while this run was training in it")

    def write(self, name: str, data: bytes) -> None:
        self.check()
        write_whole(self.path / name, data, "run folder")

    def write_config(self, config: Mapping[str, Any]) -> None:
        self.write("config.json", (json.dumps(config, indent=2, ensure_ascii=False, allow_nan=False) + "\n").encode())

    def begin(self, config: Mapping[str, Any], names: Iterable[str], policy: bytes, *, events: bool, goes_on: bool) -> None:
        """Writes the files that a run has before its first step. names: the columns of progress.csv."""
        for old in ("checkpoint.rdm", "config.json"):  # the checkpoint first: a kill must not leave it beside another run's files
            with contextlib.suppress(FileNotFoundError):
                (self.path / old).unlink()
        if not goes_on:
            for path in self._event_files():
                path.unlink()
        self._header = ",".join(names)
        self.write_config(config)
        self.write("progress.csv", f"{self._header}\n".encode())
        self.write("policy.rdm", policy)
        if events:
            self._write_events(f"{self._header}\n")

    def go_on(self, progress_bytes: int, *, events: bool) -> None:
        """Removes the rows that follow the checkpoint, and continues behind the others."""
        path = self.path / "progress.csv"
        kept = read_whole(path, "run", MOST_TEXT)[:progress_bytes]
        if len(kept) < progress_bytes:
            raise StateError(f"{path} is shorter than the checkpoint says; start the run again")
        os.truncate(path, progress_bytes)
        self.progress_bytes = progress_bytes
        text = kept.decode(errors="replace")
        self._header = text.partition("\n")[0]
        if events:
            self._write_events(text)

    def append(self, row: Mapping[str, float]) -> None:
        self.check()
        line = _cells(row.get(name, math.nan) for name in self._header.split(","))
        with open(self.path / "progress.csv", "ab") as file:
            file.write(f"{line}\n".encode())
            self.progress_bytes = file.tell()
        if self._events:
            with open(self._events, "ab") as file:
                file.write(self._event(line))

    def _event(self, line: str) -> bytes:
        return _events.row(dict(zip(self._header.split(","), line.split(","))), self._begun)

    def _event_files(self) -> list[Path]:
        out = []
        for path in sorted(self.path.glob("events.out.tfevents.*.redman")):
            seconds = path.name.split(".")[3]
            if path.is_file() and not path.is_symlink() and seconds.isdecimal() and _begins(path, _events.head(int(seconds))):
                out.append(path)
        return out

    def _write_events(self, progress: str) -> None:
        """Writes the event file: into the one that is there, since a reader may be following it, else into a new one."""
        there = self._event_files()
        if there:
            self._begun = int(there[-1].name.split(".")[3])
        self._events = self.path / _events.file_name(self._begun)
        rows = b"".join(map(self._event, progress.splitlines()[1:]))
        data = _events.head(self._begun) + rows
        if there:
            with open(self._events, "r+b") as file:
                file.truncate(0)
                file.write(data)
        else:
            write_whole(self._events, data, "run folder")
