"""Planner: finds actions by trying them out in copies of a world. Experimental, like redman/plan.h."""
from __future__ import annotations

import contextlib
import ctypes
import threading
from ctypes import byref
from typing import Any, Callable, Iterable, Mapping, Optional, Sequence

import numpy as np

from . import _abi, _discovery
from ._actor import on_task
from ._agent import Agent
from ._callbacks import c_function
from ._error import UsageError
from ._library import Handle, assign, bytes_of, check, filled, instance, int32, lib, raw, sized
from ._limits import CostLimits, each_cost
from ._names import Hinted, keywords
from ._options import Options, Value, as_dict, read_settings, settings_of
from ._policy import Backup, policy_of
from ._pool import Pool
from ._rows import FloatArray, given

Stop = Callable[[int], Any]


class PlanInfo(_abi.PlanInfo):
    """What Planner.act found. ret and cost: discounted sum of rewards and sum of each cost of the best plan; costs: the same
    by name. feasible_share: share of the plans tried that are within the limits. planned: False where the previous plan was
    followed. cut: whether stop ended it early, after the given iterations. steps: control steps of all copies."""

    planned: bool
    cut: bool
    costs: dict[str, float]

    def __init__(self, struct: _abi.rdm_plan_info, names: Sequence[str]) -> None:
        super().__init__(struct)
        cost = tuple(struct.cost[:len(names)])
        self.__dict__.update(planned=bool(struct.planned), cut=bool(struct.cut), cost=cost, costs=dict(zip(names, cost)))


class Planner(Hinted):
    """Finds the next action of one world: simulates many copies of it, each with a noisy variation of a plan, and moves the
    plan towards what went best. Among plans within the cost limits the one with the highest return is best; all others rank
    behind them, by their cost.

        pool = redman.Pool("ball_run")
        pool.reset()
        planner = redman.Planner(pool, options={"method": "cem", "samples": 64, "horizon": 20})
        for _ in range(100):
            pool.step(planner.act())                # or planner.act(env=3), of a pool with more worlds
        print(planner.info.ret, planner.info.feasible_share, pool.episode_return)

    One planner follows one world's episode: call reset() when another begins. options: redman.planner_options() has them with
    their help. noise: standard deviation of each entry of an action, [action_dim] or a number; None: option noise.
    cost_limits: on the sum of each cost over an episode, as Agent's; None: the task's on column 0. policy: proposes plans,
    and the noise is added to them; a Policy, its file or run folder, or "trained". agent: its critic values the states where
    a rollout ends. threads: of the rollouts; 0: as many as the pool has. stop(steps) is called before each step of the
    copies with their number of control steps so far: a true result ends the call with the best plan so far.

    The model is the world itself, so copies know even the random numbers that it will draw. The same seed and calls give the
    same bytes.
    """

    _hints = {
        "predict": "planner.act(env)", "step": "pool.step(planner.act())", "settings": "planner.options has all of them",
        "save": "state()", "load": "set_state(state)", "close": "a planner ends with its last reference",
        "ret": "planner.info.ret", "cost": "planner.info.cost"}
    _set_option = "Planner(pool, {}=...)"

    pool: Pool
    spec: _abi.PlannerSpec
    samples: int  # of a decision
    horizon: int  # rows of the plan

    @keywords(aliases={"num_threads": "threads", "cost_limit": "cost_limits", "critic": "agent"}, options=True)
    def __init__(self, pool: Pool, *, policy: Optional[Backup] = None, agent: Optional[Agent] = None, seed: int = 0,
                 threads: int = 0, noise: Any = None, cost_limits: CostLimits = None, options: Optional[Options] = None,
                 stop: Optional[Stop] = None) -> None:
        instance(pool, Pool, "pool")
        if agent is not None:
            instance(agent, Agent, "agent", ", which has no critics; give a policy as policy=")
        if stop is not None and not callable(stop):
            raise UsageError(f"stop: it must be a function of the number of control steps, not {stop!r}")
        first = next(iter(pool.costs.values()), None)
        usual = [-1.0] * pool.cost_dim
        if first is not None and first.limit is not None:
            usual[0] = first.limit
        self._make(pool, {
            "policy": None if policy is None else policy_of(policy, pool.task), "agent": agent, "seed": seed,
            "num_threads": threads, "options": as_dict(options),
            "noise": None if noise is None else given(noise, _abi.ROWS["rdm_planner_config"]["noise"],
                                                      {"action_dim": pool.action_dim}, "noise", spread=True).copy(),
            "cost_limits": None if cost_limits is None else each_cost(cost_limits, usual, list(pool.costs), "cost_limits"),
            "stop": stop})

    def _make(self, pool: Pool, own: dict[str, Any]) -> None:
        self.pool = pool
        config = sized(_abi.rdm_planner_config)
        check(lib.rdm_planner_config_init(byref(config), ctypes.sizeof(config)))
        assign(config, {name: own[name] for name in ("seed", "num_threads")})
        config.settings = settings_of(own["options"], {key: option.kind for key, option in _discovery.planner_options().items()})
        config.pool = pool._open()
        rows = {name: None if own[name] is None else np.ascontiguousarray(own[name], kind)
                for name, kind in (("noise", np.float32), ("cost_limits", np.float64))}
        for name, array in rows.items():
            setattr(config, name, None if array is None else array.ctypes.data)
        policy, agent, stop = own["policy"], own["agent"], own["stop"]
        config.policy = None if policy is None else policy._open()
        config.agent = None if agent is None else agent._open()
        if stop is not None:
            config.stop = self._stop = c_function("rdm_planner_config.stop", lambda _, steps: int(bool(stop(steps))))
        with on_task(pool):
            self._handle = Handle(lib.rdm_planner_create, lib.rdm_planner_destroy, byref(config))
        self._config = own
        self._agent: Optional[Agent] = agent
        self._kept = [part._handle for part in (policy, agent) if part is not None]  # which outlive it, closed or not
        self._lock = threading.RLock()
        self.spec = _abi.PlannerSpec(filled(_abi.rdm_planner_spec, lib.rdm_planner_get_spec, self._handle.value))
        self.samples, self.horizon = self.spec.samples, self.spec.horizon
        self._lengths = {"horizon": self.spec.horizon, "action_dim": self.spec.action_dim}
        self._found = sized(_abi.rdm_plan_info)

    def act(self, env: int = 0, pool: Optional[Pool] = None) -> FloatArray:
        """[action_dim] the best action for one world, env, in its present state, in another pool of the same task and options
        if one is given. StateError where no episode runs."""
        where = self.pool if pool is None else instance(pool, Pool, "pool")
        action = np.empty(self.spec.action_dim, np.float32)
        with where._lock, self._lock, contextlib.nullcontext() if self._agent is None else self._agent._lock:
            check(lib.rdm_planner_act(self._handle.value, where._open(), int32(env, "env"), action.ctypes.data,
                                      byref(self._found)))
        return action

    __call__ = act

    @property
    def info(self) -> PlanInfo:
        """What the last act found: return and costs of the best plan, the share of plans within the limits."""
        with self._lock:
            return PlanInfo(self._found, self.pool.cost_names)

    @property
    def plan(self) -> FloatArray:
        """[horizon][action_dim] the plan; row 0 is the action that act returned. The next act begins at a plan that is
        assigned."""
        out = np.empty((self.horizon, self.spec.action_dim), np.float32)
        with self._lock:
            check(lib.rdm_planner_get_plan(self._handle.value, out.ctypes.data))
        return out

    @plan.setter
    def plan(self, plan: Any) -> None:
        rows = given(plan, _abi.FUNCTIONS["rdm_planner_set_plan"].rows["plan"], self._lengths, "plan")
        with self._lock:
            check(lib.rdm_planner_set_plan(self._handle.value, rows.ctypes.data))

    @property
    def options(self) -> Mapping[str, Value]:
        """All options as this planner has them, to be read: changing an entry is an error, and dict(planner.options) is a copy.
        Planner(pool, options={...}) makes a planner with others."""
        return read_settings(lib.rdm_planner_get_settings, self._handle.value,
                             {key: option.kind for key, option in _discovery.planner_options().items()}, "Planner(pool, options={...})")

    def _option_names(self) -> Iterable[str]:
        return _discovery.planner_options()

    def reset(self) -> None:
        """Forgets the plan, as for a new episode; the stream of noise continues."""
        with self._lock:
            check(lib.rdm_planner_reset(self._handle.value))

    def cancel(self) -> None:
        """From any thread: the running act, or the next one, raises CancelledError; the plan is as before."""
        lib.rdm_planner_cancel(self._handle.value)

    def state(self) -> bytes:
        """Plan, noise and counters."""
        with self._lock:
            return bytes_of(lib.rdm_planner_write_state, self._handle.value)

    def set_state(self, state: bytes) -> None:
        """Continues from state() of a planner of the same task and options, with the same bytes."""
        data = raw(state, "state")
        with self._lock:
            check(lib.rdm_planner_read_state(self._handle.value, data, len(data)))

    def __getstate__(self) -> dict[str, Any]:
        return {"pool": self.pool, "config": self._config, "state": self.state()}

    def __setstate__(self, saved: Mapping[str, Any]) -> None:
        self._make(saved["pool"], saved["config"])
        self.set_state(saved["state"])

    def __repr__(self) -> str:
        return f"<Planner of {self.pool.task.name}: {self.samples} samples of {self.horizon} steps>"
