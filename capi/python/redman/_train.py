"""train: a complete training run, with the run folder of the command-line tool."""
from __future__ import annotations

import contextlib
import inspect
import math
import os
import tempfile
import warnings
from itertools import product
from pathlib import Path
from typing import Any, List, Mapping, Optional, Sequence, Tuple, TypeVar, Union, overload

from . import _discovery, _taught
from ._curve import settings_of
from ._error import ArgumentError, FormatError, UnsupportedError, UsageError
from ._files import MOST_TASK, as_path, read_whole
from ._imported import path_of
from ._library import all_cores, encoded, flag, real, whole
from ._limits import CostLimits
from ._names import folded, keywords
from ._options import Given, Options, Value, as_dict
from ._own_costs import Costs, Own, RowFunction
from ._own_files import load_kept
from ._paths import is_file, named_options
from ._policy import Policy, load_task_class
from ._ranks import Ranks
from ._recording import Recording
from ._run import Run
from ._run_folder import FolderPath, RunFolder, read_config
from ._shield import Shielding
from ._teacher import Teach, Teacher, eyes_of
from ._trainer import Settings, Trainer, limit_texts, shield_word, split_options
from .callbacks import Callbacks, Calls, View

_MOST_STEPS = 1 << 53  # what a float counts exactly
T = TypeVar("T")
Many = Union[List[T], Tuple[T, ...]]  # of which each makes a run


def _steps(steps: float) -> int:
    """A whole number of control steps; 1e6 is accepted too."""
    try:
        goal = int(steps)
    except TypeError:
        raise UsageError(f"steps: it must be a number, not {steps!r}") from None
    except (ValueError, OverflowError):
        goal = 0
    if not 1 <= goal <= _MOST_STEPS or goal != steps:
        raise ArgumentError(f"steps: {steps} is not a whole number from 1 to 2^53")
    return goal


def _seed(seed: Any) -> int:
    if not hasattr(seed, "__index__"):
        raise UsageError(f"seed: it must be a whole number, or a list of whole numbers for several runs, not {seed!r}")
    return whole(seed, "seed", 0, (1 << 64) - 1)


def _is_many(value: Any) -> bool:
    return isinstance(value, (list, tuple, range, set, frozenset))


_taken: Any = keywords(  # its type has no arguments that are options
    aliases={
        "num_envs": "envs", "n_envs": "envs", "num_threads": "threads", "total_steps": "steps", "total_timesteps": "steps",
        "cost_limit": "cost_limits", "env_id": "task", "env": "task", "tasks": "task", "algos": "algo", "seeds": "seed",
        "callbacks": "callback", "time_limit": "time_budget", "max_seconds": "time_budget", "from": "from_",
        "demonstrations": "from_", "out_dir": "out", "log_dir": "out", "save_freq": "checkpoint_every", "eval_freq": "eval_every",
        "verbose": "progress", "progress_bar": "progress", "rewards": "reward", "cost": "costs"},
    hints={
        "model": "from_=policy begins with its network; algo=... is the algorithm",
        "policy": "from_=policy begins with its network; hidden=[64, 64] are the widths of layers",
        "policy_kwargs": "hidden=[64, 64] are the widths of layers", "device": "there is one, the processor: threads=...",
        "tensorboard_log": "out=\"runs/first\": a run folder has its curve for TensorBoard",
        "logger": "callback=redman.callbacks.WandB(project=...), MLflow(...), TensorBoard(folder)",
        "custom_cfgs": "options={...}, or its keys as arguments", "config": "options={...}, or its keys as arguments"},
    options=True)


@overload
def train(task: Optional[_discovery.TaskName] = ..., algo: str = ..., steps: Optional[float] = ..., seed: int = ...,
          envs: int = ..., threads: Optional[int] = ..., options: Optional[Options] = ..., cost_limits: CostLimits = ...,
          out: Optional[FolderPath] = ..., callback: Callbacks = ..., eval_every: int = ..., progress: bool = ...,
          overwrite: bool = ..., task_file: Optional[FolderPath] = ..., *, checkpoint_every: int = ..., tensorboard: bool = ...,
          resume: Optional[FolderPath] = ..., from_: Teacher = ..., teach: Optional[Mapping[str, Any]] = ...,
          time_budget: Optional[float] = ..., shield: Union[Shielding, str] = ..., reward: Optional[RowFunction] = ...,
          costs: Optional[Costs] = ..., ranks: Union[None, Ranks, int, str] = ..., view: bool = ..., **keyword_options: Any) -> Run: ...


@overload
def train(task: Many[_discovery.TaskName], algo: Union[str, Many[str]] = ..., steps: Optional[float] = ...,
          seed: Union[int, Many[int], range] = ..., **settings: Any) -> List[Run]: ...


@overload
def train(task: _discovery.TaskName, algo: Many[str], steps: Optional[float] = ..., seed: Union[int, Many[int], range] = ...,
          **settings: Any) -> List[Run]: ...


@overload
def train(task: _discovery.TaskName, algo: str = ..., steps: Optional[float] = ..., *, seed: Union[Many[int], range],
          **settings: Any) -> List[Run]: ...


@_taken  # type: ignore[misc]
def train(task: Any = None, algo: Any = "ppo_lag", steps: Optional[float] = None, seed: Any = 0, envs: int = 64,
          threads: Optional[int] = None, options: Optional[Options] = None, cost_limits: CostLimits = None,
          out: Optional[FolderPath] = None, callback: Callbacks = None, eval_every: int = 10, progress: bool = True,
          overwrite: bool = False, task_file: Optional[FolderPath] = None, *, checkpoint_every: int = 10,
          tensorboard: bool = True, resume: Any = None, from_: Teacher = None, teach: Optional[Mapping[str, Any]] = None,
          time_budget: Optional[float] = None, shield: Union[Shielding, str] = None, reward: Optional[RowFunction] = None,
          costs: Optional[Costs] = None, ranks: Union[None, Ranks, int, str] = None, view: bool = False) -> Any:
    """Trains a policy on a task, as `redman train` does: the same arguments give the same bytes in the same files.

        run = redman.train("hand_over_safe_finger", steps=1e6, seed=1, out="runs/first")
        run = redman.train("ball_run", algo="cpo", max_steps=200, learning_rate=1e-3, cost_limits=25)
        run = redman.train(resume="runs/first", steps=2e6)
        runs = redman.train(["grasp", "jenga"], seed=range(5), out="runs")          # a list of ten runs

    It returns a redman.Run: the best policy, the curve and the learner. A wrong argument raises an error before anything is
    learned or written.

    task: a name (redman.tasks()), an id of its environments (redman/BallRun-v0), a .task file, or a class of your own (redman.Task).
    algo: the name of a learner (redman.algos()). steps: control steps of all worlds together, 1 to 2^53, rounded up to whole
    epochs (a line on stderr says so); None: 1e6. seed: 0 to 2^64 - 1. envs: worlds that are stepped side by side, 1 or more;
    another number gives another run. threads: None uses all cores that this process may use; the bytes are the same for any
    number. options: those of the task and of the algorithm, as a dict or as arguments; redman.task(name).options and
    redman.algo(name).options have them with their bounds.

    time_budget: seconds after which the present epoch is the last one; None: no bound. progress: shows a line for the present
    epoch on stderr. The first Ctrl-C ends the run after its epoch and returns what has been learned; the second ends it at once.

    cost_limits: limits on the sum of each cost over an episode: a number for the first cost, a list with one for each, or a
    dict by name; None: those of the task. Every eval_every epochs, 1 or more, the policy is evaluated on twenty episodes, and
    on eighty more if these look good, to decide which policy is kept: the best within the limits, else the one nearest to them.

    reward, costs: functions of your own that replace the task's reward and costs. Each takes a redman.Rows, which has the
    rows of all worlds after a control step, and returns one number or flag for each world.

        run = redman.train("ball_run", costs={"fast": lambda rows: rows.speed("velocity") > 2}, cost_limits=20)

    costs is a dict by name, or a function or a list of them, which go by their own names. In a dict, the name of a cost of the
    task instead of a function keeps that cost. The limits, the choice of the policy, run.evaluate and the curve then refer to
    these functions. evaluate(folder) and resume import the functions of a module, and the class of a task, by their import
    paths; lambdas must be given again.

    out: a run folder to write, which `redman eval`, `plot`, `report` and `train --resume` can read, with the curve for
    TensorBoard (tensorboard=False leaves it out). overwrite: replaces a run that is there. checkpoint_every: epochs from one
    checkpoint to the next. The texts of a .task file and of robots and objects of your own are kept in the folder, so that it
    is complete. task_file: the .task file of a task that was registered in another way. resume: a run folder, also one of the
    command, to continue as if the run had never been interrupted. Its settings are those of the folder; steps, threads,
    time_budget, callback, progress and the functions may be given.

    from_: where the policy starts. A policy, its file or run folder, or "trained" gives the network; options of the task
    that its run had are used unless others are given. A recording or its file (.npz) is imitated first, and so is a script
    of demonstrations: "demo" for the task's own, or a .demo file. Algorithms with a replay memory (td3, sac and what is made
    of them) cannot begin with a teacher.

    teach: how the teacher is imitated, a dict. success_only (False): leaves out episodes without success. clone_epochs (20):
    passes over the rows. clone_patience (0): ends after this many epochs without a better validation loss; 0: never.
    clone_rate (1e-3): the learning rate. validation (0.1): the share of rows that is held back. start_share (0): the share of
    episodes that begin at a state of the recording, 0 to 1, or a pair for the begin and the end of the run. Of teachers that
    act: decisions (640): how many are recorded in each world. noise (0.05): mean standard deviation of what is added to their
    actions. dagger (0): rounds in which the policy acts and the teacher labels; the teacher may then be a policy. beta (0.5):
    the teacher takes a share beta^k of the decisions of round k. pretrain (0): clouds of points that an encoder learns from
    first; pretrain_epochs (10): passes over them. Teachers that act need the command redman, which does the teaching and the
    first epoch.

    callback: a function of the epoch or of (epoch, training), an object of redman.callbacks, or a list of these. A true
    result ends the run; training.set(...) changes options. shield: a redman.Shield checks every decision; True, a dict of
    its options, "predict" (as True) or "project". ranks: this process is one of several that learn as one (redman.Ranks): each of them calls
    train with the same arguments, envs is the number of worlds of all, and the first rank writes and evaluates. view: a
    window in the browser shows the policy as it is after each epoch (redman.callbacks.View).

    A list of tasks, algorithms or seeds makes one run for each combination and returns a list. out is then the folder that
    holds their folders, ALGO-{TASK}/seed-N.
    """
    arguments = dict(locals())
    for name in ("progress", "overwrite", "tensorboard", "view"):
        arguments[name] = bool(flag(arguments[name], name))
    for name in ("out", "task_file"):
        if arguments[name] is not None:
            arguments[name] = os.fsdecode(encoded(arguments[name], name))
    if any(map(_is_many, (task, algo, seed, resume))):
        return _several(arguments)
    return _one(arguments)[0]


def _several(arguments: dict[str, Any]) -> list[Run]:
    """Makes one run for each combination. Ctrl-C ends the present run and skips the others."""
    axes = {name: list(arguments[name]) if _is_many(arguments[name]) else [arguments[name]]
            for name in ("task", "algo", "seed", "resume")}
    if any(not values for values in axes.values()):
        raise ArgumentError("train: a list is empty: there is nothing to train")
    for name, values in axes.items():  # a run that is asked for twice is no second sample
        named = [folded(value) if isinstance(value, str) else value for value in values]
        if any(named.index(value) < i for i, value in enumerate(named)):
            raise UsageError(f"train: {name} {values}: one of them is given twice")
    runs = []
    for chosen in product(*axes.values()):
        one = {**arguments, **dict(zip(axes, chosen))}
        if arguments["out"] is not None:
            name, algo = _discovery.task(one["task"]).name, _discovery.algo(one["algo"]).name
            one["out"] = Path(arguments["out"]) / f"{algo}-{{{name}}}" / f"seed-{_seed(one['seed']):03}"
        run, heard = _one(one)
        runs.append(run)
        if heard:
            break
    return runs


def _one(given: dict[str, Any]) -> tuple[Run, bool]:
    """Makes one run; returns it and whether a signal ended it."""
    calls = Calls(given["callback"], [View()] if given["view"] else [])
    ranks, budget = _ranks(given["ranks"]), None if given["time_budget"] is None else real(given["time_budget"], "time_budget")
    if budget is not None and not budget > 0:
        raise ArgumentError(f"time_budget: {budget} is not above 0 s")
    held = contextlib.ExitStack()
    try:
        return _held_one(given, calls, ranks, budget, held)
    finally:
        held.close()


def _held_one(given: dict[str, Any], calls: Calls, ranks: Optional[Ranks], budget: Optional[float],
                held: contextlib.ExitStack) -> tuple[Run, bool]:
    resume = given["resume"]
    settings = _wanted(given) if resume is None else _continued(given)
    checkpoint = Path(settings.out) / "checkpoint.rdm"
    if resume is None and settings.teach is not None and settings.teach.acts:
        settings, resume = _begun(settings, given, held)
        checkpoint = resume / "checkpoint.rdm"
    if ranks is not None and resume is None:
        _give_blocks(settings)
    trainer = Trainer(settings, ranks)
    folder: Optional[RunFolder] = None
    try:
        if resume is None:
            trainer.prepare()
        if settings.out and trainer.first:
            folder = RunFolder(settings.out, overwrite=given["overwrite"], goes_on=resume is not None)
        run = _run_of(trainer)
        if resume is None:
            trainer.begin(run, folder)
        else:
            trainer.resume(run, folder, checkpoint)
        heard = trainer.go(calls, given["progress"], budget)
    finally:
        if folder is not None:
            folder.close()
        trainer.close()
    return run, heard


def _begun(wanted: Settings, given: Mapping[str, Any], held: contextlib.ExitStack) -> tuple[Settings, Path]:
    """Lets the command teach and learn one epoch. Returns the settings to go on with and the folder to go on from, which is
    gone when `held` ends if no folder was asked for."""
    assert wanted.teach is not None
    task = given["task_file"] or (given["task"] if is_file("task", given["task"]) else wanted.task)
    _taught.need_command(given, wanted.task_class)
    spare = Path(held.enter_context(tempfile.TemporaryDirectory()))
    folder, rows = Path(wanted.out) if wanted.out else spare / "run", spare / "rows.npz"
    teach: dict[str, Any] = {**({"from": wanted.teach.said} if wanted.teach.said else {}), **wanted.teach.settings}
    if wanted.teach.said:
        teach["save_recording"] = rows
    _taught.begin(_taught.words({**given, "threads": wanted.threads}, os.fspath(task), wanted.algo,
                                {**dict(wanted.of_task), **dict(wanted.of_algo)}, wanted.limits, wanted.shield, teach),
                  folder, given["progress"])
    settings = settings_of_folder(folder)
    settings.out = wanted.out
    if rows.exists():
        assert settings.teach is not None
        settings.teach.recording = Recording.load(rows)
    return settings, folder


def _run_of(trainer: Trainer) -> Run:
    s = trainer.settings
    return Run(s.task, trainer.agent.algo.name, s.seed, s.options, dict(zip(trainer.cost_names, trainer.limits)),
               trainer.agent.policy(), lambda: trainer.agent, Path(s.out) if s.out else None, s.own,
               settings_of(trainer.config()))


_MOST_BLOCKS, _LEAST_BLOCKS, _BLOCK_WORLDS = 64, 4, 16


def _give_blocks(settings: Settings) -> None:
    """Sets the option blocks as `redman train --ranks` does: the same for any number of ranks, so that they learn the same.
    Blocks of fewer worlds leave lanes of the engine empty; fewer blocks leave nothing for ranks to share."""
    if "blocks" not in _discovery.algo(settings.algo).options:
        raise UsageError(f"ranks: {settings.algo} learns in one process; only algorithms without a replay memory learn in several")
    if "blocks" in (folded(key) for key, _ in settings.of_algo):
        return
    blocks, envs = 1, settings.envs
    while blocks < _MOST_BLOCKS and envs % (2 * blocks) == 0 and (blocks < _LEAST_BLOCKS or envs >= 2 * blocks * _BLOCK_WORLDS):
        blocks *= 2
    settings.of_algo.append(("blocks", str(blocks)))


def _ranks(ranks: Any) -> Optional[Ranks]:
    if ranks is None or isinstance(ranks, Ranks):
        return ranks
    raise UnsupportedError(f"ranks={ranks!r}: the command starts processes: `redman train --ranks {ranks} ...`, whose folder "
                           "redman.load and resume take. Here ranks is a redman.Ranks, of a process that mpi4py started")


def _wanted(given: Mapping[str, Any]) -> Settings:
    """The settings of a new run."""
    task, algo, task_file = given["task"], given["algo"], given["task_file"]
    steps = _steps(1e6 if given["steps"] is None else given["steps"])
    if task_file is None and is_file("task", task):
        task_file = task
    known = None if task is None else _discovery.task_name(task)
    teach = Teach.wanted(given["from_"], given["teach"], known)
    name = known if known is not None or teach is None else teach.task
    if name is None:
        raise UsageError("train: the task is missing: give a task, or resume=folder")
    name = _discovery.task(name).name
    algo = _discovery.algo(os.fsdecode(encoded(algo, "algo"))).name
    seed, envs = _seed(given["seed"]), whole(given["envs"], "envs", 1, (1 << 31) - 1)
    for counted in ("eval_every", "checkpoint_every"):
        whole(given[counted], counted, 1, (1 << 31) - 1)
    asked: dict[str, Given] = as_dict(given["options"])
    limits = given["cost_limits"]
    for key in [key for key in asked if folded(key) == "cost_limit"]:
        value: Any = asked.pop(key)
        try:
            limit = float(value)  # of a text too
        except (TypeError, ValueError):
            raise UsageError(f"{key}: it must be a number, not {value!r}") from None
        limits = limit if limits is None else limits
    of_task, of_algo = split_options(name, algo, asked)
    of_task = list(named_options(dict(of_task)).items())
    if teach is not None and "replay_rows" in _discovery.algo(algo).options:
        raise UsageError(f"from_: {algo} cannot begin with a teacher; only algorithms without a replay memory can, such as "
                         "algo=\"ppo_lag\". Agent.learn_from lets an agent with a replay memory learn from a recording")
    usual = _discovery.task(name).defaults.get("latent_from", "")
    if given["from_"] is None and folded(str({folded(key): value for key, value in of_algo}.get("latent_from", usual))) == "history":
        raise UsageError("latent_from=history makes a student, which starts from its teacher: give from_= a policy or run folder")
    if teach is not None and not teach.acts:
        of_task = [*teach.task_options(name), *of_task]
        of_algo = [*teach.algo_options(of_algo), *of_algo]
    if teach is None or not teach.acts:  # the command adds these itself
        of_task = [*eyes_of(name, algo, {folded(key): value for key, value in of_algo}), *of_task]
    own = Own.wanted(given["reward"], given["costs"])
    columns = list(_discovery.task(name).costs) if own is None or own.costs is None else list(own.costs)
    text = None if task_file is None else read_whole(task_file, "task file", MOST_TASK).decode(errors="replace")
    return Settings(
        name, algo, seed, envs, all_cores(given["threads"], envs), steps, of_task, of_algo, limit_texts(limits, columns),
        given["eval_every"], given["checkpoint_every"], given["tensorboard"], text, task_class_of(name), teach,
        shield_word(given["shield"]), own, given["out"] or "")


def task_class_of(name: str) -> Optional[str]:
    """The import path of a task that is a class in Python; None for other tasks, and where the class cannot be imported."""
    from ._own_task import _descriptions
    found = _descriptions.get(_discovery.task(name).number)
    return None if found is None else path_of(found.kind)


_OF_RESUME = ("steps", "threads", "callback", "progress", "time_budget", "ranks", "resume", "reward", "costs", "overwrite", "view")


def _continued(given: Mapping[str, Any]) -> Settings:
    """The settings of a run that is resumed."""
    folder = os.fsdecode(encoded(given["resume"], "resume"))
    usual = {name: p.default for name, p in inspect.signature(train).parameters.items()}
    odd = [name for name, value in given.items() if name not in _OF_RESUME and value is not usual[name] and value != usual[name]]
    if odd:
        raise UsageError(f"resume: its settings are those of the folder, {', '.join(odd)} too; {', '.join(_OF_RESUME[:5])} may "
                         f"be given. A new run that begins with its policy is train(..., from_={folder!r})")
    settings = settings_of_folder(folder, Own.wanted(given["reward"], given["costs"]))
    warn_of_another_build(folder)
    if given["steps"] is not None:
        settings.steps = _steps(given["steps"])
    if given["threads"] is not None:
        settings.threads = all_cores(given["threads"], settings.envs)
    return settings


def warn_of_another_build(folder: FolderPath) -> None:
    """Warns if the run began with another version or other kernels: it may not come to the bytes that it would have had."""
    began, now = read_config(folder).get("build"), vars(_discovery.build())
    if isinstance(began, dict):
        other = [name for name in ("version", "kernels") if began.get(name, now[name]) != now[name]]
        if other:
            said = [", ".join(f"{name} {of[name]}" for name in other) for of in (began, now)]
            warnings.warn(f"run {os.fspath(folder)}: it was trained with {said[0]}, here is {said[1]}: results differ from an unbroken "
                          "run's", RuntimeWarning, stacklevel=4)


def settings_of_folder(folder: FolderPath, own: Optional[Own] = None) -> Settings:
    """Reads the settings from config.json. own: functions that replace those that it names."""
    config, where = read_config(folder), f"run {os.fspath(folder)}"
    try:
        cfgs = config["train_cfgs"]
        pairs: dict[str, list[tuple[str, Value]]] = {
            name: [(text.split("=", 1)[0], text.split("=", 1)[1]) for text in config[name]] for name in ("set", "set_algo")}
        limits = [str(text) for text in config["set_cost_limit"]]
        kept = {name: config[name] for name in ("plugins", "robot_files", "object_files") if name in config}
        written = Own.of_config(config, where)
        settings = Settings(
            str(config["task"]), str(config["algo"]), int(config["seed"]), int(cfgs["vector_env_nums"]), int(cfgs["threads"]),
            int(cfgs["total_steps"]), pairs["set"], pairs["set_algo"], limits, int(cfgs["eval_every"]),
            int(cfgs["checkpoint_every"]), bool(cfgs.get("tensorboard", True)), config.get("task_file"),
            config.get("task_class"), Teach.of_config(config["teach_cfgs"]) if "teach_cfgs" in config else None,
            str(cfgs.get("shield", "off")), written, os.fspath(folder), kept)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        raise FormatError(f"{where}: config.json is not a run's: {error!r}") from None
    if settings.task_class is not None:
        load_task_class(settings.task, settings.task_class, where)
    load_kept(config, where)
    if own is not None:
        if written is None:
            raise UsageError(f"{where}: the run learns the task's own costs and reward, so that costs= and reward= cannot replace them")
        settings.own = written.given(own)
    return settings


def loaded_run(folder: FolderPath) -> Run:
    """Reads a run folder as a Run."""
    path = as_path(folder, "folder")
    settings, config, policy = settings_of_folder(path), read_config(path), Policy.load(path)

    def agent() -> Any:
        trainer = Trainer(settings)
        trainer.restore(path / "checkpoint.rdm")
        trainer.close()
        return trainer.agent

    if settings.own is not None and settings.own.costs is not None:
        names = list(settings.own.costs)
    else:
        names = list(_discovery.task(settings.task).costs)
    limits = {name: config["cost_limits"].get(name) for name in names}
    run = Run(settings.task, settings.algo, settings.seed, settings.options, limits, policy, agent, path, settings.own, settings_of(config))
    run._read_progress(path)
    run.env_steps = int(max(run._rows.get("TotalEnvSteps") or [0]))
    last = run._rows.get("Time/Total") or [0.0]
    run.seconds = 0.0 if math.isnan(last[-1]) else last[-1]
    run.interrupted = run.env_steps < settings.steps
    return run
