"""Callbacks of redman.train: functions and objects that are called after each epoch.

    from redman import callbacks

    run = redman.train("ball_run", callback=[
        callbacks.Curriculum({"max_steps": [50, 100, 250]}),    # an option of the task that changes over the run
        callbacks.TensorBoard("runs/board"),                    # the curve; WandB and MLflow are like it
        lambda epoch: epoch.ret > 400])                         # a true result ends the run

A callback is a function of the epoch; a function of (epoch, training), where training is a redman.Training, which has the agent,
the pool and the run; or an object of a class of your own:

    class Slower(callbacks.Callback):
        def on_epoch(self, epoch, training):
            if epoch.kl > 0.05:
                training.set(learning_rate=epoch.learning_rate / 2)
            return epoch.ret > 400                              # a true result ends the run

A callback for another library imports it when it is created.
"""
from __future__ import annotations

import inspect
import math
import os
import time
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Iterable, Mapping, Optional, Sequence, Union

from . import _events
from ._error import ArgumentError, UsageError
from ._names import Hinted
from ._optional import optional

if TYPE_CHECKING:
    from ._agent import Agent, Epoch
    from ._options import Given, Value
    from ._pool import Pool
    from ._run import Run


class Training(Hinted):
    """A run in progress, as callbacks get it: its agent, its pool and the run itself.

    run.curve has the rows so far, and agent.policy() is the policy as it is now. set() changes options; stop() ends the run after
    this epoch.
    """

    _set_option = "training.set({}=...)"

    agent: Agent
    run: Run
    steps: int  # control steps that the run is to have
    row: Mapping[str, float] = {}  # of progress.csv, of the last epoch

    def _option_names(self) -> Iterable[str]:
        return (*self.agent._option_names(), *self.pool._option_names()) if "agent" in vars(self) else ()

    @property
    def pool(self) -> Pool:
        """The worlds that the agent learns in. set() of an option of the task replaces them."""
        raise NotImplementedError

    @property
    def progress(self) -> float:
        """The share of the run's steps that are done, 0 to 1."""
        return min(1.0, self.run.env_steps / self.steps)

    def set(self, **options: Given) -> None:
        """Changes options from the next epoch on: set(learning_rate=1e-4, object_mass=0.1). The checkpoint keeps them, so that a
        run that is resumed has them too.

        Options of the learner must be live (redman.algo(name).options[key].live). For options of the task, new worlds replace the
        old ones and begin episodes; observations and actions must keep their layout. Policies are still evaluated in worlds with
        the options that train was given.
        """
        raise NotImplementedError

    def stop(self) -> None:
        """Ends the run after this epoch, as a true result of a callback does."""
        raise NotImplementedError


class Callback:
    """Base class of callbacks. Override any of its functions. training is the redman.Training that calls, epoch the
    redman.Epoch that has ended."""

    def on_begin(self, training: Training) -> Any:
        """Is called before the first epoch, also when a run is resumed. A true result ends the run."""

    def on_epoch(self, epoch: Epoch, training: Training) -> Any:
        """Is called after each epoch. A true result ends the run."""

    def on_end(self, training: Training) -> None:
        """Is called after the last epoch, also after an exception."""


Function = Union["Callable[[Epoch], Any]", "Callable[[Epoch, Training], Any]"]
Callbacks = Union[None, Function, Callback, "Sequence[Union[Function, Callback]]"]


class Calls(Callback):
    """Calls several callbacks, one after the other."""

    def __init__(self, given: Callbacks, more: Sequence[Callback] = ()) -> None:
        listed: Any = [] if given is None else given if isinstance(given, (list, tuple)) else [given]
        self._all: list[Callback] = [*(_callback(each) for each in listed), *more]

    def on_begin(self, training: Training) -> bool:
        return any([bool(each.on_begin(training)) for each in self._all])

    def on_epoch(self, epoch: Epoch, training: Training) -> bool:
        return any([bool(each.on_epoch(epoch, training)) for each in self._all])

    def on_end(self, training: Training) -> None:
        for each in self._all:
            each.on_end(training)


def _callback(given: Any) -> Callback:
    if isinstance(given, type):
        raise UsageError(f"callback: give an object, {given.__name__}(), not the class")
    if isinstance(given, Callback):
        return given
    if callable(given):
        return _Called(given)
    raise UsageError(f"callback: it must be a function of the epoch, or of (epoch, training), a redman.callbacks.Callback, or a list of "
                     f"these, not {given!r}")


class _Called(Callback):
    """Calls a function of the epoch, or of the epoch and the training."""

    def __init__(self, function: Callable[..., Any]) -> None:
        self._function = function
        try:
            inspect.signature(function).bind(None)
            self._hands = False
        except TypeError:
            self._hands = True
        except ValueError:  # of a built-in function nothing is known
            self._hands = False

    def on_epoch(self, epoch: Epoch, training: Training) -> Any:
        return self._function(epoch, training) if self._hands else self._function(epoch)


class Curriculum(Callback):
    """Changes options of the task or the learner over the run, in equal stages.

        Curriculum({"object_mass": (0.02, 0.2)})                    # from the first to the second number, in 10 stages
        Curriculum({"object": ["ball", "egg", "mug"]}, until=0.6)   # one after the other, the last from 0.6 of the run on

    A pair of numbers is the first and the last value of a line; a list has a value for each stage. The last stage begins when the
    share `until` of the run's steps is done. Policies are evaluated in worlds with the options that train was given: give it
    those of the last stage.
    """

    def __init__(self, options: Mapping[str, Union[Sequence[Value], tuple[float, float]]], until: float = 0.8,
                 stages: int = 10) -> None:
        if not 0 < until <= 1:
            raise ArgumentError(f"until: it must be a share of the run, above 0 and at most 1, not {until}")
        if stages < 2:
            raise ArgumentError(f"stages: {stages} is less than 2")
        self._until = until
        self._values: dict[str, list[Value]] = {}
        for key, values in options.items():
            if isinstance(values, tuple):
                if len(values) != 2 or not all(isinstance(value, (int, float)) for value in values):
                    raise ArgumentError(f"{key}: give a pair of numbers, (first, last), or a list of values, not {values!r}")
                low, high = map(float, values)
                self._values[key] = [low + (high - low) * k / (stages - 1) for k in range(stages)]
            elif isinstance(values, str) or not values:
                raise ArgumentError(f"{key}: give a pair of numbers, (first, last), or a list of values, not {values!r}")
            else:
                self._values[key] = list(values)

    def at(self, progress: float) -> dict[str, Value]:
        """The options at a share of the run, 0 to 1."""
        out = {}
        for key, values in self._values.items():
            last = len(values) - 1
            out[key] = values[min(last, int(progress / self._until * last + 1e-9))]
        return out

    def on_begin(self, training: Training) -> None:
        training.set(**self.at(training.progress))

    def on_epoch(self, epoch: Epoch, training: Training) -> None:
        training.set(**self.at(training.progress))


class TensorBoard(Callback):
    """Writes the curve for TensorBoard: into an event file in a folder, which needs no other library, or by add_scalar of a
    SummaryWriter of torch or tensorboardX. A run folder (train(..., out=folder)) has such a file without this callback."""

    def __init__(self, folder: Union[str, os.PathLike[str], Any]) -> None:
        self._writer: Any = folder if hasattr(folder, "add_scalar") else None
        self._folder = None if self._writer is not None else Path(folder)

    def on_begin(self, training: Training) -> None:
        self._begun = int(time.time())
        if self._folder is not None:
            self._folder.mkdir(parents=True, exist_ok=True)
            self._file = self._folder / _events.file_name(self._begun)
            self._file.write_bytes(_events.head(self._begun))

    def on_epoch(self, epoch: Epoch, training: Training) -> None:
        if self._writer is not None:
            for name, value in _finite(training.row):
                self._writer.add_scalar(name, value, epoch.env_steps)
            return
        with open(self._file, "ab") as file:
            file.write(_events.row({name: f"{value:.9g}" for name, value in training.row.items()}, self._begun))

    def on_end(self, training: Training) -> None:
        if self._writer is not None:
            self._writer.flush()


class View(Callback):
    """Opens a window in the browser, redman.view, on the policy as it is after each epoch: it plays in worlds of its own, with
    the options of the run, while somebody looks. train(view=True) is this callback with its defaults. num_envs: worlds that it
    plays in; browser: opens it in one; port: of its address, 0: any that is free."""

    def __init__(self, num_envs: int = 1, browser: bool = True, port: int = 0) -> None:
        self._num_envs, self._browser, self._port = num_envs, browser, port
        self.window: Any = None  # redman.Window

    def on_begin(self, training: Training) -> None:
        from ._play import singly
        from ._pool import Pool
        from ._window import Page, Playing
        pool = Pool(training.run.task, self._num_envs, training.run.seed, autoreset="off", options=singly(training.run.options))
        self._playing = Playing(training.agent.policy(), pool, actor=training.run.algo,
                                page=Page(self._browser, self._port), limits=training.run.cost_limits)
        self.window = self._playing.window

    def on_epoch(self, epoch: Epoch, training: Training) -> None:
        self._playing.show(training.agent.policy())

    def on_end(self, training: Training) -> None:
        if self.window is not None:
            self.window.close()


class WandB(Callback):
    """Sends the curve to Weights & Biases, as a run of project. settings: arguments of wandb.init; its config has the settings
    of the run. A run of wandb that is already active is used, and stays open."""

    def __init__(self, project: Optional[str] = None, **settings: Any) -> None:
        self._wandb = _module("wandb")
        self._settings = {**({} if project is None else {"project": project}), **settings}
        self._own = False

    def on_begin(self, training: Training) -> None:
        self._own = self._wandb.run is None
        if self._own:
            self._wandb.init(**{"config": training.run.config, "name": training.run.name, **self._settings})

    def on_epoch(self, epoch: Epoch, training: Training) -> None:
        self._wandb.log(dict(_finite(training.row)), step=epoch.env_steps)

    def on_end(self, training: Training) -> None:
        if self._own:
            self._wandb.finish()


class MLflow(Callback):
    """Sends settings and curve to MLflow as parameters and metrics, as a run of experiment. settings: arguments of
    mlflow.start_run. A run of MLflow that is already active is used, and stays open."""

    def __init__(self, experiment: Optional[str] = None, **settings: Any) -> None:
        self._mlflow = _module("mlflow")
        self._experiment, self._settings, self._own = experiment, settings, False

    def on_begin(self, training: Training) -> None:
        if self._experiment is not None:
            self._mlflow.set_experiment(self._experiment)
        self._own = self._mlflow.active_run() is None
        if self._own:
            self._mlflow.start_run(**{"run_name": training.run.name, **self._settings})
        self._mlflow.log_params(_flat(training.run.config))

    def on_epoch(self, epoch: Epoch, training: Training) -> None:
        self._mlflow.log_metrics(dict(_finite(training.row)), step=epoch.env_steps)

    def on_end(self, training: Training) -> None:
        if self._own:
            self._mlflow.end_run()


def _module(name: str) -> Any:
    return optional(name, "this callback", "; a run folder has its curve for TensorBoard without it")


def _finite(row: Mapping[str, float]) -> Iterable[tuple[str, float]]:
    return ((name, value) for name, value in row.items() if math.isfinite(value))


def _flat(config: Mapping[str, Any], before: str = "") -> dict[str, Any]:
    out: dict[str, Any] = {}
    for key, value in config.items():
        name = f"{before}{key}"
        out.update(_flat(value, f"{name}.") if isinstance(value, Mapping) else {name: value})
    return out


__all__ = ["Callback", "Callbacks", "Curriculum", "MLflow", "TensorBoard", "Training", "View", "WandB"]
