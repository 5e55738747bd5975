"""Leading a point of a robot by the action: what each entry does is tried in copies of the world, as the command `redman view`
does (examples/redman/view/lead.cpp), in all copies at once."""
from __future__ import annotations

import math
from typing import Any, Optional, Sequence

import numpy as np

from ._error import Error
from ._pool import Pool
from ._rows import Array

# How long is looked ahead, s, and how much of an entry is tried; more where nothing moves at first: a finger that presses on a
# table has targets far below it.
_LOOKS = ((0.3, 0.1), (0.6, 1.0))
_LEAST = 1e-3  # m for a whole entry: what moves the point less does not move it
_MOST_WAY = 0.03  # m, in the time that is looked ahead
_DAMPING = 0.01  # m for a whole entry
_POSTURE = 0.1  # of the way of an entry back to that of the hold action, in a step, as far as the point stays
_MOST_CHANGE = 0.2  # of an entry, in a step


def point_of(pose: Array, local: Sequence[float]) -> Array:
    """Where a point of a body at pose (position, quaternion x y z w) is."""
    axis, w, v = pose[3:6], pose[6], np.asarray(local, float)
    turn = 2 * np.cross(axis, v)
    at: Array = pose[:3] + v + w * turn + np.cross(axis, turn)
    return at


class Lead:
    """Copies of worlds of a pool: one that takes the action as it is, and one for each entry."""

    def __init__(self, pool: Pool) -> None:
        self.pool = pool
        own: dict[str, Any] = {**pool._config, "num_envs": 1 + pool.action_dim, "autoreset": "off", "ranks": None}
        self._copies = Pool(own.pop("task"), **own)
        self._copies.reset()
        self._hold = self._copies.baseline("hold")[0].astype(float)

    def _after(self, env: int, shape: int, local: Sequence[float], ahead: float, actions: Array) -> Array:
        """[copies][3] where the point is after `ahead` seconds of each action."""
        copies, on = self._copies, np.ones(len(actions), bool)
        for i in range(len(actions)):
            copies.copy(env, i, self.pool)
        for _ in range(math.ceil(ahead / (float(copies.control_dt) * copies.spec.action_repeat) - 1e-9)):
            copies.step(actions, on)
            on &= ~(copies.terminated | copies.truncated)  # they would not go on
            if not on.any():
                break
        return np.array([point_of(copies.poses(i)[shape], local) for i in range(len(actions))])

    def of_robot(self, env: int, shape: int, local: Sequence[float]) -> bool:
        """Whether some joint moves the point: what lies about is pulled, not led."""
        copies = self._copies
        try:
            copies.copy(env, 0, self.pool)
            joints = copies.joints
            q = np.clip(copies.joint_positions(0), [j.lower for j in joints], [j.upper for j in joints])
            q[[j.action < 0 and j.kp == 0 for j in joints]] = np.nan  # coupled joints follow the one that they are coupled to
            at = []
            for turned in (q, q + 1e-3):
                copies.set_joints(0, turned)
                at.append(point_of(copies.poses(0)[shape], local))
        except Error:  # a task whose joints cannot be set
            return False
        return float(np.linalg.norm(at[1] - at[0])) > 1e-6

    def bring(self, env: int, shape: int, local: Sequence[float], to: Sequence[float], action: Array) -> Optional[Array]:
        """The action after `action` that brings a point of a shape of a world nearer to `to`; None where nothing moves it."""
        if not self.of_robot(env, shape, local):
            return None
        action = np.asarray(action, float)
        for ahead, probe in _LOOKS:
            by = np.where(action > 1 - probe, -probe, probe)
            tried = np.maximum(action + by, -1)
            rows = np.tile(action, (1 + len(action), 1))
            rows[1 + np.arange(len(action)), np.arange(len(action))] = tried
            at = self._after(env, shape, local, ahead, rows.astype(np.float32))
            jacobian = ((at[1:] - at[0]) / (tried - action)[:, None]).T
            moves = np.linalg.norm(jacobian, axis=0) >= _LEAST
            if not moves.any():
                continue
            # da = J+ (way - J r) + r, damped: r brings the entries back to the hold action without moving the point.
            jacobian, back = jacobian[:, moves], _POSTURE * (self._hold - action)[moves]
            way = np.asarray(to, float) - at[0]
            way *= min(1.0, _MOST_WAY / max(float(np.linalg.norm(way)), 1e-9))
            x = np.linalg.solve(jacobian @ jacobian.T + _DAMPING**2 * np.eye(3), way - jacobian @ back)
            out = action.copy()
            out[moves] += np.clip(jacobian.T @ x + back, -_MOST_CHANGE, _MOST_CHANGE)
            return np.clip(out, -1, 1)
        return None
