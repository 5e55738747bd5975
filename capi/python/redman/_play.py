"""Whole episodes of a policy: how good it is, and what it looks like."""
from __future__ import annotations

import warnings
from dataclasses import dataclass
from typing import Any, Callable, Optional, Sequence, Union

import numpy as np

from . import _png
from ._error import ArgumentError, Error
from ._options import Options
from ._policy import Policy
from ._pool import Pool
from ._rows import Array, FloatArray

# What ends an episode, and what goes on: bits of Pool.status (redman.h, RDM_STATUS_*) by their names in results.
_END_FLAGS = {"diverged": 2, "bad_actions": 4, "task_failed": 8}
_STEP_FLAGS = {"contacts_left_out": 1, "unconverged": 16}

Player = Union[Policy, str, Callable[[FloatArray], Any]]


@dataclass(frozen=True)
class Evaluation:
    """Means over whole episodes; costs are a number for each column.

    An episode that diverged, got a bad action or whose task failed is a violation and no success; what it summed up to
    then is no measurement: all else is of the other episodes, NaN where there are none."""

    episodes: int
    return_mean: float
    return_std: float
    cost_mean: list[float]
    cost_std: list[float]
    length_mean: float
    success_rate: float  # share of episodes with at least one success
    fall_rate: float  # share of episodes that terminated
    violation_rate: float  # share of episodes over a limit
    cost_limits: list[Optional[float]]
    diverged: int = 0  # episodes that ended as a value was not finite
    contacts_left_out: int = 0  # steps in which contacts beyond contacts_max were left out
    unconverged: int = 0  # steps in which contacts were not solved
    bad_actions: int = 0  # episodes that ended as an action was not finite
    task_failed: int = 0  # episodes that ended as a function of the task failed

    @property
    def feasible(self) -> bool:
        """No mean cost is above its limit, and every episode came to an end of its own."""
        if self.diverged or self.bad_actions or self.task_failed:
            return False
        return all(limit is None or mean <= limit for mean, limit in zip(self.cost_mean, self.cost_limits))


class _Actor:
    """Writes the pool's actions: the policy's decisions, each held as long as it was trained to."""

    def __init__(self, player: Player, pool: Pool) -> None:
        self._player, self._pool = player, pool
        self._repeat = player.info.action_repeat if isinstance(player, Policy) else 1
        if isinstance(player, Policy):
            player.check(pool)
        self._left = np.zeros(pool.num_envs, np.int64)  # control steps that the action of each world is still held

    def act(self) -> None:
        if isinstance(self._player, str):
            self._pool.baseline(self._player)
            return
        due = self._left == 0
        if due.any():
            obs = self._pool.obs
            decided = self._player.act(obs) if isinstance(self._player, Policy) else self._player(obs)
            self._pool.action[due] = np.asarray(decided)[due]
            self._left[due] = self._repeat
        self._left -= 1

    def restart(self, worlds: Array) -> None:
        self._left[worlds] = 0


def limits_of(pool: Pool, wanted: Optional[Sequence[Optional[float]]]) -> list[Optional[float]]:
    """The wanted limits, or the task's own."""
    if wanted is not None:
        return list(wanted)
    return [None if cost.limit < 0 else cost.limit for cost in pool.costs.values()]


def play(pool: Pool, player: Player, episodes: int, magnitudes: bool = False) -> list[dict[str, Any]]:
    """Each episode's return, costs, length, fall and success; the pool's autoreset is off, and it was just reset. With
    magnitudes costs are sums of cost_raw where it is above 0, as an agent with cost_signal=raw learns them."""
    n = pool.num_envs
    actor = _Actor(player, pool)
    number = np.arange(n)
    playing = number < episodes
    success = np.zeros(n, np.bool_)
    raw = np.zeros((n, pool.cost_dim))
    flagged = np.zeros((n, len(_STEP_FLAGS)), np.int64)  # steps so far
    out: list[dict[str, Any]] = [{} for _ in range(episodes)]
    while playing.any():
        actor.act()
        pool.step(mask=playing)
        success |= pool.success & playing
        raw += np.maximum(pool.cost_raw, 0) * playing[:, None]
        for k, bit in enumerate(_STEP_FLAGS.values()):
            flagged[:, k] += (pool.status & bit != 0) & playing
        ended = (pool.terminated | pool.truncated) & playing
        if not ended.any():
            continue
        for i in np.flatnonzero(ended):
            cost = raw[i].copy() if magnitudes else pool.episode_cost[i].astype(np.float64)
            out[number[i]] = {"return": float(pool.episode_return[i]), "cost": cost,
                              "length": int(pool.episode_step[i]), "fall": bool(pool.terminated[i]),
                              "success": bool(success[i]), "status": int(pool.episode_status[i]),
                              **dict(zip(_STEP_FLAGS, flagged[i].tolist()))}
            number[i] += n
        success[ended] = False
        raw[ended] = 0
        flagged[ended] = 0
        playing = number < episodes
        again = ended & playing
        if again.any():
            pool.reset(mask=again)
            actor.restart(again)
    return out


def evaluate(player: Player, task: Optional[str] = None, episodes: int = 100, num_envs: int = 16, seed: int = 0,
             threads: int = 0, options: Optional[Options] = None,
             cost_limits: Optional[Sequence[Optional[float]]] = None, magnitudes: bool = False) -> Evaluation:
    """How good a policy, a baseline ("zero", "hold", "random") or a function of obs rows is, over whole episodes.

    The same episodes as `redman eval` plays for the same seed and number of worlds. With magnitudes costs are sums of
    cost_raw where it is above 0, as an agent with cost_signal=raw learns them.
    """
    if task is None:
        if not isinstance(player, Policy) or not player.info.task:
            raise ArgumentError("evaluate: say which task")
        task = player.info.task
    if episodes < 1:
        raise ArgumentError("episodes: 1 or more")
    with Pool(task, min(num_envs, episodes), seed, threads, autoreset="off", options=options) as pool:
        pool.reset()
        return summary(play(pool, player, episodes, magnitudes), limits_of(pool, cost_limits))


def summary(played: Sequence[dict[str, Any]], limits: Sequence[Optional[float]]) -> Evaluation:
    """Means of episodes, with a warning where worlds went wrong."""
    counts = {name: sum(episode[name] for episode in played) for name in _STEP_FLAGS}
    counts.update({name: sum(episode["status"] & bit != 0 for episode in played) for name, bit in _END_FLAGS.items()})
    if any(counts.values()):
        told = ", ".join(f"{name} {count}" for name, count in counts.items() if count)
        warnings.warn(f"worlds went wrong in {len(played)} episodes: {told}", RuntimeWarning, stacklevel=3)
    sound = [episode for episode in played if not episode["status"] & sum(_END_FLAGS.values())]
    returns = np.array([episode["return"] for episode in sound] or [np.nan])
    costs = np.array([episode["cost"] for episode in sound] or [np.full(len(limits), np.nan)])
    over = np.zeros(len(costs), np.bool_)
    for k, limit in enumerate(limits):
        if limit is not None:
            over |= costs[:, k] > limit
    lost = len(played) - len(sound)

    def share(values: Any) -> float:
        return float(np.mean(values)) if len(values) else float("nan")

    return Evaluation(
        episodes=len(played), return_mean=share(returns), return_std=float(returns.std()),
        cost_mean=costs.mean(axis=0).tolist(), cost_std=costs.std(axis=0).tolist(),
        length_mean=share([episode["length"] for episode in sound]),
        success_rate=sum(episode["success"] for episode in sound) / len(played),
        fall_rate=share([episode["fall"] for episode in sound]),
        violation_rate=(int(over.sum()) + lost) / len(played), cost_limits=list(limits), **counts)


def strip(policy: Policy, frames: int = 6, width: int = 240, height: int = 180) -> Optional[bytes]:
    """A PNG of moments of an episode, side by side; None where the task cannot be made or shown."""
    if not policy.info.task:
        return None
    try:
        with Pool(policy.info.task, autoreset="off") as pool:
            pool.reset()
            actor = _Actor(policy, pool)
            pictures = [pool.render(width=width, height=height)]
            step = 0
            while len(pictures) < frames and not (pool.terminated[0] or pool.truncated[0]):
                actor.act()
                pool.step()
                step += 1
                if step * (frames - 1) >= len(pictures) * pool.max_steps:
                    pictures.append(pool.render(width=width, height=height))
            return _png.row(pictures)
    except Error:
        return None
