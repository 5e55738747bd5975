"""Rewards and costs of your own: functions of rows of all worlds, which replace those of a task in train and evaluate."""
from __future__ import annotations

import inspect
import math
from typing import TYPE_CHECKING, Any, Callable, Mapping, Optional, Sequence, Union

import numpy as np

from ._abi import Status
from ._error import ArgumentError, NotFoundError, UsageError
from ._imported import path_of, thing_at
from ._library import instance
from ._names import Hinted, nearest
from ._pool import Pool
from ._rows import Array, FloatArray

if TYPE_CHECKING:
    from ._agent import Agent, Epoch

_LOST = int(Status.DIVERGED) | int(Status.BAD_ACTION) | int(Status.TASK)


class Rows(Hinted):
    """What the worlds of a pool show after a control step, one row for each world. Rewards and costs of your own are functions of
    it.

        redman.train("ball_run", costs={"fast": lambda rows: rows.speed("velocity") > 2}, cost_limits=20)

    obs is what learners see, with the noise that options give it. rows.pool has the rest, such as poses and contacts; in training
    it shows the next episode already in a world whose episode has just ended.
    """

    pool: Pool

    def __init__(self, pool: Pool) -> None:
        self.pool = instance(pool, Pool, "pool")

    @property
    def obs(self) -> FloatArray:
        """[n][obs_dim] after the step; where an episode ended, its last observation."""
        return self.pool.final_obs

    @property
    def action(self) -> FloatArray:
        """[n][action_dim] the actions that ran, in [-1, 1]."""
        return np.clip(self.pool.action, -1, 1)

    @property
    def reward(self) -> FloatArray:
        """[n] the reward of the task."""
        return self.pool.reward

    @property
    def costs(self) -> dict[str, FloatArray]:
        """The costs of the task by name, [n] each."""
        return {name: self.pool.cost[:, k] for k, name in enumerate(self.pool.cost_names)}

    @property
    def costs_raw(self) -> dict[str, FloatArray]:
        """The measured values behind the costs of the task by name, [n] each."""
        return {name: self.pool.cost_raw[:, k] for k, name in enumerate(self.pool.cost_names)}

    @property
    def success(self) -> Array:
        """[n] whether the task's success holds in this step."""
        return self.pool.success

    @property
    def terminated(self) -> Array:
        """[n] whether the task ended the episode in this step."""
        return self.pool.terminated

    @property
    def truncated(self) -> Array:
        """[n] whether the time limit, or a fault, ended the episode in this step."""
        return self.pool.truncated

    @property
    def step(self) -> Array:
        """[n] number of control steps of the episode, from 1."""
        return self.pool.episode_step

    @property
    def n(self) -> int:
        """Number of worlds."""
        return self.pool.num_envs

    def field(self, name: str) -> FloatArray:
        """[n][count] the field `name` of the observation in SI units: one with unit "5 m/s" is multiplied by 5. pool.fields
        lists all."""
        fields = self.pool._fields
        if not isinstance(name, str) or name not in fields:
            raise fields.unknown(name)
        scale = fields[name].scale
        if math.isnan(scale):
            raise ArgumentError(f"field {name}: its entries have different units ({fields[name].unit}): take "
                                f"rows.obs[:, rows.pool.fields[{name!r}].slice]")
        part: FloatArray = self.obs[:, fields[name].slice]
        return part if scale == 1 else part * np.float32(scale)

    def speed(self, name: str) -> FloatArray:
        """[n] the length of the field `name` that is a vector, such as a velocity, in SI units."""
        length: FloatArray = np.linalg.norm(self.field(name), axis=1)
        return length

    __getitem__ = field

    def _no_attribute(self, name: str) -> AttributeError:
        if name in self.pool._fields:
            return AttributeError(f"Rows.{name}: it is a field of the observation: rows.field({name!r})")
        return super()._no_attribute(name)

    def __repr__(self) -> str:
        return f"<Rows of {self.n} worlds of {self.pool.task.name}>"


RowFunction = Callable[[Rows], Any]
# Costs by name: a function of Rows that returns [n], a flag or a number not below 0; or the name of a cost of the task, which
# stays. A function, or a list of them, goes by its own name.
Costs = Union[Mapping[str, Union[RowFunction, str]], Sequence[RowFunction], RowFunction]


class Own:
    """The functions of a run or of an evaluation."""

    def __init__(self, reward: Optional[RowFunction], costs: Optional[Costs], where: str = "") -> None:
        self.where = where  # whose they are, where they were read
        if reward is not None:
            if not callable(reward):
                raise UsageError(f"reward: it must be a function of redman.Rows, not {reward!r}")
            _need_one_argument("reward", reward)
        self.reward = reward
        self.costs = None if costs is None else _by_name(costs)
        self._paths: dict[str, Optional[str]] = {}  # of functions that were not imported yet, by what they are

    @classmethod
    def wanted(cls, reward: Optional[RowFunction], costs: Optional[Costs]) -> Optional[Own]:
        return None if reward is None and costs is None else cls(reward, costs)

    @classmethod
    def of_config(cls, config: Mapping[str, Any], where: str) -> Optional[Own]:
        """The functions that config.json of a run names by import paths, by names of costs, or by null if they have no path."""
        if "own_reward" not in config and "own_costs" not in config:
            return None
        own = cls(None, None, where)
        if "own_reward" in config:
            own.reward = _later
            own._paths["reward"] = config["own_reward"]
        if "own_costs" in config:
            own.costs = {}
            for name, path in dict(config["own_costs"]).items():
                known = isinstance(path, str) and ":" not in path
                own.costs[str(name)] = str(path) if known else _later
                if not known:
                    own._paths[f"cost {name}"] = path
        return own

    def config(self) -> dict[str, Any]:
        """The members for config.json."""
        out: dict[str, Any] = {}
        if self.reward is not None:
            out["own_reward"] = self._path("reward", self.reward)
        if self.costs is not None:
            out["own_costs"] = {name: self._path(f"cost {name}", cost) for name, cost in self.costs.items()}
        return out

    def _path(self, what: str, given: Union[RowFunction, str]) -> Optional[str]:
        if what in self._paths:
            return self._paths[what]
        return given if isinstance(given, str) else path_of(given)

    def given(self, own: Own) -> Own:
        """Replaces functions of the folder by those that were given."""
        for what, mine, theirs in (("reward", self.reward, own.reward), ("costs", self.costs, own.costs)):
            if theirs is not None and mine is None:
                raise UsageError(f"{self.where}: the run learns the task's own {what}, so that {what}= cannot replace it")
        if own.reward is not None:
            self.reward = own.reward
            self._paths.pop("reward", None)
        for name, cost in (own.costs or {}).items():
            assert self.costs is not None
            if name not in self.costs:
                raise NotFoundError(f"costs: {self.where} has no cost {name}{nearest(name, self.costs)}; there are "
                                    f"{', '.join(self.costs)}")
            self.costs[name] = cost
            self._paths.pop(f"cost {name}", None)
        return self

    def names(self, pool: Pool) -> list[str]:
        """The names of the columns of cost."""
        return list(pool.cost_names) if self.costs is None else list(self.costs)

    def ready(self, pool: Pool) -> Own:
        """Imports functions that a folder names, and checks names of costs of the task."""
        for what, path in list(self._paths.items()):
            if path is None:
                said = "reward=function" if what == "reward" else f"costs={{{what[5:]!r}: function, ...}}"
                raise UsageError(f"{self.where}: its {what} was a function that cannot be imported, such as a lambda: give {said}")
            function = thing_at(path, f"{self.where}: its {what}")
            if what == "reward":
                self.reward = function
            else:
                assert isinstance(self.costs, dict)
                self.costs[what[5:]] = function
            del self._paths[what]
        for name, cost in (self.costs or {}).items():
            if isinstance(cost, str) and cost not in pool.cost_names:
                raise NotFoundError(f"costs[{name!r}]: {pool.task.name} has no cost {cost}{nearest(cost, pool.cost_names)}; "
                                    f"there are {', '.join(pool.cost_names)}")
        return self

    def look(self, pool: Pool) -> tuple[FloatArray, FloatArray]:
        """The reward [n] and cost [n][columns] of the last step."""
        rows = Rows(pool)
        lost = (pool.status & _LOST) != 0
        reward = pool.reward if self.reward is None else _values("reward", self.reward, rows, lost)
        if self.costs is None:
            return reward, pool.cost
        cost = np.empty((pool.num_envs, len(self.costs)), np.float32)
        for k, (name, function) in enumerate(self.costs.items()):
            what = f"costs[{name!r}]"
            cost[:, k] = rows.costs[function] if isinstance(function, str) else _values(what, function, rows, lost)
            if cost[:, k].min() < 0:
                raise ArgumentError(f"{what}: it returned {cost[:, k].min():g}, but a cost must not be below 0")
        return reward, cost

    def rollout(self, agent: Agent, pool: Pool) -> Epoch:
        """Does what agent.rollout(pool) does, with the rewards and costs of these functions."""
        hold = int(agent.options["action_repeat"]) // pool.spec.action_repeat
        eyes = bool(agent.options.get("encoder"))
        try:
            for _ in range(int(agent.options["horizon"])):
                if eyes:
                    seen = pool.sensors
                    pool.action[...] = agent.act(pool.obs, points=seen.points, point_class=seen.point_class,
                                                 point_color=seen.point_color)
                else:
                    agent.act(pool.obs, out=pool.action)
                self._hold(agent, pool, hold)
            return agent.update(pool.obs)
        except BaseException:
            agent.discard()
            raise

    def _hold(self, agent: Agent, pool: Pool, hold: int) -> None:
        """Makes one decision: worlds hold its action; a world whose episode ends rests until the next decision."""
        n = pool.num_envs
        live, valid = np.ones(n, np.bool_), np.ones(n, np.bool_)
        reward, cost = np.zeros(n, np.float32), np.zeros((n, agent.cost_dim), np.float32)
        terminated, truncated, success = (np.zeros(n, np.bool_) for _ in range(3))
        steps, status = np.zeros(n, np.int32), np.zeros(n, np.uint32)
        for _ in range(hold):
            pool.step(mask=live)
            gained, charged = self.look(pool)
            ended = pool.terminated | pool.truncated
            only_reset = live & (pool.episode_step == 0) & ~ended  # a reset that had failed before
            valid &= ~only_reset
            counts = live & ~only_reset
            terminated[live], truncated[live] = (pool.terminated & counts)[live], (pool.truncated & counts)[live]
            status[live] |= pool.status[live]
            reward[counts] += gained[counts]
            cost[counts] += charged[counts]
            steps[counts] += 1
            success[counts] |= pool.success[counts]
            live &= valid & ~ended
            if not live.any():
                break
        agent._record("record", reward=reward, cost=cost, terminated=terminated, truncated=truncated, final_obs=pool.final_obs,
                      valid=valid, success=success, steps=steps, status=status)

    def __getstate__(self) -> dict[str, Any]:
        """The import paths: a copy in another process imports the functions."""
        return {"config": self.config(), "where": self.where}

    def __setstate__(self, saved: Mapping[str, Any]) -> None:
        own = Own.of_config(saved["config"], saved["where"] or "this policy")
        assert own is not None
        self.__dict__.update(own.__dict__)


def _later(rows: Rows) -> Any:
    """Stands for a function that was not imported yet."""
    raise UsageError("own costs: they are not imported yet: call ready() first")


def _by_name(costs: Costs) -> dict[str, Union[RowFunction, str]]:
    listed: Any = [costs] if callable(costs) else costs
    if isinstance(listed, str) or not hasattr(listed, "__iter__"):
        raise UsageError(f"costs: it must be a dict of functions by name, such as costs={{\"fast\": function}}, not {costs!r}")
    if not isinstance(listed, Mapping):
        named = [getattr(cost, "__name__", "<") for cost in listed]
        if any("<" in name for name in named):
            raise UsageError("costs: a function that is not in a dict needs a name of its own: give costs={\"fast\": function}")
        listed = dict(zip(named, listed))
    if not listed:
        raise UsageError("costs: give at least one cost; algo=\"ppo\" learns without costs")
    for name, cost in listed.items():
        if not isinstance(name, str) or not name or set(name) & set("=,/\n"):
            raise UsageError(f"costs: {name!r} is not a name: use letters, digits and _")
        if not callable(cost) and not isinstance(cost, str):
            raise UsageError(f"costs[{name!r}]: it must be a function of redman.Rows or the name of a cost of the task, not {cost!r}")
        if callable(cost):
            _need_one_argument(f"costs[{name!r}]", cost)
    return dict(listed)


def _need_one_argument(what: str, function: RowFunction) -> None:
    try:
        inspect.signature(function).bind(None)
    except TypeError:
        raise UsageError(f"{what}: it is called with one argument, a redman.Rows") from None
    except ValueError:  # of a function in C
        pass


def _values(what: str, function: Any, rows: Rows, lost: Array) -> FloatArray:
    """[n] the result of a function; 0 where a world diverged and the result is not finite."""
    given = np.asarray(function(rows))
    if given.shape not in ((rows.n,), () if rows.n == 1 else (rows.n,)) or given.dtype.kind not in "biuf":
        raise ArgumentError(f"{what}: it returned {given.dtype} of shape {given.shape}, but must return one number for each of {rows.n} worlds: "
                            f"({rows.n},)")
    out = np.empty(rows.n, np.float32)
    out[...] = given
    wrong = ~np.isfinite(out)
    if wrong.any():
        out[wrong & lost] = 0
        if (wrong & ~lost).any():
            raise ArgumentError(f"{what}: it returned {out[wrong & ~lost][0]} in world {int(np.flatnonzero(wrong & ~lost)[0])}")
    return out

