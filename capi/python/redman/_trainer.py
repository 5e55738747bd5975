"""One training run: its epochs, evaluations, best policy so far and checkpoints, and how it is resumed. Follows `redman train`
step for step (examples/redman/run/trainer.cpp)."""
from __future__ import annotations

import contextlib
import ctypes
import math
import signal
import threading
import time
import weakref
from ctypes import byref
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Iterator, Mapping, Optional, Sequence

import numpy as np

from . import _abi, _discovery, _own_files as own_files
from ._abi import OptionKind
from ._agent import Agent, Epoch
from ._error import ArgumentError, FormatError, NotFoundError, StateError, UnsupportedError, UsageError
from ._library import check, encoded, lib
from ._limits import CostLimits, each_cost
from ._meter import Meter
from ._names import folded, nearest
from ._options import Given, Options, Value, settings_texts, shown
from ._own_costs import Own
from ._paths import named_options
from ._play import play, singly
from ._policy import Origin, Policy
from ._pool import Pool
from ._ranks import Ranks
from ._rows import Array
from ._run_folder import Note, RunFolder, Score, Tested, Times, progress_row
from ._shield import Shield
from ._teacher import Teach, imitates_of
from .callbacks import Calls, Training

if TYPE_CHECKING:
    from ._run import Run

# Of an evaluation during training; a policy that looks better than the best so far plays as many again
# _CONFIRMATIONS times, and those alone say whether it is.
_SELECTION_EPISODES, _CONFIRMATIONS = 20, 4
_LOST = 2 | 4 | 8  # bits of an episode's status that make it no measurement
_WORLDS_SEED = 7_000_000  # worlds that Training.set made draw from the run's seed + this + the epoch

Pairs = Sequence["tuple[str, Value]"]


@dataclass
class Settings:
    """All settings of a run."""

    task: str
    algo: str
    seed: int
    envs: int
    threads: int
    steps: int
    of_task: list[tuple[str, Value]]  # options, in their order; the last of a key counts
    of_algo: list[tuple[str, Value]]
    limits: list[str]  # LIMIT of column 0, or NAME=LIMIT
    eval_every: int = 10
    checkpoint_every: int = 10
    events: bool = True
    task_text: Optional[str] = None  # of a .task file
    task_class: Optional[str] = None  # import path of a task in Python
    teach: Optional[Teach] = None
    shield: str = "off"  # as the command's --shield has it
    own: Optional[Own] = None
    out: str = ""  # the run folder, "": none
    kept: dict[str, Any] = field(default_factory=dict)  # members of the config.json that a run goes on from

    @property
    def options(self) -> dict[str, Value]:
        """The options of the task."""
        return dict(self.of_task)


def limit_texts(wanted: CostLimits, columns: Sequence[str]) -> list[str]:
    """The limits as the command takes them in --cost-limit."""
    if wanted is None:
        return []
    listed = each_cost(wanted, [-1.0] * len(columns), columns, "cost_limits") or []
    if isinstance(wanted, Mapping):
        return [f"{name}={shown(name, listed[columns.index(name)])}" for name in wanted]
    if isinstance(wanted, (int, float, np.number)):
        return [shown("cost_limits", listed[0])]
    return [f"{name}={shown(name, limit)}" for name, limit in zip(columns, listed)]


def _limits_of(texts: Sequence[str], columns: Sequence[str]) -> dict[str, Optional[float]]:
    out: dict[str, Optional[float]] = {}
    for text in texts:
        name, equals, number = text.rpartition("=")
        name = name if equals else columns[0]
        found = [column for column in columns if folded(column) == folded(name)]
        out[found[0] if found else name] = float(number)
    return out


def split_options(task: str, algo: str, options: Options) -> tuple[list[tuple[str, Value]], list[tuple[str, Value]]]:
    """Splits options into those of the task and those of the algorithm. If both have an option, such as preset, the value decides:
    it goes to the one that has this word. action_repeat goes to the algorithm, since a pool that repeats actions would only show
    less of its worlds."""
    tables = (_discovery.task(task).options, _discovery.algo(algo).options)
    known, of_algo = ({folded(key) for key in table} for table in tables)
    kinds = {key: option.kind for table in tables for key, option in table.items()}

    def plain(key: str, value: Given) -> Value:
        return shown(key, value, kinds) if isinstance(value, (list, tuple, np.ndarray)) else value  # type: ignore[return-value]

    def has(i: int, key: str) -> bool:
        return folded(key) in (known, of_algo)[i] or i == 0 and folded(key.split(".", 1)[0] + ".FIELD") in known

    def takes(i: int, key: str) -> bool:
        option = next((option for name, option in tables[i].items() if folded(name) == folded(key)), None)
        if option is None or option.kind != OptionKind.TEXT or not option.choices:
            return True
        return folded(str(options[key])) in {folded(word) for word in option.choices.split("|")}

    def is_of(i: int, key: str) -> bool:
        if not (has(0, key) and has(1, key)):
            return has(i, key)
        if folded(key) == "action_repeat":
            return i == 1
        return takes(i, key) or not takes(1 - i, key)

    for key in options:
        if not has(0, key) and not has(1, key):
            others = [name for name, info in _discovery.algos().items() if folded(key) in {folded(other) for other in info.options}]
            raise NotFoundError(f"option {key}: neither task {task} nor algorithm {algo} has it" +
                                (f"; algorithm {others[0]} has" if others else nearest(key, sorted(known | of_algo))))
    return ([(key, plain(key, value)) for key, value in options.items() if is_of(0, key)],
            [(key, plain(key, value)) for key, value in options.items() if is_of(1, key)])


def learns_magnitudes(agent: Agent) -> bool:
    """Whether its costs are sums of cost_raw, with limits in that unit."""
    return agent.options["cost_signal"] == "raw"


def shield_word(wanted: Any) -> str:
    """The argument shield of train as the command takes it in --shield."""
    if wanted is None or wanted is False:
        return "off"
    if wanted is True:
        return "predict"
    if isinstance(wanted, str):
        return wanted
    if not isinstance(wanted, Mapping):
        raise UsageError(f"shield: it must be True, a dict of options, or a word such as \"project\", not {wanted!r}")
    options = dict(wanted)
    for name in ("budgets", "seed", "threads"):
        if name in options:
            raise UnsupportedError(f"shield: train does not take {name}: set agent.shield = redman.Shield(pool, {name}=...) and call "
                                   "agent.rollout")
    word = "predict" if options.pop("predict", True) else "project"
    return word + ":" * bool(options) + ",".join(f"{key}={shown(key, value)}" for key, value in options.items())


def _shield_options(word: str) -> dict[str, Value]:
    """The options of a shield for a word other than off. In training, what no plan avoids happens and is counted."""
    kind, _, rest = word.partition(":")
    if folded(kind) not in ("project", "predict"):
        raise UsageError(f"shield: {word!r} is no shield{nearest(kind, ('off', 'project', 'predict'))}; there are off, project "
                         "and predict[:key=value,...]")
    options: dict[str, Value] = {"unproven": "least", "predict": folded(kind) == "predict"}
    for item in filter(None, rest.split(",")):
        key, equals, value = item.partition("=")
        if not equals:
            raise UsageError(f"shield: {item!r} is not key=value")
        options[key] = value
    return options


def _handles_costs(algo: str, columns: int) -> bool:
    """Whether the algorithm handles costs: such an algorithm refuses to work without a limit."""
    config = _abi.rdm_agent_config()
    check(lib.rdm_agent_config_init(byref(config), ctypes.sizeof(config)))
    none = np.full(columns, -1.0)
    config.obs_dim = config.action_dim = config.num_envs = 1
    config.cost_dim, config.algo, config.cost_limits = columns, encoded(algo, "algo"), none.ctypes.data
    size = ctypes.c_size_t()
    return bool(lib.rdm_agent_config_memory(byref(config), byref(size)))


def _sum(values: Array) -> float:
    """The sum in the order of the rows, as the command computes it."""
    return float(np.cumsum(values, dtype=np.float64)[-1])


@dataclass
class _Look:
    """Means over the episodes that a policy is chosen by."""

    ret: float
    costs: list[float]
    errors: list[float]  # standard errors of the latter
    lost: bool  # an episode was no measurement


def _looked_at(played: Sequence[Mapping[str, Any]], columns: int) -> _Look:
    sound = [e for e in played if not e["status"] & _LOST]
    n, lost = len(sound), len(sound) < len(played)
    if n < 1:
        return _Look(math.nan, [math.nan] * columns, [math.nan] * columns, lost)
    costs, errors = [], []
    for k in range(columns):
        values = np.array([e["cost"][k] for e in sound], np.float64)
        mean = _sum(values) / n
        deviation = math.sqrt(_sum((values - mean) * (values - mean)) / n)
        costs.append(mean)
        errors.append(deviation / math.sqrt(n - 1) if n > 1 else math.nan)
    return _Look(_sum(np.array([e["return"] for e in sound])) / n, costs, errors, lost)


def _score(look: _Look, limits: Sequence[Optional[float]]) -> Score:
    """A cost counts as its mean plus a standard error, since the best of many noisy evaluations is usually one that was
    lucky."""
    if look.lost:
        return Score(False, -math.inf, look.ret)
    feasible, excess = True, 0.0
    for mean, error, limit in zip(look.costs, look.errors, limits):
        if limit is not None:
            over = mean + error - limit
            feasible = feasible and over <= 0
            excess += max(0.0, over) / max(limit, 1.0)
    return Score(feasible, -excess, look.ret)


def _better(score: Score, other: Score) -> bool:
    if score.feasible != other.feasible:
        return score.feasible
    return score.ret > other.ret if score.feasible else score.excess > other.excess


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


class Trainer(Training):
    """The worlds and the learner of a run, and the worlds that its policies are evaluated in."""

    settings: Settings
    cost_names: list[str]
    limits: list[Optional[float]]

    def __init__(self, settings: Settings, ranks: Optional[Ranks] = None) -> None:
        self.settings, self._ranks = settings, ranks
        self.steps = settings.steps
        s = settings
        if ranks is not None and s.envs % ranks.ranks:
            raise ArgumentError(f"ranks: {ranks.ranks} does not divide the number of worlds, {s.envs}")
        if ranks is not None and (s.own is not None or s.shield != "off"):
            raise UnsupportedError("ranks: costs, rewards and a shield cannot be shared among ranks; train without ranks")
        self._changed: dict[str, str] = {}  # options of the task, by set()
        self._worlds_epoch = 0  # when set() made worlds
        self._pool = self._made_pool(s.options, s.seed)
        if s.own is not None:
            s.own.ready(self._pool)
        names = list(self._pool.cost_names) if s.own is None else s.own.names(self._pool)
        own_costs = None if s.own is None or s.own.costs is None else names
        try:
            self.agent = Agent(self._pool, s.algo, s.seed, s.threads, dict(s.of_algo), _limits_of(s.limits, names) or None,
                               costs=own_costs, ranks=ranks)
        except ArgumentError as error:
            if s.limits or not names or not str(error).startswith("cost_limits"):
                raise
            raise ArgumentError(f"{error}; give cost_limits={{{names[0]!r}: ...}}, or algo='ppo' to record it only") from None
        self._asked = (settings_texts(lib.rdm_agent_get_settings, self.agent._open()),
                       settings_texts(lib.rdm_pool_get_settings, self._pool._open()))
        self.cost_names = names
        self.limits = self._rated(self.agent.cost_limits)
        self._magnitudes = learns_magnitudes(self.agent) and s.own is None
        alone = self._magnitudes or s.own is not None
        self._judge = Pool(s.task, _SELECTION_EPISODES, s.seed, s.threads, autoreset="off",
                           options=singly(s.options) if alone else s.options)
        counts = _handles_costs(self.agent.algo.name, len(names))
        self._counted = self.limits if counts else [None] * len(self.limits)
        self._shield: Optional[Shield] = None
        if s.shield != "off":
            self._add_shield()
        self._note = Note()
        self._folder: Optional[RunFolder] = None
        self._saved_epoch = self._scored_epoch = -1
        self._stop = False

    # ---- what callbacks have

    @property
    def pool(self) -> Pool:
        return self._pool

    def stop(self) -> None:
        self._stop = True

    def set(self, **options: Given) -> None:
        if self._ranks is not None:
            raise UnsupportedError("set: ranks share their options: train without ranks")
        of_task, of_algo = split_options(self.settings.task, self.settings.algo, options)
        of_task = list(named_options(dict(of_task)).items())
        self.agent.set(**dict(of_algo))
        has = settings_texts(lib.rdm_pool_get_settings, self._pool._open())
        others = {folded(key): shown(key, value) for key, value in of_task if not _equal(has.get(folded(key)), shown(key, value))}
        if others:
            self._new_worlds({**self._changed, **others}, self._note.epoch)

    def _new_worlds(self, changed: Mapping[str, str], epoch: int) -> None:
        options = {key: value for key, value in self.settings.options.items() if folded(key) not in changed}
        pool = self._made_pool({**options, **changed}, (self.settings.seed + _WORLDS_SEED + epoch) % (1 << 64))
        same = ("obs_dim", "action_dim", "cost_dim", "layout_hash")
        other = [name for name in same if getattr(pool.spec, name) != getattr(self._pool.spec, name)]
        if other:
            raise ArgumentError(f"set: {', '.join(changed)} would change what the worlds show ({', '.join(other)}), and the "
                                "policy could not read it")
        pool.reset()
        old, self._pool = self._pool, pool
        self._changed, self._worlds_epoch = dict(changed), epoch
        if self.settings.teach is not None and old._starts[0] is not None:
            pool.set_starts(*old._starts)
        if self._shield is not None:
            self._add_shield()
        self.agent._pool = weakref.ref(pool)
        old.close()

    def _made_pool(self, options: Mapping[str, Value], seed: int) -> Pool:
        s, ranks = self.settings, self._ranks
        return Pool(s.task, s.envs // (1 if ranks is None else ranks.ranks), seed, s.threads, options=options, ranks=ranks)

    def _add_shield(self) -> None:
        """Puts the rollouts under a shield, whose first backup is the agent itself."""
        if self.settings.own is not None:
            raise UnsupportedError("shield: it knows only the costs of the task: train with costs of your own without a shield")
        options = _shield_options(self.settings.shield)
        if not options["predict"] and not self._pool.guards:
            raise UsageError("shield: \"project\" needs a task with guards, whose costs depend on the action only; give shield=\"predict\"")
        self._shield = Shield(self._pool, seed=self.settings.seed, options=options,
                              steps=int(self.agent.options["action_repeat"]) // self._pool.spec.action_repeat)
        self.agent.shield = self._shield

    # ---- beginning

    @property
    def per_epoch(self) -> int:
        """The largest number of control steps of an epoch; a world rests from an episode's end to the next decision."""
        options = self.agent.options
        return self.settings.envs * int(options["horizon"]) * int(options["action_repeat"])

    @property
    def first(self) -> bool:
        """Whether this process writes the folder and evaluates: the first rank does."""
        return self._ranks is None or self._ranks.rank == 0

    def prepare(self) -> None:
        if self.settings.teach is not None:
            self.settings.teach.apply(self.agent, self._pool, self.settings.seed)
        elif imitates_of(self.agent):
            raise UsageError("option imitation needs a recording: from_=\"demo.npz\"")
        self._pool.reset()
        self._plan_schedule()

    def _plan_schedule(self) -> None:
        """Lets a rate that falls to 0 do so over this run, unless the caller gave a length or the algorithm has no such rate."""
        if "total_epochs" in self.agent.options and "total_epochs" not in (folded(key) for key, _ in self.settings.of_algo):
            self.agent.set(total_epochs=max(1, math.ceil(self.steps / self.per_epoch)))

    def begin(self, run: Run, folder: Optional[RunFolder], goes_on: bool = False) -> None:
        """Starts the run in its folder, after prepare()."""
        self.run, self._folder = run, folder
        run._policy = self._own(self.agent.policy())
        if folder is not None:
            names = progress_row(Epoch(_abi.rdm_epoch()), self.cost_names, self.limits, 0, Tested(), Times(1, 0, 0))
            folder.begin(self.config(), names, bytes(run.policy), events=self.settings.events, goes_on=goes_on)

    def resume(self, run: Run, folder: Optional[RunFolder], checkpoint: Path) -> None:
        """Continues from the checkpoint, or from the start where there is none. Only the first rank has a folder."""
        if not checkpoint.exists():
            self.prepare()
            return self.begin(run, folder, goes_on=True)
        self.run, self._folder = run, folder
        if self.settings.teach is not None:
            self.settings.teach.again(self.agent, self._pool, self.settings.seed)
        self.restore(checkpoint)
        self._plan_schedule()
        note = self._note
        run.env_steps, run.seconds = note.env_steps, note.seconds
        run._policy = self._own(Policy(note.best_policy) if note.best is not None else self.agent.policy())
        if folder is not None:
            folder.go_on(note.progress_bytes, events=self.settings.events)
            run._read_progress(folder.path)
            folder.write_config(self.config())

    def restore(self, checkpoint: Path) -> None:
        """Reads agent, worlds and note from the checkpoint."""
        def read() -> Note:
            return Note.of(self.agent.read_checkpoint(checkpoint, self._pool))

        try:
            changed = Note.of(self.agent.read_checkpoint(checkpoint)).changed
            if changed:
                self._new_worlds(dict(changed["options"]), int(changed["epoch"]))
            note = read()
            if note.best is not None:
                Policy(note.best_policy).check(self._pool)
            if self._shield is not None:
                if not note.shield:
                    raise FormatError("it has no state of the shield")
                self._shield.set_state(note.shield)
        except (FormatError, StateError, ArgumentError) as error:
            raise type(error)(f"cannot resume from {checkpoint}: {error}") from None
        self._note, self._saved_epoch = note, note.epoch

    def _rated(self, limits: list[Optional[float]]) -> list[Optional[float]]:
        """With option cost_limit_per_step the limit of an episode is that of its control steps: a policy is kept and reported by it."""
        rate = self.agent.options.get("cost_limit_per_step", -1)
        if not limits or float(rate) < 0:
            return limits
        given = [text for text in self.settings.limits if "=" not in text or folded(text.split("=", 1)[0]) == folded(self.cost_names[0])]
        if given:
            raise UsageError(f"cost_limits={given[0]} and cost_limit_per_step={rate}: both are limits on the first cost; give one")
        return [float(rate) * self._pool.spec.max_steps, *limits[1:]]

    def config(self) -> dict[str, Any]:
        """The members of config.json: the settings of the run, with all defaults written out."""
        s, pool, agent = self.settings, self._pool, self.agent
        named = dict(zip(self.cost_names, self.limits))
        build = vars(_discovery.build())
        now = settings_texts(lib.rdm_agent_get_settings, agent._open())
        out: dict[str, Any] = {
            "exp_name": f"{s.task}-{s.algo}-seed-{s.seed}", "task": s.task, "algo": s.algo, "seed": s.seed,
            "set": [f"{key}={shown(key, value)}" for key, value in s.of_task],
            "set_algo": [f"{key}={shown(key, value)}" for key, value in s.of_algo],
            "set_cost_limit": s.limits,
            "cost_limits": {name: float(limit) for name, limit in named.items() if limit is not None},
            "train_cfgs": {"total_steps": s.steps, "vector_env_nums": s.envs, "threads": s.threads, "eval_every": s.eval_every,
                           "checkpoint_every": s.checkpoint_every, "tensorboard": s.events},
            "algo_cfgs": {**self._asked[0], **{key: now[key] for key in ("total_epochs",) if key in now}, "steps_per_epoch": self.per_epoch},
            "env_cfgs": self._asked[1],
            "obs_dim": pool.obs_dim, "action_dim": pool.action_dim, "layout_hash": f"{pool.spec.layout_hash:016x}",
            "build": {name: build[name] for name in ("version", "abi", "ode", "eigen", "ccd", "octomap", "precision", "compiler",
                                                     "kernels", "differs")}}
        if self._shield is not None:
            out["train_cfgs"]["shield"] = s.shield
            out["shield_cfgs"] = settings_texts(lib.rdm_shield_get_settings, self._shield._open())
        if s.kept.get("plugins"):
            out["plugins"] = s.kept["plugins"]
        if s.task_text is not None:
            out["task_file"] = s.task_text
        out.update(own_files.kept(s.options))
        for member in ("robot_files", "object_files"):
            if member in s.kept:
                out[member] = s.kept[member]
        if s.teach is not None:
            out["teach_cfgs"] = s.teach.config()
        if s.task_class is not None:
            out["task_class"] = s.task_class
        if s.own is not None:
            out.update(s.own.config())
        return out

    def _own(self, policy: Policy) -> Policy:
        """The policy with the settings to evaluate it by."""
        limits = {name: limit for name, limit in zip(self.cost_names, self.limits) if limit is not None}
        policy._word = self.settings.algo
        policy.origin = Origin(self.settings.task, self.settings.options, limits, self._magnitudes,
                               None if self.run.folder is None else str(self.run.folder), self.settings.own)
        return policy

    # ---- epochs

    def go(self, calls: Calls, progress: bool, time_budget: Optional[float]) -> bool:
        """Runs epochs until the steps are done or a callback, a signal or the clock ends them, then writes the last checkpoint
        and policy.rdm. Returns whether a signal ended the run."""
        run, began = self.run, time.monotonic()
        meter = Meter(run.env_steps, self.steps, self.per_epoch) if progress and self.first else None
        with _ends_after_epoch() as heard:
            try:
                if self.first and calls.on_begin(self):
                    self.stop()
                while run.env_steps < self.steps and not self._ended(heard, began, time_budget):
                    epoch = self._epoch()
                    if self.first:
                        if calls.on_epoch(epoch, self):
                            self.stop()
                        if self._note.epoch % self.settings.checkpoint_every == 0:
                            self._save()
                    elif self._note.epoch % self.settings.checkpoint_every == 0:
                        self._save()
                    if meter:
                        meter.show(epoch)
                if self._saved_epoch != self._note.epoch:
                    self._save()
            finally:
                if self.first:
                    calls.on_end(self)
        run.interrupted = run.env_steps < self.steps
        if meter:
            meter.end(run)
        self._finish()
        return bool(heard)

    def _ended(self, heard: Sequence[int], began: float, time_budget: Optional[float]) -> bool:
        late = time_budget is not None and time.monotonic() - began >= time_budget
        ended = self._stop or bool(heard) or late
        return ended if self._ranks is None else self._ranks._any(ended)

    def _epoch(self) -> Epoch:
        began, run, note, s = time.perf_counter(), self.run, self._note, self.settings
        if s.teach is not None:
            s.teach.draw_starts(self._pool, min(1.0, note.env_steps / s.steps))
        epoch = self.agent.rollout(self._pool) if s.own is None else s.own.rollout(self.agent, self._pool)
        learned = time.perf_counter() - began
        steps, evaluated = epoch.env_steps - note.env_steps, 0.0
        note.env_steps, note.epoch = epoch.env_steps, epoch.epoch
        if self.first and note.epoch % s.eval_every == 0:
            policy = self._own(self.agent.policy())
            won, note.last = self._compete(policy)
            self._scored_epoch = note.epoch
            if won and self._folder is not None:
                self._folder.write("policy.rdm", note.best_policy)
            evaluated = time.perf_counter() - began - learned
        note.seconds += time.perf_counter() - began
        run.env_steps, run.seconds = note.env_steps, note.seconds
        self.row = progress_row(epoch, self.cost_names, self.limits, steps, note.last, Times(learned, evaluated, note.seconds))
        for name, value in self.row.items():
            run._rows.setdefault(name, []).append(value)
        if self._folder is not None:
            self._folder.append(self.row)
            note.progress_bytes = self._folder.progress_bytes
        return epoch

    def _played(self, policy: Policy, number: int) -> list[dict[str, Any]]:
        """Plays episodes of one round. All policies play round 0; those that look good play the other rounds too."""
        first = self.settings.seed * _SELECTION_EPISODES * (1 + _CONFIRMATIONS) + number * _SELECTION_EPISODES
        self._judge.reset([1 << 63 | (first + i) % (1 << 63) for i in range(_SELECTION_EPISODES)])
        return play(self._judge, policy, _SELECTION_EPISODES, self._magnitudes, own=self.settings.own)

    def _compete(self, policy: Policy) -> tuple[bool, Tested]:
        """Evaluates a policy and keeps it if it is better than the best so far. Returns whether it is, and the first result."""
        note, columns = self._note, len(self.cost_names)
        look = _looked_at(self._played(policy, 0), columns)
        tested = Tested(look.ret, look.costs[0] if columns else 0.0)
        if look.lost or (note.best is not None and not _better(_score(look, self._counted), note.best)):
            return False, tested
        rest = [e for number in range(1, 1 + _CONFIRMATIONS) for e in self._played(policy, number)]
        confirmed = _looked_at(rest, columns)
        score = _score(confirmed, self._counted)
        if confirmed.lost or (note.best is not None and not _better(score, note.best)):
            return False, tested
        note.best, note.best_policy, self.run._policy = score, bytes(policy), policy
        return True, tested

    def _save(self) -> None:
        note = self._note
        self._saved_epoch = note.epoch
        if not self.settings.out:
            return
        if not self.first:  # its part of what the first one writes
            check(lib.rdm_checkpoint_write(b"", self.agent._open(), self._pool._open(), None, 0))
            return
        assert self._folder is not None
        self._folder.check()
        if self._shield is not None:
            note.shield = self._shield.state()
        note.changed = {"options": self._changed, "epoch": self._worlds_epoch} if self._changed else {}
        self.agent.write_checkpoint(self._folder.checkpoint, self._pool, bytes(note))

    def _finish(self) -> None:
        """Compares the last policy too, without a trace in the checkpoint: a run that is resumed later must not depend on where
        it was stopped."""
        note = self._note
        if not self.first:
            self.run._policy = self._own(self.agent.policy())
        if note.epoch == 0 or not self.first:
            return
        if self._scored_epoch != note.epoch:
            self._compete(self._own(self.agent.policy()))
        if note.best is None:
            self.run._policy = self._own(self.agent.policy())
        if self._folder is not None:
            self._folder.write("policy.rdm", bytes(self.run.policy))

    def close(self) -> None:
        self._judge.close()
        self._pool.close()


def _equal(text: Optional[str], other: str) -> bool:
    if text == other:
        return True
    try:
        return text is not None and float(text) == float(other)
    except ValueError:
        return False
