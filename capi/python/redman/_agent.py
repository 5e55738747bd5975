"""Agent: one algorithm that acts and learns, in the worlds of a pool or in environments of your own."""
from __future__ import annotations

import _thread
import contextlib
import ctypes
import math
import os
import threading
import time
import weakref
from ctypes import byref, c_size_t
from queue import SimpleQueue
from typing import (TYPE_CHECKING, Any, Callable, Dict, Iterable, Mapping, MutableMapping, Optional,
                    Sequence, Union)

import numpy as np

from . import _abi, _discovery
from ._abi import ActMode
from ._error import ArgumentError, Error, NotFoundError, StateError, UsageError
from ._files import read_whole, write_whole
from ._library import (Handle, assign, bytes_of, check, encoded, failure, instance, int32, lib, raw, real, sized, text)
from ._limits import CostLimits, each_cost
from ._names import Hinted, keywords, nearest, one_of
from ._options import Given, Options, Value, as_dict, kind_of, laid, option_array, read_settings, settings_of
from ._policy import Policy
from ._pool import Pool
from ._recording import Recording
from ._rows import Array, FloatArray, address, array_of, clouds, given
from ._teach import Taught
from ._tensors import Tensors

if TYPE_CHECKING:
    from ._ranks import Ranks
    from ._shield import Shield

_MODES = {"sample": ActMode.SAMPLE, "mean": ActMode.MEAN}


class Epoch(_abi.Epoch, Dict[str, Any]):  # type: ignore[misc]  # a record has a hash, a dict has none
    """One row of the learning curve; means over the last 100 finished episodes.

    costs and multipliers have the values of cost and multiplier by the names of costs. violations, refused, unproven,
    copied and inevitable are None where there was nothing to count. It is also a dict of all its values, for json.dumps and loggers.
    """

    costs: dict[str, float]
    multipliers: dict[str, float]
    # Control steps in which column 0, or a cost with a limit by the task, was above 0; None: not an epoch of rollout.
    violations: Optional[int]  # type: ignore[assignment]
    # Decisions that a shield did not let through, and of these where nothing was known to be clean; control steps of its copies;
    # violating control steps of the unproven decisions. None: there was no shield.
    refused: Optional[int]  # type: ignore[assignment]
    unproven: Optional[int]  # type: ignore[assignment]
    copied: Optional[int]  # type: ignore[assignment]
    inevitable: Optional[int]  # type: ignore[assignment]

    def __init__(self, struct: Union[_abi.rdm_epoch, Mapping[str, Any]], names: Optional[Sequence[str]] = None) -> None:
        if isinstance(struct, Mapping):  # a copy
            self.__dict__.update(struct)
        else:
            super().__init__(struct)
            columns = slice(0, None if names is None else max(len(names), 1))
            cost, multiplier = self.cost[columns], self.multiplier[columns]
            self.__dict__.update(cost=cost, multiplier=multiplier, costs=dict(zip(names or (), cost)),
                                 multipliers=dict(zip(names or (), multiplier)))
            self.__dict__.update((name, None) for name in ("violations", "refused", "unproven", "copied", "inevitable")
                                 if getattr(self, name) < 0)
        self.update(self.__dict__)

    def __reduce__(self) -> Any:
        return Epoch, (dict(self.__dict__),)


class _AgentTensors(Tensors, MutableMapping[str, FloatArray]):
    """The parameters of an agent: reading copies out, assignment copies in."""

    __slots__ = ()

    def __setitem__(self, name: str, values: Any) -> None:
        self[name]  # an unknown name is told first
        array = np.ascontiguousarray(array_of(values, name, np.float32))
        with self._owner._lock:
            check(lib.rdm_agent_set_tensor(self._owner._open(), encoded(name, "name"), array.ctypes.data,
                                             array.size))

    def __delitem__(self, name: str) -> None:
        raise TypeError("tensors cannot be deleted")


class Agent(Taught, Hinted):
    """Learns from a pool, or from rows of any origin.

        agent = redman.Agent(pool, algo="ppo_lag", seed=1, cost_limits=40)
        epoch = agent.rollout(pool)                     # act, step and record for a horizon, then update

        agent = redman.Agent(obs_dim=3, action_dim=1, num_envs=16, options={"horizon": 64})
        action = agent.act(obs)                         # and after the world's step:
        agent.record(reward, cost, terminated, truncated, final_obs)
        epoch = agent.update(obs)                       # after option horizon such decisions

        agent = redman.Agent(pool, costs=["fast"], cost_limits=5)       # costs of your own instead of the pool's
        pool.step(agent.act(pool.obs))                  # a pool with options={"action_repeat": 0}: a step is a decision
        agent.record(pool.reward, too_fast(pool.final_obs), pool.terminated, pool.truncated, pool.final_obs)

    cost_limits: a limit for column 0, one for each column (None, or NaN in an array: no limit), or a dict by the names of
    the costs. A pool gives its dimensions, its task's defaults for learners, start pose and limits; costs, names of columns,
    replace its costs and their limits. For rows of other origin, fields, {name: (offset, count)}, names parts of them for
    actor_obs and critic_obs; cost_dim is the number of costs, control_dt the seconds of a control step, max_steps the control steps
    after which an episode's sums are closed (0: never), layout_hash a number that the policy file keeps, and initial_mean
    [action_dim] the actions that the untrained policy begins around. threads: of the update; 0: the calling thread alone; results
    are the same for any number. ranks: the place of this process among several that learn together (redman.Ranks). One thread
    uses an agent at a time; others wait.
    """

    _hints = {
        "train": "agent.learn(steps), agent.rollout(pool) for one epoch; redman.train(task, steps=...) is a whole run",
        "predict": "agent.act(obs, 'mean'), or agent.policy().act(obs)",
        "evaluate": "redman.evaluate(agent.policy(), task)", "parameters": "agent.tensors",
        "state_dict": "agent.tensors has the parameters by name, agent.save() all of its state",
        "load_state_dict": "agent.tensors[name] = array, or agent.load(state)"}
    _set_option = "agent.set({}=...)"

    algo: _discovery.Algo
    obs_dim: int
    action_dim: int
    cost_dim: int
    num_envs: int

    @keywords(aliases={"cost_limit": "cost_limits", "num_threads": "threads"}, options=True)
    def __init__(self, pool: Optional[Pool] = None, algo: str = "ppo_lag", seed: int = 0, threads: int = 0,
                 options: Optional[Options] = None, cost_limits: CostLimits = None, *,
                 obs_dim: Optional[int] = None, action_dim: Optional[int] = None, num_envs: Optional[int] = None,
                 cost_dim: Optional[int] = None, costs: Optional[Sequence[str]] = None, task: str = "",
                 control_dt: float = 0.0, max_steps: int = 0, layout_hash: int = 0, initial_mean: Any = None,
                 fields: Optional[Mapping[str, tuple[int, int]]] = None, ranks: Optional[Ranks] = None) -> None:
        own: dict[str, Any] = {"algo": algo, "seed": seed, "num_threads": threads, "options": as_dict(options),
                               "ranks": ranks}
        if costs is not None and (isinstance(costs, (str, bytes, type)) or not hasattr(costs, "__iter__") or
                                  not all(isinstance(name, str) for name in costs)):
            raise UsageError(f"costs: it must be a list of names, such as [\"fast\"], not {costs!r}")
        columns: Sequence[str] = [] if costs is None else list(costs)
        cost_dim = None if cost_dim is None else int32(cost_dim, "cost_dim")
        if costs is not None and cost_dim not in (None, len(columns)):
            raise ArgumentError(f"cost_dim: it is {cost_dim}, but costs has {len(columns)} names")
        if pool is not None:
            brought = {"obs_dim": obs_dim, "action_dim": action_dim, "num_envs": num_envs, "task": task or None,
                       "control_dt": control_dt or None, "max_steps": max_steps or None,
                       "layout_hash": layout_hash or None, "fields": fields,
                       "cost_dim": cost_dim if costs is None else None}
            for name, value in brought.items():
                if value is not None:
                    instead = "; costs=[names] replaces its costs by your own" if name == "cost_dim" else ""
                    raise ArgumentError(f"{name}: a pool brings its own{instead}")
            own.update(_config_of(pool))
            if costs is None:
                columns = list(pool.costs)
            else:
                own.update(cost_dim=len(columns), cost_limits=[-1.0] * len(columns))
        else:
            if obs_dim is None or action_dim is None:
                raise ArgumentError("agent: give a pool, or obs_dim and action_dim")
            if costs is None:
                columns = [f"cost {k}" for k in range(1 if cost_dim is None else cost_dim)]
            own.update(obs_dim=obs_dim, action_dim=action_dim, num_envs=1 if num_envs is None else num_envs,
                       cost_dim=len(columns) if cost_dim is None else cost_dim, task=task, control_dt=control_dt,
                       max_steps=max_steps, layout_hash=layout_hash, initial_mean=None, defaults={}, cost_limits=None,
                       fields=[] if fields is None else _named_parts(fields))
        if initial_mean is not None:
            lengths = {"action_dim": int32(own["action_dim"], "action_dim")}
            own["initial_mean"] = given(initial_mean, _abi.ROWS["rdm_agent_config"]["initial_mean"], lengths, "initial_mean",
                                        spread=True).copy()
        own["cost_names"] = list(columns)
        own["cost_limits"] = each_cost(cost_limits, own["cost_limits"], columns, "cost_limits")
        self._lock = threading.RLock()
        self._pool = None if pool is None else weakref.ref(pool)
        self._make(own)

    def _make(self, config: dict[str, Any]) -> None:
        self._config = config
        self._handle: Optional[Handle] = _created(config)
        self._a = self._handle.value
        self._shield: Optional[Shield] = None
        self._recording: Optional[Recording] = None
        self._lengths = {name: int(config[name]) for name in ("obs_dim", "action_dim", "cost_dim", "num_envs")}
        vars(self).update(self._lengths, algo=_discovery.algo(config["algo"]))

    # ---- learning ---------------------------------------------------------------------------------------------

    def act(self, obs: Any, mode: str = "sample", out: Optional[FloatArray] = None, points: Any = None,
            point_class: Any = None, point_color: Any = None) -> FloatArray:
        """Actions [num_envs][action_dim] for obs [num_envs][obs_dim]: a sample, after which record must be called (mode
        "sample"), or the mean (mode "mean"). out: the array that they are written to and that is returned; None: a new one.

        One call is one decision, to be held for option action_repeat control steps. Samples are not clipped. An agent with
        option encoder takes points [num_envs][encoder_points][3] too, with encoder_classes their classes (point_class
        [num_envs][encoder_points]), and with encoder_color their colours (point_color [num_envs][encoder_points][3]), 0 to 255.
        """
        chosen = one_of(mode, _MODES, "mode")
        rows = self._given("rdm_agent_act", "obs", obs)
        shape = (self.num_envs, self.action_dim)
        action = np.empty(shape, np.float32) if out is None else out
        if not isinstance(action, np.ndarray) or action.shape != shape:
            raise UsageError(f"out: it must be an array [num_envs][action_dim] = {shape}, not {out!r}")
        direct = action.dtype == np.float32 and action.flags.c_contiguous
        target = action if direct else np.empty(shape, np.float32)
        with self._lock:
            if points is None:
                self._check(lib.rdm_agent_act(self._a, rows.ctypes.data, chosen, target.ctypes.data))
            else:
                seen, kept = clouds(points, point_class, point_color, self.num_envs)
                self._check(lib.rdm_agent_act_points(self._a, rows.ctypes.data, byref(seen), chosen,
                                                     target.ctypes.data))
                del kept
        if not direct:
            action[...] = target
        return action

    def forget(self, mode: str = "sample", mask: Any = None) -> None:
        """Clears the memory of the worlds in which mask [num_envs] is true; None: of all.

        record clears the memory of sampled actions when an episode ends. The memory of mean actions (mode "mean") is separate,
        so that evaluation does not disturb it, and only this call clears it.
        """
        chosen = None if mask is None else self._given("rdm_agent_forget", "mask", mask)
        with self._lock:
            self._check(lib.rdm_agent_forget(self._a, one_of(mode, _MODES, "mode"), address(chosen)))

    def record(self, reward: Any, cost: Any = None, terminated: Any = None, truncated: Any = None,
               final_obs: Any = None, valid: Any = None, success: Any = None, steps: Any = None,
               limit: Any = None) -> None:
        """Records what followed the last sampled actions, a row per world. None means: no ends, all rows are valid, no
        success, what follows a truncation is valued 0, a decision took as many control steps as option action_repeat says.

        reward [num_envs] and cost [num_envs][cost_dim] are sums over the decision, costs not below 0. terminated, truncated and
        success [num_envs]: whether the task ended, the time was over, the task succeeded. final_obs [num_envs][obs_dim] is read
        where truncated. valid [num_envs]: rows to learn from. steps [num_envs]: control steps that it took. limit: the limit on
        column 0 that each world's episode has for itself, instead of cost_limit.
        """
        self._record("record", reward=reward, cost=cost, terminated=terminated, truncated=truncated, final_obs=final_obs,
                     valid=valid, success=success, steps=steps, limit=limit)

    def _record(self, call: str, **said: Any) -> None:
        transition, kept = self._transition(call, **said)
        with self._lock:
            self._check(lib.rdm_agent_record(self._a, byref(transition)))
        del kept

    def put(self, obs: Any, action: Any, reward: Any, cost: Any = None, terminated: Any = None, truncated: Any = None,
            final_obs: Any = None, valid: Any = None, success: Any = None, steps: Any = None,
            generation: int = 0, limit: Any = None) -> None:
        """Records a decision that was taken elsewhere, instead of act and record: obs [num_envs][obs_dim], the action
        [num_envs][action_dim] that the policy of this epoch sampled for it, not clipped, and what followed: reward, cost,
        terminated, truncated, final_obs, valid, success, steps and limit as in record.

        generation: that of the policy, as in its file; StateError when it is not the agent's any more. 0: not checked.
        """
        rows, actions = self._given("rdm_agent_put", "obs", obs), self._given("rdm_agent_put", "action", action)
        transition, kept = self._transition("put", reward=reward, cost=cost, terminated=terminated,
                                            truncated=truncated, final_obs=final_obs, valid=valid, success=success,
                                            steps=steps, limit=limit)
        assign(transition, {"generation": generation})
        with self._lock:
            self._check(lib.rdm_agent_put(self._a, rows.ctypes.data, actions.ctypes.data, byref(transition)))
        del kept

    def _transition(self, call: str, **said: Any) -> tuple[Any, dict[str, Any]]:
        """The struct, and the arrays that it points to."""
        if said["cost"] is None and self.cost_dim:
            raise ArgumentError(f"{call}: cost is missing: give [{self.num_envs}][{self.cost_dim}] numbers, 0 where there was no cost. An "
                                "agent without costs is made with cost_dim=0")
        table = _abi.ROWS["rdm_transition"]
        rows = {name: given(value, table[name], self._lengths, name)
                for name, value in said.items() if value is not None}
        transition = sized(_abi.rdm_transition)
        for name, array in rows.items():
            setattr(transition, name, array.ctypes.data)
        return transition, rows

    def update(self, last_obs: Any) -> Epoch:
        """Learns from a full horizon; last_obs [num_envs][obs_dim] follows the last record. StateError before the horizon is
        full."""
        rows = self._given("rdm_agent_update", "last_obs", last_obs)
        epoch = sized(_abi.rdm_epoch)
        with self._lock:
            self._run(lib.rdm_agent_update, rows.ctypes.data, byref(epoch))
        return self._epoch(epoch)

    def update_begin(self, last_obs: Any) -> None:
        """Begins the same update, with the same last_obs, in slices, between which the caller can act: call update_slice until
        it returns the epoch.

            agent.update_begin(obs)
            while (epoch := agent.update_slice()) is None:
                robot.move(agent.act(robot.look(), "mean"))        # the policy of before

        The result has the same bytes as one update. Between two slices, whatever would change the agent raises StateError;
        discard drops the update.
        """
        rows = self._given("rdm_agent_update_begin", "last_obs", last_obs)
        with self._lock:
            self._check(lib.rdm_agent_update_begin(self._a, rows.ctypes.data))

    def update_slice(self, units: int = 1) -> Optional[Epoch]:
        """Does `units` more pieces of work, 1 or more, each at most one pass of a network over 256 rows; returns the epoch
        after the last piece, None before."""
        epoch, done = sized(_abi.rdm_epoch), ctypes.c_int32()
        with self._lock:
            self._check(lib.rdm_agent_update_slice(self._a, int32(units, "units"), byref(done), byref(epoch)))
        return self._epoch(epoch) if done.value else None

    def discard(self) -> None:
        """Drops a horizon that has begun, an update in slices and a pending cancel; the policy is as before."""
        with self._lock:
            self._check(lib.rdm_agent_discard(self._a))

    def rollout(self, pool: Pool) -> Epoch:
        """One epoch within the library: act, step and record until the horizon is full, then update.

        The pool must have been reset and must not have autoreset off. Ctrl-C ends it early: this horizon is dropped,
        KeyboardInterrupt is raised, and agent and pool can still be used.
        """
        instance(pool, Pool, "pool")
        epoch = sized(_abi.rdm_epoch)
        with self._lock, pool._lock, contextlib.ExitStack() as stack:
            if self._shield is not None:
                stack.enter_context(self._shield._lock)
            self._run(lib.rdm_agent_rollout, pool._open(), byref(epoch))
        return self._epoch(epoch)

    @keywords(aliases={"total_timesteps": "steps", "total_steps": "steps", "env": "pool"})
    def learn(self, steps: float, pool: Optional[Pool] = None, callback: Optional[Callable[[Epoch], Any]] = None) -> Epoch:
        """Makes rollouts until this many further control steps of all worlds are taken, rounded up to whole epochs; returns
        the last epoch.

        pool: None means the pool that the agent was made for, as long as it exists; it is reset if it was not yet.
        callback(epoch) is called after each epoch; a true result ends the call. redman.train also keeps the best policy and
        a run folder."""
        if pool is None:
            pool = None if self._pool is None else self._pool()
        if pool is None:
            raise UsageError("learn: this agent has no pool: give one, agent.learn(steps, pool)")
        if callback is not None and not callable(callback):
            raise UsageError(f"callback: it must be a function of the epoch, not {callback!r}")
        steps = real(steps, "steps")
        if not instance(pool, Pool, "pool")._begun:
            pool.reset()
        options = self.options
        if not 0 < steps < math.inf:
            raise ArgumentError(f"steps: {steps:g} is not above 0")
        for _ in range(math.ceil(steps / (self.num_envs * int(options["horizon"]) * int(options["action_repeat"])))):
            epoch = self.rollout(pool)
            if callback and callback(epoch):
                break
        return epoch

    def cancel(self) -> None:
        """From any thread: the running or next rollout or update raises CancelledError."""
        lib.rdm_agent_cancel(self._a)

    def _run(self, call: Callable[..., int], *arguments: Any) -> None:
        """Runs a long call. When called from the main thread, the call runs in another one, so that the main thread can
        handle signals."""
        if threading.current_thread() is not threading.main_thread():
            self._check(call(self._a, *arguments))
            return
        go: SimpleQueue[None] = SimpleQueue()
        done = threading.Lock()
        given_up: list[bool] = []
        ended: list[bool] = []  # whether it succeeded
        failed: list[BaseException] = []

        def work() -> None:
            go.get()
            code = -1
            try:
                code = 0 if given_up else call(self._a, *arguments)
                self._check(code)  # the text is this thread's
            except BaseException as error:
                failed.append(error)
            finally:
                ended.append(code == 0)
                done.release()

        started = None
        done.acquire()
        try:  # a signal may raise behind each of these; Thread.start would leave a dead thread in threading's books
            started = _thread.start_new_thread(work, ())
            go.put(None)
            done.acquire()
        except BaseException:
            given_up.append(True)
            go.put(None)
            if started is not None:  # else it finds that this was given up
                lib.rdm_agent_cancel(self._a)
                self._wait(ended)
                failed.clear()  # no cycle with a traceback
                if ended[0]:
                    self._renew()
            raise
        if failed:
            raise failed.pop()

    @staticmethod
    def _wait(ended: list[bool]) -> None:
        """Waits for the end of a call that was cancelled; further signals are ignored meanwhile."""
        while not ended:
            with contextlib.suppress(BaseException):
                time.sleep(0.001)

    def _renew(self) -> None:
        """Makes the same agent again, without the cancel that came too late to end the call."""
        self.__setstate__(self.__getstate__())

    def _epoch(self, struct: _abi.rdm_epoch) -> Epoch:
        return Epoch(struct, self._config["cost_names"])

    # ---- what it is -------------------------------------------------------------------------------------------

    @property
    def options(self) -> Mapping[str, Value]:
        """All options of the algorithm as this agent has them, to be read: changing an entry is an error, and
        dict(agent.options) is a copy. agent.set(learning_rate=1e-4) changes a live option."""
        return read_settings(lib.rdm_agent_get_settings, self._open(),
                             {key: option.kind for key, option in self.algo.options.items()}, "agent.set(key=value)")

    def _option_names(self) -> Iterable[str]:
        return self.algo.options if "algo" in vars(self) else ()

    def set(self, **options: Given) -> None:
        """Changes live options: agent.set(learning_rate=1e-4). Keys with dots: agent.set(**{"a.b": 1})."""
        kinds = known_options(self.algo, options)
        for row in option_array(options, kinds):
            with self._lock:
                self._check(lib.rdm_agent_set_option(self._a, byref(row)))

    @property
    def cost_limits(self) -> list[Optional[float]]:
        """The limit of each cost column, None where there is none; option cost_limit is the limit of column 0."""
        said = list(self._config["cost_limits"] or [-1.0] * self.cost_dim)
        if said:
            said[0] = float(self.options.get("cost_limit", said[0]))
        return [None if limit < 0 else limit for limit in said]

    @property
    def shield(self) -> Optional[Shield]:
        """The shield that checks every decision of a rollout, or None; set it between horizons.

            agent.shield = redman.Shield(pool, steps=agent.options["action_repeat"], budgets={"cost": 0})

        Its decisions last as long as the agent's, and its first backup is the agent itself without noise. Options
        shield_learn and shield_penalty say what the agent learns from decisions that the shield refuses.
        """
        return self._shield

    @shield.setter
    def shield(self, shield: Optional[Shield]) -> None:
        from ._shield import Shield
        if shield is not None:
            instance(shield, Shield, "shield", "; None takes it away")
        with self._lock:
            self._check(lib.rdm_agent_set_shield(self._a, None if shield is None else shield._open()))
            self._shield = shield

    @property
    def tensors(self) -> _AgentTensors:
        """The parameters by name: agent.tensors["actor.log_std"][...] is a copy, assignment writes."""
        return _AgentTensors(self, lib.rdm_agent_tensor_at, lib.rdm_agent_get_tensor)

    def policy(self) -> Policy:
        """The frozen policy as it is now."""
        with self._lock:
            return Policy(bytes_of(lib.rdm_agent_write_policy, self._open()))

    # ---- state ------------------------------------------------------------------------------------------------

    def save(self, path: Union[None, str, os.PathLike[str]] = None) -> bytes:
        """The complete state between epochs: networks, optimiser, multipliers, normaliser, streams, counters. With a path it
        is also written to that file, entirely or not at all."""
        with self._lock:
            state = bytes_of(lib.rdm_agent_write_state, self._open())
        if path is not None:
            write_whole(path, state, "agent")
        return state

    def load(self, state: Union[bytes, bytearray, memoryview, str, os.PathLike[str]]) -> None:
        """Continues from the state, bytes or the path of their file, of a save() of an agent of the same configuration.
        FormatError for another one; nothing changes when it fails."""
        data = read_whole(state, "agent") if isinstance(state, (str, os.PathLike)) else raw(state, "state")
        with self._lock:
            self._check(lib.rdm_agent_read_state(self._a, data, len(data)))

    def write_checkpoint(self, path: Union[str, os.PathLike[str]], pool: Optional[Pool] = None,
                         note: bytes = b"") -> None:
        """Writes agent, pool and a note of your own to one file at path, replaced atomically. pool None: the agent alone."""
        worlds, data = None if pool is None else instance(pool, Pool, "pool")._open(), raw(note, "note")
        with self._lock:
            self._check(lib.rdm_checkpoint_write(encoded(path, "path"), self._a, worlds, data, len(data)))

    def read_checkpoint(self, path: Union[str, os.PathLike[str]], pool: Optional[Pool] = None) -> bytes:
        """Continues from the file at path that write_checkpoint wrote, and returns its note; nothing changes when it fails.
        pool: the worlds that go on from it; None: that of the file is not read."""
        worlds = None if pool is None else instance(pool, Pool, "pool")._open()
        size, note = c_size_t(), ctypes.create_string_buffer(1)
        with self._lock:
            while True:
                self._check(lib.rdm_checkpoint_read(encoded(path, "path"), self._a, worlds, note, len(note), byref(size)))
                if size.value <= len(note):
                    return note.raw[:size.value]
                note = ctypes.create_string_buffer(size.value)

    def close(self) -> None:
        """Destroys the agent. A second call does nothing."""
        with self._lock:
            self._handle = None
            self._a = None

    def __enter__(self) -> Agent:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def __getstate__(self) -> dict[str, Any]:
        return {"config": self._config, "state": self.save(), "shield": self._shield, "recording": self._recording}

    def __setstate__(self, saved: Mapping[str, Any]) -> None:
        if not hasattr(self, "_lock"):
            self._lock, self._pool = threading.RLock(), None
        self._make(saved["config"])
        self.recording = saved["recording"]
        self.load(saved["state"])
        self.shield = saved["shield"]

    def __repr__(self) -> str:
        closed = ", closed" if self._a is None else ""
        return f"<Agent {self.algo.name}: {self.num_envs} rows of {self.obs_dim} to {self.action_dim}{closed}>"

    def _given(self, function: str, name: str, value: Any) -> Array:
        return given(value, _abi.FUNCTIONS[function].rows[name], self._lengths, name)

    def _open(self) -> int:
        if self._a is None:
            raise StateError("agent: it was closed")
        return self._a

    def _fail(self, code: int) -> Error:
        return StateError("agent: it was closed") if self._a is None else failure(code)

    def _check(self, code: int) -> None:
        if code:
            raise self._fail(code)
        check(code)


def _named_parts(fields: Mapping[str, tuple[int, int]]) -> list[tuple[str, str, int, int]]:
    """Argument fields as rows (name, unit, offset, count)."""
    try:
        return [(name, "", int32(offset, "fields"), int32(count, "fields")) for name, (offset, count) in fields.items()]
    except (AttributeError, TypeError, ValueError):
        raise UsageError(f"fields: it must be a dict of (offset, count) by name, not {fields!r}") from None


def _config_of(pool: Pool) -> dict[str, Any]:
    """What rdm_agent_config_for_pool says, as plain values."""
    config = sized(_abi.rdm_agent_config)
    check(lib.rdm_agent_config_init(byref(config), ctypes.sizeof(config)))
    instance(pool, Pool, "pool", "; an environment has one, env.pool")
    check(lib.rdm_agent_config_for_pool(byref(config), pool._open()))
    pointed: dict[str, Array] = {}
    for name, rows in _abi.ROWS["rdm_agent_config"].items():
        if getattr(config, name):
            kind = np.ctypeslib.as_ctypes_type(rows.dtype)
            at = ctypes.cast(getattr(config, name), ctypes.POINTER(kind))
            pointed[name] = np.array(at[:getattr(config, rows.shape[0])], rows.dtype)
    defaults = laid(config.defaults[i] for i in range(config.num_defaults))
    return {"obs_dim": config.obs_dim, "action_dim": config.action_dim, "cost_dim": config.cost_dim,
            "num_envs": config.num_envs, "task": text(config.task), "layout_hash": config.layout_hash,
            "control_dt": config.control_dt, "max_steps": config.max_steps, "defaults": defaults,
            "initial_mean": pointed.get("initial_mean"), "cost_limits": pointed.get("cost_limits"),
            "fields": [(text(f.name), text(f.unit), f.offset, f.count) for f in config.fields[:config.num_fields]]}


def known_options(algo: _discovery.Algo, options: Iterable[str]) -> dict[str, int]:
    """The kind of each option of an algorithm; refuses an unknown key and names the nearest known one."""
    kinds: dict[str, int] = {key: option.kind for key, option in algo.options.items()}
    for key in options:
        if kind_of(key, kinds) is None:
            raise NotFoundError(f"{algo.name} option {key}: unknown{nearest(key, kinds)}")
    return kinds


def _created(own: Mapping[str, Any]) -> Handle:
    """The agent of a configuration of plain values."""
    config = sized(_abi.rdm_agent_config)
    check(lib.rdm_agent_config_init(byref(config), ctypes.sizeof(config)))
    assign(config, {name: own[name] for name in ("obs_dim", "action_dim", "cost_dim", "num_envs", "num_threads", "seed",
                                                 "layout_hash", "control_dt", "max_steps")})
    config.algo, config.task = encoded(own["algo"], "algo"), encoded(own["task"], "task")
    if own["options"]:
        config.settings = settings_of(own["options"], known_options(_discovery.algo(own["algo"]), own["options"]))
    defaults = option_array(own["defaults"])
    config.defaults, config.num_defaults = defaults, len(defaults)
    arrays = {name: None if own[name] is None else np.ascontiguousarray(own[name], rows.dtype)
              for name, rows in _abi.ROWS["rdm_agent_config"].items()}
    for name, array in arrays.items():
        setattr(config, name, address(array))
    fields = (_abi.rdm_field * len(own["fields"]))()
    for field, (name, unit, offset, count) in zip(fields, own["fields"]):
        field.name, field.unit, field.offset, field.count = encoded(name, "fields"), encoded(unit, "fields"), offset, count
    config.fields, config.num_fields = fields, len(fields)
    ranks = own["ranks"]
    if ranks is not None:
        from ._ranks import Ranks
        struct = instance(ranks, Ranks, "ranks")._struct
        return Handle(lib.rdm_agent_create_ranked, lib.rdm_agent_destroy, byref(config), byref(struct))
    return Handle(lib.rdm_agent_create, lib.rdm_agent_destroy, byref(config))
