"""Worlds of a pool as messages that the command-line tool reads (examples/redman/play/feed.hpp): a page of an episode is made
of them (`redman render --feed`), and a window shows them while they come (`redman view --feed`)."""
from __future__ import annotations

import json
import struct
from typing import TYPE_CHECKING, Any, Callable, Mapping, Optional

import numpy as np

from ._abi import ShapeKind
from ._rows import Array, DoubleArray

if TYPE_CHECKING:
    from ._own_costs import Own
    from ._pool import Pool


def _message(head: Mapping[str, Any], numbers: Array) -> bytes:
    text = json.dumps(head, allow_nan=False).encode()
    body = np.ascontiguousarray(numbers, "<f4").tobytes()
    return struct.pack("<II", 4 + len(text) + len(body), len(text)) + text + body


class Feed:
    """Scene and frames of worlds first, first + 1, ... of a pool.

    actor: what the page calls what acts. limits: of the costs by name. own: rewards and costs of your own, whose values for
    the last step the caller gives to frame().
    """

    def __init__(self, pool: Pool, first: int = 0, count: int = 1, *, actor: str = "python", seed: Optional[int] = None,
                 limits: Optional[Mapping[str, Optional[float]]] = None, own: Optional[Own] = None, shield: str = "",
                 record: str = "", leads: bool = False, shields: bool = False) -> None:
        self.record = record  # the file that the page's button writes; "": it has none
        self.leads, self.shields = leads, shields  # what else a page can ask for
        self.pool, self.worlds, self.actor, self.shield = pool, range(first, first + count), actor, shield
        self._seed = pool.seed if seed is None else seed
        self._own = own
        names = list(pool.cost_names) if own is None else own.names(pool)
        usual = {name: cost.limit for name, cost in pool.costs.items()} if own is None or own.costs is None else {}
        self._limits = {name: usual.get(name) for name in names} if limits is None else {name: limits.get(name) for name in names}
        shapes = pool.shapes
        self._moving = [i for i, shape in enumerate(shapes) if not shape.fixed]
        self._shapes = shapes
        self._gained, self._summed = np.zeros(count), np.zeros((count, len(names)))

    def scene(self) -> bytes:
        """What stays the same, as a message."""
        pool = self.pool
        head = {
            "say": "scene", "task": pool.task.name, "summary": pool.task.summary, "actor": self.actor, "seed": self._seed,
            "dt": float(pool.control_dt) * pool.spec.action_repeat, "first": int(pool.episode_step[self.worlds[0]]),
            "steps": pool.max_steps, "obs": pool.obs_dim, "worlds": len(self.worlds),
            "shapes": [self._shape(i) for i in range(len(self._shapes))],
            "cameras": [{"name": name, "eye": list(camera.eye), "target": list(camera.target), "up": list(camera.up), "fov_y": camera.fov_y,
                         "mounted": bool(camera.mount)} for name, camera in pool.task.cameras.items()],
            "costs": [{"name": name, "help": pool.costs[name].help if name in pool.costs else "a cost of your own",
                       "limit": -1 if limit is None else limit} for name, limit in self._limits.items()],
            "actions": self._actions(), "record": self.record, "leads": self.leads, "shields": self.shields, **({"shield": self.shield} if self.shield else {})}
        return _message(head, np.array([pool.poses(i) for i in self.worlds]).reshape(-1))

    def _shape(self, index: int) -> dict[str, Any]:
        shape = self._shapes[index]
        out = {"name": shape.name, "kind": int(shape.kind), "fixed": bool(shape.fixed), "size": list(shape.size),
               "color": list(shape.color[:3])}
        if shape.kind == ShapeKind.HULL:
            out["corners"] = self.pool.hull(index).reshape(-1).tolist()
        return out

    def _actions(self) -> list[str]:
        """A name for each entry of the action: that of the joint that it moves."""
        names = [f"action[{i}]" for i in range(self.pool.action_dim)]
        for joint in self.pool.joints:
            if 0 <= joint.action < len(names):
                names[joint.action] = joint.name
        return names

    def looked(self, reward: DoubleArray, cost: DoubleArray, begins: Array) -> None:
        """Notes rewards and costs of your own of a step, of all worlds; begins: where an episode has begun."""
        self._gained[begins], self._summed[begins] = 0, 0
        self._last = reward, cost
        self._gained += reward
        self._summed += cost

    def frame(self, world: int, *, contacts: bool = True, cloud: bool = True, stepped_in: Optional[Array] = None,
              take: Optional[Mapping[str, Any]] = None) -> bytes:
        """The worlds as they are now, as a message; with what one of them touches, and what its cameras see where there is a cloud.
        take: of the recording that runs."""
        pool, at = self.pool, slice(self.worlds.start, self.worlds.stop)
        n = len(self.worlds)
        head: list[Array] = [pool.reward[at], pool.episode_return[at], pool.episode_step[at], np.where(pool.terminated[at], 2, pool.truncated[at]),
                pool.success[at], np.zeros(n) if stepped_in is None else stepped_in]
        costs: list[Array] = [pool.cost[at], pool.episode_cost[at]]
        if self._own is not None:
            reward, cost = getattr(self, "_last", (np.zeros(n), np.zeros_like(self._summed)))
            head[:2], costs = [reward, self._gained], [cost, self._summed]
        rows = np.concatenate([np.stack(head, axis=1), *costs, pool.action[at]], axis=1)
        parts = [np.array([pool.poses(i)[self._moving] for i in self.worlds]).reshape(-1), rows.reshape(-1)]
        touched = points = 0
        if contacts:
            found = pool.contacts(world)
            touched = len(found)
            parts.append(np.concatenate([found["position"], found["force"]], axis=1).reshape(-1))
        if cloud:
            sensors = pool.sensors
            if sensors.points is not None and sensors.point_class is not None:
                points = len(sensors.points[world])
                parts += [sensors.points[world].reshape(-1), sensors.point_class[world]]
        head_of = {"say": "frame", "world": world - self.worlds.start, "contacts": touched, "points": points}
        return _message({**head_of, **({} if take is None else {"take": take})}, np.concatenate(parts))


class Followers:
    """What is called before and after each step and reset of a pool: methods of an instance that replace those of its class while
    there is somebody to call, so that other pools pay nothing."""

    def __init__(self, pool: Pool) -> None:
        self.all: list[tuple[Callable[[], None], Callable[[bool], None]]] = []
        step, reset = type(pool).step, type(pool).reset

        def followed_step(action: Any = None, mask: Any = None) -> Any:
            if action is not None:
                pool.action = action
            for before, _ in self.all:
                before()
            obs = step(pool, None, mask)
            for _, after in self.all:
                after(False)
            return obs

        def followed_reset(*given: Any, **named: Any) -> Any:
            obs = reset(pool, *given, **named)
            for _, after in self.all:
                after(True)
            return obs

        pool.__dict__.update(step=followed_step, reset=followed_reset)


def follow(pool: Pool, before: Callable[[], None], after: Callable[[bool], None]) -> Callable[[], None]:
    """Calls before() ahead of each step, and after(whether it was a reset). Returns what ends it."""
    followers = pool.__dict__.get("_followers") or pool.__dict__.setdefault("_followers", Followers(pool))
    both = (before, after)
    followers.all.append(both)

    def end() -> None:
        if both in followers.all:
            followers.all.remove(both)
        if not followers.all and pool.__dict__.get("_followers") is followers:
            for name in ("_followers", "step", "reset"):
                pool.__dict__.pop(name, None)

    return end
