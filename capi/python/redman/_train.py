"""train: a complete training run, with the run folder of the command-line tool."""
from __future__ import annotations

import contextlib
import ctypes
import json
import math
import os
import signal
import sys
import threading
import time
from ctypes import byref
from pathlib import Path
from typing import Any, Callable, Iterator, NamedTuple, Optional, Union

import numpy as np

from . import _abi, _discovery, _events, _own_files as own_files
from ._agent import Agent, Epoch
from ._curve import Curve
from ._error import ArgumentError, FileError, NotFoundError, StateError, UnsupportedError, UsageError
from ._files import MOST_JSON, MOST_TASK, read_bytes, read_whole, write_whole
from ._library import check, encoded, lib, whole
from ._limits import CostLimits
from ._names import Hinted, keywords, nearest
from ._options import Given, Options, Value, shown
from ._paths import is_file, named_options
from ._play import Evaluation, evaluate, play, singly, summary
from ._policy import Backup, Origin, Policy
from ._pool import Pool
from ._shield import Shielding

# Of an evaluation during training; a policy that looks better than the best so far plays as many again
# _CONFIRMATIONS times, and those alone say whether it is.
_SELECTION_EPISODES, _CONFIRMATIONS = 20, 4
_MOST_STEPS = 1 << 53  # what a float counts exactly
Callback = Callable[[Epoch], Any]


class _Score(NamedTuple):
    """How good an evaluation was; the greater the better."""

    feasible: bool
    excess: float  # minus the sum of limited costs above their limits, as shares of them
    ret: float


def _score(e: Evaluation) -> _Score:
    """A cost counts as its mean plus a standard error, since the best of many noisy evaluations is usually one that was
    lucky."""
    feasible, excess = True, 0.0
    for mean, deviation, limit in zip(e.cost_mean, e.cost_std, e.cost_limits):
        if limit is not None:
            over = mean + deviation / math.sqrt(e.episodes - 1) - limit
            feasible = feasible and over <= 0
            excess += max(0.0, over) / max(limit, 1.0)
    return _Score(feasible, 0.0 if feasible else -excess, e.return_mean)


class Run(Hinted):
    """A finished run: policy (the best one within the limits), curve, agent (its last state), folder, env_steps, seconds."""

    _draws = "run.curve and run.policy draw themselves in a notebook; run.curve.save('curve.svg') writes the curve"
    _hints = {
        "render": f"{_draws}; the command `redman render` makes pictures and pages of an episode",
        "model": "run.policy, or run.agent", "history": "run.curve",
        "resume": "Python does not resume a run; the command `redman train --resume FOLDER` does, if it has a folder",
        "returns": "run.curve.returns", "costs": "run.curve.costs"}

    def __init__(self, task: str, algo: str, seed: int, options: dict[str, Value], agent: Agent) -> None:
        self.task, self.algo, self.seed, self.options, self.agent = task, algo, seed, options, agent
        self.folder: Optional[Path] = None
        self.policy: Policy = self._own(agent.policy())
        self.env_steps = 0
        self.seconds = 0.0
        self.interrupted = False
        self._rows: dict[str, list[float]] = {}

    def _own(self, policy: Policy) -> Policy:
        """The policy with the settings to evaluate it by."""
        names = _discovery.task(self.task).costs
        limits = {name: limit for name, limit in zip(names, self.agent.cost_limits) if limit is not None}
        policy.origin = Origin(self.task, self.options, limits, learns_magnitudes(self.agent),
                               None if self.folder is None else str(self.folder))
        return policy

    @property
    def curve(self) -> Curve:
        """Progress of the epochs."""
        return Curve(self._rows, f"{self.task} {self.algo} seed {self.seed}", self.agent.cost_limits[0],
                     str(self.folder or ""))

    @property
    def epochs(self) -> list[dict[str, float]]:
        """The rows of the curve, one for each epoch."""
        return [dict(zip(self._rows, row)) for row in zip(*self._rows.values())]

    @property
    def best(self) -> Policy:
        """The policy that was kept: the best within the limits, else the one nearest to them."""
        return self.policy

    @property
    def config(self) -> dict[str, Any]:
        """The settings of the run: task, algo, seed, the options of the task and of the learner, limits by the names of
        costs."""
        limits = dict(zip(_discovery.task(self.task).costs, self.agent.cost_limits))
        return {"task": self.task, "algo": self.algo, "seed": self.seed, "options": dict(self.options),
                "agent_options": self.agent.options, "cost_limits": limits}

    def plot(self) -> Curve:
        """The curve, which a notebook draws when it is the last line of a cell; elsewhere use run.curve.save("curve.svg")."""
        return self.curve

    def save(self, path: Union[str, os.PathLike[str]]) -> None:
        """Writes the policy file; train(..., out="runs/first") writes a whole run folder."""
        self.policy.save(path)

    @classmethod
    def load(cls, folder: Union[str, os.PathLike[str]]) -> Run:
        """Always refused: a run cannot be read back."""
        raise UnsupportedError(f"Run.load: redman.Policy.load({os.fspath(folder)!r}) and redman.curve(...) read a run folder; "
                                "the command `redman train --resume FOLDER` continues it")

    def evaluate(self, episodes: int = 100, num_envs: int = 16, seed: int = 0, threads: int = 0, *, shield: Shielding = None,
                 shield_policy: Optional[Backup] = None) -> Evaluation:
        """Evaluates the policy on episodes that were not used to choose it: those of `redman.evaluate(folder)` and of
        `redman eval --policy FOLDER`. The report at the end of `redman train` uses seed=run.seed + 1_000_000."""
        return evaluate(self.policy, episodes=episodes, num_envs=num_envs, seed=seed, threads=threads, shield=shield,
                        shield_policy=shield_policy)

    def _repr_svg_(self) -> str:
        return self.curve._repr_svg_()

    def _repr_html_(self) -> str:
        return self.curve._repr_html_()

    def __repr__(self) -> str:
        return f"<Run {self.task} {self.algo} seed {self.seed}: {self.env_steps} steps in {self.seconds:.0f} s>"


def _folded(key: str) -> str:
    return key.lower().replace("-", "_")


def split_options(task: str, algo: str, options: Options) -> tuple[dict[str, Value], dict[str, Value]]:
    """Splits options into those of the task and those of the algorithm; a key of both goes to both."""
    tables = (_discovery.task(task).options, _discovery.algo(algo).options)
    of_task, of_algo = ({_folded(key) for key in table} for table in tables)
    kinds = {key: option.kind for table in tables for key, option in table.items()}

    def plain(key: str, value: Given) -> Value:
        return shown(key, value, kinds) if isinstance(value, (list, tuple, np.ndarray)) else value  # type: ignore[return-value]

    def is_of_task(key: str) -> bool:
        return _folded(key) in of_task or _folded(key.split(".", 1)[0] + ".FIELD") in of_task

    for key in options:
        if not is_of_task(key) and _folded(key) not in of_algo:
            raise NotFoundError(f"option {key}: neither task {task} nor algorithm {algo} has it"
                                f"{nearest(key, sorted(of_task | of_algo))}")
    return ({key: plain(key, value) for key, value in options.items() if is_of_task(key)},
            {key: plain(key, value) for key, value in options.items() if _folded(key) in of_algo})


def learns_magnitudes(agent: Agent) -> bool:
    """Whether its costs are sums of cost_raw, with limits in that unit."""
    return agent.options["cost_signal"] == "raw"


def _handles_costs(algo: str, columns: int) -> bool:
    """Whether the algorithm handles costs: such an algorithm refuses to work without a limit."""
    config = _abi.rdm_agent_config()
    check(lib.rdm_agent_config_init(byref(config), ctypes.sizeof(config)))
    none = np.full(columns, -1.0)
    config.obs_dim = config.action_dim = config.num_envs = 1
    config.cost_dim, config.algo, config.cost_limits = columns, encoded(algo), none.ctypes.data
    size = ctypes.c_size_t()
    return bool(lib.rdm_agent_config_memory(byref(config), byref(size)))


class _Meter:
    """One line of progress on stderr: rewritten on a terminal and in a notebook, else one every ten seconds."""

    def __init__(self, goal: int, per_epoch: int) -> None:
        self._goal, self._begin, self._shown = goal, time.monotonic(), 0.0
        self._width = 0  # of the line that stands there
        self._live = sys.stderr.isatty() or "ipykernel" in sys.modules
        if goal % per_epoch:
            self._say(f"steps={goal}: a run ends with an epoch, of up to {per_epoch} steps: it makes up to "
                      f"{math.ceil(goal / per_epoch) * per_epoch}\n")

    def show(self, e: Epoch) -> None:
        now = time.monotonic()
        last = e.env_steps >= self._goal
        if not last and now - self._shown < (0.2 if self._live else 10):
            return
        self._shown = now
        rate = e.env_steps / max(now - self._begin, 1e-9)
        left = int(max(self._goal - e.env_steps, 0) / max(rate, 1e-9))
        ended = (f"return {e.ret:.2f}  cost {e.cost[0]:.2f}  length {e.length:.0f}  falls {100 * e.fall_rate:.0f}%"
                 if e.episodes > 0 else f"no episode has ended  cost per step {e.cost_per_step:.3g}")
        line = (f"{min(100, 100 * e.env_steps / self._goal):3.0f}%  {e.env_steps} steps  {ended}  {rate:.0f} steps/s  "
                f"{left // 60}:{left % 60:02d} left")
        self._say(f"\r{line:<{self._width}}" if self._live else f"{line}\n")
        self._width = len(line) if self._live else 0

    def end(self, run: Run) -> None:
        """Ends the line, and says so when the run is not over."""
        self._say("\n" if self._width else "")
        if run.interrupted:
            further = f"; continue with redman train --resume {run.folder}" if run.folder else ""
            self._say(f"stopped at {run.env_steps} of {self._goal} steps{further}\n")

    @staticmethod
    def _say(text: str) -> None:
        sys.stderr.write(text)
        sys.stderr.flush()


@contextlib.contextmanager
def _ends_after_epoch() -> Iterator[list[int]]:
    """Counts the first Ctrl-C; further ones raise KeyboardInterrupt as usual."""
    heard: list[int] = []
    own = (threading.current_thread() is threading.main_thread()
           and signal.getsignal(signal.SIGINT) is signal.default_int_handler)

    def hear(number: int, frame: Any) -> None:
        heard.append(number)
        if len(heard) > 1:
            signal.default_int_handler(number, frame)

    if own:
        signal.signal(signal.SIGINT, hear)
    try:
        yield heard
    finally:
        if own:
            signal.signal(signal.SIGINT, signal.default_int_handler)


def _row(e: Epoch, costs: list[str], limits: list[Optional[float]], steps: int, tested: tuple[float, float],
         times: tuple[float, float, float]) -> dict[str, float]:
    """A row of progress.csv."""
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
        "Value/reward": e.value_reward, "Value/cost": e.value_cost, "Metrics/TestEpRet": tested[0],
        "Metrics/TestEpCost": tested[1], "Shield/Refused": counted(e.refused), "Shield/Unproven": counted(e.unproven),
        "Shield/Copied": counted(e.copied), "Time/Epoch": times[0], "Time/Evaluation": times[1],
        "Time/FPS": steps / times[0], "Time/Total": times[2],
        "Trouble/Diverged": e.diverged, "Trouble/ContactsLeftOut": e.contacts_left_out, "Trouble/Unconverged": e.unconverged,
        "Trouble/Slowed": e.slowed,
        "Trouble/BadActions": e.bad_actions, "Trouble/TaskFailed": e.task_failed, "Trouble/InvalidRows": e.invalid_rows,
        "Trouble/SkippedGradients": e.skipped_gradients})
    return row


# What the files of a run begin with; of config.json it is keys that no other program's has.
_HEADS = {"progress.csv": b"Train/Epoch,Train/TotalSteps,TotalEnvSteps,", "policy.rdm": b"RDMPOLIC",
          "checkpoint.rdm": b"RDMCHECK", "config.json": b""}
_CONFIG_KEYS = {"task", "algo", "seed", "train_cfgs", "algo_cfgs", "layout_hash"}


def _is_own(path: Path) -> bool:
    """Whether redman wrote the file of a run's name."""
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


class _Folder:
    """A run folder that `redman eval`, `plot` and `train --resume` can read. Files are written entirely or not at all, and
    the folder is locked meanwhile. If it has files of these names that redman did not write, they stay and the run is
    refused."""

    def __init__(self, path: Union[str, os.PathLike[str]], overwrite: bool) -> None:
        self.path = Path(path)
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            self._lock = os.open(self.path, os.O_RDONLY)
        except OSError as error:
            raise FileError(f"cannot make folder {self.path}: {error.strerror}") from None
        try:
            import fcntl
            fcntl.flock(self._lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError:
            self.close()
            raise StateError(f"another process is training in {self.path}") from None
        except (ImportError, OSError):
            pass  # a system or a file system without locks
        there = [self.path / name for name in _HEADS if os.path.lexists(self.path / name)]
        foreign = [path for path in there if not path.is_file() or not _is_own(path)]
        if foreign:
            self.close()
            raise StateError(f"{foreign[0]} was not written by redman: move it away, or give another folder")
        if there and not overwrite:
            self.close()
            raise StateError(f"{self.path} holds {'a run' if len(there) > 1 else there[0].name + ' of a run'} already: "
                             "say overwrite=True, or another folder")
        self.progress_bytes = 0
        self._begun = int(time.time())
        self._events = self.path / _events.file_name(self._begun)

    def close(self) -> None:
        os.close(self._lock)

    def write(self, name: str, data: bytes) -> None:
        write_whole(self.path / name, data, "run folder")

    def begin(self, config: dict[str, Any], header: str, policy: bytes) -> None:
        for old in ("checkpoint.rdm", "config.json"):
            with contextlib.suppress(FileNotFoundError):
                (self.path / old).unlink()
        for path in self.path.glob("events.out.tfevents.*.redman"):  # of the run that this one takes the place of
            seconds = path.name.split(".")[3]
            if path.is_file() and seconds.isdecimal() and _begins(path, _events.head(int(seconds))):
                path.unlink()
        self._header = header
        write_whole(self._events, _events.head(self._begun), "run folder")
        self.write("progress.csv", f"{header}\n".encode())
        self.write("policy.rdm", policy)
        self.write("config.json", (json.dumps(config, indent=2) + "\n").encode())

    def append(self, row: str) -> None:
        with open(self.path / "progress.csv", "ab") as file:
            file.write(f"{row}\n".encode())
            self.progress_bytes = file.tell()
        with open(self._events, "ab") as file:
            file.write(_events.row(dict(zip(self._header.split(","), row.split(","))), self._begun))


def _config(run: Run, pool: Pool, of_task: dict[str, Value], of_algo: dict[str, Value], steps: int, threads: int,
            eval_every: int, per_epoch: int, task_text: Optional[str]) -> dict[str, Any]:
    """config.json: the settings of the run, with all defaults written out."""
    limits = dict(zip(pool.costs, run.agent.cost_limits))
    return {
        "exp_name": f"{run.task}-{run.algo}-seed-{run.seed}", "task": run.task, "algo": run.algo, "seed": run.seed,
        "set": [f"{key}={shown(key, value)}" for key, value in of_task.items()],
        "set_algo": [f"{key}={shown(key, value)}" for key, value in of_algo.items()],
        "set_cost_limit": [f"{name}={shown(name, -1 if limit is None else limit)}" for name, limit in limits.items()],
        "cost_limits": {name: limit for name, limit in limits.items() if limit is not None},
        "train_cfgs": {"total_steps": steps, "vector_env_nums": pool.num_envs, "threads": threads,
                       "eval_every": eval_every, "checkpoint_every": eval_every, "tensorboard": True},
        "algo_cfgs": {**{key: shown(key, value) for key, value in run.agent.options.items()},
                      "steps_per_epoch": per_epoch},
        "env_cfgs": {key: shown(key, value) for key, value in pool.options.items()},
        "obs_dim": pool.obs_dim, "action_dim": pool.action_dim, "layout_hash": f"{pool.spec.layout_hash:016x}",
        "build": dict(vars(_discovery.build())), **({} if task_text is None else {"task_file": task_text}),
        **own_files.kept(run.options)}


def _note(e: Epoch, folder: _Folder, seconds: float, tested: tuple[float, float], best: Optional[_Score],
          policy: Policy) -> bytes:
    """What a checkpoint holds besides the states: a line of JSON, then the best policy."""
    said: dict[str, Any] = {"epoch": e.epoch, "env_steps": e.env_steps, "progress_bytes": folder.progress_bytes,
                            "seconds": seconds}
    if best is None:
        return f"{json.dumps(said)}\n".encode()
    said["last"] = list(tested)
    said["best"] = [best.feasible, best.ret, -best.excess]
    return f"{json.dumps(said)}\n".encode() + bytes(policy)


_OWN_SEED = "a run has one seed: [redman.train(..., seed=s) for s in seeds] makes several"


def _steps(steps: float) -> int:
    """A whole number of control steps; 1e6 is accepted too."""
    try:
        goal = int(steps)
    except TypeError:
        raise UsageError(f"steps: a number, not {steps!r}") from None
    except (ValueError, OverflowError):
        goal = 0
    if not 1 <= goal <= _MOST_STEPS or goal != steps:
        raise ArgumentError(f"steps: {steps} is not a whole number from 1 to 2^53")
    return goal


@keywords(aliases={"num_envs": "envs", "cost_limit": "cost_limits", "total_steps": "steps", "total_timesteps": "steps",
                   "num_threads": "threads"},
          hints={"resume": "Python does not resume a run; the command `redman train --resume FOLDER` does",
                 "seeds": _OWN_SEED, "env_id": "task=...", "env": "task=..."}, options=True)
def train(task: _discovery.TaskName, algo: str = "ppo_lag", steps: float = 1e6, seed: int = 0, envs: int = 64,
          threads: int = 0, options: Optional[Options] = None, cost_limits: CostLimits = None,
          out: Union[None, str, os.PathLike[str]] = None, callback: Optional[Callback] = None, eval_every: int = 10,
          progress: bool = True, overwrite: bool = False,
          task_file: Union[None, str, os.PathLike[str]] = None) -> Run:
    """Trains a policy on a task: the policy of `redman train` with the same arguments, to the byte.

    steps: control steps of all worlds together, rounded up to whole epochs (a line on stderr says so). options: those of the
    task and of the algorithm. Every eval_every epochs the policy is evaluated on twenty episodes, and on eighty more if
    these look good, to decide which policy is kept: the best within the limits, else the one nearest to them.
    callback(epoch) is called after each epoch; a true result ends the run. The first Ctrl-C ends it after this epoch and
    returns what has been learned; the second ends it at once.

    out: a run folder to write, which `redman eval`, `plot`, `report` and `train --resume` can read, with the curve for
    TensorBoard; Python itself does not resume a run. task may be a .task file, and options may have files of robots and
    objects: their texts are kept in the folder, so that it is complete. task_file: the .task file of a task that was
    registered in another way.
    """
    goal = _steps(steps)
    if task_file is None and is_file("task", task):
        task_file = task  # type: ignore[assignment]
    task = _discovery.task_name(task)
    whole(eval_every, "eval_every", 1, (1 << 31) - 1)
    if not hasattr(seed, "__index__"):
        raise UsageError(f"seed: a whole number, not {seed!r}; {_OWN_SEED}")
    whole(seed, "seed", 0, (1 << 64) - 1)
    whole(envs, "envs", 1, (1 << 31) - 1)
    whole(threads, "threads", 0, (1 << 31) - 1)
    task_text = None if task_file is None else read_whole(task_file, "task file", MOST_TASK).decode(errors="replace")
    asked: dict[str, Given] = dict(options or {})
    for key in [key for key in asked if _folded(key) == "cost_limit"]:
        limit = float(asked.pop(key))  # type: ignore[arg-type]
        cost_limits = limit if cost_limits is None else cost_limits
    of_task, of_algo = split_options(task, algo, asked)
    of_task = named_options(of_task)
    pool = Pool(task, envs, seed, threads, options=of_task)
    agent = Agent(pool, algo, seed, threads, of_algo, cost_limits)
    magnitudes = learns_magnitudes(agent)
    judge = Pool(task, _SELECTION_EPISODES, seed, threads, autoreset="off",
                 options=singly(of_task) if magnitudes else of_task)
    run = Run(pool.task.name, agent.algo.name, seed, of_task, agent)
    settings = agent.options
    per_epoch = envs * int(settings["horizon"]) * int(settings["action_repeat"])
    pool.reset()
    if "total_epochs" not in map(_folded, of_algo):  # a rate that falls to 0 does so over this run
        agent.set(total_epochs=max(1, math.ceil(goal / per_epoch)))
    limits = agent.cost_limits
    counted = limits if _handles_costs(run.algo, pool.cost_dim) else [None] * len(limits)
    first_seed = seed * _SELECTION_EPISODES * (1 + _CONFIRMATIONS)
    names = list(pool.costs)
    meter = _Meter(goal, per_epoch) if progress else None
    best: Optional[_Score] = None
    tested = (math.nan, math.nan)
    epoch: Optional[Epoch] = None

    def played(policy: Policy, number: int) -> list[dict[str, Any]]:
        first = first_seed + number * _SELECTION_EPISODES
        judge.reset([1 << 63 | (first + i) % (1 << 63) for i in range(_SELECTION_EPISODES)])
        return play(judge, policy, _SELECTION_EPISODES, magnitudes)

    def looked_at(policy: Policy, numbers: range) -> Evaluation:
        before = judge.stats.violations
        episodes = [e for number in numbers for e in played(policy, number)]
        return summary(episodes, counted, judge.stats.violations - before)

    def compete(policy: Policy) -> tuple[float, float]:
        """Evaluates the policy, keeps it if it is better than the best so far, and returns the result."""
        nonlocal best
        look = looked_at(policy, range(1))
        if best is None or _score(look) > best:
            score = _score(looked_at(policy, range(1, 1 + _CONFIRMATIONS)))
            if best is None or score > best:
                best, run.policy = score, policy
        return look.return_mean, look.cost_mean[0] if look.cost_mean else 0.0

    with contextlib.ExitStack() as stack:
        stack.enter_context(judge)
        stack.enter_context(pool)
        folder = None if out is None else _Folder(out, overwrite)
        if folder:
            stack.callback(folder.close)
            run.folder = folder.path
            run.policy = run._own(run.policy)
            blank = _row(Epoch(_abi.rdm_epoch()), names, limits, 0, tested, (1.0, 0.0, 0.0))
            folder.begin(_config(run, pool, of_task, of_algo, goal, threads, eval_every, per_epoch, task_text),
                         ",".join(blank),
                         bytes(run.policy))
        heard = stack.enter_context(_ends_after_epoch())
        stopped = False
        while run.env_steps < goal and not stopped:
            began = time.perf_counter()
            epoch = agent.rollout(pool)
            learned = time.perf_counter() - began
            evaluated = 0.0
            if epoch.epoch % eval_every == 0:
                kept = run.policy
                tested = compete(run._own(agent.policy()))
                if folder and run.policy is not kept:
                    folder.write("policy.rdm", bytes(run.policy))
                evaluated = time.perf_counter() - began - learned
            run.seconds += time.perf_counter() - began
            row = _row(epoch, names, limits, epoch.env_steps - run.env_steps, tested, (learned, evaluated, run.seconds))
            run.env_steps = epoch.env_steps
            for name, value in row.items():
                run._rows.setdefault(name, []).append(value)
            stopped = bool(heard) or bool(callback and callback(epoch))
            if folder:
                folder.append(",".join("nan" if math.isnan(value) else f"{value:.9g}" for value in row.values()))
                if epoch.epoch % eval_every == 0 or stopped or run.env_steps >= goal:
                    agent.write_checkpoint(folder.path / "checkpoint.rdm", pool,
                                           _note(epoch, folder, run.seconds, tested, best, run.policy))
            if meter:
                meter.show(epoch)
        run.interrupted = run.env_steps < goal
        if meter:
            meter.end(run)
        if epoch and epoch.epoch % eval_every:
            compete(run._own(agent.policy()))
        if folder:
            folder.write("policy.rdm", bytes(run.policy))
    return run
