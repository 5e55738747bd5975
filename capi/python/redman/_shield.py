"""Shield: keeps every cost within its budget, whatever actions are proposed; project: the nearest action within half spaces.
Experimental, like redman/shield.h."""
from __future__ import annotations

import ctypes
import threading
from ctypes import byref, c_size_t
from typing import TYPE_CHECKING, Any, Iterable, Mapping, Optional, Union

import numpy as np

from . import _abi, _discovery
from ._abi import ShieldKind
from ._actor import on_task
from ._error import ArgumentError, UsageError
from ._library import Handle, assign, bytes_of, check, filled, instance, int32, lib, raw, real, sized
from ._limits import CostLimits, each_cost
from ._names import Hinted, folded, keywords
from ._options import Options, Value, as_dict, read_settings, settings_of
from ._policy import Backup, Policy, policy_of
from ._pool import Pool
from ._rows import Array, FloatArray, address, array_of, given

if TYPE_CHECKING:
    import numpy.typing as npt

# Of an environment or an evaluation: True, or a dict of options and of Shield's arguments budgets, seed and threads.
Shielding = Union[None, bool, Mapping[str, Any]]
NAMES = np.array([kind.name.lower() for kind in ShieldKind], object)  # of kinds


class ShieldRow(_abi.ShieldRow):
    """What a shield did in a world's last decision, and why; kind is a redman.ShieldKind."""

    kind: ShieldKind
    # Of what was refused: the cost that it would have met, and its name; None: nothing was, or the copy diverged. Of what was
    # projected: of the guard that it broke most; None: of one that was added.
    column: Optional[int]  # type: ignore[assignment]
    cost: Optional[str]
    # That the plan continues by, of Shield.backups; None: no other way was looked for.
    backup: Optional[int]  # type: ignore[assignment]

    def __init__(self, struct: _abi.rdm_shield_row, costs: list[str]) -> None:
        super().__init__(struct)
        column = None if struct.column < 0 else struct.column
        self.__dict__.update(kind=ShieldKind(struct.kind), column=column, cost=None if column is None else costs[column],
                             backup=None if struct.backup < 0 else struct.backup)


class Shield(Hinted):
    """Accepts an action only if an exact copy of the world, which takes it and then follows a known plan, keeps every cost
    within its budget until the episode ends; otherwise it chooses another action. Before that, it replaces the action by the
    nearest one that keeps the guards: pool.guards of costs whose budget is 0, and those of add_guard; with
    options={"predict": False} it does nothing else.

        pool = redman.Pool("hand_over_safe_joint", 16, options={"action_repeat": 4})    # a step is a decision
        pool.reset()
        shield = redman.Shield(pool, policy)            # the policy is the first backup: a known way to continue
        for _ in range(19):
            pool.step(shield.act(policy.act(pool.obs)))         # or write pool.action, then shield.act()
        print(shield.stats, pool.stats.violations)

    policy: a Policy, its file or run folder, or "trained", the bundled one of the task; it must hold its actions as long
    as a decision lasts. After policies, action 0 and the hold action are tried (options zero, hold).
    steps: how many steps of the pool a decision lasts; None: as long as the policy holds an action, 1 without a policy.
    Where it is more than 1, call act once every `steps` steps and hold its action in between.
    budgets: bounds on the sum of each cost over an episode, given like Agent's cost_limits; None: the cost is ignored.
    Column 0 has 0 unless given.
    options: `redman.shield_options()` lists them with their help. threads: of the copies; 0: as many as the pool has. seed: of the
    noise that it tries. env, of the methods, is the number of a world, from 0.

    An exact copy knows the random numbers that its world will draw, so for a real robot the proof holds for the model alone;
    option copies tries each plan in several copies with random numbers of their own. When nothing that was tried keeps the
    budgets in a world, StateError names it; with options={"unproven": "least"} the action that exceeds them least is
    executed instead.
    """

    _hints = {
        "settings": "shield.options has all of them", "step": "pool.step(shield.act(action))", "save": "state()",
        "load": "set_state(state)", "policies": "shield.backups", "kind": "shield.kinds has that of each world, "
        "shield.row(env).kind one world's", "rows": "shield.row(env)", "close": "a shield ends with its last reference"}
    _set_option = "Shield(pool, {}=...)"

    pool: Pool
    steps: int  # of the pool that a decision lasts

    @keywords(aliases={"num_threads": "threads", "cost_limits": "budgets", "cost_limit": "budgets", "budget": "budgets"},
              options=True)
    def __init__(self, pool: Pool, policy: Optional[Backup] = None, *, seed: int = 0, threads: int = 0,
                 steps: Optional[int] = None, budgets: CostLimits = None, options: Optional[Options] = None) -> None:
        instance(pool, Pool, "pool", "; an environment takes shield=True")
        usual = [0.0, *[-1.0] * (pool.cost_dim - 1)][:pool.cost_dim]
        own = {"seed": seed, "num_threads": threads, "steps": 0 if steps is None else steps, "options": as_dict(options),
               "budgets": each_cost(budgets, usual, list(pool.costs), "budgets")}
        self._make(pool, own, None if policy is None else policy_of(policy, pool.task))

    def _make(self, pool: Pool, own: dict[str, Any], policy: Optional[Policy]) -> None:
        self.pool = pool
        config = sized(_abi.rdm_shield_config)
        check(lib.rdm_shield_config_init(byref(config), ctypes.sizeof(config)))
        assign(config, {name: own[name] for name in ("seed", "num_threads", "steps")})
        kinds = {key: option.kind for key, option in _discovery.shield_options().items()}
        config.settings = settings_of(own["options"], kinds)
        budgets = np.array(own["budgets"], np.float64)
        config.pool, config.budgets = pool._open(), budgets.ctypes.data
        config.policy = None if policy is None else policy._open()
        with on_task(pool):
            self._handle = Handle(lib.rdm_shield_create, lib.rdm_shield_destroy, byref(config))
        held = 1 if policy is None else policy.info.action_repeat // pool.spec.action_repeat
        self.steps = own["steps"] or held
        self._config: dict[str, Any] = {**own, "steps": self.steps}
        self._policies = [] if policy is None else [policy]
        self._guards: list[tuple[Array, float]] = []
        self._lock = threading.RLock()
        self._rows = _abi.FUNCTIONS["rdm_shield_act"].rows
        self._lengths = {"num_envs": pool.num_envs, "action_dim": pool.action_dim}

    def add(self, policy: Backup) -> None:
        """Adds a policy as a backup, after those that there are."""
        policy = policy_of(policy, self.pool.task)
        with self._lock, on_task(self.pool):
            check(lib.rdm_shield_add_policy(self._handle.value, policy._open()))
            self._policies.append(policy)

    def add_guard(self, normal: Any, bound: float) -> int:
        """Adds a guard for all worlds: normal [action_dim] . action <= bound. Returns its number for set_guard. Plans are
        forgotten."""
        row, bound = self._normal("rdm_shield_add_guard", normal), real(bound, "bound")
        with self._lock:
            check(lib.rdm_shield_add_guard(self._handle.value, row.ctypes.data, bound))
            self._guards.append((row.copy(), bound))
            return len(self._guards) - 1

    def set_guard(self, env: int, i: int, normal: Any, bound: float) -> None:
        """Sets guard i of those that were added to normal [action_dim] . action <= bound, for one world from now on, such as a
        model predicts it for the world's state. The world's plan is forgotten if the guard changed."""
        row, bound = self._normal("rdm_shield_set_guard", normal), real(bound, "bound")
        with self._lock:
            check(lib.rdm_shield_set_guard(self._handle.value, int32(env, "env"), int32(i, "i"), row.ctypes.data, bound))

    def _normal(self, function: str, normal: Any) -> Array:
        return given(normal, _abi.FUNCTIONS[function].rows["normal"], self._lengths, "normal")

    def act(self, proposed: Any = None, mask: Any = None) -> FloatArray:
        """Actions [num_envs][action_dim] for the worlds, given the `proposed` ones; it is one decision, to be held for
        `steps` steps of the pool.

        proposed None: checks pool.action in place, and returns it. mask [num_envs]: the worlds that decide now; rows of
        others are returned unchanged.
        """
        chosen = self._mask(mask)
        rows: Array = self.pool.action if proposed is None else given(proposed, self._rows["proposed"], self._lengths, "proposed")
        out = rows if proposed is None else rows.copy()
        with self.pool._lock, self._lock:
            check(lib.rdm_shield_act(self._handle.value, self.pool._open(), address(chosen), rows.ctypes.data, out.ctypes.data))
        return out if proposed is None else out.reshape(np.shape(proposed))

    def guard(self, mask: Optional[Array] = None) -> Array:
        """act() on pool.action where mask is true, except for worlds whose action is not finite, which ends their episode as
        without a shield. Returns the kinds of this decision [num_envs], OWN where nothing was checked."""
        asked: Array = np.isfinite(self.pool.action).all(axis=1)
        chosen = self._mask(mask)
        if chosen is not None:
            asked &= chosen.view(np.bool_)
        if asked.any():
            self.act(mask=asked)
        return self.kinds * asked

    def row(self, env: int = 0) -> ShieldRow:
        """What the shield did in the last decision of one world."""
        with self.pool._lock, self._lock:
            return ShieldRow(filled(_abi.rdm_shield_row, lib.rdm_shield_get_row, self._handle.value, self.pool._open(),
                                    int32(env, "env")), list(self.pool.costs))

    @property
    def kinds(self) -> npt.NDArray[np.int32]:
        """[num_envs] redman.ShieldKind of the last decision of each world."""
        out = np.empty(self.pool.num_envs, np.int32)
        with self._lock:
            check(lib.rdm_shield_get_kinds(self._handle.value, out.ctypes.data))
        return out

    @property
    def intervened(self) -> npt.NDArray[np.bool_]:
        """[num_envs] whether the last decision was changed."""
        refused: npt.NDArray[np.bool_] = self.kinds != ShieldKind.OWN
        return refused

    def plan(self, env: int = 0) -> FloatArray:
        """[decisions][action_dim] the plan of one world from now to the end of its episode; no rows where it has none."""
        count = c_size_t()
        with self.pool._lock, self._lock:
            arguments = self._handle.value, self.pool._open(), int32(env, "env")
            check(lib.rdm_shield_get_plan(*arguments, None, 0, byref(count)))
            out = np.empty(count.value, np.float32)
            check(lib.rdm_shield_get_plan(*arguments, out.ctypes.data, len(out), byref(count)))
        return out.reshape(-1, self.pool.action_dim)

    def set_plan(self, plan: Any, env: int = 0) -> None:
        """Makes plan [decisions][action_dim], such as a demonstration or a planner's plan, the plan of one world, which
        follows it when nothing new keeps the budgets. StateError if it exceeds a budget, with the time; the previous plan
        stays then."""
        plan = array_of(plan, "plan")
        lengths = {**self._lengths, "decisions": plan.size // self.pool.action_dim}
        rows = given(plan, _abi.FUNCTIONS["rdm_shield_set_plan"].rows["plan"], lengths, "plan")
        with self.pool._lock, self._lock:
            check(lib.rdm_shield_set_plan(self._handle.value, self.pool._open(), int32(env, "env"), rows.ctypes.data, len(rows)))

    @property
    def stats(self) -> _abi.ShieldStats:
        """Counts over all worlds since the shield was made: decisions, how many were tried in copies, and what was done."""
        return _abi.ShieldStats(filled(_abi.rdm_shield_stats, lib.rdm_shield_get_stats, self._handle.value))

    @property
    def interventions(self) -> int:
        """Number of decisions so far that were changed."""
        counts = self.stats
        return counts.changed + counts.planned + counts.projected + counts.unproven

    @property
    def options(self) -> Mapping[str, Value]:
        """All options as this shield has them, to be read: changing an entry is an error, and dict(shield.options) is a copy.
        Shield(pool, options={...}) makes a shield with others."""
        return read_settings(lib.rdm_shield_get_settings, self._handle.value,
                             {key: option.kind for key, option in _discovery.shield_options().items()}, "Shield(pool, options={...})")

    def _option_names(self) -> Iterable[str]:
        return _discovery.shield_options()

    @property
    def budgets(self) -> list[Optional[float]]:
        """The budget of each cost, None where it is ignored."""
        return [None if budget < 0 else budget for budget in self._config["budgets"]]

    @property
    def backups(self) -> list[Union[Policy, str]]:
        """The backups in the order in which they are tried: policies, "zero", "hold"."""
        options, out = self.options, list[Union[Policy, str]](self._policies)
        return out + [name for name in ("zero", "hold") if options[name]]

    def reset(self, mask: Any = None) -> None:
        """Forgets the plans of all worlds, or of those where mask [num_envs] is true. Not needed when an episode begins: the
        shield notices that."""
        with self._lock:
            check(lib.rdm_shield_reset(self._handle.value, address(self._mask(mask))))

    def state(self) -> bytes:
        """Plans, noise, counts and the guards of set_guard."""
        with self._lock:
            return bytes_of(lib.rdm_shield_write_state, self._handle.value)

    def set_state(self, state: bytes) -> None:
        """Continues from state() with the same bytes, if the pool is set to its state of that moment too."""
        data = raw(state, "state")
        with self._lock:
            check(lib.rdm_shield_read_state(self._handle.value, data, len(data)))

    def _mask(self, mask: Any) -> Optional[Array]:
        return None if mask is None else given(mask, self._rows["mask"], self._lengths, "mask", spread=True)

    def _open(self) -> int:
        assert self._handle.value is not None
        return self._handle.value

    def __getstate__(self) -> dict[str, Any]:
        return {"pool": self.pool, "config": self._config, "policies": self._policies, "guards": self._guards,
                "state": self.state()}

    def __setstate__(self, saved: Mapping[str, Any]) -> None:
        policies = saved["policies"]
        self._make(saved["pool"], saved["config"], policies[0] if policies else None)
        for policy in policies[1:]:
            self.add(policy)
        for normal, bound in saved["guards"]:
            self.add_guard(normal, bound)
        self.set_state(saved["state"])

    def __repr__(self) -> str:
        return f"<Shield of {self.pool.num_envs} of {self.pool.task.name}: {len(self.backups)} backups>"


def project(normals: Any, bounds: Any, action: Any) -> FloatArray:
    """The point in [-1, 1] nearest to action [dim] that satisfies normals [count][dim] . point <= bounds [count]."""
    rows = _abi.FUNCTIONS["rdm_project"].rows
    bounds, action = array_of(bounds, "bounds"), array_of(action, "action")
    count, dim = bounds.size, action.size
    lengths = {"count": count, "dim": dim}
    arrays = [given(value, rows[name], lengths, name)
              for name, value in (("normals", normals), ("bounds", bounds), ("action", action))]
    out = np.empty(dim, np.float32)
    check(lib.rdm_project(arrays[0].ctypes.data, arrays[1].ctypes.data, count, dim, arrays[2].ctypes.data, out.ctypes.data))
    return out


def is_wanted(shield: Shielding) -> bool:
    """Whether a shield= argument asks for a shield, of no options too."""
    return shield is not None and shield is not False


def shield_of(pool: Pool, wanted: Shielding, policy: Optional[Backup], steps: int = 1,
              played: Optional[Mapping[str, Value]] = None) -> Optional[Shield]:
    """The shield for the shield= argument of an environment or, with the options `played` unless others are given, of an evaluation."""
    if not is_wanted(wanted):
        if policy is not None:
            raise ArgumentError("shield_policy: it is the backup of a shield, and there is none: give shield=True too")
        return None
    if wanted is not True and not isinstance(wanted, Mapping):
        raise UsageError(f"shield: it must be True, or a dict of options, budgets, seed and threads, not {wanted!r}")
    options: dict[str, Value] = {} if wanted is True else as_dict(wanted, "shield")
    said = {folded(key) for key in options}
    options.update((key, value) for key, value in (played or {}).items() if key not in said)
    own: dict[str, Any] = {name: options.pop(name) for name in ("budgets", "seed", "threads") if name in options}
    return Shield(pool, policy, steps=steps, options=options, **own)
