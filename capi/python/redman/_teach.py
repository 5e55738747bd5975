"""What an agent can learn without acting: from recordings, policies and labels of points; and the values of its critics.
Experimental, like redman/record.h, sense.h and plan.h."""
from __future__ import annotations

import ctypes
from ctypes import byref
from typing import TYPE_CHECKING, Any, Callable, Mapping, Optional, Sequence

import numpy as np

from . import _abi
from ._error import ArgumentError, RangeError
from ._library import assign, check, flag, instance, lib, real, sized, whole
from ._options import Value
from ._policy import Backup, policy_of
from ._recording import Recording
from ._rows import DoubleArray, FloatArray, array_of, clouds, given, wrong_shape

_READ = "; redman.Recording.load(path) reads a file"


class CloneReport(_abi.CloneReport):
    """What Agent.clone did. epochs: number of epochs run; best_epoch: the epoch, from 1, whose weights were kept; stopped:
    whether it ended early; train_rows, validation_rows: counts; train_loss, validation_loss: mean squared error of an entry
    in the best epoch, nan without validation; train_losses, validation_losses: [epochs] the same for each epoch."""

    stopped: bool
    train_losses: tuple[float, ...]
    validation_losses: tuple[float, ...]

    def __init__(self, struct: _abi.rdm_clone_report, train: DoubleArray, validation: DoubleArray) -> None:
        super().__init__(struct)
        held = struct.validation_rows > 0
        self.__dict__.update(
            stopped=bool(struct.stopped), validation_loss=struct.validation_loss if held else float("nan"),
            train_losses=tuple(train[:struct.epochs].tolist()),
            validation_losses=tuple(validation[:struct.epochs].tolist()) if held else ())

    def __str__(self) -> str:
        """Two lines for people."""
        held = f", {self.validation_rows} held back for validation" if self.validation_rows else ""
        tested = f", of the rows held back {self.validation_loss:.4g}" if self.validation_rows else ""
        return (f"{self.epochs} epochs{' (stopped early)' if self.stopped else ''} on {self.train_rows} rows{held}; the weights of epoch "
                f"{self.best_epoch} were kept\nmean squared error of an entry of the action: {self.train_loss:.4g}{tested}")


class LearnReport(_abi.LearnReport):
    """What Agent.learn_from did. steps: gradient steps of this call; rows: count that are learned from; skipped_gradients:
    steps left out for a gradient that was not finite; loss_policy, loss_reward_value, loss_cost_value, value_reward,
    value_cost: means over the steps, nan where there is none; cost, multiplier: of each cost, its sum over an episode of the
    policy as the critics estimate it, nan without a limit, and its multiplier; cost_names: their names."""

    cost_names: tuple[str, ...]

    def __init__(self, struct: _abi.rdm_learn_report, names: Sequence[str]) -> None:
        super().__init__(struct)
        n = len(names)
        self.__dict__.update(cost=self.cost[:n], multiplier=self.multiplier[:n], cost_names=tuple(names))

    def __str__(self) -> str:
        """A few lines for people."""
        losses = {"policy": self.loss_policy, "critic of the reward": self.loss_reward_value, "critic of the costs": self.loss_cost_value}
        means = [f"{name} {loss:.4g}" for name, loss in losses.items() if not np.isnan(loss)]
        costs = [f"{name} {cost:.4g} (multiplier {multiplier:.4g})"
                 for name, cost, multiplier in zip(self.cost_names, self.cost, self.multiplier) if not np.isnan(cost)]
        skipped = f", {self.skipped_gradients} skipped, as their gradient was not finite" if self.skipped_gradients else ""
        return "\n".join([f"{self.steps} gradient steps on {self.rows} rows{skipped}", *([f"mean losses: {', '.join(means)}"] if means else []),
                          *([f"sum over an episode, as the critics estimate it: {', '.join(costs)}"] if costs else [])])


class Taught:
    """The methods of Agent that are in this module."""

    _a: Optional[int]
    _lock: Any
    _lengths: dict[str, int]
    num_envs: int
    obs_dim: int
    _check: Callable[[int], None]
    _open: Callable[[], int]
    _run: Callable[..., None]
    _config: dict[str, Any]
    _recording: Optional[Recording]

    if TYPE_CHECKING:
        @property
        def options(self) -> Mapping[str, Value]: ...

    def clone(self, recording: Recording, *, epochs: int = 30, batch_rows: int = 512, patience: int = 5,
              learning_rate: float = 1e-3, learning_rate_end: float = 1e-5, validation: float = 0.1, action_std: float = 0.0,
              seed: int = 0, feed_normalizer: bool = True) -> CloneReport:
        """Behaviour cloning: fits the actor's mean to the labels of a recording; critics and multipliers stay.

        epochs: passes over the rows, at most; batch_rows: rows of a gradient step; patience: ends after this many epochs
        without a better validation loss, 0: never; learning_rate falls linearly to learning_rate_end; validation: the share of
        rows, in whole episodes, held back for validation; action_std: the standard deviation of actions afterwards, 0:
        unchanged; feed_normalizer: first sets the statistics of observations to the recording's; seed: of the order of the
        rows. Ctrl-C and cancel leave the agent as it was.
        """
        instance(recording, Recording, "recording", _READ)
        how = sized(_abi.rdm_clone_config)
        check(lib.rdm_clone_config_init(byref(how), ctypes.sizeof(how)))
        assign(how, {"epochs": epochs, "batch_rows": batch_rows, "patience": patience, "learning_rate": learning_rate,
                     "learning_rate_end": learning_rate_end, "validation": validation, "action_std": action_std, "seed": seed,
                     "feed_normalizer": flag(feed_normalizer, "feed_normalizer")})
        losses = [np.zeros(max(min(how.epochs, 100_000), 1)) for _ in range(2)]
        how.capacity = len(losses[0])
        how.train_loss, how.validation_loss = (loss.ctypes.data for loss in losses)
        report = sized(_abi.rdm_clone_report)
        with self._lock, recording._lock:
            self._run(lib.rdm_agent_clone, recording._handle.value, byref(how), byref(report))
        return CloneReport(report, *losses)

    def learn_from(self, recording: Recording, steps: int) -> LearnReport:
        """Learns from a recording alone, without a world: `steps` gradient steps of an algorithm with a replay memory, such as
        td3_bc_lag; 0 only fills its memory. Option replay_rows must hold the rows, and the longest episode once more for each
        environment. A row of the recording is one decision of the agent: ArgumentError if the file of the recording, of `redman
        data make`, says another action_repeat. The first call fills the memory and sets the statistics of observations; further
        calls with the same recording continue. UnsupportedError for other algorithms."""
        instance(recording, Recording, "recording", _READ)
        steps = whole(steps, "steps", -(1 << 63), (1 << 63) - 1)
        own, its = self.options["action_repeat"], recording._repeat
        if its is not None and its != own:
            raise ArgumentError(f"learn_from: a row of the recording is a decision of {its} control steps, but one of the agent has {own}: make "
                                f"the agent with options={{'action_repeat': {its}}}")
        report = sized(_abi.rdm_learn_report)
        with self._lock, recording._lock:
            try:
                self._run(lib.rdm_agent_learn, recording._handle.value, steps, byref(report))
            except RangeError as error:
                if not str(error).startswith("replay_rows"):
                    raise
                raise RangeError(f"learn_from: the replay memory is too small for the recording: make the agent with "
                                 f"options={{'replay_rows': {self._most_rows(recording)}}} ({error})") from None
        return LearnReport(report, self._config["cost_names"])

    def _most_rows(self, recording: Recording) -> int:
        """Rows that a replay memory needs for a recording: its own, and for each of several environments its longest episode."""
        longest = int(np.unique(recording.episode, return_counts=True)[1].max(initial=0))
        return recording.info.rows + (longest * self.num_envs if self.num_envs > 1 else 0)

    @property
    def recording(self) -> Optional[Recording]:
        """The rows that options imitation and imitation_decay keep the actor near, or None. Assignment copies obs and label;
        a state that was saved with rows can be loaded only with the same rows set."""
        return self._recording

    @recording.setter
    def recording(self, recording: Optional[Recording]) -> None:
        if recording is not None:
            instance(recording, Recording, "recording", _READ)
        with self._lock:
            self._check(lib.rdm_agent_set_recording(self._a, None if recording is None else recording._handle.value))
            self._recording = recording

    def warm_start(self, policy: Backup, samples: float = 1e6) -> None:
        """Copies the actor, its standard deviation and the statistics of observations from a policy: a Policy, its file or
        run folder, or "trained". The statistics count as `samples` observations, 2 to 1e12. ArgumentError where networks
        differ: the text says in what, and nothing changes."""
        taken, samples = policy_of(policy, self._config["task"]), real(samples, "samples")
        with self._lock:
            self._check(lib.rdm_agent_set_policy(self._a, taken._open(), samples))

    def values(self, obs: Any) -> tuple[FloatArray, FloatArray]:
        """The critics' predictions for obs, observations [n][obs_dim], or for one [obs_dim]: the discounted sum of future
        rewards [n], and that of each cost [n][cost_dim], 0 for a cost that the agent does not limit. UnsupportedError with
        options normalize_reward or normalize_cost, under which critics have no unit."""
        seen = array_of(obs, "obs")
        if seen.ndim not in (1, 2) or seen.shape[-1] != self.obs_dim:
            raise wrong_shape("obs", seen.shape, f"(rows, {self.obs_dim})")
        rows = 1 if seen.ndim == 1 else len(seen)
        table, lengths = _abi.FUNCTIONS["rdm_agent_get_values"].rows, {"rows": rows, "obs_dim": self.obs_dim}
        value, cost = np.empty(rows, np.float32), np.zeros((rows, _abi.RDM_MAX_COSTS), np.float32)
        if rows:
            array = given(seen, table["obs"], lengths, "obs")
            with self._lock:
                self._check(lib.rdm_agent_get_values(self._a, array.ctypes.data, rows, value.ctypes.data, cost.ctypes.data))
        cost = cost[:, :self._lengths["cost_dim"]]
        return (value, cost) if seen.ndim == 2 else (value[0], cost[0])

    def pretrain(self, points: Any, label: Any, num_labels: int, *, point_class: Any = None, point_color: Any = None,
                 epochs: int = 20, batch_rows: int = 16, learning_rate: float = 1e-3, validation: float = 0.1,
                 seed: int = 0) -> _abi.PretrainReport:
        """Trains the encoder to classify the points of clouds [rows][num_points][3] by label [rows][num_points], each below
        num_labels; nothing else changes. point_class [rows][num_points] and point_color [rows][num_points][3], 0 to 255, where
        the encoder reads them. epochs: passes over the clouds; batch_rows: clouds of a gradient step; learning_rate: of the
        steps; validation: the share of clouds held back; seed: of their order. StateError without option encoder."""
        points = array_of(points, "points")
        rows = len(points) if points.ndim else 0
        cloud, kept = clouds(points, point_class, point_color, rows)
        named = given(label, _abi.FUNCTIONS["rdm_agent_pretrain"].rows["label"],
                      {"rows": rows, "num_points": cloud.num_points}, "label")
        how = sized(_abi.rdm_pretrain_config)
        check(lib.rdm_pretrain_config_init(byref(how), ctypes.sizeof(how)))
        assign(how, {"num_labels": num_labels, "epochs": epochs, "batch_rows": batch_rows, "learning_rate": learning_rate,
                     "validation": validation, "seed": seed})
        report = sized(_abi.rdm_pretrain_report)
        with self._lock:
            self._run(lib.rdm_agent_pretrain, byref(cloud), named.ctypes.data, rows, byref(how), byref(report))
        del kept
        return _abi.PretrainReport(report)
