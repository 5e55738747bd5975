"""Whole episodes of a policy: how good it is, and what it looks like."""
from __future__ import annotations

import os
import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Callable, Mapping, Optional, Sequence, Union

import numpy as np

from . import stats
from ._abi import ShieldKind
from ._actor import worlds_of
from ._discovery import TaskName, task_name
from ._episode import Episode, played
from ._error import ArgumentError, NotFoundError
from ._html import number, pair, share, table
from ._library import all_cores, int32
from ._limits import CostLimits, each_cost
from ._names import Hinted, folded, keywords, nearest, one_of
from ._options import Options, as_dict
from ._own_costs import Costs, Own, RowFunction
from ._policy import Backup, Origin, Policy
from ._pool import Pool
from ._rows import Array, DoubleArray, FloatArray
from ._shield import Shield, Shielding, is_wanted, shield_of
from ._worlds import Center, center_of

if TYPE_CHECKING:
    import numpy.typing as npt
    from ._agent import Agent
    from ._run import Run

_PLAYED = {"choose": "best", "unproven": "least"}  # options of a shield where nobody learns, as the command sets them
# What ends an episode, and what goes on: bits of Pool.status (redman.h, RDM_STATUS_*) by their names in results.
_END_FLAGS = {"diverged": 2, "bad_actions": 4, "task_failed": 8}
_STEP_FLAGS = {"contacts_left_out": 1, "unconverged": 16, "slowed": 32}

_BASELINES = ("zero", "hold", "random")
Function = Callable[[FloatArray], Any]
# What plays: a policy, a run or its folder, an agent, a baseline, a function of rows, a model with `predict`.
Player = Union[Policy, str, "os.PathLike[str]", "Run", "Agent", Function, Any]


def _cvar(samples: Array) -> Array:
    """Conditional value at risk of each row [resamples][episodes]...: the mean of the largest tenth; the episode on the edge
    counts in part."""
    tenth = samples.shape[1] / 10
    weights = np.clip(tenth - np.arange(samples.shape[1]), 0, 1)
    largest: Array = np.tensordot(-np.sort(-samples, axis=1), weights / tenth, (1, 0))
    return largest


def _mean(samples: Array) -> Array:
    mean: Array = samples.mean(axis=1)
    return mean


def _stderr(values: Array) -> Any:
    """Standard error of the mean of rows; NaN for less than two."""
    return values.std(axis=0, ddof=1) / np.sqrt(len(values)) if len(values) > 1 else np.full(values.shape[1:], np.nan)


def _measured(mean: float, error: float) -> str:
    return f"{mean:.3f}" if np.isnan(error) else f"{mean:.3f} +- {error:.2g}"


# What Evaluation.interval knows: rows of an evaluation, and what is made of such as were drawn from them.
_STATISTICS: dict[str, tuple[Callable[[Evaluation], Array], Callable[[Array], Array]]] = {
    "return_mean": (lambda e: e._sound(e.returns), _mean), "return_iqm": (lambda e: e._sound(e.returns), stats.iqm_of),
    "cost_mean": (lambda e: e._sound(e.costs), _mean), "cost_cvar": (lambda e: e._sound(e.costs), _cvar),
    "length_mean": (lambda e: e._sound(e.lengths), _mean), "success_rate": (lambda e: e.successes, _mean),
    "violation_rate": (lambda e: e._violations(), _mean)}
_QUANTILES = (0.5, 0.9, 0.99)


@dataclass(frozen=True)
class Evaluation(Hinted):
    """Means over whole episodes; costs have a number for each column.

    An episode that diverged, got a bad action or whose task failed counts as a violation and not as a success. Its sums are
    no valid measurement: all other numbers are over the remaining episodes, NaN where there are none."""

    _hints = {"cost": "cost_mean, the mean of each cost; costs, those of each episode", "ret": "return_mean; returns, those of each episode",
              "return_": "return_mean; returns, those of each episode", "reward": "return_mean, the mean sum of rewards of an episode",
              "success": "success_rate; successes, those of each episode", "length": "length_mean; lengths, those of each episode",
              "limits": "cost_limits"}

    episodes: int
    return_mean: float
    return_std: float
    cost_mean: list[float]
    cost_std: list[float]
    length_mean: float  # control steps
    success_rate: float  # share of episodes with at least one success
    fall_rate: float  # share of episodes that terminated
    violation_rate: float  # share of episodes over a limit
    cost_limits: list[Optional[float]]
    violating_steps: int  # control steps in which column 0, or a cost with a limit by the task, was above 0
    # of each episode, in the order of their numbers; NaN where an episode was no measurement
    returns: DoubleArray = field(repr=False, compare=False)  # [episodes]
    costs: DoubleArray = field(repr=False, compare=False)  # [episodes][cost_dim]
    lengths: DoubleArray = field(repr=False, compare=False)  # [episodes] control steps
    successes: npt.NDArray[np.bool_] = field(repr=False, compare=False)  # [episodes]
    decisions: Optional[int] = None  # that the shield looked at; None: there was none
    interventions: Optional[int] = None  # of these, that it did not let through
    inevitable_steps: Optional[int] = None  # of violating_steps, those of unproven decisions; None: there was no shield
    diverged: int = 0  # episodes that ended as a value was not finite
    contacts_left_out: int = 0  # steps in which contacts beyond contacts_max were left out
    unconverged: int = 0  # steps in which contacts were not solved
    slowed: int = 0  # steps in which a thing spun faster than the engine follows
    bad_actions: int = 0  # episodes that ended as an action was not finite
    task_failed: int = 0  # episodes that ended as a function of the task failed
    cost_names: tuple[str, ...] = ()  # of the columns of cost

    @property
    def feasible(self) -> bool:
        """Whether no mean cost is above its limit and every episode was sound."""
        if self.diverged or self.bad_actions or self.task_failed:
            return False
        return all(limit is None or mean <= limit for mean, limit in zip(self.cost_mean, self.cost_limits))

    @property
    def return_stderr(self) -> float:
        """Standard error of return_mean: s / sqrt(n), s^2 = sum (x - mean)^2 / (n - 1)."""
        return float(_stderr(self._sound(self.returns)))

    @property
    def cost_stderr(self) -> list[float]:
        """Standard error of cost_mean, likewise."""
        return list(map(float, _stderr(self._sound(self.costs))))

    @property
    def success_stderr(self) -> float:
        """Standard error of success_rate p, likewise: sqrt(p (1 - p) / (n - 1)). Where all n episodes have the same outcome
        it is 0, and yet the rate of the other outcome may be up to 3 / n (Hanley, Lippman-Hand: If Nothing Goes Wrong, Is
        Everything All Right?, JAMA 249, 1983)."""
        return float(_stderr(self.successes))

    @property
    def return_iqm(self) -> float:
        """Interquartile mean of the returns, as redman.stats.iqm."""
        returns = self._sound(self.returns)
        return float(stats.iqm_of(returns[None])[0]) if len(returns) else float("nan")

    @property
    def cost_cvar(self) -> list[float]:
        """Conditional value at risk of each cost: its mean over the worst tenth of the episodes.

            CVaR = 1 / k  sum of the k largest costs, k = n / 10; where k is not whole, the next one counts with the rest of k

        (Rockafellar, Uryasev: Conditional Value-at-Risk for General Loss Distributions, J. Banking & Finance 26, 2002). With
        10 episodes or fewer it is the largest cost."""
        costs = self._sound(self.costs)
        return list(map(float, _cvar(costs[None])[0])) if len(costs) else [float("nan")] * costs.shape[1]

    @property
    def cost_quantiles(self) -> dict[float, list[float]]:
        """The 0.5, 0.9 and 0.99 quantile of each cost, linear between two episodes (definition 7 of Hyndman, Fan: Sample
        Quantiles in Statistical Packages, The American Statistician 50, 1996)."""
        costs = self._sound(self.costs)
        if not len(costs):
            return {q: [float("nan")] * costs.shape[1] for q in _QUANTILES}
        return {q: list(map(float, np.quantile(costs, q, axis=0))) for q in _QUANTILES}

    def interval(self, stat: str, level: float = 0.95) -> Any:
        """The interval (low, high) of a stat: of return_mean, return_iqm, length_mean, success_rate or violation_rate, and one
        for each column of cost_mean or cost_cvar.

        Episodes are drawn with replacement, as many as there are, and the quantiles (1 - level) / 2 and (1 + level) / 2 of
        the resamples' values are its ends (percentile bootstrap, Efron, Tibshirani: An Introduction to the Bootstrap, 1993,
        chapter 13): 10,000 resamples of a fixed seed. It is about this one policy: for an algorithm, use
        redman.stats.interval over several runs. NaN for less than two episodes."""
        rows_of, statistic = one_of(stat, _STATISTICS, "stat")
        rows = rows_of(self)
        if len(rows) > 1:
            ends = stats.bootstrap([len(rows)], lambda drawn: statistic(rows[drawn[0]]), level)
        else:
            ends = np.full((2, *rows.shape[1:]), np.nan)
        pairs = [(float(low), float(high)) for low, high in ends.reshape(2, -1).T]
        return pairs if rows.ndim > 1 else pairs[0]

    def __str__(self) -> str:
        """A few lines, of which the first two are those of `redman eval`, without the task."""
        names = [*self.cost_names, *(f"cost {k}" for k in range(len(self.cost_names), len(self.cost_mean)))]
        costs = [f"{name} {_measured(mean, error)}" + ("" if limit is None else f" (limit {limit:g})")
                 for name, mean, error, limit in zip(names, self.cost_mean, self.cost_stderr, self.cost_limits)]
        shown = [k for k, limit in enumerate(self.cost_limits) if k == 0 or limit is not None]
        others = [cost for k, cost in enumerate(costs) if k not in shown]
        first = ", ".join([f"return {_measured(self.return_mean, self.return_stderr)}", *(costs[k] for k in shown),
                           f"success {100 * self.success_rate:.1f}%", f"over a limit {100 * self.violation_rate:.1f}%",
                           *(f"CVaR of the cost {cvar:.3f}" for cvar in self.cost_cvar[:1])])
        lines = [f"{self.episodes} episode{'s' * (self.episodes != 1)}: {first}",
                 "+- is a standard error, CVaR the mean of the worst tenth of the episodes"]
        if others:
            lines.append(f"other costs: {', '.join(others)}")
        lines.append(f"length {self.length_mean:.1f} control steps, falls {100 * self.fall_rate:.1f}%, violating steps {self.violating_steps}"
                     + (f", of which {self.inevitable_steps} were inevitable" if self.inevitable_steps else ""))
        if self.decisions is not None:
            lines.append(f"the shield changed {self.interventions} of {self.decisions} decisions")
        wrong = {name: getattr(self, name) for name in (*_END_FLAGS, *_STEP_FLAGS)}
        if any(wrong.values()):
            lines.append("went wrong: " + ", ".join(f"{name} {count}" for name, count in wrong.items() if count))
        return "\n".join(lines)

    def _repr_html_(self) -> str:
        """A table with intervals, for a notebook."""
        rows = [["return", number(self.return_mean), pair(self.interval("return_mean")), "", ""]]
        tails, means = self.interval("cost_cvar"), self.interval("cost_mean")
        for k, limit in enumerate(self.cost_limits):
            within = "" if limit is None else "yes" if self.cost_mean[k] <= limit else "no"
            name = self.cost_names[k] if k < len(self.cost_names) else f"cost {k}"
            rows.append([name, number(self.cost_mean[k]), pair(means[k]), number(limit), within])
            rows.append([f"{name}, worst tenth", number(self.cost_cvar[k]), pair(tails[k]), "", ""])
        for name, value in (("success", self.success_rate), ("violation", self.violation_rate)):
            rows.append([f"episodes with {name}", share(value), pair(self.interval(f"{name}_rate"), share), "", ""])
        rows.append(["length, control steps", number(self.length_mean), pair(self.interval("length_mean")), "", ""])
        if self.decisions:
            rows.append(["decisions changed by the shield", f"{self.interventions} of {self.decisions}", "", "", ""])
        return table(["", "mean", "95 % interval", "limit", "within"], rows, f"{self.episodes} episodes")

    def _sound(self, rows: Array) -> Array:
        """The episodes whose sums are valid."""
        return rows[~np.isnan(self.returns)]

    def _violations(self) -> Array:
        """[episodes] whether each is over a limit."""
        limits = [np.inf if limit is None else limit for limit in self.cost_limits]
        over: Array = np.isnan(self.returns) | (self.costs > limits).any(axis=1)
        return over


class _Plays:
    """Writes the actions of a pool for its next step."""

    def __init__(self, player: Union[Policy, str, Any], pool: Pool, action_repeat: Optional[int] = None,
                 center: Optional[FloatArray] = None, shield: Optional[Shield] = None) -> None:
        self._player, self._pool, self._center, self._shield = player, pool, center, shield
        self._policy = player.actor(pool) if isinstance(player, Policy) else None
        # a function decides at every step of its own pool, which this one's may be parts of
        self._hold = 1 if action_repeat is None else action_repeat // pool.spec.action_repeat
        self._left = np.zeros(pool.num_envs, np.int64)
        self._state: Any = None  # of a model
        self._began = np.ones(pool.num_envs, np.bool_)
        self._since = np.zeros(pool.num_envs, np.int64)  # steps of an episode so far, as the shield counts them
        self._ran = np.zeros_like(pool.action)  # what it let through
        self.stepped_in = np.zeros(pool.num_envs, np.bool_)  # whether it did in the decision that is held
        self.unproven = np.zeros(pool.num_envs, np.bool_)  # whether nothing clean was found for that decision

    def act(self, mask: Optional[Array] = None) -> None:
        self._propose(mask)
        if self._shield is not None:
            decides = self._since % self._shield.steps == 0
            if mask is not None:
                decides &= mask
            kinds = self._shield.guard(decides)
            self.stepped_in[decides] = kinds[decides] != ShieldKind.OWN
            self.unproven[decides] = kinds[decides] == ShieldKind.UNPROVEN
            self._ran[decides] = self._pool.action[decides]
            self._pool.action[...] = self._ran
            self._since += 1

    def _propose(self, mask: Optional[Array]) -> None:
        if self._policy is not None:
            self._pool.action[...] = self._policy(mask=mask)
            return
        due = self._left == 0
        if due.any():
            if isinstance(self._player, str):
                kept = self._pool.action.copy()
                self._pool.baseline(self._player)
                self._pool.action[~due] = kept[~due]
            else:
                self._pool.action[due] = self._about(self._decided())[due]
            self._left[due] = self._hold
            self._began[due] = False
        self._left -= 1

    def _decided(self) -> Any:
        if not hasattr(self._player, "predict"):
            return self._player(self._pool.obs)  # type: ignore[operator]
        obs = self._pool.obs
        normalizer = getattr(self._player, "get_vec_normalize_env", lambda: None)()
        if normalizer is not None:  # what its observations went through while it learned
            obs = normalizer.normalize_obs(obs)
        action, self._state = self._player.predict(obs, state=self._state, episode_start=self._began.copy(),
                                                   deterministic=True)
        return action

    def _about(self, actions: Any) -> Array:
        """As Worlds of the environments write them."""
        rows = np.asarray(actions)
        if rows.dtype != np.float64:
            rows = np.asarray(rows, np.float32)
        if rows.shape != self._pool.action.shape:
            raise ArgumentError(f"evaluate: the actions have shape {rows.shape}, not {self._pool.action.shape}")
        return rows if self._center is None else rows + self._center

    def restart(self, worlds: Array) -> None:
        self._left[worlds] = self._since[worlds] = 0
        self._began[worlds] = True


def _limits(usual: Mapping[str, Optional[float]], wanted: CostLimits) -> list[Optional[float]]:
    """The usual limits, overridden by the given ones."""
    rows = each_cost(wanted, [-1.0 if limit is None else limit for limit in usual.values()], list(usual), "cost_limits")
    return [None if limit < 0 else limit for limit in rows or []]


def play(pool: Pool, player: Any, episodes: int, magnitudes: bool = False, action_repeat: Optional[int] = None,
         center: Optional[FloatArray] = None, shield: Optional[Shield] = None, own: Optional[Own] = None) -> list[dict[str, Any]]:
    """Each episode's return, costs, length, fall and success; the pool's autoreset is off, and it was just reset. With
    magnitudes, costs are sums of cost_raw where it is above 0, as an agent with cost_signal=raw learns them; the pool then
    makes single control steps, since it shows only cost_raw of the last one. action_repeat: control steps that an action of
    a baseline or a function lasts, None: one step of the pool. shield checks each decision. own: rewards and costs that
    replace the task's; the pool makes single control steps then too, and `above` counts those in which a cost was above 0."""
    return played_under(pool, player, episodes, magnitudes, action_repeat, center, shield, own)[0]


def played_under(pool: Pool, player: Any, episodes: int, magnitudes: bool = False, action_repeat: Optional[int] = None,
                 center: Optional[FloatArray] = None, shield: Optional[Shield] = None,
                 own: Optional[Own] = None) -> tuple[list[dict[str, Any]], int]:
    """play(), and how many of the violating steps were of unproven decisions."""
    if (magnitudes or own) and pool.spec.action_repeat != 1:
        raise ArgumentError(f"{'costs' if own else 'magnitudes: cost_raw'} of each control step, and a step of the pool has "
                            f"{pool.spec.action_repeat}")
    n = pool.num_envs
    plays = _Plays(player, pool, action_repeat, center, shield)
    number = np.arange(n)
    playing = number < episodes
    success = np.zeros(n, np.bool_)
    raw = np.zeros((n, pool.cost_dim if own is None else len(own.names(pool))))
    gained, above, inevitable = np.zeros(n), np.zeros(n, np.int64), 0
    flagged = np.zeros((n, len(_STEP_FLAGS)), np.int64)  # steps so far
    out: list[dict[str, Any]] = [{} for _ in range(episodes)]
    while playing.any():
        plays.act(playing)
        unproven = plays.unproven & playing
        if unproven.any():  # step by themselves, so that the pool's count is theirs
            before = pool.stats.violations
            pool.step(mask=unproven)
            inevitable += 0 if own else pool.stats.violations - before
        if (playing & ~unproven).any():
            pool.step(mask=playing & ~unproven)
        success |= pool.success & playing
        if own is None:
            raw += np.maximum(pool.cost_raw, 0) * playing[:, None]
        else:
            reward, cost = own.look(pool)
            gained += reward * playing
            raw += cost * playing[:, None]
            violates = (cost > 0).any(axis=1) & playing
            above += violates
            inevitable += int((violates & unproven).sum())
        for k, bit in enumerate(_STEP_FLAGS.values()):
            flagged[:, k] += (pool.status & bit != 0) & playing
        ended = (pool.terminated | pool.truncated) & playing
        if not ended.any():
            continue
        for i in np.flatnonzero(ended):
            cost = raw[i].copy() if magnitudes or own else pool.episode_cost[i].astype(np.float64)
            out[number[i]] = {"return": float(gained[i] if own else pool.episode_return[i]), "cost": cost, "above": int(above[i]),
                              "length": int(pool.episode_step[i]), "fall": bool(pool.terminated[i]),
                              "success": bool(success[i]), "status": int(pool.episode_status[i]),
                              **dict(zip(_STEP_FLAGS, flagged[i].tolist()))}
            number[i] += n
        success[ended] = False
        raw[ended] = gained[ended] = above[ended] = 0
        flagged[ended] = 0
        playing = number < episodes
        again = ended & playing
        if again.any():
            pool.reset(mask=again)
            plays.restart(again)
    return out, inevitable


@dataclass
class _Judged:
    """The player, and what is known about how to evaluate it."""

    player: Any
    origin: Optional[Origin] = None
    task: Optional[str] = None
    action_repeat: Union[None, int, str] = None  # of the environment that a model learned in
    center: Center = None
    options: Mapping[str, Any] = field(default_factory=dict)


def _judged(player: Player, task: Optional[str]) -> _Judged:
    from ._agent import Agent
    from ._run import Run
    if isinstance(player, Run):
        player = player.policy
    if isinstance(player, Agent):
        player = player.policy()
    if isinstance(player, (str, os.PathLike)):
        player = _named(player, task)
    if isinstance(player, Policy):
        return _Judged(player, player.origin, player.info.task or None)
    if isinstance(player, str):
        return _Judged(player)
    if hasattr(player, "predict"):
        return _of_model(player)
    if callable(player):
        return _Judged(player)
    raise ArgumentError(f"evaluate: give a policy, a run, a folder, a baseline, a function of rows or a model with predict, not "
                        f"{player!r}")


def _named(word: Union[str, os.PathLike[str]], task: Optional[str]) -> Union[Policy, str]:
    """A baseline, "trained", or a file or folder of a policy."""
    if word in _BASELINES:
        return str(word)
    if word == "trained":
        if task is None:
            raise ArgumentError("evaluate: the task is missing: give task=")
        return Policy.trained(task)
    if Path(word).exists():
        return Policy.load(word)
    raise NotFoundError(f"evaluate: {os.fspath(word)!r} is no file or folder, nor one of {', '.join(_BASELINES)}, trained"
                        f"{nearest(os.fspath(word), (*_BASELINES, 'trained'))}")


def _of_model(model: Any) -> _Judged:
    """A model of another library, and how its environment relates to its pool."""
    pool, worlds = worlds_of(getattr(model, "get_env", lambda: None)())
    if pool is None or worlds is None:
        return _Judged(model)
    return _Judged(model, task=pool.task.name, action_repeat=pool.spec.action_repeat, center=worlds.center,
                   options=pool._config["options"])


@keywords(aliases={"envs": "num_envs", "n_envs": "num_envs", "num_threads": "threads", "cost_limit": "cost_limits",
                   "num_episodes": "episodes", "n_episodes": "episodes", "n_eval_episodes": "episodes", "policy": "player",
                   "model": "player", "env_id": "task", "env": "task"},
          hints={"deterministic": "the mean action plays; a sampling one is redman.evaluate(policy.actor(pool, stochastic=True))",
                 "render": "policy.render(\"throw.html\"), or .png, .mp4, .gif"}, options=True)
def evaluate(player: Player, task: Optional[TaskName] = None, episodes: int = 100, num_envs: int = 16, seed: int = 0,
             threads: Optional[int] = None, options: Optional[Options] = None, cost_limits: CostLimits = None,
             magnitudes: Optional[bool] = None, *, action_repeat: Union[None, int, str] = None, center: Center = None,
             shield: Shielding = None, shield_policy: Optional[Backup] = None, reward: Optional[RowFunction] = None,
             costs: Optional[Costs] = None) -> Evaluation:
    """How good a policy is over whole episodes, an Evaluation: the same episodes as `redman eval` plays for the same seed and number
    of worlds.

        print(redman.evaluate("runs/first"))
        print(redman.evaluate("trained", "ball_run", episodes=500, cost_limits=20).cost_mean)

    player: a Policy, a Run, a run folder or policy file, an Agent, "trained" (the policy that comes with the task), a baseline
    ("zero", "hold", "random"), a function of rows obs [num_envs][obs_dim], or a model with Stable-Baselines3's predict.
    task: None is that of the player. episodes: 1 or more. num_envs: worlds that play side by side, 1 or more. seed: 0 to
    2^64 - 1, seed + i for world i. options: of the task, a dict.

    For a policy that comes from a run, the run's task, options, limits and cost signal are used, as in `redman eval --policy
    FOLDER`; arguments override them. For a model that has an environment of redman.sb3, the task, options, action_repeat,
    center and VecNormalize of that environment are used. For functions and other models, say what they learned with:
    action_repeat, the control steps that an action lasts ("task": as long as a decision of the task's own learner; policies
    of redman hold their actions themselves), and center, what an action of 0 does ("initial", or [action_dim]).

    With magnitudes, costs are sums of cost_raw where it is above 0, as an agent with cost_signal=raw learns them.
    threads: None uses all cores that this process may use; the episodes are the same for any number. cost_limits: a number
    for the first cost, a list with one for each, or a dict by name.

    reward, costs: functions of your own that replace the task's reward and costs, as in redman.train. For a policy of a run
    with such functions, these are used unless others are given.

        redman.evaluate("trained", "ball_run", costs={"fast": lambda rows: rows.speed("velocity") > 2}, cost_limits=20)

    shield: a redman.Shield checks every decision; True, or a dict of its options, budgets, seed and threads. Its first
    backup is shield_policy, or the policy itself. As in `redman eval`, the options choose=best and unproven=least hold unless
    others are given: when nothing keeps the budgets in a world, the action that exceeds them least runs, and steps that cost
    are counted in violating_steps and in inevitable_steps; with shield={"unproven": "error"} StateError is raised.
    """
    if int32(episodes, "episodes") < 1:
        raise ArgumentError(f"episodes: {episodes} is less than 1")
    options = as_dict(options)
    task = None if task is None else task_name(task)
    judged = _judged(player, task)
    origin = judged.origin
    known = judged.task or (origin.task if origin else None)
    if task is None and known is None:
        raise ArgumentError("evaluate: the task is missing: give task=")
    chosen = known if task is None else task
    assert chosen is not None
    own: Mapping[str, Any] = {}
    functions = Own.wanted(reward, costs)
    usual: Optional[Mapping[str, float]] = None  # limits of the run
    if known is not None and folded(chosen) == folded(known):
        own = judged.options
        if origin is not None and folded(origin.task) == folded(chosen):
            own = origin.options
            usual = origin.cost_limits
            magnitudes = origin.magnitudes if magnitudes is None else magnitudes
            if origin.own is not None:
                functions = origin.own if functions is None else functions
    given_options = {folded(key) for key in options}
    laid = {key: value for key, value in own.items() if folded(key) not in given_options}
    laid.update(options)
    if isinstance(judged.player, Policy) and center is not None:
        raise ArgumentError("center: it cannot be given with a policy of redman, whose actions need no center")
    repeat = judged.action_repeat if action_repeat is None else action_repeat
    if repeat is not None and "action_repeat" not in given_options:
        laid = {key: value for key, value in laid.items() if folded(key) != "action_repeat"}
        laid["action_repeat"] = 0 if repeat == "task" else repeat
    center = judged.center if center is None else center
    worlds = min(int32(num_envs, "num_envs"), episodes)
    threads = all_cores(threads, worlds)
    pool = Pool(chosen, worlds, seed, threads, autoreset="off", options=laid)
    steps = pool.spec.action_repeat
    if (magnitudes or functions) and steps > 1:
        pool = Pool(chosen, worlds, seed, threads, autoreset="off", options=singly(laid))
    if functions is not None:
        functions.ready(pool)
        magnitudes = False
    names = list(pool.cost_names) if functions is None else functions.names(pool)
    if usual is not None:
        known_limits: dict[str, Optional[float]] = {name: usual.get(name) for name in names}
    elif functions is None or functions.costs is None:
        known_limits = {name: cost.limit for name, cost in pool.costs.items()}
    else:
        known_limits = {name: None for name in names}
    limits = _limits(known_limits, cost_limits)
    player = judged.player
    if isinstance(player, Policy):
        held = player.info.action_repeat // pool.spec.action_repeat
        if is_wanted(shield) and shield_policy is None and not player.info.num_points:
            shield_policy = player
    else:
        held = steps // pool.spec.action_repeat
    with pool:
        guard = shield_of(pool, shield, shield_policy, held, _PLAYED)
        pool.reset()
        played, inevitable = played_under(pool, player, episodes, bool(magnitudes), steps, center_of(pool, center), guard, functions)
        counts = {} if guard is None else {"decisions": guard.stats.decisions, "interventions": guard.interventions,
                                           "inevitable_steps": inevitable}
        above = pool.stats.violations if functions is None else sum(episode["above"] for episode in played)
        return summary(played, limits, above, names, **counts)


def singly(options: Mapping[str, Any]) -> dict[str, Any]:
    """The same options with single control steps."""
    return {**{key: value for key, value in options.items() if folded(key) != "action_repeat"}, "action_repeat": 1}


def summary(played: Sequence[dict[str, Any]], limits: Sequence[Optional[float]], violating_steps: int, names: Sequence[str] = (),
            **shielded: int) -> Evaluation:
    """Means over episodes, with a warning where worlds failed. shielded: decisions, interventions and inevitable_steps."""
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
    measured = np.array([not episode["status"] & sum(_END_FLAGS.values()) for episode in played])

    def of_each(values: Sequence[Any]) -> DoubleArray:
        rows = np.array(values, np.float64)
        rows[~measured] = np.nan
        rows.flags.writeable = False
        return rows

    successes = np.array([episode["success"] for episode in played]) & measured
    successes.flags.writeable = False

    def share(values: Any) -> float:
        return float(np.mean(values)) if len(values) else float("nan")

    return Evaluation(
        episodes=len(played), return_mean=share(returns), return_std=float(returns.std()),
        cost_mean=costs.mean(axis=0).tolist(), cost_std=costs.std(axis=0).tolist(),
        length_mean=share([episode["length"] for episode in sound]),
        success_rate=sum(episode["success"] for episode in sound) / len(played),
        fall_rate=share([episode["fall"] for episode in sound]),
        violation_rate=(int(over.sum()) + lost) / len(played), cost_limits=list(limits),
        violating_steps=violating_steps, returns=of_each([episode["return"] for episode in played]),
        costs=of_each([episode["cost"] for episode in played]), lengths=of_each([episode["length"] for episode in played]),
        successes=successes, cost_names=tuple(names), **shielded, **counts)


def episode_of(policy: Policy, task: Optional[TaskName] = None, *, seed: int = 0, options: Optional[Options] = None,
               steps: Optional[int] = None, shield: Shielding = None, shield_policy: Optional[Backup] = None) -> Episode:
    """Policy.episode."""
    origin = policy.origin
    known = policy.info.task or (origin.task if origin else None)
    name = known if task is None else task_name(task)
    if not name:
        raise ArgumentError("episode: the task is missing: give task=")
    laid: dict[str, Any] = {}
    limits: Optional[Mapping[str, float]] = None
    own = None
    if origin is not None and folded(origin.task) == folded(name):
        laid, limits, own = dict(origin.options), origin.cost_limits, origin.own
    options, steps = as_dict(options), None if steps is None else int32(steps, "steps")
    given_options = {folded(key) for key in options}
    laid = singly({**{key: value for key, value in laid.items() if folded(key) not in given_options}, **options})
    with Pool(name, 1, seed, autoreset="off", options=laid) as pool:
        if own is not None:
            own.ready(pool)
        if is_wanted(shield) and shield_policy is None and not policy.info.num_points:
            shield_policy = policy
        guard = shield_of(pool, shield, shield_policy, policy.info.action_repeat, _PLAYED)
        pool.reset()
        return played(pool, policy, actor=policy._word, limits=limits, own=own, steps=steps, shield=guard)
